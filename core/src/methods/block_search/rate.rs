//! The rate term: the bits of a motion vector difference.

use super::{Match, Neighbours, Settings};

/// The rate term λR added to the distortion: R is the bits of the difference between a displacement and its predictor
/// (G. J. Sullivan and T. Wiegand, Rate-distortion optimization for video compression, IEEE Signal Processing Magazine
/// 15(6), 1998). The bits are those of H.264's signed Exp-Golomb code.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rate {
    /// Cost per bit.
    pub lambda: f64,
    /// The predictor, in the steps in which displacements are coded.
    predicted: [i32; 2],
    /// Steps to a px: 1, 2 or 4.
    per_px: i32,
}

impl Rate {
    /// The rate term of a block with these neighbours: the predictor is their median.
    pub fn new(settings: &Settings, neighbours: &Neighbours) -> Self {
        let per_px = settings.refinement.subpixel.steps_per_px();
        let steps = |found: Match| match per_px {
            1 => found.displacement,
            _ => found.quarters().map(|c| c * per_px / 4),
        };
        Self { lambda: settings.refinement.lambda.into(), predicted: neighbours.median_of(steps), per_px }
    }

    /// The rate term λR of a displacement in quarters of a px.
    #[inline]
    pub fn price(&self, quarters: [i32; 2]) -> f64 {
        if self.lambda == 0.0 { 0.0 } else { self.lambda * f64::from(self.bits(quarters)) }
    }

    /// The distortion of `found`: its cost without the rate term, rounded so that sums of whole numbers stay whole.
    pub fn distortion(&self, found: Match) -> f64 {
        if self.lambda == 0.0 {
            return found.cost;
        }
        ((found.cost - self.price(found.quarters())) * 1e6).round() / 1e6
    }

    /// The bits of a displacement in quarters of a px.
    pub fn bits(&self, quarters: [i32; 2]) -> u32 {
        let [u, v] = quarters.map(|c| c * self.per_px / 4);
        exp_golomb_bits(u - self.predicted[0]) + exp_golomb_bits(v - self.predicted[1])
    }

    /// The predictor in px.
    pub fn predicted_px(&self) -> [f32; 2] {
        self.predicted.map(|c| c as f32 / self.per_px as f32)
    }
}

/// Bits of `v` in the signed Exp-Golomb code (ITU-T H.264, 9.1.1): 1 for 0, 3 for ±1, 5 for ±2 and ±3, and so on.
fn exp_golomb_bits(v: i32) -> u32 {
    let code = if v > 0 { 2 * v.unsigned_abs() - 1 } else { 2 * v.unsigned_abs() };
    2 * (code + 1).ilog2() + 1
}

#[cfg(test)]
mod tests {
    use super::super::{HasSettings, Refinement};
    use super::*;
    use crate::families::block_matching::FullSearch;

    #[test]
    fn bits_are_those_of_the_standards_table() {
        let expected = [(0, 1), (1, 3), (-1, 3), (2, 5), (-2, 5), (3, 5), (-3, 5), (4, 7), (-7, 7), (8, 9)];
        for (v, bits) in expected {
            assert_eq!(exp_golomb_bits(v), bits, "{v}");
        }
    }

    #[test]
    fn the_predictor_takes_the_shortest_code() {
        let left = Some(Match { displacement: [3, -2], fraction: [0.5, 0.0], cost: 0.0 });
        let neighbours = Neighbours { left, ..Neighbours::default() };
        let settings = |subpixel| {
            let settings = FullSearch::default().settings();
            Settings { refinement: Refinement { lambda: 4.0, subpixel, ..settings.refinement }, ..settings }
        };
        let half = Rate::new(&settings(super::super::Subpixel::Half), &neighbours);
        assert_eq!((half.bits([14, -8]), half.price([14, -8]), half.predicted_px()), (2, 8.0, [3.5, -2.0]));
        assert_eq!(half.bits([16, -8]), 4);
        // In whole px the neighbour's fraction is dropped.
        let whole = Rate::new(&settings(super::super::Subpixel::None), &neighbours);
        assert_eq!((whole.bits([12, -8]), whole.bits([16, -8])), (2, 4));
    }
}
