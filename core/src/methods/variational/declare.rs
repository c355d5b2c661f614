//! Parameters that all variational methods share.

use crate::methods::differential::Scheme;
use crate::params;

params! {
    /// Parameters that all variational methods share.
    #[derive(Copy)]
    pub struct Settings {
        /// Number of iterations per warp.
        iterations: usize = 100, 1..=1000;
        /// Stopping criterion: the iterations of a warp end when the mean change of the flow is smaller, in px of level 0; tested every 8 iterations. 0 does all iterations.
        tolerance: f32 = 0.0, 0.0..=1.0, "px";
        /// Number of pyramid levels, each half the size of the one below, down to 16 px per side. More levels reach larger motion; 1 uses full resolution only.
        levels: usize = 4, 1..=10;
        /// Number of warps per level: each warps frame t+1 toward frame t by the current flow and linearises again.
        warps: usize = 3, 1..=20;
        /// Kernel that estimates the derivatives I_x and I_y.
        derivatives: Scheme = Scheme::FivePoint;
        /// Standard deviation σ of the Gaussian that smooths both frames before derivatives are taken. 0 does not smooth.
        sigma: f32 = 0.0, 0.0..=5.0, "px";
    }
    advanced { "tolerance", "derivatives" }
}
