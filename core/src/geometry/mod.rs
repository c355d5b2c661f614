//! Numbers in rows and columns, rectangles and polygons: how they are read between pixels and beyond the edge, filtered, and made
//! smaller.

mod bounds;
pub(crate) mod filter;
mod grid;
pub(crate) mod polygon;
pub(crate) mod pyramid;
mod rows;
pub(crate) mod warp;

pub use bounds::Bounds;
pub(crate) use filter::{Beyond, Numbers};
pub use grid::{Border, Gray, Grid};
pub(crate) use warp::Sampling;
