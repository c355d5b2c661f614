//! The chain of the motions of consecutive pairs.

use std::sync::Arc;

use crate::base::{Error, Threads};
use crate::data::Clip;
use crate::products::ModelField;
use crate::products::model::{IDENTITY, Matrix3, Model, Support, inverse, normalised, product};
use crate::products::path::corner_error;
use crate::run::{GlobalModel, Granularity, Span, Stage, StageView, need};

/// The lines of the pseudocode that chain the motions.
pub(crate) mod pairs_line {
    crate::line_names!(ESTIMATE, CHAIN);
}

/// The pseudocode of an estimator whose first pass composes the motions of all pairs.
macro_rules! path_pseudocode {
    ($($name:ident: $text:literal,)*) => {
        $crate::pseudocode! {
            EACH_PAIR: "for each pair of frames t, t+1",
            ESTIMATE: "  M(t) ← motion of the pair, by the motion stage; the identity if it has none",
            CHAIN: "  P(t+1) ← M(t) P(t), the map from the first frame to frame t+1",
            $($name: $text,)*
        }
    };
}
pub(crate) use path_pseudocode;

/// The motions so far, of the pairs from the first frame on.
#[derive(Clone)]
pub struct Chain {
    /// The frames of the run.
    pub span: Span,
    /// The first frame of the next pair; the last frame once the chain is complete.
    pub frame: usize,
    /// Width and height of the picture in px.
    pub picture: (usize, usize),
    /// Whether all pairs are done.
    pub is_complete: bool,
    /// The motion of each pair, the identity where none was found.
    pub motions: Arc<Vec<Matrix3>>,
    /// The map from the first frame to each frame so far.
    pub to_frames: Arc<Vec<Matrix3>>,
    /// Number of pairs without a usable motion.
    pub unknown: usize,
    /// The first frame of the first of them, and why.
    pub first_refused: Option<(usize, Refused)>,
}

/// Why the motion of a pair is not used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refused {
    /// The stage found none; with the matches, if it has any.
    Unknown(Model, Option<Support>),
    /// Its matrix has no inverse.
    Singular,
    /// It moves a corner farther than the diagonal of the picture.
    Far {
        /// The motion of that corner in px.
        moved_px: f64,
        /// The diagonal in px.
        most_px: f64,
    },
    /// Chained to the motions before, it gives a map without an inverse.
    Path,
}

/// A pair of frames in the chain.
#[derive(Clone, Debug)]
pub struct Link {
    /// The estimate of the stage.
    pub field: ModelField,
    /// The motion that is used: that of the stage, or the identity if that is refused.
    pub motion: Matrix3,
    /// Why the motion of the stage is not used, if so.
    pub refused: Option<Refused>,
    /// The map from the first frame to the first frame of the pair.
    pub before: Matrix3,
    /// The map from the first frame to the second frame of the pair.
    pub after: Matrix3,
    /// The true motion of the background, where it is known, or why it could not be read.
    pub truth: Result<Option<Matrix3>, Error>,
}

/// The motion of an estimate, or why it is not used.
///
/// # Errors
/// If there is none, it has no inverse, or moves a corner farther than the diagonal of the picture.
pub fn usable(field: &ModelField) -> Result<Matrix3, Refused> {
    let most_px = (field.picture.0 as f64).hypot(field.picture.1 as f64);
    let matrix = field.matrix.ok_or(Refused::Unknown(field.model, field.support))?;
    let is_finite = matrix.iter().flatten().all(|entry| entry.is_finite());
    if !is_finite || inverse(&matrix).is_none() {
        return Err(Refused::Singular);
    }
    let moved_px = corner_error([&matrix, &IDENTITY], field.picture);
    if moved_px <= most_px { Ok(matrix) } else { Err(Refused::Far { moved_px, most_px }) }
}

/// The map from the first frame after one more motion; `None` if it has no inverse.
fn composed(motion: &Matrix3, before: &Matrix3) -> Option<Matrix3> {
    normalised(&product(motion, before)).filter(|after| inverse(after).is_some())
}

