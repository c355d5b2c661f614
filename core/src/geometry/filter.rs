//! Filters that go along rows and columns.

use std::borrow::Cow;

use super::{Border, Grid};
use crate::base::{
    LANES, Threads, effort,
    wide::{lane, widest},
};

/// Extrapolation of a picture beyond its edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beyond {
    /// With its own pixels, brought back in by a rule: for what cannot be negative.
    Pixels(Border),
    /// With its own pixels, turned by half a turn about the one at the edge, so that a slope goes on as steeply: for gray
    /// values whose derivatives are taken.
    Slope,
}

impl From<Border> for Beyond {
    fn from(border: Border) -> Self {
        Beyond::Pixels(border)
    }
}

/// A row of numbers that is weighed without being copied before.
pub trait Numbers: Copy {
    /// Its first `count` numbers.
    fn first(self, count: usize) -> Self;

    /// Number `i`.
    fn at(self, i: usize) -> f32;
}

impl<T: Copy + Into<f32>> Numbers for &[T] {
    #[inline(always)]
    fn first(self, count: usize) -> Self {
        &self[..count]
    }

    #[inline(always)]
    fn at(self, i: usize) -> f32 {
        self[i].into()
    }
}

/// The sums of `image` weighted by `across` along each row and by `down` along each column.
///
/// The middle weight belongs to the pixel itself; of an even number, the one left of (above) the middle.
///
/// # Panics
/// If the image or one of the filters is empty.
pub fn separable<T: Copy + Into<f32> + Sync>(
    image: &Grid<T>,
    filter: (&[f32], &[f32]),
    beyond: impl Into<Beyond>,
    threads: &Threads,
) -> Grid<f32> {
    effort::add(2 * image.cells().len());
    let ((width, height), beyond) = (image.size(), beyond.into());
    let mut filtered = Grid::new(width, height, 0.0);
    threads.rows(&mut filtered, |y, target| row_of(image, filter, (beyond, y), target));
    filtered
}
widest! {
    fn row_of(image: &Grid<impl Copy + Into<f32>>, filter: (&[f32], &[f32]), at: (Beyond, usize), target: &mut [f32])
        = row_of_body
}

#[inline(always)]
fn row_of_body(image: &Grid<impl Copy + Into<f32>>, filter: (&[f32], &[f32]), at: (Beyond, usize), target: &mut [f32]) {
    filtered_row((|y| image.row(y), image.height()), filter, at, &mut Vec::new(), target);
}

/// Row `y` of what [`separable`] gives, of a picture with these `rows`, so many; `row` is room to work in.
#[inline(always)]
pub fn filtered_row<N: Numbers>(
    (rows, height): (impl Fn(usize) -> N, usize),
    (across, down): (&[f32], &[f32]),
    (beyond, y): (Beyond, usize),
    row: &mut Vec<f32>,
    target: &mut [f32],
) {
    let left = (across.len() - 1) / 2;
    if across == [1.0] {
        return weigh_rows((rows, height), down, (beyond, y), target);
    }
    let width = target.len();
    // With room on either side for what `across` reaches.
    row.resize(width + across.len() - 1, 0.0);
    weigh_rows((rows, height), down, (beyond, y), &mut row[left..left + width]);
    for i in (0..left).chain(left + width..row.len()) {
        let at = i as isize - left as isize;
        row[i] = match beyond {
            Beyond::Pixels(border) => row[left + border.index(at, width)],
            Beyond::Slope => on_slope(at, width).map(|(inside, times)| times * row[left + inside]).sum(),
        };
    }
    let row = &**row;
    weigh(target, across, |k| &row[k..]);
}

/// Sets `target` to the rows around row `y` weighted by `down`.
#[inline(always)]
fn weigh_rows<N: Numbers>(
    (rows, height): (impl Fn(usize) -> N, usize),
    down: &[f32],
    (beyond, y): (Beyond, usize),
    target: &mut [f32],
) {
    let first = y as isize - ((down.len() - 1) / 2) as isize;
    match beyond {
        Beyond::Pixels(border) => weigh(target, down, |k| rows(border.index(first + k as isize, height))),
        Beyond::Slope => {
            let (first, down) = folded(down, first, height);
            weigh(target, &down, |k| rows(first + k));
        }
    }
}

