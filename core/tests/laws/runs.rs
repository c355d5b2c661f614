//! Laws that hold for every estimator of the registry. A new one is tested here unasked.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Arc, Mutex};

use crate::common::{Objects, waves};
use motionscope_core::base::{Stop, Threads, effort};
use motionscope_core::course::estimators;
use motionscope_core::data::{Clip, Detection, Frame, ObjectBox};
use motionscope_core::geometry::{Bounds, Grid};
use motionscope_core::params::{Kind, Params, Spot, Value};
use motionscope_core::products::{
    BlockField, DenseField, Followed, KINDS, Motion, ObjectField, Output, PointField, ProductKind, Reference,
    RegionField, Score, TrackStatus,
};
use motionscope_core::run::stage::value_of;
use motionscope_core::run::{AnyEstimator, Cursor, Direction, Explained, Guarantee, Move, Walk};
use motionscope_core::scene::{Focus, Scene, Step};
use motionscope_core::synth;
use proptest::prelude::*;

/// A texture without repetition: every place can be told from every other.
fn texture(x: i64, y: i64) -> u8 {
    let hash = |x: i64, y: i64| {
        let h = (x.wrapping_mul(0x9E37_79B9) ^ y.wrapping_mul(0x85EB_CA6B)).wrapping_mul(0x2545_F491_4F6C_DD1D);
        (h >> 40) & 0xff
    };
    // Smoothed over 2×2 so that it is a picture rather than noise.
    ((hash(x, y) + hash(x + 1, y) + hash(x, y + 1) + hash(x + 1, y + 1)) / 4) as u8
}

/// Waves in all directions, so long that over a block the difference grows with the distance from the match.
fn smooth_texture(x: i64, y: i64) -> u8 {
    waves(x as f64, y as f64) as u8
}

/// Two frames of waves that move by `(u, v)` px, a fraction of one.
fn moving_waves((width, height): (usize, usize), (u, v): (f64, f64)) -> Clip {
    let frame = |t: f64| {
        let value = |x, y| (waves(x as f64 - u * t, y as f64 - v * t) + 0.5) as u8;
        Frame::gray(Grid::from_fn(width, height, value))
    };
    Clip::from_frames("waves", vec![frame(0.0), frame(1.0)]).expect("frames of one size")
}

/// Frames of `texture` in which everything moves by `(u, v)` px/frame.
fn moving_texture(
    texture: impl Fn(i64, i64) -> u8,
    (width, height): (usize, usize),
    (u, v): (i64, i64),
    frames: i64,
) -> Clip {
    let frame = |t: i64| Frame::gray(Grid::from_fn(width, height, |x, y| texture(x as i64 - u * t, y as i64 - v * t)));
    let clip = Clip::from_frames("moving", (0..frames).map(frame).collect()).expect("frames of one size");
    // Two objects that move with it, which someone has detected a little off their place.
    let [u, v] = [u, v].map(|c| c as f32);
    let object = |id: u32, t: f32| ObjectBox {
        id,
        x: 4.0 + 12.0 * id as f32 + u * t,
        y: 6.0 + v * t,
        width: 9.0,
        height: 11.0,
        visibility: 1.0,
    };
    let objects: Vec<Vec<ObjectBox>> = (0..frames).map(|t| vec![object(1, t as f32), object(2, t as f32)]).collect();
    let detected = |object: &ObjectBox| {
        let bounds = Bounds::from(&ObjectBox { x: object.x + 0.5, y: object.y - 0.25, ..*object });
        Detection { bounds, center: bounds.center(), score: 0.9, blob: None, deviation_px: None }
    };
    let detections = objects.iter().map(|objects| objects.iter().map(detected).collect()).collect();
    clip.with_detections(detections).with_truth(Arc::new(Objects(objects)))
}

/// Frames in which everything moves by `(u, v)` px/frame.
fn moving(width: usize, height: usize, motion: (i64, i64), frames: i64) -> Clip {
    moving_texture(texture, (width, height), motion, frames)
}

/// Everything that can be seen at a cursor.
#[derive(Debug, PartialEq)]
struct View {
    cursor: Cursor,
    step: Step,
    scene: Scene,
    output: Output,
}

impl View {
    fn of(walk: &dyn Walk) -> Self {
        Self { cursor: walk.cursor(), step: walk.step(None), scene: walk.scene(None), output: walk.output() }
    }

    /// Equal but for NaN, which stands for "not known yet" and differs from itself.
    fn same(&self, other: &Self) -> bool {
        self.cursor == other.cursor
            && alike(&self.step, &other.step)
            && alike(&self.scene, &other.scene)
            && alike(&self.output, &other.output)
    }
}

/// Equal, or written alike, as NaN is.
fn alike<T: PartialEq + std::fmt::Debug>(a: &T, b: &T) -> bool {
    a == b || format!("{a:?}") == format!("{b:?}")
}

fn into(way: Direction, walk: &mut dyn Walk) {
    walk.jump(Move::Granularity(walk.info().granularities.len() - 1, way));
}

/// Parameters small enough that whole runs can be walked.
fn small(mut estimator: Box<dyn AnyEstimator>) -> Box<dyn AnyEstimator> {
    // More candidates than are passed over at once.
    for (name, value) in
        [("block-size", "8"), ("search-range", "3"), ("levels", "2"), ("warps", "2"), ("iterations", "7")]
    {
        if estimator.get(name).is_ok() {
            estimator.set(name, value).expect("in range");
        }
    }
    for name in ["max-age", "tracker.max-age"] {
        // Only trackers have it: tracks end within a short clip.
        estimator.set(name, "3").ok();
    }
    estimator
}

/// The clip on which an estimator meets all that it knows: where each unit is a frame, the one of whole lives of tracks.
fn clip_for(estimator: &dyn AnyEstimator, pair: Clip) -> Clip {
    match estimator.guarantee() {
        Guarantee::SceneFlow => street(),
        _ if estimator.units_of(pair.size(), 2) == Some(2) => lives(),
        _ => pair,
    }
}

/// Two calibrated cameras that drive along a street.
fn street() -> Clip {
    let scene = synth::scene("drive").expect("a scene");
    let mut small = scene.difficulty();
    for (name, value) in [("width", "64"), ("height", "48"), ("frames", "3")] {
        small.set(name, value).expect("in range");
    }
    scene.clip(&small).expect("a clip")
}

