//! Tracking of one region through a clip: its start, its path, and what all trackers of a region explain alike.
//!
//! A [`RegionModel`] learns the object in the first frame and finds it in each later one; [`RegionTracking`] turns it into an
//! estimator.
//!
//! All trackers share the start (`start.rs`: placed, from the truth, or in the middle), the path and the scores. The outcome
//! for the region (`ending.rs`) chooses the conclusion, which also reports a region found again after a loss (`regained.rs`)
//! and the content of a mask that left the object (`content.rs`). A refused region ends the run with the first frame and the
//! reason. The product is a `RegionField`, which is also a track of one object. A model that knows the pixels of the object
//! (`mask`) has a `MaskField` as well: contours do, snakes as a `Fit` to edges (`methods/contour`) and `chan-vese` with a level
//! set function. Both start from a placed polygon, or from the ellipse in the region.

pub(crate) mod color;
mod conclusion;
mod content;
mod ending;
mod explain;
pub(crate) mod plots;
mod regained;
mod start;
mod tracker;
pub(crate) mod vocabulary;

use std::sync::Arc;

pub use ending::{Ending, Loss, Outcome};
pub use start::Settings;
use start::{Chosen, Restarts, choose};
pub(crate) use start::{LOST, WHERE, line};
pub use tracker::{At, Explained, Refusal, RegionModel, Similarity};

use crate::base::{Error, Mapped, Observer};
use crate::data::{Clip, Frame};
use crate::params::inner_params;
use crate::products::{MaskField, ObjectFrame, Output, Product, ProductKind, Region, RegionField, RegionFrame};
use crate::run::{Estimator, Footprint, Granularity, Guarantee, Info, Need, Progress, Seen, Span, need};
use crate::scene::{Chart, Name, Question, Role, Scene, Step};

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
    refusal: Option<Arc<Refusal>>,
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
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.draw_step(seen, scene);
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
