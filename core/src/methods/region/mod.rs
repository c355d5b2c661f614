//! Tracking of one region through a clip: its start, its path, and what all trackers of a region explain alike.
//!
//! A [`RegionModel`] learns the object in the first frame and finds it in each later one; [`RegionTracking`] turns it into an
//! estimator.

pub(crate) mod color;
mod conclusion;
mod content;
mod ending;
mod explain;
pub(crate) mod plots;
mod regained;
mod start;
pub(crate) mod vocabulary;

use std::sync::Arc;

pub use ending::{Ending, Loss, Outcome};
pub use start::Settings;
use start::{Chosen, Restarts, choose};
pub(crate) use start::{LOST, WHERE, line};
use vocabulary::case;

use crate::base::{Error, Mapped, Observer};
use crate::data::{Clip, Frame, PackedMask, Pose};
use crate::geometry::Bounds;
use crate::params::{Params, inner_params};
use crate::products::{MaskField, ObjectFrame, Output, Product, ProductKind, Region, RegionField, RegionFrame};
use crate::run::{Estimator, Footprint, Granularity, Guarantee, Info, Need, Progress, Seen, Span, need};
use crate::scene::{Chart, Fact, Name, Question, Readout, Role, Scene, Sentence, Step};

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
    /// What has a high one too, without being the object, as the subject of a sentence.
    pub shared_by: &'static str,
}

/// A tracker of one region: a model of its appearance, and the search for it.
pub trait RegionModel: Params + Default + Clone + Send + Sync + 'static {
    /// The description of the tracker.
    const INFO: Info;
    /// As [`Estimator::QUESTIONS`]; [`WHERE`] belongs to all, [`LOST`] to those with a criterion of loss.
    const QUESTIONS: &'static [Question];
    /// The charts of its steps.
    const CHARTS: &'static [Chart] = &[Chart::Series];
    /// As [`Estimator::CONTRASTS`].
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

    /// Why a region of the first frame cannot be tracked, as a sentence with its number, if it cannot.
    fn refuse(&self, frame: &Frame, region: Region) -> Option<Sentence> {
        self.refusal(frame, region).map(|why| Sentence::default().text(why))
    }

    /// [`RegionModel::refuse`] of a tracker whose steps are not yet data.
    fn refusal(&self, _frame: &Frame, _region: Region) -> Option<String> {
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
    fn step(&self, at: &At<'_, Self>, step: Step) -> Step {
        let mut step = step.tell(self.sentence(at));
        if let Some(Readout::Facts(facts)) = step.readouts.first_mut() {
            facts.extend(self.facts(at));
        }
        step.show_all(self.readouts(at))
    }

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
        match self.opening() {
            opening if opening.is_empty() => step.say(case::OPENING),
            opening => told(step, "", Some(opening)),
        }
    }

    /// Tells why the object is lost in a frame, at the tracker's last event: a clause that begins with a colon.
    fn tell_loss(&self, at: &At<'_, Self>, step: Step) -> Step {
        told(step, ": ", self.loss(at))
    }

    /// Tells what all frames of a run show beyond their regions, at the tracker's last event, as a further sentence of its end.
    fn tell_summary(&self, at: &At<'_, Self>, step: Step) -> Step {
        told(step, " ", self.summary(at))
    }

    /// Tells what the result of a frame that did not lose the object does not show, at the tracker's last event, as a sentence.
    fn tell_caveat(&self, at: &At<'_, Self>, step: Step) -> Step {
        told(step, " ", self.caveat(at))
    }

    /// Tells the lesson of a run at the last event of its tracker: why it ended so, and what would help. The outcome is never
    /// [`Outcome::Unknown`].
    fn advise(&self, ending: Ending, at: &At<'_, Self>, step: Step) -> Step {
        told(step, " ", Some(self.advice(ending, at)))
    }

    // The explanation of trackers whose steps are not yet data; the methods above replace these.

    /// The sentence of [`Explained::step`].
    fn sentence(&self, _at: &At<'_, Self>) -> Sentence {
        Sentence::default()
    }

    /// The facts of [`Explained::step`].
    fn facts(&self, _at: &At<'_, Self>) -> Vec<Fact> {
        Vec::new()
    }

    /// The formula and the charts of [`Explained::step`].
    fn readouts(&self, _at: &At<'_, Self>) -> Vec<Readout> {
        Vec::new()
    }

    /// The text of [`Explained::open`].
    fn opening(&self) -> String {
        String::new()
    }

    /// The text of [`Explained::tell_loss`].
    fn loss(&self, _at: &At<'_, Self>) -> Option<String> {
        None
    }

    /// The text of [`Explained::tell_summary`].
    fn summary(&self, _at: &At<'_, Self>) -> Option<String> {
        None
    }

    /// The text of [`Explained::tell_caveat`].
    fn caveat(&self, _at: &At<'_, Self>) -> Option<String> {
        None
    }

    /// The text of [`Explained::advise`].
    fn advice(&self, _ending: Ending, _at: &At<'_, Self>) -> String {
        String::new()
    }
}

