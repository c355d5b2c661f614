//! What compression gains by motion: the bits of a residual and of vectors, against those of the frame itself.

use crate::base::{
    Error,
    entropy::{bits, vector_bits},
};
use crate::geometry::Gray;

/// Bits to send frame t, by zero-order entropy (C. E. Shannon, A Mathematical Theory of Communication, 1948).
///
/// No coder is this simple: each number is taken by itself, without its neighbours. It is a common yardstick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coding {
    /// The frame anew, without motion.
    pub frame_bits: f64,
    /// The residual: frame t less its prediction.
    pub residual_bits: f64,
    /// The displacements, each block's as one symbol; `None` where they are not of blocks: those are not meant to be sent.
    pub vector_bits: Option<f64>,
}

impl Coding {
    /// The bits for `frame`, of which `prediction` was made, with the motion vectors of blocks in px if these are sent.
    ///
    /// # Errors
    /// If the sizes differ.
    pub fn of(vectors: Option<&[[f32; 2]]>, frame: &Gray, prediction: &Gray) -> Result<Self, Error> {
        if prediction.size() != frame.size() {
            return Err(Error::new("a prediction must have the size of its picture"));
        }
        let pairs = frame.cells().iter().zip(prediction.cells());
        Ok(Self {
            frame_bits: bits(frame.cells().iter().copied()),
            residual_bits: bits(pairs.map(|(&a, &b)| i16::from(a) - i16::from(b))),
            vector_bits: vectors.map(|vectors| vector_bits(vectors.iter().copied())),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;

    #[test]
    fn a_perfect_prediction_leaves_only_the_vectors() {
        let frame = Grid::from_fn(16, 8, |x, _| x as u8);
        let coding = Coding::of(Some(&[[0.0, 1.0], [0.25, 1.0]]), &frame, &frame).unwrap();
        assert_eq!(coding, Coding { frame_bits: 512.0, residual_bits: 0.0, vector_bits: Some(2.0) });
        assert!(Coding::of(None, &frame, &Grid::new(3, 3, 0)).is_err());
    }
}
