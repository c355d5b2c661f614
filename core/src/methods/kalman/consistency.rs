//! The test of a filter's covariance by the mean NIS: Bar-Shalom, section 5.4.

use super::chi_square;
use crate::methods::numbers::squared;

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

    /// The outcome in words, and the remedy.
    pub fn verdict(&self, is_biased: bool) -> String {
        let Self { mean, band: [low, high], .. } = *self;
        let (place, verdict) = match mean {
            _ if self.is_above() => (
                "above",
                ". The covariance is too small (overconfident): raise the process noise Q or the measurement noise R.",
            ),
            mean if mean < low => (
                "below",
                ". The covariance is too large (underconfident): lower the process noise Q or the measurement noise R.",
            ),
            _ if is_biased => {
                ("within", ": the innovations agree with S in size, so NIS alone does not show the bias.")
            }
            _ => ("within", ": the filter is consistent."),
        };
        let [mean, low, high] = [mean, low, high].map(squared);
        format!(" Mean NIS {mean} is {place} the 95 % band {low}–{high}{verdict}")
    }
}
