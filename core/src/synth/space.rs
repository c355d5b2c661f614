//! Planes and spheres in space, seen by a rectified pair of cameras: exact views, depths and motion by casting rays.
//!
//! Lengths are metres: X to the right, Y down, Z forwards from the left camera of the first frame.

use super::difficulty::Difficulty;
use super::layer::{Paint, TrackPoint, painted, scale};
use super::maths::sin_cos;
use super::motion::grown;
use super::shape::Point;
use super::texture::{Rgb, Spot};
use crate::data::{Calibration, Pose, Viewpoint};

/// A position or direction in space in m.
pub type Vector = [f64; 3];

/// Focal length in px of a picture of 320×240.
const FOCAL: f64 = 300.0;
/// Units of a texture per m: the px of a picture of 320×240 at a depth of 2 m.
const TEXTURE: f64 = FOCAL / 2.0;

/// The cameras of a scene.
#[derive(Clone, Copy, Debug)]
pub struct Rig {
    /// Their distance in m.
    pub baseline_m: f64,
    /// Takes coordinates of the scene to those of the left camera at a time in frames; at time 0 both are the same.
    pub view: fn(f64) -> Pose,
}

impl Rig {
    /// Two cameras at rest, 12 cm apart.
    pub const REST: Self = Self { baseline_m: 0.12, view: |_| Pose::IDENTITY };
}

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

    /// The corners of a part of a plane.
    fn corners(&self) -> Option<[Vector; 4]> {
        let Form::Plane { at, along: [u, v], half: [a, b] } = *self else { return None };
        Some([[-a, -b], [a, -b], [a, b], [-a, b]].map(|[a, b]| plus(at, plus(times(u, a), times(v, b)))))
    }
}

/// A body with its motion and surface.
pub struct Body {
    form: Form,
    /// Its pose at a time in frames.
    motion: Motion,
    paint: Paint,
    plain: Rgb,
    object: Option<u32>,
    /// Whether a plane is seen from the side alone to which the product of its directions points.
    is_one_sided: bool,
}

/// The motion of a body.
#[derive(Clone, Copy)]
enum Motion {
    /// A translation.
    Shift(fn(f64) -> Vector),
    /// A rigid motion.
    Rigid(fn(f64) -> Pose),
}

impl Motion {
    fn pose(self, time: f64) -> Pose {
        match self {
            Self::Shift(shift) => Pose { translation: shift(time), ..Pose::IDENTITY },
            Self::Rigid(pose) => pose(time),
        }
    }
}

impl Body {
    /// A body at rest. `plain` is its colour where all texture is gone.
    pub fn new(form: Form, plain: Rgb, paint: impl Fn(Spot) -> Rgb + Send + Sync + 'static) -> Self {
        let motion = Motion::Shift(|_| [0.0; 3]);
        Self { form, motion, paint: Box::new(paint), plain, object: None, is_one_sided: false }
    }

    /// The same with a motion: its translation at a time in frames, bounded, and zero at time 0.
    pub fn moving(self, motion: fn(f64) -> Vector) -> Self {
        Self { motion: Motion::Shift(motion), ..self }
    }

    /// The same as a face of a rigid object that hides its inside: the form is in the coordinates of the object, which has a pose at a time
    /// in frames, and the product of the directions of a plane points outwards.
    pub fn face_of(self, id: u32, pose: fn(f64) -> Pose) -> Self {
        Self { motion: Motion::Rigid(pose), object: Some(id), is_one_sided: true, ..self }
    }
}

/// Bodies, seen by a pair of cameras.
pub struct Space {
    bodies: Vec<Body>,
    rig: Rig,
    difficulty: Difficulty,
}

impl Space {
    /// Bodies in any order; one of them must fill the picture.
    pub fn new(bodies: Vec<Body>, rig: Rig, difficulty: Difficulty) -> Self {
        Self { bodies, rig, difficulty }
    }

