//! The path of a camera: motions of consecutive pairs of frames, chained, for estimators that register the frames of a clip.
//!
//! A stage of the kind `GlobalModel` makes a `ModelField` of each pair; `chain.rs` chains them to a `PathField`, whose pictures
//! (`Views`) are warped when they are asked for. Stabilisation and mosaic make two passes: motions, then frames.

mod canvas;
mod chain;
mod differences;
pub(crate) mod explain;
mod smooth;

pub use canvas::{Blending, Canvas, MOST_FRAMES, outline};
pub(crate) use chain::path_pseudocode;
pub use chain::{Chain, Link, Refused, usable};
pub use differences::differences;
pub(crate) use explain::DIRECTION;
pub use explain::{chain_step, conclude, displacement, draw_link, draw_outline, estimate_step, path_series, refusal};
pub use smooth::correction;
