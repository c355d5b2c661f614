//! Scores of a template at all places of a search area, summed directly or by Fourier transforms.
//!
//! Everything is computed from whole numbers, so both ways give the same scores, bit by bit.
//!
//! The products of gray levels come from `cost/products.rs` or from transforms along the rows (`fourier.rs`), whose rounded
//! sums are equal to them. Phase correlation and image alignment report events that hold the state after a stage, from which a
//! step recomputes its pictures and matrices.

mod fourier;
mod scores;

pub use fourier::bytes;
pub use scores::{Evaluation, MOST_PX, Moments, Score, faster, map};
