//! The change of exposure between a background model and a frame, so that automatic exposure is not taken for foreground.
//!
//! The brightness transfer function gives the gray level of a frame for each gray level of the background (M. D. Grossberg and
//! S. K. Nayar, Determining the camera response from images: what is knowable?, IEEE TPAMI 25(11), 2003). Here it is the median
//! difference among the pixels of similar gray level: an object that covers less than half of them does not change it.
//!
//! Pixels are similar by the mean of their two gray levels, not by that of the background. Where a frame is displaced by a few pixels, the
//! darkest pixels of the background meet lighter ones and the lightest meet darker ones, which would look like less contrast (regression
//! to the mean; J. M. Bland and D. G. Altman, Comparing methods of measurement: why plotting difference against standard method is
//! misleading, The Lancet 346, 1995).

use crate::choices;
use crate::data::Frame;
use crate::geometry::Gray;

choices! {
    /// The treatment of changes of the exposure.
    pub enum Exposure {
        /// Gray levels are compared as they are.
        Ignored = "ignored" "Ignored",
        /// Each frame is corrected by the brightness transfer function from the frame to the background.
        Compensated = "compensated" "Compensated",
    }
}

/// The number of gray levels of the background in a bin.
const BIN_LEVELS: usize = 16;
const BINS: usize = 256 / BIN_LEVELS;
/// The number of sampled pixels, at most.
const SAMPLES: usize = 20_000;
/// A bin counts if it has at least one of this many samples.
const LEAST_SHARE: u32 = 200;
/// A smaller median change is left as it is, in gray levels.
const LEAST_CHANGE: f32 = 1.0;
/// The greatest deviation of a bin from the median change: a number of gray levels, and a share of the median.
const SPREAD: [f32; 2] = [2.0, 1.5];
/// The differences of gray levels, −255 to 255.
const DIFFERENCES: usize = 511;

/// A brightness transfer function.
#[derive(Clone, Debug, PartialEq)]
pub struct Transfer {
    /// The change from the background to the frame at the middle of each bin of background levels, in gray levels.
    change: [f32; BINS],
    /// The median change of all pixels, in gray levels.
    pub median: f32,
}

/// A histogram of differences.
type Counts = [u32; DIFFERENCES];

impl Transfer {
    /// Returns the transfer from the background, whose gray level `expected` gives where it is known, to a frame; `None` where the
    /// exposure has not changed.
    pub fn between(frame: &Gray, expected: impl Fn(usize, usize) -> Option<f32>) -> Option<Self> {
        let samples = sampled(frame, expected);
        let mut all: Counts = [0; DIFFERENCES];
        samples.iter().for_each(|sample| all[sample.index()] += 1);
        let median = median(&all).filter(|median| median.abs() >= LEAST_CHANGE)?;
        let bins = by_level(&samples, median);
        let least = (all.iter().sum::<u32>() / LEAST_SHARE).max(1);
        let spread = SPREAD[0] + SPREAD[1] * median.abs();
        // A bin that objects cover for the most part keeps near the others.
        let limited = |change: f32| change.clamp(median - spread, median + spread);
        let known = bins.iter().map(|bin| self::median(bin).filter(|_| bin.iter().sum::<u32>() >= least).map(limited));
        Some(Self { change: completed(known.collect())?, median })
    }

    /// The change at a gray level of the background: linear between the middles of the bins.
    pub fn change(&self, level: f32) -> f32 {
        let place = ((level + 0.5) / BIN_LEVELS as f32 - 0.5).clamp(0.0, (BINS - 1) as f32);
        let (low, share) = (place as usize, place.fract());
        self.change[low] * (1.0 - share) + self.change[(low + 1).min(BINS - 1)] * share
    }

    /// Returns a frame with the exposure of the background. The color of a pixel changes as its gray level does.
    pub fn undone(&self, frame: &Frame) -> Frame {
        let correction = self.corrections();
        let by = |level: u8| correction[usize::from(level)];
        let moved = |value: u8, by: i16| (i16::from(value) + by).clamp(0, 255) as u8;
        match frame.color() {
            Some(color) => {
                let mut corrected = color.clone();
                for (pixel, level) in corrected.cells_mut().iter_mut().zip(frame.luma().cells()) {
                    *pixel = pixel.map(|value| moved(value, by(*level)));
                }
                Frame::rgb(corrected)
            }
            None => Frame::gray(frame.luma().map(|level| moved(*level, by(*level)))),
        }
    }

    /// The correction of each gray level of the frame.
    fn corrections(&self) -> [i16; 256] {
        // The background level that the transfer maps onto a level of the frame: the transfer made monotonic, then inverted.
        let mut reached = f32::MIN;
        let mapped: Vec<f32> = (0..256)
            .map(|level| {
                reached = reached.max(level as f32 + self.change(level as f32));
                reached
            })
            .collect();
        // Levels beyond all that the transfer reaches are no darker than the last of these.
        let mut lightest = i16::MIN;
        std::array::from_fn(|level| {
            let from = mapped.partition_point(|mapped| *mapped < level as f32).min(255);
            lightest = lightest.max(level as i16 - self.change(from as f32).round() as i16);
            lightest - level as i16
        })
    }
}

/// The gray levels of a pixel in the background and in a frame.
struct Sample {
    background: i32,
    frame: i32,
}

impl Sample {
    /// The place of its difference among the counts.
    fn index(&self) -> usize {
        (255 + self.frame - self.background) as usize
    }
}

