//! Running average: the background is an exponentially weighted mean.

use crate::base::wide::wide;
use crate::methods::subtraction::{
    self, ChannelModel, Channels, Channelwise, Common, Explanation, Initial, Planes, Probe, Row, Settings, Setup,
    ShadowDetection, Steadiness, classify, subtraction_pseudocode,
};
use crate::run::Info;
use crate::scene::Step;
use crate::{cases, params};

params! {
    /// Running average of each pixel.
    pub struct RunningAverage {
        /// Learning rate α, about 1 / history in frames. Higher values absorb stopped objects and ghosts sooner, but leave trails behind slow ones.
        learning_rate: f32 = 0.02, 0.0..=1.0;
        /// The channels that are compared.
        channels: Channels = Channels::Color;
        /// Difference threshold in gray levels. Pixels with a larger |I − B|, in colour in any channel, are foreground.
        threshold: f32 = 25.0, 0.0..=255.0;
        /// Selective update: only background pixels update the model. Objects leave no trail, but ghosts and stopped objects stay foreground permanently.
        selective: bool = false;
        /// The detection of cast shadows.
        shadow: ShadowDetection = ShadowDetection::default();
        /// Initial background: the first frame, or the median of the run, which uses later frames (non-causal).
        initial: Initial = Initial::Median;
        /// The treatment of a camera that is not quite at rest.
        steady: Steadiness = Steadiness::default();
        /// The parameters of all background subtractions.
        settings: Settings = Settings::default();
    }
    when {
        "detect-shadows": |p| p.channels == Channels::Color, "Shadow detection has no effect in gray: it needs colour.";
        "shadow-threshold": |p| p.channels == Channels::Color, "The shadow threshold has no effect in gray.";
    }
}

impl Channelwise for RunningAverage {
    type Cell = f32;

    #[inline(always)]
    fn distance(&self, mean: f32, level: u8) -> f32 {
        (f32::from(level) - mean).abs()
    }

    #[inline(always)]
    fn differs(&self, mean: f32, level: u8) -> bool {
        self.distance(mean, level) > self.threshold
    }

    #[inline(always)]
    fn updated(&self, mean: f32, level: u8, is_foreground: bool) -> f32 {
        let rate = if is_foreground && self.selective { 0.0 } else { self.learning_rate };
        mean + rate * (f32::from(level) - mean)
    }
}

wide!(fn decide(of: &RunningAverage, row: Row<'_>, model: &mut [f32], words: &mut [u64]) = classify);

cases! { over subtraction::value;
    LEARNS: "; the learning rate is α = {learning_rate}.",
    FROZEN: "foreground, and the update is selective, so B stays {background}.",
}

subtraction_pseudocode! {
    begin: "B ← the initial background",
    camera: "  shift the model by the median displacement of the camera, in whole px",
    compare: "  d ← |I − B|; in colour the maximum over the channels",
    decide: "  foreground if d > threshold",
    shadows: "  shadow if I ≈ a B with shadow-threshold ≤ a ≤ 1",
    shake: "  suppress pixels that fit the background of a pixel within shake",
    update: "  B ← (1 − α) B + α I with learning-rate α; if selective, at background pixels only",
}

impl ChannelModel for RunningAverage {
    const INFO: Info = Info {
        id: "running-average",
        name: "Running average",
        family: "Moving objects",
        summary: "Models the background as an exponentially weighted mean of each pixel and channel and thresholds the difference from it.",
        source: "J. Heikkilä and O. Silvén, A real-time system for monitoring of cyclists and pedestrians, VS 1999; selective: \
                 D. Koller et al., Towards robust automatic traffic scene analysis in real-time, ICPR 1994; shadows: T. Horprasert, D. Harwood and L. S. Davis, ICCV \
                 frame-rate workshop 1999",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "stage"],
        frames: 2,
    };

    fn common(&self) -> Common {
        let setup = Setup { settings: self.settings, initial: Some(self.initial), steady: Some(self.steady) };
        Common { channels: self.channels, shadow: self.shadow, setup }
    }

    fn threshold(&self) -> f32 {
        self.threshold
    }

    fn begun(&self, level: u8) -> f32 {
        level.into()
    }

    fn decide(&self, row: Row<'_>, cells: &mut [f32], words: &mut [u64]) {
        decide(self, row, cells, words);
    }

    fn explain(&self, step: Step, probe: &Probe<Planes<f32>>) -> Explanation {
        let comparison = probe.before.comparison(self, probe);
        let mut explanation = comparison.explained(step.put(subtraction::value::LEARNING_RATE, self.learning_rate));
        match comparison.is_foreground && self.selective {
            _ if probe.after.is_none() => {}
            true => explanation.update = vec![case::FROZEN],
            false => explanation.update.push(case::LEARNS),
        }
        explanation
    }
}
