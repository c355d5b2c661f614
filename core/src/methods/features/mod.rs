//! What is done with features: places of a picture that can be told from all around them. They are found by their structure
//! tensors and tracked by Lucas and Kanade's method.

mod level_trace;
pub mod affine;
mod corners;
mod declare;
mod explain;
pub mod follow;
mod response;
mod select;
mod trace;
pub mod tracker;
pub(crate) mod trails;

pub use level_trace::{LevelTrace, why};
pub use corners::{Corners, Measure};
pub(crate) use declare::corner_pseudocode;
pub use select::{Settings, spread};
pub use trace::Trace;
