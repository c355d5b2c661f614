//! What all background subtractions share: a model of what each pixel looks like when nothing moves, and from the pixels
//! that differ to blobs.

mod declare;
mod explain;
mod explanation;
mod initial;
mod rows;

use std::sync::Arc;

pub use declare::Settings;
pub(crate) use declare::subtraction_pseudocode;
pub(crate) use explain::{Account, plots};
pub(crate) use explanation::{Explanation, compared};
pub use initial::Initial;
pub(crate) use rows::{Flags, by_rows};

use crate::base::{Error, Observer, Threads};
use crate::data::{Clip, Detection, Frame, Labelling, Mask, PackedMask};
use crate::geometry::{Gray, Grid};
use crate::params::{Params, inner_params};
use crate::products::{MaskField, ObjectField, ObjectFrame, Output, Product, ProductKind, Record};
use crate::run::{
    Estimator, Explained, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen, Span, StageView, need,
};
use crate::scene::{Canvas, Chart, Focus, Picture, Scene, Step};

/// A model of the background.
pub trait Background: Params + Default + Clone + Send + Sync + 'static {
    /// What there is to say about the detector.
    const INFO: Info;
    /// What the heat shows that tells how far pixels differ, for the legend.
    const SHOWN: &'static str;
    /// What that is.
    const COMPARED: &'static str = "difference from the background";
    /// What its steps have charts for.
    const CHARTS: &'static [Chart] = &[Chart::Tiles, Chart::Series];
    /// What is known of the background.
    type Model: Clone + Send + Sync + 'static;

    /// As [`Estimator::stage_view`].
    ///
    /// # Errors
    /// If a frame cannot be read.
    fn stage_view(&self, _clip: &Clip, _now: usize) -> Result<Option<StageView>, Error> {
        Ok(None)
    }

    /// The parameters that all background subtractions have.
    fn settings(&self) -> Settings;

    /// What the model begins with.
    fn initial(&self) -> Initial {
        Initial::FirstFrame
    }

    /// Memory of a model of the frames of a clip, and of all that a frame is compared with.
    fn need(&self, clip: &Clip) -> Need;

    /// What is known after the picture that it begins with.
    fn begin(&self, first: &Arc<Frame>) -> Self::Model;

    /// Works out what is compared of a frame, where that takes long enough to be given up with the clip.
    ///
    /// # Errors
    /// If the work is cancelled.
    fn look(&self, _clip: &Clip, _model: &Self::Model, _frame: &Frame, _threads: &Threads) -> Result<(), Error> {
        Ok(())
    }

    /// Decides which pixels of a frame do not belong to the background, and takes the frame into the model. Threads
    /// change nothing of what becomes of a pixel.
    fn subtract(&self, model: &mut Self::Model, frame: &Arc<Frame>, threads: &Threads) -> Found;

    /// The gray value that is expected of a pixel.
    fn expected(&self, model: &Self::Model, place: (usize, usize)) -> f32;

    /// The gray value that a pixel of a frame is compared with, which is the expected one unless there are several.
    fn compared_with(&self, model: &Self::Model, _frame: &Frame, place: (usize, usize)) -> f32 {
        self.expected(model, place)
    }

    /// The pictures that a frame is compared with, and the frame, from left to right.
    fn pictures(&self, model: &Arc<Self::Model>, size: (usize, usize)) -> Vec<Canvas> {
        let (detector, model) = (self.clone(), Arc::clone(model));
        let expected = move || {
            let gray = |x, y| detector.expected(&model, (x, y)).round().clamp(0.0, 255.0) as u8;
            Frame::gray(Grid::from_fn(size.0, size.1, gray))
        };
        vec![Canvas::of_clip(Picture::CURRENT), Canvas::made(Picture::REFERENCE, expected)]
    }

    /// Whether a pixel of `picture`, one of those, is explained as the pixel of the frame at the same place.
    fn explains(&self, picture: Picture) -> bool {
        [Picture::CURRENT, Picture::REFERENCE].contains(&picture)
    }

    /// How far a pixel is from what is expected, as [`Background::SHOWN`] says.
    fn difference(&self, model: &Self::Model, frame: &Frame, place: (usize, usize)) -> f32;

    /// How a pixel is decided by a model, and what the model has become, once that is known.
    fn explain(&self, models: [Option<&Self::Model>; 2], frame: &Frame, place: (usize, usize)) -> Explanation;

    /// What a pixel must do to count as foreground, to follow "pixels that".
    fn rule(&self) -> String;

    /// What happens to the model at the end of a frame.
    fn update(&self) -> String;

    /// The model as a checkpoint keeps it, as small as it can be made.
    fn at_rest(&self, model: &Arc<Self::Model>) -> Arc<Self::Model> {
        Arc::clone(model)
    }

    /// Memory of a model, in bytes.
    fn model_bytes(&self, model: &Self::Model) -> usize;
}

