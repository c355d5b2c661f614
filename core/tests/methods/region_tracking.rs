//! Trackers of one region, held to their definitions on small clips, and to what they say of the scenes that break them.

use std::f64::consts::TAU;
use std::sync::Arc;

use crate::common::{self, Objects, set, steps, tile};
use motionscope_core::base::Threads;
use motionscope_core::data::{Clip, Frame, ObjectBox};
use motionscope_core::geometry::{Bounds, Grid};
use motionscope_core::params::Params as _;
use motionscope_core::products::region::{RegionError, RegionScores, success};
use motionscope_core::products::{Region, RegionField};
use motionscope_core::run::{AnyEstimator, Direction, Move};
use motionscope_core::synth;

const ALL: [&str; 4] = ["mean-shift", "camshift", "particle-filter", "correlation-filter"];

fn run(estimator: &dyn AnyEstimator, clip: &Clip) -> RegionField {
    let output = estimator.run(clip, 0, &Threads::single()).expect("a run");
    output.get::<RegionField>().expect("a region").clone()
}

fn scene(id: &str) -> Clip {
    synth::make(id, &synth::scene(id).expect("it is bundled").difficulty()).expect("a clip")
}

fn errors(estimator: &dyn AnyEstimator, clip: &Clip) -> Vec<RegionError> {
    run(estimator, clip).errors(clip).expect("readable")
}

/// The mean overlap in frames of a clip.
fn overlap(errors: &[RegionError], frames: std::ops::Range<usize>) -> f64 {
    let all: Vec<_> = errors.iter().filter(|error| frames.contains(&error.frame)).map(|error| error.overlap).collect();
    assert!(!all.is_empty(), "true boxes in {frames:?}");
    all.iter().sum::<f64>() / all.len() as f64
}

/// A number of 0 to 255 that belongs to a pixel.
fn noise(x: usize, y: usize, seed: u64) -> u8 {
    let mixed = (x as u64 * 0x9E37_79B9) ^ (y as u64 * 0x85EB_CA6B) ^ (seed * 0xC2B2_AE35);
    (mixed.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 40) as u8
}

/// A coloured disc of many shades in front of a background with some of its colours.
fn disc(center: [f64; 2], seed: u64) -> Frame {
    discs(&[center], seed)
}

/// Several of them.
fn discs(centers: &[[f64; 2]], seed: u64) -> Frame {
    Frame::rgb(Grid::from_fn(64, 48, |x, y| {
        let is_disc = centers.iter().any(|center| (x as f64 - center[0]).hypot(y as f64 - center[1]) < 9.0);
        let shade = noise(x, y, seed) / 4;
        if is_disc { [190 + shade, 60 + shade, 40 + shade / 2] } else { [60 + shade, 120 + shade, 40 + shade] }
    }))
}

/// The bin of a pixel among 16 of each channel.
fn bin(frame: &Frame, x: usize, y: usize) -> usize {
    let rgb = frame.color().expect("colour")[(x, y)];
    rgb.iter().fold(0, |bin, level| bin * 16 + usize::from(*level) / 16)
}

/// The pixels of an ellipse with the squares of their distances in radii.
fn pixels(frame: &Frame, center: [f64; 2], size: [f64; 2]) -> Vec<(usize, usize, f64)> {
    let (width, height) = frame.size();
    let square = |x: usize, y: usize| {
        let [u, v] = [(x as f64 - center[0]) / (size[0] / 2.0), (y as f64 - center[1]) / (size[1] / 2.0)];
        u * u + v * v
    };
    let all = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    all.map(|(x, y)| (x, y, square(x, y))).filter(|(.., square)| *square < 1.0).collect()
}

/// The histogram under the Epanechnikov kernel (Comaniciu, Ramesh and Meer 2003, equation 19).
fn histogram(frame: &Frame, center: [f64; 2], size: [f64; 2]) -> Vec<f64> {
    let mut sums = vec![0.0; 4096];
    pixels(frame, center, size).into_iter().for_each(|(x, y, square)| sums[bin(frame, x, y)] += 1.0 - square);
    let sum: f64 = sums.iter().sum();
    sums.into_iter().map(|value| value / sum).collect()
}

/// One shift: the Bhattacharyya coefficient before it (equation 17) and the centre after it (equations 25 and 26).
fn shifted(model: &[f64], frame: &Frame, center: [f64; 2], size: [f64; 2]) -> (f64, [f64; 2]) {
    let candidate = histogram(frame, center, size);
    let coefficient = model.iter().zip(&candidate).map(|(q, p)| (q * p).sqrt()).sum();
    let mut sums = [0.0; 3];
    for (x, y, _) in pixels(frame, center, size) {
        let weight = (model[bin(frame, x, y)] / candidate[bin(frame, x, y)]).sqrt();
        sums = [sums[0] + weight, sums[1] + weight * x as f64, sums[2] + weight * y as f64];
    }
    (coefficient, [sums[1] / sums[0], sums[2] / sums[0]])
}

