//! Pyramidal Lucas–Kanade: sparse optical flow, coarse to fine.

mod explain;

use std::sync::{Arc, OnceLock};

use crate::base::{Error, Mapped, Observer, Tally, Threads};
use crate::data::{Clip, Flow, Frame};
use crate::geometry::{Grid, pyramid::halvings};
use crate::methods::{
    differential::{field, truth},
    features::{
        follow::{self, Follow, LevelResult},
        level_trace::case as tracking,
        tracker::Level,
    },
};
use crate::params::Spots;
use crate::products::{Confidence, DenseField, Feature, Output, PointField, Product, ProductKind, Status};
use crate::run::{Estimator, Footprint, Granularity, Guarantee, Info, Keypoints, Need, Pointed, Progress, Seen, Stage};
use crate::scene::{Chart, Focus, Levels, Picture, Question, Reply, Role, Scene, Step};
use crate::{choices, params, pseudocode};

choices! {
    /// Selection of the points to track.
    pub enum Points {
        /// Keypoints of the detector, the strongest first.
        Detect = "detect" "Detected keypoints",
        /// Points of a regular grid.
        Grid = "grid" "Grid",
        /// Points clicked in the frame.
        Clicks = "clicks" "Clicked points",
        /// Every pixel: dense flow, unknown where a pixel is lost.
        Dense = "dense" "Every pixel",
    }
}

params! {
    /// Lucas and Kanade's method for single points, coarse to fine on a pyramid.
    pub struct PyramidalLucasKanade {
        /// Selection of the points to track.
        points: Points = Points::Detect;
        /// Detector of the keypoints to track.
        detector: Stage<Keypoints> = Stage::named("shi-tomasi").with("min-distance", "7");
        /// Clicked points, by frame.
        clicks: Spots = Spots::default();
        /// Largest number of points; of keypoints, the strongest are tracked. No effect where every pixel is tracked.
        max_points: usize = 500, 1..=5000;
        /// Side of the window around each point, on every level; an even side is rounded up. Larger windows are more robust but mix different motions.
        window: usize = 21, 3..=31, "px";
        /// Number of pyramid levels including full resolution, each half the size of the one below, down to 16 px per side. More levels reach larger motion.
        levels: usize = 4, 1..=8;
        /// Largest number of iterations per level.
        iterations: usize = 30, 1..=100;
        /// Stopping criterion: the iterations of a level end with an increment shorter than this, in px of the level.
        epsilon: f32 = 0.01, 0.0..=1.0, "px";
        /// Smallest accepted eigenvalue λ₂ of the window's structure tensor, in (gray levels per px)². Points below it are ill-conditioned and lost.
        min_eigenvalue: f32 = 0.5, 0.0..=100.0;
        /// Largest accepted mean absolute difference between the windows of both frames, in gray levels. Points above it are lost.
        max_residual: f32 = 20.0, 0.0..=255.0;
    }
    advanced { "iterations", "epsilon", "max-residual" }
    when {
        "detector": |p| p.points == Points::Detect,
            "The detector has no effect unless detected keypoints are tracked.";
        "clicks": |p| p.points == Points::Clicks, "Clicks have no effect unless clicked points are tracked.";
        "max-points": |p| p.points != Points::Dense,
            "The maximum number of points has no effect where every pixel is tracked.";
    }
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    fixed: Arc<Fixed>,
    /// The results of the completed points, group by group.
    found: Vec<Arc<[Found]>>,
    /// The current level.
    level: usize,
    /// The initial guess of each point of the current group, in px of the level.
    guesses: Vec<[f32; 2]>,
}

/// The result of a point.
#[derive(Clone, Copy, Debug)]
struct Found {
    feature: Feature,
    /// The smaller eigenvalue of its structure tensor on level 0.
    certainty: f32,
}

impl Found {
    fn new(at: [f32; 2], (displacement, result): ([f32; 2], Result<f32, Status>), smaller: Smaller) -> Self {
        let feature = Feature::tracked(at, result.map(|residual| (displacement, residual)));
        Self { feature, certainty: smaller.0 }
    }
}

/// The constant part of a run.
struct Fixed {
    /// The pyramids of both frames, level 0 first.
    levels: [Vec<Level>; 2],
    points: Vec<[f32; 2]>,
    /// Points per unit: one, or a row of pixels.
    group: usize,
    truth: Option<Arc<Flow>>,
    /// The frames, and their levels as pictures, computed on demand.
    pair: [Arc<Frame>; 2],
    pictures: OnceLock<Arc<[crate::scene::Level]>>,
}

