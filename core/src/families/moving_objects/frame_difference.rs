//! Frame differencing: the previous frame is the background.

use std::sync::Arc;

use crate::base::{Threads, wide::wide};
use crate::data::{Clip, Frame, Mask};
use crate::methods::subtraction::{
    self, Background, Cases, Channel, Channels, Comparison, Differencing, Explanation, Flags, Found, Probe, Row,
    Settings, Setup, Steadiness, automatic_threshold, difference_rule, displaced, largest, levels, noise_of, resampled,
    subtraction_pseudocode, tuple,
};
use crate::run::{Info, Need};
use crate::scene::{Canvas, Picture, Role, Step, Unit};
use crate::{cases, params, variables};

params! {
    /// Frame differencing: thresholded differences of consecutive frames.
    pub struct FrameDifference {
        /// Number of frames that are compared: two-frame or three-frame differencing.
        differencing: Differencing = Differencing::Two;
        /// The channels that are compared.
        channels: Channels = Channels::Color;
        /// Difference threshold in gray levels. Pixels with a larger difference, in colour in any channel, are foreground. 0 chooses 4
        /// standard deviations of the noise, which the median absolute difference of the two frames gives (1.4826 times the median), and
        /// at least 8.
        threshold: usize = 0, 0..=255;
        /// The treatment of a camera that is not quite at rest.
        steady: Steadiness = Steadiness { shake: 0, ..Steadiness::default() };
        /// The parameters of all background subtractions.
        settings: Settings = Settings { opening: 0, area_opening: 9, closing: 4, ..Settings::default() };
    }
}

/// The levels of a frame in all of its channels.
fn values(frame: &Frame, channels: usize) -> &[u8] {
    frame.color().filter(|_| channels == 3).map_or(frame.luma().cells(), |color| color.cells().as_flattened())
}

impl FrameDifference {
    /// Returns the number of channels that are compared.
    fn count(&self, before: &[Arc<Frame>], frame: &Frame) -> usize {
        before.iter().map(|earlier| self.channels.count(earlier)).fold(self.channels.count(frame), usize::min)
    }

    /// Returns the threshold for a frame in gray levels.
    fn limit(&self, before: &[Arc<Frame>], frame: &Frame) -> u8 {
        if self.threshold > 0 {
            return self.threshold as u8;
        }
        let channels = self.count(before, frame);
        let noise = before.first().map_or(0.0, |before| {
            let both = values(frame, channels).iter().zip(values(before, channels));
            noise_of(both.map(|(now, before)| now.abs_diff(*before)))
        });
        automatic_threshold(noise)
    }

    /// Returns the pixels that differ from each frame of `before` by more than the threshold.
    pub fn differs(&self, before: &[Arc<Frame>], frame: &Frame, threads: &Threads) -> Mask {
        let ((width, height), threshold) = (frame.size(), self.limit(before, frame));
        let (mut mask, channels) = (Mask::new(width, height), self.count(before, frame));
        mask.write(|words, in_row| {
            threads.chunks(words, in_row, |y, words| {
                words.fill(u64::MAX);
                for earlier in before {
                    both([frame, &**earlier].map(|frame| Row::of(frame, y, channels)), threshold, words);
                }
            });
        });
        mask
    }

    /// Returns the previous frame that a pixel differs least from, which decides; the channel in which it differs from it most, and by how
    /// much. The largest difference of a pixel from each frame counts.
    fn nearest<'a>(
        &self,
        before: &'a [Arc<Frame>],
        frame: &Frame,
        place: (usize, usize),
    ) -> Option<(&'a Frame, (Channel, f32))> {
        let channels = self.count(before, frame);
        let value = levels(frame, place, channels);
        let off = |earlier: &Frame| {
            let before = levels(earlier, place, channels);
            largest(&[0, 1, 2].map(|c| f32::from(value[c].abs_diff(before[c])))[..channels])
        };
        let all = before.iter().map(|earlier| (&**earlier, off(earlier)));
        all.reduce(|a, b| if b.1.1 < a.1.1 { b } else { a })
    }
}

