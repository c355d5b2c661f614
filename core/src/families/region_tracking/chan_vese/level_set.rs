//! A level set function in a window, and its evolution.

use crate::data::{Connectivity, Labelling, Mask};
use crate::geometry::{Bounds, Grid};

/// Width ε of the regularised delta function, in px.
const EPSILON: f32 = 1.0;
/// The gradient at which the curvature of a flat part is bounded.
const FLAT: f32 = 1e-4;

/// The weights of the energy, and the time step.
#[derive(Clone, Copy, Debug)]
pub struct Weights {
    /// Weight of the length.
    pub mu: f32,
    /// Weight of the area.
    pub nu: f32,
    /// Weights of the squared differences inside and outside.
    pub lambda: [f32; 2],
    /// Time step Δt.
    pub step: f32,
}

/// The energy by its parts, with gray levels of 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// μ times the length.
    pub length: f64,
    /// ν times the area inside.
    pub area: f64,
    /// λ₁ times the squared differences from c₁ inside.
    pub inside: f64,
    /// λ₂ times those from c₂ outside.
    pub outside: f64,
}

impl Energy {
    /// The sum.
    pub fn total(&self) -> f64 {
        self.length + self.area + self.inside + self.outside
    }
}

/// The regularised delta function ε / (π (ε² + φ²)).
fn delta(phi: f32) -> f32 {
    EPSILON / (std::f32::consts::PI * (EPSILON * EPSILON + phi * phi))
}

/// The means of `levels` where φ ≥ 0 and where φ < 0; 0 where there is no pixel.
pub fn means(phi: &Grid<f32>, levels: &Grid<f32>) -> [f32; 2] {
    let (mut sums, mut counts) = ([0.0f64; 2], [0usize; 2]);
    for (phi, level) in phi.cells().iter().zip(levels.cells()) {
        let side = usize::from(*phi < 0.0);
        sums[side] += f64::from(*level);
        counts[side] += 1;
    }
    [0, 1].map(|side| (sums[side] / counts[side].max(1) as f64) as f32)
}

/// Energy of φ with these means.
pub fn energy(phi: &Grid<f32>, levels: &Grid<f32>, means: [f32; 2], weights: &Weights) -> Energy {
    let (width, height) = phi.size();
    let (mut length, mut area, mut squares) = (0.0f64, 0usize, [0.0f64; 2]);
    for y in 0..height {
        let rows = [y.saturating_sub(1), y, (y + 1).min(height - 1)].map(|y| phi.row(y));
        for (x, level) in levels.row(y).iter().enumerate() {
            let here = rows[1][x];
            let along = (rows[1][(x + 1).min(width - 1)] - rows[1][x.saturating_sub(1)]) / 2.0;
            let down = (rows[2][x] - rows[0][x]) / 2.0;
            length += f64::from(delta(here) * (along * along + down * down).sqrt());
            let side = usize::from(here < 0.0);
            area += 1 - side;
            squares[side] += f64::from((level - means[side]) * (level - means[side]));
        }
    }
    Energy {
        length: f64::from(weights.mu) * length,
        area: f64::from(weights.nu) * area as f64,
        inside: f64::from(weights.lambda[0]) * squares[0],
        outside: f64::from(weights.lambda[1]) * squares[1],
    }
}

/// One step of the semi-implicit scheme (Chan and Vese 2001, section III; in the explicit order of P. Getreuer, IPOL 2, 2012, with the
/// neighbours of the step before): φ at the pixel is implicit, so that any time step is stable.
pub fn evolved(phi: &Grid<f32>, levels: &Grid<f32>, means: [f32; 2], weights: &Weights) -> Grid<f32> {
    let (width, height) = phi.size();
    // Diffusivities μ / |∇φ| between a pixel and its right and lower neighbours, for this row and the row above.
    let mut right = vec![0.0f32; width];
    let [mut below, mut above] = [vec![0.0f32; width], vec![0.0f32; width]];
    let mut next = Grid::new(width, height, 0.0);
    for y in 0..height {
        let rows = [y.saturating_sub(1), y, (y + 1).min(height - 1)].map(|y| phi.row(y));
        std::mem::swap(&mut above, &mut below);
        diffusivities(rows, weights.mu, [&mut right, &mut below]);
        if y == 0 {
            above.fill(0.0);
        }
        let last = width - 1;
        for (x, (target, level)) in next.row_mut(y).iter_mut().zip(levels.row(y)).enumerate() {
            let here = rows[1][x];
            // No flow across the border of the window: the neighbour there has the same value.
            let left = if x > 0 { right[x - 1] } else { 0.0 };
            let flow = right[x] * rows[1][(x + 1).min(last)]
                + left * rows[1][x.saturating_sub(1)]
                + below[x] * rows[2][x]
                + above[x] * rows[0][x];
            let [inside, outside] = means.map(|mean| (level - mean) * (level - mean));
            let force = weights.lambda[1] * outside - weights.lambda[0] * inside - weights.nu;
            let rate = weights.step * delta(here);
            *target = (here + rate * (flow + force)) / (1.0 + rate * (right[x] + left + below[x] + above[x]));
        }
    }
    next
}

