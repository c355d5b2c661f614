//! What a run needs is known before it starts: against an allocator that counts.

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicIsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use common::set;
use motionscope_core::base::{Error, Stop, Threads};
use motionscope_core::course::estimators;
use motionscope_core::data::{Clip, ClipInfo, Detection, Frame, FrameSource};
use motionscope_core::geometry::{Bounds, Grid};
use motionscope_core::run::{AnyEstimator, Direction, Move};
use motionscope_core::scene::Focus;

/// Counts what is allocated now, and the most that was at once.
struct Counting;

static NOW: AtomicIsize = AtomicIsize::new(0);
static MOST: AtomicIsize = AtomicIsize::new(0);
/// One is measured at a time.
static TURN: Mutex<()> = Mutex::new(());

fn count(bytes: isize) {
    let now = NOW.fetch_add(bytes, Ordering::Relaxed) + bytes;
    MOST.fetch_max(now, Ordering::Relaxed);
}

// SAFETY: everything is passed on to the system's allocator as it is.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: as for this function.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: as for this function.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        count(-(layout.size() as isize));
        // SAFETY: as for this function.
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The most that `work` held at once beside what was there before, in bytes.
fn most_of(work: impl FnOnce()) -> u64 {
    let before = NOW.load(Ordering::Relaxed);
    MOST.store(before, Ordering::Relaxed);
    work();
    (MOST.load(Ordering::Relaxed) - before).max(0) as u64
}

const SIZE: (usize, usize) = (320, 240);

/// Frames in colour in which a pattern moves before another one, with noise.
fn clip() -> Clip {
    let value = |x: usize, y: usize, t: usize| {
        let hash = (x as u64 * 0x9E37_79B9) ^ (y as u64 * 0x85EB_CA6B) ^ (t as u64 * 0xC2B2_AE35);
        let noise = hash.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 59;
        let is_object = (x as f64 - 60.0 - 3.0 * t as f64).hypot(y as f64 - 150.0) < 40.0;
        let x = if is_object { x + 400 - 3 * t } else { x };
        (100.0 + 60.0 * ((x as f64 * 0.31).sin() + (y as f64 * 0.27 + x as f64 * 0.05).sin())) as u8 / 2 + noise as u8
    };
    let frame = |t| Frame::rgb(Grid::from_fn(SIZE.0, SIZE.1, |x, y| [value(x, y, t), value(x, y, t) / 2, 90]));
    Clip::from_frames("noise", (0..3).map(frame).collect()).expect("frames of one size")
}

/// All estimators, and those whose memory depends on parameters where it depends on them most.
fn all() -> Vec<(Box<dyn AnyEstimator>, String)> {
    let mut all: Vec<_> = estimators().into_iter().map(|estimator| (estimator, String::new())).collect();
    for (id, settings) in [
        ("full-search", &[("block-size", "4"), ("search-range", "64"), ("border", "mirror")][..]),
        ("diamond", &[("block-size", "8"), ("spacing", "1")]),
        ("predictive", &[("block-size", "8"), ("spacing", "2"), ("lambda", "4")]),
        ("hierarchical", &[("block-size", "8"), ("spacing", "1"), ("levels", "2")]),
        ("hierarchical", &[("block-size", "4"), ("levels", "6")]),
        ("pyramidal-lucas-kanade", &[("points", "dense"), ("window", "5")]),
        ("pyramidal-lucas-kanade", &[("points", "grid"), ("max-points", "5000")]),
        ("klt", &[("max-points", "1000"), ("window", "31"), ("min-distance", "1"), ("detector.threshold", "0")]),
        ("harris", &[("min-distance", "0"), ("threshold", "0"), ("max-points", "5000")]),
        ("shi-tomasi", &[("min-distance", "2"), ("threshold", "0"), ("window", "31")]),
        ("horn-schunck", &[("levels", "1"), ("solver", "sor")]),
        ("clg", &[("rho", "10"), ("solver", "sor"), ("sigma", "5")]),
        ("farneback", &[("poly-n", "15"), ("window", "63"), ("levels", "1")]),
        ("point-trajectories", &[("method", "farneback")]),
        ("point-trajectories", &[("method", "tv-l1"), ("spacing", "5"), ("min-eigenvalue", "0")]),
        ("mixture-of-gaussians", &[("modes", "1")]),
        (
            "mixture-of-gaussians",
            &[("modes", "8"), ("threshold", "0.5"), ("complexity-reduction", "0"), ("learning-rate", "0.4")],
        ),
        ("frame-difference", &[("opening", "0"), ("closing", "0"), ("threshold", "2"), ("connectivity", "4")]),
        ("single-gaussian", &[("opening", "0"), ("closing", "0"), ("threshold", "0.5"), ("min-area", "1")]),
        ("connected-components", &[("closing", "0"), ("threshold", "3"), ("connectivity", "4")]),
        ("flow-magnitude", &[("method", "tv-l1")]),
        ("kalman-tracker", &[("source", "moving")]),
        ("template-tracker", &[("region", "0,0,319,239"), ("levels", "6")]),
        ("rapid", &[("region", "0,0,319,239"), ("spacing", "1"), ("search-range", "40")]),
        ("chan-vese", &[("region", "20,20,300,220"), ("margin", "200")]),
    ] {
        all.push((set(id, settings), format!("{settings:?}")));
    }
    // How long iterations go on says nothing of memory.
    for (estimator, _) in &mut all {
        for (name, text) in [("iterations", "3"), ("warps", "2")] {
            if estimator.get(name).is_ok() {
                estimator.set(name, text).expect("in range");
            }
        }
    }
    all
}

