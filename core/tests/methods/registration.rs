//! Phase correlation and image alignment against plain sums, on known motion, and on input that does not suit them.

use crate::common::{self, SIZE, error, linear_motion, moving, set, waves};
use motionscope_core::base::Threads;
use motionscope_core::data::{Clip, Flow, Frame};
use motionscope_core::geometry::Grid;
use motionscope_core::params::Params;
use motionscope_core::products::{ModelField, metrics};
use motionscope_core::run::{AnyEstimator, Cursor, Move};
use motionscope_core::scene::Readout;
use motionscope_core::synth;

fn model(estimator: &dyn AnyEstimator, clip: &Clip) -> ModelField {
    let output = estimator.run(clip, 0, &Threads::single()).expect("a run");
    output.get::<ModelField>().expect("a model").clone()
}

fn noise(x: i64, y: i64) -> u8 {
    let h = (x as u32).wrapping_mul(0x9E37_79B9) ^ (y as u32).wrapping_mul(0x85EB_CA6B);
    let h = (h ^ h >> 15).wrapping_mul(0xC2B2_AE35);
    ((h ^ h >> 13) >> 24) as u8
}

/// Two frames of noise that moves by `(u, v)` px.
fn shifted((width, height): (usize, usize), [u, v]: [i64; 2]) -> Clip {
    let frame = |t: i64| Frame::gray(Grid::from_fn(width, height, |x, y| noise(x as i64 - u * t, y as i64 - v * t)));
    Clip::from_frames("noise", vec![frame(0), frame(1)]).expect("frames of one size")
}

/// The phase correlation of two small pictures by sums over all pixels and frequencies.
fn plain_correlation([a, b]: [&Grid<u8>; 2], least: f64) -> Vec<f64> {
    const TAU: f64 = std::f64::consts::TAU;
    let (width, height) = a.size();
    let hann = |i: usize, n: usize| (std::f64::consts::PI * (i as f64 + 0.5) / n as f64).sin().powi(2);
    let places: Vec<_> = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).collect();
    let angle = |(x, y): (usize, usize), (f, g): (usize, usize)| {
        TAU * ((x * f) as f64 / width as f64 + (y * g) as f64 / height as f64)
    };
    let transform = |picture: &Grid<u8>, at: (usize, usize)| {
        let mean = picture.cells().iter().map(|&v| f64::from(v)).sum::<f64>() / (width * height) as f64;
        places.iter().fold([0.0, 0.0], |[re, im], &(x, y)| {
            let value = (f64::from(picture[(x, y)]) - mean) * hann(x, width) * hann(y, height);
            let (sin, cos) = angle((x, y), at).sin_cos();
            [re + value * cos, im - value * sin]
        })
    };
    let power: f64 = places.iter().map(|&(x, y)| (hann(x, width) * hann(y, height)).powi(2)).sum();
    let phases: Vec<_> = places
        .iter()
        .map(|&at| {
            let ([a, b], [c, d]) = (transform(a, at), transform(b, at));
            let cross = [c * a + d * b, d * a - c * b];
            let size = cross[0].hypot(cross[1]);
            if size > least * power / 12.0 { cross.map(|part| part / size) } else { [0.0; 2] }
        })
        .collect();
    let kept = phases.iter().filter(|phase| **phase != [0.0; 2]).count() as f64;
    let value = |at: (usize, usize)| -> f64 {
        let terms = places.iter().zip(&phases).map(|(&frequency, [re, im])| {
            let (sin, cos) = angle(at, frequency).sin_cos();
            re * cos - im * sin
        });
        terms.sum::<f64>() / kept
    };
    places.iter().map(|&at| value(at)).collect()
}

