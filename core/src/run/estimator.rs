//! The trait of all estimators: a declaration, a unit of work, and its presentation.
//!
//! An estimator has a *state*, processes one *unit* at a time ([`Estimator::advance`]), and reports the *events* inside a unit
//! to an observer. The fast run, stepping in both directions, benchmarks and laws all use this one loop: it is generic over the
//! observer, and the observer `()` ignores events at no cost, so the loop that is explained is the loop that is timed. `run`
//! may distribute units over threads; a law requires bit-identical results. It counts units and events on the way (`Tally`), so
//! nothing runs twice to be counted.
//!
//! `advance` returns a `Result` because a frame may turn out to be damaged during a run: the run then ends with an error, and
//! the results so far remain. A run may cover a whole clip ([`Estimator::at_frame`]); if the number of frames is unknown, it
//! ends where `Clip::has_frame` returns false.

use std::any::Any;

use super::{Footprint, Pointed, StageView, TestsCandidates};
use crate::base::{Error, Observer, Tally, Threads};
use crate::data::Clip;
use crate::params::Params;
use crate::products::{Output, ProductKind};
use crate::scene::{Chart, Focus, Line, Name, Picture, Question, Role, Scene, Step, pseudocode};

/// The declaration of an estimator.
#[derive(Debug, PartialEq, Eq)]
pub struct Info {
    /// Stable kebab-case id: `full-search`. Its file has the same name, with underscores.
    pub id: &'static str,
    /// Name in the window: `Full search`.
    pub name: &'static str,
    /// Family and folder: `Block matching` lives in `block_matching`.
    pub family: &'static str,
    /// Its method in one sentence.
    pub summary: &'static str,
    /// The publication that it follows.
    pub source: &'static str,
    /// The algorithm, line by line, as [`pseudocode!`](crate::pseudocode!) declares it.
    pub pseudocode: &'static [Line],
    /// Names of the granularities of stepping, outermost first. The last is an event, the one before it a unit.
    pub granularities: &'static [&'static str],
    /// Number of frames that a run reads.
    pub frames: usize,
}

/// The guaranteed result of an estimator for a global translation within its range, in whole px unless stated otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guarantee {
    /// The translation, on any texture that does not repeat.
    Translation,
    /// The translation up to an error of `off_px`, on smooth texture, where the cost surface has a single minimum.
    SmoothTranslation {
        /// Largest error in px of each component.
        off_px: u8,
    },
    /// A displacement of no higher cost than zero motion.
    Better,
    /// A sub-pixel translation of a dense field on smooth texture, with this mean error.
    SubPixel {
        /// Mean error in hundredths of a px.
        off_centi_px: u8,
    },
    /// A sub-pixel translation of features on smooth texture, with this mean error.
    Features {
        /// Mean error in hundredths of a px.
        off_centi_px: u8,
    },
    /// Feature points that move with the picture (covariance); no displacement.
    Places,
    /// Feature points with sub-pixel positions that move with the picture up to an error; no displacement.
    SubPixelPlaces {
        /// Largest error of a component in hundredths of a px.
        off_centi_px: u8,
    },
    /// Moving objects before a static background; no displacement.
    Objects,
    /// The object whose region is given in the first frame, before a background of other colours; no displacement.
    Region,
    /// The segments of rigid motions in a true flow; no displacement.
    Segments,
    /// The disparity of two views shifted by a whole number of px, on texture that does not repeat; no displacement.
    Disparity,
    /// The segments of trajectories over several frames; no displacement.
    Trajectories,
    /// The motion in space of points seen by two calibrated cameras.
    SceneFlow,
    /// The normal flow of a sub-pixel translation, on smooth texture.
    AlongGradient,
}

impl Info {
    /// The index in [`Info::pseudocode`] of the line called `name`.
    pub fn line(&self, name: Name) -> Option<usize> {
        pseudocode::find(self.pseudocode, name)
    }
}

/// The granularity of pyramid levels, counted down to 0, the picture itself.
pub const LEVEL: &str = "level";
/// The granularity of rows of a picture, named by their coordinate y.
pub const ROW: &str = "row";
/// The granularity of frames, whose numbers in the clip are always shown.
pub const FRAME: &str = "frame";

