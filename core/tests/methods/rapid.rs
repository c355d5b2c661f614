//! RAPiD, held to its definition with derivatives by differences, to exact poses, and to what it says of the scenes that break it.

use std::sync::Arc;

use crate::common::{fact, set, steps};
use motionscope_core::base::{Error, Threads};
use motionscope_core::data::{Clip, Flow, Frame, ObjectBox, Pose, Truth};
use motionscope_core::geometry::Grid;
use motionscope_core::params::Params;
use motionscope_core::products::RegionField;
use motionscope_core::run::Move;
use motionscope_core::scene::{Readout, Step};
use motionscope_core::synth;

fn run(settings: &[(&str, &str)], clip: &Clip) -> RegionField {
    let output = set("rapid", settings).run(clip, 0, &Threads::single()).expect("a run");
    output.get::<RegionField>().expect("a region").clone()
}

/// The poses of a truth, with the boxes of the first frame alone: those of all frames take most of the time of a walk.
struct Posed(Arc<dyn Truth>);

impl Truth for Posed {
    fn flow(&self, _t: usize) -> Result<Option<Arc<Flow>>, Error> {
        Ok(None)
    }

    fn objects(&self, t: usize) -> Result<Option<Vec<ObjectBox>>, Error> {
        if t == 0 { self.0.objects(t) } else { Ok(None) }
    }

    fn pose(&self, id: u32, t: usize) -> Result<Option<Pose>, Error> {
        self.0.pose(id, t)
    }

    fn kinds(&self) -> Vec<&'static str> {
        vec!["objects"]
    }
}

/// The turning box with these sliders.
fn turning(sliders: &[(&str, &str)]) -> Clip {
    let scene = synth::scene("turning-box").expect("a scene");
    let mut difficulty = scene.difficulty();
    sliders.iter().for_each(|(name, value)| difficulty.set(name, value).expect("a slider"));
    let clip = scene.clip(&difficulty).expect("a clip");
    let truth = Posed(Arc::clone(clip.truth().expect("a truth")));
    clip.with_truth(Arc::new(truth))
}

/// A matrix that a step shows, if it does.
fn shown(step: &Step, symbol: &str) -> Option<Grid<f64>> {
    let all = step.readouts.iter().filter_map(|readout| match readout {
        Readout::Matrices(matrices) => Some(matrices),
        _ => None,
    });
    all.flatten().find(|matrix| matrix.symbol == symbol).map(|matrix| matrix.entries.clone())
}

fn matrix(step: &Step, symbol: &str) -> Grid<f64> {
    shown(step, symbol).expect("a matrix")
}

fn pose(step: &Step) -> Pose {
    let entries = matrix(step, "[R T]");
    let rotation = [0, 1, 2].map(|y| [0, 1, 2].map(|x| entries[(x, y)]));
    Pose { rotation, translation: [0, 1, 2].map(|y| entries[(3, y)]) }
}

/// The error of a pose.
struct PoseError {
    /// Angle of the rotation in degrees.
    angle: f64,
    /// Length of the translation as a share of the depth.
    share: f64,
    /// Normalised estimation error squared, in units of the covariance; infinite without one.
    nees: f64,
}

/// The errors of the poses of all frames.
fn errors(settings: &[(&str, &str)], clip: &Clip) -> Vec<PoseError> {
    let length = |v: [f64; 3]| dot(v, v).sqrt();
    let truth = clip.truth().expect("a truth");
    let of = |(t, step): (usize, &Step)| {
        let exact = truth.pose(1, t).expect("readable").expect("a pose");
        let [rotation, shift] = exact.motion_to(&pose(step));
        // In the units of the covariance: degrees and mm.
        let off: Vec<f64> = rotation.iter().map(|c| c.to_degrees()).chain(shift.map(|c| 1000.0 * c)).collect();
        let squared = |covariance: Grid<f64>| {
            let row = |y: usize| std::array::from_fn(|x| if x < 6 { covariance[(x, y)] } else { off[y] });
            let weighed = solved(std::array::from_fn(row));
            (0..6).map(|i| off[i] * weighed[i]).sum()
        };
        PoseError {
            angle: length(rotation).to_degrees(),
            share: length(shift) / exact.translation[2],
            nees: shown(step, "P").map_or(f64::INFINITY, squared),
        }
    };
    steps(&*set("rapid", settings), clip, "Pose: turn").iter().enumerate().map(of).collect()
}

