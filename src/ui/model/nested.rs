//! The current experiment, and the experiments that wait while one of their stages is open.
//!
//! Undo restores those that wait.

use motionscope_core::base::Error;
use motionscope_core::data::Clip;
use motionscope_core::run::stage::{self, Opened};
use motionscope_core::run::{AnyEstimator, Cursor};

use super::snapshot::{Place, Snapshot};
use crate::experiment::side_by_side::SideBySide;
use crate::experiment::{Experiment, is_same};

/// The undoable state: an experiment, and those that wait while one of their stages is open.
#[derive(Clone)]
pub struct Nested {
    /// The current experiment.
    pub experiment: Experiment,
    /// The waiting experiments, each using the next as a stage; the outermost first.
    pub parents: Vec<Parent>,
    /// The clip that it looks at, where that is not the one that is open.
    pub clip: Option<Clip>,
}

/// An experiment that waits while a stage of its estimator is open.
#[derive(Clone)]
pub struct Parent {
    /// The waiting experiment.
    pub experiment: Experiment,
    /// The parameter of the stage.
    index: usize,
    /// The first frame of its run, and the current one.
    frames: (usize, usize),
    /// The position of its run.
    pub cursor: Cursor,
    /// The stage as it was opened, with its position.
    opened: (Experiment, Cursor),
    /// The clip that it looks at, where that is not the one that is open.
    clip: Option<Clip>,
}

// The clips of stages follow from the others.
impl PartialEq for Nested {
    fn eq(&self, other: &Self) -> bool {
        let Self { experiment, parents, clip: _ } = self;
        *experiment == other.experiment && *parents == other.parents
    }
}

impl PartialEq for Parent {
    fn eq(&self, other: &Self) -> bool {
        let Self { experiment, index, frames, cursor, opened, clip: _ } = self;
        *experiment == other.experiment
            && (*index, *frames, *cursor) == (other.index, other.frames, other.cursor)
            && *opened == other.opened
    }
}

impl Nested {
    /// Returns an experiment that is not a stage.
    pub fn alone(experiment: Experiment) -> Self {
        Self { experiment, parents: Vec::new(), clip: None }
    }

    /// Returns the outermost experiment.
    pub fn outermost(&self) -> &Experiment {
        self.parents.first().map_or(&self.experiment, |parent| &parent.experiment)
    }

    /// Returns the position of the current stage when it was opened.
    pub fn opened_at(&self) -> Option<Cursor> {
        self.parents.last().map(|parent| parent.opened.1)
    }

    /// The same with the stage that is parameter `index` of the estimator at work, where `shown` stands on `clip`; `None` if that
    /// is no stage that can be opened.
    ///
    /// # Errors
    /// If a picture that the stage looks at cannot be had.
    pub fn enter(&self, index: usize, shown: &Snapshot, clip: &Clip) -> Result<Option<(Self, Place)>, Error> {
        let Self { experiment: now, mut parents, clip: seen } = self.clone();
        let frames = (now.frame, shown.frame);
        let Some(opened) = stage::open(&*now.estimator, index, clip, frames)? else { return Ok(None) };
        let Opened { estimator, clip: own, frame, cursor } = opened;
        // A parent may stand at the last frame, of which there is no pair.
        let frame = frame.min(last_frame(own.as_ref().unwrap_or(clip), &*estimator));
        let experiment = Experiment { estimator, side_by_side: SideBySide::default(), frame, ..now.clone() };
        let (own, opened) = (own.or_else(|| seen.clone()), (experiment.clone(), cursor));
        parents.push(Parent { experiment: now, index, frames, cursor: shown.leader(), opened, clip: seen });
        Ok(Some((Self { experiment, parents, clip: own }, Place::at(cursor))))
    }

    /// Closes the current stage, keeps its changes, and returns the position of the parent.
    pub fn leave(&mut self) -> Option<Cursor> {
        let Parent { mut experiment, index, cursor, opened: (opened, _), clip, .. } = self.parents.pop()?;
        // How many frames it goes through is its parent's to say.
        if !is_same(&*opened.estimator, &*self.experiment.estimator) {
            // What was opened as this stage can be one.
            experiment.estimator.set_value(index, stage::value_of(&*self.experiment.estimator)).ok()?;
        }
        // The sliders of the clip are the same for all.
        experiment.source = self.experiment.source.clone();
        (self.experiment, self.clip) = (experiment, clip);
        Some(cursor)
    }

    /// Applies all experiments to `open`, another clip.
    pub fn look_at(&mut self, open: &Clip) {
        let mut seen: Option<Clip> = None;
        for parent in &mut self.parents {
            parent.clip = seen.clone();
            let clip = seen.as_ref().unwrap_or(open);
            // A picture that cannot be had any more is told when the stage runs.
            let opened = stage::open(&*parent.experiment.estimator, parent.index, clip, parent.frames).ok().flatten();
            seen = opened.and_then(|opened| opened.clip).or(seen);
        }
        self.clip = seen;
    }
}

/// Returns the last frame of `clip` on which a run of `estimator` can start.
fn last_frame(clip: &Clip, estimator: &dyn AnyEstimator) -> usize {
    let frames = clip.info().frames;
    frames.map_or(usize::MAX, |frames| frames.saturating_sub(estimator.info().frames))
}
