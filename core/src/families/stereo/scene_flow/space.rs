//! The cloud of points of a scene flow.

use crate::data::Pose;
use crate::products::SceneFlowField;
use crate::scene::{Cloud, CloudCamera, CloudData, CloudLine, CloudPoint, Role};

/// Distance in px of the pixels whose displacements are drawn.
const SPACING: usize = 9;
/// Depth in m of the picture in a camera's pyramid.
const PYRAMID_M: f64 = 0.6;

/// The cloud of a field, with the pixel that a step explains.
pub(super) fn cloud(field: SceneFlowField, pixel: (usize, usize)) -> Cloud {
    let narrowed = |at: [f64; 3]| at.map(|c| c as f32);
    let marked = field.motion(pixel).map(|motion| [(Role::Reference, motion.from), (Role::Measured, motion.to)]);
    let mut marked: Vec<_> = marked.into_iter().flatten().map(|(role, at)| (role, narrowed(at))).collect();
    if marked.is_empty() {
        marked.extend(field.position(pixel).map(|at| (Role::Reference, narrowed(at))));
    }
    let legend = legend(&field);
    let mut cloud = Cloud::new("Point cloud", move || data(&field));
    (cloud.legend, cloud.marked) = (legend, marked);
    cloud
}

fn legend(field: &SceneFlowField) -> Vec<(Role, &'static str)> {
    let is_known = field.next_disparity.0.cells().iter().any(|d| d.is_finite());
    let mut legend = vec![(Role::Reference, "pixel and cameras at t")];
    if is_known {
        let has_ego = field.ego.is_some();
        legend.push((Role::Measured, if has_ego { "pixel and cameras at t+1" } else { "pixel at t+1" }));
        legend.push((Role::Result, if has_ego { "motion without that of the cameras" } else { "scene flow" }));
    }
    legend
}

fn data(field: &SceneFlowField) -> CloudData {
    let colors = field.picture.color();
    let color = |(x, y): (usize, usize)| match colors {
        Some(colors) => colors[(x, y)],
        None => [field.picture.luma()[(x, y)]; 3],
    };
    let is_moving = |(x, y): (usize, usize)| field.moving.as_ref().is_some_and(|moving| moving.get(x, y));
    let point = |pixel: (usize, usize)| {
        Some(CloudPoint {
            at: field.position(pixel)?.map(|c| c as f32),
            color: color(pixel),
            role: is_moving(pixel).then_some(Role::Result),
            pixel: [pixel.0 as u16, pixel.1 as u16],
        })
    };
    let depth_m = field.typical_depth_m().map_or(1.0, |depth| 2.0 * depth as f32);
    let points = field.pixels().filter_map(point).filter(|point| point.at[2] <= depth_m).collect();
    let lines = lines(field, is_moving).into_iter().filter(|line| line.ends[0][2] <= depth_m).collect();
    CloudData { depth_m, lines, cameras: cameras(field), points }
}

/// Scene flow, or once the motion of the cameras is known what remains without it of the pixels with a motion of their own.
fn lines(field: &SceneFlowField, is_moving: impl Fn((usize, usize)) -> bool) -> Vec<CloudLine> {
    let on_grid = |(x, y): &(usize, usize)| x % SPACING == SPACING / 2 && y % SPACING == SPACING / 2;
    let line = |pixel: (usize, usize)| {
        let motion = field.motion(pixel)?;
        let by = match (&field.ego, &field.moving) {
            (None, _) => motion.displacement(),
            (Some(ego), None) => motion.own(&ego.pose),
            (Some(ego), Some(_)) => is_moving(pixel).then(|| motion.own(&ego.pose))?,
        };
        let to: [f32; 3] = std::array::from_fn(|i| (motion.from[i] + by[i]) as f32);
        Some(CloudLine { role: Role::Result, ends: [motion.from.map(|c| c as f32), to] })
    };
    field.pixels().filter(on_grid).filter_map(line).collect()
}

fn cameras(field: &SceneFlowField) -> Vec<CloudCamera> {
    let Some(rig) = &field.calibration else { return Vec::new() };
    let (width, height) = field.size();
    let corner = |x: f64, y: f64| {
        let [cx, cy] = rig.principal_px;
        [x - cx, y - cy, rig.focal_px].map(|c| c / rig.focal_px * PYRAMID_M)
    };
    let (right, bottom) = (width as f64 - 0.5, height as f64 - 0.5);
    let frame = [[0.0; 3], corner(-0.5, -0.5), corner(right, -0.5), corner(right, bottom), corner(-0.5, bottom)];
    let placed = |role, pose: &Pose, side: f64| {
        let at = |[x, y, z]: [f64; 3]| pose.moved([x + side, y, z]).map(|c| c as f32);
        CloudCamera { role, corners: frame.map(at) }
    };
    let pair = |role, pose: Pose| [0.0, rig.baseline_m].map(|side| placed(role, &pose, side));
    let mut all = pair(Role::Reference, Pose::IDENTITY).to_vec();
    all.extend(field.ego.iter().flat_map(|ego| pair(Role::Measured, ego.pose.inverse())));
    all
}
