//! What is opened, or stands beside another, where a person names nothing: chosen by hand, and nowhere else.

/// The sample that the window shows first.
pub const SAMPLE: &str = "pillar";
/// The estimator that an example of the command line names.
pub const EXAMPLE: &str = "full-search";
/// The estimators that stand beside another one: the best known searches.
pub const BESIDE: [&str; 3] = ["full-search", "three-step", "diamond"];
/// The estimator that opens with a file of detections.
pub const OF_DETECTIONS: &str = "kalman-tracker";