#[test]
fn the_correlation_is_that_of_the_textbook() {
    let clip = shifted((18, 14), [3, -2]);
    let pair = clip.pair(0).expect("a pair");
    let expected = plain_correlation([pair[0].luma(), pair[1].luma()], 10.0);
    let mut walk = set("phase-correlation", &[]).walk(&clip, 0).expect("a walk");
    walk.jump(Move::To(Cursor { unit: 9, event: 1 }));
    let surface = walk.step(None).readouts.into_iter().find_map(|readout| match readout {
        Readout::Surface(surface) => Some(surface),
        _ => None,
    });
    let surface = surface.expect("a surface");
    // The maximum of the correlation is sought, not its minimum.
    let most = expected.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let found = surface.optimum().map(|(value, _)| f64::from(value));
    assert!(found.is_some_and(|found| (found - most).abs() < 1e-5), "{found:?} for {most}");
    for (x, y) in (0..surface.values.height()).flat_map(|y| (0..surface.values.width()).map(move |x| (x, y))) {
        let [u, v] = [surface.origin[0] + x as i32, surface.origin[1] + y as i32];
        let place = v.rem_euclid(14) as usize * 18 + u.rem_euclid(18) as usize;
        let off = f64::from(surface.values[(x, y)]) - expected[place];
        assert!(off.abs() < 1e-5, "({u}, {v}): off by {off}");
    }
}

#[test]
fn whole_translations_have_a_distinct_peak() {
    for motion in [[0, 0], [5, -3], [-17, 11]] {
        let clip = shifted((128, 96), motion);
        let found = model(&*set("phase-correlation", &[("subpixel", "none")]), &clip).matrix.expect("an estimate");
        assert_eq!([found[0][2], found[1][2]], motion.map(|c| c as f64));
    }
}

#[test]
fn frames_with_nothing_in_common_have_no_translation_and_the_number_is_said() {
    let smooth = |seed: i64| {
        let level = |x: usize, y: usize| {
            let cells = (0..6).flat_map(|j| (0..6).map(move |i| (i, j)));
            let sum: f64 = cells.map(|(i, j)| f64::from(noise(x as i64 + i + seed, y as i64 + j))).sum();
            (sum / 36.0) as u8
        };
        Frame::gray(Grid::from_fn(128, 96, level))
    };
    let rough = |seed: i64| Frame::gray(Grid::from_fn(128, 96, |x, y| noise(x as i64 + seed, y as i64)));
    for (name, frames) in [
        ("rough", vec![rough(0), rough(5000)]),
        ("smooth", vec![smooth(0), smooth(5000)]),
        ("both", vec![smooth(0), rough(5000)]),
    ] {
        let clip = Clip::from_frames(name, frames).expect("frames of one size");
        let estimator = set("phase-correlation", &[]);
        assert_eq!(model(&*estimator, &clip).matrix, None, "{name}");
        let mut walk = estimator.walk(&clip, 0).expect("a walk");
        walk.jump(Move::End);
        let said = walk.step(None).sentence.plain();
        assert!(said.contains("rejected") && said.contains("standard deviations of r are less than"), "{name}: {said}");
    }
}

#[test]
fn a_translation_is_found_under_noise_and_a_change_of_a_third_of_the_picture() {
    let level = |t: i64, x: usize, y: usize| {
        let (u, v) = (x as i64 - 7 * t, y as i64 + 4 * t);
        let own = if x < 42 { noise(x as i64 + 9000 * (t + 1), y as i64) } else { noise(u, v) };
        let disturbance = f64::from(noise(x as i64 + 777 + 400 * t, y as i64 + 55)) - 127.5;
        (0.6 * f64::from(own) + 0.2 * disturbance + 51.0) as u8
    };
    let frame = |t: i64| Frame::gray(Grid::from_fn(128, 96, |x, y| level(t, x, y)));
    let clip = Clip::from_frames("half", vec![frame(0), frame(1)]).expect("frames of one size");
    let found = model(&*set("phase-correlation", &[("subpixel", "none")]), &clip).matrix.expect("an estimate");
    assert_eq!([found[0][2], found[1][2]], [7.0, -4.0]);
}

#[test]
fn known_warps_are_recovered_by_each_model() {
    let turn = [[0.0, -0.03], [0.03, 0.0]];
    for (id, matrix, d) in [
        ("translation", [[0.0; 2]; 2], [2.6, -1.7]),
        ("rigid", turn, [1.2, 0.8]),
        ("similarity", [[0.02, -0.03], [0.03, 0.02]], [1.2, 0.8]),
        ("affine", [[0.03, 0.02], [-0.01, -0.02]], [-1.5, 2.0]),
        ("homography", [[0.03, 0.02], [-0.01, -0.02]], [-1.5, 2.0]),
    ] {
        let (clip, truth) = linear_motion(matrix, d);
        let found = model(&*set("image-alignment", &[("model", id)]), &clip);
        let off = error(&found.displacements_of_pixels(), &truth, 8);
        assert!(off < 0.04, "{id}: {off} px off");
    }
}

