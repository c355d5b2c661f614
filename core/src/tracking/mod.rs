//! Objects with a past and a predicted future.

mod blob_tracker;
mod kalman_filter;
mod kalman_tracker;
mod trajectory_analysis;

pub use blob_tracker::BlobTracker;
pub use kalman_filter::KalmanFilter;
pub use kalman_tracker::KalmanTracker;
pub use trajectory_analysis::TrajectoryAnalysis;
