//! Fourier transforms of real windows of one size.
//!
//! Several rows or columns beside each other are transformed at once, number by number as a single one is, so that spectra are the
//! same on every machine.

use std::sync::Arc;

use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlannerScalar};

use super::lanes::{LANES, Lanes};

/// The frequencies of a real window: in groups of columns beside each other, row by row. The columns are those from 0 to half the
/// width, because the others are their conjugates; those that fill up the last group are 0.
pub type Spectrum = Vec<Complex<Lanes>>;

/// Rows of pixels that are transformed at once: two as the real and the imaginary part of each number.
const ROWS: usize = 2 * LANES;

/// The transforms of windows of one size.
pub struct Transform {
    size: (usize, usize),
    /// Along rows and columns, to frequencies and back.
    forward: [Arc<dyn Fft<Lanes>>; 2],
    inverse: [Arc<dyn Fft<Lanes>>; 2],
}

impl Transform {
    /// Plans the transforms of windows of a width and a height.
    pub fn new((width, height): (usize, usize)) -> Self {
        let mut planner = FftPlannerScalar::new();
        let forward = [width, height].map(|length| planner.plan_fft_forward(length));
        let inverse = [width, height].map(|length| planner.plan_fft_inverse(length));
        Self { size: (width, height), forward, inverse }
    }

    /// Width and height of the windows.
    pub fn size(&self) -> (usize, usize) {
        self.size
    }

    /// Number of columns of a spectrum, without those that fill it up.
    fn columns(&self) -> usize {
        self.size.0 / 2 + 1
    }

    /// Length of a spectrum.
    pub fn length(&self) -> usize {
        self.columns().div_ceil(LANES) * self.size.1
    }

    /// The mean over all frequencies of values given for those of a spectrum.
    pub fn mean(&self, values: &[Lanes]) -> f32 {
        let (width, height) = self.size;
        let groups = values.chunks_exact(height);
        let columns = groups.flat_map(|group| group.iter().fold(Lanes::default(), |sum, values| sum + *values).0);
        // A column of the other half has the values of its mirror.
        let sum: f32 = columns
            .take(self.columns())
            .enumerate()
            .map(|(k, column)| {
                let is_single = k == 0 || 2 * k == width;
                column * if is_single { 1.0 } else { 2.0 }
            })
            .sum();
        sum / (width * height) as f32
    }

    /// Transforms the pixels of a window, row by row.
    pub fn forward(&self, pixels: &[f32]) -> Spectrum {
        let (width, height) = self.size;
        // Two rows as real and imaginary part, from which their transforms are separated by symmetry.
        let mut pairs: Spectrum = vec![Complex::default(); height.div_ceil(ROWS) * width];
        for (pairs, rows) in pairs.chunks_exact_mut(width).zip(pixels.chunks(ROWS * width)) {
            for (i, row) in rows.chunks_exact(width).enumerate() {
                for (pair, pixel) in pairs.iter_mut().zip(row) {
                    part_mut(pair, i % 2).0[i / 2] = *pixel;
                }
            }
        }
        self.forward[0].process(&mut pairs);
        let mut spectrum: Spectrum = vec![Complex::default(); self.length()];
        let half = Lanes::all(0.5);
        for (j, pairs) in pairs.chunks_exact(width).enumerate() {
            let rows = ROWS.min(height - j * ROWS);
            for k in 0..self.columns() {
                let (value, mirrored) = (pairs[k], pairs[(width - k) % width].conj());
                let (first, apart) = ((value + mirrored) * half, (value - mirrored) * half);
                let both = [first, Complex::new(apart.im, -apart.re)];
                let column = &mut spectrum[k / LANES * height + j * ROWS..][..rows];
                for (i, target) in column.iter_mut().enumerate() {
                    target.re.0[k % LANES] = both[i % 2].re.0[i / 2];
                    target.im.0[k % LANES] = both[i % 2].im.0[i / 2];
                }
            }
        }
        self.forward[1].process(&mut spectrum);
        spectrum
    }

