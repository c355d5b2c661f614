//! Background subtraction: a background model, a foreground mask, its clean-up by opening and closing, and blobs.
//!
//! [`Subtraction`] turns any [`Background`] into an estimator: initialisation, classification, update and explanation. A unit
//! is a frame; its events are difference, decision, opening, closing, labelling and update. The initial model is the first
//! frame or the median of frames from the whole run (`Initial`). Models with a background for each channel share the loop over
//! pixels (`channels.rs`). `flow-magnitude` uses the previous frame as its model and a stage for the flow.
//! `Background::accepted` gives the gray levels that are background at a pixel in the present frame; `history.rs` plots the
//! levels of the last frames beside them.

mod camera;
mod channels;
mod channelwise;
mod charts;
mod conclusion;
mod declare;
mod explain;
mod explanation;
mod exposure;
mod history;
mod initial;
mod marks;
mod mask_history;
mod noise;
mod rows;
mod shadow;
mod vocabulary;

use std::sync::Arc;

pub use camera::{CameraMotion, Steadiness};
pub(crate) use camera::{displaced, resampled, shifted};
pub use channels::Channels;
pub(crate) use channels::{Channel, Row, largest, levels, luma};
pub(crate) use channelwise::{ChannelModel, Channelwise, Common, Planes, SHADOW_SHARE, classify};
pub(crate) use charts::plots;
use declare::QUESTIONS;
pub use declare::Settings;
pub(crate) use declare::subtraction_pseudocode;
pub(crate) use explain::put_blobs;
pub(crate) use explanation::{
    Cases, Comparison, Explanation, IN_CHANNEL, Probe, class, difference_rule, put_pixel, tuple,
};
pub use exposure::Exposure;
pub(crate) use history::Accepted;
pub use initial::Initial;
pub(crate) use mask_history::MaskHistory;
pub use noise::{Differencing, automatic_threshold, noise_of};
pub(crate) use rows::{Flags, by_rows};
pub use shadow::ShadowDetection;
use shadow::enclosed;
pub(crate) use shadow::{ShadowLimits, is_shadow, shadow_brightness};
pub(crate) use vocabulary::{case, value};

use camera::Camera;
use exposure::Transfer;

use crate::base::{Error, Observer, Tally, Threads};
use crate::data::{Clip, Detection, Frame, Labelling, Mask, MaskErrors, ObjectBox, PackedMask, area_opened};
use crate::geometry::{Bounds, Gray, Grid};
use crate::params::{Params, inner_params};
use crate::products::{
    MaskField, ObjectField, ObjectFrame, Output, Product, ProductKind, Record,
    objects::score::{Boxes, Matches},
};
use crate::run::{
    Estimator, Explained, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen, Span, StageView,
    need, run_counted,
};
use crate::scene::{Canvas, Case, Chart, Focus, Layer, Name, Picture, Question, Scene, Step};

