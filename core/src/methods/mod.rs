//! Methods shared by the estimators of a family, one folder each.

pub(crate) mod alignment;
pub(crate) mod block_search;
pub(crate) mod camera_path;
pub(crate) mod contour;
pub(crate) mod correlation;
pub(crate) mod cost;
pub(crate) mod differential;
pub(crate) mod features;
pub mod geometric;
pub mod kalman;
pub(crate) mod matching;
pub(crate) mod multi_object;
pub(crate) mod numbers;
pub(crate) mod polynomial;
pub(crate) mod region;
pub(crate) mod scale_space;
pub(crate) mod scene_flow;
pub mod segmentation;
pub(crate) mod stereo;
pub(crate) mod subtraction;
pub(crate) mod variational;
