//! Multi-object tracking: sources of detections, track management, and what steps say of them.

pub(crate) mod chances;
pub(crate) mod density;
pub mod directions;
mod drawing;
pub(crate) mod dynamics;
pub(crate) mod explain;
mod extent;
pub(crate) mod gating;
pub(crate) mod lifecycle;
pub(crate) mod partial;
pub(crate) mod selected;
pub mod source;
mod tables;
pub(crate) mod tracker_run;
pub(crate) mod tracking;
pub(crate) mod truth;
pub(crate) mod vocabulary;

pub use extent::Extent;
pub use tracking::MultiTracking;
