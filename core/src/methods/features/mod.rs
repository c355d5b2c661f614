//! Feature detection by structure tensors, and feature tracking by Lucas and Kanade's method.
//!
//! [`Corners`] turns any [`Measure`] of a structure tensor into a detector: response, threshold, non-maximum suppression,
//! selection at a minimum distance. Trackers ask a stage for keypoints and keep those with sufficient distance from existing
//! features (`spread`). `tracker.rs` compares a window with a position (AVX2 or portable, bit-identical), `follow.rs` iterates
//! through the pyramid after Bouguet, and `Account` produces the explanation for every tracker.

pub mod affine;
pub mod brief;
mod conclusion;
mod corners;
mod declare;
mod eigenvalues;
mod explain;
pub mod follow;
pub mod haar;
pub mod integral;
mod keypoints;
pub mod level_trace;
mod marks;
mod response;
pub mod scale_pyramid;
mod scan;
pub mod segment;
mod select;
mod trace;
pub mod tracker;
pub(crate) mod trails;

pub use conclusion::{conclude, put_lost, reason_of};
pub use corners::{Corners, Measure};
pub(crate) use declare::{KEPT, Status, be, case, corner_pseudocode, value};
pub(crate) use explain::{point, unit_of_parts};
pub use keypoints::draw_keypoints;
pub(crate) use marks::{draw_minimum_distance, draw_points};
pub use scan::{Scan, Stage};
pub use select::{Selection, Settings, choose, spread};
pub use trace::Trace;
