//! The iterations of TV-L1, with Chambolle's dual formulation of the total variation.
//!
//! They minimise λ |ρ(f)| + |f − w|² / 2θ + |∇u| + |∇v|, summed over the pixels, where w = (u, v) is the flow, f the auxiliary
//! flow of the data term, and ∇ forward differences, 0 at the image border.

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

    /// Does one iteration: thresholding of the data term, update of the flow, dual update.
    pub fn iterate(&mut self, linear: &Linear, weights: Weights, threads: &Threads) {
        effort::add(self.field.u.cells().len());
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
                    dual_widest([along, down], [part.row(y), part.row((y + 1).min(height - 1))], weights.rate);
                }
            });
        }
    }

    /// The thresholding and the update of the flow.
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

/// Splits `grid` into bands of `rows` rows.
fn bands(grid: &mut Grid<f32>, rows: usize) -> std::slice::ChunksMut<'_, f32> {
    let width = grid.width();
    grid.cells_mut().chunks_mut(rows * width)
}

widest! {
    fn smoothed_widest(field: [&mut [f32]; 2], factors: [&[f32]; 3], p: [[&[f32]; 3]; 2], weights: Weights) = smoothed
}

widest! {
    fn dual_widest(p: [&mut [f32]; 2], field: [&[f32]; 2], rate: f32) = dual_row
}

/// Updates a row of the flow from its constraints and from p: its row along x, its row along y and the one above.
#[inline(always)]
fn smoothed([u, v]: [&mut [f32]; 2], factors: [&[f32]; 3], p: [[&[f32]; 3]; 2], weights: Weights) {
    let mut x = 0;
    while x < u.len() {
        // Separate output arrays let the compiler vectorise.
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
