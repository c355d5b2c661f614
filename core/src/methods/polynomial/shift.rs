//! Displacement estimation from polynomial expansions (G. Farnebäck, Two-frame motion estimation based on polynomial
//! expansion, SCIA 2003): A d = Δb for each pixel, solved by least squares over a window.

use super::Packed;
use crate::base::{Threads, wide::wide};
use crate::geometry::{Grid, filter::weigh};
use crate::methods::differential::{Field, Tensor, Window};

/// The polynomial expansions of frames t and t + 1, and the prior displacements.
#[derive(Clone, Copy)]
pub struct ExpansionPair<'a> {
    /// The polynomial expansions.
    pub pair: [&'a Grid<Packed>; 2],
    /// The prior displacements.
    pub from: &'a Field,
}

/// The displacement equation A d = Δb of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisplacementEquation {
    /// a_xx, a_xy and a_yy of A, the mean of both polynomials.
    pub a: [f32; 3],
    /// Δb.
    pub b: [f32; 2],
}

impl DisplacementEquation {
    /// Returns the equation of a pixel's polynomial and the one `by` px away in frame t + 1.
    #[inline(always)]
    fn between(here: &Packed, there: &Packed, by: [f32; 2]) -> Self {
        let [xx, xy, yy] = [2, 3, 4].map(|i| 0.5 * (here[i] + there[i]));
        let [x, y] = [0, 1].map(|i| 0.5 * (here[i] - there[i]));
        Self { a: [xx, xy, yy], b: [x + xx * by[0] + xy * by[1], y + xy * by[0] + yy * by[1]] }
    }

    /// Returns its two rows as lines a u + b v + c = 0.
    pub fn lines(&self) -> [[f32; 3]; 2] {
        let Self { a: [xx, xy, yy], b: [x, y] } = *self;
        [[xx, xy, -x], [xy, yy, -y]]
    }
}

/// The least-squares displacements of all windows, with their confidence.
pub struct Estimate {
    /// The displacements.
    pub field: Field,
    /// The smaller eigenvalue of the windowed mean of AᵀA.
    pub certainty: Grid<f32>,
}

/// The parts of a product row: three of AᵀA, two of AᵀΔb.
const PARTS: usize = 5;

/// Regularised least squares over a window.
pub struct WindowSolver {
    /// The window.
    pub window: Window,
    /// The regularisation weight λ of the prior displacement, in the squared unit of A.
    pub damping: f32,
}

impl ExpansionPair<'_> {
    /// Returns the pixel of frame t + 1 at the prior displacement; `None` outside.
    #[inline(always)]
    fn landing(&self, (x, y): (usize, usize), [u, v]: [f32; 2]) -> Option<(usize, usize)> {
        let (width, height) = self.from.u.size();
        let (x, y) = (x as f32 + u + 0.5, y as f32 + v + 0.5);
        // False for NaN as well.
        let is_inside = (0.0..width as f32).contains(&x) && (0.0..height as f32).contains(&y);
        is_inside.then_some((x as u32 as usize, y as u32 as usize))
    }

    /// Returns the displacement equation of a pixel and its partner in frame t + 1; `None` outside.
    pub fn shift(&self, (x, y): (usize, usize)) -> Option<(DisplacementEquation, (usize, usize))> {
        self.shift_of(&self.pair[0][(x, y)], (x, y), self.from.at(x, y))
    }

    /// Returns the same for a pixel with this polynomial and this prior displacement.
    #[inline(always)]
    fn shift_of(
        &self,
        here: &Packed,
        (x, y): (usize, usize),
        uv: [f32; 2],
    ) -> Option<(DisplacementEquation, (usize, usize))> {
        let to = self.landing((x, y), uv)?;
        let by = [to.0 as f32 - x as f32, to.1 as f32 - y as f32];
        Some((DisplacementEquation::between(here, &self.pair[1][to], by), to))
    }

    /// Returns AᵀA and AᵀΔb of each pixel.
    fn products(&self, threads: &Threads) -> Grid<f32> {
        let (width, height) = self.from.u.size();
        let mut products = Grid::new(PARTS * width, height, 0.0);
        threads.rows(&mut products, |y, row| self.product_row(y, row));
        products
    }

    /// Computes a row of products, with the widest registers available; all give the same result.
    fn product_row(&self, y: usize, row: &mut [f32]) {
        wide! {
            fn wide(of: &ExpansionPair, y: usize, row: &mut [f32]) = ExpansionPair::product_row_body
        }
        wide(self, y, row);
    }

    #[inline(always)]
    fn product_row_body(&self, y: usize, row: &mut [f32]) {
        let width = self.from.u.width();
        let [a, b, c, d, e] = parts(row, width);
        let (here, u, v) = (self.pair[0].row(y), self.from.u.row(y), self.from.v.row(y));
        // Pixels that lead outside stay 0.
        for (x, (here, (u, v))) in here.iter().zip(u.iter().zip(v)).enumerate() {
            if let Some((DisplacementEquation { a: [xx, xy, yy], b: [bx, by] }, _)) =
                self.shift_of(here, (x, y), [*u, *v])
            {
                (a[x], b[x], c[x], d[x], e[x]) = (xx, xy, yy, bx, by);
            }
        }
        for x in 0..width {
            let (xx, xy, yy, bx, by) = (a[x], b[x], c[x], d[x], e[x]);
            (a[x], b[x], c[x]) = (xx * xx + xy * xy, xy * (xx + yy), xy * xy + yy * yy);
            (d[x], e[x]) = (xx * bx + xy * by, xy * bx + yy * by);
        }
    }

    /// Returns the windowed means of AᵀA and −AᵀΔb around a pixel, in the form of a structure tensor, with the known share of
    /// the window.
    pub fn tensor(&self, (x, y): (usize, usize), window: &Window) -> Tensor {
        let (width, height) = self.from.u.size();
        let ((left, across), (top, down)) = (window.inside(x, width), window.inside(y, height));
        let total = window.weights().iter().sum::<f32>().powi(2);
        let mut mean = Tensor::default();
        for (y, along) in (top..).zip(down) {
            for (x, weight) in (left..).zip(across) {
                let Some((DisplacementEquation { a: [xx, xy, yy], b: [bx, by] }, _)) = self.shift((x, y)) else {
                    continue;
                };
                let weight = along * weight / total;
                mean.pixels += weight;
                mean.xx += weight * (xx * xx + xy * xy);
                mean.xy += weight * xy * (xx + yy);
                mean.yy += weight * (xy * xy + yy * yy);
                mean.xt -= weight * (xx * bx + xy * by);
                mean.yt -= weight * (xy * bx + yy * by);
                mean.tt += weight * (bx * bx + by * by);
            }
        }
        mean
    }
}

