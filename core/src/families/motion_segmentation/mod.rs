//! Motion segmentation: which pixels move together. One file per estimator; the shared parts are in `methods/segmentation`.

mod flow_segmentation;
mod motion_clustering;
mod motion_layers;
mod trajectory_clustering;

pub use crate::methods::segmentation::{FlowInput, FlowSource, SegmentationRun};
pub use flow_segmentation::{FlowSegmentation, Growth};
pub use motion_clustering::{Features, Method, MotionClustering, Selection};
pub use motion_layers::MotionLayers;
pub use trajectory_clustering::{Choice, TrajectoryClustering};
