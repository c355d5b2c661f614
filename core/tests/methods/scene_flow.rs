//! Scene flow against its definition, against exact truth, and against the theory of its errors.

use std::sync::Arc;

use crate::common::set;
use motionscope_core::base::{Error, Threads};
use motionscope_core::course::{estimator, estimators};
use motionscope_core::data::{Calibration, Clip, DepthSource, Frame, PixelClass, Pose};
use motionscope_core::geometry::Grid;
use motionscope_core::params::Params;
use motionscope_core::products::scene_flow::{depth_error, scene_flow_error};
use motionscope_core::products::{Reference, SceneFlowField};
use motionscope_core::run::{AnyEstimator, Cursor, Direction, Guarantee, Move};
use motionscope_core::synth;

fn street(settings: &[(&str, &str)]) -> Clip {
    scene("drive", settings)
}

fn scene(id: &str, settings: &[(&str, &str)]) -> Clip {
    let scene = synth::scene(id).expect("a scene");
    let mut difficulty = scene.difficulty();
    settings.iter().for_each(|(name, value)| difficulty.set(name, value).expect("in range"));
    scene.clip(&difficulty).expect("a clip")
}

fn made(estimator: &dyn AnyEstimator, clip: &Clip, frame: usize) -> SceneFlowField {
    let output = estimator.run(clip, frame, &Threads::single()).expect("a run");
    output.get::<SceneFlowField>().expect("a scene flow").clone()
}

fn of_truth(noise_px: &str) -> Box<dyn AnyEstimator> {
    set("scene-flow", &[("source", "truth"), ("noise", noise_px)])
}

/// Z = f B / d, X = (x − cx) Z / f, Y = (y − cy) Z / f.
fn triangulated(rig: &Calibration, x: f64, y: f64, d: f64) -> [f64; 3] {
    let depth = rig.focal_px * rig.baseline_m / d;
    [(x - rig.principal_px[0]) * depth / rig.focal_px, (y - rig.principal_px[1]) * depth / rig.focal_px, depth]
}

#[test]
fn positions_and_displacements_are_those_of_the_definition() {
    let clip = street(&[("width", "160"), ("height", "120")]);
    let (truth, rig) = (clip.truth().expect("truth"), *clip.calibration().expect("a calibration"));
    let field = made(&*of_truth("0"), &clip, 4);
    let [flow, now, next] = [
        truth.flow(4).unwrap().unwrap().0.map(|[u, v]| [f64::from(*u), f64::from(*v)]),
        truth.disparity(4).unwrap().unwrap().0.map(|d| [f64::from(*d), 0.0]),
        truth.next_disparity(4).unwrap().unwrap().0.map(|d| [f64::from(*d), 0.0]),
    ];
    let mut compared = 0;
    for (x, y) in field.pixels() {
        let motion = field.motion((x, y)).expect("the truth is known everywhere");
        let ([u, v], d, after) = (flow[(x, y)], now[(x, y)][0], next[(x, y)][0]);
        let (from, to) =
            (triangulated(&rig, x as f64, y as f64, d), triangulated(&rig, x as f64 + u, y as f64 + v, after));
        for i in 0..3 {
            assert!((motion.from[i] - from[i]).abs() < 1e-9 * from[2] && (motion.to[i] - to[i]).abs() < 1e-9 * to[2]);
            assert!((motion.displacement()[i] - (to[i] - from[i])).abs() < 1e-9 * to[2]);
        }
        compared += 1;
    }
    assert_eq!(compared, 160 * 120);
}

#[test]
fn with_exact_measurements_the_camera_is_exact_and_only_objects_move() {
    let clip = street(&[]);
    // Single precision is all the noise that there is.
    let settings = [("source", "truth"), ("noise", "0"), ("sigma", "0.01"), ("opening", "0")];
    let estimator = set("scene-flow", &settings);
    for frame in [0, 9, 20] {
        let field = made(&*estimator, &clip, frame);
        let truth = clip.truth().expect("truth");
        let ego = truth.ego_motion(frame).unwrap().expect("a motion of the cameras");
        let [turned, moved] = ego.motion_to(&field.ego.expect("a motion").pose);
        assert!(turned.iter().chain(&moved).all(|off| off.abs() < 1e-4), "{frame}: {turned:?} {moved:?}");
        let mask = truth.foreground(frame).unwrap().expect("objects");
        let moving = field.moving.as_ref().expect("a mask");
        let wrong = field.pixels().filter(|&(x, y)| moving.get(x, y) != (mask.0[(x, y)] == PixelClass::Foreground));
        assert_eq!(wrong.count(), 0, "frame {frame}");
    }
}

