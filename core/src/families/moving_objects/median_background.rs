//! Approximate median: the background goes one step towards each frame.

use std::sync::Arc;

use crate::base::{Threads, wide::wide, words};
use crate::data::{Clip, Frame};
use crate::geometry::Gray;
use crate::methods::subtraction::{
    Background, Explanation, Flags, Found, Initial, Settings, by_rows, compared, subtraction_pseudocode,
};
use crate::params;
use crate::run::{Info, Need};
use crate::scene::{Fact, Role};

params! {
    /// An approximate median of each pixel.
    pub struct MedianBackground {
        /// So far the background goes towards each frame, in gray levels: it comes to rest where half of the frames are brighter.
        step: usize = 1, 1..=16;
        /// A pixel that differs by more than this is foreground, in gray levels.
        threshold: usize = 25, 0..=255;
        /// Initial background.
        initial: Initial = Initial::FirstFrame;
        /// What all background subtractions have.
        settings: Settings = Settings::default();
    }
}

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
    compare: "  d ← |I − B|",
    decide: "  foreground if d > threshold",
    update: "  B ← B + step where I > B, B − step where I < B, but not beyond I",
}

impl Background for MedianBackground {
    const INFO: Info = Info {
        id: "median-background",
        name: "Median background",
        family: "Moving objects",
        summary: "Moves each pixel of the background a step towards each frame, so that it comes to the median: what passes quickly leaves no trace.",
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

    fn difference(&self, model: &Gray, frame: &Frame, place: (usize, usize)) -> f32 {
        f32::from(frame.luma()[place].abs_diff(model[place]))
    }

    fn explain(&self, [before, after]: [Option<&Gray>; 2], frame: &Frame, place: (usize, usize)) -> Explanation {
        let Some(before) = before else { return Explanation::default() };
        let value = f32::from(frame.luma()[place]);
        let mut explanation = compared(value, (f32::from(before[place]), "B"), self.threshold as f32);
        let now =
            after.map(|model| Fact::new("Background now", words::number(model[place].into()), Some(Role::Estimate)));
        explanation.facts.extend(now);
        explanation
    }

    fn rule(&self) -> String {
        format!("differ from the median by more than {} gray levels", self.threshold)
    }

    fn update(&self) -> String {
        let levels = if self.step == 1 { "a gray level".into() } else { format!("{} gray levels", self.step) };
        format!("The background goes {levels} towards this frame, wherever it differs")
    }

    fn model_bytes(&self, model: &Gray) -> usize {
        model.cells().len()
    }
}
