//! What trackers of many objects share: the detections, how tracks live, and how they are told.

pub(crate) mod tracker_run;
pub mod directions;
pub(crate) mod explain;
mod extent;
pub(crate) mod lifecycle;
pub mod source;

pub use extent::Extent;
