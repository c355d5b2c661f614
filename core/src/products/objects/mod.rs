//! Objects: what is followed from frame to frame, the assignment of detections to tracks, and how good tracks are.

pub mod assignment;
mod field;
pub mod box_index;
pub mod pairs;
mod product;
pub mod score;
pub mod trajectory;

pub use field::{Followed, Object, ObjectField, ObjectFrame, TrackStatus};
