//! The iterations of TV-L1, with Chambolle's dual formulation of the total variation.
//!
//! They minimise λ |ρ(f)| + |f − w|² / 2θ + |∇u| + |∇v|, summed over the pixels, where w = (u, v) is the flow, f the auxiliary
//! flow of the data term, and ∇ forward differences, 0 at the image border.

use std::ops::Range;

use super::model::Unknowns;
use crate::base::{
    LANES, Threads, effort,
    wide::{lane, widest},
};
use crate::geometry::Grid;
use crate::methods::differential::{Field, Linear};

/// The flow field and its dual variables.
#[derive(Clone)]
pub struct Dual {
    /// The flow field.
    pub field: Field,
    /// The dual variables: x and y of p_u, then of p_v.
    p: [Grid<f32>; 4],
}

impl Unknowns for Dual {
    fn begin(start: &Field, last: Option<&Self>) -> Self {
        let (width, height) = start.u.size();
        let zero = || std::array::from_fn(|_| Grid::new(width, height, 0.0));
        Self { field: start.clone(), p: last.map_or_else(zero, |last| last.p.clone()) }
    }

    fn field(&self) -> &Field {
        &self.field
    }

    fn bytes(&self) -> usize {
        self.field.bytes() + 4 * size_of_val(self.p[0].cells())
    }
}

/// The constants of an iteration.
#[derive(Clone, Copy, Debug)]
pub struct Weights {
    /// λ θ: the threshold of the step along the gradient.
    pub most: f32,
    /// θ.
    pub theta: f32,
    /// τ / θ: the step size of the dual update.
    pub rate: f32,
}

/// Squared gradient magnitude up to which a gradient is rounding error.
const FLAT: f32 = 1e-10;

/// The thresholded step s along the gradient, for a residual `off` and |∇I|².
#[inline(always)]
pub fn step(off: f32, squared_gradient: f32, most: f32) -> f32 {
    // Without gradient the step is multiplied by 0.
    (off / squared_gradient.max(FLAT)).max(-most).min(most)
}

impl Dual {
    /// Returns p_u and p_v of a pixel.
    pub fn p(&self, place: (usize, usize)) -> [[f32; 2]; 2] {
        [[self.p[0][place], self.p[1][place]], [self.p[2][place], self.p[3][place]]]
    }

    /// Returns div p_u and div p_v of a pixel.
    pub fn divergence(&self, (x, y): (usize, usize)) -> [f32; 2] {
        let left = |p: &Grid<f32>| if x > 0 { p[(x - 1, y)] } else { 0.0 };
        let above = |p: &Grid<f32>| if y > 0 { p[(x, y - 1)] } else { 0.0 };
        [0, 2].map(|i| {
            let (across, down) = (&self.p[i], &self.p[i + 1]);
            (across[(x, y)] - left(across)) + (down[(x, y)] - above(down))
        })
    }

    /// Returns ∇u and ∇v of a pixel.
    pub fn gradients(&self, (x, y): (usize, usize)) -> [[f32; 2]; 2] {
        let (width, height) = self.field.u.size();
        [&self.field.u, &self.field.v].map(|part| {
            let next = [((x + 1).min(width - 1), y), (x, (y + 1).min(height - 1))];
            next.map(|next| part[next] - part[(x, y)])
        })
    }

    /// Does `iterations`, each thresholding of the data term, update of the flow, dual update.
    pub fn iterate(&mut self, linear: &Linear, weights: Weights, iterations: usize, threads: &Threads) {
        let (width, height) = self.field.u.size();
        effort::add(iterations * width * height);
        if threads.count() == 1 {
            return Band { linear, weights, rows: 0..height, depth: iterations }.run(self, 0);
        }
        let rows = height.div_ceil(threads.count()).max(1);
        for done in (0..iterations).step_by(DEPTH) {
            let band = |first: usize| Band {
                linear,
                weights,
                rows: first..(first + rows).min(height),
                depth: DEPTH.min(iterations - done),
            };
            let bands = threads.map(height.div_ceil(rows), |i| {
                let band = band(i * rows);
                let held = band.range(0);
                let mut part = self.part(held.clone());
                band.run(&mut part, held.start);
                (part, held.start)
            });
            self.write(&bands, rows, threads);
        }
    }

