//! Objects: what is followed from frame to frame, who belongs to whom, where objects go, and how good tracks are.

pub mod assignment;
mod field;
pub mod near;
pub mod pairs;
mod product;
pub mod score;
pub mod trajectory;

pub use field::{Followed, Life, Object, ObjectField, ObjectFrame};
