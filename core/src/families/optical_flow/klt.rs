//! The Kanade–Lucas–Tomasi tracker: detection, tracking through the clip, validation and replacement of features.

mod explain;
mod vocabulary;

use std::sync::Arc;

use crate::base::{Error, Mapped, Observer, Tally, Threads};
use crate::data::{Clip, Flow, Frame};
use crate::methods::{
    differential::truth,
    features::{
        affine::{Fit, FitFailure, IDENTITY, SAME_LIGHT, Start, View},
        follow::{self, Follow},
        level_trace::case as tracking,
        spread,
        tracker::Level,
    },
};
use crate::products::{Feature, Output, PointField, Product, ProductKind, Status, Track, TrackField};
use crate::run::{
    Estimator, Footprint, Granularity, Guarantee, Info, Keypoints, Need, Pointed, Progress, Seen, Span, Stage, need,
};
use crate::scene::{Chart, Focus, Question, Reply, Role, Scene, Step};
use crate::{params, pseudocode};

params! {
    /// The Kanade–Lucas–Tomasi (KLT) tracker.
    pub struct Klt {
        /// Number of frames, including the first; fewer at the end of the clip.
        frames: usize = 30, 2..=10_000;
        /// Detector of the keypoints that become features.
        detector: Stage<Keypoints> = Stage::named("shi-tomasi");
        /// Largest number of features tracked at once.
        max_points: usize = 200, 1..=5000;
        /// Smallest distance of a new feature to all others.
        min_distance: usize = 7, 0..=100, "px";
        /// Detect new features in each frame to replace lost ones.
        replenish: bool = true;
        /// Side of the window around each feature, on every level; an even side is rounded up. Larger windows are more robust but mix different motions.
        window: usize = 15, 3..=31, "px";
        /// Number of pyramid levels including full resolution, each half the size of the one below, down to 16 px per side. More levels reach larger motion.
        levels: usize = 4, 1..=8;
        /// Largest number of iterations per level.
        iterations: usize = 30, 1..=100;
        /// Stopping criterion: the iterations of a level end with an increment shorter than this, in px of the level.
        epsilon: f32 = 0.01, 0.0..=1.0, "px";
        /// Smallest accepted eigenvalue λ₂ of the window's structure tensor, in (gray levels per px)². Features below it are ill-conditioned and lost.
        min_eigenvalue: f32 = 0.5, 0.0..=100.0;
        /// Largest accepted mean absolute difference between the windows of consecutive frames, in gray levels. Features above it are lost.
        max_residual: f32 = 20.0, 0.0..=255.0;
        /// Largest accepted forward–backward error: distance between a feature and its position after tracking forward and back. 0
        /// disables the check.
        max_fb_error: f32 = 1.0, 0.0..=100.0, "px";
        /// Largest accepted dissimilarity from the first view after an affine fit (Shi–Tomasi), a mean absolute difference in gray levels. 0 disables the check.
        max_dissimilarity: f32 = 12.0, 0.0..=255.0;
        /// Correlation with the first view at and above which a feature is kept, although its dissimilarity is above the limit or its affine fit
        /// diverges: limbs and cloth deform otherwise than by an affine map. 1 keeps none of these. Used with illumination only.
        min_correlation: f32 = 0.5, 0.0..=1.0;
        /// Fit gain and offset of the gray values as well, so that changes in illumination do not count as dissimilarity.
        illumination: bool = true;
    }
    advanced { "iterations", "epsilon", "max-residual", "max-fb-error", "max-dissimilarity", "min-correlation", "illumination" }
    when {
        "illumination": |p| p.max_dissimilarity > 0.0, "Illumination has no effect without the dissimilarity check.";
        "min-correlation": |p| p.max_dissimilarity > 0.0, "The correlation has no effect without the dissimilarity check.";
        "min-correlation": |p| p.illumination, "The correlation has no effect where illumination must not change: it does not depend on gain and offset.";
    }
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    span: Span,
    /// The first frame of the current pair.
    frame: usize,
    /// The current feature, an index of `live`; `None` during detection.
    turn: Option<usize>,
    /// Number of units before this pair.
    begun: usize,
    /// All tracks, in order of their start.
    tracks: Vec<Arc<Track>>,
    /// The features in the first frame of the pair.
    live: Vec<Live>,
    /// The features tracked to the second frame so far.
    next: Vec<Live>,
    /// Number of features at the start of each earlier pair.
    counts: Arc<Vec<u32>>,
    /// Width and height of the frame in px.
    picture: (usize, usize),
    /// Size of one pyramid in memory, in bytes.
    pyramid_bytes: usize,
    /// Recomputed on demand: both frames, and the pyramid of the first.
    pair: Option<Arc<Pair>>,
    pyramid: Option<Arc<Vec<Level>>>,
}

