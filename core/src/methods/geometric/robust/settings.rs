//! The parameters of robust estimation.

use crate::methods::geometric::ransac::Scoring;
use crate::params;

params! {
    /// Parameters of random sample consensus.
    pub struct Settings {
        /// Score of a hypothesis.
        scoring: Scoring = Scoring::LoRansac;
        /// Largest distance of an inlier from the model.
        threshold: f32 = 3.0, 0.1..=50.0, "px";
        /// Probability of drawing at least one sample without outliers, which decides the number of iterations.
        confidence: f32 = 0.99, 0.5..=0.99999;
        /// Largest number of iterations.
        max_iterations: usize = 2000, 1..=100_000;
        /// Share of the matches that are replaced by random ones. The number of iterations grows steeply with it.
        outliers: f32 = 0.0, 0.0..=0.95;
        /// Random seed. The same seed draws the same samples.
        seed: usize = 1, 0..=1_000_000;
    }
    advanced { "confidence", "max-iterations", "seed" }
}