/// What pixel `i` of `extent` in a row is made from where a picture goes on as [`Beyond::Slope`]: pixels inside, and how often.
fn on_slope(mut i: isize, extent: usize) -> impl Iterator<Item = (usize, f32)> {
    let (last, mut sign, mut is_inside) = (extent as isize - 1, 1.0, false);
    std::iter::from_fn(move || {
        if is_inside {
            return None;
        }
        let edge = i.clamp(0, last);
        is_inside = i == edge || last == 0;
        let times = if is_inside { sign } else { 2.0 * sign };
        (i, sign) = (2 * edge - i, -sign);
        Some((edge as usize, times))
    })
}

/// `weights` of pixels in a row of `extent`, the first being for pixel `first`: those beyond the edge are given to what
/// stands for it there. With the pixel that the first weight is for then.
fn folded(weights: &[f32], first: isize, extent: usize) -> (usize, Cow<'_, [f32]>) {
    if first >= 0 && first as usize + weights.len() <= extent {
        return (first as usize, Cow::Borrowed(weights));
    }
    let mut inside = vec![0.0; extent];
    for (i, weight) in (first..).zip(weights) {
        on_slope(i, extent).for_each(|(place, times)| inside[place] += times * weight);
    }
    (0, Cow::Owned(inside))
}

/// Sets `target` to the sum of all sources k, each `weights[k]` times; those of weight 0 are left out.
#[inline(always)]
pub fn weigh<N: Numbers>(target: &mut [f32], weights: &[f32], source: impl Fn(usize) -> N) {
    let mut taps =
        weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0).map(|(k, &weight)| (source(k), weight));
    if !add_some::<false, N>(target, &mut taps) {
        target.fill(0.0);
    }
    while add_some::<true, N>(target, &mut taps) {}
}

/// Adds the next taps, if there are any, to `target`, or where that is not `ON`, to 0. Several in one pass: the sums stay in
/// registers, and are the same as one after the other.
#[inline(always)]
fn add_some<const ON: bool, N: Numbers>(target: &mut [f32], taps: &mut impl Iterator<Item = (N, f32)>) -> bool {
    let Some(first) = taps.next() else { return false };
    match (taps.next(), taps.next(), taps.next(), taps.next()) {
        (Some(b), Some(c), Some(d), Some(e)) => add_scaled::<ON, 5, N>(target, [first, b, c, d, e]),
        (Some(b), Some(c), Some(d), None) => add_scaled::<ON, 4, N>(target, [first, b, c, d]),
        (Some(b), Some(c), ..) => add_scaled::<ON, 3, N>(target, [first, b, c]),
        (Some(b), ..) => add_scaled::<ON, 2, N>(target, [first, b]),
        _ => add_scaled::<ON, 1, N>(target, [first]),
    }
    true
}

/// One pass. The taps are inside the loop over pixels, which the compiler unrolls and turns into vector instructions along the row.
#[inline(always)]
fn add_scaled<const ON: bool, const TAPS: usize, N: Numbers>(target: &mut [f32], taps: [(N, f32); TAPS]) {
    let taps = taps.map(|(source, weight)| (source.first(target.len()), weight));
    for (i, value) in target.iter_mut().enumerate() {
        let mut sum = if ON { *value } else { 0.0 };
        for (source, weight) in taps {
            sum += weight * source.at(i);
        }
        *value = sum;
    }
}

/// The weights of a Gaussian of `sigma_px`, cut at three of it; they sum to 1, and are a single 1 for no smoothing.
pub fn gaussian(sigma_px: f32) -> Vec<f32> {
    gaussian_within(sigma_px, (3.0 * sigma_px).ceil() as usize)
}

