//! Stereo: the viewpoints of a rig of two cameras, its calibration, and disparities.
//!
//! ```text
//!              P                     Z = f B / d
//!             ╱ ╲
//!       x_l  ╱   ╲  x_r              d = x_l − x_r, in px
//!     ──●───╱   ──╲─●──              image lines, f px before the cameras
//!        ○─────────○
//!       left   B   right             baseline, in m
//! ```

use crate::base::Error;
use crate::geometry::Grid;

/// The viewpoint of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Viewpoint {
    /// The only camera, or the left one of two.
    #[default]
    Left,
    /// The right one of two.
    Right,
}

/// The disparity d of every pixel of the left view in px: the point at (x, y) appears at (x − d, y) in the right view. A pixel of
/// unknown disparity holds NaN.
#[derive(Clone, Debug)]
pub struct Disparity(pub Grid<f32>);

/// Two are equal where both are unknown as well.
impl PartialEq for Disparity {
    fn eq(&self, other: &Self) -> bool {
        let same = |(a, b): (&f32, &f32)| a == b || a.is_nan() && b.is_nan();
        self.0.size() == other.0.size() && self.0.cells().iter().zip(other.0.cells()).all(same)
    }
}

impl Disparity {
    /// The value of a pixel of unknown disparity.
    pub const UNKNOWN: f32 = f32::NAN;

    /// The disparity at `(x, y)` in px, if it is known.
    pub fn at(&self, x: usize, y: usize) -> Option<f32> {
        self.0.get(x, y).copied().filter(|d| d.is_finite())
    }

    /// Number of pixels of known disparity.
    pub fn known(&self) -> usize {
        self.0.cells().iter().filter(|d| d.is_finite()).count()
    }
}

/// The calibration of a rectified pair of cameras: what turns disparities into metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// Focal length f in px, the same in both views.
    pub focal_px: f64,
    /// Baseline B in m: the distance of the cameras.
    pub baseline_m: f64,
    /// Principal point of the left view in px.
    pub principal_px: [f64; 2],
    /// The principal point of the right view minus that of the left one, along x in px: `doffs` of Middlebury. 0 where a point at infinity
    /// has the disparity 0.
    pub offset_px: f64,
}

impl Calibration {
    /// A calibration without an offset.
    ///
    /// # Errors
    /// If focal length or baseline is not positive, or a number is not finite.
    pub fn new(focal_px: f64, baseline_m: f64, principal_px: [f64; 2]) -> Result<Self, Error> {
        Self { focal_px, baseline_m, principal_px, offset_px: 0.0 }.checked()
    }

    /// The same if it is possible.
    ///
    /// # Errors
    /// As [`Calibration::new`].
    pub fn checked(self) -> Result<Self, Error> {
        for (name, unit, value) in [("focal length", "px", self.focal_px), ("baseline", "m", self.baseline_m)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::new(format!("the {name} must be a positive number of {unit}, not {value}")));
            }
        }
        let [x, y] = self.principal_px;
        if ![x, y, self.offset_px].iter().all(|value| value.is_finite()) {
            return Err(Error::new("the principal point must be two finite numbers of px"));
        }
        Ok(self)
    }

    /// The depth Z = f B / d in m of a disparity in px; `None` for a point at infinity or behind the cameras.
    pub fn depth_m(&self, disparity: f64) -> Option<f64> {
        let shift = disparity + self.offset_px;
        (shift > 0.0).then(|| self.focal_px * self.baseline_m / shift)
    }

    /// The disparity in px of a depth in m.
    pub fn disparity_px(&self, depth_m: f64) -> f64 {
        self.focal_px * self.baseline_m / depth_m - self.offset_px
    }

    /// The position [X, Y, Z] in m of a pixel of the left view with a disparity in px: X to the right, Y down, Z forwards from the left camera.
    pub fn point_m(&self, [x, y]: [f64; 2], disparity: f64) -> Option<[f64; 3]> {
        let depth = self.depth_m(disparity)?;
        let [cx, cy] = self.principal_px;
        Some([(x - cx) * depth / self.focal_px, (y - cy) * depth / self.focal_px, depth])
    }

    /// The pixel of the left view that a point in m is seen at, with its disparity in px; `None` unless it lies before the cameras.
    pub fn project(&self, [x, y, z]: [f64; 3]) -> Option<([f64; 2], f64)> {
        let [cx, cy] = self.principal_px;
        let at = |c: f64| self.focal_px * c / z;
        (z > 0.0).then(|| ([cx + at(x), cy + at(y)], at(self.baseline_m) - self.offset_px))
    }

    /// The standard deviation of a depth in m for one of the disparity in px, to first order: σ_Z = Z² σ_d / (f B).
    pub fn depth_sigma_m(&self, depth_m: f64, sigma_px: f64) -> f64 {
        depth_m * depth_m * sigma_px / (self.focal_px * self.baseline_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_triangulated_where_it_projects_from() {
        let rig = Calibration::new(300.0, 0.12, [159.5, 119.5]).unwrap();
        for [x, y, z] in [[0.0, 0.0, 2.0], [-0.4, 0.3, 1.5], [1.0, -0.7, 6.0]] {
            let place = |camera: f64| [159.5 + 300.0 * (x - camera) / z, 119.5 + 300.0 * y / z];
            let (left, right) = (place(0.0), place(0.12));
            let found = rig.point_m(left, left[0] - right[0]).unwrap();
            assert!([x, y, z].iter().zip(found).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
            let (at, disparity) = rig.project([x, y, z]).unwrap();
            assert!((at[0] - left[0]).abs() + (at[1] - left[1]).abs() + (disparity - left[0] + right[0]).abs() < 1e-9);
        }
        assert_eq!((rig.depth_m(0.0), rig.depth_m(-3.0)), (None, None), "at infinity, and behind the cameras");
        // To first order, an error of the disparity changes the depth by σ_Z.
        let (depth, off) = (rig.depth_m(18.0).unwrap(), rig.depth_m(18.01).unwrap());
        assert!((rig.depth_sigma_m(depth, 0.01) - (depth - off)).abs() < 1e-5);
        let shifted = Calibration { offset_px: 4.0, ..rig };
        assert_eq!(shifted.depth_m(14.0), rig.depth_m(18.0));
    }

    #[test]
    fn an_impossible_calibration_is_refused_with_the_reason() {
        let message = |focal, baseline| Calibration::new(focal, baseline, [0.0; 2]).unwrap_err().to_string();
        assert!(message(0.0, 0.1).contains("focal length") && message(300.0, -1.0).contains("baseline"));
        assert!(message(f64::NAN, 0.1).contains("positive number of px"));
        assert!(Calibration::new(300.0, 0.1, [f64::INFINITY, 0.0]).is_err());
    }

    #[test]
    fn unknown_disparities_are_equal_and_not_counted() {
        let of = |cells: [f32; 3]| Disparity(Grid::from_fn(3, 1, |x, _| cells[x]));
        let map = of([1.0, f32::NAN, 2.5]);
        assert_eq!((map.clone(), map.known(), map.at(1, 0), map.at(2, 0)), (map, 2, None, Some(2.5)));
        assert_ne!(of([1.0, f32::NAN, 2.5]), of([1.0, 0.0, 2.5]));
    }
}
