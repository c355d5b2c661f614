//! How fast optical flow and the detection of corners are: `cargo bench -p motionscope-core --bench optical_flow`.
//!
//! A smooth texture that moves by (0.6, −0.4) px, on one and on two threads. All with their defaults, and Horn and Schunck's method
//! also as in the paper: 100 Jacobi iterations, no pyramid.

use criterion::{Criterion, criterion_group, criterion_main};
use motionscope_core::base::Threads;
use motionscope_core::course::{estimator, estimators};
use motionscope_core::data::{Clip, Frame};
use motionscope_core::families::interest_points::Harris;
use motionscope_core::geometry::Grid;

fn clip(width: usize, height: usize) -> Clip {
    let wave = |x: f64, y: f64| {
        let part =
            |k: f64| (x * (0.1 + 0.03 * k) * (k * 0.7).cos() + y * (0.1 + 0.03 * k) * (k * 0.7).sin() + k * k).sin();
        (128.0 + 15.0 * (0..8).map(|k| part(f64::from(k))).sum::<f64>()) as u8
    };
    let frame = |t: f64| Frame::gray(Grid::from_fn(width, height, |x, y| wave(x as f64 - 0.6 * t, y as f64 + 0.4 * t)));
    Clip::from_frames("waves", vec![frame(0.0), frame(1.0)]).expect("two frames of one size")
}

/// How fast features are tracked when nobody has to find them first, as in the figure of OpenCV that it is held against.
fn tracking(c: &mut Criterion) {
    let mut estimator = estimator("pyramidal-lucas-kanade").expect("it is there");
    estimator.set("points", "grid").expect("in range");
    let clip = clip(640, 480);
    c.bench_function("pyramidal-lucas-kanade VGA on a grid, 1 thread(s)", |b| {
        b.iter(|| estimator.run(&clip, 0, &Threads::single()).expect("a run"));
    });
}

/// How fast responses are worked out, without the choice of peaks among them.
fn responses(c: &mut Criterion) {
    let picture = clip(640, 480).frame(0).expect("a frame");
    for threads in [1, 2] {
        let pool = Threads::new(threads).expect("threads");
        c.bench_function(&format!("harris, map of responses alone VGA {threads} thread(s)"), |b| {
            b.iter(|| Harris::default().responses(picture.luma(), &pool));
        });
    }
}

/// Horn and Schunck's method as in the paper.
fn paper(c: &mut Criterion) {
    let mut estimator = estimator("horn-schunck").expect("it is there");
    for (name, value) in [("levels", "1"), ("warps", "1"), ("solver", "jacobi"), ("iterations", "100")] {
        estimator.set(name, value).expect("in range");
    }
    let clip = clip(640, 480);
    for threads in [1, 2] {
        let pool = Threads::new(threads).expect("threads");
        c.bench_function(&format!("horn-schunck as in the paper VGA {threads} thread(s)"), |b| {
            b.iter(|| estimator.run(&clip, 0, &pool).expect("a run"));
        });
    }
}

fn whole_runs(c: &mut Criterion) {
    for (name, width, height) in [("VGA", 640, 480), ("1080p", 1920, 1080)] {
        let clip = clip(width, height);
        for estimator in estimators().into_iter().filter(|e| e.info().family != "Block matching") {
            for threads in [1, 2] {
                let pool = Threads::new(threads).expect("threads");
                c.bench_function(&format!("{} {name} {threads} thread(s)", estimator.info().id), |b| {
                    b.iter(|| estimator.run(&clip, 0, &pool).expect("a run"));
                });
            }
        }
    }
}

criterion_group!(benches, tracking, responses, paper, whole_runs);
criterion_main!(benches);
