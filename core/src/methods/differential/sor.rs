//! Gauss–Seidel and SOR iterations in four colours: the even rows before the odd ones, and in each row the even columns before the
//! odd ones. No pixel has a neighbour of its own colour, so all pixels of a colour are updated at once, and the newest values do
//! not depend on the number of threads (L. M. Adams, R. J. LeVeque and D. M. Young, Analysis of the SOR iteration for the 9-point
//! Laplacian, SIAM J. Numerical Analysis 25(5), 1988). Several iterations follow each other through rows that stay in the cache.

use std::ops::Range;

use super::Field;
use super::jacobi::Rows;
use super::stencil::{BESIDE, CORNER};
use crate::base::{LANES, Threads, wide::lane};

/// Iterations that follow each other through the rows in one pass.
const DEPTH: usize = 8;

/// Values of margin on either side of the columns of one colour, a cache line.
const MARGIN: usize = 16;

/// Whether the pixel at `other` has its new value when the one at `place` is updated.
pub fn is_earlier(other: (usize, usize), place: (usize, usize)) -> bool {
    let color = |(x, y): (usize, usize)| (y % 2, x % 2);
    color(other) < color(place)
}

/// The update of one pixel, from its neighbourhood mean and its `N` coefficients.
pub trait Update<const N: usize>: Sized {
    /// Returns the new value of (u, v), without over-relaxation.
    fn update(mean: [f32; 2], factors: [f32; N]) -> [f32; 2];

    /// Updates the pixels of one colour in a row: [`row`] with the widest registers.
    fn row(around: [Around; 2], factors: [&[f32]; N], to: [&mut [f32]; 2], relaxation: f32);
}

/// The `N` coefficients of every pixel, the columns of each row by colour.
pub struct Factors<const N: usize> {
    /// For each image row N rows of the even columns, then N of the odd ones.
    rows: Rows,
}

impl<const N: usize> Factors<N> {
    /// Returns the coefficients of an image of this size; `write` computes those of a row.
    pub fn new(
        (width, height): (usize, usize),
        write: impl Fn(usize, [&mut [f32]; N]) + Sync,
        threads: &Threads,
    ) -> Self {
        let mut rows = Rows::new(width.div_ceil(2).next_multiple_of(LANES), 2 * N * height);
        let stride = rows.stride;
        threads.chunks(rows.cells_mut(), 2 * N * stride, |y, target| {
            let mut row: [Vec<f32>; N] = std::array::from_fn(|_| vec![0.0; width]);
            write(y, row.each_mut().map(Vec::as_mut_slice));
            let (even, odd) = target.split_at_mut(N * stride);
            let targets = even.chunks_exact_mut(stride).zip(odd.chunks_exact_mut(stride));
            row.iter().zip(targets).for_each(|(row, (even, odd))| split(row, [even, odd]));
        });
        Self { rows }
    }

    /// Returns the coefficients of row `y` in the columns of a parity.
    fn row(&self, y: usize, parity: usize) -> [&[f32]; N] {
        let stride = self.rows.stride;
        std::array::from_fn(|i| &self.rows.cells()[((2 * y + parity) * N + i) * stride..][..stride])
    }
}

/// Copies the even and the odd columns of a row.
fn split(row: &[f32], [even, odd]: [&mut [f32]; 2]) {
    let pairs = row.chunks_exact(2);
    if let [last] = pairs.remainder() {
        even[row.len() / 2] = *last;
    }
    for (pair, (even, odd)) in pairs.zip(even.iter_mut().zip(odd)) {
        (*even, *odd) = (pair[0], pair[1]);
    }
}

/// Copies even and odd columns back into a row.
fn join([even, odd]: [&[f32]; 2], row: &mut [f32]) {
    let half = row.len() / 2;
    let mut pairs = row.chunks_exact_mut(2);
    for (pair, (even, odd)) in (&mut pairs).zip(even.iter().zip(odd)) {
        (pair[0], pair[1]) = (*even, *odd);
    }
    if let [last] = pairs.into_remainder() {
        *last = even[half];
    }
}

/// Does `iterations` from `field` with the relaxation factor ω = `relaxation`.
pub fn iterate<const N: usize, U: Update<N>>(
    factors: &Factors<N>,
    field: &Field,
    (iterations, relaxation): (usize, f32),
    threads: &Threads,
) -> Field {
    // A band needs rows beyond it, the more, the more iterations it does.
    let at_once = if threads.count() == 1 { iterations } else { DEPTH };
    let (mut from, mut spare) = (None, None);
    for done in (0..iterations).step_by(at_once.max(1)) {
        let mut to = spare.take().unwrap_or_else(|| Field::new(field.u.size(), [0.0; 2]));
        let depth = at_once.min(iterations - done);
        in_bands::<N, U>(factors, (from.as_ref().unwrap_or(field), &mut to), (depth, relaxation), threads);
        spare = from.replace(to);
    }
    from.unwrap_or_else(|| field.clone())
}

