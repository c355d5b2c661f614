//! What the estimators of a family share: a folder for each method, of which several are made.

pub(crate) mod alignment;
pub mod block_search;
pub mod camera_path;
pub mod contour;
pub mod correlation;
pub mod cost;
pub mod differential;
pub mod features;
pub mod geometric;
pub mod kalman;
pub mod matching;
pub mod multi_object;
pub(crate) mod numbers;
pub mod polynomial;
pub mod region;
pub mod scale_space;
pub mod scene_flow;
pub mod segmentation;
pub mod stereo;
pub mod subtraction;
pub mod variational;
