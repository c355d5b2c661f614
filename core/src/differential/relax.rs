//! Relaxation: each pixel is set to what fits it and the average of its neighbours, again and again.
//!
//! All solvers lessen the energy Σ (a u + b v + c)² + α² Σ wₙ |(u, v) − (u, v)ₙ|², the second sum over the pairs of
//! neighbours n with the weights of the paper's average: 1/6 beside, above and below, 1/12 across the corners; beyond the
//! edge the pixel at the edge is repeated.

use super::{Field, Linear};
use crate::{Border, Grid, Threads};

/// Weight of the neighbours beside, above and below in the average.
pub const BESIDE: f32 = 1.0 / 6.0;
/// Weight of those across the corners.
pub const CORNER: f32 = 1.0 / 12.0;
/// Iterations that are done while the rows are in the cache.
const DEPTH: usize = 16;

/// The constraints of a picture, divided by the root of α² + a² + b². From the mean (u, v) around a pixel its update is then
/// (u, v) − (a, b) (a u + b v + c).
pub struct System {
    factors: [Grid<f32>; 3],
}

impl System {
    /// The system of `linear` for a weight `alpha` of smoothness.
    pub fn new(linear: &Linear, alpha: f32, threads: &Threads) -> Self {
        let [a, b, c] = [&linear.factors.a, &linear.factors.b, &linear.factors.c];
        let scaled = |part: &Grid<f32>| {
            let mut scaled = Grid::new(part.width(), part.height(), 0.0);
            threads.rows(&mut scaled, |y, row| {
                let gradient = a.row(y).iter().zip(b.row(y));
                for ((value, part), (a, b)) in row.iter_mut().zip(part.row(y)).zip(gradient) {
                    *value = part / (alpha * alpha + a * a + b * b).sqrt();
                }
            });
            scaled
        };
        Self { factors: [scaled(a), scaled(b), scaled(c)] }
    }

    fn rows(&self, y: usize) -> [&[f32]; 3] {
        [0, 1, 2].map(|i| self.factors[i].row(y))
    }

    /// `iterations` of Jacobi's method from `field` on: all pixels at once, from the averages of the iteration before.
    pub fn jacobi(&self, field: &Field, iterations: usize, threads: &Threads) -> Field {
        let mut field = field.clone();
        let mut target = field.clone();
        let mut left = iterations;
        while left > 0 {
            let depth = left.min(DEPTH);
            self.jacobi_in_bands(&field, &mut target, depth, threads);
            std::mem::swap(&mut field, &mut target);
            left -= depth;
        }
        field
    }

    /// `depth` iterations from `from` to `to`, a band of rows for each thread.
    fn jacobi_in_bands(&self, from: &Field, to: &mut Field, depth: usize, threads: &Threads) {
        let (width, height) = from.u.size();
        let rows = height.div_ceil(threads.count()).max(1);
        let parts = to.u.cells_mut().chunks_mut(rows * width).zip(to.v.cells_mut().chunks_mut(rows * width));
        threads.each(parts.enumerate().collect(), |(band, (u, v))| {
            let band = Band { system: self, from, rows: (band * rows, (band * rows + u.len() / width)), depth };
            band.run([u, v]);
        });
    }

    /// An iteration in place, pixel by pixel along the rows, from the newest values of the neighbours; `relaxation` is 1 in
    /// Gauss and Seidel's method, and how far beyond that it goes in successive over-relaxation.
    pub fn sweep(&self, field: &mut Field, relaxation: f32) {
        let (width, height) = field.u.size();
        let mut above = [vec![0.0; width + 2], vec![0.0; width + 2]];
        let mut here = above.clone();
        let mut below = above.clone();
        for y in 0..height {
            let [a, b, c] = self.rows(y);
            for (i, part) in [&field.u, &field.v].into_iter().enumerate() {
                pad(&mut above[i], part.row(y.saturating_sub(1)));
                pad(&mut here[i], part.row(y));
                pad(&mut below[i], part.row((y + 1).min(height - 1)));
                if y == 0 {
                    above[i].clone_from(&here[i]);
                }
                if y + 1 == height {
                    below[i].clone_from(&here[i]);
                }
            }
            for x in 0..width {
                let mean = [0, 1].map(|i| average([&above[i], &here[i], &below[i]], x));
                let new = update(mean, [a[x], b[x], c[x]]);
                for i in 0..2 {
                    let value = here[i][x + 1] + relaxation * (new[i] - here[i][x + 1]);
                    here[i][x + 1] = value;
                    // The rows beyond the edge repeat it.
                    if y == 0 {
                        above[i][x + 1] = value;
                    }
                    if y + 1 == height {
                        below[i][x + 1] = value;
                    }
                }
            }
            field.u.row_mut(y).copy_from_slice(&here[0][1..=width]);
            field.v.row_mut(y).copy_from_slice(&here[1][1..=width]);
        }
    }
}

