//! Whether a feature still looks as in its first view, turned, stretched and sheared as it may be: J. Shi and C. Tomasi, Good
//! features to track, CVPR 1994.

use super::tracker::Level;
use crate::Observer;

/// What a feature looked like where it was first seen.
#[derive(Debug, PartialEq)]
pub struct View {
    reach: usize,
    /// The gray values around it, row by row; NaN outside the picture.
    values: Vec<f32>,
}

/// How a first view lies in a later picture: the pixel at `o` px from its middle lies at A o + d from where the feature was
/// tracked to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The matrix A, row by row.
    pub matrix: [[f32; 2]; 2],
    /// The displacement d from where it was tracked to, in px.
    pub shift: [f32; 2],
    /// The mean of the absolute differences, in gray levels.
    pub difference: f32,
    /// The share of its pixels that lie in the picture.
    pub share: f32,
}

/// No turn and no stretch.
pub const IDENTITY: [[f32; 2]; 2] = [[1.0, 0.0], [0.0, 1.0]];

/// An update that moves no pixel of the window by more than this is the last.
const EPSILON_PX: f32 = 0.02;
/// At most so many updates.
const ITERATIONS: usize = 10;

/// Why a first view could not be fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unfit {
    /// It cannot be told how it lies: too little of it is in the picture, or its gradients do not say.
    Unknown,
    /// It would have to be stretched or shifted beyond reason.
    Astray,
}

/// A view that is stretched or squeezed by more than this in any direction fits anything.
const STRETCH: f32 = 2.0;
/// Where the tracked place and the fit differ by more, in px, one of them is wrong: a tracker drifts by less in a long clip.
const SHIFT_PX: f32 = 4.0;

impl Fit {
    /// Whether the view is neither squeezed nor shifted beyond reason.
    fn is_sound(&self) -> bool {
        let [[a, b], [c, d]] = self.matrix;
        // The singular values of A: the roots of s² − t s + det².
        let (t, det) = (a * a + b * b + c * c + d * d, a * d - b * c);
        let root = (t * t - 4.0 * det * det).max(0.0).sqrt();
        let [large, small] = [t + root, t - root].map(|twice| (twice / 2.0).max(0.0).sqrt());
        det > 0.0 && large <= STRETCH && small >= 1.0 / STRETCH && self.shift[0].hypot(self.shift[1]) <= SHIFT_PX
    }
}

/// The equations of an update: T z = a for z = (D₁₁, D₁₂, D₂₁, D₂₂, d₁, d₂).
#[derive(Default)]
struct Normal {
    matrix: [[f64; 6]; 6],
    right: [f64; 6],
    difference: f64,
    pixels: u32,
}

impl View {
    /// What `level` looks like around a place, `reach` px each way.
    pub fn new(level: &Level, at: [f32; 2], reach: usize) -> Self {
        let value = |[i, j]: [f32; 2]| {
            let place = [at[0] + i, at[1] + j];
            if level.holds(place) { level.sample(place) } else { f32::NAN }
        };
        Self { reach, values: offsets(reach).map(value).collect() }
    }

    /// Side in px.
    pub fn side(&self) -> usize {
        2 * self.reach + 1
    }