#[test]
fn a_restart_after_each_failure_measures_robustness() {
    let clip = |id: &str, settings: &[(&str, &str)]| {
        let scene = synth::scene(id).expect("a scene");
        let mut difficulty = scene.difficulty();
        settings.iter().for_each(|(name, value)| difficulty.set(name, value).expect("in range"));
        scene.clip(&difficulty).expect("a clip")
    };
    // Behind the tunnel the object is lost; the tracker goes on from where it comes out.
    let clip = clip("tunnel", &[("frames", "60")]);
    let run = |restart: &str| {
        let output = set("template-tracker", &[("restart", restart)]).run(&clip, 0, &Threads::single()).expect("a run");
        output.get::<RegionField>().expect("a region").clone()
    };
    let (plain, restarted) = (run("off"), run("on"));
    let overlap = |field: &RegionField| {
        let errors = field.errors(&clip).expect("truth");
        errors.iter().map(|error| error.overlap).collect::<Vec<_>>()
    };
    let (plain, restarted) = (overlap(&plain), overlap(&restarted));
    let failed = plain.iter().position(|overlap| *overlap == 0.0).expect("it fails");
    assert_eq!(plain[..=failed], restarted[..=failed], "until the failure both are alike");
    assert!(restarted[failed..failed + 5].iter().all(|overlap| *overlap < 0.5), "it waits");
    let again = restarted[failed + 5..].iter().position(|overlap| *overlap > 0.9).expect("it restarts");
    assert!(plain[failed + 5 + again] < 0.5, "without a restart it stays lost");
}

#[test]
fn shifts_are_those_of_the_definition() {
    let frames = [disc([24.0, 22.0], 1), disc([27.0, 20.5], 2)];
    let clip = Clip::from_frames("disc", frames.to_vec()).expect("frames of one size");
    // No pixel lies on the border of the ellipse, where it counts or not.
    let (mut center, size) = ([24.05, 22.05], [20.5, 18.3]);
    let model = histogram(&frames[0], center, size);
    let mut before = 0.0;
    for shifts in 1..=4 {
        let (coefficient, next) = shifted(&model, &frames[1], center, size);
        let (shifts_text, region) = (shifts.to_string(), "13.8,12.9,34.3,31.2");
        let settings = [
            ("region", region),
            ("adapt-scale", "off"),
            ("iterations", &shifts_text),
            ("epsilon", "0.01"),
            ("frames", "2"),
        ];
        let found = run(&*set("mean-shift", &settings), &clip).frames[1];
        let off = [0, 1].map(|i| f64::from(found.region.center[i]) - next[i]);
        assert!(off[0].hypot(off[1]) < 1e-3, "shift {shifts}: {:?} where {next:?} is expected", found.region.center);
        assert!((f64::from(found.similarity) - coefficient).abs() < 1e-4, "shift {shifts}: ρ {coefficient}");
        assert!(coefficient > before, "ρ rises: {coefficient} after {before}");
        (center, before) = (next, coefficient);
    }
    assert!((center[0] - 27.0).hypot(center[1] - 20.5) < 1.0, "{center:?} is on the disc");
}

/// The discrete Fourier transform of a real picture by its definition, as real and imaginary part of each frequency.
fn transformed(of: &Grid<f64>) -> Vec<[f64; 2]> {
    let (width, height) = of.size();
    let value = |u: usize, v: usize| {
        let mut sums = [0.0; 2];
        for y in 0..height {
            for x in 0..width {
                let turn = -TAU * ((u * x) as f64 / width as f64 + (v * y) as f64 / height as f64);
                sums = [sums[0] + of[(x, y)] * turn.cos(), sums[1] + of[(x, y)] * turn.sin()];
            }
        }
        sums
    };
    (0..height).flat_map(|v| (0..width).map(move |u| (u, v))).map(|(u, v)| value(u, v)).collect()
}

/// Numerator G F* and denominator F F* of a filter for a window, with the Gaussian of 2 px in its middle.
struct Parts {
    numerator: Vec<[f64; 2]>,
    energy: Vec<f64>,
}

fn parts(window: &Grid<f32>) -> Parts {
    let (width, height) = window.size();
    let gaussian = |x: usize, y: usize| {
        let [u, v] = [x as f64 - (width / 2) as f64, y as f64 - (height / 2) as f64];
        (-(u * u + v * v) / 8.0).exp()
    };
    let g = transformed(&Grid::from_fn(width, height, gaussian));
    let f = transformed(&Grid::from_fn(width, height, |x, y| f64::from(window[(x, y)])));
    let product = |([a, b], [c, d]): (&[f64; 2], &[f64; 2])| [a * c + b * d, b * c - a * d];
    Parts { numerator: g.iter().zip(&f).map(product).collect(), energy: f.iter().map(|[a, b]| a * a + b * b).collect() }
}

/// The spatial filter of H* = A / (B + ε), with displacement 0 in the middle; ε is a thousandth of the mean of B.
fn spatial(Parts { numerator, energy }: &Parts, (width, height): (usize, usize)) -> Grid<f64> {
    let least = 1e-3 * energy.iter().sum::<f64>() / energy.len() as f64;
    Grid::from_fn(width, height, |x, y| {
        let [dx, dy] = [x as f64 - (width / 2) as f64, y as f64 - (height / 2) as f64];
        let term = |i: usize| {
            let ([u, v], [re, im]) = ([i % width, i / width], numerator[i].map(|part| part / (energy[i] + least)));
            let turn = TAU * (u as f64 * dx / width as f64 + v as f64 * dy / height as f64);
            // Of the conjugate of H*.
            re * turn.cos() + im * turn.sin()
        };
        (0..width * height).map(term).sum::<f64>() / (width * height) as f64
    })
}

