//! Pictures made harder: noise and a change of light, for any picture.

use super::random;
use crate::geometry::{Gray, Grid};

/// `picture` with Gaussian noise of standard deviation `sigma` gray levels, clipped to 0 to 255; `seed` chooses which.
pub fn noise(picture: &Gray, sigma: f64, seed: u64) -> Gray {
    Grid::from_fn(picture.width(), picture.height(), |x, y| {
        let gaussian = random::gaussian(random::hash(seed, x as u64, y as u64));
        level(f64::from(picture[(x, y)]) + sigma * gaussian)
    })
}

/// `gain` times `picture` plus `offset` gray levels, clipped to 0 to 255.
pub fn light(picture: &Gray, (gain, offset): (f64, f64)) -> Gray {
    picture.map(|&v| level(gain * f64::from(v) + offset))
}

/// `picture` without the `left` leftmost of its columns and as many of the rightmost as leave `width` of them. Two frames
/// that are cut at different places move by the difference more.
///
/// # Panics
/// If the picture is not wide enough.
pub fn cut(picture: &Gray, left: usize, width: usize) -> Gray {
    Grid::from_fn(width, picture.height(), |x, y| picture.row(y)[x + left])
}

fn level(value: f64) -> u8 {
    // A cast clips to the range.
    value.round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_further_left_moves_everything_to_the_right() {
        let picture = Grid::from_fn(9, 2, |x, y| (x + 10 * y) as u8);
        let [current, next] = [3, 0].map(|left| cut(&picture, left, 6));
        assert_eq!(current.row(1), [13, 14, 15, 16, 17, 18]);
        assert_eq!(next.row(1), [10, 11, 12, 13, 14, 15]);
    }

    #[test]
    fn noise_has_the_deviation_that_was_asked_for_and_light_is_exact() {
        let gray = Grid::new(200, 200, 128u8);
        let noisy = noise(&gray, 10.0, 7);
        let differences = || noisy.cells().iter().map(|&v| f64::from(v) - 128.0);
        let mean = differences().sum::<f64>() / 40_000.0;
        let deviation = (differences().map(|d| d * d).sum::<f64>() / 40_000.0 - mean * mean).sqrt();
        assert!(mean.abs() < 0.2 && (deviation - 10.0).abs() < 0.15, "{mean} {deviation}");
        assert_ne!(noise(&gray, 10.0, 8), noisy);
        assert_eq!(light(&Grid::from_fn(3, 1, |x, _| [0, 100, 250][x]), (1.1, 8.0)).cells(), [8, 118, 255]);
    }
}
