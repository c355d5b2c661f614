//! Single Gaussian: the background is a mean and how far a pixel strays from it.

use std::sync::Arc;

use crate::base::{Threads, wide::wide, words};
use crate::data::{Clip, Frame};
use crate::geometry::Grid;
use crate::methods::subtraction::{
    Background, Explanation, Flags, Found, Initial, Settings, by_rows, subtraction_pseudocode,
};
use crate::params;
use crate::run::{Info, Need};
use crate::scene::{Fact, Math, Role, Sentence};

params! {
    /// A normal distribution for each pixel.
    pub struct SingleGaussian {
        /// How much a frame counts in mean and variance: the larger, the sooner the background follows a change.
        rate: f32 = 0.02, 0.0..=1.0;
        /// A pixel farther from the mean than so many standard deviations is foreground.
        threshold: f32 = 4.0, 0.0..=20.0, "σ";
        /// Standard deviation of each pixel to begin with, in gray levels.
        first_sigma: f32 = 6.0, 0.5..=50.0;
        /// No standard deviation becomes less than this, in gray levels: what looks the same for long may still flicker a little.
        min_sigma: f32 = 2.0, 0.5..=50.0;
        /// Take only what looks like the background into it: objects do not widen it, but what has changed for good never belongs to it.
        selective: bool = true;
        /// Initial background.
        initial: Initial = Initial::FirstFrame;
        /// What all background subtractions have.
        settings: Settings = Settings::default();
    }
    advanced { "first-sigma", "min-sigma" }
}

/// What is known of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    /// The mean of its gray values.
    pub mean: f32,
    /// Their variance.
    pub variance: f32,
}

wide!(fn decide(model: &mut [Gaussian], row: &[u8], words: &mut [u64], of: &SingleGaussian) = decide_row);

#[inline(always)]
fn decide_row(model: &mut [Gaussian], row: &[u8], words: &mut [u64], of: &SingleGaussian) {
    let limit = of.threshold * of.threshold;
    let least = of.min_sigma * of.min_sigma;
    let rate_in_front = if of.selective { 0.0 } else { of.rate };
    for ((model, row), word) in model.chunks_mut(64).zip(row.chunks(64)).zip(words) {
        *word = Flags::of(model.len().min(row.len()), |i| {
            let Gaussian { mean, variance } = model[i];
            let off = f32::from(row[i]) - mean;
            let is_foreground = off * off > limit * variance;
            let rate = if is_foreground { rate_in_front } else { of.rate };
            let variance = variance + rate * (off * off - variance);
            model[i] = Gaussian { mean: mean + rate * off, variance: if variance > least { variance } else { least } };
            is_foreground
        })
        .word();
    }
}

subtraction_pseudocode! {
    begin: "μ ← the initial background, σ ← first-sigma",
    compare: "  d ← |I − μ| / σ",
    decide: "  foreground if d > threshold",
    update: "  μ ← μ + rate (I − μ), σ² ← σ² + rate ((I − μ)² − σ²); if selective, in the background only",
}

impl Background for SingleGaussian {
    const INFO: Info = Info {
        id: "single-gaussian",
        name: "Single Gaussian",
        family: "Moving objects",
        summary: "Learns how far each pixel strays from its mean, so that water may flicker and a wall may not.",
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

    fn need(&self, clip: &Clip) -> Need {
        Need::per_pixel(clip, [9.0, 9.0])
    }

    fn initial(&self) -> Initial {
        self.initial
    }

    fn begin(&self, first: &Arc<Frame>) -> Grid<Gaussian> {
        let sigma = self.first_sigma.max(self.min_sigma);
        first.luma().map(|gray| Gaussian { mean: f32::from(*gray), variance: sigma * sigma })
    }

    fn subtract(&self, model: &mut Grid<Gaussian>, frame: &Arc<Frame>, threads: &Threads) -> Found {
        let mask = by_rows(model, threads, |y, cells, words| decide(cells, frame.luma().row(y), words, self));
        Found { mask, shadows: None }
    }

    fn expected(&self, model: &Grid<Gaussian>, place: (usize, usize)) -> f32 {
        model[place].mean
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
        let distance = words::number(off.abs() / variance.sqrt());
        let [shown, mu, sigma, limit] = [value, mean, variance.sqrt(), self.threshold].map(words::number);
        let mut facts = vec![
            Fact::new("Gray", shown.clone(), Some(Role::Measured)),
            Fact::new("Mean μ", mu.clone(), Some(Role::Predicted)),
            Fact::new("Standard deviation σ", sigma.clone(), Some(Role::Predicted)),
            Fact::new("Distance", format!("{distance} σ"), Some(role)),
            Fact::new("Threshold", format!("{limit} σ"), None),
        ];
        facts.extend(after.map(|model| {
            let Gaussian { mean, variance } = model[place];
            let now = format!("{} ± {}", words::number(mean), words::number(variance.sqrt()));
            Fact::new("Background now", now, Some(Role::Estimate))
        }));
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
                .text(" is ")
                .ink(Role::Measured, shown)
                .text(" where ")
                .ink(Role::Predicted, format!("{mu} ± {sigma}"))
                .text(" is expected: ")
                .ink(role, format!("{distance} standard deviations"))
                .text(match is_foreground {
                    true => format!(" off, more than {limit}: foreground."),
                    false => format!(" off, not more than {limit}: background."),
                }),
        }
    }

    fn rule(&self) -> String {
        format!("are more than {} standard deviations from their mean", self.threshold)
    }

    fn update(&self) -> String {
        let share = words::number(100.0 * self.rate);
        let only = if self.selective { ", where it looks like them" } else { "" };
        format!("Means and variances move {share} % of the way to this frame{only}")
    }

    fn model_bytes(&self, model: &Grid<Gaussian>) -> usize {
        size_of_val(model.cells())
    }
}
