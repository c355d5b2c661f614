//! What every estimator is: a declaration, a unit of work, and how it is seen and told.

use std::any::Any;

use super::{Footprint, Pointed, StageView, TestsCandidates};
use crate::base::{Error, Observer, Threads};
use crate::data::Clip;
use crate::params::Params;
use crate::products::{Output, ProductKind};
use crate::pseudocode;
use crate::scene::{Chart, Focus, Line, Name, Picture, Role, Scene, Step};

/// What there is to say about an estimator before it runs.
#[derive(Debug, PartialEq, Eq)]
pub struct Info {
    /// Stable kebab-case id: `full-search`. Its file is called the same, with underscores.
    pub id: &'static str,
    /// Name in the window: `Full search`.
    pub name: &'static str,
    /// Family and folder: `Block matching` lives in `block_matching`.
    pub family: &'static str,
    /// What it does, in one sentence.
    pub summary: &'static str,
    /// The source that it follows.
    pub source: &'static str,
    /// The algorithm, line by line, as [`pseudocode!`](crate::pseudocode!) declares it.
    pub pseudocode: &'static [Line],
    /// Names of the ladder's granularities, outermost first. The last is an event, the one before it a unit.
    pub granularities: &'static [&'static str],
    /// How many frames a run looks at, from the one that it starts on.
    pub frames: usize,
}

/// What an estimator finds where the whole picture moves alike, by a whole number of px unless it says otherwise, and not
/// farther than it looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guarantee {
    /// That displacement, on any texture that differs from place to place.
    Translation,
    /// That displacement, give or take a few px each way, where the texture is smooth, so that the cost falls from all
    /// sides towards it.
    SmoothTranslation {
        /// How far off it may be.
        off_px: u8,
    },
    /// A displacement that fits at least as well as none at all.
    Better,
    /// A displacement of a fraction of a px on any smooth texture, on average this near.
    SubPixel {
        /// Mean error in hundredths of a px.
        off_centi_px: u8,
    },
    /// A displacement of a fraction of a px for its features on any smooth texture, on average this near.
    Features {
        /// Mean error in hundredths of a px.
        off_centi_px: u8,
    },
    /// No displacement, but features: those of a picture that is moved are moved alike.
    Places,
    /// No displacement, but what moves before a background at rest: it is found in its place.
    Objects,
    /// The part along the gradient of a displacement of a fraction of a px, on any smooth texture.
    AlongGradient,
}

impl Info {
    /// Where in [`Info::pseudocode`] the line called `name` is.
    pub fn line(&self, name: Name) -> Option<usize> {
        pseudocode::find(self.pseudocode, name)
    }
}

/// The granularity of the levels of a pyramid: they are counted down to 0, the picture itself.
pub const LEVEL: &str = "level";

/// Where a run stands on one granularity of the ladder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Granularity {
    /// Which one, from 0.
    pub index: usize,
    /// How many there are, if that is known.
    pub of: Option<usize>,
}

/// Whether there is more to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// At least one more unit.
    More,
    /// That was the last unit.
    Done,
}

/// What can be seen at a cursor: everything that a step tells and a scene draws comes from this alone.
pub struct Seen<'a, E: Estimator> {
    /// The state before the unit at the cursor.
    pub before: &'a E::State,
    /// The state after it, once all its events were seen.
    pub after: Option<&'a E::State>,
    /// The unit's events up to the cursor; empty only at the very start of a run.
    pub events: &'a [E::Event],
    /// The pixel that the person points at, on a picture that the estimator takes ([`Pointed::takes`]). It changes what is
    /// explained, never what is computed.
    pub focus: Option<Focus>,
}

impl<E: Estimator> Seen<'_, E> {
    /// The point of frame t that the person points at, in px: on frame t, or at the same place of a picture that the
    /// estimator takes and whose pixels are those of frame t.
    pub fn point(&self) -> Option<[f32; 2]> {
        self.focus.filter(|focus| focus.on.is_aligned_with(Picture::CURRENT)).map(|focus| focus.at)
    }
}