/// Copies `row` between two more pixels, the edge repeated.
fn pad(target: &mut [f32], row: &[f32]) {
    let width = row.len();
    target[1..=width].copy_from_slice(row);
    target[0] = row[0];
    target[width + 1] = row[width - 1];
}

/// The average around pixel `x` of three padded rows.
#[inline(always)]
fn average([above, here, below]: [&[f32]; 3], x: usize) -> f32 {
    BESIDE * ((above[x + 1] + below[x + 1]) + (here[x] + here[x + 2]))
        + CORNER * ((above[x] + above[x + 2]) + (below[x] + below[x + 2]))
}

/// What fits a pixel and the mean of its neighbours.
#[inline(always)]
fn update([u, v]: [f32; 2], [a, b, c]: [f32; 3]) -> [f32; 2] {
    let off = a * u + b * v + c;
    [u - a * off, v - b * off]
}

/// Some rows through which several iterations go one close behind the other, so that what one writes the next reads while
/// it is in the cache. Beyond the rows as many more are worked out as their neighbours need.
struct Band<'a> {
    system: &'a System,
    from: &'a Field,
    /// First row, and the one after the last.
    rows: (usize, usize),
    depth: usize,
}

impl Band<'_> {
    /// The rows that iteration `k` must work out.
    fn range(&self, k: usize) -> std::ops::Range<usize> {
        let more = self.depth - k;
        self.rows.0.saturating_sub(more)..(self.rows.1 + more).min(self.from.u.height())
    }

    fn run(&self, to: [&mut [f32]; 2]) {
        let [to_u, to_v] = to;
        let (width, height) = self.from.u.size();
        // Of each iteration the last three rows, padded; of the last none.
        let mut rings: Vec<[[Vec<f32>; 2]; 3]> = Vec::new();
        rings.resize_with(self.depth, || std::array::from_fn(|_| std::array::from_fn(|_| vec![0.0; width + 2])));
        let mut done = [vec![0.0; width + 2], vec![0.0; width + 2]];
        let first = self.range(0).start;
        for time in first..self.rows.1 + self.depth {
            for k in 0..=self.depth {
                let Some(y) = time.checked_sub(k).filter(|y| self.range(k).contains(y)) else { continue };
                if k == 0 {
                    let [u, v] = &mut rings[0][y % 3];
                    pad(u, self.from.u.row(y));
                    pad(v, self.from.v.row(y));
                    continue;
                }
                let (before, after) = rings.split_at_mut(k);
                let row = |y: usize| &before[k - 1][y % 3];
                let (above, here, below) = (row(y.saturating_sub(1)), row(y), row((y + 1).min(height - 1)));
                let around = [0, 1].map(|i| [&above[i][..], &here[i][..], &below[i][..]]);
                let target = after.first_mut().map_or(&mut done, |ring| &mut ring[y % 3]);
                let [u, v] = target;
                kernel(around, self.system.rows(y), [&mut u[1..=width], &mut v[1..=width]]);
                for part in [u, v] {
                    (part[0], part[width + 1]) = (part[1], part[width]);
                }
                if k == self.depth {
                    let start = (y - self.rows.0) * width;
                    to_u[start..start + width].copy_from_slice(&done[0][1..=width]);
                    to_v[start..start + width].copy_from_slice(&done[1][1..=width]);
                }
            }
        }
    }
}

