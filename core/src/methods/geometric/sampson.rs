//! The fundamental matrix of least Sampson distances: Levenberg–Marquardt steps on the seven degrees of freedom of a matrix of rank
//! two (A. Bartoli and P. Sturm, Nonlinear estimation of the fundamental matrix with minimal parameters, IEEE PAMI 26(3), 2004).

use nalgebra::{Matrix3 as Square, SMatrix, SVector, Vector3};

use super::Correspondence;
use super::fit::product;
use super::normalisation::Normalisation;
use crate::products::model::Matrix3;

/// Degrees of freedom: three rotations of each orthogonal factor, and the ratio of the singular values.
const FREEDOM: usize = 7;
/// Most steps.
const STEPS: usize = 10;
/// A step that lowers the sum by a smaller share is the last.
const LEAST_GAIN: f64 = 1e-6;

type Normal = SMatrix<f64, FREEDOM, FREEDOM>;
type Parameters = SVector<f64, FREEDOM>;

/// The matrix U diag(1, s, 0) Vᵀ.
#[derive(Clone, Copy)]
struct Factors {
    u: Square<f64>,
    ratio: f64,
    v: Square<f64>,
}

impl Factors {
    /// The factors of the nearest matrix of rank two.
    fn of(matrix: &Square<f64>) -> Option<Self> {
        let svd = matrix.svd(true, true);
        let (u, v_t) = (svd.u?, svd.v_t?);
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| svd.singular_values[*b].total_cmp(&svd.singular_values[*a]));
        let first = svd.singular_values[order[0]];
        if first <= 0.0 {
            return None;
        }
        Some(Self {
            u: Square::from_columns(&order.map(|i| u.column(i).into_owned())),
            ratio: svd.singular_values[order[1]] / first,
            v: Square::from_columns(&order.map(|i| v_t.row(i).transpose())),
        })
    }

    fn with(&self, middle: Square<f64>) -> Square<f64> {
        self.u * middle * self.v.transpose()
    }

    fn matrix(&self) -> Square<f64> {
        self.with(Square::from_diagonal(&Vector3::new(1.0, self.ratio, 0.0)))
    }

    /// The derivatives of the matrix by the parameters.
    fn derivatives(&self) -> [Square<f64>; FREEDOM] {
        let diagonal = Square::from_diagonal(&Vector3::new(1.0, self.ratio, 0.0));
        std::array::from_fn(|k| match k {
            0..=2 => self.with(turn(k) * diagonal),
            3..=5 => self.with(-(diagonal * turn(k - 3))),
            _ => self.with(Square::from_diagonal(&Vector3::new(0.0, 1.0, 0.0))),
        })
    }

    /// The factors after a step.
    fn moved(&self, by: &Parameters) -> Self {
        let rotation =
            |first: usize| nalgebra::Rotation3::new(Vector3::new(by[first], by[first + 1], by[first + 2])).into_inner();
        Self { u: self.u * rotation(0), ratio: self.ratio + by[6], v: self.v * rotation(3) }
    }
}

/// The derivative of a rotation about axis `k` at the angle 0.
fn turn(k: usize) -> Square<f64> {
    let mut axis = Vector3::zeros();
    axis[k] = 1.0;
    axis.cross_matrix()
}

/// The points of a correspondence in homogeneous coordinates.
type Ends = [Vector3<f64>; 2];

/// The sum of the squared distances.
fn cost(matrix: &Square<f64>, ends: &[Ends]) -> f64 {
    let squared = |[from, to]: &Ends| {
        let (line, back) = (matrix * from, matrix.tr_mul(to));
        let value = to.dot(&line);
        value * value / gradient(&line, &back)
    };
    ends.iter().map(squared).sum()
}

/// The squared length of the gradient of x′ᵀ F x over the four coordinates.
fn gradient(line: &Vector3<f64>, back: &Vector3<f64>) -> f64 {
    (line.xy().norm_squared() + back.xy().norm_squared()).max(f64::MIN_POSITIVE)
}

/// The normal equations of a Gauss–Newton step: JᵀJ and −Jᵀr.
fn equations(at: &Factors, ends: &[Ends]) -> (Normal, Parameters) {
    let (matrix, derivatives) = (at.matrix(), at.derivatives());
    let (mut normal, mut right) = (Normal::zeros(), Parameters::zeros());
    for [from, to] in ends {
        let (line, back) = (matrix * from, matrix.tr_mul(to));
        let (value, squared) = (to.dot(&line), gradient(&line, &back));
        let length = squared.sqrt();
        let row = Parameters::from_fn(|k, _| {
            let (by_line, by_back) = (derivatives[k] * from, derivatives[k].tr_mul(to));
            let by_squared = line.xy().dot(&by_line.xy()) + back.xy().dot(&by_back.xy());
            to.dot(&by_line) / length - value * by_squared / (squared * length)
        });
        normal += row * row.transpose();
        right -= row * (value / length);
    }
    (normal, right)
}

