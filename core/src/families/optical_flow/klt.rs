//! The Kanade-Lucas-Tomasi tracker: features are found, followed through the clip, checked and replaced.

mod explain;

use std::sync::Arc;

use crate::base::{Error, Mapped, Observer, Threads};
use crate::data::{Clip, Flow, Frame};
use crate::methods::{
    differential::truth,
    features::{
        affine::{Fit, IDENTITY, SAME_LIGHT, Start, Unfit, View},
        follow::{self, Follow},
        spread,
        tracker::Level,
    },
};
use crate::products::{Feature, Output, PointField, Product, ProductKind, Status, Track, TrackField};
use crate::run::{
    Estimator, Footprint, Granularity, Guarantee, Info, Keypoints, Need, Pointed, Progress, Seen, Span, Stage, need,
};
use crate::scene::{Chart, Focus, Role, Scene, Step};
use crate::{params, pseudocode};

params! {
    /// The Kanade–Lucas–Tomasi tracker.
    pub struct Klt {
        /// At most so many frames are tracked through, the first one counted; fewer where the clip ends.
        frames: usize = 30, 2..=10_000;
        /// Detector of the keypoints that become features. It gives all that it finds, and the tracker chooses.
        detector: Stage<Keypoints> = Stage::named("shi-tomasi");
        /// At most so many features are tracked at once.
        max_points: usize = 200, 1..=5000;
        /// From one feature to the next it is at least this far where a feature begins.
        min_distance: usize = 7, 0..=100, "px";
        /// Look for new features in each frame, in place of those that were lost.
        replenish: bool = true;
        /// Side of the window around each feature, on every level; an even one reaches as far as the next odd one.
        window: usize = 15, 3..=31, "px";
        /// Levels of the pyramid with the picture itself, each half as wide and high; fewer where a side would be less than 16 px.
        levels: usize = 4, 1..=8;
        /// At most so many updates of a displacement on each level.
        iterations: usize = 30, 1..=100;
        /// An update shorter than this, in px of its level, is the last there.
        epsilon: f32 = 0.01, 0.0..=1.0, "px";
        /// A feature is lost where the smaller eigenvalue of its window's tensor, in (gray levels per px)² for a pixel, is less.
        threshold: f32 = 0.5, 0.0..=100.0;
        /// A feature is lost where its window differs by more than this on average from that in the frame before, in gray levels.
        max_residual: f32 = 20.0, 0.0..=255.0;
        /// A feature is lost where tracking it back leads farther than this from where it came from; 0 leaves the check out.
        max_return: f32 = 1.0, 0.0..=100.0, "px";
        /// A feature is lost where it differs by more than this on average from its first view, turned and stretched to fit, in gray levels; 0 leaves the check out.
        max_change: f32 = 12.0, 0.0..=255.0;
        /// Let the light of that first view fit as well: a gain and an offset of its gray values.
        any_light: bool = true;
    }
    renamed { "quality" => "detector.threshold" }
    advanced { "iterations", "epsilon", "max-residual", "max-return", "max-change", "any-light" }
    when {
        "any-light": |p| p.max_change > 0.0,
            "Gain and offset have no effect without the check against the first view.";
    }
}

/// What a run reads and writes.
#[derive(Clone)]
pub struct State {
    span: Span,
    /// The first frame of the pair at hand.
    frame: usize,
    /// The feature whose turn it is, an index of `live`; `None` while features are looked for.
    turn: Option<usize>,
    /// The units that were done before this pair.
    begun: usize,
    /// All tracks, in the order in which they began.
    tracks: Vec<Arc<Track>>,
    /// The features in the first frame of the pair.
    live: Vec<Live>,
    /// Those that were found again in the second by now.
    next: Vec<Live>,
    /// How many features each pair before this one began with.
    counts: Arc<Vec<u32>>,
    /// Width and height of the picture in px.
    picture: (usize, usize),
    /// Memory of one pyramid.
    pyramid_bytes: usize,
    /// What is made again where it is missing: both frames, and before that the pyramid of the first.
    pair: Option<Arc<Pair>>,
    pyramid: Option<Arc<Vec<Level>>>,
}

/// A feature that is not lost.
#[derive(Clone)]
struct Live {
    track: u32,
    /// Its place in px.
    at: [f32; 2],
    /// What it looked like at first, and how that lies now.
    view: Arc<View>,
    matrix: [[f32; 2]; 2],
    light: [f32; 2],
}

impl Live {
    /// The same where the fit of its first view has come to.
    fn seen_as(self, fit: &Fit) -> Self {
        Self { matrix: fit.matrix, light: fit.light, ..self }
    }
}

/// Two frames and their pyramids.
pub struct Pair {
    pyramids: [Arc<Vec<Level>>; 2],
    truth: Option<Arc<Flow>>,
}

