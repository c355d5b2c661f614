//! How fast keypoints are found, matched and explained by one model, and how accurate the models are: `cargo bench -p motionscope-core --bench
//! matching`.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use motionscope_core::base::Threads;
use motionscope_core::course::estimator;
use motionscope_core::data::Clip;
use motionscope_core::families::correspondence::{EpipolarGeometry, GlobalMotion};
use motionscope_core::methods::geometric::Correspondence;
use motionscope_core::methods::geometric::epipolar::{line, line_back};
use motionscope_core::methods::geometric::robust::Robust;
use motionscope_core::params::Params;
use motionscope_core::products::model::mapped;
use motionscope_core::synth;

fn vga() -> Clip {
    let scene = synth::scene("pillar").expect("a scene");
    let mut difficulty = scene.difficulty();
    for (name, value) in [("width", "640"), ("height", "480"), ("frames", "2")] {
        difficulty.set(name, value).expect("in range");
    }
    synth::make(scene.id, &difficulty).expect("a clip")
}

fn keypoints(c: &mut Criterion) {
    let (clip, pool) = (vga(), Threads::single());
    for (id, settings) in [("sift", &[("max-points", "100000")][..]), ("feature-matching", &[])] {
        let mut method = estimator(id).expect("it is there");
        settings.iter().for_each(|(name, value)| method.set(name, value).expect("in range"));
        c.bench_function(&format!("{id}, 640×480"), |b| {
            b.iter(|| method.run(black_box(&clip), 0, &pool).expect("a run"))
        });
    }
}

/// Pseudorandom numbers from 0 to 1.
fn random(i: usize, k: usize) -> f64 {
    let h = (i as u64 * 31 + k as u64 * 17 + 7).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    ((h ^ (h >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9) >> 40) as f64 / (1u64 << 24) as f64
}

/// A thousand matches of `map` with noise of 0.5 px, three in ten of them random.
fn matches(map: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<Correspondence> {
    let one = |i: usize| {
        let from = [640.0 * random(i, 0), 480.0 * random(i, 1)];
        let [x, y] = map(from);
        let normal = |k: usize| (0..12).map(|j| random(i, 20 * k + j)).sum::<f64>() - 6.0;
        let to = match i % 10 < 3 {
            true => [640.0 * random(i, 2), 480.0 * random(i, 3)],
            false => [x + 0.5 * normal(4), y + 0.5 * normal(5)],
        };
        Correspondence { from, to }
    };
    (0..1000).map(one).collect()
}

/// The homography of the peers' task.
const PLANE: [[f64; 3]; 3] = [[1.05, 0.03, 12.0], [-0.02, 0.97, -8.0], [4e-5, -3e-5, 1.0]];

/// Mean distance in px of the corners of the picture from where they belong.
fn corner_error(matrix: &[[f64; 3]; 3]) -> f64 {
    let corners = [[0.0, 0.0], [639.0, 0.0], [639.0, 479.0], [0.0, 479.0]];
    let off = corners.map(|corner| {
        let [a, b] = [matrix, &PLANE].map(|matrix| mapped(matrix, corner).expect("before the horizon"));
        (a[0] - b[0]).hypot(a[1] - b[1])
    });
    off.iter().sum::<f64>() / 4.0
}

/// Mean distance in px of exact points from the epipolar lines of their partners, in both frames.
fn epipolar_error(matrix: &[[f64; 3]; 3], exact: &[Correspondence]) -> f64 {
    let off = exact.iter().map(|m| {
        let of = |[a, b, c]: [f64; 3], [x, y]: [f64; 2]| (a * x + b * y + c).abs() / a.hypot(b);
        0.5 * (of(line(matrix, m.from), m.to) + of(line_back(matrix, m.to), m.from))
    });
    off.sum::<f64>() / exact.len() as f64
}

fn models(c: &mut Criterion) {
    let plane = matches(|from| mapped(&PLANE, from).expect("before the horizon"));
    let mut homography = Robust(GlobalMotion::default());
    homography.set("confidence", "0.995").expect("in range");
    let found = homography.estimate(&plane).fitted.expect("an estimate");
    println!("homography: mean corner error {:.3} px, {} inliers", corner_error(&found.matrix), found.score.inliers);
    c.bench_function("homography, 1000 matches, 30 % outliers", |b| b.iter(|| homography.estimate(black_box(&plane))));
    // A camera that moves sideways and forward past points at different depths.
    let moved = |[x, y]: [f64; 2]| {
        let depth = 4.0 + 3.0 * ((0.13 * x).sin() * (0.17 * y).cos());
        let scale = depth / (depth - 0.2);
        [320.0 + scale * (x - 320.0) + 60.0 / depth, 240.0 + scale * (y - 240.0)]
    };
    let scene = matches(moved);
    let exact: Vec<_> = scene.iter().map(|m| Correspondence { from: m.from, to: moved(m.from) }).collect();
    let mut fundamental = Robust(EpipolarGeometry::default());
    fundamental.set("confidence", "0.995").expect("in range");
    let found = fundamental.estimate(&scene).fitted.expect("an estimate");
    let error = epipolar_error(&found.matrix, &exact);
    println!("fundamental matrix: mean distance from epipolar lines {error:.3} px, {} inliers", found.score.inliers);
    c.bench_function("fundamental matrix, 1000 matches, 30 % outliers", |b| {
        b.iter(|| fundamental.estimate(black_box(&scene)));
    });
}

criterion_group!(benches, keypoints, models);
criterion_main!(benches);
