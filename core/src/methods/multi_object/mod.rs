//! What trackers of many objects share: who detects, how tracks live, and how they are told.

pub(crate) mod course;
pub mod directions;
mod extent;
pub(crate) mod lives;
pub mod source;
pub(crate) mod tell;

pub use extent::Extent;
