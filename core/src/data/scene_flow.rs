//! Measurements of a point in two views at two times, and its motion in space with its covariance.
//!
//! ```text
//!   m = (x, y, d, u, v, d')         P  = B/d  (x − cx, y − cy, f)ᵀ
//!                                   P' = B/d' (x + u − cx, y + v − cy, f)ᵀ
//!   V = P' − P                      Σ_V = σ_d² (P Pᵀ/d² + P' P'ᵀ/d'²) + σ_f² (B/d')² diag(1, 1, 0)
//! ```

use nalgebra::{Matrix3, Vector3};

use super::{Calibration, Pose};

/// A 3×3 covariance in m², row by row.
type Covariance = [[f64; 3]; 3];

/// Standard deviations of the measurements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sigma {
    /// Of a disparity in px.
    pub disparity_px: f64,
    /// Of each component of the flow in px.
    pub flow_px: f64,
}

/// Measurements of a point in both views at two times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Pixel of the left view of frame t.
    pub pixel: [f64; 2],
    /// Disparity in px.
    pub disparity: f64,
    /// Flow to frame t + 1 in px.
    pub flow: [f64; 2],
    /// Disparity in frame t + 1 in px.
    pub next_disparity: f64,
}

/// The positions of a point in the coordinates of the left camera at both times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpaceMotion {
    /// Position in frame t in m.
    pub from: [f64; 3],
    /// Position in frame t + 1 in m.
    pub to: [f64; 3],
    /// Both disparities in px, with the offset of the principal points.
    shifts: [f64; 2],
    /// Metres in space for a pixel in frame t + 1.
    metres_per_px: f64,
}

impl Measured {
    /// Its pixel in frame t + 1.
    pub fn next_pixel(&self) -> [f64; 2] {
        [0, 1].map(|i| self.pixel[i] + self.flow[i])
    }

    /// The positions by triangulation; `None` if one is at infinity.
    pub fn in_space(&self, rig: &Calibration) -> Option<SpaceMotion> {
        let to = rig.point_m(self.next_pixel(), self.next_disparity)?;
        Some(SpaceMotion {
            from: rig.point_m(self.pixel, self.disparity)?,
            to,
            shifts: [self.disparity, self.next_disparity].map(|d| d + rig.offset_px),
            metres_per_px: to[2] / rig.focal_px,
        })
    }
}

fn outer(a: [f64; 3], factor: f64) -> Covariance {
    a.map(|row| a.map(|column| factor * row * column))
}

impl SpaceMotion {
    /// The scene flow V = P′ − P in m.
    pub fn displacement(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| self.to[i] - self.from[i])
    }

    /// The motion of its own in m: what remains of the scene flow after a rigid motion of the scene, P′ − (R P + t).
    pub fn own(&self, ego: &Pose) -> [f64; 3] {
        let predicted = ego.moved(self.from);
        [0, 1, 2].map(|i| self.to[i] - predicted[i])
    }

    /// The covariance of [`SpaceMotion::own`] to first order; with the identity that of the displacement. The uncertainty of the motion of the
    /// cameras is neglected, as hundreds of points determine it.
    pub fn covariance(&self, ego: &Pose, sigma: &Sigma) -> Covariance {
        let share = |i: usize| (sigma.disparity_px / self.shifts[i]).powi(2);
        let (before, after) = (outer(ego.turned(self.from), share(0)), outer(self.to, share(1)));
        let across = (sigma.flow_px * self.metres_per_px).powi(2);
        let of_flow = |i: usize, j: usize| if i == j && i < 2 { across } else { 0.0 };
        [0, 1, 2].map(|i| [0, 1, 2].map(|j| before[i][j] + after[i][j] + of_flow(i, j)))
    }
}

/// The squared Mahalanobis distance of a vector from zero; infinite for a singular covariance.
pub(crate) fn mahalanobis_squared(vector: [f64; 3], covariance: &Covariance) -> f64 {
    let matrix = Matrix3::from_fn(|i, j| covariance[i][j]);
    let vector = Vector3::from(vector);
    matrix.try_inverse().map_or(f64::INFINITY, |inverse| (vector.transpose() * inverse * vector)[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rig() -> Calibration {
        Calibration::new(300.0, 0.5, [159.5, 119.5]).unwrap()
    }

    #[test]
    fn covariances_are_those_of_small_errors() {
        let measured = Measured { pixel: [40.0, 200.0], disparity: 18.0, flow: [-6.0, 3.0], next_disparity: 19.5 };
        let ego = Pose::IDENTITY.after([[0.01, -0.02, 0.005], [0.1, 0.0, -0.3]]);
        let own = |m: Measured| m.in_space(&rig()).unwrap().own(&ego);
        let sigma = Sigma { disparity_px: 0.25, flow_px: 0.4 };
        let at = own(measured);
        // J Σ Jᵀ with a Jacobian by central differences.
        let step = 1e-4;
        let changed: [fn(Measured, f64) -> Measured; 4] = [
            |m, by| Measured { disparity: m.disparity + by, ..m },
            |m, by| Measured { next_disparity: m.next_disparity + by, ..m },
            |m, by| Measured { flow: [m.flow[0] + by, m.flow[1]], ..m },
            |m, by| Measured { flow: [m.flow[0], m.flow[1] + by], ..m },
        ];
        let mut expected = [[0.0; 3]; 3];
        for (change, sigma) in changed.iter().zip([0.25, 0.25, 0.4, 0.4]) {
            let (more, less) = (own(change(measured, step)), own(change(measured, -step)));
            let slope = [0, 1, 2].map(|i| (more[i] - less[i]) / (2.0 * step));
            let part = outer(slope, sigma * sigma);
            expected = [0, 1, 2].map(|i| [0, 1, 2].map(|j| expected[i][j] + part[i][j]));
        }
        let found = measured.in_space(&rig()).unwrap().covariance(&ego, &sigma);
        for (a, b) in found.as_flattened().iter().zip(expected.as_flattened()) {
            assert!((a - b).abs() < 1e-7 * (1.0 + b.abs()), "{found:?} {expected:?}");
        }
        assert!(mahalanobis_squared(at, &found) > 0.0 && mahalanobis_squared(at, &[[0.0; 3]; 3]).is_infinite());
    }

    #[test]
    fn what_is_at_rest_has_no_motion_of_its_own() {
        let ego = Pose::IDENTITY.after([[0.0, 0.02, 0.0], [0.05, 0.0, -0.3]]);
        let point = [1.2, -0.4, 7.0];
        let [(from, disparity), (to, next_disparity)] = [point, ego.moved(point)].map(|at| rig().project(at).unwrap());
        let measured = Measured { pixel: from, disparity, flow: [to[0] - from[0], to[1] - from[1]], next_disparity };
        let motion = measured.in_space(&rig()).unwrap();
        assert!(motion.own(&ego).iter().all(|c| c.abs() < 1e-9));
        assert!((motion.displacement()[2] - (ego.moved(point)[2] - 7.0)).abs() < 1e-9);
        assert_eq!(Measured { next_disparity: 0.0, ..measured }.in_space(&rig()), None);
    }
}