/// Does `depth` iterations, a band of rows per thread.
fn in_bands<const N: usize, U: Update<N>>(
    factors: &Factors<N>,
    (from, to): (&Field, &mut Field),
    (depth, relaxation): (usize, f32),
    threads: &Threads,
) {
    let (width, height) = from.u.size();
    let rows = height.div_ceil(threads.count()).max(1);
    let parts = to.u.cells_mut().chunks_mut(rows * width).zip(to.v.cells_mut().chunks_mut(rows * width));
    threads.each(parts.enumerate(), |(band, (u, v))| {
        let first = band * rows;
        let band = Band { factors, rows: first..first + u.len() / width, height, depth, relaxation };
        band.run::<U>(from, [u, v]);
    });
}

/// A band of rows. Rows beyond it are computed only where its own rows need them.
struct Band<'a, const N: usize> {
    factors: &'a Factors<N>,
    rows: Range<usize>,
    /// Height of the picture.
    height: usize,
    depth: usize,
    relaxation: f32,
}

impl<const N: usize> Band<'_, N> {
    /// Returns the rows that iteration `k` must compute: an even row needs the odd ones beside it of the iteration before, and those
    /// the even ones beside them.
    fn range(&self, k: usize) -> Range<usize> {
        let more = 2 * (self.depth - k) + 2;
        self.rows.start.saturating_sub(more)..(self.rows.end + more).min(self.height)
    }

    fn run<U: Update<N>>(&self, from: &Field, to: [&mut [f32]; 2]) {
        let range = self.range(0);
        let mut held = Held::new(from, range.clone());
        for done in (0..self.depth).step_by(DEPTH) {
            let last = (done + DEPTH).min(self.depth);
            // An iteration updates row 2s and then row 2s − 1, and follows the one before by two rows.
            for time in range.start / 2..range.end / 2 + 1 + last - done {
                for k in done + 1..=last {
                    let Some(step) = time.checked_sub(k - done - 1) else { continue };
                    let rows = [Some(2 * step), (2 * step).checked_sub(1)];
                    for y in rows.into_iter().flatten().filter(|y| self.range(k).contains(y)) {
                        self.update::<U>(&mut held, y);
                    }
                }
            }
        }
        held.write(self.rows.start, to);
    }

    /// Updates row `y`: its even columns, then its odd ones.
    fn update<U: Update<N>>(&self, held: &mut Held, y: usize) {
        for parity in [0, 1] {
            // The image border is replicated.
            if y == 0 {
                held.copy(y, held.place(y) - 1);
            }
            if y + 1 == self.height {
                held.copy(y, held.place(y) + 1);
            }
            let (around, to) = held.around(y, parity);
            U::row(around, self.factors.row(y, parity), to, self.relaxation);
            held.replicate(y, parity);
        }
    }
}

/// Rows of u and v in work with one more above and below, the columns of each by colour with a margin on either side.
struct Held {
    rows: Rows,
    /// The first row of the picture that is held.
    first: usize,
    /// Number of columns of either parity.
    columns: [usize; 2],
}