/// Half the sides of the model in m.
const HALF: [f64; 3] = [0.24, 0.16, 0.18];
/// Focal length and principal point of the default parameters in a picture of 320×240.
const MIDDLE: [f64; 2] = [159.5, 119.5];

fn focal() -> f64 {
    160.0 / (56.14f64.to_radians() / 2.0).tan()
}

fn projected([x, y, z]: [f64; 3]) -> [f64; 2] {
    [MIDDLE[0] + focal() * x / z, MIDDLE[1] + focal() * y / z]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

/// The edges of the box that a pose shows, by their ends in the coordinates of the camera: all but those between two faces that are turned
/// away.
fn visible(pose: &Pose) -> Vec<[[f64; 3]; 2]> {
    let corner = |signs: [f64; 3]| pose.moved([0, 1, 2].map(|i| signs[i] * HALF[i]));
    let faces_camera = |axis: usize, sign: f64| {
        let normal = [0, 1, 2].map(|i| if i == axis { sign } else { 0.0 });
        dot(pose.turned(normal), pose.moved([0, 1, 2].map(|i| normal[i] * HALF[i]))) < 0.0
    };
    let mut all = Vec::new();
    for axis in 0..3 {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        for (a, b) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            if faces_camera(u, a) || faces_camera(v, b) {
                all.push([-1.0, 1.0].map(|end| {
                    let mut signs = [0.0; 3];
                    (signs[axis], signs[u], signs[v]) = (end, a, b);
                    corner(signs)
                }));
            }
        }
    }
    all
}

/// The distance of the nearest edge within 8 px along a normal: a local maximum of the gradient, of at least 6 levels/px.
fn edge(picture: &Grid<u8>, at: [f64; 2], normal: [f64; 2]) -> Option<f64> {
    let between = |[x, y]: [f64; 2]| {
        let (i, j) = (x.floor() as usize, y.floor() as usize);
        let (u, v) = (x - i as f64, y - j as f64);
        let value = |x: usize, y: usize| f64::from(picture[(x, y)]);
        (1.0 - v) * ((1.0 - u) * value(i, j) + u * value(i + 1, j))
            + v * ((1.0 - u) * value(i, j + 1) + u * value(i + 1, j + 1))
    };
    let along = |k: f64| {
        let beside = |s: f64| between([at[0] + k * normal[0] - s * normal[1], at[1] + k * normal[1] + s * normal[0]]);
        (beside(-1.0) + beside(0.0) + beside(1.0)) / 3.0
    };
    let slope = |k: i32| (along(f64::from(k) + 1.0) - along(f64::from(k) - 1.0)).abs() / 2.0;
    let is_edge = |k: &i32| slope(*k) >= 6.0 && slope(*k) >= slope(k - 1) && slope(*k) >= slope(k + 1);
    let best = (-8..=8).filter(is_edge).min_by_key(|k: &i32| (k.abs(), *k))?;
    let [before, here, after] = [slope(best - 1), slope(best), slope(best + 1)];
    let bend = before - 2.0 * here + after;
    let part = if bend < 0.0 { ((before - after) / (2.0 * bend)).clamp(-0.5, 0.5) } else { 0.0 };
    Some(f64::from(best) + part)
}

/// The solution of a system of six equations by elimination with pivots.
fn solved(mut m: [[f64; 7]; 6]) -> [f64; 6] {
    for i in 0..6 {
        let pivot = (i..6).max_by(|a, b| m[*a][i].abs().total_cmp(&m[*b][i].abs())).expect("rows");
        m.swap(i, pivot);
        for row in 0..6 {
            let factor = m[row][i] / m[i][i];
            if row != i {
                (i..7).for_each(|column| m[row][column] -= factor * m[i][column]);
            }
        }
    }
    std::array::from_fn(|i| m[i][6] / m[i][i])
}

/// A point relative to the origin of the object after a small rotation about it and a translation.
fn moved([x, y, z]: [f64; 3], origin: [f64; 3], by: [f64; 6]) -> [f64; 3] {
    let [a, b, c, ..] = by;
    let turned = [x + b * z - c * y, y + c * x - a * z, z + a * y - b * x];
    [0, 1, 2].map(|i| turned[i] + origin[i] + by[3 + i])
}

/// An equation of an edge: the derivatives of its distance by the six parameters, and the distance in px.
type Equation = ([f64; 6], f64);

