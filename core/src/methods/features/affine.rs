//! Dissimilarity of a feature from its first view under an affine map: J. Shi and C. Tomasi, Good features to track, CVPR 1994;
//! with gain and offset: H. Jin, P. Favaro and S. Soatto, Real-time feature tracking and outlier rejection with changes in
//! illumination, ICCV 2001.

use super::tracker::Level;
use crate::base::Observer;

/// The first view of a feature: its window where it was detected.
#[derive(Debug, PartialEq)]
pub struct View {
    reach: usize,
    /// The gray values, row by row; NaN outside the frame.
    values: Vec<f32>,
    /// Their mean.
    mean: f32,
}

/// The initial values of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// The affine matrix A.
    pub matrix: [[f32; 2]; 2],
    /// Gain and offset; `None` for constant illumination.
    pub light: Option<[f32; 2]>,
}

/// The affine map of a first view into a later frame: the pixel at offset `o` from the centre maps to the tracked position plus
/// A o + d.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The matrix A, row by row.
    pub matrix: [[f32; 2]; 2],
    /// The shift d from the tracked position, in px.
    pub shift: [f32; 2],
    /// Gain λ and offset δ: a gray value I of the view becomes λ I + δ.
    pub light: [f32; 2],
    /// The dissimilarity: the mean absolute difference, in gray levels.
    pub difference: f32,
    /// The share of its pixels inside the frame.
    pub share: f32,
}

/// The identity matrix.
pub const IDENTITY: [[f32; 2]; 2] = [[1.0, 0.0], [0.0, 1.0]];
/// Unit gain, zero offset.
pub const SAME_LIGHT: [f32; 2] = [1.0, 0.0];

/// Stopping criterion: the fit ends when no pixel of the window moves farther, in px.
const EPSILON_PX: f32 = 0.02;
/// Largest number of iterations.
const ITERATIONS: usize = 10;

/// Why an affine fit failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FitFailure {
    /// The system is singular, or less than half of the view lies in the frame.
    Undetermined,
    /// The fit diverged beyond plausible stretch, shift or gain.
    Diverged,
}

/// Largest plausible stretch or compression in any direction.
const STRETCH: f32 = 2.0;
/// Largest plausible gain, or inverse gain: without contrast a view fits any flat window.
const GAIN: f32 = 2.0;
/// Largest plausible shift from the tracked position, in px.
const SHIFT_PX: f32 = 4.0;

impl Fit {
    /// Whether stretch, shift and gain are plausible.
    fn is_plausible(&self) -> bool {
        let [[a, b], [c, d]] = self.matrix;
        // The singular values of A: the roots of s² − t s + det².
        let (t, det) = (a * a + b * b + c * c + d * d, a * d - b * c);
        let root = (t * t - 4.0 * det * det).max(0.0).sqrt();
        let [large, small] = [t + root, t - root].map(|twice| (twice / 2.0).max(0.0).sqrt());
        let is_lit = (1.0 / GAIN..=GAIN).contains(&self.light[0]);
        let is_near = self.shift[0].hypot(self.shift[1]) <= SHIFT_PX;
        det > 0.0 && large <= STRETCH && small >= 1.0 / STRETCH && is_near && is_lit
    }
}

/// The unknowns of an update: matrix, shift, and gain and offset if these are fitted.
const UNKNOWNS: usize = 8;

/// The normal equations of an update: T z = a for z = (D₁₁, D₁₂, D₂₁, D₂₂, d₁, d₂, λ, δ), with δ at the view's mean.
#[derive(Default)]
struct Normal {
    matrix: [[f64; UNKNOWNS]; UNKNOWNS],
    right: [f64; UNKNOWNS],
    difference: f64,
    pixels: u32,
}

impl View {
    /// Samples the window of radius `reach` px around a position of `level`.
    pub fn new(level: &Level, at: [f32; 2], reach: usize) -> Self {
        let value = |[i, j]: [f32; 2]| {
            let place = [at[0] + i, at[1] + j];
            if level.holds(place) { level.sample(place) } else { f32::NAN }
        };
        let values: Vec<f32> = offsets(reach).map(value).collect();
        let known = values.iter().filter(|v| !v.is_nan());
        let mean = known.clone().sum::<f32>() / known.count().max(1) as f32;
        Self { reach, values, mean }
    }

