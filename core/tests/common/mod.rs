//! What several tests share.
#![allow(dead_code, reason = "each test uses its part of it")]

use motionscope_core::{AnyEstimator, Border, Gray, Grid, estimator};

/// The estimator `id` with these parameters.
pub fn set(id: &str, settings: &[(&str, &str)]) -> Box<dyn AnyEstimator> {
    let mut estimator = estimator(id).expect("it is there");
    settings.iter().for_each(|(name, value)| estimator.set(name, value).expect("in range"));
    estimator
}

/// Waves in all directions, so long that over a block the difference grows with the distance from the match.
pub fn waves(x: f64, y: f64) -> f64 {
    let wave = |k: f64| {
        let (period, angle) = (13.0 + 0.7 * k, k * std::f64::consts::PI / 8.0);
        ((x * angle.cos() + y * angle.sin()) * std::f64::consts::TAU / period + k * k).sin()
    };
    128.0 + 15.0 * (0..8).map(|k| wave(f64::from(k))).sum::<f64>()
}

/// Every second pixel, as the mean of 5×5 px with the weights of Burt and Adelson.
pub fn halved(picture: &Gray) -> Gray {
    let weights = [1u32, 4, 6, 4, 1];
    Grid::from_fn(picture.width().div_ceil(2), picture.height().div_ceil(2), |x, y| {
        let window = (0..5).flat_map(|j| (0..5).map(move |i| (i, j)));
        let sum: u32 = window
            .map(|(i, j)| {
                let at = picture.at((2 * x + i) as isize - 2, (2 * y + j) as isize - 2, Border::Mirror);
                weights[i] * weights[j] * u32::from(at)
            })
            .sum();
        ((sum + 128) / 256) as u8
    })
}

/// The central difference of `at` at `i` of `extent` values; at either end the difference to one side.
pub fn central(at: impl Fn(isize) -> f64, i: isize, extent: usize) -> f64 {
    let (low, high) = ((i - 1).max(0), (i + 1).min(extent as isize - 1));
    if low == high { 0.0 } else { (at(high) - at(low)) / (high - low) as f64 }
}