/// The equations of one iteration (Harris 1990): the derivatives of the projections are differences.
fn equations(picture: &Grid<u8>, pose: &Pose) -> Vec<Equation> {
    let mut all = Vec::new();
    for [from, to] in visible(pose) {
        let [a, b] = [projected(from), projected(to)];
        let length = (b[0] - a[0]).hypot(b[1] - a[1]);
        let normal = [(b[1] - a[1]) / length, (a[0] - b[0]) / length];
        let count = (length / 6.0).round() as usize;
        for i in 0..count {
            let share = (i as f64 + 0.5) / count as f64;
            let place = [0, 1, 2].map(|k| from[k] + share * (to[k] - from[k]));
            let Some(distance) = edge(picture, projected(place), normal) else { continue };
            let arm = [0, 1, 2].map(|k| place[k] - pose.translation[k]);
            let slope = |k: usize| {
                let along = |step: f64| {
                    let mut by = [0.0; 6];
                    by[k] = step;
                    let [x, y] = projected(moved(arm, pose.translation, by));
                    normal[0] * x + normal[1] * y
                };
                (along(1e-5) - along(-1e-5)) / 2e-5
            };
            all.push((std::array::from_fn(slope), distance));
        }
    }
    all
}

/// The weighted least-squares solution of equations.
fn fitted(all: &[Equation], weights: &[f64]) -> [f64; 6] {
    let mut system = [[0.0; 7]; 6];
    for ((row, distance), weight) in all.iter().zip(weights) {
        for k in 0..6 {
            (0..6).for_each(|l| system[k][l] += weight * row[k] * row[l]);
            system[k][6] += weight * row[k] * distance;
        }
    }
    solved(system)
}

/// Three times weights 1/(1 + |r|), r the distances that the solution with the last ones leaves (Drummond and Cipolla 2002).
fn robust_weights(all: &[Equation]) -> Vec<f64> {
    let mut weights = vec![1.0; all.len()];
    for _ in 0..3 {
        let motion = fitted(all, &weights);
        let left = |(row, distance): &Equation| distance - (0..6).map(|k| row[k] * motion[k]).sum::<f64>();
        weights = all.iter().map(|equation| 1.0 / (1.0 + left(equation).abs())).collect();
    }
    weights
}

#[test]
fn iterations_are_those_of_the_definition() {
    let clip = turning(&[]);
    for weighting in ["equal", "robust"] {
        let estimator = set("rapid", &[("frames", "6"), ("weighting", weighting), ("pose-prediction", "none")]);
        let judged = steps(&*estimator, &clip, "Pose: turn");
        let first = steps(&*estimator, &clip, "Iteration 1:");
        assert_eq!((judged.len(), first.len()), (6, 6));
        for t in 1..6 {
            // Without a prediction, a frame starts at the pose of the one before.
            let before = pose(&judged[t - 1]);
            let all = equations(clip.frame(t).expect("a frame").luma(), &before);
            let weights = if weighting == "robust" { robust_weights(&all) } else { vec![1.0; all.len()] };
            let expected = fitted(&all, &weights);
            let found = before.motion_to(&pose(&first[t]));
            for (i, (found, expected)) in found.as_flattened().iter().zip(expected).enumerate() {
                assert!((found - expected).abs() < 1e-5, "{weighting}, frame {t}, parameter {i}: {found}, {expected}");
            }
        }
    }
}

#[test]
fn the_first_sentence_says_what_is_given() {
    let walk = set("rapid", &[]).walk(&turning(&[]), 0).expect("a walk");
    let said = walk.step(None).sentence.plain();
    assert!(said.contains("is given the shape") && !said.contains("learns"), "{said}");
}

#[test]
fn a_weighted_step_shows_its_weights_and_the_error_of_its_pose() {
    let clip = turning(&[]);
    for (weighting, what) in
        [("equal", ". Least squares over 6 parameters"), ("robust", ". Weighted least squares over 6 parameters")]
    {
        let estimator = set("rapid", &[("frames", "2"), ("weighting", weighting)]);
        assert!(!steps(&*estimator, &clip, what).is_empty(), "{weighting}");
        let judged = steps(&*estimator, &clip, "Pose: turn");
        assert!(judged.iter().all(|step| fact(step, "Error of the rotation").is_some_and(|text| text.ends_with('°'))));
    }
}

