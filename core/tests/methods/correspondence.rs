//! SIFT, matching, global motion and epipolar geometry against plain references, a recorded peer and exactly known motion.

use crate::common::{self, set};
use motionscope_core::base::Threads;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::Grid;
use motionscope_core::products::keypoints::Descriptor;
use motionscope_core::products::{EpipolarField, MatchField, MatchStatus, ModelField, Output, PointField, Reference};
use motionscope_core::run::{Direction, Move};
use motionscope_core::scene::{Math, Readout};
use motionscope_core::synth;
use nalgebra::{Rotation3, Vector3};

fn scene(id: &str) -> Clip {
    let scene = synth::scene(id).expect("a scene");
    synth::make(scene.id, &scene.difficulty()).expect("a clip")
}

fn run(id: &str, settings: &[(&str, &str)], clip: &Clip) -> Output {
    set(id, settings).run(clip, 0, &Threads::single()).expect("a run")
}

fn keypoints(id: &str, settings: &[(&str, &str)], clip: &Clip) -> PointField {
    run(id, settings, clip).get::<PointField>().expect("keypoints").clone()
}

/// The strongest keypoints of frame 0 of the scene `translation` by OpenCV 5.0.0, SIFT_create(0, 3, 0.04, 10, 1.6, enable_precise_upscale =
/// True): x, y, size / 2 and angle.
const OPENCV: [[f32; 4]; 40] = [
    [33.93, 182.22, 4.53, 70.2],
    [33.93, 182.22, 4.53, 267.0],
    [59.68, 143.59, 4.02, 39.6],
    [59.68, 143.59, 4.02, 238.6],
    [214.60, 154.51, 3.98, 138.1],
    [49.35, 25.29, 6.60, 40.7],
    [49.35, 25.29, 6.60, 268.4],
    [114.08, 46.33, 4.10, 108.0],
    [206.19, 59.01, 4.48, 272.5],
    [201.52, 169.02, 7.43, 235.0],
    [238.23, 156.60, 2.97, 248.5],
    [297.24, 110.61, 4.57, 238.1],
    [171.91, 131.59, 7.36, 2.7],
    [171.91, 131.59, 7.36, 33.9],
    [171.91, 131.59, 7.36, 81.5],
    [234.81, 79.63, 2.54, 107.8],
    [187.96, 116.83, 5.71, 65.4],
    [187.96, 116.83, 5.71, 352.9],
    [310.77, 101.75, 3.28, 49.0],
    [310.77, 101.75, 3.28, 252.3],
    [292.39, 84.89, 2.79, 92.1],
    [292.39, 84.89, 2.79, 231.4],
    [87.38, 193.98, 6.19, 37.0],
    [125.81, 32.18, 3.92, 2.2],
    [50.07, 161.21, 3.68, 46.1],
    [50.07, 161.21, 3.68, 264.6],
    [48.62, 195.99, 8.13, 65.8],
    [75.77, 15.87, 5.09, 84.9],
    [75.77, 15.87, 5.09, 195.2],
    [306.87, 94.55, 3.00, 250.8],
    [149.09, 116.47, 3.12, 294.8],
    [149.22, 116.50, 3.15, 293.9],
    [254.05, 154.76, 6.19, 281.3],
    [14.13, 180.85, 2.88, 120.2],
    [14.13, 180.85, 2.88, 281.1],
    [295.82, 155.07, 7.91, 76.6],
    [295.82, 155.07, 7.91, 236.8],
    [277.95, 162.27, 3.86, 66.6],
    [277.95, 162.27, 3.86, 219.5],
    [130.71, 141.83, 4.98, 83.2],
];

#[test]
fn sift_keypoints_are_those_of_opencv() {
    let found = keypoints("sift", &[("max-points", "100000")], &scene("translation"));
    let agrees = |[x, y, sigma, angle]: [f32; 4]| {
        found.points.iter().zip(&found.keypoints).any(|(point, keypoint)| {
            let own = keypoint.angle_rad.expect("an orientation").to_degrees();
            let turned = (own - angle + 180.0).rem_euclid(360.0) - 180.0;
            let scale = keypoint.scale_px.expect("a scale") / sigma;
            (point.at[0] - x).hypot(point.at[1] - y) < 0.1 && (0.95..1.05).contains(&scale) && turned.abs() < 5.0
        })
    };
    let count = OPENCV.into_iter().filter(|keypoint| agrees(*keypoint)).count();
    assert!(count >= 38, "{count} of {}", OPENCV.len());
    // 589 by OpenCV.
    assert!((560..620).contains(&found.points.len()), "{}", found.points.len());
}

/// The share of the keypoints of `a`, moved by `map`, that have one of `b` within `off` px and a factor of 1.2 of their scale.
fn repeated(a: &PointField, b: &PointField, map: impl Fn([f32; 2]) -> [f32; 2], off: f32) -> f32 {
    let is_again =
        |(point, keypoint): (&motionscope_core::products::Feature, &motionscope_core::products::Keypoint)| {
            let [x, y] = map(point.at);
            b.points.iter().zip(&b.keypoints).any(|(other, of)| {
                let factor = of.scale_px.unwrap_or(1.0) / keypoint.scale_px.unwrap_or(1.0);
                (other.at[0] - x).hypot(other.at[1] - y) < off && (1.0 / 1.2..1.2).contains(&factor)
            })
        };
    let again = a.points.iter().zip(&a.keypoints).filter(|pair| is_again(*pair)).count();
    again as f32 / a.points.len() as f32
}

