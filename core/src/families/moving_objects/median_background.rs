//! Approximate median: the background moves one step toward each frame.

use std::sync::Arc;

use crate::base::{Threads, wide::wide, words};
use crate::data::{Clip, Frame, Mask};
use crate::geometry::Grid;
use crate::methods::numbers::level;
use crate::methods::subtraction::{
    Accepted, Background, Channel, Channels, Channelwise, Comparison, Explanation, Found, Initial, Past, Planes, Row,
    SHADOW_SHARE, Settings, ShadowDetection, Steadiness, classify, displaced, kind, levels, subtraction_pseudocode,
    tuple,
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
        /// The channels that are compared.
        channels: Channels = Channels::Color;
        /// Difference threshold in gray levels. Pixels with a larger |I − B|, in colour in any channel, are foreground.
        threshold: usize = 25, 0..=255;
        /// The detection of cast shadows.
        shadow: ShadowDetection = ShadowDetection::default();
        /// Initial background: the first frame, or the median of the run, which uses later frames (non-causal).
        initial: Initial = Initial::Median;
        /// Number of frames, spread evenly up to the current one, of the true median from which a layer shows the difference.
        median_frames: usize = 25, 3..=200;
        /// The treatment of a camera that is not quite at rest.
        steady: Steadiness = Steadiness::default();
        /// The parameters of all background subtractions.
        settings: Settings = Settings::default();
    }
    renamed { "open" => "opening", "close" => "closing" }
    advanced { "median-frames" }
    when {
        "detect-shadows": |p| p.channels == Channels::Color, "Shadow detection has no effect in gray: it needs colour.";
        "shadow-threshold": |p| p.channels == Channels::Color, "The shadow threshold has no effect in gray.";
    }
}

impl Channelwise for MedianBackground {
    type Cell = u8;

    #[inline(always)]
    fn distance(&self, median: u8, level: u8) -> f32 {
        f32::from(level.abs_diff(median))
    }

    #[inline(always)]
    fn differs(&self, median: u8, level: u8) -> bool {
        level.abs_diff(median) > self.threshold as u8
    }

    #[inline(always)]
    fn updated(&self, median: u8, level: u8, _: bool) -> u8 {
        let step = self.step as u8;
        median + level.saturating_sub(median).min(step) - median.saturating_sub(level).min(step)
    }
}

wide!(fn decide(of: &MedianBackground, row: Row<'_>, model: &mut [u8], words: &mut [u64]) = classify);

subtraction_pseudocode! {
    begin: "B ← the initial background",
    camera: "  shift the model by the median displacement of the camera, in whole px",
    exposure: "  correct the exposure of the frame to that of the background",
    compare: "  d ← |I − B|; in colour the maximum over the channels",
    decide: "  foreground if d > threshold",
    shadows: "  shadow if I ≈ a B with shadow-threshold ≤ a ≤ 1",
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
    const SHOWN: &'static str = "|I − B|, in colour the maximum over the channels";
    type Model = Planes<u8>;

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
        Need::per_pixel(clip, [1.0 + 2.0 * self.channels.most(clip) as f64; 2])
    }

    fn initial(&self) -> Initial {
        self.initial
    }

    fn begin(&self, first: &Arc<Frame>) -> Planes<u8> {
        Planes::begin(first, self.channels, |level| level)
    }

    fn subtract(&self, model: &mut Planes<u8>, frame: &Arc<Frame>, threads: &Threads) -> Found {
        // Shadows are those on the background before the update.
        let before = (self.shadow.detect_shadows && model.channels == 3).then(|| model.clone());
        let mask = model.by_rows(frame, threads, |row, cells, words| decide(self, row, cells, words));
        let limit = |_| (SHADOW_SHARE * self.threshold as f32).powi(2);
        let darkest = self.shadow.shadow_threshold;
        let shadows = before.map(|model| model.shadows((frame, &mask), darkest, f32::from, limit));
        Found { mask, shadows }
    }

    fn expected(&self, model: &Planes<u8>, place: (usize, usize)) -> f32 {
        model.expected(place, Channel::Gray, f32::from)
    }

    fn expected_color(&self, model: &Planes<u8>, place: (usize, usize)) -> Option<[u8; 3]> {
        model.color(place, f32::from)
    }

    fn channel(&self, model: &Planes<u8>, frame: &Frame, place: (usize, usize)) -> Channel {
        model.deciding(self, frame, place).0
    }

    fn compared_in(&self, model: &Planes<u8>, _: &Frame, place: (usize, usize), channel: Channel) -> f32 {
        model.expected(place, channel, f32::from)
    }

    fn layers(&self, model: &Arc<Planes<u8>>, past: &Past) -> Vec<Layer> {
        let (model, past, frames) = (Arc::clone(model), past.clone(), self.median_frames);
        vec![Layer::new(Quantity::OffMedian, move || {
            let ((width, height), median) = (model.size(), past.median(frames));
            let off = |place| match &median {
                Ok(median) => (model.expected(place, Channel::Gray, f32::from) - median[place]).abs(),
                Err(_) => f32::NAN,
            };
            Grid::from_fn(width, height, |x, y| off((x, y)))
        })]
    }

    fn accepted(&self, model: &Planes<u8>, place: (usize, usize), channel: Channel) -> Vec<Accepted> {
        vec![Accepted::around(model.expected(place, channel, f32::from), self.threshold as f32)]
    }

    fn difference(&self, model: &Planes<u8>, frame: &Frame, place: (usize, usize)) -> f32 {
        model.deciding(self, frame, place).1
    }

    fn explain(&self, [before, after]: [Option<&Planes<u8>>; 2], frame: &Frame, place: (usize, usize)) -> Explanation {
        let Some(before) = before else { return Explanation::default() };
        let (channels, pixel) = (before.channels, levels(frame, place, before.channels));
        let pixel = &pixel[..channels];
        let comparison = Comparison {
            pixel,
            background: &before.at(place).map(f32::from)[..channels],
            is_whole: true,
            threshold: self.threshold as f32,
        };
        let mut explanation = comparison.explained();
        if let Some(after) = after {
            let text = |values: &[u8]| tuple(values, |value| level(value.into()));
            let [old, new] = [before, after].map(|model| text(&model.at(place)[..channels]));
            explanation.facts.push(Fact::new("Background after update", new.clone(), Some(Role::Estimate)));
            explanation.update = Sentence::default()
                .text("the background B moves from ")
                .ink(Role::Predicted, old)
                .text(" to ")
                .ink(Role::Estimate, new)
                .text(format!(
                    " toward the {} {}, by a step of at most {}.",
                    kind(channels)[1],
                    text(pixel),
                    words::counted(self.step, "gray level")
                ));
        }
        explanation
    }

    fn rule(&self) -> String {
        format!("|I − B| exceeds the threshold of {} gray levels{}", self.threshold, self.channels.any())
    }

    fn model_bytes(&self, model: &Planes<u8>) -> usize {
        model.bytes()
    }
}
