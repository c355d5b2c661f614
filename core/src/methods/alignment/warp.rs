//! Warps and their parameters, in coordinates about the middle of a picture.

use crate::geometry::Grid;
use crate::products::Model;
use crate::products::model::{IDENTITY, Matrix3, product};

/// Coordinates relative to the middle of a picture, in halves of its longer side, which give all parameters a similar size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Normalized {
    middle: [f64; 2],
    /// px of a unit.
    pub scale: f64,
}

impl Normalized {
    pub(crate) fn of((width, height): (usize, usize)) -> Self {
        let middle = [width, height].map(|extent| (extent as f64 - 1.0) / 2.0);
        Self { middle, scale: (width.max(height) as f64 / 2.0).max(1.0) }
    }

    /// A pixel in these coordinates.
    #[inline(always)]
    pub(crate) fn of_pixel(&self, x: usize, y: usize) -> [f64; 2] {
        [(x as f64 - self.middle[0]) / self.scale, (y as f64 - self.middle[1]) / self.scale]
    }

    /// A warp in these coordinates as a warp of pixels.
    pub(crate) fn in_px(&self, matrix: &Matrix3) -> Matrix3 {
        let ([x, y], s) = (self.middle, self.scale);
        let to = [[1.0 / s, 0.0, -x / s], [0.0, 1.0 / s, -y / s], [0.0, 0.0, 1.0]];
        let from = [[s, 0.0, x], [0.0, s, y], [0.0, 0.0, 1.0]];
        product(&from, &product(matrix, &to))
    }
}

/// The names of the parameters.
pub(crate) fn names(model: Model) -> &'static [&'static str] {
    match model {
        Model::Translation => &["t_x", "t_y"],
        Model::Rigid => &["θ", "t_x", "t_y"],
        Model::Similarity => &["a", "b", "t_x", "t_y"],
        Model::Affine => &["p₁", "p₂", "t_x", "p₃", "p₄", "t_y"],
        Model::Homography => &["p₁", "p₂", "t_x", "p₃", "p₄", "t_y", "p₅", "p₆"],
    }
}

/// The warp with these parameters; all 0 give no motion.
pub(crate) fn warp_of(model: Model, p: &[f64]) -> Matrix3 {
    match (model, p) {
        (Model::Translation, [x, y]) => [[1.0, 0.0, *x], [0.0, 1.0, *y], [0.0, 0.0, 1.0]],
        (Model::Rigid, [angle, x, y]) => {
            let (sin, cos) = angle.sin_cos();
            [[cos, -sin, *x], [sin, cos, *y], [0.0, 0.0, 1.0]]
        }
        (Model::Similarity, [a, b, x, y]) => [[1.0 + a, -b, *x], [*b, 1.0 + a, *y], [0.0, 0.0, 1.0]],
        (Model::Affine, [a, b, x, c, d, y]) => [[1.0 + a, *b, *x], [*c, 1.0 + d, *y], [0.0, 0.0, 1.0]],
        (Model::Homography, [a, b, x, c, d, y, g, h]) => [[1.0 + a, *b, *x], [*c, 1.0 + d, *y], [*g, *h, 1.0]],
        _ => IDENTITY,
    }
}