    /// Returns all values, u and v first.
    fn grids(&self) -> [&Grid<f32>; 6] {
        let [a, b, c, d] = &self.p;
        [&self.field.u, &self.field.v, a, b, c, d]
    }

    /// Returns a copy of some rows.
    fn part(&self, rows: Range<usize>) -> Self {
        let width = self.field.u.width();
        let part = |grid: &Grid<f32>| {
            let mut part = Grid::new(width, rows.len(), 0.0);
            part.cells_mut().copy_from_slice(&grid.cells()[rows.start * width..rows.end * width]);
            part
        };
        let [u, v, a, b, c, d] = self.grids().map(part);
        Self { field: Field { u, v }, p: [a, b, c, d] }
    }

    /// Takes over bands of `rows` rows from parts, each with the first row that it holds.
    fn write(&mut self, parts: &[(Self, usize)], rows: usize, threads: &Threads) {
        let width = self.field.u.width();
        let [a, b, c, d] = &mut self.p;
        let mut bands = [&mut self.field.u, &mut self.field.v, a, b, c, d].map(|grid| bands(grid, rows));
        let work = parts.iter().map(|part| (part, bands.each_mut().map(|bands| bands.next().unwrap_or_default())));
        threads.each(work.enumerate(), |(band, ((part, first), targets))| {
            for (grid, target) in part.grids().into_iter().zip(targets) {
                let start = (band * rows - first) * width;
                target.copy_from_slice(&grid.cells()[start..start + target.len()]);
            }
        });
    }
}

/// Iterations that a band of rows does before its neighbours' are needed.
const DEPTH: usize = 20;

/// Iterations that follow each other through rows that stay in the cache.
const PASS: usize = 5;

/// A band of rows through which several iterations pass in a wavefront. Rows beyond the band are computed only where its own need
/// them.
struct Band<'a> {
    linear: &'a Linear,
    weights: Weights,
    rows: Range<usize>,
    depth: usize,
}

impl Band<'_> {
    /// Returns the rows that iteration `k` must compute: each reads what the one before left in the rows beside it.
    fn range(&self, k: usize) -> Range<usize> {
        let more = self.depth - k + 1;
        self.rows.start.saturating_sub(more)..(self.rows.end + more).min(self.linear.start.u.height())
    }

    /// Does the iterations in `part`, which holds rows from `first` on.
    fn run(&self, part: &mut Dual, first: usize) {
        let range = self.range(0);
        for done in (0..self.depth).step_by(PASS) {
            let last = (done + PASS).min(self.depth);
            // An iteration updates the flow in a row, then p in the row above, and follows the one before by two rows.
            for time in range.start..range.end + 1 + 2 * (last - done) {
                for k in done + 1..=last {
                    let Some(y) = time.checked_sub(2 * (k - done - 1)) else { continue };
                    let range = self.range(k);
                    if range.contains(&y) {
                        self.fit_and_smooth(part, y, first);
                    }
                    if let Some(above) = y.checked_sub(1).filter(|above| range.contains(above)) {
                        self.update_dual(part, above, first);
                    }
                }
            }
        }
    }

    /// The thresholding and the update of the flow in row `y`.
    fn fit_and_smooth(&self, Dual { field, p }: &mut Dual, y: usize, first: usize) {
        let factors = [&self.linear.factors.a, &self.linear.factors.b, &self.linear.factors.c].map(|part| part.row(y));
        let i = y - first;
        let rows = [0, 2].map(|k| [p[k].row(i), p[k + 1].row(i), p[k + 1].row(i.saturating_sub(1))]);
        let to = [field.u.row_mut(i), field.v.row_mut(i)];
        if y == 0 {
            let nothing = vec![0.0; rows[0][0].len()];
            smooth_widest(to, factors, rows.map(|[along, down, _]| [along, down, &nothing]), self.weights);
        } else {
            smooth_widest(to, factors, rows, self.weights);
        }
    }

    /// The dual update in row `y`.
    fn update_dual(&self, Dual { field, p }: &mut Dual, y: usize, first: usize) {
        let i = y - first;
        let below = (i + 1).min(field.u.height() - 1);
        let [ux, uy, vx, vy] = p;
        for (part, along, down) in [(&field.u, ux, uy), (&field.v, vx, vy)] {
            dual_widest([along.row_mut(i), down.row_mut(i)], [part.row(i), part.row(below)], self.weights.rate);
        }
    }
}

