//! How fast templates are matched and whole pictures aligned: `cargo bench -p motionscope-core --bench correspondence`.
//!
//! A template of 64×64 px over all places of a VGA picture, on one thread; then whole runs on a pair of frames.

use criterion::{Criterion, criterion_group, criterion_main};
use motionscope_core::base::Threads;
use motionscope_core::course::estimator;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::Grid;

fn clip((width, height): (usize, usize)) -> Clip {
    let wave = |x: f64, y: f64| {
        let part =
            |k: f64| (x * (0.1 + 0.03 * k) * (k * 0.7).cos() + y * (0.1 + 0.03 * k) * (k * 0.7).sin() + k * k).sin();
        (128.0 + 15.0 * (0..8).map(|k| part(f64::from(k))).sum::<f64>()) as u8
    };
    let frame = |t: f64| Frame::gray(Grid::from_fn(width, height, |x, y| wave(x as f64 - 0.6 * t, y as f64 + 0.4 * t)));
    Clip::from_frames("waves", vec![frame(0.0), frame(1.0)]).expect("two frames of one size")
}

fn templates(c: &mut Criterion) {
    let clip = clip((640, 480));
    for (score, method) in [("ssd", "auto"), ("zncc", "auto"), ("ncc", "auto"), ("sad", "direct"), ("ssd", "direct")] {
        let mut matching = estimator("template-matching").expect("it is there");
        for (name, value) in [("size", "64"), ("search-range", "1000"), ("score", score), ("method", method)] {
            matching.set(name, value).expect("in range");
        }
        c.bench_function(&format!("template-matching 64×64 over VGA, {score}, {method}, 1 thread"), |b| {
            b.iter(|| matching.run(&clip, 0, &Threads::single()).expect("a run"));
        });
    }
}

fn pictures(c: &mut Criterion) {
    let clip = clip((640, 480));
    for id in ["phase-correlation", "image-alignment"] {
        let whole = estimator(id).expect("it is there");
        c.bench_function(&format!("{id} VGA, 1 thread"), |b| {
            b.iter(|| whole.run(&clip, 0, &Threads::single()).expect("a run"));
        });
    }
}

criterion_group!(benches, templates, pictures);
criterion_main!(benches);
