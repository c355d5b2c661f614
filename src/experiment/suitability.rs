//! Whether a clip suits an estimator, by what both declare and by the examples: nothing is run.

use motionscope_core::course::examples::{self, Cause};
use motionscope_core::data::Clip;
use motionscope_core::run::{AnyEstimator, Guarantee};

use super::source::Source;

/// Whether a clip suits an estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Suitability {
    /// It has more than the frames that a run reads.
    Suits(Merit),
    /// It has the frames that a run reads.
    Runs,
    /// A run lacks something, or gives a wrong result.
    Unsuited(Flaw),
}

/// Why a clip suits an estimator, the strongest reason first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Merit {
    /// An example of success is this clip.
    Example,
    /// It has two views, which the estimator compares.
    Views,
    /// It has measured depths, which the estimator uses.
    Depths,
    /// It has detections, which the estimator tracks.
    Detections,
    /// Its true objects are known, which the estimator begins with.
    Objects,
}

impl Merit {
    /// Every reason, the strongest first.
    pub const ALL: [Self; 5] = [Self::Example, Self::Views, Self::Depths, Self::Detections, Self::Objects];

    /// The reason in one sentence.
    pub fn words(self) -> &'static str {
        match self {
            Self::Example => "This clip is its example.",
            Self::Views => "It compares the two views of the clip.",
            Self::Depths => "It uses the measured depths of the clip.",
            Self::Detections => "It tracks the detections of the clip.",
            Self::Objects => "It begins with the true objects.",
        }
    }
}

/// Why a clip does not suit an estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flaw {
    /// The clip has detections but no frames.
    Frames,
    /// The clip has a single frame.
    NextFrame,
    /// The clip has no right view.
    RightView,
    /// The clip has neither a right view nor measured depths.
    Depths,
    /// An example of failure is this clip.
    Fails(Cause),
}

impl Flaw {
    /// The reason in one sentence.
    pub fn words(self) -> String {
        match self {
            Self::Frames => "Needs frames.".into(),
            Self::NextFrame => "Needs two frames.".into(),
            Self::RightView => "Needs a right view.".into(),
            Self::Depths => "Needs a right view or depths.".into(),
            Self::Fails(cause) => format!("Fails here: {}.", cause.name()),
        }
    }
}

impl Suitability {
    /// Whether `clip`, opened from `source`, suits `estimator` with its default parameters.
    pub fn of(estimator: &dyn AnyEstimator, source: &Source, clip: &Clip) -> Self {
        if let Some(flaw) = missing(estimator, clip) {
            return Self::Unsuited(flaw);
        }
        match (claim(estimator.info().id, source), merit(estimator, clip)) {
            (Some(Some(cause)), _) => Self::Unsuited(Flaw::Fails(cause)),
            (Some(None), _) => Self::Suits(Merit::Example),
            (None, Some(merit)) => Self::Suits(merit),
            (None, None) => Self::Runs,
        }
    }
}

/// What the clip lacks for a run of the estimator.
fn missing(estimator: &dyn AnyEstimator, clip: &Clip) -> Option<Flaw> {
    let has_right = clip.right().is_some();
    match estimator.guarantee() {
        _ if clip.is_blank() => estimator.needs_pictures().then_some(Flaw::Frames),
        _ if clip.info().frames.is_some_and(|frames| frames < estimator.info().frames) => Some(Flaw::NextFrame),
        Guarantee::Disparity if !has_right => Some(Flaw::RightView),
        Guarantee::SceneFlow if !has_right && !clip.has_depths() => Some(Flaw::Depths),
        _ => None,
    }
}

