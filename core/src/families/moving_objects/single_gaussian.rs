//! Single Gaussian: a mean and a variance of each background pixel.

use std::sync::Arc;

use crate::base::wide::wide;
use crate::geometry::Grid;
use crate::methods::subtraction::{
    self, Accepted, Channel, ChannelModel, Channels, Channelwise, Common, Explanation, IN_CHANNEL, Initial, Past,
    Planes, Probe, Row, Settings, Setup, ShadowDetection, Steadiness, class, classify, levels, put_pixel,
    subtraction_pseudocode, tuple,
};
use crate::run::Info;
use crate::scene::{Case, Layer, Quantity, Role, Step, Unit, Variable};
use crate::{cases, params, variables};

params! {
    /// One normal distribution for each pixel, in colour for each of its channels.
    pub struct SingleGaussian {
        /// Learning rate α of mean and variance, about 1 / history in frames. Higher values follow changes sooner, but absorb slow objects.
        learning_rate: f32 = 0.02, 0.0..=1.0;
        /// The channels that are compared.
        channels: Channels = Channels::Color;
        /// Threshold on |I − μ| / σ. Pixels farther from the mean, in colour in any channel, are foreground; OpenCV's variance threshold is its square.
        threshold: f32 = 4.0, 0.0..=20.0, "σ";
        /// Initial standard deviation σ of each pixel in gray levels.
        initial_sigma: f32 = 6.0, 0.5..=50.0;
        /// Minimum standard deviation σ in gray levels. It keeps image noise from becoming foreground where the scene was quiet.
        min_sigma: f32 = 2.0, 0.5..=50.0;
        /// Selective update: only background pixels update the model. Objects do not inflate σ, but ghosts and stopped objects stay foreground permanently.
        selective: bool = true;
        /// The detection of cast shadows.
        shadow: ShadowDetection = ShadowDetection::default();
        /// Initial background: the first frame, or the median of the run, which uses later frames (non-causal).
        initial: Initial = Initial::Median;
        /// The treatment of a camera that is not quite at rest.
        steady: Steadiness = Steadiness::default();
        /// The parameters of all background subtractions.
        settings: Settings = Settings::default();
    }
    advanced { "initial-sigma", "min-sigma" }
    when {
        "detect-shadows": |p| p.channels == Channels::Color, "Shadow detection has no effect in gray: it needs colour.";
        "shadow-threshold": |p| p.channels == Channels::Color, "The shadow threshold has no effect in gray.";
    }
}

/// The distribution of the levels of a channel of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    /// The mean μ in gray levels.
    pub mean: f32,
    /// The variance σ² in squared gray levels.
    pub variance: f32,
}

impl From<Gaussian> for f32 {
    fn from(of: Gaussian) -> f32 {
        of.mean
    }
}

impl Channelwise for SingleGaussian {
    type Cell = Gaussian;

    #[inline(always)]
    fn distance(&self, Gaussian { mean, variance }: Gaussian, level: u8) -> f32 {
        (f32::from(level) - mean).abs() / variance.sqrt()
    }

    #[inline(always)]
    fn differs(&self, Gaussian { mean, variance }: Gaussian, level: u8) -> bool {
        let off = f32::from(level) - mean;
        off * off > self.threshold * self.threshold * variance
    }

    #[inline(always)]
    fn updated(&self, Gaussian { mean, variance }: Gaussian, level: u8, is_foreground: bool) -> Gaussian {
        let rate = if is_foreground && self.selective { 0.0 } else { self.learning_rate };
        let (off, least) = (f32::from(level) - mean, self.min_sigma * self.min_sigma);
        let variance = variance + rate * (off * off - variance);
        Gaussian { mean: mean + rate * off, variance: if variance > least { variance } else { least } }
    }
}

