//! Video stabilisation: the path of the camera, smoothed, and the frames warped to it.

mod explain;

use std::sync::Arc;

use crate::base::{Error, Observer, Threads};
use crate::data::{Clip, Frame};
use crate::methods::camera_path::{Chain, DIRECTION, Link, correction, path_pseudocode};
use crate::params;
use crate::products::model::{IDENTITY, Matrix3, product};
use crate::products::path::{empty_share, middle};
use crate::products::{Output, PathField, Product, ProductKind, Views};
use crate::run::{
    Estimator, Footprint, GlobalModel, Granularity, Guarantee, Info, Need, Progress, Seen, Stage, StageView,
};
use crate::scene::{Chart, Question, Scene, Step};

params! {
    /// Video stabilisation by smoothing the path of the camera.
    pub struct Stabilization {
        /// Number of frames, including the first; fewer at the end of the clip.
        frames: usize = 100, 2..=10_000;
        /// Method of the motion of a pair of frames.
        motion: Stage<GlobalModel> = Stage::named("global-motion").with("model", "similarity").with("detector.double", "off");
        /// Standard deviation of the Gaussian weights with which the path is smoothed. Larger ones suppress slower shakes, but leave more
        /// of the picture empty; the frames after t are needed too, so it is not causal.
        smoothing: f32 = 8.0, 0.5..=200.0, "frames";
        /// Magnification of the stabilised frames about their middle, to hide the empty border.
        zoom: f32 = 0.0, 0.0..=50.0, "%";
    }
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    chain: Chain,
    /// The maps from each frame to its stabilised one so far.
    corrections: Arc<Vec<Matrix3>>,
    /// Number of frames without a smoothed place, which stay on the path.
    unsmoothed: usize,
    clip: Clip,
}

/// A frame and its correction.
#[derive(Clone)]
pub struct Stable {
    frame: Arc<Frame>,
    correction: Matrix3,
    /// Whether the path has a smoothed place for it.
    is_smoothed: bool,
}

impl Stable {
    /// Share of the stabilised frame that is empty.
    fn empty(&self) -> f64 {
        empty_share(&self.correction, self.frame.size())
    }
}

/// An event of a unit: a pair of frames, or a frame to be stabilised.
#[derive(Clone)]
pub enum Event {
    /// The motion of the pair.
    Estimated(Arc<Link>),
    /// The path up to the second frame.
    Chained(Arc<Link>),
    /// The correction of a frame.
    Smoothed(Arc<Stable>),
    /// The stabilised frame.
    Warped(Arc<Stable>),
}

impl Stabilization {
    /// The map from a frame to its stabilised version, given the map to its place on the smoothed path.
    fn zoomed(&self, chain: &Chain, smooth: &Matrix3) -> Matrix3 {
        let factor = 1.0 + f64::from(self.zoom) / 100.0;
        let [x, y] = middle(chain.picture);
        let zoom = [[factor, 0.0, x * (1.0 - factor)], [0.0, factor, y * (1.0 - factor)], [0.0, 0.0, 1.0]];
        product(&zoom, smooth)
    }
}

path_pseudocode! {
    EACH_FRAME: "for each frame t",
    SMOOTH: "  S(t) ← Σ w(k) P(t+k) P(t)⁻¹ with Gaussian weights w of Σ w = 1 and Σ k w(k) = 0",
    WARP: "  stabilised frame ← frame t warped by S(t)",
}

impl Estimator for Stabilization {
    const INFO: Info = Info {
        id: "stabilization",
        name: "Video stabilisation",
        family: "Correspondence",
        summary: "Chains the motions of the background through the clip, smooths this path of the camera, and warps each frame to it.",
        source: "Y. Matsushita, E. Ofek, W. Ge, X. Tang and H.-Y. Shum, Full-frame video stabilization with motion inpainting, PAMI 28(7), \
                 2006, section 3; local linear weights: W. S. Cleveland, JASA 74, 1979",
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
        let chain = Chain::new(clip, frame, self.frames)?;
        Ok(State { chain, corrections: Arc::default(), unsmoothed: 0, clip: clip.clone() })
    }

    fn advance(&self, clip: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        if !state.chain.is_complete {
            let link = Arc::new(state.chain.advance(&self.motion, clip, &Threads::single())?);
            observer.see(|| Event::Estimated(Arc::clone(&link)));
            observer.see(|| Event::Chained(link));
            return Ok(Progress::More);
        }
        clip.wanted()?;
        let index = state.corrections.len();
        let frame = clip.frame(state.chain.span.first + index)?;
        let smooth = correction(&state.chain.to_frames, index, self.smoothing);
        let correction = self.zoomed(&state.chain, &smooth.unwrap_or(IDENTITY));
        let stable = Arc::new(Stable { frame, correction, is_smoothed: smooth.is_some() });
        state.unsmoothed += usize::from(smooth.is_none());
        observer.see(|| Event::Smoothed(Arc::clone(&stable)));
        observer.see(|| Event::Warped(stable));
        Arc::make_mut(&mut state.corrections).push(correction);
        let is_over = state.corrections.len() == state.chain.to_frames.len();
        Ok(if is_over { Progress::Done } else { Progress::More })
    }

    fn units(&self, state: &State) -> Option<usize> {
        state.chain.units()
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        state.chain.place(state.corrections.len())
    }

    fn at_frame(&self, state: &State) -> Option<usize> {
        Some(state.chain.at_frame(state.corrections.len()))
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
        let is_empty = state.corrections.is_empty();
        let views = if is_empty { Views::None } else { Views::Stabilized(state.clip.clone()) };
        Output::of(state.chain.field(&state.corrections, views))
    }
}

impl Footprint<State> for Stabilization {
    fn need(&self, clip: &Clip) -> Need {
        let Need { run, .. } = self.motion.need(clip);
        // A step shows a frame and its stabilised version.
        Need::per_pixel(clip, [4.0, 16.0]).and([run as f64; 2])
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of::<State>() + state.chain.bytes() + size_of_val(&state.corrections[..])
    }
}
