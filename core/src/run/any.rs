//! A type-erased estimator: its declaration, and how to start a run.

use std::any::Any;

use super::{Estimator, Footprint, Guarantee, Info, Need, Progress, StageView, Timeline, Walk, need};
use crate::base::{Count, Error, Tally, Threads, heap};
use crate::data::Clip;
use crate::params::Params;
use crate::products::{Output, ProductKind};
use crate::scene::{Chart, Question};

/// Rejects a clip of detections alone for estimators that read frames.
fn check_pictures<E: Estimator>(clip: &Clip) -> Result<(), Error> {
    if !E::NEEDS_PICTURES || !clip.is_blank() {
        return Ok(());
    }
    Err(Error::new(format!(
        "{} has detections but no frames, and {} needs frames; choose a tracker, or open a video",
        clip.info().name,
        E::INFO.id
    )))
}

/// Refuses a run for which there is not enough memory.
fn check_memory<E: Estimator>(estimator: &E, clip: &Clip, of: fn(Need) -> u64) -> Result<(), Error> {
    need::check(clip, E::INFO.name, of(Footprint::need(estimator, clip)))
}

/// Checks that a run is possible and wanted.
fn check_run<E: Estimator>(estimator: &E, clip: &Clip) -> Result<(), Error> {
    check_pictures::<E>(clip)?;
    check_memory(estimator, clip, |need| need.run)?;
    clip.wanted()?;
    heap::keep();
    Ok(())
}

/// The size of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Units.
    pub units: usize,
    /// Events that stepping through it shows.
    pub events: u64,
    /// Memory that the run needs beside the two frames, in bytes.
    pub memory_bytes: usize,
}

/// The products and the size of a whole run.
pub struct RunSummary {
    /// The products.
    pub output: Output,
    /// The products as known in real time, if the parameters use later frames.
    pub causal: Option<Output>,
    /// The size.
    pub extent: Extent,
}

impl RunSummary {
    fn of<E: Estimator>(estimator: &E, state: &E::State, count: &Count) -> Self {
        let extent =
            Extent { units: count.units(), events: count.events(), memory_bytes: estimator.memory_bytes(state) };
        Self { causal: estimator.causal(state), output: estimator.output(state), extent }
    }
}

/// An estimator of any type, as the window and the command line hold it.
pub trait AnyEstimator: Params + Send + Sync {
    /// Its declaration.
    fn info(&self) -> &'static Info;