/// The diffusivities of a row, from it and the rows above and below.
fn diffusivities([above, here, below]: [&[f32]; 3], mu: f32, [right, down]: [&mut [f32]; 2]) {
    let last = here.len() - 1;
    for x in 0..here.len() {
        let (before, after) = (here[x.saturating_sub(1)], here[(x + 1).min(last)]);
        let [forward_x, central_x] = [after - here[x], (after - before) / 2.0];
        let [forward_y, central_y] = [below[x] - here[x], (below[x] - above[x]) / 2.0];
        right[x] = mu / (FLAT * FLAT + forward_x * forward_x + central_y * central_y).sqrt();
        down[x] = mu / (FLAT * FLAT + central_x * central_x + forward_y * forward_y).sqrt();
    }
}

/// The signed distance to the border between pixels inside and outside: positive inside, ±0.5 next to it.
pub fn signed_distance((width, height): (usize, usize), is_inside: impl Fn(usize, usize) -> bool) -> Grid<f32> {
    let inside = Grid::from_fn(width, height, is_inside);
    let [to_inside, to_outside] = [true, false].map(|side| squared_distance(&inside, side));
    Grid::from_fn(width, height, |x, y| match inside[(x, y)] {
        true => to_outside[(x, y)].sqrt() - 0.5,
        false => 0.5 - to_inside[(x, y)].sqrt(),
    })
}

/// The squared distance of each pixel to the nearest with the value `of`, in px² (P. F. Felzenszwalb and D. P. Huttenlocher, Distance
/// transforms of sampled functions, Theory of Computing 8, 2012); where there is none, that of the farthest corners.
fn squared_distance(cells: &Grid<bool>, of: bool) -> Grid<f32> {
    let (width, height) = cells.size();
    let most = (width * width + height * height) as f32;
    let mut squares = cells.map(|cell| if *cell == of { 0.0 } else { most });
    let mut column = vec![0.0; height];
    for x in 0..width {
        (0..height).for_each(|y| column[y] = squares[(x, y)]);
        let lowest = envelope(&column);
        (0..height).for_each(|y| squares[(x, y)] = lowest[y].min(most));
    }
    for y in 0..height {
        let lowest = envelope(squares.row(y));
        squares.row_mut(y).copy_from_slice(&lowest);
    }
    squares
}

/// The lower envelope of the parabolas (x − i)² + f(i) at each x.
fn envelope(f: &[f32]) -> Vec<f32> {
    // The parabolas of the envelope, each with the place from which it is the lowest.
    let mut parts: Vec<(usize, f32)> = Vec::with_capacity(f.len());
    for (i, value) in f.iter().enumerate() {
        let meets = |j: usize| ((value + (i * i) as f32) - (f[j] + (j * j) as f32)) / (2 * (i - j)) as f32;
        while parts.last().is_some_and(|(j, from)| meets(*j) <= *from) {
            parts.pop();
        }
        let from = parts.last().map_or(f32::NEG_INFINITY, |(j, _)| meets(*j));
        parts.push((i, from));
    }
    let mut part = 0;
    let at = |x: usize| {
        while parts.get(part + 1).is_some_and(|(_, from)| *from < x as f32) {
            part += 1;
        }
        let i = parts[part].0;
        (x.abs_diff(i) * x.abs_diff(i)) as f32 + f[i]
    };
    (0..f.len()).map(at).collect()
}

/// The number of pixels that are on another side.
pub fn changed(before: &Grid<f32>, after: &Grid<f32>) -> usize {
    before.cells().iter().zip(after.cells()).filter(|(a, b)| (**a < 0.0) != (**b < 0.0)).count()
}