fn still(frame: Frame) -> Clip {
    Clip::from_frames("still", vec![frame.clone(), frame]).expect("frames of one size")
}

#[test]
fn keypoints_are_found_again_after_a_quarter_turn_and_another_gain() {
    let clip = scene("translation");
    let picture = clip.frame(0).expect("a frame").luma().clone();
    let (width, height) = picture.size();
    let here = keypoints("sift", &[], &clip);
    // (x, y) goes to (height − 1 − y, x).
    let turned = Frame::gray(Grid::from_fn(height, width, |x, y| picture[(y, height - 1 - x)]));
    let there = keypoints("sift", &[], &still(turned));
    let share = repeated(&here, &there, |[x, y]| [(height - 1) as f32 - y, x], 0.5);
    assert!(share > 0.95, "{share} after a quarter turn");
    let darker = Frame::gray(picture.map(|value| value / 2 + 20));
    let there = keypoints("sift", &[("contrast-threshold", "0.02")], &still(darker));
    let share = repeated(&here, &there, |at| at, 0.5);
    assert!(share > 0.9, "{share} at half the contrast");
}

#[test]
fn matches_are_the_nearest_neighbours_that_pass_both_tests() {
    let clip = scene("spin-zoom");
    let settings = [("detector.max-points", "120")];
    let found = run("feature-matching", &settings, &clip);
    let found = found.get::<MatchField>().expect("matches");
    let side = |t| {
        let output = set("sift", &[("max-points", "120")]).run(&clip, t, &Threads::single()).expect("a run");
        let field = output.get::<PointField>().expect("keypoints").clone();
        let entries = |keypoint: &motionscope_core::products::Keypoint| match &keypoint.descriptor {
            Some(Descriptor::Reals(values)) => values.iter().map(|v| f64::from(*v)).collect::<Vec<f64>>(),
            _ => panic!("SIFT describes"),
        };
        let descriptors: Vec<_> = field.keypoints.iter().map(entries).collect();
        (field.points, descriptors)
    };
    let ((here, a), (there, b)) = (side(0), side(1));
    let distance = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    let ranked = |of: &[f64], all: &[Vec<f64>]| {
        let mut order: Vec<(f64, usize)> = all.iter().enumerate().map(|(i, other)| (distance(of, other), i)).collect();
        order.sort_by(|x, y| x.0.total_cmp(&y.0));
        [order[0], order[1]]
    };
    assert_eq!(found.matches.len(), here.len());
    let mut counts = [0; 3];
    for (i, own) in found.matches.iter().enumerate() {
        let [(first, nearest), (second, _)] = ranked(&a[i], &b);
        let status = match () {
            () if first / second >= 0.8 => MatchStatus::RejectedRatio,
            () if ranked(&b[nearest], &a)[0].1 != i => MatchStatus::RejectedCrossCheck,
            () => MatchStatus::Match,
        };
        assert_eq!((own.from, own.to, own.status), (here[i].at, there[nearest].at, status), "keypoint {i}");
        assert!((f64::from(own.distance) - first).abs() < 1e-4);
        counts[[MatchStatus::Match, MatchStatus::RejectedRatio, MatchStatus::RejectedCrossCheck]
            .iter()
            .position(|other| *other == status)
            .expect("one of three")] += 1;
    }
    assert!(counts[0] > 40 && counts[1] > 5, "{counts:?}");
}

#[test]
fn matches_on_known_motion_are_right() {
    // The pines of the parallax look alike.
    for (id, descriptor, least) in [
        ("translation", "auto", 0.95),
        ("spin-zoom", "sift", 0.95),
        ("translation", "patch", 0.95),
        ("parallax", "auto", 0.8),
        ("translation", "surf", 0.95),
        ("translation", "orb", 0.9),
    ] {
        let clip = scene(id);
        let output = run("feature-matching", &[("descriptor", descriptor)], &clip);
        let field = output.get::<MatchField>().expect("matches");
        let truth = clip.truth().expect("truth").flow(0).expect("a flow").expect("a flow");
        let errors = MatchField::compare(field.accepted(), &truth);
        let precision = errors.precision().expect("known matches");
        assert!(errors.known > 60 && precision > least, "{id}, {descriptor}: {errors:?}");
    }
    // Corners have no descriptor of their own, so patches are compared.
    let clip = scene("translation");
    let output = run("feature-matching", &[("detector", "harris"), ("detector.max-points", "200")], &clip);
    assert!(output.get::<MatchField>().expect("matches").count(MatchStatus::Match) > 60);
}

#[test]
fn a_ratio_of_two_distances_of_0_is_undefined_in_words_and_numbers() {
    // A pattern that repeats exactly.
    let level = |x: usize, y: usize| ((x % 24) * (x % 24) * 7 + (y % 24) * 31 + (x % 24) * (y % 24) * 5) as u8;
    let clip = still(Frame::gray(Grid::from_fn(144, 120, level)));
    let mut walk = set("feature-matching", &[]).walk(&clip, 0).expect("a walk");
    let mut seen = 0;
    while !walk.at_end() && seen < 3 {
        walk.jump(Move::Granularity(2, Direction::Forward));
        let step = walk.step(None);
        let said = step.sentence.plain();
        if said.starts_with("Ratio test") {
            let equation = format!("{:?}", step.readouts.iter().find(|of| matches!(of, Readout::Equation(_))));
            assert_eq!(equation.contains("is undefined"), said.contains("is undefined"), "{said} {equation}");
            seen += usize::from(said.contains("is undefined"));
        }
    }
    assert!(seen > 0, "two distances of 0");
    let output = run("feature-matching", &[], &clip);
    let field = output.get::<MatchField>().expect("matches");
    let undefined = field.matches.iter().filter(|found| found.status == MatchStatus::RejectedRatio);
    assert!(undefined.filter(|found| found.distance == 0.0).all(|found| found.ratio.is_none()));
}