#[test]
fn the_covariance_grows_with_noise() {
    let deviation = |noise: &str| {
        let judged = steps(&*set("rapid", &[("frames", "8")]), &turning(&[("noise", noise)]), "Pose: turn");
        judged.iter().map(|step| matrix(step, "P")[(5, 5)].sqrt()).sum::<f64>() / judged.len() as f64
    };
    let all = ["0", "6", "12"].map(deviation);
    assert!(all[0] > 0.0 && all.is_sorted_by(|a, b| a < b), "{all:?} mm");
}

/// A gray cylinder of radius 0.2 m and height 0.5 m in a pose, by casting a ray through 3×3 places of each pixel.
fn cylinder(pose: &Pose) -> Frame {
    let eye = pose.turned_back(pose.translation.map(|c| -c));
    let shade = |x: f64, y: f64| {
        let ray = pose.turned_back([(x - MIDDLE[0]) / focal(), (y - MIDDLE[1]) / focal(), 1.0]);
        let [a, b, c] = [
            ray[0] * ray[0] + ray[2] * ray[2],
            eye[0] * ray[0] + eye[2] * ray[2],
            eye[0] * eye[0] + eye[2] * eye[2] - 0.04,
        ];
        let at = |t: f64| [0, 1, 2].map(|i| eye[i] + t * ray[i]);
        let root = (b * b - a * c).max(0.0).sqrt();
        let side = Some((-b - root) / a).filter(|t| b * b >= a * c && at(*t)[1].abs() <= 0.25).map(|t| (t, 140.0));
        let end = |y: f64, gray: f64| {
            let t = (y - eye[1]) / ray[1];
            Some((t, gray)).filter(|_| at(t)[0].hypot(at(t)[2]) <= 0.2)
        };
        let all = [side, end(-0.25, 220.0), end(0.25, 80.0)];
        all.into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0)).map_or(40.0, |(_, gray)| gray)
    };
    let thirds = [-1.0 / 3.0, 0.0, 1.0 / 3.0];
    Frame::gray(Grid::from_fn(320, 240, |x, y| {
        let places = thirds.into_iter().flat_map(|u| thirds.map(|v| (x as f64 + u, y as f64 + v)));
        (places.map(|(x, y)| shade(x, y)).sum::<f64>() / 9.0 + 0.5) as u8
    }))
}

/// The judged steps of a cylinder in these poses.
fn judged_cylinder(exact: &[Pose]) -> Vec<Step> {
    let clip = Clip::from_frames("cylinder", exact.iter().map(cylinder).collect()).expect("frames of one size");
    // The rectangle around the first one.
    let luma = clip.frame(0).expect("a frame");
    let places = (0..240).flat_map(|y| (0..320).map(move |x| (x, y))).filter(|place| luma.luma()[*place] > 60);
    let ends = places.fold([320, 240, 0, 0], |[l, t, r, b], (x, y)| [l.min(x), t.min(y), r.max(x), b.max(y)]);
    let region = ends.map(|c| c.to_string()).join(",");
    let size = [("solid", "cylinder"), ("model-width", "0.4"), ("model-height", "0.5"), ("model-depth", "0.4")];
    let settings = [&size[..], &[("region", region.as_str()), ("turn", "0"), ("tilt", "20")]].concat();
    steps(&*set("rapid", &settings), &clip, "Pose: turn")
}

#[test]
fn a_cylinder_is_followed_but_for_the_rotation_about_its_axis() {
    let tilt = |t: usize| (0.35 + 0.012 * t as f64).sin_cos();
    let exact = |t: usize| Pose::tilted((0.0, 1.0), tilt(t), [0.012 * t as f64, 0.0, 1.8 - 0.02 * t as f64]);
    let judged = judged_cylinder(&(0..12).map(exact).collect::<Vec<_>>());
    assert_eq!(judged.len(), 12);
    for (t, step) in judged.iter().enumerate() {
        let (found, exact) = (pose(step), exact(t));
        // Between the axes.
        let [a, b] = [&found, &exact].map(|pose| pose.turned([0.0, 1.0, 0.0]));
        let angle = dot(a, b).min(1.0).acos().to_degrees();
        let [_, shift] = found.motion_to(&exact);
        let off = shift.iter().map(|c| c * c).sum::<f64>().sqrt();
        assert!(angle < 1.5 && off < 0.03, "frame {t}: {angle}°, {off} m");
        assert_eq!(fact(step, "Rotation about the axis of the cylinder").as_deref(), Some("held"));
        // The held rotation has no variance: the axis and the covariance of the rotation are orthogonal.
        let (covariance, axis) = (matrix(step, "P"), found.turned([0.0, 1.0, 0.0]));
        let along = |y: usize| (0..3).map(|x| covariance[(x, y)] * axis[x]).sum::<f64>();
        assert!((0..6).all(|y| along(y).abs() < 1e-9), "frame {t}: {covariance:?}");
    }
}