/// The largest difference of two pictures as a share of the largest value.
fn difference(found: &Grid<f32>, expected: &Grid<f64>) -> f64 {
    let most = expected.cells().iter().fold(0.0f64, |most, value| most.max(value.abs()));
    let pairs = found.cells().iter().zip(expected.cells());
    pairs.map(|(found, expected)| (f64::from(*found) - expected).abs()).fold(0.0, f64::max) / most
}

/// A textured square at a place of a textured background.
fn square(at: [usize; 2]) -> Frame {
    Frame::gray(Grid::from_fn(56, 48, |x, y| {
        let inside = (at[0]..at[0] + 12).contains(&x) && (at[1]..at[1] + 10).contains(&y);
        if inside { 90 + noise(x - at[0], y - at[1], 1) / 2 } else { 70 + noise(x / 3, y / 3, 2) / 4 }
    }))
}

#[test]
fn a_correlation_filter_is_that_of_direct_sums() {
    // Two frames alike at the end: the window of the last is the one that the update before it took.
    let frames = vec![square([20, 18]), square([22, 17]), square([22, 17])];
    let clip = Clip::from_frames("square", frames).expect("frames of one size");
    let settings =
        [("region", "19.5,17.5,31.5,27.5"), ("perturbations", "0"), ("min-psr", "0"), ("window-scale", "1.5")];
    let filter = set("correlation-filter", &settings);
    let learned = &steps(&*filter, &clip, "is learned from")[0];
    let window = tile(learned, "window f");
    let first = parts(&window);
    let expected = spatial(&first, window.size());
    assert!(difference(&tile(learned, "filter h"), &expected) < 1e-3, "the filter of the first frame");

    // The response at n: Σ_k f(n + k) h(k), repeated beyond the window.
    let responses = steps(&*filter, &clip, "transformed back");
    let (f, g) = (tile(&responses[0], "window f"), tile(&responses[0], "response g"));
    let (width, height) = f.size();
    let direct = Grid::from_fn(width, height, |x, y| {
        let product = |i: usize, j: usize| {
            let [u, v] = [(x + i + width - width / 2) % width, (y + j + height - height / 2) % height];
            f64::from(f[(u, v)]) * expected[(i, j)]
        };
        (0..height).map(|j| (0..width).map(|i| product(i, j)).sum::<f64>()).sum::<f64>()
    });
    assert!(difference(&g, &direct) < 1e-3, "the response of the second frame");
    let peak = (0..width * height).max_by(|a, b| direct.cells()[*a].total_cmp(&direct.cells()[*b])).expect("pixels");
    assert_eq!([peak % width - width / 2, height / 2 - peak / width], [2, 1], "the displacement is (2, −1) px");

    // The update: η = 0.125 of the window at the new place.
    let updated = tile(&steps(&*filter, &clip, "averaged into numerator")[0], "filter, updated");
    let second = parts(&tile(&responses[1], "window f"));
    let mixed = |a: f64, b: f64| 0.875 * a + 0.125 * b;
    let both = Parts {
        numerator: first
            .numerator
            .iter()
            .zip(&second.numerator)
            .map(|(a, b)| [0, 1].map(|i| mixed(a[i], b[i])))
            .collect(),
        energy: first.energy.iter().zip(&second.energy).map(|(a, b)| mixed(*a, *b)).collect(),
    };
    assert!(difference(&updated, &spatial(&both, (width, height))) < 1e-3, "the updated filter");
}

#[test]
fn success_is_the_area_under_the_plot() {
    let overlaps = [1.0, 0.82, 0.5, 0.31, 0.0, 0.0, 0.64, 0.0];
    let error = |overlap| {
        let truth = Bounds::around([0.0; 2], [1.0; 2]);
        RegionError { frame: 1, truth, bounds: truth, overlap, center_px: 0.0, is_lost: false }
    };
    let errors: Vec<_> = overlaps.into_iter().map(error).collect();
    // Fine steps: the area under the share of frames above a threshold is the mean overlap, which the 21 thresholds come near.
    let fine: f64 =
        (0..10_000).map(|i| overlaps.iter().filter(|o| **o > f64::from(i) / 1e4).count() as f64 / 8e4).sum();
    let mean = overlaps.iter().sum::<f64>() / 8.0;
    let scores = RegionScores::of(&errors).expect("frames");
    assert!((fine - mean).abs() < 1e-3 && (scores.success - fine).abs() < 0.03, "{scores:?}, {fine}");
    assert_eq!((scores.failures, scores.overlap), (2, mean));
    let curve = success(&errors);
    assert_eq!((curve.len(), curve[0], curve[10], curve[20]), (21, [0.0, 5.0 / 8.0], [0.5, 3.0 / 8.0], [1.0, 0.0]));
}

