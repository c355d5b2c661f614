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
mod tests {
    use super::*;
    use crate::products::model::IDENTITY;

    fn shift(u: f64, v: f64) -> Matrix3 {
        [[1.0, 0.0, u], [0.0, 1.0, v], [0.0, 0.0, 1.0]]
    }

    #[test]
    fn weights_keep_constants_and_lines() {
        for (t, count) in [(0, 1), (0, 2), (0, 30), (3, 30), (15, 30), (29, 30)] {
            let (first, all) = weights((t, count), 4.0);
            let sum: f64 = all.iter().sum();
            let mean: f64 = all.iter().enumerate().map(|(i, w)| w * ((first + i) as f64 - t as f64)).sum();
            assert!((sum - 1.0).abs() < 1e-12 && mean.abs() < 1e-9, "{t} of {count}: {sum}, {mean}");
        }
        let (first, all) = weights((15, 30), 2.0);
        assert!(first == 9 && all.len() == 13 && all.windows(2).take(6).all(|pair| pair[0] < pair[1]), "{all:?}");
    }

    #[test]
    fn a_steady_pan_is_not_corrected() {
        let pan: Vec<_> = (0..20).map(|t| shift(-3.0 * f64::from(t), f64::from(t))).collect();
        for t in 0..20 {
            let found = correction(&pan, t, 5.0).expect("translations have inverses");
            let off = found.as_flattened().iter().zip(IDENTITY.as_flattened()).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 1e-9, "{t}: {found:?}");
        }
    }

    #[test]
    fn a_jump_is_spread_over_its_neighbours() {
        let path: Vec<_> = (0..21).map(|t| shift(if t == 10 { 6.0 } else { 0.0 }, 0.0)).collect();
        let (_, all) = weights((10, 21), 3.0);
        // The frame moves back, except for its own weight.
        let corrected = |t| correction(&path, t, 3.0).expect("translations have inverses")[0][2];
        let found = corrected(10);
        assert!((found - (6.0 * all[all.len() / 2] - 6.0)).abs() < 1e-9, "{found}");
        assert!((0.0..1.0).contains(&corrected(8)));
    }

    #[test]
    fn a_map_without_an_inverse_has_no_correction() {
        let mut path = vec![IDENTITY; 5];
        path[1] = [[0.0; 3], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(correction(&path, 1, 2.0), None);
        // Frame 3 is beyond the horizon of frame 2.
        path[1] = IDENTITY;
        path[3] = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
        assert_eq!(correction(&path, 2, 2.0), None);
        assert!(correction(&path[..3], 2, 2.0).is_some());
    }
}
