//! Single Gaussian: a mean and a variance of each background pixel.

use std::sync::Arc;

use crate::base::{Threads, wide::wide};
use crate::data::{Clip, Frame, Mask};
use crate::geometry::Grid;
use crate::methods::numbers::{fixed, gray, level, ratio};
use crate::methods::subtraction::{
    Accepted, Background, Explanation, Flags, Found, Initial, Past, Settings, Steadiness, by_rows, displaced, shifted,
    subtraction_pseudocode,
};
use crate::params;
use crate::run::{Info, Need};
use crate::scene::{Fact, Layer, Math, Quantity, Role, Sentence};

params! {
    /// One normal distribution for each pixel.
    pub struct SingleGaussian {
        /// Learning rate α of mean and variance, about 1 / history in frames. Higher values follow changes sooner, but absorb slow objects.
        learning_rate: f32 = 0.02, 0.0..=1.0;
        /// Threshold on |I − μ| / σ. Pixels farther from the mean are foreground; OpenCV's variance threshold is its square.
        threshold: f32 = 4.0, 0.0..=20.0, "σ";
        /// Initial standard deviation σ of each pixel in gray levels.
        initial_sigma: f32 = 6.0, 0.5..=50.0;
        /// Minimum standard deviation σ in gray levels. It keeps image noise from becoming foreground where the scene was quiet.
        min_sigma: f32 = 2.0, 0.5..=50.0;
        /// Selective update: only background pixels update the model. Objects do not inflate σ, but ghosts and stopped objects stay foreground permanently.
        selective: bool = true;
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
}

/// The distribution of a pixel's gray levels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    /// The mean μ in gray levels.
    pub mean: f32,
    /// The variance σ² in squared gray levels.
    pub variance: f32,
}

wide!(fn decide(model: &mut [Gaussian], row: &[u8], words: &mut [u64], of: &SingleGaussian) = decide_row);

#[inline(always)]
fn decide_row(model: &mut [Gaussian], row: &[u8], words: &mut [u64], of: &SingleGaussian) {
    let limit = of.threshold * of.threshold;
    let least = of.min_sigma * of.min_sigma;
    let rate_in_front = if of.selective { 0.0 } else { of.learning_rate };
    for ((model, row), word) in model.chunks_mut(64).zip(row.chunks(64)).zip(words) {
        *word = Flags::of(model.len().min(row.len()), |i| {
            let Gaussian { mean, variance } = model[i];
            let off = f32::from(row[i]) - mean;
            let is_foreground = off * off > limit * variance;
            let rate = if is_foreground { rate_in_front } else { of.learning_rate };
            let variance = variance + rate * (off * off - variance);
            model[i] = Gaussian { mean: mean + rate * off, variance: if variance > least { variance } else { least } };
            is_foreground
        })
        .word();
    }
}

