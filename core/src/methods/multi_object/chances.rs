//! The probabilities of detections, which trackers that weigh several explanations share.

use super::Extent;
use super::gating::{ln_likelihood, ln_size_ratio};
use crate::data::Detection;
use crate::methods::kalman::{Filter, Measurement, chi_square};
use crate::params;

params! {
    /// The probabilities of detections.
    pub struct Chances {
        /// Gate probability P_G: share of the true measurements inside the gate. It sets the gating threshold of d² by the χ² distribution with 2 degrees of freedom.
        gate: f32 = 0.999, 0.5..=0.9999;
        /// Detection probability P_D: the share of the frames in which an object is detected.
        detection_probability: f32 = 0.9, 0.01..=0.999;
        /// Expected number of false alarms per frame, anywhere in the picture. Over the area of the picture it is their density.
        false_alarms: f32 = 1.0, 0.001..=1000.0;
        /// Standard deviation of the logarithm of a detected width and height from those of the track: 0.2 is about 20 %.
        size_noise: f32 = 0.2, 0.01..=2.0;
    }
}

impl Chances {
    /// The gating threshold of d².
    pub(crate) fn limit(&self) -> f64 {
        chi_square::quantile(f64::from(self.gate), 2)
    }

    /// P_D.
    pub(crate) fn detected(&self) -> f64 {
        self.detection_probability.into()
    }

    /// The probability 1 − P_D P_G that an object has no detection in its gate: it is not detected, or outside the gate (Y. Bar-Shalom and
    /// X. Li, Multitarget-multisensor tracking, 1995, section 3.4). Published formulas of multiple hypothesis tracking have 1 − P_D (I. J. Cox
    /// and S. L. Hingorani 1996), which is its limit for a gate that holds all measurements.
    pub(crate) fn missed(&self) -> f64 {
        1.0 - self.detected() * f64::from(self.gate)
    }

    /// The false alarms per px² of a picture of this size.
    pub(crate) fn density(&self, (width, height): (usize, usize)) -> f64 {
        f64::from(self.false_alarms) / (width * height) as f64
    }

    /// Returns the logarithms of N(ν; 0, S) of a measurement at d² and of the likelihood ratio of the detection's size.
    pub(crate) fn ln_likelihoods(
        &self,
        (filter, extent): (&Filter, &Extent),
        (found, measured): (&Detection, &Measurement),
        squared: f64,
    ) -> [f64; 2] {
        [ln_likelihood(filter, measured, squared), ln_size_ratio(extent, found, self.size_noise.into())]
    }
}
