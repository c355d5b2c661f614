//! Runs on frames as they come: pair after pair, or on through a clip that grows.
//!
//! Frames that arrive during a step are skipped. A run through the clip goes on with the next frame, others begin anew with
//! each pair. Which estimators are fast enough to be offered is measured, not declared.

use std::collections::VecDeque;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use motionscope_core::base::{Error, Stop};
use motionscope_core::data::{Clip, ClipInfo, Frame, FrameSource};
use motionscope_core::run::{AnyEstimator, Direction, FRAME, FRAMES, Move, Walk};
use web_time::{Duration, Instant};

/// Frames of the past that a run can look back at.
const KEPT: usize = 64;
/// Frames after which a run through the clip begins anew, so that its memory is bounded.
const LONGEST: usize = 900;
/// Memory of the checkpoints, of which a live run needs few: it only goes forward.
const CHECKPOINTS_BYTES: u64 = 64 << 20;

/// Frames of which the shortest time counts.
const TIMED: usize = 3;
/// Time between two checks whether a measurement was cancelled.
const POLL: Duration = Duration::from_millis(10);

/// Waits for the next frame and returns it; frames that were not taken in time are dropped.
pub type NextFrame = Box<dyn Fn(&Stop) -> Result<Arc<Frame>, Error> + Send + Sync>;

/// A clip that grows by a frame whenever a run asks for one.
struct Growing {
    next: NextFrame,
    kept: Mutex<Past>,
}

/// The frames that were delivered last.
#[derive(Default)]
struct Past {
    /// Number of the oldest one.
    first: usize,
    frames: VecDeque<Arc<Frame>>,
}

impl Growing {
    fn kept(&self) -> MutexGuard<'_, Past> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl FrameSource for Growing {
    fn frame(&self, index: usize, stop: &Stop) -> Result<Arc<Frame>, Error> {
        loop {
            let past = self.kept();
            if let Some(frame) = index.checked_sub(past.first).and_then(|i| past.frames.get(i)) {
                return Ok(Arc::clone(frame));
            }
            if index < past.first {
                return Err(Error::new(format!("frame {index} of the camera is not kept any more")));
            }
            // Reading an earlier frame does not wait for the next one.
            drop(past);
            let frame = (self.next)(stop)?;
            let mut past = self.kept();
            past.frames.push_back(frame);
            if past.frames.len() > KEPT {
                past.frames.pop_front();
                past.first += 1;
            }
        }
    }

    fn cached(&self, index: usize) -> Option<Arc<Frame>> {
        let past = self.kept();
        index.checked_sub(past.first).and_then(|i| past.frames.get(i)).cloned()
    }

    fn has_frame(&self, _: usize, _: &Stop) -> Result<bool, Error> {
        Ok(true)
    }
}

/// A run of an estimator on frames as they come.
pub struct LiveRun {
    estimator: Box<dyn AnyEstimator>,
    clip: Clip,
    stop: Stop,
    /// Whether one run goes through all frames; else each pair has a run of its own.
    is_through_clip: bool,
    walk: Option<Box<dyn Walk>>,
    /// The first frame of the next run.
    frame: usize,
}

impl LiveRun {
    /// The run of `estimator` on frames of a size, which `next` delivers, until `stop` is set.
    pub fn new(estimator: &dyn AnyEstimator, size: (usize, usize), next: NextFrame, stop: Stop) -> Self {
        let info = ClipInfo {
            name: "Camera".into(),
            width: size.0,
            height: size.1,
            frames: None,
            fps: None,
            container: "live".into(),
            codec: "raw".into(),
            warnings: Vec::new(),
        };
        let mut estimator = estimator.boxed_clone();
        let runs_on = estimator.specs().iter().any(|spec| spec.name == FRAMES);
        // An estimator that allows fewer keeps its number.
        estimator.set(FRAMES, &LONGEST.to_string()).unwrap_or_default();
        let clip = Clip::new(info, Arc::new(Growing { next, kept: Mutex::default() }));
        let room = clip.room().min(estimator.need(&clip).walk.saturating_add(CHECKPOINTS_BYTES));
        Self {
            is_through_clip: runs_on && estimator.info().granularities[0] != FRAME,
            estimator,
            clip: clip.within(room).until(stop.clone()),
            stop,
            walk: None,
            frame: 0,
        }
    }

    /// The frames so far.
    pub fn clip(&self) -> &Clip {
        &self.clip
    }

    /// The estimator as it runs.
    pub fn estimator(&self) -> &dyn AnyEstimator {
        &*self.estimator
    }

    /// Runs on the next frame, and returns the run at its end.
    ///
    /// # Errors
    /// If there are no more frames, the estimator cannot run on them, or the run was stopped.
    pub fn advance(&mut self) -> Result<&dyn Walk, Error> {
        let is_through_clip = self.is_through_clip;
        let goes_on = self.walk.take().filter(|walk| is_through_clip && !walk.at_end() && walk.failure().is_none());
        let mut walk = match goes_on {
            Some(walk) => walk,
            None => self.estimator.walk(&self.clip, self.frame)?,
        };
        // The granularity after that of the whole run is its frames.
        let to = if is_through_clip { Move::Granularity(1, Direction::Forward) } else { Move::End };
        walk.jump_while(to, &|| !self.stop.is_set());
        self.stop.check()?;
        if let Some(error) = walk.failure() {
            return Err(error.clone());
        }
        let at = walk.at_frame();
        if self.is_through_clip && !(self.frame..=self.frame + 1).contains(&at) {
            let name = walk.info().name;
            return Err(Error::new(format!("{name} needs the last frame of a clip first, and a camera has none")));
        }
        self.frame = at + 1;
        Ok(&**self.walk.insert(walk))
    }
}

