//! Experiments: the source of a clip, the estimators, the pixel to explain, and comparisons.
//!
//! An [`Experiment`] holds the source, ground truth and detections given explicitly, the estimator with its stages, those in
//! lockstep, and the frame; a [`Position`] is a place in its run; [`Prepared`] has the clip open. Flags, sessions and undo all
//! construct experiments. The look of a step (`view/look.rs`) is separate.

pub mod comparison;
pub mod course_table;
pub mod first;
pub mod interest;
pub mod live;
pub mod pixel;
pub mod side_by_side;
pub mod source;
pub mod suitability;
pub mod sweeps;
pub mod travel;
pub mod whole;

use std::sync::Arc;

use motionscope_core::base::Error;
use motionscope_core::base::words::fixed;
use motionscope_core::course::estimators;
use motionscope_core::data::Clip;
use motionscope_core::params::{Figure, Kind, Spec};
use motionscope_core::products::{Assessment, Output, Reference, RegionField};
use motionscope_core::run::{AnyEstimator, Cursor, Info, Walk};
use serde::Serialize;

use crate::media::export::Inputs;
use crate::media::{Given, Open, OpenedClip};
use pixel::Held;
use side_by_side::SideBySide;
use source::Source;

/// An experiment: clip, estimators and frame, shared by window, command line, sessions and comparisons.
pub struct Experiment {
    /// The source of the clip.
    pub source: Source,
    /// Ground truth and detections given explicitly.
    pub given: Given,
    /// The estimator with its parameters and its stages.
    pub estimator: Box<dyn AnyEstimator>,
    /// The estimators in lockstep with it.
    pub side_by_side: SideBySide,
    /// Frame t, on which the run begins.
    pub frame: usize,
}

/// A position in a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Position {
    /// The step; `None` for the end of the run.
    pub cursor: Option<Cursor>,
    /// The held pixel or object to explain.
    pub held: Option<Held>,
}

impl Experiment {
    /// Returns `estimator` alone on `source`, from the first frame.
    pub fn new(source: Source, estimator: Box<dyn AnyEstimator>) -> Self {
        Self { source, given: Given::default(), estimator, side_by_side: SideBySide::default(), frame: 0 }
    }

    /// Returns the first estimator of the course on `source`.
    pub fn first(source: Source) -> Self {
        Self::new(source, estimators().swap_remove(0))
    }

    /// Returns the description of the run.
    pub fn info(&self) -> &'static Info {
        self.side_by_side.info(&*self.estimator)
    }

    /// Starts the run on `clip`, opened from the source.
    ///
    /// # Errors
    /// If an estimator cannot run there.
    pub fn walk(&self, clip: &Clip) -> Result<Box<dyn Walk>, Error> {
        self.side_by_side.walk(&*self.estimator, clip, self.frame)
    }

    /// Whether both run on the same clip, with the same files beside it.
    pub fn has_clip_of(&self, other: &Self) -> bool {
        self.source == other.source && self.given == other.given
    }

    /// How good the estimator is in real time, where it looks back as it is set (then `causal` is what it gave) and is scored.
    ///
    /// # Errors
    /// If the truth cannot be read.
    pub fn causal(&self, clip: &Clip, causal: Option<Output>) -> Result<Option<Assessment>, Error> {
        let Some(causal) = causal.filter(|_| clip.truth().is_some()) else { return Ok(None) };
        let assessment = causal.assess(&Reference { clip, frame: self.frame })?;
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

/// An experiment with its clip open. A run never changes it, so every picture can name its clip and parameters.
pub struct Prepared {
    /// The experiment.
    pub experiment: Experiment,
    /// The clip.
    pub clip: Clip,
    /// All input files, including the session.
    pub inputs: Arc<Inputs>,
}

/// Pairs of frames whose truth is looked for.
const MOST_PAIRS: usize = 1000;

/// The first pair of frames whose true flow is known, if there is one and it is not the first of the clip: a run begins there unless
/// another frame is asked for. The search ends where `is_wanted` says no more.
pub fn first_known_pair(clip: &Clip, is_wanted: impl Fn() -> bool) -> Option<usize> {
    let truth = clip.truth().filter(|truth| truth.kinds().contains(&"flow"))?;
    let pairs = clip.info().frames.unwrap_or(0).saturating_sub(1).min(MOST_PAIRS);
    // What cannot be read is told where it is needed.
    let is_known = |t: &usize| truth.flow(*t).map_or(true, |flow| flow.is_some());
    let first = (0..pairs).take_while(|_| is_wanted()).find(is_known)?;
    (first > 0).then_some(first)
}

/// Whether a run of the estimator is one of a single pair of frames, so that the pair decides whether the truth is known.
pub fn is_of_pair(estimator: &dyn AnyEstimator) -> bool {
    !estimator.is_by_frame() && !estimator.is_of_single_frames()
}

/// Whether frames `t` and `t + 1` are identical, so that nothing moves between them; `None` as long as they are not both decoded.
pub fn is_repeated(clip: &Clip, t: usize) -> Option<bool> {
    let [first, second] = [clip.cached(t)?, clip.cached(t.checked_add(1)?)?];
    Some(!clip.is_blank() && first == second)
}

/// The note about a pair of identical frames that begins at `t`.
pub fn repeated_note(t: usize) -> String {
    format!("Frames {t} and {} are identical, so nothing moves between them; choose another pair.", t + 1)
}

/// The rectangle to be placed on the object before a run is about it: in a clip of one's own, where none is placed and the truth gives none.
/// A bundled scene declares its objects, or is about the whole picture.
pub fn unplaced(estimator: &dyn AnyEstimator, (source, clip): (&Source, &Clip), frame: usize) -> Option<&'static Spec> {
    let has_object =
        || clip.truth().is_some_and(|truth| matches!(truth.objects(frame), Ok(Some(objects)) if !objects.is_empty()));
    let spec = zone_at_default(estimator)?;
    (!matches!(source, Source::Synth { .. }) && !clip.is_blank() && !has_object()).then_some(spec)
}