impl Fixed {
    fn pyramids(&self) -> [&[Level]; 2] {
        self.levels.each_ref().map(Vec::as_slice)
    }

    fn coarsest(&self) -> usize {
        self.levels[0].len() - 1
    }

    fn groups(&self) -> usize {
        self.points.len() / self.group
    }

    /// Returns the points of a group.
    fn group(&self, index: usize) -> &[[f32; 2]] {
        self.points.chunks_exact(self.group).nth(index).unwrap_or_default()
    }
}

/// An event of a point on one level.
#[derive(Clone, Copy, Debug)]
pub enum Event {
    /// There is no point.
    Nothing,
    /// A step of the tracking.
    Of(follow::Event),
    /// The next pixel of the row was tracked on this level.
    Pixel,
}

/// An observer that keeps λ₂ of the last window.
#[derive(Default)]
struct Smaller(f32);

impl Observer<follow::Event> for Smaller {
    #[inline(always)]
    fn see(&mut self, event: impl FnOnce() -> follow::Event) {
        if let follow::Event::Window(tensor) = event() {
            self.0 = tensor.eigenvalues()[1];
        }
    }
}

/// An observer that keeps λ₂ of the last window, and reports that there was an event.
struct Counted<'a, O> {
    smaller: &'a mut Smaller,
    counter: &'a mut O,
}

impl<O: Observer<Event>> Observer<follow::Event> for Counted<'_, O> {
    #[inline(always)]
    fn see(&mut self, event: impl FnOnce() -> follow::Event) {
        self.counter.see(|| Event::Nothing);
        self.smaller.see(event);
    }
}

impl PyramidalLucasKanade {
    fn reach(&self) -> usize {
        self.window / 2
    }

    fn prepare(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let pair = clip.pair(frame)?;
        let points = match self.points {
            Points::Detect => {
                let found = self.detector.points(clip, frame, threads)?;
                found.points.iter().map(|point| point.at).take(self.max_points).collect()
            }
            Points::Grid => grid(clip.size(), self.max_points),
            Points::Clicks => self.clicks.of_frame(frame).filter(|at| is_in(*at, clip.size())).collect(),
            Points::Dense => grid(clip.size(), usize::MAX),
        };
        let group = if self.points == Points::Dense { clip.size().0 } else { 1 };
        let of_frame = |i: usize| Level::pyramid(pair[i].luma(), self.levels, self.reach());
        let levels = <[_; 2]>::try_from(threads.map(2, of_frame)).unwrap_or_default();
        let level = levels[0].len() - 1;
        let fixed = Fixed { levels, points, group, truth: truth(clip, frame), pair, pictures: OnceLock::new() };
        Ok(State { fixed: Arc::new(fixed), found: Vec::new(), level, guesses: vec![[0.0; 2]; group] })
    }

    fn follow(&self) -> Follow {
        let Self { iterations, epsilon, min_eigenvalue, max_residual, .. } = *self;
        Follow { reach: self.reach(), iterations, epsilon, threshold: min_eigenvalue, max_residual }
    }
}

/// Whether a position lies in the frame.
fn is_in([x, y]: [f32; 2], (width, height): (usize, usize)) -> bool {
    (-0.5..width as f32 - 0.5).contains(&x) && (-0.5..height as f32 - 0.5).contains(&y)
}

/// At most `most` points of a regular grid on a frame of this size.
fn grid((width, height): (usize, usize), most: usize) -> Vec<[f32; 2]> {
    let mut spacing = ((width * height) as f64 / most as f64).sqrt().ceil().max(1.0) as usize;
    let along = |extent: usize, spacing: usize| ((spacing.min(extent) - 1) / 2..extent).step_by(spacing);
    while along(width, spacing).count() * along(height, spacing).count() > most {
        spacing += 1;
    }
    let row = |y: usize| along(width, spacing).map(move |x| [x as f32, y as f32]);
    along(height, spacing).flat_map(row).collect()
}

pseudocode! {
    MAKE_PYRAMIDS: "build the pyramids of frames t and t+1; select points",
    EACH_POINT: "for each point x: g ← 0",
    EACH_LEVEL: "  for each pyramid level, from the coarsest to full resolution",
    TAKE_TENSOR: "    T ← mean of (I_x², I_x I_y; I_x I_y, I_y²) over the window at x in frame t",
    IS_SINGULAR: "    if λ₂ of T < min-eigenvalue: pass g on, or lost on level 0",
    REPEAT: "    d ← g; repeat",
    UPDATE: "      δI ← I(x, t) − I(x + d, t+1), b ← mean of δI (I_x, I_y), η ← T⁻¹ b, d ← d + η",
    UNTIL_CONVERGED: "    until |η| < epsilon, or iterations are done",
    HAND_ON: "    g ← 2 d",
    CHECK: "  lost if x + d is outside the frame or mean |δI| > max-residual; else x moves by d",
}

