//! The place of the inliers of a model: the part of the picture, and whether it is foreground.

use crate::data::{PixelClass, TrueMask};
use crate::methods::geometric::Correspondence;

/// The place of the inliers of a model in frame t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Share of them on the true foreground, where it is known.
    pub foreground: Option<f64>,
    /// Share of the picture inside their convex hull.
    pub hull: f64,
}

impl Place {
    /// The place of `inliers` in a picture of this size.
    pub fn of(inliers: &[Correspondence], foreground: Option<&TrueMask>, (width, height): (usize, usize)) -> Self {
        let class = |mask: &TrueMask, m: &Correspondence| {
            let [x, y] = m.from.map(|c| c.round().max(0.0) as usize);
            mask.0.get(x, y).copied()
        };
        let share = |mask: &TrueMask| {
            let on = inliers.iter().filter(|m| class(mask, m) == Some(PixelClass::Foreground)).count();
            on as f64 / inliers.len().max(1) as f64
        };
        let points = inliers.iter().map(|m| m.from).collect();
        Self { foreground: foreground.map(share), hull: hull_area(points) / (width * height).max(1) as f64 }
    }
}

/// The area of the convex hull of points (Andrew 1979).
fn hull_area(mut points: Vec<[f64; 2]>) -> f64 {
    let cross = |[a, b, c]: [[f64; 2]; 3]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut hull: Vec<[f64; 2]> = Vec::new();
        for point in points {
            while let [.., a, b] = hull[..]
                && cross([a, b, point]) <= 0.0
            {
                hull.pop();
            }
            hull.push(point);
        }
        hull.pop();
        hull
    };
    let hull = [chain(&mut points.iter().copied()), chain(&mut points.iter().rev().copied())].concat();
    let next = hull.iter().cycle().skip(1);
    hull.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>() / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;

    fn at(points: &[[f64; 2]]) -> Vec<Correspondence> {
        points.iter().map(|&from| Correspondence { from, to: from }).collect()
    }

    #[test]
    fn the_hull_of_points_is_measured() {
        // A rhombus with a point inside and one on its border.
        let points = at(&[[5.0, 0.0], [10.0, 5.0], [5.0, 10.0], [0.0, 5.0], [4.0, 5.0], [7.5, 2.5]]);
        assert_eq!(Place::of(&points, None, (20, 10)), Place { foreground: None, hull: 0.25 });
        for few in [&points[..0], &points[..1], &points[..2]] {
            assert_eq!(Place::of(few, None, (20, 10)).hull, 0.0);
        }
    }

    #[test]
    fn inliers_on_the_foreground_are_counted() {
        let mask = TrueMask(Grid::from_fn(8, 8, |x, _| match x {
            0..3 => PixelClass::Foreground,
            3 => PixelClass::Shadow,
            _ => PixelClass::Background,
        }));
        let points = at(&[[0.0, 1.0], [2.4, 1.0], [2.6, 1.0], [7.4, 7.0]]);
        assert_eq!(Place::of(&points, Some(&mask), (8, 8)).foreground, Some(0.5));
    }
}