/// Splits `grid` into bands of `rows` rows.
fn bands(grid: &mut Grid<f32>, rows: usize) -> std::slice::ChunksMut<'_, f32> {
    let width = grid.width();
    grid.cells_mut().chunks_mut(rows * width)
}

widest! {
    fn smooth_widest(field: [&mut [f32]; 2], factors: [&[f32]; 3], p: [[&[f32]; 3]; 2], weights: Weights) = smooth
}

widest! {
    fn dual_widest(p: [&mut [f32]; 2], field: [&[f32]; 2], rate: f32) = dual_row
}

/// Updates a row of the flow from its constraints and from p: its row along x, its row along y and the one above.
#[inline(always)]
fn smooth([u, v]: [&mut [f32]; 2], factors: [&[f32]; 3], p: [[&[f32]; 3]; 2], weights: Weights) {
    let mut x = 0;
    while x < u.len() {
        // Separate output arrays allow vectorisation.
        match smoothed_lanes([u, v], factors, p, (x, weights)) {
            Some(to) => {
                u[x..x + LANES].copy_from_slice(&to[0]);
                v[x..x + LANES].copy_from_slice(&to[1]);
                x += LANES;
            }
            None => {
                let around =
                    p.map(|[along, down, above]| [along[x], if x > 0 { along[x - 1] } else { 0.0 }, down[x], above[x]]);
                [u[x], v[x]] = smoothed_pixel([u[x], v[x]], factors.map(|row| row[x]), around, weights);
                x += 1;
            }
        }
    }
}

