//! Scene flow: the position of each pixel in space, and its displacement to the next frame.
//!
//! ```text
//!   left t ── flow (u, v) ──▸ left t+1
//!     │                         │
//!     d                         d'            P  from (x, y, d)
//!     ▾                         ▾             P' from (x + u, y + v, d')
//!   right t                   right t+1       V = P' − P
//! ```

mod charts;
mod explain;
mod space;
mod vocabulary;

use std::sync::Arc;

use crate::base::{Error, Observer, Tally, Threads};
use crate::data::{
    Calibration, Clip, Disparity, Flow, Frame, Mask, Measured, Sigma, Truth, Viewpoint, mahalanobis_squared,
};
use crate::geometry::Grid;
use crate::methods::scene_flow::{Consensus, Draw, Ego, EgoSettings};
use crate::products::{EgoMotion, Output, Product, ProductKind, SceneFlowField};
use crate::run::{
    DenseFlow, Disparities, Estimator, Explained, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress,
    Seen, Stage, run_counted,
};
use crate::scene::{Chart, Focus, Name, Picture, Question, Reply, Role, Scene, Step};
use crate::synth::random::{gaussian, hash};
use crate::{choices, params, pseudocode};
use vocabulary::{case, value};

choices! {
    /// The disparities and the flow that are used.
    pub enum Source {
        /// Those that methods estimate.
        Estimated = "estimated" "Estimated",
        /// The true ones, where they are known, with noise.
        Truth = "truth" "Ground truth",
    }
}

params! {
    /// Scene flow of two views of a pair of frames.
    pub struct SceneFlow {
        /// Disparities and flow that are used. The true ones with noise show the error that remains.
        source: Source = Source::Estimated;
        /// Method of the disparities, in frame t and in frame t + 1.
        disparity: Stage<Disparities> = Stage::named("semi-global-matching");
        /// Method of the flow.
        flow: Stage<DenseFlow> = Stage::named("tv-l1");
        /// Standard deviation of the noise that is added to the true disparities and flow.
        noise: f32 = 0.25, 0.0..=5.0, "px";
        /// Assumed standard deviation of disparities and flow: it determines the uncertainty of positions and displacements. Of measured depths
        /// the disparities are those at the typed baseline, which so sets their error σ_Z = Z² σ / (f B).
        sigma: f32 = 0.25, 0.01..=5.0, "px";
        /// Gate of the squared Mahalanobis distance of the motion that remains without that of the cameras; beyond it a pixel has a motion of its
        /// own. 11.34 is the 99 % quantile of χ² with 3 degrees of freedom.
        gate: f32 = 11.34, 0.5..=500.0;
        /// Radius of the opening that removes small groups of such pixels, with a square of 2·radius + 1 px. 0 removes none.
        opening: usize = 2, 0..=15, "px";
        /// Estimation of the motion of the cameras.
        ego: EgoSettings = EgoSettings::default();
    }
    when {
        "disparity": |p| p.source == Source::Estimated, "The method has no effect on the true disparities.";
        "flow": |p| p.source == Source::Estimated, "The method has no effect on the true flow.";
        "noise": |p| p.source == Source::Truth, "The noise has no effect on estimated disparities and flow.";
    }
}

/// A part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The disparities of frame t.
    Disparity,
    /// The disparities of frame t + 1.
    NextDisparity,
    /// The flow.
    Flow,
    /// Positions and displacements, row by row.
    Positions,
    /// The motion of the cameras, sample by sample.
    Ego,
    /// The motion that remains, row by row.
    Own,
}