#[test]
fn candidates_lie_within_the_search_radius() {
    let clip = scene("translation");
    let far = |radius: &str| {
        let output = run("feature-matching", &[("radius", radius), ("ratio", "1"), ("cross-check", "off")], &clip);
        let field = output.get::<MatchField>().expect("matches").clone();
        field.matches.iter().map(|found| found.displacement()).map(|[u, v]| u.hypot(v)).fold(0.0, f32::max)
    };
    assert!(far("6") <= 6.0 && far("0") > 6.0);
}

/// The mean and the largest distance of the model's displacements from the true ones.
fn errors(output: &Output, clip: &Clip) -> [f32; 2] {
    let flow = output.get::<ModelField>().expect("a model").displacements_of_pixels();
    let truth = clip.truth().expect("truth").flow(0).expect("a flow").expect("a flow");
    let (width, height) = clip.size();
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let off = places.filter_map(|(x, y)| {
        let ([u, v], [true_u, true_v]) = (flow.at(x, y)?, truth.at(x, y)?);
        Some((u - true_u).hypot(v - true_v))
    });
    let all: Vec<f32> = off.collect();
    assert!(!all.is_empty());
    [all.iter().sum::<f32>() / all.len() as f32, all.iter().copied().fold(0.0, f32::max)]
}

#[test]
fn every_model_finds_a_translation_and_those_with_rotation_a_turn() {
    let clip = scene("translation");
    for model in ["translation", "rigid", "similarity", "affine", "homography"] {
        let [mean, most] = errors(&run("global-motion", &[("model", model)], &clip), &clip);
        assert!(mean < 0.1 && most < 0.6, "{model}: {mean}, {most}");
    }
    let clip = scene("spin-zoom");
    for model in ["similarity", "affine", "homography"] {
        let [mean, _] = errors(&run("global-motion", &[("model", model)], &clip), &clip);
        assert!(mean < 0.3, "{model}: {mean}");
    }
    let [mean, _] = errors(&run("global-motion", &[("model", "translation")], &clip), &clip);
    assert!(mean > 1.0, "a translation is no rotation: {mean}");
}

#[test]
fn outliers_cost_iterations_and_not_accuracy() {
    let clip = scene("translation");
    let with = |outliers: &str, scoring: &str| {
        let settings = [("outliers", outliers), ("scoring", scoring), ("max-iterations", "100000")];
        let output = run("global-motion", &settings, &clip);
        (errors(&output, &clip)[0], output.get::<ModelField>().expect("a model").iterations)
    };
    for scoring in ["ransac", "msac", "lo-ransac"] {
        let all = ["0", "0.3", "0.6"].map(|share| with(share, scoring));
        assert!(all.iter().all(|(mean, _)| *mean < 0.15), "{scoring}: {all:?}");
        assert!(all[0].1 < all[1].1 && 3 * all[1].1 < all[2].1, "{scoring}: {all:?}");
    }
}

#[test]
fn epipolar_lines_pass_through_the_true_matches() {
    // Layers at four depths, seen by a camera that moves sideways.
    let clip = scene("parallax");
    let output = run("epipolar-geometry", &[], &clip);
    let field = output.get::<EpipolarField>().expect("epipolar geometry");
    let matrix = field.matrix.expect("an estimate");
    let truth = clip.truth().expect("truth").flow(0).expect("a flow").expect("a flow");
    let (width, height) = clip.size();
    let (mut near, mut all) = (0, 0);
    for (x, y) in (4..height - 4).step_by(7).flat_map(|y| (4..width - 4).step_by(7).map(move |x| (x, y))) {
        let Some([u, v]) = truth.at(x, y) else { continue };
        let (x, y) = (x as f64, y as f64);
        let [a, b, c] = matrix.map(|row| row[0] * x + row[1] * y + row[2]);
        let distance = (a * (x + f64::from(u)) + b * (y + f64::from(v)) + c).abs() / a.hypot(b);
        near += usize::from(distance < 1.0);
        all += 1;
    }
    assert!(10 * near > 9 * all, "{near} of {all}");
    assert!(field.support.inliers > 60 && field.residual_px.is_some_and(|residual| residual < 0.75), "{field:?}");
}

/// What the last step of a run says.
fn last_sentence(id: &str, settings: &[(&str, &str)], clip: &Clip) -> String {
    let mut walk = set(id, settings).walk(clip, 0).expect("a walk");
    walk.jump(Move::End);
    walk.step(None).sentence.plain()
}