#[test]
fn a_tunnel_stops_what_predicts_no_velocity() {
    let clip = scene("tunnel");
    for id in ["mean-shift", "camshift", "particle-filter"] {
        let errors = errors(&*set(id, &[]), &clip);
        let (before, after) = (overlap(&errors, 1..11), overlap(&errors, 33..40));
        assert!(before > 0.85, "{id}: overlap {before:.3} before the tunnel");
        match id {
            "particle-filter" => assert!(after > 0.5, "{id}: overlap {after:.3} behind the tunnel"),
            _ => assert!(after < 0.05, "{id}: overlap {after:.3} behind the tunnel"),
        }
    }
}

#[test]
fn particles_cross_the_tunnel_with_most_seeds() {
    let clip = scene("tunnel");
    let kept = (1..=10).filter(|seed: &u32| {
        let errors = errors(&*set("particle-filter", &[("seed", &seed.to_string())]), &clip);
        overlap(&errors, 33..40) > 0.4
    });
    let kept = kept.count();
    assert!(kept >= 8, "{kept} of 10");
}

/// Frames of the tunnel in which the whole ball is visible: it reaches the entrance in frame 13.
const BEFORE_TUNNEL: std::ops::Range<usize> = 1..13;

#[test]
fn a_correlation_filter_follows_the_rolling_ball_to_the_tunnel() {
    let clip = scene("tunnel");
    for seed in 1..=8 {
        let filter = set("correlation-filter", &[("seed", &seed.to_string())]);
        let before = overlap(&errors(&*filter, &clip), BEFORE_TUNNEL);
        assert!(before > 0.9, "seed {seed}: overlap {before:.3} before the tunnel");
    }
    // It predicts no velocity: inside the tunnel it reports that the ball is lost, and does not find it behind.
    let field = run(&*set("correlation-filter", &[]), &clip);
    assert!(field.frames[20..23].iter().all(|frame| frame.is_lost), "{:?}", &field.frames[20..23]);
    assert!(overlap(&field.errors(&clip).expect("readable"), 33..40) < 0.05);
}

#[test]
fn a_rolling_ball_needs_perturbations_of_its_rotation_and_a_window_around_it() {
    // The ball turns by 14.4° in each frame.
    let clip = scene("tunnel");
    for settings in [&[("rotation", "6")][..], &[("perturbations", "0")], &[("window-scale", "1.5")]] {
        let field = run(&*set("correlation-filter", settings), &clip);
        let lost = field.frames[BEFORE_TUNNEL].iter().filter(|frame| frame.is_lost && frame.similarity < 7.0).count();
        let before = overlap(&field.errors(&clip).expect("readable"), BEFORE_TUNNEL);
        assert!(lost > 6 && before < 0.4, "{settings:?}: lost in {lost} frames, overlap {before:.3}");
    }
}

#[test]
fn leaves_of_its_hue_spread_camshift_but_not_the_correlation_filter() {
    let clip = scene("leaves");
    let last = |id: &str| overlap(&errors(&*set(id, &[]), &clip), 26..36);
    let [camshift, filter] = ["camshift", "correlation-filter"].map(last);
    assert!(camshift < 0.15 && filter > 0.5, "CamShift {camshift:.3}, correlation filter {filter:.3}");
    // Its region keeps the size of the first frame, and the ball grows by a third: a region in its middle has an overlap of 0.57.
    let all = overlap(&errors(&*set("correlation-filter", &[]), &clip), 1..36);
    assert!(all > 0.7, "correlation filter {all:.3} over all frames");
    let field = run(&*set("camshift", &[]), &clip);
    let [first, late] = [0, 30].map(|t| field.frames[t].region.bounds().area());
    assert!(late > 4.0 * first, "the window spreads from {first} to {late} px²");
}

#[test]
fn a_threshold_of_the_ratio_keeps_an_occluder_out_of_the_filter() {
    // A textured bar goes over the square, which stays.
    let frame = |t: usize| {
        let bar = 6 * t;
        Frame::gray(Grid::from_fn(96, 48, |x, y| {
            let inside = (40..56).contains(&x) && (16..32).contains(&y);
            match (x + 30 >= bar && x + 10 < bar, inside) {
                (true, _) => 40 + noise((x + 30 - bar) / 2, y / 2, 9) / 2,
                (_, true) => 90 + noise(x, y, 1) / 2,
                _ => 70 + noise(x / 3, y / 3, 2) / 4,
            }
        }))
    };
    let clip = Clip::from_frames("bar", (0..22).map(frame).collect()).expect("frames of one size");
    let overlap = |settings: &[(&str, &str)]| {
        let placed = [("region", "39.5,15.5,55.5,31.5"), ("learning-rate", "0.3")];
        let field = run(&*set("correlation-filter", &[&placed, settings].concat()), &clip);
        let truth = Bounds { min: [39.5, 15.5], max: [55.5, 31.5] };
        field.frames[21].region.bounds().iou(&truth)
    };
    let [kept, lost] = [overlap(&[]), overlap(&[("min-psr", "0")])];
    assert!(kept > 0.85, "with a threshold of 7: {kept:.3}");
    assert!(lost < 0.5, "without a threshold: {lost:.3}");
}

