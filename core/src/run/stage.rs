//! Stages: estimators that work inside others, each chosen by what it makes, with its own parameters.

use std::any::Any;
use std::fmt;
use std::marker::PhantomData;
use std::sync::{Arc, Mutex, PoisonError};

use super::{AnyEstimator, AnyRun, Cursor, Estimator, Need, Progress};
use crate::base::{Error, Threads};
use crate::data::{Clip, Detection, Flow, Frame};
use crate::params::{Kind, Parameter, Params, Part, PartKind, Spec, StageValue, Value};
use crate::products::{DenseField, MaskField, ObjectField, Product, ProductKind};

/// An estimator before it is made.
pub struct Entry {
    /// Its id.
    pub id: &'static str,
    /// The kinds of products that it makes.
    pub produces: &'static [&'static ProductKind],
    /// Makes it, with its default parameters.
    pub make: fn() -> Box<dyn AnyEstimator>,
}

impl Entry {
    /// The entry of an estimator.
    pub const fn of<E: Estimator>() -> Self {
        Self { id: E::INFO.id, produces: E::PRODUCES, make: || Box::new(E::default()) }
    }
}

/// All estimators that stages are chosen from. Stages stand below the estimators that have them, so the list of these is
/// filled in from above.
pub struct Course;

/// A list of estimators.
pub trait Entries {
    /// All of them, in the order of the course.
    const ENTRIES: &'static [Entry];

    /// The one called `id`.
    ///
    /// # Errors
    /// A sentence with the ids there are.
    fn entry(id: &str) -> Result<&'static Entry, Error> {
        Self::ENTRIES.iter().find(|entry| entry.id == id).ok_or_else(|| {
            let ids: Vec<_> = Self::ENTRIES.iter().map(|entry| entry.id).collect();
            Error::new(format!("there is no estimator {id}; there are {}", ids.join(", ")))
        })
    }
}

/// What is asked of the estimators that can be a stage.
pub trait Makes: Clone + Copy + fmt::Debug + Send + Sync + 'static {
    /// The product that they make.
    const PRODUCT: &'static ProductKind;
    /// The same in words, with an article.
    const WORDS: &'static str;
}

/// An estimator that makes what `M` asks for, as a parameter of another.
pub struct Stage<M> {
    estimator: Box<dyn AnyEstimator>,
    makes: PhantomData<M>,
}

impl<M> Clone for Stage<M> {
    fn clone(&self) -> Self {
        Self { estimator: self.estimator.boxed_clone(), makes: PhantomData }
    }
}

impl<M> fmt::Debug for Stage<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple(self.estimator.info().id).field(&self.estimator.values()).finish()
    }
}

impl<M: Makes> Stage<M> {
    /// The estimator called `id`, with its default parameters.
    ///
    /// # Panics
    /// If there is none that makes what is asked for: ids are written in declarations.
    pub fn named(id: &str) -> Self {
        #[expect(clippy::expect_used, reason = "ids stand in declarations, and a law tries all of them")]
        let estimator = candidate::<M>(id).expect("a declared stage exists");
        Self { estimator, makes: PhantomData }
    }

    /// The same with a parameter set.
    ///
    /// # Panics
    /// If it has no such parameter or value: both are written in declarations.
    #[must_use]
    pub fn with(mut self, name: &str, value: &str) -> Self {
        #[expect(clippy::expect_used, reason = "values stand in declarations, and a law tries all of them")]
        self.estimator.set(name, value).expect("a declared stage has what is set");
        self
    }

    /// The estimator.
    pub fn estimator(&self) -> &dyn AnyEstimator {
        &*self.estimator
    }
}

/// The estimator called `id` if it makes what `M` asks for.
fn candidate<M: Makes>(id: &str) -> Result<Box<dyn AnyEstimator>, Error> {
    let entry = Course::entry(id)?;
    if makes::<M>(entry) {
        return Ok((entry.make)());
    }
    let made: Vec<_> = entry.produces.iter().map(|kind| kind.name.to_lowercase()).collect();
    let ids: Vec<_> = candidates::<M>().map(|entry| entry.id).collect();
    Err(Error::new(format!("{id} makes {}, not {}; choose {}", made.join(" or "), M::WORDS, ids.join(", "))))
}

