//! A mosaic of a panning shot: all frames, registered in the coordinates of the middle one.

mod explain;

use std::sync::Arc;

use crate::base::{Error, Observer, Threads};
use crate::data::{Clip, Frame};
use crate::methods::camera_path::{Blending, Canvas, Chain, DIRECTION, Link, MOST_FRAMES, path_pseudocode};
use crate::params;
use crate::products::model::{Matrix3, inverse, normalised, product};
use crate::products::{Output, PathField, Product, ProductKind, Views};
use crate::run::{
    Estimator, Footprint, GlobalModel, Granularity, Guarantee, Info, Need, Progress, Seen, Stage, StageView,
};
use crate::scene::{Chart, Question, Scene, Step};

params! {
    /// A mosaic of the frames of a panning shot.
    pub struct Mosaic {
        /// Number of frames, including the first; fewer at the end of the clip.
        frames: usize = 100, 2..=10_000;
        /// Method of the motion of a pair of frames.
        motion: Stage<GlobalModel> = Stage::named("global-motion").with("detector.double", "off");
        /// Blending of frames that overlap.
        blending: Blending = Blending::Mean;
    }
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    chain: Chain,
    /// The canvas, once all motions are known, and the number of frames on it.
    canvas: Option<Arc<Canvas>>,
    placed: usize,
    /// The mosaic at the end of the run.
    done: Option<Arc<Frame>>,
}

impl State {
    /// Index of the frame in whose coordinates the mosaic is.
    fn reference(&self) -> usize {
        (self.chain.to_frames.len() - 1) / 2
    }

    /// The map from frame `i` of the run to the reference frame; `None` if it has no inverse.
    fn to_reference(&self, i: usize) -> Option<Matrix3> {
        let reference = &self.chain.to_frames[self.reference()];
        let back = inverse(&self.chain.to_frames[i])?;
        normalised(&product(reference, &back)).filter(|map| inverse(map).is_some())
    }
}

/// A frame on the canvas.
#[derive(Clone)]
pub struct Placed {
    /// The map to the reference frame, if it has one.
    map: Option<Matrix3>,
    /// The canvas with the frame.
    canvas: Arc<Canvas>,
}

/// An event of a unit: a pair of frames, the canvas, or a frame on it.
#[derive(Clone)]
pub enum Event {
    /// The motion of the pair.
    Estimated(Arc<Link>),
    /// The path up to the second frame.
    Chained(Arc<Link>),
    /// The canvas that holds all frames.
    Bounded(Arc<Canvas>),
    /// The place of a frame.
    Found(Arc<Placed>),
    /// The frame is blended into the canvas.
    Blended(Arc<Placed>),
}

impl Mosaic {
    /// Blends the next frame into the canvas.
    fn blend(
        &self,
        clip: &Clip,
        (state, mut canvas): (&mut State, Arc<Canvas>),
        observer: &mut impl Observer<Event>,
    ) -> Result<Progress, Error> {
        clip.wanted()?;
        let frame = clip.frame(state.chain.span.first + state.placed)?;
        let map = state.to_reference(state.placed);
        if let Some(map) = &map {
            Arc::make_mut(&mut canvas).add(&frame, map, self.blending);
        }
        let placed = Arc::new(Placed { map, canvas: Arc::clone(&canvas) });
        observer.see(|| Event::Found(Arc::clone(&placed)));
        observer.see(|| Event::Blended(placed));
        state.placed += 1;
        let is_over = state.placed == state.chain.to_frames.len();
        state.done = is_over.then(|| Arc::new(canvas.picture()));
        state.canvas = Some(canvas);
        Ok(if is_over { Progress::Done } else { Progress::More })
    }
}

path_pseudocode! {
    BOUND: "c ← the frame in the middle; the canvas holds all frames in its coordinates",
    EACH_FRAME: "for each frame t",
    PLACE: "  A ← P(c) P(t)⁻¹, the map from frame t to the canvas",
    BLEND: "  blend frame t, warped by A, into the mosaic",
}

impl Estimator for Mosaic {
    const INFO: Info = Info {
        id: "mosaic",
        name: "Mosaic",
        family: "Correspondence",
        summary: "One picture of a panning shot: all frames are registered by the chained motions of the background, and blended.",
        source: "R. Szeliski, Video mosaics for virtual environments, IEEE Computer Graphics and Applications 16(2), 1996; R. Szeliski, \
                 Image alignment and stitching, Foundations and Trends in Computer Graphics and Vision 2(1), 2006",
        pseudocode: line::ALL,
        granularities: &["clip", "pass", "frame", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[DIRECTION];
    const GUARANTEE: Guarantee = Guarantee::Better;
    const CHARTS: &'static [Chart] = &[Chart::Series, Chart::Matrices];
    const PRODUCES: &'static [&'static ProductKind] = &[PathField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        Ok(State { chain: Chain::new(clip, frame, self.frames)?, canvas: None, placed: 0, done: None })
    }

    fn advance(&self, clip: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        if !state.chain.is_complete {
            let link = Arc::new(state.chain.advance(&self.motion, clip, &Threads::single())?);
            observer.see(|| Event::Estimated(Arc::clone(&link)));
            observer.see(|| Event::Chained(link));
            return Ok(Progress::More);
        }
        let canvas = match state.canvas.take() {
            Some(canvas) => canvas,
            None => {
                let maps: Vec<_> = (0..state.chain.to_frames.len()).map(|i| state.to_reference(i)).collect();
                let canvas = Arc::new(Canvas::of(&maps, state.reference(), state.chain.picture));
                observer.see(|| Event::Bounded(Arc::clone(&canvas)));
                canvas
            }
        };
        self.blend(clip, (state, canvas), observer)
    }

    fn units(&self, state: &State) -> Option<usize> {
        state.chain.units()
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        state.chain.place(state.placed)
    }

    fn at_frame(&self, state: &State) -> Option<usize> {
        Some(state.chain.at_frame(state.placed))
    }

    fn stage_view(&self, clip: &Clip, now: usize) -> Result<Option<StageView>, Error> {
        Chain::stage_view(clip, now)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.draw_step(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        Output::of(state.chain.field(&[], state.done.clone().map_or(Views::None, Views::Mosaic)))
    }
}

impl Footprint<State> for Mosaic {
    fn need(&self, clip: &Clip) -> Need {
        let Need { run, .. } = self.motion.need(clip);
        // The canvas and the picture of it; in a walk that before the frame, after it, and in a checkpoint.
        let canvas = 20.0 * MOST_FRAMES;
        Need::per_pixel(clip, [canvas, 4.0 * canvas]).and([run as f64; 2])
    }

    fn state_bytes(&self, state: &State) -> usize {
        let canvas = state.canvas.as_ref().map_or(0, |canvas| canvas.bytes());
        size_of::<State>() + state.chain.bytes() + canvas + state.done.as_ref().map_or(0, |frame| frame.bytes())
    }
}
