//! Mixture of Gaussians: several weighted normal distributions per pixel, of which the heaviest are the background.

mod explain;
mod model;

use std::sync::Arc;

use crate::base::Threads;
use crate::data::{Clip, Frame, Mask};
use crate::geometry::Grid;
use crate::methods::subtraction::{
    Accepted, Background, Cases, Channel, Explanation, Found, Initial, Past, Probe, Settings, Setup, ShadowDetection,
    Steadiness, displaced, subtraction_pseudocode,
};
use crate::params;
use crate::run::{Info, Need};
use crate::scene::{Chart, Layer, Quantity, Step};

pub use model::{Mixture, Mode};

params! {
    /// Mixture of normal distributions for each pixel, in colour where the frames are.
    pub struct MixtureOfGaussians {
        /// Maximum number K of Gaussians (modes) per pixel. Unused modes are pruned.
        modes: usize = 5, 1..=8;
        /// Learning rate α, about 1 / history in frames. Higher values absorb stopped objects and ghosts into the background sooner.
        learning_rate: f32 = 0.002, 0.0..=1.0;
        /// Threshold on |I − μ| / σ within which a pixel matches a mode; OpenCV's variance threshold is its square. σ² is the mean squared distance over all channels together. Stauffer and Grimson use 2.5, Zivkovic 3.
        threshold: f32 = 4.0, 0.5..=20.0, "σ";
        /// Share of the total weight that the heaviest modes reach together; these modes are the background.
        background_ratio: f32 = 0.9, 0.0..=1.0;
        /// Complexity reduction c_T of Zivkovic: share of the data that a mode needs to persist. The weight of a mode with less decays to
        /// zero; 0 keeps all modes, as in Stauffer and Grimson.
        complexity_reduction: f32 = 0.05, 0.0..=0.5;
        /// Initial standard deviation σ of a new mode in gray levels, over all channels together; in colour √3 times that of one channel. A mode
        /// grows to 2.25 times this at most.
        initial_sigma: f32 = 4.0, 0.5..=50.0;
        /// Minimum standard deviation σ of a mode in gray levels.
        min_sigma: f32 = 2.0, 0.5..=50.0;
        /// The detection of cast shadows.
        shadow: ShadowDetection = ShadowDetection::default();
        /// Initial background: the first frame, or the median of the run, which uses later frames (non-causal).
        initial: Initial = Initial::Median;
        /// The treatment of a camera that is not quite at rest.
        steady: Steadiness = Steadiness::default();
        /// The parameters of all background subtractions.
        settings: Settings = Settings::default();
    }
    advanced { "background-ratio", "complexity-reduction", "initial-sigma", "min-sigma" }
}

/// The maximum σ of a mode, as a multiple of that of a new one.
const MAX_SIGMAS: f32 = 2.25;

subtraction_pseudocode! {
    begin: "one mode per pixel: w ← 1, μ ← the initial background, σ ← initial-sigma",
    camera: "  shift the model by the median displacement of the camera, in whole px",
    compare: "  matched mode ← the heaviest with |I − μ| ≤ threshold · σ",
    decide: "  foreground if none matches, or if Σ w of the heavier modes ≥ background-ratio",
    shadows: "  shadow if I ≈ a μ with shadow-threshold ≤ a ≤ 1 for a background mode",
    shake: "  suppress pixels that fit the background of a pixel within shake",
    update: "  w ← w + α (o − w − c_T), o = 1 if matched, else 0; its μ, σ² move by α / w, σ within min-sigma and 2.25 initial-sigma; no match: new mode",
}

impl Background for MixtureOfGaussians {
    const INFO: Info = Info {
        id: "mixture-of-gaussians",
        name: "Mixture of Gaussians",
        family: "Moving objects",
        summary: "Models each pixel by several weighted Gaussians, so that waving leaves and blinking lamps are background too. Rare colours are foreground.",
        source: "C. Stauffer and W. E. L. Grimson, Adaptive background mixture models for real-time tracking, CVPR 1999; number \
                 of modes: Z. Zivkovic, Improved adaptive Gaussian mixture model for background subtraction, ICPR 2004; shadows: \
                 A. Prati, I. Mikić, M. Trivedi and R. Cucchiara, Detecting moving shadows, PAMI 2003",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "stage"],
        frames: 2,
    };
    const SHOWN: &'static str = "|I − μ| / σ of the nearest background mode";
    const CHARTS: &'static [Chart] = &[Chart::Tiles, Chart::Series, Chart::Matrices];
    type Model = Mixture;

    fn setup(&self) -> Setup {
        Setup { settings: self.settings, initial: Some(self.initial), steady: Some(self.steady) }
    }

    fn moved(&self, model: &Self::Model, by: [f32; 2], frame: &Arc<Frame>) -> Self::Model {
        model.moved(self, by, frame)
    }

    fn displaced(&self, model: &Self::Model, frame: &Frame, mask: &Mask) -> Option<Mask> {
        displaced(mask, Some(self.steady), |place, of| model.fits(self, (frame, place), of))
    }

    fn need(&self, clip: &Clip) -> Need {
        let is_gray = clip.cached(0).is_some_and(|frame| frame.color().is_none());
        let bytes = Mixture::need(self.modes, if is_gray { 1 } else { 3 });
        Need::per_pixel(clip, [bytes; 2])
    }

    fn begin(&self, first: &Arc<Frame>) -> Mixture {
        Mixture::new(self, first)
    }

    fn subtract(&self, model: &mut Mixture, frame: &Arc<Frame>, threads: &Threads) -> Found {
        model.subtract(self, frame, threads)
    }

    fn expected(&self, model: &Mixture, place: (usize, usize)) -> f32 {
        model.modes(place).first().map_or(0.0, Mode::gray)
    }

    fn accepted(&self, model: &Self::Model, place: (usize, usize), _: Channel) -> Vec<Accepted> {
        let background = model.background_modes(self, place);
        model.modes(place)[..background].iter().map(|mode| mode.accepted(self.threshold)).collect()
    }

    fn layers(&self, model: &Arc<Mixture>, _past: &Past) -> Vec<Layer> {
        let layer = |quantity, of: fn(&[Mode]) -> f32| {
            let model = Arc::clone(model);
            Layer::new(quantity, move || {
                let (width, height) = model.size();
                Grid::from_fn(width, height, |x, y| of(&model.modes((x, y))))
            })
        };
        vec![
            layer(Quantity::Deviation, |modes| modes.first().map_or(f32::NAN, |mode| mode.variance.sqrt())),
            layer(Quantity::Weight, |modes| modes.first().map_or(f32::NAN, |mode| mode.weight)),
            layer(Quantity::Modes, |modes| modes.len() as f32),
        ]
    }

    fn difference(&self, model: &Mixture, frame: &Frame, place: (usize, usize)) -> f32 {
        model.distance(frame, place, self.background_ratio)
    }

    fn explain(&self, step: Step, probe: &Probe<Mixture>) -> Explanation {
        self.explanation(step, probe)
    }

    fn rule(&self, step: Step) -> (Step, Cases) {
        self.put_rule(step)
    }

    fn at_rest(&self, model: &Arc<Mixture>) -> Arc<Mixture> {
        Arc::new(model.packed())
    }

    fn model_bytes(&self, model: &Mixture) -> usize {
        model.bytes()
    }
}
