//! Running average: the background is an exponentially weighted mean.

use std::sync::Arc;

use crate::base::{Threads, wide::wide};
use crate::data::{Clip, Frame, Mask};
use crate::geometry::Grid;
use crate::methods::numbers::{gray, level, ratio};
use crate::methods::subtraction::{
    Accepted, Background, Expected, Explanation, Flags, Found, Initial, Settings, Steadiness, by_rows, compared,
    displaced, shifted, subtraction_pseudocode,
};
use crate::params;
use crate::run::{Info, Need};
use crate::scene::{Fact, Role, Sentence};

params! {
    /// Running average of each pixel.
    pub struct RunningAverage {
        /// Learning rate α, about 1 / history in frames. Higher values absorb stopped objects and ghosts sooner, but leave trails behind slow ones.
        learning_rate: f32 = 0.02, 0.0..=1.0;
        /// Difference threshold in gray levels. Pixels with a larger |I − B| are foreground.
        threshold: f32 = 25.0, 0.0..=255.0;
        /// Selective update: only background pixels update the model. Objects leave no trail, but ghosts and stopped objects stay foreground permanently.
        selective: bool = false;
        /// Initial background: the first frame, or the median of the run, which uses later frames (non-causal).
        initial: Initial = Initial::Median;
        /// The treatment of a camera that is not quite at rest.
        steady: Steadiness = Steadiness::default();
        /// The parameters of all background subtractions.
        settings: Settings = Settings::default();
    }
    renamed { "rate" => "learning-rate", "open" => "opening", "close" => "closing" }
}

wide!(fn decide(model: &mut [f32], row: &[u8], words: &mut [u64], average: &RunningAverage) = decide_row);

#[inline(always)]
fn decide_row(model: &mut [f32], row: &[u8], words: &mut [u64], average: &RunningAverage) {
    let (rate, threshold) = (average.learning_rate, average.threshold);
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
    camera: "  shift the model by the median displacement of the camera, in whole px",
    exposure: "  correct the exposure of the frame to that of the background",
    compare: "  d ← |I − B|",
    decide: "  foreground if d > threshold",
    shake: "  suppress pixels that fit the background of a pixel within shake",
    update: "  B ← (1 − α) B + α I with learning-rate α; if selective, at background pixels only",
}

impl Background for RunningAverage {
    const INFO: Info = Info {
        id: "running-average",
        name: "Running average",
        family: "Moving objects",
        summary: "Models the background as an exponentially weighted mean of each pixel and thresholds the difference from it.",
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

    fn steadiness(&self) -> Option<Steadiness> {
        Some(self.steady)
    }

    fn moved(&self, model: &Self::Model, by: [f32; 2], frame: &Arc<Frame>) -> Self::Model {
        shifted(model, by, |x, y| f32::from(frame.luma()[(x, y)]))
    }

    fn displaced(&self, model: &Self::Model, frame: &Frame, mask: &Mask) -> Option<Mask> {
        let fits = |place, of| (f32::from(frame.luma()[place]) - model[of]).abs() <= self.threshold;
        displaced(mask, self.steady, fits)
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

    fn accepted(&self, model: &Self::Model, place: (usize, usize)) -> Vec<Accepted> {
        vec![Accepted::around(model[place], self.threshold)]
    }

    fn difference(&self, model: &Grid<f32>, frame: &Frame, place: (usize, usize)) -> f32 {
        (f32::from(frame.luma()[place]) - model[place]).abs()
    }

    fn explain(&self, [before, after]: [Option<&Grid<f32>>; 2], frame: &Frame, place: (usize, usize)) -> Explanation {
        let Some(before) = before else { return Explanation::default() };
        let value = f32::from(frame.luma()[place]);
        let mut explanation =
            compared(value, Expected { value: before[place], symbol: "B", is_whole: false }, self.threshold);
        if let Some(after) = after {
            let [old, new] = [before[place], after[place]].map(gray);
            let is_frozen = self.selective && (value - before[place]).abs() > self.threshold;
            explanation.facts.push(Fact::new("Background after update", new.clone(), Some(Role::Estimate)));
            explanation.update = match is_frozen {
                true => Sentence::default().text(format!("foreground, and the update is selective, so B stays {old}.")),
                false => Sentence::default()
                    .text("B moves from ")
                    .ink(Role::Predicted, old)
                    .text(" to ")
                    .ink(Role::Estimate, new)
                    .text(format!(
                        " toward the gray level {}; the learning rate is α = {}.",
                        level(value),
                        ratio(self.learning_rate.into())
                    )),
            };
        }
        explanation
    }

    fn rule(&self) -> String {
        format!("|I − B| exceeds the threshold of {} gray levels", gray(self.threshold))
    }

    fn model_bytes(&self, model: &Grid<f32>) -> usize {
        size_of_val(model.cells())
    }
}