/// Tells a text behind `lead`, of a tracker whose steps are not yet data.
fn told(step: Step, lead: &str, text: Option<String>) -> Step {
    match text {
        Some(text) => step.tell(Sentence::default().text(format!("{lead}{text}"))),
        None => step,
    }
}

/// The run at an event of a tracker.
pub struct At<'a, T: RegionModel> {
    /// The model before the frame; none in the first one.
    pub model: Option<&'a T::Model>,
    /// The region before the frame; in the first one that of the start.
    pub region: Region,
    /// The tracker's events of the frame up to the one at hand.
    pub events: Vec<&'a T::Event>,
    /// The event at hand.
    pub event: &'a T::Event,
    /// The true pose of the object in the frame, where it is known.
    pub pose: Option<Pose>,
    /// The true poses of the object in the frames of the run, by their index, where they are known.
    pub poses: Box<dyn Fn(usize) -> Option<Pose> + 'a>,
}

/// The estimator that tracks a region by the model `T`.
#[derive(Clone, Debug, Default)]
pub struct RegionTracking<T>(pub T);

inner_params!(RegionTracking<T: RegionModel>);

/// The state of a run.
#[derive(Clone)]
pub struct State<M> {
    span: Span,
    /// The next frame.
    frame: usize,
    picture: (usize, usize),
    chosen: Arc<Chosen>,
    /// Why the region cannot be tracked, if it cannot: the run ends with the first frame.
    refusal: Option<Arc<Sentence>>,
    /// The model, from the first frame on.
    model: Option<Arc<M>>,
    /// The region of the last frame.
    region: Region,
    past: Arc<Vec<RegionFrame>>,
    /// The masks of the frames, where the model has any.
    masks: Arc<Vec<Arc<ObjectFrame>>>,
    restarts: Restarts,
}

impl<M> State<M> {
    fn mask_field(&self) -> MaskField {
        MaskField { picture: self.picture, first: self.span.first, frames: self.masks.to_vec() }
    }

    fn field(&self) -> RegionField {
        let (first, object) = (self.span.first, self.chosen.object);
        RegionField { picture: self.picture, first, object, frames: self.past.to_vec() }
    }
}

/// An event of a frame.
#[derive(Clone)]
pub enum Event<E> {
    /// The region of the first frame.
    Chosen,
    /// It cannot be tracked.
    Refused,
    /// The tracker waits for its restart.
    Waiting,
    /// An event of the tracker.
    Own(E),
    /// The result of the frame.
    Moved(RegionFrame),
}

impl<T: RegionModel> RegionTracking<T> {
    /// Learns the object in the first frame, unless it cannot be tracked.
    fn learn(
        &self,
        state: &mut State<T::Model>,
        frame: &Arc<Frame>,
        observer: &mut impl Observer<Event<T::Event>>,
    ) -> RegionFrame {
        observer.see(|| Event::Chosen);
        if state.refusal.is_some() {
            observer.see(|| Event::Refused);
            return RegionFrame { region: state.region, similarity: 0.0, is_lost: true };
        }
        let mut own = Mapped { observer: &mut *observer, map: Event::Own };
        let (model, similarity) = self.0.begin(frame, state.region, &mut own);
        let fitted = self.0.fitted(&model);
        state.model = Some(Arc::new(model));
        if let Some(result) = fitted {
            observer.see(|| Event::Moved(result));
        }
        fitted.unwrap_or(RegionFrame { region: state.region, similarity, is_lost: false })
    }

    /// Keeps the mask of the frame that gave a result.
    fn keep_mask(&self, state: &mut State<T::Model>, result: &RegionFrame) {
        if T::PRODUCES.contains(&MaskField::KIND) {
            let model = state.model.as_deref().filter(|_| !result.is_lost);
            let mask = model.and_then(|model| self.0.mask(model));
            Arc::make_mut(&mut state.masks).push(Arc::new(ObjectFrame { mask, ..ObjectFrame::default() }));
        }
    }
}