/// Applies `law` to every estimator, on all cores. Laws use thread pools of their own, so these are plain threads.
fn each(law: impl Fn(Box<dyn AnyEstimator>) + Sync) {
    let rest = Mutex::new(estimators().into_iter());
    let next = || rest.lock().expect("it is not held by a law").next();
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                while let Some(estimator) = next() {
                    law(small(estimator))
                }
            });
        }
    });
}

#[test]
fn run_equals_stepping_on_any_number_of_threads() {
    each(|estimator| {
        let clip = clip_for(&*estimator, moving(50, 41, (1, -2), 2));
        let mut walk = estimator.walk(&clip, 0).unwrap();
        while !walk.at_end() {
            into(Direction::Forward, &mut *walk);
        }
        for threads in 1..4 {
            let run = estimator.run(&clip, 0, &Threads::new(threads).unwrap()).unwrap();
            assert_eq!(run, walk.output(), "{}", estimator.info().id);
        }
        let extent = estimator.extent(&clip, 0).unwrap();
        assert_eq!(Some(extent.units), walk.units());
    });
}

/// Nothing is computed for plots that nothing shows, and nothing twice: to see the last step costs little more than the run.
#[test]
fn walking_to_the_end_takes_at_most_twice_the_work_of_a_run() {
    let (mut counted, mut dense) = (0, 0);
    for estimator in estimators() {
        let id = estimator.info().id;
        let pair = moving(112, 80, (1, -2), 4);
        let clip = clip_for(&*estimator, pair);
        let work = |job: &mut dyn FnMut()| {
            let before = effort::pixels();
            job();
            effort::pixels() - before
        };
        let (mut units, mut walked, mut memory) = (0, 0, 0);
        let plain = work(&mut || drop(estimator.run(&clip, 0, &Threads::single()).expect("a run")));
        let with_count = work(&mut || {
            let extent = estimator.run_counted(&clip, 0, &Threads::single()).expect("a run").extent;
            (units, memory) = (extent.units, extent.memory_bytes);
        });
        assert_eq!(plain, with_count, "{id}: counting is no second run");
        assert!(memory > 0, "{id}");
        let seen = work(&mut || {
            let mut walk = estimator.walk(&clip, 0).expect("a walk");
            walk.jump(Move::End);
            assert_eq!(walk.units(), Some(units), "{id}");
            drop((walk.step(None), walk.scene(None), walk.output()));
            walked = walk.advanced();
        });
        // Where the number of units is not known before, the last one is performed again, from the checkpoint before it.
        assert!(walked >= units && walked <= 2 * units + 2, "{id} performs {walked} units for {units}");
        assert!(seen <= 2 * plain, "{id} goes through {seen} pixels for {plain}");
        counted += 1;
        dense += usize::from(plain > 0);
    }
    assert!(counted == estimators().len() && dense >= 8, "{dense} of {counted} go through whole pictures");
}

#[test]
fn seeking_anywhere_equals_walking_there() {
    each(|estimator| {
        // What shows pictures at every stop takes long: of those fewer and smaller frames, still more than a pair.
        let goes_through = estimator.units_of((34, 27), 2) == Some(2);
        let pair = moving(34, 27, (1, 1), if goes_through { 4 } else { 2 });
        let clip = if estimator.needs_pictures() { pair } else { clip_for(&*estimator, pair) };
        let mut walk = estimator.walk(&clip, 0).unwrap();
        let mut views = vec![View::of(&*walk)];
        while !walk.at_end() {
            into(Direction::Forward, &mut *walk);
            views.push(View::of(&*walk));
        }
        let extent = estimator.extent(&clip, 0).unwrap();
        assert_eq!(views.len() as u64, extent.events + 1, "one stop for each event, and the start");
        // The explanations of a pixel under the pointer.
        let focus = Some(Focus::current([17.0, 13.0]));
        let mut pointed = Vec::new();
        for view in views.iter().rev() {
            assert!(view.same(&View::of(&*walk)), "walking back: {}", view.cursor);
            pointed.push(walk.step(focus));
            into(Direction::Back, &mut *walk);
        }
        pointed.reverse();
        // A fixed order that visits every stop from an unrelated one.
        for i in 0..views.len() {
            let index = i * 7919 % views.len();
            let view = &views[index];
            walk.jump(Move::To(view.cursor));
            assert!(view.same(&View::of(&*walk)), "seeking: {}", view.cursor);
            let before = index.checked_sub(1).filter(|before| views[*before].cursor.unit == view.cursor.unit);
            let same = |now: Option<Step>, then: Option<&Step>| alike(&now.as_ref(), &then);
            assert!(same(walk.step_before(None), before.map(|before| &views[before].step)), "before {}", view.cursor);
            assert!(same(walk.step_before(focus), before.map(|before| &pointed[before])), "before {}", view.cursor);
        }
    });
}

/// Twenty frames of two objects before a background at rest: one is there all the time, but goes behind a pillar that hides the
/// whole of it in frames 8 to 10, the other ends with frame 13. Long enough that tracks are confirmed, coast, come back and end.
fn lives() -> Clip {
    const FRAMES: usize = 20;
    const PILLAR: std::ops::Range<usize> = 22..35;
    let place = |id: usize, t: usize| [6 + 2 * t, 5 + 18 * id];
    let is_there = |id: usize, t: usize| id == 0 || t <= 13;
    let is_hidden = |x: usize, y: usize| PILLAR.contains(&x) && y < 20;
    let covers = |id: usize, t: usize, x: usize, y: usize| {
        let [left, top] = place(id, t);
        is_there(id, t) && !is_hidden(x, y) && (left..left + 9).contains(&x) && (top..top + 9).contains(&y)
    };
    let frame = |t: usize| {
        Frame::gray(Grid::from_fn(64, 44, |x, y| {
            let rest = texture(x as i64, y as i64) / 3;
            let moves = |id: usize| texture(x as i64 - 2 * t as i64 + 90, y as i64 + 200 * id as i64) / 3 + 150;
            (0..2).find(|&id| covers(id, t, x, y)).map_or(rest, moves)
        }))
    };
    let object = |id: usize, t: usize| {
        let [x, y] = place(id, t).map(|c| c as f32 - 0.5);
        let [left, top] = place(id, t);
        let seen = (left..left + 9).filter(|&x| !is_hidden(x, top)).count();
        ObjectBox { id: id as u32 + 1, x, y, width: 9.0, height: 9.0, visibility: seen as f32 / 9.0 }
    };
    let there = |t: usize| (0..2).filter(move |&id| is_there(id, t));
    let detected = |t: usize| -> Vec<Detection> {
        let seen = there(t).filter(|&id| object(id, t).visibility > 0.0);
        let detection = |id| {
            let bounds = Bounds::from(&object(id, t));
            Detection { bounds, center: bounds.center(), score: 0.9, blob: None, deviation_px: None }
        };
        seen.map(detection).collect()
    };
    let truth = (0..FRAMES).map(|t| there(t).map(|id| object(id, t)).collect()).collect();
    let clip = Clip::from_frames("lives", (0..FRAMES).map(frame).collect()).expect("frames of one size");
    clip.with_detections((0..FRAMES).map(detected).collect()).with_truth(Arc::new(Objects(truth)))
}

