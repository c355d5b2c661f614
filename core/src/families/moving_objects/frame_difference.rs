//! Frame differencing: the previous frame is the background.

use std::sync::Arc;

use crate::base::{Threads, wide::wide};
use crate::data::{Clip, Frame, Mask};
use crate::methods::numbers::{level, ratio};
use crate::methods::subtraction::{
    Background, Differencing, Expected, Explanation, Flags, Found, NOISE_SIGMAS, Settings, Steadiness,
    automatic_threshold, compared, displaced, noise_of, resampled, subtraction_pseudocode,
};
use crate::params;
use crate::run::{Info, Need};
use crate::scene::{Canvas, Fact, Math, Picture, Role, Sentence};

params! {
    /// Frame differencing: thresholded differences of consecutive frames.
    pub struct FrameDifference {
        /// Number of frames that are compared: two-frame or three-frame differencing.
        differencing: Differencing = Differencing::Two;
        /// Difference threshold in gray levels. Pixels with a larger difference are foreground. 0 chooses 4 standard deviations of the
        /// noise, which the median absolute difference of the two frames gives (1.4826 times the median), and at least 8.
        threshold: usize = 0, 0..=255;
        /// The treatment of a camera that is not quite at rest.
        steady: Steadiness = Steadiness { shake: 0, ..Steadiness::default() };
        /// The parameters of all background subtractions.
        settings: Settings = Settings { opening: 0, closing: 4, ..Settings::default() };
    }
    renamed { "compared" => "differencing", "open" => "opening", "close" => "closing" }
}

impl FrameDifference {
    /// Returns the threshold for a frame in gray levels.
    fn limit(&self, before: &[Arc<Frame>], frame: &Frame) -> u8 {
        if self.threshold > 0 {
            return self.threshold as u8;
        }
        let noise = before.first().map_or(0.0, |before| {
            let both = frame.luma().cells().iter().zip(before.luma().cells());
            noise_of(both.map(|(now, before)| now.abs_diff(*before)))
        });
        automatic_threshold(noise)
    }

    /// Returns the pixels that differ from each frame of `before` by more than the threshold.
    pub fn differs(&self, before: &[Arc<Frame>], frame: &Frame, threads: &Threads) -> Mask {
        let ((width, height), threshold) = (frame.size(), self.limit(before, frame));
        let mut mask = Mask::new(width, height);
        mask.write(|words, in_row| {
            threads.chunks(words, in_row, |y, words| {
                words.fill(u64::MAX);
                for earlier in before {
                    both([frame.luma().row(y), earlier.luma().row(y)], threshold, words);
                }
            });
        });
        mask
    }
}

wide!(fn both(rows: [&[u8]; 2], threshold: u8, words: &mut [u64]) = both_differ);

/// Keeps the pixels of `words` whose rows differ by more than `threshold`.
#[inline(always)]
fn both_differ([here, there]: [&[u8]; 2], threshold: u8, words: &mut [u64]) {
    for ((a, b), word) in here.chunks(64).zip(there.chunks(64)).zip(words) {
        *word &= Flags::of(a.len().min(b.len()), |i| a[i].abs_diff(b[i]) > threshold).word();
    }
}

subtraction_pseudocode! {
    begin: "B ← frame 0",
    camera: "  shift B by the median displacement of the camera",
    exposure: "  correct the exposure of the frame to that of the background",
    compare: "  d ← |I(t) − I(t−1)|; with three frames min(|I(t) − I(t−1)|, |I(t) − I(t−2)|)",
    decide: "  foreground if d > threshold",
    shake: "  suppress pixels that fit the background of a pixel within shake",
    update: "  frame t becomes the reference of frame t+1",
}