#[test]
fn a_consensus_on_an_object_is_told() {
    let said = last_sentence("global-motion", &[], &scene("passing-bus"));
    let (_, share) = said.split_once("By the ground truth, ").expect(&said);
    assert!(common::numbers(share)[0] > 50.0, "{said}");
    assert!(said.contains("the motion of an object and not that of the background"), "{said}");
    let said = last_sentence("global-motion", &[], &scene("hand-held"));
    assert!(said.contains("End of the run") && !said.contains("foreground"), "{said}");
    // Without truth, a texture in a small part of the picture.
    let places: Vec<[usize; 2]> = (0..16).map(|i| [30 + 14 * (i % 4), 30 + 14 * (i / 4)]).collect();
    let said = last_sentence("global-motion", &[("model", "translation")], &patches(&places));
    assert!(said.contains("The convex hull of the inliers covers "), "{said}");
}

#[test]
fn the_last_step_registers_the_frames() {
    let mut walk = set("global-motion", &[]).walk(&scene("hand-held"), 0).expect("a walk");
    walk.jump(Move::End);
    let said = walk.step(None).sentence.plain();
    let (registered, at_rest) = said.split_once(" gray levels on average where they overlap, and by ").expect(&said);
    let (registered, at_rest) = (common::numbers(registered), common::numbers(at_rest));
    assert!(2.0 * registered[registered.len() - 1] < at_rest[0], "{said}");
    let scene = walk.scene(None);
    let names: Vec<String> = scene.pictures.iter().map(|canvas| canvas.picture.to_string()).collect();
    assert!(names == ["t", "mosaic"] && scene.links.is_empty(), "{names:?}");
}

#[test]
fn the_number_of_iterations_follows_from_the_share_of_inliers_beside_it() {
    let mut seen = 0;
    for id in ["epipolar-geometry", "global-motion"] {
        let estimator = set(id, &[]);
        let mut walk = estimator.walk(&scene("parallax"), 0).expect("a run");
        let innermost = walk.info().granularities.len() - 1;
        while !walk.at_end() {
            walk.jump(Move::Granularity(innermost, Direction::Forward));
            let step = walk.step(None);
            let lines = step.readouts.iter().find_map(|readout| match readout {
                Readout::Equation(lines) => Some(lines.iter().map(Math::plain).collect::<Vec<_>>()),
                _ => None,
            });
            let formula = lines.and_then(|lines| lines.into_iter().find(|line| line.contains(", so ")));
            if let Some((quotient, count)) = formula.as_deref().and_then(|line| line.split_once(", so ")) {
                // log(1 − p) / log(1 − wⁿ), with w to three decimals.
                let (numbers, size) = (common::numbers(quotient), if id == "global-motion" { 4 } else { 7 });
                let share = numbers.iter().copied().find(|n| n.fract() != 0.0 && *n != 0.99).unwrap_or(1.0);
                let needed = |share: f64| (0.01f64.ln() / (1.0 - share.min(1.0).powi(size)).ln()).ceil().max(1.0);
                let [low, high] = [share + 5e-4, share - 5e-4].map(needed);
                let said = common::numbers(count)[0];
                assert!((low..=high).contains(&said) || said == common::numbers(count)[1], "{quotient}, so {count}");
                seen += 1;
            }
        }
    }
    assert!(seen > 5, "{seen} formulas");
}

#[test]
fn the_chart_shows_the_inliers_of_every_hypothesis_once_they_are_counted() {
    let mut walk = set("global-motion", &[]).walk(&scene("hand-held"), 0).expect("a run");
    let innermost = walk.info().granularities.len() - 1;
    let (mut most, mut worse) = (0.0_f32, 0);
    while !walk.at_end() {
        walk.jump(Move::Granularity(innermost, Direction::Forward));
        let step = walk.step(None);
        let series = step.readouts.iter().find_map(|readout| match readout {
            Readout::Series(series) => Some(series),
            _ => None,
        });
        // Before the first count there is nothing to be shown, and no 0 either.
        let Some(series) = series else { continue };
        let [own, best] = [0, 1].map(|line| &series.lines[line].2);
        assert_eq!(own.len(), best.len());
        assert!(own.iter().any(|[_, inliers]| inliers.is_finite()), "an empty chart");
        for ([_, own], [_, best]) in
            own.iter().zip(best).filter(|([_, own], [_, best])| own.is_finite() && best.is_finite())
        {
            assert!(*best > 0.0 && *own > 0.0);
            worse += usize::from(own < best);
            most = most.max(*best);
        }
    }
    assert!(most > 180.0 && worse > 0, "{most} inliers, {worse} worse hypotheses");
}

#[test]
fn the_linear_system_of_a_hypothesis_and_of_the_final_fit_is_shown() {
    let shown = |id: &str, settings: &[(&str, &str)], needle: &str| {
        let mut walk = set(id, settings).walk(&scene("translation"), 0).expect("a walk");
        loop {
            walk.jump(Move::Granularity(2, Direction::Forward));
            let step = walk.step(None);
            if step.sentence.plain().contains(needle) {
                let all = step.readouts.iter().filter_map(|readout| match readout {
                    Readout::Matrices(all) => Some(all.iter().map(|matrix| matrix.symbol)),
                    _ => None,
                });
                let size = step.readouts.iter().find_map(|readout| match readout {
                    Readout::Facts(facts) => facts.iter().find(|fact| fact.label == "Linear system"),
                    _ => None,
                });
                return (all.flatten().collect::<Vec<_>>(), size.map(|fact| fact.value.clone()));
            }
            assert!(!walk.at_end(), "{id}: no step says {needle}");
        }
    };
    let (symbols, size) = shown("global-motion", &[], "through the sample is the hypothesis");
    assert_eq!((symbols, size), (vec!["H", "T", "T′", "λ", "H"], Some("A h = 0 with 8×9 entries".into())));
    let (symbols, size) = shown("global-motion", &[], "Least squares over all inliers");
    assert!(symbols.ends_with(&["T", "T′", "λ", "H"]) && size.is_some_and(|size| !size.contains("8×9")), "{symbols:?}");
    let (symbols, size) = shown("epipolar-geometry", &[], "through the sample is the hypothesis");
    assert_eq!((symbols, size), (vec!["F", "T", "T′", "λ", "F₁", "F₂"], Some("A f = 0 with 7×9 entries".into())));
    let (symbols, _) = shown("epipolar-geometry", &[("sampling", "eight")], "through the sample is the hypothesis");
    assert_eq!(symbols, ["F", "T", "T′", "λ", "F", "s"]);
    let (symbols, _) = shown("global-motion", &[("model", "affine")], "through the sample is the hypothesis");
    assert_eq!(symbols, ["H", "N", "R"]);
}

