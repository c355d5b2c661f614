//! Point trajectories: points of a grid, advected by dense flow, compared with feature tracks.

mod explain;

use std::sync::Arc;

use crate::base::{Error, Observer, Tally, Threads};
use crate::data::{Clip, Flow};
use crate::geometry::Grid;
use crate::methods::{
    differential::truth,
    features::{
        follow::Follow,
        tracker::{Level, Template},
    },
};
use crate::products::{Feature, Output, Product, ProductKind, Status, Track, TrackField, consistency::returned};
use crate::run::{
    DenseFlow, Estimator, Explained, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen, Span,
    Stage, need, run_counted,
};
use crate::scene::{Chart, Focus, Question, Reply, Role, Scene, Step};
use crate::{params, pseudocode};

params! {
    /// Trajectories of grid points, advected by dense optical flow.
    pub struct PointTrajectories {
        /// Number of frames, including the first; fewer at the end of the clip.
        frames: usize = 30, 2..=10_000;
        /// Method of the dense optical flow.
        method: Stage<DenseFlow> = Stage::named("horn-schunck");
        /// Spacing of the grid points.
        spacing: usize = 10, 1..=100, "px";
        /// Start new points in empty grid cells of each frame.
        replenish: bool = true;
        /// Absolute tolerance of the forward–backward check: the largest accepted squared error at zero motion.
        absolute_tolerance: f32 = 0.5, 0.0..=1000.0, "px²";
        /// Relative tolerance of the forward–backward check, as a fraction of the squared forward and backward flow.
        relative_tolerance: f32 = 0.01, 0.0..=1.0;
        /// Smallest accepted eigenvalue λ₂ of the window's structure tensor, in (gray levels per px)². Points below it are not started, or are lost.
        min_eigenvalue: f32 = 0.5, 0.0..=100.0;
        /// Side of the window of the structure tensor and of feature tracking; an even side is rounded up.
        window: usize = 15, 3..=31, "px";
        /// Number of pyramid levels of feature tracking, each half the size of the one below, down to 16 px per side.
        levels: usize = 4, 1..=8;
    }
    advanced { "absolute-tolerance", "relative-tolerance", "min-eigenvalue", "window", "levels" }
}

/// Feature tracking uses the default parameters of the KLT tracker.
const ITERATIONS: usize = 30;
const EPSILON_PX: f32 = 0.01;
const MAX_RESIDUAL: f32 = 20.0;

/// The state of a run.
#[derive(Clone)]
pub struct State {
    span: Span,
    /// The first frame of the current pair.
    frame: usize,
    /// All tracks, by flow and by feature tracking, in order of their start.
    tracks: Vec<Arc<Track>>,
    twins: Vec<Arc<Track>>,
    /// The live points.
    live: Vec<Live>,
    /// Statistics of the pairs so far.
    notes: Arc<Vec<Note>>,
    /// Width and height of the frame in px.
    picture: (usize, usize),
    /// Size of a pair in memory, in bytes.
    pair_bytes: usize,
}

/// A live point.
#[derive(Clone, Copy, Debug)]
struct Live {
    track: u32,
    /// Its position by flow, in px.
    at: [f32; 2],
    /// Its position by feature tracking, unless lost.
    twin: Option<[f32; 2]>,
    /// Its true position, if known.
    truth: Option<[f32; 2]>,
}

/// Statistics of a pair; means in px, NaN without points.
#[derive(Clone, Copy, Debug)]
struct Note {
    /// Number of points at its start.
    points: u32,
    /// Mean drift between flow and feature tracks.
    apart: f32,
    /// Mean distances of flow and feature tracks from the truth.
    errors: [f32; 2],
}

/// Pyramids, flow and ground truth of a pair of frames.
struct Pair {
    pyramids: [Vec<Level>; 2],
    /// Forward and backward flow.
    flows: [Flow; 2],
    truth: Option<Arc<Flow>>,
    hidden: Option<Arc<Grid<bool>>>,
}

