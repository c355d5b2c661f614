//! Relaxation with a windowed data term, as in the combined local-global method.
//!
//! All solvers minimise the energy Σ (w, 1)ᵀ T (w, 1) + α² Σ w_n |w − w_n|² over the displacements w = (u, v), the second sum as in
//! [`relax`](crate::methods::differential::relax).

use crate::base::{
    LANES, Threads, effort,
    wide::{lane, widest},
};
use crate::geometry::{Border, Grid, filter};
use crate::methods::differential::{Field, Linear, sor, stencil};

/// The motion tensor of every pixel: the Gaussian-smoothed products of the constraint coefficients.
///
/// The products for the increment are smoothed, because neighbours share it; then xt, yt and tt are converted to the whole
/// flow.
pub struct MotionTensor {
    /// xx, xy, yy in (gray levels/px)², xt, yt in (gray levels)²/px, tt in (gray levels)².
    parts: [Grid<f32>; 6],
}

impl MotionTensor {
    /// Returns the tensors of `linear`, smoothed by a Gaussian of standard deviation `sigma_px`; the border is mirrored.
    pub fn new(linear: &Linear, sigma_px: f32, threads: &Threads) -> Self {
        // Six products, each smoothed in two directions.
        effort::add(12 * linear.start.u.cells().len());
        let left = temporal(linear);
        let [x, y, t] = [&linear.factors.a, &linear.factors.b, &left];
        let smoothed = |a: &Grid<f32>, b: &Grid<f32>| {
            let mut product = a.clone();
            product.cells_mut().iter_mut().zip(b.cells()).for_each(|(a, b)| *a *= b);
            filter::smooth(&product, sigma_px, Border::Mirror, threads)
        };
        let mut parts = [(x, x), (x, y), (y, y), (x, t), (y, t), (t, t)].map(|(a, b)| smoothed(a, b));
        let [xx, xy, yy, xt, yt, tt] = &mut parts;
        let start = linear.start.u.cells().iter().zip(linear.start.v.cells());
        for (i, (u, v)) in start.enumerate() {
            let [xx, xy, yy] = [&xx, &xy, &yy].map(|part| part.cells()[i]);
            let (xt, yt) = (&mut xt.cells_mut()[i], &mut yt.cells_mut()[i]);
            let (of_x, of_y) = (xx * u + xy * v, xy * u + yy * v);
            tt.cells_mut()[i] += (of_x - 2.0 * *xt) * u + (of_y - 2.0 * *yt) * v;
            *xt -= of_x;
            *yt -= of_y;
        }
        Self { parts }
    }

    /// Returns xx, xy, yy, xt, yt and tt of a pixel.
    pub fn at(&self, place: (usize, usize)) -> [f32; 6] {
        self.parts.each_ref().map(|part| part[place])
    }

    /// Returns the data term at a flow field, per pixel.
    pub fn energy(&self, field: &Field) -> f64 {
        effort::add(field.u.cells().len());
        let (width, height) = field.u.size();
        let of_row =
            |y| f64::from(energy_row(self.parts.each_ref().map(|part| part.row(y)), [field.u.row(y), field.v.row(y)]));
        (0..height).map(of_row).sum::<f64>() / (width * height) as f64
    }
}

widest! {
    fn energy_row(tensor: [&[f32]; 6], field: [&[f32]; 2]) -> f32 = energy_of_row
}

/// The data term of a row.
#[inline(always)]
fn energy_of_row(tensor: [&[f32]; 6], field: [&[f32]; 2]) -> f32 {
    let of = |[xx, xy, yy, xt, yt, tt]: [f32; 6], [u, v]: [f32; 2]| {
        (xx * u + 2.0 * (xy * v + xt)) * u + (yy * v + 2.0 * yt) * v + tt
    };
    let [xx, xy, yy, xt, yt, tt] = tensor;
    let (mut lanes, mut x, mut rest) = ([0.0; LANES], 0, 0.0);
    while let (Some(xx), Some(xy), Some(yy), Some(xt), Some(yt), Some(tt), Some(u), Some(v)) = (
        lane(xx, x),
        lane(xy, x),
        lane(yy, x),
        lane(xt, x),
        lane(yt, x),
        lane(tt, x),
        lane(field[0], x),
        lane(field[1], x),
    ) {
        for i in 0..LANES {
            lanes[i] += of([xx[i], xy[i], yy[i], xt[i], yt[i], tt[i]], [u[i], v[i]]);
        }
        x += LANES;
    }
    (x..xx.len()).for_each(|x| rest += of(tensor.map(|row| row[x]), field.map(|row| row[x])));
    lanes.iter().sum::<f32>() + rest
}