#[test]
fn a_plane_does_not_determine_the_epipolar_geometry_and_that_is_said() {
    let clip = scene("spin-zoom");
    let told = last_sentence("epipolar-geometry", &[], &clip);
    assert!(told.contains("homography explains") && told.contains("plane"), "{told}");
    let told = last_sentence("epipolar-geometry", &[], &scene("parallax"));
    assert!(!told.contains("homography explains"), "{told}");
    let is_plane = |id: &str| {
        let output = run("epipolar-geometry", &[("focal-length", "400")], &scene(id));
        let field = output.get::<EpipolarField>().expect("F");
        assert!(field.planar.is_none_or(|planar| !planar.is_plane) || field.pose.is_none(), "{id}: {field:?}");
        field.planar.expect("enough inliers").is_plane
    };
    let found = ["spin-zoom", "translation", "sub-pixel", "parallax", "pillar"].map(is_plane);
    assert_eq!(found, [true, true, true, false, false]);
}

#[test]
fn a_plane_is_claimed_only_where_nearly_all_matches_follow_the_homography() {
    let told = last_sentence("epipolar-geometry", &[], &scene("translation"));
    assert!(told.contains("So the scene is a plane, or the camera only rotated."), "{told}");
    let told = last_sentence("epipolar-geometry", &[], &scene("turntable"));
    assert!(told.contains("cannot be told") && !told.contains("So the scene is a plane"), "{told}");
    let told = last_sentence("global-motion", &[], &scene("turntable"));
    assert!(told.contains("Registration makes the difference larger, so the model does not hold"), "{told}");
}

#[test]
fn the_inliers_that_f_rests_on_are_those_that_the_homography_leaves() {
    let told = last_sentence("epipolar-geometry", &[], &scene("parallax"));
    let (_, counts) = told.split_once("Of the ").expect(&told);
    let numbers = common::numbers(counts);
    assert_eq!(numbers[0] - numbers[1], numbers[2], "{told}");
    assert!(numbers[3] <= numbers[2], "{told}");
    let [doubt, pose] = ["F rests on", "pose of the camera"].map(|words| told.find(words).expect(&told));
    assert!(doubt < pose && told.contains("as uncertain as F"), "{told}");
}

#[test]
fn without_matches_shares_and_predictions_are_undefined() {
    let flat = still(Frame::gray(Grid::new(64, 48, 90)));
    for (id, share) in [("global-motion", "inlier_share"), ("epipolar-geometry", "epipolar_inlier_share")] {
        let assessed = run(id, &[], &flat).assess(&Reference { clip: &flat, frame: 0 }).expect("an assessment");
        let value =
            |key: &str| assessed.scores.iter().find(|score| score.measure.key == key).map(|score| score.value.real());
        assert_eq!(value(share), Some(None), "{id}");
        let fact = |label: &str| assessed.facts.iter().find(|fact| fact.label == label).map(|fact| fact.value.as_str());
        assert_eq!(fact("Inliers"), Some("undefined: there are no matches"), "{id}");
        if id == "global-motion" {
            assert_eq!([value("psnr_db"), value("residual_bits")], [Some(None); 2]);
            assert_eq!(fact("Prediction"), Some("undefined: no motion was estimated"));
        }
    }
}

#[test]
fn without_texture_the_number_that_was_too_small_is_said() {
    let flat = still(Frame::gray(Grid::new(64, 48, 90)));
    for (id, number) in [
        ("sift", "|D| is at most 0.00 gray levels, and an extremum needs more than 1.70"),
        ("surf", "The largest response is R = 0.00, and a keypoint needs more than the threshold R = 25.00"),
        ("orb", "The highest score of all levels is V = 0, and a corner has at least V = t = 20"),
        ("fast", "The highest score is V = 0, and a corner has at least V = t = 20"),
        ("feature-matching", "0 keypoints, and a match needs at least 1"),
    ] {
        let told = last_sentence(id, &[], &flat);
        assert!(told.contains(number), "{id}: {told}");
    }
    for (id, needed) in [("global-motion", "0 of the needed 4"), ("epipolar-geometry", "0 of the needed 7")] {
        let told = last_sentence(id, &[], &flat);
        assert!(told.contains(needed), "{id}: {told}");
    }
    for (model, needed) in [("translation", 1), ("rigid", 2), ("similarity", 2), ("affine", 3)] {
        let told = last_sentence("global-motion", &[("model", model)], &flat);
        assert!(told.contains(&format!("0 of the needed {needed}")), "{model}: {told}");
    }
    let output = run("global-motion", &[], &flat);
    assert_eq!(output.get::<ModelField>().expect("a model").matrix, None);
    assert_eq!(run("epipolar-geometry", &[], &flat).get::<EpipolarField>().expect("no estimate").matrix, None);
    assert!(output.flow().expect("a flow").0.cells().iter().flatten().all(|c| c.is_nan()));
}