impl Pair {
    fn pyramids(&self) -> [&[Level]; 2] {
        self.pyramids.each_ref().map(|levels| levels.as_slice())
    }
}

/// What the detector finds in a frame, and what is taken of it.
pub struct Found {
    keypoints: PointField,
    taken: Vec<[f32; 2]>,
}

/// What happens inside a unit: features are looked for, or one is tracked to the next frame.
#[derive(Clone)]
pub enum Event {
    /// There are features enough.
    Enough,
    /// The detector has found keypoints.
    Found(Arc<Found>),
    /// Some of them are taken.
    Taken(Arc<Found>),
    /// A step of following the feature between two frames, on this level.
    Forward(Arc<Pair>, usize, follow::Event),
    /// Where tracking back from there leads to, or why it does not.
    Back(Result<[f32; 2], Status>),
    /// A step of fitting the first view.
    Fit(Fit),
    /// What has become of the feature.
    Verdict(Feature),
}

impl Klt {
    fn follow(&self) -> Follow {
        let Self { window, iterations, epsilon, threshold, max_residual, .. } = *self;
        Follow { reach: window / 2, iterations, epsilon, threshold, max_residual }
    }

    /// The frames at hand; the pyramid of the first is that of the second before.
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

    /// Looks for features in the first frame of the pair, if there is room for more.
    fn look(&self, clip: &Clip, state: &State, threads: &Threads) -> Result<Option<Found>, Error> {
        let room = self.max_points.saturating_sub(state.live.len());
        if room == 0 || (state.frame > state.span.first && !self.replenish) {
            return Ok(None);
        }
        let keypoints = self.detector.points(clip, state.frame, threads)?;
        let taken = spread(&keypoints, state.live.iter().map(|live| live.at), (self.min_distance, room));
        Ok(Some(Found { keypoints, taken }))
    }

    /// Begins the tracks of the features found.
    fn begin(&self, state: &mut State, pair: &Pair, found: &[[f32; 2]]) {
        for at in found.iter().copied() {
            let track = state.tracks.len() as u32;
            let view = Arc::new(View::new(&pair.pyramids[0][0], at, self.window / 2));
            state.live.push(Live { track, at, view, matrix: IDENTITY, light: SAME_LIGHT });
            let point = Feature { at, displacement: None, status: Status::Found, residual: None };
            state.tracks.push(Arc::new(Track { first: state.frame, points: vec![point] }));
        }
        state.turn = Some(0);
    }

    /// Tracks a feature to the second frame of the pair: what became of it, and how its first view is seen there.
    fn track(&self, pair: &Arc<Pair>, live: &Live, observer: &mut impl Observer<Event>) -> (Feature, Live) {
        let (displacement, result) = self.moved(pair, live, observer);
        let to = [0, 1].map(|i| live.at[i] + displacement[i]);
        let checked = result.and_then(|residual| Ok((residual, self.changed(pair, (live, to), observer)?)));
        let (result, next) = match checked {
            Ok((residual, next)) => (Ok(residual), next),
            Err(status) => (Err(status), live.clone()),
        };
        let feature = match result {
            Ok(residual) => Feature {
                at: live.at,
                displacement: Some(displacement),
                status: Status::Tracked,
                residual: Some(residual),
            },
            Err(status) => Feature { at: live.at, displacement: None, status, residual: None },
        };
        observer.see(|| Event::Verdict(feature));
        (feature, next)
    }

    /// Follows a feature, and back from where that leads to.
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
        if result.is_err() || self.max_return == 0.0 {
            return (displacement, result);
        }
        let to = [0, 1].map(|i| live.at[i] + displacement[i]);
        let (back, returned) = self.follow().through([second, first], to, &mut ());
        let place = [0, 1].map(|i| to[i] + back[i]);
        observer.see(|| Event::Back(returned.map(|_| place)));
        let off_px = (place[0] - live.at[0]).hypot(place[1] - live.at[1]);
        (displacement, if returned.is_err() || off_px > self.max_return { Err(Status::Astray) } else { result })
    }

    /// The feature at the place that it was tracked to, as its first view is seen there, unless it has changed too much.
    fn changed(
        &self,
        pair: &Pair,
        (live, to): (&Live, [f32; 2]),
        observer: &mut impl Observer<Event>,
    ) -> Result<Live, Status> {
        let next = Live { at: to, ..live.clone() };
        if self.max_change == 0.0 {
            return Ok(next);
        }
        let start = Start { matrix: live.matrix, light: self.any_light.then_some(live.light) };
        match live.view.fit(&pair.pyramids[1][0], to, start, &mut Mapped { observer, map: Event::Fit }) {
            // At the edge too little of it is left to tell.
            Err(Unfit::Unknown) => Ok(next),
            Err(Unfit::Astray) => Err(Status::Changed),
            Ok(fit) if fit.difference > self.max_change => Err(Status::Changed),
            Ok(fit) => Ok(next.seen_as(&fit)),
        }
    }

    /// Writes down what has become of the feature whose turn it was.
    fn note(state: &mut State, (feature, next): (Feature, Live)) {
        let track = Arc::make_mut(&mut state.tracks[next.track as usize]);
        if let Some(last) = track.points.last_mut() {
            *last = feature;
        }
        if feature.displacement.is_some() {
            track.points.push(Feature { at: next.at, displacement: None, status: Status::Found, residual: None });
            state.next.push(next);
        }
    }

    /// Goes on to the next pair if every feature had its turn.
    fn go_on(&self, clip: &Clip, state: &mut State) -> Progress {
        if state.turn.is_none_or(|turn| turn < state.live.len()) {
            return Progress::More;
        }
        let count = state.live.len();
        Arc::make_mut(&mut state.counts).push(count as u32);
        state.begun += 1 + count;
        state.live = std::mem::take(&mut state.next);
        state.pyramid = state.pair.take().map(|pair| Arc::clone(&pair.pyramids[1]));
        (state.frame, state.turn) = (state.frame + 1, None);
        // A pair has a frame to go on to.
        let is_over = state.span.is_over(clip, state.frame + 1);
        if is_over { Progress::Done } else { Progress::More }
    }
}

