//! Whether a feature still looks as in its first view, turned, stretched and sheared as it may be: J. Shi and C. Tomasi, Good
//! features to track, CVPR 1994; in other light: H. Jin, P. Favaro and S. Soatto, Real-time feature tracking and outlier
//! rejection with changes in illumination, ICCV 2001.

use super::tracker::Level;
use crate::base::Observer;

/// What a feature probe like where it was first seen.
#[derive(Debug, PartialEq)]
pub struct View {
    reach: usize,
    /// The gray values around it, row by row; NaN outside the picture.
    values: Vec<f32>,
    /// Their mean.
    mean: f32,
}

/// How a view lay before, and what may have become of it since.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Its matrix.
    pub matrix: [[f32; 2]; 2],
    /// Its light; `None` where that does not change.
    pub light: Option<[f32; 2]>,
}

/// How a first view lies in a later picture: the pixel at `o` px from its middle lies at A o + d from where the feature was
/// tracked to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The matrix A, row by row.
    pub matrix: [[f32; 2]; 2],
    /// The displacement d from where it was tracked to, in px.
    pub shift: [f32; 2],
    /// The light λ and δ: a gray value I of the view is λ I + δ now.
    pub light: [f32; 2],
    /// The mean of the absolute differences, in gray levels.
    pub difference: f32,
    /// The share of its pixels that lie in the picture.
    pub share: f32,
}

/// No turn and no stretch.
pub const IDENTITY: [[f32; 2]; 2] = [[1.0, 0.0], [0.0, 1.0]];
/// The light of the first view.
pub const SAME_LIGHT: [f32; 2] = [1.0, 0.0];

/// An update that moves no pixel of the window by more than this is the last.
const EPSILON_PX: f32 = 0.02;
/// At most so many updates.
const ITERATIONS: usize = 10;

/// Why a first view could not be fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FitFailure {
    /// It cannot be told how it lies: too little of it is in the picture, or its gradients do not say.
    Unknown,
    /// It would have to be stretched or shifted beyond reason.
    Astray,
}

/// A view that is stretched or squeezed by more than this in any direction fits anything.
const STRETCH: f32 = 2.0;
/// Light of which more than this, or less than its inverse, is left is no light but another thing: contrast that is taken away
/// altogether fits anything flat.
const GAIN: f32 = 2.0;
/// Where the tracked place and the fit differ by more, in px, one of them is wrong: a tracker drifts by less in a long clip.
const SHIFT_PX: f32 = 4.0;

impl Fit {
    /// Whether the view is neither squeezed nor shifted nor lit beyond reason.
    fn is_sound(&self) -> bool {
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

/// How much an update changes: the matrix, the displacement, and the light if that may change.
const UNKNOWNS: usize = 8;

/// The equations of an update: T z = a for z = (D₁₁, D₁₂, D₂₁, D₂₂, d₁, d₂, λ, δ), where δ is taken at the view's mean.
#[derive(Default)]
struct Normal {
    matrix: [[f64; UNKNOWNS]; UNKNOWNS],
    right: [f64; UNKNOWNS],
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
        let values: Vec<f32> = offsets(reach).map(value).collect();
        let known = values.iter().filter(|v| !v.is_nan());
        let mean = known.clone().sum::<f32>() / known.count().max(1) as f32;
        Self { reach, values, mean }
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

    /// Fits the view to `next` around a place, from `start` on, by Gauss and Newton's method; tells each fit on the way.
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
            let lost = if iteration == 0 { FitFailure::Unknown } else { FitFailure::Astray };
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
            if !fit.is_sound() {
                return Err(FitFailure::Astray);
            }
            if moved[0].max(moved[1]) < EPSILON_PX {
                break;
            }
        }
        let normal = self.normal(next, at, &fit);
        (fit.difference, fit.share) = (normal.mean(), normal.pixels as f32 / self.values.len() as f32);
        observer.see(|| fit);
        if fit.share < 0.5 { Err(FitFailure::Astray) } else { Ok(fit) }
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
            let off = fit.light[0] * value + fit.light[1] - there;
            normal.add(gradient.map(f64::from), offset.map(f64::from), f64::from(value - self.mean), f64::from(off));
        }
        normal
    }

    /// The view as it lies in `next`, in its own light, row by row; NaN outside the picture.
    pub fn warped(&self, next: &Level, at: [f32; 2], fit: &Fit) -> Vec<f32> {
        let value = |offset| {
            let place = place(at, fit, offset);
            if next.holds(place) { (next.sample(place) - fit.light[1]) / fit.light[0] } else { f32::NAN }
        };
        offsets(self.reach).map(value).collect()
    }
}

