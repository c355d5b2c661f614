//! Relaxation: iterative solution of Horn and Schunck's linear system, one pixel from the mean of its neighbours.
//!
//! All solvers minimise the energy Σ (a u + b v + c)² + α² Σ w_n |(u, v) − (u, v)_n|², the second sum over the pairs of
//! neighbours n with the paper's weights: 1/6 horizontally and vertically, 1/12 diagonally; the image border is replicated.
//! For a linear field the second sum is a third of the squared slope per pixel, so α² stands for α²/3 in the integral: the paper
//! absorbs the factor 3 of its Laplacian, 3 (mean − value), into α² as well.

use super::jacobi::{self, Rows};
use super::sor;
use super::stencil::{BESIDE, CORNER, update};
use super::{Field, Linear};
use crate::base::{
    LANES, Threads, effort,
    wide::{lane, widest},
};
use crate::geometry::{Border, Grid};

/// The linear system of a warp, prepared for its solver.
///
/// The constraints are divided by the root of α² + a² + b²: from the neighbourhood mean (u, v) the update is then
/// (u, v) − (a, b) (a u + b v + c).
pub enum System {
    /// Jacobi iterations: rows of a, b and c, interleaved.
    Jacobi(Rows),
    /// Gauss–Seidel and SOR, with the relaxation factor ω; 1 is Gauss–Seidel.
    Sor(sor::Factors<3>, f32),
}

impl System {
    /// Returns the system of `linear` for the regularisation weight `alpha`, for SOR with the factor `relaxation`, or for Jacobi
    /// without one.
    pub fn new(linear: &Linear, alpha: f32, relaxation: Option<f32>, threads: &Threads) -> Self {
        let parts = [&linear.factors.a, &linear.factors.b, &linear.factors.c];
        let size @ (width, height) = parts[0].size();
        let write = |y, rows: [&mut [f32]; 3]| scale_row(parts.map(|part| part.row(y)), alpha, rows);
        if let Some(relaxation) = relaxation {
            return Self::Sor(sor::Factors::new(size, write, threads), relaxation);
        }
        let mut factors = Rows::new(width, 3 * height);
        let stride = factors.stride;
        threads.chunks(factors.cells_mut(), 3 * stride, |y, rows| {
            let (a, rest) = rows.split_at_mut(stride);
            let (b, c) = rest.split_at_mut(stride);
            write(y, [&mut a[..width], &mut b[..width], &mut c[..width]]);
        });
        Self::Jacobi(factors)
    }

    /// Does `iterations` from `field`.
    pub fn iterate(&self, field: &Field, iterations: usize, threads: &Threads) -> Field {
        effort::add(iterations * field.u.cells().len());
        match self {
            Self::Jacobi(factors) => jacobi::iterations(factors, field, iterations, threads),
            Self::Sor(factors, relaxation) => {
                sor::iterate::<3, GradientUpdate>(factors, field, (iterations, *relaxation), threads)
            }
        }
    }
}

widest! {
    fn scale_row(factors: [&[f32]; 3], alpha: f32, to: [&mut [f32]; 3]) = scale
}

/// Divides a row of constraints by the root of α² + a² + b².
#[inline(always)]
fn scale([a, b, c]: [&[f32]; 3], alpha: f32, [to_a, to_b, to_c]: [&mut [f32]; 3]) {
    let share = |a: f32, b: f32| 1.0 / (alpha * alpha + a * a + b * b).sqrt();
    let (mut x, width) = (0, a.len());
    while let (Some(a), Some(b), Some(c)) = (lane(a, x), lane(b, x), lane(c, x)) {
        let mut to = [[0.0; LANES]; 3];
        for i in 0..LANES {
            let share = share(a[i], b[i]);
            (to[0][i], to[1][i], to[2][i]) = (a[i] * share, b[i] * share, c[i] * share);
        }
        to_a[x..x + LANES].copy_from_slice(&to[0]);
        to_b[x..x + LANES].copy_from_slice(&to[1]);
        to_c[x..x + LANES].copy_from_slice(&to[2]);
        x += LANES;
    }
    for x in x..width {
        let share = share(a[x], b[x]);
        (to_a[x], to_b[x], to_c[x]) = (a[x] * share, b[x] * share, c[x] * share);
    }
}

/// The update of a pixel from its scaled constraint.
pub struct GradientUpdate;

impl sor::Update<3> for GradientUpdate {
    #[inline(always)]
    fn update(mean: [f32; 2], factors: [f32; 3]) -> [f32; 2] {
        update(mean, factors)
    }

    fn row(around: [sor::Around; 2], factors: [&[f32]; 3], to: [&mut [f32]; 2], relaxation: f32) {
        widest! {
            fn wide(around: [sor::Around; 2], factors: [&[f32]; 3], to: [&mut [f32]; 2], relaxation: f32)
                = sor::row::<3, GradientUpdate>
        }
        wide(around, factors, to, relaxation);
    }
}

/// The data term and the smoothness term, on average per pixel.
pub fn energy(linear: &Linear, alpha: f32, field: &Field) -> [f64; 2] {
    effort::add(field.u.cells().len());
    let (width, height) = field.u.size();
    let (mut data, mut smoothness) = (0.0, 0.0);
    for y in 0..height {
        let around = rows_around(field, y);
        let factors = [&linear.factors.a, &linear.factors.b, &linear.factors.c].map(|part| part.row(y));
        data += f64::from(data_row(factors, around.map(|rows| rows[1])));
        smoothness += around.iter().map(|rows| f64::from(smoothness_row(*rows))).sum::<f64>();
    }
    let pixels = (width * height) as f64;
    [data / pixels, f64::from(alpha).powi(2) * smoothness / pixels]
}

