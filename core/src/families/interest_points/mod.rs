//! Interest points: places that can be found again. One file per detector; the shared parts are in `features`.

mod harris;
mod shi_tomasi;

pub use crate::methods::features::Corners;
pub use harris::Harris;
pub use shi_tomasi::ShiTomasi;
