//! Running average: the background is an exponentially weighted mean.

use std::sync::Arc;

use crate::base::{Threads, wide::wide};
use crate::data::{Clip, Frame, Mask};
use crate::methods::numbers::{gray, level, ratio};
use crate::methods::subtraction::{
    Accepted, Background, Channel, Channels, Channelwise, Comparison, Explanation, Found, Initial, Planes, Row,
    SHADOW_SHARE, Settings, ShadowDetection, Steadiness, classify, displaced, kind, levels, subtraction_pseudocode,
    tuple,
};
use crate::params;
use crate::run::{Info, Need};
use crate::scene::{Fact, Role, Sentence};

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
    renamed { "rate" => "learning-rate", "open" => "opening", "close" => "closing" }
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

subtraction_pseudocode! {
    begin: "B ← the initial background",
    camera: "  shift the model by the median displacement of the camera, in whole px",
    exposure: "  correct the exposure of the frame to that of the background",
    compare: "  d ← |I − B|; in colour the maximum over the channels",
    decide: "  foreground if d > threshold",
    shadows: "  shadow if I ≈ a B with shadow-threshold ≤ a ≤ 1",
    shake: "  suppress pixels that fit the background of a pixel within shake",
    update: "  B ← (1 − α) B + α I with learning-rate α; if selective, at background pixels only",
}

impl Background for RunningAverage {
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
    const SHOWN: &'static str = "|I − B|, in colour the maximum over the channels";
    type Model = Planes<f32>;

    fn settings(&self) -> Settings {
        self.settings
    }

    fn steadiness(&self) -> Option<Steadiness> {
        Some(self.steady)
    }

    fn moved(&self, model: &Self::Model, by: [f32; 2], frame: &Arc<Frame>) -> Self::Model {
        model.shifted(by, &self.begin(frame))
    }

    fn displaced(&self, model: &Self::Model, frame: &Frame, mask: &Mask) -> Option<Mask> {
        displaced(mask, self.steady, |place, of| model.fits(self, (frame, place), of))
    }

    fn need(&self, clip: &Clip) -> Need {
        Need::per_pixel(clip, [2.0 + 8.0 * self.channels.most(clip) as f64; 2])
    }

    fn initial(&self) -> Initial {
        self.initial
    }

    fn begin(&self, first: &Arc<Frame>) -> Planes<f32> {
        Planes::begin(first, self.channels, f32::from)
    }

    fn subtract(&self, model: &mut Planes<f32>, frame: &Arc<Frame>, threads: &Threads) -> Found {
        // Shadows are those on the background before the update.
        let before = (self.shadow.detect_shadows && model.channels == 3).then(|| model.clone());
        let mask = model.by_rows(frame, threads, |row, cells, words| decide(self, row, cells, words));
        let limit = |_| (SHADOW_SHARE * self.threshold).powi(2);
        let darkest = self.shadow.shadow_threshold;
        let shadows = before.map(|model| model.shadows((frame, &mask), darkest, |mean| mean, limit));
        Found { mask, shadows }
    }

    fn expected(&self, model: &Planes<f32>, place: (usize, usize)) -> f32 {
        model.expected(place, Channel::Gray, |mean| mean)
    }

    fn expected_color(&self, model: &Planes<f32>, place: (usize, usize)) -> Option<[u8; 3]> {
        model.color(place, |mean| mean)
    }

    fn channel(&self, model: &Planes<f32>, frame: &Frame, place: (usize, usize)) -> Channel {
        model.deciding(self, frame, place).0
    }

    fn compared_in(&self, model: &Planes<f32>, _: &Frame, place: (usize, usize), channel: Channel) -> f32 {
        model.expected(place, channel, |mean| mean)
    }

    fn accepted(&self, model: &Planes<f32>, place: (usize, usize), channel: Channel) -> Vec<Accepted> {
        vec![Accepted::around(model.expected(place, channel, |mean| mean), self.threshold)]
    }

    fn difference(&self, model: &Planes<f32>, frame: &Frame, place: (usize, usize)) -> f32 {
        model.deciding(self, frame, place).1
    }

    fn explain(&self, [before, after]: [Option<&Planes<f32>>; 2], frame: &Frame, place: (usize, usize)) -> Explanation {
        let Some(before) = before else { return Explanation::default() };
        let (channels, pixel) = (before.channels, levels(frame, place, before.channels));
        let pixel = &pixel[..channels];
        let comparison =
            Comparison { pixel, background: &before.at(place)[..channels], is_whole: false, threshold: self.threshold };
        let mut explanation = comparison.explained();
        if let Some(after) = after {
            let [old, new] = [before, after].map(|model| tuple(&model.at(place)[..channels], gray));
            let is_frozen = self.selective && before.deciding(self, frame, place).1 > self.threshold;
            explanation.facts.push(Fact::new("Background after update", new.clone(), Some(Role::Estimate)));
            explanation.update = match is_frozen {
                true => Sentence::default().text(format!("foreground, and the update is selective, so B stays {old}.")),
                false => Sentence::default()
                    .text("the background B moves from ")
                    .ink(Role::Predicted, old)
                    .text(" to ")
                    .ink(Role::Estimate, new)
                    .text(format!(
                        " toward the {} {}; the learning rate is α = {}.",
                        kind(channels)[1],
                        tuple(pixel, |of| level(of.into())),
                        ratio(self.learning_rate.into())
                    )),
            };
        }
        explanation
    }

    fn rule(&self) -> String {
        format!("|I − B| exceeds the threshold of {} gray levels{}", gray(self.threshold), self.channels.any())
    }

    fn model_bytes(&self, model: &Planes<f32>) -> usize {
        model.bytes()
    }
}
