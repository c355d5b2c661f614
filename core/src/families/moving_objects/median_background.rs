//! Approximate median: the background moves one step toward each frame.

use std::sync::Arc;

use crate::base::{Threads, wide::wide, words};
use crate::data::{Clip, Frame, Mask};
use crate::geometry::{Gray, Grid};
use crate::methods::numbers::level;
use crate::methods::subtraction::{
    Accepted, Background, Expected, Explanation, Flags, Found, Initial, Past, Settings, Steadiness, by_rows, compared,
    displaced, shifted, subtraction_pseudocode,
};
use crate::params;
use crate::run::{Info, Need};
use crate::scene::{Fact, Layer, Quantity, Role, Sentence};

params! {
    /// Approximate median of each pixel.
    pub struct MedianBackground {
        /// Step of the background toward each frame in gray levels. The background converges to the median: half of the frames are
        /// brighter, half darker.
        step: usize = 1, 1..=16;
        /// Difference threshold in gray levels. Pixels with a larger |I − B| are foreground.
        threshold: usize = 25, 0..=255;
        /// Initial background: the first frame, or the median of the run, which uses later frames (non-causal).
        initial: Initial = Initial::Median;
        /// The treatment of a camera that is not quite at rest.
        steady: Steadiness = Steadiness::default();
        /// The parameters of all background subtractions.
        settings: Settings = Settings::default();
    }
    renamed { "open" => "opening", "close" => "closing" }
}

/// The number of frames of the median that the approximate one is compared with.
const MEDIAN_FRAMES: usize = 25;

wide!(fn decide(model: &mut [u8], row: &[u8], words: &mut [u64], median: &MedianBackground) = decide_row);

#[inline(always)]
fn decide_row(model: &mut [u8], row: &[u8], words: &mut [u64], median: &MedianBackground) {
    let (step, threshold) = (median.step as u8, median.threshold as u8);
    for ((model, row), word) in model.chunks_mut(64).zip(row.chunks(64)).zip(words) {
        *word = Flags::of(model.len().min(row.len()), |i| {
            let (old, new) = (model[i], row[i]);
            let up = new.saturating_sub(old).min(step);
            let down = old.saturating_sub(new).min(step);
            model[i] = old + up - down;
            old.abs_diff(new) > threshold
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
    update: "  B ← B + step where I > B, B − step where I < B, at most to I",
}

impl Background for MedianBackground {
    const INFO: Info = Info {
        id: "median-background",
        name: "Median background",
        family: "Moving objects",
        summary: "Moves the background by a fixed step per frame toward the current frame, so that it converges to the median. Fast objects leave no trail.",
        source: "N. J. B. McFarlane and C. P. Schofield, Segmentation and tracking of piglets in images, Machine Vision and \
                 Applications 8, 1995; the median itself: R. Cucchiara, C. Grana, M. Piccardi and A. Prati, Detecting moving \
                 objects, ghosts, and shadows in video streams, PAMI 2003",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "stage"],
        frames: 2,
    };
    const SHOWN: &'static str = "|I − B|";
    type Model = Gray;

    fn settings(&self) -> Settings {
        self.settings
    }

    fn steadiness(&self) -> Option<Steadiness> {
        Some(self.steady)
    }

    fn moved(&self, model: &Self::Model, by: [f32; 2], frame: &Arc<Frame>) -> Self::Model {
        shifted(model, by, |x, y| frame.luma()[(x, y)])
    }

    fn displaced(&self, model: &Self::Model, frame: &Frame, mask: &Mask) -> Option<Mask> {
        let fits = |place, of| usize::from(frame.luma()[place].abs_diff(model[of])) <= self.threshold;
        displaced(mask, self.steady, fits)
    }

    fn need(&self, clip: &Clip) -> Need {
        Need::per_pixel(clip, [2.0, 2.0])
    }

    fn initial(&self) -> Initial {
        self.initial
    }

    fn begin(&self, first: &Arc<Frame>) -> Gray {
        first.luma().clone()
    }

    fn subtract(&self, model: &mut Gray, frame: &Arc<Frame>, threads: &Threads) -> Found {
        let mask = by_rows(model, threads, |y, cells, words| decide(cells, frame.luma().row(y), words, self));
        Found { mask, shadows: None }
    }

    fn expected(&self, model: &Gray, place: (usize, usize)) -> f32 {
        f32::from(model[place])
    }

    fn layers(&self, model: &Arc<Gray>, past: &Past) -> Vec<Layer> {
        let (model, past) = (Arc::clone(model), past.clone());
        vec![Layer::new(Quantity::OffMedian, move || match past.median(MEDIAN_FRAMES) {
            Ok(median) => {
                let (width, height) = model.size();
                Grid::from_fn(width, height, |x, y| (f32::from(model[(x, y)]) - median[(x, y)]).abs())
            }
            Err(_) => model.map(|_| f32::NAN),
        })]
    }

    fn accepted(&self, model: &Self::Model, place: (usize, usize)) -> Vec<Accepted> {
        vec![Accepted::around(model[place].into(), self.threshold as f32)]
    }

    fn difference(&self, model: &Gray, frame: &Frame, place: (usize, usize)) -> f32 {
        f32::from(frame.luma()[place].abs_diff(model[place]))
    }

    fn explain(&self, [before, after]: [Option<&Gray>; 2], frame: &Frame, place: (usize, usize)) -> Explanation {
        let Some(before) = before else { return Explanation::default() };
        let value = f32::from(frame.luma()[place]);
        let mut explanation = compared(
            value,
            Expected { value: f32::from(before[place]), symbol: "B", is_whole: true },
            self.threshold as f32,
        );
        if let Some(after) = after {
            let [old, new] = [before[place], after[place]].map(|value| level(value.into()));
            explanation.facts.push(Fact::new("Background after update", new.clone(), Some(Role::Estimate)));
            explanation.update = Sentence::default()
                .text("B moves from ")
                .ink(Role::Predicted, old)
                .text(" to ")
                .ink(Role::Estimate, new)
                .text(format!(
                    " toward the gray level {}, by a step of at most {}.",
                    level(value),
                    words::counted(self.step, "gray level")
                ));
        }
        explanation
    }

    fn rule(&self) -> String {
        format!("|I − B| exceeds the threshold of {} gray levels", self.threshold)
    }

    fn model_bytes(&self, model: &Gray) -> usize {
        model.cells().len()
    }
}