    /// The kinds of products that a run may make, the main one first.
    fn produces(&self) -> &'static [&'static ProductKind];

    /// The motion it is guaranteed to find, for tests.
    fn guarantee(&self) -> Guarantee;

    /// Whether its products belong to single frames, without motion from one to the next.
    fn is_of_single_frames(&self) -> bool {
        self.info().frames == 1 || self.produces().iter().all(|kind| kind.is_of_single_frames)
    }

    /// Whether frame t alone shows its run, without a second frame or pictures of its own.
    fn shows_frame_alone(&self) -> bool {
        self.is_of_single_frames() && !self.produces().iter().any(|kind| kind.has_pictures)
    }

    /// As [`Estimator::units_of`].
    fn units_of(&self, picture: (usize, usize), frames: usize) -> Option<usize>;

    /// As [`Estimator::earlier_frames`].
    fn earlier_frames(&self) -> Option<usize>;

    /// Whether a unit of a run is a frame of the clip.
    fn is_by_frame(&self) -> bool {
        self.units_of((1, 1), 1) == Some(1)
    }

    /// As [`Estimator::lends`].
    fn lends(&self) -> Option<Box<dyn Any>>;

    /// As [`Estimator::stage_view`].
    ///
    /// # Errors
    /// If a frame cannot be read.
    fn stage_view(&self, clip: &Clip, now: usize) -> Result<Option<StageView>, Error>;

    /// Whether it tests candidates of blocks: such estimators can run in lockstep.
    fn tests_candidates(&self) -> bool;

    /// The parameter whose values are contrasted if it runs in lockstep with itself.
    fn contrasts(&self) -> Option<&'static str>;

    /// Whether it reads frames; some estimators read detections only.
    fn needs_pictures(&self) -> bool;

    /// The charts that its steps may fill.
    fn charts(&self) -> &'static [Chart];

    /// As [`Estimator::QUESTIONS`].
    fn questions(&self) -> &'static [Question];

    /// The same estimator with the same parameters.
    fn boxed_clone(&self) -> Box<dyn AnyEstimator>;

    /// Estimated peak memory of a run on a clip, without the frames of the clip.
    fn need(&self, clip: &Clip) -> Need;

    /// A run that can be walked through in both directions.
    ///
    /// # Errors
    /// If the clip, the frame, the parameters or the memory do not allow a run.
    fn walk(&self, clip: &Clip, frame: usize) -> Result<Box<dyn Walk>, Error>;

    /// The result of a whole run.
    ///
    /// # Errors
    /// If the clip, the frame, the parameters or the memory do not allow a run.
    fn run(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<Output, Error>;

    /// A whole run with its summary; its size is counted on the way.
    ///
    /// # Errors
    /// If the clip, the frame, the parameters or the memory do not allow a run.
    fn run_counted(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<RunSummary, Error>;

    /// A run that is advanced unit by unit.
    ///
    /// # Errors
    /// If the clip, the frame or the parameters do not allow a run.
    fn begin(&self, clip: &Clip, frame: usize) -> Result<Box<dyn AnyRun>, Error>;

    /// The same with its size counted on the way.
    ///
    /// # Errors
    /// As [`AnyEstimator::begin`].
    fn begin_counted(&self, clip: &Clip, frame: usize) -> Result<Box<dyn CountedRun>, Error>;

    /// The size of a whole run, without its result.
    ///
    /// # Errors
    /// If the clip, the frame, the parameters or the memory do not allow a run.
    fn extent(&self, clip: &Clip, frame: usize) -> Result<Extent, Error> {
        self.run_counted(clip, frame, &Threads::single()).map(|ran| ran.extent)
    }

    /// Number of candidates tested by each unit of a whole run.
    ///
    /// # Errors
    /// If the clip, the frame, the parameters or the memory do not allow a run.
    fn evaluations(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<Vec<u32>, Error>;
}

/// A run that is advanced unit by unit.
pub trait AnyRun: Send {
    /// Does the next unit.
    ///
    /// # Errors
    /// As [`Estimator::advance`].
    fn advance(&mut self) -> Result<Progress, Error>;

    /// The products so far.
    fn output(&self) -> Output;

    /// Memory that its state takes with all that is shared, in bytes.
    fn bytes(&self) -> usize;
}

/// A run whose units and events are counted.
pub trait CountedRun: AnyRun {
    /// The products and the size so far.
    fn summary(&self) -> RunSummary;
}

/// The run of one estimator.
struct Running<E: Estimator, T> {
    estimator: E,
    clip: Clip,
    state: E::State,
    tally: T,
}

impl<E: Estimator, T: Tally<E::Event>> Running<E, T> {
    fn begin(estimator: &E, clip: &Clip, frame: usize, tally: T) -> Result<Self, Error> {
        check_pictures::<E>(clip)?;
        check_memory(estimator, clip, |need| need.run)?;
        let state = estimator.start(clip, frame)?;
        Ok(Self { estimator: estimator.clone(), clip: clip.clone(), state, tally })
    }
}

impl<E: Estimator, T: Tally<E::Event> + Send> AnyRun for Running<E, T> {
    fn advance(&mut self) -> Result<Progress, Error> {
        let Self { estimator, clip, state, tally } = self;
        clip.wanted()?;
        tally.add_units(1);
        estimator.advance(clip, state, &mut tally.counter())
    }

    fn output(&self) -> Output {
        self.estimator.output(&self.state)
    }

    fn bytes(&self) -> usize {
        self.estimator.memory_bytes(&self.state)
    }
}

impl<E: Estimator> CountedRun for Running<E, Count> {
    fn summary(&self) -> RunSummary {
        RunSummary::of(&self.estimator, &self.state, &self.tally)
    }
}

impl<E: Estimator> AnyEstimator for E {
    fn info(&self) -> &'static Info {
        const { &E::INFO }
    }

    fn produces(&self) -> &'static [&'static ProductKind] {
        E::PRODUCES
    }

    fn guarantee(&self) -> Guarantee {
        E::GUARANTEE
    }

    fn units_of(&self, picture: (usize, usize), frames: usize) -> Option<usize> {
        Estimator::units_of(self, picture, frames)
    }

    fn earlier_frames(&self) -> Option<usize> {
        Estimator::earlier_frames(self)
    }

    fn lends(&self) -> Option<Box<dyn Any>> {
        Estimator::lends(self)
    }

    fn stage_view(&self, clip: &Clip, now: usize) -> Result<Option<StageView>, Error> {
        Estimator::stage_view(self, clip, now)
    }

    fn tests_candidates(&self) -> bool {
        self.tests().is_some()
    }

    fn contrasts(&self) -> Option<&'static str> {
        E::CONTRASTS
    }

    fn needs_pictures(&self) -> bool {
        E::NEEDS_PICTURES
    }

    fn charts(&self) -> &'static [Chart] {
        E::CHARTS
    }

    fn questions(&self) -> &'static [Question] {
        E::QUESTIONS
    }

    fn boxed_clone(&self) -> Box<dyn AnyEstimator> {
        Box::new(self.clone())
    }

    fn need(&self, clip: &Clip) -> Need {
        Footprint::need(self, clip)
    }

    fn walk(&self, clip: &Clip, frame: usize) -> Result<Box<dyn Walk>, Error> {
        check_pictures::<E>(clip)?;
        check_memory(self, clip, |need| need.walk)?;
        // The remaining memory may hold checkpoints.
        let left = clip.room().saturating_sub(Footprint::need(self, clip).walk);
        let budget = Timeline::<E>::BUDGET_BYTES.min(usize::try_from(left / 2).unwrap_or(usize::MAX));
        Ok(Box::new(Timeline::new(self.clone(), clip.clone(), frame)?.with_budget(budget)))
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<Output, Error> {
        check_run(self, clip)?;
        Estimator::run(self, clip, frame, threads, &()).map(|state| self.output(&state))
    }

    fn run_counted(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<RunSummary, Error> {
        check_run(self, clip)?;
        let count = Count::default();
        let state = Estimator::run(self, clip, frame, threads, &count)?;
        Ok(RunSummary::of(self, &state, &count))
    }

    fn begin(&self, clip: &Clip, frame: usize) -> Result<Box<dyn AnyRun>, Error> {
        Ok(Box::new(Running::begin(self, clip, frame, ())?))
    }

    fn begin_counted(&self, clip: &Clip, frame: usize) -> Result<Box<dyn CountedRun>, Error> {
        Ok(Box::new(Running::begin(self, clip, frame, Count::default())?))
    }

    fn evaluations(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<Vec<u32>, Error> {
        check_memory(self, clip, |need| need.run)?;
        let state = Estimator::run(self, clip, frame, threads, &())?;
        Ok(self.tests().map_or_else(Vec::new, |tests| tests.evaluations(&state)))
    }
}