/// The result of a point in a pair.
#[derive(Clone, Copy, Debug)]
struct Moved {
    live: Live,
    /// λ₂ of its structure tensor, in (gray levels per px)².
    structure: f32,
    /// The forward flow at the point, and the backward flow at its end.
    there: Option<[f32; 2]>,
    back: Option<[f32; 2]>,
    /// The result by flow and by feature tracking.
    feature: Feature,
    twin: Option<Feature>,
    /// Its true end position.
    truth: Option<[f32; 2]>,
}

/// An event of a pair.
#[derive(Clone)]
pub struct Event(What);

#[derive(Clone)]
enum What {
    /// Forward and backward flow are estimated.
    Flow(Arc<Pair>),
    /// New points start.
    Begun(usize),
    /// The result of a point.
    Moved(Arc<Pair>, Moved),
    /// The end of the pair.
    Done(Note),
}

impl Moved {
    /// Returns its end position by flow, unless lost.
    fn to(&self) -> Option<[f32; 2]> {
        self.feature.end()
    }

    fn twin_to(&self) -> Option<[f32; 2]> {
        self.twin?.end()
    }

    /// Returns the drift between both tracks, in px.
    fn apart(&self) -> Option<f32> {
        Some(distance(self.to()?, self.twin_to()?))
    }
}

fn distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

impl Note {
    fn of(moved: &[Moved]) -> Self {
        let mean = |of: &dyn Fn(&Moved) -> Option<f32>| {
            let known = moved.iter().filter_map(of);
            let (sum, count) = known.fold((0.0, 0u32), |(sum, count), value| (sum + f64::from(value), count + 1));
            (sum / f64::from(count)) as f32
        };
        Self {
            points: moved.len() as u32,
            apart: mean(&Moved::apart),
            errors: [
                mean(&|moved| Some(distance(moved.to()?, moved.truth?))),
                // Over the same points.
                mean(&|moved| moved.to().and(Some(distance(moved.twin_to()?, moved.truth?)))),
            ],
        }
    }
}

impl Pair {
    /// Returns λ₂ of the structure tensor of a window, in (gray levels per px)².
    fn structure(&self, at: [f32; 2], reach: usize) -> f32 {
        Template::new(&self.pyramids[0][0], at, reach).tensor.eigenvalues()[1]
    }

    /// Returns the mean absolute difference of the windows at two positions, in gray levels.
    fn residual(&self, (at, to): ([f32; 2], [f32; 2]), reach: usize) -> f32 {
        Template::new(&self.pyramids[0][0], at, reach).mismatch(&self.pyramids[1][0], to).residual
    }

    /// Returns the true end position, if it is known and not occluded.
    fn true_end(&self, at: [f32; 2]) -> Option<[f32; 2]> {
        let pixel = at.map(|c| c.round() as usize);
        let is_hidden = self.hidden.as_ref().is_some_and(|hidden| hidden.get(pixel[0], pixel[1]) == Some(&true));
        let uv = self.truth.as_ref().filter(|_| !is_hidden)?.sample(at)?;
        Some([0, 1].map(|i| at[i] + uv[i]))
    }

    fn bytes(&self) -> usize {
        let levels: usize = self.pyramids.iter().flatten().map(Level::bytes).sum();
        levels + self.flows.iter().map(|flow| size_of_val(flow.0.cells())).sum::<usize>()
    }
}

impl PointTrajectories {
    fn reach(&self) -> usize {
        self.window / 2
    }

    fn pair(&self, clip: &Clip, t: usize, threads: &Threads) -> Result<Pair, Error> {
        let frames = clip.pair(t)?;
        let pyramids = frames.each_ref().map(|frame| Level::pyramid(frame.luma(), self.levels, self.reach()));
        let flows = [self.method.flow(clip, t, threads)?, self.method.flow(&clip.reversed(t)?, 0, threads)?];
        // A run needs no truth; unreadable truth is reported where errors are computed.
        let hidden = clip.truth().and_then(|truth| truth.occlusion(t).ok().flatten());
        Ok(Pair { pyramids, flows, truth: truth(clip, t), hidden })
    }