/// The neighbours of the pixels of one colour in a row of u or v.
pub struct Around<'a> {
    /// Above, below, left and right.
    beside: [&'a [f32]; 4],
    /// Above to the left and right, below to the left and right.
    corner: [&'a [f32]; 4],
}

impl Held {
    fn new(from: &Field, range: Range<usize>) -> Self {
        let width = from.u.width();
        let columns = [width.div_ceil(2), width / 2];
        let length = columns[0].next_multiple_of(LANES) + 2 * MARGIN;
        let mut held = Self { rows: Rows::new(length, 4 * (range.len() + 2)), first: range.start, columns };
        for y in range {
            for (part, grid) in [&from.u, &from.v].into_iter().enumerate() {
                let (stride, start) = (held.rows.stride, held.start(held.place(y), part));
                let (even, odd) = held.rows.cells_mut()[start..start + 2 * stride].split_at_mut(stride);
                split(grid.row(y), [&mut even[MARGIN..], &mut odd[MARGIN..]]);
            }
            [0, 1].into_iter().for_each(|parity| held.replicate(y, parity));
        }
        held
    }

    /// Returns the number of a row of the picture among those held.
    fn place(&self, y: usize) -> usize {
        y + 1 - self.first
    }

    /// Returns where the even columns of a row of u (`part` 0) or v begin; the odd ones follow.
    fn start(&self, place: usize, part: usize) -> usize {
        (2 * place + part) * 2 * self.rows.stride
    }

    /// Copies row `y` to another of the rows held.
    fn copy(&mut self, y: usize, to: usize) {
        let (from, to, count) = (self.start(self.place(y), 0), self.start(to, 0), 4 * self.rows.stride);
        self.rows.cells_mut().copy_within(from..from + count, to);
    }

    /// Replicates the border of row `y` after the columns of a parity have changed.
    fn replicate(&mut self, y: usize, parity: usize) {
        let stride = self.rows.stride;
        for part in [0, 1] {
            let even = self.start(self.place(y), part) + MARGIN;
            let odd = even + stride;
            let [evens, odds] = self.columns;
            let cells = self.rows.cells_mut();
            if parity == 0 {
                cells[odd - 1] = cells[even];
            }
            // The last column is its own neighbour, among those of the other parity.
            match evens == odds {
                true if parity == 1 => cells[even + evens] = cells[odd + odds - 1],
                false if parity == 0 => cells[odd + odds] = cells[even + evens - 1],
                _ => {}
            }
        }
    }

    /// Returns the neighbours of the columns of a parity in row `y`, and these columns of u and v.
    fn around(&mut self, y: usize, parity: usize) -> ([Around<'_>; 2], [&mut [f32]; 2]) {
        let (stride, start, count) = (self.rows.stride, self.start(self.place(y), 0), self.columns[parity]);
        let (above, rest) = self.rows.cells_mut().split_at_mut(start);
        let (here, below) = rest.split_at_mut(4 * stride);
        let (above, below) = (&above[above.len() - 4 * stride..], &below[..4 * stride]);
        let (here_u, here_v) = here.split_at_mut(2 * stride);
        let [(u, other_u), (v, other_v)] = [here_u, here_v].map(|row| {
            let (even, odd) = row.split_at_mut(stride);
            if parity == 0 { (even, &*odd) } else { (odd, &*even) }
        });
        let [(above_u, above_v), (below_u, below_v)] = [above, below].map(|rows| rows.split_at(2 * stride));
        let around = [
            Around::new([above_u, below_u], other_u, (parity, count)),
            Around::new([above_v, below_v], other_v, (parity, count)),
        ];
        (around, [&mut u[MARGIN..MARGIN + count], &mut v[MARGIN..MARGIN + count]])
    }

    /// Writes rows from `first` on to u and v.
    fn write(&self, first: usize, to: [&mut [f32]; 2]) {
        let (stride, width) = (self.rows.stride, self.columns[0] + self.columns[1]);
        for (part, to) in to.into_iter().enumerate() {
            for (i, row) in to.chunks_exact_mut(width).enumerate() {
                let held = &self.rows.cells()[self.start(self.place(first + i), part)..][..2 * stride];
                let (even, odd) = held.split_at(stride);
                join([&even[MARGIN..], &odd[MARGIN..]], row);
            }
        }
    }
}

impl<'a> Around<'a> {
    /// Returns the neighbours of `count` columns of a parity, from the rows above and below and the row's other columns.
    fn new(rows: [&'a [f32]; 2], other: &'a [f32], (parity, count): (usize, usize)) -> Self {
        let (stride, length) = (other.len(), count.next_multiple_of(LANES));
        // Column k of the even ones lies between the odd columns k − 1 and k, of the odd ones between the even columns k and k + 1.
        let [left, right] = [MARGIN + parity - 1, MARGIN + parity];
        let same = |row: &'a [f32]| &row[parity * stride + MARGIN..][..length];
        let [left_of, right_of] = [left, right].map(|first| move |row: &'a [f32]| &row[first..first + length]);
        let [above, below] = rows;
        let across = |row: &'a [f32]| &row[(1 - parity) * stride..][..stride];
        let [above_other, below_other] = rows.map(across);
        Self {
            beside: [same(above), same(below), left_of(other), right_of(other)],
            corner: [left_of(above_other), right_of(above_other), left_of(below_other), right_of(below_other)],
        }
    }

    /// Returns the neighbourhood means of a vector of pixels from `start`, if they are there.
    #[inline(always)]
    fn mean(&self, start: usize) -> Option<[f32; LANES]> {
        let [a, b, c, d] = self.beside;
        let (a, b, c, d) = (lane(a, start)?, lane(b, start)?, lane(c, start)?, lane(d, start)?);
        let [e, f, g, h] = self.corner;
        let (e, f, g, h) = (lane(e, start)?, lane(f, start)?, lane(g, start)?, lane(h, start)?);
        let mut mean = [0.0; LANES];
        for i in 0..LANES {
            mean[i] = BESIDE * ((a[i] + b[i]) + (c[i] + d[i])) + CORNER * ((e[i] + f[i]) + (g[i] + h[i]));
        }
        Some(mean)
    }
}

/// Updates the pixels of one colour in a row. Vectors may reach beyond the row; what they hold there is not written.
#[inline(always)]
pub fn row<const N: usize, U: Update<N>>(
    around: [Around; 2],
    factors: [&[f32]; N],
    [u, v]: [&mut [f32]; 2],
    relaxation: f32,
) {
    let (width, mut start) = (u.len(), 0);
    while start < width {
        let (Some(mean_u), Some(mean_v)) = (around[0].mean(start), around[1].mean(start)) else { return };
        let mut lanes = [&[0.0; LANES]; N];
        for (lanes, row) in lanes.iter_mut().zip(factors) {
            let Some(row) = lane(row, start) else { return };
            *lanes = row;
        }
        let mut to = [[0.0; LANES]; 2];
        for i in 0..LANES {
            // A loop, because a function of arrays would not be vectorised.
            let mut own = [0.0; N];
            for k in 0..N {
                own[k] = lanes[k][i];
            }
            [to[0][i], to[1][i]] = U::update([mean_u[i], mean_v[i]], own);
        }
        for (values, to) in [(&mut *u, &to[0]), (&mut *v, &to[1])] {
            relax(&mut values[start..], to, relaxation);
        }
        start += LANES;
    }
}

/// Moves the values of a vector beyond their update by the factor ω; at the end of a row there may be fewer.
#[inline(always)]
fn relax(values: &mut [f32], to: &[f32; LANES], relaxation: f32) {
    if let Some(values) = values.first_chunk_mut::<LANES>() {
        let old = *values;
        for i in 0..LANES {
            values[i] = old[i] + relaxation * (to[i] - old[i]);
        }
        return;
    }
    for (value, to) in values.iter_mut().zip(to) {
        *value += relaxation * (to - *value);
    }
}

#[cfg(test)]
mod tests {
    use super::super::relax::{GradientUpdate, mean_around};
    use super::super::stencil::update;
    use super::*;

    #[test]
    fn an_iteration_updates_each_pixel_from_the_newest_values() {
        for (width, height) in [(1, 1), (1, 5), (2, 7), (5, 2), (33, 5), (40, 2), (67, 41)] {
            let value =
                |x: usize, y: usize, k: usize| ((x * 37 + y * 101 + x * y * 13 + 7 * k) % 29) as f32 / 29.0 - 0.5;
            let write = |y: usize, rows: [&mut [f32]; 3]| {
                rows.into_iter().enumerate().for_each(|(k, row)| (0..width).for_each(|x| row[x] = value(x, y, k)));
            };
            let factors = Factors::new((width, height), write, &Threads::single());
            let part = |k: usize| crate::geometry::Grid::from_fn(width, height, |x, y| 4.0 * value(x, y, k));
            let from = Field { u: part(3), v: part(4) };
            let mut plain = from.clone();
            for _ in 0..11 {
                let before = plain.clone();
                let by_color = |color: usize| {
                    let rows = (color / 2..height).step_by(2);
                    rows.flat_map(move |y| (color % 2..width).step_by(2).map(move |x| (x, y)))
                };
                for (x, y) in (0..4).flat_map(by_color) {
                    let mean = mean_around(&plain, &before, (x, y), is_earlier);
                    let new = update(mean, [0, 1, 2].map(|k| value(x, y, k)));
                    plain.u[(x, y)] += 1.7 * (new[0] - plain.u[(x, y)]);
                    plain.v[(x, y)] += 1.7 * (new[1] - plain.v[(x, y)]);
                }
            }
            let iterate = |field: &Field, count, threads: usize| {
                let threads = Threads::new(threads).expect("threads");
                super::iterate::<3, GradientUpdate>(&factors, field, (count, 1.7), &threads)
            };
            let cells = |field: &Field| [field.u.cells().to_vec(), field.v.cells().to_vec()].concat();
            let found = cells(&iterate(&from, 11, 1));
            for threads in [2, 3] {
                assert_eq!(found, cells(&iterate(&from, 11, threads)), "{width}×{height}, {threads} threads");
            }
            let singly = (0..11).fold(from.clone(), |field, _| iterate(&field, 1, 1));
            assert_eq!(found, cells(&singly), "{width}×{height}");
            let far = cells(&plain).iter().zip(&found).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(far < 1e-4, "{width}×{height}: {far}");
        }
    }
}
