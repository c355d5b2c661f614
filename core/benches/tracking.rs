//! How fast objects are followed: `cargo bench -p motionscope-core --bench tracking`.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use motionscope_core::base::{Error, Threads};
use motionscope_core::course::estimator;
use motionscope_core::data::{Clip, Detection, Flow, Frame, ObjectBox, Truth};
use motionscope_core::geometry::{Bounds, Grid};
use motionscope_core::methods::kalman::{Estimate, Sensor, Velocity};
use motionscope_core::products::ObjectField;
use motionscope_core::products::objects::score::scores;
use motionscope_core::synth;
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
        Detection { bounds: Bounds::around(center, [24.0, 60.0]), center, score: 0.9, blob: None, deviation_px: None }
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

/// True objects, by frame.
struct Objects(Vec<Vec<ObjectBox>>);

impl Truth for Objects {
    fn flow(&self, _t: usize) -> Result<Option<Arc<Flow>>, Error> {
        Ok(None)
    }

    fn objects(&self, t: usize) -> Result<Option<Vec<ObjectBox>>, Error> {
        Ok(self.0.get(t).cloned())
    }

    fn kinds(&self) -> Vec<&'static str> {
        vec!["objects"]
    }
}

/// A number of 0 to 1 that tells an object and a frame from all others.
fn chance(i: usize, t: usize) -> f32 {
    let mixed = (i as u64 * 0x9E37_79B9) ^ (t as u64 * 0x85EB_CA6B);
    (mixed.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 40) as f32 / (1u32 << 24) as f32
}

/// So many objects with their true places; they go straight on, or are anywhere in each frame.
fn throng(objects: usize, frames: usize, is_smooth: bool) -> Clip {
    let place = |i: usize, t: usize| match is_smooth {
        true => [0, 1].map(|k| [1920.0, 1080.0][k] * chance(i, k) + 4.0 * (chance(i, k + 2) - 0.5) * t as f32),
        false => [1920.0 * chance(i, 2 * t), 1080.0 * chance(i, 2 * t + 1)],
    };
    let size = |i: usize| [10.0 + 14.0 * chance(i, 91), 20.0 + 30.0 * chance(i, 92)];
    let object = |i: usize, t: usize| {
        let Bounds { min: [x, y], .. } = Bounds::around(place(i, t), size(i));
        let [width, height] = size(i);
        ObjectBox { id: i as u32 + 1, x, y, width, height, visibility: 1.0 }
    };
    let detection = |i: usize, t: usize| {
        let center = [0, 1].map(|k| place(i, t)[k] + 3.0 * chance(i, 2 * t + k + 50) - 1.5);
        Detection { bounds: Bounds::around(center, size(i)), center, score: 0.9, blob: None, deviation_px: None }
    };
    let truth = (0..frames).map(|t| (0..objects).map(|i| object(i, t)).collect()).collect();
    let found = (0..frames).map(|t| (0..objects).map(|i| detection(i, t)).collect()).collect();
    Clip::blank("throng", (1920, 1080), frames).with_detections(found).with_truth(Arc::new(Objects(truth)))
}

/// Very many detections, tracked and scored: a frame takes a tenth of what is shown.
fn many(c: &mut Criterion) {
    const FRAMES: usize = 10;
    let pool = Threads::single();
    let mut group = c.benchmark_group("many");
    group.sample_size(10);
    for (name, is_smooth) in [("smooth", true), ("scattered", false)] {
        let clip = throng(5000, FRAMES, is_smooth);
        let truth = clip.truth().expect("exact");
        for id in ["kalman-tracker", "blob-tracker", "trajectory-analysis"] {
            let tracker = estimator(id).expect("it is registered");
            group.bench_function(format!("{id}, 5000 {name} detections with truth, {FRAMES} frames"), |b| {
                b.iter(|| {
                    let output = tracker.run(&clip, 0, &pool).expect("a run");
                    scores(output.get::<ObjectField>().expect("objects"), &**truth).expect("readable")
                });
            });
        }
    }
    group.finish();
}

