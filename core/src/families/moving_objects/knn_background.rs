//! K nearest neighbours: each pixel keeps samples of its values, and enough near samples make a value background.

mod explain;

use std::sync::Arc;

use crate::base::Threads;
use crate::data::{Clip, Frame, Mask};
use crate::geometry::Grid;
use crate::methods::subtraction::{
    Background, Cases, Explanation, Flags, Found, Initial, Probe, SHADOW_SHARE, Settings, Setup, ShadowDetection,
    ShadowLimits, Steadiness, by_rows, displaced, is_shadow, levels, luma, shifted, subtraction_pseudocode,
};
use crate::params;
use crate::run::{Info, Need};
use crate::scene::{Chart, Step};
use crate::synth::random::hash;

params! {
    /// Samples of each pixel, in colour where the frames are.
    pub struct KnnBackground {
        /// Number N of samples in each of the three sets: of recent frames, of earlier ones and of old ones.
        samples: usize = 7, 3..=7;
        /// Number k of background samples within the threshold that make a pixel background.
        k: usize = 2, 1..=7;
        /// Radius of the neighbourhood in gray levels, over all channels together. Samples within it are near; OpenCV's distance threshold is
        /// its square.
        threshold: f32 = 20.0, 1.0..=200.0;
        /// Learning rate α, about 1 / history in frames: it sets how often samples are replaced.
        learning_rate: f32 = 0.002, 0.0..=1.0;
        /// The detection of cast shadows.
        shadow: ShadowDetection = ShadowDetection::default();
        /// Initial background: the first frame, or the median of the run, which uses later frames (non-causal).
        initial: Initial = Initial::Median;
        /// The treatment of a camera that is not quite at rest.
        steady: Steadiness = Steadiness::default();
        /// The parameters of all background subtractions.
        settings: Settings = Settings::default();
    }
    advanced { "samples" }
}

/// The maximum number of samples of a set.
const MOST: usize = 7;
/// The weights of all values since the samples of a set were taken, which the sets together cover: 30 %, 60 % and 90 % of the past.
const LEFT: [f64; 3] = [0.7, 0.4, 0.1];

/// A sample of a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Red, green and blue; the gray level three times over in gray frames.
    color: [u8; 3],
    /// Whether enough samples were near when it was taken.
    is_background: bool,
}

/// The samples of a pixel: recent, earlier and old ones.
type Sets = [[Sample; MOST]; 3];

/// The samples of all pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    sets: Grid<Sets>,
    /// The channels that count: 1 for gray frames, 3 for colour.
    channels: usize,
    /// The number of frames so far.
    frames: usize,
}

/// The number of samples near a pixel's value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Near {
    /// The samples within the threshold.
    all: usize,
    /// Number of near samples that are background.
    background: usize,
}

