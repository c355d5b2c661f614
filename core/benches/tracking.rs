//! How fast objects are followed: `cargo bench -p motionscope-core --bench tracking`.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use motionscope_core::kalman::{Estimate, Sensor, Velocity};
use motionscope_core::{Bounds, Clip, Detection, Threads, estimator};
use nalgebra::{SMatrix, Vector2, Vector4};

/// A time step and a measurement of a filter with four numbers, of which two are measured.
fn filter(c: &mut Criterion) {
    let (motion, sensor) = (Velocity { acceleration: 0.5 }, Sensor::<4, 2>::first([2.0; 2]));
    let first = Estimate { state: Vector4::new(10.0, 20.0, 1.0, -1.0), covariance: SMatrix::identity() * 25.0 };
    c.bench_function("Kalman predict and update, 4 states, 2 measured", |b| {
        b.iter(|| {
            let expected = black_box(&first).predicted(&motion).estimate;
            let innovation = expected.innovation(&sensor, &Vector2::new(11.5, 18.5)).expect("sound");
            expected.updated(&sensor, &innovation).estimate
        });
    });
}

/// So many objects that go their ways, each detected in every frame.
fn crowd(objects: usize, frames: usize) -> Clip {
    let detection = |i: usize, t: usize| {
        let (x, y) = (20.0 + 60.0 * (i % 20) as f32, 40.0 + 70.0 * (i / 20) as f32);
        let turn = i as f32 * 2.4;
        let off = 0.7 * ((i * 31 + t * 17) % 7) as f32 - 2.1;
        let center = [x + 3.0 * t as f32 * turn.cos() + off, y + 3.0 * t as f32 * turn.sin() - off];
        Detection { bounds: Bounds::around(center, [24.0, 60.0]), center, score: 0.9, blob: None }
    };
    let all = (0..frames).map(|t| (0..objects).map(|i| detection(i, t)).collect()).collect();
    Clip::blank("crowd", (1280, 800), frames).with_detections(all)
}

fn tracker(c: &mut Criterion) {
    const FRAMES: usize = 20;
    let (clip, pool) = (crowd(200, FRAMES), Threads::single());
    for id in ["kalman-tracker", "blob-tracker"] {
        let tracker = estimator(id).expect("it is registered");
        c.bench_function(&format!("{id}, 200 objects, {FRAMES} frames"), |b| {
            b.iter(|| tracker.run(&clip, 0, &pool).expect("a run"));
        });
    }
}

criterion_group!(benches, filter, tracker);
criterion_main!(benches);
