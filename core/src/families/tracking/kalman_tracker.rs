//! Multi-object tracking with a Kalman filter per track and data association in every frame (SORT and its successors).

mod association;
mod charts;
mod explain;
mod formulas;
mod vocabulary;

use std::sync::Arc;

use super::{is_far_outside, object_of};
use crate::base::{Error, Observer};
use crate::data::{Clip, Detection};
use crate::geometry::Bounds;
use crate::methods::{
    kalman::{Filter, Measurement},
    multi_object::{
        self, Extent,
        dynamics::Dynamics,
        explain::ShownTrack,
        lifecycle::{Rules, TrackAge},
        partial::WholeSize,
        tracker_run::{self, Conclusion},
        tracking::{MultiTracker, MultiTracking},
        vocabulary::value as shared,
    },
};
use crate::products::{Object, ObjectFrame, TrackStatus};
use crate::run::{Info, Need, Progress, Seen};
use crate::scene::{Question, Reply, Role, Scene, Step};
use crate::{choices, params, pseudocode};

pub use association::{Costs, Pair};
use vocabulary::{case, value};

choices! {
    /// The assignment method.
    pub enum Association {
        /// Greedy: the pair of least cost first, then the next.
        Nearest = "nearest" "Greedy",
        /// Optimal assignment (Hungarian algorithm): as many pairs as possible at the least total cost.
        Assignment = "assignment" "Optimal assignment",
    }
}

choices! {
    /// The cost of a pair.
    pub enum PairCost {
        /// Squared Mahalanobis distance d² of the detection from the prediction.
        Mahalanobis = "mahalanobis" "Mahalanobis distance",
        /// 1 − IoU of the predicted box and the detection, as in SORT.
        Overlap = "overlap" "IoU",
        /// Mean of d² / gate and (1 − IoU) / (1 − IoU threshold).
        Both = "both" "Mahalanobis distance and IoU",
    }
}

params! {
    /// Multi-object tracking with a Kalman filter per track.
    pub struct KalmanTracker {
        /// The frames of the run and the source of the detections.
        settings: tracker_run::Settings = tracker_run::Settings::default();
        /// The filters of the tracks.
        dynamics: Dynamics = Dynamics::default();
        /// Method that assigns detections to tracks.
        association: Association = Association::Assignment;
        /// Cost of a pair of track and detection.
        cost: PairCost = PairCost::Both;
        /// Gate probability: share of the true measurements inside the gate. It sets the gating threshold of d² by the χ² distribution with 2 degrees of freedom.
        gate: f32 = 0.999, 0.5..=0.9999;
        /// Minimum IoU of the predicted box and a detection. With 0 the boxes only have to overlap.
        iou_threshold: f32 = 0.2, 0.0..=0.95;
        /// Match confirmed tracks first, tentative ones with the remaining detections. Off: all at once, as in SORT.
        cascade: bool = true;
        /// Threshold τ of ByteTrack: detections of at least this score are matched first and start tracks. Those of lower score only continue tracks matched in the previous frame.
        score_threshold: f32 = 0.6, -1000.0..=1000.0;
        /// Observation-centric recovery (OC-SORT): match the remaining tracks by their last detected box too, for objects that stopped while occluded.
        recover: bool = true;
        /// Partial observation: where one side of a blob is hidden, its visible edges and the size of the track give its box. Off: boxes
        /// shrink with what is visible.
        partial: bool = true;
        /// Track management.
        rules: Rules = Rules::default();
    }
    advanced { "cascade", "score-threshold", "recover", "partial" }
    when {
        "gate": |p| p.cost != PairCost::Overlap,
            "The gate has no effect where the cost is the overlap of boxes alone.";
        "score-threshold": |p| p.settings.may_have_scores(),
            "The score threshold has no effect on detections without scores.";
    }
}

type State = multi_object::tracking::State<Vec<Track>>;

/// A track.
#[derive(Clone, Debug)]
pub struct Track {
    id: u32,
    filter: Filter,
    extent: Extent,
    size: WholeSize,
    /// The last detected box.
    last: Bounds,
    age: TrackAge,
}

/// An event of a frame.
#[derive(Clone, Debug)]
pub enum Event {
    /// The detections, and the number discarded by the minimum score.
    Detected(Arc<Vec<Detection>>, usize),
    /// The predicted tracks.
    Predicted(Arc<Vec<Track>>),
    /// The cost matrix; infinite outside the gate.
    Costs(Arc<Costs>),
    /// An assigned pair, and the row of its track.
    Assigned(Arc<Costs>, usize, Pair),
    /// A track is updated: before and after.
    Updated(Box<[Track; 2]>, Measurement),
    /// A track without a detection.
    Missed(Box<Track>),
    /// A deleted track.
    Deleted(Box<Track>),
    /// A track that starts with an unassigned detection.
    Begun(Box<Track>),
    /// The finished frame and its conclusion.
    Done(Arc<ObjectFrame>, Box<Conclusion>),
}