/// I_t of the warped frame: the constant term for the increment.
fn temporal(linear: &Linear) -> Grid<f32> {
    let mut left = linear.factors.c.clone();
    let gradients = linear.factors.a.cells().iter().zip(linear.factors.b.cells());
    let start = linear.start.u.cells().iter().zip(linear.start.v.cells());
    for (t, ((a, b), (u, v))) in left.cells_mut().iter_mut().zip(gradients.zip(start)) {
        *t += a * u + b * v;
    }
    left
}

/// The update of a pixel from its neighbourhood mean (u, v): the solution of (T + α² I) w = α² (u, v) − (xt, yt), as A and b of
/// A (u, v) + b; prepared for its solver.
pub enum Local {
    /// Jacobi iterations. A: uu, uv, vv; then b: u, v.
    Jacobi([Grid<f32>; 5]),
    /// Gauss–Seidel and SOR, with the relaxation factor ω; 1 is Gauss–Seidel.
    Sor(sor::Factors<5>, f32),
}

impl Local {
    /// Solves for the regularisation weight `alpha`, for SOR with the factor `relaxation`, or for Jacobi without one.
    pub fn new(tensor: &MotionTensor, alpha: f32, relaxation: Option<f32>, threads: &Threads) -> Self {
        let size @ (width, height) = tensor.parts[0].size();
        let [xx, xy, yy, xt, yt, _] = &tensor.parts;
        let write = |y: usize, to: [&mut [f32]; 5]| {
            let rows = [xx.row(y), xy.row(y), yy.row(y), xt.row(y), yt.row(y)];
            solve_row(rows, alpha, to);
        };
        if let Some(relaxation) = relaxation {
            return Self::Sor(sor::Factors::new(size, write, threads), relaxation);
        }
        let mut factors = [(); 5].map(|()| Grid::new(width, height, 0.0));
        threads.rows_of(factors.each_mut(), |y, mut to| write(y, to.each_mut().map(|row| &mut **row)));
        Self::Jacobi(factors)
    }

    /// Does `iterations` from `field`.
    pub fn iterate(&self, field: &Field, iterations: usize, threads: &Threads) -> Field {
        effort::add(iterations * field.u.cells().len());
        match self {
            Self::Jacobi(factors) => jacobi(factors, field, iterations, threads),
            Self::Sor(factors, relaxation) => {
                sor::iterate::<5, Self>(factors, field, (iterations, *relaxation), threads)
            }
        }
    }
}

widest! {
    fn solve_row(tensor: [&[f32]; 5], alpha: f32, to: [&mut [f32]; 5]) = solve
}

/// A and b of the pixels of a row with these motion tensors.
#[inline(always)]
fn solve([xx, xy, yy, xt, yt]: [&[f32]; 5], alpha: f32, [uu, uv, vv, u, v]: [&mut [f32]; 5]) {
    let weight = f64::from(alpha) * f64::from(alpha);
    for x in 0..uu.len() {
        let (xy, xt, yt) = (f64::from(xy[x]), f64::from(xt[x]), f64::from(yt[x]));
        let (xx, yy) = (f64::from(xx[x]) + weight, f64::from(yy[x]) + weight);
        let det = xx * yy - xy * xy;
        uu[x] = (weight * yy / det) as f32;
        uv[x] = (-weight * xy / det) as f32;
        vv[x] = (weight * xx / det) as f32;
        u[x] = ((xy * yt - yy * xt) / det) as f32;
        v[x] = ((xy * xt - xx * yt) / det) as f32;
    }
}

impl sor::Update<5> for Local {
    #[inline(always)]
    fn update(mean: [f32; 2], factors: [f32; 5]) -> [f32; 2] {
        solution(factors, mean)
    }

    fn row(around: [sor::Around; 2], factors: [&[f32]; 5], to: [&mut [f32]; 2], relaxation: f32) {
        widest! {
            fn wide(around: [sor::Around; 2], factors: [&[f32]; 5], to: [&mut [f32]; 2], relaxation: f32)
                = sor::row::<5, Local>
        }
        wide(around, factors, to, relaxation);
    }
}

