//! Numbers in rows and columns, and rectangles: how they are read between pixels and beyond the edge, filtered, and made
//! smaller.

mod bounds;
pub mod filter;
mod grid;
pub mod interpolation;
pub mod pyramid;
mod rows;
pub mod warp;

pub use bounds::Bounds;
pub use filter::{Beyond, Numbers};
pub use grid::{Border, Gray, Grid};
pub(crate) use interpolation::Between;
pub use interpolation::Interpolation;
pub use warp::Sampling;
