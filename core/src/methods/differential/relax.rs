//! Relaxation: iterative solution of Horn and Schunck's linear system, one pixel from the mean of its neighbours.
//!
//! All solvers minimise the energy Σ (a u + b v + c)² + α² Σ w_n |(u, v) − (u, v)_n|², the second sum over the pairs of
//! neighbours n with the paper's weights: 1/6 horizontally and vertically, 1/12 diagonally; the image border is replicated.
//! For a linear field the second sum is a third of the squared slope per pixel, so α² stands for α²/3 in the integral: the paper
//! absorbs the factor 3 of its Laplacian, 3 (mean − value), into α² as well.

use super::jacobi::{self, DEPTH, Rows};
use super::stencil::{BESIDE, CORNER, update};
use super::{Field, Linear};
use crate::base::Threads;
use crate::geometry::{Border, Grid};

/// The constraints, divided by the root of α² + a² + b²: from the neighbourhood mean (u, v) the update is then
/// (u, v) − (a, b) (a u + b v + c).
pub struct System {
    /// Rows of a, b and c, interleaved.
    factors: Rows,
}

impl System {
    /// Returns the system of `linear` for the regularisation weight `alpha`.
    pub fn new(linear: &Linear, alpha: f32, threads: &Threads) -> Self {
        let parts = [&linear.factors.a, &linear.factors.b, &linear.factors.c];
        let (width, height) = parts[0].size();
        let mut factors = Rows::new(width, 3 * height);
        let stride = factors.stride;
        threads.chunks(factors.cells_mut(), 3 * stride, |y, rows| {
            let (to_a, rest) = rows.split_at_mut(stride);
            let (to_b, to_c) = rest.split_at_mut(stride);
            let to = to_a.iter_mut().zip(to_b).zip(to_c);
            let [a, b, c] = parts.map(|part| part.row(y));
            for (((to_a, to_b), to_c), ((a, b), c)) in to.zip(a.iter().zip(b).zip(c)) {
                let share = 1.0 / (alpha * alpha + a * a + b * b).sqrt();
                (*to_a, *to_b, *to_c) = (a * share, b * share, c * share);
            }
        });
        Self { factors }
    }

    fn rows(&self, y: usize) -> [&[f32]; 3] {
        [0, 1, 2].map(|i| &self.factors.cells()[(3 * y + i) * self.factors.stride..])
    }

    /// Does `iterations` Jacobi iterations from `field`: all pixels from the means of the previous iteration.
    pub fn jacobi(&self, field: &Field, iterations: usize, threads: &Threads) -> Field {
        let (mut from, mut spare) = (None, None);
        for done in (0..iterations).step_by(DEPTH) {
            let mut to = spare.take().unwrap_or_else(|| Field::new(field.u.size(), [0.0; 2]));
            let depth = DEPTH.min(iterations - done);
            jacobi::iterate(&self.factors, from.as_ref().unwrap_or(field), &mut to, depth, threads);
            spare = from.replace(to);
        }
        from.unwrap_or_else(|| field.clone())
    }

    /// Does one iteration in place, in raster order, from the newest values of the neighbours. `relaxation` is the factor ω of
    /// successive over-relaxation; 1 is Gauss–Seidel.
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
                let mean = [0, 1].map(|i| neighbor_mean([&above[i], &here[i], &below[i]], x));
                let new = update(mean, [a[x], b[x], c[x]]);
                for i in 0..2 {
                    let value = here[i][x + 1] + relaxation * (new[i] - here[i][x + 1]);
                    here[i][x + 1] = value;
                    // Replicate the border.
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

/// Copies `row` with one replicated border pixel on either side.
fn pad(target: &mut [f32], row: &[f32]) {
    let width = row.len();
    target[1..=width].copy_from_slice(row);
    target[0] = row[0];
    target[width + 1] = row[width - 1];
}

/// The mean of the neighbours of pixel `x` in three padded rows.
#[inline(always)]
fn neighbor_mean([above, here, below]: [&[f32]; 3], x: usize) -> f32 {
    BESIDE * ((above[x + 1] + below[x + 1]) + (here[x] + here[x + 2]))
        + CORNER * ((above[x] + above[x + 2]) + (below[x] + below[x + 2]))
}

/// The data term and the smoothness term, on average per pixel.
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
                // Each pair is visited twice.
                smoothness += 0.5 * (f64::from(BESIDE) * beside + f64::from(CORNER) * corner);
            }
        }
    }
    let pixels = (width * height) as f64;
    [data / pixels, f64::from(alpha).powi(2) * smoothness / pixels]
}

/// The mean change between two fields, in px.
pub fn change(from: &Field, to: &Field) -> f64 {
    let parts = from.u.cells().iter().zip(to.u.cells()).zip(from.v.cells().iter().zip(to.v.cells()));
    let sum: f64 =
        parts.map(|((u, new_u), (v, new_v))| f64::from(((new_u - u).powi(2) + (new_v - v).powi(2)).sqrt())).sum();
    sum / from.u.cells().len() as f64
}

/// The mean of the neighbours of a pixel: those before it in raster order from `earlier`, the others from `later`.
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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::methods::differential::Constraints;

    #[test]
    fn the_smoothness_of_a_slope_is_a_third_of_its_square() {
        let zero = || Grid::new(200, 200, 0.0);
        let field = Field { u: Grid::from_fn(200, 200, |x, _| x as f32), v: zero() };
        let factors = Constraints::new((200, 200), |_, _| (), &Threads::single());
        let linear = Linear { factors, start: Arc::new(field.clone()) };
        let [data, smoothness] = energy(&linear, 5.0, &field);
        // A little less, because the last column has no right neighbour.
        assert!(data == 0.0 && (smoothness - 25.0 / 3.0).abs() < 0.01 * 25.0, "{smoothness}");
    }
}
