//! What compression gains by motion: the bits of a residual and of vectors, against those of the frame itself.

use std::collections::BTreeMap;

use crate::{BlockField, Error, Gray};

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
    /// The bits for `frame`, of which `prediction` was made, with the motion vectors of `blocks` if these are sent.
    ///
    /// # Errors
    /// If the sizes differ.
    pub fn of(blocks: Option<&BlockField>, frame: &Gray, prediction: &Gray) -> Result<Self, Error> {
        if prediction.size() != frame.size() {
            return Err(Error::new("a prediction must have the size of its picture"));
        }
        let pairs = frame.cells().iter().zip(prediction.cells());
        let vectors =
            |field: &BlockField| vector_bits(field.vectors.iter().flatten().map(|vector| vector.displacement));
        Ok(Self {
            frame_bits: bits(frame.cells().iter().copied()),
            residual_bits: bits(pairs.map(|(&a, &b)| i16::from(a) - i16::from(b))),
            vector_bits: blocks.map(vectors),
        })
    }
}

/// Bits of all displacements, each as one symbol.
pub(crate) fn vector_bits(vectors: impl Iterator<Item = [f32; 2]>) -> f64 {
    // Displacements are multiples of a quarter of a pixel, or finer by a fit: a hundredth tells them apart.
    bits(vectors.map(|vector| vector.map(|c| (c * 100.0).round() as i32)))
}

/// Bits of all symbols at −log₂ p each, where p is how often a symbol comes among them.
fn bits<T: Ord>(symbols: impl Iterator<Item = T>) -> f64 {
    let mut counts = BTreeMap::new();
    for symbol in symbols {
        *counts.entry(symbol).or_insert(0u64) += 1;
    }
    let all = counts.values().sum::<u64>() as f64;
    counts.values().map(|&count| count as f64 * (all / count as f64).log2()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BlockGrid, BlockVector, Border, Grid};

    #[test]
    fn bits_are_those_of_the_textbook() {
        assert_eq!(bits([7; 9].into_iter()), 0.0);
        assert_eq!(bits(0..8), 24.0);
        // Half, a quarter, and two eighths: 1.75 bits a symbol.
        assert_eq!(bits([1, 1, 1, 1, 2, 2, 3, 4].into_iter()), 14.0);
    }

    #[test]
    fn a_perfect_prediction_leaves_only_the_vectors() {
        let blocks = BlockGrid { picture: (16, 8), size: 8, step: 8 };
        let vectors =
            [[0.0, 1.0], [0.25, 1.0]].map(|displacement| Some(BlockVector { displacement, cost: 0.0, candidates: 1 }));
        let filter = crate::Interpolation::Bilinear;
        let field = BlockField { blocks, vectors: vectors.to_vec(), cost: "SAD", border: Border::Replicate, filter };
        let frame = Grid::from_fn(16, 8, |x, _| x as u8);
        let coding = Coding::of(Some(&field), &frame, &frame).unwrap();
        assert_eq!(coding, Coding { frame_bits: 512.0, residual_bits: 0.0, vector_bits: Some(2.0) });
        assert!(Coding::of(Some(&field), &frame, &Grid::new(3, 3, 0)).is_err());
    }
}
