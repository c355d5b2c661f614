//! The unscented transform: mean and covariance through a nonlinear function by sigma points.
//!
//! S. J. Julier and J. K. Uhlmann, Unscented filtering and nonlinear estimation, Proceedings of the IEEE 92, 2004; weights of the
//! covariance: E. A. Wan and R. van der Merwe, The unscented Kalman filter for nonlinear estimation, AS-SPCC 2000, with α = 1,
//! κ = 3 − n and β = 2.

use nalgebra::{Cholesky, Const, SMatrix, SVector};

use super::Motion;
use super::estimate::{Estimate, Prediction, symmetric};

/// The square of the distance c of the points of a pair from the mean, in columns of the Cholesky factor: with n + κ = 3 the points
/// have the kurtosis of a normal distribution along each column.
pub const SQUARED_DISTANCE: f64 = 3.0;
/// The prior knowledge β of the distribution; 2 is the best for normal ones. With it no weight of the covariance is negative.
pub const BETA: f64 = 2.0;

/// The weights of sigma points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Of the point at the mean, for the mean.
    pub center: f64,
    /// Of the point at the mean, for the covariance.
    pub center_spread: f64,
    /// Of each other point.
    pub pair: f64,
}

impl Weights {
    /// Returns the weights of the points of a state of dimension `n`.
    pub fn of(n: usize) -> Self {
        let center = 1.0 - n as f64 / SQUARED_DISTANCE;
        Self { center, center_spread: center + BETA, pair: 0.5 / SQUARED_DISTANCE }
    }
}

/// The sigma points of an estimate.
#[derive(Clone, Debug)]
pub struct SigmaPoints<const N: usize> {
    /// The point at the mean.
    pub center: SVector<f64, N>,
    /// A pair for each column of the Cholesky factor L of P: x + c L and x − c L.
    pub pairs: [[SVector<f64, N>; 2]; N],
    /// L, where the points are those of an estimate.
    factor: Cholesky<f64, Const<N>>,
}

impl<const N: usize> SigmaPoints<N> {
    /// Draws the sigma points of an estimate; `None` if its covariance is not positive definite.
    pub fn of(estimate: &Estimate<N>) -> Option<Self> {
        let factor = Cholesky::new(estimate.covariance)?;
        let columns = factor.l();
        let pairs = std::array::from_fn(|i| {
            let step = columns.column(i) * SQUARED_DISTANCE.sqrt();
            [estimate.state + step, estimate.state - step]
        });
        Some(Self { center: estimate.state, pairs, factor })
    }

    /// Moves each point by the motion model.
    #[must_use]
    pub fn moved(&self, motion: &impl Motion<N>) -> Self {
        let pairs = self.pairs.each_ref().map(|pair| pair.each_ref().map(|point| motion.moved(point)));
        Self { center: motion.moved(&self.center), pairs, factor: self.factor }
    }

    /// Returns the weighted mean and covariance.
    pub fn moments(&self) -> Estimate<N> {
        let Weights { center, center_spread, pair } = Weights::of(N);
        let points = || self.pairs.iter().flatten();
        let state = points().fold(self.center * center, |sum, point| sum + point * pair);
        let spread = |point: &SVector<f64, N>| (point - state) * (point - state).transpose();
        let covariance = points().fold(spread(&self.center) * center_spread, |sum, point| sum + spread(point) * pair);
        Estimate { state, covariance }
    }
}

/// Predicts by sigma points. The transition is that of the statistical linearisation, A = Ψᵀ P⁻¹ with the covariance Ψ of the state
/// before and after the motion: the Jacobian of a linear motion. `None` if P is not positive definite.
pub fn predicted<const N: usize>(estimate: &Estimate<N>, motion: &impl Motion<N>) -> Option<Prediction<N>> {
    let drawn = SigmaPoints::of(estimate)?;
    let moved = drawn.moved(motion);
    // Ψᵀ = D Lᵀ with the central differences D of the pairs, because their weight times c² is ½. So A = D L⁻¹.
    let mut differences = SMatrix::<f64, N, N>::zeros();
    for (i, [ahead, behind]) in moved.pairs.iter().enumerate() {
        differences.set_column(i, &((ahead - behind) / (2.0 * SQUARED_DISTANCE.sqrt())));
    }
    let transition = drawn.factor.l().transpose().solve_upper_triangular(&differences.transpose())?.transpose();
    let (moments, noise) = (moved.moments(), motion.noise());
    let covariance = symmetric(moments.covariance + noise);
    Some(Prediction { transition, noise, estimate: Estimate { state: moments.state, covariance } })
}
