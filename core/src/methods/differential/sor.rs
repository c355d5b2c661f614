//! Gauss–Seidel and SOR iterations: rows from top to bottom, and in each row the even columns before the odd ones, so that many
//! pixels of a row are updated at once, each from the newest values. Several iterations follow each other through rows that stay
//! in the cache.

use super::Field;
use super::jacobi::Rows;
use super::stencil::{BESIDE, CORNER, update};
use crate::base::{
    LANES,
    wide::{lane, widest},
};

/// Iterations in one pass over the rows.
pub const DEPTH: usize = 8;

/// Whether the pixel at `other` has its new value when the one at `place` is updated.
pub fn is_earlier(other: (usize, usize), place: (usize, usize)) -> bool {
    other.1 < place.1 || other.1 == place.1 && other.0 % 2 < place.0 % 2
}

/// Does `depth` iterations in place with the relaxation factor ω = `relaxation`. `factors` has three rows for each image row.
pub fn iterate(factors: &Rows, field: &mut Field, depth: usize, relaxation: f32) {
    let (width, height) = field.u.size();
    let mut work = Work::new(width);
    // Row y of an iteration needs row y − 1 of the same, and row y + 1 of the one before.
    for time in 0..height + 2 * (depth - 1) {
        for y in (0..depth).filter_map(|k| time.checked_sub(2 * k)).filter(|y| *y < height) {
            let factors = [0, 1, 2].map(|i| &factors.cells()[(3 * y + i) * factors.stride..][..width]);
            if y == 0 || y + 1 == height {
                border_row(field, y, factors, relaxation);
            } else {
                work.row(field, y, factors, relaxation);
            }
        }
    }
}

/// Updates a row at the image border, which is replicated.
fn border_row(field: &mut Field, y: usize, factors: [&[f32]; 3], relaxation: f32) {
    let (width, height) = field.u.size();
    let [above, below] = [y.saturating_sub(1), (y + 1).min(height - 1)];
    for x in (0..width).step_by(2).chain((1..width).step_by(2)) {
        let (left, right) = (x.saturating_sub(1), (x + 1).min(width - 1));
        let mean = [&field.u, &field.v].map(|part| {
            BESIDE * ((part[(x, above)] + part[(x, below)]) + (part[(left, y)] + part[(right, y)]))
                + CORNER * ((part[(left, above)] + part[(right, above)]) + (part[(left, below)] + part[(right, below)]))
        });
        let new = update(mean, factors.map(|row| row[x]));
        for (part, new) in [&mut field.u, &mut field.v].into_iter().zip(new) {
            part[(x, y)] += relaxation * (new - part[(x, y)]);
        }
    }
}

/// Rows at hand: of u and of v, with a pixel of margin on either side.
struct Work {
    /// The sums of the rows above and below.
    beside: [Vec<f32>; 2],
    /// The row itself.
    here: [Vec<f32>; 2],
}

impl Work {
    fn new(width: usize) -> Self {
        let rows = || [(); 2].map(|()| vec![0.0; width + 2]);
        Self { beside: rows(), here: rows() }
    }

    /// Updates row `y`, which has one above and one below.
    fn row(&mut self, field: &mut Field, y: usize, factors: [&[f32]; 3], relaxation: f32) {
        let width = field.u.width();
        for ((part, beside), here) in [&field.u, &field.v].into_iter().zip(&mut self.beside).zip(&mut self.here) {
            for (sum, (above, below)) in beside[1..].iter_mut().zip(part.row(y - 1).iter().zip(part.row(y + 1))) {
                *sum = above + below;
            }
            (beside[0], beside[width + 1]) = (beside[1], beside[width]);
            // A pixel at the border is its own neighbour beyond it: its own value, not yet updated.
            let row = part.row(y);
            here[1..=width].copy_from_slice(row);
            (here[0], here[width + 1]) = (row[0], row[width - 1]);
        }
        let [beside_u, beside_v] = &self.beside;
        let [here_u, here_v] = &mut self.here;
        let (u, v) = (field.u.row_mut(y), field.v.row_mut(y));
        even_columns([[here_u, beside_u], [here_v, beside_v]], factors, [u, v], relaxation);
        here_u[1..=width].copy_from_slice(u);
        here_v[1..=width].copy_from_slice(v);
        odd_columns([[here_u, beside_u], [here_v, beside_v]], factors, [u, v], relaxation);
    }
}

/// A row of u or v with the sums of the rows above and below, both with a pixel of margin.
type Around<'a> = [&'a [f32]; 2];

widest! {
    fn even_columns(around: [Around; 2], factors: [&[f32]; 3], to: [&mut [f32]; 2], relaxation: f32) = columns::<0>
}

widest! {
    fn odd_columns(around: [Around; 2], factors: [&[f32]; 3], to: [&mut [f32]; 2], relaxation: f32) = columns::<1>
}