/// Does `iterations` Jacobi iterations from `field`: all pixels from the means of the previous iteration.
fn jacobi(factors: &[Grid<f32>; 5], field: &Field, iterations: usize, threads: &Threads) -> Field {
    let (mut field, mut to) = (field.clone(), field.clone());
    let (width, height) = field.u.size();
    let rows = height.div_ceil(threads.count()).max(1);
    for _ in 0..iterations {
        let bands = to.u.cells_mut().chunks_mut(rows * width).zip(to.v.cells_mut().chunks_mut(rows * width));
        threads.each(bands.enumerate(), |(band, (u, v))| {
            for (i, (u, v)) in u.chunks_exact_mut(width).zip(v.chunks_exact_mut(width)).enumerate() {
                let y = band * rows + i;
                let around = [y.saturating_sub(1), y, (y + 1).min(height - 1)];
                let around = [&field.u, &field.v].map(|part| around.map(|y| part.row(y)));
                row_widest(around, factors.each_ref().map(|part| part.row(y)), [u, v]);
            }
        });
        std::mem::swap(&mut field, &mut to);
    }
    field
}

/// The mean of the neighbours of pixel `x` in three rows, with the columns to its left and right.
#[inline(always)]
fn mean([above, here, below]: [&[f32]; 3], x: usize, [left, right]: [usize; 2]) -> f32 {
    stencil::BESIDE * ((above[x] + below[x]) + (here[left] + here[right]))
        + stencil::CORNER * ((above[left] + above[right]) + (below[left] + below[right]))
}

#[inline(always)]
fn solution([uu, uv, vv, u, v]: [f32; 5], [mean_u, mean_v]: [f32; 2]) -> [f32; 2] {
    [uu * mean_u + uv * mean_v + u, uv * mean_u + vv * mean_v + v]
}

widest! {
    fn row_widest(around: [[&[f32]; 3]; 2], factors: [&[f32]; 5], to: [&mut [f32]; 2]) = row
}

/// Computes a row of an iteration from three rows of the previous one.
#[inline(always)]
fn row(around: [[&[f32]; 3]; 2], factors: [&[f32]; 5], [u, v]: [&mut [f32]; 2]) {
    let width = u.len();
    let mut x = 0;
    while x < width {
        // Separate output arrays allow vectorisation.
        match lanes(around, factors, x) {
            Some(to) => {
                u[x..x + LANES].copy_from_slice(&to[0]);
                v[x..x + LANES].copy_from_slice(&to[1]);
                x += LANES;
            }
            None => {
                let mean = around.map(|rows| mean(rows, x, [x.saturating_sub(1), (x + 1).min(width - 1)]));
                [u[x], v[x]] = solution(factors.map(|row| row[x]), mean);
                x += 1;
            }
        }
    }
}

/// The flow of a vector of pixels from `start`, if it fits into the row with a pixel on either side.
#[inline(always)]
fn lanes(around: [[&[f32]; 3]; 2], factors: [&[f32]; 5], start: usize) -> Option<[[f32; LANES]; 2]> {
    let [u, v] = [around_lanes(around[0], start)?, around_lanes(around[1], start)?];
    let [a, b, c, d, e] = factors;
    let (a, b, c) = (lane(a, start)?, lane(b, start)?, lane(c, start)?);
    let (d, e) = (lane(d, start)?, lane(e, start)?);
    let mut to = [[0.0; LANES]; 2];
    for x in 0..LANES {
        let mean = |[above, here, below]: &[[&[f32; LANES]; 3]; 3]| {
            stencil::BESIDE * ((above[1][x] + below[1][x]) + (here[0][x] + here[2][x]))
                + stencil::CORNER * ((above[0][x] + above[2][x]) + (below[0][x] + below[2][x]))
        };
        [to[0][x], to[1][x]] = solution([a[x], b[x], c[x], d[x], e[x]], [mean(&u), mean(&v)]);
    }
    Some(to)
}

/// For each of three rows: the pixels from `start`, and those one px to the left and right.
#[inline(always)]
fn around_lanes(rows: [&[f32]; 3], start: usize) -> Option<[[&[f32; LANES]; 3]; 3]> {
    let left = start.checked_sub(1)?;
    let of = |row| -> Option<[&[f32; LANES]; 3]> { Some([lane(row, left)?, lane(row, start)?, lane(row, start + 1)?]) };
    Some([of(rows[0])?, of(rows[1])?, of(rows[2])?])
}
