//! Joint probabilistic data association: each track is updated with all detections in its gate, weighted by the probabilities that
//! they are its own.
//!
//! T. E. Fortmann, Y. Bar-Shalom and M. Scheffe, Sonar tracking of multiple targets using joint probabilistic data association, 1983.

mod coalescence;
mod events;
mod explain;
mod tables;
mod vocabulary;

use std::sync::Arc;

use super::{is_far_outside, object_of};
use crate::base::{Error, Observer};
use crate::data::{Clip, Detection};
use crate::geometry::Bounds;
use crate::methods::{
    kalman::Filter,
    multi_object::{
        self, Extent,
        chances::Chances,
        dynamics::Dynamics,
        explain::ShownTrack,
        lifecycle::{Rules, TrackAge},
        tracker_run::{self, Conclusion},
        tracking::{MultiTracker, MultiTracking},
    },
};
use crate::products::{Object, ObjectFrame};
use crate::run::{Info, Need, Progress, Seen};
use crate::scene::{Question, Reply, Role, Scene, Step};
use crate::{params, pseudocode};
use events::{Joint, Validation};
use vocabulary::{case, value};

params! {
    /// Multi-object tracking with soft data association.
    pub struct JointProbabilistic {
        /// The frames of the run and the source of the detections.
        settings: tracker_run::Settings = tracker_run::Settings::default();
        /// The filters of the tracks.
        dynamics: Dynamics = Dynamics::default();
        /// The probabilities of detections.
        chances: Chances = Chances::default();
        /// Maximum number of joint events of a cluster of tracks, the most probable ones.
        max_events: usize = 500, 1..=5000;
        /// Track management. Coasted boxes are not interpolated by default: after a gap the weighted mean of several detections may
        /// lie on another object.
        rules: Rules = Rules { interpolate: false, ..Rules::default() };
    }
}

/// The probability from which on something counts as the more probable of two.
const MORE_PROBABLE: f64 = 0.5;

type State = multi_object::tracking::State<Vec<Track>>;

/// A track.
#[derive(Clone, Debug)]
pub struct Track {
    id: u32,
    filter: Filter,
    extent: Extent,
    age: TrackAge,
}

/// The association of a track with the detections in its gate.
#[derive(Clone, Debug)]
pub struct Weights {
    /// The probability of each detection in the gate.
    detections: Vec<(usize, f64)>,
    /// Its measurements with their probabilities.
    measured: Vec<([f64; 2], f64)>,
    /// The standard deviation of a measurement along each axis in px.
    deviation: f64,
    /// The detection that is reported as the track's own, with its probability: no other track has it.
    own: Option<(usize, f64)>,
}

/// An event of a frame.
#[derive(Clone, Debug)]
pub enum Event {
    /// The detections, and the number discarded by the minimum score.
    Detected(Arc<Vec<Detection>>, usize),
    /// The predicted tracks.
    Predicted(Arc<Vec<Track>>),
    /// The validation matrix.
    Validated(Arc<Validation>),
    /// The feasible joint events of a cluster.
    Enumerated(Arc<Validation>, Arc<Joint>),
    /// The association probabilities of a cluster.
    Weighed(Arc<Validation>, Arc<Joint>),
    /// A track is updated: before and after.
    Updated(Box<[Track; 2]>, Box<Weights>),
    /// A track that is more probably not detected.
    Missed(Box<Track>, f64),
    /// A deleted track.
    Deleted(Box<Track>),
    /// A track that starts with a detection that probably belongs to no track.
    Begun(Box<Track>, f64),
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

impl Weights {
    /// Returns β₀, the probability that none of the detections is the track's.
    fn missed(&self) -> f64 {
        (1.0 - self.detections.iter().map(|(_, weight)| weight).sum::<f64>()).max(0.0)
    }

    /// Returns whether one of the detections is more probably the track's than none.
    fn is_detected(&self) -> bool {
        self.missed() < MORE_PROBABLE
    }