#[test]
fn bad_regions_are_refused_with_their_reason() {
    let flat = Clip::from_frames("flat", vec![Frame::gray(Grid::new(64, 48, 90u8)); 3]).expect("frames of one size");
    let estimator = set("rapid", &[("region", "20,15,44,33")]);
    let refused = steps(&*estimator, &flat, "cannot be tracked");
    assert!(
        refused[0].sentence.plain().contains("0 of ") && refused[0].sentence.plain().contains("6 parameters of a pose")
    );
    let field = run(&[("region", "20,15,44,33")], &flat);
    assert!(field.frames.len() == 1 && field.frames[0].is_lost, "{field:?}");
    for extreme in [
        ("field-of-view", "150"),
        ("field-of-view", "5"),
        ("model-depth", "100"),
        ("model-width", "0.01"),
        ("tilt", "89"),
        ("turn", "-180"),
    ] {
        let field = run(&[extreme, ("frames", "4")], &turning(&[]));
        let regions = field.frames.iter().map(|frame| frame.region);
        assert!(
            regions.into_iter().all(|region| region.size.iter().chain(&region.center).all(|c| c.is_finite())),
            "{extreme:?}"
        );
    }
}

/// The largest error of the rotation in degrees, and of the translation as a share of the depth.
fn worst(settings: &[(&str, &str)], clip: &Clip) -> (f64, f64) {
    let all = errors(settings, clip);
    assert!(!all.is_empty());
    all.iter().fold((0.0, 0.0), |(a, b), error| (a.max(error.angle), b.max(error.share)))
}

#[test]
fn the_turning_box_is_followed_with_its_pose() {
    for sliders in [&[][..], &[("noise", "2")], &[("noise", "2"), ("seed", "7")], &[("noise", "2"), ("speed", "2")]] {
        let clip = turning(sliders);
        let (angle, share) = worst(&[], &clip);
        assert!(angle < 1.0 && share < 0.005, "{sliders:?}: {angle}°, {share} of the depth");
        assert!(run(&[], &clip).frames.iter().all(|frame| !frame.is_lost), "{sliders:?}");
    }
}

#[test]
fn the_covariance_is_that_of_the_errors() {
    // The errors of six parameters, squared in units of their covariance, have a mean of 6 if that is right. Errors of neighbouring edges are
    // not quite independent, so it is somewhat more.
    let each = ["1", "2", "3"].map(|seed| {
        let all = errors(&[], &turning(&[("seed", seed), ("noise", "2")]));
        all.iter().map(|error| error.nees).sum::<f64>() / all.len() as f64
    });
    let mean = each.iter().sum::<f64>() / 3.0;
    assert!((4.0..12.0).contains(&mean), "{each:?}");
}

/// The setting of the original method, with a range of 4 px.
const PLAIN: [(&str, &str); 4] =
    [("search-range", "4"), ("pose-prediction", "none"), ("weighting", "equal"), ("iterations", "1")];

#[test]
fn a_motion_beyond_the_search_range_loses_the_box() {
    let clip = turning(&[("speed", "2")]);
    let (angle, _) = worst(&PLAIN, &clip);
    assert!(angle > 10.0 && run(&PLAIN, &clip).frames.iter().any(|frame| frame.is_lost), "{angle}°");
    // The prediction leaves its error alone to the same range.
    let (angle, _) = worst(&PLAIN[..1], &clip);
    assert!(angle < 1.0, "{angle}°");
}

/// The turning box behind a dark upright pole of this width in px.
fn behind_a_pole(width: usize) -> Clip {
    let clip = turning(&[]);
    let truth = Arc::clone(clip.truth().expect("a truth"));
    let frame = |t: usize| {
        let luma = clip.frame(t).expect("a frame").luma().clone();
        let is_pole = |x: usize| (150..150 + width).contains(&x);
        Frame::gray(Grid::from_fn(320, 240, |x, y| if is_pole(x) { 20 } else { luma[(x, y)] }))
    };
    let frames = (0..).take_while(|t| clip.has_frame(*t).expect("readable")).map(frame).collect();
    Clip::from_frames("pole", frames).expect("frames of one size").with_truth(truth)
}

