//! Interest point detectors, one file each; the shared parts are in `methods/features`.

mod fast;
mod harris;
mod shi_tomasi;

pub use crate::methods::features::Corners;
pub use fast::Fast;
pub use harris::Harris;
pub use shi_tomasi::ShiTomasi;
