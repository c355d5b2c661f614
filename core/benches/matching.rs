//! How fast keypoints are found, matched and explained by one model: `cargo bench -p motionscope-core --bench matching`.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use motionscope_core::correspondence::{EpipolarGeometry, GlobalMotion};
use motionscope_core::geometric::{Correspondence, robust::Robust};
use motionscope_core::{Clip, Params, Threads, estimator, synth};

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

fn models(c: &mut Criterion) {
    let plane = matches(|[x, y]| {
        let w = 1.0 + 3e-4 * x - 1e-4 * y;
        [(0.9 * x + 0.1 * y + 12.0) / w, (1.05 * y - 0.08 * x + 5.0) / w]
    });
    let homography = Robust(GlobalMotion::default());
    c.bench_function("homography, 1000 matches, 30 % outliers", |b| b.iter(|| homography.estimate(black_box(&plane))));
    // A camera that moves sideways and forward past points at different depths.
    let scene = matches(|[x, y]| {
        let depth = 4.0 + 3.0 * ((0.13 * x).sin() * (0.17 * y).cos());
        let scale = depth / (depth - 0.2);
        [320.0 + scale * (x - 320.0) + 60.0 / depth, 240.0 + scale * (y - 240.0)]
    });
    let fundamental = Robust(EpipolarGeometry::default());
    c.bench_function("fundamental matrix, 1000 matches, 30 % outliers", |b| {
        b.iter(|| fundamental.estimate(black_box(&scene)));
    });
}

criterion_group!(benches, keypoints, models);
criterion_main!(benches);
