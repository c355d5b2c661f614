//! The contour in an iteration, and its points with their neighbours.

use super::Point;
use crate::geometry::polygon;
use crate::methods::contour::Edges;

/// A point and all that the energies of its neighbourhood depend on.
#[derive(Clone, Copy)]
pub struct Site {
    /// Its place.
    pub at: Point,
    /// The points before and after it.
    pub neighbors: [Point; 2],
    /// The mean distance of neighbouring points in px.
    pub distance: f64,
    /// Whether the point is a corner, where curvature does not count.
    pub is_corner: bool,
}

/// The contour in an iteration.
pub struct Curve<'a> {
    pub edges: &'a Edges,
    pub points: Vec<Point>,
    pub is_corner: Vec<bool>,
    /// The mean distance of neighbouring points.
    pub distance: f64,
}

/// The distance of two points.
pub fn apart(a: Point, b: Point) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

impl Curve<'_> {
    fn neighbors(&self, index: usize) -> [Point; 2] {
        let count = self.points.len();
        [self.points[(index + count - 1) % count], self.points[(index + 1) % count]]
    }

    pub fn site(&self, index: usize) -> Site {
        let is_corner = self.is_corner[index];
        Site { at: self.points[index], neighbors: self.neighbors(index), distance: self.distance, is_corner }
    }

    /// The mean distance of neighbouring points.
    pub fn mean_distance(&self) -> f64 {
        polygon::length(&self.points) / self.points.len() as f64
    }

    /// The squared length of the change of direction at a point, of unit vectors along both edges.
    pub fn turn(&self, index: usize) -> f64 {
        let (at, [before, after]) = (self.points[index], self.neighbors(index));
        let direction = |a: Point, b: Point| {
            let length = apart(a, b);
            if length > 0.0 { [0, 1].map(|k| (b[k] - a[k]) / length) } else { [0.0; 2] }
        };
        let (first, second) = (direction(before, at), direction(at, after));
        (second[0] - first[0]).powi(2) + (second[1] - first[1]).powi(2)
    }
}
