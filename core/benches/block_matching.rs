//! How fast the block searches are: `cargo bench -p motionscope-core --bench block_matching`.
//!
//! 16×16 blocks, ±16 px, SAD, candidates inside the picture, on a texture that moves by (7, −5) px:
//! whole runs on one and on two threads, and one step back in the middle of a walk.

use criterion::{Criterion, criterion_group, criterion_main};
use motionscope_core::base::Threads;
use motionscope_core::course::estimators;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::Grid;
use motionscope_core::run::{AnyEstimator, Cursor, Direction, Move};

fn clip(width: usize, height: usize) -> Clip {
    let texture = |x: i64, y: i64| {
        let hash = |x: i64, y: i64| {
            let h = (x.wrapping_mul(0x9E37_79B9) ^ y.wrapping_mul(0x85EB_CA6B)).wrapping_mul(0x2545_F491_4F6C_DD1D);
            (h >> 40) & 0xff
        };
        ((hash(x / 4, y / 4) * 3 + hash(x, y)) / 4) as u8
    };
    let frame = |(u, v): (i64, i64)| {
        Frame::gray(Grid::from_fn(width, height, |x, y| texture(x as i64 + 4096 - u, y as i64 + 4096 - v)))
    };
    Clip::from_frames("texture", vec![frame((0, 0)), frame((7, -5))]).expect("two frames of one size")
}

fn block_searches() -> impl Iterator<Item = Box<dyn AnyEstimator>> {
    estimators().into_iter().filter(|estimator| estimator.info().family == "Block matching")
}

fn whole_runs(c: &mut Criterion) {
    for (name, width, height) in [("VGA", 640, 480), ("1080p", 1920, 1080)] {
        let clip = clip(width, height);
        for estimator in block_searches() {
            for threads in [1, 2] {
                let pool = Threads::new(threads).expect("threads");
                c.bench_function(&format!("{} {name} {threads} thread(s)", estimator.info().id), |b| {
                    b.iter(|| estimator.run(&clip, 0, &pool).expect("a run"));
                });
            }
        }
    }
}

fn steps_back(c: &mut Criterion) {
    let clip = clip(1920, 1080);
    for estimator in block_searches() {
        let mut walk = estimator.walk(&clip, 0).expect("a walk");
        let innermost = walk.info().granularities.len() - 1;
        c.bench_function(&format!("{} 1080p one step back over a unit's start", walk.info().id), |b| {
            walk.jump(Move::End);
            b.iter(|| {
                let unit = walk.cursor().unit;
                // From the first event of a unit to the last of the one before: that unit must be run again.
                walk.jump(Move::To(Cursor { unit: if unit < 3 { 4000 } else { unit }, event: 1 }));
                walk.jump(Move::Granularity(innermost, Direction::Back));
                (walk.step(None), walk.scene(None))
            });
        });
    }
}

criterion_group!(benches, whole_runs, steps_back);
criterion_main!(benches);
