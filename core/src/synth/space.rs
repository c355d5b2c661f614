//! Planes and spheres in space, seen by a rectified pair of cameras: exact views, depths and motion by casting rays.
//!
//! Lengths are metres: X to the right, Y down, Z forwards from the left camera of the first frame.

use super::difficulty::Difficulty;
use super::layer::{Paint, painted, scale};
use super::maths::sin_cos;
use super::motion::grown;
use super::shape::Point;
use super::texture::{Rgb, Spot};
use crate::data::{Calibration, Viewpoint};

/// A position or direction in space in m.
pub type Vector = [f64; 3];

/// Focal length in px of a picture of 320×240.
const FOCAL: f64 = 300.0;
/// Distance of the cameras in m.
const BASELINE: f64 = 0.12;
/// Units of a texture per m: the px of a picture of 320×240 at a depth of 2 m.
const TEXTURE: f64 = FOCAL / 2.0;

/// The geometry of a body at rest.
#[derive(Clone, Copy, Debug)]
pub enum Form {
    /// A part of a plane through `at` with the unit vectors `along` in it, perpendicular to each other.
    Plane {
        /// Its middle.
        at: Vector,
        /// The directions of its coordinates.
        along: [Vector; 2],
        /// Half its sides in m; infinite for a whole plane.
        half: [f64; 2],
    },
    /// A sphere.
    Sphere {
        /// Its centre.
        at: Vector,
        /// Its radius in m.
        radius: f64,
    },
}

impl Form {
    /// An upright rectangle that faces the cameras, turned about its vertical axis by `turns`: its right side farther for positive ones.
    pub fn upright(at: Vector, turns: f64, half: [f64; 2]) -> Self {
        let (sin, cos) = sin_cos(turns);
        Form::Plane { at, along: [[cos, 0.0, sin], [0.0, 1.0, 0.0]], half }
    }
}

/// A body with its motion and surface.
pub struct Body {
    form: Form,
    /// Its translation at a time in frames.
    motion: fn(f64) -> Vector,
    paint: Paint,
    plain: Rgb,
}

impl Body {
    /// A body at rest. `plain` is its colour where all texture is gone.
    pub fn new(form: Form, plain: Rgb, paint: impl Fn(Spot) -> Rgb + Send + Sync + 'static) -> Self {
        Self { form, motion: |_| [0.0; 3], paint: Box::new(paint), plain }
    }

    /// The same with a motion: its translation at a time in frames, bounded, and zero at time 0.
    pub fn moving(self, motion: fn(f64) -> Vector) -> Self {
        Self { motion, ..self }
    }
}

/// Bodies, seen by a pair of cameras.
pub struct Space {
    bodies: Vec<Body>,
    difficulty: Difficulty,
}

impl Space {
    /// Bodies in any order; one of them must fill the picture.
    pub fn new(bodies: Vec<Body>, difficulty: Difficulty) -> Self {
        Self { bodies, difficulty }
    }

    /// The calibration of the cameras, unless their focal length changes.
    pub fn calibration(&self) -> Option<Calibration> {
        let d = &self.difficulty;
        let [x, y] = centre(d);
        let known = Calibration::new(FOCAL * scale(d), BASELINE, [x, y]).ok();
        known.filter(|_| d.scale_change == 0.0)
    }

    /// Everything in its place at frame `t`, which need not be whole.
    pub fn seen_from(&self, viewpoint: Viewpoint, t: f64) -> Moment<'_> {
        let d = &self.difficulty;
        let time = t * f64::from(d.speed);
        let focal = FOCAL * scale(d) * grown(f64::from(d.scale_change) / 100.0, t);
        let (sin, cos) = sin_cos(f64::from(d.rotation) / 360.0 * t);
        let eye = match viewpoint {
            Viewpoint::Left => [0.0; 3],
            // The pair turns as a whole, so that its views stay rectified.
            Viewpoint::Right => [cos * BASELINE, -sin * BASELINE, 0.0],
        };
        let shifts = self.bodies.iter().map(|body| (body.motion)(time)).collect();
        Moment { space: self, shifts, camera: Camera { eye, focal, turned: (sin, cos), centre: centre(d) } }
    }
}

fn centre(d: &Difficulty) -> Point {
    [(d.width - 1) as f64 / 2.0, (d.height - 1) as f64 / 2.0]
}