impl Estimator for PyramidalLucasKanade {
    const INFO: Info = Info {
        id: "pyramidal-lucas-kanade",
        name: "Pyramidal Lucas–Kanade",
        family: "Optical flow",
        summary: "Sparse optical flow: least-squares tracking of single points, coarse to fine on a pyramid.",
        source: "J.-Y. Bouguet, Pyramidal implementation of the Lucas Kanade feature tracker: description of the algorithm, \
                 Intel Corporation, Microprocessor Research Labs, 2000",
        pseudocode: line::ALL,
        granularities: &["frame", "feature", "level", "iteration"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::place("displaced", "Where is the point in frame t+1?", line::CHECK, Role::Best),
        Question::choice(
            "converged",
            "Does the next iteration converge?",
            &[Reply::at(line::UNTIL_CONVERGED, "Yes: its increment is shorter than ε"), Reply::at(line::UPDATE, "No")],
        ),
        Question::choice(
            "lost",
            "Is the point tracked or lost?",
            &[Reply::told(line::CHECK, tracking::LOST, "Lost"), Reply::at(line::CHECK, "Tracked")],
        ),
    ];
    const GUARANTEE: Guarantee = Guarantee::Features { off_centi_px: 2 };
    const TELLS_CONFIDENCE: bool = true;
    const CHARTS: &'static [Chart] = &[Chart::Plane, Chart::Tiles, Chart::Stack];
    const PRODUCES: &'static [&'static ProductKind] = &[PointField::KIND, DenseField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        self.prepare(clip, frame, &Threads::single())
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let (fixed, follow) = (Arc::clone(&state.fixed), self.follow());
        let group = fixed.group(state.found.len());
        if group.is_empty() {
            observer.see(|| Event::Nothing);
            return Ok(Progress::Done);
        }
        let mut done = Vec::new();
        for (at, guess) in group.iter().zip(&mut state.guesses) {
            let mut smaller = Smaller::default();
            let (from, pyramids) = ((*at, *guess), fixed.pyramids());
            let followed = match self.points {
                Points::Dense => follow.on_level(pyramids, state.level, from, &mut smaller),
                _ => follow.on_level(
                    pyramids,
                    state.level,
                    from,
                    &mut Mapped { observer: &mut *observer, map: Event::Of },
                ),
            };
            if self.points == Points::Dense {
                observer.see(|| Event::Pixel);
            }
            match followed {
                LevelResult::Guess(finer) => *guess = finer,
                LevelResult::Done(displacement, result) => {
                    done.push(Found::new(*at, (displacement, result), smaller));
                    *guess = [0.0; 2];
                }
            }
        }
        if let Some(finer) = state.level.checked_sub(1) {
            state.level = finer;
            return Ok(Progress::More);
        }
        state.found.push(done.into());
        state.level = fixed.coarsest();
        Ok(if state.found.len() == fixed.groups() { Progress::Done } else { Progress::More })
    }

