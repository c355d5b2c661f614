//! Running average: the background is a mean in which the past fades.

use std::sync::Arc;

use crate::base::{Threads, wide::wide, words};
use crate::data::{Clip, Frame};
use crate::geometry::Grid;
use crate::methods::subtraction::{
    Background, Explanation, Flags, Found, Initial, Settings, by_rows, compared, subtraction_pseudocode,
};
use crate::params;
use crate::run::{Info, Need};
use crate::scene::{Fact, Role};

params! {
    /// A running average of each pixel.
    pub struct RunningAverage {
        /// How much a frame counts in the background: the larger, the sooner what stands still belongs to it.
        rate: f32 = 0.02, 0.0..=1.0;
        /// A pixel that differs by more than this is foreground, in gray levels.
        threshold: f32 = 25.0, 0.0..=255.0;
        /// Take only what looks like the background into it: objects leave no trail, but what has changed for good never belongs to it.
        selective: bool = false;
        /// Initial background.
        initial: Initial = Initial::FirstFrame;
        /// What all background subtractions have.
        settings: Settings = Settings::default();
    }
}

wide!(fn decide(model: &mut [f32], row: &[u8], words: &mut [u64], average: &RunningAverage) = decide_row);

#[inline(always)]
fn decide_row(model: &mut [f32], row: &[u8], words: &mut [u64], average: &RunningAverage) {
    let (rate, threshold) = (average.rate, average.threshold);
    let rate_in_front = if average.selective { 0.0 } else { rate };
    for ((model, row), word) in model.chunks_mut(64).zip(row.chunks(64)).zip(words) {
        *word = Flags::of(model.len().min(row.len()), |i| {
            let difference = f32::from(row[i]) - model[i];
            let is_foreground = difference.abs() > threshold;
            model[i] += if is_foreground { rate_in_front } else { rate } * difference;
            is_foreground
        })
        .word();
    }
}

subtraction_pseudocode! {
    begin: "B ← the initial background",
    compare: "  d ← |I − B|",
    decide: "  foreground if d > threshold",
    update: "  B ← (1 − rate) B + rate · I; if selective, in the background only",
}

impl Background for RunningAverage {
    const INFO: Info = Info {
        id: "running-average",
        name: "Running average",
        family: "Moving objects",
        summary: "Keeps a mean of each pixel in which the past fades, and takes for moving what differs from it.",
        source: "J. Heikkilä and O. Silvén, A real-time system for monitoring of cyclists and pedestrians, VS 1999; selective: \
                 D. Koller et al., Towards robust automatic traffic scene analysis in real-time, ICPR 1994",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "stage"],
        frames: 2,
    };
    const SHOWN: &'static str = "|I − B|";
    type Model = Grid<f32>;

    fn settings(&self) -> Settings {
        self.settings
    }

    fn need(&self, clip: &Clip) -> Need {
        Need::per_pixel(clip, [6.0, 6.0])
    }

    fn initial(&self) -> Initial {
        self.initial
    }

    fn begin(&self, first: &Arc<Frame>) -> Grid<f32> {
        first.luma().map(|gray| f32::from(*gray))
    }

    fn subtract(&self, model: &mut Grid<f32>, frame: &Arc<Frame>, threads: &Threads) -> Found {
        let mask = by_rows(model, threads, |y, cells, words| decide(cells, frame.luma().row(y), words, self));
        Found { mask, shadows: None }
    }

    fn expected(&self, model: &Grid<f32>, place: (usize, usize)) -> f32 {
        model[place]
    }

    fn difference(&self, model: &Grid<f32>, frame: &Frame, place: (usize, usize)) -> f32 {
        (f32::from(frame.luma()[place]) - model[place]).abs()
    }

    fn explain(&self, [before, after]: [Option<&Grid<f32>>; 2], frame: &Frame, place: (usize, usize)) -> Explanation {
        let Some(before) = before else { return Explanation::default() };
        let value = f32::from(frame.luma()[place]);
        let mut explanation = compared(value, (before[place], "B"), self.threshold);
        let now = after.map(|model| Fact::new("Background now", words::number(model[place]), Some(Role::Estimate)));
        explanation.facts.extend(now);
        explanation
    }

    fn rule(&self) -> String {
        format!("differ from the mean by more than {} gray levels", self.threshold)
    }

    fn update(&self) -> String {
        let share = words::number(100.0 * self.rate);
        let only = if self.selective { ", where it looks like it" } else { "" };
        format!("The background moves {share} % of the way to this frame{only}")
    }

    fn model_bytes(&self, model: &Grid<f32>) -> usize {
        size_of_val(model.cells())
    }
}