/// A model of the background.
pub trait Background: Params + Default + Clone + Send + Sync + 'static {
    /// The description of the detector.
    const INFO: Info;
    /// The formula of the difference that the heat map shows, for its scale.
    const SHOWN: &'static str;
    /// The name of that difference, for the legend.
    const COMPARED: &'static str = "difference from the background";
    /// The charts of its steps.
    const CHARTS: &'static [Chart] = &[Chart::Tiles, Chart::Series];
    /// Whether each frame replaces the model.
    const IS_REPLACED: bool = false;
    /// Whether the model is registered to each frame by a motion of the camera.
    const IS_REGISTERED: bool = false;
    /// The cause of a foreground that covers much of the frame, and what to do about it.
    const FLOODED: [&'static Case; 2] = [case::CAMERA_OR_LIGHT, case::USE_MOTION];
    /// The background model.
    type Model: Clone + Send + Sync + 'static;

    /// As [`Estimator::stage_view`].
    ///
    /// # Errors
    /// If a frame cannot be read.
    fn stage_view(&self, _clip: &Clip, _now: usize) -> Result<Option<StageView>, Error> {
        Ok(None)
    }

    /// As [`Estimator::earlier_frames`].
    fn earlier_frames(&self) -> Option<usize> {
        None
    }

    /// The parameters that background subtractions share.
    fn setup(&self) -> Setup;

    /// Returns the model displaced by `by` px, whole ones unless each frame replaces it; uncovered pixels are initialised with the frame.
    fn moved(&self, model: &Self::Model, _by: [f32; 2], _frame: &Arc<Frame>) -> Self::Model {
        model.clone()
    }

    /// Returns the foreground pixels that the background of another pixel within the radius of the shake suppression explains.
    fn displaced(&self, _model: &Self::Model, _frame: &Frame, _mask: &Mask) -> Option<Mask> {
        None
    }

    /// Memory of a model and of everything that a frame of the clip is compared with.
    fn need(&self, clip: &Clip) -> Need;

    /// Initialises the model with a picture.
    fn begin(&self, first: &Arc<Frame>) -> Self::Model;

    /// Prepares the comparison of a frame where that takes long enough to be cancelled with the clip.
    ///
    /// # Errors
    /// If the work is cancelled.
    fn look(&self, _clip: &Clip, _model: &Self::Model, _frame: &Frame, _threads: &Threads) -> Result<(), Error> {
        Ok(())
    }

    /// Classifies the pixels of a frame and updates the model with it. The result does not depend on the threads.
    fn subtract(&self, model: &mut Self::Model, frame: &Arc<Frame>, threads: &Threads) -> Found;

    /// The gray level of the background at a pixel.
    fn expected(&self, model: &Self::Model, place: (usize, usize)) -> f32;

    /// The gray level of the background that a pixel is compared with, if there are several.
    fn compared_with(&self, model: &Self::Model, _frame: &Frame, place: (usize, usize)) -> f32 {
        self.expected(model, place)
    }

    /// The color of the background at a pixel, if the model has one for each channel.
    fn expected_color(&self, _model: &Self::Model, _place: (usize, usize)) -> Option<[u8; 3]> {
        None
    }

    /// The channel that decides about a pixel.
    fn channel(&self, _model: &Self::Model, _frame: &Frame, _place: (usize, usize)) -> Channel {
        Channel::Gray
    }

    /// As [`Background::compared_with`], in a channel.
    fn compared_in(&self, model: &Self::Model, frame: &Frame, place: (usize, usize), _channel: Channel) -> f32 {
        self.compared_with(model, frame, place)
    }

    /// The frame and the pictures that it is compared with, from left to right.
    fn pictures(&self, model: &Arc<Self::Model>, size: (usize, usize)) -> Vec<Canvas> {
        let (detector, model) = (self.clone(), Arc::clone(model));
        let expected = move || {
            if detector.expected_color(&model, (0, 0)).is_some() {
                let color = |x, y| detector.expected_color(&model, (x, y)).unwrap_or_default();
                return Frame::rgb(Grid::from_fn(size.0, size.1, color));
            }
            let gray = |x, y| detector.expected(&model, (x, y)).round().clamp(0.0, 255.0) as u8;
            Frame::gray(Grid::from_fn(size.0, size.1, gray))
        };
        vec![Canvas::of_clip(Picture::CURRENT), Canvas::made(Picture::REFERENCE, expected)]
    }

    /// The levels of a channel that the model takes for background at a pixel: one range for each background mode.
    fn accepted(&self, _model: &Self::Model, _place: (usize, usize), _channel: Channel) -> Vec<Accepted> {
        Vec::new()
    }

    /// The quantities of the model at every pixel.
    fn layers(&self, _model: &Arc<Self::Model>, _past: &Past) -> Vec<Layer> {
        Vec::new()
    }

    /// Whether pixels of `picture` are explained as the pixels of the frame at the same position.
    fn explains(&self, picture: Picture) -> bool {
        [Picture::CURRENT, Picture::REFERENCE].contains(&picture)
    }

    /// The difference of a pixel from the background, as in [`Background::SHOWN`].
    fn difference(&self, model: &Self::Model, frame: &Frame, place: (usize, usize)) -> f32;

    /// Explains the class of a pixel by the model before the frame, and the update by the model after it.
    fn explain(&self, step: Step, probe: &Probe<Self::Model>) -> Explanation;

    /// Puts the registration of the model to a frame; returns with it the cases that tell it.
    fn comparison(&self, step: Step, _model: &Self::Model, _frame: &Frame) -> (Step, Cases) {
        (step, Vec::new())
    }

    /// Puts the criterion of foreground pixels; returns with it the cases that tell it.
    fn rule(&self, step: Step) -> (Step, Cases);

    /// The model as a checkpoint stores it, as small as possible.
    fn at_rest(&self, model: &Arc<Self::Model>) -> Arc<Self::Model> {
        Arc::clone(model)
    }

    /// Memory of a model, in bytes.
    fn model_bytes(&self, model: &Self::Model) -> usize;
}

