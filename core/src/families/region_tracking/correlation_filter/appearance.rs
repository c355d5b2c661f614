//! The appearance of the region in the first frame, which the filter forgets as it is updated: a filter that has learnt
//! the ground behind the object responds to it with an equally high peak.

use crate::base::effort;
use crate::geometry::{Border, Gray, Grid};
use crate::products::Region;

/// Bins of gray levels.
const BINS: usize = 20;
/// They reach this many standard deviations of the surroundings to either side of their median.
const REACH: f64 = 4.0;
/// The smallest standard deviation of the surroundings in gray levels: of noise.
const LEAST_SIGMA: f64 = 4.0;
/// The standard deviation of a normal distribution, as a multiple of its median absolute deviation.
const SIGMA_OF_MAD: f64 = 1.4826;
/// The box is compared at this distance from the region too, in px.
const SHIFT_PX: isize = 2;
/// A box with a smaller ZNCC no longer shows the pattern of the first frame.
const LEAST_ZNCC: f64 = 0.3;
/// Gray levels at least this similar to the surroundings are taken for the surroundings.
const LIKE: f64 = 0.9;
/// The gray levels match the surroundings rather than the object if the coefficients differ by more than this.
const APART: f64 = 0.1;

/// The shares of gray levels, relative to median and deviation of the surroundings, which a change of light changes alike.
type Shares = [f64; BINS];

/// The ellipse in the region of the first frame: the corners of its box are background.
#[derive(Clone)]
pub struct Appearance {
    pixels: Gray,
    shares: Shares,
}

/// The box of the region in a later frame, compared with that of the first one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// Its zero-mean normalised cross-correlation with that of the first frame; none for a uniform one.
    pub zncc: Option<f64>,
    /// The Bhattacharyya coefficients of its gray levels with those of the box of the first frame, and with those of its surroundings.
    pub coefficients: [f64; 2],
}

impl Evidence {
    /// Whether the pattern of the first frame is no longer found: the object has changed, is covered, or is absent.
    pub fn is_unlike(&self) -> bool {
        self.zncc.is_some_and(|zncc| zncc < LEAST_ZNCC)
    }

    /// Whether the box shows the surroundings and not the object.
    pub fn is_gone(&self) -> bool {
        let [object, around] = self.coefficients;
        self.zncc.is_none_or(|zncc| zncc < LEAST_ZNCC) && around > LIKE && around - object > APART
    }
}

impl Appearance {
    /// Returns the appearance of a region: its pixels, and its gray levels beside those of a window around it.
    pub fn of(luma: &Gray, region: Region, window: (usize, usize)) -> Self {
        let pixels = cut(luma, region.center, region.size.map(|side| side.round().max(1.0) as usize));
        let [shares, _] = shares(luma, (region.center, pixels.size()), window);
        Self { pixels, shares }
    }

    /// Compares the box around `center` with it.
    pub fn compare(&self, luma: &Gray, center: [f32; 2], window: (usize, usize)) -> Evidence {
        let [own, around] = shares(luma, (center, self.pixels.size()), window);
        let [x, y] = corner(center, self.pixels.size());
        let shifts = (-SHIFT_PX..=SHIFT_PX).flat_map(|v| (-SHIFT_PX..=SHIFT_PX).map(move |u| [x + u, y + v]));
        let best = shifts.filter_map(|at| self.zncc(luma, at)).reduce(f64::max);
        Evidence { zncc: best, coefficients: [&self.shares, &around].map(|other| coefficient(&own, other)) }
    }

