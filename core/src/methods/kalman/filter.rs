//! Predict, gate, update and smooth, each by itself.

use nalgebra::{Cholesky, Const, SMatrix, SVector};

use super::Motion;

/// A state estimate: `N` numbers and their covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate<const N: usize> {
    /// The expected state x.
    pub state: SVector<f64, N>,
    /// Its covariance P.
    pub covariance: SMatrix<f64, N, N>,
}

/// A step of time, and what it was made with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction<const N: usize> {
    /// How the state goes on: F, or the Jacobian of the motion where that is not linear.
    pub transition: SMatrix<f64, N, N>,
    /// What is uncertain about that: Q.
    pub noise: SMatrix<f64, N, N>,
    /// What is expected now.
    pub estimate: Estimate<N>,
}

/// How something measures `M` numbers of a state of `N`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor<const N: usize, const M: usize> {
    /// What it measures of the state: H.
    pub observation: SMatrix<f64, M, N>,
    /// How uncertain that is: R.
    pub noise: SMatrix<f64, M, M>,
}

impl<const N: usize, const M: usize> Sensor<N, M> {
    /// One that measures the first `M` numbers of the state, each with its standard deviation.
    pub fn first(deviations: [f64; M]) -> Self {
        let variances = SVector::from(deviations).map(|deviation| deviation * deviation);
        Self { observation: SMatrix::identity(), noise: SMatrix::from_diagonal(&variances) }
    }
}

/// How a measurement differs from what was expected.
#[derive(Clone, Debug)]
pub struct Innovation<const M: usize> {
    /// The measurement less what was expected: ν = z − H x.
    pub residual: SVector<f64, M>,
    /// What the residual's covariance should be: S = H P Hᵀ + R.
    pub covariance: SMatrix<f64, M, M>,
    /// The squared Mahalanobis distance νᵀ S⁻¹ ν, also called normalised innovation squared.
    pub squared_distance: f64,
    factor: Cholesky<f64, Const<M>>,
}

/// What a measurement changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Update<const N: usize, const M: usize> {
    /// How far the estimate moves towards the measurement: K = P Hᵀ S⁻¹.
    pub gain: SMatrix<f64, N, M>,
    /// The state estimate.
    pub estimate: Estimate<N>,
}

impl<const N: usize> Estimate<N> {
    /// A step of time: x ← f(x), P ← F P Fᵀ + Q.
    pub fn predicted(&self, motion: &impl Motion<N>) -> Prediction<N> {
        let (transition, noise) = (motion.transition(&self.state), motion.noise());
        let covariance = transition * self.covariance * transition.transpose() + noise;
        let estimate = Estimate { state: motion.moved(&self.state), covariance: symmetric(covariance) };
        Prediction { transition, noise, estimate }
    }

    /// How a measurement differs from what is expected; `None` if its covariance is not positive definite.
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

    /// The state estimate after a measurement: x ← x + K ν, and in Joseph's form, which keeps it symmetric and positive,
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

    /// The squared Mahalanobis distance of the true state, normalised estimation error squared; `None` if P is not positive
    /// definite.
    pub fn squared_error(&self, truth: &SVector<f64, N>) -> Option<f64> {
        let factor = Cholesky::new(self.covariance)?;
        Some(factor.l_dirty().solve_lower_triangular(&(truth - self.state))?.norm_squared())
    }
}

/// Rounding must not make a covariance lopsided.
fn symmetric<const N: usize>(matrix: SMatrix<f64, N, N>) -> SMatrix<f64, N, N> {
    (matrix + matrix.transpose()) * 0.5
}

/// The smoothed estimate of a step, once all later measurements are known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smoothed<const N: usize> {
    /// How far what is known of the next step reaches back: C = P Fᵀ P⁻¹, the second P that of the prediction.
    pub gain: SMatrix<f64, N, N>,
    /// The state estimate.
    pub estimate: Estimate<N>,
}

/// Walks a step back: from the estimate after step t, how step t + 1 was predicted from that, and what step t + 1 was
/// smoothed to. `None` if the prediction's covariance is not positive definite.
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
