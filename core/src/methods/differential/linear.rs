//! The data term: gradient constraints, linearised about the current flow.

use std::sync::Arc;

use super::{Field, Scheme};
use crate::base::{Threads, effort};
use crate::geometry::{Grid, Sampling, warp::backward};

/// The gradient constraint a u + b v + c = 0 of every pixel, in gray levels. Unknown constraints are 0, 0, 0.
#[derive(Clone, Debug)]
pub struct Constraints {
    /// I_x.
    pub a: Grid<f32>,
    /// I_y.
    pub b: Grid<f32>,
    /// The residual at zero flow: I_t, or c after warping.
    pub c: Grid<f32>,
    /// The pixels with unknown constraint, as sorted row-major indices.
    unknown: Vec<u32>,
}

impl Constraints {
    /// Returns the constraints of an image of this size, whose coefficients `write` computes row by row. A coefficient that is
    /// not finite makes the constraint unknown.
    pub fn new(
        (width, height): (usize, usize),
        write: impl Fn(usize, [&mut [f32]; 3]) + Send + Sync,
        threads: &Threads,
    ) -> Self {
        let [mut a, mut b, mut c] = [(); 3].map(|()| Grid::new(width, height, 0.0));
        let unknown = threads.rows_of([&mut a, &mut b, &mut c], |y, mut row| {
            write(y, row.each_mut().map(|part| &mut **part));
            cleared(row).into_iter().map(|x| (y * width + x) as u32).collect::<Vec<_>>()
        });
        Self { a, b, c, unknown: unknown.concat() }
    }

    /// Returns a, b and c of a pixel.
    pub fn at(&self, place: (usize, usize)) -> [f32; 3] {
        [self.a[place], self.b[place], self.c[place]]
    }

    /// Whether the constraint of a pixel is known.
    pub fn is_known(&self, (x, y): (usize, usize)) -> bool {
        self.unknown_in_row(y).all(|unknown| unknown != x)
    }

    /// Returns the columns of row `y` with unknown constraint.
    pub fn unknown_in_row(&self, y: usize) -> impl Iterator<Item = usize> {
        let width = self.a.width();
        let before = |y: usize| self.unknown.partition_point(|i| (*i as usize) < y * width);
        self.unknown[before(y)..before(y + 1)].iter().map(move |i| *i as usize % width)
    }

    /// Returns the size in memory, in bytes.
    pub fn bytes(&self) -> usize {
        3 * size_of_val(self.a.cells()) + size_of_val(&self.unknown[..])
    }
}

/// Sets the unknown constraints of a row to 0 and returns their columns.
fn cleared([a, b, c]: [&mut [f32]; 3]) -> Vec<usize> {
    let is_unknown = |a: f32, b: f32, c: f32| !(a + b + c).is_finite();
    let of_row = a.iter().zip(&*b).zip(&*c);
    // Mostly all are finite; without early exit the test becomes vector instructions.
    if !of_row.fold(false, |any, ((a, b), c)| any | is_unknown(*a, *b, *c)) {
        return Vec::new();
    }
    let unknown: Vec<_> = (0..a.len()).filter(|&x| is_unknown(a[x], b[x], c[x])).collect();
    unknown.iter().for_each(|&x| (a[x], b[x], c[x]) = (0.0, 0.0, 0.0));
    unknown
}

/// The gradient constraints of all pixels, linearised about the flow `start`.
///
/// Frame t + 1 is warped toward frame t by `start`, so that (a, b, I_t) constrain the increment; with
/// c = I_t − a u₀ − b v₀ the unknown is the whole flow (u, v). Where `start` leads out of frame t + 1 the constraint is unknown.
pub struct Linear {
    /// a, b and c.
    pub factors: Constraints,
    /// The flow (u₀, v₀) of the linearisation.
    pub start: Arc<Field>,
}

impl Linear {
    /// Linearises the constraints of two frames about `start`.
    pub fn about(start: impl Into<Arc<Field>>, pictures: [&Grid<f32>; 2], scheme: Scheme, threads: &Threads) -> Self {
        let (start, [current, next]) = (start.into(), pictures);
        // The warped frame and three derivatives.
        effort::add(4 * current.cells().len());
        // At zero flow no warping is needed.
        if start.is_zero() {
            let write = |y, factors: [&mut [f32]; 3]| scheme.row([current, next], y, factors);
            return Self { factors: Constraints::new(current.size(), write, threads), start };
        }
        let warped = backward(next, [&start.u, &start.v], Sampling::Bicubic, threads);
        let write = |y, [a, b, c]: [&mut [f32]; 3]| {
            scheme.row([current, &warped], y, [&mut *a, &mut *b, &mut *c]);
            let start_at = start.u.row(y).iter().zip(start.v.row(y));
            for (c, ((a, b), (u, v))) in c.iter_mut().zip(a.iter().zip(b).zip(start_at)) {
                *c -= *a * u + *b * v;
            }
        };
        Self { factors: Constraints::new(current.size(), write, threads), start }
    }

    /// Returns I_x, I_y and I_t of a pixel; NaN where they are unknown.
    pub fn derivatives(&self, place: (usize, usize)) -> [f32; 3] {
        if !self.factors.is_known(place) {
            return [f32::NAN; 3];
        }
        let ([a, b, c], [u, v]) = (self.factors.at(place), self.start.at(place.0, place.1));
        [a, b, c + a * u + b * v]
    }

    /// Returns the size in memory, in bytes.
    pub fn bytes(&self) -> usize {
        self.factors.bytes() + self.start.bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_warped_frame() {
        let value = |x: f32, y: f32| 3.0 * x - 2.0 * y + 0.25 * x * y;
        let current = Grid::from_fn(12, 9, |x, y| value(x as f32, y as f32));
        let next = Grid::from_fn(12, 9, |x, y| value(x as f32 - 1.5, y as f32 + 0.5) + 1.0);
        let start = Field::new((12, 9), [1.0, -0.5]);
        let linear = Linear::about(start, [&current, &next], Scheme::Central, &Threads::single());
        // At (6, 4) the warped frame shows (7, 3.5) of frame t + 1, which is (5.5, 4) of frame t.
        let [a, b, t] = linear.derivatives((6, 4));
        assert!((t - (value(5.5, 4.0) + 1.0 - value(6.0, 4.0))).abs() < 1e-4, "I_t is {t}");
        let c = linear.factors.at((6, 4))[2];
        assert!((c - (t - a * 1.0 + b * 0.5)).abs() < 1e-4, "c is {c}");
        // The last column goes beyond the edge, and the first row as well.
        assert!(linear.factors.is_known((6, 4)) && !linear.factors.is_known((11, 4)));
        assert_eq!(linear.factors.at((11, 4)), [0.0; 3]);
        assert!(linear.derivatives((11, 4)).iter().all(|d| d.is_nan()));
        assert_eq!(linear.factors.unknown_in_row(0).count(), 12);
        assert_eq!(linear.factors.unknown_in_row(4).collect::<Vec<_>>(), [10, 11]);
    }
}