#[test]
fn the_clip_of_the_laws_has_tracks_that_confirm_coast_come_back_and_end() {
    let clip = lives();
    let truth = |t: usize| clip.truth().expect("true objects").objects(t).expect("true objects").expect("true objects");
    let visible: Vec<f32> = (0..20).map(|t| truth(t)[0].visibility).collect();
    let begins = visible.windows(2).position(|pair| pair[1] < pair[0]).expect("an occlusion begins");
    let passes = visible.windows(2).rposition(|pair| pair[1] > pair[0]).expect("it passes");
    assert_eq!((visible[begins], visible[9], visible[passes + 1]), (1.0, 0.0, 1.0), "{visible:?}");
    assert!((8..=10).all(|t| truth(t).len() == 2 && clip.detections(t).is_some_and(|found| found.len() == 1)));
    let trackers = AtomicUsize::default();
    each(|estimator| {
        let output = estimator.run(&clip, 0, &Threads::single()).expect("a run");
        let Some(field) = output.get::<ObjectField>().filter(|field| field.followed == Followed::All) else { return };
        let id = estimator.info().id;
        let lives =
            |object: u32| field.frames.iter().map(move |frame| frame.object(object).map(|object| object.status));
        let ids: std::collections::BTreeSet<u32> =
            field.frames.iter().flat_map(|frame| frame.objects.iter().map(|object| object.id)).collect();
        assert_eq!(ids.len(), 2, "{id}: one track each, none is torn");
        let told: Vec<Vec<_>> = ids.into_iter().map(|id| lives(id).collect()).collect();
        assert!(told.iter().all(|lives| lives.contains(&Some(TrackStatus::Confirmed))), "{id}: {told:?}");
        assert!(told.iter().any(|lives| lives.contains(&Some(TrackStatus::Coasting))), "{id}: {told:?}");
        assert_eq!(told[0][19], Some(TrackStatus::Confirmed), "{id}: it comes back");
        assert_eq!(told[1][19], None, "{id}: it ends");
        trackers.fetch_add(1, Relaxed);
    });
    assert_eq!(
        trackers.into_inner(),
        5,
        "blob tracker, Kalman tracker, both that weigh hypotheses, and trajectory analysis"
    );
}

/// With so little memory beside what a run needs that of the states only a few are kept.
#[test]
fn seeking_among_thinned_checkpoints_equals_walking_there() {
    let (ran, thinned) = (AtomicUsize::default(), Mutex::new(Vec::new()));
    each(|estimator| {
        let clip = lives();
        let room = estimator.need(&clip).walk + (64 << 10);
        let clip = clip.within(room);
        let mut walk = estimator.walk(&clip, 0).unwrap();
        let unit = walk.info().granularities.len() - 2;
        let mut views = vec![View::of(&*walk)];
        while !walk.at_end() {
            walk.jump(Move::Granularity(unit, Direction::Forward));
            views.push(View::of(&*walk));
        }
        assert!(walk.failure().is_none(), "{}: {:?}", estimator.info().id, walk.failure());
        // Some from all over the run, in an order that is none.
        let (some, mut farthest) = (12.min(views.len()), 0);
        for i in 0..some {
            let view = &views[(i * 7919) % some * (views.len() - 1) / some.max(1)];
            walk.go(Move::To(view.cursor));
            farthest = farthest.max(walk.progress().map_or(0, |(_, units)| units));
            while !walk.work(&mut || true) {}
            assert!(view.same(&View::of(&*walk)), "{}: seeking {}", estimator.info().id, view.cursor);
        }
        // A state before every unit would be at hand.
        thinned.lock().unwrap().extend((farthest > 1).then_some(estimator.info().id));
        ran.fetch_add(1, Relaxed);
    });
    assert_eq!(ran.into_inner(), estimators().len());
    let thinned = thinned.into_inner().unwrap();
    assert!(thinned.len() >= 16, "{thinned:?}");
}

#[test]
fn steps_show_the_charts_that_are_declared_and_no_others() {
    each(|mut estimator| {
        // What is shown of a resampling needs one: in every frame.
        if estimator.get("resample-below").is_ok() {
            estimator.set("resample-below", "1").expect("a share");
        }
        // Some plot what happens from frame to frame, and some need points at different depths.
        let is_of_depth = estimator.guarantee() == Guarantee::SceneFlow || estimator.get("focal-length").is_ok();
        let clip = if is_of_depth { street() } else { moving(50, 41, (1, -2), 4) };
        let mut walk = estimator.walk(&clip, 0).unwrap();
        let mut shown = std::collections::HashSet::new();
        while !walk.at_end() {
            into(Direction::Forward, &mut *walk);
            shown.extend(
                walk.step(Some(Focus::current([20.0, 20.0]))).readouts.iter().filter_map(|readout| readout.chart()),
            );
        }
        let declared = estimator.charts();
        let id = estimator.info().id;
        assert!(shown.iter().all(|chart| declared.contains(chart)), "{id} shows {shown:?}, not only {declared:?}");
        let missing: Vec<_> = declared.iter().filter(|chart| !shown.contains(*chart)).collect();
        assert!(missing.is_empty(), "{id} never shows {missing:?}");
    });
}

#[test]
fn granularities_lead_to_ends_of_units_and_back() {
    each(|estimator| {
        let clip = clip_for(&*estimator, moving(40, 24, (0, 1), 2));
        let mut walk = estimator.walk(&clip, 0).unwrap();
        let unit = walk.info().granularities.len() - 2;
        let mut ends = vec![walk.cursor()];
        while !walk.at_end() {
            walk.jump(Move::Granularity(unit, Direction::Forward));
            assert_eq!(walk.cursor().event, walk.events());
            ends.push(walk.cursor());
        }
        assert_eq!(Some(ends.len() - 1), walk.units());
        for end in ends.iter().rev() {
            assert_eq!(walk.cursor(), *end);
            walk.jump(Move::Granularity(unit, Direction::Back));
        }
        walk.jump(Move::Granularity(0, Direction::Forward));
        assert!(walk.at_end(), "the outermost granularity is the whole run");
        walk.jump(Move::Granularity(0, Direction::Back));
        assert_eq!(walk.cursor(), Cursor::default());
        walk.jump(Move::To(Cursor { unit: usize::MAX, event: usize::MAX }));
        assert!(walk.at_end(), "a place beyond the end is the end");
    });
}

