//! Costs that are not a sum of one term per pixel: they need the whole block.
//!
//! All are computed from whole numbers, so they are the same on every machine.

use super::Cut;

/// The rows of the block, each with that of the candidate whose first pixel is the first of `pixels`.
fn rows<'a>(block: &'a Cut, pixels: &'a [u8], stride: usize) -> impl Iterator<Item = (&'a [u8], &'a [u8])> {
    (0..block.height).map(move |y| (&block.row(0, y)[..block.width], &pixels[y * stride..][..block.width]))
}

/// Zero-mean SAD: each block's mean is subtracted first, so the cost is invariant to a brightness offset.
pub fn zero_mean(block: &Cut, pixels: &[u8], stride: usize) -> f64 {
    let difference = |(a, b): (&u8, &u8)| i32::from(*a) - i32::from(*b);
    let sum: i32 = rows(block, pixels, stride).map(|(a, b)| a.iter().zip(b).map(difference).sum::<i32>()).sum();
    // N times as large, so that the mean is a whole number. At most 64² px: N · 255 · 2 fits.
    let count = (block.width * block.height) as i32;
    let off_mean = |pair| i64::from((count * difference(pair) - sum).unsigned_abs());
    let total: i64 = rows(block, pixels, stride).map(|(a, b)| a.iter().zip(b).map(off_mean).sum::<i64>()).sum();
    total as f64 / f64::from(count)
}

/// SATD: half the sum of the absolute coefficients of the 4×4 Hadamard transform of the differences, as in H.264 encoders.
/// For a clipped block the missing differences are zero.
pub fn hadamard(block: &Cut, pixels: &[u8], stride: usize) -> f64 {
    let corners = (0..block.height).step_by(4).flat_map(|y| (0..block.width).step_by(4).map(move |x| (x, y)));
    let total: u32 =
        corners.map(|corner| coefficients(block, pixels, stride, corner).concat().iter().sum::<u32>()).sum();
    f64::from(total / 2)
}

/// The absolute coefficients of the 4×4 px from `(x, y)` on.
pub fn coefficients(block: &Cut, pixels: &[u8], stride: usize, (x, y): (usize, usize)) -> [[u32; 4]; 4] {
    let mut tile = [[0i32; 4]; 4];
    for (j, row) in tile.iter_mut().enumerate().take(block.height - y) {
        for (i, difference) in row.iter_mut().enumerate().take(block.width - x) {
            *difference = i32::from(block.pixel(x + i, y + j)) - i32::from(pixels[(y + j) * stride + x + i]);
        }
    }
    let along = tile.map(butterfly);
    let columns: [[i32; 4]; 4] = std::array::from_fn(|i| butterfly(along.map(|row| row[i])));
    std::array::from_fn(|j| std::array::from_fn(|i| columns[i][j].unsigned_abs()))
}

/// Four numbers times the Hadamard matrix.
fn butterfly([a, b, c, d]: [i32; 4]) -> [i32; 4] {
    let (plus, minus) = ([a + c, b + d], [a - c, b - d]);
    [plus[0] + plus[1], minus[0] + minus[1], minus[0] - minus[1], plus[0] - plus[1]]
}

/// `N² ·` the variance of the block, that of the candidate, and their covariance.
pub fn moments(block: &Cut, pixels: &[u8], stride: usize) -> [i64; 3] {
    let mut sums = [0i64; 5];
    for (a, b) in rows(block, pixels, stride) {
        let mut row = [0u32; 5];
        for (&a, &b) in a.iter().zip(b) {
            let (a, b) = (u32::from(a), u32::from(b));
            for (sum, term) in row.iter_mut().zip([a, b, a * a, b * b, a * b]) {
                *sum += term;
            }
        }
        sums.iter_mut().zip(row).for_each(|(sum, row)| *sum += i64::from(row));
    }
    let ([a, b, aa, bb, ab], count) = (sums, (block.width * block.height) as i64);
    [count * aa - a * a, count * bb - b * b, count * ab - a * b]
}

/// One minus the zero-mean normalised cross-correlation of two blocks, from 0 (perfect match) to 2. Invariant to gain and
/// offset of brightness. A block without texture has correlation 0, cost 1.
pub fn correlation(block: &Cut, pixels: &[u8], stride: usize) -> f64 {
    correlation_of(moments(block, pixels, stride).map(|moment| moment as f64))
}