    /// Whether it has objects.
    pub fn has_objects(&self) -> bool {
        self.bodies.iter().any(|body| body.object.is_some())
    }

    /// The pose of an object at frame `t` in the coordinates of the left camera, unless that turns or zooms.
    pub fn pose(&self, id: u32, t: f64) -> Option<Pose> {
        let body = self.bodies.iter().find(|body| body.object == Some(id))?;
        self.is_upright().then(|| self.placed(body, t * f64::from(self.difficulty.speed)))
    }

    /// Whether camera coordinates are those of its picture: it neither turns nor zooms.
    fn is_upright(&self) -> bool {
        self.difficulty.rotation == 0.0 && self.difficulty.scale_change == 0.0
    }

    /// The pose of a body in the coordinates of the left camera.
    fn placed(&self, body: &Body, time: f64) -> Pose {
        (self.rig.view)(time).of(&body.motion.pose(time))
    }

    /// The motion of all that is at rest from frame `t` to the next one in the coordinates of the left camera, unless that turns or zooms.
    pub fn ego_motion(&self, t: f64) -> Option<Pose> {
        let [now, next] = [t, t + 1.0].map(|t| (self.rig.view)(t * f64::from(self.difficulty.speed)));
        self.is_upright().then(|| next.of(&now.inverse()))
    }

    /// The calibration of the cameras, unless their focal length changes.
    pub fn calibration(&self) -> Option<Calibration> {
        let d = &self.difficulty;
        let [x, y] = centre(d);
        let known = Calibration::new(FOCAL * scale(d), self.rig.baseline_m, [x, y]).ok();
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
            Viewpoint::Right => [cos * self.rig.baseline_m, -sin * self.rig.baseline_m, 0.0],
        };
        let poses = self.bodies.iter().map(|body| self.placed(body, time)).collect();
        Moment { space: self, poses, camera: Camera { eye, focal, turned: (sin, cos), centre: centre(d) } }
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
    poses: Vec<Pose>,
    camera: Camera,
}

