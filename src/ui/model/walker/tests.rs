//! The walker with real runs.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use motionscope_core::base::Stop;
use motionscope_core::course::estimator;
use motionscope_core::data::{Clip, Flow, Frame, FrameSource};
use motionscope_core::geometry::Grid;
use motionscope_core::run::Cursor;
use motionscope_core::scene::{Picture, Readout};

use super::super::snapshot::Near;
use super::*;
use crate::experiment::Experiment;
use crate::experiment::source::Source;
use crate::paint::{FlowLayer, View as PictureView};

fn clip() -> Clip {
    let texture = |x: usize, y: usize| (x * 31 + y * 57 + x * y % 7 * 20) as u8;
    let frame = |shift: usize| Frame::gray(Grid::from_fn(64, 48, |x, y| texture(x + 4 - shift, y)));
    Clip::from_frames("shift", vec![frame(0), frame(2)]).unwrap()
}

fn subject() -> Prepared {
    let mut estimator = estimator("full-search").unwrap();
    estimator.set("search-range", "4").unwrap();
    let experiment = Experiment::new(Source::File("shift".into()), estimator);
    Prepared { experiment, clip: clip(), inputs: Arc::default() }
}

fn job() -> Job {
    Job { subject: Arc::new(subject()), place: Place::default() }
}

/// A run that takes a second or so, to be begun at its end.
fn long() -> Job {
    let mut subject = subject();
    let frame = |t: usize| Frame::gray(Grid::from_fn(1600, 1200, |x, y| (x * 31 + y * 57 + x * y % 7 * 20 + t) as u8));
    subject.clip = Clip::from_frames("long", vec![frame(0), frame(2)]).unwrap();
    for (name, value) in [("block-size", "8"), ("spacing", "2"), ("search-range", "16")] {
        subject.experiment.estimator.set(name, value).unwrap();
    }
    Job { subject: Arc::new(subject), place: Place::END }
}

fn started() -> Walker {
    let walker = Walker::new(|| {}).unwrap();
    walker.start(job());
    walker.wait();
    walker
}

fn cursor(walker: &Walker) -> Cursor {
    walker.wait();
    walker.view().shown.map(|shown| shown.cursor).unwrap()
}

#[test]
fn there_and_back_again() {
    let walker = started();
    walker.go(Move::To(Cursor { unit: 3, event: 7 }));
    assert_eq!(cursor(&walker), Cursor { unit: 3, event: 7 });
    let before = walker.view().shown.unwrap();
    walker.go(Move::Granularity(2, Direction::Forward));
    walker.go(Move::Granularity(2, Direction::Back));
    walker.wait();
    let after = walker.view().shown.unwrap();
    // Costs that are not known yet are NaN, so it is the words that are compared.
    let message = |shown: &Snapshot| format!("{} {:?} {:?}", shown.cursor, shown.step, shown.scene);
    assert!(message(&after) == message(&before));
}

#[test]
fn a_refused_run_leaves_the_last_picture() {
    let walker = started();
    let mut beyond = subject();
    beyond.experiment.frame = 9;
    walker.start(Job { subject: Arc::new(beyond), place: Place::default() });
    walker.wait();
    let view = walker.view();
    assert!(view.shown.is_some() && view.refused.is_some_and(|error| error.to_string().contains("frame")));
    let before = cursor(&walker);
    walker.focus(Some(Focus::current([3.0, 3.0])));
    walker.go(Move::Granularity(2, Direction::Forward));
    walker.wait();
    assert!(walker.view().refused.is_some() && cursor(&walker) == before, "the old run is no more");
    walker.start(job());
    walker.wait();
    assert!(walker.view().refused.is_none());
}

/// Frames that take for ever, until they are cancelled.
struct Slow(Arc<AtomicBool>);

