//! How fast interest points are detected: `cargo bench -p motionscope-core --bench interest_points`.
//!
//! Without limits of distance and number, as the peers that they are held against; ORB with its defaults.

use criterion::{Criterion, criterion_group, criterion_main};
use motionscope_core::base::Threads;
use motionscope_core::course::estimator;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::{Gray, Grid};
use motionscope_core::products::PointField;

/// Smooth noise on several scales with some edges.
fn texture(width: usize, height: usize) -> Gray {
    let hash = |x: usize, y: usize, scale: usize| {
        let mixed = (x as u64 * 0x9E37_79B9) ^ (y as u64 * 0x85EB_CA6B) ^ (scale as u64 * 0xC2B2_AE35);
        ((mixed.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 40) & 255) as f32
    };
    let smooth = |x: usize, y: usize, scale: usize| {
        let (fx, fy) = ((x % scale) as f32 / scale as f32, (y % scale) as f32 / scale as f32);
        let at = |i: usize, j: usize| hash(x / scale + i, y / scale + j, scale);
        let top = at(0, 0) + (at(1, 0) - at(0, 0)) * fx;
        let bottom = at(0, 1) + (at(1, 1) - at(0, 1)) * fx;
        top + (bottom - top) * fy
    };
    Grid::from_fn(width, height, |x, y| {
        (0.4 * smooth(x, y, 32) + 0.35 * smooth(x, y, 8) + 0.25 * smooth(x, y, 4)) as u8
    })
}

fn detectors(c: &mut Criterion) {
    let vga = ("VGA", 640, 480);
    let all = [("max-points", "100000")];
    for (id, (name, width, height), settings) in [
        ("fast", vga, &[("max-points", "100000"), ("min-distance", "0")][..]),
        ("fast", ("1080p", 1920, 1080), &[("max-points", "100000"), ("min-distance", "0")]),
        ("sift", vga, &all),
        ("surf", vga, &all),
        ("surf", vga, &[("max-points", "1024")]),
        ("orb", vga, &[]),
    ] {
        let clip = Clip::from_frames("texture", vec![Frame::gray(texture(width, height))]).expect("a frame");
        let mut estimator = estimator(id).expect("it is registered");
        settings.iter().for_each(|(name, value)| estimator.set(name, value).expect("in range"));
        let run = || estimator.run(&clip, 0, &Threads::single()).expect("a run");
        let points = run().get::<PointField>().expect("points").points.len();
        c.bench_function(&format!("{id} {name}, {points} points, 1 thread"), |b| b.iter(run));
    }
}

criterion_group!(benches, detectors);
criterion_main!(benches);
