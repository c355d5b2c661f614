//! The refinement of a pose by the edges along the normals of control points.

use std::sync::Arc;

use crate::data::{Frame, Pose};
use crate::geometry::Bounds;
use crate::methods::alignment::solve;

use super::wireframe::{Camera, Control, Point, Vector, Wireframe};
use super::{Rapid, Weighting};

/// A rotation vector in rad and a translation in m.
pub type Motion = [[f64; 3]; 2];
/// Degrees of freedom of a pose.
pub const FREEDOM: usize = 6;

/// A control point with the edge that was found for it.
#[derive(Clone, Copy, Debug)]
pub struct Sought {
    pub control: Control,
    /// Distance of the edge along the normal in px; none without an edge.
    pub edge: Option<f64>,
    /// Weight of its equation.
    pub weight: f64,
}

impl Sought {
    /// The place of the edge.
    pub fn found(&self) -> Option<Point> {
        let Control { at, normal, .. } = self.control;
        self.edge.map(|distance| [0, 1].map(|i| at[i] + distance * normal[i]))
    }
}

/// The number of control points with an edge.
pub fn matched(all: &[Sought]) -> usize {
    all.iter().filter(|sought| sought.edge.is_some()).count()
}

/// The view of a model: a camera, and an axis about which a rotation changes nothing.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    pub camera: Camera,
    /// The axis of symmetry in the coordinates of the camera, of unit length. The rotation about it is held.
    pub axis: Option<Vector>,
}

/// A model as a camera sees it.
#[derive(Clone)]
pub struct View {
    pub wireframe: Arc<Wireframe>,
    pub camera: Camera,
    pub picture: (usize, usize),
    pub pose: Pose,
}

impl View {
    pub fn at(&self, pose: Pose) -> Self {
        Self { pose, ..self.clone() }
    }

    /// The rectangle around the projection; none if a corner lies at the camera or behind it.
    pub fn bounds(&self) -> Option<Bounds> {
        self.wireframe.bounds(&self.camera, &self.pose)
    }

    /// The view of the model in its pose.
    pub fn sight(&self) -> Sight {
        Sight { camera: self.camera, axis: self.wireframe.axis().map(|axis| self.pose.turned(axis)) }
    }
}

/// The normal equations of an iteration.
#[derive(Clone, Debug)]
pub struct Equations {
    /// Σ w c cᵀ, with λ a aᵀ where the rotation about an axis a is held, row by row.
    pub matrix: Vec<f64>,
    /// Σ w c l.
    pub right: Vec<f64>,
    /// Number of edges.
    pub edges: usize,
    /// Root mean square distance of the edges in px.
    pub rms: f64,
}

/// Searches the nearest edge within `range` px along the normal of a control point: a local maximum of the gradient of at least `least` gray
/// levels per px. The strongest one may belong to another edge of the object.
fn search(frame: &Frame, control: &Control, (range, least): (usize, f32)) -> Option<f64> {
    let (luma, reach) = (frame.luma(), range as isize);
    let Control { at, normal: [u, v], .. } = *control;
    // The mean of three places side by side along the edge: noise weighs less, and the edge stays sharp.
    let value = |k: isize| {
        let along = |side: f64| {
            let k = k as f64;
            luma.sample((at[0] + k * u - side * v) as f32, (at[1] + k * v + side * u) as f32)
        };
        (along(-1.0) + along(0.0) + along(1.0)) / 3.0
    };
    let values: Vec<f32> = (-reach - 2..=reach + 2).map(value).collect();
    let slopes: Vec<f32> = values.windows(3).map(|three| (three[2] - three[0]).abs() / 2.0).collect();
    let is_edge = |i: &usize| slopes[*i] >= least && slopes[*i] >= slopes[*i - 1].max(slopes[*i + 1]);
    let middle = range + 1;
    let outwards = (1..=range).flat_map(|k| [middle - k, middle + k]);
    let best = std::iter::once(middle).chain(outwards).find(is_edge)?;
    let [before, here, after] = [slopes[best - 1], slopes[best], slopes[best + 1]].map(f64::from);
    let bend = before - 2.0 * here + after;
    let between = if bend < 0.0 { ((before - after) / (2.0 * bend)).clamp(-0.5, 0.5) } else { 0.0 };
    Some(best as f64 - middle as f64 + between)
}

/// The motion of a control point along its normal in px by the six parameters of a small motion.
pub fn row(camera: &Camera, control: &Control) -> [f64; FREEDOM] {
    let Control { place: [x, y, z], arm: [p, q, r], normal: [u, v], .. } = *control;
    let scale = camera.focal / z;
    // The projection of a motion along X, Y and Z.
    let by = [scale * u, scale * v, -scale * (u * x + v * y) / z];
    // A rotation θ about the origin of the object moves the point by θ × arm.
    [q * by[2] - r * by[1], r * by[0] - p * by[2], p * by[1] - q * by[0], by[0], by[1], by[2]]
}