#[test]
fn colours_of_the_surroundings_attract_mean_shift_unless_they_are_weighted() {
    // The region of a disc contains much of its background, to which the disc moves no more.
    let frame = |t: usize| {
        let center = [24.0 + 2.5 * t as f64, 24.0];
        Frame::rgb(Grid::from_fn(128, 48, |x, y| {
            let shade = noise(x, y, 3) / 16;
            let radius = (x as f64 - center[0]).hypot(y as f64 - center[1]);
            if radius < 6.0 { [180 + shade, 50 + shade, 60] } else { [70 + shade, 110 + shade, 60] }
        }))
    };
    let clip = Clip::from_frames("disc", (0..30).map(frame).collect()).expect("frames of one size");
    let distance = |background: &str| {
        let settings = [("region", "9.5,9.5,38.5,38.5"), ("background", background), ("adapt-scale", "off")];
        let field = run(&*set("mean-shift", &settings), &clip);
        let [x, y] = field.frames[29].region.center;
        f64::from(x - 96.5).hypot(f64::from(y) - 24.0)
    };
    let [ignored, weighted] = ["ignored", "weighted"].map(distance);
    assert!(weighted < 3.0 && ignored > 2.0 * weighted, "{ignored:.2} px, weighted {weighted:.2} px");
}

#[test]
fn regions_without_pixels_are_refused_and_flat_ones_are_told() {
    let flat = Frame::rgb(Grid::from_fn(64, 48, |_, _| [120, 60, 40]));
    let clip = Clip::from_frames("flat", vec![flat; 4]).expect("frames of one size");
    for id in ALL {
        for (region, said) in [("70,10,90,30", "0×20 px inside the picture of 64×48 px"), ("5,5,6,6", "1×1 px inside")]
        {
            let refusal = set(id, &[("region", region)]).walk(&clip, 0).map(|_| ()).expect_err("too small").to_string();
            assert!(refusal.contains(said) && refusal.contains("place it anew"), "{id}: {refusal}");
        }
        let estimator = set(id, &[("region", "20,15,40,35")]);
        let phrase = if id == "correlation-filter" { "without texture" } else { "flat region in one bin" };
        assert!(!steps(&*estimator, &clip, phrase).is_empty(), "{id} says nothing of a flat region");
        if id == "mean-shift" {
            let told = steps(&*estimator, &clip, "nothing distinguishes this position");
            assert_eq!(told.len(), 3, "one for each frame after the first");
        }
        let expected = Region::from(Bounds { min: [20.0, 15.0], max: [40.0, 35.0] });
        let field = run(&*estimator, &clip);
        match id {
            "correlation-filter" => assert!(field.frames.len() == 1 && field.frames[0].is_lost, "{field:?}"),
            "camshift" => assert!(field.frames.iter().all(|frame| frame.region.size.iter().all(|side| *side <= 64.0))),
            _ => {
                let [x, y] = field.frames[3].region.center;
                assert!((x - expected.center[0]).hypot(y - expected.center[1]) < 20.0, "{id}: {x}, {y}");
            }
        }
    }
}

/// Grass at rest, and before it a disc at `center`, if there is one, with the levels that `level` gives.
fn before_grass(center: Option<[f64; 2]>, level: impl Fn(i64, i64) -> u8) -> Frame {
    let grass = |x: usize, y: usize| 60 + (u16::from(noise(x / 2, y / 2, 5)) * 2 / 5) as u8;
    Frame::gray(Grid::from_fn(128, 96, |x, y| match center {
        Some([u, v]) if (x as f64 - u).hypot(y as f64 - v) < 11.0 => level(x as i64 - u as i64, y as i64 - v as i64),
        _ => grass(x, y),
    }))
}

#[test]
fn a_uniform_object_on_texture_has_a_window_with_texture() {
    let at = |t: usize| [40.0 + 2.0 * t as f64, 48.0];
    let frames = (0..12).map(|t| before_grass(Some(at(t)), |_, _| 200)).collect();
    let clip = Clip::from_frames("uniform", frames).expect("frames of one size");
    let field = run(&*set("correlation-filter", &[("region", "34,42,46,54")]), &clip);
    assert!(field.frames.len() == 12 && !field.frames[0].is_lost, "it is not refused: {field:?}");
}