/// The position of a run on one granularity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Granularity {
    /// Index from 0.
    pub index: usize,
    /// Total number, if known.
    pub of: Option<usize>,
}

/// Whether the run continues.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// At least one unit remains.
    More,
    /// That was the last unit.
    Done,
}

/// The run at a cursor: steps and scenes are made from this alone.
pub struct Seen<'a, E: Estimator> {
    /// The clip.
    pub clip: &'a Clip,
    /// The state before the unit at the cursor.
    pub before: &'a E::State,
    /// The state after it, at the end of the unit.
    pub after: Option<&'a E::State>,
    /// The unit's events up to the cursor; empty only at the very start of a run.
    pub events: &'a [E::Event],
    /// The pixel pointed at, on a picture that the estimator accepts ([`Pointed::takes`]). It changes the explanation, never
    /// the result.
    pub focus: Option<Focus>,
}

impl<E: Estimator> Seen<'_, E> {
    /// The point of frame t pointed at in px: on frame t, or at the same position of a picture aligned with it.
    pub fn point(&self) -> Option<[f32; 2]> {
        self.focus.filter(|focus| focus.on.is_aligned_with(Picture::CURRENT)).map(|focus| focus.at)
    }
}

/// A motion estimator: parameters, a state, and one unit of work at a time.
///
/// A *unit* is the natural outer step (a block, an iteration, a feature, a frame); *events* are what happens inside it. Everything that a
/// unit reads and writes is in the state, so that a run can be resumed anywhere with the same bits.
pub trait Estimator: Params + Footprint<<Self as Estimator>::State> + Default + Clone + Send + Sync + 'static {
    /// Its declaration.
    const INFO: Info;
    /// The kinds of products of a run, the main one first.
    const PRODUCES: &'static [&'static ProductKind];
    /// The motion it is guaranteed to find, for tests.
    const GUARANTEE: Guarantee = Guarantee::Translation;
    /// Whether its field has a confidence at the end of a run.
    const TELLS_CONFIDENCE: bool = false;
    /// Whether it reads frames; some estimators read detections only.
    const NEEDS_PICTURES: bool = true;
    /// The parameter whose values are contrasted if the estimator runs in lockstep with itself.
    const CONTRASTS: Option<&'static str> = None;
    /// The charts that its steps fill, the main one first; the window offers no others.
    const CHARTS: &'static [Chart] = Chart::ALL;
    /// The questions about its next step, the most telling first: the first that a step answers is asked.
    const QUESTIONS: &'static [Question] = &[];
    /// Everything that a unit reads and writes, its random generator included.
    type State: Clone + Send + Sync + 'static;
    /// An event inside a unit.
    type Event: Clone + Send + Sync + 'static;

    /// The state before the first unit of a run on frame `frame`.
    ///
    /// # Errors
    /// If the input is invalid: all checks are made here.
    fn start(&self, clip: &Clip, frame: usize) -> Result<Self::State, Error>;

    /// Performs one unit of work and reports at least one event. Called only while the run continues.
    ///
    /// # Errors
    /// If a frame cannot be read; the run ends before this unit.
    fn advance(
        &self,
        clip: &Clip,
        state: &mut Self::State,
        observer: &mut impl Observer<Self::Event>,
    ) -> Result<Progress, Error>;

    /// Number of units of the run, if known beforehand.
    fn units(&self, state: &Self::State) -> Option<usize>;

    /// The position of the next unit of `state`: one entry for each of [`Info::granularities`] but the innermost.
    fn place(&self, state: &Self::State) -> Vec<Granularity>;

    /// The frame (or first frame of the pair) of the next unit of `state`, for estimators that process a clip frame by frame;
    /// `None` for those of a single pair.
    fn at_frame(&self, _state: &Self::State) -> Option<usize> {
        None
    }

    /// Number of earlier frames on which the result of a frame depends, for estimators that process a clip frame by frame; `None` if on
    /// all of them.
    fn earlier_frames(&self) -> Option<usize> {
        None
    }

    /// Number of units for this many frames of a width and height in px, for estimators with a fixed number of units per frame;
    /// `None` otherwise.
    fn units_of(&self, _picture: (usize, usize), _frames: usize) -> Option<usize> {
        None
    }

    /// Data lent to the parent of a stage, besides its products.
    fn lends(&self) -> Option<Box<dyn Any>> {
        None
    }

    /// The frames that its stages read while it works on frame `now`, if not the pair that begins there.
    ///
    /// # Errors
    /// If a frame cannot be read.
    fn stage_view(&self, _clip: &Clip, _now: usize) -> Result<Option<StageView>, Error> {
        Ok(None)
    }

    /// The role of an event that is marked on the timeline.
    fn landmark(&self, _event: &Self::Event) -> Option<Role> {
        None
    }

    /// Whether nothing happens at an event, so that stepping passes over it.
    fn is_idle(&self, _event: &Self::Event) -> bool {
        false
    }

    /// The line of pseudocode of an event, if each stands for a stage of the unit: in lockstep, events of one stage stand side by side.
    fn stage(&self, _event: &Self::Event) -> Option<Name> {
        None
    }

    /// The count of its candidates, for block searches: these can run in lockstep.
    fn tests(&self) -> Option<&dyn TestsCandidates<Self::State, Self::Event>> {
        None
    }

    /// The explanation of a pixel pointed at, if it has one.
    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        None
    }

    /// The explanation at the cursor.
    fn step(&self, seen: &Seen<Self>) -> Step;

    /// Draws the scene at the cursor.
    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene);

    /// The products of a state as known in real time, as for a live camera, if its parameters use later frames.
    fn causal(&self, _state: &Self::State) -> Option<Output> {
        None
    }

    /// The products of a state so far.
    fn output(&self, state: &Self::State) -> Output;

    /// Performs up to `most` units (at least 1) that nothing observes, and returns their number. Override it where several
    /// units together are faster than one after the other, never to compute differently; it ends with each group of units
    /// ([`Info::granularities`]).
    ///
    /// # Errors
    /// As [`Estimator::advance`].
    fn advance_many(&self, clip: &Clip, state: &mut Self::State, _most: usize) -> Result<(usize, Progress), Error> {
        self.advance(clip, state, &mut ()).map(|progress| (1, progress))
    }

    /// Runs to the end, with its units and events counted by `tally`. Override it to spread units over cores, never to
    /// compute differently: the result is bit-identical to stepping.
    ///
    /// # Errors
    /// As [`Estimator::start`] and [`Estimator::advance`].
    fn run(
        &self,
        clip: &Clip,
        frame: usize,
        _threads: &Threads,
        tally: &impl Tally<Self::Event>,
    ) -> Result<Self::State, Error> {
        run_counted(self, (clip, frame), tally, |state, counter| self.advance(clip, state, counter))
    }
}