/// An event of a unit.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// A whole map was estimated.
    Whole(Part),
    /// A row was done.
    Row(Part, u32),
    /// A sample, or a round of the final fit, of the motion of the cameras.
    Draw(Box<Draw>),
    /// There were too few points for it.
    NoEgo,
    /// Small groups were removed: the number of pixels before and after.
    Opened([u32; 2]),
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    fixed: Arc<Fixed>,
    /// Number of completed parts.
    done: usize,
    disparity: Option<Arc<Disparity>>,
    /// Of frame t + 1, at the pixels of frame t + 1; of the truth, at those of frame t.
    next: Option<Arc<Disparity>>,
    flow: Option<Arc<Flow>>,
    /// The disparity in frame t + 1 of the point at each pixel of frame t.
    followed: Option<Arc<Disparity>>,
    /// The points on which the motion of the cameras is estimated.
    points: Arc<Vec<Measured>>,
    consensus: Option<Arc<Consensus>>,
    moving: Option<Arc<Mask>>,
}

/// The origin of depths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Depths {
    /// There are none.
    Unknown,
    /// Disparities of two views.
    Stereo,
    /// A sensor beside the camera.
    Sensor,
}

/// The constant part of a run.
struct Fixed {
    frame: usize,
    left: Arc<Frame>,
    depths: Depths,
    calibration: Option<Calibration>,
    /// Maps before they are estimated.
    unknown: (Arc<Disparity>, Arc<Flow>),
}

