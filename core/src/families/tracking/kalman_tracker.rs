//! Many objects, each with a Kalman filter: in every frame detections are shared out among them.

mod explain;
mod share;

use std::sync::Arc;

use super::{is_far_outside, object_of};
use crate::base::{Error, Observer};
use crate::data::{Clip, Detection};
use crate::geometry::Bounds;
use crate::methods::{
    kalman::{Filter, Measurement, Model, MotionModel},
    multi_object::{
        Extent,
        course::{self, Course},
        lifecycle::{Age, Rules},
    },
};
use crate::products::{Object, ObjectField, ObjectFrame, Output, Product, ProductKind};
use crate::run::{Estimator, Footprint, Granularity, Guarantee, Info, Need, Progress, Seen};
use crate::scene::{Chart, Role, Scene, Step};
use crate::{choices, params, pseudocode};

pub use share::Costs;

choices! {
    /// How pairs of objects and detections are chosen.
    pub enum Association {
        /// The cheapest pair first, then the next.
        Nearest = "nearest" "Nearest first",
        /// As many pairs as can be at the least cost in all: the Hungarian method.
        Assignment = "assignment" "Assignment",
    }
}

choices! {
    /// What a pair costs.
    pub enum PairCost {
        /// The squared Mahalanobis distance from where the object is expected.
        Mahalanobis = "mahalanobis" "Mahalanobis distance",
        /// What the boxes do not have in common: 1 − intersection over union.
        Overlap = "overlap" "Overlap of boxes",
        /// The mean of both, each as a share of its limit.
        Both = "both" "Both",
    }
}

params! {
    /// Many objects, each with a Kalman filter.
    pub struct KalmanTracker {
        /// The frames of the run, and the source of the detections.
        given: course::Settings = course::Settings::default();
        /// How objects are thought to move.
        motion: MotionModel = MotionModel::Velocity;
        /// Standard deviation of what disturbs the motion, in px/frame² for each px of the height that the object has by then.
        process_noise: f32 = 0.02, 0.0..=2.0;
        /// Standard deviation of what disturbs the rate of a coordinated turn.
        turn_noise: f32 = 0.5, 0.0..=45.0, "°/frame²";
        /// Standard deviation of a measured place along each axis, as a share of the height of its box.
        measurement_noise: f32 = 0.1, 0.001..=2.0;
        /// How pairs of objects and detections are chosen.
        association: Association = Association::Assignment;
        /// What a pair costs.
        cost: PairCost = PairCost::Both;
        /// A pair is allowed if the detection lies where this share of all measurements of the object would lie.
        gate: f32 = 0.999, 0.5..=0.9999;
        /// A pair is allowed if both boxes have at least this in common, as intersection over union; with 0 they need only overlap.
        min_overlap: f32 = 0.2, 0.0..=0.95;
        /// Confirmed tracks choose first, tentative ones from what is left; otherwise all at once, as in SORT.
        in_turns: bool = true;
        /// Detections beside the clip with at least this score are surely objects: these are shared out first, and only these begin new ones. Those with less only go on with objects that were seen in the frame before, as in ByteTrack.
        sure_score: f32 = 0.6, -1000.0..=1000.0;
        /// An object for which nothing is left where it is expected may take what overlaps the box in which it was last seen: it may have stopped while it was hidden (OC-SORT).
        recover: bool = true;
        /// When a track is confirmed, and when it is deleted.
        rules: Rules = Rules::default();
    }
    advanced { "in-turns", "sure-score", "recover" }
    when {
        "turn-noise": |p| p.motion == MotionModel::Turn,
            "Turn noise has no effect unless the motion is a coordinated turn.";
        "gate": |p| p.cost != PairCost::Overlap,
            "The gate has no effect where the cost is the overlap of boxes alone.";
        "sure-score": |p| p.given.may_have_scores(),
            "The score threshold has no effect on detections without scores.";
    }
}

/// What a run reads and writes.
#[derive(Clone)]
pub struct State {
    course: Course,
    tracks: Vec<Track>,
}

/// An object that is followed.
#[derive(Clone, Debug)]
pub struct Track {
    id: u32,
    filter: Filter,
    extent: Extent,
    /// The box in which it was last seen.
    last: Bounds,
    age: Age,
}