/// Runs to the end, each unit by `advance`, with units and events counted by `tally`: an [`Estimator::run`] for units that are parallel
/// inside.
///
/// # Errors
/// As [`Estimator::start`] and `advance`.
pub fn run_counted<'a, E: Estimator, T: Tally<E::Event>>(
    estimator: &E,
    (clip, frame): (&Clip, usize),
    tally: &'a T,
    mut advance: impl FnMut(&mut E::State, &mut T::Counter<'a>) -> Result<Progress, Error>,
) -> Result<E::State, Error> {
    let (mut state, mut counter) = (estimator.start(clip, frame)?, tally.counter());
    loop {
        clip.wanted()?;
        tally.add_units(1);
        if advance(&mut state, &mut counter)? == Progress::Done {
            return Ok(state);
        }
    }
}

/// Runs to the end with events reported to `observer`; returns the last state and the number of units.
///
/// # Errors
/// As [`Estimator::start`] and [`Estimator::advance`].
pub fn run_observed<E: Estimator>(
    estimator: &E,
    clip: &Clip,
    frame: usize,
    observer: &mut impl Observer<E::Event>,
) -> Result<(E::State, usize), Error> {
    let mut state = estimator.start(clip, frame)?;
    let mut units = 1;
    while estimator.advance(clip, &mut state, observer)? == Progress::More {
        clip.wanted()?;
        units += 1;
    }
    Ok((state, units))
}