impl Normal {
    /// Adds a pixel: the gradient where it lies, its place in the view, its gray value there off the mean, and how far off it is.
    fn add(&mut self, [gx, gy]: [f64; 2], [i, j]: [f64; 2], value: f64, off: f64) {
        let row = [gx * i, gx * j, gy * i, gy * j, gx, gy, -value, -1.0];
        for (sums, a) in self.matrix.iter_mut().zip(row) {
            sums.iter_mut().zip(row).for_each(|(sum, b)| *sum += a * b);
        }
        self.right.iter_mut().zip(row).for_each(|(sum, a)| *sum += a * off);
        self.difference += off.abs();
        self.pixels += 1;
    }

    /// What the pixels say to change; no light unless that may change.
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
    use crate::geometry::{Gray, Grid};

    fn waves(x: f64, y: f64) -> f64 {
        128.0
            + 40.0 * (0.31 * x + 0.11 * y).sin()
            + 35.0 * (0.27 * y - 0.13 * x + 1.0).cos()
            + 20.0 * (0.4 * x * 0.7).sin()
    }

    const AS_IT_WAS: Start = Start { matrix: IDENTITY, light: None };
    const IN_ANY_LIGHT: Start = Start { matrix: IDENTITY, light: Some(SAME_LIGHT) };

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
            for start in [AS_IT_WAS, IN_ANY_LIGHT] {
                let mut told = Vec::new();
                let fit = view.fit(&next, [40.0, 30.0], start, &mut told).expect("a fit");
                assert!((fit.light[0] - 1.0).abs() < 0.01 && fit.light[1].abs() < 1.5, "{fit:?}");
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
        assert_eq!(found, Err(FitFailure::Astray), "what has lost its contrast is another thing");
    }

    #[test]
    fn what_cannot_be_told_is_not() {
        let flat = Level::new(&Grid::new(40, 40, 9), 10);
        assert_eq!(
            View::new(&flat, [20.0, 20.0], 10).fit(&flat, [20.0, 20.0], AS_IT_WAS, &mut ()),
            Err(FitFailure::Unknown)
        );
        let first = Level::new(&picture([[1.0, 0.0], [0.0, 1.0]], [0.0; 2]), 10);
        let view = View::new(&first, [40.0, 30.0], 10);
        assert_eq!(
            view.fit(&first, [0.0, 0.0], IN_ANY_LIGHT, &mut ()),
            Err(FitFailure::Unknown),
            "three quarters lie outside"
        );
        let dot = Level::new(&Grid::new(1, 1, 9), 3);
        assert_eq!(View::new(&dot, [0.0; 2], 3).fit(&dot, [0.0; 2], AS_IT_WAS, &mut ()), Err(FitFailure::Unknown));
    }

    #[test]
    fn a_fit_beyond_reason_is_none() {
        let fit = |matrix, shift| Fit { matrix, shift, light: SAME_LIGHT, difference: 0.0, share: 1.0 };
        assert!(fit([[1.3, 0.2], [-0.2, 0.8]], [1.0, -1.0]).is_sound());
        let lit = |gain| Fit { light: [gain, 9.0], ..fit(IDENTITY, [0.0; 2]) }.is_sound();
        assert!(lit(0.6) && lit(1.9) && !lit(0.4) && !lit(2.1) && !lit(-1.0));
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