/// A camera at one moment.
struct Camera {
    eye: Vector,
    /// Focal length in px.
    focal: f64,
    /// Sine and cosine of the clockwise rotation of the picture.
    turned: (f64, f64),
    centre: Point,
}

impl Camera {
    /// The direction of the ray through `p`, of depth 1.
    fn ray(&self, p: Point) -> Vector {
        let (sin, cos) = self.turned;
        let [x, y]: Point = std::array::from_fn(|i| (p[i] - self.centre[i]) / self.focal);
        [cos * x + sin * y, cos * y - sin * x, 1.0]
    }

    /// Where a point is seen, and its depth.
    fn project(&self, point: Vector) -> Option<(Point, f64)> {
        let (sin, cos) = self.turned;
        let [x, y, z] = minus(point, self.eye);
        let at = [cos * x - sin * y, sin * x + cos * y];
        (z > 1e-6).then(|| (std::array::from_fn(|i| self.centre[i] + self.focal * at[i] / z), z))
    }
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|i| a[i] - b[i])
}

fn plus(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|i| a[i] + b[i])
}

fn times(a: Vector, factor: f64) -> Vector {
    a.map(|c| c * factor)
}

/// Where a ray meets a body.
struct Hit {
    /// Number of the body.
    body: usize,
    /// Depth in m.
    depth: f64,
    /// The point of the body at rest.
    rest: Vector,
    /// The spot on its texture.
    spot: Spot,
    /// Distance from its outline in units of the texture, negative outside.
    inside: f64,
}

/// A scene at one moment from one viewpoint.
pub struct Moment<'a> {
    space: &'a Space,
    shifts: Vec<Vector>,
    camera: Camera,
}

