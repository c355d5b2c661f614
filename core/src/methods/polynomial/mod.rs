//! What Farnebäck's method stands on: pictures as polynomials around each pixel, and how those that have moved tell by how
//! much.

mod expansion;
mod explain;
mod shift;

pub use expansion::{Applicability, Expander, Packed, Polynomial};
pub use explain::{Looked, Part};
pub use shift::{Agreed, Agreement, Moved, Shift};
