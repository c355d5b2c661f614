//! Global motion at work: stabilisation, mosaics and differences under a moving camera, held to the true path of a synthetic one.

use crate::common::set;
use motionscope_core::base::Threads;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::Grid;
use motionscope_core::params::Params;
use motionscope_core::products::model::{Matrix3, mapped};
use motionscope_core::products::path::{PathErrors, chained, jitter, track, true_motions};
use motionscope_core::products::{MaskField, Output, PathField, Reference, Views};
use motionscope_core::run::{Cursor, Move};
use motionscope_core::scene::{Answer, Shown};
use motionscope_core::synth;

fn clip(scene: &str, settings: &[(&str, &str)]) -> Clip {
    let scene = synth::scene(scene).expect("a bundled scene");
    let mut difficulty = scene.difficulty();
    settings.iter().for_each(|(name, value)| difficulty.set(name, value).expect("in range"));
    synth::make(scene.id, &difficulty).expect("a clip")
}

fn run(id: &str, settings: &[(&str, &str)], clip: &Clip) -> Output {
    set(id, settings).run(clip, 0, &Threads::new(2).expect("sound")).expect("a run")
}

fn measure(output: &Output, clip: &Clip, key: &str) -> f64 {
    let assessed = output.assess(&Reference { clip, frame: 0 }).expect("frames can be read");
    let score = assessed.scores.iter().find(|score| score.measure.key == key).expect("it is measured");
    score.value.real().unwrap_or(f64::NAN)
}

fn errors(output: &Output, clip: &Clip) -> PathErrors {
    output.get::<PathField>().expect("a path").errors(clip).expect("a synthetic truth")
}

#[test]
fn the_true_motion_of_the_background_is_that_of_its_pixels() {
    for scene in ["hand-held", "passing-bus", "spin-zoom", "parallax"] {
        let clip = clip(scene, &[("frames", "6"), ("rotation", "1")]);
        let truth = clip.truth().expect("a synthetic clip");
        let mut agreeing = 0;
        for t in 0..5 {
            let matrix = truth.background(t).expect("computed").expect("a background that does not bend");
            let flow = truth.flow(t).expect("computed").expect("a pair");
            let is_there = |x: usize, y: usize| {
                let to = mapped(&matrix, [x as f64, y as f64]).expect("before the horizon");
                let [u, v] = flow.at(x, y).expect("known everywhere");
                (x as f64 + f64::from(u) - to[0]).hypot(y as f64 + f64::from(v) - to[1]) < 1e-3
            };
            agreeing += (0..240)
                .step_by(5)
                .flat_map(|y| (0..320).step_by(5).map(move |x| (x, y)))
                .filter(|at| is_there(at.0, at.1))
                .count();
        }
        // Elsewhere is an object, or a layer in front.
        assert!(agreeing > 5 * 48 * 64 / 8, "{scene}: {agreeing}");
        assert_eq!(truth.background(5), Ok(None), "{scene}: there is no next frame");
    }
}

#[test]
fn a_hand_held_pan_is_chained_and_stabilised() {
    let clip = clip("hand-held", &[]);
    let output = run("stabilization", &[], &clip);
    let found = errors(&output, &clip);
    let truth = true_motions(&clip, (0, 23)).expect("computed").expect("a synthetic clip");
    let shaken = jitter(&track(&chained(&truth), clip.size())).expect("24 frames");
    let [motion, drift, residual] = [found.motion_px, found.drift_px, found.residual_px].map(|px| px.expect("known"));
    assert!(shaken > 2.0, "the camera shakes: {shaken}");
    assert!(motion < 0.3 && drift < 1.5, "a motion is {motion} px off, all together {drift} px");
    assert!(residual < 0.15 * shaken, "{residual} px of {shaken} px are left");
    // The pan itself stays: the camera ends where it was, but for its shake.
    let field = output.get::<PathField>().expect("a path");
    let end = |maps: &[Matrix3]| track(maps, clip.size())[23];
    let smooth: Vec<_> = field.corrections.iter().zip(field.to_frames()).map(|(s, p)| product(s, &p)).collect();
    let [a, b] = [end(&field.to_frames()), end(&smooth)];
    assert!(a[0] - 159.5 > 60.0 && (a[0] - b[0]).hypot(a[1] - b[1]) < 6.0, "{a:?}, {b:?}");
}