    /// The ZNCC with the box from a pixel on; none where one of them is uniform.
    fn zncc(&self, luma: &Gray, [left, top]: [isize; 2]) -> Option<f64> {
        let (width, height) = self.pixels.size();
        effort::add(width * height);
        let (mut sums, mut products) = ([0.0f64; 2], [0.0f64; 3]);
        for y in 0..height {
            let row = luma.row(Border::Replicate.index(top + y as isize, luma.height()));
            let (mut row_sums, mut row_products) = ([0u64; 2], [0u64; 3]);
            for x in columns(y, (width, height)) {
                let a = self.pixels[(x, y)];
                let b = u64::from(row[Border::Replicate.index(left + x as isize, row.len())]);
                let a = u64::from(a);
                row_sums = [row_sums[0] + a, row_sums[1] + b];
                row_products = [row_products[0] + a * a, row_products[1] + a * b, row_products[2] + b * b];
            }
            (0..2).for_each(|i| sums[i] += row_sums[i] as f64);
            (0..3).for_each(|i| products[i] += row_products[i] as f64);
        }
        let count = (0..height).map(|y| columns(y, (width, height)).len()).sum::<usize>().max(1) as f64;
        let [aa, ab, bb] = products.map(|sum| sum / count);
        let [a, b] = sums.map(|sum| sum / count);
        // Whole gray levels, so that a uniform box has less variance than a single pixel.
        let variances = [aa - a * a, bb - b * b];
        variances.iter().all(|variance| *variance >= 1.0).then(|| (ab - a * b) / (variances[0] * variances[1]).sqrt())
    }
}

/// The first pixel of a box around a centre.
fn corner(center: [f32; 2], (width, height): (usize, usize)) -> [isize; 2] {
    [0, 1].map(|i| (center[i] - ([width, height][i] as f32 - 1.0) / 2.0).round() as isize)
}

/// The columns of the ellipse in a box of this size that lie in row `y`.
fn columns(y: usize, (width, height): (usize, usize)) -> std::ops::Range<usize> {
    let [a, b] = [width, height].map(|side| side as f64 / 2.0);
    let dy = (y as f64 + 0.5 - b) / b;
    let reach = a * (1.0 - dy * dy).max(0.0).sqrt();
    (a - reach).round() as usize..(a + reach).round() as usize
}

/// The pixels of a box around a centre; beyond the border those at it.
fn cut(luma: &Gray, center: [f32; 2], [width, height]: [usize; 2]) -> Gray {
    let [left, top] = corner(center, (width, height));
    Grid::from_fn(width, height, |x, y| luma.at(left + x as isize, top + y as isize, Border::Replicate))
}

/// The shares of gray levels in the ellipse in a box around a centre, and around the box in a window.
fn shares(luma: &Gray, (center, size): ([f32; 2], (usize, usize)), (width, height): (usize, usize)) -> [Shares; 2] {
    let window = cut(luma, center, [width, height]);
    effort::add(width * height);
    let [corner, from] = [corner(center, size), corner(center, (width, height))];
    let [left, top] = [0, 1].map(|i| (corner[i] - from[i]).max(0) as usize);
    // Of each gray level, in the ellipse and around the box.
    let mut counts = [[0usize; 256]; 2];
    for y in 0..height {
        let row = (y >= top && y < top + size.1).then(|| columns(y - top, size));
        for (x, level) in window.row(y).iter().enumerate() {
            match &row {
                Some(own) if x >= left && x < left + size.0 => {
                    counts[0][usize::from(*level)] += usize::from(own.contains(&(x - left)));
                }
                _ => counts[1][usize::from(*level)] += 1,
            }
        }
    }
    let median = median(counts[1].iter().copied().enumerate());
    let mut off = [0usize; 256];
    counts[1].iter().enumerate().for_each(|(level, count)| off[level.abs_diff(median)] += count);
    let sigma = (SIGMA_OF_MAD * self::median(off.into_iter().enumerate()) as f64).max(LEAST_SIGMA);
    let bin = |level: usize| {
        let off = (level as f64 - median as f64) / (2.0 * REACH * sigma) + 0.5;
        (off * BINS as f64).clamp(0.0, BINS as f64 - 1.0) as usize
    };
    counts.map(|counts| {
        let sum = counts.iter().sum::<usize>().max(1) as f64;
        let mut shares = [0.0; BINS];
        counts.iter().enumerate().for_each(|(level, count)| shares[bin(level)] += *count as f64 / sum);
        shares
    })
}

/// The median of values with their counts, in ascending order; 0 of none.
fn median(counts: impl Iterator<Item = (usize, usize)> + Clone) -> usize {
    let half = counts.clone().map(|(_, count)| count).sum::<usize>().div_ceil(2);
    let mut below = 0;
    counts
        .into_iter()
        .find(|(_, count)| {
            below += count;
            below >= half
        })
        .map_or(0, |(value, _)| value)
}

/// The Bhattacharyya coefficient of two histograms.
fn coefficient(a: &Shares, b: &Shares) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a * b).sqrt()).sum()
}