impl KnnBackground {
    /// Returns the samples of a pixel in use.
    fn used<'a>(&self, sets: &'a Sets) -> impl Iterator<Item = &'a Sample> {
        let count = self.samples;
        sets.iter().flat_map(move |set| &set[..count])
    }

    /// Counts the samples near to a value.
    #[inline(always)]
    fn near(&self, sets: &Sets, color: [u8; 3], channels: usize) -> Near {
        let limit = self.threshold * self.threshold;
        let mut near = Near::default();
        for sample in self.used(sets) {
            let is_near = square(sample.color, color, channels) <= limit;
            near.all += usize::from(is_near);
            near.background += usize::from(is_near && sample.is_background);
        }
        near
    }

    /// Returns whether `k` of the samples that `counts` accepts are near to a value. No further ones are compared.
    #[inline(always)]
    fn has_near(&self, sets: &Sets, (color, channels): ([u8; 3], usize), counts: impl Fn(&Sample) -> bool) -> bool {
        let limit = self.threshold * self.threshold;
        let near = self.used(sets).filter(|sample| counts(sample) && square(sample.color, color, channels) <= limit);
        near.take(self.k).count() == self.k
    }

    /// Returns whether enough background samples make the value a shadow.
    fn is_in_shadow(&self, sets: &Sets, color: [u8; 3], channels: usize) -> bool {
        let limits =
            ShadowLimits { darkest: self.shadow.shadow_threshold, limit: (SHADOW_SHARE * self.threshold).powi(2) };
        let pixel = color.map(f32::from);
        let is_one = |sample: &&Sample| sample.is_background && is_shadow(pixel, sample.color.map(f32::from), limits);
        channels == 3 && self.used(sets).filter(is_one).take(self.k).count() == self.k
    }

    /// Returns the mean number of frames after which a sample of each set is replaced.
    fn periods(&self) -> [u64; 3] {
        let rate = f64::from(self.learning_rate).clamp(1e-6, 0.5);
        let ends = LEFT.map(|left| (left.ln() / (1.0 - rate).ln()).ceil());
        let lengths = [ends[0], ends[1] - ends[0], ends[2] - ends[1]];
        lengths.map(|length| (length / self.samples as f64).ceil().max(1.0) as u64)
    }

    /// Replaces samples: old ones by earlier ones, those by recent ones, and recent ones by the value, each at its rate.
    fn update(
        &self,
        sets: &mut Sets,
        (color, channels): ([u8; 3], usize),
        place: u64,
        (frames, periods): (usize, [u64; 3]),
    ) {
        let [draws, chance] = [0, 1].map(|stream| hash(place, frames as u64, stream));
        let slot = |part: u64| (chance >> (8 * part) & 0xff) as usize % self.samples;
        // Each set has a random number of its own.
        let is_due = |set: usize| ((draws >> (20 * set)) % (1 << 20)).is_multiple_of(periods[set]);
        let is_background = is_due(0) && self.has_near(sets, (color, channels), |_| true);
        for set in (0..periods.len()).rev().filter(|set| is_due(*set)) {
            let next = match set.checked_sub(1) {
                Some(newer) => sets[newer][slot(2 * set as u64)],
                None => Sample { color, is_background },
            };
            sets[set][slot(2 * set as u64 + 1)] = next;
        }
    }
}

/// Returns the squared distance of two colors over the channels that count.
#[inline(always)]
fn square(a: [u8; 3], b: [u8; 3], channels: usize) -> f32 {
    let mut sum = 0;
    for c in 0..channels {
        let off = i32::from(a[c]) - i32::from(b[c]);
        sum += off * off;
    }
    sum as f32
}

subtraction_pseudocode! {
    begin: "all samples of each pixel ← the initial background",
    camera: "  shift the model by the median displacement of the camera, in whole px",
    compare: "  n ← number of background samples s with |I − s| ≤ threshold",
    decide: "  foreground if n < k",
    shadows: "  shadow if I ≈ a s with shadow-threshold ≤ a ≤ 1 for k background samples",
    shake: "  suppress pixels that fit the background of a pixel within shake",
    update: "  at random: recent sample ← I, background if k samples are near; earlier ← recent; old ← earlier",
}