/// A live feature.
#[derive(Clone)]
struct Live {
    track: u32,
    /// Its position in px.
    at: [f32; 2],
    /// Its first view, with the affine map into the current frame.
    view: Arc<View>,
    matrix: [[f32; 2]; 2],
    light: [f32; 2],
}

impl Live {
    /// Returns the correlation of its window in `next` at `at` with its first view as it was deformed last; `None` where it is undefined.
    fn correlation(&self, next: &Level, at: [f32; 2]) -> Option<f32> {
        let fit = Fit { matrix: self.matrix, shift: [0.0; 2], light: SAME_LIGHT, difference: 0.0, share: 1.0 };
        self.view.correlation(&self.view.warped(next, at, &fit))
    }

    /// Returns the feature with an updated affine fit.
    fn seen_as(self, fit: &Fit) -> Self {
        Self { matrix: fit.matrix, light: fit.light, ..self }
    }
}

/// The pyramids of a pair of frames.
pub struct Pair {
    pyramids: [Arc<Vec<Level>>; 2],
    truth: Option<Arc<Flow>>,
}

impl Pair {
    fn pyramids(&self) -> [&[Level]; 2] {
        self.pyramids.each_ref().map(|levels| levels.as_slice())
    }
}

/// The keypoints of a frame, and the new features among them.
pub struct Found {
    keypoints: PointField,
    taken: Vec<[f32; 2]>,
}

/// A feature that was tracked back.
#[derive(Clone, Copy)]
pub struct Returned {
    /// The position in px.
    at: [f32; 2],
    /// The forward–backward error in px.
    off_px: f32,
    /// Whether that is above the maximum.
    is_above: bool,
}

/// An event of a unit: detection, or the tracking of one feature to the next frame.
#[derive(Clone)]
pub enum Event {
    /// No detection: max-points is reached, or replenish is off.
    Enough,
    /// The keypoints of the detector.
    Found(Arc<Found>),
    /// The new features among them.
    Taken(Arc<Found>),
    /// A step of forward tracking, on this level.
    Forward(Arc<Pair>, usize, follow::Event),
    /// The result of tracking back, or why it failed.
    Back(Result<Returned, Status>),
    /// An iteration of the affine fit.
    Fit(Fit),
    /// The correlation with the first view, where the fit does not explain the window, and whether it suffices; `None` where it is undefined.
    Correlated(Option<(f32, bool)>),
    /// The result of the feature.
    Verdict(Feature),
}

impl Klt {
    fn follow(&self) -> Follow {
        let Self { window, iterations, epsilon, min_eigenvalue, max_residual, .. } = *self;
        Follow { reach: window / 2, iterations, epsilon, threshold: min_eigenvalue, max_residual }
    }

    /// Returns the current pair; the pyramid of its first frame is reused from the previous pair.
    fn pair(&self, clip: &Clip, state: &mut State) -> Result<Arc<Pair>, Error> {
        if let Some(pair) = &state.pair {
            return Ok(Arc::clone(pair));
        }
        need::check_kept(clip, self.state_bytes(state))?;
        let frames = clip.pair(state.frame)?;
        let pyramid = |frame: &Frame| Arc::new(Level::pyramid(frame.luma(), self.levels, self.window / 2));
        let pyramids = [state.pyramid.take().unwrap_or_else(|| pyramid(&frames[0])), pyramid(&frames[1])];
        state.pyramid_bytes = pyramids[0].iter().map(Level::bytes).sum();
        let pair = Arc::new(Pair { pyramids, truth: truth(clip, state.frame) });
        state.pair = Some(Arc::clone(&pair));
        Ok(pair)
    }

