//! How fast motion segmentation is: `cargo bench -p motionscope-core --bench motion_segmentation`.
//!
//! The scene of rigid layers in VGA with its true flow, on one and on two threads: an iteration of k-means with four clusters on a flow with
//! noise, and whole runs.

use std::sync::Arc;

use criterion::{Criterion, criterion_group, criterion_main};
use motionscope_core::base::Threads;
use motionscope_core::course::estimator;
use motionscope_core::data::Clip;
use motionscope_core::methods::segmentation::points::{Place, Points};
use motionscope_core::params::Params;
use motionscope_core::synth;

fn clip() -> Clip {
    let scene = synth::scene("rigid-layers").expect("a bundled scene");
    let mut difficulty = scene.difficulty();
    for (name, value) in [("width", "640"), ("height", "480"), ("frames", "2")] {
        difficulty.set(name, value).expect("in range");
    }
    scene.clip(&difficulty).expect("a clip")
}

/// The displacements of the true flow with a deterministic disturbance of up to half a px, so that no cluster is a single point.
fn points(clip: &Clip) -> Points {
    let flow: Arc<_> = clip.truth().expect("truth").flow(0).expect("readable").expect("a flow");
    let part = |i: usize| {
        let off = |k: usize| ((k * 7919) % 1000) as f32 / 1000.0 - 0.5;
        flow.0.cells().iter().enumerate().map(|(k, uv)| uv[i] + off(k + 500 * i)).collect()
    };
    Points::new(vec![part(0), part(1)])
}

fn iteration(c: &mut Criterion) {
    let points = points(&clip());
    let means: [Place; 4] = [[2.0, 1.0], [-2.0, 0.5], [0.5, -1.0], [0.0, 0.0]].map(|[u, v]| [u, v, 0.0, 0.0, 0.0, 0.0]);
    let mut nearest = vec![0; points.len()];
    for threads in [1, 2] {
        let pool = Threads::new(threads).expect("threads");
        c.bench_function(&format!("k-means, an iteration VGA k = 4 {threads} thread(s)"), |b| {
            b.iter(|| {
                let tally = points.assign(&means, &mut nearest, &pool);
                [0, 1, 2, 3].map(|j| tally.mean(j))
            });
        });
    }
}

fn whole_runs(c: &mut Criterion) {
    let clip = clip();
    // Rendering the truth is no part of it.
    clip.truth().expect("truth").flow(0).expect("readable");
    for (id, method) in [
        ("motion-clustering", Some("k-means")),
        ("motion-clustering", Some("gaussian-mixture")),
        ("motion-clustering", Some("mean-shift")),
        ("motion-layers", None),
        ("flow-segmentation", Some("graph")),
        ("flow-segmentation", Some("region-growing")),
    ] {
        let mut estimator = estimator(id).expect("it is there");
        estimator.set("flow-source", "truth").expect("a choice");
        method.into_iter().for_each(|method| estimator.set("method", method).expect("a choice"));
        for threads in [1, 2] {
            let pool = Threads::new(threads).expect("threads");
            let name = method.map_or_else(String::new, |method| format!(" {method}"));
            c.bench_function(&format!("{id}{name} VGA {threads} thread(s)"), |b| {
                b.iter(|| estimator.run(&clip, 0, &pool).expect("a run"));
            });
        }
    }
}

criterion_group!(benches, iteration, whole_runs);
criterion_main!(benches);