impl Moment<'_> {
    /// Where the ray through `p` meets body `index`, or passes it closest.
    fn hit(&self, index: usize, p: Point) -> Option<Hit> {
        let (ray, eye) = (self.camera.ray(p), minus(self.camera.eye, self.shifts[index]));
        let pixel = |depth: f64| TEXTURE * depth / self.camera.focal;
        match self.space.bodies[index].form {
            Form::Plane { at, along: [u, v], half } => {
                let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
                let slope = dot(normal, ray);
                let depth = dot(normal, minus(at, eye)) / slope;
                if !(depth > 1e-6 && depth.is_finite()) {
                    return None;
                }
                let rest = plus(eye, times(ray, depth));
                let [a, b] = [u, v].map(|axis| dot(minus(rest, at), axis));
                // Seen at an angle, a pixel covers more of the plane.
                let tilt = (slope.abs() / dot(ray, ray).sqrt()).max(0.2);
                let spot = Spot { x: TEXTURE * a, y: TEXTURE * b, pixel: pixel(depth) / tilt };
                let inside = TEXTURE * (half[0] - a.abs()).min(half[1] - b.abs());
                Some(Hit { body: index, depth, rest, spot, inside })
            }
            Form::Sphere { at, radius } => {
                let (to, a) = (minus(at, eye), dot(ray, ray));
                let b = dot(ray, to);
                let space = b * b - a * (dot(to, to) - radius * radius);
                let depth = (b - space.max(0.0).sqrt()) / a;
                if !(depth > 1e-6 && depth.is_finite()) {
                    return None;
                }
                let rest = plus(eye, times(ray, depth));
                let [x, y, _] = times(minus(rest, at), TEXTURE);
                let passes = (radius * radius - space / a).max(0.0).sqrt();
                let inside = if space >= 0.0 { (radius - passes).max(0.0) } else { radius - passes };
                Some(Hit {
                    body: index,
                    depth,
                    rest,
                    spot: Spot { x, y, pixel: pixel(depth) },
                    inside: TEXTURE * inside,
                })
            }
        }
    }

    fn hits(&self, p: Point) -> impl Iterator<Item = Hit> {
        (0..self.space.bodies.len()).filter_map(move |index| self.hit(index, p))
    }

    /// The foremost surface at `p`.
    fn first(&self, p: Point) -> Option<Hit> {
        self.hits(p).filter(|hit| hit.inside >= 0.0).min_by(|a, b| a.depth.total_cmp(&b.depth))
    }

    /// The colour that the pixel at `p` sees.
    pub fn color(&self, p: Point) -> Rgb {
        let mut hits: Vec<_> = self.hits(p).filter(|hit| hit.inside > -2.0 * hit.spot.pixel).collect();
        hits.sort_by(|a, b| a.depth.total_cmp(&b.depth));
        let (mut color, mut left) = ([0.0; 3], 1.0);
        for hit in hits {
            let cover = left * hit.spot.cover(hit.inside);
            if cover > 0.0 {
                let body = &self.space.bodies[hit.body];
                let own = painted(body.plain, &body.paint, hit.spot, &self.space.difficulty);
                color = std::array::from_fn(|c| color[c] + cover * own[c]);
                left -= cover;
            }
            if left <= 0.0 {
                break;
            }
        }
        color
    }

    /// Number of the foremost body at `p`.
    pub fn foremost(&self, p: Point) -> Option<usize> {
        self.first(p).map(|hit| hit.body)
    }

    /// As [`super::stage::Moment::follow`].
    pub fn follow(&self, index: usize, p: Point, other: &Self) -> Option<(Point, bool)> {
        /// Relative difference of depths that rounding explains.
        const ROUNDING: f64 = 1e-6;
        let rest = self.hit(index, p)?.rest;
        let (to, depth) = other.camera.project(plus(rest, other.shifts[index]))?;
        let (width, height) = (self.space.difficulty.width as f64, self.space.difficulty.height as f64);
        let is_outside = to[0] < -0.5 || to[1] < -0.5 || to[0] >= width - 0.5 || to[1] >= height - 0.5;
        let is_covered = other.first(to).is_some_and(|first| first.depth < depth * (1.0 - ROUNDING));
        Some((to, is_outside || is_covered))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synth::texture::rgb;

    /// A wall at 3 m and a sphere of radius 0.25 m at 1.5 m.
    fn space() -> Space {
        let gray = rgb(0x808080);
        let wall = Form::upright([0.0, 0.0, 3.0], 0.0, [f64::INFINITY; 2]);
        let ball = Form::Sphere { at: [0.0, 0.0, 1.5], radius: 0.25 };
        let bodies = vec![Body::new(wall, gray, move |_| gray), Body::new(ball, gray, move |_| gray)];
        Space::new(bodies, Difficulty::default())
    }

    #[test]
    fn disparities_are_those_of_the_geometry() {
        let space = space();
        let [left, right] = [Viewpoint::Left, Viewpoint::Right].map(|viewpoint| space.seen_from(viewpoint, 0.0));
        let disparity = |p: Point| {
            let ([x, y], hidden) = left.follow(left.foremost(p).unwrap(), p, &right).unwrap();
            assert!((y - p[1]).abs() < 1e-9, "the views are rectified");
            (p[0] - x, hidden)
        };
        // f B = 36 px m: 12 px on the wall, and 28.8 px at the nearest point of the sphere, 1.25 m away.
        let (wall, hidden) = disparity([40.0, 20.0]);
        assert!((wall - 12.0).abs() < 1e-9 && !hidden);
        let (ball, hidden) = disparity([159.5, 119.5]);
        assert!((ball - 28.8).abs() < 1e-9 && !hidden);
        // Left of the sphere, which spans some 51 px to each side, the right camera sees its side in place of the wall.
        assert!(disparity([100.0, 119.5]).1 && !disparity([215.0, 119.5]).1);
        assert!(disparity([5.0, 119.5]).1, "beside the right view");
        let depth = space.calibration().unwrap().depth_m(ball).unwrap();
        assert!((depth - 1.25).abs() < 1e-9);
    }

    #[test]
    fn a_pair_that_rolls_stays_rectified() {
        let space =
            Space { difficulty: Difficulty { rotation: 7.0, scale_change: 1.5, ..Difficulty::default() }, ..space() };
        let [left, right] = [Viewpoint::Left, Viewpoint::Right].map(|viewpoint| space.seen_from(viewpoint, 4.0));
        for p in [[30.0, 40.0], [159.5, 119.5], [250.0, 200.0], [170.0, 140.0]] {
            let ([x, y], _) = left.follow(left.foremost(p).unwrap(), p, &right).unwrap();
            assert!((y - p[1]).abs() < 1e-9 && x < p[0], "{p:?} is at {x}, {y}");
        }
        assert_eq!(space.calibration(), None, "the focal length changes");
    }
}
