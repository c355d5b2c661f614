//! A state with its covariance, as estimated and as predicted.

use nalgebra::{SMatrix, SVector};

/// A state estimate of dimension `N`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate<const N: usize> {
    /// The state x.
    pub state: SVector<f64, N>,
    /// Its covariance P.
    pub covariance: SMatrix<f64, N, N>,
}

/// A prediction and its matrices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction<const N: usize> {
    /// State transition F; of a nonlinear motion the Jacobian, or the statistical linearisation by sigma points.
    pub transition: SMatrix<f64, N, N>,
    /// Process noise covariance Q.
    pub noise: SMatrix<f64, N, N>,
    /// The predicted estimate.
    pub estimate: Estimate<N>,
}

/// Symmetrises a covariance against rounding.
pub(super) fn symmetric<const N: usize>(matrix: SMatrix<f64, N, N>) -> SMatrix<f64, N, N> {
    (matrix + matrix.transpose()) * 0.5
}
