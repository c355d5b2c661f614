//! Coding gain of motion compensation: bits of residual and vectors, compared with those of the frame.

use crate::base::{
    Error,
    entropy::{bits, vector_bits},
};
use crate::geometry::Gray;

/// Bits of frame t by zero-order entropy (C. E. Shannon, A Mathematical Theory of Communication, 1948).
///
/// Symbols are coded independently of their neighbours: an estimate, not the size of a real coder's output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coding {
    /// The frame without motion compensation (intra).
    pub frame_bits: f64,
    /// The residual: frame t minus its prediction.
    pub residual_bits: f64,
    /// The motion vectors, one symbol per block; `None` for dense and sparse flow, which is not coded.
    pub vector_bits: Option<f64>,
}

impl Coding {
    /// The bits of `frame` with its `prediction`, and of the motion vectors of blocks in px, if any.
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
