//! Repeatability: the share of keypoints that are detected again in another picture of the same plane.

use nalgebra::{Matrix3, Vector3};

use super::PointField;

/// The repeatability of a detector on two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Repeatability {
    /// Keypoints of the first picture that lie in the second.
    pub first: usize,
    /// Keypoints of the second picture that lie in the first.
    pub second: usize,
    /// Those of the first with one of the second within the tolerance.
    pub repeated: usize,
}

impl Repeatability {
    /// The repeated share of the fewer of both, 0 to 1; `None` if there are none (C. Schmid, R. Mohr and C. Bauckhage, IJCV 37(2),
    /// 2000).
    pub fn share(self) -> Option<f64> {
        let possible = self.first.min(self.second);
        (possible > 0).then(|| self.repeated.min(possible) as f64 / possible as f64)
    }
}

/// Compares the keypoints of two pictures of a plane. `homography` maps the first to the second, row by row; a keypoint is repeated
/// if one of the other picture lies at most `tolerance_px` from where it is mapped. `None` if the homography has no inverse.
pub fn repeatability(
    [first, second]: [&PointField; 2],
    homography: [[f64; 3]; 3],
    tolerance_px: f64,
) -> Option<Repeatability> {
    let to_second = Matrix3::from_fn(|row, column| homography[row][column]);
    let to_first = to_second.try_inverse()?;
    let places = |field: &PointField, to: Matrix3<f64>, other: (usize, usize)| -> Vec<([f64; 2], [f64; 2])> {
        let at = field.points.iter().map(|point| point.at.map(f64::from));
        at.filter_map(|at| Some((at, mapped(to, at)?))).filter(|(_, there)| is_in(*there, other)).collect()
    };
    let here = places(first, to_second, second.picture);
    let there = places(second, to_first, first.picture);
    let is_near = |[x, y]: [f64; 2]| there.iter().any(|([a, b], _)| (a - x).hypot(b - y) <= tolerance_px);
    let repeated = here.iter().filter(|(_, place)| is_near(*place)).count();
    Some(Repeatability { first: here.len(), second: there.len(), repeated })
}

/// A place mapped by a homography; `None` at infinity.
fn mapped(homography: Matrix3<f64>, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
    let place = homography * Vector3::new(x, y, 1.0);
    let [u, v] = [place.x / place.z, place.y / place.z];
    (u.is_finite() && v.is_finite()).then_some([u, v])
}

fn is_in([x, y]: [f64; 2], (width, height): (usize, usize)) -> bool {
    x >= 0.0 && y >= 0.0 && x <= width as f64 - 1.0 && y <= height as f64 - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::products::{Feature, Status};

    fn field(points: &[[f32; 2]]) -> PointField {
        let feature = |at: &[f32; 2]| Feature { at: *at, displacement: None, status: Status::Found, residual: None };
        PointField { picture: (100, 80), points: points.iter().map(feature).collect(), keypoints: Vec::new() }
    }

    #[test]
    fn what_lies_outside_the_other_picture_does_not_count() {
        // Ten px to the right.
        let shift = [[1.0, 0.0, 10.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let a = field(&[[20.0, 30.0], [50.0, 40.0], [95.0, 10.0]]);
        let b = field(&[[31.0, 30.0], [63.0, 40.0], [4.0, 4.0], [15.0, 5.0]]);
        let found = repeatability([&a, &b], shift, 1.5).expect("an inverse");
        assert_eq!(found, Repeatability { first: 2, second: 3, repeated: 1 });
        assert_eq!(found.share(), Some(0.5));
        let wider = repeatability([&a, &b], shift, 3.0).expect("an inverse");
        assert_eq!(wider.share(), Some(1.0));
    }

    #[test]
    fn nothing_to_compare_has_no_share() {
        let none = field(&[]);
        let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(repeatability([&none, &none], unit, 1.5).and_then(Repeatability::share), None);
        assert_eq!(repeatability([&none, &none], [[0.0; 3]; 3], 1.5), None);
    }
}