#[test]
fn errors_grow_with_the_square_of_the_depth_as_theory_says() {
    for (id, frame) in [("drive", 2), ("still-life", 5)] {
        let clip = scene(id, &[]);
        let field = made(&*of_truth("0.25"), &clip, frame);
        let rows = depth_error(&field, &Reference { clip: &clip, frame }, (0.25, 8));
        assert_eq!(rows.len(), 8);
        let rig = clip.calibration().expect("a calibration");
        for [depth, found, expected] in rows {
            // To first order: not where the noise is a large part of the disparity itself.
            let disparity = rig.focal_px * rig.baseline_m / depth;
            if disparity > 5.0 {
                assert!((found / expected - 1.0).abs() < 0.1, "{id} at {depth} m: {found} against {expected}");
            }
            // σ_ΔZ / Z = √2 σ / d: within 2 % of the depth from 18 px on.
            if disparity > 20.0 {
                assert!(found < 0.02 * depth, "{id} at {depth} m: {found}");
            }
        }
    }
}

#[test]
fn estimated_scene_flow_is_right_on_scenes_it_was_not_tuned_on() {
    for (id, seed, frame) in [("drive", "7", 0), ("drive", "23", 11), ("still-life", "5", 3)] {
        let clip = scene(id, &[("seed", seed)]);
        let field = made(&*estimator("scene-flow").unwrap(), &clip, frame);
        let error = scene_flow_error(&field, &Reference { clip: &clip, frame }).expect("readable truth");
        let (median, [turned, moved]) = (error.median_percent.expect("truth"), error.ego.expect("a motion"));
        assert!(median < 2.0, "{id} {seed}: median {median} % of the depth");
        assert!(moved < 0.02 && turned.to_degrees() < 0.03, "{id} {seed}: {moved} m, {}°", turned.to_degrees());
    }
}

#[test]
fn without_calibration_disparities_remain_and_without_a_right_view_the_flow() {
    let clip = street(&[("width", "96"), ("height", "72"), ("frames", "3")]);
    let frames = |clip: &Clip| (0..3).map(|t| (*clip.frame(t).unwrap()).clone()).collect::<Vec<_>>();
    let mono = Clip::from_frames("left", frames(&clip)).unwrap();
    let right = Clip::from_frames("right", frames(clip.right().unwrap())).unwrap();
    let stereo = mono.clone().with_right(right).unwrap();
    let estimator = estimator("scene-flow").unwrap();
    let field = made(&*estimator, &stereo, 0);
    assert!(field.pixels().filter(|pixel| field.measured(*pixel).is_some()).count() > 96 * 72 / 2);
    assert!(field.pixels().all(|pixel| field.motion(pixel).is_none()) && field.ego.is_none());
    let field = made(&*estimator, &mono, 0);
    assert!(field.flow.at(48, 36).is_some() && field.disparity.known() == 0);
    for (clip, told) in [(&mono, "no right view"), (&stereo, "not calibrated")] {
        let walk = estimator.walk(clip, 0).unwrap();
        let sentence = walk.step(None).sentence.plain();
        assert!(sentence.contains(told), "{sentence}");
    }
    let refused = of_truth("0").run(&stereo, 0, &Threads::single()).expect_err("no truth").to_string();
    assert!(refused.contains("source"), "{refused}");
    assert!(estimator.run(&stereo, 2, &Threads::single()).is_err(), "there is no frame after the last");
}

/// The depths of a clip from its true disparities.
struct Sensor(Clip);