#[test]
fn a_run_takes_no_more_than_it_said_before() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let clip = clip();
    // What is kept for all runs is there before the first one.
    estimators()[0].run(&clip, 0, &Threads::single()).expect("a run");
    let (mut checked, mut wrong) = (0, Vec::new());
    for (estimator, settings) in all() {
        let (id, need) = (estimator.info().id, estimator.need(&clip));
        for threads in [1, 2] {
            let threads = Threads::new(threads).expect("threads");
            let most = most_of(|| drop(estimator.run(&clip, 0, &threads).expect("a run")));
            if most > need.run {
                wrong.push(format!("{id} {settings} takes {most} bytes, not {}", need.run));
            }
        }
        let extent = most_of(|| assert!(estimator.extent(&clip, 0).is_ok()));
        if extent > need.run {
            wrong.push(format!("{id} {settings} is counted with {extent} bytes, not {}", need.run));
        }
        let walked = clip.clone().within(need.walk);
        let most = most_of(|| {
            let mut walk = estimator.walk(&walked, 0).expect("there is just enough");
            walk.jump(Move::End);
            assert!(walk.failure().is_none(), "{id}: {:?}", walk.failure());
            // Over some beginnings of whatever takes memory anew.
            let unit = walk.info().granularities.len() - 2;
            (0..5).for_each(|_| walk.jump(Move::Granularity(unit, Direction::Back)));
            (0..5).for_each(|_| walk.jump(Move::Granularity(unit, Direction::Forward)));
            drop((walk.step(Some(Focus::current([30.0, 40.0]))), walk.scene(None), walk.output()));
        });
        if most > need.walk {
            wrong.push(format!("{id} {settings} is walked through with {most} bytes, not {}", need.walk));
        }
        checked += 1;
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(checked > 50, "only {checked} were measured");
}

/// Pictures of any size that nobody can read.
struct Unread;

impl FrameSource for Unread {
    fn frame(&self, _index: usize, _stop: &Stop) -> Result<Arc<Frame>, Error> {
        Err(Error::new("it was read"))
    }

    fn cached(&self, _index: usize) -> Option<Arc<Frame>> {
        None
    }
}

