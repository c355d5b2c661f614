//! The edges of a frame around a contour, and the force by which they attract it.

use super::Point;
use crate::base::{Threads, effort};
use crate::geometry::filter::{gaussian, smooth};
use crate::geometry::{Border, Bounds, Gray, Grid, polygon};

/// Edges are relative to the steepest gradient, or to this one if none is as steep, in gray levels/px: noise is no edge.
const LEAST_GRADIENT: f32 = 1.0;

/// The edge strength in a window around a contour.
#[derive(Clone, Debug)]
pub struct Edges {
    /// The first pixel of the window.
    pub origin: [usize; 2],
    /// The edge strength f, 0 to 1: the gradient magnitude of the smoothed picture as a share of the steepest.
    pub strength: Grid<f32>,
    /// The largest gradient magnitude in gray levels/px.
    pub steepest: f32,
}

impl Edges {
    /// The edges up to `margin` px around `points`, from all pixels within reach of the filters; the border of the picture is replicated.
    pub fn around(luma: &Gray, points: &[Point], (sigma_px, margin): (f32, usize)) -> Self {
        let window = Window::around(points, margin, luma.size());
        // The Gaussian, and a pixel for the central difference.
        let read = window.grown(gaussian(sigma_px).len() / 2 + 1, luma.size());
        let smoothed = smooth(&read.cut(luma), sigma_px, Border::Replicate, &Threads::single());
        let (gradients, [x0, y0]) = (gradient(&smoothed), [0, 1].map(|i| window.origin[i] - read.origin[i]));
        let mut strength = Grid::from_fn(window.size[0], window.size[1], |x, y| {
            let [x, y] = gradients[(x0 + x, y0 + y)];
            (x * x + y * y).sqrt()
        });
        let steepest = strength.cells().iter().copied().fold(0.0, f32::max);
        let scale = 1.0 / steepest.max(LEAST_GRADIENT);
        strength.cells_mut().iter_mut().for_each(|f| *f *= scale);
        Self { origin: window.origin, strength, steepest }
    }

    /// A place in the window, relative to its first pixel; one outside is clamped to its border.
    fn within(&self, at: Point) -> [f32; 2] {
        let (width, height) = self.strength.size();
        [0, 1].map(|i| (at[i] - self.origin[i] as f64).clamp(0.0, [width, height][i] as f64 - 1.0) as f32)
    }

    /// The place of the window that is nearest.
    pub fn nearest(&self, at: Point) -> Point {
        let (width, height) = self.strength.size();
        [0, 1].map(|i| at[i].clamp(self.origin[i] as f64, (self.origin[i] + [width, height][i] - 1) as f64))
    }

    /// The edge strength at a place, interpolated bilinearly.
    pub fn strength_at(&self, at: Point) -> f32 {
        let [x, y] = self.within(at);
        self.strength.sample(x, y)
    }

    /// The force ∇f.
    pub(crate) fn force(&self) -> Force {
        Force { values: gradient(&self.strength) }
    }

    /// A force at a place, interpolated bilinearly.
    pub(crate) fn force_at(&self, force: &Force, at: Point) -> Point {
        let (values, [x, y]) = (&force.values, self.within(at));
        let (x0, y0) = (x as usize, y as usize);
        let (x1, y1) = ((x0 + 1).min(values.width() - 1), (y0 + 1).min(values.height() - 1));
        let (fx, fy) = (x - x0 as f32, y - y0 as f32);
        let mix = |a: f32, b: f32, f: f32| a + (b - a) * f;
        let (top, bottom) = ([values[(x0, y0)], values[(x1, y0)]], [values[(x0, y1)], values[(x1, y1)]]);
        [0, 1].map(|i| mix(mix(top[0][i], top[1][i], fx), mix(bottom[0][i], bottom[1][i], fx), fy).into())
    }
}

/// A part of a picture: its first pixel, and its width and height in px.
#[derive(Clone, Copy)]
struct Window {
    origin: [usize; 2],
    size: [usize; 2],
}

impl Window {
    /// The window up to `margin` px around `points`.
    fn around(points: &[Point], margin: usize, (width, height): (usize, usize)) -> Self {
        let bounds = polygon::bounds(points).unwrap_or(Bounds { min: [0.0; 2], max: [0.0; 2] });
        let margin = margin as f32;
        let origin = [0, 1].map(|i| ((bounds.min[i] - margin).floor().max(0.0) as usize).min([width, height][i] - 1));
        let end = [0, 1].map(|i| ((bounds.max[i] + margin).ceil().max(0.0) as usize + 1).min([width, height][i]));
        Self { origin, size: [0, 1].map(|i| end[i].max(origin[i] + 1) - origin[i]) }
    }