/// The rectangle that a run of the estimator begins with, where none is placed.
fn zone_at_default(estimator: &dyn AnyEstimator) -> Option<&'static Spec> {
    let is_at_default = |spec: &&Spec| estimator.get(&spec.name).is_ok_and(|value| value == spec.default);
    let spec = estimator.specs().iter().find(|spec| matches!(spec.kind, Kind::Placed(Figure::Zone)))?;
    (is_at_default(&spec) && estimator.why_idle(&spec.name).is_none()).then_some(spec)
}

/// The region of the first frame of a run for which none was placed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TakenRegion {
    /// The first frame.
    frame: usize,
    /// Left and upper edge in px, and the size; the edge of the first pixel lies at −0.5 px.
    x: f32,
    y: f32,
    width: f32,
    height: f32,
    /// The true object whose box it is; null in the middle of the frame.
    object: Option<u32>,
}

impl TakenRegion {
    /// Returns the region that `estimator` started from, given its `output`; `None` if the user placed one, or none is tracked.
    pub fn of(estimator: &dyn AnyEstimator, output: &Output) -> Option<Self> {
        zone_at_default(estimator)?;
        let field: &RegionField = output.get()?;
        let bounds = field.frames.first()?.region.bounds();
        let ([x, y], [width, height]) = (bounds.min, bounds.size());
        Some(Self { frame: field.first, x, y, width, height, object: field.object })
    }

    /// One line: the box and why it was taken.
    pub fn text(&self) -> String {
        let Self { frame, object, .. } = self;
        let [x, y, width, height] = [self.x, self.y, self.width, self.height].map(|c| fixed(c.into(), 1));
        let why = match object {
            Some(id) => format!("around true object {id}"),
            None => "near the middle of the frame".to_owned(),
        };
        format!("x {x}, y {y}, {width}×{height} px in frame {frame}, {why}: none was placed")
    }
}

/// The rectangle that is taken where `spec` is not placed, as a clause.
pub fn told_of_unplaced(spec: &Spec) -> String {
    format!("no {} is placed on an object, so one near the middle of the frame is taken", spec.label.to_lowercase())
}

/// What is said of that pair.
pub fn told_of_pair(frame: usize) -> String {
    format!("The true flow is known for frames {frame} → {}: the run is on this pair.", frame + 1)
}

impl Prepared {
    /// Opens the clip of `experiment` with its own ground truth and detections and the other `options`.
    ///
    /// # Errors
    /// As [`Source::open`].
    pub fn open(experiment: Experiment, options: Open) -> Result<Self, Error> {
        let options = Open { given: experiment.given.clone(), ..options };
        let OpenedClip { clip, inputs } = experiment.source.open(&options)?;
        Ok(Self { experiment, clip, inputs: Arc::new(inputs) })
    }
}

#[cfg(test)]
mod tests {
    use motionscope_core::base::Threads;
    use motionscope_core::course::estimator;
    use motionscope_core::synth;

    use super::*;

    #[test]
    fn the_region_that_is_taken_is_told_where_none_is_placed() {
        let sample = synth::scene("traffic").expect("it is bundled");
        let clip = sample.clip(&sample.difficulty()).expect("a clip");
        let taken = |id: &str, settings: &[(&str, &str)]| {
            let mut estimator = estimator(id).expect("it is there");
            settings.iter().for_each(|(name, value)| estimator.set(name, value).expect("in range"));
            TakenRegion::of(&*estimator, &estimator.run(&clip, 0, &Threads::single()).expect("a run"))
        };
        let told = taken("mean-shift", &[("frames", "2")]).expect("none is placed").text();
        assert!(told.starts_with("x ") && told.contains("around true object "), "{told}");
        assert_eq!(taken("mean-shift", &[("frames", "2"), ("region", "20,120,60,150")]), None);
        assert_eq!(taken("kalman-tracker", &[("frames", "2")]), None);
    }
}
