//! Smoothing of a camera's path.
//!
//! The correction of a frame is the weighted mean of the maps from it to its neighbours, as in Y. Matsushita, E. Ofek, W. Ge, X. Tang
//! and H.-Y. Shum, Full-frame video stabilization with motion inpainting, PAMI 28(7), 2006. A local linear fit corrects the weights
//! where the neighbours of one side are missing (W. S. Cleveland, JASA 74, 1979), so that a steady pan stays as it is.

use crate::products::model::{Matrix3, inverse, normalised, product};

/// Neighbours up to this many standard deviations count.
const REACH_SIGMAS: f32 = 3.0;

/// The weights of the frames from `first` on in the smoothed place of frame `t` of `count` frames; their sum is 1, and their mean
/// offset from `t` is 0.
pub fn weights((t, count): (usize, usize), sigma: f32) -> (usize, Vec<f64>) {
    let reach = (REACH_SIGMAS * sigma).ceil() as usize;
    let (first, last) = (t.saturating_sub(reach), (t + reach).min(count - 1));
    let sigma = f64::from(sigma);
    let offset = |i: usize| i as f64 - t as f64;
    let gaussian = |i: usize| (-0.5 * (offset(i) / sigma).powi(2)).exp();
    let moment = |power: i32| (first..=last).map(|i| gaussian(i) * offset(i).powi(power)).sum::<f64>();
    let [s0, s1, s2] = [moment(0), moment(1), moment(2)];
    let spread = s0 * s2 - s1 * s1;
    let weight = |i: usize| match spread > 1e-9 * s0 * s0 {
        true => gaussian(i) * (s2 - s1 * offset(i)) / spread,
        false => gaussian(i) / s0,
    };
    (first, (first..=last).map(weight).collect())
}

/// The map from frame `t` to its place on the smoothed path, given the maps from the first frame to each; `None` if that or a map between
/// two of the frames has no inverse.
pub fn correction(to_frames: &[Matrix3], t: usize, sigma: f32) -> Option<Matrix3> {
    let back = inverse(&to_frames[t])?;
    let (first, weights) = weights((t, to_frames.len()), sigma);
    let mut sum = [[0.0; 3]; 3];
    for (map, weight) in to_frames[first..].iter().zip(&weights) {
        // The mean of maps makes sense only where all have the origin before their horizons.
        let relative = normalised(&product(map, &back)).filter(|relative| relative[2][2] == 1.0)?;
        for (entry, other) in sum.as_flattened_mut().iter_mut().zip(relative.as_flattened()) {
            *entry += weight * other;
        }
    }
    normalised(&sum).filter(|matrix| inverse(matrix).is_some())
}

#[cfg(test)]
mod tests;
