//! Wireframe models of convex solids, the camera that sees them, and their control points.

use crate::choices;
use crate::data::Pose;
use crate::geometry::Bounds;
use crate::products::Region;

use super::Rapid;

choices! {
    /// Shape of the model.
    pub enum Solid {
        /// Box: its visible edges.
        Box = "box" "Box",
        /// Upright cylinder: the ellipses of its ends and the two sides of its outline. With equal width and depth no edge shows a rotation
        /// about its axis, which is held.
        Cylinder = "cylinder" "Cylinder",
    }
}

/// A position or direction in space in m.
pub type Vector = [f64; 3];
/// A place in the picture in px.
pub type Point = [f64; 2];

/// Sides of the prism that stands for a cylinder.
const SIDES: usize = 24;
/// The nearest depth in m that a camera sees.
const NEAREST_M: f64 = 1e-3;

/// A camera with square pixels and its principal point in the middle of the picture.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    /// Focal length in px.
    pub focal: f64,
    /// Principal point in px.
    pub middle: Point,
}

impl Camera {
    /// The camera of pictures of a size with a horizontal field of view in degrees.
    pub fn new((width, height): (usize, usize), field_of_view: f32) -> Self {
        let half = f64::from(field_of_view).to_radians() / 2.0;
        let middle = [width, height].map(|side| (side as f64 - 1.0) / 2.0);
        Self { focal: width as f64 / (2.0 * half.tan()), middle }
    }

    /// The projection of a point in the coordinates of the camera; none at or behind it.
    pub fn project(&self, [x, y, z]: Vector) -> Option<Point> {
        let at = [self.middle[0] + self.focal * x / z, self.middle[1] + self.focal * y / z];
        (z > NEAREST_M && at.iter().all(|c| c.is_finite())).then_some(at)
    }
}

/// An edge between two faces.
#[derive(Clone, Copy, Debug)]
struct Edge {
    corners: [usize; 2],
    faces: [usize; 2],
    /// Whether it is seen as part of the outline alone, as on a curved surface.
    is_smooth: bool,
}

/// A face by its outward normal and one of its corners.
#[derive(Clone, Copy, Debug)]
struct Face {
    normal: Vector,
    corner: usize,
}

/// A convex solid about its middle, in m.
#[derive(Clone, Debug)]
pub struct Wireframe {
    corners: Vec<Vector>,
    faces: Vec<Face>,
    edges: Vec<Edge>,
    /// Whether it is a cylinder with two equal radii.
    is_round: bool,
}

/// A point of a visible edge, and the edge in the picture.
#[derive(Clone, Copy, Debug)]
pub struct Control {
    /// The point in the coordinates of the camera, and relative to the origin of the object, in m.
    pub place: Vector,
    /// See `place`.
    pub arm: Vector,
    /// Its projection.
    pub at: Point,
    /// Unit normal of the projected edge.
    pub normal: Point,
}

impl Wireframe {
    /// The model that the parameters describe.
    pub fn of(rapid: &Rapid) -> Self {
        let half = [rapid.model_width, rapid.model_height, rapid.model_depth].map(|side| f64::from(side) / 2.0);
        let around = match rapid.solid {
            Solid::Box => [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].to_vec(),
            Solid::Cylinder => (0..SIDES)
                .map(|i| {
                    let (sin, cos) = (std::f64::consts::TAU * i as f64 / SIDES as f64).sin_cos();
                    [cos, sin]
                })
                .collect(),
        };
        Self::prism(&around, half, rapid.solid == Solid::Cylinder)
    }

    /// The axis of symmetry, if there is one: a rotation about it changes no edge.
    pub fn axis(&self) -> Option<Vector> {
        self.is_round.then_some([0.0, 1.0, 0.0])
    }

    /// The upright prism over a polygon in the plane of X and Z, counter-clockwise there, scaled by half the sides.
    fn prism(around: &[Point], [a, b, c]: Vector, is_round: bool) -> Self {
        let count = around.len();
        let ring = |y: f64| around.iter().map(move |[x, z]| [a * x, y, c * z]);
        let corners: Vec<Vector> = ring(-b).chain(ring(b)).collect();
        let mut faces =
            vec![Face { normal: [0.0, -1.0, 0.0], corner: 0 }, Face { normal: [0.0, 1.0, 0.0], corner: count }];
        let mut edges = Vec::new();
        for i in 0..count {
            let next = (i + 1) % count;
            let [from, to] = [corners[i], corners[next]];
            // The side to the right of its edge in the plane of X and Z.
            faces.push(Face { normal: [to[2] - from[2], 0.0, from[0] - to[0]], corner: i });
            let (side, before) = (2 + i, 2 + (i + count - 1) % count);
            edges.push(Edge { corners: [i, next], faces: [0, side], is_smooth: false });
            edges.push(Edge { corners: [count + i, count + next], faces: [1, side], is_smooth: false });
            edges.push(Edge { corners: [i, count + i], faces: [before, side], is_smooth: is_round });
        }
        Self { corners, faces, edges, is_round: is_round && a == c }
    }

    /// The visible edges of a pose by their ends in the picture, with the ends in the coordinates of the camera.
    fn visible(&self, camera: &Camera, pose: &Pose) -> Vec<([Vector; 2], [Point; 2])> {
        let faces_camera = |face: &Face| {
            let (normal, at) = (pose.turned(face.normal), pose.moved(self.corners[face.corner]));
            normal[0] * at[0] + normal[1] * at[1] + normal[2] * at[2] < 0.0
        };
        let is_front: Vec<bool> = self.faces.iter().map(faces_camera).collect();
        let is_seen = |edge: &&Edge| match (edge.faces.map(|face| is_front[face]), edge.is_smooth) {
            ([a, b], true) => a != b,
            ([a, b], false) => a || b,
        };
        let ends = |edge: &Edge| {
            let ends = edge.corners.map(|corner| pose.moved(self.corners[corner]));
            let [from, to] = ends.map(|end| camera.project(end));
            Some((ends, [from?, to?]))
        };
        self.edges.iter().filter(is_seen).filter_map(ends).collect()
    }