/// What happens in a frame.
#[derive(Clone, Debug)]
pub enum Event {
    /// What was detected, and how much of it is left out.
    Looked(Arc<Vec<Detection>>, usize),
    /// All objects go on by a time step.
    Predicted(Arc<Vec<Track>>),
    /// What each pair would cost; infinite where it is not allowed.
    Costs(Arc<Costs>),
    /// A pair was chosen.
    Paired(Arc<Costs>, [usize; 2]),
    /// An object moves to its detection: before and after.
    Updated(Box<[Track; 2]>, Measurement),
    /// An object was not seen.
    Missed(Box<Track>),
    /// An object is given up.
    Ended(Box<Track>),
    /// An unassigned detection begins a track.
    Begun(Box<Track>),
    /// The frame is over.
    Done(Arc<ObjectFrame>),
}

impl Track {
    /// Its box, around the estimated place.
    fn bounds(&self) -> Bounds {
        self.extent.around(self.filter.place())
    }

    fn object(&self, detection: Option<usize>) -> Object {
        Object { detection, ..object_of(&self.filter, self.id, self.bounds(), self.age.life) }
    }
}

impl KalmanTracker {
    fn measurement(&self, detection: &Detection) -> Measurement {
        let height_px = f64::from(detection.bounds.size()[1]).max(1.0);
        let place_deviation = f64::from(self.measurement_noise) * height_px;
        Measurement { place: detection.center.map(f64::from), place_deviation, velocity: None }
    }

    /// An object moves to its detection.
    fn updated(&self, track: &Track, detection: &Detection) -> Track {
        let measurement = self.measurement(detection);
        let filter = track.filter.updated(&measurement).map_or(track.filter, |(filter, _)| filter);
        let extent = track.extent.towards(detection);
        Track { filter, extent, last: detection.bounds, age: self.rules.seen(track.age), id: track.id }
    }

    fn begun(&self, detection: &Detection, id: u32) -> Track {
        let extent = Extent::of(detection);
        // In a frame hardly anything goes as far as half its height.
        let speed = extent.height_px() / 4.0;
        let filter = Filter::begun(self.model(&extent), &self.measurement(detection), speed);
        Track { id, filter, extent, last: detection.bounds, age: self.rules.begun() }
    }

    /// How something of this size is thought to move.
    fn model(&self, extent: &Extent) -> Model {
        self.motion.model(self.process_noise * extent.height_px() as f32, self.turn_noise)
    }

    /// What becomes of an object that was not seen in a picture of this size; `None` where it is given up.
    fn missed(&self, track: &Track, picture: (usize, usize)) -> Option<Track> {
        let age = self.rules.missed(track.age).filter(|_| !is_far_outside(track.filter.place(), picture))?;
        Some(Track { age, ..track.clone() })
    }
}

pseudocode! {
    EACH_FRAME: "for each frame t",
    DETECT: "  detect objects",
    PREDICT: "  predict every track: x ← F x, P ← F P F^T + Q",
    COMPUTE_COSTS: "  cost of each pair: Mahalanobis distance, overlap, or both; ∞ outside the gate",
    ASSIGN: "  choose pairs: confirmed tracks first, less sure detections and last boxes with what is left",
    UPDATE_TRACK: "  for each pair: update the track",
    EACH_UNSEEN_TRACK: "  for each track without a detection",
    COAST_OR_END: "    coast, or end if it was not seen for too long",
    EACH_LEFT_DETECTION: "  for each sure detection without a track",
    BEGIN_TRACK: "    begin a track, tentative until it was seen often enough",
}

