//! Tracking: state estimation and data association over time.

mod blob_tracker;
mod joint_probabilistic;
mod kalman_filter;
mod kalman_tracker;
mod multiple_hypothesis;
mod trajectory_analysis;

pub use crate::methods::multi_object::MultiTracking;
pub use crate::methods::multi_object::chances::Chances;
pub use crate::methods::multi_object::dynamics::{Dynamics, NoiseFrom};
pub use crate::methods::multi_object::lifecycle::Rules;
pub use crate::methods::multi_object::source::Source;
pub use blob_tracker::{BlobTracker, Identity};
pub use joint_probabilistic::JointProbabilistic;
pub use kalman_filter::{Confidence, KalmanFilter, Sensors};
pub use kalman_tracker::{Association, KalmanTracker, PairCost};
pub use multiple_hypothesis::MultipleHypothesis;
pub use trajectory_analysis::TrajectoryAnalysis;

use crate::data::Clip;
use crate::geometry::Bounds;
use crate::methods::kalman::Filter;
use crate::products::{Object, TrackStatus};
use crate::run::Need;

/// The number of objects assumed for memory where detections are not known yet.
const ASSUMED_OBJECTS: usize = 1000;

/// The maximum number of pairs stored for each track: see [`kalman_tracker`].
const MAX_PAIRS: usize = 500;

/// Memory of tracking the objects of a clip: tracks, pairs and events for the frame with the most detections, and the model,
/// difference and blobs of a background subtraction.
fn need(clip: &Clip) -> Need {
    let most = most_objects(clip);
    let objects = most * (4096.0 + 40.0 * most.min(MAX_PAIRS as f64));
    Need::per_pixel(clip, [10.0, 10.0]).and([objects, 4.0 * objects])
}

/// Returns the largest number of detections of a frame, where it is known.
fn most_objects(clip: &Clip) -> f64 {
    let frames = clip.info().frames.unwrap_or(0);
    (0..frames).filter_map(|t| clip.detections(t)).map(<[_]>::len).max().unwrap_or(ASSUMED_OBJECTS) as f64
}

/// Returns the object that a filter estimates.
fn object_of(filter: &Filter, id: u32, bounds: Bounds, status: TrackStatus) -> Object {
    Object {
        id,
        bounds,
        status,
        position: filter.place(),
        velocity: Some(filter.velocity()),
        covariance: Some(filter.place_covariance()),
        detection: None,
    }
}

/// Returns whether a position is outside the picture by more than the picture's size. A track there is deleted.
fn is_far_outside([x, y]: [f64; 2], (width, height): (usize, usize)) -> bool {
    let is_near = |c: f64, side: usize| (-(side as f64)..2.0 * side as f64).contains(&c);
    !is_near(x, width) || !is_near(y, height)
}