    /// Returns the side in px.
    pub fn side(&self) -> usize {
        2 * self.reach + 1
    }

    /// Returns the gray values, row by row; NaN outside the frame.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Returns the size in memory, in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.values[..])
    }

    /// Fits the view to `next` around a position by the Gauss–Newton method, and reports each iteration.
    ///
    /// # Errors
    /// Why it cannot be fitted.
    pub fn fit(
        &self,
        next: &Level,
        at: [f32; 2],
        start: Start,
        observer: &mut impl Observer<Fit>,
    ) -> Result<Fit, FitFailure> {
        let light = start.light.unwrap_or(SAME_LIGHT);
        let mut fit = Fit { matrix: start.matrix, shift: [0.0; 2], light, difference: 0.0, share: 0.0 };
        for iteration in 0..ITERATIONS {
            let lost = if iteration == 0 { FitFailure::Undetermined } else { FitFailure::Diverged };
            let normal = self.normal(next, at, &fit);
            (fit.difference, fit.share) = (normal.mean(), normal.pixels as f32 / self.values.len() as f32);
            observer.see(|| fit);
            if fit.share < 0.5 {
                return Err(lost);
            }
            let update = normal.update(start.light.is_some()).ok_or(lost)?.map(|v| v as f32);
            for (i, row) in fit.matrix.iter_mut().enumerate() {
                row.iter_mut().zip(&update[2 * i..]).for_each(|(value, change)| *value += change);
                fit.shift[i] += update[4 + i];
            }
            fit.light = [fit.light[0] + update[6], fit.light[1] + update[7] - update[6] * self.mean];
            let reach = self.reach as f32;
            let moved = [0, 1].map(|i| (update[2 * i].abs() + update[2 * i + 1].abs()) * reach + update[4 + i].abs());
            if !fit.is_plausible() {
                return Err(FitFailure::Diverged);
            }
            if moved[0].max(moved[1]) < EPSILON_PX {
                break;
            }
        }
        let normal = self.normal(next, at, &fit);
        (fit.difference, fit.share) = (normal.mean(), normal.pixels as f32 / self.values.len() as f32);
        observer.see(|| fit);
        if fit.share < 0.5 { Err(FitFailure::Diverged) } else { Ok(fit) }
    }

    /// Returns the normal equations at `fit`.
    fn normal(&self, next: &Level, at: [f32; 2], fit: &Fit) -> Normal {
        let mut normal = Normal::default();
        for (offset, value) in offsets(self.reach).zip(&self.values) {
            let place = place(at, fit, offset);
            if value.is_nan() || !next.holds_around(place) {
                continue;
            }
            let (there, gradient) = next.slope(place);
            let off = fit.light[0] * value + fit.light[1] - there;
            normal.add(gradient.map(f64::from), offset.map(f64::from), f64::from(value - self.mean), f64::from(off));
        }
        normal
    }

    /// Returns the normalised cross-correlation with another window of this size, −1 to 1; `None` without contrast.
    pub fn correlation(&self, other: &[f32]) -> Option<f32> {
        let both = || self.values.iter().zip(other).filter(|(a, b)| a.is_finite() && b.is_finite());
        let count = both().count() as f64;
        let sums = both().fold([0.0; 2], |sums, (a, b)| [sums[0] + f64::from(*a), sums[1] + f64::from(*b)]);
        let mean = sums.map(|sum| sum / count);
        let [aa, ab, bb] = both().fold([0.0; 3], |[aa, ab, bb], (a, b)| {
            let [a, b] = [f64::from(*a) - mean[0], f64::from(*b) - mean[1]];
            [aa + a * a, ab + a * b, bb + b * b]
        });
        (aa > 0.0 && bb > 0.0).then(|| (ab / (aa * bb).sqrt()) as f32)
    }

    /// Returns the window of `next` warped to the view, with its illumination; NaN outside the frame.
    pub fn warped(&self, next: &Level, at: [f32; 2], fit: &Fit) -> Vec<f32> {
        let value = |offset| {
            let place = place(at, fit, offset);
            if next.holds(place) { (next.sample(place) - fit.light[1]) / fit.light[0] } else { f32::NAN }
        };
        offsets(self.reach).map(value).collect()
    }
}

