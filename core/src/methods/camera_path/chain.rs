//! The chain of the motions of consecutive pairs.

use std::sync::Arc;

use super::differences::differences;
use crate::base::{Error, Threads};
use crate::data::Clip;
use crate::geometry::Gray;
use crate::products::model::{IDENTITY, Matrix3, Model, Support, inverse, normalised, product};
use crate::products::path::{bend, corner_error};
use crate::products::{ModelField, PathField, Views};
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
    /// Number of pairs with a motion that bends the picture.
    pub bent: usize,
    /// The first frame of the first of them, and the bend in px.
    pub first_bent: Option<(usize, f64)>,
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
    /// Only a few matches agree, and the gray levels contradict them.
    Worse {
        /// Mean absolute difference of the frames registered by it, in gray levels.
        registered: f64,
        /// The same difference of the unregistered frames, at the same pixels.
        at_rest: f64,
    },
    /// It bends the picture, and the gray levels of most pixels contradict it.
    Bent {
        /// Largest distance of a corner from the nearest similarity in px.
        bend_px: f64,
        /// Median absolute difference of the frames registered by it, in gray levels.
        registered: f64,
        /// The same difference of the unregistered frames, at the same pixels.
        at_rest: f64,
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
/// If there is none, or it has no inverse, moves a corner farther than the diagonal of the picture, or registers the frames worse than no motion at
/// all although it has few inliers or bends the picture.
pub fn usable(field: &ModelField, frames: [&Gray; 2]) -> Result<Matrix3, Refused> {
    let most_px = diagonal(field.picture);
    let matrix = field.matrix.ok_or(Refused::Unknown(field.model, field.support))?;
    let is_finite = matrix.iter().flatten().all(|entry| entry.is_finite());
    if !is_finite || inverse(&matrix).is_none() {
        return Err(Refused::Singular);
    }
    let moved_px = corner_error([&matrix, &IDENTITY], field.picture);
    if moved_px > most_px {
        return Err(Refused::Far { moved_px, most_px });
    }
    let is_weak = field.support.is_some_and(|support| support.inliers < MANY_INLIERS);
    let bend_px = bend(&matrix, field.picture);
    let is_bent = is_bend(bend_px, field.picture);
    let Some([registered, at_rest]) = (is_weak || is_bent).then(|| differences(&matrix, frames)).flatten() else {
        return Ok(matrix);
    };
    if is_weak && registered.mean > WORSE * at_rest.mean + NOISE {
        return Err(Refused::Worse { registered: registered.mean, at_rest: at_rest.mean });
    }
    // An object that moves with the motion lowers the mean; the median reflects the rest of the picture.
    if is_bent && registered.median > WORSE * at_rest.median + HALF_LEVEL {
        return Err(Refused::Bent { bend_px, registered: registered.median, at_rest: at_rest.median });
    }
    Ok(matrix)
}

/// Number of inliers from which the matches alone are evidence.
const MANY_INLIERS: usize = 16;
/// Frames that differ by more than this many times their difference at rest, and by this many gray levels of noise, contradict a motion.
const WORSE: f64 = 1.25;
const NOISE: f64 = 0.05;
/// The median of whole gray levels is known to half a level.
const HALF_LEVEL: f64 = 0.5;

fn diagonal((width, height): (usize, usize)) -> f64 {
    (width as f64).hypot(height as f64)
}

/// Above this share of the diagonal, a motion between two frames bends the picture more than a camera does: hand-held
/// clips reach 0.4 %, a homography that includes a passing car more than 2 %.
const BENT: f64 = 0.01;

/// Whether a motion bends a picture more than a camera does.
fn is_bend(bend_px: f64, picture: (usize, usize)) -> bool {
    bend_px > BENT * diagonal(picture)
}

/// The map from the first frame after a further motion; `None` if it has no inverse.
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
            bent: 0,
            first_bent: None,
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

    /// The pair that the motion stage processes at frame `now`; after the last pair, that pair.
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
        let pair = clip.pair(self.frame)?;
        let known = usable(&field, pair.each_ref().map(|frame| frame.luma())).and_then(composed);
        let (motion, after) = known.unwrap_or((IDENTITY, before));
        let truth = clip.truth().map_or(Ok(None), |truth| truth.background(self.frame));
        Arc::make_mut(&mut self.motions).push(motion);
        Arc::make_mut(&mut self.to_frames).push(after);
        self.unknown += usize::from(known.is_err());
        self.first_refused = self.first_refused.or(known.err().map(|why| (self.frame, why)));
        let bend_px = bend(&motion, self.picture);
        if is_bend(bend_px, self.picture) {
            self.bent += 1;
            self.first_bent = self.first_bent.or(Some((self.frame, bend_px)));
        }
        self.frame += 1;
        self.is_complete = self.span.is_over(clip, self.frame + 1);
        Ok(Link { field, motion, refused: known.err(), before, after, truth })
    }

    /// The path with the maps from each frame to its corrected one, and pictures along it.
    pub fn field(&self, corrections: &[Matrix3], views: Views) -> PathField {
        let (motions, corrections) = (self.motions.to_vec(), corrections.to_vec());
        PathField { picture: self.picture, first: self.span.first, motions, corrections, views }
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + size_of_val(&self.motions[..]) + size_of_val(&self.to_frames[..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;
    use crate::products::model::mapped;

    #[test]
    fn few_matches_are_held_against_the_gray_levels() {
        let level = |x: usize, y: usize| ((x * x * 7 + y * 31 + x * y * 5) % 251) as u8;
        let frame = |by: usize| Grid::from_fn(60, 40, |x, y| level(x + 10 - by, y));
        let field = |u: f64, inliers: usize| ModelField {
            picture: (60, 40),
            model: Model::Translation,
            matrix: Some([[1.0, 0.0, u], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
            iterations: 1,
            residual_px: Some(0.1),
            support: Some(Support { inliers, matches: inliers }),
        };
        let used = |u: f64, inliers: usize, by: usize| usable(&field(u, inliers), [&frame(0), &frame(by)]);
        // The camera moves as the matches say, or it is at rest.
        assert!(used(4.0, 5, 4).is_ok());
        let Err(Refused::Worse { registered, at_rest }) = used(4.0, 5, 0) else { panic!("the frames are the same") };
        assert!(registered > 40.0 && at_rest == 0.0, "{registered}, {at_rest}");
        assert!(used(4.0, MANY_INLIERS, 0).is_ok(), "many matches on a background that an object hides");
    }

    #[test]
    fn a_bend_is_held_against_most_gray_levels() {
        let level = |x: f64, y: f64| ((x * 7.0 + y * 31.0 + x * y).sin() * 100.0 + 128.0) as u8;
        // Stretched along y, as by an object that comes nearer; it fills the lower part of the picture, or all of it.
        let stretched = [[1.0, 0.0, 0.0], [0.0, 1.1, 0.0], [0.0, 0.0, 1.0]];
        let frame = |scale: f64, from: usize| {
            Grid::from_fn(60, 40, |x, y| level(x as f64, if y < from { y as f64 } else { y as f64 / scale }))
        };
        let field = ModelField {
            picture: (60, 40),
            model: Model::Homography,
            matrix: Some(stretched),
            iterations: 1,
            residual_px: Some(0.1),
            support: Some(Support { inliers: 90, matches: 120 }),
        };
        let used = |from: usize| usable(&field, [&frame(1.0, from), &frame(1.1, from)]);
        let Err(Refused::Bent { bend_px, registered, at_rest }) = used(28) else { panic!("most pixels are at rest") };
        assert!(bend_px > 0.72 && registered > 10.0 && at_rest == 0.0, "{bend_px}, {registered}, {at_rest}");
        assert!(used(0).is_ok(), "all pixels move so");
    }

    #[test]
    fn a_motion_that_ends_the_path_is_refused() {
        let turn = [[1.0, 0.0, 2.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(composed(&turn, &turn).map(|after| after[0][2]), Some(4.0));
        // The origin of the first frame goes to infinity, and comes back.
        let tilted = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.5, 0.0, 1.0]];
        let after = composed(&tilted, &turn).expect("what lies before the horizon stays there");
        assert_eq!((mapped(&after, [0.0; 2]), mapped(&after, [-2.0, 0.0])), (None, Some([0.0; 2])));
        let back = inverse(&tilted).expect("regular");
        assert_eq!(composed(&back, &after).map(|after| mapped(&after, [0.0; 2])), Some(Some([2.0, 0.0])));
        // Each motion has an inverse; all together they leave less than rounding errors of the picture.
        let smaller = [[1e-5, 0.0, 0.0], [0.0, 1e-5, 0.0], [0.0, 0.0, 1.0]];
        assert!(inverse(&smaller).is_some() && composed(&smaller, &smaller).is_none());
    }
}