#[test]
fn sliced_seeking_arrives_at_the_same_place() {
    each(|estimator| {
        // Some have a unit for each frame.
        let clip = match estimator.guarantee() {
            Guarantee::SceneFlow => street(),
            _ => moving(80, 60, (1, 0), 16),
        };
        let mut direct = estimator.walk(&clip, 0).unwrap();
        let mut sliced = estimator.walk(&clip, 0).unwrap();
        let units = estimator.extent(&clip, 0).unwrap().units;
        let target = Move::To(Cursor { unit: units.saturating_sub(2), event: 3 });
        direct.jump(target);
        sliced.go(target);
        let mut slices = 1;
        while !sliced.work(&mut || false) {
            let (done, of) = sliced.progress().expect("this move has a known length");
            assert!(done <= of);
            assert_eq!(sliced.cursor(), Cursor::default(), "nothing shows before the move is finished");
            slices += 1;
        }
        // A consensus of few iterations has fewer units than that.
        assert!(slices > 10.min(units.saturating_sub(3)), "one unit a slice");
        assert!(View::of(&*direct).same(&View::of(&*sliced)));
        // To the end of the run, however it is asked for, it is known how far that is.
        for to in [Move::End, Move::Granularity(0, Direction::Forward)] {
            let mut fresh = estimator.walk(&clip, 0).unwrap();
            fresh.go(to);
            assert!(!fresh.work(&mut || false));
            // The first unit is at hand, and the last is run before our eyes.
            assert_eq!(fresh.progress().map(|(_, of)| of + 2), fresh.units());
        }
    });
}

#[test]
fn known_translations_are_recovered_as_far_as_promised() {
    let ran = AtomicUsize::default();
    each(|mut estimator| {
        let (texture, off_px): (fn(i64, i64) -> u8, _) = match estimator.guarantee() {
            Guarantee::Translation => (texture, 0),
            Guarantee::SmoothTranslation { off_px } => {
                // Blocks large enough to hold waves in all directions.
                estimator.set("block-size", "16").unwrap();
                (smooth_texture, off_px)
            }
            Guarantee::Better
            | Guarantee::SubPixel { .. }
            | Guarantee::Features { .. }
            | Guarantee::Places
            | Guarantee::SubPixelPlaces { .. }
            | Guarantee::Objects
            | Guarantee::Region
            | Guarantee::Segments
            | Guarantee::Disparity
            | Guarantee::SceneFlow
            | Guarantee::Trajectories
            | Guarantee::AlongGradient => return,
        };
        for motion in [(0, 0), (2, -1), (-2, 2)] {
            let clip = moving_texture(texture, (96, 80), motion, 2);
            let flow = estimator.run(&clip, 0, &Threads::single()).unwrap().flow().expect("a flow");
            // Away from the border, where what moved in cannot be known.
            for (x, y) in (16..64).flat_map(|y| (16..80).map(move |x| (x, y))) {
                let [u, v] = flow.at(x, y).expect("a displacement for every pixel");
                let off = (u - motion.0 as f32).abs().max((v - motion.1 as f32).abs());
                assert!(off <= f32::from(off_px), "{}: ({u}, {v}) at {x}, {y}, not {motion:?}", estimator.info().id);
            }
        }
        ran.fetch_add(1, Relaxed);
    });
    assert_eq!(ran.into_inner(), 11, "all block searches but that by quadrants");
}

#[test]
fn known_fractions_of_a_pixel_are_recovered_as_far_as_promised() {
    let mut ran = 0;
    for estimator in estimators() {
        let id = estimator.info().id;
        let is_along_gradient = estimator.guarantee() == Guarantee::AlongGradient;
        let most = match estimator.guarantee() {
            Guarantee::SubPixel { off_centi_px } | Guarantee::Features { off_centi_px } => {
                f32::from(off_centi_px) / 100.0
            }
            // The waves bend: over a pixel their gradient is not quite the same.
            Guarantee::AlongGradient => 0.03,
            _ => continue,
        };
        for motion in [(0.0, 0.0), (0.4, -0.3), (-0.25, 0.6)] {
            let clip = moving_waves((96, 80), motion);
            let output = estimator.run(&clip, 0, &Threads::single()).unwrap();
            let least = if output.motion().is_field() { 48 * 64 / 2 } else { 20 };
            let flow = output.flow().expect("a flow");
            let (mut sum, mut known) = (0.0, 0);
            // Away from the border, where what moved in cannot be known.
            for [u, v] in (16..64).flat_map(|y| (16..80).map(move |x| (x, y))).filter_map(|(x, y)| flow.at(x, y)) {
                let (true_u, true_v) = (motion.0 as f32, motion.1 as f32);
                let length = u.hypot(v);
                sum += match is_along_gradient {
                    // What is found has the direction of the gradient: the true motion must reach as far that way.
                    true if length > 0.0 => ((true_u * u + true_v * v) / length - length).abs(),
                    true => 0.0,
                    false => (u - true_u).hypot(v - true_v),
                };
                known += 1;
            }
            assert!(known > least, "{id} knows only {known} pixels");
            let mean = sum / known as f32;
            assert!(mean <= most, "{id}: {mean} px off on average at {motion:?}");
        }
        ran += 1;
    }
    assert_eq!(ran, 10, "all methods of optical flow, and image alignment");
}

#[test]
fn features_of_a_moved_picture_are_moved_alike() {
    for estimator in estimators() {
        let off_px = match estimator.guarantee() {
            Guarantee::Places => 0.0,
            Guarantee::SubPixelPlaces { off_centi_px } => f32::from(off_centi_px) / 100.0,
            _ => continue,
        };
        let clip = moving_texture(smooth_texture, (160, 128), (3, -2), 3);
        let features = |frame| {
            let output = estimator.run(&clip, frame, &Threads::single()).unwrap();
            output.get::<PointField>().expect("features").points.iter().map(|point| point.at).collect::<Vec<_>>()
        };
        let (here, there) = (features(0), features(1));
        // What lies near the border is not seen in both, and may have taken the place of others.
        let inner = here.iter().filter(|[x, y]| (32.0..128.0).contains(x) && (32.0..96.0).contains(y));
        let is_near = |a: [f32; 2], b: [f32; 2]| (0..2).all(|i| (a[i] - b[i]).abs() <= off_px);
        let is_there = |at: [f32; 2]| there.iter().any(|other| is_near(*other, at));
        let (all, again): (Vec<_>, Vec<_>) = inner.map(|[x, y]| (1, is_there([x + 3.0, y - 2.0]))).unzip();
        let again = again.into_iter().filter(|is_again| *is_again).count();
        let id = estimator.info().id;
        assert!(all.len() > 20 && 10 * again >= 9 * all.len(), "{id}: {again} of {} are found again", all.len());
    }
}