#[test]
fn the_increment_solves_the_normal_equations() {
    let (clip, _) = linear_motion([[0.0; 2]; 2], [0.6, -0.4]);
    let pair = clip.pair(0).expect("a pair");
    let [a, b] = [0, 1].map(|i| pair[i].luma());
    let (mut sums, mut right) = ([0.0f64; 3], [0.0f64; 2]);
    for (x, y) in (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (x, y))) {
        let row = |i: isize| f64::from(a[(i as usize, y)]);
        let column = |i: isize| f64::from(a[(x, i as usize)]);
        let [u, v] = [common::central(row, x as isize, SIZE.0), common::central(column, y as isize, SIZE.1)];
        let difference = f64::from(b[(x, y)]) - f64::from(a[(x, y)]);
        sums = [sums[0] + u * u, sums[1] + u * v, sums[2] + v * v];
        right = [right[0] + u * difference, right[1] + v * difference];
    }
    let det = sums[0] * sums[2] - sums[1] * sums[1];
    let plain = [(sums[2] * right[0] - sums[1] * right[1]) / det, (sums[0] * right[1] - sums[1] * right[0]) / det];
    let settings = [("model", "translation"), ("levels", "1"), ("iterations", "1")];
    let found = model(&*set("image-alignment", &settings), &clip).matrix.expect("an estimate");
    // The inverse of the increment is composed.
    assert!((found[0][2] + plain[0]).abs() < 1e-4 && (found[1][2] + plain[1]).abs() < 1e-4, "{found:?} {plain:?}");
}

#[test]
fn an_increment_with_partial_overlap_solves_the_equations_of_the_pixels_inside() {
    // Columns and rows of a small picture leave the frame: the Hessian of the whole picture would make each increment too short.
    let frame = |t: f64| Frame::gray(Grid::from_fn(32, 24, |x, y| waves(x as f64 - 3.2 * t, y as f64 + 2.4 * t) as u8));
    let clip = Clip::from_frames("shifted", vec![frame(0.0), frame(1.0)]).expect("frames of one size");
    let after = |iterations: &str| {
        let settings = [("model", "translation"), ("levels", "1"), ("iterations", iterations)];
        let found = model(&*set("image-alignment", &settings), &clip).matrix.expect("an estimate");
        [found[0][2], found[1][2]]
    };
    let ([u, v], second) = (after("1"), after("2"));
    assert!(u.abs().max(v.abs()) > 1.0, "the first increment leaves pixels outside: ({u}, {v})");
    let pair = clip.pair(0).expect("a pair");
    let [a, b] = [0, 1].map(|i| pair[i].luma());
    let (mut sums, mut right) = ([0.0f64; 3], [0.0f64; 2]);
    for (x, y) in (0..24).flat_map(|y| (0..32).map(move |x| (x, y))) {
        let at = [x as f64 + u, y as f64 + v];
        if at[0] < 0.0 || at[0] > 31.0 || at[1] < 0.0 || at[1] > 23.0 {
            continue;
        }
        let row = |i: isize| f64::from(a[(i as usize, y)]);
        let column = |i: isize| f64::from(a[(x, i as usize)]);
        let [dx, dy] = [common::central(row, x as isize, 32), common::central(column, y as isize, 24)];
        let difference = f64::from(b.sample(at[0] as f32, at[1] as f32)) - f64::from(a[(x, y)]);
        sums = [sums[0] + dx * dx, sums[1] + dx * dy, sums[2] + dy * dy];
        right = [right[0] + dx * difference, right[1] + dy * difference];
    }
    let det = sums[0] * sums[2] - sums[1] * sums[1];
    let plain = [(sums[2] * right[0] - sums[1] * right[1]) / det, (sums[0] * right[1] - sums[1] * right[0]) / det];
    let off = [u - plain[0] - second[0], v - plain[1] - second[1]].map(f64::abs);
    assert!(off[0].max(off[1]) < 0.01, "({u}, {v}), then {second:?}; plainly {plain:?}");
}

