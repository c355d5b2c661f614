//! Jacobi iterations with temporal blocking: several iterations follow each other through rows that stay in the cache.

use super::Field;
use super::stencil::{BESIDE, update};
use crate::base::{Threads, wide::widest};

/// Iterations in one pass over the rows.
const DEPTH: usize = 16;

/// Values in a cache line.
const LINE: usize = 16;

/// Rows aligned to cache lines, so that no wide load crosses two lines.
pub struct Rows {
    cells: Vec<f32>,
    first: usize,
    /// Distance between rows, in values.
    pub stride: usize,
}

impl Rows {
    /// Returns `count` rows of at least `width` zeros.
    pub fn new(width: usize, count: usize) -> Self {
        let stride = width.next_multiple_of(LINE);
        let cells = vec![0.0; stride * count + LINE];
        // Without a known alignment rows are only slower.
        let first = cells.as_ptr().align_offset(LINE * size_of::<f32>()).min(LINE);
        Self { cells, first, stride }
    }

    /// Returns all rows, one after the other.
    pub fn cells(&self) -> &[f32] {
        &self.cells[self.first..]
    }

    /// Returns all rows for writing.
    pub fn cells_mut(&mut self) -> &mut [f32] {
        let end = self.cells.len() - LINE + self.first;
        &mut self.cells[self.first..end]
    }
}

/// Does `iterations` from `field`.
pub fn iterations(factors: &Rows, field: &Field, iterations: usize, threads: &Threads) -> Field {
    let (mut from, mut spare) = (None, None);
    for done in (0..iterations).step_by(DEPTH) {
        let mut to = spare.take().unwrap_or_else(|| Field::new(field.u.size(), [0.0; 2]));
        iterate(factors, from.as_ref().unwrap_or(field), &mut to, DEPTH.min(iterations - done), threads);
        spare = from.replace(to);
    }
    from.unwrap_or_else(|| field.clone())
}

/// Does `depth` iterations from `from` to `to`, a band of rows per thread. `factors` has three rows for each image row.
fn iterate(factors: &Rows, from: &Field, to: &mut Field, depth: usize, threads: &Threads) {
    let (width, height) = from.u.size();
    let rows = height.div_ceil(threads.count()).max(1);
    let parts = to.u.cells_mut().chunks_mut(rows * width).zip(to.v.cells_mut().chunks_mut(rows * width));
    threads.each(parts.enumerate(), |(band, (u, v))| {
        let band = Band { factors, from, rows: (band * rows, band * rows + u.len() / width), depth };
        band.run([u, v]);
    });
}

/// A band of rows through which several iterations pass in a wavefront: each reads what the one before has just written.
/// Rows beyond the band are computed only where their neighbours need them.
struct Band<'a> {
    factors: &'a Rows,
    from: &'a Field,
    /// First row and the row after the last.
    rows: (usize, usize),
    depth: usize,
}

impl Band<'_> {
    /// Returns the rows that iteration `k` must compute.
    fn range(&self, k: usize) -> std::ops::Range<usize> {
        let more = self.depth - k;
        self.rows.0.saturating_sub(more)..(self.rows.1 + more).min(self.from.u.height())
    }

    fn run(&self, mut to: [&mut [f32]; 2]) {
        let (width, height) = self.from.u.size();
        // The last three rows of u and v of each iteration but the last.
        let mut rings = Rows::new(width, 6 * (self.depth - 1));
        let stride = rings.stride;
        let place = |y: usize, part: usize| (2 * (y % 3) + part) * stride;
        let mut sums = RowSums::default();
        for time in self.range(1).start + 1..self.rows.1 + self.depth {
            for k in 1..=self.depth {
                let Some(y) = time.checked_sub(k).filter(|y| self.range(k).contains(y)) else { continue };
                let (before, after) = rings.cells_mut().split_at_mut(6 * stride * (k - 1));
                let before = &before[6 * stride * k.saturating_sub(2)..];
                let row = |y: usize, part: usize| match k {
                    1 => [&self.from.u, &self.from.v][part].row(y),
                    _ => &before[place(y, part)..][..width],
                };
                let near = [y.saturating_sub(1), y, (y + 1).min(height - 1)];
                let around = [0, 1].map(|part| near.map(|y| row(y, part)));
                let factors = [0, 1, 2].map(|i| &self.factors.cells()[(3 * y + i) * self.factors.stride..][..width]);
                let target = if k == self.depth {
                    to.each_mut().map(|part| &mut part[(y - self.rows.0) * width..][..width])
                } else {
                    let (u, v) = after[place(y, 0)..].split_at_mut(stride);
                    [&mut u[..width], &mut v[..width]]
                };
                kernel(around, factors, target, &mut sums);
            }
        }
    }
}

/// Pixels of a row in one pass; more would not fit the level-1 cache.
const STRETCH: usize = 640;

/// Column sums of a stretch of u and v with a cache line of margin: the neighbours above and below, and half of these plus the
/// pixel itself.
#[repr(align(64))]
struct RowSums {
    beside: [[f32; STRETCH + 2 * LINE]; 2],
    column: [[f32; STRETCH + 2 * LINE]; 2],
}