    /// Starts points in empty grid cells with texture; returns their number.
    fn begin(&self, state: &mut State, pair: &Pair) -> usize {
        if state.frame > state.span.first && !self.replenish {
            return 0;
        }
        let (width, height) = state.picture;
        let cell = |at: [f32; 2]| at.map(|c| c.max(0.0) as usize / self.spacing);
        let mut is_taken = Grid::new(width.div_ceil(self.spacing), height.div_ceil(self.spacing), false);
        for live in &state.live {
            let [x, y] = cell(live.at);
            is_taken[(x, y)] = true;
        }
        let along = |extent: usize| (self.spacing / 2..extent).step_by(self.spacing);
        let before = state.live.len();
        for (x, y) in along(height).flat_map(|y| along(width).map(move |x| (x, y))) {
            let at = [x as f32, y as f32];
            let [column, row] = cell(at);
            if is_taken[(column, row)] || pair.structure(at, self.reach()) < self.min_eigenvalue {
                continue;
            }
            state.live.push(Live { track: state.tracks.len() as u32, at, twin: Some(at), truth: Some(at) });
            let track = Arc::new(Track::begin(state.frame, at));
            state.tracks.push(Arc::clone(&track));
            state.twins.push(track);
        }
        state.live.len() - before
    }

    /// Advects a point, and tracks it as a feature.
    fn moved(&self, pair: &Pair, live: Live) -> Moved {
        let structure = pair.structure(live.at, self.reach());
        let [flow, reverse] = &pair.flows;
        let there = flow.sample(live.at);
        let to = there.map(|uv| [0, 1].map(|i| live.at[i] + uv[i]));
        let is_inside = |place: &[f32; 2]| pair.pyramids[1][0].holds(*place);
        let back = to.filter(is_inside).and_then(|to| reverse.sample(to));
        let result = match (there, to, back) {
            _ if structure < self.min_eigenvalue => Err(Status::Flat),
            (_, Some(to), _) if !is_inside(&to) => Err(Status::Outside),
            (Some(there), Some(to), Some(back)) => {
                let [off, limit] = returned(there, back, (self.relative_tolerance, self.absolute_tolerance));
                if off <= limit { Ok((there, pair.residual((live.at, to), self.reach()))) } else { Err(Status::Astray) }
            }
            _ => Err(Status::Astray),
        };
        let feature = Feature::tracked(live.at, result);
        let twin = live.twin.map(|at| self.followed(pair, at));
        let truth = live.truth.and_then(|at| pair.true_end(at));
        Moved { live, structure, there, back, feature, twin, truth }
    }

    fn followed(&self, pair: &Pair, at: [f32; 2]) -> Feature {
        let follow = Follow {
            reach: self.reach(),
            iterations: ITERATIONS,
            epsilon: EPSILON_PX,
            threshold: self.min_eigenvalue,
            max_residual: MAX_RESIDUAL,
        };
        let pyramids = pair.pyramids.each_ref().map(|levels| levels.as_slice());
        let (displacement, result) = follow.through(pyramids, at, &mut ());
        Feature::tracked(at, result.map(|residual| (displacement, residual)))
    }

    /// Processes one pair.
    fn work(
        &self,
        (clip, threads): (&Clip, &Threads),
        state: &mut State,
        observer: &mut impl Observer<Event>,
    ) -> Result<Progress, Error> {
        need::check_kept(clip, self.state_bytes(state))?;
        let pair = Arc::new(self.pair(clip, state.frame, threads)?);
        state.pair_bytes = pair.bytes();
        observer.see(|| Event(What::Flow(Arc::clone(&pair))));
        let begun = self.begin(state, &pair);
        observer.see(|| Event(What::Begun(begun)));
        let live = std::mem::take(&mut state.live);
        let all = threads.map_while(live.len(), || clip.wanted(), |i| self.moved(&pair, live[i]))?;
        for moved in &all {
            observer.see(|| Event(What::Moved(Arc::clone(&pair), *moved)));
            let Live { track, .. } = moved.live;
            note(&mut state.tracks[track as usize], Some(moved.feature));
            note(&mut state.twins[track as usize], moved.twin);
            if let Some(at) = moved.to() {
                state.live.push(Live { track, at, twin: moved.twin_to(), truth: moved.truth });
            }
        }
        let numbers = Note::of(&all);
        Arc::make_mut(&mut state.notes).push(numbers);
        observer.see(|| Event(What::Done(numbers)));
        state.frame += 1;
        // A pair needs a next frame.
        let is_over = state.span.is_over(clip, state.frame + 1);
        Ok(if is_over { Progress::Done } else { Progress::More })
    }
}

