//! Gaussian pyramids.

use super::warp::{cubic_taps, linear_taps, weighted};
use super::{Border, Gray, Grid, Sampling, filter};
use crate::base::{Threads, wide::wide};

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

/// The levels of a pyramid over `picture`, itself first, each [`halve`] of the one before: `count` of them, or as many as
/// leave no side of less than 16 px.
pub fn halvings(picture: &Gray, count: usize) -> Vec<Gray> {
    let mut levels = vec![picture.clone()];
    while let Some(finest) = levels.last().filter(|_| levels.len() < count) {
        if finest.width().min(finest.height()).div_ceil(2) < SMALLEST {
            break;
        }
        levels.push(halve(finest));
    }
    levels
}

/// The smallest side of a level in px.
const SMALLEST: usize = 16;

/// The levels of a pyramid over `picture`, each `factor` (between 0 and 1) times as wide and high as the one before: with the
/// picture itself `count` of them, or as many as leave no side of less than 16 px.
pub fn coarser(picture: &Grid<f32>, factor: f32, count: usize, threads: &Threads) -> Vec<Grid<f32>> {
    let mut levels = Vec::new();
    while levels.len() + 1 < count {
        let finest = levels.last().unwrap_or(picture);
        let size = [finest.width(), finest.height()].map(|side| (side as f32 * factor).round() as usize);
        if size[0].min(size[1]) < SMALLEST {
            break;
        }
        let next = shrunk(finest, (size[0], size[1]), factor, threads);
        levels.push(next);
    }
    levels
}

/// `picture` smoothed for a sampling `factor` times as dense (E. Meinhardt-Llopis and J. Sánchez, Image Processing On Line 3,
/// 2013), and sampled to `size`.
fn shrunk(picture: &Grid<f32>, size: (usize, usize), factor: f32, threads: &Threads) -> Grid<f32> {
    let sigma_px = 0.6 * (factor.powi(-2) - 1.0).sqrt();
    let smooth = filter::smooth(picture, sigma_px, filter::Beyond::Slope, threads);
    resampled(&smooth, size, Sampling::Bicubic, threads)
}

/// `picture` sampled to `size`; both cover the same area.
pub fn resampled(
    picture: &Grid<f32>,
    (width, height): (usize, usize),
    sampling: Sampling,
    threads: &Threads,
) -> Grid<f32> {
    let place = |i: usize, of: usize, count: usize| (i as f32 + 0.5) * (of as f32 / count as f32) - 0.5;
    let (columns, rows) = ((picture.width(), width), (picture.height(), height));
    let places = |(of, count): (usize, usize)| (0..count).map(move |i| place(i, of, count));
    let mut sampled = Grid::new(width, height, 0.0);
    // Every row is sampled at the same columns.
    match sampling {
        Sampling::Bilinear => {
            let across: Vec<_> = places(columns).map(|x| linear_taps(x, columns.0)).collect();
            let down: Vec<_> = places(rows).map(|y| linear_taps(y, rows.0)).collect();
            threads.rows(&mut sampled, |y, row| {
                let (rows, f) = down[y];
                bilinear_row(rows.map(|y| picture.row(y)), f, &across, row);
            });
        }
        Sampling::Bicubic => {
            let across: Vec<_> = places(columns).map(|x| cubic_taps(x, columns.0)).collect();
            let down: Vec<_> = places(rows).map(|y| cubic_taps(y, rows.0)).collect();
            threads.rows(&mut sampled, |y, row| {
                let (rows, weights) = down[y];
                bicubic_row(rows.map(|y| picture.row(y)), weights, &across, row);
            });
        }
    }
    sampled
}

/// A row between two others, the second at a distance `f` from 0 to 1, sampled at the places `across`.
fn bilinear_row([above, below]: [&[f32]; 2], f: f32, across: &[([usize; 2], f32)], to: &mut [f32]) {
    for (value, ([left, right], along)) in to.iter_mut().zip(across) {
        let mix = |row: &[f32]| row[*left] + (row[*right] - row[*left]) * along;
        let (top, bottom) = (mix(above), mix(below));
        *value = top + (bottom - top) * f;
    }
}