    /// The gray values, row by row; NaN outside the picture.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.values[..])
    }

    /// Fits the view to `next` around a place, from a matrix on, by Gauss and Newton's method; tells each fit on the way.
    ///
    /// # Errors
    /// Why it cannot be fitted.
    pub fn fit(
        &self,
        next: &Level,
        at: [f32; 2],
        matrix: [[f32; 2]; 2],
        observer: &mut impl Observer<Fit>,
    ) -> Result<Fit, Unfit> {
        let mut fit = Fit { matrix, shift: [0.0; 2], difference: 0.0, share: 0.0 };
        for iteration in 0..ITERATIONS {
            let lost = if iteration == 0 { Unfit::Unknown } else { Unfit::Astray };
            let normal = self.normal(next, at, &fit);
            (fit.difference, fit.share) = (normal.mean(), normal.pixels as f32 / self.values.len() as f32);
            observer.see(|| fit);
            if fit.share < 0.5 {
                return Err(lost);
            }
            let update = solve(normal.matrix, normal.right).ok_or(lost)?.map(|v| v as f32);
            for (i, row) in fit.matrix.iter_mut().enumerate() {
                row.iter_mut().zip(&update[2 * i..]).for_each(|(value, change)| *value += change);
                fit.shift[i] += update[4 + i];
            }
            let reach = self.reach as f32;
            let moved = [0, 1].map(|i| (update[2 * i].abs() + update[2 * i + 1].abs()) * reach + update[4 + i].abs());
            if !fit.is_sound() {
                return Err(Unfit::Astray);
            }
            if moved[0].max(moved[1]) < EPSILON_PX {
                break;
            }
        }
        let normal = self.normal(next, at, &fit);
        (fit.difference, fit.share) = (normal.mean(), normal.pixels as f32 / self.values.len() as f32);
        observer.see(|| fit);
        if fit.share < 0.5 { Err(Unfit::Astray) } else { Ok(fit) }
    }

    /// What the pixels of the view say where it lies as `fit` says.
    fn normal(&self, next: &Level, at: [f32; 2], fit: &Fit) -> Normal {
        let mut normal = Normal::default();
        for (offset, value) in offsets(self.reach).zip(&self.values) {
            let place = place(at, fit, offset);
            if value.is_nan() || !next.holds_around(place) {
                continue;
            }
            let (there, gradient) = next.slope(place);
            normal.add(gradient.map(f64::from), offset.map(f64::from), f64::from(value - there));
        }
        normal
    }

    /// The view as it lies in `next`, row by row; NaN outside the picture.
    pub fn warped(&self, next: &Level, at: [f32; 2], fit: &Fit) -> Vec<f32> {
        let value = |offset| {
            let place = place(at, fit, offset);
            if next.holds(place) { next.sample(place) } else { f32::NAN }
        };
        offsets(self.reach).map(value).collect()
    }
}

impl Normal {
    fn add(&mut self, [gx, gy]: [f64; 2], [i, j]: [f64; 2], off: f64) {
        let row = [gx * i, gx * j, gy * i, gy * j, gx, gy];
        for (sums, a) in self.matrix.iter_mut().zip(row) {
            sums.iter_mut().zip(row).for_each(|(sum, b)| *sum += a * b);
        }
        self.right.iter_mut().zip(row).for_each(|(sum, a)| *sum += a * off);
        self.difference += off.abs();
        self.pixels += 1;
    }

    fn mean(&self) -> f32 {
        (self.difference / f64::from(self.pixels.max(1))) as f32
    }
}

/// The pixels of a window, from its middle.
fn offsets(reach: usize) -> impl Iterator<Item = [f32; 2]> {
    let reach = reach as i32;
    (-reach..=reach).flat_map(move |j| (-reach..=reach).map(move |i| [i as f32, j as f32]))
}

/// Where a pixel of the view lies.
pub fn place(at: [f32; 2], fit: &Fit, [i, j]: [f32; 2]) -> [f32; 2] {
    [0, 1].map(|k| at[k] + fit.shift[k] + fit.matrix[k][0] * i + fit.matrix[k][1] * j)
}