impl Rapid {
    /// The control points of a pose with their edges in a frame.
    pub(super) fn sought(&self, frame: &Frame, (sight, controls): (&Sight, Vec<Control>)) -> Vec<Sought> {
        crate::base::effort::add(controls.len() * 3 * (2 * self.search_range + 5));
        let limits = (self.search_range, self.min_gradient);
        let edge = |control| Sought { control, edge: search(frame, &control, limits), weight: 1.0 };
        let mut all: Vec<_> = controls.into_iter().map(edge).collect();
        if self.weighting == Weighting::Robust {
            reweigh(&mut all, sight);
        }
        all
    }
}

/// Weighs the equations by 1/(c + |r|), r the distance that a first least-squares solution leaves (Drummond and Cipolla 2002).
fn reweigh(all: &mut [Sought], sight: &Sight) {
    /// Distance in px at which the weight is one half.
    const SCALE_PX: f64 = 1.0;
    const PASSES: usize = 3;
    for _ in 0..PASSES {
        let Some(motion) = solution(&equations(all, sight)) else { return };
        for sought in all.iter_mut() {
            let left = residual(sought, &sight.camera, &motion).unwrap_or(0.0);
            sought.weight = SCALE_PX / (SCALE_PX + left.abs());
        }
    }
}

/// The distance of an edge that a motion leaves in px.
pub fn residual(sought: &Sought, camera: &Camera, motion: &[f64]) -> Option<f64> {
    let moved: f64 = row(camera, &sought.control).iter().zip(motion).map(|(a, b)| a * b).sum();
    sought.edge.map(|distance| distance - moved)
}

/// The normal equations of all control points with an edge.
pub fn equations(all: &[Sought], sight: &Sight) -> Equations {
    let (mut matrix, mut right) = (vec![0.0; FREEDOM * FREEDOM], vec![0.0; FREEDOM]);
    let (mut edges, mut squares) = (0usize, 0.0);
    for sought in all {
        let Some(distance) = sought.edge else { continue };
        let row = row(&sight.camera, &sought.control);
        for i in 0..FREEDOM {
            (0..FREEDOM).for_each(|j| matrix[i * FREEDOM + j] += sought.weight * row[i] * row[j]);
            right[i] += sought.weight * row[i] * distance;
        }
        edges += 1;
        squares += distance * distance;
    }
    if let Some(axis) = sight.axis {
        // As strong as all edges together, which are insensitive to it.
        let strength: f64 = (0..3).map(|i| matrix[i * FREEDOM + i]).sum();
        (0..3).for_each(|i| (0..3).for_each(|j| matrix[i * FREEDOM + j] += strength * axis[i] * axis[j]));
    }
    let rms = (squares / edges.max(1) as f64).sqrt();
    Equations { matrix, right, edges, rms }
}

/// The motion that minimises the squared distances; none if the edges do not determine it.
pub fn solution(equations: &Equations) -> Option<Vec<f64>> {
    let found = solve(&equations.matrix, &equations.right).filter(|_| equations.edges >= FREEDOM)?;
    found.iter().all(|c| c.is_finite()).then_some(found)
}

/// The six parameters as a motion.
pub fn motion_of(parameters: &[f64]) -> Motion {
    [0, 3].map(|first| [0, 1, 2].map(|i| parameters.get(first + i).copied().unwrap_or_default()))
}

/// The covariance of the parameters, row by row in rad and m: the weighted variance of the residuals times the inverse of the matrix. Errors of
/// the edges count as independent. A held rotation has no variance.
pub fn covariance(all: &[Sought], sight: &Sight) -> Option<Vec<f64>> {
    let equations = equations(all, sight);
    let motion = solution(&equations)?;
    let weighed = |s: &Sought| Some([s.weight, s.weight * residual(s, &sight.camera, &motion)?.powi(2)]);
    let [weights, squares] = all.iter().filter_map(weighed).fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d]);
    let free = (FREEDOM - usize::from(sight.axis.is_some())) as f64;
    // Edges beyond the number of parameters, each with its weight; at least one.
    let variance = squares / (weights - free).max(1.0);
    let mut entries = vec![0.0; FREEDOM * FREEDOM];
    for j in 0..FREEDOM {
        let unit: Vec<f64> = (0..FREEDOM).map(|i| f64::from(u8::from(i == j))).collect();
        let column = solve(&equations.matrix, &unit)?;
        (0..FREEDOM).for_each(|i| entries[i * FREEDOM + j] = variance * column[i]);
    }
    sight.axis.into_iter().for_each(|axis| hold(&mut entries, axis));
    Some(entries)
}

/// Removes the rotation about an axis from a covariance, where it is fixed by the constraint alone.
fn hold(covariance: &mut [f64], axis: Vector) {
    // Entries in a row follow each other, those in a column are a row apart.
    for (line, entry) in [(FREEDOM, 1), (1, FREEDOM)] {
        for first in (0..FREEDOM).map(|i| i * line) {
            let along: f64 = axis.iter().enumerate().map(|(i, a)| a * covariance[first + i * entry]).sum();
            axis.iter().enumerate().for_each(|(i, a)| covariance[first + i * entry] -= along * a);
        }
    }
}