#[test]
fn ground_that_stays_behind_an_object_is_no_match() {
    // The disc leaves and the filter stays: it has learnt the grass, and answers to it with an ever higher peak.
    let at = |t: usize| [40.0 + 2.0 * t as f64, 48.0];
    let faint = |u: i64, v: i64| 200 + noise((u + 40) as usize / 3, (v + 40) as usize / 3, 9) / 12;
    let frames = (0..40).map(|t| before_grass(Some(at(t)), faint)).collect();
    let clip = Clip::from_frames("leaves", frames).expect("frames of one size");
    let wide = set("correlation-filter", &[("region", "29,37,51,59"), ("window-scale", "4")]);
    let field = run(&*wide, &clip);
    let off = |t: usize| (f64::from(field.frames[t].region.center[0]) - at(t)[0]).abs();
    let gone: Vec<_> = (20..40).filter(|t| off(*t) > 22.0).collect();
    println!("{} of 20 frames beside the disc: {:?}", gone.len(), field.frames.last());
    assert!(gone.iter().all(|t| field.frames[*t].is_lost), "{:?}", field.frames);
    // The disc vanishes.
    let pattern = |u: i64, v: i64| 120 + noise((u + 40) as usize / 3, (v + 40) as usize / 3, 9) / 2;
    let still = |t: usize| at(t.min(8));
    let frame = |t: usize| before_grass((t < 20).then(|| still(t)), pattern);
    let clip = Clip::from_frames("gone", (0..30).map(frame).collect()).expect("frames of one size");
    let filter = set("correlation-filter", &[("region", "29,37,51,59")]);
    for filter in [&filter, &wide] {
        let field = run(&**filter, &clip);
        let (before, after) = field.frames.split_at(20);
        assert!(before.iter().all(|frame| !frame.is_lost), "the disc is followed: {before:?}");
        assert!(after.iter().all(|frame| frame.is_lost), "the disc is gone: {after:?}");
    }
    // A pattern that turns is another, but not the ground: that is doubt and no loss.
    let turned = |u: i64, v: i64| pattern(-v, u);
    let frame = |t: usize| before_grass(Some(at(t)), |u, v| if t < 14 { pattern(u, v) } else { turned(u, v) });
    let clip = Clip::from_frames("turned", (0..24).map(frame).collect()).expect("frames of one size");
    let field = run(&*filter, &clip);
    let lost = field.frames.iter().filter(|frame| frame.is_lost && frame.similarity >= 7.0).count();
    assert_eq!(lost, 0, "{:?}", field.frames);
    if !field.frames[23].is_lost {
        let end = conclusion(&*filter, &clip);
        assert!(end.contains("cannot tell these apart"), "{end}");
    }
}

#[test]
fn colours_that_are_gone_are_said() {
    let red = Frame::rgb(Grid::from_fn(64, 48, |x, y| [200, noise(x, y, 1) / 8, 20]));
    let blue = Frame::rgb(Grid::from_fn(64, 48, |x, y| [20, noise(x, y, 1) / 8, 200]));
    let clip = Clip::from_frames("gone", vec![red, blue.clone(), blue]).expect("frames of one size");
    for (id, phrase) in [
        ("mean-shift", "none of the pixels of the ellipse has a colour"),
        ("camshift", "no pixel of the window has a hue"),
    ] {
        let estimator = set(id, &[("region", "20,15,40,35")]);
        let field = run(&*estimator, &clip);
        assert!(field.frames[1..].iter().all(|frame| frame.is_lost), "{id}: {field:?}");
        assert_eq!(field.frames[2].region.center, [30.0, 25.0], "{id} stays");
        assert!(!steps(&*estimator, &clip, phrase).is_empty(), "{id} says nothing");
    }
    // Particles weigh the same where all are equally bad, whatever λ: a cloud that only spreads.
    let field = run(&*set("particle-filter", &[("region", "20,15,40,35"), ("lambda", "200")]), &clip);
    assert!(field.frames.iter().all(|frame| frame.region.center.iter().all(|c| c.is_finite())), "{field:?}");
    assert!(field.frames[2].similarity < 0.01);
}

#[test]
fn colours_unlike_those_of_the_first_frame_are_a_loss() {
    // The disc leaves at 4 px/frame. Little of its region is background, which then fills the ellipse.
    let frame = |t: usize| disc([30.0 + 4.0 * t as f64, 24.0], 1);
    let clip = Clip::from_frames("leaves", (0..16).map(frame).collect()).expect("frames of one size");
    let region = ("region", "20,14,40,34");
    let run_with = |least: &str| run(&*set("mean-shift", &[region, ("min-similarity", least)]), &clip);
    let field = run_with("0.4");
    for (t, frame) in field.frames.iter().enumerate() {
        assert_eq!(frame.is_lost, frame.similarity < 0.4, "frame {t}: {frame:?}");
    }
    let lost = field.frames.iter().position(|frame| frame.is_lost).expect("a loss");
    assert!((8..14).contains(&lost) && field.frames[lost..].iter().all(|frame| frame.is_lost), "from frame {lost} on");
    assert!(field.frames[lost..].iter().all(|frame| frame.region == field.frames[lost - 1].region), "the region stays");
    assert!(!run_with("0").frames[lost].is_lost, "without a threshold");
    let end = conclusion(&*set("mean-shift", &[region]), &clip);
    assert!(end.contains("ρ is below 0.400, 40 % of that in the first frame"), "{end}");
}

#[test]
fn particles_outside_the_picture_are_said_to_have_no_weight() {
    // The object leaves at 8 px/frame, and the particles with it.
    let frame = |t: usize| disc([50.0 + 8.0 * t as f64, 24.0], 1);
    let clip = Clip::from_frames("leaves", (0..12).map(frame).collect()).expect("frames of one size");
    let settings = [("region", "41,15,59,33"), ("process-noise", "0"), ("scale-noise", "0"), ("particles", "40")];
    let still = run(&*set("particle-filter", &settings), &clip);
    assert!(still.frames.iter().all(|frame| !frame.is_lost), "without noise the particles stay: {still:?}");
    let settings = [("region", "41,15,59,33"), ("process-noise", "30"), ("particles", "10"), ("resample-below", "0")];
    let estimator = set("particle-filter", &settings);
    let field = run(&*estimator, &clip);
    let lost = field.frames.iter().position(|frame| frame.is_lost).expect("all particles have left");
    assert_eq!(field.frames[lost].region, field.frames[lost - 1].region, "the estimate is not used");
    assert!(!steps(&*estimator, &clip, "none inside has a weight above 0").is_empty());
}