/// The same from the [`moments`].
#[inline(always)]
pub fn correlation_of([a, b, both]: [f64; 3]) -> f64 {
    if a == 0.0 || b == 0.0 { 1.0 } else { 1.0 - both / (a * b).sqrt() }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::{Border, Gray, Grid};

    fn cut(picture: &Gray) -> Cut {
        let mut cut = Cut::default();
        cut.take(picture, (0, 0), picture.size(), Border::Replicate);
        cut
    }

    /// Each cost of `a` against `b`.
    fn costs(a: &Gray, b: &Gray) -> [f64; 3] {
        let (block, (pixels, stride)) = (cut(a), (b.cells(), b.width()));
        [zero_mean, hadamard, correlation].map(|cost| cost(&block, pixels, stride))
    }

    fn noise(width: usize, height: usize, seed: u32) -> Gray {
        Grid::from_fn(width, height, |x, y| {
            let h = (x as u32).wrapping_mul(0x9E37_79B9) ^ (y as u32).wrapping_mul(0x85EB_CA6B) ^ seed;
            (h.wrapping_mul(0xC2B2_AE35) >> 24) as u8
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]

        #[test]
        fn costs_agree_with_their_formulas(width in 1usize..40, height in 1usize..40, seed in any::<u32>()) {
            let (a, b) = (noise(width, height, seed), noise(width, height, seed ^ 0xABCD));
            let values = |picture: &Gray| picture.cells().iter().map(|&v| f64::from(v)).collect::<Vec<_>>();
            let count = (width * height) as f64;
            let off_mean = |values: Vec<f64>| {
                let mean = values.iter().sum::<f64>() / count;
                values.into_iter().map(|v| v - mean).collect::<Vec<_>>()
            };
            let (da, db) = (off_mean(values(&a)), off_mean(values(&b)));
            let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let [zsad, satd, ncc] = costs(&a, &b);
            let expected: f64 = da.iter().zip(&db).map(|(a, b)| (a - b).abs()).sum();
            prop_assert!((zsad - expected).abs() < 1e-6 * (1.0 + expected));
            let norm = (product(&da, &da) * product(&db, &db)).sqrt();
            let expected = if norm < 1e-9 { 1.0 } else { 1.0 - product(&da, &db) / norm };
            prop_assert!((ncc - expected).abs() < 1e-9, "{ncc} {expected}");
            // H D H with the matrix written out.
            let matrix = [[1, 1, 1, 1], [1, 1, -1, -1], [1, -1, -1, 1], [1, -1, 1, -1]];
            let at = |picture: &Gray, x: usize, y: usize| picture.get(x, y).map_or(0, |&v| i64::from(v));
            let mut total = 0;
            for (x, y) in (0..height).step_by(4).flat_map(|y| (0..width).step_by(4).map(move |x| (x, y))) {
                for (i, j) in (0..4).flat_map(|j| (0..4).map(move |i| (i, j))) {
                    let mut coefficient = 0;
                    for (k, l) in (0..4).flat_map(|l| (0..4).map(move |k| (k, l))) {
                        coefficient += matrix[i][k] * matrix[j][l] * (at(&a, x + k, y + l) - at(&b, x + k, y + l));
                    }
                    total += coefficient.abs();
                }
            }
            prop_assert_eq!(satd, total as f64 / 2.0);
            prop_assert_eq!(costs(&a, &a)[..2].to_vec(), vec![0.0; 2]);
        }
    }

    #[test]
    fn changes_of_light_do_what_they_should() {
        let dark = noise(16, 16, 1).map(|v| v / 4);
        let (lighter, stronger) = (dark.map(|v| v + 30), dark.map(|v| v * 2 + 7));
        assert_eq!(costs(&dark, &lighter)[0], 0.0);
        assert!(costs(&dark, &lighter)[1] > 0.0 && costs(&dark, &stronger)[0] > 0.0);
        assert!(costs(&dark, &lighter)[2].abs() < 1e-12 && costs(&dark, &stronger)[2].abs() < 1e-12);
        assert_eq!(costs(&dark, &dark)[2], 0.0);
        assert!((costs(&dark, &dark.map(|v| 255 - v))[2] - 2.0).abs() < 1e-12);
        assert_eq!(costs(&dark, &Grid::new(16, 16, 9))[2], 1.0);
    }
}