impl Normal {
    /// Adds a pixel: its gradient, its offset in the view, its gray value minus the mean, and its residual.
    fn add(&mut self, [gx, gy]: [f64; 2], [i, j]: [f64; 2], value: f64, off: f64) {
        let row = [gx * i, gx * j, gy * i, gy * j, gx, gy, -value, -1.0];
        for (sums, a) in self.matrix.iter_mut().zip(row) {
            sums.iter_mut().zip(row).for_each(|(sum, b)| *sum += a * b);
        }
        self.right.iter_mut().zip(row).for_each(|(sum, a)| *sum += a * off);
        self.difference += off.abs();
        self.pixels += 1;
    }

    /// Solves for the update; without gain and offset unless `changes_light`.
    fn update(&self, changes_light: bool) -> Option<[f64; UNKNOWNS]> {
        if changes_light {
            return solve(self.matrix, self.right);
        }
        const SHAPE: usize = UNKNOWNS - 2;
        let matrix: [[f64; SHAPE]; SHAPE] = std::array::from_fn(|i| std::array::from_fn(|j| self.matrix[i][j]));
        let found = solve(matrix, std::array::from_fn(|i| self.right[i]))?;
        Some(std::array::from_fn(|i| found.get(i).copied().unwrap_or(0.0)))
    }

    fn mean(&self) -> f32 {
        (self.difference / f64::from(self.pixels.max(1))) as f32
    }
}

/// The offsets of the pixels of a window from its centre.
fn offsets(reach: usize) -> impl Iterator<Item = [f32; 2]> {
    let reach = reach as i32;
    (-reach..=reach).flat_map(move |j| (-reach..=reach).map(move |i| [i as f32, j as f32]))
}

/// The position to which a pixel of the view maps.
pub fn place(at: [f32; 2], fit: &Fit, [i, j]: [f32; 2]) -> [f32; 2] {
    [0, 1].map(|k| at[k] + fit.shift[k] + fit.matrix[k][0] * i + fit.matrix[k][1] * j)
}