    /// Transforms a spectrum back to pixels, row by row.
    pub fn inverse(&self, mut spectrum: Spectrum) -> Vec<f32> {
        let (width, height) = self.size;
        self.inverse[1].process(&mut spectrum);
        let mut pairs = vec![Complex::default(); height.div_ceil(ROWS) * width];
        let turned = |of: Complex<Lanes>| Complex::new(-of.im, of.re);
        for (j, pairs) in pairs.chunks_exact_mut(width).enumerate() {
            let rows = ROWS.min(height - j * ROWS);
            for k in 0..self.columns() {
                let mut both = [Complex::<Lanes>::default(); 2];
                let column = &spectrum[k / LANES * height + j * ROWS..][..rows];
                for (i, value) in column.iter().enumerate() {
                    both[i % 2].re.0[i / 2] = value.re.0[k % LANES];
                    both[i % 2].im.0[i / 2] = value.im.0[k % LANES];
                }
                let [first, second] = both;
                // The mirror first: if it is the same frequency, both are equal.
                pairs[(width - k) % width] = first.conj() + turned(second.conj());
                pairs[k] = first + turned(second);
            }
        }
        self.inverse[0].process(&mut pairs);
        let scale = 1.0 / (width * height) as f32;
        let mut pixels = vec![0.0; width * height];
        for (pairs, rows) in pairs.chunks_exact_mut(width).zip(pixels.chunks_mut(ROWS * width)) {
            for (i, row) in rows.chunks_exact_mut(width).enumerate() {
                for (pair, pixel) in pairs.iter_mut().zip(row) {
                    *pixel = part_mut(pair, i % 2).0[i / 2] * scale;
                }
            }
        }
        pixels
    }
}

/// The real part 0 or the imaginary part 1.
#[inline(always)]
fn part_mut(of: &mut Complex<Lanes>, part: usize) -> &mut Lanes {
    if part == 0 { &mut of.re } else { &mut of.im }
}

/// The Hann window over `extent` pixels: 1 at the pixel in the middle, as the Gaussian is.
pub fn hann(extent: usize) -> Vec<f32> {
    let middle = (extent / 2) as f32;
    let angle = |i: usize| std::f32::consts::TAU * (i as f32 - middle) / extent as f32;
    (0..extent).map(|i| 0.5 + 0.5 * angle(i).cos()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_comes_back_and_a_wave_has_one_frequency_of_each_half() {
        for (width, height) in [(12, 10), (11, 9), (12, 9)] {
            let wave = |i: usize| {
                let (x, y) = ((i % width) as f32, (i / width) as f32);
                (std::f32::consts::TAU * (2.0 * x / width as f32 + 3.0 * y / height as f32)).cos()
            };
            let count = (width * height) as f32;
            let pixels: Vec<f32> = (0..width * height).map(wave).collect();
            let transform = Transform::new((width, height));
            let spectrum = transform.forward(&pixels);
            for (i, k) in (0..spectrum.len()).flat_map(|i| (0..LANES).map(move |k| (i, k))) {
                let norm = spectrum[i].re.0[k].hypot(spectrum[i].im.0[k]);
                let column = i / height * LANES + k;
                let expected = if (column, i % height) == (2, 3) { count / 2.0 } else { 0.0 };
                assert!((norm - expected).abs() < 1e-3, "{width}×{height}, {i}, {k}");
            }
            let energy: Vec<Lanes> = spectrum.iter().map(|value| value.norm_sqr()).collect();
            // Parseval: the mean energy of the frequencies is the sum of the squares of the pixels.
            let squares: f32 = pixels.iter().map(|value| value * value).sum();
            assert!((transform.mean(&energy) / squares - 1.0).abs() < 1e-4, "{width}×{height}");
            let back = transform.inverse(spectrum);
            assert!(back.iter().zip(&pixels).all(|(a, b)| (a - b).abs() < 1e-5) && back.len() == pixels.len());
        }
    }
}