/// The parameters that background subtractions share.
#[derive(Clone, Copy)]
pub struct Setup {
    /// The parameters of every background subtraction.
    pub settings: Settings,
    /// The initialisation of a model that has more memory than the previous frames.
    pub initial: Option<Initial>,
    /// The treatment of a camera that is not quite at rest, for models that are compared pixel by pixel.
    pub steady: Option<Steadiness>,
}

/// The frames that a model has seen.
#[derive(Clone, Debug)]
pub struct Past {
    clip: Clip,
    span: Span,
    steady: Option<Steadiness>,
    /// The displacement of the model with the camera in px.
    at: [f32; 2],
}

impl Past {
    /// The median gray levels of `samples` of these frames, spaced evenly, displaced with the camera as the model is; NaN for what
    /// the first frame does not show.
    ///
    /// # Errors
    /// If a frame cannot be read.
    pub fn median(&self, samples: usize) -> Result<Grid<f32>, Error> {
        let median = initial::median_of((&self.clip, samples), &self.span, self.steady)?;
        let (width, height) = median.size();
        let level = displaced_by(self.at, (width, height), |at| f32::from(median.luma()[at]));
        Ok(Grid::from_fn(width, height, |x, y| level(x, y).unwrap_or(f32::NAN)))
    }
}

/// The foreground of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The foreground pixels, shadows included.
    pub mask: Mask,
    /// The pixels of the colour of a shadow, where shadows are detected.
    pub shadows: Option<Mask>,
}

/// The detector of moving objects by the background model `M`.
#[derive(Clone, Debug, Default)]
pub struct Subtraction<M>(pub M);

inner_params!(Subtraction<M: Background>);

/// The state of a run.
#[derive(Clone)]
pub struct State<T> {
    pub(crate) span: Span,
    /// The next frame.
    pub(crate) frame: usize,
    picture: (usize, usize),
    /// The background model, from the first frame on.
    pub(crate) model: Option<Arc<T>>,
    /// The camera, if the model follows it.
    pub(crate) camera: Option<Camera>,
    /// The results of the frames so far.
    pub(crate) record: Record,
}

impl<T> State<T> {
    /// Counts the frame and returns whether more follow.
    fn go_on(&mut self, clip: &Clip) -> Progress {
        self.frame += 1;
        if self.span.is_over(clip, self.frame) { Progress::Done } else { Progress::More }
    }
}

/// The processing stages of a frame.
#[derive(Clone)]
pub enum Event {
    /// The model is initialised with this picture.
    Begun(Arc<Frame>),
    /// The model is shifted by this many px; the displacement of the camera since the first frame.
    Followed([f32; 2], [f32; 2]),
    /// The frame as it was before its exposure was corrected, and the transfer from the background to it.
    Exposed(Arc<Frame>, Arc<Transfer>),
    /// The frame, to which the model was registered by a motion.
    Registered(Arc<Frame>),
    /// The frame and the difference of each pixel from the background.
    Compared(Arc<Frame>, Arc<Grid<f32>>),
    /// The foreground mask by the threshold.
    Decided(Arc<Mask>),
    /// The mask without shadows, and the shadows.
    Shadows(Arc<Mask>, Arc<Mask>),
    /// The mask without displaced background, and that.
    Steadied(Arc<Mask>, Arc<Mask>),
    /// The mask after opening.
    Opened(Arc<Mask>),
    /// The mask after closing.
    Closed(Arc<Mask>),
    /// The connected components and their number.
    Labelled(Arc<Grid<u32>>, u32),
    /// The components of at least the minimum area, and the others.
    Kept(Arc<[Vec<Detection>; 2]>),
    /// The model is updated: the conclusion of the frame.
    Updated(Arc<Conclusion>),
}

/// The result of a frame, and its score where there is ground truth.
#[derive(Clone, Debug, Default)]
pub struct Conclusion {
    /// Pixels of its mask.
    pub(crate) foreground: usize,
    /// The share of the picture that differs from the background, without shadows.
    pub(crate) differing: f64,
    /// The displacement of the camera since the first frame in px, where it is followed.
    pub(crate) camera: Option<[f32; 2]>,
    /// The matches of the blobs with the true boxes.
    pub(crate) frame: Option<Matches>,
    /// The mask compared with the true foreground, pixel by pixel.
    pub(crate) errors: Option<MaskErrors>,
    /// The pixels of all masks compared with the truth, at the end of the run.
    pub(crate) run_pixels: Option<Matches>,
    /// Unmatched blobs where an object stood in the first frame and none is now.
    pub(crate) ghosts: usize,
    /// The matches of all frames, at the end of the run.
    pub(crate) run: Option<Matches>,
}

