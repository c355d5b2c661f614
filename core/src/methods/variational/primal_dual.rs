//! The iterations of TV-L1, by A. Chambolle's dual of the total variation.
//!
//! They lessen λ |ρ(f)| + |f − w|² / 2θ + |∇u| + |∇v|, summed over the pixels, where w = (u, v) is the field, f is the one
//! that fits, and ∇ are differences to the next pixel, 0 at the last one.

use super::model::Unknowns;
use crate::base::{
    LANES, Threads,
    wide::{lane, widest},
};
use crate::geometry::Grid;
use crate::methods::differential::{Field, Linear};

/// A field and its dual variables.
#[derive(Clone)]
pub struct Dual {
    /// The displacements.
    pub field: Field,
    /// p of u along x and y, then p of v.
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

/// What an iteration weighs by.
#[derive(Clone, Copy, Debug)]
pub struct Weights {
    /// λ θ: how many times its gradient a pixel moves at most to fit.
    pub most: f32,
    /// θ.
    pub theta: f32,
    /// τ / θ.
    pub rate: f32,
}

/// A gradient whose square is smaller comes from rounding alone.
const FLAT: f32 = 1e-10;

/// How many times its gradient a pixel moves to fit a constraint that is `off` by so much.
#[inline(always)]
pub fn step(off: f32, squared_gradient: f32, most: f32) -> f32 {
    // A picture without gradient is off by whatever it is: there the move is nothing, however often it is taken.
    (off / squared_gradient.max(FLAT)).max(-most).min(most)
}

impl Dual {
    /// p of u and of v at a pixel.
    pub fn p(&self, place: (usize, usize)) -> [[f32; 2]; 2] {
        [[self.p[0][place], self.p[1][place]], [self.p[2][place], self.p[3][place]]]
    }

    /// div p of u and of v at a pixel.
    pub fn divergence(&self, (x, y): (usize, usize)) -> [f32; 2] {
        let left = |p: &Grid<f32>| if x > 0 { p[(x - 1, y)] } else { 0.0 };
        let above = |p: &Grid<f32>| if y > 0 { p[(x, y - 1)] } else { 0.0 };
        [0, 2].map(|i| {
            let (across, down) = (&self.p[i], &self.p[i + 1]);
            (across[(x, y)] - left(across)) + (down[(x, y)] - above(down))
        })
    }

    /// The gradients of u and of v at a pixel.
    pub fn gradients(&self, (x, y): (usize, usize)) -> [[f32; 2]; 2] {
        let (width, height) = self.field.u.size();
        [&self.field.u, &self.field.v].map(|part| {
            let next = [((x + 1).min(width - 1), y), (x, (y + 1).min(height - 1))];
            next.map(|next| part[next] - part[(x, y)])
        })
    }

    /// An iteration: every pixel fits its constraint, is smoothed by p, and p follows.
    pub fn iterate(&mut self, linear: &Linear, weights: Weights, threads: &Threads) {
        let height = self.field.u.height();
        let rows = height.div_ceil(threads.count()).max(1);
        self.fit_and_smooth(linear, weights, (rows, threads));
        let Self { field, p: [ux, uy, vx, vy] } = self;
        for (part, along, down) in [(&field.u, ux, uy), (&field.v, vx, vy)] {
            let bands = bands(along, rows).zip(bands(down, rows)).enumerate();
            threads.each(bands.collect(), |(band, (along, down))| {
                let width = part.width();
                for (i, (along, down)) in along.chunks_exact_mut(width).zip(down.chunks_exact_mut(width)).enumerate() {
                    let y = band * rows + i;
                    turn_widest([along, down], [part.row(y), part.row((y + 1).min(height - 1))], weights.rate);
                }
            });
        }
    }

    /// The first half of an iteration, by which the field changes.
    fn fit_and_smooth(&mut self, linear: &Linear, weights: Weights, (rows, threads): (usize, &Threads)) {
        let Self { field, p } = self;
        let width = field.u.width();
        let factors = [&linear.factors.a, &linear.factors.b, &linear.factors.c];
        let nothing = vec![0.0; width];
        let bands = bands(&mut field.u, rows).zip(bands(&mut field.v, rows)).enumerate();
        threads.each(bands.collect(), |(band, (u, v))| {
            for (i, (u, v)) in u.chunks_exact_mut(width).zip(v.chunks_exact_mut(width)).enumerate() {
                let y = band * rows + i;
                let above = |i: usize| if y > 0 { p[i].row(y - 1) } else { &nothing };
                let p = [0, 2].map(|i| [p[i].row(y), p[i + 1].row(y), above(i + 1)]);
                smoothed_widest([u, v], factors.map(|part| part.row(y)), p, weights);
            }
        });
    }
}

/// `grid` cut into bands of so many rows.
fn bands(grid: &mut Grid<f32>, rows: usize) -> std::slice::ChunksMut<'_, f32> {
    let width = grid.width();
    grid.cells_mut().chunks_mut(rows * width)
}

