//! What is done with features: places of a picture that can be told from all around them. They are found by their structure
//! tensors and tracked by Lucas and Kanade's method.

mod corners;
mod response;
mod select;
mod tell;
pub mod tracker;

pub use corners::{Corners, Measure, detect};
pub use select::Settings;
