//! The template tracker, held to its definition in plain sums, to exact warps, and to what it says of the scenes that break it.

use crate::common::{central, set, steps, waves};
use motionscope_core::base::Threads;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::{Bounds, Grid};
use motionscope_core::params::Params;
use motionscope_core::products::RegionField;
use motionscope_core::run::{AnyEstimator, Move};
use motionscope_core::scene::{Readout, Step};
use motionscope_core::synth;

/// The linear part and the shift of an affine warp, row by row.
type Affine = [[f64; 3]; 2];

/// A number of 0 to 255 that belongs to a pixel.
fn noise(x: usize, y: usize, seed: u64) -> u8 {
    let mixed = (x as u64 * 0x9E37_79B9) ^ (y as u64 * 0x85EB_CA6B) ^ (seed * 0xC2B2_AE35);
    (mixed.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 40) as u8
}

fn clip(frames: Vec<Frame>) -> Clip {
    Clip::from_frames("frames", frames).expect("frames of one size")
}

fn run(estimator: &dyn AnyEstimator, clip: &Clip) -> RegionField {
    let output = estimator.run(clip, 0, &Threads::single()).expect("a run");
    output.get::<RegionField>().expect("a region").clone()
}

/// The warp that a step shows.
fn warp(step: &Step, symbol: &str) -> Affine {
    let matrices = step.readouts.iter().find_map(|readout| match readout {
        Readout::Matrices(matrices) => Some(matrices),
        _ => None,
    });
    let matrix = matrices.expect("matrices").iter().find(|matrix| matrix.symbol == symbol).expect("a warp");
    [0, 1].map(|y| [0, 1, 2].map(|x| matrix.entries[(x, y)]))
}

fn applied(warp: &Affine, [x, y]: [f64; 2]) -> [f64; 2] {
    warp.map(|row| row[0] * x + row[1] * y + row[2])
}