wide! {
    fn sums_of_rows(rows: [&[f32]; 4], weights: [f32; 4], to: &mut [f32]) = sums_of_rows_body
}

#[inline(always)]
fn sums_of_rows_body([a, b, c, d]: [&[f32]; 4], weights: [f32; 4], to: &mut [f32]) {
    for ((to, (a, b)), (c, d)) in to.iter_mut().zip(a.iter().zip(b)).zip(c.iter().zip(d)) {
        *to = weighted(weights, [*a, *b, *c, *d]);
    }
}

/// A row between four others with their weights, sampled at the places `across`.
fn bicubic_row(rows: [&[f32]; 4], weights: [f32; 4], across: &[([usize; 4], [f32; 4])], to: &mut [f32]) {
    let mut sums = vec![0.0; rows[0].len()];
    sums_of_rows(rows, weights, &mut sums);
    for (value, ([a, b, c, d], weights)) in to.iter_mut().zip(across) {
        *value = weighted(*weights, [sums[*a], sums[*b], sums[*c], sums[*d]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_shrink_by_their_factor_and_keep_waves_in_place() {
        let wave = |x: f32, y: f32| 100.0 + 40.0 * (x / 15.0).sin() + 30.0 * (y / 12.0).cos();
        let picture = Grid::from_fn(120, 90, |x, y| wave(x as f32, y as f32));
        for factor in [0.5, 0.8] {
            let levels = coarser(&picture, factor, 3, &Threads::single());
            assert_eq!(levels.len(), 2);
            for level in &levels {
                let scale = [120.0 / level.width() as f32, 90.0 / level.height() as f32];
                for (x, y) in (4..level.height() - 4).flat_map(|y| (4..level.width() - 4).map(move |x| (x, y))) {
                    let place = |i: usize, scale: f32| (i as f32 + 0.5) * scale - 0.5;
                    let truth = wave(place(x, scale[0]), place(y, scale[1]));
                    // Smoothing takes a little of the waves away.
                    assert!((level[(x, y)] - truth).abs() < 1.5, "{factor} at {x}, {y}: {}", level[(x, y)]);
                }
            }
        }
        let most = coarser(&picture, 0.5, 10, &Threads::single());
        assert_eq!(most.iter().map(Grid::size).collect::<Vec<_>>(), [(60, 45), (30, 23)]);
        assert!(coarser(&Grid::new(1, 200, 0.0), 0.5, 10, &Threads::single()).is_empty());
    }

    #[test]
    fn a_resampled_picture_is_its_samples_one_by_one() {
        let picture = Grid::from_fn(23, 17, |x, y| ((x * 37 + y * 101 + x * y * 13) % 256) as f32);
        for (sampling, size) in
            [Sampling::Bilinear, Sampling::Bicubic].into_iter().flat_map(|s| [(s, (12, 9)), (s, (46, 35))])
        {
            let found = resampled(&picture, size, sampling, &Threads::single());
            for (x, y) in (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y))) {
                let place = |i: usize, of: usize, count: usize| (i as f32 + 0.5) * (of as f32 / count as f32) - 0.5;
                let plain = sampling.sample(&picture, place(x, 23, size.0), place(y, 17, size.1));
                assert_eq!(found[(x, y)], plain, "{sampling:?} at ({x}, {y}) of {size:?}");
            }
        }
    }

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
    fn halvings_end_before_a_side_is_too_short() {
        let sizes = |count| halvings(&Grid::new(70, 61, 9), count).iter().map(Grid::size).collect::<Vec<_>>();
        assert_eq!(sizes(9), [(70, 61), (35, 31), (18, 16)]);
        assert_eq!(sizes(2), [(70, 61), (35, 31)]);
        assert_eq!(halvings(&Grid::new(1, 1, 0), 3).len(), 1);
    }

    #[test]
    fn flat_stays_flat() {
        assert_eq!(halve(&Grid::new(7, 4, 255)), Grid::new(4, 2, 255));
    }
}
