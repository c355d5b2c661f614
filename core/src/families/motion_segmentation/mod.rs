//! Motion segmentation: which pixels move together. One file per estimator; the shared parts are in `methods/segmentation`.

mod motion_clustering;

pub use crate::methods::segmentation::{FlowInput, FlowSource};
pub use motion_clustering::{Features, Method, MotionClustering, Selection};