/// Returns the gray levels at pixels of a regular grid where the background is known.
fn sampled(frame: &Gray, expected: impl Fn(usize, usize) -> Option<f32>) -> Vec<Sample> {
    let (width, height) = frame.size();
    let step = (1..).find(|step| width * height <= SAMPLES * step * step).unwrap_or(1);
    let places = (step / 2..height).step_by(step).flat_map(|y| (step / 2..width).step_by(step).map(move |x| (x, y)));
    let samples = places.filter_map(|at| {
        let background = expected(at.0, at.1)?.round().clamp(0.0, 255.0) as i32;
        Some(Sample { background, frame: i32::from(frame[at]) })
    });
    samples.collect()
}

/// Counts the differences in bins of background levels. That of a pixel is taken from the mean of its two levels, from which half
/// the median change is subtracted.
fn by_level(samples: &[Sample], median: f32) -> Vec<Counts> {
    let mut bins = vec![[0; DIFFERENCES]; BINS];
    for sample in samples {
        let level = ((sample.background + sample.frame) as f32 - median) / 2.0;
        bins[level.clamp(0.0, 255.0) as usize / BIN_LEVELS][sample.index()] += 1;
    }
    bins
}

/// The median of the differences, with the fraction that interpolation within its class gives.
fn median(counts: &Counts) -> Option<f32> {
    let all: u32 = counts.iter().sum();
    let mut below = 0;
    for (index, count) in counts.iter().enumerate() {
        if 2 * (below + count) >= all && *count > 0 {
            return Some(index as f32 - 255.5 + (0.5 * all as f32 - below as f32) / *count as f32);
        }
        below += count;
    }
    None
}

/// Returns the values of all bins: those without one take that of the nearest bin that has one, the darker of two.
fn completed(known: Vec<Option<f32>>) -> Option<[f32; BINS]> {
    let nearest = |bin: usize| {
        let values = known.iter().enumerate().filter_map(|(i, value)| value.map(|value| (i.abs_diff(bin), value)));
        values.reduce(|a, b| if b.0 < a.0 { b } else { a }).map(|(_, value)| value)
    };
    nearest(0)?;
    Some(std::array::from_fn(|bin| nearest(bin).unwrap_or_default()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;

    /// A background with all gray levels from 20 to 200.
    fn background() -> Gray {
        Grid::from_fn(120, 90, |x, y| (20 + (x * 7 + y * 13) % 181) as u8)
    }

    /// The background under another exposure, with an object in a fifth of the picture.
    fn exposed(gain: f32, offset: f32) -> Frame {
        Frame::gray(Grid::from_fn(120, 90, |x, y| {
            let level = f32::from(background()[(x, y)]);
            if x < 24 { 240 } else { (gain * level + offset).round() as u8 }
        }))
    }

    fn transfer(frame: &Frame) -> Option<Transfer> {
        let background = background();
        Transfer::between(frame.luma(), |x, y| Some(f32::from(background[(x, y)])))
    }

    #[test]
    fn a_gain_is_found_and_undone_beside_an_object() {
        let frame = exposed(1.12, 3.0);
        let transfer = transfer(&frame).unwrap();
        for level in [40.0, 90.0, 160.0] {
            assert!((transfer.change(level) - (0.12 * level + 3.0)).abs() < 2.0, "{level}: {}", transfer.change(level));
        }
        let (corrected, background) = (transfer.undone(&frame), background());
        let wrong = |frame: &Frame| {
            let cells = (0..90).flat_map(|y| (24..120).map(move |x| (x, y)));
            cells.filter(|at| frame.luma()[*at].abs_diff(background[*at]) > 2).count()
        };
        assert!(wrong(&corrected) < 90 && wrong(&frame) > 5000, "{} {}", wrong(&corrected), wrong(&frame));
        // The object stays far from the background, the lightest part of which is at 200.
        assert!(corrected.luma()[(3, 3)] > 205, "{}", corrected.luma()[(3, 3)]);
    }

    #[test]
    fn a_displaced_frame_is_not_taken_for_less_contrast() {
        // Waves that are displaced by 3 px, and 8 gray levels lighter.
        let waves = |x: usize, y: usize| {
            let [x, y] = [x, y].map(|c| c as f32);
            110.0 + 40.0 * (0.5 * x + 0.2 * y).sin() + 35.0 * (0.3 * x - 0.45 * y).sin()
        };
        let frame = Grid::from_fn(120, 90, |x, y| (waves(x + 3, y) + 8.0).round() as u8);
        let transfer = Transfer::between(&frame, |x, y| Some(waves(x, y))).unwrap();
        for level in [70.0, 110.0, 150.0] {
            assert!((transfer.change(level) - 8.0).abs() < 4.0, "{level}: {}", transfer.change(level));
        }
    }

    #[test]
    fn the_same_exposure_is_no_change() {
        assert_eq!(transfer(&exposed(1.0, 0.0)), None);
        assert_eq!(Transfer::between(&Grid::new(0, 0, 0), |_, _| Some(1.0)), None, "no pixels");
        assert_eq!(Transfer::between(&Grid::new(8, 8, 0), |_, _| None), None, "an unknown background");
    }

    #[test]
    fn every_level_stays_a_gray_level() {
        for (gain, offset) in [(0.2, 0.0), (1.0, -19.0), (1.25, 0.0)] {
            let frame = exposed(gain, offset);
            let corrected = transfer(&frame).unwrap().undone(&frame);
            assert_eq!(corrected.size(), frame.size());
            let levels: Vec<_> = [30u8, 60, 90]
                .iter()
                .map(|level| transfer(&frame).unwrap().corrections()[usize::from(*level)] + i16::from(*level))
                .collect();
            assert!(levels.is_sorted(), "{levels:?}: the order of levels is kept");
        }
    }
}
