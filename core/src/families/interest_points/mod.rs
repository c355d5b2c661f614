//! Interest point detectors, one file each; the shared parts are in `methods/features`.

mod fast;
mod harris;
mod orb;
mod shi_tomasi;
mod sift;
mod surf;

pub use crate::methods::features::{Corners, Selection, Settings};
pub use fast::Fast;
pub use harris::Harris;
pub use orb::Orb;
pub use shi_tomasi::ShiTomasi;
pub use sift::Sift;
pub use surf::Surf;
