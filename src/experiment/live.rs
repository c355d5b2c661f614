//! Runs on frames as they come: pair after pair, or on through a clip that grows.
//!
//! Frames that arrive during a step are skipped. A run through the clip goes on with the next frame, others begin anew with
//! each pair. Which estimators are fast enough to be offered is measured, not declared.
//!
//! An estimator reads its frames at once, but a camera has to be waited for. So a run that asks for a frame that has not come is left, and
//! begins again once it has: at its beginning a run may do so a few times, later it needs one more frame for each step.

use std::collections::VecDeque;
use std::future::ready;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use motionscope_core::base::{Error, Stop};
use motionscope_core::data::{Clip, ClipInfo, Frame, FrameSource};
use motionscope_core::run::{AnyEstimator, Direction, FRAME, FRAMES, Move, Walk};
use web_time::{Duration, Instant};

use crate::experiment::travel::travel;
use crate::work::Boxed;

/// Frames of the past that a run can look back at.
const KEPT: usize = 64;
/// Frames after which a run through the clip begins anew, so that its memory is bounded.
const LONGEST: usize = 900;
/// Memory of the checkpoints, of which a live run needs few: it only goes forward.
const CHECKPOINTS_BYTES: u64 = 64 << 20;

/// Frames of which the shortest time counts.
const TIMED: usize = 3;

/// Frames as they come.
pub trait LiveFrames {
    /// Waits for the next frame and returns it; frames that were not taken in time are dropped.
    fn next(&mut self) -> Boxed<'_, Result<Arc<Frame>, Error>>;
}

/// A clip that grows by a frame whenever one has come.
#[derive(Default)]
struct Growing {
    kept: Mutex<Past>,
    /// Whether a frame was asked for that has not come.
    has_missed: AtomicBool,
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

    fn push(&self, frame: Arc<Frame>) {
        let mut past = self.kept();
        past.frames.push_back(frame);
        if past.frames.len() > KEPT {
            past.frames.pop_front();
            past.first += 1;
        }
    }
}

impl FrameSource for Growing {
    fn frame(&self, index: usize, _: &Stop) -> Result<Arc<Frame>, Error> {
        let past = self.kept();
        let Some(place) = index.checked_sub(past.first) else {
            return Err(Error::new(format!("frame {index} of the camera is not kept any more")));
        };
        past.frames.get(place).cloned().ok_or_else(|| {
            self.has_missed.store(true, Ordering::Relaxed);
            Error::new(format!("frame {index} of the camera has not come yet"))
        })
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
pub struct LiveRun<'a> {
    estimator: Box<dyn AnyEstimator>,
    frames: Box<dyn LiveFrames + 'a>,
    growing: Arc<Growing>,
    clip: Clip,
    stop: Stop,
    /// Whether one run goes through all frames; else each pair has a run of its own.
    is_through_clip: bool,
    walk: Option<Box<dyn Walk>>,
    /// The first frame of the next run.
    frame: usize,
}

impl<'a> LiveRun<'a> {
    /// The run of `estimator` on `frames` of a size, until `stop` is set.
    pub fn new(
        estimator: &dyn AnyEstimator,
        size: (usize, usize),
        frames: Box<dyn LiveFrames + 'a>,
        stop: Stop,
    ) -> Self {
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
        let growing = Arc::<Growing>::default();
        let clip = Clip::new(info, Arc::clone(&growing) as Arc<dyn FrameSource>);
        let room = clip.room().min(estimator.need(&clip).walk.saturating_add(CHECKPOINTS_BYTES));
        Self {
            is_through_clip: runs_on && estimator.info().granularities[0] != FRAME,
            estimator,
            frames,
            growing,
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
    pub async fn advance(&mut self) -> Result<&dyn Walk, Error> {
        let is_through_clip = self.is_through_clip;
        let mut goes_on = self.walk.take().filter(|walk| is_through_clip && !walk.at_end() && walk.failure().is_none());
        let walk = loop {
            self.growing.push(self.frames.next().await?);
            self.growing.has_missed.store(false, Ordering::Relaxed);
            let walk = self.attempt(goes_on.take()).await;
            self.stop.check()?;
            if !self.growing.has_missed.load(Ordering::Relaxed) {
                break walk?;
            }
        };
        let at = walk.at_frame();
        if self.is_through_clip && !(self.frame..=self.frame + 1).contains(&at) {
            let name = walk.info().name;
            return Err(Error::new(format!("{name} needs the last frame of a clip first, and a camera has none")));
        }
        self.frame = at + 1;
        Ok(&**self.walk.insert(walk))
    }

    /// Has a run, or a new one, go on to the end of a frame.
    async fn attempt(&self, run: Option<Box<dyn Walk>>) -> Result<Box<dyn Walk>, Error> {
        let mut walk = match run {
            Some(walk) => walk,
            None => self.estimator.walk(&self.clip, self.frame)?,
        };
        // The granularity after that of the whole run is its frames.
        let to = if self.is_through_clip { Move::Granularity(1, Direction::Forward) } else { Move::End };
        if !travel(&mut *walk, to, &|| !self.stop.is_set()).await {
            self.stop.check()?;
        }
        walk.failure().cloned().map_or(Ok(walk), Err)
    }
}

/// Frames again and again.
struct Repeated<'a> {
    frames: &'a [Arc<Frame>],
    count: usize,
}

impl LiveFrames for Repeated<'_> {
    fn next(&mut self) -> Boxed<'_, Result<Arc<Frame>, Error>> {
        self.count += 1;
        Box::pin(ready(Ok(Arc::clone(&self.frames[self.count % self.frames.len()]))))
    }
}