/// Patches around these positions; those of frame t + 1 are 5 px to the right and 2 px down.
fn patches(positions: &[[usize; 2]]) -> Clip {
    let moved: Vec<[usize; 2]> = positions.iter().map(|[x, y]| [x + 5, y + 2]).collect();
    moved_patches([positions, &moved])
}

/// Different patches of 9×9 px around the positions in both frames. Their middle is the brightest, so that corners are found there.
fn moved_patches(positions: [&[[usize; 2]]; 2]) -> Clip {
    let level = |k: usize, i: usize, j: usize| {
        if i / 3 == 1 && j / 3 == 1 {
            return 255;
        }
        let mixed = (k as u64 * 0x9E37_79B9) ^ (i as u64 / 3 * 0x85EB_CA6B) ^ (j as u64 / 3 * 0xC2B2_AE35);
        96 + (mixed.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 58) as u8
    };
    let frame = |positions: &[[usize; 2]]| {
        let mut picture = Grid::new(320, 240, 128);
        for (k, [x, y]) in positions.iter().enumerate() {
            for (i, j) in (0..9).flat_map(|j| (0..9).map(move |i| (i, j))) {
                picture[(x + i - 4, y + j - 4)] = level(k, i, j);
            }
        }
        Frame::gray(picture)
    };
    Clip::from_frames("patches", positions.map(frame).to_vec()).expect("frames of one size")
}

/// One keypoint in the middle of each patch at most, compared by patches.
const FEW: [(&str, &str); 4] =
    [("detector", "harris"), ("detector.min-distance", "12"), ("detector.threshold", "0.001"), ("descriptor", "patch")];

#[test]
fn fewer_matches_than_a_model_needs_are_told_with_their_number() {
    let clip = patches(&[[60, 60], [200, 70], [120, 180]]);
    let told = last_sentence("global-motion", &FEW, &clip);
    assert!(told.contains("3 of the needed 4 matches"), "{told}");
    let told = last_sentence("epipolar-geometry", &FEW, &clip);
    assert!(told.contains("3 of the needed 7 matches"), "{told}");
    let output = run("global-motion", &FEW, &clip);
    let field = output.get::<ModelField>().expect("a model");
    assert!(field.matrix.is_none() && field.residual_px.is_none(), "{field:?}");
    // A translation needs one.
    let output = run("global-motion", &[&FEW[..], &[("model", "translation")]].concat(), &clip);
    let [[_, _, u], [_, _, v], _] = output.get::<ModelField>().expect("a model").matrix.expect("an estimate");
    assert!((u - 5.0).abs() < 0.1 && (v - 2.0).abs() < 0.1, "({u}, {v})");
}

#[test]
fn points_on_a_line_determine_no_homography_and_the_spread_is_told() {
    let line: Vec<[usize; 2]> = (0..14).map(|i| [20 + 19 * i, 40 + 9 * i]).collect();
    let clip = patches(&line);
    for (id, settings) in [
        ("global-motion", [("model", "homography")]),
        ("global-motion", [("model", "affine")]),
        ("epipolar-geometry", [("sampling", "eight")]),
    ] {
        let settings = [&FEW[..], &settings].concat();
        let told = last_sentence(id, &settings, &clip);
        assert!(told.contains("line"), "{id}, {settings:?}: {told}");
        let output = run(id, &settings, &clip);
        let matrix = output.get::<ModelField>().map(|field| field.matrix);
        let matrix = matrix.unwrap_or_else(|| output.get::<EpipolarField>().expect("one of both").matrix);
        assert_eq!(matrix, None, "{id}, {settings:?}");
    }
    let output = run("global-motion", &[&FEW[..], &[("model", "similarity")]].concat(), &clip);
    assert!(output.get::<ModelField>().expect("a model").matrix.is_some(), "a line determines a similarity");
}

#[test]
fn matches_that_agree_by_chance_give_no_matrix() {
    let noise = |seed: u64| {
        Frame::gray(Grid::from_fn(320, 240, |x, y| {
            let mixed = ((x as u64 / 4) * 0x9E37_79B9) ^ ((y as u64 / 4) * 0x85EB_CA6B) ^ (seed * 0xC2B2_AE35);
            (mixed.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 56) as u8
        }))
    };
    let clip = Clip::from_frames("cut", vec![noise(1), noise(2)]).expect("frames of one size");
    for id in ["global-motion", "epipolar-geometry"] {
        let settings = [("ratio", "1")];
        let told = last_sentence(id, &settings, &clip);
        assert!(told.contains("rejected") && told.contains("random matches"), "{id}: {told}");
        let output = run(id, &settings, &clip);
        let matrix = output.get::<ModelField>().map(|field| field.matrix);
        assert_eq!(matrix.unwrap_or_else(|| output.get::<EpipolarField>().expect("one of both").matrix), None, "{id}");
        assert!(output.get::<MatchField>().expect("matches").matches.len() > 8);
    }
}

