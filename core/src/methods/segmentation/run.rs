//! Methods of motion segmentation as estimators: a [`Segmenter`] divides the flow of a frame into segments, in rounds, and
//! [`SegmentationRun`] goes through the clip with it.

use super::{FlowInput, Record};
use crate::base::{Error, Observer, Tally, Threads};
use crate::data::Clip;
use crate::params::{Params, inner_params};
use crate::products::{Output, Product, ProductKind, SegmentField};
use crate::run::{
    Estimator, Explained, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen, run_counted,
};
use crate::scene::{Chart, Focus, Question, Role, Scene, Step};

/// The state of a [`Segmenter`] between two rounds.
pub trait SegmenterState: Clone + Send + Sync + 'static {
    /// The state before the last recorded frame.
    fn before(record: Record) -> Self;

    /// The segments of the frames so far.
    fn record(&self) -> &Record;

    /// The rounds of this frame so far.
    fn round(&self) -> usize;

    /// Memory of each checkpoint's own data in bytes, without the record.
    fn own_bytes(&self) -> usize;

    /// Memory shared by checkpoints in bytes, without the record.
    fn shared_bytes(&self) -> usize;
}

/// A method that divides the flow of each frame into segments.
pub trait Segmenter: Params + Default + Clone + Send + Sync + 'static {
    /// The description of the method.
    const INFO: Info;
    /// As [`Estimator::QUESTIONS`].
    const QUESTIONS: &'static [Question];
    /// Memory of a run and of a walk, in bytes per pixel.
    const BYTES_PER_PIXEL: [f64; 2];
    /// The state carried from round to round.
    type State: SegmenterState;
    /// An event inside a round.
    type Event: Clone + Send + Sync + 'static;

    /// The flow that is segmented.
    fn input(&self) -> &FlowInput;

    /// The most frames of a run.
    fn frames(&self) -> usize;

    /// Does the next round.
    ///
    /// # Errors
    /// If a frame cannot be read, or the work is cancelled.
    fn work(
        &self,
        at: (&Clip, &Threads),
        state: &mut Self::State,
        observer: &mut impl Observer<Self::Event>,
    ) -> Result<Progress, Error>;

    /// The role of an event that is marked on the timeline.
    fn landmark(&self, event: &Self::Event) -> Option<Role>;

    /// Explains a step.
    fn explanation(&self, seen: &Seen<SegmentationRun<Self>>) -> Step;

    /// Draws a step.
    fn draw_step(&self, seen: &Seen<SegmentationRun<Self>>, scene: &mut Scene);
}

/// The estimator that segments each frame of a run by the method `T`.
#[derive(Clone, Debug, Default)]
pub struct SegmentationRun<T>(pub T);

inner_params!(SegmentationRun<T: Segmenter>);

impl<T: Segmenter> Estimator for SegmentationRun<T> {
    const INFO: Info = T::INFO;
    const QUESTIONS: &'static [Question] = T::QUESTIONS;
    const GUARANTEE: Guarantee = Guarantee::Segments;
    const CHARTS: &'static [Chart] = &[Chart::Plane, Chart::Series];
    const PRODUCES: &'static [&'static ProductKind] = &[SegmentField::KIND];
    type State = T::State;
    type Event = T::Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<T::State, Error> {
        let record = Record::new(clip, frame, self.0.frames())?;
        self.0.input().check(clip, frame)?;
        Ok(T::State::before(record))
    }

    fn advance(
        &self,
        clip: &Clip,
        state: &mut T::State,
        observer: &mut impl Observer<T::Event>,
    ) -> Result<Progress, Error> {
        self.0.work((clip, &Threads::single()), state, observer)
    }

    fn units(&self, _: &T::State) -> Option<usize> {
        None
    }

    fn place(&self, state: &T::State) -> Vec<Granularity> {
        state.record().place(state.round())
    }

    fn at_frame(&self, state: &T::State) -> Option<usize> {
        Some(state.record().frame())
    }

    fn landmark(&self, event: &T::Event) -> Option<Role> {
        self.0.landmark(event)
    }

    fn pointed(&self) -> Option<&dyn Pointed<T::State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.0.explanation(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.0.draw_step(seen, scene);
    }

    fn output(&self, state: &T::State) -> Output {
        state.record().output()
    }

    fn run(
        &self,
        clip: &Clip,
        frame: usize,
        threads: &Threads,
        tally: &impl Tally<T::Event>,
    ) -> Result<T::State, Error> {
        run_counted(self, (clip, frame), tally, |state, counter| self.0.work((clip, threads), state, counter))
    }
}

impl<T: Segmenter> Footprint<T::State> for SegmentationRun<T> {
    fn need(&self, clip: &Clip) -> Need {
        let Need { run, .. } = self.0.input().need(clip);
        Need::per_pixel(clip, T::BYTES_PER_PIXEL).and([run as f64; 2])
    }

    fn state_bytes(&self, state: &T::State) -> usize {
        size_of::<T::State>() + state.own_bytes() + 8 * state.record().frames.len()
    }

    fn memory_bytes(&self, state: &T::State) -> usize {
        self.state_bytes(state) + state.shared_bytes() + state.record().bytes()
    }
}

impl<T: Segmenter> Pointed<T::State> for SegmentationRun<T> {
    fn explained(&self, state: &T::State, Focus { at: point, .. }: Focus) -> Option<Explained> {
        let (width, height) = state.record().picture();
        let inside = |i: usize, extent: usize| (0.0..extent as f32).contains(&(point[i] + 0.5));
        (inside(0, width) && inside(1, height)).then_some(Explained::Always)
    }
}