/// A scene with a slider.
fn scene_with(id: &str, slider: (&str, &str)) -> Clip {
    let mut difficulty = synth::scene(id).expect("it is bundled").difficulty();
    difficulty.set(slider.0, slider.1).expect("a slider");
    synth::make(id, &difficulty).expect("a clip")
}

/// The sentence at the end of a run.
fn conclusion(estimator: &dyn AnyEstimator, clip: &Clip) -> String {
    let mut walk = estimator.walk(clip, 0).expect("a walk");
    walk.jump(Move::End);
    walk.step(None).sentence.plain()
}

#[test]
fn the_end_of_a_run_says_what_became_of_the_region() {
    let (leaves, fast, tunnel) = (scene("leaves"), scene_with("leaves", ("speed", "4")), scene("tunnel"));
    for (id, clip, said, unsaid) in [
        (
            "camshift",
            &leaves,
            &["times as large as the true box", "spread over a background of like hue"][..],
            "stood out",
        ),
        ("particle-filter", &fast, &["1 failure", "is not in the picture from frame 17 on"], "survived"),
        ("particle-filter", &tunnel, &["The object was hidden in", "the velocity carried"], "outside the picture"),
        (
            "mean-shift",
            &tunnel,
            &[
                "1 failure",
                "a loss reported in",
                "ρ is below 0.400, 40 % of that in the first",
                "The object was hidden in",
            ],
            "led the ellipse",
        ),
        ("correlation-filter", &tunnel, &["1 failure", "The object was hidden in"], "does not attract"),
    ] {
        let end = conclusion(&*set(id, &[]), clip);
        assert!(said.iter().all(|phrase| end.contains(phrase)) && !end.contains(unsaid), "{id}: {end}");
    }
}

#[test]
fn an_object_that_stays_hidden_is_the_cause_of_the_end() {
    let clip = scene("hand-held");
    for id in ["mean-shift", "camshift", "particle-filter", "correlation-filter", "template-tracker"] {
        let end = conclusion(&*set(id, &[]), &clip);
        assert!(end.contains("disappears from frame 17 on and is wholly hidden from frame 23 on"), "{id}: {end}");
        for blame in ["attract it too", "of another pose", "places have colours", "has the hues of the model"] {
            assert!(!end.contains(blame), "{id}: {end}");
        }
    }
}

#[test]
fn without_true_boxes_no_success_is_claimed() {
    let still = Clip::from_frames("still", vec![disc([30.0, 24.0], 1); 4]).expect("frames of one size");
    for id in ALL {
        let end = conclusion(&*set(id, &[("region", "21,15,39,33")]), &still);
        assert!(end.contains("lost in 0 of 4 frames") && end.contains("only the pictures show"), "{id}: {end}");
    }
    // What a contour judges by is no similarity to a model.
    let balloon = scene("balloon");
    let frames = (0..4).map(|t| (*balloon.frame(t).expect("a frame")).clone()).collect();
    let untold = Clip::from_frames("balloon", frames).expect("frames of one size");
    let end = conclusion(&*set("active-contour", &[("region", "36,95,92,161")]), &untold);
    assert!(end.contains("of something else has a high mean edge strength too") && !end.contains("similar"), "{end}");
    // Gray pixels have no hue: the model is empty, whatever lies beside it.
    let gray = Frame::rgb(Grid::from_fn(64, 48, |x, y| [noise(x, y, 1) / 4 + 90; 3]));
    let clip = Clip::from_frames("gray", vec![gray; 4]).expect("frames of one size");
    let end = conclusion(&*set("camshift", &[("region", "20,15,40,35")]), &clip);
    assert!(end.contains("the model has no hue") && end.contains("The model is empty"), "{end}");
}

#[test]
fn a_region_found_again_may_be_another_object() {
    // The disc goes for two frames and comes back far away, while another one comes near to where it was last.
    let places: [&[[f64; 2]]; 8] = [
        &[[24.0, 24.0]],
        &[[24.0, 24.0]],
        &[],
        &[],
        &[[52.0, 38.0], [30.0, 22.0]],
        &[[52.0, 38.0], [30.0, 22.0]],
        &[[52.0, 38.0], [30.0, 22.0]],
        &[[52.0, 38.0], [30.0, 22.0]],
    ];
    let frames = places.iter().map(|centers| discs(centers, 1)).collect();
    let clip = Clip::from_frames("discs", frames).expect("frames of one size");
    let box_of = |[x, y]: [f64; 2]| ObjectBox {
        id: 1,
        x: (x - 9.0) as f32,
        y: (y - 9.0) as f32,
        width: 18.0,
        height: 18.0,
        visibility: 1.0,
    };
    let truth = places.iter().map(|centers| centers.first().map(|center| box_of(*center)).into_iter().collect());
    let known = clip.clone().with_truth(Arc::new(Objects(truth.collect())));
    for id in ["mean-shift", "camshift"] {
        let placed = set(id, &[("region", "15,15,33,33")]);
        // CamShift has no threshold of a loss.
        let unreported = if id == "camshift" { " that is not reported" } else { "" };
        let again = steps(&*placed, &clip, &format!("After a loss of 2 frames{unreported} the region is found again"));
        let said = again.first().map(|step| step.sentence.plain()).unwrap_or_default();
        assert!(
            said.contains("px from its position before the loss") && said.contains("may be another object"),
            "{said}"
        );
        let end = conclusion(&*placed, &clip);
        let said = format!("In frame 4, after a loss of 2 frames{unreported}, the region was found again");
        assert!(end.contains(&said), "{id}: {end}");
        assert!(end.contains("may be another object"), "{id}: {end}");
        // The truth says that it is one.
        let end = conclusion(&*set(id, &[]), &known);
        assert!(id == "camshift" || end.contains("another object or the background was found"), "{id}: {end}");
        assert!(!end.contains("may be another"), "{id}: {end}");
    }
    // A ball that comes out of a tunnel is the one that went in.
    assert!(!conclusion(&*set("particle-filter", &[]), &scene("tunnel")).contains("found again"));
}