/// Moves `matrix`, in px, to the minimum of the sum of squared Sampson distances of `matches` near it. `None` if it has no such form.
pub fn refined(matrix: &Matrix3, matches: &[Correspondence]) -> Option<Matrix3> {
    // Both frames in the same units, about 1: the distances are those in px times the factor.
    let mut by = [Normalisation::of(matches.iter().map(|m| m.from))?, Normalisation::of(matches.iter().map(|m| m.to))?];
    by[1].scale = by[0].scale;
    let ends: Vec<Ends> = matches.iter().map(|m| [point(by[0].apply(m.from)), point(by[1].apply(m.to))]).collect();
    let [from, to] = by.map(|normalisation| normalisation.inverse());
    let inner = product(&transposed(&to), &product(matrix, &from));
    let mut at = Factors::of(&Square::from_fn(|i, j| inner[i][j]))?;
    let (mut least, mut damping) = (cost(&at.matrix(), &ends), 1e-4);
    for _ in 0..STEPS {
        let (normal, right) = equations(&at, &ends);
        let damped = normal + Normal::from_diagonal(&(normal.diagonal() * damping));
        let Some(step) = damped.cholesky().map(|lower| lower.solve(&right)) else { break };
        let next = at.moved(&step);
        let there = cost(&next.matrix(), &ends);
        if there < least {
            let is_last = there >= least * (1.0 - LEAST_GAIN);
            (at, least, damping) = (next, there, damping / 10.0);
            if is_last {
                break;
            }
        } else {
            damping *= 10.0;
        }
    }
    let found = at.matrix();
    let rows: Matrix3 = std::array::from_fn(|i| std::array::from_fn(|j| found[(i, j)]));
    let in_px = product(&transposed(&by[1].matrix()), &product(&rows, &by[0].matrix()));
    let norm = in_px.iter().flatten().map(|entry| entry * entry).sum::<f64>().sqrt();
    (norm.is_finite() && norm > 0.0).then(|| in_px.map(|row| row.map(|entry| entry / norm)))
}

fn point([x, y]: [f64; 2]) -> Vector3<f64> {
    Vector3::new(x, y, 1.0)
}

fn transposed(matrix: &Matrix3) -> Matrix3 {
    std::array::from_fn(|i| std::array::from_fn(|j| matrix[j][i]))
}

#[cfg(test)]
mod tests {
    use super::super::epipolar::{eight_point, sampson_squared};
    use super::*;
    use crate::synth::random::{gaussian, hash, unit};

    /// Points at many depths, seen by a camera that moves sideways, with noise of `sigma_px` in frame t + 1.
    fn sideways(count: usize, sigma_px: f64) -> Vec<Correspondence> {
        let one = |i: usize| {
            let random = |k: u64| unit(hash(11, i as u64, k));
            let from = [320.0 * random(0), 240.0 * random(1)];
            let disparity = [7.0, 3.0, 1.5, 0.75, 0.25][i % 5];
            let off = [2, 3].map(|k| sigma_px * gaussian(hash(12, i as u64, k)));
            Correspondence { from, to: [from[0] - disparity + off[0], from[1] + off[1]] }
        };
        (0..count).map(one).collect()
    }

    fn sum(matrix: &Matrix3, matches: &[Correspondence]) -> f64 {
        matches.iter().map(|m| sampson_squared(matrix, m)).sum()
    }

    #[test]
    fn no_matrix_of_rank_two_near_by_has_a_smaller_sum() {
        let all = sideways(140, 0.2);
        let found = refined(&eight_point(&all).expect("general position"), &all).expect("a matrix");
        let least = sum(&found, &all);
        let at = Factors::of(&Square::from_fn(|i, j| found[i][j])).expect("rank two");
        for k in 0..FREEDOM {
            for by in [-1e-6, 1e-6] {
                let mut step = Parameters::zeros();
                step[k] = by;
                let other = at.moved(&step).matrix();
                let other: Matrix3 = std::array::from_fn(|i| std::array::from_fn(|j| other[(i, j)]));
                assert!(sum(&other, &all) >= least * (1.0 - 1e-4), "parameter {k}: {} of {least}", sum(&other, &all));
            }
        }
    }

    #[test]
    fn the_sum_is_at_most_that_of_the_true_matrix() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let truth = [[0.0; 3], [0.0, 0.0, -half], [0.0, half, 0.0]];
        for sigma_px in [0.05, 0.2, 0.5] {
            let all = sideways(140, sigma_px);
            let start = eight_point(&all).expect("general position");
            let found = refined(&start, &all).expect("a matrix");
            assert!(sum(&found, &all) <= sum(&start, &all));
            assert!(sum(&found, &all) <= sum(&truth, &all), "σ {sigma_px}");
        }
        let exact = sideways(140, 0.0);
        let found = refined(&eight_point(&exact).expect("general position"), &exact).expect("a matrix");
        assert!(sum(&found, &exact) < 1e-9);
    }
}