impl Background for FrameDifference {
    const INFO: Info = Info {
        id: "frame-difference",
        name: "Frame difference",
        family: "Moving objects",
        summary: "Thresholds the difference of consecutive frames. Needs no model, but finds only the edges of uniform objects and leaves ghosts behind them.",
        source: "R. Jain and H.-H. Nagel, On the analysis of accumulative difference pictures from image sequences of real world \
                 scenes, PAMI 1979; three frames: R. Collins et al., A system for video surveillance and monitoring, \
                 CMU-RI-TR-00-12, 2000",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "stage"],
        frames: 2,
    };
    const SHOWN: &'static str = "|I(t) − B|; B is the previous frame, or the more similar of the two previous frames";
    const IS_REPLACED: bool = true;
    /// The previous frames, the latest one first.
    type Model = Vec<Arc<Frame>>;

    fn settings(&self) -> Settings {
        self.settings
    }

    fn steadiness(&self) -> Option<Steadiness> {
        Some(self.steady)
    }

    fn moved(&self, model: &Self::Model, by: [f32; 2], frame: &Arc<Frame>) -> Self::Model {
        model.iter().map(|earlier| Arc::new(resampled(earlier, by, frame))).collect()
    }

    fn displaced(&self, model: &Self::Model, frame: &Frame, mask: &Mask) -> Option<Mask> {
        let threshold = self.limit(model, frame);
        let is_near = |earlier: &Arc<Frame>, place, of| frame.luma()[place].abs_diff(earlier.luma()[of]) <= threshold;
        displaced(mask, self.steady, |place, of| model.iter().any(|earlier| is_near(earlier, place, of)))
    }

    fn need(&self, clip: &Clip) -> Need {
        Need::per_pixel(clip, [1.0, 1.0])
    }

    fn begin(&self, first: &Arc<Frame>) -> Self::Model {
        vec![Arc::clone(first)]
    }

    fn subtract(&self, model: &mut Self::Model, frame: &Arc<Frame>, threads: &Threads) -> Found {
        let mask = self.differs(model, frame, threads);
        model.insert(0, Arc::clone(frame));
        model.truncate(if self.differencing == Differencing::Two { 1 } else { 2 });
        Found { mask, shadows: None }
    }

    fn expected(&self, model: &Self::Model, place: (usize, usize)) -> f32 {
        f32::from(model[0].luma()[place])
    }

    fn pictures(&self, model: &Arc<Self::Model>, _size: (usize, usize)) -> Vec<Canvas> {
        let before = (1..=model.len() as i32).rev().map(|frames| Picture::at(-frames));
        before.chain([Picture::CURRENT]).map(Canvas::of_clip).collect()
    }

    fn explains(&self, picture: Picture) -> bool {
        let before = if self.differencing == Differencing::Two { 1 } else { 2 };
        (-before..=0).map(Picture::at).any(|shown| shown == picture)
    }

    fn compared_with(&self, model: &Self::Model, frame: &Frame, place: (usize, usize)) -> f32 {
        // Of two previous frames the more similar one decides.
        let value = f32::from(frame.luma()[place]);
        let before = model.iter().map(|earlier| f32::from(earlier.luma()[place]));
        before.reduce(|a, b| if (b - value).abs() < (a - value).abs() { b } else { a }).unwrap_or(value)
    }

    fn difference(&self, model: &Self::Model, frame: &Frame, place: (usize, usize)) -> f32 {
        (f32::from(frame.luma()[place]) - self.compared_with(model, frame, place)).abs()
    }

    fn explain(&self, [before, _]: [Option<&Self::Model>; 2], frame: &Frame, place: (usize, usize)) -> Explanation {
        let Some(before) = before else { return Explanation::default() };
        let value = f32::from(frame.luma()[place]);
        let of = |earlier: &Arc<Frame>| f32::from(earlier.luma()[place]);
        let nearest = self.compared_with(before, frame, place);
        let mut explanation = compared(
            value,
            Expected { value: nearest, symbol: "B", is_whole: true },
            f32::from(self.limit(before, frame)),
        );
        if let [last, earlier] = &before[..] {
            let [last, earlier] = [last, earlier].map(|frame| level(of(frame)));
            explanation.facts.push(Fact::new(
                "Frames t−1 and t−2",
                format!("{last} and {earlier}"),
                Some(Role::Predicted),
            ));
            explanation.equation.insert(0, Math::text("B = the more similar of I(t−1) and I(t−2)"));
        }
        explanation.update = Sentence::default()
            .text(format!("the next frame is compared with gray level {} of this one", level(value)))
            .text(format!(", this one was compared with {}.", level(of(&before[0]))));
        explanation
    }

    fn rule(&self) -> String {
        let which = if self.differencing == Differencing::Two { "the previous frame" } else { "both previous frames" };
        match self.threshold {
            0 => format!(
                "the difference from {which} exceeds {} standard deviations of the noise, at least 8 gray levels",
                ratio(f64::from(NOISE_SIGMAS))
            ),
            threshold => format!("the difference from {which} exceeds the threshold of {threshold} gray levels"),
        }
    }

    fn model_bytes(&self, model: &Self::Model) -> usize {
        model.iter().map(|frame| frame.bytes()).sum()
    }
}