/// A bright square that goes over a background at rest, and where it is in each frame.
fn square_on_background(frames: usize) -> (Clip, Vec<Bounds>) {
    let bounds = |t: usize| Bounds::around([12.0 + 2.5 * t as f32, 30.0 + 0.5 * t as f32], [15.0, 13.0]);
    let frame = |t: usize| {
        let Bounds { min, max } = bounds(t);
        let is_inside = |p: [f32; 2]| (0..2).all(|i| min[i] < p[i] && p[i] < max[i]);
        Frame::gray(Grid::from_fn(96, 80, |x, y| match is_inside([x as f32, y as f32]) {
            true => 190 + texture(x as i64, y as i64 - t as i64) / 8,
            false => smooth_texture(x as i64, y as i64) / 3 + texture(x as i64 + 300 * t as i64, y as i64) / 64,
        }))
    };
    let clip = Clip::from_frames("square", (0..frames).map(frame).collect()).expect("frames of one size");
    (clip, (0..frames).map(bounds).collect())
}

#[test]
fn what_moves_before_a_background_is_found_in_its_place() {
    for mut estimator in estimators().into_iter().filter(|estimator| estimator.guarantee() == Guarantee::Objects) {
        let (clip, bounds) = square_on_background(24);
        // The registration of frames is exact here. The details of the square move by 1 px, and would count as its errors.
        if estimator.get("motion").is_ok() && estimator.get("shake").is_ok() {
            estimator.set("shake", "0").expect("in range");
        }
        let output = estimator.run(&clip, 0, &Threads::single()).unwrap();
        let field = output.get::<ObjectField>().expect("objects");
        let id = estimator.info().id;
        assert_eq!((field.first, field.frames.len()), (0, 24), "{id}");
        for (frame, truth) in field.frames.iter().zip(&bounds).skip(8) {
            let places = match &frame.objects[..] {
                [] => frame.detections.iter().map(|found| found.bounds).collect::<Vec<_>>(),
                all => all.iter().map(|object| object.bounds).collect(),
            };
            let best = places.iter().map(|place| place.iou(truth)).fold(0.0, f32::max);
            assert!(best >= 0.5, "{id}: {places:?} where {truth:?} is");
        }
    }
}

/// A square whose texture moves with it, as that of a rigid object does, before another texture; and its bounds.
fn textured_square(frames: usize) -> (Clip, Vec<Bounds>) {
    let moved = |t: usize| [2 * t as i64, t as i64 / 2];
    let bounds = |t: usize| Bounds::around([0, 1].map(|i| [22.0, 32.0][i] + moved(t)[i] as f32), [31.0, 27.0]);
    let frame = |t: usize| {
        let (Bounds { min, max }, [dx, dy]) = (bounds(t), moved(t));
        let is_inside = |p: [f32; 2]| (0..2).all(|i| min[i] < p[i] && p[i] < max[i]);
        Frame::gray(Grid::from_fn(96, 80, |x, y| match is_inside([x as f32, y as f32]) {
            true => 120 + texture(x as i64 - dx, y as i64 - dy) / 3,
            false => smooth_texture(x as i64, y as i64) / 3 + texture(x as i64 + 300 * t as i64, y as i64) / 64,
        }))
    };
    let clip = Clip::from_frames("square", (0..frames).map(frame).collect()).expect("frames of one size");
    (clip, (0..frames).map(bounds).collect())
}

#[test]
fn a_given_region_stays_on_its_object() {
    let mut ran = 0;
    for mut estimator in estimators().into_iter().filter(|estimator| estimator.guarantee() == Guarantee::Region) {
        let (clip, bounds) = textured_square(24);
        let Bounds { min: [x, y], max: [u, v] } = bounds[0];
        estimator.set("region", &format!("{x},{y},{u},{v}")).expect("a region");
        // A model in space is given the shape of the square: flat, and seen from the front.
        let sides = [("model-width", "0.31"), ("model-height", "0.27"), ("model-depth", "0.01")];
        for (name, value) in [("turn", "0"), ("tilt", "0")].into_iter().chain(sides) {
            estimator.set(name, value).ok();
        }
        let output = estimator.run(&clip, 0, &Threads::single()).unwrap();
        let field = output.get::<RegionField>().expect("a region");
        let id = estimator.info().id;
        assert_eq!((field.first, field.frames.len(), field.objects().frames.len()), (0, 24, 24), "{id}");
        for (t, (frame, truth)) in field.frames.iter().zip(&bounds).enumerate() {
            let overlap = frame.region.bounds().iou(truth);
            assert!(overlap >= 0.5 && !frame.is_lost, "{id}, frame {t}: {frame:?} where {truth:?} is");
        }
        ran += 1;
    }
    assert_eq!(ran, 9);
}

#[test]
fn who_looks_at_pictures_refuses_a_clip_without_any() {
    let blank = Clip::blank("found", (64, 48), 4).with_detections(vec![Vec::new(); 4]);
    each(|estimator| {
        let refused = [estimator.walk(&blank, 0).err(), estimator.run(&blank, 0, &Threads::single()).err()];
        for error in refused {
            assert_eq!(error.is_some(), estimator.needs_pictures());
            assert!(error.is_none_or(|error| error.to_string().contains("no frames")));
        }
    });
}

#[test]
fn a_dense_prediction_fits_better_than_none() {
    let mut ran = 0;
    for estimator in estimators() {
        let clip = moving_waves((96, 80), (0.4, -0.3));
        let [current, next] = clip.pair(0).unwrap();
        let output = estimator.run(&clip, 0, &Threads::single()).unwrap();
        let Some(field) = &output.get::<DenseField>().cloned() else { continue };
        assert!(field.confidence.as_ref().is_none_or(|c| c.values.cells().iter().all(|v| v.is_finite())));
        let off = |picture: &Grid<u8>| -> u64 {
            picture.cells().iter().zip(current.luma().cells()).map(|(a, b)| u64::from(a.abs_diff(*b))).sum()
        };
        let (predicted, at_rest) = (off(&output.prediction(next.luma()).expect("a prediction")), off(next.luma()));
        assert!(2 * predicted < at_rest, "{}: {predicted} off, at rest {at_rest}", estimator.info().id);
        ran += 1;
    }
    assert!(ran >= 6, "only {ran} make a dense flow");
}

