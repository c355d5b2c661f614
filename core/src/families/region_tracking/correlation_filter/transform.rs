//! Fourier transforms of windows of one size.
//!
//! They are computed without wide registers, so that they are the same on every machine.

use std::sync::Arc;

use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlannerScalar};

/// Complex values of a window, row by row.
pub type Spectrum = Vec<Complex<f32>>;

/// The transforms of windows of one size. A spectrum is stored column by column.
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

    /// Transforms pixels, row by row, to frequencies, column by column.
    pub fn forward(&self, values: &mut Spectrum) {
        let (width, height) = self.size;
        self.forward[0].process(values);
        *values = transposed(values, (width, height));
        self.forward[1].process(values);
    }

    /// Transforms frequencies, column by column, back to pixels, row by row.
    pub fn inverse(&self, values: &mut Spectrum) {
        let (width, height) = self.size;
        self.inverse[1].process(values);
        *values = transposed(values, (height, width));
        self.inverse[0].process(values);
        let scale = 1.0 / (width * height) as f32;
        values.iter_mut().for_each(|value| *value *= scale);
    }
}

/// Columns as rows.
fn transposed(values: &[Complex<f32>], (width, height): (usize, usize)) -> Spectrum {
    let mut turned = Vec::with_capacity(values.len());
    for x in 0..width {
        turned.extend((0..height).map(|y| values[y * width + x]));
    }
    turned
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
    fn a_window_comes_back_and_a_wave_has_two_frequencies() {
        let (width, height) = (12, 10);
        let wave = |i: usize| {
            let (x, y) = ((i % width) as f32, (i / width) as f32);
            (std::f32::consts::TAU * (2.0 * x / 12.0 + 3.0 * y / 10.0)).cos()
        };
        let pixels: Spectrum = (0..120).map(|i| Complex::new(wave(i), 0.0)).collect();
        let transform = Transform::new((width, height));
        let mut spectrum = pixels.clone();
        transform.forward(&mut spectrum);
        for (i, value) in spectrum.iter().enumerate() {
            let expected = if [2 * height + 3, 10 * height + 7].contains(&i) { 60.0 } else { 0.0 };
            assert!((value.norm() - expected).abs() < 1e-3, "{i}");
        }
        transform.inverse(&mut spectrum);
        assert!(spectrum.iter().zip(&pixels).all(|(a, b)| (a - b).norm() < 1e-5));
    }
}