/// Memory of masks and blobs in addition to that of the model. Without opening and closing, noise can make a blob of nearly
/// every pixel.
pub(crate) fn need_of_blobs(clip: &Clip, settings: Settings, model: Need) -> Need {
    let (width, height) = clip.size();
    let pixels = (width * height) as f64;
    let blobs = if !settings.is_opened() && settings.closing == 0 { 40.0 } else { 8.0 };
    model.and([pixels * blobs, pixels * (20.0 + 2.0 * blobs)])
}

/// Extracts blobs from a mask: opening, closing, connected components, minimum area.
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
    let [kept, dropped] = sifted(settings, picture.size(), finals.detections(&labelling, picture));
    observer.see(|| Event::Kept(Arc::new([kept.clone(), dropped])));
    ObjectFrame { mask: Some(PackedMask::new(&mask)), detections: kept, objects: Vec::new() }
}

/// Applies the openings and the closing to a mask.
pub(crate) fn cleaned(settings: Settings, mut mask: Mask, observer: &mut impl Observer<Event>) -> Mask {
    if settings.is_opened() {
        mask = if settings.opening > 0 { mask.opened(settings.opening) } else { mask };
        if settings.area_opening > 1 {
            mask = area_opened(mask, settings.connectivity, settings.area_opening);
        }
        observer.see(|| Event::Opened(Arc::new(mask.clone())));
    }
    if settings.closing > 0 {
        mask = mask.closed(settings.closing);
        observer.see(|| Event::Closed(Arc::new(mask.clone())));
    }
    mask
}

/// Splits components into those of at least the minimum area and the others.
pub(crate) fn sifted(settings: Settings, picture: (usize, usize), all: Vec<Detection>) -> [Vec<Detection>; 2] {
    let least = settings.least_area(picture);
    let is_large = |found: &Detection| found.blob.is_none_or(|blob| blob.area_px as usize >= least);
    let (kept, dropped) = all.into_iter().partition(is_large);
    [kept, dropped]
}

/// The level that `of` gives for pixels of a picture that is displaced by `by` px; `None` for uncovered pixels.
fn displaced_by(
    by: [f32; 2],
    (width, height): (usize, usize),
    of: impl Fn((usize, usize)) -> f32,
) -> impl Fn(usize, usize) -> Option<f32> {
    let by = by.map(|c| c.round() as isize);
    move |x, y| {
        let at = (x.checked_add_signed(-by[0])?, y.checked_add_signed(-by[1])?);
        (at.0 < width && at.1 < height).then(|| of(at))
    }
}

impl<M: Background> Subtraction<M> {
    /// Returns the next frame; at the start of a run the picture that initialises the model.
    fn next_frame(&self, clip: &Clip, state: &State<M::Model>) -> Result<Arc<Frame>, Error> {
        match state.model {
            None => initial::picture(self.0.setup(), clip, &state.span),
            Some(_) => clip.frame(state.frame),
        }
    }

    fn is_followed(&self) -> bool {
        self.0.setup().steady.is_some_and(|steady| steady.camera == CameraMotion::Followed)
    }

    /// Begins to follow the camera, if that is asked for.
    fn camera(&self, clip: &Clip, state: &State<M::Model>) -> Result<Option<Camera>, Error> {
        self.is_followed().then(|| Ok(Camera::new(&*clip.frame(state.span.first)?))).transpose()
    }

    /// Shifts the model with the camera; returns the frame with the exposure of the model.
    fn follow(
        &self,
        state: &mut State<M::Model>,
        frame: Arc<Frame>,
        observer: &mut impl Observer<Event>,
    ) -> Arc<Frame> {
        let Some(model) = &mut state.model else { return frame };
        let by = state.camera.as_mut().map_or([0.0; 2], |camera| camera.follow(&frame, M::IS_REPLACED));
        let transfer = self.transfer(model, by, &frame);
        let exposed =
            transfer.as_ref().map_or_else(|| Arc::clone(&frame), |transfer| Arc::new(transfer.undone(&frame)));
        if by != [0.0; 2] {
            *model = Arc::new(self.0.moved(model, by, &exposed));
            let at = state.camera.as_ref().map_or(by, |camera| camera.at);
            observer.see(|| Event::Followed(by, at));
        }
        if let Some(transfer) = transfer {
            observer.see(|| Event::Exposed(frame, Arc::new(transfer)));
        }
        exposed
    }

