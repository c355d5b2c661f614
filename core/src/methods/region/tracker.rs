//! A tracker of a region: its model of an object, and the explanation of its steps.

use std::sync::Arc;

use super::vocabulary::case;
use super::{Ending, Settings};
use crate::base::{Error, Observer};
use crate::data::{Clip, Frame, PackedMask, Pose};
use crate::geometry::Bounds;
use crate::params::Params;
use crate::products::{Product, ProductKind, Region, RegionField, RegionFrame};
use crate::run::{Info, Need};
use crate::scene::{Case, Chart, Name, Question, Scene, Step, Value};

/// The quantity by which a tracker judges its match.
#[derive(Clone, Copy, Debug)]
pub struct Similarity {
    /// Its name in a sentence: `mean back-projection`.
    pub name: &'static str,
    /// Its name on its own: `Mean back-projection`.
    pub label: &'static str,
    /// Its symbol.
    pub symbol: &'static str,
    /// Its decimals.
    pub decimals: usize,
    /// Another cause of a high similarity, as the subject of a sentence.
    pub shared_by: &'static str,
}

/// Why a region cannot be tracked: the case, and the values that it tells.
pub type Refusal = (&'static Case, Vec<Value>);

/// A tracker of one region: a model of its appearance, and the search for it.
pub trait RegionModel: Params + Default + Clone + Send + Sync + 'static {
    /// The description of the tracker.
    const INFO: Info;
    /// As [`Estimator::QUESTIONS`](crate::run::Estimator::QUESTIONS); [`WHERE`](super::WHERE) belongs to all, [`LOST`](super::LOST) to those with a criterion of loss.
    const QUESTIONS: &'static [Question];
    /// The charts of its steps.
    const CHARTS: &'static [Chart] = &[Chart::Series];
    /// As [`Estimator::CONTRASTS`](crate::run::Estimator::CONTRASTS).
    const CONTRASTS: Option<&'static str> = None;
    /// The quantity by which it judges its match.
    const SIMILARITY: Similarity;
    /// The kinds of products of a run: the region, and the masks of the object where [`RegionModel::mask`] gives them.
    const PRODUCES: &'static [&'static ProductKind] = &[RegionField::KIND];
    /// Everything that is carried from frame to frame, besides the region.
    type Model: Clone + Send + Sync + 'static;
    /// An event inside a frame.
    type Event: Clone + Send + Sync + 'static;

    /// The parameters that all trackers of a region have.
    fn settings(&self) -> &Settings;

    /// The region that is placed on the first frame, of a picture of this size, if one is.
    ///
    /// # Errors
    /// If it cannot be one.
    fn placed(&self, _picture: (usize, usize)) -> Result<Option<Bounds>, Error> {
        Ok(self.settings().region)
    }

    /// Why a region of the first frame cannot be tracked, if it cannot.
    fn refuse(&self, _frame: &Frame, _region: Region) -> Option<Refusal> {
        None
    }

    /// Learns the object from its region in the first frame; returns the similarity to itself too.
    fn begin(
        &self,
        frame: &Arc<Frame>,
        region: Region,
        observer: &mut impl Observer<Self::Event>,
    ) -> (Self::Model, f32);

    /// Finds the object in the frame after one in which it had `region`.
    fn follow(
        &self,
        model: &mut Self::Model,
        frame: &Arc<Frame>,
        region: Region,
        observer: &mut impl Observer<Self::Event>,
    ) -> RegionFrame;

    /// The result of the first frame, where the model is fitted to it.
    fn fitted(&self, _model: &Self::Model) -> Option<RegionFrame> {
        None
    }

    /// The pixels of the object in the last frame, where the model knows them.
    fn mask(&self, _model: &Self::Model) -> Option<PackedMask> {
        None
    }

    /// Memory of a model and its work.
    fn need(&self, clip: &Clip) -> Need;

    /// Memory of a model in bytes.
    fn model_bytes(&self, model: &Self::Model) -> usize;

    /// The line of pseudocode of an event.
    fn line(&self, event: &Self::Event) -> Name;
}

/// The explanation of a tracker of a region.
pub trait Explained: RegionModel {
    /// Whether the advice at the end of a run judges the start of a loss by the visibility of the object.
    const JUDGES_LOSS: bool = false;

    /// Adds the values, the sentence, the formula and the charts of an event to a step at its line.
    fn step(&self, at: &At<'_, Self>, step: Step) -> Step;

    /// Draws the step over frame t.
    fn draw(&self, at: &At<'_, Self>, scene: &mut Scene);

    /// Draws the result of a frame over frame t, beside its region.
    fn draw_result(&self, _model: &Self::Model, _scene: &mut Scene) {}

    /// The part of the picture that the steps of a frame are about, by the model before it, where marks do not tell.
    fn work(&self, _model: &Self::Model) -> Option<Bounds> {
        None
    }

    /// Tells the first sentence of a run.
    fn open(&self, step: Step) -> Step {
        step.say(case::OPENING)
    }

    /// Tells why the object is lost in a frame, at the tracker's last event: a clause that begins with a colon.
    fn tell_loss(&self, _at: &At<'_, Self>, step: Step) -> Step {
        step
    }

    /// Summarises all frames of a run beyond their regions, at the tracker's last event, as a further sentence of its end.
    fn tell_summary(&self, _at: &At<'_, Self>, step: Step) -> Step {
        step
    }

    /// Tells what the result of a frame that did not lose the object does not show, at the tracker's last event, as a sentence.
    fn tell_caveat(&self, _at: &At<'_, Self>, step: Step) -> Step {
        step
    }

    /// Tells the lesson of a run at the last event of its tracker: why it ended so, and what would help. The outcome is never
    /// [`Outcome::Unknown`](super::Outcome::Unknown).
    fn advise(&self, ending: Ending, at: &At<'_, Self>, step: Step) -> Step;
}

/// The run at an event of a tracker.
pub struct At<'a, T: RegionModel> {
    /// The model before the frame; none in the first one.
    pub model: Option<&'a T::Model>,
    /// The region before the frame; in the first one that of the start.
    pub region: Region,
    /// The tracker's events of the frame up to the current one.
    pub events: Vec<&'a T::Event>,
    /// The current event.
    pub event: &'a T::Event,
    /// The true pose of the object in the frame, where it is known.
    pub pose: Option<Pose>,
    /// The true poses of the object in the frames of the run, by their index, where they are known.
    pub poses: Box<dyn Fn(usize) -> Option<Pose> + 'a>,
}
