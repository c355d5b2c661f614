//! What is run, and the experiments that wait while a stage of one of them is run by itself.

use motionscope_core::stage::{self, Opened};
use motionscope_core::{AnyEstimator, Clip, Cursor, Error};

use super::snapshot::{Place, Snapshot};
use crate::experiment::side_by_side::SideBySide;
use crate::experiment::{Experiment, is_same};

/// Everything that undo takes back: an experiment, and those that wait while one of their stages is run by itself.
#[derive(Clone)]
pub struct Nested {
    /// What is run.
    pub experiment: Experiment,
    /// The experiments of whose estimators it is a stage, one of the other: the outermost first.
    pub parents: Vec<Parent>,
    /// The clip that it looks at, where that is not the one that is open.
    pub clip: Option<Clip>,
}

/// An experiment that waits while a stage of its estimator is run by itself.
#[derive(Clone)]
pub struct Parent {
    /// What waits.
    pub experiment: Experiment,
    /// The parameter that the stage is.
    index: usize,
    /// The frame that its run began on, and that which it stands at.
    frames: (usize, usize),
    /// Where its run stands.
    pub cursor: Cursor,
    /// The stage as it was opened, and where it stood then.
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
    /// An experiment that is a stage of no other.
    pub fn alone(experiment: Experiment) -> Self {
        Self { experiment, parents: Vec::new(), clip: None }
    }

    /// The outermost experiment.
    pub fn outermost(&self) -> &Experiment {
        self.parents.first().map_or(&self.experiment, |parent| &parent.experiment)
    }

    /// Where the stage at work stood when it was opened.
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

    /// Goes back to the parent of the stage at work, which has become what it is now; gives where the parent stands.
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

    /// Looks at `open`, which is another clip than before, from each of the estimators.
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

/// The last frame of `clip` that a run of `estimator` can start on.
fn last_frame(clip: &Clip, estimator: &dyn AnyEstimator) -> usize {
    let frames = clip.info().frames;
    frames.map_or(usize::MAX, |frames| frames.saturating_sub(estimator.info().frames))
}
