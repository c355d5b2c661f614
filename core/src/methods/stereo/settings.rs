//! The parameters that all estimators of disparity share.

use crate::params;

params! {
    /// Range and tests of a stereo match.
    pub struct Settings {
        /// Number of disparities searched, from 0 px up. The nearest point that can be matched has the largest one.
        disparities: usize = 64, 2..=256, "px";
        /// Uniqueness: how much higher than the minimum the cost of any disparity that is not its neighbour must be. 0 switches the test off.
        uniqueness: usize = 10, 0..=100, "%";
        /// Left–right check: largest difference of the disparities found from the left and from the right view.
        max_difference: usize = 1, 0..=255, "px";
        /// Refine each disparity by a parabola through the costs of the minimum and of its neighbours.
        subpixel: bool = true;
    }
}

impl Settings {
    /// Whether the disparity of a pixel in column `x` is refined: a parabola needs a neighbour on both sides.
    #[inline(always)]
    pub(crate) fn is_refined(&self, best: usize, x: usize) -> bool {
        self.subpixel && best > 0 && best < x.min(self.disparities - 1)
    }
}
