//! Interest point detectors, one file each; the shared parts are in `methods/features`.

mod harris;
mod shi_tomasi;
mod sift;

pub use crate::methods::features::Corners;
pub use harris::Harris;
pub use shi_tomasi::ShiTomasi;
pub use sift::Sift;
