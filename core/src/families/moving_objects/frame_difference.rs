//! Frame difference: the background is what the frame before looked like.

use std::sync::Arc;

use crate::base::{Threads, wide::wide, words};
use crate::data::{Clip, Frame, Mask};
use crate::methods::subtraction::{Background, Explanation, Flags, Found, Settings, compared, subtraction_pseudocode};
use crate::run::{Info, Need};
use crate::scene::{Canvas, Fact, Math, Picture, Role};
use crate::{choices, params};

choices! {
    /// How many frames are looked at.
    pub enum Compared {
        /// The frame and the one before it: what has moved leaves its trace in the place that it has left.
        Two = "2" "2",
        /// The frame and both before it: what counts differs from each of them.
        Three = "3" "3",
    }
}

params! {
    /// Differences between frames that follow each other.
    pub struct FrameDifference {
        /// How many frames are looked at: the frame and one or two before it.
        compared: Compared = Compared::Two;
        /// A pixel that differs by more than this is foreground, in gray levels.
        threshold: usize = 8, 0..=255;
        /// What all background subtractions have.
        settings: Settings = Settings { open: 0, close: 4, ..Settings::default() };
    }
}

impl FrameDifference {
    /// The pixels that differ from each of `before`.
    pub fn differs(&self, before: &[Arc<Frame>], frame: &Frame, threads: &Threads) -> Mask {
        let (width, height) = frame.size();
        let mut mask = Mask::new(width, height);
        mask.write(|words, in_row| {
            threads.chunks(words, in_row, |y, words| {
                words.fill(u64::MAX);
                for earlier in before {
                    both([frame.luma().row(y), earlier.luma().row(y)], self.threshold as u8, words);
                }
            });
        });
        mask
    }
}

wide!(fn both(rows: [&[u8]; 2], threshold: u8, words: &mut [u64]) = both_differ);

/// Keeps the pixels that differ by more than `threshold`.
#[inline(always)]
fn both_differ([here, there]: [&[u8]; 2], threshold: u8, words: &mut [u64]) {
    for ((a, b), word) in here.chunks(64).zip(there.chunks(64)).zip(words) {
        *word &= Flags::of(a.len().min(b.len()), |i| a[i].abs_diff(b[i]) > threshold).word();
    }
}

subtraction_pseudocode! {
    begin: "the first frame is the one before the second",
    compare: "  d ← |I(t) − I(t−1)|, or the smaller one of that and |I(t) − I(t−2)|",
    decide: "  foreground if d > threshold",
    update: "  frame t is the one before the next",
}

impl Background for FrameDifference {
    const INFO: Info = Info {
        id: "frame-difference",
        name: "Frame difference",
        family: "Moving objects",
        summary: "Takes for moving what looks different from the frame before: no model, no memory, and only edges of what is uniform.",
        source: "R. Jain and H.-H. Nagel, On the analysis of accumulative difference pictures from image sequences of real world \
                 scenes, PAMI 1979; three frames: R. Collins et al., A system for video surveillance and monitoring, \
                 CMU-RI-TR-00-12, 2000",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "stage"],
        frames: 2,
    };
    const SHOWN: &'static str = "|I(t) − B|, B the frame before, of two the nearer one";
    /// The frames before, the last one first.
    type Model = Vec<Arc<Frame>>;

    fn settings(&self) -> Settings {
        self.settings
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
        model.truncate(if self.compared == Compared::Two { 1 } else { 2 });
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
        let before = if self.compared == Compared::Two { 1 } else { 2 };
        (-before..=0).map(Picture::at).any(|shown| shown == picture)
    }

    fn compared_with(&self, model: &Self::Model, frame: &Frame, place: (usize, usize)) -> f32 {
        // Of two frames before, the one that is nearer to the value decides.
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
        let mut explanation = compared(value, (nearest, "B"), self.threshold as f32);
        if let [last, earlier] = &before[..] {
            let [last, earlier] = [last, earlier].map(|frame| words::number(of(frame)));
            explanation.facts.push(Fact::new(
                "In the two frames before",
                format!("{last} and {earlier}"),
                Some(Role::Predicted),
            ));
            explanation.equation.insert(0, Math::text("B is what is nearer of both frames before"));
        }
        explanation
    }

    fn rule(&self) -> String {
        let which = if self.compared == Compared::Two { "the frame before" } else { "each of the two frames before" };
        format!("differ from {which} by more than {} gray levels", self.threshold)
    }

    fn update(&self) -> String {
        "This frame is what the next one is compared with".into()
    }

    fn model_bytes(&self, model: &Self::Model) -> usize {
        model.iter().map(|frame| frame.bytes()).sum()
    }
}