#[test]
fn the_end_of_a_run_has_its_scores() {
    let (clip, estimator) = (scene("tunnel"), set("mean-shift", &[]));
    let of = RegionScores::of(&errors(&*estimator, &clip)).expect("true boxes");
    let end = conclusion(&*estimator, &clip);
    for score in [
        format!("mean overlap {:.3}", of.overlap),
        format!("success (AUC) {:.3}", of.success),
        format!("precision at 20 px {:.3}", of.precision),
        format!("{} failure", of.failures),
    ] {
        assert!(end.contains(&score), "{score}: {end}");
    }
}

#[test]
fn an_ellipse_is_filled_as_far_as_its_back_projection_is_that_of_the_first_frame() {
    let filled = |scene_id: &str| {
        steps(&*set("camshift", &[]), &scene(scene_id), "the hues of the object fill the ellipse").len()
    };
    let frames = |scene_id: &str| run(&*set("camshift", &[]), &scene(scene_id)).frames.len();
    let [balloon, leaves] = ["balloon", "leaves"].map(|id| (filled(id), frames(id)));
    assert!(2 * balloon.0 > balloon.1 && 2 * leaves.0 < leaves.1, "{balloon:?}, {leaves:?}");
    let all = steps(&*set("camshift", &[]), &scene("leaves"), "The second moments in the window");
    let last = all.last().map(|step| step.sentence.plain()).unwrap_or_default();
    assert!(last.contains("times the area of that in the first frame"), "{last}");
}

#[test]
fn a_loose_region_needs_the_background_weighted_histogram() {
    let leaves = scene("leaves");
    let [ignored, weighted] = ["ignored", "weighted"].map(|background| {
        let mean_shift = set("mean-shift", &[("region", "18,114,66,162"), ("background", background)]);
        overlap(&errors(&*mean_shift, &leaves), 1..36)
    });
    assert!(ignored < 0.45 && weighted > 0.65, "{ignored:.3}, weighted {weighted:.3}");
}

#[test]
fn a_region_without_extent_is_refused_by_its_size() {
    let mut mean_shift = set("mean-shift", &[]);
    let refusal = mean_shift.set("region", "50,100,50,100").unwrap_err().to_string();
    assert!(refusal.contains("region has 0 × 0 px") && refusal.contains("must differ"), "{refusal}");
    let refusal = mean_shift.set("region", "50,100,50").unwrap_err().to_string();
    assert!(refusal.contains("two opposite corners"), "{refusal}");
}

#[test]
fn a_size_that_stays_is_no_move() {
    let still = Clip::from_frames("still", vec![disc([30.0, 24.0], 1); 3]).expect("frames of one size");
    let mean_shift = set("mean-shift", &[("region", "21,15,39,33")]);
    let sizes = steps(&*mean_shift, &still, "with the larger one.");
    assert!(!sizes.is_empty());
    for step in sizes {
        let said = step.sentence.plain();
        let is_present = said.contains("The best is the present size");
        assert_eq!(is_present, said.contains("so the size stays"), "{said}");
        assert_eq!(is_present, !said.contains("of the way to it"), "{said}");
    }
}

#[test]
fn the_hill_that_mean_shift_climbs_has_its_coefficient_where_the_ellipse_is() {
    let (estimator, clip) = (set("mean-shift", &[]), scene("hand-held"));
    let mut walk = estimator.walk(&clip, 0).expect("a run");
    let mut compared = 0;
    for _ in 0..60 {
        walk.jump(Move::Granularity(2, Direction::Forward));
        let step = walk.step(None);
        let Some(surface) = step.readouts.iter().find_map(|readout| readout.landscape()) else { continue };
        let Some(coefficient) = common::fact(&step, "Bhattacharyya coefficient") else { continue };
        let shift = common::fact(&step, "Shift").expect("its number");
        // The first ellipse stands in the middle of a cell.
        if shift == "1" {
            let value = surface.interpolated(surface.trail[0]).expect("it is known");
            assert!((f64::from(value) - common::numbers(&coefficient)[0]).abs() < 6e-4, "{value}, not {coefficient}");
            compared += 1;
        }
    }
    assert!(compared > 4, "{compared}");
}