impl Estimator for KalmanTracker {
    const INFO: Info = Info {
        id: "kalman-tracker",
        name: "Kalman tracker",
        family: "Tracking",
        summary: "Follows many objects: predicts each, shares the detections of a frame out among them, and moves each to its own.",
        source: "A. Bewley, Z. Ge, L. Ott, F. Ramos and B. Upcroft, Simple online and realtime tracking, ICIP 2016; less sure \
                 detections: Y. Zhang and others, ByteTrack, ECCV 2022; last box: J. Cao and others, Observation-centric SORT, CVPR \
                 2023; gate and life of tracks: S. Blackman and R. Popoli, Design and analysis of modern tracking systems, 1999; assignment: H. W. \
                 Kuhn 1955, R. Jonker and A. Volgenant 1987",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "step"],
        frames: 2,
    };
    const GUARANTEE: Guarantee = Guarantee::Objects;
    const NEEDS_PICTURES: bool = false;
    const CHARTS: &'static [Chart] = &[Chart::Matrices, Chart::Series];
    const PRODUCES: &'static [&'static ProductKind] = &[ObjectField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        Ok(State { course: Course::new(self.given.clone(), clip, frame)?, tracks: Vec::new() })
    }

    fn advance(&self, clip: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let (detections, left_out) = state.course.look(clip)?;
        let detections = Arc::new(detections);
        observer.see(|| Event::Looked(Arc::clone(&detections), left_out));
        let mut tracks = std::mem::take(&mut state.tracks);
        for track in &mut tracks {
            track.filter = track.filter.going_by(self.model(&track.extent)).predicted();
        }
        observer.see(|| Event::Predicted(Arc::new(tracks.clone())));
        let is_sure = |found: &Detection| !state.course.tells_scores() || found.score >= self.sure_score;
        let costs = Arc::new(self.costs(clip, (tracks, detections), is_sure)?);
        observer.see(|| Event::Costs(Arc::clone(&costs)));
        for (row, pair) in costs.pairs.iter().enumerate().filter_map(|(row, pair)| Some((row, (*pair)?))) {
            observer.see(|| Event::Paired(Arc::clone(&costs), [row, pair.column]));
        }
        let objects = self.share_out(state, &costs, observer);
        let frame = Arc::new(ObjectFrame { mask: None, detections: Vec::clone(&costs.detections), objects });
        observer.see(|| Event::Done(Arc::clone(&frame)));
        Ok(state.course.note(clip, frame))
    }

    fn units(&self, state: &State) -> Option<usize> {
        state.course.span.frames()
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        state.course.place()
    }

    fn units_of(&self, _picture: (usize, usize), frames: usize) -> Option<usize> {
        Some(frames)
    }

    fn at_frame(&self, state: &State) -> Option<usize> {
        Some(state.course.frame())
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        match event {
            Event::Begun(_) => Some(Role::Reference),
            Event::Ended(_) => Some(Role::Rejected),
            _ => None,
        }
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.told(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.drawn(seen, scene);
    }

    fn causal(&self) -> Option<Self> {
        self.rules.without_hindsight().map(|rules| Self { rules, ..self.clone() })
    }

    fn output(&self, state: &State) -> Output {
        Output::of(state.course.field())
    }
}

impl Footprint<State> for KalmanTracker {
    fn need(&self, clip: &Clip) -> Need {
        super::need(clip)
    }

    fn state_bytes(&self, state: &State) -> usize {
        state.course.own_bytes() + size_of_val(&state.tracks[..])
    }

    fn memory_bytes(&self, state: &State) -> usize {
        self.state_bytes(state) + state.course.shared_bytes()
    }
}

impl KalmanTracker {
    /// Moves objects to their detections, ends and begins some; gives those there are in this frame.
    fn share_out(&self, state: &mut State, costs: &Costs, observer: &mut impl Observer<Event>) -> Vec<Object> {
        let (mut objects, mut is_taken) = (Vec::new(), vec![false; costs.detections.len()]);
        for (track, pair) in costs.tracks.iter().zip(&costs.pairs) {
            let column = pair.map(|pair| pair.column);
            column.into_iter().for_each(|column| is_taken[column] = true);
            let next = match column {
                Some(column) => {
                    let detection = &costs.detections[column];
                    let updated = self.updated(track, detection);
                    observer.see(|| {
                        let both = Box::new([track.clone(), updated.clone()]);
                        Event::Updated(both, self.measurement(detection))
                    });
                    state.course.look_back(self.rules, &updated.object(Some(column)), track.age);
                    Some(updated)
                }
                None => {
                    let missed = self.missed(track, state.course.picture());
                    observer.see(|| match &missed {
                        Some(track) => Event::Missed(Box::new(track.clone())),
                        None => Event::Ended(Box::new(track.clone())),
                    });
                    missed
                }
            };
            objects.extend(next.iter().map(|track| track.object(column)));
            state.tracks.extend(next);
        }
        for (column, detection) in costs.detections.iter().enumerate() {
            if !costs.is_sure[column] || is_taken[column] {
                continue;
            }
            let track = self.begun(detection, state.course.next_id());
            observer.see(|| Event::Begun(Box::new(track.clone())));
            objects.push(track.object(Some(column)));
            state.tracks.push(track);
        }
        objects
    }
}