/// The weights of a Gaussian of `sigma_px` at −`reach` to `reach` px; they sum to 1.
pub fn gaussian_within(sigma_px: f32, reach: usize) -> Vec<f32> {
    let weight = |i: usize| {
        let along = (i as f64 - reach as f64) / f64::from(sigma_px.max(1e-3));
        (-0.5 * along * along).exp()
    };
    let weights: Vec<f64> = (0..=2 * reach).map(weight).collect();
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|weight| (weight / sum) as f32).collect()
}

/// `image` smoothed by a Gaussian of `sigma_px`.
pub fn smooth<T: Copy + Into<f32> + Sync>(
    image: &Grid<T>,
    sigma_px: f32,
    beyond: impl Into<Beyond>,
    threads: &Threads,
) -> Grid<f32> {
    let weights = gaussian(sigma_px.max(0.0));
    separable(image, (&weights, &weights), beyond, threads)
}

/// The median of the 3×3 px around each pixel, the edge repeated.
pub fn median(image: &Grid<f32>, threads: &Threads) -> Grid<f32> {
    effort::add(image.cells().len());
    let (width, height) = image.size();
    let mut medians = Grid::new(width, height, 0.0);
    threads.rows(&mut medians, |y, target| {
        let rows = [y.saturating_sub(1), y, (y + 1).min(height - 1)].map(|y| {
            let row = image.row(y);
            [&row[..1], row, &row[width - 1..]].concat()
        });
        medians_of_rows(rows.each_ref().map(|row| &row[..]), target);
    });
    medians
}

widest! {
    fn medians_of_rows(rows: [&[f32]; 3], target: &mut [f32]) = medians_of_rows_body
}

/// The medians of a row, from the three rows around it with a pixel of margin on either side.
#[inline(always)]
fn medians_of_rows_body(rows: [&[f32]; 3], target: &mut [f32]) {
    for (i, target) in target.chunks_mut(LANES).enumerate() {
        let x = i * LANES;
        if let Some(medians) = medians_of_lanes(rows, x).filter(|_| target.len() == LANES) {
            target.copy_from_slice(&medians);
            continue;
        }
        for (i, median) in target.iter_mut().enumerate() {
            *median = median_of(rows.map(|row| [row[x + i], row[x + i + 1], row[x + i + 2]]));
        }
    }
}

#[inline(always)]
fn medians_of_lanes(rows: [&[f32]; 3], x: usize) -> Option<[f32; LANES]> {
    let around = |row| -> Option<[&[f32; LANES]; 3]> { Some([lane(row, x)?, lane(row, x + 1)?, lane(row, x + 2)?]) };
    let (above, here, below) = (around(rows[0])?, around(rows[1])?, around(rows[2])?);
    let mut medians = [0.0; LANES];
    for i in 0..LANES {
        let row = |row: [&[f32; LANES]; 3]| [row[0][i], row[1][i], row[2][i]];
        medians[i] = median_of([row(above), row(here), row(below)]);
    }
    Some(medians)
}