/// The pixels that do not look like the background.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// All of them.
    pub mask: Mask,
    /// Those that are shadows, where they are looked for.
    pub shadows: Option<Mask>,
}

/// What moves before the background that `M` is a model of.
#[derive(Clone, Debug, Default)]
pub struct Subtraction<M>(pub M);

inner_params!(Subtraction<M: Background>);

/// What a run reads and writes.
#[derive(Clone)]
pub struct State<T> {
    pub(crate) span: Span,
    /// The frame that comes next.
    pub(crate) frame: usize,
    picture: (usize, usize),
    /// The background; nothing is known before the first frame.
    pub(crate) model: Option<Arc<T>>,
    /// What the frames came to.
    pub(crate) record: Record,
}

impl<T> State<T> {
    fn go_on(&mut self, clip: &Clip) -> Progress {
        self.frame += 1;
        if self.span.is_over(clip, self.frame) { Progress::Done } else { Progress::More }
    }
}

/// The stages that a frame goes through.
#[derive(Clone)]
pub enum Event {
    /// The first frame has become the model.
    Begun(Arc<Frame>),
    /// How far each pixel of the frame is from what is expected.
    Compared(Arc<Frame>, Arc<Grid<f32>>),
    /// The pixels that are too far.
    Decided(Arc<Mask>),
    /// Those that remain, and the shadows.
    Shadows(Arc<Mask>, Arc<Mask>),
    /// The mask, opened.
    Opened(Arc<Mask>),
    /// The mask, closed.
    Closed(Arc<Mask>),
    /// The connected components, and how many there are.
    Labelled(Arc<Grid<u32>>, u32),
    /// Those that are large enough, and the others.
    Kept(Arc<[Vec<Detection>; 2]>),
    /// The model has taken in the frame.
    Updated,
}

/// Memory that masks and blobs take beside what a run takes for its model. Where nothing is opened or closed, noise makes a blob
/// of nearly every pixel.
pub(crate) fn need_of_blobs(clip: &Clip, settings: Settings, model: Need) -> Need {
    let (width, height) = clip.size();
    let pixels = (width * height) as f64;
    let blobs = if settings.open == 0 && settings.close == 0 { 40.0 } else { 8.0 };
    model.and([pixels * blobs, pixels * (20.0 + 2.0 * blobs)])
}

/// From a mask to blobs, as all do it.
pub(crate) fn blobs(
    settings: Settings,
    mask: Mask,
    picture: &Gray,
    observer: &mut impl Observer<Event>,
) -> ObjectFrame {
    let mask = cleaned(settings, mask, observer);
    let labelling = Labelling::of(&mask, settings.connectivity);
    let finals = labelling.finals();
    observer.see(|| Event::Labelled(Arc::new(finals.grid(&labelling, mask.size())), finals.count));
    let [kept, dropped] = sifted(settings, finals.detections(&labelling, picture));
    observer.see(|| Event::Kept(Arc::new([kept.clone(), dropped])));
    ObjectFrame { mask: Some(PackedMask::new(&mask)), detections: kept, objects: Vec::new() }
}

/// The mask opened and closed.
pub(crate) fn cleaned(settings: Settings, mut mask: Mask, observer: &mut impl Observer<Event>) -> Mask {
    if settings.open > 0 {
        mask = mask.opened(settings.open);
        observer.see(|| Event::Opened(Arc::new(mask.clone())));
    }
    if settings.close > 0 {
        mask = mask.closed(settings.close);
        observer.see(|| Event::Closed(Arc::new(mask.clone())));
    }
    mask
}

/// The blobs that are large enough, and the others.
pub(crate) fn sifted(settings: Settings, all: Vec<Detection>) -> [Vec<Detection>; 2] {
    let is_large = |found: &Detection| found.blob.is_none_or(|blob| blob.area_px as usize >= settings.min_area);
    let (kept, dropped) = all.into_iter().partition(is_large);
    [kept, dropped]
}

impl<M: Background> Subtraction<M> {
    /// The picture that is worked on next: at the start of a run, what the model begins with.
    fn next_frame(&self, clip: &Clip, state: &State<M::Model>) -> Result<Arc<Frame>, Error> {
        match state.model {
            None => initial::picture(self.0.initial(), clip, &state.span),
            Some(_) => clip.frame(state.frame),
        }
    }