wide!(fn decide(of: &SingleGaussian, row: Row<'_>, model: &mut [Gaussian], words: &mut [u64]) = classify);

/// The unit of a distance in standard deviations.
const SIGMAS: Unit = Unit::new("σ", 2);

variables! {
    /// The mean μ of the pixel, in colour of each channel.
    MEAN: "Mean μ", r"\mu", Unit::FINE, Role::Predicted;
    /// The standard deviation σ of the pixel, in colour of each channel.
    SIGMA: "Standard deviation σ", r"\sigma", Unit::FINE, Role::Predicted;
    /// The distance of the pixel from its mean, in colour the largest of all channels.
    DISTANCE: "Distance", r"|I - \mu| / \sigma", SIGMAS;
    /// The mean μ after the update.
    NEW_MEAN: "Mean after update", r"\mu", Unit::FINE, Role::Estimate;
    /// The standard deviation σ after the update.
    NEW_SIGMA: "Standard deviation after update", r"\sigma", Unit::FINE, Role::Estimate;
    /// The standard deviation in the channel that decides.
    DECIDING_SIGMA: "", r"\sigma", Unit::FINE, Role::Predicted;
}

cases! { over value, subtraction::value;
    RULE: "|I − μ| / σ exceeds the threshold of {threshold}",
    BACKGROUND: ", background {predicted|μ =} {mean}, {predicted|σ =} {sigma}.",
    DISTANCE: "The distance {distance}",
    LARGEST_DISTANCE: "The largest distance {distance} in {channel}",
    EXCEEDS: "exceeds the threshold {threshold}: foreground.",
    WITHIN: "is within the threshold {threshold}: background.",
    FROZEN: "foreground, and the update is selective, so μ {mean} and σ {sigma} stay.",
    LEARNS: "the update with learning rate α = {learning_rate} moves {estimate|μ} from {mean} to {new_mean}, {estimate|σ} from \
             {sigma} to {new_sigma}.",
}

subtraction_pseudocode! {
    begin: "μ ← the initial background, σ ← initial-sigma",
    camera: "  shift the model by the median displacement of the camera, in whole px",
    compare: "  d ← |I − μ| / σ; in colour the maximum over the channels",
    decide: "  foreground if d > threshold",
    shadows: "  shadow if I ≈ a μ with shadow-threshold ≤ a ≤ 1",
    shake: "  suppress pixels that fit the background of a pixel within shake",
    update: "  μ ← μ + α (I − μ), σ² ← σ² + α ((I − μ)² − σ²), σ ≥ min-sigma; if selective, at background pixels only",
}

impl ChannelModel for SingleGaussian {
    const INFO: Info = Info {
        id: "single-gaussian",
        name: "Single Gaussian",
        family: "Moving objects",
        summary: "Models each pixel by a normal distribution and thresholds the distance in standard deviations, so that noisy pixels need a larger difference.",
        source: "C. Wren, A. Azarbayejani, T. Darrell and A. Pentland, Pfinder: real-time tracking of the human body, PAMI 1997; here \
                 with independent channels; shadows: T. Horprasert, D. Harwood and L. S. Davis, ICCV frame-rate workshop 1999",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "stage"],
        frames: 2,
    };
    const SHOWN: &'static str = "|I − μ| / σ, in colour the maximum over the channels";
    const RULE: &'static Case = case::RULE;
    const UNIT: Unit = SIGMAS;

    fn common(&self) -> Common {
        let setup = Setup { settings: self.settings, initial: Some(self.initial), steady: Some(self.steady) };
        Common { channels: self.channels, shadow: self.shadow, setup }
    }

    fn threshold(&self) -> f32 {
        self.threshold
    }

    fn begun(&self, level: u8) -> Gaussian {
        Gaussian { mean: level.into(), variance: self.initial_sigma.max(self.min_sigma).powi(2) }
    }

    fn shadow_limit(&self, of: [Gaussian; 3]) -> f32 {
        let variance = of.iter().map(|of| of.variance).sum::<f32>() / 3.0;
        self.threshold * self.threshold * variance
    }

    fn accepts(&self, Gaussian { mean, variance }: Gaussian) -> Accepted {
        let sigma = variance.sqrt();
        Accepted { sigma: Some(sigma), ..Accepted::around(mean, self.threshold * sigma) }
    }

    fn decide(&self, row: Row<'_>, cells: &mut [Gaussian], words: &mut [u64]) {
        decide(self, row, cells, words);
    }

    fn layers(&self, model: &Arc<Planes<Gaussian>>, _past: &Past) -> Vec<Layer> {
        let model = Arc::clone(model);
        // For colour, the deviation of the channel that varies most.
        vec![Layer::new(Quantity::Deviation, move || {
            let (width, height) = model.size();
            let variance = |place| model.at(place).map(|of| of.variance).into_iter().fold(0.0, f32::max);
            Grid::from_fn(width, height, |x, y| variance((x, y)).sqrt())
        })]
    }

    fn explain(&self, step: Step, probe: &Probe<Planes<Gaussian>>) -> Explanation {
        let &Probe { before, after, frame, place } = probe;
        let pixel = levels(frame, place, before.channels);
        let (channel, distance) = before.deciding(self, frame, place);
        let (at, is_foreground) = (channel.index(), !before.fits(self, (frame, place), place));
        let (role, sign) = class(is_foreground);
        let (step, level) = put_pixel(step, &pixel[..before.channels]);
        let step = moments(step, before, place, [value::MEAN, value::SIGMA])
            .fact_of(value::DISTANCE.is(distance).inked(role))
            .fact_if(subtraction::value::CHANNEL, channel.name())
            .fact_of(subtraction::value::THRESHOLD.is(self.threshold).in_unit(SIGMAS))
            .put(subtraction::value::LEVEL, pixel[at])
            .put(subtraction::value::EXPECTED, before.at(place)[at].mean)
            .put(value::DECIDING_SIGMA, before.at(place)[at].variance.sqrt());
        let (symbols, within, off) = match channel {
            Channel::Gray => (r"\frac{|I - \mu|}{\sigma} > T", "", case::DISTANCE),
            Channel::Color(_) => (r"\max_c \frac{|I_c - \mu_c|}{\sigma_c} > T", IN_CHANNEL, case::LARGEST_DISTANCE),
        };
        let step = step.formula(symbols).formula(format!(
            r"\frac{{|{{level}} - {{expected}}|}}{{{{deciding_sigma}}}} = {{distance}} {sign} {{threshold}}{within}"
        ));
        let verdict = vec![level, case::BACKGROUND, off, if is_foreground { case::EXCEEDS } else { case::WITHIN }];
        let Some(after) = after else { return Explanation { step, verdict, update: Vec::new() } };
        let step = moments(step, after, place, [value::NEW_MEAN, value::NEW_SIGMA]);
        let step = step.put(subtraction::value::LEARNING_RATE, self.learning_rate);
        let update = vec![if self.selective && is_foreground { case::FROZEN } else { case::LEARNS }];
        Explanation { step, verdict, update }
    }
}

/// Puts mean and standard deviation of a pixel.
fn moments(step: Step, model: &Planes<Gaussian>, place: (usize, usize), [mean, sigma]: [&'static Variable; 2]) -> Step {
    let all = &model.at(place)[..model.channels];
    let [means, sigmas] =
        [|of: &Gaussian| of.mean, |of: &Gaussian| of.variance.sqrt()].map(|of| all.iter().map(of).collect::<Vec<_>>());
    step.fact(mean, tuple(&means)).fact(sigma, tuple(&sigmas))
}