/// Whether an estimator makes what `M` asks for above all, however it is set.
fn makes<M: Makes>(entry: &Entry) -> bool {
    entry.produces.first() == Some(&M::PRODUCT)
}

/// The estimators that make what `M` asks for, in the order of the course.
fn candidates<M: Makes>() -> impl Iterator<Item = &'static Entry> {
    Course::ENTRIES.iter().filter(|entry| makes::<M>(entry))
}

fn kind_of<M: Makes>() -> PartKind {
    PartKind {
        product: M::PRODUCT.id,
        makes: M::WORDS,
        all: || candidates::<M>().map(|entry| Box::new(Chosen((entry.make)())) as Box<dyn Part>).collect(),
        refuse: |id| candidate::<M>(id).err().unwrap_or_else(|| Error::new(format!("{id} cannot be chosen here"))),
    }
}

impl<M: Makes> Parameter for Stage<M> {
    type Range = ();

    fn kind((): ()) -> Kind {
        Kind::Stage(kind_of::<M>())
    }

    fn to_value(&self) -> Value {
        Value::Stage(StageValue::new(Box::new(Chosen(self.estimator.boxed_clone()))))
    }

    fn from_value(value: Value) -> Option<Self> {
        let Value::Stage(value) = value else { return None };
        Some(Self { estimator: estimator_of(&value)?.boxed_clone(), makes: PhantomData })
    }
}

/// The estimator that a stage's value is.
pub fn estimator_of(value: &StageValue) -> Option<&dyn AnyEstimator> {
    value.part().as_any().downcast_ref::<Chosen>().map(|chosen| &*chosen.0)
}

/// The value of a stage in which `estimator` works.
pub fn value_of(estimator: &dyn AnyEstimator) -> Value {
    Value::Stage(StageValue::new(Box::new(Chosen(estimator.boxed_clone()))))
}

/// An estimator that was chosen as a part.
struct Chosen(Box<dyn AnyEstimator>);

impl Params for Chosen {
    fn specs(&self) -> &'static [Spec] {
        self.0.specs()
    }

    fn value(&self, index: usize) -> Value {
        self.0.value(index)
    }

    fn set_value(&mut self, index: usize, value: Value) -> Result<(), Error> {
        self.0.set_value(index, value)
    }
}

impl Part for Chosen {
    fn id(&self) -> &'static str {
        self.0.info().id
    }

    fn name(&self) -> &'static str {
        self.0.info().name
    }

    fn summary(&self) -> &'static str {
        self.0.info().summary
    }

    fn clone_part(&self) -> Box<dyn Part> {
        Box::new(Self(self.0.boxed_clone()))
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}

/// Makes a dense flow.
#[derive(Clone, Copy, Debug)]
pub struct DenseFlow;

impl Makes for DenseFlow {
    const PRODUCT: &'static ProductKind = DenseField::KIND;
    const WORDS: &'static str = "a dense flow";
}

impl Stage<DenseFlow> {
    /// Where each pixel of frame `t` of a clip goes in frame `t + 1`.
    ///
    /// # Errors
    /// If there is no such pair, it cannot be read, it is not wanted any more, or the stage makes no field as it is set.
    pub fn flow(&self, clip: &Clip, t: usize, threads: &Threads) -> Result<Flow, Error> {
        let output = self.estimator.run(clip, t, threads)?;
        output.flow().filter(|_| output.motion().is_field()).ok_or_else(|| {
            let id = self.estimator.info().id;
            Error::new(format!("{id} makes no dense flow as it is set; change its parameters or choose another method"))
        })
    }