impl DepthSource for Sensor {
    fn depth_m(&self, t: usize) -> Result<Option<Arc<Grid<f32>>>, Error> {
        let rig = *self.0.calibration().expect("a calibration");
        let map = self.0.truth().expect("truth").disparity(t)?;
        Ok(map.map(|map| Arc::new(map.0.map(|d| rig.depth_m(f64::from(*d)).map_or(f32::NAN, |z| z as f32)))))
    }
}

#[test]
fn depths_of_a_sensor_take_the_place_of_two_views() {
    let clip = street(&[("frames", "3")]);
    let frames = (0..3).map(|t| (*clip.frame(t).unwrap()).clone()).collect();
    let left = Clip::from_frames("left", frames).unwrap().with_depths(Arc::new(Sensor(clip.clone())));
    let estimator = estimator("scene-flow").unwrap();
    let start = |clip: &Clip| estimator.walk(clip, 0).unwrap().step(None).sentence.plain();
    assert!(start(&left).contains("focal length"), "{}", start(&left));
    let left = left.with_calibration(*clip.calibration().unwrap()).with_truth(Arc::clone(clip.truth().unwrap()));
    assert!(start(&left).starts_with("A depth and the focal length"));
    let field = made(&*estimator, &left, 0);
    let error = scene_flow_error(&field, &Reference { clip: &left, frame: 0 }).unwrap();
    assert!(error.ego.expect("a motion")[1] < 0.01, "{error:?}");
    let truth = clip.truth().unwrap().disparity(0).unwrap().unwrap();
    assert!(field.pixels().all(|(x, y)| (field.disparity.0[(x, y)] - truth.0[(x, y)]).abs() < 1e-3));
    // Depths of another size are refused.
    let small = street(&[("width", "96"), ("height", "72"), ("frames", "3")]);
    let wrong = left.with_depths(Arc::new(Sensor(small)));
    let refused = estimator.run(&wrong, 0, &Threads::single()).expect_err("of another size").to_string();
    assert!(refused.contains("96×72 px"), "{refused}");
}

#[test]
fn stepping_is_running_and_any_cursor_is_reached_from_both_sides() {
    let clip = street(&[("width", "96"), ("height", "72"), ("frames", "3")]);
    let mut ran = 0;
    for estimator in estimators().into_iter().filter(|estimator| estimator.guarantee() == Guarantee::SceneFlow) {
        let mut walk = estimator.walk(&clip, 0).unwrap();
        let event = walk.info().granularities.len() - 1;
        let mut steps = vec![(walk.cursor(), walk.step(None))];
        while !walk.at_end() {
            walk.jump(Move::Granularity(event, Direction::Forward));
            steps.push((walk.cursor(), walk.step(None)));
        }
        assert_eq!(walk.output(), estimator.run(&clip, 0, &Threads::new(2).unwrap()).unwrap());
        assert!(steps.len() > 150, "{}", steps.len());
        for (cursor, step) in steps.iter().rev().step_by(17) {
            walk.jump(Move::To(*cursor));
            assert_eq!(walk.step(None), *step, "{cursor:?}");
        }
        ran += 1;
    }
    assert_eq!(ran, 1);
}

#[test]
fn as_many_samples_are_said_to_be_enough_only_where_they_are() {
    let clip = street(&[("width", "96"), ("height", "72"), ("frames", "3")]);
    for (noise, iterations, phrase) in
        [("0", "200", "samples are enough"), ("3", "4", "All 4 samples that are allowed are drawn")]
    {
        let estimator = set("scene-flow", &[("source", "truth"), ("noise", noise), ("iterations", iterations)]);
        let mut walk = estimator.walk(&clip, 0).unwrap();
        let event = walk.info().granularities.len() - 1;
        let (mut told, mut others) = (0, 0);
        while !walk.at_end() {
            walk.jump(Move::Granularity(event, Direction::Forward));
            let said = walk.step(None).sentence.plain();
            if said.contains("the best so far") {
                *(if said.contains(phrase) { &mut told } else { &mut others }) += 1;
            }
        }
        assert!(told > 0 && others == 0, "{noise} px: {told}, {others}");
    }
}

