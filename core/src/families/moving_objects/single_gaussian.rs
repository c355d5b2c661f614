//! Single Gaussian: a mean and a variance of each background pixel.

use std::sync::Arc;

use crate::base::{Threads, wide::wide};
use crate::data::{Clip, Frame, Mask};
use crate::geometry::Grid;
use crate::methods::numbers::{fixed, gray, level, ratio};
use crate::methods::subtraction::{
    Accepted, Background, Channel, Channels, Channelwise, Explanation, Found, Initial, Past, Planes, Row, Settings,
    ShadowDetection, Steadiness, classify, displaced, in_channel, kind, levels, most, of_channel,
    subtraction_pseudocode, tuple,
};
use crate::params;
use crate::run::{Info, Need};
use crate::scene::{Fact, Layer, Math, Quantity, Role, Sentence};

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
    renamed {
        "rate" => "learning-rate",
        "first-sigma" => "initial-sigma",
        "open" => "opening",
        "close" => "closing",
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

subtraction_pseudocode! {
    begin: "μ ← the initial background, σ ← initial-sigma",
    camera: "  shift the model by the median displacement of the camera, in whole px",
    exposure: "  correct the exposure of the frame to that of the background",
    compare: "  d ← |I − μ| / σ; in colour the maximum over the channels",
    decide: "  foreground if d > threshold",
    shadows: "  shadow if I ≈ a μ with shadow-threshold ≤ a ≤ 1",
    shake: "  suppress pixels that fit the background of a pixel within shake",
    update: "  μ ← μ + α (I − μ), σ² ← σ² + α ((I − μ)² − σ²); if selective, at background pixels only",
}

impl Background for SingleGaussian {
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
    type Model = Planes<Gaussian>;

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
        Need::per_pixel(clip, [1.0 + 16.0 * self.channels.most(clip) as f64; 2])
    }

    fn initial(&self) -> Initial {
        self.initial
    }

    fn begin(&self, first: &Arc<Frame>) -> Planes<Gaussian> {
        let sigma = self.initial_sigma.max(self.min_sigma);
        Planes::begin(first, self.channels, |level| Gaussian { mean: level.into(), variance: sigma * sigma })
    }

    fn subtract(&self, model: &mut Planes<Gaussian>, frame: &Arc<Frame>, threads: &Threads) -> Found {
        // Shadows are those on the background before the update.
        let before = (self.shadow.detect_shadows && model.channels == 3).then(|| model.clone());
        let mask = model.by_rows(frame, threads, |row, cells, words| decide(self, row, cells, words));
        let limit = |of: [Gaussian; 3]| {
            let variance = of.iter().map(|of| of.variance).sum::<f32>() / 3.0;
            self.threshold * self.threshold * variance
        };
        let darkest = self.shadow.shadow_threshold;
        let shadows = before.map(|model| model.shadows((frame, &mask), darkest, |of| of.mean, limit));
        Found { mask, shadows }
    }

    fn expected(&self, model: &Planes<Gaussian>, place: (usize, usize)) -> f32 {
        model.expected(place, Channel::Gray, |of| of.mean)
    }

    fn expected_color(&self, model: &Planes<Gaussian>, place: (usize, usize)) -> Option<[u8; 3]> {
        model.color(place, |of| of.mean)
    }

    fn channel(&self, model: &Planes<Gaussian>, frame: &Frame, place: (usize, usize)) -> Channel {
        model.deciding(self, frame, place).0
    }

    fn compared_in(&self, model: &Planes<Gaussian>, _: &Frame, place: (usize, usize), channel: Channel) -> f32 {
        model.expected(place, channel, |of| of.mean)
    }

    fn accepted(&self, model: &Planes<Gaussian>, place: (usize, usize), channel: Channel) -> Vec<Accepted> {
        let Gaussian { mean, variance } = model.at(place)[channel.index()];
        let sigma = variance.sqrt();
        vec![Accepted { sigma: Some(sigma), ..Accepted::around(mean, self.threshold * sigma) }]
    }

    fn layers(&self, model: &Arc<Planes<Gaussian>>, _past: &Past) -> Vec<Layer> {
        let model = Arc::clone(model);
        // In colour that of the channel that varies most.
        vec![Layer::new(Quantity::Deviation, move || {
            let (width, height) = model.size();
            let variance = |place| model.at(place).map(|of| of.variance).into_iter().fold(0.0, f32::max);
            Grid::from_fn(width, height, |x, y| variance((x, y)).sqrt())
        })]
    }

    fn difference(&self, model: &Planes<Gaussian>, frame: &Frame, place: (usize, usize)) -> f32 {
        model.deciding(self, frame, place).1
    }

    fn explain(
        &self,
        [before, after]: [Option<&Planes<Gaussian>>; 2],
        frame: &Frame,
        place: (usize, usize),
    ) -> Explanation {
        let Some(before) = before else { return Explanation::default() };
        let (channels, pixel) = (before.channels, levels(frame, place, before.channels));
        let (channel, distance) = before.deciding(self, frame, place);
        let (at, is_foreground) = (channel.index(), !before.fits(self, (frame, place), place));
        let role = if is_foreground { Role::Result } else { Role::Rejected };
        let [mu, sigma] = texts(before, place);
        let [distance, limit] = [fixed(distance.into(), 2), gray(self.threshold)];
        let shown = tuple(&pixel[..channels], |of| level(of.into()));
        let ([name, lower], found) = (kind(channels), in_channel(&format!("{distance} σ"), channel));
        let label = if channels == 1 { "Distance" } else { "Largest distance" };
        let mut facts = vec![
            Fact::new(name, shown.clone(), Some(Role::Measured)),
            Fact::new("Mean μ", mu.clone(), Some(Role::Predicted)),
            Fact::new("Standard deviation σ", sigma.clone(), Some(Role::Predicted)),
            Fact::new(label, found.clone(), Some(role)),
            Fact::new("Threshold", format!("{limit} σ"), None),
        ];
        let mut update = Sentence::default();
        if let Some(after) = after {
            let [new_mu, new_sigma] = texts(after, place);
            facts.push(Fact::new("After update", format!("μ {new_mu}, σ {new_sigma}"), Some(Role::Estimate)));
            update = match self.selective && is_foreground {
                true => update.text(format!("foreground, and the update is selective, so μ {mu} and σ {sigma} stay.")),
                false => update
                    .text(format!("the update with learning rate α = {} moves ", ratio(self.learning_rate.into())))
                    .ink(Role::Estimate, format!("μ from {mu} to {new_mu}, σ from {sigma} to {new_sigma}"))
                    .text("."),
            };
        }
        let size = |inner: Vec<Math>| Math::Abs(Box::new(Math::Row(inner)));
        let [of_pixel, of_mean, of_sigma] = ["I", "μ", "σ"].map(|symbol| of_channel(symbol, channels));
        let symbols = Math::Frac(Box::new(size(vec![of_pixel, Math::text(" − "), of_mean])), Box::new(of_sigma));
        let Gaussian { mean, variance } = before.at(place)[at];
        let numbers = Math::Frac(
            Box::new(size(vec![
                Math::ink(Role::Measured, level(pixel[at].into())),
                Math::text(" − "),
                Math::ink(Role::Predicted, gray(mean)),
            ])),
            Box::new(Math::ink(Role::Predicted, gray(variance.sqrt()))),
        );
        let verdict = if is_foreground { " > " } else { " ≤ " };
        let within = channel.name().map_or_else(String::new, |name| format!(" in {name}"));
        Explanation {
            facts,
            equation: vec![
                Math::Row(vec![most(symbols, channels), Math::text(" > "), Math::Var("T")]),
                Math::Row(vec![
                    numbers,
                    Math::text(" = "),
                    Math::ink(role, distance),
                    Math::text(format!("{verdict}{limit}{within}")),
                ]),
            ],
            matrices: Vec::new(),
            verdict: Sentence::default()
                .text(format!(": {lower} "))
                .ink(Role::Measured, shown)
                .text(", background ")
                .ink(Role::Predicted, format!("μ = {mu}, σ = {sigma}"))
                .text(format!(". The {} ", label.to_lowercase()))
                .ink(role, found)
                .text(match is_foreground {
                    true => format!(" exceeds the threshold {limit} σ: foreground."),
                    false => format!(" is within the threshold {limit} σ: background."),
                }),
            update,
        }
    }

    fn rule(&self) -> String {
        format!("|I − μ| / σ exceeds the threshold of {} σ{}", gray(self.threshold), self.channels.any())
    }

    fn model_bytes(&self, model: &Planes<Gaussian>) -> usize {
        model.bytes()
    }
}

/// Mean and standard deviation of a pixel as text.
fn texts(model: &Planes<Gaussian>, place: (usize, usize)) -> [String; 2] {
    let all = model.at(place);
    let channels = &all[..model.channels];
    [tuple(channels, |of| gray(of.mean)), tuple(channels, |of| gray(of.variance.sqrt()))]
}