/// The largest connected part of the pixels with φ ≥ 0 in a picture, with its box and its number of pixels; nothing without such pixels.
pub fn largest(phi: &Grid<f32>, origin: [usize; 2], picture: (usize, usize)) -> Option<(Mask, Bounds, usize)> {
    let (width, height) = phi.size();
    let inside = Mask::from_fn(width, height, |x, y| phi[(x, y)] >= 0.0);
    let labelling = Labelling::of(&inside, Connectivity::Eight);
    let finals = labelling.finals();
    let mut areas = vec![0usize; finals.count as usize + 1];
    let label = |provisional: u32| finals.labels[provisional as usize];
    labelling.runs().iter().for_each(|run| areas[label(run.label) as usize] += (run.end - run.start) as usize);
    // The first of equals.
    let best = (1..areas.len()).rev().max_by_key(|label| areas[*label])?;
    let (mut min, mut max) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
    for run in labelling.runs().iter().filter(|run| label(run.label) as usize == best) {
        let [x, y] = origin.map(|c| c as f32);
        min = [min[0].min(x + run.start as f32 - 0.5), min[1].min(y + run.y as f32 - 0.5)];
        max = [max[0].max(x + run.end as f32 - 0.5), max[1].max(y + run.y as f32 + 0.5)];
    }
    let labels = finals.grid(&labelling, (width, height));
    let is_object = |x: usize, y: usize| {
        let at = (x.checked_sub(origin[0])?, y.checked_sub(origin[1])?);
        labels.get(at.0, at.1).map(|label| *label as usize == best)
    };
    let object = Mask::from_fn(picture.0, picture.1, |x, y| is_object(x, y).unwrap_or(false));
    Some((object, Bounds { min, max }, areas[best]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_to_the_nearest_pixel_of_the_other_side() {
        let shapes: [fn(usize, usize) -> bool; 3] =
            [|x, y| x > 2 && x < 9 && y > 3 && x + y < 15, |x, y| (x * 7 + y * 5) % 11 < 3, |x, _| x == 0];
        for is_inside in shapes {
            let found = signed_distance((13, 11), is_inside);
            for (x, y) in (0..11).flat_map(|y| (0..13).map(move |x| (x, y))) {
                let others = (0..11)
                    .flat_map(|v| (0..13).map(move |u| (u, v)))
                    .filter(|(u, v)| is_inside(*u, *v) != is_inside(x, y));
                let least =
                    others.map(|(u, v)| (x as f32 - u as f32).hypot(y as f32 - v as f32)).fold(f32::INFINITY, f32::min);
                let expected = if is_inside(x, y) { least - 0.5 } else { 0.5 - least };
                assert!((found[(x, y)] - expected).abs() < 1e-5, "{x}, {y}: {}, not {expected}", found[(x, y)]);
            }
        }
        let all = signed_distance((4, 3), |_, _| true);
        assert!(all.cells().iter().all(|phi| *phi == 4.5), "no other side: as far as the corners");
    }

    #[test]
    fn length_and_curvature_are_those_of_a_circle() {
        const RADIUS: f32 = 14.0;
        let circle = Grid::from_fn(64, 64, |x, y| RADIUS - (x as f32 - 31.5).hypot(y as f32 - 31.5));
        let flat = Grid::new(64, 64, 0.0);
        let weights = Weights { mu: 1.0, nu: 0.0, lambda: [1.0; 2], step: 0.01 };
        let length = energy(&circle, &flat, [0.0; 2], &weights).length;
        // The delta function has long tails, parts of which the window cuts off.
        assert!((length / f64::from(std::f32::consts::TAU * RADIUS) - 1.0).abs() < 0.1, "{length}");
        // Without data the curve shrinks by δ(φ) μ κ, with κ = 1 / r.
        let next = evolved(&circle, &flat, [0.0; 2], &weights);
        for (x, y) in [(45, 31), (31, 45), (41, 41)] {
            let at = (x as f32 - 31.5).hypot(y as f32 - 31.5);
            let expected = -0.01 * delta(circle[(x, y)]) / at;
            let moved = next[(x, y)] - circle[(x, y)];
            assert!((moved / expected - 1.0).abs() < 0.1, "{x}, {y}: {moved}, not {expected}");
        }
    }
}
