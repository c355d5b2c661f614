//! Objects with a past and a predicted future.

mod blob_tracker;
mod kalman_filter;
mod kalman_tracker;
mod trajectory_analysis;

pub use blob_tracker::BlobTracker;
pub use kalman_filter::KalmanFilter;
pub use kalman_tracker::KalmanTracker;
pub use trajectory_analysis::TrajectoryAnalysis;

use crate::kalman::Filter;
use crate::objects::{Bounds, Life, Object};

/// The object that a filter follows.
fn object_of(filter: &Filter, id: u32, bounds: Bounds, life: Life) -> Object {
    Object {
        id,
        bounds,
        life,
        position: filter.place(),
        velocity: Some(filter.velocity()),
        covariance: Some(filter.place_covariance()),
        detection: None,
    }
}

/// Whether a place is outside a picture of this size by more than that size: what is believed to be there is not seen again.
fn is_far_outside([x, y]: [f64; 2], (width, height): (usize, usize)) -> bool {
    let is_near = |c: f64, side: usize| (-(side as f64)..2.0 * side as f64).contains(&c);
    !is_near(x, width) || !is_near(y, height)
}