#[test]
fn a_flat_picture_and_one_a_pixel_wide_give_nothing_that_is_not_finite() {
    let flat = |size: (usize, usize)| moving_texture(|_, _| 90, size, (0, 0), 2);
    let mut ran = [0; 4];
    let clips = [flat((24, 18)), flat((1, 1)), moving(1, 20, (0, 1), 2), moving(20, 1, (1, 0), 2)];
    for (clip, ran) in clips.into_iter().zip(&mut ran) {
        for estimator in estimators().into_iter().map(small) {
            let Ok(mut walk) = estimator.walk(&clip, 0) else { continue };
            walk.jump(Move::End);
            assert!(walk.failure().is_none(), "{}", estimator.info().id);
            for [u, v] in walk.output().flow().into_iter().flat_map(|flow| flow.0.into_cells()) {
                assert!(u.is_finite() == v.is_finite() && !u.is_infinite(), "{}: ({u}, {v})", estimator.info().id);
            }
            assert!(!walk.step(None).sentence.plain().contains("NaN"));
            *ran += 1;
        }
    }
    // The others say that a picture a pixel wide is too small.
    assert!(ran[0] == estimators().len() && ran[1..].iter().all(|ran| *ran >= 22), "{ran:?}");
}

#[test]
fn a_displacement_fits_at_least_as_well_as_none() {
    let ran = AtomicUsize::default();
    each(|estimator| {
        let clip = moving(64, 48, (2, -1), 2);
        let [current, next] = clip.pair(0).unwrap();
        let output = estimator.run(&clip, 0, &Threads::single()).unwrap();
        let Some(field) = output.get::<BlockField>() else { return };
        for (i, vector) in field.vectors.iter().enumerate() {
            let block = field.blocks.block(i);
            let pixels =
                (block.y..block.y + block.height).flat_map(|y| (block.x..block.x + block.width).map(move |x| (x, y)));
            let at_rest: u64 = pixels.map(|at| u64::from(current.luma()[at].abs_diff(next.luma()[at]))).sum();
            let found = vector.expect("every block is searched").cost;
            assert!(found <= at_rest as f64, "{}: block {i} costs {found}, at rest {at_rest}", estimator.info().id);
        }
        ran.fetch_add(1, Relaxed);
    });
    let ran = ran.into_inner();
    assert!(ran >= 11, "only {ran} make block vectors");
}

/// Whether a letter stands below the line in plain text: there is no such y, so all are told as in I_x, I_y.
fn has_lone_index(text: &str) -> bool {
    text.contains(|c| matches!(c, '\u{2090}'..='\u{209c}' | '\u{1d62}'..='\u{1d6a}' | '\u{2c7c}'))
}

#[test]
fn every_mark_is_finite_and_every_event_is_reported() {
    each(|estimator| {
        let clip = clip_for(&*estimator, moving(24, 24, (1, 1), 2));
        let mut walk = estimator.walk(&clip, 0).unwrap();
        let info = estimator.info();
        while !walk.at_end() {
            into(Direction::Forward, &mut *walk);
            let step = walk.step(Some(Focus::current([9.0, 9.0])));
            assert!(info.line(step.line).is_some(), "{}: {}", walk.cursor(), step.line);
            assert!(step.sentence.plain().len() > 10, "{}: {}", walk.cursor(), step.sentence.plain());
            assert!(!step.readouts.is_empty());
            assert!(!has_lone_index(&format!("{step:?}")), "{}: {step:?}", walk.cursor());
            let scene = walk.scene(None);
            assert!(scene.marks.iter().all(|mark| mark.shape.coordinates().iter().all(|c| c.is_finite())));
            assert!(!scene.legend.is_empty());
        }
    });
}

#[test]
fn a_pixel_is_not_explained_before_its_turn() {
    let (clip, ran) = (moving(40, 32, (2, 1), 2), AtomicUsize::default());
    each(|estimator| {
        let id = estimator.info().id;
        let mut walk = estimator.walk(&clip, 0).expect("a run");
        let point = Focus::current([9.0, 4.0]);
        let Some(Explained::From(turn)) = walk.explained(point) else { return };
        let told = |walk: &dyn Walk, focus| format!("{:?} {:?}", walk.step(focus), walk.scene(focus));
        walk.jump(Move::To(Cursor { unit: turn.unit, event: turn.event - 3 }));
        assert!(told(&*walk, Some(point)) == told(&*walk, None), "{id} tells at {} what comes", walk.cursor());
        walk.jump(Move::To(turn));
        let at_work = told(&*walk, None);
        assert!(told(&*walk, Some(point)) == at_work, "{id}: at {turn} another pixel is at work");
        into(Direction::Forward, &mut *walk);
        assert!(told(&*walk, Some(point)) != told(&*walk, None), "{id}: a pixel that is done is not explained");
        ran.fetch_add(1, Relaxed);
    });
    let ran = ran.into_inner();
    assert!(ran >= 4, "only {ran} explain a pixel of the unit at work");
}

#[test]
fn declarations_are_complete() {
    let family_of = |info: &motionscope_core::run::Info| info.family.to_lowercase().replace(' ', "_");
    let mut files = Vec::new();
    for estimator in estimators() {
        let info = estimator.info();
        files.push(format!("{}/{}.rs", family_of(info), info.id.replace('-', "_")));
        assert!(info.pseudocode.iter().all(|line| !has_lone_index(line.text)), "{}", info.id);
        assert!(info.granularities.len() >= 3 && !info.pseudocode.is_empty() && !info.source.is_empty());
        for (i, spec) in estimator.specs().iter().enumerate() {
            assert!(spec.doc.ends_with('.'), "{}: the doc of {} is a sentence", info.id, spec.name);
            assert!(!has_lone_index(&spec.doc), "{}: {}", info.id, spec.doc);
            assert_eq!(spec.check(spec.default.clone()).as_ref(), Ok(&spec.default));
            assert_eq!(estimator.value(i), spec.default, "{}: {}", info.id, spec.name);
        }
    }
    // Registry and files agree, both ways.
    let source = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/families");
    let mut found = Vec::new();
    let families: std::collections::BTreeSet<_> = estimators().iter().map(|e| family_of(e.info())).collect();
    for family in families {
        for entry in std::fs::read_dir(source.join(&family)).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            // The telling of a long one stands in a folder of its own.
            if name != "mod.rs" && name.ends_with(".rs") {
                found.push(format!("{family}/{name}"));
            }
        }
    }
    found.sort();
    files.sort();
    assert_eq!(files, found);
}

