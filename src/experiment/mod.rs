//! What is run: a clip by its name, the estimators, a pixel to be explained, and estimators compared on one pair.

pub mod comparison;
pub mod course_table;
pub mod first;
pub mod pixel;
pub mod side_by_side;
pub mod source;
pub mod sweeps;

use std::sync::Arc;

use motionscope_core::products::{Assessment, Reference};
use motionscope_core::{AnyEstimator, Clip, Cursor, Error, Info, Threads, Walk, estimators};

use crate::media::export::Inputs;
use crate::media::{Given, Open};
use pixel::Pixel;
use side_by_side::SideBySide;
use source::Source;

/// What is run: the same in the window, on the command line, in a session and beside others in a comparison.
pub struct Experiment {
    /// Where the clip comes from.
    pub source: Source,
    /// What is given for the clip by hand.
    pub given: Given,
    /// The estimator with its parameters and its stages.
    pub estimator: Box<dyn AnyEstimator>,
    /// Those that go in lockstep with it.
    pub side_by_side: SideBySide,
    /// Frame t, on which the run begins.
    pub frame: usize,
}

/// Where in a run one is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Position {
    /// The step; `None` for the end of the run.
    pub cursor: Option<Cursor>,
    /// The pixel that is held to be explained by itself.
    pub pixel: Option<Pixel>,
}

impl Experiment {
    /// The estimator by itself on `source`, from its first frame on, with nothing given by hand.
    pub fn new(source: Source, estimator: Box<dyn AnyEstimator>) -> Self {
        Self { source, given: Given::default(), estimator, side_by_side: SideBySide::default(), frame: 0 }
    }

    /// The first estimator of the course on `source`.
    pub fn first(source: Source) -> Self {
        Self::new(source, estimators().swap_remove(0))
    }

    /// What there is to say about the run.
    pub fn info(&self) -> &'static Info {
        self.side_by_side.info(&*self.estimator)
    }

    /// The run on `clip`, which is the one that the source names.
    ///
    /// # Errors
    /// If an estimator cannot run there.
    pub fn walk(&self, clip: &Clip) -> Result<Box<dyn Walk>, Error> {
        self.side_by_side.walk(&*self.estimator, clip, self.frame)
    }

    /// How good the same estimator is in real time, where it looks back in time as it is set and is scored.
    ///
    /// # Errors
    /// If it cannot run there, or the truth cannot be read.
    pub fn causal(&self, clip: &Clip, threads: &Threads) -> Result<Option<Assessment>, Error> {
        let Some(causal) = self.estimator.causal().filter(|_| clip.truth().is_some()) else { return Ok(None) };
        let output = causal.run(clip, self.frame, threads)?;
        let assessment = output.assess(&Reference { clip, frame: self.frame })?;
        Ok(Some(assessment).filter(|assessment| !assessment.headline.is_empty()))
    }
}

impl Clone for Experiment {
    fn clone(&self) -> Self {
        let Self { source, given, estimator, side_by_side, frame } = self;
        let (source, given, side_by_side) = (source.clone(), given.clone(), side_by_side.clone());
        Self { source, given, estimator: estimator.boxed_clone(), side_by_side, frame: *frame }
    }
}

impl PartialEq for Experiment {
    fn eq(&self, other: &Self) -> bool {
        let Self { source, given, estimator, side_by_side, frame } = self;
        is_same(&**estimator, &*other.estimator)
            && *source == other.source
            && *given == other.given
            && *side_by_side == other.side_by_side
            && *frame == other.frame
    }
}

/// Whether both are the same estimator with the same parameters.
pub fn is_same(a: &dyn AnyEstimator, b: &dyn AnyEstimator) -> bool {
    a.info().id == b.info().id && a.values() == b.values()
}

/// An experiment whose clip is open. A run never changes it, so a picture of the run can always tell what it is a picture of.
pub struct Prepared {
    /// What is run.
    pub experiment: Experiment,
    /// The clip.
    pub clip: Clip,
    /// All files that the clip is read from, and the session that named it.
    pub inputs: Arc<Inputs>,
}

impl Prepared {
    /// Opens the clip of `experiment` with what is given for it; of `options` the rest counts.
    ///
    /// # Errors
    /// As [`Source::open`].
    pub fn open(experiment: Experiment, options: Open) -> Result<Self, Error> {
        let options = Open { given: experiment.given.clone(), ..options };
        let clip = experiment.source.open(&options)?;
        let inputs = Arc::new(experiment.source.inputs(&clip, &options));
        Ok(Self { experiment, clip, inputs })
    }
}