    /// The change of the exposure from the model, which will be shifted by `by` px, to a frame.
    fn transfer(&self, model: &M::Model, by: [f32; 2], frame: &Frame) -> Option<Transfer> {
        let steady = self.0.setup().steady.filter(|steady| steady.exposure == Exposure::Compensated);
        steady.and_then(|_| {
            Transfer::between(frame.luma(), displaced_by(by, frame.size(), |at| self.0.expected(model, at)))
        })
    }

    /// Processes the next frame.
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
        let frame = self.follow(state, frame, observer);
        let Some(model) = &mut state.model else {
            state.model = Some(Arc::new(self.0.begin(&frame)));
            state.camera = self.camera(clip, state)?;
            observer.see(|| Event::Begun(frame));
            let (width, height) = state.picture;
            let mask = Some(PackedMask::new(&Mask::new(width, height)));
            state.record.note(ObjectFrame { mask, ..ObjectFrame::default() });
            return Ok(state.go_on(clip));
        };
        self.0.look(clip, model, &frame, threads)?;
        if M::IS_REGISTERED {
            observer.see(|| Event::Registered(Arc::clone(&frame)));
        }
        observer.see(|| {
            let (width, height) = frame.size();
            let difference = Grid::from_fn(width, height, |x, y| self.0.difference(model, &frame, (x, y)));
            Event::Compared(Arc::clone(&frame), Arc::new(difference))
        });
        // Shake is judged by the model with which the frame was compared, not by its update.
        let before =
            (M::IS_REPLACED || self.0.setup().steady.is_some_and(|steady| steady.shake > 0)).then(|| Arc::clone(model));
        let Found { mut mask, shadows } = self.0.subtract(Arc::make_mut(model), &frame, threads);
        observer.see(|| Event::Decided(Arc::new(mask.clone())));
        if let Some(shadows) = shadows {
            let shadows = shadows.without(&enclosed(&mask.without(&shadows), &shadows));
            mask = mask.without(&shadows);
            observer.see(|| Event::Shadows(Arc::new(mask.clone()), Arc::new(shadows)));
        }
        let differing = mask.count();
        if let Some(displaced) = self.0.displaced(before.as_ref().unwrap_or(model), &frame, &mask) {
            mask = mask.without(&displaced);
            observer.see(|| Event::Steadied(Arc::new(mask.clone()), Arc::new(displaced)));
        }
        let mut found = blobs(self.0.setup().settings, mask, frame.luma(), observer);
        if let Some(Camera { at, .. }) = state.camera {
            found
                .detections
                .iter_mut()
                .filter_map(|found| found.blob.as_mut())
                .for_each(|blob| blob.background_px = at);
        }
        observer.see(|| Event::Updated(Arc::new(self.conclusion(clip, state, &found, differing))));
        state.record.note(found);
        Ok(state.go_on(clip))
    }
}

impl<M: Background> Subtraction<M> {
    /// Scores the blobs of a frame, and those of all frames at the end of the run.
    fn conclusion(&self, clip: &Clip, state: &State<M::Model>, found: &ObjectFrame, differing: usize) -> Conclusion {
        let (t, first) = (state.frame, state.span.first);
        let truth = |t: usize| clip.truth().and_then(|truth| truth.objects(t).ok().flatten());
        let matched = |t: usize, frame: &ObjectFrame| Some(Matches::of(&(boxes(&truth(t)?), detected(frame))));
        let is_last = state.span.is_over(clip, t + 1);
        let run = is_last.then(|| {
            // The first frame initialises the model, so nothing is detected in it.
            let earlier = state.record.frames().iter().enumerate().skip(1);
            let all = earlier.map(|(i, frame)| matched(first + i, frame)).chain([matched(t, found)]);
            all.reduce(|a, b| Some(a?.and(b?))).flatten()
        });
        let true_mask = |t: usize| clip.truth().and_then(|truth| truth.foreground(t).ok().flatten());
        let compared = |t: usize, frame: &ObjectFrame| true_mask(t)?.compare(frame.mask.as_ref()?).ok();
        let errors = compared(t, found);
        let run_pixels = errors.as_ref().filter(|_| is_last).map(|last| {
            let earlier = state.record.frames().iter().enumerate().skip(1);
            let all = earlier.filter_map(|(i, frame)| compared(first + i, frame).as_ref().map(Matches::of_pixels));
            all.fold(Matches::of_pixels(last), Matches::and)
        });
        // Only a model with memory keeps ghosts of its first frame.
        let is_ghostly = self.0.setup().initial == Some(Initial::FirstFrame);
        let ghosts = truth(first).zip(truth(t)).filter(|_| is_ghostly).map(<[_; 2]>::from);
        Conclusion {
            foreground: found.mask.as_ref().map_or(0, PackedMask::count),
            differing: differing as f64 / (state.picture.0 * state.picture.1).max(1) as f64,
            camera: state.camera.as_ref().map(|camera| camera.at),
            frame: matched(t, found),
            errors,
            run_pixels,
            ghosts: ghosts.map_or(0, |[then, now]| ghosts_of(found, [&boxes(&then), &boxes(&now)])),
            run: run.flatten(),
        }
    }
}