/// A motion estimator: parameters, a state, and one unit of work at a time.
///
/// A *unit* is the natural outer step (a block, an iteration, a feature, a frame); *events* are what
/// happens inside it. Everything that a unit reads and writes is in the state, so that a run can be
/// taken up anywhere and gives the same bits.
pub trait Estimator: Params + Footprint<<Self as Estimator>::State> + Default + Clone + Send + Sync + 'static {
    /// What there is to say about it.
    const INFO: Info;
    /// The kinds of products that a run may make, the one that matters most first.
    const PRODUCES: &'static [&'static ProductKind];
    /// What it can be relied on to find: for tests.
    const GUARANTEE: Guarantee = Guarantee::Translation;
    /// Whether the end of a run tells how far its field is trusted.
    const TELLS_CONFIDENCE: bool = false;
    /// Whether it looks at pictures: some take what others have detected.
    const NEEDS_PICTURES: bool = true;
    /// The charts that its steps may have something for, the one that matters most first: the window offers no others.
    const CHARTS: &'static [Chart] = Chart::ALL;
    /// All that a unit reads and writes, its random generator included.
    type State: Clone + Send + Sync + 'static;
    /// What happens inside a unit.
    type Event: Clone + Send + Sync + 'static;

    /// The state before the first unit of a run on frame `frame`.
    ///
    /// # Errors
    /// Every bad input is refused here.
    fn start(&self, clip: &Clip, frame: usize) -> Result<Self::State, Error>;

    /// Does one unit of work and tells at least one event. Called only while there is more to do.
    ///
    /// # Errors
    /// If a frame that it needs is damaged; the run ends before this unit.
    fn advance(
        &self,
        clip: &Clip,
        state: &mut Self::State,
        observer: &mut impl Observer<Self::Event>,
    ) -> Result<Progress, Error>;

    /// How many units the run has, if that is known beforehand.
    fn units(&self, state: &Self::State) -> Option<usize>;

    /// Where the next unit of `state` stands: one entry for each of [`Info::granularities`] but the innermost.
    fn place(&self, state: &Self::State) -> Vec<Granularity>;

    /// The frame that the next unit of `state` works on, for those that go through a clip: the first of a pair, or one by
    /// itself. `None` where that is always the pair of the run.
    fn at_frame(&self, _state: &Self::State) -> Option<usize> {
        None
    }

    /// The units that so many frames take on pictures of a width and height in px, where a run goes through the clip frame
    /// by frame and each takes as many; `None` for what looks at a pair, or takes as long as it takes.
    fn units_of(&self, _picture: (usize, usize), _frames: usize) -> Option<usize> {
        None
    }

    /// What it lends to an estimator whose stage it is, beside what a run of it makes.
    fn lends(&self) -> Option<Box<dyn Any>> {
        None
    }

    /// What its stages look at while it works on frame `now`, where that is not the pair from there on.
    ///
    /// # Errors
    /// If a frame cannot be read.
    fn stage_view(&self, _clip: &Clip, _now: usize) -> Result<Option<StageView>, Error> {
        Ok(None)
    }

    /// The role of an event that is worth a mark on the timeline.
    fn landmark(&self, _event: &Self::Event) -> Option<Role> {
        None
    }

    /// How its candidates are counted, if it searches blocks by testing such: then it can go in lockstep with others.
    fn tests(&self) -> Option<&dyn TestsCandidates<Self::State, Self::Event>> {
        None
    }

    /// What lies where a person points, if something does.
    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        None
    }

    /// What the cursor tells.
    fn step(&self, seen: &Seen<Self>) -> Step;

    /// What the cursor shows on the stage.
    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene);

    /// The same estimator as it would work on a live camera, where it looks back in time as it is set: without hindsight.
    fn causal(&self) -> Option<Self> {
        None
    }

    /// What a state amounts to so far.
    fn output(&self, state: &Self::State) -> Output;

    /// Runs to the end. Override it to spread units over cores, never to compute differently:
    /// the result is bit-identical to stepping.
    ///
    /// # Errors
    /// As [`Estimator::start`] and [`Estimator::advance`].
    fn run(&self, clip: &Clip, frame: usize, _threads: &Threads) -> Result<Self::State, Error> {
        run_observed(self, clip, frame, &mut ()).map(|(state, _)| state)
    }
}

/// Runs to the end before the eyes of `observer`; gives the last state and the number of units.
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
