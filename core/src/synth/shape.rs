//! Outlines of layers: how far inside a place is, and the polygon that bounds it.

use super::maths::sin_cos;

/// A point or vector: x right, y down.
pub type Point = [f64; 2];

/// Distance to an edge, in the layer's units, beyond which it need not be exact.
const FAR: f64 = 8.0;

/// A height for every x.
pub type Profile = Box<dyn Fn(f64) -> f64 + Send + Sync>;

/// What part of the plane a layer fills, in the layer's own coordinates.
pub enum Shape {
    /// All of it.
    Everywhere,
    /// What lies below a skyline.
    Below {
        /// The skyline's y for every x.
        skyline: Profile,
        /// Its highest place's y, and its lowest one's, or a little beyond.
        range: Point,
    },
    /// Everything but what is inside another shape: a wall with a window.
    Around(Box<Shape>),
    /// An ellipse about the origin.
    Ellipse {
        /// Half its width and half its height.
        radii: Point,
    },
    /// A rectangle about the origin.
    Rectangle {
        /// Half its width and half its height.
        half: Point,
        /// Radius of its corners.
        corner: f64,
    },
    /// Straight lines from corner to corner, and back to the first.
    Polygon(Vec<Point>),
}

impl Shape {
    /// A circle about the origin.
    pub fn disc(radius: f64) -> Self {
        Self::Ellipse { radii: [radius; 2] }
    }

    /// A star about the origin, with one of its `points` upwards.
    pub fn star(points: u32, outer: f64, inner: f64) -> Self {
        let corner = |i: u32| {
            let (sin, cos) = sin_cos(f64::from(i) * 0.5 / f64::from(points));
            let radius = if i.is_multiple_of(2) { outer } else { inner };
            [radius * sin, -radius * cos]
        };
        Self::Polygon((0..2 * points).map(corner).collect())
    }

    /// What lies below `skyline`, which runs between `highest` and `lowest`.
    pub fn below([highest, lowest]: Point, skyline: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Self {
        Self::Below { skyline: Box::new(skyline), range: [highest, lowest] }
    }

    /// How far `p` is inside (negative outside); exact near the outline, a fair guess elsewhere.
    pub fn inside(&self, p: Point) -> f64 {
        match self {
            Self::Everywhere => f64::INFINITY,
            Self::Below { range, .. } if p[1] < range[0] - FAR => p[1] - range[0],
            Self::Below { range, .. } if p[1] > range[1] + FAR => p[1] - range[1],
            Self::Below { skyline, .. } => {
                let depth = p[1] - skyline(p[0]);
                if depth.abs() > FAR {
                    return depth;
                }
                let slope = skyline(p[0] + 0.5) - skyline(p[0] - 0.5);
                depth / (1.0 + slope * slope).sqrt()
            }
            Self::Around(hole) => -hole.inside(p),
            Self::Ellipse { radii: [rx, ry] } => {
                let scaled = length([p[0] / rx, p[1] / ry]);
                let steepness = length([p[0] / (rx * rx), p[1] / (ry * ry)]);
                if steepness > 0.0 { (1.0 - scaled) * scaled / steepness } else { rx.min(*ry) }
            }
            Self::Rectangle { half, corner } => {
                let beyond: Point = std::array::from_fn(|i| p[i].abs() - half[i] + corner);
                corner - length(beyond.map(|b| b.max(0.0))) - beyond[0].max(beyond[1]).min(0.0)
            }
            Self::Polygon(corners) => inside_polygon(corners, p),
        }
    }

    /// Points along the outline, close enough to bound the shape to a thousandth of its size.
    /// None if it has no end.
    pub fn outline(&self) -> Vec<Point> {
        match self {
            Self::Everywhere | Self::Below { .. } | Self::Around(_) => Vec::new(),
            Self::Ellipse { radii: [rx, ry] } => circle().map(|[x, y]| [x * rx, y * ry]).collect(),
            Self::Rectangle { half, corner } => {
                let reach = |c: f64, half: f64| c * corner + (half - corner).copysign(c);
                let mut corners: Vec<Point> = circle().map(|[x, y]| [reach(x, half[0]), reach(y, half[1])]).collect();
                corners.dedup();
                along(&corners)
            }
            Self::Polygon(corners) => along(corners),
        }
    }
}

/// Length of a vector.
pub fn length([x, y]: Point) -> f64 {
    (x * x + y * y).sqrt()
}

const CIRCLE_POINTS: u32 = 256;

fn circle() -> impl Iterator<Item = Point> {
    (0..CIRCLE_POINTS).map(|i| {
        let (sin, cos) = sin_cos(f64::from(i) / f64::from(CIRCLE_POINTS));
        [cos, sin]
    })
}

/// The corners with points in between, since a layer may bend.
fn along(corners: &[Point]) -> Vec<Point> {
    const PARTS: u32 = 16;
    sides(corners)
        .flat_map(|(a, b)| {
            (0..PARTS).map(move |i| {
                let share = f64::from(i) / f64::from(PARTS);
                [a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share]
            })
        })
        .collect()
}

fn sides(corners: &[Point]) -> impl Iterator<Item = (Point, Point)> {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

fn inside_polygon(corners: &[Point], p: Point) -> f64 {
    let mut nearest = f64::MAX;
    let mut inside = false;
    for (a, b) in sides(corners) {
        let (side, to_p) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
        let share = (to_p[0] * side[0] + to_p[1] * side[1]) / (side[0] * side[0] + side[1] * side[1]);
        let share = share.clamp(0.0, 1.0);
        nearest = nearest.min(length([to_p[0] - share * side[0], to_p[1] - share * side[1]]));
        if (a[1] > p[1]) != (b[1] > p[1]) && to_p[0] < side[0] * to_p[1] / side[1] {
            inside = !inside;
        }
    }
    if inside { nearest } else { -nearest }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bounded() -> [Shape; 4] {
        [
            Shape::Ellipse { radii: [20.0, 9.0] },
            Shape::Rectangle { half: [15.0, 8.0], corner: 3.0 },
            Shape::Rectangle { half: [15.0, 8.0], corner: 0.0 },
            Shape::star(5, 20.0, 9.0),
        ]
    }

    #[test]
    fn outlines_lie_on_the_edge() {
        for shape in bounded() {
            let outline = shape.outline();
            assert!(outline.len() > 50);
            for p in outline {
                assert!(shape.inside(p).abs() < 2e-3, "{p:?}");
                assert!(shape.inside(p.map(|c| c * 0.98)) > 0.0 && shape.inside(p.map(|c| c * 1.02)) < 0.0);
            }
        }
    }

    #[test]
    fn distances_near_the_edge_are_true() {
        let [ellipse, rectangle, ..] = bounded();
        assert!((ellipse.inside([19.5, 0.0]) - 0.5).abs() < 0.02);
        assert_eq!(rectangle.inside([14.0, 0.0]), 1.0);
        assert_eq!(rectangle.inside([0.0, -10.0]), -2.0);
        assert_eq!(Shape::Around(Box::new(rectangle)).inside([0.0, -10.0]), 2.0);
        let slope = Shape::below([-1e9, 1e9], |x| x);
        assert!((slope.inside([0.0, 1.0]) - 0.5_f64.sqrt()).abs() < 1e-12 && slope.inside([0.0, -1.0]) < 0.0);
    }
}