impl SceneFlow {
    /// The parts of a run; without a second view or a calibration there are fewer.
    fn parts(&self, fixed: &Fixed) -> &'static [Part] {
        use Part::{Disparity, Ego, Flow, NextDisparity, Own, Positions};
        match (fixed.depths, fixed.calibration) {
            (Depths::Unknown, _) | (Depths::Sensor, None) => &[Flow],
            (Depths::Stereo, None) => &[Disparity, NextDisparity, Flow, Positions],
            (_, Some(_)) => &[Disparity, NextDisparity, Flow, Positions, Ego, Own],
        }
    }

    fn sigma(&self) -> Sigma {
        Sigma { disparity_px: self.sigma.into(), flow_px: self.sigma.into() }
    }

    /// The standard deviation that errors should have: that of the noise where it is known.
    fn expected_sigma(&self) -> Sigma {
        match self.source {
            Source::Truth => Sigma { disparity_px: self.noise.into(), flow_px: self.noise.into() },
            Source::Estimated => self.sigma(),
        }
    }

    /// The standard deviation expected of the errors: that of the noise, if it is known.
    fn work(
        &self,
        (clip, threads): (&Clip, &Threads),
        state: &mut State,
        observer: &mut impl Observer<Event>,
    ) -> Result<Progress, Error> {
        let parts = self.parts(&state.fixed);
        let (part, t) = (parts[state.done], state.fixed.frame);
        match part {
            Part::Disparity => state.disparity = Some(self.disparities(clip, (t, 0), threads)?),
            Part::NextDisparity => state.next = Some(self.disparities(clip, (t, 1), threads)?),
            Part::Flow => state.flow = Some(self.flow_of(clip, t, threads)?),
            Part::Positions => self.triangulate(clip, state, observer)?,
            Part::Ego => self.estimate_ego(clip, state, observer)?,
            Part::Own => self.find_own(clip, state, observer)?,
        }
        if matches!(part, Part::Disparity | Part::NextDisparity | Part::Flow) {
            observer.see(|| Event::Whole(part));
        }
        state.done += 1;
        Ok(if state.done == parts.len() { Progress::Done } else { Progress::More })
    }

    /// Checks that the truth that is used is known for a pair of frames.
    fn check_truth(&self, clip: &Clip, t: usize, depths: Depths) -> Result<(), Error> {
        let truth = known(clip)?;
        let flow = truth.flow(t)?.is_some_and(|flow| flow.0.size() == clip.size());
        let fits = |map: &Arc<Disparity>| map.0.size() == clip.size();
        let both = || {
            Ok::<_, Error>(
                [truth.disparity(t)?, truth.next_disparity(t)?].iter().flatten().filter(|map| fits(map)).count(),
            )
        };
        let is_known = flow && (depths == Depths::Unknown || both()? == 2);
        is_known.then_some(()).ok_or_else(unknown)
    }

    /// The disparities of frame `t + after`.
    fn disparities(&self, clip: &Clip, (t, after): (usize, usize), threads: &Threads) -> Result<Arc<Disparity>, Error> {
        if self.source == Source::Estimated && clip.has_depths() {
            return of_sensor(clip, t + after).map(Arc::new);
        }
        if self.source == Source::Estimated {
            return Ok(Arc::new(self.disparity.disparities(clip, t + after, threads)?.map));
        }
        let truth = known(clip)?;
        let found = if after == 0 { truth.disparity(t)? } else { truth.next_disparity(t)? };
        let found = found.filter(|map| map.0.size() == clip.size()).ok_or_else(unknown)?;
        Ok(Arc::new(Disparity(self.noisy(&found.0, after as u64, |d, noise| d + noise(0)))))
    }

    fn flow_of(&self, clip: &Clip, t: usize, threads: &Threads) -> Result<Arc<Flow>, Error> {
        if self.source == Source::Estimated {
            return self.flow.flow(clip, t, threads).map(Arc::new);
        }
        let found = known(clip)?.flow(t)?.filter(|flow| flow.0.size() == clip.size()).ok_or_else(unknown)?;
        Ok(Arc::new(Flow(self.noisy(&found.0, 2, |[u, v], noise| [u + noise(0), v + noise(1)]))))
    }

    /// A true map with noise of its own.
    fn noisy<T: Copy>(&self, map: &Grid<T>, number: u64, add: impl Fn(T, &dyn Fn(u64) -> f32) -> T) -> Grid<T> {
        let (width, height) = map.size();
        Grid::from_fn(width, height, |x, y| {
            let pixel = (y * width + x) as u64;
            let noise =
                |part: u64| self.noise * gaussian(hash(self.ego.seed as u64, 4 * pixel + part, 0x5ce0 + number)) as f32;
            add(map[(x, y)], &noise)
        })
    }

    /// The disparity in frame t + 1 of the point at a pixel; NaN unless all is known.
    fn followed(&self, state: &State, (x, y): (usize, usize)) -> f32 {
        let found = || {
            state.disparity.as_ref()?.at(x, y)?;
            let ([u, v], next) = (state.flow.as_ref()?.at(x, y)?, state.next.as_ref()?);
            match self.source {
                Source::Truth => next.at(x, y),
                Source::Estimated => look_up(next, [x as f32 + u, y as f32 + v]),
            }
        };
        found().unwrap_or(Disparity::UNKNOWN)
    }

    /// Follows each pixel to frame t + 1 and looks up its disparity there.
    fn triangulate(&self, clip: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<(), Error> {
        let (width, height) = state.fixed.left.size();
        let mut followed = Grid::new(width, height, Disparity::UNKNOWN);
        for y in 0..height {
            clip.wanted()?;
            (0..width).for_each(|x| followed[(x, y)] = self.followed(state, (x, y)));
            observer.see(|| Event::Row(Part::Positions, y as u32));
        }
        state.followed = Some(Arc::new(Disparity(followed)));
        Ok(())
    }

    /// The pixels of a grid with known positions in both frames.
    fn ego_points(&self, field: &SceneFlowField) -> Vec<Measured> {
        let is_on_grid = |c: usize| c % self.ego.spacing == self.ego.spacing / 2;
        let on_grid = field.pixels().filter(|(x, y)| is_on_grid(*x) && is_on_grid(*y));
        let is_placed = |m: &Measured| field.calibration.is_some_and(|rig| m.in_space(&rig).is_some());
        on_grid.filter_map(|pixel| field.measured(pixel)).filter(is_placed).collect()
    }

    fn estimate_ego(&self, clip: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<(), Error> {
        let field = self.field(state);
        let Some(rig) = field.calibration else { return Ok(()) };
        let points = self.ego_points(&field);
        let ego = Ego::new(&rig, &points, &self.ego);
        let consensus = ego.estimate(|| clip.wanted(), |draw| observer.see(|| Event::Draw(Box::new(draw))))?;
        if consensus.drawn == 0 {
            observer.see(|| Event::NoEgo);
        }
        (state.points, state.consensus) = (Arc::new(points), Some(Arc::new(consensus)));
        Ok(())
    }

    /// The squared Mahalanobis distance of the motion of its own of a pixel.
    fn own_squared(&self, field: &SceneFlowField, pixel: (usize, usize)) -> Option<f64> {
        let (motion, ego) = (field.motion(pixel)?, field.ego?.pose);
        Some(mahalanobis_squared(motion.own(&ego), &motion.covariance(&ego, &field.sigma)))
    }

    /// Whether a pixel with this squared Mahalanobis distance has a motion of its own.
    fn is_beyond(&self, squared: f64) -> bool {
        squared > f64::from(self.gate)
    }

    fn find_own(&self, clip: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<(), Error> {
        let field = self.field(state);
        if field.ego.is_none() {
            // Without the camera motion no pixel can be judged.
            observer.see(|| Event::NoEgo);
            return Ok(());
        }
        let (width, height) = field.size();
        let mut beyond = Mask::new(width, height);
        for y in 0..height {
            clip.wanted()?;
            let row = Mask::from_fn(width, 1, |x, _| {
                self.own_squared(&field, (x, y)).is_some_and(|squared| self.is_beyond(squared))
            });
            beyond.write_row(y, |words| words.copy_from_slice(row.row(0)));
            observer.see(|| Event::Row(Part::Own, y as u32));
        }
        let opened = beyond.opened(self.opening);
        observer.see(|| Event::Opened([&beyond, &opened].map(|mask| mask.count() as u32)));
        state.moving = Some(Arc::new(opened));
        Ok(())
    }

    fn field(&self, state: &State) -> SceneFlowField {
        let Fixed { left, calibration, unknown: (unknown, still), .. } = &*state.fixed;
        let ego = state.consensus.as_ref().and_then(|consensus| {
            let fit = consensus.fit?;
            let (pose, residual_px) = (fit.pose, fit.rms_px());
            Some(EgoMotion { pose, inliers: fit.score.inliers, points: consensus.points, residual_px })
        });
        SceneFlowField {
            picture: Arc::clone(left),
            disparity: state.disparity.as_ref().unwrap_or(unknown).clone(),
            flow: state.flow.as_ref().unwrap_or(still).clone(),
            next_disparity: state.followed.as_ref().unwrap_or(unknown).clone(),
            calibration: *calibration,
            sigma: self.sigma(),
            ego,
            moving: state.moving.clone(),
        }
    }
}

fn known(clip: &Clip) -> Result<&Arc<dyn Truth>, Error> {
    clip.truth().ok_or_else(unknown)
}

/// The disparities that a second camera would see of the measured depths of frame `t`.
fn of_sensor(clip: &Clip, t: usize) -> Result<Disparity, Error> {
    let missing = || Error::new(format!("there are no depths of frame {t}; scene flow needs those of two frames"));
    let (depth, rig) = clip.depth_m(t)?.zip(clip.calibration()).ok_or_else(missing)?;
    let disparity = |z: &f32| if *z > 0.0 { rig.disparity_px(f64::from(*z)) as f32 } else { Disparity::UNKNOWN };
    Ok(Disparity(depth.map(disparity)))
}

fn unknown() -> Error {
    Error::new("the true disparities and flow of this pair of frames are not known; set source to estimated")
}

/// Largest difference of the disparities around a place, in px, between which one is interpolated; beyond it there is a depth edge.
const SMOOTH_PX: f32 = 1.0;

/// The disparity at a place between pixels: bilinear, or at a depth edge that of the nearest pixel.
fn look_up(map: &Disparity, [x, y]: [f32; 2]) -> Option<f32> {
    let (width, height) = map.0.size();
    let inside = |c: f32, extent: usize| (0.0..=(extent - 1) as f32).contains(&c);
    if !(inside(x, width) && inside(y, height)) {
        return None;
    }
    let (left, top) = (x.floor() as usize, y.floor() as usize);
    let (right, bottom) = ((left + 1).min(width - 1), (top + 1).min(height - 1));
    let corners = [(left, top), (right, top), (left, bottom), (right, bottom)].map(|(x, y)| map.at(x, y));
    let nearest = || map.at(x.round() as usize, y.round() as usize);
    let [Some(a), Some(b), Some(c), Some(d)] = corners else { return nearest() };
    let (least, most) = [b, c, d].iter().fold((a, a), |(least, most), v| (least.min(*v), most.max(*v)));
    if most - least > SMOOTH_PX {
        return nearest();
    }
    let (fx, fy) = (x - left as f32, y - top as f32);
    Some((a * (1.0 - fx) + b * fx) * (1.0 - fy) + (c * (1.0 - fx) + d * fx) * fy)
}

pseudocode! {
    TAKE_VIEWS: "take both views of frame t and of frame t + 1, rectified, with the calibration of the cameras",
    DISPARITY: "d(x, y) ← disparity in frame t",
    NEXT_DISPARITY: "d′(x, y) ← disparity in frame t + 1",
    FLOW: "(u, v) ← optical flow of the left view from frame t to frame t + 1",
    TRIANGULATE: "for each pixel: P from (x, y, d(x, y)), P′ from (x + u, y + v, d′(x + u, y + v)); scene flow V ← P′ − P",
    SKIP: "  where a disparity or the flow is not known: no scene flow",
    SAMPLE: "draw 3 pixels: R, t ← arg min Σ reprojection error of R P + t in frame t + 1, by Gauss–Newton steps",
    REFIT: "R, t ← the same over all inliers of the best sample; again while the cost falls",
    OWN: "for each pixel: r ← P′ − (R P + t), with covariance Σ; it has a motion of its own if its squared Mahalanobis distance > gate",
    OPEN: "remove groups of such pixels smaller than the square of the opening",
}

impl Estimator for SceneFlow {
    const INFO: Info = Info {
        id: "scene-flow",
        name: "Scene flow",
        family: "Stereo",
        summary: "Positions and displacements of pixels in space from disparities and optical flow, without the motion of the cameras.",
        source: "S. Vedula, S. Baker, P. Rander, R. Collins and T. Kanade, Three-dimensional scene flow, ICCV 1999; A. Wedel, T. Brox, T. Vaudrey, \
                 C. Rabe, U. Franke and D. Cremers, Stereoscopic scene flow computation for 3D motion understanding, International Journal \
                 of Computer Vision 95, 2011; motion of the cameras: A. Geiger, J. Ziegler and C. Stiller, StereoScan, IEEE Intelligent \
                 Vehicles Symposium 2011",
        pseudocode: line::ALL,
        granularities: &["frame", "stage", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::choice(
            "own",
            "Does the next pixel have a motion of its own?",
            &[
                Reply::told(line::OWN, case::OWN_MOTION, "Yes: the residual exceeds the gate"),
                Reply::told(line::OWN, case::AT_REST, "No: the motion of the cameras explains it"),
            ],
        ),
        Question::value("inliers", "How many points agree with the next sample?", line::SAMPLE, value::INLIERS),
    ];
    const GUARANTEE: Guarantee = Guarantee::SceneFlow;
    const CHARTS: &'static [Chart] = &[Chart::Cloud, Chart::Matrices, Chart::Series];
    const PRODUCES: &'static [&'static ProductKind] = &[SceneFlowField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        let [left, _] = clip.pair(frame)?;
        let depths = match (clip.has_depths(), clip.right()) {
            (true, _) => Depths::Sensor,
            (_, Some(_)) => Depths::Stereo,
            (_, None) => Depths::Unknown,
        };
        if depths == Depths::Stereo {
            clip.frame_from(Viewpoint::Right, frame + 1)?;
        }
        if self.source == Source::Truth {
            self.check_truth(clip, frame, depths)?;
        }
        let calibration = clip.calibration().filter(|_| depths != Depths::Unknown).copied();
        let (width, height) = left.size();
        let unknown = (
            Arc::new(Disparity(Grid::new(width, height, Disparity::UNKNOWN))),
            Arc::new(Flow(Grid::new(width, height, Flow::UNKNOWN))),
        );
        let fixed = Fixed { frame, left, depths, calibration, unknown };
        Ok(State {
            fixed: Arc::new(fixed),
            done: 0,
            disparity: None,
            next: None,
            flow: None,
            followed: None,
            points: Arc::default(),
            consensus: None,
            moving: None,
        })
    }

    fn advance(&self, clip: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        self.work((clip, &Threads::single()), state, observer)
    }

    fn units(&self, state: &State) -> Option<usize> {
        Some(self.parts(&state.fixed).len())
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        vec![Granularity { index: 0, of: Some(1) }, Granularity { index: state.done, of: self.units(state) }]
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        let is_better = |draw: &Draw| draw.fit.is_some() && draw.fit == draw.best;
        matches!(event, Event::Draw(draw) if is_better(draw)).then_some(Role::Best)
    }

    fn stage(&self, event: &Event) -> Option<Name> {
        Some(match event {
            Event::Whole(Part::Disparity) => line::DISPARITY,
            Event::Whole(Part::NextDisparity) => line::NEXT_DISPARITY,
            Event::Whole(_) => line::FLOW,
            Event::Row(Part::Positions, _) => line::TRIANGULATE,
            Event::Row(..) => line::OWN,
            Event::Opened(_) => line::OPEN,
            Event::Draw(draw) if draw.sample.is_none() => line::REFIT,
            Event::Draw(_) | Event::NoEgo => line::SAMPLE,
        })
    }

    fn pointed(&self) -> Option<&dyn Pointed<State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.draw_step(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        Output::of(self.field(state))
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads, tally: &impl Tally<Event>) -> Result<State, Error> {
        run_counted(self, (clip, frame), tally, |state, counter| self.work((clip, threads), state, counter))
    }
}

impl Footprint<State> for SceneFlow {
    fn need(&self, clip: &Clip) -> Need {
        let stages = [self.disparity.need(clip).run, self.flow.need(clip).run];
        let most = stages.into_iter().max().unwrap_or_default() as f64;
        Need::per_pixel(clip, [60.0, 120.0]).and([most, most])
    }

    fn state_bytes(&self, state: &State) -> usize {
        let maps = [&state.disparity, &state.next, &state.followed].into_iter().flatten();
        let maps: usize = maps.map(|map| size_of_val(map.0.cells())).sum();
        let flow = state.flow.as_ref().map_or(0, |flow| size_of_val(flow.0.cells()));
        let mask = state.moving.as_ref().map_or(0, |mask| mask.bytes());
        size_of::<State>() + maps + flow + mask + size_of_val(&state.points[..])
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let (unknown, still) = &state.fixed.unknown;
        let maps = size_of_val(unknown.0.cells()) + size_of_val(still.0.cells());
        self.state_bytes(state) + size_of::<Fixed>() + maps
    }
}

impl Pointed<State> for SceneFlow {
    fn takes(&self, picture: Picture) -> bool {
        picture == Picture::CURRENT
    }

    fn explained(&self, state: &State, Focus { at, .. }: Focus) -> Option<Explained> {
        state.fixed.left.luma().cell_at(at).map(|_| Explained::Always)
    }
}