impl Default for RowSums {
    fn default() -> Self {
        Self { beside: [[0.0; STRETCH + 2 * LINE]; 2], column: [[0.0; STRETCH + 2 * LINE]; 2] }
    }
}

/// Three rows of the previous iteration.
type Around<'a> = [&'a [f32]; 3];

widest! {
    fn kernel(around: [Around; 2], factors: [&[f32]; 3], to: [&mut [f32]; 2], sums: &mut RowSums) = row
}

/// Computes a row of an iteration. The image border is replicated. With w = 1/6, the neighbourhood mean is w (beside + left
/// column + right column), since diagonal neighbours have half the weight.
#[inline(always)]
fn row(around: [Around; 2], factors: [&[f32]; 3], [to_u, to_v]: [&mut [f32]; 2], sums: &mut RowSums) {
    let width = to_u.len();
    for start in (0..width).step_by(STRETCH) {
        let count = STRETCH.min(width - start);
        let (first, last) = (start.saturating_sub(LINE), (start + count + LINE).min(width));
        let skip = LINE + first - start;
        for ((rows, beside), column) in around.iter().zip(&mut sums.beside).zip(&mut sums.column) {
            columns(rows.map(|row| &row[first..last]), &mut beside[skip..], &mut column[skip..]);
            if start == 0 {
                column[LINE - 1] = column[LINE];
            }
            if last == start + count {
                column[LINE + count] = column[LINE + count - 1];
            }
        }
        let [a, b, c] = factors.map(|row| &row[start..start + count]);
        let [beside_u, beside_v] = sums.beside.each_ref().map(|part| &part[LINE..LINE + count]);
        let [left_u, left_v] = sums.column.each_ref().map(|part| &part[LINE - 1..LINE - 1 + count]);
        let [right_u, right_v] = sums.column.each_ref().map(|part| &part[LINE + 1..LINE + 1 + count]);
        let (to_u, to_v) = (&mut to_u[start..start + count], &mut to_v[start..start + count]);
        for x in 0..count {
            let u = BESIDE * ((left_u[x] + right_u[x]) + beside_u[x]);
            let v = BESIDE * ((left_v[x] + right_v[x]) + beside_v[x]);
            [to_u[x], to_v[x]] = update([u, v], [a[x], b[x], c[x]]);
        }
    }
}

/// Computes the column sums of a [`RowSums`].
#[inline(always)]
fn columns([above, here, below]: Around, beside: &mut [f32], column: &mut [f32]) {
    let count = above.len();
    let (here, below) = (&here[..count], &below[..count]);
    let (beside, column) = (&mut beside[..count], &mut column[..count]);
    for x in 0..count {
        beside[x] = above[x] + below[x];
        column[x] = here[x] + 0.5 * beside[x];
    }
}

#[cfg(test)]
mod tests {
    use super::super::relax::mean_around;
    use super::*;
    use crate::geometry::Grid;

    /// Factors and a field that are rough everywhere.
    fn rough(width: usize, height: usize) -> (Rows, Field) {
        let value = |x: usize, y: usize, k: usize| ((x * 37 + y * 101 + x * y * 13 + 7 * k) % 29) as f32 / 29.0 - 0.5;
        let mut factors = Rows::new(width, 3 * height);
        let stride = factors.stride;
        for (i, row) in factors.cells_mut().chunks_mut(stride).take(3 * height).enumerate() {
            (0..width).for_each(|x| row[x] = value(x, i / 3, i % 3));
        }
        let part = |k: usize| Grid::from_fn(width, height, |x, y| 4.0 * value(x, y, k));
        (factors, Field { u: part(3), v: part(4) })
    }

    #[test]
    fn an_iteration_is_the_update_from_the_mean_around_each_pixel() {
        for (width, height) in [(1, 1), (2, 7), (33, 5), (STRETCH, 2), (STRETCH + 1, 3), (2 * STRETCH + 17, 2)] {
            let (factors, from) = rough(width, height);
            let mut to = from.clone();
            iterate(&factors, &from, &mut to, 1, &Threads::single());
            for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                let at = |i: usize| factors.cells()[(3 * y + i) * factors.stride + x];
                let plain = update(mean_around(&from, &from, (x, y), |_, _| false), [at(0), at(1), at(2)]);
                let found = to.at(x, y);
                assert!(
                    (0..2).all(|i| (found[i] - plain[i]).abs() < 1e-5),
                    "{found:?} at ({x}, {y}), plainly {plain:?}"
                );
            }
        }
    }

    #[test]
    fn iterations_behind_each_other_are_those_one_after_the_other() {
        for (width, height) in [(1, 1), (3, 50), (45, 37), (STRETCH + 5, 9)] {
            let (factors, mut one) = rough(width, height);
            let mut all = one.clone();
            iterate(&factors, &one, &mut all, 9, &Threads::new(3).expect("threads"));
            for _ in 0..9 {
                let from = one.clone();
                iterate(&factors, &from, &mut one, 1, &Threads::single());
            }
            let bits = |field: &Field| [&field.u, &field.v].map(|part| part.map(|value| value.to_bits()));
            assert_eq!(bits(&all), bits(&one), "{width}×{height}");
        }
    }
}
