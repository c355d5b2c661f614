//! Spatial and temporal derivatives of a pair of frames.

use crate::base::{Threads, wide::wide};
use crate::choices;
use crate::geometry::{Beyond, Grid, Numbers, filter::filtered_row};

choices! {
    /// Kernel that estimates the derivatives I_x and I_y.
    pub enum Scheme {
        /// Half the difference of the two neighbours: (−1, 0, 1) / 2.
        Central = "central" "Central difference",
        /// Central difference, smoothed across by (1, 2, 1) / 4.
        Sobel = "sobel" "Sobel",
        /// Central difference, smoothed across by (3, 10, 3) / 16: less dependent on the orientation of an edge than Sobel.
        Scharr = "scharr" "Scharr",
        /// Mean of the four differences along the edges of a 2×2×2 cube, as in Horn and Schunck (1981). It holds for the
        /// centre of the cube, so corners and flow are shifted by half a pixel to the left and up.
        Cube = "cube" "2×2×2 cube",
        /// Fourth-order central difference: (1, −8, 0, 8, −1) / 12.
        FivePoint = "five-point" "Five-point",
    }
}

/// Squared gradient magnitude up to which a gradient is rounding error, in (gray levels per px)².
pub const FLAT: f32 = 1e-6;

/// Derivatives of the gray values along x, y and time, in gray levels per px and per frame.
///
/// At the image border they are one-sided differences. Unknown derivatives are NaN.
#[derive(Clone, Debug)]
pub struct Derivatives {
    /// I_x.
    pub x: Grid<f32>,
    /// I_y.
    pub y: Grid<f32>,
    /// I_t.
    pub t: Grid<f32>,
}

impl Scheme {
    /// Returns the kernel of the derivative along its axis, and of the smoothing across it.
    pub fn weights(self) -> (&'static [f32], &'static [f32]) {
        match self {
            Scheme::Central => (&[-0.5, 0.0, 0.5], &[1.0]),
            Scheme::Sobel => (&[-0.5, 0.0, 0.5], &[0.25, 0.5, 0.25]),
            Scheme::Scharr => (&[-0.5, 0.0, 0.5], &[3.0 / 16.0, 10.0 / 16.0, 3.0 / 16.0]),
            Scheme::Cube => (&[-1.0, 1.0], &[0.5, 0.5]),
            Scheme::FivePoint => (&[1.0 / 12.0, -8.0 / 12.0, 0.0, 8.0 / 12.0, -1.0 / 12.0], &[1.0]),
        }
    }

    /// Returns the derivatives of two frames of equal size. I_x and I_y are those of the mean of both frames.
    pub fn of(self, current: &Grid<f32>, next: &Grid<f32>, threads: &Threads) -> Derivatives {
        let (width, height) = current.size();
        let [mut x, mut y, mut t] = [(); 3].map(|()| Grid::new(width, height, 0.0));
        threads.rows_of([&mut x, &mut y, &mut t], |row, targets| self.row([current, next], row, targets));
        Derivatives { x, y, t }
    }

    /// Computes row `y` of I_x, I_y and I_t.
    pub fn row(self, pictures: [&Grid<f32>; 2], y: usize, targets: [&mut [f32]; 3]) {
        wide! {
            fn wide(by: Scheme, pictures: [&Grid<f32>; 2], y: usize, targets: [&mut [f32]; 3]) = Scheme::row_body
        }
        wide(self, pictures, y, targets);
    }

    #[inline(always)]
    fn row_body(self, [current, next]: [&Grid<f32>; 2], y: usize, [to_x, to_y, to_t]: [&mut [f32]; 3]) {
        let (along, across) = self.weights();
        let (at, height, mut control) = ((Beyond::Slope, y), current.height(), Vec::new());
        let mean = |y| Both { rows: [current.row(y), next.row(y)], f: |a, b| 0.5 * (a + b) };
        filtered_row((mean, height), (along, across), at, &mut control, to_x);
        filtered_row((mean, height), (across, along), at, &mut control, to_y);
        let change = |y| Both { rows: [current.row(y), next.row(y)], f: |a, b| b - a };
        let around = if self == Scheme::Cube { across } else { &[1.0] };
        filtered_row((change, height), (around, around), at, &mut control, to_t);
    }
}

