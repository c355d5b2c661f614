//! Scores of a template at all places of a search area, summed directly or by Fourier transforms.
//!
//! Everything is computed from whole numbers, so both ways give the same scores, bit by bit.

mod fourier;
mod scores;

pub use fourier::bytes;
pub use scores::{Evaluation, MOST_PX, Moments, Score, faster, map};