widest! {
    fn smoothed_widest(field: [&mut [f32]; 2], factors: [&[f32]; 3], p: [[&[f32]; 3]; 2], weights: Weights) = smoothed
}

widest! {
    fn turn_widest(p: [&mut [f32]; 2], field: [&[f32]; 2], rate: f32) = turn
}

/// A row of the field, fitted to its constraints and smoothed by p, of which the rows along x and y and the one above are given.
#[inline(always)]
fn smoothed([u, v]: [&mut [f32]; 2], factors: [&[f32]; 3], p: [[&[f32]; 3]; 2], weights: Weights) {
    let mut x = 0;
    while x < u.len() {
        // What is written next is not seen to be what is read, so it goes through arrays of its own.
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

/// The displacements of the pixels from `start` on, where there are so many, and one to the left.
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

/// A pixel (u, v) fitted to its constraint and smoothed by p, of which that along x, the one to the left of it, that along y and
/// the one above it are given.
#[inline(always)]
fn smoothed_pixel([u, v]: [f32; 2], [a, b, c]: [f32; 3], p: [[f32; 4]; 2], weights: Weights) -> [f32; 2] {
    let step = step(a * u + b * v + c, a * a + b * b, weights.most);
    let divergence = |[along, left, down, above]: [f32; 4]| (along - left) + (down - above);
    [(u - step * a) + weights.theta * divergence(p[0]), (v - step * b) + weights.theta * divergence(p[1])]
}

/// A row of p, turned towards the gradient of a part of the field, of which this row and the one below are given.
#[inline(always)]
fn turn([along, down]: [&mut [f32]; 2], [here, below]: [&[f32]; 2], rate: f32) {
    let width = along.len();
    let mut x = 0;
    while x < width {
        match turned_lanes([along, down], [here, below], (x, rate)) {
            Some(to) => {
                along[x..x + LANES].copy_from_slice(&to[0]);
                down[x..x + LANES].copy_from_slice(&to[1]);
                x += LANES;
            }
            None => {
                let gradient = [here[(x + 1).min(width - 1)] - here[x], below[x] - here[x]];
                [along[x], down[x]] = turned_pixel([along[x], down[x]], gradient, rate);
                x += 1;
            }
        }
    }
}

/// p of the pixels from `start` on, where there are so many and one more.
#[inline(always)]
fn turned_lanes(p: [&[f32]; 2], [here, below]: [&[f32]; 2], (start, rate): (usize, f32)) -> Option<[[f32; LANES]; 2]> {
    let [along, down] = [lane(p[0], start)?, lane(p[1], start)?];
    let (right, here, below) = (lane(here, start + 1)?, lane(here, start)?, lane(below, start)?);
    let mut to = [[0.0; LANES]; 2];
    for x in 0..LANES {
        let gradient = [right[x] - here[x], below[x] - here[x]];
        [to[0][x], to[1][x]] = turned_pixel([along[x], down[x]], gradient, rate);
    }
    Some(to)
}

#[inline(always)]
fn turned_pixel([along, down]: [f32; 2], [x, y]: [f32; 2], rate: f32) -> [f32; 2] {
    let shorter = 1.0 / (1.0 + rate * (x * x + y * y).sqrt());
    [(along + rate * x) * shorter, (down + rate * y) * shorter]
}

/// The two parts of the energy, on average over the pixels: λ times how far the constraints are off, and the total variation.
pub fn energy(linear: &Linear, lambda: f32, field: &Field) -> [f64; 2] {
    let (width, height) = field.u.size();
    let (mut data, mut variation) = (0.0, 0.0);
    for y in 0..height {
        let [a, b, c] = [&linear.factors.a, &linear.factors.b, &linear.factors.c].map(|part| part.row(y));
        let parts = [&field.u, &field.v].map(|part| [part.row(y), part.row((y + 1).min(height - 1))]);
        for x in 0..width {
            let [u, v] = parts.map(|[here, _]| here[x]);
            data += f64::from((a[x] * u + b[x] * v + c[x]).abs());
            for [here, below] in parts {
                let gradient = [here[(x + 1).min(width - 1)] - here[x], below[x] - here[x]];
                variation += f64::from((gradient[0] * gradient[0] + gradient[1] * gradient[1]).sqrt());
            }
        }
    }
    let pixels = (width * height) as f64;
    [f64::from(lambda) * data / pixels, variation / pixels]
}