/// A row of an iteration from three padded rows of the one before, with the widest registers there are; all give the same.
fn kernel(around: [[&[f32]; 3]; 2], factors: [&[f32]; 3], to: [&mut [f32]; 2]) {
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512f") {
            // SAFETY: the processor has AVX-512.
            return unsafe { row_avx512(around, factors, to) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: the processor has AVX2.
            return unsafe { row_avx2(around, factors, to) };
        }
    }
    row(around, factors, to);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn row_avx512(around: [[&[f32]; 3]; 2], factors: [&[f32]; 3], to: [&mut [f32]; 2]) {
    row(around, factors, to);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn row_avx2(around: [[&[f32]; 3]; 2], factors: [&[f32]; 3], to: [&mut [f32]; 2]) {
    row(around, factors, to);
}

/// Pixels that are worked out at once.
const LANES: usize = 16;

#[inline(always)]
fn row(around: [[&[f32]; 3]; 2], factors: [&[f32]; 3], [to_u, to_v]: [&mut [f32]; 2]) {
    let width = to_u.len();
    for start in (0..width).step_by(LANES) {
        // The last ones may be worked out twice, which changes nothing.
        let start = start.min(width.saturating_sub(LANES));
        match lanes(around, factors, start) {
            Some([u, v]) => {
                to_u[start..start + LANES].copy_from_slice(&u);
                to_v[start..start + LANES].copy_from_slice(&v);
            }
            None => {
                for x in start..width {
                    let mean = around.map(|rows| average(rows, x));
                    [to_u[x], to_v[x]] = update(mean, factors.map(|row| row[x]));
                }
            }
        }
    }
}

/// The new displacements of the pixels from `start` on, if there are so many. They are written to arrays of their own, so
/// that the compiler sees that nothing it reads is overwritten, and makes vector instructions of the loop.
#[inline(always)]
fn lanes([u, v]: [[&[f32]; 3]; 2], [a, b, c]: [&[f32]; 3], start: usize) -> Option<[[f32; LANES]; 2]> {
    let (u, v) = (around_lanes(u, start)?, around_lanes(v, start)?);
    let (a, b, c) = (lane(a, start)?, lane(b, start)?, lane(c, start)?);
    let mut to = [[0.0; LANES]; 2];
    for x in 0..LANES {
        let mean = |[above, here, below]: &[[&[f32; LANES]; 3]; 3]| {
            BESIDE * ((above[1][x] + below[1][x]) + (here[0][x] + here[2][x]))
                + CORNER * ((above[0][x] + above[2][x]) + (below[0][x] + below[2][x]))
        };
        [to[0][x], to[1][x]] = update([mean(&u), mean(&v)], [a[x], b[x], c[x]]);
    }
    Some(to)
}

#[inline(always)]
fn lane(row: &[f32], start: usize) -> Option<&[f32; LANES]> {
    row.get(start..)?.first_chunk()
}

/// Of each of three padded rows the pixels to the left of those from `start` on, they themselves, and those to the right.
#[inline(always)]
fn around_lanes(rows: [&[f32]; 3], start: usize) -> Option<[[&[f32; LANES]; 3]; 3]> {
    let of =
        |row| -> Option<[&[f32; LANES]; 3]> { Some([lane(row, start)?, lane(row, start + 1)?, lane(row, start + 2)?]) };
    Some([of(rows[0])?, of(rows[1])?, of(rows[2])?])
}

/// The two parts of the energy, on average over the pixels: how far the constraints are off, and how far neighbours differ.
pub fn energy(linear: &Linear, alpha: f32, field: &Field) -> [f64; 2] {
    let (width, height) = field.u.size();
    let (mut data, mut smoothness) = (0.0, 0.0);
    for y in 0..height {
        let rows = [y.saturating_sub(1), y, (y + 1).min(height - 1)];
        let around = [&field.u, &field.v].map(|part| rows.map(|y| part.row(y)));
        let [a, b, c] = [&linear.factors.a, &linear.factors.b, &linear.factors.c].map(|part| part.row(y));
        for x in 0..width {
            let columns = [x.saturating_sub(1), x, (x + 1).min(width - 1)];
            let [u, v] = around.map(|rows| f64::from(rows[1][x]));
            data += (f64::from(a[x]) * u + f64::from(b[x]) * v + f64::from(c[x])).powi(2);
            for (rows, value) in around.into_iter().zip([u, v]) {
                let squared = |i: usize, j: usize| (f64::from(rows[j][columns[i]]) - value).powi(2);
                let beside = squared(0, 1) + squared(2, 1) + squared(1, 0) + squared(1, 2);
                let corner = squared(0, 0) + squared(2, 0) + squared(0, 2) + squared(2, 2);
                // Each pair is met twice.
                smoothness += 0.5 * (f64::from(BESIDE) * beside + f64::from(CORNER) * corner);
            }
        }
    }
    let pixels = (width * height) as f64;
    [data / pixels, f64::from(alpha).powi(2) * smoothness / pixels]
}

/// How far displacements change from one field to the other, in px on average.
pub fn change(from: &Field, to: &Field) -> f64 {
    let parts = from.u.cells().iter().zip(to.u.cells()).zip(from.v.cells().iter().zip(to.v.cells()));
    let sum: f64 =
        parts.map(|((u, new_u), (v, new_v))| f64::from(((new_u - u).powi(2) + (new_v - v).powi(2)).sqrt())).sum();
    sum / from.u.cells().len() as f64
}

/// The average of the neighbours of a pixel, those before it in the order of the rows from `earlier`, the others from `later`.
pub fn mean_around(earlier: &Field, later: &Field, (x, y): (usize, usize)) -> [f32; 2] {
    let (width, height) = later.u.size();
    let mean = |earlier: &Grid<f32>, later: &Grid<f32>| {
        let at = |i: isize, j: isize| {
            let place =
                (Border::Replicate.index(x as isize + i, width), Border::Replicate.index(y as isize + j, height));
            if (place.1, place.0) < (y, x) { earlier[place] } else { later[place] }
        };
        BESIDE * (at(0, -1) + at(0, 1) + at(-1, 0) + at(1, 0))
            + CORNER * (at(-1, -1) + at(1, -1) + at(-1, 1) + at(1, 1))
    };
    [mean(&earlier.u, &later.u), mean(&earlier.v, &later.v)]
}
