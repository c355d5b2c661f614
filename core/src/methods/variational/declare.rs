//! What every variational method declares, once.

use crate::methods::differential::Scheme;
use crate::params;

params! {
    /// The parameters that all variational methods have.
    #[derive(Copy)]
    pub struct Settings {
        /// Iterations for each level and warp.
        iterations: usize = 100, 1..=1000;
        /// Go on to the next warp when an iteration changes displacements by less on average, in px of the picture; 0 does all iterations.
        tolerance: f32 = 0.0, 0.0..=1.0, "px";
        /// Levels of the pyramid, each half as large as the one before; fewer where a side would be less than 16 px. 1 works on the picture alone.
        levels: usize = 4, 1..=10;
        /// How often on each level frame t+1 is brought back by what was found, and its derivatives taken anew.
        warps: usize = 3, 1..=20;
        /// How derivatives are estimated from pixels.
        derivatives: Scheme = Scheme::FivePoint;
        /// Standard deviation of the Gaussian that smooths both frames first; 0 leaves them as they are.
        smoothing: f32 = 0.0, 0.0..=5.0, "px";
    }
    advanced { "tolerance", "derivatives" }
}