    /// Memory that the flow of a pair takes while it is worked out.
    pub fn need(&self, clip: &Clip) -> Need {
        let Need { run, .. } = self.estimator.need(clip);
        Need { run, walk: run }
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

/// Makes foreground masks, and the objects found in them.
#[derive(Clone, Copy, Debug)]
pub struct Foreground;

impl Makes for Foreground {
    const PRODUCT: &'static ProductKind = MaskField::KIND;
    const WORDS: &'static str = "foreground masks";
}

/// What a detector has found in the frames of a clip, worked out frame after frame as far as it is asked for.
///
/// It comes to the same however often and in whatever order it is asked, so copies share what was worked out.
#[derive(Clone)]
pub struct Detections(Arc<Mutex<Found>>);

struct Found {
    run: Box<dyn AnyRun>,
    first: usize,
    frames: Vec<Arc<Vec<Detection>>>,
    is_over: bool,
}

impl fmt::Debug for Detections {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Detections")
    }
}

impl Stage<Foreground> {
    /// The detections in `count` frames at most from frame `first` of a clip on.
    ///
    /// # Errors
    /// If the detector cannot run there.
    pub fn detections(&self, clip: &Clip, first: usize, count: usize) -> Result<Detections, Error> {
        let mut detector = self.estimator.boxed_clone();
        if detector.specs().iter().any(|spec| spec.name == FRAMES) {
            detector.set(FRAMES, &count.to_string())?;
        }
        let run = detector.begin(clip, first)?;
        Ok(Detections(Arc::new(Mutex::new(Found { run, first, frames: Vec::new(), is_over: false }))))
    }
}

impl Detections {
    /// What is detected in frame `t`; nothing behind the end of the run.
    ///
    /// # Errors
    /// If a frame up to there cannot be read, or the clip is not wanted any more.
    pub fn at(&self, t: usize) -> Result<Arc<Vec<Detection>>, Error> {
        let mut found = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(index) = t.checked_sub(found.first) else { return Ok(Arc::default()) };
        while found.frames.len() <= index && !found.is_over {
            found.is_over = found.run.advance()? == Progress::Done;
            let output = found.run.output();
            let known = found.frames.len();
            let new = output.get::<ObjectField>().map(|field| {
                field.frames[known..].iter().map(|frame| Arc::new(frame.detections.clone())).collect::<Vec<_>>()
            });
            found.frames.extend(new.unwrap_or_default());
        }
        Ok(found.frames.get(index).cloned().unwrap_or_default())
    }

    /// Memory that it takes, in bytes; its copies share it.
    pub fn bytes(&self) -> usize {
        let found = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        found.frames.iter().map(|frame| size_of_val(&frame[..])).sum()
    }
}

/// A stage that is opened by itself: what it runs, on which frame, and where in that run its parent stands.
pub struct Opened {
    /// The estimator that works as the stage.
    pub estimator: Box<dyn AnyEstimator>,
    /// The frame that its run begins on.
    pub frame: usize,
    /// Its place while the parent is at work.
    pub cursor: Cursor,
}

/// Opens the stage that is parameter `index` of `parent`, whose run began on frame `first` and works on frame `now`.
///
/// A stage that goes through the clip begins where its parent began, and stands at the end of the frame at hand; one that looks
/// at a pair runs on the pair at hand, from its start. `None` if that parameter is no stage.
pub fn open(parent: &dyn AnyEstimator, index: usize, (first, now): (usize, usize)) -> Option<Opened> {
    parent.specs().get(index)?;
    let Value::Stage(value) = parent.value(index) else { return None };
    let mut estimator = estimator_of(&value)?.boxed_clone();
    if !estimator.info().is_by_frame() {
        return Some(Opened { estimator, frame: now, cursor: Cursor::default() });
    }
    // It sees as many frames as its parent does.
    if let Ok(frames) = parent.get(FRAMES)
        && let Some(own) = estimator.specs().iter().position(|spec| spec.name == FRAMES)
    {
        // A parent that may see more than its stage is cut there.
        estimator.set_value(own, frames).ok();
    }
    let cursor = Cursor { unit: now.saturating_sub(first), event: usize::MAX };
    Some(Opened { estimator, frame: first, cursor })
}

/// The stages of `estimator`: the indices of its parameters that are such.
pub fn stages(estimator: &dyn AnyEstimator) -> Vec<usize> {
    let specs = estimator.specs().iter().enumerate();
    specs.filter(|(_, spec)| matches!(spec.kind, Kind::Stage(_))).map(|(index, _)| index).collect()
}

/// The parameter of all that go through a clip: how many frames at most.
const FRAMES: &str = "frames";