    /// Works on the frame that comes next.
    fn work(
        &self,
        clip: &Clip,
        state: &mut State<M::Model>,
        threads: &Threads,
        observer: &mut impl Observer<Event>,
    ) -> Result<Progress, Error> {
        clip.wanted()?;
        need::check_kept(clip, state.record.bytes())?;
        let frame = self.next_frame(clip, state)?;
        let Some(model) = &mut state.model else {
            state.model = Some(Arc::new(self.0.begin(&frame)));
            observer.see(|| Event::Begun(frame));
            let (width, height) = state.picture;
            let mask = Some(PackedMask::new(&Mask::new(width, height)));
            state.record.note(ObjectFrame { mask, ..ObjectFrame::default() });
            return Ok(state.go_on(clip));
        };
        self.0.look(clip, model, &frame, threads)?;
        observer.see(|| {
            let (width, height) = frame.size();
            let difference = Grid::from_fn(width, height, |x, y| self.0.difference(model, &frame, (x, y)));
            Event::Compared(Arc::clone(&frame), Arc::new(difference))
        });
        let Found { mut mask, shadows } = self.0.subtract(Arc::make_mut(model), &frame, threads);
        observer.see(|| Event::Decided(Arc::new(mask.clone())));
        if let Some(shadows) = shadows {
            mask = mask.without(&shadows);
            observer.see(|| Event::Shadows(Arc::new(mask.clone()), Arc::new(shadows)));
        }
        let found = blobs(self.0.settings(), mask, frame.luma(), observer);
        observer.see(|| Event::Updated);
        state.record.note(found);
        Ok(state.go_on(clip))
    }
}

impl<M: Background> Estimator for Subtraction<M> {
    const INFO: Info = M::INFO;
    const GUARANTEE: Guarantee = Guarantee::Objects;
    const CHARTS: &'static [Chart] = M::CHARTS;
    const PRODUCES: &'static [&'static ProductKind] = &[MaskField::KIND, ObjectField::KIND];
    type State = State<M::Model>;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<Self::State, Error> {
        let span = Span::new(clip, frame, self.0.settings().frames)?;
        Ok(State { span, frame, picture: clip.size(), model: None, record: Record::default() })
    }

    fn advance(
        &self,
        clip: &Clip,
        state: &mut Self::State,
        observer: &mut impl Observer<Event>,
    ) -> Result<Progress, Error> {
        self.work(clip, state, &Threads::single(), observer)
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

    fn stage_view(&self, clip: &Clip, now: usize) -> Result<Option<StageView>, Error> {
        self.0.stage_view(clip, now)
    }

    fn at_frame(&self, state: &Self::State) -> Option<usize> {
        Some(state.frame)
    }

    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.told(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.drawn(seen, scene);
    }

    fn output(&self, state: &Self::State) -> Output {
        state.record.output(state.picture, state.span.first)
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<Self::State, Error> {
        let mut state = self.start(clip, frame)?;
        while self.work(clip, &mut state, threads, &mut ())? == Progress::More {}
        Ok(state)
    }
}

impl<M: Background> Footprint<State<M::Model>> for Subtraction<M> {
    fn need(&self, clip: &Clip) -> Need {
        let model = self.0.need(clip);
        // Walked through, the model before a frame, after it, kept and on its way, and the pictures that are told.
        let walked = Need { walk: 4 * model.walk, ..model };
        need_of_blobs(clip, self.0.settings(), walked)
    }

    fn at_rest(&self, state: &State<M::Model>) -> State<M::Model> {
        State { model: state.model.as_ref().map(|model| self.0.at_rest(model)), ..state.clone() }
    }

    fn state_bytes(&self, state: &State<M::Model>) -> usize {
        let model = state.model.as_ref().map_or(0, |model| self.0.model_bytes(model));
        size_of::<State<M::Model>>() + model + state.record.own_bytes()
    }

    fn memory_bytes(&self, state: &State<M::Model>) -> usize {
        self.state_bytes(state) + state.record.shared_bytes()
    }
}

impl<M: Background> Pointed<State<M::Model>> for Subtraction<M> {
    fn takes(&self, picture: Picture) -> bool {
        self.0.explains(picture)
    }

    fn explained(&self, state: &State<M::Model>, Focus { at: point, .. }: Focus) -> Option<Explained> {
        let [x, y] = point.map(|c| c + 0.5);
        let (width, height) = state.picture;
        ((0.0..width as f32).contains(&x) && (0.0..height as f32).contains(&y)).then_some(Explained::Always)
    }
}