#[test]
fn without_ego_motion_no_pixel_is_judged() {
    let clip = street(&[("width", "96"), ("height", "72"), ("frames", "3")]);
    // Two points at most, which determine no rigid motion.
    let estimator = set("scene-flow", &[("spacing", "64")]);
    let mut walk = estimator.walk(&clip, 0).unwrap();
    walk.jump(Move::To(Cursor::END));
    assert!(walk.failure().is_none(), "{:?}", walk.failure());
    let told = walk.step(None).sentence.plain();
    assert!(told.contains("not determined") && !told.contains("at rest"), "{told}");
    let output = walk.output();
    let field = output.get::<SceneFlowField>().unwrap();
    assert!(field.ego.is_none() && field.moving.is_none() && field.known() > 1000);
    let error = scene_flow_error(field, &Reference { clip: &clip, frame: 0 }).unwrap();
    assert_eq!((error.ego, error.own_motion_f1), (None, None));
}

#[test]
fn pictures_of_a_few_pixels_have_a_scene_flow_or_none() {
    let estimator = estimator("scene-flow").unwrap();
    let rig = Calibration::new(30.0, 0.5, [0.0; 2]).unwrap();
    for (width, height) in [(1, 1), (1, 9), (9, 1), (3, 2)] {
        let frames = || vec![Frame::gray(Grid::from_fn(width, height, |x, y| (90 * x + 37 * y) as u8)); 2];
        let clip = |name: &str| Clip::from_frames(name, frames()).unwrap();
        let stereo = clip("left").with_right(clip("right")).unwrap().with_calibration(rig);
        let field = made(&*estimator, &stereo, 0);
        assert_eq!((field.size(), field.ego), ((width, height), None));
    }
}

#[test]
fn swapped_views_are_recognized() {
    let clip = street(&[("frames", "3")]);
    let frames = |clip: &Clip| (0..3).map(|t| (*clip.frame(t).unwrap()).clone()).collect::<Vec<_>>();
    let [left, right] = [frames(&clip), frames(clip.right().unwrap())];
    let start = |views: [&Vec<Frame>; 2]| {
        let [left, right] = views.map(|frames| Clip::from_frames("view", frames.clone()).unwrap());
        let stereo = left.with_right(right).unwrap().with_calibration(*clip.calibration().unwrap());
        estimator("scene-flow").unwrap().walk(&stereo, 0).unwrap().step(None).sentence.plain()
    };
    assert!(!start([&left, &right]).contains("The views are"), "{}", start([&left, &right]));
    assert!(start([&right, &left]).contains("The views are"), "{}", start([&right, &left]));
}

#[test]
fn a_scene_at_rest_has_no_motion_of_its_own() {
    let clip = scene("still-life", &[]);
    let field = made(&*estimator("scene-flow").unwrap(), &clip, 0);
    let ego = field.ego.expect("a motion").pose;
    let [turned, moved] = Pose::IDENTITY.motion_to(&ego);
    assert!(turned.iter().chain(&moved).all(|off| off.abs() < 0.01), "the cameras stand still: {turned:?} {moved:?}");
    let beside = Grid::from_fn(40, 60, |x, y| field.moving.as_ref().unwrap().get(4 + x, 4 + y));
    assert!(beside.cells().iter().filter(|moving| **moving).count() < 30, "the wall");
}

#[test]
fn the_end_judges_no_pixel_by_an_ego_motion_of_a_minority() {
    let clip = street(&[]);
    let percents = |settings: &[(&str, &str)]| {
        let mut walk = set("scene-flow", settings).walk(&clip, 0).unwrap();
        walk.jump(Move::To(Cursor::END));
        let field = walk.output().get::<SceneFlowField>().unwrap().clone();
        let told = walk.step(None).sentence.plain();
        (field.ego.expect("a motion").is_of_majority(), told.matches(" %").count())
    };
    let (is_of_majority, with_share) = percents(&[("source", "truth"), ("noise", "0.5")]);
    assert!(is_of_majority);
    // The threshold is well below the noise, so few points agree with any motion.
    let (is_of_majority, without_share) = percents(&[("source", "truth"), ("noise", "0.5"), ("threshold", "0.2")]);
    assert!(!is_of_majority);
    assert!(without_share < with_share, "no share of pixels with a motion of their own");
}