/// The solution of symmetric equations by Cholesky's method; `None` if they do not determine it.
fn solve<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N]) -> Option<[f64; N]> {
    let largest = (0..N).map(|i| a[i][i]).fold(0.0, f64::max);
    for i in 0..N {
        for j in 0..=i {
            let sum = a[i][j] - (0..j).map(|k| a[i][k] * a[j][k]).sum::<f64>();
            if i > j {
                a[i][j] = sum / a[j][j];
            } else if sum > 1e-9 * largest {
                a[i][i] = sum.sqrt();
            } else {
                return None;
            }
        }
    }
    for i in 0..N {
        b[i] = (b[i] - (0..i).map(|k| a[i][k] * b[k]).sum::<f64>()) / a[i][i];
    }
    for i in (0..N).rev() {
        b[i] = (b[i] - (i + 1..N).map(|k| a[k][i] * b[k]).sum::<f64>()) / a[i][i];
    }
    Some(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Gray, Grid};

    fn waves(x: f64, y: f64) -> f64 {
        128.0
            + 40.0 * (0.31 * x + 0.11 * y).sin()
            + 35.0 * (0.27 * y - 0.13 * x + 1.0).cos()
            + 20.0 * (0.4 * x * 0.7).sin()
    }

    /// Waves that are seen as `matrix` says around (40, 30), and `shift` px farther.
    fn picture(matrix: [[f64; 2]; 2], shift: [f64; 2]) -> Gray {
        let det = matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0];
        Grid::from_fn(80, 60, |x, y| {
            let [i, j] = [x as f64 - 40.0 - shift[0], y as f64 - 30.0 - shift[1]];
            let back = [(matrix[1][1] * i - matrix[0][1] * j) / det, (matrix[0][0] * j - matrix[1][0] * i) / det];
            (waves(40.0 + back[0], 30.0 + back[1]) + 0.5) as u8
        })
    }

    #[test]
    fn turns_stretches_and_shears_are_found() {
        let first = Level::new(&picture([[1.0, 0.0], [0.0, 1.0]], [0.0; 2]), 10);
        let view = View::new(&first, [40.0, 30.0], 10);
        for (matrix, shift) in [
            ([[1.0, 0.0], [0.0, 1.0]], [0.0, 0.0]),
            ([[1.1, 0.0], [0.0, 0.93]], [0.4, -0.3]),
            ([[0.98, -0.15], [0.15, 0.98]], [-0.2, 0.5]),
            ([[1.0, 0.12], [-0.05, 1.05]], [0.6, 0.1]),
        ] {
            let next = Level::new(&picture(matrix, shift), 10);
            let mut told = Vec::new();
            let fit = view.fit(&next, [40.0, 30.0], IDENTITY, &mut told).expect("a fit");
            for i in 0..2 {
                assert!((f64::from(fit.shift[i]) - shift[i]).abs() < 0.03, "{fit:?}, not {shift:?}");
                for j in 0..2 {
                    assert!((f64::from(fit.matrix[i][j]) - matrix[i][j]).abs() < 0.01, "{fit:?}, not {matrix:?}");
                }
            }
            assert!(fit.difference < 1.0, "{fit:?}");
            assert_eq!(told.last(), Some(&fit));
            assert!(told.first().is_some_and(|first| first.difference >= fit.difference - 0.05));
        }
    }

    #[test]
    fn what_cannot_be_told_is_not() {
        let flat = Level::new(&Grid::new(40, 40, 9), 10);
        assert_eq!(View::new(&flat, [20.0, 20.0], 10).fit(&flat, [20.0, 20.0], IDENTITY, &mut ()), Err(Unfit::Unknown));
        let first = Level::new(&picture([[1.0, 0.0], [0.0, 1.0]], [0.0; 2]), 10);
        let view = View::new(&first, [40.0, 30.0], 10);
        assert_eq!(view.fit(&first, [0.0, 0.0], IDENTITY, &mut ()), Err(Unfit::Unknown), "three quarters lie outside");
        let dot = Level::new(&Grid::new(1, 1, 9), 3);
        assert_eq!(View::new(&dot, [0.0; 2], 3).fit(&dot, [0.0; 2], IDENTITY, &mut ()), Err(Unfit::Unknown));
    }

    #[test]
    fn a_fit_beyond_reason_is_none() {
        let fit = |matrix, shift| Fit { matrix, shift, difference: 0.0, share: 1.0 };
        assert!(fit([[1.3, 0.2], [-0.2, 0.8]], [1.0, -1.0]).is_sound());
        assert!(!fit(IDENTITY, [4.0, 1.0]).is_sound(), "shifted");
        assert!(!fit([[1.0, 0.95], [0.95, 1.0]], [0.0; 2]).is_sound(), "squeezed to a line");
        assert!(!fit([[1.0, 0.0], [0.0, -1.0]], [0.0; 2]).is_sound(), "turned over");
        assert!(!fit([[2.1, 0.0], [0.0, 1.0]], [0.0; 2]).is_sound(), "stretched");
    }

    #[test]
    fn equations_are_solved() {
        let root = [[3.0, 0.0, 0.0], [1.0, 2.0, 0.0], [-2.0, 0.5, 1.5]];
        let a: [[f64; 3]; 3] =
            std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| root[i][k] * root[j][k]).sum()));
        let want = [1.0, -2.0, 0.5];
        let b = std::array::from_fn(|i| (0..3).map(|j| a[i][j] * want[j]).sum());
        let found = solve(a, b).expect("a solution");
        assert!(found.iter().zip(want).all(|(found, want)| (found - want).abs() < 1e-12));
        assert_eq!(solve([[1.0, 1.0], [1.0, 1.0]], [1.0, 1.0]), None);
    }
}