/// What the clip has for the estimator beside frames.
fn merit(estimator: &dyn AnyEstimator, clip: &Clip) -> Option<Merit> {
    let has_objects = clip.truth().is_some_and(|truth| truth.kinds().contains(&"objects"));
    match estimator.guarantee() {
        Guarantee::SceneFlow if clip.right().is_none() => Some(Merit::Depths),
        Guarantee::Disparity | Guarantee::SceneFlow => Some(Merit::Views),
        _ if !estimator.needs_pictures() && clip.detections(0).is_some() => Some(Merit::Detections),
        Guarantee::Region if has_objects => Some(Merit::Objects),
        _ if !estimator.needs_pictures() && has_objects => Some(Merit::Objects),
        _ => None,
    }
}

/// What an example with default parameters claims of this very clip: the cause of a failure, or none where the estimator works.
fn claim(id: &str, source: &Source) -> Option<Option<Cause>> {
    let is_clip = |name: &str| Source::parse(format!("synth:{name}")).is_ok_and(|of| of == *source);
    let of_clip = examples::of(id).filter(|example| example.settings.is_empty()).find(|example| is_clip(example.clip));
    of_clip.map(|example| example.cause)
}

#[cfg(test)]
mod tests {
    use motionscope_core::course::{estimator, estimators};
    use motionscope_core::data::{Detection, Frame};
    use motionscope_core::geometry::Grid;

    use super::*;
    use crate::media::Open;

    fn on(id: &str, name: &str) -> Suitability {
        let source = Source::parse(name).expect("a scene");
        let clip = source.open(&Open::default()).expect("a clip").clip;
        Suitability::of(&*estimator(id).expect("an estimator"), &source, &clip)
    }

    #[test]
    fn a_clip_with_two_views_suits_stereo_and_one_without_does_not() {
        for id in ["block-stereo", "semi-global-matching"] {
            assert_eq!(on(id, "synth:pillar"), Suitability::Unsuited(Flaw::RightView), "{id}");
            assert_eq!(on(id, "synth:still-life"), Suitability::Suits(Merit::Example), "{id}");
            assert_eq!(on(id, "synth:drive"), Suitability::Suits(Merit::Views), "{id}");
        }
        assert_eq!(on("scene-flow", "synth:pillar"), Suitability::Unsuited(Flaw::Depths));
    }

    #[test]
    fn an_example_speaks_of_its_very_clip() {
        let repeats = Suitability::Unsuited(Flaw::Fails(Cause::Repetition));
        assert_eq!(on("block-stereo", "synth:still-life,repeating-texture=100"), repeats);
        assert_eq!(on("block-stereo", "synth:still-life,repeating-texture=99"), Suitability::Suits(Merit::Views));
        assert_eq!(on("running-average", "synth:traffic"), Suitability::Suits(Merit::Example));
        assert_eq!(on("running-average", "synth:traffic,speed=2"), Suitability::Runs);
    }

    #[test]
    fn true_objects_and_detections_suit_what_begins_with_them() {
        for id in ["mean-shift", "kalman-tracker"] {
            assert_eq!(on(id, "synth:pillar"), Suitability::Suits(Merit::Objects), "{id}");
        }
        assert_eq!(on("full-search", "synth:pillar"), Suitability::Runs);
    }

    #[test]
    fn what_a_run_cannot_read_is_told() {
        let source = Source::parse("one.png").expect("a name");
        let picture = Clip::from_frames("one.png", vec![Frame::gray(Grid::new(8, 8, 0))]).expect("a clip");
        let boxes = Clip::blank("det.txt", (8, 8), 2).with_detections(vec![Vec::<Detection>::new(); 2]);
        for estimator in estimators() {
            let (of_picture, of_boxes) =
                (Suitability::of(&*estimator, &source, &picture), Suitability::of(&*estimator, &source, &boxes));
            let reads_one = estimator.info().frames == 1;
            assert_eq!(of_picture == Suitability::Unsuited(Flaw::NextFrame), !reads_one, "{}", estimator.info().id);
            let expected = match estimator.needs_pictures() {
                true => Suitability::Unsuited(Flaw::Frames),
                false => Suitability::Suits(Merit::Detections),
            };
            assert_eq!(of_boxes, expected, "{}", estimator.info().id);
        }
    }
}
