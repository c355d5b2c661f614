//! The orientation of a keypoint: the peaks of a histogram of gradient directions.

use std::f32::consts::TAU;

use super::angle;
use crate::base::LANES;
use crate::base::wide::wide;
use crate::geometry::Grid;

/// Number of bins of the orientation histogram.
pub const ORIENTATIONS: usize = 36;

/// Smallest height of a peak relative to the highest.
pub const PEAK_RATIO: f32 = 0.8;

/// The gradient directions around a keypoint, weighted by gradient magnitude and a Gaussian.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// The weights of the directions 0°, 10°, … 350° before smoothing.
    pub raw: [f32; ORIENTATIONS],
    /// The weights after circular smoothing with (1, 4, 6, 4, 1) / 16.
    pub bins: [f32; ORIENTATIONS],
}

/// A peak of the histogram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Direction in radians from x towards y, interpolated by a parabola.
    pub angle_rad: f32,
    /// Its bin.
    pub bin: usize,
    /// Its height relative to the highest bin.
    pub share: f32,
}

impl Histogram {
    /// Standard deviation of the weights in standard deviations of the keypoint.
    const SPREAD: f32 = 1.5;

    /// Radius of the window in px for a keypoint with this standard deviation.
    pub fn radius_px(sigma_px: f32) -> usize {
        (3.0 * Self::SPREAD * sigma_px).round() as usize
    }

    /// The histogram around pixel `(x, y)` of a Gaussian image, for a keypoint of `sigma_px`, in px of the octave.
    pub fn around(image: &Grid<f32>, (x, y): (usize, usize), sigma_px: f32) -> Self {
        let radius = Self::radius_px(sigma_px);
        let across = -0.5 / (Self::SPREAD * sigma_px).powi(2);
        let weights: Vec<f32> = (0..=radius).map(|i| (across * (i * i) as f32).exp()).collect();
        let mut raw = [0.0; ORIENTATIONS];
        let (width, height) = image.size();
        let from = x.saturating_sub(radius).max(1);
        let to = (x + radius + 1).min(width.saturating_sub(1));
        if from < to {
            let mut row = Row { magnitudes: vec![0.0; to - from], bins: vec![0.0; to - from] };
            for j in y.saturating_sub(radius).max(1)..(y + radius + 1).min(height.saturating_sub(1)) {
                gradients(image, (from, j), &mut row);
                let of_row = weights[j.abs_diff(y)];
                for (i, (magnitude, bin)) in row.magnitudes.iter().zip(&row.bins).enumerate() {
                    raw[*bin as usize] += magnitude * of_row * weights[(from + i).abs_diff(x)];
                }
            }
        }
        Self { raw, bins: smoothed(&raw) }
    }

    /// The highest bin.
    pub fn highest(&self) -> f32 {
        self.bins.iter().copied().fold(0.0, f32::max)
    }

    /// The peaks of at least [`PEAK_RATIO`] of the highest bin, in the order of bins.
    pub fn peaks(&self) -> Vec<Peak> {
        let (highest, bins) = (self.highest(), &self.bins);
        let peak = |bin: usize| {
            let [left, here, right] = [bin + ORIENTATIONS - 1, bin, bin + 1].map(|i| bins[i % ORIENTATIONS]);
            let is_peak = here > left && here > right && here >= PEAK_RATIO * highest;
            is_peak.then(|| {
                let offset = 0.5 * (left - right) / (left - 2.0 * here + right);
                let angle_rad = (bin as f32 + offset) * TAU / ORIENTATIONS as f32;
                Peak { angle_rad: angle_rad.rem_euclid(TAU), bin, share: here / highest }
            })
        };
        (0..ORIENTATIONS).filter_map(peak).collect()
    }
}

/// Gradients of a stretch of a row.
struct Row {
    magnitudes: Vec<f32>,
    bins: Vec<f32>,
}

wide! {
    fn gradients(image: &Grid<f32>, at: (usize, usize), row: &mut Row) = gradients_body
}

#[inline(always)]
fn gradients_body(image: &Grid<f32>, (from, y): (usize, usize), Row { magnitudes, bins }: &mut Row) {
    let count = bins.len();
    let [above, below] = [y - 1, y + 1].map(|y| &image.row(y)[from..from + count]);
    let [left, right] = [from - 1, from + 1].map(|x| &image.row(y)[x..x + count]);
    let around = [left, right, above, below];
    let whole = count - count % LANES;
    for i in (0..whole).step_by(LANES) {
        let [found, bin] = gradients_at::<LANES>(around, i);
        magnitudes[i..i + LANES].copy_from_slice(&found);
        bins[i..i + LANES].copy_from_slice(&bin);
    }
    for i in whole..count {
        let [[found], [bin]] = gradients_at::<1>(around, i);
        (magnitudes[i], bins[i]) = (found, bin);
    }
}

/// Magnitudes and bins of the gradients of `N` pixels, from the rows of their neighbours on the left, on the right, above and below.
#[inline(always)]
fn gradients_at<const N: usize>(around: [&[f32]; 4], start: usize) -> [[f32; N]; 2] {
    let [mut magnitudes, mut bins] = [[0.0; N]; 2];
    let [left, right, above, below] = around.map(|row| &row[start..start + N]);
    for i in 0..N {
        let (gx, gy) = (right[i] - left[i], below[i] - above[i]);
        let turns = angle(gx, gy) / TAU;
        // Rounded to the nearest bin; bin 36 is bin 0.
        let bin = (turns * ORIENTATIONS as f32 + ORIENTATIONS as f32 + 0.5).floor();
        bins[i] = if bin >= ORIENTATIONS as f32 { bin - ORIENTATIONS as f32 } else { bin };
        magnitudes[i] = (gx * gx + gy * gy).sqrt();
    }
    [magnitudes, bins]
}

fn smoothed(raw: &[f32; ORIENTATIONS]) -> [f32; ORIENTATIONS] {
    std::array::from_fn(|i| {
        let at = |by: usize| raw[(i + ORIENTATIONS + by - 2) % ORIENTATIONS];
        (at(0) + at(4)) / 16.0 + (at(1) + at(3)) / 4.0 + at(2) * 6.0 / 16.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_direction_of_a_slope_is_found() {
        for degrees in [0.0f32, 30.0, 77.0, 123.0, 200.0, 300.0, 351.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let slope = Grid::from_fn(40, 40, |x, y| 2.0 * (cos * x as f32 + sin * y as f32));
            let histogram = Histogram::around(&slope, (20, 20), 2.0);
            let [peak] = histogram.peaks()[..] else { panic!("{degrees}: {:?}", histogram.bins) };
            let off = (peak.angle_rad.to_degrees() - degrees + 180.0).rem_euclid(360.0) - 180.0;
            // A single direction lies in one bin of 10°.
            assert!(off.abs() <= 5.0 && peak.share == 1.0, "{degrees}: {peak:?}");
        }
    }

    #[test]
    fn a_flat_window_has_no_peak() {
        assert!(Histogram::around(&Grid::new(9, 9, 3.0), (4, 4), 2.0).peaks().is_empty());
    }
}