    /// Detects features in the first frame of the pair, if fewer than max-points are tracked.
    fn detect(&self, clip: &Clip, state: &State, threads: &Threads) -> Result<Option<Found>, Error> {
        let room = self.max_points.saturating_sub(state.live.len());
        if room == 0 || (state.frame > state.span.first && !self.replenish) {
            return Ok(None);
        }
        let keypoints = self.detector.points(clip, state.frame, threads)?;
        let taken = spread(&keypoints, state.live.iter().map(|live| live.at), (self.min_distance, room));
        Ok(Some(Found { keypoints, taken }))
    }

    /// Starts tracks at new features.
    fn begin(&self, state: &mut State, pair: &Pair, found: &[[f32; 2]]) {
        for at in found.iter().copied() {
            let track = state.tracks.len() as u32;
            let view = Arc::new(View::new(&pair.pyramids[0][0], at, self.window / 2));
            state.live.push(Live { track, at, view, matrix: IDENTITY, light: SAME_LIGHT });
            state.tracks.push(Arc::new(Track::begin(state.frame, at)));
        }
        state.turn = Some(0);
    }

    /// Tracks a feature to the second frame of the pair, with all checks.
    fn track(&self, pair: &Arc<Pair>, live: &Live, observer: &mut impl Observer<Event>) -> (Feature, Live) {
        let (displacement, result) = self.moved(pair, live, observer);
        let to = [0, 1].map(|i| live.at[i] + displacement[i]);
        let checked = result.and_then(|residual| Ok((residual, self.changed(pair, (live, to), observer)?)));
        let (result, next) = match checked {
            Ok((residual, next)) => (Ok(residual), next),
            Err(status) => (Err(status), live.clone()),
        };
        let feature = Feature::tracked(live.at, result.map(|residual| (displacement, residual)));
        observer.see(|| Event::Verdict(feature));
        (feature, next)
    }

    /// Tracks a feature forward, and back for the forward–backward check.
    fn moved(
        &self,
        pair: &Arc<Pair>,
        live: &Live,
        observer: &mut impl Observer<Event>,
    ) -> ([f32; 2], Result<f32, Status>) {
        let [first, second] = pair.pyramids();
        let mut forward =
            Mapped { observer: &mut *observer, map: |(level, event)| Event::Forward(Arc::clone(pair), level, event) };
        let (displacement, result) = self.follow().through([first, second], live.at, &mut forward);
        if result.is_err() || self.max_fb_error == 0.0 {
            return (displacement, result);
        }
        let to = [0, 1].map(|i| live.at[i] + displacement[i]);
        let (back, returned) = self.follow().through([second, first], to, &mut ());
        let place = [0, 1].map(|i| to[i] + back[i]);
        let off_px = (place[0] - live.at[0]).hypot(place[1] - live.at[1]);
        let is_above = off_px > self.max_fb_error;
        observer.see(|| Event::Back(returned.map(|_| Returned { at: place, off_px, is_above })));
        (displacement, if returned.is_err() || is_above { Err(Status::Astray) } else { result })
    }

    /// Fits the first view at the tracked position; an error if the dissimilarity is too large and the window does not resemble the view.
    fn changed(
        &self,
        pair: &Pair,
        (live, to): (&Live, [f32; 2]),
        observer: &mut impl Observer<Event>,
    ) -> Result<Live, Status> {
        let next = Live { at: to, ..live.clone() };
        if self.max_dissimilarity == 0.0 {
            return Ok(next);
        }
        let start = Start { matrix: live.matrix, light: self.illumination.then_some(live.light) };
        let level = &pair.pyramids[1][0];
        let kept = match live.view.fit(level, to, start, &mut Mapped { observer: &mut *observer, map: Event::Fit }) {
            // Near the border too little of the view is visible.
            Err(FitFailure::Undetermined) => return Ok(next),
            Ok(fit) if fit.difference <= self.max_dissimilarity => return Ok(next.seen_as(&fit)),
            Ok(fit) => next.seen_as(&fit),
            Err(FitFailure::Diverged) => next,
        };
        if !self.illumination {
            return Err(Status::Changed);
        }
        let correlation =
            live.correlation(level, to).map(|correlation| (correlation, correlation >= self.min_correlation));
        observer.see(|| Event::Correlated(correlation));
        if correlation.is_some_and(|(_, resembles)| resembles) { Ok(kept) } else { Err(Status::Changed) }
    }

