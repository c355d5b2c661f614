//! Numbers in rows and columns, rectangles and polygons: how they are read between pixels and beyond the edge, filtered, and made
//! smaller.

mod bounds;
pub mod filter;
mod grid;
pub mod polygon;
pub mod pyramid;
mod rows;
pub mod warp;

pub use bounds::Bounds;
pub use filter::{Beyond, Numbers};
pub use grid::{Border, Gray, Grid};
pub use warp::Sampling;