impl Chain {
    /// The chain of at most `count` frames from `frame` on.
    ///
    /// # Errors
    /// If there is no pair of frames there.
    pub fn new(clip: &Clip, frame: usize, count: usize) -> Result<Self, Error> {
        Ok(Self {
            span: Span::new(clip, frame, count)?,
            frame,
            picture: clip.size(),
            is_complete: false,
            motions: Arc::default(),
            to_frames: Arc::new(vec![IDENTITY]),
            unknown: 0,
            first_refused: None,
        })
    }

    /// Number of frames of the run, if known.
    pub fn frames(&self) -> Option<usize> {
        if self.is_complete { Some(self.to_frames.len()) } else { self.span.frames() }
    }

    /// Number of units of a run whose second pass goes through all frames, if known.
    pub fn units(&self) -> Option<usize> {
        self.frames().map(|frames| 2 * frames - 1)
    }

    /// The place of a run of two passes after `done` frames of the second: clip, pass, and pair or frame.
    pub fn place(&self, done: usize) -> Vec<Granularity> {
        let frames = self.frames();
        let (pass, index, of) = match self.is_complete {
            false => (0, self.motions.len(), frames.map(|frames| frames - 1)),
            true => (1, done, frames),
        };
        vec![Granularity { index: 0, of: Some(1) }, Granularity { index: pass, of: Some(2) }, Granularity { index, of }]
    }

    /// The frame of a run of two passes after `done` frames of the second.
    pub fn at_frame(&self, done: usize) -> usize {
        match self.is_complete {
            false => self.frame,
            true => self.span.first + done.min(self.to_frames.len() - 1),
        }
    }

    /// What the motion stage processes at frame `now`: behind the last pair that pair.
    ///
    /// # Errors
    /// If a frame cannot be read.
    pub fn stage_view(clip: &Clip, now: usize) -> Result<Option<StageView>, Error> {
        if now == 0 || clip.has_frame(now + 1)? {
            return Ok(None);
        }
        clip.pair_from(now - 1).map(|clip| Some(StageView { clip, set: Vec::new() }))
    }

    /// Adds the next pair.
    ///
    /// # Errors
    /// If a frame cannot be read, or the work is cancelled.
    pub fn advance(&mut self, motion: &Stage<GlobalModel>, clip: &Clip, threads: &Threads) -> Result<Link, Error> {
        clip.wanted()?;
        need::check_kept(clip, self.bytes())?;
        let field = motion.model(clip, self.frame, threads)?;
        let before = self.to_frames[self.to_frames.len() - 1];
        let composed = |motion: Matrix3| composed(&motion, &before).map(|after| (motion, after)).ok_or(Refused::Path);
        let known = usable(&field).and_then(composed);
        let (motion, after) = known.unwrap_or((IDENTITY, before));
        let truth = clip.truth().map_or(Ok(None), |truth| truth.background(self.frame));
        Arc::make_mut(&mut self.motions).push(motion);
        Arc::make_mut(&mut self.to_frames).push(after);
        self.unknown += usize::from(known.is_err());
        self.first_refused = self.first_refused.or(known.err().map(|why| (self.frame, why)));
        self.frame += 1;
        self.is_complete = self.span.is_over(clip, self.frame + 1);
        Ok(Link { field, motion, refused: known.err(), before, after, truth })
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + size_of_val(&self.motions[..]) + size_of_val(&self.to_frames[..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_that_ends_the_path_is_refused() {
        let turn = [[1.0, 0.0, 2.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(composed(&turn, &turn).map(|after| after[0][2]), Some(4.0));
        // The origin of the first frame goes to infinity: no last entry of 1.
        let tilted = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.5, 0.0, 1.0]];
        assert_eq!(composed(&tilted, &turn), None);
        // Each motion has an inverse; all together they leave less than rounding errors of the picture.
        let smaller = [[1e-5, 0.0, 0.0], [0.0, 1e-5, 0.0], [0.0, 0.0, 1.0]];
        assert!(inverse(&smaller).is_some() && composed(&smaller, &smaller).is_none());
    }
}