/// The time that `estimator` takes for a frame, measured on `frames`; `None` if that is longer than `limit`, it cannot run on them, or
/// `quit` is set.
pub fn measure(estimator: &dyn AnyEstimator, frames: &[Arc<Frame>], limit: Duration, quit: &Stop) -> Option<Duration> {
    let size = frames.first()?.size();
    let (stop, asked) = (Stop::default(), Mutex::new(0));
    // As often as they are asked for.
    let frames: Arc<[Arc<Frame>]> = frames.into();
    let next: NextFrame = Box::new(move |stop| {
        let mut asked = asked.lock().unwrap_or_else(PoisonError::into_inner);
        *asked += 1;
        stop.check().map(|()| Arc::clone(&frames[*asked % frames.len()]))
    });
    let (done, is_done) = channel::<()>();
    let (late, quit, begun) = (stop.clone(), quit.clone(), Instant::now());
    let watch = thread::spawn(move || {
        while is_done.recv_timeout(POLL) == Err(RecvTimeoutError::Timeout) {
            late.set(quit.is_set() || begun.elapsed() > (TIMED as u32 + 1) * limit);
        }
    });
    let mut run = LiveRun::new(estimator, size, next, stop);
    let mut timed = || {
        let begun = Instant::now();
        run.advance().map(|_| begun.elapsed())
    };
    let times: Result<Vec<_>, Error> = (0..=TIMED).map(|_| timed()).collect();
    drop(done);
    watch.join().unwrap_or_default();
    // Other programs make a run slower, and nothing makes it faster.
    times.ok()?.into_iter().skip(1).min().filter(|time| *time <= limit)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use motionscope_core::course::estimators;
    use motionscope_core::synth;

    use super::*;

    fn frames() -> Vec<Arc<Frame>> {
        let clip = synth::scene(crate::experiment::first::SAMPLE).unwrap();
        let clip = clip.clip(&synth::Difficulty { width: 96, height: 64, frames: 8, ..clip.difficulty() }).unwrap();
        (0..8).map(|t| clip.frame(t).unwrap()).collect()
    }

    /// A run on these frames again and again, and how many it has asked for.
    fn run(estimator: &dyn AnyEstimator) -> (LiveRun, Arc<AtomicUsize>) {
        let (frames, asked) = (frames(), Arc::new(AtomicUsize::new(0)));
        let count = Arc::clone(&asked);
        let next = move |stop: &Stop| {
            stop.check().map(|()| Arc::clone(&frames[count.fetch_add(1, Ordering::Relaxed) % frames.len()]))
        };
        (LiveRun::new(estimator, (96, 64), Box::new(next), Stop::default()), asked)
    }

    #[test]
    fn every_run_goes_on_with_each_frame() {
        let mut count = 0;
        for estimator in estimators().iter().filter(|one| one.units_of((96, 64), 2).is_some_and(|units| units <= 100)) {
            let (mut run, asked) = run(&**estimator);
            let name = estimator.info().id;
            // Some need what a camera does not have, such as a second view.
            let Ok(first) = run.advance().map(|walk| walk.at_frame()) else { continue };
            for t in 1..6 {
                let before = asked.load(Ordering::Relaxed);
                let walk = run.advance().unwrap_or_else(|error| panic!("{name}: {error}"));
                assert_eq!(walk.at_frame(), first + t, "{name}");
                let taken = asked.load(Ordering::Relaxed);
                // Some begin with the median of the first frames, which they then go through.
                assert!((1..=KEPT).contains(&(taken - walk.at_frame())), "{name}: {taken} at {}", walk.at_frame());
                assert!(taken - before <= 1, "{name} takes {} frames at once", taken - before);
            }
            count += 1;
        }
        assert!(count >= 12, "{count} estimators");
    }

    #[test]
    fn a_run_that_is_stopped_waits_no_longer() {
        let estimator = &estimators()[0];
        let stop = Stop::default();
        let waits = |stop: &Stop| loop {
            stop.check()?;
            thread::sleep(Duration::from_millis(1));
        };
        let mut run = LiveRun::new(&**estimator, (96, 64), Box::new(waits), stop.clone());
        let asker = thread::spawn(move || run.advance().err());
        stop.set(true);
        assert!(asker.join().unwrap().is_some());
    }

    #[test]
    fn what_takes_too_long_is_not_measured() {
        let (frames, first, quit) = (frames(), &estimators()[0], Stop::default());
        let time = |frames: &[Arc<Frame>], limit_s| measure(&**first, frames, Duration::from_secs(limit_s), &quit);
        assert!(time(&frames, 20).is_some() && time(&frames, 0).is_none() && time(&[], 20).is_none());
    }
}
