//! Everything about motion estimation that can be known without a screen, a file or a codec.

mod clip;
mod error;
mod grid;
pub mod params;

pub use clip::{Clip, ClipInfo, Flow, Frame, FrameSource, ObjectBox, Truth};
pub use error::Error;
pub use grid::{Border, Gray, Grid};
pub use params::{Params, Spec, Value};