/// Updates every other column of a row, from the one numbered `PARITY` on.
#[inline(always)]
fn columns<const PARITY: usize>(around: [Around; 2], factors: [&[f32]; 3], [u, v]: [&mut [f32]; 2], relaxation: f32) {
    let (width, mut x) = (u.len(), 0);
    // Separate output arrays let the compiler vectorise.
    while let Some(to) = lanes::<PARITY>(around, factors, (x, relaxation)) {
        u[x..x + LANES].copy_from_slice(&to[0]);
        v[x..x + LANES].copy_from_slice(&to[1]);
        x += LANES;
    }
    for x in (x..width).filter(|x| x % 2 == PARITY) {
        let mean = around.map(|[here, beside]| mean([here[x], here[x + 2]], [beside[x], beside[x + 1], beside[x + 2]]));
        let new = update(mean, factors.map(|row| row[x]));
        u[x] += relaxation * (new[0] - u[x]);
        v[x] += relaxation * (new[1] - v[x]);
    }
}

#[inline(always)]
fn mean([left, right]: [f32; 2], [beside_left, beside, beside_right]: [f32; 3]) -> f32 {
    BESIDE * (beside + (left + right)) + CORNER * (beside_left + beside_right)
}

/// The new values of a vector of pixels from `start`, if it fits into the row. All columns are computed, since registers hold
/// consecutive ones.
#[inline(always)]
fn lanes<const PARITY: usize>(
    around: [Around; 2],
    [a, b, c]: [&[f32]; 3],
    (start, relaxation): (usize, f32),
) -> Option<[[f32; LANES]; 2]> {
    let (a, b, c) = (lane(a, start)?, lane(b, start)?, lane(c, start)?);
    let [u, v] = [triple(around[0][0], start)?, triple(around[1][0], start)?];
    let [beside_u, beside_v] = [triple(around[0][1], start)?, triple(around[1][1], start)?];
    let mut to = [[0.0; LANES]; 2];
    for x in 0..LANES {
        let mean = |here: [&[f32; LANES]; 3], beside: [&[f32; LANES]; 3]| {
            mean([here[0][x], here[2][x]], [beside[0][x], beside[1][x], beside[2][x]])
        };
        let new = update([mean(u, beside_u), mean(v, beside_v)], [a[x], b[x], c[x]]);
        let old = [u[1][x], v[1][x]];
        for i in 0..2 {
            to[i][x] = if x % 2 == PARITY { old[i] + relaxation * (new[i] - old[i]) } else { old[i] };
        }
    }
    Some(to)
}

/// The pixels left of a vector, itself and right of it, in a row with a pixel of margin.
#[inline(always)]
fn triple(row: &[f32], start: usize) -> Option<[&[f32; LANES]; 3]> {
    Some([lane(row, start)?, lane(row, start + 1)?, lane(row, start + 2)?])
}

#[cfg(test)]
mod tests {
    use super::super::relax::mean_around;
    use super::*;
    use crate::geometry::Grid;

    #[test]
    fn an_iteration_updates_each_pixel_from_the_newest_values() {
        for (width, height) in [(1, 1), (1, 5), (2, 7), (33, 5), (40, 2), (67, 21)] {
            let value =
                |x: usize, y: usize, k: usize| ((x * 37 + y * 101 + x * y * 13 + 7 * k) % 29) as f32 / 29.0 - 0.5;
            let mut factors = Rows::new(width, 3 * height);
            let stride = factors.stride;
            for (i, row) in factors.cells_mut().chunks_mut(stride).take(3 * height).enumerate() {
                (0..width).for_each(|x| row[x] = value(x, i / 3, i % 3));
            }
            let part = |k: usize| Grid::from_fn(width, height, |x, y| 4.0 * value(x, y, k));
            let from = Field { u: part(3), v: part(4) };
            let mut plain = from.clone();
            for _ in 0..3 {
                let before = plain.clone();
                let by_row = |y: usize| (0..width).step_by(2).chain((1..width).step_by(2)).map(move |x| (x, y));
                for place in (0..height).flat_map(by_row) {
                    let at = |i: usize| factors.cells()[(3 * place.1 + i) * stride + place.0];
                    let mean = mean_around(&plain, &before, place, is_earlier);
                    let new = update(mean, [at(0), at(1), at(2)]);
                    plain.u[place] += 1.7 * (new[0] - plain.u[place]);
                    plain.v[place] += 1.7 * (new[1] - plain.v[place]);
                }
            }
            let (mut at_once, mut singly) = (from.clone(), from);
            iterate(&factors, &mut at_once, 3, 1.7);
            (0..3).for_each(|_| iterate(&factors, &mut singly, 1, 1.7));
            let cells = |field: &Field| [field.u.cells().to_vec(), field.v.cells().to_vec()].concat();
            assert_eq!(cells(&at_once), cells(&singly), "{width}×{height}");
            let far = cells(&plain).iter().zip(cells(&at_once)).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(far < 1e-4, "{width}×{height}: {far}");
        }
    }
}