    /// Stores the result of the current feature.
    fn note(state: &mut State, (feature, next): (Feature, Live)) {
        let is_tracked = feature.displacement.is_some();
        Arc::make_mut(&mut state.tracks[next.track as usize]).record(feature, is_tracked.then_some(next.at));
        if is_tracked {
            state.next.push(next);
        }
    }

    /// Moves on to the next pair after the last feature.
    fn go_on(&self, clip: &Clip, state: &mut State) -> Progress {
        if state.turn.is_none_or(|turn| turn < state.live.len()) {
            return Progress::More;
        }
        Arc::make_mut(&mut state.counts).push(state.next.len() as u32);
        state.begun += 1 + state.live.len();
        state.live = std::mem::take(&mut state.next);
        state.pyramid = state.pair.take().map(|pair| Arc::clone(&pair.pyramids[1]));
        (state.frame, state.turn) = (state.frame + 1, None);
        // A pair needs a next frame.
        let is_over = state.span.is_over(clip, state.frame + 1);
        if is_over { Progress::Done } else { Progress::More }
    }
}

pseudocode! {
    EACH_FRAME: "for each pair of frames t, t+1",
    DETECT: "  if fewer than max-points features: K ← keypoints of frame t, by the detector",
    TAKE_STRONGEST: "    add the strongest of K at min-distance from all features; store the first view of each",
    EACH_FEATURE: "  for each feature x",
    TRACK: "    d ← displacement to frame t+1, by pyramidal Lucas–Kanade",
    TRACK_BACK: "    b ← displacement back to frame t; lost if |d + b| > max-fb-error",
    FIT_FIRST_VIEW: "    (A, s, λ, δ) ← affine fit of the first view to frame t+1, with gain and offset",
    CORRELATE: "    dissimilarity > max-dissimilarity, or no fit: ρ ← correlation of the window with the first view",
    IS_CHANGED: "    lost if ρ < min-correlation",
    MOVE: "    else x ← x + d",
}