impl FrameSource for Slow {
    fn frame(&self, _index: usize, stop: &Stop) -> Result<Arc<Frame>, Error> {
        self.0.store(true, Ordering::SeqCst);
        loop {
            stop.check()?;
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn cached(&self, _index: usize) -> Option<Arc<Frame>> {
        None
    }
}

/// Has `walker` wait for a frame that never comes.
fn stuck(walker: &Walker) {
    let asked = Arc::new(AtomicBool::new(false));
    let clip = Clip::new(clip().info().clone(), Arc::new(Slow(Arc::clone(&asked))));
    walker.start(Job { subject: Arc::new(Prepared { clip, ..subject() }), place: Place::default() });
    while !asked.load(Ordering::SeqCst) {
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn a_cancelled_frame_is_not_waited_for() {
    let walker = Walker::new(|| {}).unwrap();
    stuck(&walker);
    walker.start(job());
    walker.wait();
    assert!(walker.view().shown.is_some() && walker.view().refused.is_none());
    stuck(&walker);
    drop(walker);
}

#[test]
fn a_run_begins_where_it_is_wanted() {
    let walker = Walker::new(|| {}).unwrap();
    let place = Place {
        cursor: Cursor { unit: 0, event: 5 },
        near: Near::Pixel(Focus::current([40.0, 20.0])),
        ..Place::default()
    };
    walker.start(Job { place, ..job() });
    assert_eq!(cursor(&walker), Cursor { unit: 6, event: 5 });
    walker.go_at(Focus::current([1.0, 1.0]), Side::End);
    assert_eq!((cursor(&walker).unit, cursor(&walker).event > 1), (0, true));
    walker.go_at(Focus::current([40.0, 20.0]), Side::Start);
    assert_eq!(cursor(&walker), Cursor { unit: 6, event: 1 });
}

#[test]
fn nothing_is_reported_while_nothing_changes() {
    let count = Arc::new(AtomicUsize::new(0));
    let message = Arc::clone(&count);
    let walker = Walker::new(move || {
        message.fetch_add(1, Ordering::SeqCst);
    })
    .unwrap();
    walker.start(job());
    walker.wait();
    std::thread::sleep(Duration::from_millis(20));
    let before = count.load(Ordering::SeqCst);
    walker.focus(None);
    std::thread::sleep(Duration::from_millis(20));
    assert_eq!(count.load(Ordering::SeqCst), before);
}

#[test]
fn the_pointer_makes_no_picture_anew() {
    let mut subject = subject();
    subject.experiment.estimator = estimator("running-average").unwrap();
    let walker = Walker::new(|| {}).unwrap();
    walker.look(&Look { view: Some(PictureView::SideBySide), ..Look::default() });
    walker.start(Job { subject: Arc::new(subject), place: Place::END });
    let shown = |focus: Option<Focus>| {
        walker.focus(focus);
        walker.wait();
        walker.view().shown.unwrap()
    };
    let before = shown(None);
    assert!(before.pictures.beside.iter().any(|(picture, _)| *picture == Picture::REFERENCE), "it is shown");
    for x in 0..5 {
        let next = shown(Some(Focus::on(Picture::NEXT, [x as f32, 3.0])));
        assert!(Arc::ptr_eq(&next, &before), "no pixel of frame t+1 is explained, so nothing is shown anew");
    }
    for x in 0..5 {
        let explained = shown(Some(Focus::current([x as f32, 3.0])));
        assert!(explained.pointed.is_some() && !Arc::ptr_eq(&explained, &before));
        for ((_, frame), (_, other)) in explained.pictures.beside.iter().zip(&before.pictures.beside) {
            assert!(Arc::ptr_eq(frame, other), "a picture of the step is made once");
        }
    }
    assert!(shown(None).pointed.is_none(), "the pixel is let go");
}

#[test]
fn a_place_replaces_what_was_asked_before() {
    let walker = started();
    for event in 1..200 {
        walker.go(Move::To(Cursor { unit: 5, event: event % 60 + 1 }));
    }
    walker.go(Move::To(Cursor { unit: 1, event: 1 }));
    assert_eq!(cursor(&walker), Cursor { unit: 1, event: 1 });
    let shown = walker.view().shown.unwrap();
    assert!(walker.output(&shown).recv().is_ok_and(|output| output.flow().is_some_and(|flow| flow.at(0, 0).is_some())));
    walker.go(Move::Granularity(2, Direction::Forward));
    assert!(walker.output(&shown).recv().is_err(), "the run has moved on");
}

#[test]
fn a_small_move_waits_for_a_run_to_come_to_its_place() {
    let walker = Walker::new(|| {}).unwrap();
    walker.start(long());
    std::thread::sleep(2 * SLOW_AFTER);
    assert!(walker.view().shown.is_none_or(|shown| !shown.at_end), "it takes longer than that");
    walker.go(Move::Granularity(2, Direction::Back));
    walker.wait();
    let shown = walker.view().shown.unwrap();
    assert_eq!((Some(shown.cursor.unit + 1), shown.cursor.event + 1), (shown.units, shown.events));
}

#[test]
fn a_run_that_is_stopped_on_its_way_stays_where_it_is() {
    let walker = Walker::new(|| {}).unwrap();
    walker.start(long());
    std::thread::sleep(2 * SLOW_AFTER);
    walker.stop();
    walker.wait();
    assert!(walker.view().shown.is_some_and(|shown| !shown.at_end && shown.bound_for.is_none()));
    // Before anything was shown, that is its start.
    walker.start(long());
    walker.stop();
    assert_eq!(cursor(&walker), Cursor::default());
    walker.go(Move::Granularity(2, Direction::Forward));
    assert_eq!(cursor(&walker), Cursor { unit: 0, event: 1 });
}

/// Two frames that are not delivered while they are held.
struct Held(Clip, AtomicBool);

impl FrameSource for Held {
    fn frame(&self, index: usize, stop: &Stop) -> Result<Arc<Frame>, Error> {
        while self.1.load(Ordering::Relaxed) {
            stop.check()?;
            std::thread::yield_now();
        }
        self.0.frame(index)
    }

    fn cached(&self, _index: usize) -> Option<Arc<Frame>> {
        None
    }
}

#[test]
fn a_check_that_takes_long_is_given_up_and_can_be_tried_again() {
    let source = Arc::new(Held(clip(), AtomicBool::new(false)));
    let subject = Prepared { clip: Clip::new(clip().info().clone(), Arc::clone(&source) as _), ..subject() };
    let walker = Walker::new(|| {}).unwrap();
    walker.start(Job { subject: Arc::new(subject), place: Place::END });
    walker.wait();
    source.1.store(true, Ordering::Relaxed);
    let seen = |layer| Look { layer: Some(layer), ..Look::default() };
    walker.look(&seen(FlowLayer::Consistency));
    while !walker.view().checking {
        std::thread::yield_now();
    }
    walker.stop();
    walker.wait();
    let message = |walker: &Walker| {
        let shown = walker.view().shown.unwrap();
        shown.step.readouts.iter().any(|readout| match readout {
            Readout::Facts(facts) => facts.iter().any(|fact| fact.label == "Reverse pair"),
            _ => false,
        })
    };
    assert!(message(&walker), "why there is no check is told");
    source.1.store(false, Ordering::Relaxed);
    walker.look(&seen(FlowLayer::Wheel));
    walker.wait();
    walker.look(&seen(FlowLayer::Consistency));
    walker.wait();
    let layer = walker.view().shown.unwrap().pictures.layer.clone();
    assert_eq!(layer.map(|layer| layer.kind), Some(FlowLayer::Consistency));
    assert!(!message(&walker));
}

/// What never comes as long as it is held, whether it is wanted or not.
struct Uncancellable(Clip, Arc<AtomicBool>);

impl Uncancellable {
    fn wait(&self) {
        while self.1.load(Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

impl FrameSource for Uncancellable {
    fn frame(&self, index: usize, _stop: &Stop) -> Result<Arc<Frame>, Error> {
        self.wait();
        self.0.frame(index)
    }

    fn cached(&self, _index: usize) -> Option<Arc<Frame>> {
        None
    }
}

impl motionscope_core::data::Truth for Uncancellable {
    fn flow(&self, _t: usize) -> Result<Option<Arc<Flow>>, Error> {
        self.wait();
        Ok(None)
    }

    fn kinds(&self) -> Vec<&'static str> {
        vec!["flow"]
    }
}

/// Tends `walker` until it is idle.
fn tended(walker: &mut Walker) {
    let begun = Instant::now();
    while !walker.wait_for(Duration::from_millis(5)) {
        walker.tend();
        assert!(begun.elapsed() < Duration::from_secs(20), "it is busy for ever");
    }
}

#[test]
fn a_run_that_cannot_be_interrupted_is_left_behind() {
    let held = Arc::new(AtomicBool::new(true));
    let mut walker = Walker::new(|| {}).unwrap();
    let clip = Clip::new(clip().info().clone(), Arc::new(Uncancellable(clip(), Arc::clone(&held))));
    let held_job = || Job { subject: Arc::new(Prepared { clip: clip.clone(), ..subject() }), place: Place::default() };
    walker.start(held_job());
    std::thread::sleep(2 * SLOW_AFTER);
    assert!(walker.view().busy_for.is_some_and(|time| time > SLOW_AFTER));
    let begun = Instant::now();
    walker.stop();
    tended(&mut walker);
    assert!(begun.elapsed() < Duration::from_secs(5), "it stops at once: {:?}", begun.elapsed());
    assert!(walker.view().refused.is_some_and(|error| error.to_string().contains("cancelled before")));

    // Nor does it stand in the way of another one.
    walker.start(held_job());
    std::thread::sleep(2 * SLOW_AFTER);
    walker.start(job());
    tended(&mut walker);
    assert!(walker.view().refused.is_none() && walker.view().shown.is_some());
    walker.go(Move::Granularity(2, Direction::Forward));
    assert_eq!(cursor(&walker), Cursor { unit: 0, event: 1 });

    // Those that were left behind end when they can.
    held.store(false, Ordering::Relaxed);
    while !walker.left.is_empty() {
        walker.tend();
        std::thread::sleep(Duration::from_millis(1));
    }
}

#[test]
fn what_was_left_behind_is_taken_up_where_it_was() {
    let held = Arc::new(AtomicBool::new(true));
    let truth = Arc::new(Uncancellable(clip(), Arc::clone(&held)));
    let mut walker = Walker::new(|| {}).unwrap();
    let clip = clip().with_truth(truth);
    walker.start(Job { subject: Arc::new(Prepared { clip, ..subject() }), place: Place::END });
    while walker.view().phase != Phase::Measuring {
        std::thread::yield_now();
    }
    assert!(walker.view().shown.is_none() && walker.view().coming.is_some(), "its frames are known");
    walker.stop();
    tended(&mut walker);
    let shown = walker.view().shown.unwrap();
    assert_eq!((shown.cursor, shown.events), (Cursor::default(), 0), "what was known is shown");
    held.store(false, Ordering::Relaxed);
    let output = walker.output(&shown);
    walker.go(Move::End);
    walker.wait();
    assert!(walker.view().shown.is_some_and(|shown| shown.at_end) && output.recv().is_ok());
}

/// Frames that take a while each.
struct SlowFrames(Clip);

impl FrameSource for SlowFrames {
    fn frame(&self, index: usize, stop: &Stop) -> Result<Arc<Frame>, Error> {
        stop.check()?;
        std::thread::sleep(Duration::from_millis(if index > 1 { 60 } else { 0 }));
        self.0.frame(index % 2)
    }

    fn cached(&self, _index: usize) -> Option<Arc<Frame>> {
        None
    }
}

#[test]
fn a_long_run_shows_how_far_it_has_come_and_can_be_stopped_there() {
    let info = motionscope_core::data::ClipInfo { frames: Some(200), ..clip().info().clone() };
    let clip = Clip::new(info, Arc::new(SlowFrames(clip())));
    let estimator = estimator("frame-difference").unwrap();
    let walker = Walker::new(|| {}).unwrap();
    let experiment = Experiment::new(Source::File("long".into()), estimator);
    let subject = Arc::new(Prepared { experiment, clip, inputs: Arc::default() });
    walker.start(Job { subject: Arc::clone(&subject), place: Place::END });
    let begun = Instant::now();
    let shown = loop {
        match walker.view().shown {
            Some(shown) if shown.bound_for.is_some() => break shown,
            _ => assert!(begun.elapsed() < Duration::from_secs(20), "nothing is shown"),
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    assert!(shown.cursor.unit > 1 && !shown.at_end && walker.view().busy, "{}", shown.cursor);
    assert_eq!(Place::of(&shown), Place::END, "with other parameters it is bound for the same place");
    while walker.view().progress.is_none_or(|(done, _)| done <= shown.cursor.unit) {
        assert!(begun.elapsed() < Duration::from_secs(20), "no progress is told");
        std::thread::sleep(Duration::from_millis(1));
    }
    let progress = walker.view().progress;
    assert!(progress.is_some_and(|(done, of)| done > shown.cursor.unit && done < of), "{progress:?}");
    walker.stop();
    walker.wait();
    let stopped = walker.view().shown.unwrap();
    assert!(stopped.cursor >= shown.cursor && stopped.bound_for.is_none() && !stopped.at_end, "{}", stopped.cursor);
    walker.go(Move::Granularity(2, Direction::Forward));
    assert!(cursor(&walker) > stopped.cursor);
}
