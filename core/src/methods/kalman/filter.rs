//! Prediction, innovation, update and smoothing as single steps.

use nalgebra::{Cholesky, Const, SMatrix, SVector};

use super::estimate::{Estimate, Prediction, symmetric};
use super::{Motion, unscented};

/// A sensor of `M` components of a state of dimension `N`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor<const N: usize, const M: usize> {
    /// Measurement matrix H.
    pub observation: SMatrix<f64, M, N>,
    /// Measurement noise covariance R.
    pub noise: SMatrix<f64, M, M>,
}

impl<const N: usize, const M: usize> Sensor<N, M> {
    /// Creates a sensor of the first `M` components of the state, each with its standard deviation.
    pub fn first(deviations: [f64; M]) -> Self {
        let variances = SVector::from(deviations).map(|deviation| deviation * deviation);
        Self { observation: SMatrix::identity(), noise: SMatrix::from_diagonal(&variances) }
    }
}

/// The innovation of a measurement.
#[derive(Clone, Debug)]
pub struct Innovation<const M: usize> {
    /// Innovation ν = z − H x.
    pub residual: SVector<f64, M>,
    /// Innovation covariance S = H P Hᵀ + R.
    pub covariance: SMatrix<f64, M, M>,
    /// Squared Mahalanobis distance d² = νᵀ S⁻¹ ν: the normalised innovation squared (NIS).
    pub squared_distance: f64,
    factor: Cholesky<f64, Const<M>>,
}

/// The update by a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Update<const N: usize, const M: usize> {
    /// Kalman gain K = P Hᵀ S⁻¹.
    pub gain: SMatrix<f64, N, M>,
    /// The resulting estimate.
    pub estimate: Estimate<N>,
}

impl<const M: usize> Innovation<M> {
    /// Returns the natural logarithm of the likelihood of the measurement, of N(ν; 0, S).
    pub fn log_likelihood(&self) -> f64 {
        let log_determinant: f64 = 2.0 * self.factor.l_dirty().diagonal().map(f64::ln).sum();
        -0.5 * (self.squared_distance + log_determinant + M as f64 * std::f64::consts::TAU.ln())
    }
}

/// The update by several measurements with their probabilities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Association<const N: usize, const M: usize> {
    /// The combined innovation ν = Σ β_j ν_j.
    pub innovation: SVector<f64, M>,
    /// The innovation covariance S = H P Hᵀ + R.
    pub covariance: SMatrix<f64, M, M>,
    /// The spread of the innovations Σ β_j ν_j ν_jᵀ − ν νᵀ.
    pub spread: SMatrix<f64, M, M>,
    /// The Kalman gain K.
    pub gain: SMatrix<f64, N, M>,
    /// The resulting estimate.
    pub estimate: Estimate<N>,
}

impl<const N: usize> Estimate<N> {
    /// Predicts the next frame: x ← f(x), P ← F P Fᵀ + Q; or by sigma points, where the motion asks for them and P is positive definite.
    pub fn predicted(&self, motion: &impl Motion<N>) -> Prediction<N> {
        let by_points = motion.is_unscented().then(|| unscented::predicted(self, motion)).flatten();
        by_points.unwrap_or_else(|| self.linearised(motion))
    }

    /// Predicts by the Jacobian of the motion.
    fn linearised(&self, motion: &impl Motion<N>) -> Prediction<N> {
        let (transition, noise) = (motion.transition(&self.state), motion.noise());
        let covariance = transition * self.covariance * transition.transpose() + noise;
        let estimate = Estimate { state: motion.moved(&self.state), covariance: symmetric(covariance) };
        Prediction { transition, noise, estimate }
    }

    /// Returns the innovation of a measurement; `None` if its covariance is not positive definite.
    pub fn innovation<const M: usize>(
        &self,
        sensor: &Sensor<N, M>,
        measured: &SVector<f64, M>,
    ) -> Option<Innovation<M>> {
        let Sensor { observation, noise } = sensor;
        let residual = measured - observation * self.state;
        let covariance = symmetric(observation * self.covariance * observation.transpose() + noise);
        let factor = Cholesky::new(covariance)?;
        // |L⁻¹ ν|² for S = L Lᵀ: never negative.
        let whitened = factor.l_dirty().solve_lower_triangular(&residual)?;
        let squared_distance = whitened.norm_squared();
        squared_distance.is_finite().then_some(Innovation { residual, covariance, squared_distance, factor })
    }