wide!(fn both(rows: [Row<'_>; 2], threshold: u8, words: &mut [u64]) = both_differ);

/// Keeps the pixels of `words` whose rows differ by more than `threshold` in any channel.
#[inline(always)]
fn both_differ(rows: [Row<'_>; 2], threshold: u8, words: &mut [u64]) {
    for (index, word) in words.iter_mut().enumerate() {
        let mut flags = Flags([0; 64]);
        for c in 0..rows[0].channels() {
            let [here, there] = rows.map(|row| row.block(c, 64 * index));
            for ((flag, a), b) in flags.0.iter_mut().zip(here).zip(there) {
                *flag |= u8::from(differs(a, b, threshold));
            }
        }
        *word &= flags.word();
    }
}

/// Whether two levels differ by more than the threshold.
#[inline(always)]
fn differs(a: u8, b: u8, threshold: u8) -> bool {
    a.abs_diff(b) > threshold
}

/// Whether a pixel of a frame differs in no channel from a pixel of another one.
fn is_near(frames: [&Frame; 2], places: [(usize, usize); 2], (channels, threshold): (usize, u8)) -> bool {
    let [a, b] = [0, 1].map(|i| levels(frames[i], places[i], channels));
    !(0..channels).any(|c| differs(a[c], b[c], threshold))
}

variables! {
    /// The level or colour of the pixel in the previous frame.
    FRAME_BEFORE: "Frame t−1", "I(t-1)", Unit::WHOLE, Role::Predicted;
    /// The level or colour of the pixel in the frame before that.
    FRAME_EARLIER: "Frame t−2", "I(t-2)", Unit::WHOLE, Role::Predicted;
}

cases! { over value, subtraction::value;
    FROM_PREVIOUS: "the difference from the previous frame",
    FROM_BOTH: "the difference from both previous frames",
    REPLACES_LEVEL: "this frame, with gray level {gray_level}, becomes the reference of the next in place of the frame with \
                     {frame_before}.",
    REPLACES_COLOUR: "this frame, with colour {colour}, becomes the reference of the next in place of the frame with \
                      {frame_before}.",
}

subtraction_pseudocode! {
    begin: "B ← frame 0",
    camera: "  shift B by the median displacement of the camera",
    compare: "  d ← |I(t) − I(t−1)|, in colour the maximum over the channels; with three frames the smaller of it and that of t−2",
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
    const SHOWN: &'static str = "|I(t) − B|, in colour the maximum over the channels; B is the previous frame, or the more similar of the two previous frames";
    const IS_REPLACED: bool = true;
    /// The previous frames, the latest one first.
    type Model = Vec<Arc<Frame>>;

    fn setup(&self) -> Setup {
        Setup { settings: self.settings, initial: None, steady: Some(self.steady) }
    }

    fn moved(&self, model: &Self::Model, by: [f32; 2], frame: &Arc<Frame>) -> Self::Model {
        model.iter().map(|earlier| Arc::new(resampled(earlier, by, frame))).collect()
    }

    fn displaced(&self, model: &Self::Model, frame: &Frame, mask: &Mask) -> Option<Mask> {
        let (threshold, channels) = (self.limit(model, frame), self.count(model, frame));
        let fits = |earlier: &Frame, places| is_near([frame, earlier], places, (channels, threshold));
        displaced(mask, Some(self.steady), |place, of| model.iter().any(|earlier| fits(earlier, [place, of])))
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
        self.compared_in(model, frame, place, Channel::Gray)
    }

    fn channel(&self, model: &Self::Model, frame: &Frame, place: (usize, usize)) -> Channel {
        self.nearest(model, frame, place).map_or(Channel::Gray, |(_, (channel, _))| channel)
    }

    fn compared_in(&self, model: &Self::Model, frame: &Frame, place: (usize, usize), channel: Channel) -> f32 {
        let earlier = self.nearest(model, frame, place).map_or(frame, |(earlier, _)| earlier);
        f32::from(channel.level(earlier, place))
    }

    fn difference(&self, model: &Self::Model, frame: &Frame, place: (usize, usize)) -> f32 {
        self.nearest(model, frame, place).map_or(0.0, |(_, (_, difference))| difference)
    }

    fn explain(&self, step: Step, probe: &Probe<Self::Model>) -> Explanation {
        let &Probe { before, after, frame, place } = probe;
        let Some((nearest, _)) = self.nearest(before, frame, place) else { return Explanation::of(step) };
        let (channels, limit) = (self.count(before, frame), self.limit(before, frame));
        let of = |frame: &Frame| levels(frame, place, channels)[..channels].to_vec();
        let comparison = Comparison {
            pixel: of(frame),
            background: of(nearest).into_iter().map(f32::from).collect(),
            after: None,
            threshold: subtraction::value::THRESHOLD.is(limit).in_unit(Unit::LEVEL),
            is_foreground: !before.iter().any(|earlier| is_near([frame, earlier], [place; 2], (channels, limit))),
        };
        let step = match &before[..] {
            [last, earlier] => step
                .fact(value::FRAME_BEFORE, tuple(&of(last)))
                .fact(value::FRAME_EARLIER, tuple(&of(earlier)))
                .formula(r"B = \text{the more similar of I(t−1) and I(t−2)}"),
            _ => step.put(value::FRAME_BEFORE, tuple(&of(&before[0]))),
        };
        let update = if channels == 1 { case::REPLACES_LEVEL } else { case::REPLACES_COLOUR };
        Explanation { update: after.map(|_| update).into_iter().collect(), ..comparison.explained(step) }
    }

    fn rule(&self, step: Step) -> (Step, Cases) {
        let is_two = self.differencing == Differencing::Two;
        let from = if is_two { case::FROM_PREVIOUS } else { case::FROM_BOTH };
        difference_rule(step, self.threshold, [from, self.channels.any()])
    }

    fn model_bytes(&self, model: &Self::Model) -> usize {
        model.iter().map(|frame| frame.bytes()).sum()
    }
}