impl Background for KnnBackground {
    const INFO: Info = Info {
        id: "knn-background",
        name: "K nearest neighbours",
        family: "Moving objects",
        summary: "Keeps samples of each pixel from recent and from older frames. A pixel is background where k background samples are near, whatever the shape of their distribution.",
        source: "Z. Zivkovic and F. van der Heijden, Efficient adaptive density estimation per image pixel for the task of background \
                 subtraction, Pattern Recognition Letters 27, 2006; shadows: T. Horprasert, D. Harwood and L. S. Davis, ICCV \
                 frame-rate workshop 1999",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "stage"],
        frames: 2,
    };
    const SHOWN: &'static str = "|I − s| to the k-th nearest background sample";
    const CHARTS: &'static [Chart] = &[Chart::Tiles, Chart::Series, Chart::Matrices];
    type Model = Samples;

    fn setup(&self) -> Setup {
        Setup { settings: self.settings, initial: Some(self.initial), steady: Some(self.steady) }
    }

    fn moved(&self, model: &Samples, by: [f32; 2], frame: &Arc<Frame>) -> Samples {
        let begun = |x, y| [[Sample { color: levels(frame, (x, y), model.channels), is_background: true }; MOST]; 3];
        Samples { sets: shifted(&model.sets, by, begun), ..*model }
    }

    fn displaced(&self, model: &Samples, frame: &Frame, mask: &Mask) -> Option<Mask> {
        displaced(mask, Some(self.steady), |place, of| {
            let value = (levels(frame, place, model.channels), model.channels);
            self.has_near(&model.sets[of], value, |sample| sample.is_background)
        })
    }

    fn need(&self, clip: &Clip) -> Need {
        Need::per_pixel(clip, [size_of::<Sets>() as f64 + 1.0; 2])
    }

    fn begin(&self, first: &Arc<Frame>) -> Samples {
        let ((width, height), channels) = (first.size(), if first.color().is_some() { 3 } else { 1 });
        let sets = Grid::from_fn(width, height, |x, y| {
            [[Sample { color: levels(first, (x, y), channels), is_background: true }; MOST]; 3]
        });
        Samples { sets, channels, frames: 0 }
    }

    fn subtract(&self, model: &mut Samples, frame: &Arc<Frame>, threads: &Threads) -> Found {
        let (channels, width) = (model.channels, frame.size().0);
        model.frames += 1;
        let (frames, periods) = (model.frames, self.periods());
        let tells_shadows = self.shadow.detect_shadows && channels == 3;
        let value = |x, y| (levels(frame, (x, y), channels), channels);
        let mask = by_rows(&mut model.sets, threads, |y, row, words| {
            for (index, (cells, word)) in row.chunks(64).zip(words).enumerate() {
                let is_foreground =
                    |i| !self.has_near(&cells[i], value(64 * index + i, y), |sample| sample.is_background);
                *word = Flags::of(cells.len(), is_foreground).word();
            }
        });
        // Shadows are those on the samples before the frame.
        let shadows = tells_shadows.then(|| {
            let is_one = |x, y| self.is_in_shadow(&model.sets[(x, y)], levels(frame, (x, y), channels), channels);
            Mask::from_fn(mask.width(), mask.height(), |x, y| mask.get(x, y) && is_one(x, y))
        });
        if self.learning_rate > 0.0 {
            let rows = model.sets.cells_mut().chunks_mut(width).enumerate();
            threads.each(rows, |(y, row): (usize, &mut [Sets])| {
                for (x, sets) in row.iter_mut().enumerate() {
                    self.update(sets, value(x, y), (y * width + x) as u64, (frames, periods));
                }
            });
        }
        Found { mask, shadows }
    }

    fn expected(&self, model: &Samples, place: (usize, usize)) -> f32 {
        let sets = &model.sets[place];
        // The median of the gray levels is a typical sample's.
        let mut values: Vec<f32> = self
            .used(sets)
            .filter(|sample| sample.is_background)
            .map(|sample| luma(sample.color.map(f32::from)))
            .collect();
        values.sort_by(f32::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or_else(|| luma(sets[0][0].color.map(f32::from)))
    }

    fn difference(&self, model: &Samples, frame: &Frame, place: (usize, usize)) -> f32 {
        self.distances(model, frame, place).get(self.k - 1).copied().unwrap_or(f32::NAN)
    }

    fn explain(&self, step: Step, probe: &Probe<Samples>) -> Explanation {
        self.explanation(step, probe)
    }

    fn rule(&self, step: Step) -> (Step, Cases) {
        self.put_rule(step)
    }

    fn model_bytes(&self, model: &Samples) -> usize {
        size_of_val(model.sets.cells())
    }
}

impl KnnBackground {
    /// Returns the distances of a pixel from its background samples, the least first.
    fn distances(&self, model: &Samples, frame: &Frame, place: (usize, usize)) -> Vec<f32> {
        let color = levels(frame, place, model.channels);
        let background = self.used(&model.sets[place]).filter(|sample| sample.is_background);
        let mut all: Vec<f32> = background.map(|sample| square(sample.color, color, model.channels).sqrt()).collect();
        all.sort_by(f32::total_cmp);
        all
    }
}