    /// Returns the most probable detection.
    fn likeliest(&self) -> Option<(usize, f64)> {
        self.detections.iter().copied().reduce(|a, b| if b.1 > a.1 { b } else { a })
    }
}

pseudocode! {
    EACH_FRAME: "for each frame t",
    DETECT: "  detect objects",
    PREDICT: "  predict each track: x ← F x, P ← F P F^T + Q",
    VALIDATE: "  validation matrix: detections in the gates, d² ≤ threshold; clusters",
    EACH_CLUSTER: "  for each cluster of tracks with common detections",
    ENUMERATE: "    feasible joint events θ: no detection and no track used twice",
    WEIGH: "    P(θ) = ∏ P_D N(ν; 0, S) L_size / λ ∏ (1 − P_D P_G), normalised; sum it to β for each pair",
    UPDATE_TRACK: "  for each track: update x, P with ν = Σ β ν_j and its spread",
    COAST_OR_END: "    coast where β_0 ≥ 0.5; delete if tentative or missed > max-age frames",
    BEGIN_TRACK: "  start a track where a detection belongs to no track, Σ β < 0.5",
}

impl MultiTracker for JointProbabilistic {
    const INFO: Info = Info {
        id: "joint-probabilistic",
        name: "Joint probabilistic data association",
        family: "Tracking",
        summary: "Tracks many objects without assignment: each track is updated with all detections in its gate, weighted by the probability of each association.",
        source: "T. E. Fortmann, Y. Bar-Shalom and M. Scheffe, Sonar tracking of multiple targets using joint probabilistic data \
                 association, IEEE Journal of Oceanic Engineering 1983; update by several measurements: Y. Bar-Shalom and E. Tse, \
                 Automatica 1975; the most probable joint events: K. G. Murty 1968",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::choice(
            "associated",
            "What becomes of the next track?",
            &[
                Reply::at(line::UPDATE_TRACK, "It is updated"),
                Reply::told(line::COAST_OR_END, case::COASTS, "It coasts"),
                Reply::at(line::COAST_OR_END, "It is deleted"),
            ],
        ),
        Question::value("events", "How many feasible joint events are there?", line::ENUMERATE, value::JOINT_EVENTS),
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
        let validation = Arc::new(self.validated(clip, (tracks, Arc::clone(&detections)))?);
        observer.see(|| Event::Validated(Arc::clone(&validation)));
        let weights = self.weights(clip, &validation, observer)?;
        let objects = self.update_tracks(state, (&validation, &weights), observer);
        let frame = state.run.finished(self.rules, Vec::clone(&detections), objects);
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
            Event::Begun(..) => Some(Role::Reference),
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

impl JointProbabilistic {
    fn updated(&self, track: &Track, detections: &[Detection], weights: &Weights) -> Track {
        let filter = if weights.measured.is_empty() {
            track.filter
        } else {
            track.filter.associated(weights.deviation, &weights.measured).unwrap_or(track.filter)
        };
        let likeliest = weights.likeliest().filter(|_| weights.is_detected());
        let Some((likeliest, _)) = likeliest else { return Track { filter, ..*track } };
        // Without a detection of its own it was detected, but its box stays.
        let extent = weights.own.map_or(track.extent, |(own, _)| track.extent.towards(&detections[own]));
        Track { filter, extent, age: self.rules.seen(track.age, &detections[likeliest]), ..*track }
    }

    /// Updates, deletes and starts tracks; returns the objects of this frame.
    fn update_tracks(
        &self,
        state: &mut State,
        (validation, weights): (&Validation, &[Weights]),
        observer: &mut impl Observer<Event>,
    ) -> Vec<Object> {
        let detections = &validation.detections;
        let (mut objects, mut taken) = (Vec::new(), vec![0.0; detections.len()]);
        for (track, weights) in validation.tracks.iter().zip(weights) {
            weights.detections.iter().for_each(|(detection, weight)| taken[*detection] += weight);
            let updated = self.updated(track, detections, weights);
            if !weights.measured.is_empty() {
                observer.see(|| {
                    let both = Box::new([track.clone(), updated.clone()]);
                    Event::Updated(both, Box::new(weights.clone()))
                });
            }
            if weights.is_detected() {
                let object = updated.object(weights.own.map(|(detection, _)| detection));
                state.run.look_back(self.rules, &object, track.age);
                objects.push(object);
                state.tracks.push(updated);
                continue;
            }
            let is_outside = is_far_outside(updated.filter.place(), state.run.picture());
            let age = self.rules.missed(track.age).filter(|_| !is_outside);
            observer.see(|| match age {
                Some(age) => Event::Missed(Box::new(Track { age, ..updated.clone() }), weights.missed()),
                None => Event::Deleted(Box::new(updated.clone())),
            });
            let coasting = age.map(|age| Track { age, ..updated });
            objects.extend(coasting.iter().map(|track| track.object(None)));
            state.tracks.extend(coasting);
        }
        let free = detections.iter().zip(taken).enumerate().filter(|(_, (_, share))| *share < MORE_PROBABLE);
        for (index, (detection, share)) in free {
            let (filter, extent) = (self.dynamics.begun(detection), Extent::of(detection));
            let track = Track { id: state.run.next_id(), filter, extent, age: self.rules.begun(detection) };
            observer.see(|| Event::Begun(Box::new(track.clone()), share));
            objects.push(track.object(Some(index)));
            state.tracks.push(track);
        }
        objects
    }
}