/// The warp after the inverse of another.
fn after_inverse(warp: &Affine, [[a, b, u], [c, d, v]]: Affine) -> Affine {
    let det = a * d - b * c;
    let back = [[d / det, -b / det], [-c / det, a / det]];
    let shift = back.map(|row| -row[0] * u - row[1] * v);
    warp.map(|row| {
        let entry = |j: usize| row[0] * back[0][j] + row[1] * back[1][j];
        [entry(0), entry(1), row[0] * shift[0] + row[1] * shift[1] + row[2]]
    })
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

/// The warps after each iteration of the inverse compositional algorithm with an affine warp (Baker and Matthews 2004, figure 4).
fn iterated(template: &Grid<f64>, image: &Grid<u8>, start: Affine, count: usize) -> Vec<Affine> {
    let (width, height) = template.size();
    let middle = [(width as f64 - 1.0) / 2.0, (height as f64 - 1.0) / 2.0];
    let between = |[x, y]: [f64; 2]| {
        let (i, j) = (x.floor() as usize, y.floor() as usize);
        let (u, v) = (x - i as f64, y - j as f64);
        let at = |x: usize, y: usize| f64::from(image[(x, y)]);
        (1.0 - v) * ((1.0 - u) * at(i, j) + u * at(i + 1, j)) + v * ((1.0 - u) * at(i, j + 1) + u * at(i + 1, j + 1))
    };
    let mut warp = start;
    let once = |warp: &Affine| {
        let mut system = [[0.0; 7]; 6];
        for (i, j) in (0..height).flat_map(|j| (0..width).map(move |i| (i, j))) {
            let gx = central(|x| template[(x as usize, j)], i as isize, width);
            let gy = central(|y| template[(i, y as usize)], j as isize, height);
            let [x, y] = [i as f64 - middle[0], j as f64 - middle[1]];
            let descent = [gx * x, gx * y, gx, gy * x, gy * y, gy];
            let error = between(applied(warp, [x, y])) - template[(i, j)];
            for (row, a) in system.iter_mut().zip(descent) {
                (0..6).for_each(|k| row[k] += a * descent[k]);
                row[6] += a * error;
            }
        }
        let p = solved(system);
        after_inverse(warp, [[1.0 + p[0], p[1], p[2]], [p[3], 1.0 + p[4], p[5]]])
    };
    (0..count)
        .map(|_| {
            warp = once(&warp);
            warp
        })
        .collect()
}

/// Waves that move by `to_object`, the map from a pixel of frame t to a place of the object.
fn moved(size: (usize, usize), to_object: impl Fn([f64; 2]) -> [f64; 2]) -> Frame {
    Frame::gray(Grid::from_fn(size.0, size.1, |x, y| {
        let [u, v] = to_object([x as f64, y as f64]);
        (waves(u, v) + 0.5) as u8
    }))
}

#[test]
fn iterations_are_those_of_the_definition() {
    let back = |[x, y]: [f64; 2]| [1.03 * x - 0.05 * y + 1.1, 0.04 * x + 0.98 * y - 1.7];
    let frames = [moved((64, 56), |at| at), moved((64, 56), back)];
    let clip = clip(frames.to_vec());
    let settings = [
        ("region", "19.5,17.5,40.5,36.5"),
        ("update", "none"),
        ("levels", "1"),
        ("iterations", "5"),
        ("epsilon", "0.001"),
        ("frames", "2"),
    ];
    let found = steps(&*set("template-tracker", &settings), &clip, "Iteration ");
    let template = Grid::from_fn(21, 19, |x, y| f64::from(frames[0].luma()[(20 + x, 18 + y)]));
    let expected = iterated(&template, frames[1].luma(), [[1.0, 0.0, 30.0], [0.0, 1.0, 27.0]], 5);
    assert!(found.len() >= 4, "{} iterations", found.len());
    for (i, (step, expected)) in found.iter().zip(&expected).enumerate() {
        if step.sentence.plain().contains("undone") {
            continue;
        }
        let found = warp(step, "W");
        for (row, expected) in found.iter().zip(expected) {
            let off: Vec<f64> = row.iter().zip(expected).map(|(a, b)| (a - b).abs()).collect();
            assert!(off[0] < 1e-5 && off[1] < 1e-5 && off[2] < 1e-4, "iteration {}: {found:?}, {expected:?}", i + 1);
        }
    }
    let [x, y] = applied(&expected[4], [0.0; 2]);
    let [u, v] = back([x, y]);
    assert!((u - 30.0).hypot(v - 27.0) < 0.05, "the middle of the template lies at ({u}, {v})");
}

/// A place and a linear map.
type Pose = ([f64; 2], [[f64; 2]; 2]);

/// A turn by 1.5° and growth by 1 % a frame about a point that moves; the truth of the point and of the linear part.
fn turning(frames: usize) -> (Clip, impl Fn(usize) -> Pose) {
    let pose = |t: usize| {
        let (sin, cos) = (0.026 * t as f64).sin_cos();
        let scale = 1.01f64.powi(t as i32);
        ([40.0 + 1.3 * t as f64, 44.0 - 0.6 * t as f64], [[scale * cos, -scale * sin], [scale * sin, scale * cos]])
    };
    let frame = |t: usize| {
        let ([cx, cy], [[a, b], [c, d]]) = pose(t);
        let det = a * d - b * c;
        moved((112, 80), move |[x, y]| {
            let (x, y) = (x - cx, y - cy);
            [(d * x - b * y) / det, (a * y - c * x) / det]
        })
    };
    (clip((0..frames).map(frame).collect()), pose)
}

#[test]
fn exact_warps_are_recovered_and_a_translation_does_not_fit_them() {
    let (clip, pose) = turning(20);
    let last = |settings: &[(&str, &str)]| {
        let placed = [("region", "27.5,31.5,52.5,56.5")];
        let field = run(&*set("template-tracker", &[&placed, settings].concat()), &clip);
        let ([x, y], _) = pose(19);
        let frame = field.frames[19];
        (frame, f64::from(frame.region.center[0] - x as f32).hypot(f64::from(frame.region.center[1]) - y))
    };
    for warp in ["affine", "similarity"] {
        for update in ["none", "every-frame", "drift-corrected"] {
            let (frame, off) = last(&[("warp", warp), ("update", update)]);
            let side = f64::from(frame.region.size[0] * frame.region.size[1]).sqrt();
            assert!(!frame.is_lost && off < 0.15, "{warp}, {update}: {off:.3} px off");
            assert!((side / (25.0 * 1.01f64.powi(19)) - 1.0).abs() < 0.01, "{warp}, {update}: {side:.3} px wide");
        }
    }
    let [affine, shifted] = ["affine", "translation"].map(|warp| last(&[("warp", warp), ("update", "none")]).0);
    assert!(shifted.similarity < 0.8 && affine.similarity > 0.97, "{affine:?}, {shifted:?}");
}

/// A textured disc of `radius` px that moves before a textured background, and its centre. Over a share of the disc that grows to
/// `covered`, another texture sweeps around its middle.
fn disc(radius: f64, covered: f64) -> (Clip, fn(usize) -> [f64; 2]) {
    let place = |t: usize| [26.0 + 1.4 * t as f64, 32.0 + 0.3 * t as f64];
    let frame = |t: usize| {
        let ([cx, cy], share) = (place(t), covered * t as f64 / (DISC_FRAMES - 1) as f64);
        Frame::gray(Grid::from_fn(112, 72, |x, y| {
            let [u, v] = [x as f64 - cx, y as f64 - cy];
            let turn = (v.atan2(u) / std::f64::consts::TAU).rem_euclid(1.0);
            let value = match (u.hypot(v) < radius, turn < share) {
                (true, true) => 20.0 + 0.8 * waves(v + 400.0, 200.0 - u),
                (true, false) => waves(u, v),
                _ => 40.0 + 0.6 * waves(1.3 * x as f64 + 700.0, 1.3 * y as f64),
            };
            (value.clamp(0.0, 247.0) + 0.5) as u8 + noise(x, y, t as u64) / 32
        }))
    };
    (clip((0..DISC_FRAMES).map(frame).collect()), place)
}

const DISC_FRAMES: usize = 48;

/// The distances from the true centre by frame, and whether the object was lost.
fn errors(settings: &[(&str, &str)], (clip, place): &(Clip, fn(usize) -> [f64; 2])) -> (Vec<f64>, bool) {
    let field = run(&*set("template-tracker", settings), clip);
    let off = |(t, [x, y]): (usize, [f32; 2])| (f64::from(x) - place(t)[0]).hypot(f64::from(y) - place(t)[1]);
    let all = field.frames.iter().map(|frame| frame.region.center).enumerate().map(off).collect();
    (all, field.frames.iter().any(|frame| frame.is_lost))
}

#[test]
fn an_update_in_every_frame_drifts_and_the_correction_does_not() {
    // The corners of the region show the background, which stays behind.
    let disc = disc(12.0, 0.0);
    let of = |update: &str| errors(&[("update", update), ("region", "13.5,19.5,38.5,44.5")], &disc);
    let [(naive, is_lost), (corrected, _)] = ["every-frame", "drift-corrected"].map(of);
    let [naive, corrected] = [naive, corrected].map(|errors| errors[DISC_FRAMES - 8..].iter().sum::<f64>() / 8.0);
    assert!(
        corrected < 0.6 && naive > 8.0,
        "{naive:.3} px off with an update in every frame, corrected {corrected:.3} px"
    );
    // The correlation does not show it: it is one with a template that has drifted too.
    assert!(!is_lost);
}

#[test]
fn a_change_of_appearance_is_lost_without_update() {
    let disc = disc(15.0, 0.8);
    let region = ("region", "16.5,22.5,35.5,41.5");
    let (off, is_lost) = errors(&[("update", "none"), region], &disc);
    assert!(is_lost && off[DISC_FRAMES - 1] > 15.0, "without update {:.2} px off", off[DISC_FRAMES - 1]);
    for update in ["every-frame", "drift-corrected"] {
        let (off, is_lost) = errors(&[("update", update), region], &disc);
        assert!(!is_lost && off[DISC_FRAMES - 1] < 7.0, "{update}: {:.2} px off", off[DISC_FRAMES - 1]);
    }
    let failed = steps(&*set("template-tracker", &[region]), &disc.0, "it has failed, since drift is slow");
    assert!(!failed.is_empty(), "the first template no longer fits");
}

#[test]
fn a_ball_that_grows_over_leaves_of_its_colour_is_followed_without_drift() {
    let difficulty = synth::scene("leaves").expect("it is bundled").difficulty();
    let clip = synth::make("leaves", &difficulty).expect("a clip");
    let overlap = |update: &str| {
        let field = run(&*set("template-tracker", &[("update", update)]), &clip);
        let errors = field.errors(&clip).expect("readable");
        errors[25..].iter().map(|error| error.overlap).sum::<f64>() / errors[25..].len() as f64
    };
    let [naive, corrected] = ["every-frame", "drift-corrected"].map(overlap);
    assert!(corrected > 0.85 && naive < 0.4, "{naive:.3} with an update in every frame, corrected {corrected:.3}");
}

#[test]
fn more_levels_reach_farther() {
    let place = |t: usize| 26.0 + 6.0 * t as f64;
    let frame = |t: usize| moved((150, 72), move |[x, y]| [1.6 * (x - place(t)), 1.6 * (y - 36.0)]);
    let clip = clip((0..12).map(frame).collect());
    let off = |levels: &str| {
        let settings = [("region", "9.5,19.5,42.5,52.5"), ("levels", levels)];
        let center = run(&*set("template-tracker", &settings), &clip).frames[11].region.center;
        (f64::from(center[0]) - place(11)).hypot(f64::from(center[1]) - 36.0)
    };
    let [one, three] = ["1", "3"].map(off);
    assert!(three < 0.2 && one > 5.0, "{one:.2} px off on one level, {three:.2} px on three");
}

#[test]
fn a_hidden_object_is_said_to_be_lost_and_its_template_is_kept() {
    // A textured bar goes over the square, which stays.
    let frame = |t: usize| {
        let bar = 6 * t;
        Frame::gray(Grid::from_fn(96, 48, |x, y| {
            let inside = (40..60).contains(&x) && (14..34).contains(&y);
            match (x + 34 >= bar && x + 6 < bar, inside) {
                (true, _) => 40 + noise((x + 34 - bar) / 2, y / 2, 9) / 2,
                (_, true) => (waves(1.5 * x as f64, 1.5 * y as f64) + 0.5) as u8,
                _ => 70 + noise(x / 3, y / 3, 2) / 4,
            }
        }))
    };
    let clip = clip((0..20).map(frame).collect());
    let truth = Bounds { min: [39.5, 13.5], max: [59.5, 33.5] };
    for update in ["none", "every-frame", "drift-corrected"] {
        let tracker = set("template-tracker", &[("region", "39.5,13.5,59.5,33.5"), ("update", update)]);
        let field = run(&*tracker, &clip);
        assert!(field.frames[12].is_lost, "{update}: {:?}", field.frames[12]);
        let last = field.frames[19];
        let overlap = last.region.bounds().iou(&truth);
        assert!(!last.is_lost && overlap > 0.85, "{update}: overlap {overlap:.3}");
        assert!(!steps(&*tracker, &clip, "The warp is discarded").is_empty(), "{update} says nothing");
    }
}

#[test]
fn a_template_that_shrinks_to_a_line_is_lost_however_well_it_correlates() {
    let clip = synth::make("traffic", &synth::scene("traffic").expect("it is bundled").difficulty()).expect("a clip");
    let tracker = set("template-tracker", &[]);
    let frames = run(&*tracker, &clip).frames;
    // The bridge hides the car: its edge correlates with a template of no width.
    assert!(frames.last().expect("frames").is_lost);
    for pair in frames.windows(2) {
        let [[w, h], [next_w, next_h]] = [pair[0].region.size, pair[1].region.size];
        assert!((0.5..=2.0).contains(&(next_w / w)) && (0.5..=2.0).contains(&(next_h / h)), "{pair:?}");
    }
    assert!(!steps(&*tracker, &clip, "the warp changes lengths by factors between").is_empty(), "it says nothing");
}

/// A scene at a speed, with this number of frames.
fn scene(id: &str, speed: &str, frames: &str) -> Clip {
    let mut difficulty = synth::scene(id).expect("it is bundled").difficulty();
    for (name, value) in [("speed", speed), ("frames", frames)] {
        difficulty.set(name, value).expect("a slider");
    }
    synth::make(id, &difficulty).expect("a clip")
}

/// The first lost frame of a run, the visible share of the object in it, and the last sentence.
fn ended(clip: &Clip) -> (usize, f32, String) {
    let tracker = set("template-tracker", &[]);
    let frame = run(&*tracker, clip).frames.iter().position(|frame| frame.is_lost).expect("a loss");
    let objects = clip.truth().expect("exact").objects(frame).expect("readable").expect("known");
    let mut walk = tracker.walk(clip, 0).expect("a walk");
    walk.jump(Move::End);
    (frame, objects[0].visibility, walk.step(None).sentence.plain())
}

#[test]
fn a_slow_ball_is_lost_by_the_cover_of_the_tunnel() {
    let clip = scene("tunnel", "0.5", "80");
    // It reaches the entrance in frame 25.
    let errors = run(&*set("template-tracker", &[]), &clip).errors(&clip).expect("readable");
    let before: Vec<f64> = errors.iter().filter(|error| error.frame < 25).map(|error| error.overlap).collect();
    assert!(before.len() == 24 && before.iter().all(|overlap| *overlap > 0.9), "{before:?}");
    let (frame, visibility, end) = ended(&clip);
    assert!(frame > 25 && visibility < 0.6, "frame {frame}: {visibility} visible");
    assert!(end.contains(&format!("begins in frame {frame}")) && end.contains("it was covered"), "{end}");
}

#[test]
fn a_ball_is_lost_by_its_rotation_before_anything_covers_it() {
    // By 14.4° a frame; at half the speed by 7.2°, which the template follows to the tunnel.
    let (frame, visibility, end) = ended(&scene("tunnel", "1", "13"));
    assert!(frame < 13 && visibility == 1.0, "frame {frame}: {visibility} visible");
    assert!(end.contains("nothing covered the object") && end.contains("a rotation, a change of light"), "{end}");
    let (_, _, end) = ended(&scene("fast-flight", "1", "12"));
    assert!(end.contains("farther than the iterations converge"), "{end}");
}

#[test]
fn regions_without_texture_or_pixels_are_refused_in_words() {
    let flat = clip(vec![Frame::gray(Grid::new(64, 48, 90)); 3]);
    let edge = clip(vec![Frame::gray(Grid::from_fn(64, 48, |x, _| if x < 30 { 60 } else { 170 })); 3]);
    for (clip, warp, count) in
        [(&flat, "affine", "6 parameters"), (&flat, "translation", "2 parameters"), (&edge, "affine", "6 parameters")]
    {
        let tracker = set("template-tracker", &[("region", "20,15,40,35"), ("warp", warp)]);
        let said = steps(&*tracker, clip, "The region cannot be tracked");
        assert!(said.len() == 1 && said[0].sentence.plain().contains(&format!("does not determine {count}")), "{warp}");
        let field = run(&*tracker, clip);
        assert!(field.frames.len() == 1 && field.frames[0].is_lost, "{field:?}");
    }
    for (region, said) in [("70,10,90,30", "0×20 px inside the picture of 64×48 px"), ("5,5,6,6", "1×1 px inside")] {
        let refusal = set("template-tracker", &[("region", region)]).walk(&edge, 0).map(|_| ()).expect_err("too small");
        assert!(refusal.to_string().contains(said), "{refusal}");
    }
}
