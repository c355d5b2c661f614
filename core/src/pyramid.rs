//! Gaussian pyramids.

use crate::{Border, Gray, Grid};

/// The weights of the 5×5 px over which a pixel of the next level is taken, along each axis; they sum to 16
/// (P. J. Burt and E. H. Adelson, IEEE Trans. Communications 31(4), 1983).
const WEIGHTS: [u16; 5] = [1, 4, 6, 4, 1];

/// The next level: smoothed, then every second pixel of every second row, rounded up in number. Its pixel `(x, y)` stands
/// for the place `(2x, 2y)`.
///
/// # Panics
/// If the picture is empty.
pub fn halve(picture: &Gray) -> Gray {
    let (width, height) = picture.size();
    // A row with two px more on either side.
    let mut sums = vec![0u16; width + 4];
    let mut half = Grid::new(width.div_ceil(2), height.div_ceil(2), 0);
    for y in 0..half.height() {
        let rows = [0, 1, 2, 3, 4].map(|k| picture.row(Border::Mirror.index((2 * y + k) as isize - 2, height)));
        let [a, b, c, d, e] = rows;
        for (x, sum) in sums[2..width + 2].iter_mut().enumerate() {
            let [a, b, c, d, e] = [a[x], b[x], c[x], d[x], e[x]].map(u16::from);
            *sum = a + e + 4 * (b + d) + 6 * c;
        }
        for x in [-2, -1, width as isize, width as isize + 1] {
            sums[(x + 2) as usize] = sums[Border::Mirror.index(x, width) + 2];
        }
        for (x, pixel) in half.row_mut(y).iter_mut().enumerate() {
            let window = &sums[2 * x..2 * x + 5];
            let sum: u16 = window.iter().zip(WEIGHTS).map(|(sum, weight)| sum * weight).sum();
            *pixel = ((u32::from(sum) + 128) >> 8) as u8;
        }
    }
    half
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_is_the_weighted_mean_of_the_one_below() {
        for (width, height) in [(1, 1), (2, 5), (17, 9), (32, 24)] {
            let picture = Grid::from_fn(width, height, |x, y| ((x * 77 + y * 131 + x * y * 13) % 256) as u8);
            let half = halve(&picture);
            assert_eq!(half.size(), (width.div_ceil(2), height.div_ceil(2)));
            for (x, y) in (0..half.height()).flat_map(|y| (0..half.width()).map(move |x| (x, y))) {
                let mut sum = 0;
                for (i, j) in (0..5).flat_map(|j| (0..5).map(move |i| (i, j))) {
                    let at = picture.at((2 * x + i) as isize - 2, (2 * y + j) as isize - 2, Border::Mirror);
                    sum += u32::from(WEIGHTS[i] * WEIGHTS[j]) * u32::from(at);
                }
                assert_eq!(u32::from(half[(x, y)]), (sum + 128) / 256);
            }
        }
    }

    #[test]
    fn flat_stays_flat() {
        assert_eq!(halve(&Grid::new(7, 4, 255)), Grid::new(4, 2, 255));
    }
}