impl Estimator for Klt {
    const INFO: Info = Info {
        id: "klt",
        name: "KLT tracker",
        family: "Optical flow",
        summary: "Detects features, tracks them through the clip, validates each track, and replaces lost ones.",
        source: "C. Tomasi and T. Kanade, Detection and tracking of point features, CMU-CS-91-132, 1991; J. Shi and C. Tomasi, \
                 Good features to track, CVPR 1994; tracking: J.-Y. Bouguet, Intel Corporation, 2000; forward–backward check: Z. Kalal, \
                 K. Mikolajczyk and J. Matas, Forward-backward error, ICPR 2010; illumination: H. Jin, P. Favaro and S. Soatto, \
                 Real-time feature tracking and outlier rejection with changes in illumination, ICCV 2001",
        pseudocode: line::ALL,
        granularities: &["clip", "pair", "feature", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[Question::choice(
        "kept",
        "What becomes of the next feature?",
        &[
            Reply::at(line::MOVE, "It passes all checks"),
            Reply::told(line::TRACK, tracking::LOST, "It leaves the frame"),
            Reply::told(line::TRACK_BACK, tracking::LOST, "Tracking back ends elsewhere"),
            Reply::at(line::IS_CHANGED, "It no longer looks like its first view"),
        ],
    )];
    const GUARANTEE: Guarantee = Guarantee::Features { off_centi_px: 2 };
    const CHARTS: &'static [Chart] = &[Chart::Plane, Chart::Tiles, Chart::Series];
    const PRODUCES: &'static [&'static ProductKind] = &[TrackField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        Ok(State {
            span: Span::new(clip, frame, self.frames)?,
            frame,
            turn: None,
            begun: 0,
            tracks: Vec::new(),
            live: Vec::new(),
            next: Vec::new(),
            counts: Arc::default(),
            picture: clip.size(),
            pyramid_bytes: 0,
            pair: None,
            pyramid: None,
        })
    }

    fn advance(&self, clip: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let pair = self.pair(clip, state)?;
        match state.turn {
            None => {
                let found = self.detect(clip, state, &Threads::single())?.map(Arc::new);
                match &found {
                    None => observer.see(|| Event::Enough),
                    Some(found) => {
                        observer.see(|| Event::Found(Arc::clone(found)));
                        observer.see(|| Event::Taken(Arc::clone(found)));
                    }
                }
                self.begin(state, &pair, found.as_ref().map_or(&[], |found| &found.taken));
            }
            Some(turn) => {
                let live = state.live[turn].clone();
                let became = self.track(&pair, &live, observer);
                Self::note(state, became);
                state.turn = Some(turn + 1);
            }
        }
        Ok(self.go_on(clip, state))
    }

    fn units(&self, _: &State) -> Option<usize> {
        None
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        // Detection counts with the first feature.
        let feature = Granularity { index: state.turn.unwrap_or(0), of: state.turn.map(|_| state.live.len()) };
        [state.span.place_of_pair(state.frame), vec![feature]].concat()
    }

    fn at_frame(&self, state: &State) -> Option<usize> {
        Some(state.frame)
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        match event {
            Event::Verdict(Feature { displacement: None, .. }) => Some(Role::Rejected),
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
        let mut state = self.start(clip, frame)?;
        loop {
            clip.wanted()?;
            let pair = self.pair(clip, &mut state)?;
            let found = self.detect(clip, &state, threads)?.map(Arc::new);
            // As `advance` reports it.
            tally.add_events(if found.is_some() { 2 } else { 1 });
            self.begin(&mut state, &pair, found.as_ref().map_or(&[], |found| &found.taken));
            let live = std::mem::take(&mut state.live);
            tally.add_units(1 + live.len());
            let track = |i: usize| self.track(&pair, &live[i], &mut tally.counter());
            let became = threads.map_while(live.len(), || clip.wanted(), track)?;
            became.into_iter().for_each(|became| Self::note(&mut state, became));
            (state.turn, state.live) = (Some(live.len()), live);
            if self.go_on(clip, &mut state) == Progress::Done {
                return Ok(state);
            }
        }
    }
}

impl Footprint<State> for Klt {
    fn need(&self, clip: &Clip) -> Need {
        // The first view of each feature, its derivatives, and its track.
        let points = self.max_points as f64 * (20.0 * (self.window * self.window) as f64 + 1000.0);
        let Need { run, .. } = self.detector.need(clip);
        Need::per_pixel(clip, [14.0, 20.0]).and([points, 4.0 * points]).and([run as f64; 2])
    }

    fn at_rest(&self, state: &State) -> State {
        State { pair: None, pyramid: None, ..state.clone() }
    }

    fn state_bytes(&self, state: &State) -> usize {
        let tracks: usize = state.tracks.iter().map(|track| track.bytes()).sum();
        let views: usize = state.live.iter().map(|live| size_of::<Live>() + live.view.bytes()).sum();
        size_of::<State>() + tracks + views + size_of_val(&state.next[..]) + size_of_val(&state.counts[..])
    }

    fn memory_bytes(&self, state: &State) -> usize {
        self.state_bytes(state) + 2 * state.pyramid_bytes
    }
}

impl Pointed<State> for Klt {
    /// Returns the unit that tracks the feature of this pair nearest to a position.
    fn unit_at(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<usize> {
        state.turn?;
        let far = |live: &Live| (live.at[0] - point[0]).hypot(live.at[1] - point[1]);
        let nearest = state.live.iter().enumerate().min_by(|(_, a), (_, b)| far(a).total_cmp(&far(b)));
        nearest.map(|(index, _)| state.begun + 1 + index)
    }
}