    /// Updates the estimate: x ← x + K ν, and in Joseph's form, which keeps P symmetric and positive definite,
    /// P ← (I − K H) P (I − K H)ᵀ + K R Kᵀ.
    pub fn updated<const M: usize>(&self, sensor: &Sensor<N, M>, innovation: &Innovation<M>) -> Update<N, M> {
        let Sensor { observation, noise } = sensor;
        // K = P Hᵀ S⁻¹, from S Kᵀ = H P.
        let gain = innovation.factor.solve(&(observation * self.covariance)).transpose();
        let rest = SMatrix::identity() - gain * observation;
        let covariance = rest * self.covariance * rest.transpose() + gain * noise * gain.transpose();
        let state = self.state + gain * innovation.residual;
        Update { gain, estimate: Estimate { state, covariance: symmetric(covariance) } }
    }

    /// Updates the estimate with several measurements of one sensor, each with the probability of being the one of the object (PDA:
    /// Y. Bar-Shalom and E. Tse 1975, as in JPDA). The combined innovation is Σ β_j ν_j, and with β₀ = 1 − Σ β_j
    /// P ← β₀ P + (1 − β₀) P_c + K (Σ β_j ν_j ν_jᵀ − ν νᵀ) Kᵀ, where P_c is the covariance after one certain measurement. `None` if the
    /// innovation covariance is not positive definite.
    pub fn associated<const M: usize>(
        &self,
        sensor: &Sensor<N, M>,
        measured: &[(SVector<f64, M>, f64)],
    ) -> Option<Association<N, M>> {
        let first = self.innovation(sensor, &(sensor.observation * self.state))?;
        let residual = |at: &SVector<f64, M>| at - sensor.observation * self.state;
        let (mut innovation, mut second, mut share) = (SVector::<f64, M>::zeros(), SMatrix::<f64, M, M>::zeros(), 0.0);
        for (at, probability) in measured {
            let one = residual(at);
            innovation += one * *probability;
            second += one * one.transpose() * *probability;
            share += probability;
        }
        let spread = symmetric(second - innovation * innovation.transpose());
        let certain = self.updated(sensor, &first);
        let gain = certain.gain;
        let missed = (1.0 - share).max(0.0);
        let covariance =
            self.covariance * missed + certain.estimate.covariance * (1.0 - missed) + gain * spread * gain.transpose();
        let estimate = Estimate { state: self.state + gain * innovation, covariance: symmetric(covariance) };
        Some(Association { innovation, covariance: first.covariance, spread, gain, estimate })
    }

    /// Returns the normalised estimation error squared (NEES) of the true state; `None` if P is not positive definite.
    pub fn squared_error(&self, truth: &SVector<f64, N>) -> Option<f64> {
        let factor = Cholesky::new(self.covariance)?;
        Some(factor.l_dirty().solve_lower_triangular(&(truth - self.state))?.norm_squared())
    }
}

/// The smoothed estimate of a frame, given all later measurements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoothed<const N: usize> {
    /// Smoother gain C = P Fᵀ P⁻¹, the second P being the predicted covariance.
    pub gain: SMatrix<f64, N, N>,
    /// The resulting estimate.
    pub estimate: Estimate<N>,
}

/// Smooths one frame backward (RTS), given its filtered estimate, the prediction of the next frame and the smoothed estimate of
/// that; `None` if the predicted covariance is not positive definite.
///
/// H. E. Rauch, F. Tung and C. T. Striebel, Maximum likelihood estimates of linear dynamic systems, 1965.
pub fn smoothed<const N: usize>(
    filtered: &Estimate<N>,
    prediction: &Prediction<N>,
    next: &Estimate<N>,
) -> Option<Smoothed<N>> {
    let expected = &prediction.estimate;
    let factor = Cholesky::new(expected.covariance)?;
    let gain = factor.solve(&(prediction.transition * filtered.covariance)).transpose();
    let state = filtered.state + gain * (next.state - expected.state);
    let covariance = filtered.covariance + gain * (next.covariance - expected.covariance) * gain.transpose();
    Some(Smoothed { gain, estimate: Estimate { state, covariance: symmetric(covariance) } })
}