/// The flow of a vector of pixels from `start`, if it fits into the row with a pixel to the left.
#[inline(always)]
fn smoothed_lanes<'a>(
    field: [&[f32]; 2],
    [a, b, c]: [&[f32]; 3],
    [pu, pv]: [[&'a [f32]; 3]; 2],
    (start, weights): (usize, Weights),
) -> Option<[[f32; LANES]; 2]> {
    let left = start.checked_sub(1)?;
    let around = |[along, down, above]: [&'a [f32]; 3]| -> Option<[&'a [f32; LANES]; 4]> {
        Some([lane(along, start)?, lane(along, left)?, lane(down, start)?, lane(above, start)?])
    };
    let (pu, pv) = (around(pu)?, around(pv)?);
    let [u, v] = [lane(field[0], start)?, lane(field[1], start)?];
    let (a, b, c) = (lane(a, start)?, lane(b, start)?, lane(c, start)?);
    let mut to = [[0.0; LANES]; 2];
    for x in 0..LANES {
        let p = [[pu[0][x], pu[1][x], pu[2][x], pu[3][x]], [pv[0][x], pv[1][x], pv[2][x], pv[3][x]]];
        [to[0][x], to[1][x]] = smoothed_pixel([u[x], v[x]], [a[x], b[x], c[x]], p, weights);
    }
    Some(to)
}

/// The update of a pixel (u, v) from its constraint and from p: its x component here and to the left, its y component here and
/// above.
#[inline(always)]
fn smoothed_pixel([u, v]: [f32; 2], [a, b, c]: [f32; 3], p: [[f32; 4]; 2], weights: Weights) -> [f32; 2] {
    let step = step(a * u + b * v + c, a * a + b * b, weights.most);
    let divergence = |[along, left, down, above]: [f32; 4]| (along - left) + (down - above);
    [(u - step * a) + weights.theta * divergence(p[0]), (v - step * b) + weights.theta * divergence(p[1])]
}

/// The dual update of a row of p from this row of a flow component and the one below.
#[inline(always)]
fn dual_row([along, down]: [&mut [f32]; 2], [here, below]: [&[f32]; 2], rate: f32) {
    let width = along.len();
    let mut x = 0;
    while x < width {
        match dual_lanes([along, down], [here, below], (x, rate)) {
            Some(to) => {
                along[x..x + LANES].copy_from_slice(&to[0]);
                down[x..x + LANES].copy_from_slice(&to[1]);
                x += LANES;
            }
            None => {
                let gradient = [here[(x + 1).min(width - 1)] - here[x], below[x] - here[x]];
                [along[x], down[x]] = dual_pixel([along[x], down[x]], gradient, rate);
                x += 1;
            }
        }
    }
}

/// p of a vector of pixels from `start`, if it fits into the row with one more pixel.
#[inline(always)]
fn dual_lanes(p: [&[f32]; 2], [here, below]: [&[f32]; 2], (start, rate): (usize, f32)) -> Option<[[f32; LANES]; 2]> {
    let [along, down] = [lane(p[0], start)?, lane(p[1], start)?];
    let (right, here, below) = (lane(here, start + 1)?, lane(here, start)?, lane(below, start)?);
    let mut to = [[0.0; LANES]; 2];
    for x in 0..LANES {
        let gradient = [right[x] - here[x], below[x] - here[x]];
        [to[0][x], to[1][x]] = dual_pixel([along[x], down[x]], gradient, rate);
    }
    Some(to)
}

#[inline(always)]
fn dual_pixel([along, down]: [f32; 2], [x, y]: [f32; 2], rate: f32) -> [f32; 2] {
    let shorter = 1.0 / (1.0 + rate * (x * x + y * y).sqrt());
    [(along + rate * x) * shorter, (down + rate * y) * shorter]
}

/// The data term λ |ρ| and the total variation, per pixel.
pub fn energy(linear: &Linear, lambda: f32, field: &Field) -> [f64; 2] {
    effort::add(field.u.cells().len());
    let (width, height) = field.u.size();
    let (mut data, mut variation) = (0.0, 0.0);
    for y in 0..height {
        let factors = [&linear.factors.a, &linear.factors.b, &linear.factors.c].map(|part| part.row(y));
        let parts = [&field.u, &field.v].map(|part| [part.row(y), part.row((y + 1).min(height - 1))]);
        data += f64::from(residual_row(factors, parts.map(|[here, _]| here)));
        variation += parts.iter().map(|rows| f64::from(variation_row(*rows))).sum::<f64>();
    }
    let pixels = (width * height) as f64;
    [f64::from(lambda) * data / pixels, variation / pixels]
}

widest! {
    fn residual_row(factors: [&[f32]; 3], field: [&[f32]; 2]) -> f32 = residual_of_row
}

/// The sum of |ρ| of a row.
#[inline(always)]
fn residual_of_row([a, b, c]: [&[f32]; 3], [u, v]: [&[f32]; 2]) -> f32 {
    let (mut lanes, mut x, mut rest) = ([0.0; LANES], 0, 0.0);
    while let (Some(a), Some(b), Some(c), Some(u), Some(v)) =
        (lane(a, x), lane(b, x), lane(c, x), lane(u, x), lane(v, x))
    {
        (0..LANES).for_each(|i| lanes[i] += (a[i] * u[i] + b[i] * v[i] + c[i]).abs());
        x += LANES;
    }
    (x..u.len()).for_each(|x| rest += (a[x] * u[x] + b[x] * v[x] + c[x]).abs());
    lanes.iter().sum::<f32>() + rest
}

widest! {
    fn variation_row(rows: [&[f32]; 2]) -> f32 = variation_of_row
}

/// The total variation of a row of one component, from the row and the one below.
#[inline(always)]
fn variation_of_row([here, below]: [&[f32]; 2]) -> f32 {
    let length = |value: f32, right: f32, below: f32| {
        let (across, down) = (right - value, below - value);
        (across * across + down * down).sqrt()
    };
    let (mut lanes, mut x, mut rest) = ([0.0; LANES], 0, 0.0);
    while let (Some(value), Some(right), Some(below)) = (lane(here, x), lane(here, x + 1), lane(below, x)) {
        (0..LANES).for_each(|i| lanes[i] += length(value[i], right[i], below[i]));
        x += LANES;
    }
    (x..here.len()).for_each(|x| rest += length(here[x], here[(x + 1).min(here.len() - 1)], below[x]));
    lanes.iter().sum::<f32>() + rest
}