    fn units(&self, state: &State) -> Option<usize> {
        Some((state.fixed.groups() * state.fixed.levels[0].len()).max(1))
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        let (groups, levels) = (state.fixed.groups(), state.fixed.levels[0].len());
        let granularity = |index, of| Granularity { index, of: Some(of) };
        vec![
            granularity(0, 1),
            granularity(state.found.len(), groups.max(1)),
            granularity(levels - 1 - state.level, levels),
        ]
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        match event {
            Event::Of(follow::Event::End(_, Err(_))) => Some(Role::Rejected),
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
        let state = seen.after.unwrap_or(seen.before);
        match self.points {
            Points::Dense => field::draw(state.field().flow.0, scene),
            _ => explain::draw_points(state, scene),
        }
        let probe = self.probe(seen);
        if let Some(probe) = &probe {
            probe.trace.level_trace().draw([Picture::CURRENT, Picture::NEXT], scene);
        }
        scene.levels = Some(state.fixed.shown(probe.map_or(0, |probe| probe.trace.level())));
    }

    fn output(&self, state: &State) -> Output {
        match self.points {
            Points::Dense => Output::of(state.field()),
            _ => Output::of(PointField {
                picture: state.fixed.pair[0].size(),
                points: state.features().collect(),
                keypoints: Vec::new(),
            }),
        }
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads, tally: &impl Tally<Event>) -> Result<State, Error> {
        let mut state = self.prepare(clip, frame, threads)?;
        let (fixed, follow) = (Arc::clone(&state.fixed), self.follow());
        let levels = fixed.levels[0].len();
        tally.add_units((fixed.groups() * levels).max(1));
        tally.add_events(match self.points {
            // An event for each pixel of each level.
            Points::Dense => (fixed.points.len() * levels) as u64,
            _ => u64::from(fixed.points.is_empty()),
        });
        let found = |&at: &[f32; 2]| {
            let mut smaller = Smaller::default();
            let result = match self.points {
                Points::Dense => {
                    let mut on_level = Mapped { observer: &mut smaller, map: |(_, event)| event };
                    follow.through(fixed.pyramids(), at, &mut on_level)
                }
                _ => {
                    let mut counted = Counted { smaller: &mut smaller, counter: &mut tally.counter() };
                    let mut on_level = Mapped { observer: &mut counted, map: |(_, event)| event };
                    follow.through(fixed.pyramids(), at, &mut on_level)
                }
            };
            Found::new(at, result, smaller)
        };
        let of_group = |index| fixed.group(index).iter().map(found).collect();
        state.found = threads.map_while(fixed.groups(), || clip.wanted(), of_group)?;
        Ok(state)
    }
}

impl Footprint<State> for PyramidalLucasKanade {
    fn need(&self, clip: &Clip) -> Need {
        match self.points {
            Points::Dense => Need::per_pixel(clip, [72.0, 110.0]),
            Points::Detect => {
                let Need { run, .. } = self.detector.need(clip);
                Need::per_pixel(clip, [14.0, 20.0]).and([run as f64; 2])
            }
            _ => Need::per_pixel(clip, [14.0, 20.0]),
        }
    }

    fn state_bytes(&self, state: &State) -> usize {
        // Results are shared with later states.
        let groups = size_of_val(&state.found[..]) + size_of_val(&state.guesses[..]);
        size_of::<State>() + groups + state.fixed.group * size_of::<Found>()
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let levels: usize = state.fixed.levels.iter().flatten().map(Level::bytes).sum();
        let points = size_of_val(&state.fixed.points[..]) + state.fixed.points.len() * size_of::<Found>();
        self.state_bytes(state) + points + levels
    }
}

impl Pointed<State> for PyramidalLucasKanade {
    /// Returns the unit that tracks the point nearest to a position.
    fn unit_at(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<usize> {
        let index = nearest(&state.fixed.points, point)?;
        Some((index / state.fixed.group + 1) * state.fixed.levels[0].len() - 1)
    }
}

fn nearest(points: &[[f32; 2]], place: [f32; 2]) -> Option<usize> {
    let far = |at: &[f32; 2]| (at[0] - place[0]).hypot(at[1] - place[1]);
    let nearest = points.iter().enumerate().min_by(|(_, a), (_, b)| far(a).total_cmp(&far(b)));
    nearest.map(|(index, _)| index)
}

impl Fixed {
    /// Returns the pyramid as pictures, with the current level.
    fn shown(&self, at_work: usize) -> Levels {
        let all = self.pictures.get_or_init(|| {
            let [current, next] = self.pair.each_ref().map(|frame| {
                let coarser = halvings(frame.luma(), self.levels[0].len()).into_iter().skip(1);
                let coarser = coarser.map(|level| Arc::new(Frame::gray(level)));
                [Arc::clone(frame)].into_iter().chain(coarser).collect::<Vec<_>>()
            });
            current.into_iter().zip(next).map(|(current, next)| crate::scene::Level::new([current, next])).collect()
        });
        Levels { all: Arc::clone(all), at_work }
    }
}

impl State {
    fn features(&self) -> impl Iterator<Item = Feature> {
        self.found.iter().flat_map(|group| group.iter().map(|found| found.feature))
    }

    /// Returns the dense flow of all pixels so far.
    fn field(&self) -> DenseField {
        let (width, height) = self.fixed.pair[0].size();
        let of = |x: usize, y: usize| self.found.get(y).map(|row| row[x]);
        let displacement = |x, y| of(x, y).and_then(|found| found.feature.displacement).unwrap_or(Flow::UNKNOWN);
        let certainty = |x, y| of(x, y).map_or(0.0, |found| found.certainty);
        let values = Grid::from_fn(width, height, certainty);
        let confidence = Some(Confidence { name: "smaller_eigenvalue", values });
        DenseField { flow: Flow(Grid::from_fn(width, height, displacement)), confidence }
    }
}
