//! The estimators: a folder for each family, a file for each of its estimators.

pub mod block_matching;
pub mod correspondence;
pub mod interest_points;
pub mod motion_segmentation;
pub mod moving_objects;
pub mod optical_flow;
pub mod region_tracking;
pub mod stereo;
pub mod tracking;