subtraction_pseudocode! {
    begin: "μ ← the initial background, σ ← initial-sigma",
    camera: "  shift the model by the median displacement of the camera, in whole px",
    exposure: "  correct the exposure of the frame to that of the background",
    compare: "  d ← |I − μ| / σ",
    decide: "  foreground if d > threshold",
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
                 on gray values",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "stage"],
        frames: 2,
    };
    const SHOWN: &'static str = "|I − μ| / σ";
    type Model = Grid<Gaussian>;

    fn settings(&self) -> Settings {
        self.settings
    }

    fn steadiness(&self) -> Option<Steadiness> {
        Some(self.steady)
    }

    fn moved(&self, model: &Self::Model, by: [f32; 2], frame: &Arc<Frame>) -> Self::Model {
        let begun = self.begin(frame);
        shifted(model, by, |x, y| begun[(x, y)])
    }

    fn displaced(&self, model: &Self::Model, frame: &Frame, mask: &Mask) -> Option<Mask> {
        displaced(mask, self.steady, |place, of| {
            let Gaussian { mean, variance } = model[of];
            let off = f32::from(frame.luma()[place]) - mean;
            off * off <= self.threshold * self.threshold * variance
        })
    }

    fn need(&self, clip: &Clip) -> Need {
        Need::per_pixel(clip, [9.0, 9.0])
    }

    fn initial(&self) -> Initial {
        self.initial
    }

    fn begin(&self, first: &Arc<Frame>) -> Grid<Gaussian> {
        let sigma = self.initial_sigma.max(self.min_sigma);
        first.luma().map(|gray| Gaussian { mean: f32::from(*gray), variance: sigma * sigma })
    }

    fn subtract(&self, model: &mut Grid<Gaussian>, frame: &Arc<Frame>, threads: &Threads) -> Found {
        let mask = by_rows(model, threads, |y, cells, words| decide(cells, frame.luma().row(y), words, self));
        Found { mask, shadows: None }
    }

    fn expected(&self, model: &Grid<Gaussian>, place: (usize, usize)) -> f32 {
        model[place].mean
    }

    fn accepted(&self, model: &Self::Model, place: (usize, usize)) -> Vec<Accepted> {
        let Gaussian { mean, variance } = model[place];
        let sigma = variance.sqrt();
        vec![Accepted { sigma: Some(sigma), ..Accepted::around(mean, self.threshold * sigma) }]
    }

    fn layers(&self, model: &Arc<Grid<Gaussian>>, _past: &Past) -> Vec<Layer> {
        let model = Arc::clone(model);
        vec![Layer::new(Quantity::Deviation, move || model.map(|of| of.variance.sqrt()))]
    }

    fn difference(&self, model: &Grid<Gaussian>, frame: &Frame, place: (usize, usize)) -> f32 {
        let Gaussian { mean, variance } = model[place];
        (f32::from(frame.luma()[place]) - mean).abs() / variance.sqrt()
    }

    fn explain(
        &self,
        [before, after]: [Option<&Grid<Gaussian>>; 2],
        frame: &Frame,
        place: (usize, usize),
    ) -> Explanation {
        let Some(before) = before else { return Explanation::default() };
        let Gaussian { mean, variance } = before[place];
        let value = f32::from(frame.luma()[place]);
        let (off, is_foreground) = (value - mean, (value - mean) * (value - mean) > self.threshold.powi(2) * variance);
        let role = if is_foreground { Role::Result } else { Role::Rejected };
        let distance = fixed(f64::from(off.abs() / variance.sqrt()), 2);
        let [mu, sigma, limit] = [mean, variance.sqrt(), self.threshold].map(gray);
        let shown = level(value);
        let mut facts = vec![
            Fact::new("Gray level", shown.clone(), Some(Role::Measured)),
            Fact::new("Mean μ", mu.clone(), Some(Role::Predicted)),
            Fact::new("Standard deviation σ", sigma.clone(), Some(Role::Predicted)),
            Fact::new("Distance", format!("{distance} σ"), Some(role)),
            Fact::new("Threshold", format!("{limit} σ"), None),
        ];
        let mut update = Sentence::default();
        if let Some(after) = after {
            let [new_mu, new_sigma] = [after[place].mean, after[place].variance.sqrt()].map(gray);
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
        let symbols = Math::Frac(
            Box::new(size(vec![Math::Var("I"), Math::text(" − "), Math::Var("μ")])),
            Box::new(Math::Var("σ")),
        );
        let numbers = Math::Frac(
            Box::new(size(vec![
                Math::ink(Role::Measured, shown.clone()),
                Math::text(" − "),
                Math::ink(Role::Predicted, mu.clone()),
            ])),
            Box::new(Math::ink(Role::Predicted, sigma.clone())),
        );
        let verdict = if is_foreground { " > " } else { " ≤ " };
        Explanation {
            facts,
            equation: vec![
                Math::Row(vec![symbols, Math::text(" > "), Math::Var("T")]),
                Math::Row(vec![
                    numbers,
                    Math::text(" = "),
                    Math::ink(role, distance.clone()),
                    Math::text(format!("{verdict}{limit}")),
                ]),
            ],
            matrices: Vec::new(),
            verdict: Sentence::default()
                .text(": gray level ")
                .ink(Role::Measured, shown)
                .text(", background ")
                .ink(Role::Predicted, format!("μ = {mu}, σ = {sigma}"))
                .text(". The distance ")
                .ink(role, format!("{distance} σ"))
                .text(match is_foreground {
                    true => format!(" exceeds the threshold {limit} σ: foreground."),
                    false => format!(" is within the threshold {limit} σ: background."),
                }),
            update,
        }
    }

    fn rule(&self) -> String {
        format!("|I − μ| / σ exceeds the threshold of {} σ", gray(self.threshold))
    }

    fn model_bytes(&self, model: &Grid<Gaussian>) -> usize {
        size_of_val(model.cells())
    }
}