impl<T: Explained> Estimator for RegionTracking<T> {
    const INFO: Info = T::INFO;
    const QUESTIONS: &'static [Question] = T::QUESTIONS;
    const GUARANTEE: Guarantee = Guarantee::Region;
    const CHARTS: &'static [Chart] = T::CHARTS;
    const CONTRASTS: Option<&'static str> = T::CONTRASTS;
    const PRODUCES: &'static [&'static ProductKind] = T::PRODUCES;
    type State = State<T::Model>;
    type Event = Event<T::Event>;

    fn start(&self, clip: &Clip, frame: usize) -> Result<Self::State, Error> {
        let settings = self.0.settings();
        let span = Span::new(clip, frame, settings.frames)?;
        let first = clip.frame(frame)?;
        let chosen = choose(self.0.placed(clip.size())?, clip, frame)?;
        let refusal = self.0.refuse(&first, chosen.region).map(Arc::new);
        let span = if refusal.is_some() { span.until(frame + 1) } else { span };
        Ok(State {
            span,
            frame,
            picture: clip.size(),
            region: chosen.region,
            chosen: Arc::new(chosen),
            refusal,
            model: None,
            past: Arc::default(),
            masks: Arc::default(),
            restarts: Restarts::default(),
        })
    }

    fn advance(
        &self,
        clip: &Clip,
        state: &mut Self::State,
        observer: &mut impl Observer<Self::Event>,
    ) -> Result<Progress, Error> {
        clip.wanted()?;
        need::check_kept(clip, self.state_bytes(state))?;
        let frame = clip.frame(state.frame)?;
        if let Some(region) = state.restarts.region(state.chosen.object, (clip, state.frame))?
            && self.0.refuse(&frame, region).is_none()
        {
            state.region = region;
            state.restarts = Restarts { waits_until: None, count: state.restarts.count + 1 };
        }
        let result = match &mut state.model {
            _ if state.restarts.waits_until.is_some() => {
                let result = RegionFrame { region: state.region, similarity: 0.0, is_lost: true };
                observer.see(|| Event::Waiting);
                observer.see(|| Event::Moved(result));
                result
            }
            None => self.learn(state, &frame, observer),
            Some(model) => {
                let mut own = Mapped { observer: &mut *observer, map: Event::Own };
                let result = self.0.follow(Arc::make_mut(model), &frame, state.region, &mut own);
                observer.see(|| Event::Moved(result));
                result
            }
        };
        state.region = result.region;
        let can_fail = self.0.settings().restart && state.restarts.waits_until.is_none();
        if can_fail && state.restarts.fail(&result.region, state.chosen.object, (clip, state.frame))? {
            state.model = None;
        }
        self.keep_mask(state, &result);
        Arc::make_mut(&mut state.past).push(result);
        state.frame += 1;
        let is_over = state.refusal.is_some() || state.span.is_over(clip, state.frame);
        Ok(if is_over { Progress::Done } else { Progress::More })
    }

    fn units(&self, state: &Self::State) -> Option<usize> {
        state.span.frames()
    }

    fn place(&self, state: &Self::State) -> Vec<Granularity> {
        state.span.place(state.frame - state.span.first)
    }

    fn units_of(&self, _picture: (usize, usize), frames: usize) -> Option<usize> {
        Some(frames)
    }

    fn at_frame(&self, state: &Self::State) -> Option<usize> {
        Some(state.frame)
    }

    fn landmark(&self, event: &Self::Event) -> Option<Role> {
        match event {
            Event::Refused => Some(Role::Error),
            Event::Moved(result) if result.is_lost => Some(Role::Error),
            _ => None,
        }
    }

    fn stage(&self, event: &Self::Event) -> Option<Name> {
        Some(self.line_of(event))
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.told(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.drawn(seen, scene);
    }

    fn output(&self, state: &Self::State) -> Output {
        let output = Output::of(state.field());
        if T::PRODUCES.contains(&MaskField::KIND) { output.and(state.mask_field()) } else { output }
    }
}

impl<T: Explained> Footprint<State<T::Model>> for RegionTracking<T> {
    fn need(&self, clip: &Clip) -> Need {
        self.0.need(clip)
    }

    fn state_bytes(&self, state: &State<T::Model>) -> usize {
        let model = state.model.as_ref().map_or(0, |model| self.0.model_bytes(model));
        let masks: usize = state.masks.iter().map(|frame| frame.bytes()).sum();
        size_of::<State<T::Model>>() + model + masks + size_of_val(&state.past[..])
    }
}