fn boxes(objects: &[ObjectBox]) -> Boxes {
    objects.iter().map(|object| (object.id, Bounds::from(object))).collect()
}

fn detected(frame: &ObjectFrame) -> Boxes {
    (0..).zip(&frame.detections).map(|(i, found)| (i, found.bounds)).collect()
}

/// The number of blobs on the position of an object of the first frame where there is none now.
fn ghosts_of(found: &ObjectFrame, [then, now]: [&Boxes; 2]) -> usize {
    let is_on = |blob: &Bounds, all: &Boxes, least: f32| all.iter().any(|(_, bounds)| blob.shared(bounds) > least);
    found.detections.iter().filter(|blob| is_on(&blob.bounds, then, 0.5) && !is_on(&blob.bounds, now, 0.0)).count()
}

impl<M: Background> Estimator for Subtraction<M> {
    const INFO: Info = M::INFO;
    const QUESTIONS: &'static [Question] = QUESTIONS;
    const GUARANTEE: Guarantee = Guarantee::Objects;
    const CHARTS: &'static [Chart] = M::CHARTS;
    const PRODUCES: &'static [&'static ProductKind] = &[MaskField::KIND, ObjectField::KIND];
    type State = State<M::Model>;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<Self::State, Error> {
        let span = Span::new(clip, frame, self.0.setup().settings.frames)?;
        Ok(State { span, frame, picture: clip.size(), model: None, camera: None, record: Record::default() })
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

    fn earlier_frames(&self) -> Option<usize> {
        self.0.earlier_frames()
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

    fn stage(&self, event: &Event) -> Option<Name> {
        Some(explain::stage(event))
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.draw_step(seen, scene);
    }

    fn output(&self, state: &Self::State) -> Output {
        state.record.output(state.picture, state.span.first)
    }

    fn run(
        &self,
        clip: &Clip,
        frame: usize,
        threads: &Threads,
        tally: &impl Tally<Event>,
    ) -> Result<Self::State, Error> {
        run_counted(self, (clip, frame), tally, |state, counter| self.work(clip, state, threads, counter))
    }
}

impl<M: Background> Footprint<State<M::Model>> for Subtraction<M> {
    fn need(&self, clip: &Clip) -> Need {
        let model = self.0.need(clip);
        // A walk holds the model before a frame, after it, in a checkpoint and in work, and the pictures shown.
        let walked = Need { walk: 4 * model.walk, ..model };
        // The suppression of shake looks at a copy from before the update.
        let is_copied = self.0.setup().steady.is_some_and(|steady| steady.shake > 0);
        let walked = if is_copied { walked.and([model.run as f64, model.walk as f64]) } else { walked };
        need_of_blobs(clip, self.0.setup().settings, walked)
    }

    fn at_rest(&self, state: &State<M::Model>) -> State<M::Model> {
        State { model: state.model.as_ref().map(|model| self.0.at_rest(model)), ..state.clone() }
    }

    fn state_bytes(&self, state: &State<M::Model>) -> usize {
        let model = state.model.as_ref().map_or(0, |model| self.0.model_bytes(model));
        let camera = state.camera.as_ref().map_or(0, Camera::bytes);
        size_of::<State<M::Model>>() + model + camera + state.record.own_bytes()
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