fn product(a: &Matrix3, b: &Matrix3) -> Matrix3 {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

#[test]
fn a_dominant_object_takes_the_motion_over() {
    let clip = clip("passing-bus", &[]);
    let found = errors(&run("stabilization", &[], &clip), &clip);
    assert!(found.motion_px.expect("known") > 2.0, "{found:?}");
    let output = run("compensated-difference", &[("frames", "8")], &clip);
    let f1 = measure(&output, &clip, "mask_f1");
    assert!(f1 < 0.5, "the background is foreground instead: {f1}");
    let mut walk = set("stabilization", &[]).walk(&clip, 0).expect("a walk");
    walk.jump(Move::End);
    let said = walk.step(None).sentence.plain();
    assert!(said.contains("not that of the background"), "{said}");
}

#[test]
fn stabilised_frames_fit_each_other_better_than_the_frames() {
    let clip = clip("hand-held", &[("frames", "12")]);
    let output = run("stabilization", &[("smoothing", "20"), ("motion.model", "rigid")], &clip);
    let field = output.get::<PathField>().expect("a path");
    assert!(matches!(field.views, Views::Stabilized(_)));
    let pictures = field.pictures().expect("all frames can be read");
    assert_eq!(pictures.len(), 12);
    // The frames themselves differ by the pan and the shake, the stabilised ones by the steady pan: without it they are equal.
    let off = |a: &motionscope_core::geometry::Gray, b: &motionscope_core::geometry::Gray, by: [i32; 2]| {
        let inner = (40..200).flat_map(|y| (40..260).map(move |x| (x, y)));
        let diffs = inner.map(|(x, y)| {
            let other = b[((x + by[0]) as usize, (y + by[1]) as usize)];
            f64::from(a[(x as usize, y as usize)].abs_diff(other))
        });
        diffs.sum::<f64>() / (160.0 * 220.0)
    };
    let least = |a: &motionscope_core::geometry::Gray, b: &motionscope_core::geometry::Gray| {
        let shifts = (-8..=0).flat_map(|u| (-3..=3).map(move |v| [u, v]));
        shifts.map(|by| off(a, b, by)).fold(f64::INFINITY, f64::min)
    };
    let mut better = 0;
    for (t, pair) in pictures.windows(2).enumerate() {
        let [before, after] = [clip.frame(t).expect("read"), clip.frame(t + 1).expect("read")];
        let [stable, shaken] =
            [off(pair[0].2.luma(), pair[1].2.luma(), [-3, 0]), off(before.luma(), after.luma(), [-3, 0])];
        assert!(least(pair[0].2.luma(), pair[1].2.luma()) < 16.0);
        better += usize::from(stable < shaken);
    }
    assert!(better >= 9, "{better} of 11 pairs fit the steady pan better");
}

#[test]
fn a_mosaic_holds_every_frame_in_its_place() {
    let clip = clip("hand-held", &[("speed", "0.7")]);
    let output = run("mosaic", &[("motion.model", "rigid"), ("blending", "newest")], &clip);
    let field = output.get::<PathField>().expect("a path");
    let [(_, _, mosaic)] = &field.pictures().expect("made")[..] else { panic!("one picture") };
    assert!(mosaic.size().0 > 360 && mosaic.size().1 > 240, "{:?}", mosaic.size());
    let found = errors(&output, &clip);
    // Errors of 23 pairs add up.
    assert!(found.drift_px.expect("known") < 0.1 * 23.0, "{found:?}");
    // The newest frame covers all others. Its place on the mosaic follows from the true path; a border of the mosaic is a whole pixel.
    let truth = chained(&true_motions(&clip, (0, 23)).expect("computed").expect("a synthetic clip"));
    let newest = clip.frame(23).expect("read");
    let reference = truth[11];
    let back = product(&truth[23], &inverse(&reference));
    let corners = truth.iter().flat_map(|map| {
        let map = product(&reference, &inverse(map));
        [[0.0, 0.0], [319.0, 0.0], [319.0, 239.0], [0.0, 239.0]].map(|at| mapped(&map, at).expect("near"))
    });
    let [left, top] = corners.fold([0.0f64; 2], |low, at| [0, 1].map(|i| low[i].min(at[i].floor())));
    let (mut sum, mut count) = (0.0, 0);
    for (x, y) in (0..mosaic.size().1).step_by(3).flat_map(|y| (0..mosaic.size().0).step_by(3).map(move |x| (x, y))) {
        let at = mapped(&back, [x as f64 + left, y as f64 + top]).expect("near").map(|c| c as f32);
        if at[0] > 4.0 && at[1] > 4.0 && at[0] < 315.0 && at[1] < 235.0 {
            sum += (newest.luma().sample(at[0], at[1]) - f32::from(mosaic.luma()[(x, y)])).abs();
            count += 1;
        }
    }
    assert!(count > 5000 && sum / (count as f32) < 6.0, "{} gray levels at {count} pixels", sum / count as f32);
}

fn inverse(matrix: &Matrix3) -> Matrix3 {
    motionscope_core::products::model::inverse(matrix).expect("regular")
}

#[test]
fn compensation_finds_the_cars_under_a_moving_camera() {
    let clip = clip("hand-held", &[]);
    let f1 = |id: &str, settings: &[(&str, &str)]| measure(&run(id, settings, &clip), &clip, "mask_f1");
    let compensated = f1("compensated-difference", &[]);
    let two = f1("compensated-difference", &[("differencing", "2")]);
    let plain = f1("frame-difference", &[("camera", "still"), ("differencing", "3")]);
    // The compensated difference is one of gray levels, as this median; that of colours comes nearer.
    let [gray, rgb] = ["gray", "rgb"].map(|channels| f1("median-background", &[("channels", channels)]));
    assert!(compensated > 0.6 && two > 0.6, "{compensated}, {two}");
    assert!(compensated > plain + 0.3 && compensated > gray + 0.2, "{compensated}, {plain}, {gray}");
    assert!(compensated > rgb, "{compensated}, {rgb}");
}

#[test]
fn pixels_that_come_into_the_picture_are_background() {
    // A wall on which nothing moves but the camera: all differences are errors.
    let clip = clip("translation", &[("frames", "8"), ("speed", "2")]);
    let output = run("compensated-difference", &[("motion.model", "translation")], &clip);
    let masks = output.get::<MaskField>().expect("masks");
    for (t, mask) in masks.masks() {
        assert!(mask.count() < 200, "{} px in frame {t}", mask.count());
    }
}

#[test]
fn trackers_follow_objects_through_a_compensated_detector() {
    let clip = clip("hand-held", &[]);
    let recall = |detector: &str| {
        let mut tracker = set("kalman-tracker", &[]);
        tracker.set("detector", detector).expect("it makes masks");
        let output = tracker.run(&clip, 0, &Threads::new(2).expect("sound")).expect("a run");
        measure(&output, &clip, "recall")
    };
    let [compensated, plain] = ["compensated-difference", "frame-difference"].map(recall);
    assert!(compensated > 0.3 && compensated > 2.0 * plain, "{compensated}, {plain}");
}

#[test]
fn without_texture_the_camera_counts_as_at_rest() {
    let flat = clip("translation", &[("low-texture", "100"), ("frames", "3")]);
    for id in ["stabilization", "mosaic", "compensated-difference"] {
        let output = run(id, &[], &flat);
        if let Some(field) = output.get::<PathField>() {
            let still = |matrix: &Matrix3| mapped(matrix, [100.0, 50.0]) == Some([100.0, 50.0]);
            assert!(field.motions.iter().all(still), "{id}");
        }
    }
    let mut walk = set("stabilization", &[]).walk(&flat, 0).expect("a walk");
    walk.jump(Move::To(Cursor { unit: 0, event: 1 }));
    let said = walk.step(None).sentence.plain();
    assert!(said.contains("none that is usable"), "{said}");
    assert!(said.contains("has 0 of 0 matches as inliers") && said.contains("At least 2 are needed"), "{said}");
    let mut walk = set("mosaic", &[]).walk(&flat, 0).expect("a walk");
    walk.jump(Move::End);
    let said = walk.step(None).sentence.plain();
    assert!(said.contains("count as at rest: 2 of 2. Frames 0 and 1: A motion of the model"), "{said}");
}

#[test]
fn a_motion_that_bends_the_picture_is_told() {
    let said_of = |clip: &Clip| {
        let mut walk = set("mosaic", &[]).walk(clip, 0).expect("a walk");
        walk.jump(Move::End);
        walk.step(None).sentence.plain()
    };
    // A texture stretched along y, as by an object that comes nearer below, and one that is enlarged.
    let texture = |x: f64, y: f64| {
        let wave = |k: f64| (x * (0.13 * k).cos() * 0.4 + y * (0.7 * k).sin() * 0.4 + k * k).sin();
        (128.0 + 12.0 * (1..9).map(|k| wave(f64::from(k))).sum::<f64>()) as u8
    };
    let frame = |scale: [f64; 2]| {
        Frame::gray(Grid::from_fn(160, 120, |x, y| texture(x as f64 / scale[0], y as f64 / scale[1])))
    };
    let made = |scale| Clip::from_frames("scaled", vec![frame([1.0; 2]), frame(scale)]).expect("frames");
    let said = said_of(&made([1.0, 1.06]));
    assert!(said.contains("Motions that bend the picture: 1 of 1. From frame 0 to 1 a corner is "), "{said}");
    for clip in [made([1.06; 2]), clip("hand-held", &[])] {
        let said = said_of(&clip);
        assert!(said.contains("End of the run") && !said.contains("similarity"), "{said}");
    }
}

#[test]
fn a_mosaic_of_frames_without_overlap_says_what_was_too_small() {
    // Two textures that have nothing in common.
    let texture = |seed: u64| {
        let gray = move |x: usize, y: usize| {
            let mixed = ((x as u64 / 4) * 0x9E37_79B9) ^ ((y as u64 / 4) * 0x85EB_CA6B) ^ (seed * 0xC2B2_AE35);
            (mixed.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 56) as u8
        };
        Frame::gray(Grid::from_fn(120, 90, gray))
    };
    let apart = Clip::from_frames("apart", vec![texture(1), texture(2)]).expect("frames");
    let mut walk = set("mosaic", &[]).walk(&apart, 0).expect("a walk");
    walk.jump(Move::End);
    let said = walk.step(None).sentence.plain();
    assert!(said.contains("count as at rest: 1 of 1. Frames 0 and 1: "), "{said}");
    assert!(
        said.contains("the model (homography)")
            && said.contains("At least 4 are needed, and more than agree by chance"),
        "{said}"
    );
}

#[test]
fn the_direction_of_a_level_motion_is_not_asked() {
    let texture = |x: i64, y: i64| {
        let mixed = (x as u64).wrapping_mul(0x9E37_79B9) ^ (y as u64).wrapping_mul(0x85EB_CA6B);
        (mixed.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 56) as u8
    };
    for id in ["stabilization", "mosaic"] {
        let estimator = set(id, &[("motion", "phase-correlation"), ("motion.subpixel", "none")]);
        let answers = [-2, 0, 2].map(|v| {
            let frame = |t: i64| {
                Frame::gray(Grid::from_fn(128, 96, |x, y| texture(x as i64 - 3 * t + 500, y as i64 - v * t + 500)))
            };
            let clip = Clip::from_frames("shifted", vec![frame(0), frame(1)]).expect("frames");
            let mut walk = estimator.walk(&clip, 0).expect("a walk");
            walk.jump(Move::To(Cursor { unit: 0, event: 1 }));
            let (step, scene) = (walk.step(None), walk.scene(None));
            let shown = Shown { step: &step, scene: &scene };
            let answer = estimator.questions()[0].answer(shown, shown);
            answer.map(|answer| match answer {
                Answer::Choice(i) => estimator.questions()[0].choices()[i],
                other => panic!("{other:?}"),
            })
        });
        assert_eq!(answers, [Some("Up"), None, Some("Down")], "{id}");
    }
}
