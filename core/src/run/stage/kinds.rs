//! The kinds of stages: the product required of each, and how it is computed.

use super::super::AnyEstimator;
use super::chosen::FRAMES;
use super::{Frames, Makes, Stage};
use crate::base::{Error, Threads};
use crate::data::{Clip, Flow, Frame};
use crate::params::Kind;
use crate::products::{
    BlockField, DenseField, DisparityField, MaskField, ModelField, ObjectField, PointField, Product, ProductKind,
    TrackField,
};

/// Makes a dense flow.
#[derive(Clone, Copy, Debug)]
pub struct DenseFlow;

impl Makes for DenseFlow {
    const ASKS: &'static str = "flow";
    const PRODUCT: &'static ProductKind = DenseField::KIND;
    const WORDS: &'static str = "a dense flow";
}

impl Stage<DenseFlow> {
    /// The dense flow from frame `t` of a clip to frame `t + 1`.
    ///
    /// # Errors
    /// If there is no such pair, it cannot be read, the work is cancelled, or the stage makes no field as it is set.
    pub fn flow(&self, clip: &Clip, t: usize, threads: &Threads) -> Result<Flow, Error> {
        let output = self.estimator.run(clip, t, threads)?;
        output.flow().filter(|_| output.motion().is_field()).ok_or_else(|| {
            let id = self.estimator.info().id;
            Error::new(format!("{id} makes no dense flow with these parameters; change them, or choose another method"))
        })
    }

    /// Where each pixel of the first of two frames of one size goes in the second; frames of `clip`, with which the work is
    /// cancelled.
    ///
    /// # Errors
    /// If the sizes differ, the frames are too small for the method, or the work was cancelled.
    pub fn between(&self, clip: &Clip, frames: [&Frame; 2], threads: &Threads) -> Result<Flow, Error> {
        let grays = frames.map(|frame| Frame::gray(frame.luma().clone()));
        let pair = Clip::from_frames("a pair of frames", grays.into())?;
        self.flow(&pair.part_of(clip), 0, threads)
    }
}

/// Makes disparities of the two views of a frame.
#[derive(Clone, Copy, Debug)]
pub struct Disparities;

impl Makes for Disparities {
    const ASKS: &'static str = "disparity";
    const PRODUCT: &'static ProductKind = DisparityField::KIND;
    const WORDS: &'static str = "disparities";
    // A point that one view does not show has no position.
    const DEFAULTS: &'static [(&'static str, &'static str)] = &[("fill", "off")];
}

impl Stage<Disparities> {
    /// The disparities of frame `t` of a clip.
    ///
    /// # Errors
    /// If it cannot be read, or the work is cancelled.
    pub fn disparities(&self, clip: &Clip, t: usize, threads: &Threads) -> Result<DisparityField, Error> {
        let output = self.estimator.run(clip, t, threads)?;
        output.get().cloned().ok_or_else(|| {
            let id = self.estimator.info().id;
            Error::new(format!(
                "{id} makes no disparities with these parameters; change them, or choose another method"
            ))
        })
    }
}

/// Makes one motion for the whole picture.
#[derive(Clone, Copy, Debug)]
pub struct GlobalModel;

impl Makes for GlobalModel {
    const ASKS: &'static str = "motion";
    const PRODUCT: &'static ProductKind = ModelField::KIND;
    const WORDS: &'static str = "one motion for the whole picture";
}

impl Stage<GlobalModel> {
    /// The motion from frame `t` of a clip to frame `t + 1`.
    ///
    /// # Errors
    /// If there is no such pair, it cannot be read, or the work is cancelled.
    pub fn model(&self, clip: &Clip, t: usize, threads: &Threads) -> Result<ModelField, Error> {
        let output = self.estimator.run(clip, t, threads)?;
        output.get().cloned().ok_or_else(|| {
            let id = self.estimator.info().id;
            Error::new(format!(
                "{id} makes no motion model with these parameters; change them, or choose another method"
            ))
        })
    }

    /// The motion from the first of two frames of one size to the second; frames of `clip`, with which the work is cancelled.
    ///
    /// # Errors
    /// As [`Self::model`].
    pub fn between_frames(&self, clip: &Clip, frames: [&Frame; 2], threads: &Threads) -> Result<ModelField, Error> {
        let pair = Clip::from_frames("a pair of frames", frames.map(Frame::clone).into())?;
        self.model(&pair.part_of(clip), 0, threads)
    }
}

/// Makes foreground masks, and detects the objects in them.
#[derive(Clone, Copy, Debug)]
pub struct Foreground;

impl Makes for Foreground {
    const ASKS: &'static str = "detections";
    const DECIDED: &'static [&'static str] = &[FRAMES];
    const PRODUCT: &'static ProductKind = MaskField::KIND;
    const WORDS: &'static str = "foreground masks";
    const DEFAULTS: &'static [(&'static str, &'static str)] = &[("pixels", "foreground")];
}