/// The solution of a symmetric system by Cholesky decomposition; `None` if it is singular.
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
    use crate::geometry::{Gray, Grid};

    fn waves(x: f64, y: f64) -> f64 {
        128.0
            + 40.0 * (0.31 * x + 0.11 * y).sin()
            + 35.0 * (0.27 * y - 0.13 * x + 1.0).cos()
            + 20.0 * (0.4 * x * 0.7).sin()
    }

    const AS_IT_WAS: Start = Start { matrix: IDENTITY, light: None };
    const IN_ANY_LIGHT: Start = Start { matrix: IDENTITY, light: Some(SAME_LIGHT) };

    /// Waves mapped by `matrix` around (40, 30) and shifted by `shift` px.
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
            for start in [AS_IT_WAS, IN_ANY_LIGHT] {
                let mut fits = Vec::new();
                let fit = view.fit(&next, [40.0, 30.0], start, &mut fits).expect("a fit");
                assert!((fit.light[0] - 1.0).abs() < 0.01 && fit.light[1].abs() < 1.5, "{fit:?}");
                for i in 0..2 {
                    assert!((f64::from(fit.shift[i]) - shift[i]).abs() < 0.03, "{fit:?}, not {shift:?}");
                    for j in 0..2 {
                        assert!((f64::from(fit.matrix[i][j]) - matrix[i][j]).abs() < 0.01, "{fit:?}, not {matrix:?}");
                    }
                }
                assert!(fit.difference < 1.0, "{fit:?}");
                assert_eq!(fits.last(), Some(&fit));
                assert!(fits.first().is_some_and(|first| first.difference >= fit.difference - 0.05));
            }
        }
    }

    #[test]
    fn another_light_is_found_with_the_rest() {
        let turned = picture([[0.98, -0.15], [0.15, 0.98]], [-0.2, 0.5]);
        let first = Level::new(&picture([[1.0, 0.0], [0.0, 1.0]], [0.0; 2]), 10);
        let view = View::new(&first, [40.0, 30.0], 10);
        for (gain, offset) in [(0.7, 20.0), (0.8, 0.0), (1.0, 15.0)] {
            let lit = turned.map(|v| (gain * f32::from(*v) + offset).round().clamp(0.0, 255.0) as u8);
            let next = Level::new(&lit, 10);
            let fit = view.fit(&next, [40.0, 30.0], IN_ANY_LIGHT, &mut ()).expect("a fit");
            assert!((fit.light[0] - gain).abs() < 0.02 && (fit.light[1] - offset).abs() < 2.0, "{fit:?}");
            assert!((fit.matrix[1][0] - 0.15).abs() < 0.01 && fit.difference < 1.0, "{fit:?}");
            // In its own light it looks as it did.
            let warped = view.warped(&next, [40.0, 30.0], &fit);
            let off = warped.iter().zip(view.values()).map(|(now, then)| (now - then).abs()).fold(0.0, f32::max);
            assert!(off < 4.0, "{off}");
            let plain = view.fit(&next, [40.0, 30.0], AS_IT_WAS, &mut ());
            assert!(plain.is_err() || plain.is_ok_and(|plain| plain.difference > 5.0 && plain.light == SAME_LIGHT));
        }
        let flat = Level::new(&turned.map(|v| 100 + v / 10), 10);
        let found = view.fit(&flat, [40.0, 30.0], IN_ANY_LIGHT, &mut ());
        assert_eq!(found, Err(FitFailure::Diverged), "what has lost its contrast is another thing");
    }

    #[test]
    fn correlation_depends_on_the_pattern_not_on_its_light() {
        let level = Level::new(&picture([[1.0, 0.0], [0.0, 1.0]], [0.0; 2]), 10);
        let view = View::new(&level, [40.0, 30.0], 10);
        let lit: Vec<f32> = view.values().iter().map(|v| 0.4 * v + 30.0).collect();
        let negative: Vec<f32> = view.values().iter().map(|v| 255.0 - v).collect();
        let [same, opposite] = [&lit, &negative].map(|window| view.correlation(window).expect("contrast"));
        assert!((same - 1.0).abs() < 1e-5 && (opposite + 1.0).abs() < 1e-5, "{same} and {opposite}");
        assert_eq!(view.correlation(&vec![7.0; lit.len()]), None, "a flat window has no pattern");
        assert_eq!(view.correlation(&vec![f32::NAN; lit.len()]), None, "nothing is visible");
    }

    #[test]
    fn a_singular_fit_fails() {
        let flat = Level::new(&Grid::new(40, 40, 9), 10);
        assert_eq!(
            View::new(&flat, [20.0, 20.0], 10).fit(&flat, [20.0, 20.0], AS_IT_WAS, &mut ()),
            Err(FitFailure::Undetermined)
        );
        let first = Level::new(&picture([[1.0, 0.0], [0.0, 1.0]], [0.0; 2]), 10);
        let view = View::new(&first, [40.0, 30.0], 10);
        assert_eq!(
            view.fit(&first, [0.0, 0.0], IN_ANY_LIGHT, &mut ()),
            Err(FitFailure::Undetermined),
            "three quarters lie outside"
        );
        let dot = Level::new(&Grid::new(1, 1, 9), 3);
        assert_eq!(View::new(&dot, [0.0; 2], 3).fit(&dot, [0.0; 2], AS_IT_WAS, &mut ()), Err(FitFailure::Undetermined));
    }

    #[test]
    fn an_implausible_fit_is_rejected() {
        let fit = |matrix, shift| Fit { matrix, shift, light: SAME_LIGHT, difference: 0.0, share: 1.0 };
        assert!(fit([[1.3, 0.2], [-0.2, 0.8]], [1.0, -1.0]).is_plausible());
        let lit = |gain| Fit { light: [gain, 9.0], ..fit(IDENTITY, [0.0; 2]) }.is_plausible();
        assert!(lit(0.6) && lit(1.9) && !lit(0.4) && !lit(2.1) && !lit(-1.0));
        assert!(!fit(IDENTITY, [4.0, 1.0]).is_plausible(), "shifted");
        assert!(!fit([[1.0, 0.95], [0.95, 1.0]], [0.0; 2]).is_plausible(), "squeezed to a line");
        assert!(!fit([[1.0, 0.0], [0.0, -1.0]], [0.0; 2]).is_plausible(), "turned over");
        assert!(!fit([[2.1, 0.0], [0.0, 1.0]], [0.0; 2]).is_plausible(), "stretched");
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
