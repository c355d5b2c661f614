//! Mixture of Gaussians: a pixel may have several looks, and those that it has mostly are the background.

mod explain;
mod model;

use std::sync::Arc;

use crate::base::{Threads, words};
use crate::data::{Clip, Frame};
use crate::methods::subtraction::{Background, Explanation, Found, Initial, Settings, subtraction_pseudocode};
use crate::params;
use crate::run::{Info, Need};
use crate::scene::Chart;

pub use model::{Mixture, Mode};

params! {
    /// A mixture of normal distributions for each pixel, in colour where the frames have it.
    pub struct MixtureOfGaussians {
        /// At most so many distributions, or modes, for each pixel; as many as it needs.
        modes: usize = 5, 1..=8;
        /// How much a frame counts: the larger, the sooner something that stands still becomes background.
        rate: f32 = 0.005, 0.0..=1.0;
        /// A pixel belongs to a mode if it is not farther from it than so many σ, the root of the mean squared distance of the mode's pixels, all channels together. Stauffer and Grimson took 2.5, Zivkovic 3.
        threshold: f32 = 4.0, 0.5..=20.0, "σ";
        /// The heaviest modes that together have this share of the weight are the background.
        background: f32 = 0.9, 0.0..=1.0;
        /// How much evidence a mode needs to last, as a share of the data: without it its weight falls to nothing; 0 keeps all modes, as Stauffer and Grimson did.
        prune: f32 = 0.05, 0.0..=0.5;
        /// σ of a new mode, in gray levels: the root of the mean squared distance from its mean, all channels together. In colour that is √3 of what one channel strays.
        first_sigma: f32 = 4.0, 0.5..=50.0;
        /// No σ becomes less than this, in gray levels.
        min_sigma: f32 = 2.0, 0.5..=50.0;
        /// Take shadows off the foreground: what has a background's colour, but is darker. Gray pictures do not tell.
        shadows: bool = true;
        /// A shadow leaves at least this share of the light.
        darkest: f32 = 0.5, 0.05..=1.0;
        /// Initial background.
        initial: Initial = Initial::FirstFrame;
        /// What all background subtractions have.
        settings: Settings = Settings::default();
    }
    advanced { "background", "prune", "first-sigma", "min-sigma", "darkest" }
    when {
        "darkest": |p| p.shadows, "The darkest shadow has no effect where shadows are not detected.";
    }
}

/// No σ becomes more than so many times that of a new mode.
const MAX_SIGMAS: f32 = 2.25;

subtraction_pseudocode! {
    begin: "one mode for each pixel: w ← 1, μ ← the initial background, σ ← first-sigma",
    compare: "  mode ← the heaviest with |I − μ| ≤ threshold · σ, if there is one",
    decide: "  foreground if there is none, or heavier modes have the share background already",
    shadows: "  shadow if I ≈ a μ with darkest ≤ a ≤ 1 for a mode of the background",
    update: "  w ← w + rate (1 or 0 − w − prune); the mode's μ, σ² follow I by rate / w; none: a new mode",
}

impl Background for MixtureOfGaussians {
    const INFO: Info = Info {
        id: "mixture-of-gaussians",
        name: "Mixture of Gaussians",
        family: "Moving objects",
        summary: "Gives each pixel several looks with their weights, so that leaves may wave and lamps may blink; the rare ones are objects.",
        source: "C. Stauffer and W. E. L. Grimson, Adaptive background mixture models for real-time tracking, CVPR 1999; how many \
                 modes: Z. Zivkovic, Improved adaptive Gaussian mixture model for background subtraction, ICPR 2004; shadows: \
                 A. Prati, I. Mikić, M. Trivedi and R. Cucchiara, Detecting moving shadows, PAMI 2003",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "stage"],
        frames: 2,
    };
    const SHOWN: &'static str = "|I − μ| / σ of the nearest mode of the background";
    const CHARTS: &'static [Chart] = &[Chart::Tiles, Chart::Series, Chart::Matrices];
    type Model = Mixture;

    fn settings(&self) -> Settings {
        self.settings
    }

    fn need(&self, clip: &Clip) -> Need {
        let is_gray = clip.cached(0).is_some_and(|frame| frame.color().is_none());
        let bytes = Mixture::need(self.modes, if is_gray { 1 } else { 3 });
        Need::per_pixel(clip, [bytes; 2])
    }

    fn initial(&self) -> Initial {
        self.initial
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

    fn difference(&self, model: &Mixture, frame: &Frame, place: (usize, usize)) -> f32 {
        model.distance(frame, place, self.background)
    }

    fn explain(&self, models: [Option<&Mixture>; 2], frame: &Frame, place: (usize, usize)) -> Explanation {
        self.explanation(models, frame, place)
    }

    fn rule(&self) -> String {
        format!("fit none of the modes that make up {} % of the weight", words::number(100.0 * self.background))
    }

    fn update(&self) -> String {
        "The mode that fits grows and follows the pixel, all others lose weight, and a look that is new begins a mode of its own"
            .into()
    }

    fn at_rest(&self, model: &Arc<Mixture>) -> Arc<Mixture> {
        Arc::new(model.packed())
    }

    fn model_bytes(&self, model: &Mixture) -> usize {
        model.bytes()
    }
}
