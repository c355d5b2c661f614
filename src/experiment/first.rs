//! The defaults for clips and estimators; no other file names any.

/// The clip that the window opens first.
pub const SAMPLE: &str = "pillar";
/// The estimator in examples of the command line.
pub const EXAMPLE: &str = "full-search";
/// The default estimators in lockstep: the best-known searches.
pub const BESIDE: [&str; 3] = ["full-search", "three-step", "diamond"];
/// The search with which others are compared: it tests every candidate.
pub const EXHAUSTIVE: &str = "full-search";
/// The estimator for a file of detections.
pub const OF_DETECTIONS: &str = "kalman-tracker";
/// The estimator for two views of one moment.
pub const OF_VIEWS: &str = "block-stereo";
