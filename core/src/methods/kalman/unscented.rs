//! The unscented transform: mean and covariance through a nonlinear function by sigma points.
//!
//! S. J. Julier and J. K. Uhlmann, Unscented filtering and nonlinear estimation, Proceedings of the IEEE 92, 2004.

use nalgebra::{Cholesky, Const, SMatrix, SVector};

use super::{Estimate, Motion, Prediction};

/// Weight W₀ of the sigma point at the mean. It is positive, so that the predicted covariance is positive semidefinite.
pub const CENTER_WEIGHT: f64 = 1.0 / 3.0;

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

/// The distance c of the points of a pair from the mean, in columns of the Cholesky factor.
fn distance<const N: usize>() -> f64 {
    (N as f64 / (1.0 - CENTER_WEIGHT)).sqrt()
}

impl<const N: usize> SigmaPoints<N> {
    /// Draws the sigma points of an estimate; `None` if its covariance is not positive definite.
    pub fn of(estimate: &Estimate<N>) -> Option<Self> {
        let factor = Cholesky::new(estimate.covariance)?;
        let columns = factor.l();
        let pairs = std::array::from_fn(|i| {
            let step = columns.column(i) * distance::<N>();
            [estimate.state + step, estimate.state - step]
        });
        Some(Self { center: estimate.state, pairs, factor })
    }

    /// Moves each point by the motion model.
    #[must_use]
    pub fn moved(&self, motion: &impl Motion<N>) -> Self {
        let pairs = self.pairs.each_ref().map(|pair| pair.each_ref().map(|point| motion.moved(point)));
        Self { center: motion.moved(&self.center), pairs, factor: self.factor.clone() }
    }

    /// Returns the weighted mean and covariance.
    pub fn moments(&self) -> Estimate<N> {
        let weight = (1.0 - CENTER_WEIGHT) / (2 * N) as f64;
        let points = || self.pairs.iter().flatten();
        let state = points().fold(self.center * CENTER_WEIGHT, |sum, point| sum + point * weight);
        let spread = |point: &SVector<f64, N>| (point - state) * (point - state).transpose();
        let covariance = points().fold(spread(&self.center) * CENTER_WEIGHT, |sum, point| sum + spread(point) * weight);
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
        differences.set_column(i, &((ahead - behind) / (2.0 * distance::<N>())));
    }
    let transition = drawn.factor.l().transpose().solve_upper_triangular(&differences.transpose())?.transpose();
    let (moments, noise) = (moved.moments(), motion.noise());
    let covariance = super::filter::symmetric(moments.covariance + noise);
    Some(Prediction { transition, noise, estimate: Estimate { state: moments.state, covariance } })
}
