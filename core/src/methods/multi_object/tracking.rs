//! Trackers of many objects as estimators: a [`MultiTracker`] tracks the detections of a frame, and [`MultiTracking`] makes a run of it.

use super::lifecycle::Rules;
use super::selected::{Selected, track_at};
use super::tracker_run::{Conclusion, Settings, TrackerRun};
use super::{explain, truth};
use crate::base::{Error, Observer};
use crate::data::{Clip, Detection};
use crate::params::{Params, inner_params};
use crate::products::{ObjectField, ObjectFrame, Output, Product, ProductKind, objects::score::FrameErrors};
use crate::run::{Estimator, Explained, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen};
use crate::scene::{Chart, Focus, Question, Role, Scene, Step};

/// A tracker of many objects.
pub trait MultiTracker: Params + Default + Clone + Send + Sync + 'static {
    /// The description of the tracker.
    const INFO: Info;
    /// As [`Estimator::QUESTIONS`].
    const QUESTIONS: &'static [Question];
    /// The charts of its steps.
    const CHARTS: &'static [Chart] = &[Chart::Matrices, Chart::Series];
    /// Everything that is carried from frame to frame, besides the run.
    type Tracks: Clone + Default + Send + Sync + 'static;
    /// An event inside a frame.
    type Event: Clone + Send + Sync + 'static;

    /// The parameters that all trackers start with.
    fn settings(&self) -> &Settings;

    /// Track management.
    fn rules(&self) -> Rules;

    /// Whether later frames decide earlier ones, besides the hindsight of the rules.
    fn is_deferred(&self) -> bool {
        false
    }

    /// Tracks the detections of a frame, of which others were discarded by the minimum score.
    ///
    /// # Errors
    /// If the frame cannot be read, or the work is cancelled.
    fn track(
        &self,
        clip: &Clip,
        state: &mut State<Self::Tracks>,
        found: (Vec<Detection>, usize),
        observer: &mut impl Observer<Self::Event>,
    ) -> Result<Progress, Error>;

    /// The role of an event that stands out in the timeline.
    fn landmark(&self, event: &Self::Event) -> Option<Role>;

    /// Memory of the tracks and of the work.
    fn need(&self, clip: &Clip) -> Need;

    /// Memory of the tracks in bytes.
    fn tracks_bytes(&self, tracks: &Self::Tracks) -> usize;

    /// Explains a step.
    fn step(&self, seen: &Seen<MultiTracking<Self>>) -> Step;

    /// Draws a step.
    fn draw(&self, seen: &Seen<MultiTracking<Self>>, scene: &mut Scene);
}

/// The estimator that tracks many objects by the tracker `T`.
#[derive(Clone, Debug, Default)]
pub struct MultiTracking<T>(pub T);

inner_params!(MultiTracking<T: MultiTracker>);

/// The state of a run.
#[derive(Clone)]
pub struct State<T> {
    pub(crate) run: TrackerRun,
    pub(crate) tracks: T,
}

impl<T: MultiTracker> Estimator for MultiTracking<T> {
    const INFO: Info = T::INFO;
    const QUESTIONS: &'static [Question] = T::QUESTIONS;
    const GUARANTEE: Guarantee = Guarantee::Objects;
    const NEEDS_PICTURES: bool = false;
    const CHARTS: &'static [Chart] = T::CHARTS;
    const PRODUCES: &'static [&'static ProductKind] = &[ObjectField::KIND];
    type State = State<T::Tracks>;
    type Event = T::Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<Self::State, Error> {
        Ok(State { run: TrackerRun::new(self.0.settings().clone(), clip, frame)?, tracks: T::Tracks::default() })
    }

    fn advance(
        &self,
        clip: &Clip,
        state: &mut Self::State,
        observer: &mut impl Observer<T::Event>,
    ) -> Result<Progress, Error> {
        let found = state.run.look(clip)?;
        let progress = self.0.track(clip, state, found, observer)?;
        clip.wanted()?;
        Ok(progress)
    }

    fn units(&self, state: &Self::State) -> Option<usize> {
        state.run.span.frames()
    }

    fn place(&self, state: &Self::State) -> Vec<Granularity> {
        state.run.place()
    }

    fn units_of(&self, _picture: (usize, usize), frames: usize) -> Option<usize> {
        Some(frames)
    }

    fn at_frame(&self, state: &Self::State) -> Option<usize> {
        Some(state.run.frame())
    }

    fn landmark(&self, event: &T::Event) -> Option<Role> {
        self.0.landmark(event)
    }

    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.0.step(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.0.draw(seen, scene);
        if let Some(selected) = selected(seen) {
            selected.draw(scene);
        }
    }

    fn causal(&self, state: &Self::State) -> Option<Output> {
        let looks_back = self.0.is_deferred() || self.0.rules().looks_back();
        looks_back.then(|| Output::of(state.run.live_field()))
    }

    fn output(&self, state: &Self::State) -> Output {
        Output::of(state.run.field())
    }
}