impl Track {
    /// Returns the box at the estimated position.
    fn bounds(&self) -> Bounds {
        self.extent.around(self.filter.place())
    }

    fn shown(&self) -> ShownTrack<'_> {
        ShownTrack { id: self.id, filter: &self.filter, bounds: self.bounds(), age: self.age }
    }

    fn object(&self, detection: Option<usize>) -> Object {
        Object { detection, ..object_of(&self.filter, self.id, self.bounds(), self.age.status) }
    }
}

impl KalmanTracker {
    /// Returns the whole box of a blob of which a side is hidden, as a detection; `None` if none is.
    fn completed(&self, track: &Track, detection: &Detection, picture: (usize, usize)) -> Option<Detection> {
        let is_possible = self.partial
            && detection.blob.is_some()
            && track.age.status != TrackStatus::Tentative
            && track.size.hidden_frames < self.rules.max_age;
        let bounds = is_possible.then(|| track.size.completed(&detection.bounds, &track.bounds(), picture))??;
        Some(Detection { bounds, center: track.extent.place_in(&bounds), ..*detection })
    }

    /// Returns the measurement of a track by a detection: of its whole box, if a side is hidden.
    fn measured(&self, track: &Track, detection: &Detection, picture: (usize, usize)) -> Measurement {
        self.dynamics.measurement(&self.completed(track, detection, picture).unwrap_or(*detection))
    }

    fn updated(&self, track: &Track, detection: &Detection, picture: (usize, usize)) -> Track {
        let completed = self.completed(track, detection, picture);
        let found = completed.as_ref().unwrap_or(detection);
        let filter = track.filter.updated(&self.dynamics.measurement(found)).map_or(track.filter, |(filter, _)| filter);
        Track {
            id: track.id,
            filter,
            extent: track.extent.towards(found),
            size: track.size.seen(detection, completed.is_some()),
            last: detection.bounds,
            age: self.rules.seen(track.age, found),
        }
    }

    fn begun(&self, detection: &Detection, id: u32) -> Track {
        let (size, age) = (WholeSize::of(detection), self.rules.begun(detection));
        let (filter, extent) = (self.dynamics.begun(detection), Extent::of(detection));
        Track { id, filter, extent, size, last: detection.bounds, age }
    }

    /// Returns a track after a missed frame; `None` if it is deleted.
    fn missed(&self, track: &Track, picture: (usize, usize)) -> Option<Track> {
        let age = self.rules.missed(track.age).filter(|_| !is_far_outside(track.filter.place(), picture))?;
        Some(Track { age, ..track.clone() })
    }
}

pseudocode! {
    EACH_FRAME: "for each frame t",
    DETECT: "  detect objects",
    PREDICT: "  predict each track: x ← F x, P ← F P F^T + Q",
    COMPUTE_COSTS: "  cost matrix C by d², 1 − IoU, or both; ∞ outside gate and IoU threshold",
    ASSIGN: "  assignment: confirmed tracks, then low scores, tentative tracks, last boxes",
    UPDATE_TRACK: "  for each pair: update x, P with the detection",
    EACH_UNSEEN_TRACK: "  for each track without a detection",
    COAST_OR_END: "    coast; delete if tentative or missed > max-age frames",
    EACH_LEFT_DETECTION: "  for each unassigned detection with score ≥ τ = score-threshold",
    BEGIN_TRACK: "    start a track, tentative until min-hits frames and min-travel",
}

impl MultiTracker for KalmanTracker {
    const INFO: Info = Info {
        id: "kalman-tracker",
        name: "Kalman tracker",
        family: "Tracking",
        summary: "Tracks many objects: predicts each with a Kalman filter, assigns the detections of a frame to the tracks, and updates them.",
        source: "A. Bewley, Z. Ge, L. Ott, F. Ramos and B. Upcroft, Simple online and realtime tracking, ICIP 2016; low-score \
                 detections: Y. Zhang and others, ByteTrack, ECCV 2022; recovery by the last box: J. Cao and others, Observation-centric SORT, CVPR \
                 2023; partial observation: M. Xu and T. Ellis, BMVC 2002; gating and track management: S. Blackman and R. Popoli, Design and analysis of modern tracking systems, 1999; assignment: H. W. \
                 Kuhn 1955, R. Jonker and A. Volgenant 1987",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::choice(
            "gain",
            "Along x, will the updated position of the next track be nearer to its prediction or to its detection?",
            &[
                Reply::above(line::UPDATE_TRACK, (value::GAIN, 0.5), "Nearer to the detection"),
                Reply::told(line::UPDATE_TRACK, case::BY_GAIN, "Nearer to the prediction"),
            ],
        ),
        Question::choice(
            "unassigned",
            "What becomes of the next track without a detection?",
            &[
                Reply::told(line::COAST_OR_END, case::COASTS, "It coasts"),
                Reply::at(line::COAST_OR_END, "It is deleted"),
            ],
        ),
        Question::value(
            "gated",
            "How many pairs of a track and a detection does gating leave?",
            line::COMPUTE_COSTS,
            shared::GATED,
        ),
    ];
    type Tracks = Vec<Track>;
    type Event = Event;