#[test]
fn the_truth_of_bundled_clips_is_met() {
    for (name, id, settings, most) in [
        ("translation", "phase-correlation", &[][..], 0.1),
        ("sub-pixel", "phase-correlation", &[], 0.1),
        ("translation", "image-alignment", &[("model", "translation")], 0.1),
        ("sub-pixel", "image-alignment", &[("model", "translation")], 0.1),
        ("spin-zoom", "image-alignment", &[("model", "similarity")], 0.1),
        ("spin-zoom", "image-alignment", &[("model", "affine")], 0.1),
        ("spin-zoom", "image-alignment", &[("model", "homography")], 0.15),
    ] {
        let scene = synth::scene(name).expect("a scene");
        let mut difficulty = scene.difficulty();
        difficulty.set("frames", "2").expect("all have it");
        let clip = synth::make(scene.id, &difficulty).expect("a clip");
        let truth = clip.truth().expect("a truth").flow(0).expect("readable").expect("known");
        let flow: Flow = model(&*set(id, settings), &clip).displacements_of_pixels();
        let epe = metrics::flow_error(&flow, &truth).expect("one size").expect("known pixels").epe_px;
        println!("{name} {id} {settings:?}: {epe:.4} px");
        assert!(epe < most, "{name}, {id} {settings:?}: {epe} px");
    }
}

#[test]
fn without_texture_nothing_moves_and_the_reason_is_said() {
    let clip = Clip::from_frames("flat", vec![Frame::gray(Grid::new(60, 40, 77)); 2]).expect("frames");
    for (id, unit, event, reason) in [
        (
            "phase-correlation",
            10,
            1,
            "the strongest has 0.0 times the cross power of rounding, and more than 10.0 times is needed",
        ),
        ("image-alignment", 0, 2, "singular: it has rank 0, and 6 parameters need rank 6"),
    ] {
        let estimator = set(id, &[]);
        let found = model(&*estimator, &clip);
        let rest = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert!(found.matrix.is_none_or(|matrix| matrix == rest), "{id}: {found:?}");
        let mut walk = estimator.walk(&clip, 0).expect("a walk");
        walk.jump(Move::To(Cursor { unit, event }));
        let said = walk.step(None).sentence.plain();
        assert!(said.contains(reason), "{id}: {said}");
    }
}

#[test]
fn another_picture_never_gives_a_wild_matrix() {
    let before = Frame::gray(Grid::from_fn(96, 80, |x, y| waves(x as f64, y as f64) as u8));
    let after = Frame::gray(Grid::from_fn(96, 80, |x, y| noise(x as i64, y as i64)));
    let clip = Clip::from_frames("cut", vec![before, after]).expect("frames");
    for id in ["translation", "rigid", "similarity", "affine", "homography"] {
        let found = model(&*set("image-alignment", &[("model", id)]), &clip);
        assert!(
            found.matrix.iter().flatten().flatten().all(|entry| entry.is_finite() && entry.abs() < 500.0),
            "{id}: {found:?}"
        );
    }
}

#[test]
fn frames_that_stay_are_aligned_at_once() {
    let clip = moving(|place| place);
    let found = model(&*set("image-alignment", &[]), &clip);
    assert!(
        found.iterations <= 2 * 3 && found.displacements_of_pixels().0.cells().iter().flatten().all(|c| c.abs() < 1e-3)
    );
}

#[test]
fn along_stripes_the_translation_is_unknown() {
    // Stripes in several directions: along the edges the displacement is free, whatever the peak says.
    for (across, period) in [([1.0, 0.0], 16.0), ([0.0, 1.0], 12.0), ([0.8, 0.6], 20.0), ([0.6, -0.8], 9.0)] {
        let frame = |t: f64| {
            Frame::gray(Grid::from_fn(128, 96, |x, y| {
                let along = across[0] * (x as f64 - 3.0 * t) + across[1] * y as f64;
                (127.5 + 80.0 * (along * std::f64::consts::TAU / period).sin()).round() as u8
            }))
        };
        let clip = Clip::from_frames("stripes", vec![frame(0.0), frame(1.0)]).expect("frames of one size");
        assert_eq!(model(&*set("phase-correlation", &[]), &clip).matrix, None, "{across:?}");
    }
}