/// Four objects that cross, and five false alarms anywhere in each frame.
fn cluttered(frames: usize) -> Clip {
    let detection = |center: [f32; 2]| Detection {
        bounds: Bounds::around(center, [20.0; 2]),
        center,
        score: 0.9,
        blob: None,
        deviation_px: None,
    };
    let object = |i: usize, t: usize| {
        let (far, turn) = (6.0 * (t as f32 - frames as f32 / 2.0), i as f32 * 1.6 + 0.3);
        let off = [0, 1].map(|k| 4.0 * chance(i, 2 * t + k) - 2.0);
        detection([160.0 + far * turn.cos() + off[0], 120.0 + far * turn.sin() + off[1]])
    };
    let wrong = |i: usize, t: usize| detection([320.0 * chance(i + 9, 2 * t), 240.0 * chance(i + 9, 2 * t + 1)]);
    let frame = |t: usize| (0..4).map(|i| object(i, t)).chain((0..5).map(|i| wrong(i, t))).collect();
    Clip::blank("cluttered", (320, 240), frames).with_detections((0..frames).map(frame).collect())
}

/// Trackers that weigh several explanations, for all scans.
fn ambiguous(c: &mut Criterion) {
    const SCANS: usize = 20;
    let (clip, pool) = (cluttered(SCANS), Threads::single());
    for id in ["multiple-hypothesis", "joint-probabilistic"] {
        let mut tracker = estimator(id).expect("it is registered");
        tracker.set("false-alarms", "5").expect("in range");
        c.bench_function(&format!("{id}, 4 targets, 5 false alarms, {SCANS} scans"), |b| {
            b.iter(|| tracker.run(&clip, 0, &pool).expect("a run"));
        });
    }
}

/// An object of 64×64 px that moves by 3 px/frame before a background, both with colour and texture.
fn region(frames: usize) -> Clip {
    let frame = |t: usize| {
        let left = 200 + 3 * t;
        Frame::rgb(Grid::from_fn(640, 480, |x, y| {
            let shade = (60.0 * chance(x, y)) as u8;
            let is_inside = (left..left + 64).contains(&x) && (180..244).contains(&y);
            if is_inside { [180 + shade, 40 + shade, 60] } else { [80 + shade, 110, 60 + shade] }
        }))
    };
    Clip::from_frames("region", (0..frames).map(frame).collect()).expect("frames of one size")
}

/// Trackers of one region, for each frame but the first, which has its start.
fn of_one_region(c: &mut Criterion) {
    const FRAMES: usize = 21;
    let (clip, pool) = (region(FRAMES), Threads::single());
    for (id, settings) in [
        ("mean-shift", &[][..]),
        ("camshift", &[]),
        ("particle-filter", &[("particles", "1000")]),
        ("correlation-filter", &[]),
    ] {
        let mut tracker = estimator(id).expect("it is registered");
        tracker.set("region", "199.5,179.5,263.5,243.5").expect("a region");
        settings.iter().for_each(|(name, value)| tracker.set(name, value).expect("in range"));
        c.bench_function(&format!("{id}, 64×64 px, VGA, {} frames", FRAMES - 1), |b| {
            b.iter(|| tracker.run(&clip, 0, &pool).expect("a run"));
        });
    }
}

