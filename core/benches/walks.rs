//! How long it takes to see the last step, against the run alone: `cargo bench --workspace --bench walks`.
//!
//! A run on one thread beside a walk to its end with the explanation of the last step, both on the same frames at 640×480: the shortest
//! times of several, and their ratio. A walk may take twice as long; `core/tests/laws/runs.rs` counts the work. Names of estimators after `--`
//! take the place of the usual ones, `all` stands for all.

use std::time::{Duration, Instant};

use motionscope_core::base::Threads;
use motionscope_core::course::{estimator, estimators};
use motionscope_core::data::{Clip, Frame};
use motionscope_core::params::Params;
use motionscope_core::run::{AnyEstimator, Move};
use motionscope_core::synth;

/// The variational methods, and one of each kind of run: by blocks, by rows, by frames.
const USUAL: [&str; 6] = ["horn-schunck", "clg", "tv-l1", "full-search", "lucas-kanade", "mixture-of-gaussians"];
/// Runs and walks of which the shortest counts.
const TIMES: u32 = 5;
/// The frames of a run through a clip.
const FRAMES: usize = 12;

/// A scene whose frames are in memory.
fn clip() -> Clip {
    let scene = synth::scene("traffic").expect("a scene");
    let mut difficulty = scene.difficulty();
    for (name, value) in [("width", 640), ("height", 480), ("frames", FRAMES)] {
        difficulty.set(name, &value.to_string()).expect("in range");
    }
    let rendered = synth::make(scene.id, &difficulty).expect("a clip");
    let frames = (0..FRAMES).map(|t| Frame::clone(&*rendered.frame(t).expect("a frame"))).collect();
    Clip::from_frames("traffic", frames).expect("frames of one size")
}

/// The shortest time of a job.
fn shortest(mut job: impl FnMut()) -> Duration {
    let timed = |_| {
        let start = Instant::now();
        job();
        start.elapsed()
    };
    (0..TIMES).map(timed).min().unwrap_or_default()
}

fn line(estimator: &dyn AnyEstimator, clip: &Clip) -> String {
    let run = shortest(|| drop(estimator.run(clip, 0, &Threads::single()).expect("a run")));
    let walk = shortest(|| {
        let mut walk = estimator.walk(clip, 0).expect("a walk");
        walk.jump(Move::End);
        drop((walk.step(None), walk.scene(None), walk.output()));
    });
    let [run, walk] = [run, walk].map(|time| time.as_secs_f64() * 1e3);
    format!("{:<22} {run:>10.1} {walk:>10.1} {:>7.2}", estimator.info().id, walk / run)
}

fn main() {
    // Cargo itself passes flags.
    let named: Vec<String> = std::env::args().skip(1).filter(|name| !name.starts_with('-')).collect();
    let ids: Vec<String> = match &named[..] {
        [] => USUAL.map(str::to_owned).into(),
        [all] if all == "all" => estimators().iter().map(|estimator| estimator.info().id.to_owned()).collect(),
        _ => named,
    };
    let clip = clip();
    println!("{:<22} {:>10} {:>10} {:>7}", "estimator", "run ms", "walk ms", "ratio");
    for id in ids {
        match estimator(&id) {
            Ok(estimator) => println!("{}", line(&*estimator, &clip)),
            Err(error) => eprintln!("{error}"),
        }
    }
}