    fn settings(&self) -> &tracker_run::Settings {
        &self.settings
    }

    fn rules(&self) -> Rules {
        self.rules
    }

    fn track(
        &self,
        clip: &Clip,
        state: &mut State,
        (detections, discarded): (Vec<Detection>, usize),
        observer: &mut impl Observer<Event>,
    ) -> Result<Progress, Error> {
        let detections = Arc::new(detections);
        observer.see(|| Event::Detected(Arc::clone(&detections), discarded));
        let mut tracks = std::mem::take(&mut state.tracks);
        for track in &mut tracks {
            track.filter = self.dynamics.predicted(&track.filter, &track.extent);
        }
        observer.see(|| Event::Predicted(Arc::new(tracks.clone())));
        let is_high = |found: &Detection| !state.run.has_scores() || found.score >= self.score_threshold;
        let costs = Arc::new(self.costs(clip, (tracks, detections), is_high)?);
        observer.see(|| Event::Costs(Arc::clone(&costs)));
        for (row, pair) in costs.pairs.iter().enumerate().filter_map(|(row, pair)| Some((row, (*pair)?))) {
            observer.see(|| Event::Assigned(Arc::clone(&costs), row, pair));
        }
        let objects = self.update_tracks(state, &costs, observer);
        let frame = state.run.finished(self.rules, Vec::clone(&costs.detections), objects);
        observer.see(|| {
            Event::Done(
                Arc::clone(&frame),
                Box::new(state.run.conclusion(clip, &frame, (self.rules, Some(&self.dynamics)))),
            )
        });
        Ok(state.run.note(clip, self.rules, frame))
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        match event {
            Event::Begun(_) => Some(Role::Reference),
            Event::Deleted(_) => Some(Role::Rejected),
            _ => None,
        }
    }

    fn need(&self, clip: &Clip) -> Need {
        super::need(clip)
    }

    fn tracks_bytes(&self, tracks: &Vec<Track>) -> usize {
        size_of_val(&tracks[..])
    }

    fn step(&self, seen: &Seen<MultiTracking<Self>>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<MultiTracking<Self>>, scene: &mut Scene) {
        self.draw_step(seen, scene);
    }
}

impl KalmanTracker {
    /// Updates, deletes and starts tracks; returns the objects of this frame.
    fn update_tracks(&self, state: &mut State, costs: &Costs, observer: &mut impl Observer<Event>) -> Vec<Object> {
        let (mut objects, mut is_taken) = (Vec::new(), vec![false; costs.detections.len()]);
        for (track, pair) in costs.tracks.iter().zip(&costs.pairs) {
            let column = pair.map(|pair| pair.column);
            column.into_iter().for_each(|column| is_taken[column] = true);
            let next = match column {
                Some(column) => {
                    let detection = &costs.detections[column];
                    let picture = state.run.picture();
                    let updated = self.updated(track, detection, picture);
                    observer.see(|| {
                        let both = Box::new([track.clone(), updated.clone()]);
                        Event::Updated(both, self.measured(track, detection, picture))
                    });
                    state.run.look_back(self.rules, &updated.object(Some(column)), track.age);
                    Some(updated)
                }
                None => {
                    let missed = self.missed(track, state.run.picture());
                    observer.see(|| match &missed {
                        Some(track) => Event::Missed(Box::new(track.clone())),
                        None => Event::Deleted(Box::new(track.clone())),
                    });
                    missed
                }
            };
            objects.extend(next.iter().map(|track| track.object(column)));
            state.tracks.extend(next);
        }
        for (column, detection) in costs.detections.iter().enumerate() {
            if !costs.is_high[column] || is_taken[column] {
                continue;
            }
            let track = self.begun(detection, state.run.next_id());
            observer.see(|| Event::Begun(Box::new(track.clone())));
            objects.push(track.object(Some(column)));
            state.tracks.push(track);
        }
        objects
    }
}