#[test]
fn a_wrong_focal_length_is_told_with_the_ratio_of_the_singular_values() {
    // Points at different depths, seen by a camera of 300 px that moves and turns.
    let (turn, moved) = (Rotation3::new(Vector3::new(0.09, 0.1, 0.02)), Vector3::new(0.35, 0.2, 0.08));
    let view = |k: usize| {
        let (x, y) = (30 + 26 * (k % 10), 30 + 26 * (k / 10));
        let depth = 4.0 + 1.5 * (x as f64 / 40.0).sin() * (y as f64 / 30.0).cos();
        let point = Vector3::new((x as f64 - 159.5) / 300.0, (y as f64 - 119.5) / 300.0, 1.0) * depth;
        let seen = turn * point + moved;
        let to = [300.0 * seen[0] / seen[2] + 159.5, 300.0 * seen[1] / seen[2] + 119.5];
        let is_inside = to[0] > 12.0 && to[0] < 307.0 && to[1] > 12.0 && to[1] < 227.0;
        is_inside.then(|| ([x, y], to.map(|c| c.round() as usize)))
    };
    let (here, there): (Vec<_>, Vec<_>) = (0..70).filter_map(view).unzip();
    let clip = moved_patches([&here, &there]);
    let settings = |focal: &'static str| [&FEW[..], &[("focal-length", focal)]].concat();
    let right = last_sentence("epipolar-geometry", &settings("300"), &clip);
    assert!(right.contains("Ratio of the singular values") && !right.contains("rejected"), "{right}");
    let wrong = last_sentence("epipolar-geometry", &settings("30"), &clip);
    assert!(wrong.contains("The pose is rejected") && !wrong.contains("NaN"), "{wrong}");
    let pose = |focal| run("epipolar-geometry", &settings(focal), &clip).get::<EpipolarField>().expect("F").pose;
    assert_eq!((pose("30"), pose("0")), (None, None));
    let found = pose("300").expect("the right focal length");
    let off = (0..9).map(|i| (found.rotation[i / 3][i % 3] - turn[(i / 3, i % 3)]).abs()).fold(0.0, f64::max);
    let along = Vector3::from(found.translation).dot(&moved.normalize());
    // Positions are rounded to whole pixels.
    assert!(off < 0.03 && along > 0.97, "rotation {off} off, cosine of the translation {along}");
}

/// The steps that follow from the fundamental matrix: what is said, and the scene.
fn sequels(clip: &Clip) -> [(String, motionscope_core::scene::Scene); 2] {
    let mut walk = set("epipolar-geometry", &[]).walk(clip, 0).expect("a walk");
    walk.jump(Move::End);
    let rectified = (walk.step(None).sentence.plain(), walk.scene(None));
    let event = walk.info().granularities.len() - 1;
    walk.jump(Move::Granularity(event, motionscope_core::run::Direction::Back));
    [(walk.step(None).sentence.plain(), walk.scene(None)), rectified]
}

/// The first number of the `index`-th "120 of 121 right".
fn right(told: &str, index: usize) -> usize {
    let before = told.split(" right").nth(index).expect("counts are told");
    before.rsplit(' ').nth(2).and_then(|word| word.parse().ok()).expect("a number")
}

#[test]
fn guided_matching_finds_more_right_matches_than_unguided() {
    let clip = scene("parallax");
    let [(told, guided), _] = sequels(&clip);
    assert!(told.contains("Guided matching"), "{told}");
    // "… 123 matches, 120 of 121 right. Without guidance there are 99 matches, 97 of 98 right."
    let [guided_right, plain_right] = [right(&told, 0), right(&told, 1)];
    assert!(guided_right > plain_right, "{told}");
    assert!(guided.links.len() >= guided_right);
}

#[test]
fn a_rectified_pair_has_equal_rows() {
    // Layers at four depths, seen by a camera that moves sideways: the rows are nearly equal as they are.
    let [_, (told, scene)] = sequels(&scene("parallax"));
    assert!(told.contains("Rectification: both frames are warped"), "{told}");
    let names: Vec<String> = scene.pictures.iter().map(|canvas| canvas.picture.to_string()).collect();
    assert_eq!(names, ["warped-t", "warped-t+1"]);
}

#[test]
fn keypoints_are_tracked_through_a_clip_by_matching() {
    let clip = scene("hand-held");
    // ORB finds whole pixels of its levels.
    for (detector, off_px) in [("sift", 0.3), ("surf", 0.5), ("orb", 0.9)] {
        let output = run("feature-tracker", &[("detector", detector), ("frames", "8")], &clip);
        let field = output.get::<motionscope_core::products::TrackField>().expect("tracks");
        assert_eq!((field.first, field.last), (0, 7), "{detector}");
        let mut off: Vec<f32> = Vec::new();
        for t in 0..7 {
            let truth = clip.truth().expect("truth").flow(t).expect("a flow").expect("a flow");
            for point in field.at(t).points {
                let (Some([u, v]), Some([true_u, true_v])) = (point.displacement, truth.sample(point.at)) else {
                    continue;
                };
                off.push((u - true_u).hypot(v - true_v));
            }
        }
        off.sort_by(f32::total_cmp);
        let long = field.tracks.iter().filter(|track| track.points.len() >= 6).count();
        assert!(
            off.len() > 300 && off[off.len() / 2] < off_px,
            "{detector}: {} px of {}",
            off[off.len() / 2],
            off.len()
        );
        assert!(long > 20, "{detector}: only {long} tracks last 6 frames");
        // A track goes on where it stopped.
        for track in &field.tracks {
            for pair in track.points.windows(2) {
                let [u, v] = pair[0].displacement.expect("tracked in all but its last frame");
                let off = (pair[0].at[0] + u - pair[1].at[0]).hypot(pair[0].at[1] + v - pair[1].at[1]);
                assert!(off < 1e-3, "{detector}: {pair:?}");
            }
        }
    }
}