/// Alignment of a template of 64×64 px that moves by 3 px/frame with its texture, for each frame but the first.
fn template(c: &mut Criterion) {
    const FRAMES: usize = 21;
    let waves =
        |x: f32, y: f32| 60.0 * (0.31 * x).sin() * (0.27 * y + 0.05 * x).cos() + 20.0 * (0.83 * y - 0.4 * x).sin();
    let frame = |t: usize| {
        let left = 200 + 3 * t;
        Frame::gray(Grid::from_fn(640, 480, |x, y| {
            let is_inside = (left..left + 64).contains(&x) && (180..244).contains(&y);
            let [u, v] = [x as f32, y as f32];
            let level =
                if is_inside { 140.0 + waves(u - left as f32, v) } else { 80.0 + 0.5 * waves(1.3 * u, 0.7 * v) };
            (level + 8.0 * chance(x, y)) as u8
        }))
    };
    let clip = Clip::from_frames("template", (0..FRAMES).map(frame).collect()).expect("frames of one size");
    let pool = Threads::single();
    for update in ["none", "drift-corrected"] {
        let mut tracker = estimator("template-tracker").expect("it is registered");
        tracker.set("region", "199.5,179.5,263.5,243.5").expect("a region");
        tracker.set("update", update).expect("a choice");
        c.bench_function(&format!("template-tracker, update {update}, 64×64 px, VGA, {} frames", FRAMES - 1), |b| {
            b.iter(|| tracker.run(&clip, 0, &pool).expect("a run"));
        });
    }
}

/// The pose of a turning box, for each frame but the first.
fn pose(c: &mut Criterion) {
    const FRAMES: usize = 21;
    let scene = synth::scene("turning-box").expect("a scene");
    let clip = scene.clip(&scene.difficulty()).expect("a clip");
    let pool = Threads::single();
    for weighting in ["equal", "robust"] {
        let mut tracker = estimator("rapid").expect("it is registered");
        tracker.set("frames", &FRAMES.to_string()).expect("in range");
        tracker.set("weighting", weighting).expect("a choice");
        c.bench_function(&format!("rapid, weighting {weighting}, 320×240 px, {} frames", FRAMES - 1), |b| {
            b.iter(|| tracker.run(&clip, 0, &pool).expect("a run"));
        });
    }
}

/// A contour around a bright disc, of 100 points where it has points. The viscosity is so high that it does not converge in 100 iterations; a frame of these is to
/// take 2 ms at most. The greedy one converges earlier.
fn contours(c: &mut Criterion) {
    const FRAMES: usize = 11;
    let frame = |t: usize| {
        let center = [300.0 + t as f32, 240.0];
        Frame::gray(Grid::from_fn(640, 480, |x, y| {
            let is_inside = (x as f32 - center[0]).hypot(y as f32 - center[1]) < 64.0;
            (20.0 * chance(x, y)) as u8 + if is_inside { 170 } else { 60 }
        }))
    };
    let clip = Clip::from_frames("disc", (0..FRAMES).map(frame).collect()).expect("frames of one size");
    let corner = |i: usize| {
        let (sin, cos) = (i as f32 / 100.0 * std::f32::consts::TAU).sin_cos();
        format!("{:.2},{:.2}", 300.0 + 63.6 * cos, 240.0 + 63.6 * sin)
    };
    let contour = (0..100).map(corner).collect::<Vec<_>>().join(" ");
    let pool = Threads::single();
    for (id, settings) in [
        ("active-contour", &[("gamma", "5"), ("epsilon", "0.001"), ("force", "gradient")][..]),
        ("active-contour", &[("gamma", "5"), ("epsilon", "0.001"), ("force", "gradient-vector-flow")]),
        ("greedy-contour", &[]),
        ("chan-vese", &[]),
    ] {
        let mut tracker = estimator(id).expect("it is registered");
        let own = [("contour", contour.as_str()), ("iterations", "100")];
        let spaced = (id != "chan-vese").then_some(("spacing", "4"));
        own.iter().chain(&spaced).chain(settings).for_each(|(name, value)| tracker.set(name, value).expect("in range"));
        let force = settings.last().map_or("", |(_, value)| *value);
        c.bench_function(&format!("{id} {force}, 100 points, up to 100 iterations, {FRAMES} frames"), |b| {
            b.iter(|| tracker.run(&clip, 0, &pool).expect("a run"));
        });
    }
}

criterion_group!(benches, filter, tracker, ambiguous, many, of_one_region, template, pose, contours);
criterion_main!(benches);