impl Moment<'_> {
    /// Where the ray through `p` meets body `index`, or passes it closest.
    fn hit(&self, index: usize, p: Point) -> Option<Hit> {
        // In the coordinates of the body the camera moves.
        let (body, pose) = (&self.space.bodies[index], &self.poses[index]);
        let ray = pose.turned_back(self.camera.ray(p));
        let eye = pose.turned_back(minus(self.camera.eye, pose.translation));
        let pixel = |depth: f64| TEXTURE * depth / self.camera.focal;
        match body.form {
            Form::Plane { at, along: [u, v], half } => {
                let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
                let slope = dot(normal, ray);
                let depth = dot(normal, minus(at, eye)) / slope;
                if !(depth > 1e-6 && depth.is_finite()) || (body.is_one_sided && slope > 0.0) {
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
        // Faces that meet at an edge share the pixel: nothing behind them shines through. What of it was left for the first of them.
        let (mut object, mut shared) = (None, 1.0);
        for hit in hits {
            let id = self.space.bodies[hit.body].object;
            if id.is_none() || id != object {
                (object, shared) = (id, left);
            }
            let cover = (shared * hit.spot.cover(hit.inside)).min(left);
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

    /// Whether a body is part of an object.
    pub fn is_object(&self, index: usize) -> bool {
        self.space.bodies[index].object.is_some()
    }

    /// As [`super::layer::Moment::sightings`], for objects with plane faces.
    pub fn sightings(&self) -> Vec<TrackPoint> {
        let mut ids: Vec<_> = self.space.bodies.iter().filter_map(|body| body.object).collect();
        ids.sort_unstable();
        ids.dedup();
        ids.into_iter().filter_map(|id| self.sighting(id)).collect()
    }

    /// The object, unless it is behind the camera or beside the picture.
    fn sighting(&self, id: u32) -> Option<TrackPoint> {
        let is_part = |index: usize| self.space.bodies[index].object == Some(id);
        let parts = (0..self.space.bodies.len()).filter(|index| is_part(*index));
        let corners =
            parts.filter_map(|i| Some(self.space.bodies[i].form.corners()?.map(|at| self.poses[i].moved(at))));
        let seen: Option<Vec<Point>> = corners.flatten().map(|at| Some(self.camera.project(at)?.0)).collect();
        let none = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        let bounds = seen?
            .into_iter()
            .fold(none, |[left, top, right, bottom], [x, y]| [left.min(x), top.min(y), right.max(x), bottom.max(y)]);
        let [left, top, right, bottom] = bounds;
        let (width, height) = (self.space.difficulty.width as f64, self.space.difficulty.height as f64);
        if !(right >= -0.5 && bottom >= -0.5 && left < width - 0.5 && top < height - 0.5) {
            return None;
        }
        let (mut all, mut visible) = (0u32, 0u32);
        for y in top.ceil() as i64..=bottom.floor() as i64 {
            for x in left.ceil() as i64..=right.floor() as i64 {
                let p = [x as f64, y as f64];
                let is_inside = p[0] >= -0.5 && p[1] >= -0.5 && p[0] < width - 0.5 && p[1] < height - 0.5;
                if self.hits(p).any(|hit| hit.inside >= 0.0 && is_part(hit.body)) {
                    all += 1;
                    visible += u32::from(is_inside && self.foremost(p).is_some_and(is_part));
                }
            }
        }
        Some(TrackPoint { id, bounds, visible: f64::from(visible) / f64::from(all.max(1)) })
    }

    /// The disparity that the point of body `index` at `p` has in `other`, another moment seen by the cameras of a rig.
    pub fn disparity_in(&self, index: usize, p: Point, other: [&Self; 2]) -> Option<f64> {
        let rest = self.hit(index, p)?.rest;
        let at = |view: &Self| Some(view.camera.project(view.poses[index].moved(rest))?.0[0]);
        Some(at(other[0])? - at(other[1])?)
    }

    /// As [`super::stage::Moment::follow`].
    pub fn follow(&self, index: usize, p: Point, other: &Self) -> Option<(Point, bool)> {
        /// Relative difference of depths that rounding explains.
        const ROUNDING: f64 = 1e-6;
        let rest = self.hit(index, p)?.rest;
        let (to, depth) = other.camera.project(other.poses[index].moved(rest))?;
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
        Space::new(bodies, Rig::REST, Difficulty::default())
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

    #[test]
    fn nothing_shines_through_where_faces_meet() {
        let [white, black] = [rgb(0xffffff), rgb(0x000000)];
        // Two white faces recede from their common edge, before a black wall.
        let face = |at: Vector, along: Vector| {
            let form = Form::Plane { at, along: [along, [0.0, 1.0, 0.0]], half: [0.2, 0.3] };
            Body::new(form, white, move |_| white).face_of(1, |_| Pose::IDENTITY)
        };
        let wall = Form::upright([0.0, 0.0, 3.0], 0.0, [f64::INFINITY; 2]);
        let bodies = vec![
            Body::new(wall, black, move |_| black),
            face([-0.16, 0.0, 1.62], [-0.8, 0.0, 0.6]),
            face([0.16, 0.0, 1.62], [-0.8, 0.0, -0.6]),
        ];
        let space = Space::new(bodies, Rig::REST, Difficulty::default());
        let moment = space.seen_from(Viewpoint::Left, 0.0);
        for x in [157.0, 158.5, 159.0, 159.5, 160.0, 160.5, 162.0] {
            let seen = moment.color([x, 119.5]);
            assert!(seen.iter().all(|c| *c > 245.0), "{x}: {seen:?}");
        }
        assert!(moment.color([100.0, 119.5]).iter().all(|c| *c < 1.0), "the wall beside them");
    }
}