    /// The window with up to `by` px more on each side.
    fn grown(&self, by: usize, (width, height): (usize, usize)) -> Self {
        let origin = self.origin.map(|first| first.saturating_sub(by));
        let end = [0, 1].map(|i| (self.origin[i] + self.size[i] + by).min([width, height][i]));
        Self { origin, size: [0, 1].map(|i| end[i] - origin[i]) }
    }

    /// The pixels of a picture in the window.
    fn cut(&self, luma: &Gray) -> Gray {
        let Self { origin: [x0, y0], size: [width, height] } = *self;
        effort::add(width * height);
        Grid::from_fn(width, height, |x, y| luma[(x0 + x, y0 + y)])
    }
}

/// The central differences of `of` along x and y, its border repeated.
fn gradient(of: &Grid<f32>) -> Grid<[f32; 2]> {
    let (width, height) = of.size();
    let mut found = Grid::new(width, height, [0.0; 2]);
    for y in 0..height {
        let (above, here, below) = (of.row(y.saturating_sub(1)), of.row(y), of.row((y + 1).min(height - 1)));
        for (x, cell) in found.row_mut(y).iter_mut().enumerate() {
            let (left, right) = (here[x.saturating_sub(1)], here[(x + 1).min(width - 1)]);
            *cell = [(right - left) / 2.0, (below[x] - above[x]) / 2.0];
        }
    }
    found
}

/// An external force at each pixel of a window, in 1/px.
#[derive(Clone, Debug)]
pub(crate) struct Force {
    pub values: Grid<[f32; 2]>,
}

impl Force {
    /// Gradient vector flow (Xu and Prince 1998, equations 12 to 17): `count` steps of g ← g + μ ∇²g − |∇f|² (g − ∇f) from g = ∇f, at
    /// the end scaled to the largest length of ∇f, since diffusion weakens it at the edges.
    pub fn diffused(&self, mu: f32, count: usize) -> Self {
        let edge = &self.values;
        let (width, height) = edge.size();
        effort::add(width * height * count);
        let (mut now, mut next) = (edge.clone(), edge.clone());
        for _ in 0..count {
            for y in 0..height {
                let rows = [y.saturating_sub(1), y, (y + 1).min(height - 1)].map(|y| now.row(y));
                diffuse_row(rows, edge.row(y), mu, next.row_mut(y));
            }
            std::mem::swap(&mut now, &mut next);
        }
        let scale = longest(edge) / longest(&now).max(f32::MIN_POSITIVE);
        Self { values: now.map(|force| force.map(|c| c * scale)) }
    }
}

/// The largest length of a force.
fn longest(values: &Grid<[f32; 2]>) -> f32 {
    values.cells().iter().map(|[x, y]| x * x + y * y).fold(0.0, f32::max).sqrt()
}

fn diffuse_row([above, here, below]: [&[[f32; 2]]; 3], edge: &[[f32; 2]], mu: f32, target: &mut [[f32; 2]]) {
    let last = here.len() - 1;
    for (x, target) in target.iter_mut().enumerate() {
        let (left, right, force) = (here[x.saturating_sub(1)], here[(x + 1).min(last)], edge[x]);
        let weight = force[0] * force[0] + force[1] * force[1];
        *target = [0, 1].map(|i| {
            let laplacian = above[x][i] + below[x][i] + left[i] + right[i] - 4.0 * here[x][i];
            here[x][i] + mu * laplacian - weight * (here[x][i] - force[i])
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_do_not_depend_on_the_margin_but_for_their_scale() {
        let luma =
            Grid::from_fn(90, 70, |x, y| (127.0 + 60.0 * (0.4 * x as f32).sin() + 60.0 * (0.3 * y as f32).cos()) as u8);
        let points = [[40.0, 30.0], [50.0, 30.0], [50.0, 40.0], [40.0, 40.0]];
        let whole = Edges::around(&luma, &points, (2.0, 200));
        assert_eq!((whole.origin, whole.strength.size()), ([0, 0], (90, 70)));
        for margin in [4, 9, 24] {
            let part = Edges::around(&luma, &points, (2.0, margin));
            assert_eq!(part.origin, [40 - margin, 30 - margin]);
            let (width, height) = part.strength.size();
            for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
                let there = whole.strength[(x + part.origin[0], y + part.origin[1])] * whole.steepest;
                let here = part.strength[(x, y)] * part.steepest;
                assert!((here - there).abs() < 1e-3, "margin {margin} px, pixel {x}, {y}: {here}, not {there}");
            }
        }
    }
}