/// The median distance of the edges from their control points in px; NaN without an edge. A few edges of something else do not raise it.
pub fn median_distance(all: &[Sought]) -> f64 {
    let mut distances: Vec<f64> = all.iter().filter_map(|sought| sought.edge).map(f64::abs).collect();
    distances.sort_by(f64::total_cmp);
    distances.get(distances.len() / 2).copied().unwrap_or(f64::NAN)
}

/// The farthest motion of a control point in px between two poses.
pub fn farthest(controls: &[Sought], camera: &Camera, [before, after]: [&Pose; 2]) -> f64 {
    let moved = |sought: &Sought| {
        let at = camera.project(after.moved(before.turned_back(sought.control.arm)));
        let from = sought.control.at;
        at.map_or(f64::INFINITY, |at| (at[0] - from[0]).hypot(at[1] - from[1]))
    };
    controls.iter().map(moved).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::super::wireframe::Wireframe;
    use super::*;

    /// The rows are the derivatives of the projection: compared with differences of projections of the moved point.
    #[test]
    fn rows_are_the_derivatives_of_the_projection() {
        let (model, camera) = (Wireframe::of(&Rapid::default()), Camera::new((320, 240), 56.14));
        let pose = Pose::tilted((0.5, 0.75f64.sqrt()), 0.35f64.sin_cos(), [0.1, -0.05, 1.6]);
        let controls = model.controls(&camera, (&pose, 8.0), (320, 240));
        assert!(controls.len() > 40, "{}", controls.len());
        for control in controls {
            let exact = row(&camera, &control);
            for (i, exact) in exact.into_iter().enumerate() {
                const STEP: f64 = 1e-6;
                let moved = |sign: f64| {
                    let mut by = [0.0; FREEDOM];
                    by[i] = sign * STEP;
                    let at = camera.project(pose.after(motion_of(&by)).moved(pose.turned_back(control.arm)));
                    let at = at.expect("in front of the camera");
                    at[0] * control.normal[0] + at[1] * control.normal[1]
                };
                let slope = (moved(1.0) - moved(-1.0)) / (2.0 * STEP);
                assert!((slope - exact).abs() < 1e-3 * exact.abs().max(1.0), "parameter {i}: {slope}, {exact}");
            }
        }
    }

    #[test]
    fn a_held_rotation_has_no_variance() {
        let axis = [0.6, 0.0, 0.8];
        let mut covariance: Vec<f64> =
            (0..FREEDOM * FREEDOM).map(|i| if i % (FREEDOM + 1) == 0 { 2.0 } else { 0.5 }).collect();
        hold(&mut covariance, axis);
        let times = |i: usize| (0..3).map(|j| covariance[i * FREEDOM + j] * axis[j]).sum::<f64>();
        assert!((0..FREEDOM).all(|i| times(i).abs() < 1e-12), "{covariance:?}");
        // The part perpendicular to the axis is unchanged.
        assert_eq!([covariance[FREEDOM + 1], covariance[5 * FREEDOM + 5]], [2.0; 2]);
    }

    #[test]
    fn a_step_edge_is_found_between_pixels() {
        // The edge lies at x = 20.3: the pixel there has its share of both sides.
        let value = |x: usize| {
            if x < 20 {
                40
            } else if x == 20 {
                72
            } else {
                200u8
            }
        };
        let frame = Frame::gray(crate::geometry::Grid::from_fn(40, 30, |x, _| value(x)));
        let control = Control { place: [0.0, 0.0, 1.0], arm: [0.0; 3], at: [17.0, 15.0], normal: [1.0, 0.0] };
        let edge = search(&frame, &control, (6, 5.0)).expect("an edge");
        assert!((edge - 3.3).abs() < 0.1, "{edge}");
        assert!(search(&frame, &control, (1, 5.0)).is_none(), "beyond the range");
        assert!(search(&frame, &control, (2, 5.0)).is_none(), "only its slope lies within the range");
        assert!(search(&frame, &Control { at: [8.0, 15.0], ..control }, (6, 5.0)).is_none());
    }

    #[test]
    fn the_nearest_edge_is_found_and_not_the_strongest() {
        let frame =
            Frame::gray(crate::geometry::Grid::from_fn(40, 30, |x, _| [40, 80, 220u8][(x / 6).clamp(2, 4) - 2]));
        let control = Control { place: [0.0, 0.0, 1.0], arm: [0.0; 3], at: [20.0, 15.0], normal: [1.0, 0.0] };
        // Edges at 17.5 px, of 40 levels, and 23.5 px, of 140 levels.
        let edge = search(&frame, &control, (8, 5.0)).expect("an edge");
        assert!((edge + 2.5).abs() < 0.1, "{edge}");
        let edge = search(&frame, &Control { at: [21.0, 15.0], ..control }, (8, 5.0)).expect("an edge");
        assert!((edge - 2.5).abs() < 0.1, "{edge}");
    }
}