#[test]
fn without_texture_nothing_is_stated_and_no_limit_is_blamed() {
    let clip = Clip::from_frames("flat", vec![Frame::gray(Grid::new(64, 48, 77)); 2]).expect("frames");
    let told = |id: &str| {
        let mut walk = set(id, &[]).walk(&clip, 0).expect("a walk");
        walk.jump(Move::End);
        walk.step(None).sentence.plain()
    };
    for (id, ends) in [
        ("feature-matching", "End of the run without matches."),
        ("phase-correlation", "The translation remains unknown."),
        ("image-alignment", "so the motion of the picture remains unknown."),
    ] {
        let said = told(id);
        assert!(said.contains(ends) && !said.contains("(0.000") && !said.contains("ratio limit"), "{id}: {said}");
    }
}

#[test]
fn the_turnover_of_a_pair_is_that_of_its_tracks() {
    let clip = scene("hand-held");
    let matching = set("feature-tracker", &[("frames", "4")]);
    let output = matching.run(&clip, 0, &Threads::single()).expect("a run");
    let field = output.get::<motionscope_core::products::TrackField>().expect("tracks");
    let mut walk = matching.walk(&clip, 0).expect("a walk");
    walk.jump(Move::End);
    let said = walk.step(None).sentence.plain();
    // Tracks that were there before the last pair, and those of them that it continues.
    let old = field.tracks.iter().filter(|track| track.at(1).is_some() && track.at(2).is_some());
    let (old, continued) = (old.clone().count(), old.filter(|track| track.at(3).is_some()).count());
    assert!(said.contains(&format!(": {continued} of {old} tracks continued, {} lost", old - continued)), "{said}");
    assert!(said.contains("Mean endpoint error of this pair: "), "{said}");
    // The plot counts as tracked what goes on to the next frame, lost tracks apart.
    let tracked = field.tracks.iter().filter(|track| track.at(2).is_some() && track.at(3).is_some()).count();
    let plotted = walk.step(None).readouts.into_iter().find_map(|readout| match readout {
        Readout::Series(series) => series.lines[0].2.last().map(|[_, count]| *count as usize),
        _ => None,
    });
    assert_eq!(plotted, Some(tracked));
}

#[test]
fn a_rectified_pair_near_an_epipole_is_told_to_be_distorted() {
    // A camera of 300 px that moves forward and aside: its epipole 300 · 0.8 + 159.5 lies 80 px beside the picture.
    let moved = Vector3::new(0.48, 0.0, 0.6);
    let view = |k: usize| {
        let (x, y) = (24 + 23 * (k % 12), 24 + 23 * (k / 12));
        let depth = 4.0 + 1.5 * (x as f64 / 40.0).sin() * (y as f64 / 30.0).cos();
        let seen = Vector3::new((x as f64 - 159.5) / 300.0, (y as f64 - 119.5) / 300.0, 1.0) * depth - moved;
        let to = [300.0 * seen[0] / seen[2] + 159.5, 300.0 * seen[1] / seen[2] + 119.5];
        let is_inside = to[0] > 12.0 && to[0] < 307.0 && to[1] > 12.0 && to[1] < 227.0;
        is_inside.then(|| ([x, y], to.map(|c| c.round() as usize)))
    };
    let (here, there): (Vec<_>, Vec<_>) = (0..108).filter_map(view).unzip();
    let told = last_sentence("epipolar-geometry", &FEW, &moved_patches([&here, &there]));
    assert!(told.contains("px beside frame t") && told.contains("most of the picture is a sliver"), "{told}");
    let [_, (plain, _)] = sequels(&scene("parallax"));
    assert!(!plain.contains("sliver"), "{plain}");
}

/// A flow that is true for one plane of the scene.
struct Plane(std::sync::Arc<motionscope_core::data::Flow>);

impl motionscope_core::data::Truth for Plane {
    fn flow(
        &self,
        _: usize,
    ) -> Result<Option<std::sync::Arc<motionscope_core::data::Flow>>, motionscope_core::base::Error> {
        Ok(Some(self.0.clone()))
    }

    fn is_of_plane(&self, _: usize) -> bool {
        true
    }

    fn kinds(&self) -> Vec<&'static str> {
        vec!["flow"]
    }
}

#[test]
fn the_truth_of_a_plane_says_nothing_of_points_off_it() {
    let clip = scene("parallax");
    let told = |clip: &Clip| last_sentence("feature-matching", &[], clip);
    assert!(!told(&clip).contains("holds for one plane"));
    // As if nothing moved: most matches disagree with it.
    let still = Grid::new(320, 240, [0.0; 2]);
    let off =
        told(&clip.with_truth(std::sync::Arc::new(Plane(std::sync::Arc::new(motionscope_core::data::Flow(still))))));
    assert!(off.contains("a homography, which holds for one plane"), "{off}");
}