/// The median of nine: the middle one of the largest of the smallest, the middle of the middle and the smallest of the
/// largest, once each row is in order.
#[inline(always)]
fn median_of([a, b, c]: [[f32; 3]; 3]) -> f32 {
    // As one instruction, which the functions of f32 are not: those have a rule for NaN.
    let min = |a: f32, b: f32| if a < b { a } else { b };
    let max = |a: f32, b: f32| if a > b { a } else { b };
    let least = |[a, b, c]: [f32; 3]| min(min(a, b), c);
    let most = |[a, b, c]: [f32; 3]| max(max(a, b), c);
    let middle = |[a, b, c]: [f32; 3]| max(min(a, b), min(max(a, b), c));
    let low = most([least(a), least(b), least(c)]);
    let mid = middle([middle(a), middle(b), middle(c)]);
    let high = least([most(a), most(b), most(c)]);
    middle([low, mid, high])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_fifth_of_nine() {
        let image = Grid::from_fn(37, 6, |x, y| ((x * 37 + y * 101 + x * y * 13) % 29) as f32);
        let medians = median(&image, &Threads::single());
        for (x, y) in (0..6).flat_map(|y| (0..37).map(move |x| (x, y))) {
            let around = |i: isize, j: isize| image.at(x as isize + i, y as isize + j, Border::Replicate);
            let mut nine: Vec<f32> = (-1..2).flat_map(|j| (-1..2).map(move |i| around(i, j))).collect();
            nine.sort_by(f32::total_cmp);
            assert_eq!(medians[(x, y)], nine[4], "{x}, {y}");
        }
        assert_eq!(median(&Grid::new(1, 1, 3.0), &Threads::single())[(0, 0)], 3.0);
    }

    #[test]
    fn a_filter_is_the_weighted_sum_over_its_reach() {
        let image = Grid::from_fn(9, 7, |x, y| ((x * 37 + y * 101 + x * y * 13) % 256) as f32);
        let (across, down) = ([0.5, -2.0, 1.0, 0.25], [1.0, 3.0, -1.0]);
        for border in [Border::Mirror, Border::Replicate] {
            let filtered = separable(&image, (&across, &down), border, &Threads::single());
            for (x, y) in (0..7).flat_map(|y| (0..9).map(move |x| (x, y))) {
                let mut sum = 0.0;
                for (i, a) in across.iter().enumerate() {
                    for (j, d) in down.iter().enumerate() {
                        sum += a * d * image.at((x + i) as isize - 1, (y + j) as isize - 1, border);
                    }
                }
                assert!((filtered[(x, y)] - sum).abs() < 1e-3, "{border:?} at {x}, {y}");
            }
        }
    }

    #[test]
    fn a_slope_goes_on_beyond_the_edge() {
        let weights = [1.0 / 12.0, -8.0 / 12.0, 0.0, 8.0 / 12.0, -1.0 / 12.0];
        for (width, height) in [(9, 7), (2, 3), (3, 2), (4, 5)] {
            let slope = Grid::from_fn(width, height, |x, y| 4.0 * x as f32 - 3.0 * y as f32);
            for (filter, truth) in [((&weights[..], &[0.25, 0.5, 0.25][..]), 4.0), ((&[1.0], &[-1.0, 1.0]), -3.0)] {
                let found = separable(&slope, filter, Beyond::Slope, &Threads::single());
                assert!(found.cells().iter().all(|v| (v - truth).abs() < 1e-4), "{width}×{height}: {found:?}");
            }
        }
        let line = Grid::from_fn(1, 6, |_, y| (y * y) as f32);
        let across = separable(&line, (&weights, &[1.0]), Beyond::Slope, &Threads::single());
        assert!(across.cells().iter().all(|v| v.abs() < 1e-4), "a single pixel has no slope: {across:?}");
    }

    #[test]
    fn smoothing_has_the_spread_it_is_named_by_and_keeps_flat_pictures() {
        let weights = gaussian(1.5);
        let middle = (weights.len() / 2) as f32;
        let variance: f32 = weights.iter().enumerate().map(|(i, w)| w * (i as f32 - middle).powi(2)).sum();
        assert!((variance.sqrt() - 1.5).abs() < 0.02, "{}", variance.sqrt());
        assert_eq!(gaussian(0.0), [1.0]);
        let flat = smooth(&Grid::new(1, 5, 7.0), 2.0, Border::Mirror, &Threads::single());
        assert!(flat.cells().iter().all(|v| (v - 7.0).abs() < 1e-5));
        let slope = |x: usize, y: usize| 4.0 * x as f32 - y as f32;
        let smoothed = smooth(&Grid::from_fn(9, 5, slope), 2.0, Beyond::Slope, &Threads::single());
        for (x, y) in (0..5).flat_map(|y| (0..9).map(move |x| (x, y))) {
            assert!((smoothed[(x, y)] - slope(x, y)).abs() < 1e-4, "({x}, {y}) of a slope stays {}", slope(x, y));
        }
    }
}