/// Stores the result of a point in its track.
fn note(track: &mut Arc<Track>, feature: Option<Feature>) {
    if let Some(feature) = feature {
        Arc::make_mut(track).record(feature, feature.end());
    }
}

pseudocode! {
    EACH_FRAME: "for each pair of frames t, t+1",
    FIND_FLOW: "  w ← dense flow from frame t to t+1, w′ ← dense flow from t+1 to t",
    BEGIN_POINTS: "  start a point in each empty grid cell with λ₂ ≥ min-eigenvalue",
    EACH_POINT: "  for each point x",
    IS_FLAT: "    lost if λ₂(x) < min-eigenvalue",
    IS_OUTSIDE: "    lost if x + w(x) is outside the frame",
    IS_ASTRAY: "    lost if |w(x) + w′(x + w(x))|² > relative-tolerance · (|w|² + |w′|²) + absolute-tolerance",
    CARRY: "    else x ← x + w(x), w interpolated bilinearly",
    COMPARE_FEATURES: "  y ← the same points, tracked by pyramidal Lucas–Kanade; drift ← mean of |x − y|",
}

impl Estimator for PointTrajectories {
    const INFO: Info = Info {
        id: "point-trajectories",
        name: "Point trajectories",
        family: "Optical flow",
        summary: "Long-term trajectories of grid points by dense flow, with a forward–backward check, compared with feature \
                  tracks of the same points.",
        source: "N. Sundaram, T. Brox and K. Keutzer, Dense point trajectories by GPU-accelerated large displacement optical \
                 flow, ECCV 2010; P. Sand and S. Teller, Particle video: long-range motion estimation using point trajectories, \
                 CVPR 2006; features: J.-Y. Bouguet, Intel Corporation, 2000",
        pseudocode: line::ALL,
        granularities: &["clip", "pair", "point"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[Question::choice(
        "carried",
        "What becomes of the next point?",
        &[
            Reply::at(line::CARRY, "The flow carries it on"),
            Reply::at(line::IS_ASTRAY, "Lost: forward and backward flow disagree"),
            Reply::at(line::IS_OUTSIDE, "Lost: the flow leads out of the frame"),
            Reply::at(line::IS_FLAT, "Lost: its surroundings are flat"),
        ],
    )];
    const GUARANTEE: Guarantee = Guarantee::Features { off_centi_px: 5 };
    const CHARTS: &'static [Chart] = &[Chart::Tiles, Chart::Series];
    const PRODUCES: &'static [&'static ProductKind] = &[TrackField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        Ok(State {
            span: Span::new(clip, frame, self.frames)?,
            frame,
            tracks: Vec::new(),
            twins: Vec::new(),
            live: Vec::new(),
            notes: Arc::default(),
            picture: clip.size(),
            pair_bytes: 0,
        })
    }

    fn advance(&self, clip: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        self.work((clip, &Threads::single()), state, observer)
    }

    fn units(&self, state: &State) -> Option<usize> {
        state.span.pairs()
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        state.span.place_of_pair(state.frame)
    }

    fn at_frame(&self, state: &State) -> Option<usize> {
        Some(state.frame)
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        match &event.0 {
            What::Moved(_, moved) if moved.to().is_none() => Some(Role::Rejected),
            _ => None,
        }
    }

    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.draw_step(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        let (first, last) = (state.span.first, state.frame);
        Output::of(TrackField { picture: state.picture, first, last, tracks: state.tracks.clone() })
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads, tally: &impl Tally<Event>) -> Result<State, Error> {
        run_counted(self, (clip, frame), tally, |state, counter| self.work((clip, threads), state, counter))
    }
}

impl Footprint<State> for PointTrajectories {
    fn need(&self, clip: &Clip) -> Need {
        let (width, height) = clip.size();
        let points = (width.div_ceil(self.spacing) * height.div_ceil(self.spacing)) as f64;
        // Forward and backward flow and both pyramids beside the method; each point has two tracks.
        self.method.need(clip).and([28.0 * (width * height) as f64; 2]).and([1500.0 * points, 3000.0 * points])
    }

