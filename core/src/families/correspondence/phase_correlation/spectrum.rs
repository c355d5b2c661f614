//! Fourier transforms of the rows and columns of pictures, and peaks of correlations.
//!
//! The transforms are computed without wide registers, so that they are the same on every machine.

use rustfft::num_complex::Complex;
use rustfft::{Fft, FftDirection, FftPlannerScalar};

use super::Spectrum;
use crate::geometry::{Gray, Grid};

/// A peak this close to the highest one is part of it, in px.
const APART_PX: usize = 2;

/// The direction of a transform.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    /// To frequencies.
    Forward,
    /// Back to pixels, without division by their number.
    Inverse,
}

impl Direction {
    fn plan(self, length: usize) -> std::sync::Arc<dyn Fft<f64>> {
        let direction = if self == Self::Forward { FftDirection::Forward } else { FftDirection::Inverse };
        FftPlannerScalar::new().plan_fft(length, direction)
    }
}

/// The Hann window over `extent` pixels: highest in the middle, near 0 at both ends.
pub(super) fn hann(extent: usize) -> Vec<f64> {
    let angle = |i: usize| std::f64::consts::TAU * (i as f64 + 0.5) / extent as f64;
    (0..extent).map(|i| 0.5 - 0.5 * angle(i).cos()).collect()
}

pub(super) fn mean(luma: &Gray) -> f64 {
    let sum: u64 = luma.cells().iter().map(|&pixel| u64::from(pixel)).sum();
    sum as f64 / luma.cells().len().max(1) as f64
}

/// The transforms of all rows.
pub(super) fn rows(picture: &Spectrum, way: Direction) -> Spectrum {
    let mut transformed = picture.clone();
    // The plan transforms as many rows as the buffer holds.
    way.plan(picture.width()).process(transformed.cells_mut());
    transformed
}

/// The transforms of all columns.
pub(super) fn columns(picture: &Spectrum, way: Direction) -> Spectrum {
    let turned = |picture: &Spectrum| Grid::from_fn(picture.height(), picture.width(), |x, y| picture[(y, x)]);
    turned(&rows(&turned(picture), way))
}

/// The place of the highest real part, with `except` at some distance from that; the first of equals.
pub(super) fn peak(picture: &Spectrum, except: Option<(usize, usize)>) -> Option<(usize, usize)> {
    let (width, height) = picture.size();
    // The transform is periodic.
    let apart = |a: usize, b: usize, extent: usize| a.abs_diff(b).min(extent - a.abs_diff(b));
    let is_apart =
        |(x, y): (usize, usize)| except.is_none_or(|(u, v)| apart(x, u, width).max(apart(y, v, height)) >= APART_PX);
    let mut best: Option<(usize, usize)> = None;
    for place in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let is_higher = best.is_none_or(|best| picture[place].re > picture[best].re);
        if is_higher && is_apart(place) {
            best = Some(place);
        }
    }
    best
}

/// A picture of at most `most` cells a side: each is the largest value of the cells under it.
pub(super) fn reduced(picture: &Grid<f32>, most: usize) -> Grid<f32> {
    let factor = picture.width().max(picture.height()).div_ceil(most).max(1);
    let size = (picture.width().div_ceil(factor), picture.height().div_ceil(factor));
    Grid::from_fn(size.0, size.1, |x, y| {
        let rows = y * factor..((y + 1) * factor).min(picture.height());
        let cells = rows.flat_map(|v| &picture.row(v)[x * factor..((x + 1) * factor).min(picture.width())]);
        cells.copied().fold(f32::NEG_INFINITY, f32::max)
    })
}

/// The value at frequency 0 in the middle, as spectra are shown.
pub(super) fn centred(picture: &Spectrum, value: impl Fn(Complex<f64>) -> f64) -> Grid<f32> {
    let (width, height) = picture.size();
    let turned = |c: usize, extent: usize| (c + extent - extent / 2) % extent;
    Grid::from_fn(width, height, |x, y| value(picture[(turned(x, width), turned(y, height))]) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wave_has_a_single_frequency_and_comes_back() {
        let (width, height) = (12, 10);
        let wave = |x: usize, y: usize| (std::f64::consts::TAU * (2.0 * x as f64 / 12.0 + 3.0 * y as f64 / 10.0)).cos();
        let picture = Grid::from_fn(width, height, |x, y| Complex::new(wave(x, y), 0.0));
        let spectrum = columns(&rows(&picture, Direction::Forward), Direction::Forward);
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let expected = if [(2, 3), (10, 7)].contains(&(x, y)) { 60.0 } else { 0.0 };
            assert!((spectrum[(x, y)].norm() - expected).abs() < 1e-9, "{x}, {y}");
        }
        let back = rows(&columns(&spectrum, Direction::Inverse), Direction::Inverse);
        assert!(back.cells().iter().zip(picture.cells()).all(|(a, b)| (a / 120.0 - b).norm() < 1e-12));
        assert_eq!(centred(&spectrum, Complex::norm)[(6 + 2, 5 + 3)].round(), 60.0, "frequency 0 in the middle");
    }

    #[test]
    fn the_next_peak_is_no_neighbour_across_the_border() {
        let height = |x: usize, y: usize| {
            [((0, 0), 9.0), ((11, 9), 8.0), ((5, 5), 2.0)]
                .iter()
                .find(|(at, _)| *at == (x, y))
                .map_or(0.0, |(_, height)| *height)
        };
        let picture = Grid::from_fn(12, 10, |x, y| Complex::new(height(x, y), 0.0));
        assert_eq!(peak(&picture, None), Some((0, 0)));
        assert_eq!(peak(&picture, Some((0, 0))), Some((5, 5)));
    }
}