/// Splits a product row into its parts.
#[inline(always)]
fn parts(row: &mut [f32], width: usize) -> [&mut [f32]; PARTS] {
    let mut rest = row;
    std::array::from_fn(|_| rest.split_off_mut(..width).unwrap_or_default())
}

impl WindowSolver {
    /// Solves the windows of all pixels.
    pub fn solve(&self, expansions: &ExpansionPair, threads: &Threads) -> Estimate {
        let products = expansions.products(threads);
        let size = expansions.from.u.size();
        let mut estimate = Estimate { field: Field::new(size, [0.0; 2]), certainty: Grid::new(size.0, size.1, 0.0) };
        let Estimate { field: Field { u, v }, certainty } = &mut estimate;
        let [u, v, c] = [u, v, certainty].map(|grid| grid.cells_mut().chunks_mut(size.0));
        let rows = u.zip(v).zip(c).map(|((u, v), c)| [u, v, c]);
        let total: f32 = self.window.weights().iter().sum();
        let weights: Vec<_> = self.window.weights().iter().map(|weight| weight / total).collect();
        threads.each(rows.enumerate(), |(y, row)| self.row((&products, &weights), (expansions.from, y), row));
        estimate
    }

    /// Computes a row of displacements, with the widest registers available; all give the same result.
    fn row(&self, products: (&Grid<f32>, &[f32]), from: (&Field, usize), row: [&mut [f32]; 3]) {
        wide! {
            fn wide(by: &WindowSolver, products: (&Grid<f32>, &[f32]), from: (&Field, usize), row: [&mut [f32]; 3])
                = WindowSolver::row_body
        }
        wide(self, products, from, row);
    }

    #[inline(always)]
    fn row_body(&self, (products, weights): (&Grid<f32>, &[f32]), (from, y): (&Field, usize), row: [&mut [f32]; 3]) {
        let ((width, height), reach) = (from.u.size(), self.window.reach());
        let (top, last) = (y.saturating_sub(reach), (y + reach).min(height - 1));
        let inside = &weights[top + reach - y..=last + reach - y];
        let mut down = vec![0.0; width + 2 * reach];
        let mut means = vec![0.0; PARTS * width];
        let mut means = parts(&mut means, width);
        for (part, mean) in means.iter_mut().enumerate() {
            weigh(&mut down[reach..reach + width], inside, |k| &products.row(top + k)[part * width..][..width]);
            weigh(mean, weights, |k| &down[k..]);
        }
        let [xx, xy, yy, x_right, y_right] = means.each_ref().map(|mean| &mean[..width]);
        let [u, v, certainty] = row.map(|row| &mut row[..width]);
        let (from_u, from_v) = (&from.u.row(y)[..width], &from.v.row(y)[..width]);
        for x in 0..width {
            let (mean, half) = (0.5 * (xx[x] + yy[x]), 0.5 * (xx[x] - yy[x]));
            let smaller = mean - (half * half + xy[x] * xy[x]).sqrt();
            certainty[x] = if smaller > 0.0 { smaller } else { 0.0 };
            let [to_u, to_v] =
                damped([xx[x], xy[x], yy[x]], [x_right[x], y_right[x]], [from_u[x], from_v[x]], self.damping);
            (u[x], v[x]) = (to_u, to_v);
        }
    }
}

/// The effective weight λ where the mean of AᵀA has this diagonal: a relative minimum keeps singular systems solvable.
#[inline(always)]
pub fn in_effect(damping: f32, [xx, yy]: [f32; 2]) -> f32 {
    damping + 1e-5 * (xx + yy)
}

/// The displacement d that minimises the mean of |A d − Δb|² plus λ |d − from|².
#[inline(always)]
fn damped([xx, xy, yy]: [f32; 3], [x, y]: [f32; 2], [u, v]: [f32; 2], damping: f32) -> [f32; 2] {
    let damping = in_effect(damping, [xx, yy]);
    let (a, c) = (xx + damping, yy + damping);
    let (p, q) = (x + damping * u, y + damping * v);
    let det = a * c - xy * xy;
    [(c * p - xy * q) / det, (a * q - xy * p) / det]
}
