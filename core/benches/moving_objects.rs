//! How fast moving objects are detected: `cargo bench -p motionscope-core --bench moving_objects`.
//!
//! A whole run over 60 frames with noise in which five discs move, so a frame takes a 60th of what is shown; and connected
//! components with their statistics alone.

use std::sync::Arc;
use std::time::Instant;

use criterion::{Criterion, criterion_group, criterion_main};
use motionscope_core::base::{Error, Stop, Threads};
use motionscope_core::course::{estimator, estimators};
use motionscope_core::data::{Clip, ClipInfo, Connectivity, Frame, FrameSource, Labelling, Mask};
use motionscope_core::geometry::{Gray, Grid};
use motionscope_core::run::{Cursor, Guarantee, Move};

const FRAMES: usize = 60;

fn value(x: usize, y: usize, t: usize) -> u8 {
    let mixed = (x as u64 * 0x9E37_79B9) ^ (y as u64 * 0x85EB_CA6B) ^ (t as u64 * 0xC2B2_AE35);
    let noise = (0..4).map(|k| (mixed.wrapping_mul(0x2545_F491_4F6C_DD1D) >> (24 + 8 * k)) & 15).sum::<u64>() / 4;
    let is_object = (0..5).any(|k| {
        let (cx, cy) = (40.0 + 110.0 * k as f32 + 1.7 * t as f32, 60.0 + 80.0 * k as f32 - 0.6 * t as f32);
        (x as f32 - cx).hypot(y as f32 - cy) < 28.0
    });
    let base = if is_object { 210 } else { 60 + (x / 9 + y / 7) % 64 };
    base as u8 + noise as u8
}

fn clip(size: (usize, usize), in_color: bool) -> Clip {
    clip_of(size, in_color, FRAMES)
}

fn clip_of((width, height): (usize, usize), in_color: bool, frames: usize) -> Clip {
    let frame = |t| {
        let gray = Grid::from_fn(width, height, |x, y| value(x, y, t));
        if in_color { Frame::rgb(gray.map(|&v| [v, v / 2 + 40, 255 - v])) } else { Frame::gray(gray) }
    };
    Clip::from_frames("discs", (0..frames).map(frame).collect()).expect("frames of one size")
}

fn detection(c: &mut Criterion) {
    for (name, in_color) in [("gray", false), ("colour", true)] {
        let clip = clip((640, 480), in_color);
        for estimator in estimators().into_iter().filter(|e| e.guarantee() == Guarantee::Objects) {
            for threads in [1, 2] {
                let pool = Threads::new(threads).expect("threads");
                let id = estimator.info().id;
                c.bench_function(&format!("{id} VGA {name}, {FRAMES} frames, {threads} thread(s)"), |b| {
                    b.iter(|| estimator.run(&clip, 0, &pool).expect("a run"));
                });
            }
        }
    }
}

fn components(c: &mut Criterion) {
    let picture: Gray = Grid::from_fn(640, 480, |x, y| value(x, y, 0));
    let few = Mask::from_fn(640, 480, |x, y| picture[(x, y)] > 180);
    // Blotches of some pixels each, several hundred of them.
    let wave = |x: usize, y: usize, k: f64| (x as f64 * (0.2 + 0.13 * k) + y as f64 * (0.31 - 0.17 * k) + k * k).sin();
    let many = Mask::from_fn(640, 480, |x, y| (0..5).map(|k| wave(x, y, f64::from(k))).sum::<f64>() > 1.0);
    for (name, mask) in [("5 objects", &few), ("a texture", &many)] {
        let count = Labelling::of(mask, Connectivity::Eight).finals().count;
        c.bench_function(&format!("connected components with statistics VGA, {name}, {count}"), |b| {
            b.iter(|| {
                let labelling = Labelling::of(mask, Connectivity::Eight);
                let finals = labelling.finals();
                (finals.detections(&labelling, &picture), finals.grid(&labelling, mask.size()))
            });
        });
        c.bench_function(&format!("opening and closing VGA, {name}"), |b| {
            b.iter(|| mask.opened(1).closed(2));
        });
    }
}

/// Pictures that come again and again.
struct Round(Vec<Arc<Frame>>);

impl FrameSource for Round {
    fn frame(&self, index: usize, _stop: &Stop) -> Result<Arc<Frame>, Error> {
        Ok(Arc::clone(&self.0[index % self.0.len()]))
    }

    fn cached(&self, index: usize) -> Option<Arc<Frame>> {
        self.0.get(index % self.0.len()).cloned()
    }
}

/// How long it takes to be anywhere in a long clip that was gone through once.
fn scrubbing(c: &mut Criterion) {
    const LONG: usize = 1000;
    const JUMPS: usize = 200;
    let short = clip((640, 480), false);
    let pictures = (0..FRAMES).map(|t| short.frame(t).expect("it is there")).collect();
    let info = ClipInfo { frames: Some(LONG), ..short.info().clone() };
    let long = Clip::new(info, Arc::new(Round(pictures)));
    for id in ["frame-difference", "single-gaussian", "mixture-of-gaussians", "kalman-tracker"] {
        let mut estimator = estimator(id).expect("it is registered");
        estimator.set("frames", &LONG.to_string()).expect("it is allowed");
        let mut walk = estimator.walk(&long, 0).expect("a run");
        walk.jump(Move::End);
        let mut at = 0;
        let mut jump = || {
            at = (at + 7919) % LONG;
            let begun = Instant::now();
            walk.jump(Move::To(Cursor { unit: at, event: usize::MAX }));
            begun.elapsed().as_secs_f64() * 1e3
        };
        let times: Vec<f64> = (0..JUMPS).map(|_| jump()).collect();
        let (mean, worst) = (times.iter().sum::<f64>() / JUMPS as f64, times.iter().copied().fold(0.0, f64::max));
        println!("{id} VGA, {LONG} frames, {JUMPS} jumps: mean {mean:.1} ms, worst {worst:.1} ms");
        c.bench_function(&format!("{id} VGA, anywhere in {LONG} frames"), |b| b.iter(&mut jump));
    }
}

/// Mixtures on large pictures: a frame takes an eighth of what is shown.
fn large(c: &mut Criterion) {
    const LARGE: usize = 8;
    let mut group = c.benchmark_group("large");
    group.sample_size(10);
    for (name, in_color) in [("gray", false), ("colour", true)] {
        let clip = clip_of((3840, 2160), in_color, LARGE);
        let mixture = estimator("mixture-of-gaussians").expect("it is registered");
        for threads in [1, 2] {
            let pool = Threads::new(threads).expect("threads");
            group.bench_function(format!("mixture-of-gaussians 4K {name}, {LARGE} frames, {threads} thread(s)"), |b| {
                b.iter(|| mixture.run(&clip, 0, &pool).expect("a run"));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, components, detection, large, scrubbing);
criterion_main!(benches);