    /// The visible edges of a pose in the picture.
    pub fn outline(&self, camera: &Camera, pose: &Pose) -> Vec<[[f32; 2]; 2]> {
        let drawn = |(_, ends): ([Vector; 2], [Point; 2])| ends.map(|end| end.map(|c| c as f32));
        self.visible(camera, pose).into_iter().map(drawn).collect()
    }

    /// Control points on the visible edges, about `spacing_px` apart in the picture, that lie inside a picture of this size.
    pub fn controls(
        &self,
        camera: &Camera,
        (pose, spacing_px): (&Pose, f32),
        (width, height): (usize, usize),
    ) -> Vec<Control> {
        let mut all = Vec::new();
        for ([from, to], [a, b]) in self.visible(camera, pose) {
            let along = [b[0] - a[0], b[1] - a[1]];
            let length = along[0].hypot(along[1]);
            let count = (length / f64::from(spacing_px)).round() as usize;
            let count = count.clamp(usize::from(length > 1.0), width + height);
            for i in 0..count {
                // Never at a corner, where the normals of two edges meet.
                let share = (i as f64 + 0.5) / count as f64;
                let place = [0, 1, 2].map(|k| from[k] + share * (to[k] - from[k]));
                let Some(at) = camera.project(place) else { continue };
                let is_inside =
                    at[0] >= 0.0 && at[1] >= 0.0 && at[0] <= width as f64 - 1.0 && at[1] <= height as f64 - 1.0;
                if is_inside {
                    let arm = [0, 1, 2].map(|k| place[k] - pose.translation[k]);
                    all.push(Control { place, arm, at, normal: [along[1] / length, -along[0] / length] });
                }
            }
        }
        all
    }

    /// The rectangle around the projection; none if a corner lies at the camera or behind it.
    pub fn bounds(&self, camera: &Camera, pose: &Pose) -> Option<Bounds> {
        let seen: Option<Vec<Point>> = self.corners.iter().map(|corner| camera.project(pose.moved(*corner))).collect();
        let none = Bounds { min: [f32::INFINITY; 2], max: [f32::NEG_INFINITY; 2] };
        seen.map(|seen| {
            seen.iter().fold(none, |Bounds { min, max }, at| Bounds {
                min: [0, 1].map(|i| min[i].min(at[i] as f32)),
                max: [0, 1].map(|i| max[i].max(at[i] as f32)),
            })
        })
    }

    /// The translation at which the projection of a rotated model has the centre and the area of a region.
    pub fn placed(&self, camera: &Camera, rotated: Pose, region: Region) -> Pose {
        /// Enough corrections to converge to rounding error.
        const CORRECTIONS: usize = 20;
        let wanted = region.bounds();
        let radius = self.corners.iter().map(|c| c.iter().map(|x| x * x).sum::<f64>().sqrt()).fold(0.0, f64::max);
        let area = |bounds: &Bounds| f64::from(bounds.area()).max(1e-6).sqrt();
        let mut depth = (2.0 * radius * camera.focal / area(&wanted)).max(1.5 * radius);
        let mut at = wanted.center().map(f64::from);
        let pose = |at: Point, depth: f64| {
            let [x, y] = [0, 1].map(|i| (at[i] - camera.middle[i]) * depth / camera.focal);
            Pose { translation: [x, y, depth], ..rotated }
        };
        for _ in 0..CORRECTIONS {
            let Some(seen) = self.bounds(camera, &pose(at, depth)) else { break };
            at = [0, 1].map(|i| at[i] + f64::from(wanted.center()[i] - seen.center()[i]));
            depth = (depth * area(&seen) / area(&wanted)).max(1.5 * radius);
        }
        pose(at, depth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_shows_nine_edges_of_twelve_and_a_cylinder_its_outline() {
        let camera = Camera::new((320, 240), 56.14);
        let pose = Pose::tilted((0.5, 0.75f64.sqrt()), 0.35f64.sin_cos(), [0.0, 0.0, 1.6]);
        let solid = |solid| Wireframe::of(&Rapid { solid, ..Rapid::default() });
        assert_eq!(solid(Solid::Box).outline(&camera, &pose).len(), 9);
        // The whole upper ring, the near half of the lower one and two sides of the outline.
        let seen = solid(Solid::Cylinder).outline(&camera, &pose).len();
        assert!((SIDES + SIDES / 2 - 2..=SIDES + SIDES / 2 + 4).contains(&seen), "{seen} edges");
        let behind = Pose { translation: [0.0, 0.0, 0.1], ..pose };
        assert_eq!(solid(Solid::Box).bounds(&camera, &behind), None);
    }

    #[test]
    fn a_region_gives_the_translation() {
        let (model, camera) = (Wireframe::of(&Rapid::default()), Camera::new((320, 240), 56.14));
        let pose = Pose::tilted((0.5, 0.75f64.sqrt()), 0.35f64.sin_cos(), [0.2, -0.1, 1.9]);
        let seen = model.bounds(&camera, &pose).expect("in front of the camera");
        let found = model.placed(&camera, pose, seen.into());
        assert!(pose.translation.iter().zip(found.translation).all(|(a, b)| (a - b).abs() < 1e-4), "{found:?}");
    }
}