    fn state_bytes(&self, state: &State) -> usize {
        let tracks: usize = state.tracks.iter().chain(&state.twins).map(|track| track.bytes()).sum();
        size_of::<State>() + tracks + size_of_val(&state.live[..]) + size_of_val(&state.notes[..])
    }

    fn memory_bytes(&self, state: &State) -> usize {
        self.state_bytes(state) + state.pair_bytes
    }
}

impl Pointed<State> for PointTrajectories {
    fn explained(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<Explained> {
        let inside = |i: usize, extent: usize| (0.0..extent as f32).contains(&(point[i] + 0.5));
        (inside(0, state.picture.0) && inside(1, state.picture.1)).then_some(Explained::Always)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: usize = 61;

    /// The flow of a rotation about the centre; it is linear, so bilinear interpolation is exact.
    fn turn(degrees: f32) -> Flow {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let middle = (SIZE / 2) as f32;
        Flow(Grid::from_fn(SIZE, SIZE, |x, y| {
            let [x, y] = [x, y].map(|c| c as f32 - middle);
            [cos * x - sin * y - x, sin * x + cos * y - y]
        }))
    }

    fn pair(flows: [Flow; 2]) -> Pair {
        let picture = Grid::from_fn(SIZE, SIZE, |x, y| (x * 37 + y * 91) as u8);
        let pyramids = [0, 1].map(|_| Level::pyramid(&picture, 1, 7));
        let truth = Some(Arc::new(flows[0].clone()));
        Pair { pyramids, flows, truth, hidden: None }
    }

    #[test]
    fn a_full_turn_returns_to_the_start() {
        let method = PointTrajectories { min_eigenvalue: 0.0, ..PointTrajectories::default() };
        let pair = pair([turn(3.0), turn(-3.0)]);
        for start in [[50.0, 30.0], [30.0, 12.5], [22.25, 41.75], [30.0, 30.0f32]] {
            let mut live = Live { track: 0, at: start, twin: None, truth: Some(start) };
            for step in 0..120 {
                let moved = method.moved(&pair, live);
                let to = moved.to().expect("it comes back along the reverse flow");
                let angle = (3.0 * (step + 1) as f32).to_radians();
                let [x, y] = start.map(|c| c - 30.0);
                let truth = [angle.cos() * x - angle.sin() * y + 30.0, angle.sin() * x + angle.cos() * y + 30.0];
                assert!(distance(to, truth) < 0.01, "{start:?} is at {to:?}, not {truth:?}");
                assert_eq!(moved.truth, Some(to), "what is true is gone along in the same way");
                live.at = to;
                live.truth = moved.truth;
            }
            assert!(distance(live.at, start) < 0.01);
        }
    }

    #[test]
    fn a_point_is_lost_for_the_right_reason() {
        let method = PointTrajectories { min_eigenvalue: 0.0, ..PointTrajectories::default() };
        let status = |method: &PointTrajectories, flows: [[f32; 2]; 2], at: [f32; 2]| {
            let pair = pair(flows.map(|uv| Flow(Grid::new(SIZE, SIZE, uv))));
            method.moved(&pair, Live { track: 0, at, twin: None, truth: None }).feature.status
        };
        let middle = [30.0, 30.0];
        assert_eq!(status(&method, [[2.0, 0.0], [-2.0, 0.0]], middle), Status::Tracked);
        assert_eq!(status(&method, [[2.0, 0.0], [-2.0, 0.0]], [59.0, 30.0]), Status::Outside);
        // 0.5 + 0.01 (4 + 1.6) = 0.556 px² against 0.54 and 0.58.
        assert_eq!(status(&method, [[2.0, 0.0], [-1.265, 0.0]], middle), Status::Tracked);
        assert_eq!(status(&method, [[2.0, 0.0], [-1.24, 0.0]], middle), Status::Astray);
        assert_eq!(status(&method, [[2.0, 0.0], Flow::UNKNOWN], middle), Status::Astray);
        let strict = PointTrajectories { min_eigenvalue: 100_000.0, ..method };
        assert_eq!(status(&strict, [[0.0; 2]; 2], middle), Status::Flat);
    }
}