/// Makes foreground masks.
#[derive(Clone, Copy, Debug)]
pub struct Masks;

impl Makes for Masks {
    const ASKS: &'static str = "masks";
    const DECIDED: &'static [&'static str] = &[FRAMES];
    const PRODUCT: &'static ProductKind = MaskField::KIND;
    const WORDS: &'static str = "foreground masks";
}

/// Makes objects that are followed over time.
#[derive(Clone, Copy, Debug)]
pub struct Tracks;

impl Makes for Tracks {
    const ASKS: &'static str = "tracks";
    const DECIDED: &'static [&'static str] = &[FRAMES];
    const PRODUCT: &'static ProductKind = ObjectField::KIND;
    const WORDS: &'static str = "tracks of objects";
    // As a live camera would see it: the analysis uses the results known at the time.
    const DEFAULTS: &'static [(&'static str, &'static str)] = &[("backdate", "off"), ("interpolate", "off")];
}

/// Stages that go through a clip frame after frame.
pub trait ByFrame: Makes {}
impl ByFrame for Foreground {}
impl ByFrame for Masks {}
impl ByFrame for Tracks {}

impl<M: ByFrame> Stage<M> {
    /// Its products for at most `count` frames of a clip from frame `first` on.
    ///
    /// # Errors
    /// If it cannot run there.
    pub fn frames(&self, clip: &Clip, first: usize, count: usize) -> Result<Frames, Error> {
        Frames::begin(&*self.estimator, clip, (first, count))
    }
}

/// Makes trajectories of points through a clip.
#[derive(Clone, Copy, Debug)]
pub struct FeatureTracks;

impl Makes for FeatureTracks {
    const ASKS: &'static str = "feature-tracks";
    const DECIDED: &'static [&'static str] = &[FRAMES];
    const PRODUCT: &'static ProductKind = TrackField::KIND;
    const WORDS: &'static str = "feature tracks";

    fn lacks(estimator: &dyn AnyEstimator) -> Option<&'static str> {
        // A figure placed by hand allows a single object.
        let is_placed = estimator.specs().iter().any(|spec| matches!(spec.kind, Kind::Placed(_)));
        is_placed.then_some("follows what is placed on the picture")
    }
}

impl Stage<FeatureTracks> {
    /// The tracks through `count` frames at most from frame `first` of a clip on.
    ///
    /// # Errors
    /// If a frame cannot be read, or the work is cancelled.
    pub fn tracks(&self, clip: &Clip, (first, count): (usize, usize), threads: &Threads) -> Result<TrackField, Error> {
        let mut estimator = self.estimator.boxed_clone();
        if estimator.specs().iter().any(|spec| spec.name == FRAMES) {
            estimator.set(FRAMES, &count.to_string())?;
        }
        let output = estimator.run(clip, first, threads)?;
        output.get().cloned().ok_or_else(|| {
            let id = estimator.info().id;
            Error::new(format!("{id} makes no tracks with these parameters; change them, or choose another method"))
        })
    }
}

/// Makes the keypoints of single frames.
#[derive(Clone, Copy, Debug)]
pub struct Keypoints;

impl Makes for Keypoints {
    const ASKS: &'static str = "keypoints";
    const PRODUCT: &'static ProductKind = PointField::KIND;
    const WORDS: &'static str = "keypoints of single frames";
    // The parent selects among all of them.
    const DEFAULTS: &'static [(&'static str, &'static str)] = &[("min-distance", "0"), ("max-points", "100000")];

    fn lacks(estimator: &dyn AnyEstimator) -> Option<&'static str> {
        (estimator.info().frames > 1).then_some("tracks keypoints through a pair of frames")
    }
}

impl Stage<Keypoints> {
    /// The keypoints of frame `t` of a clip.
    ///
    /// # Errors
    /// If it cannot be read, or the detector refuses it.
    pub fn points(&self, clip: &Clip, t: usize, threads: &Threads) -> Result<PointField, Error> {
        let output = self.estimator.run(clip, t, threads)?;
        output.get().cloned().ok_or_else(|| {
            let id = self.estimator.info().id;
            Error::new(format!(
                "{id} makes no keypoints with these parameters; change them, or choose another detector"
            ))
        })
    }
}

/// Makes block vectors by testing candidates.
#[derive(Clone, Copy, Debug)]
pub struct BlockVectors;

impl Makes for BlockVectors {
    const ASKS: &'static str = "block-vectors";
    const PRODUCT: &'static ProductKind = BlockField::KIND;
    const WORDS: &'static str = "block vectors";
    // The parent decides blocks and cost, and refines the vectors.
    const DECIDED: &'static [&'static str] =
        &["block-size", "search-range", "cost", "subpixel", "interpolation", "lambda", "spacing", "border"];
}
