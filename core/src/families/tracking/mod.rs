//! Objects with a past and a predicted future.

mod blob_tracker;
mod kalman_filter;
mod kalman_tracker;
mod trajectory_analysis;

pub use blob_tracker::BlobTracker;
pub use kalman_filter::KalmanFilter;
pub use kalman_tracker::KalmanTracker;
pub use trajectory_analysis::TrajectoryAnalysis;

use crate::data::Clip;
use crate::geometry::Bounds;
use crate::methods::kalman::Filter;
use crate::products::{Object, TrackStatus};
use crate::run::Need;

/// The number of objects that memory is reckoned for where nothing is detected yet.
const RECKONED: usize = 1000;

/// So many pairs of an object are kept for each of its detections at most: see [`kalman_tracker`].
const PAIRS: usize = 500;

/// Memory that following the objects of a clip takes: for each of the frame that has the most its tracks and pairs, and what is
/// told of it; and where what moves is looked for, the background, a frame compared with it, and the blobs.
fn need(clip: &Clip) -> Need {
    let frames = clip.info().frames.unwrap_or(0);
    let most = (0..frames).filter_map(|t| clip.detections(t)).map(<[_]>::len).max().unwrap_or(RECKONED) as f64;
    let objects = most * (4096.0 + 40.0 * most.min(PAIRS as f64));
    Need::per_pixel(clip, [10.0, 10.0]).and([objects, 4.0 * objects])
}

/// The object that a filter follows.
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

/// Whether a place is outside a picture of this size by more than that size: an object estimated there is not seen again.
fn is_far_outside([x, y]: [f64; 2], (width, height): (usize, usize)) -> bool {
    let is_near = |c: f64, side: usize| (-(side as f64)..2.0 * side as f64).contains(&c);
    !is_near(x, width) || !is_near(y, height)
}