impl<T: MultiTracker> Footprint<State<T::Tracks>> for MultiTracking<T> {
    fn need(&self, clip: &Clip) -> Need {
        self.0.need(clip)
    }

    fn state_bytes(&self, state: &State<T::Tracks>) -> usize {
        state.run.own_bytes() + self.0.tracks_bytes(&state.tracks)
    }

    fn memory_bytes(&self, state: &State<T::Tracks>) -> usize {
        self.state_bytes(state) + state.run.shared_bytes()
    }
}

impl<T: MultiTracker> Pointed<State<T::Tracks>> for MultiTracking<T> {
    fn explained(&self, state: &State<T::Tracks>, focus: Focus) -> Option<Explained> {
        focus.object.or_else(|| track_at(&state.run, focus.at)).map(|_| Explained::Always)
    }

    fn object_at(&self, state: &State<T::Tracks>, focus: Focus) -> Option<u32> {
        track_at(&state.run, focus.at)
    }

    fn place_of(&self, state: &State<T::Tracks>, object: u32) -> Option<[f32; 2]> {
        let frames = state.run.frames().iter().rev();
        frames.filter_map(|frame| frame.object(object)).next().map(|last| last.position.map(|c| c as f32))
    }
}

/// The track that is pointed at.
pub(crate) fn selected<T: MultiTracker>(seen: &Seen<MultiTracking<T>>) -> Option<Selected> {
    let (run, focus) = (&seen.after.unwrap_or(seen.before).run, seen.focus?);
    Selected::of(run, seen.clip, focus.object.or_else(|| track_at(run, seen.point()?))?)
}

/// The errors of the frame beside the truth, at its end.
pub(crate) fn errors<T: MultiTracker>(seen: &Seen<MultiTracking<T>>) -> Option<FrameErrors> {
    truth::errors_of_last(seen.clip, &seen.after?.run)
}

/// Draws the detections of a frame: within it with their numbers, at its end with the errors beside the truth.
pub(crate) fn draw_detections<T: MultiTracker>(
    scene: &mut Scene,
    seen: &Seen<MultiTracking<T>>,
    detected: &[Detection],
) {
    explain::draw_detections(scene, detected);
    scene.is_overview = seen.after.is_some() && seen.point().is_none();
    match seen.after {
        Some(_) => errors(seen).iter().for_each(|errors| truth::draw(scene, errors)),
        None => explain::number_detections(scene, detected),
    }
}

/// Adds the errors of a finished frame and the track that is pointed at among the facts.
pub(crate) fn add_errors_and_selected<T: MultiTracker>(step: Step, seen: &Seen<MultiTracking<T>>) -> Step {
    let step = errors(seen).iter().fold(step, truth::add_errors);
    selected(seen).iter().fold(step, |step, selected| selected.add_to(step))
}

/// Says the end of a frame: the track that is pointed at, or else the conclusion and the identity switches.
pub(crate) fn tell_end<T: MultiTracker>(
    step: Step,
    seen: &Seen<MultiTracking<T>>,
    (frame, conclusion): (&ObjectFrame, &Conclusion),
) -> Step {
    match selected(seen) {
        Some(selected) => selected.tell(step),
        None => errors(seen).iter().fold(explain::tell_conclusion(step, frame, conclusion), truth::tell_switches),
    }
}