#[test]
fn what_does_not_fit_is_refused_before_anything_is_read() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let info = ClipInfo { width: 16_000, height: 8000, frames: Some(3), ..clip().info().clone() };
    let huge = Clip::new(info, Arc::new(Unread)).within(2 << 30);
    let mut refused = Vec::new();
    for (estimator, settings) in all() {
        let (id, need) = (estimator.info().id, estimator.need(&huge));
        let fits = [need.run <= 2 << 30, need.walk <= 2 << 30];
        let errors = [
            estimator.run(&huge, 0, &Threads::single()).map(drop).unwrap_err(),
            estimator.walk(&huge, 0).map(drop).unwrap_err(),
        ];
        for (fits, error) in fits.into_iter().zip(errors) {
            let error = error.to_string();
            let told = if fits { "it was read" } else { "but 2.0 GiB are free" };
            assert!(error.contains(told), "{id} {settings}: {error}");
            refused.extend((!fits).then_some((id, settings.clone(), error)));
        }
    }
    let both = |id: &str| refused.iter().filter(|(other, settings, _)| *other == id && settings.is_empty()).count();
    for id in ["horn-schunck", "tv-l1", "farneback", "lucas-kanade", "mixture-of-gaussians", "flow-magnitude"] {
        assert_eq!(both(id), 2, "{id} is refused both ways");
    }
    assert!(refused.iter().all(|(.., error)| error.contains("for frames of 16000×8000 px")));
    // Blocks edge to edge take little of however large a picture.
    assert_eq!([both("full-search"), both("diamond")], [0; 2]);
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

/// A long clip of small pictures full of noise, in which very many boxes are detected.
fn long() -> Clip {
    let hash = |x: usize, y: usize, t: usize| {
        let mixed = (x as u64 * 0x9E37_79B9) ^ (y as u64 * 0x85EB_CA6B) ^ (t as u64 * 0xC2B2_AE35);
        mixed.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 40
    };
    let frame = |t| Arc::new(Frame::gray(Grid::from_fn(160, 120, |x, y| (hash(x, y, t) % 200) as u8)));
    let info = ClipInfo { width: 160, height: 120, frames: Some(400), ..clip().info().clone() };
    let detection = |i: usize, t: usize| {
        let center = [0, 1].map(|k| (hash(i, k, t) % 4000) as f32 / 10.0);
        Detection { bounds: Bounds::around(center, [8.0, 12.0]), center, score: 0.9, blob: None, deviation_px: None }
    };
    let detections = (0..400).map(|t| (0..300).map(|i| detection(i, t)).collect()).collect();
    Clip::new(info, Arc::new(Round((0..7).map(frame).collect()))).with_detections(detections)
}

#[test]
fn what_is_found_ends_a_run_where_there_is_no_room_for_more() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let clip = long();
    for (id, settings) in [
        (
            "frame-difference",
            &[("opening", "0"), ("closing", "0"), ("threshold", "110"), ("min-area", "1"), ("area-opening", "0")][..],
        ),
        (
            "connected-components",
            &[("closing", "0"), ("threshold", "150"), ("pixels", "bright"), ("min-area", "1"), ("area-opening", "0")],
        ),
        (
            "point-trajectories",
            &[("spacing", "4"), ("min-eigenvalue", "0"), ("method", "farneback"), ("frames", "10000")],
        ),
        ("klt", &[("max-points", "100"), ("window", "3"), ("frames", "10000")]),
        ("kalman-tracker", &[("frames", "400")]),
        ("blob-tracker", &[("frames", "400")]),
        ("trajectory-analysis", &[("frames", "400")]),
    ] {
        let estimator = set(id, settings);
        let need = estimator.need(&clip).run;
        let tight = clip.clone().within(need);
        let most = most_of(|| match estimator.run(&tight, 0, &Threads::single()) {
            Ok(output) => drop(output),
            Err(error) => assert!(error.to_string().contains("no more is free"), "{id}: {error}"),
        });
        println!("{id}: {:.1} of {:.1} MB", most as f64 / 1e6, need as f64 / 1e6);
        assert!(most < 2 * need + (8 << 20), "{id} takes {most} bytes, and may take {need}");
    }
    let noisy = set(
        "frame-difference",
        &[("opening", "0"), ("closing", "0"), ("threshold", "110"), ("min-area", "1"), ("area-opening", "0")],
    );
    let tight = clip.clone().within(noisy.need(&clip).run);
    assert!(noisy.run(&tight, 0, &Threads::single()).is_err(), "there is more to keep than room");
}
