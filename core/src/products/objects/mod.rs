//! Objects: detections and tracks, assignment, trajectories and scores.

pub mod assignment;
pub mod box_index;
mod field;
pub mod k_best;
pub mod pairs;
mod product;
pub mod score;
pub mod trajectory;

pub use field::{Followed, Object, ObjectField, ObjectFrame, TrackStatus, Watched};