#[test]
fn a_few_edges_of_something_else_weigh_less_with_robust_weights() {
    let clip = behind_a_pole(4);
    let [robust, equal] = ["robust", "equal"].map(|weighting| worst(&[("weighting", weighting)], &clip).0);
    assert!(robust < 1.0 && equal > 1.5 * robust, "{robust}°, {equal}°");
}

#[test]
fn many_edges_of_something_else_pull_the_pose_away() {
    let clip = behind_a_pole(20);
    for weighting in ["robust", "equal"] {
        let (angle, _) = worst(&[("weighting", weighting)], &clip);
        assert!(angle > 5.0, "{weighting}: {angle}°");
    }
    // The rectangle around the model fits all the same, so the step says what it does not show.
    assert!(!steps(&*set("rapid", &[]), &clip, "wrong edges were matched").is_empty());
}

#[test]
fn a_pose_that_jumps_off_is_reported_as_lost() {
    // Noise makes edges everywhere, so that every control point finds one.
    for slider in [("noise", "20"), ("salt-and-pepper", "10")] {
        let clip = turning(&[slider]);
        let (errors, field) = (errors(&[], &clip), run(&[], &clip));
        let wrong = field.frames.iter().zip(&errors).filter(|(_, error)| error.angle > 10.0);
        let reported: Vec<bool> = wrong.map(|(frame, _)| frame.is_lost).collect();
        let count = reported.iter().filter(|is_lost| **is_lost).count();
        assert!(reported.len() > 20 && 10 * count >= 9 * reported.len(), "{slider:?}: {count} of {}", reported.len());
    }
    assert!(!steps(&*set("rapid", &[]), &turning(&[("noise", "20")]), "do not fit one pose").is_empty());
    // Blur and light change the edges, not the pose.
    for slider in [("motion-blur", "100"), ("flicker", "40"), ("noise", "10")] {
        assert!(run(&[], &turning(&[slider])).frames.iter().all(|frame| !frame.is_lost), "{slider:?}");
    }
}

#[test]
fn a_fast_motion_needs_a_prediction() {
    let clip = turning(&[("speed", "2")]);
    let [still, predicted] = ["none", "constant-velocity"].map(|how| worst(&[("pose-prediction", how)], &clip).0);
    assert!(still > 5.0 && predicted < 1.0, "{still}°, {predicted}°");
}

/// The sentence at the end of a run.
fn conclusion(settings: &[(&str, &str)], clip: &Clip) -> String {
    let mut walk = set("rapid", settings).walk(clip, 0).expect("a walk");
    walk.jump(Move::End);
    walk.step(None).sentence.plain()
}

#[test]
fn the_end_counts_wrong_poses() {
    // Boxes overlap all the time, so that a tracker of regions would report no failure.
    let settings = [("search-range", "4"), ("pose-prediction", "none")];
    let clip = turning(&[("speed", "2.5")]);
    let (errors, field) = (errors(&settings, &clip), run(&settings, &clip));
    let is_wrong = |error: &PoseError| error.angle > 5.0 || error.share > 0.05;
    let wrong = errors.iter().filter(|error| is_wrong(error)).count();
    let unreported =
        errors.iter().zip(&field.frames).filter(|(error, frame)| is_wrong(error) && !frame.is_lost).count();
    let end = conclusion(&settings, &clip);
    let counted =
        format!("in {wrong} of {} frames: pose failures, {unreported} of them not reported as lost", errors.len());
    assert!(wrong > 10 && end.contains(&counted), "{counted}: {end}");
    assert!(!end.contains("errors do not add up"), "{end}");
    // A texture of lines holds the model on wrong edges.
    let end = conclusion(&[], &turning(&[("repeating-texture", "100")]));
    assert!(end.contains("pose failures") && end.contains("not reported as lost"), "{end}");
    let end = conclusion(&[], &turning(&[]));
    assert!(end.contains("the pose never differs from the true one by more than 5.00°"), "{end}");
}

#[test]
fn without_true_poses_the_end_tells_how_the_edges_fit() {
    let clip = turning(&[]);
    let frames = (0..8).map(|t| (*clip.frame(t).expect("a frame")).clone()).collect();
    let placed = run(&[], &clip).frames[0].region.bounds();
    let region = format!("{},{},{},{}", placed.min[0], placed.min[1], placed.max[0], placed.max[1]);
    let end = conclusion(&[("region", &region)], &Clip::from_frames("box", frames).expect("frames of one size"));
    assert!(end.contains("of the control points have an edge, at a median distance of"), "{end}");
}