/// The values of the steepest-descent images at a pixel: its gradient in gray levels per unit, times the derivatives of the warp.
#[inline(always)]
pub(crate) fn columns(model: Model, [x, y]: [f64; 2], gradient: [f32; 2], scale: f64) -> [f64; 8] {
    let [u, v] = gradient.map(|slope| f64::from(slope) * scale);
    match model {
        Model::Translation => [u, v, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        Model::Rigid => [v * x - u * y, u, v, 0.0, 0.0, 0.0, 0.0, 0.0],
        Model::Similarity => [u * x + v * y, v * x - u * y, u, v, 0.0, 0.0, 0.0, 0.0],
        Model::Affine => [u * x, u * y, u, v * x, v * y, v, 0.0, 0.0],
        Model::Homography => {
            let along = u * x + v * y;
            [u * x, u * y, u, v * x, v * y, v, -along * x, -along * y]
        }
    }
}

/// Derivatives along x and y: central differences, at the border to one side.
pub(crate) fn gradients(picture: &Grid<f32>) -> [Grid<f32>; 2] {
    let (width, height) = picture.size();
    let slope = |low: f32, high: f32, apart: usize| if apart == 0 { 0.0 } else { (high - low) / apart as f32 };
    let ends = |c: usize, extent: usize| (c.saturating_sub(1), (c + 1).min(extent - 1));
    let along = Grid::from_fn(width, height, |x, y| {
        let (low, high) = ends(x, width);
        slope(picture[(low, y)], picture[(high, y)], high - low)
    });
    let down = Grid::from_fn(width, height, |x, y| {
        let (low, high) = ends(y, height);
        slope(picture[(x, low)], picture[(x, high)], high - low)
    });
    [along, down]
}

/// The warp after the inverse of `increment`, with a last entry of 1; `None` if that has no inverse, or the middle of the picture goes behind
/// the horizon.
pub(crate) fn composed(warp: &Matrix3, increment: &Matrix3) -> Option<Matrix3> {
    let composed = product(warp, &inverse(increment)?);
    let last = composed[2][2];
    let is_sound = last > 1e-9 && composed.iter().flatten().all(|entry| entry.is_finite());
    is_sound.then(|| composed.map(|row| row.map(|entry| entry / last)))
}

/// The inverse by cofactors.
fn inverse(m: &Matrix3) -> Option<Matrix3> {
    let minor = |i: usize, j: usize| {
        let [a, b] = [(i + 1) % 3, (i + 2) % 3];
        let [c, d] = [(j + 1) % 3, (j + 2) % 3];
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let det: f64 = (0..3).map(|j| m[0][j] * minor(0, j)).sum();
    (det.abs() > 1e-12).then(|| [0, 1, 2].map(|i| [0, 1, 2].map(|j| minor(j, i) / det)))
}

/// A pivot below this share of its diagonal entry is rounding.
const SINGULAR: f64 = 1e-9;

/// The rank of a symmetric positive semi-definite matrix of `count` rows: the parameters that it determines together
/// with the earlier ones.
pub(crate) fn rank(matrix: &[f64], count: usize) -> usize {
    let (mut root, mut rank) = (vec![0.0; count * count], 0);
    for j in 0..count {
        let rest = |i: usize, root: &[f64]| {
            let known: f64 = (0..j).map(|k| root[i * count + k] * root[j * count + k]).sum();
            matrix[i * count + j] - known
        };
        let pivot = rest(j, &root);
        // A column without a pivot adds nothing to the earlier ones.
        if pivot > SINGULAR * matrix[j * count + j] && pivot.is_finite() {
            for i in j..count {
                root[i * count + j] = rest(i, &root) / pivot.sqrt();
            }
            rank += 1;
        }
    }
    rank
}

/// Solves `matrix · x = right` for a symmetric positive definite matrix, by Cholesky decomposition; `None` if it is singular.
pub(crate) fn solve(matrix: &[f64], right: &[f64]) -> Option<Vec<f64>> {
    let count = right.len();
    let mut root = matrix.to_vec();
    for i in 0..count {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| root[i * count + k] * root[j * count + k]).sum();
            let rest = matrix[i * count + j] - known;
            if i != j {
                root[i * count + j] = rest / root[j * count + j];
            } else if rest > SINGULAR * matrix[i * count + i] && rest.is_finite() {
                root[i * count + i] = rest.sqrt();
            } else {
                return None;
            }
        }
    }
    let mut x = right.to_vec();
    for i in 0..count {
        let known: f64 = (0..i).map(|k| root[i * count + k] * x[k]).sum();
        x[i] = (x[i] - known) / root[i * count + i];
    }
    for i in (0..count).rev() {
        let known: f64 = (i + 1..count).map(|k| root[k * count + i] * x[k]).sum();
        x[i] = (x[i] - known) / root[i * count + i];
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_is_solved_and_a_singular_one_is_not() {
        let matrix = [4.0, 2.0, 0.4, 2.0, 5.0, 1.0, 0.4, 1.0, 3.0];
        let x = solve(&matrix, &[1.0, -2.0, 0.5]).expect("regular");
        for (row, right) in matrix.chunks(3).zip([1.0, -2.0, 0.5]) {
            assert!((row.iter().zip(&x).map(|(a, b)| a * b).sum::<f64>() - right).abs() < 1e-12);
        }
        assert_eq!(solve(&[1.0, 2.0, 2.0, 4.0], &[1.0, 1.0]), None);
        assert_eq!(solve(&[0.0; 4], &[0.0; 2]), None);
    }

    #[test]
    fn the_rank_is_the_number_of_independent_columns() {
        let gram = |columns: &[[f64; 4]]| -> Vec<f64> {
            let product = |a: &[f64; 4], b: &[f64; 4]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            columns.iter().flat_map(|a| columns.iter().map(move |b| product(a, b))).collect()
        };
        let (a, b) = ([1.0, 2.0, 0.0, -1.0], [0.5, 0.0, 3.0, 1.0]);
        let sum = [0, 1, 2, 3].map(|i| a[i] + 2.0 * b[i]);
        assert_eq!(rank(&gram(&[a, b, [0.0, 0.0, 0.0, 1.0]]), 3), 3);
        assert_eq!(rank(&gram(&[a, sum, b]), 3), 2);
        assert_eq!(rank(&gram(&[[0.0; 4], a, a]), 3), 1);
        assert_eq!(rank(&[0.0; 36], 6), 0);
    }

    #[test]
    fn steepest_descent_is_the_derivative_of_the_warp() {
        const STEP: f64 = 1e-6;
        let (at, gradient) = ([0.3, -0.7], [2.0f32, -1.5]);
        for model in [Model::Translation, Model::Rigid, Model::Similarity, Model::Affine, Model::Homography] {
            let exact = columns(model, at, gradient, 10.0);
            for i in 0..model.freedom() {
                let mut parameters = vec![0.0; model.freedom()];
                parameters[i] = STEP;
                let to = crate::products::model::mapped(&warp_of(model, &parameters), at).expect("in front");
                let moved = [0, 1].map(|k| (to[k] - at[k]) / STEP);
                let slope = 10.0 * (moved[0] * f64::from(gradient[0]) + moved[1] * f64::from(gradient[1]));
                assert!((slope - exact[i]).abs() < 1e-4, "{model:?}, {}: {slope}, not {}", names(model)[i], exact[i]);
            }
        }
    }

    #[test]
    fn a_warp_is_undone_by_itself() {
        let warp = [[1.1, 0.2, 3.0], [-0.1, 0.9, -2.0], [0.001, 0.002, 1.0]];
        let back = composed(&warp, &warp).expect("regular");
        for (a, b) in back.iter().flatten().zip(IDENTITY.iter().flatten()) {
            assert!((a - b).abs() < 1e-12);
        }
        assert_eq!(composed(&warp, &[[0.0; 3]; 3]), None);
    }
}