/// Two rows combined by `f`, element by element.
#[derive(Clone, Copy)]
struct Both<'a, F> {
    rows: [&'a [f32]; 2],
    f: F,
}

impl<F: Fn(f32, f32) -> f32 + Copy> Numbers for Both<'_, F> {
    #[inline(always)]
    fn first(self, count: usize) -> Self {
        Self { rows: self.rows.map(|row| &row[..count]), ..self }
    }

    #[inline(always)]
    fn at(self, i: usize) -> f32 {
        (self.f)(self.rows[0][i], self.rows[1][i])
    }
}

impl Derivatives {
    /// Returns the size in memory, in bytes.
    pub fn bytes(&self) -> usize {
        [&self.x, &self.y, &self.t].map(|part| size_of_val(part.cells())).iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Scheme; 5] = [Scheme::Central, Scheme::Sobel, Scheme::Scharr, Scheme::Cube, Scheme::FivePoint];

    /// Returns the derivatives of `f(x, y, t)` at pixel (4, 5).
    fn at(scheme: Scheme, f: impl Fn(f64, f64, f64) -> f64) -> [f64; 3] {
        let frame = |t: f64| Grid::from_fn(9, 11, |x, y| f(x as f64, y as f64, t) as f32);
        let Derivatives { x, y, t } = scheme.of(&frame(0.0), &frame(1.0), &Threads::single());
        [x, y, t].map(|grid| f64::from(grid[(4, 5)]))
    }

    #[test]
    fn every_scheme_is_exact_on_planes_that_change() {
        for scheme in ALL {
            // The cube is centred between the pixels and frames; the other schemes are centred at the pixel, between both frames.
            let [x, y] = if scheme == Scheme::Cube { [4.5, 5.5] } else { [4.0, 5.0] };
            let f = |x: f64, y: f64, t: f64| 3.0 + 2.0 * x - 5.0 * y + 0.5 * x * y + t * (7.0 + x - 2.0 * y);
            let truth = [2.0 + 0.5 * y + 0.5, -5.0 + 0.5 * x - 1.0, 7.0 + x - 2.0 * y];
            for (found, truth) in at(scheme, f).into_iter().zip(truth) {
                assert!((found - truth).abs() < 1e-4, "{scheme:?}: {found}, not {truth}");
            }
        }
    }

    #[test]
    fn a_slope_is_as_steep_at_the_edge_as_elsewhere() {
        for scheme in ALL {
            let frame = |t: f32| Grid::from_fn(7, 6, |x, y| 4.0 * (x as f32 - 0.5 * t) - 3.0 * y as f32);
            let Derivatives { x, y, t } = scheme.of(&frame(0.0), &frame(1.0), &Threads::single());
            for (part, truth) in [(x, 4.0), (y, -3.0), (t, -2.0)] {
                assert!(part.cells().iter().all(|v| (v - truth).abs() < 1e-4), "{scheme:?}: {part:?}");
            }
        }
    }

    #[test]
    fn symmetric_schemes_are_exact_on_parabolas_and_five_points_on_the_fourth_power() {
        for scheme in ALL {
            let [x, y, _] = at(scheme, |x, y, _| (x - 3.0).powi(2) + 2.0 * (y - 3.0).powi(2));
            let middle = if scheme == Scheme::Cube { 0.5 } else { 0.0 };
            assert!((x - 2.0 * (1.0 + middle)).abs() < 1e-4 && (y - 4.0 * (2.0 + middle)).abs() < 1e-4, "{scheme:?}");
            let [x, ..] = at(scheme, |x, _, _| (x - 3.0).powi(4));
            assert_eq!((x - 4.0).abs() < 1e-3, scheme == Scheme::FivePoint, "{scheme:?}: {x}");
        }
    }

    #[test]
    fn a_picture_one_pixel_wide_has_no_derivative_across() {
        for scheme in ALL {
            let frame = |t: usize| Grid::from_fn(1, 6, |_, y| (y * y + t) as f32);
            let Derivatives { x, t, .. } = scheme.of(&frame(0), &frame(3), &Threads::single());
            assert!(x.cells().iter().all(|v| v.abs() < 1e-5) && t.cells().iter().all(|v| *v == 3.0), "{scheme:?}");
        }
    }
}
