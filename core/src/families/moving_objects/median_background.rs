//! Approximate median: the background moves one step toward each frame.

use std::sync::Arc;

use crate::base::wide::wide;
use crate::geometry::Grid;
use crate::methods::subtraction::{
    Channel, ChannelModel, Channels, Channelwise, Common, Explanation, Initial, Past, Planes, Probe, Row, Settings,
    Setup, ShadowDetection, Steadiness, classify, subtraction_pseudocode,
};
use crate::run::Info;
use crate::scene::{Layer, Quantity, Step, Unit};
use crate::{cases, params, variables};

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

variables! {
    /// The largest step of the background toward the frame.
    STEP: "", "", Unit::count("gray level");
}

cases! { over value;
    STEPS: ", by a step of at most {step}.",
}

subtraction_pseudocode! {
    begin: "B ← the initial background",
    camera: "  shift the model by the median displacement of the camera, in whole px",
    compare: "  d ← |I − B|; in colour the maximum over the channels",
    decide: "  foreground if d > threshold",
    shadows: "  shadow if I ≈ a B with shadow-threshold ≤ a ≤ 1",
    shake: "  suppress pixels that fit the background of a pixel within shake",
    update: "  B ← B + step where I > B, B − step where I < B, at most to I",
}

impl ChannelModel for MedianBackground {
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
    const UNIT: Unit = Unit::LEVEL;

    fn common(&self) -> Common {
        let setup = Setup { settings: self.settings, initial: Some(self.initial), steady: Some(self.steady) };
        Common { channels: self.channels, shadow: self.shadow, setup }
    }

    fn threshold(&self) -> f32 {
        self.threshold as f32
    }

    fn begun(&self, level: u8) -> u8 {
        level
    }

    fn decide(&self, row: Row<'_>, cells: &mut [u8], words: &mut [u64]) {
        decide(self, row, cells, words);
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

    fn explain(&self, step: Step, probe: &Probe<Planes<u8>>) -> Explanation {
        let mut explanation = probe.before.comparison(self, probe).explained(step.put(value::STEP, self.step));
        explanation.update.extend(probe.after.map(|_| case::STEPS));
        explanation
    }
}