/// The last sentence of phase correlation on a clip.
fn told(clip: &Clip) -> String {
    let mut walk = set("phase-correlation", &[]).walk(clip, 0).expect("a walk");
    walk.jump(Move::End);
    walk.step(None).sentence.plain()
}

#[test]
fn stripes_under_noise_are_edges_of_one_direction() {
    for (across, deviation) in [([1.0, 0.0], 6.0), ([0.0, 1.0], 10.0), ([0.8, 0.6], 6.0), ([0.96, -0.28], 0.0)] {
        let frame = |t: i64| {
            Frame::gray(Grid::from_fn(128, 96, |x, y| {
                let along = across[0] * (x as f64 - 3.0 * t as f64) + across[1] * y as f64;
                let off = f64::from(noise(x as i64 + 900 * (t + 1), y as i64)) / 127.5 - 1.0;
                let level = 127.5 + 60.0 * (along * std::f64::consts::TAU / 16.0).sin();
                (level + 3f64.sqrt() * deviation * off).round().clamp(0.0, 255.0) as u8
            }))
        };
        let clip = Clip::from_frames("stripes", vec![frame(0), frame(1)]).expect("frames of one size");
        assert_eq!(model(&*set("phase-correlation", &[]), &clip).matrix, None, "{across:?}");
        let said = told(&clip);
        assert!(said.contains("aperture problem") && said.contains("repeats every 16 px"), "{across:?}: {said}");
    }
}

#[test]
fn a_pattern_repeats_only_where_it_does() {
    for (clip, repeats) in [("spin-zoom", false), ("translation", false), ("wallpaper", true)] {
        let clip = synth::make(clip, &synth::scene(clip).expect("bundled").difficulty()).expect("a clip");
        assert!(model(&*set("phase-correlation", &[]), &clip).matrix.is_some(), "an error can be measured");
        let said = told(&clip);
        assert_eq!(said.contains("The pattern repeats"), repeats, "{said}");
    }
}

#[test]
fn a_border_at_rest_does_not_pass_for_the_motion_of_the_picture() {
    let motion = [7, -4];
    let is_inside = |x: usize, y: usize| (20..108).contains(&x) && (14..82).contains(&y);
    let frame = |t: i64| {
        let level = |x: usize, y: usize| {
            let moved = [x as i64 - motion[0] * t, y as i64 - motion[1] * t];
            // Blurred noise, so that the border has the stronger edges.
            let cells = (0..25).map(|i| f64::from(noise(moved[0] + i % 5, moved[1] + i / 5)));
            if is_inside(x, y) { (110.0 + cells.sum::<f64>() / 25.0 / 2.0) as u8 } else { 0 }
        };
        Frame::gray(Grid::from_fn(128, 96, level))
    };
    let clip = Clip::from_frames("border", vec![frame(0), frame(1)]).expect("frames of one size");
    let found = model(&*set("phase-correlation", &[("subpixel", "none")]), &clip).matrix;
    let is_right = found.is_none_or(|found| [found[0][2], found[1][2]] == motion.map(|c| c as f64));
    assert!(is_right, "the border at rest passes for the picture: {found:?}");
}

#[test]
fn a_distinct_peak_does_not_claim_the_part_of_the_picture_that_moves_otherwise() {
    let bundled = |id: &str| synth::make(id, &synth::scene(id).expect("bundled").difficulty()).expect("a clip");
    // Without the truth the residual tells.
    let without_truth = |clip: &Clip| {
        let frames = (0..2).map(|t| (*clip.frame(t).expect("a frame")).clone()).collect();
        Clip::from_frames("without truth", frames).expect("frames of one size")
    };
    let bus = bundled("passing-bus");
    let said = told(&bus);
    assert!(said.contains("only a part of the picture: by the ground truth "), "{said}");
    let said = told(&without_truth(&bus));
    assert!(said.contains("only a part of the picture: ") && said.contains("8×8 blocks"), "{said}");
    let marble = bundled("translation");
    for clip in [without_truth(&marble), marble] {
        let said = told(&clip);
        assert!(said.ends_with("stands out, so one translation explains the motion."), "{said}");
    }
}