#[test]
fn who_looks_at_one_frame_needs_no_second_and_nobody_a_missing_one() {
    let (one, two) = (moving(32, 32, (0, 0), 1), moving(32, 32, (0, 0), 2));
    each(|estimator| {
        let (id, needs_pair) = (estimator.info().id, estimator.info().frames > 1);
        assert_eq!([estimator.walk(&one, 0).is_err(), estimator.walk(&two, 1).is_err()], [needs_pair; 2], "{id}");
        for frame in [2, usize::MAX] {
            assert!(estimator.walk(&two, frame).is_err(), "{id}");
        }
        if !needs_pair {
            let output = |clip, frame| estimator.run(clip, frame, &Threads::single()).expect("a run");
            assert_eq!(output(&one, 0), output(&two, 1), "{id}: the pictures are the same");
        }
    });
}

/// The same with small numbers, so that whole runs can be walked.
fn small_kind(kind: &Kind) -> Kind {
    match kind {
        Kind::Int { min, max } => Kind::Int { min: *min, max: *max.min(&(min + 9)) },
        other => other.clone(),
    }
}

/// A value for `kind` that is in range, chosen by `dice`.
fn in_range(kind: &Kind, dice: u64) -> Value {
    match kind {
        Kind::Int { min, max } => Value::Int(min + (dice % (*max - *min + 1) as u64) as i64),
        Kind::Real { min, max } => Value::Real(min + (max - min) * ((dice % 1001) as f64 / 1000.0)),
        Kind::Switch => Value::Switch(dice.is_multiple_of(2)),
        Kind::Choice(all) => Value::Choice(all[dice as usize % all.len()].name),
        Kind::Stage(kind) => {
            let ids = kind.ids();
            let mut stage = kind.parse(ids[dice as usize % ids.len()]).expect("one of its own");
            // Its own parameters vary as well, and so do those of its stages.
            for (i, spec) in stage.part().specs().iter().enumerate() {
                let own = dice.rotate_left(7 * i as u32 + 3).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 8;
                stage.part_mut().set_value(i, in_range(&small_kind(&spec.kind), own)).expect("in range");
            }
            Value::Stage(stage)
        }
        Kind::Placed(figure) if dice.is_multiple_of(3) => Value::Placed(figure.none()),
        Kind::Placed(figure) => {
            let at = |shift: u32| [(dice >> shift) % 97, (dice >> (shift + 7)) % 89].map(|c| c as f32 - 20.25);
            let spots = [3, 5, 11].map(|shift| Spot { frame: (dice >> shift) as usize % 3, at: at(shift) });
            let spanned = figure.spanned(at(0), at(17).map(|c| c + 100.0));
            Value::Placed(spots.into_iter().fold(spanned, |placed, spot| placed.with(spot)))
        }
        Kind::Optional { word, .. } if dice.is_multiple_of(3) => Value::Choice(word),
        Kind::Optional { of, .. } => in_range(of, dice),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn stepping_equals_running_with_any_small_parameters(dice in prop::collection::vec(any::<u64>(), 16)) {
        for mut estimator in estimators() {
            for (i, spec) in estimator.specs().iter().enumerate() {
                prop_assert!(estimator.set_value(i, in_range(&small_kind(&spec.kind), dice[i % dice.len()])).is_ok());
            }
            let clip = clip_for(&*estimator, moving(30, 26, (1, -1), 2));
            // Each of those that are placed may have to be taken away.
            while let Err(error) = estimator.walk(&clip, 0) {
                // A pyramid of so many levels has no room for a block. It says so, and one of two levels has. A template, a region or a
                // contour may be placed beside the picture; one that is chosen automatically is not.
                let told = error.to_string();
                if told.contains("set source to estimated") {
                    estimator.set("source", "estimated").expect("a choice");
                    continue;
                }
                if told.contains("there is no true flow") {
                    estimator.set("flow-source", "estimated").expect("a choice");
                    continue;
                }
                let all = ["template", "region", "contour"];
                let placed = all.into_iter().find(|name| told.contains(&format!("set {name} to none")));
                if let Some(placed) = placed {
                    prop_assert!(estimator.get(placed).expect("a parameter").to_string() != "none", "{error}");
                    estimator.set(placed, "none").expect("nothing placed");
                } else {
                    prop_assert!(told.contains("levels the coarsest is smaller than a block"), "{error}");
                    prop_assert!(estimator.get("levels").expect("a pyramid").to_string() != "2", "{error}");
                    estimator.set("levels", "2").expect("a pyramid");
                }
            }
            let mut walk = estimator.walk(&clip, 0).expect("small blocks fit");
            let unit = walk.info().granularities.len() - 2;
            let mut events = 0;
            while !walk.at_end() {
                walk.jump(Move::Granularity(unit, Direction::Forward));
                events += walk.events() as u64;
            }
            prop_assert_eq!(walk.output(), estimator.run(&clip, 0, &Threads::single()).expect("a run"));
            prop_assert_eq!(events, estimator.extent(&clip, 0).expect("an extent").events);
        }
    }

    #[test]
    fn any_parameters_in_range_run_or_are_refused_in_words(
        dice in prop::collection::vec(any::<u64>(), 16),
        (width, height) in (1usize..90, 1usize..90),
        motion in (-3i64..4, -3i64..4),
    ) {
        for mut estimator in estimators() {
            for (i, spec) in estimator.specs().iter().enumerate() {
                let value = in_range(&spec.kind, dice[i % dice.len()]);
                prop_assert!(estimator.set_value(i, value).is_ok());
            }
            let clip = moving(width, height, motion, 2);
            match estimator.walk(&clip, 0) {
                Err(error) => prop_assert!(error.to_string().len() > 20),
                Ok(mut walk) => {
                    walk.jump(Move::To(Cursor { unit: (dice[0] % 50) as usize, event: (dice[1] % 100) as usize }));
                    walk.step(Some(Focus::current([3.0, 4.0])));
                    let scene = walk.scene(None);
                    for mark in &scene.marks {
                        let odd = mark.shape.coordinates().into_iter().find(|c| !c.is_finite());
                        prop_assert!(odd.is_none(), "{}: {odd:?} in {:?}", estimator.info().id, mark.role);
                    }
                }
            }
        }
    }

    #[test]
    fn parameters_out_of_range_are_refused_with_the_range(beyond in 1i64..1000) {
        for mut estimator in estimators() {
            for (i, spec) in estimator.specs().iter().enumerate() {
                let outside = match &spec.kind {
                    Kind::Int { min, max } => vec![Value::Int(min - beyond), Value::Int(max + beyond)],
                    Kind::Real { min, max } => {
                        vec![Value::Real(min - beyond as f64), Value::Real(max + beyond as f64), Value::Real(f64::NAN)]
                    }
                    Kind::Switch => vec![Value::Int(1)],
                    Kind::Choice(_) | Kind::Optional { .. } => vec![Value::Choice("none-of-these")],
                    Kind::Stage(kind) => {
                        let wrong = estimators().into_iter().find(|other| !kind.ids().contains(&other.info().id));
                        vec![Value::Int(1), value_of(&*wrong.expect("one that cannot be this stage"))]
                    }
                    Kind::Placed(figure) => {
                        let far = [beyond as f32 * 1e6; 2];
                        vec![Value::Int(1), Value::Placed(figure.spanned([0.0; 2], far).with(Spot { frame: 0, at: far }))]
                    }
                };
                for value in outside {
                    let refusal = estimator.set_value(i, value).expect_err("out of range").to_string();
                    prop_assert!(refusal.contains(&spec.allowed()), "{refusal}");
                    prop_assert_eq!(&estimator.value(i), &spec.default);
                }
            }
        }
    }
}

#[test]
fn who_tells_a_confidence_declares_it() {
    each(|estimator| {
        let clip = moving(50, 41, (1, -2), 4);
        let told = estimator.run(&clip, 0, &Threads::single()).unwrap();
        let walk = estimator.walk(&clip, 0).unwrap();
        // Where it is asked for features alone, a method of dense fields may have some to tell otherwise.
        if told.motion() != Motion::Points {
            assert_eq!(told.confidence().is_some(), walk.tells_confidence(), "{}", estimator.info().id);
        }
    });
}

#[test]
fn a_run_makes_products_of_the_kinds_that_are_declared() {
    each(|estimator| {
        let (id, declared) = (estimator.info().id, estimator.produces());
        let clip = moving(50, 41, (1, -2), 4);
        let output = estimator.run(&clip, 0, &Threads::single()).expect("a run");
        assert!(output.kinds().count() > 0 && output.kinds().all(|kind| declared.contains(&kind)), "{id}");
        assert!(declared.iter().all(|kind| KINDS.contains(kind)), "{id}");
        // What is declared and not made by default is made with other parameters: one choice at a time.
        let choices = estimator.specs().iter().enumerate().filter_map(|(i, spec)| match &spec.kind {
            Kind::Choice(all) => Some(all.iter().map(move |choice| (i, Value::Choice(choice.name)))),
            _ => None,
        });
        let missing = |made: &[&ProductKind]| declared.iter().any(|kind| !made.contains(kind));
        let mut made: Vec<_> = output.kinds().collect();
        for (index, value) in choices.flatten().collect::<Vec<_>>() {
            if !missing(&made) {
                break;
            }
            let mut changed = estimator.boxed_clone();
            changed.set_value(index, value).expect("a choice of its own");
            made.extend(
                changed.run(&clip, 0, &Threads::single()).iter().flat_map(|output| output.kinds().collect::<Vec<_>>()),
            );
        }
        assert!(!missing(&made), "{id} declares a product that it never makes");
    });
}

#[test]
fn a_product_is_assessed_by_the_measures_of_its_kind() {
    each(|estimator| {
        let clip = moving(50, 41, (1, -2), 4);
        let output = estimator.run(&clip, 0, &Threads::single()).expect("a run");
        for product in output.products() {
            let assessment = product.assess(&Reference { clip: &clip, frame: 0 }).expect("frames that can be read");
            let is_declared = |score: &Score| {
                product.kind().measures.iter().copied().flatten().any(|measure| measure == score.measure)
            };
            assert!(assessment.scores.iter().all(is_declared), "{}", estimator.info().id);
            assert_eq!(assessment.truth_error, None, "{}", estimator.info().id);
            if let Some(table) = product.table() {
                assert!(table.rows().all(|row| row.len() == table.columns().len()), "{}", estimator.info().id);
            }
        }
    });
}

#[test]
fn a_run_that_nobody_wants_ends() {
    each(|estimator| {
        let stop = Stop::default();
        let clip = moving(50, 41, (1, -2), 4).until(stop.clone());
        stop.set(true);
        assert!(estimator.extent(&clip, 0).is_err(), "{} goes on before the eyes of someone", estimator.info().id);
        stop.set(false);
        assert!(estimator.extent(&clip, 0).is_ok());
    });
    each(|estimator| {
        let id = estimator.info().id;
        let stop = Stop::default();
        let clip = moving(50, 41, (1, -2), 4).until(stop.clone());
        for threads in [1, 2] {
            let threads = Threads::new(threads).unwrap();
            stop.set(true);
            assert!(estimator.run(&clip, 0, &threads).is_err(), "{id} goes on");
            stop.set(false);
            assert!(estimator.run(&clip, 0, &threads).is_ok(), "{id}");
        }
    });
}

#[test]
fn a_walk_that_nobody_wants_stays_where_it_is_and_can_go_on() {
    each(|estimator| {
        let id = estimator.info().id;
        let stop = Stop::default();
        let clip = moving(50, 41, (1, -2), 4).until(stop.clone());
        let mut walk = estimator.walk(&clip, 0).unwrap();
        into(Direction::Forward, &mut *walk);
        let here = walk.cursor();
        stop.set(true);
        walk.jump(Move::To(Cursor { unit: 2, event: 1 }));
        assert!(walk.failure().is_none(), "{id}: {:?} is no failure of the run", walk.failure());
        let there = walk.cursor();
        assert!(there == here || there == Cursor { unit: 2, event: 1 } || walk.at_end(), "{id}: {there}");
        stop.set(false);
        walk.jump(Move::End);
        assert!(walk.at_end() && walk.failure().is_none(), "{id}");
        let mut fresh = estimator.walk(&clip, 0).unwrap();
        fresh.jump(Move::End);
        assert!(View::of(&*walk).same(&View::of(&*fresh)), "{id}");
    });
}