/// The time that `estimator` takes for a frame, measured on `frames`; `None` if that is longer than `limit`, it cannot run on them, or
/// `quit` is set.
pub async fn measure(
    estimator: &dyn AnyEstimator,
    frames: &[Arc<Frame>],
    limit: Duration,
    quit: &Stop,
) -> Option<Duration> {
    let size = frames.first()?.size();
    let (quit, begun) = (quit.clone(), Instant::now());
    let stop = Stop::when(move || quit.is_set() || begun.elapsed() > (TIMED as u32 + 1) * limit);
    let mut run = LiveRun::new(estimator, size, Box::new(Repeated { frames, count: 0 }), stop);
    let mut times = Vec::new();
    for _ in 0..=TIMED {
        let begun = Instant::now();
        run.advance().await.ok()?;
        times.push(begun.elapsed());
    }
    // Other programs make a run slower, and nothing makes it faster.
    times.into_iter().skip(1).min().filter(|time| *time <= limit)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicUsize;
    use std::thread;

    use motionscope_core::course::estimators;
    use motionscope_core::synth;

    use super::*;
    use crate::work::{self, finish};

    fn frames() -> Vec<Arc<Frame>> {
        let clip = synth::scene(crate::experiment::first::SAMPLE).unwrap();
        let clip = clip.clip(&synth::Difficulty { width: 96, height: 64, frames: 8, ..clip.difficulty() }).unwrap();
        (0..8).map(|t| clip.frame(t).unwrap()).collect()
    }

    /// Frames again and again, which are counted.
    struct Counted(Vec<Arc<Frame>>, Arc<AtomicUsize>);

    impl LiveFrames for Counted {
        fn next(&mut self) -> Boxed<'_, Result<Arc<Frame>, Error>> {
            Box::pin(ready(Ok(Arc::clone(&self.0[self.1.fetch_add(1, Ordering::Relaxed) % self.0.len()]))))
        }
    }

    /// A run on these frames again and again, and how many it has asked for.
    fn run(estimator: &dyn AnyEstimator) -> (LiveRun<'_>, Arc<AtomicUsize>) {
        let asked = Arc::new(AtomicUsize::new(0));
        let frames = Box::new(Counted(frames(), Arc::clone(&asked)));
        (LiveRun::new(estimator, (96, 64), frames, Stop::default()), asked)
    }

    /// Frames of which none comes.
    struct Silent(Stop);

    impl LiveFrames for Silent {
        fn next(&mut self) -> Boxed<'_, Result<Arc<Frame>, Error>> {
            Box::pin(async {
                loop {
                    self.0.check()?;
                    work::sleep(Duration::from_millis(1)).await;
                }
            })
        }
    }

    #[test]
    fn every_run_goes_on_with_each_frame() {
        let mut count = 0;
        for estimator in estimators().iter().filter(|one| one.units_of((96, 64), 2).is_some_and(|units| units <= 100)) {
            let (mut run, asked) = run(&**estimator);
            let name = estimator.info().id;
            // Some need what a camera does not have, such as a second view.
            let Ok(first) = finish(run.advance()).map(|walk| walk.at_frame()) else { continue };
            for t in 1..6 {
                let before = asked.load(Ordering::Relaxed);
                let walk = finish(run.advance()).unwrap_or_else(|error| panic!("{name}: {error}"));
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
        let stop = Stop::default();
        let asked = stop.clone();
        let asker = thread::spawn(move || {
            let mut run = LiveRun::new(&*estimators()[0], (96, 64), Box::new(Silent(asked.clone())), asked);
            finish(run.advance()).err()
        });
        stop.set(true);
        assert!(asker.join().unwrap().is_some());
    }

    #[test]
    fn what_takes_too_long_is_not_measured() {
        let (frames, first, quit) = (frames(), &estimators()[0], Stop::default());
        let time =
            |frames: &[Arc<Frame>], limit_s| finish(measure(&**first, frames, Duration::from_secs(limit_s), &quit));
        assert!(time(&frames, 20).is_some() && time(&frames, 0).is_none() && time(&[], 20).is_none());
    }
}
