//! The results of a stage, frame by frame.

use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use super::super::{AnyEstimator, AnyRun, Progress};
use super::chosen::FRAMES;
use crate::base::Error;
use crate::data::Clip;
use crate::products::{Followed, ObjectField, ObjectFrame};

/// The products of a stage for the frames of a clip, computed frame by frame on demand: each as known at the end of its
/// frame.
///
/// The result does not depend on the order of requests, so copies share it.
#[derive(Clone)]
pub struct Frames(Arc<Mutex<Found>>);

struct Found {
    estimator: Box<dyn AnyEstimator>,
    clip: Clip,
    /// `None` behind an error: its state may lie in the middle of a unit.
    run: Option<Box<dyn AnyRun>>,
    /// The units of a frame.
    units: usize,
    first: usize,
    frames: Vec<Arc<ObjectFrame>>,
    followed: Followed,
    is_over: bool,
}

impl Found {
    /// Processes one more frame. A failed run starts again and skips the known frames.
    fn advance(&mut self) -> Result<(), Error> {
        let mut run = match self.run.take() {
            Some(run) => run,
            None => self.estimator.begin(&self.clip, self.first)?,
        };
        for _ in 0..self.units {
            self.is_over = run.advance()? == Progress::Done;
            if self.is_over {
                break;
            }
        }
        if let Some(field) = run.output().get::<ObjectField>() {
            let new = field.frames.get(self.frames.len()..).unwrap_or_default();
            self.frames.extend(new.iter().cloned());
            self.followed = field.followed.clone();
        }
        self.run = Some(run);
        Ok(())
    }
}

impl fmt::Debug for Frames {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Frames")
    }
}

impl Frames {
    /// The products of `estimator` for at most `count` frames of a clip from frame `first` on.
    ///
    /// # Errors
    /// If it cannot run there.
    pub fn begin(estimator: &dyn AnyEstimator, clip: &Clip, (first, count): (usize, usize)) -> Result<Self, Error> {
        let mut estimator = estimator.boxed_clone();
        if estimator.specs().iter().any(|spec| spec.name == FRAMES) {
            estimator.set(FRAMES, &count.to_string())?;
        }
        let units = estimator.units_of(clip.size(), 1).unwrap_or(1);
        let run = estimator.begin(clip, first)?;
        let followed = run.output().get::<ObjectField>().map_or(Followed::Nothing, |field| field.followed.clone());
        let (run, clip) = (Some(run), clip.clone());
        let found = Found { estimator, clip, run, units, first, frames: Vec::new(), followed, is_over: false };
        Ok(Self(Arc::new(Mutex::new(found))))
    }

    /// The products of frame `t`; `None` after the end of the run.
    ///
    /// # Errors
    /// If a frame up to there cannot be read, or the work is cancelled.
    pub fn at(&self, t: usize) -> Result<Option<Arc<ObjectFrame>>, Error> {
        let mut found = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(index) = t.checked_sub(found.first) else { return Ok(None) };
        while found.frames.len() <= index && !found.is_over {
            found.advance()?;
        }
        Ok(found.frames.get(index).cloned())
    }

    /// Which objects it follows.
    pub fn followed(&self) -> Followed {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).followed.clone()
    }

    /// Memory that it takes, in bytes, with all that its run keeps; its copies share it.
    pub fn bytes(&self) -> usize {
        let found = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        found.run.as_ref().map_or(0, |run| run.bytes()) + size_of_val(&found.frames[..])
    }
}
