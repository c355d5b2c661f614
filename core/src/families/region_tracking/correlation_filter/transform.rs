//! Fourier transforms of real windows of one size.
//!
//! They are computed without wide registers, so that they are the same on every machine.

use std::sync::Arc;

use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlannerScalar};

/// The frequencies of a real window, column by column: those from 0 to half the width, because the others are their conjugates.
pub type Spectrum = Vec<Complex<f32>>;

/// The transforms of windows of one size.
pub struct Transform {
    size: (usize, usize),
    /// Along rows and columns, to frequencies and back.
    forward: [Arc<dyn Fft<f32>>; 2],
    inverse: [Arc<dyn Fft<f32>>; 2],
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

    /// Number of columns of a spectrum.
    fn columns(&self) -> usize {
        self.size.0 / 2 + 1
    }

    /// Number of values of a spectrum.
    pub fn frequencies(&self) -> usize {
        self.columns() * self.size.1
    }

    /// The mean over all frequencies of values given for those of a spectrum.
    pub fn mean(&self, values: &[f32]) -> f32 {
        let (width, height) = self.size;
        let columns = values.chunks_exact(height).enumerate();
        // A column of the other half has the values of its mirror.
        let sum: f32 = columns
            .map(|(k, column)| {
                let is_single = k == 0 || 2 * k == width;
                column.iter().sum::<f32>() * if is_single { 1.0 } else { 2.0 }
            })
            .sum();
        sum / (width * height) as f32
    }

    /// Transforms the pixels of a window, row by row.
    pub fn forward(&self, pixels: &[f32]) -> Spectrum {
        let (width, height) = self.size;
        // Two rows at once: as real and imaginary part, from which their transforms are separated by symmetry.
        let mut pairs: Spectrum = Vec::with_capacity(height.div_ceil(2) * width);
        for rows in pixels.chunks(2 * width) {
            let (first, second) = rows.split_at(width);
            pairs.extend((0..width).map(|x| Complex::new(first[x], second.get(x).copied().unwrap_or(0.0))));
        }
        self.forward[0].process(&mut pairs);
        let mut spectrum = vec![Complex::default(); self.frequencies()];
        for (k, column) in spectrum.chunks_exact_mut(height).enumerate() {
            for (j, rows) in column.chunks_mut(2).enumerate() {
                let (value, mirrored) = (pairs[j * width + k], pairs[j * width + (width - k) % width].conj());
                rows[0] = (value + mirrored) * 0.5;
                if let Some(second) = rows.get_mut(1) {
                    let apart = (value - mirrored) * 0.5;
                    *second = Complex::new(apart.im, -apart.re);
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
        let mut pairs = vec![Complex::default(); height.div_ceil(2) * width];
        let turned = |of: Complex<f32>| Complex::new(-of.im, of.re);
        for (k, column) in spectrum.chunks_exact(height).enumerate() {
            for (j, rows) in column.chunks(2).enumerate() {
                let (first, second) = (rows[0], rows.get(1).copied().unwrap_or_default());
                // The mirror first: where it is the same frequency, both are equal.
                pairs[j * width + (width - k) % width] = first.conj() + turned(second.conj());
                pairs[j * width + k] = first + turned(second);
            }
        }
        self.inverse[0].process(&mut pairs);
        let scale = 1.0 / (width * height) as f32;
        let mut pixels = Vec::with_capacity(pairs.len() * 2);
        for row in pairs.chunks_exact(width) {
            pixels.extend(row.iter().map(|value| value.re * scale));
            pixels.extend(row.iter().map(|value| value.im * scale));
        }
        pixels.truncate(width * height);
        pixels
    }
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
            for (i, value) in spectrum.iter().enumerate() {
                let expected = if i == 2 * height + 3 { count / 2.0 } else { 0.0 };
                assert!((value.norm() - expected).abs() < 1e-3, "{width}×{height}, {i}");
            }
            let energy: Vec<f32> = spectrum.iter().map(|value| value.norm_sqr()).collect();
            // Parseval: the mean energy of the frequencies is the sum of the squares of the pixels.
            let squares: f32 = pixels.iter().map(|value| value * value).sum();
            assert!((transform.mean(&energy) / squares - 1.0).abs() < 1e-4, "{width}×{height}");
            let back = transform.inverse(spectrum);
            assert!(back.iter().zip(&pixels).all(|(a, b)| (a - b).abs() < 1e-5) && back.len() == pixels.len());
        }
    }
}
