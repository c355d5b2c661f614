//! The test of a filter's covariance by the mean NIS: Bar-Shalom, section 5.4.

use super::chi_square;
use super::vocabulary::{case, value};
use crate::scene::Step;

/// The mean NIS of measurements and its two-sided 95 % band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConsistencyTest {
    /// The mean NIS.
    pub mean: f64,
    /// The band of a consistent filter.
    pub band: [f64; 2],
    /// The dimension of a measurement: the expected NIS.
    pub dof: usize,
}

impl ConsistencyTest {
    /// Returns the test of the NIS of measurements of dimension `dof`; `None` without any.
    pub fn of(nis: &[f64], dof: usize) -> Option<Self> {
        let number = nis.len() as f64;
        let mean = (!nis.is_empty()).then(|| nis.iter().sum::<f64>() / number)?;
        let band = [0.025, 0.975].map(|p| chi_square::quantile(p, dof * nis.len()) / number);
        Some(Self { mean, band, dof })
    }

    /// Whether the covariance is too small: the filter is overconfident.
    pub fn is_above(&self) -> bool {
        self.mean > self.band[1]
    }

    /// Tells the outcome and the remedy.
    pub fn tell(&self, step: Step, is_biased: bool) -> Step {
        let Self { mean, band: [low, high], .. } = *self;
        let step = step.put(value::MEAN_NIS, mean).put(value::BAND_LOW, low).put(value::BAND_HIGH, high);
        step.say(match mean {
            _ if self.is_above() => case::NIS_ABOVE,
            mean if mean < low => case::NIS_BELOW,
            _ if is_biased => case::NIS_WITHIN,
            _ => case::CONSISTENT,
        })
    }
}
