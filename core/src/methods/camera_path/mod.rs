//! The path of a camera: motions of consecutive pairs of frames, chained, for estimators that register the frames of a clip.

mod canvas;
mod chain;
mod differences;
mod explain;
mod smooth;

pub use canvas::{Blending, Canvas, MOST_FRAMES, outline};
pub use chain::{Chain, Link, Refused, usable};
pub(crate) use chain::{DIRECTION, path_pseudocode};
pub use differences::differences;
pub use explain::{bent_pairs, chain_facts, chain_step, draw_link, matrix, path_series, unknown_pairs, why};
pub use smooth::correction;