pseudocode! {
    EACH_FRAME: "for each frame t, up to the last but one",
    DETECT: "  if there is room: K ← keypoints of frame t, by the detector",
    TAKE_STRONGEST: "    take the strongest of K that keep their distance; remember how each looks",
    EACH_FEATURE: "  for each feature x",
    TRACK: "    d ← displacement to frame t+1, by pyramidal Lucas–Kanade",
    TRACK_BACK: "    b ← displacement back to frame t; lost if |d + b| > max-return",
    FIT_FIRST_VIEW: "    (A, s, λ, δ) ← how its first view lies in frame t+1, and in what light",
    IS_CHANGED: "    lost if that differs by more than max-change",
    MOVE: "    else x ← x + d",
}

impl Estimator for Klt {
    const INFO: Info = Info {
        id: "klt",
        name: "KLT tracker",
        family: "Optical flow",
        summary: "Finds features, tracks them from frame to frame, checks each, and finds new ones for those that are lost.",
        source: "C. Tomasi and T. Kanade, Detection and tracking of point features, CMU-CS-91-132, 1991; J. Shi and C. Tomasi, \
                 Good features to track, CVPR 1994; tracking: J.-Y. Bouguet, Intel Corporation, 2000; the way back: Z. Kalal, \
                 K. Mikolajczyk and J. Matas, Forward-backward error, ICPR 2010; other light: H. Jin, P. Favaro and S. Soatto, \
                 Real-time feature tracking and outlier rejection with changes in illumination, ICCV 2001",
        pseudocode: line::ALL,
        granularities: &["clip", "pair", "feature", "step"],
        frames: 2,
    };
    const GUARANTEE: Guarantee = Guarantee::Features { off_centi_px: 2 };
    const CHARTS: &'static [Chart] = &[Chart::Tiles, Chart::Series];
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
                let found = self.look(clip, state, &Threads::single())?.map(Arc::new);
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
        let pairs = state.span.frames().map(|frames| frames - 1);
        vec![
            Granularity { index: 0, of: Some(1) },
            Granularity { index: state.frame - state.span.first, of: pairs },
            // Looking for features counts with the first of them.
            Granularity { index: state.turn.unwrap_or(0), of: state.turn.map(|_| state.live.len()) },
        ]
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
        self.told(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.drawn(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        let (first, last) = (state.span.first, state.frame);
        Output::of(TrackField { picture: state.picture, first, last, tracks: state.tracks.clone() })
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let mut state = self.start(clip, frame)?;
        loop {
            clip.wanted()?;
            let pair = self.pair(clip, &mut state)?;
            let found = self.look(clip, &state, threads)?.map(Arc::new);
            self.begin(&mut state, &pair, found.as_ref().map_or(&[], |found| &found.taken));
            let live = std::mem::take(&mut state.live);
            let became = threads.map_while(live.len(), || clip.wanted(), |i| self.track(&pair, &live[i], &mut ()))?;
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
        // The first view of each point, its derivatives, and its track.
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
    /// The unit that tracks the feature of this pair that is nearest to a place.
    fn unit_at(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<usize> {
        state.turn?;
        let far = |live: &Live| (live.at[0] - point[0]).hypot(live.at[1] - point[1]);
        let nearest = state.live.iter().enumerate().min_by(|(_, a), (_, b)| far(a).total_cmp(&far(b)));
        nearest.map(|(index, _)| state.begun + 1 + index)
    }
}
