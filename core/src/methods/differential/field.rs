//! Dense flow fields with separate components, so that loops over rows vectorise.

use crate::base::Threads;
use crate::data::Flow;
use crate::geometry::{Grid, Sampling, pyramid::resampled};
use crate::scene::{Picture, Role, Scene, Shape};

/// A dense flow field (u, v) in px/frame; NaN where it is unknown.
#[derive(Clone, Debug)]
pub struct Field {
    /// Horizontal component, positive to the right.
    pub u: Grid<f32>,
    /// Vertical component, positive downwards.
    pub v: Grid<f32>,
}

impl Field {
    /// Returns a constant field of `width × height` pixels.
    pub fn new((width, height): (usize, usize), [u, v]: [f32; 2]) -> Self {
        Self { u: Grid::new(width, height, u), v: Grid::new(width, height, v) }
    }

    /// Returns the flow at `(x, y)`; NaN where it is unknown.
    pub fn at(&self, x: usize, y: usize) -> [f32; 2] {
        [self.u[(x, y)], self.v[(x, y)]]
    }

    /// Whether the field is 0 everywhere.
    pub fn is_zero(&self) -> bool {
        // Chunks without early exit become vector instructions.
        let is_zero = |cells: &[f32]| cells.iter().fold(true, |all, cell| all & (*cell == 0.0));
        [&self.u, &self.v].into_iter().flat_map(|part| part.cells().chunks(1024)).all(is_zero)
    }

    /// Returns the size in memory, in bytes.
    pub fn bytes(&self) -> usize {
        2 * size_of_val(self.u.cells())
    }

    /// Returns the field resampled to another `size`, its vectors scaled accordingly.
    pub fn resized(&self, size: (usize, usize), threads: &Threads) -> Self {
        let part = |grid: &Grid<f32>, times: f32| {
            let mut part = resampled(grid, size, Sampling::Bilinear, threads);
            part.cells_mut().iter_mut().for_each(|c| *c *= times);
            part
        };
        let (width, height) = self.u.size();
        Self { u: part(&self.u, size.0 as f32 / width as f32), v: part(&self.v, size.1 as f32 / height as f32) }
    }

    /// Returns the field as a [`Flow`].
    pub fn flow(&self) -> Flow {
        let (width, height) = self.u.size();
        let mut flow = Grid::new(width, height, [0.0; 2]);
        let parts = self.u.cells().iter().zip(self.v.cells());
        for (uv, (&u, &v)) in flow.cells_mut().iter_mut().zip(parts) {
            *uv = if u.is_finite() & v.is_finite() { [u, v] } else { Flow::UNKNOWN };
        }
        Flow(flow)
    }
}

/// Draws a dense flow field.
pub fn draw(values: Grid<[f32; 2]>, scene: &mut Scene) {
    scene.draw(Picture::CURRENT, (Role::Result, "estimated flow"), Shape::Flow { origin: [0.0; 2], values });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_resized_field_moves_the_same_places() {
        // A turn about the middle of the picture, on twice as many pixels.
        let turn = |size: usize, middle: f32| {
            let part =
                |f: fn(f32, f32) -> f32| Grid::from_fn(size, size, |x, y| f(x as f32 - middle, y as f32 - middle));
            Field { u: part(|_, y| -0.1 * y), v: part(|x, _| 0.1 * x) }
        };
        let (coarse, fine) = (turn(20, 9.5), turn(40, 19.5));
        let resized = coarse.resized((40, 40), &Threads::single());
        for (x, y) in (1..39).flat_map(|y| (1..39).map(move |x| (x, y))) {
            let (found, truth) = (resized.at(x, y), fine.at(x, y));
            assert!((found[0] - truth[0]).abs() < 1e-4 && (found[1] - truth[1]).abs() < 1e-4, "{x}, {y}");
        }
    }

    #[test]
    fn half_known_is_unknown() {
        let field =
            Field { u: Grid::new(2, 1, 1.0), v: Grid::from_fn(2, 1, |x, _| if x == 0 { f32::NAN } else { 2.0 }) };
        assert_eq!((field.flow().at(0, 0), field.flow().at(1, 0)), (None, Some([1.0, 2.0])));
    }
}