/// The smoothness term of a field, on average per pixel, without its weight.
pub fn roughness(field: &Field) -> f64 {
    effort::add(field.u.cells().len());
    let (width, height) = field.u.size();
    let of_row = |y| rows_around(field, y).iter().map(|rows| f64::from(smoothness_row(*rows))).sum::<f64>();
    (0..height).map(of_row).sum::<f64>() / (width * height) as f64
}

/// Row `y` of both components with the rows above and below it; the image border is replicated.
fn rows_around(field: &Field, y: usize) -> [[&[f32]; 3]; 2] {
    let rows = [y.saturating_sub(1), y, (y + 1).min(field.u.height() - 1)];
    [&field.u, &field.v].map(|part| rows.map(|y| part.row(y)))
}

widest! {
    fn data_row(factors: [&[f32]; 3], field: [&[f32]; 2]) -> f32 = data_of_row
}

#[inline(always)]
fn data_of_row([a, b, c]: [&[f32]; 3], [u, v]: [&[f32]; 2]) -> f32 {
    let squared = |a: f32, b: f32, c: f32, u: f32, v: f32| {
        let off = a * u + b * v + c;
        off * off
    };
    let (mut lanes, mut x, mut rest) = ([0.0; LANES], 0, 0.0);
    while let (Some(a), Some(b), Some(c), Some(u), Some(v)) =
        (lane(a, x), lane(b, x), lane(c, x), lane(u, x), lane(v, x))
    {
        (0..LANES).for_each(|i| lanes[i] += squared(a[i], b[i], c[i], u[i], v[i]));
        x += LANES;
    }
    (x..u.len()).for_each(|x| rest += squared(a[x], b[x], c[x], u[x], v[x]));
    lanes.iter().sum::<f32>() + rest
}

widest! {
    fn smoothness_row(rows: [&[f32]; 3]) -> f32 = smoothness_of_row
}

/// The smoothness term of a row of one component, without its weight.
#[inline(always)]
fn smoothness_of_row([above, here, below]: [&[f32]; 3]) -> f32 {
    let width = here.len();
    // Each pair of neighbours is visited twice.
    let of = |value: f32, beside: [f32; 4], corner: [f32; 4]| {
        let sum = |[a, b, c, d]: [f32; 4]| {
            let squared = |other: f32| (other - value) * (other - value);
            (squared(a) + squared(b)) + (squared(c) + squared(d))
        };
        0.5 * (BESIDE * sum(beside) + CORNER * sum(corner))
    };
    let at = |x: usize| {
        let (left, right) = (x.saturating_sub(1), (x + 1).min(width - 1));
        of(
            here[x],
            [here[left], here[right], above[x], below[x]],
            [above[left], above[right], below[left], below[right]],
        )
    };
    let (mut lanes, mut x, mut rest) = ([0.0; LANES], 1, at(0));
    while x + LANES < width {
        let [up, mid, down] = [above, here, below]
            .map(|row| [lane(row, x - 1), lane(row, x), lane(row, x + 1)].map(|part| part.unwrap_or(&[0.0; LANES])));
        for i in 0..LANES {
            lanes[i] += of(
                mid[1][i],
                [mid[0][i], mid[2][i], up[1][i], down[1][i]],
                [up[0][i], up[2][i], down[0][i], down[2][i]],
            );
        }
        x += LANES;
    }
    (x..width).for_each(|x| rest += at(x));
    lanes.iter().sum::<f32>() + rest
}

/// The mean change between two fields, in px.
pub fn change(from: &Field, to: &Field) -> f64 {
    effort::add(from.u.cells().len());
    let of_row = |y| f64::from(change_row([from.u.row(y), from.v.row(y)], [to.u.row(y), to.v.row(y)]));
    (0..from.u.height()).map(of_row).sum::<f64>() / from.u.cells().len() as f64
}

widest! {
    fn change_row(from: [&[f32]; 2], to: [&[f32]; 2]) -> f32 = change_of_row
}

/// The sum of the lengths of the changes of a row.
#[inline(always)]
fn change_of_row([u, v]: [&[f32]; 2], [new_u, new_v]: [&[f32]; 2]) -> f32 {
    let length = |u: f32, v: f32| (u * u + v * v).sqrt();
    let (mut lanes, mut x, mut rest) = ([0.0; LANES], 0, 0.0);
    while let (Some(u), Some(v), Some(new_u), Some(new_v)) = (lane(u, x), lane(v, x), lane(new_u, x), lane(new_v, x)) {
        (0..LANES).for_each(|i| lanes[i] += length(new_u[i] - u[i], new_v[i] - v[i]));
        x += LANES;
    }
    (x..u.len()).for_each(|x| rest += length(new_u[x] - u[x], new_v[x] - v[x]));
    lanes.iter().sum::<f32>() + rest
}

/// The mean of the neighbours of a pixel: those of which `is_earlier` says that they are updated before it (first their place, then
/// the pixel's) from `earlier`, the others from `later`.
pub fn mean_around(
    earlier: &Field,
    later: &Field,
    (x, y): (usize, usize),
    is_earlier: fn((usize, usize), (usize, usize)) -> bool,
) -> [f32; 2] {
    let (width, height) = later.u.size();
    let mean = |earlier: &Grid<f32>, later: &Grid<f32>| {
        let at = |i: isize, j: isize| {
            let place =
                (Border::Replicate.index(x as isize + i, width), Border::Replicate.index(y as isize + j, height));
            if is_earlier(place, (x, y)) { earlier[place] } else { later[place] }
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
