//! The normalisation of points before a linear fit (Hartley and Zisserman 2004, section 4.4).

use crate::products::model::Matrix3;

/// The mean of points; the origin if there are none.
pub(super) fn mean(points: impl Iterator<Item = [f64; 2]> + Clone) -> [f64; 2] {
    let count = points.clone().count().max(1) as f64;
    points.fold([0.0; 2], |sum, p| [sum[0] + p[0], sum[1] + p[1]]).map(|sum| sum / count)
}

/// A similarity that moves points to mean zero and mean distance √2, as the factor and the mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Normalisation {
    /// The mean.
    pub mean: [f64; 2],
    /// The factor.
    pub scale: f64,
}

impl Normalisation {
    /// The normalisation of points; `None` if all are at one place.
    pub fn of(points: impl Iterator<Item = [f64; 2]> + Clone) -> Option<Self> {
        let mean = mean(points.clone());
        let count = points.clone().count() as f64;
        let length = |[x, y]: [f64; 2]| ((x - mean[0]).powi(2) + (y - mean[1]).powi(2)).sqrt();
        let distance = points.map(length).sum::<f64>() / count;
        (distance > 1e-9).then(|| Self { mean, scale: std::f64::consts::SQRT_2 / distance })
    }

    /// A normalised point.
    #[inline(always)]
    pub fn apply(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [(x - self.mean[0]) * self.scale, (y - self.mean[1]) * self.scale]
    }

    /// Its matrix.
    pub fn matrix(&self) -> Matrix3 {
        let Self { mean: [x, y], scale } = *self;
        [[scale, 0.0, -scale * x], [0.0, scale, -scale * y], [0.0, 0.0, 1.0]]
    }

    /// The matrix of the way back.
    pub fn inverse(&self) -> Matrix3 {
        let Self { mean: [x, y], scale } = *self;
        [[1.0 / scale, 0.0, x], [0.0, 1.0 / scale, y], [0.0, 0.0, 1.0]]
    }
}
