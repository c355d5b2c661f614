//! Refinement of a homography: the squared distance in frame t + 1, minimised by Gauss–Newton steps.

use nalgebra::SVector;

use super::Correspondence;
use super::fit::fit;
use super::moments::Moments;
use crate::base::wide::wide;
use crate::products::model::{HORIZON, Matrix3, Model};

/// Most Gauss–Newton steps after the DLT.
const STEPS: usize = 12;
/// A step that lowers the sum by a smaller share is the last.
const LEAST_GAIN: f64 = 1e-12;

/// Fits `model` to all of `matches` by least squares of the distance in frame t + 1.
pub fn least_squares(model: Model, matches: &[Correspondence]) -> Option<Matrix3> {
    let first = fit(model, matches)?;
    if model != Model::Homography {
        return Some(first);
    }
    // In units of about 1, so that the normal equations are well conditioned.
    let size = matches.iter().flat_map(|m| m.from).fold(1.0f64, |most, c| most.max(c.abs()));
    let mut matrix = first;
    let mut at = Some(equations(&matrix, matches, size)).filter(|at| at.is_regular)?;
    for _ in 0..STEPS {
        let Some(next) = step(&matrix, &at, size) else { break };
        let there = equations(&next, matches, size);
        // Far from the minimum a step may lead upwards.
        if !there.is_regular || there.squared >= at.squared {
            break;
        }
        let is_last = there.squared >= at.squared * (1.0 - LEAST_GAIN);
        (matrix, at) = (next, there);
        if is_last {
            break;
        }
    }
    Some(matrix)
}

/// The matrix after a step; `None` where the equations are singular.
fn step(matrix: &Matrix3, Equations { moments, right, .. }: &Equations, size: f64) -> Option<Matrix3> {
    let normal = moments.transfer().fixed_view::<8, 8>(0, 0).into_owned();
    let right = SVector::<f64, 8>::from_fn(|i, _| right[i]);
    let d = normal.cholesky()?.solve(&right);
    let [[a, b, c], [e, f, g], [h, i, last]] = *matrix;
    Some([[a + d[0], b + d[1], c + size * d[2]], [e + d[3], f + d[4], g + size * d[5]], [h + d[6], i + d[7], last]])
}

/// The normal equations of a Gauss–Newton step.
#[derive(Default)]
struct Equations {
    /// The moments of the entries of the matrix; the last one is kept.
    moments: Moments,
    right: [f64; 9],
    /// The sum of the squared distances in px².
    squared: f64,
    /// Whether all points lie before the horizon.
    is_regular: bool,
}

wide! {
    fn equations(matrix: &Matrix3, matches: &[Correspondence], size: f64) -> Equations = equations_body
}

#[inline(always)]
fn equations_body(matrix: &Matrix3, matches: &[Correspondence], size: f64) -> Equations {
    let (mut moments, mut right, mut squared, mut least) = (Moments::default(), [0.0; 9], 0.0, f64::INFINITY);
    for Correspondence { from: [x, y], to } in matches {
        let [a, b, w] = matrix.map(|row| row[0] * x + row[1] * y + row[2]);
        let (u, v, p) = (a / w, b / w, [x / w, y / w, size / w]);
        let [off_x, off_y] = [to[0] - u, to[1] - v];
        squared += off_x * off_x + off_y * off_y;
        least = if w < least { w } else { least };
        moments.add(p, [u, v, 1.0], 1.0);
        for (block, factor) in [off_x, off_y, -(u * off_x + v * off_y)].into_iter().enumerate() {
            (0..3).for_each(|i| right[3 * block + i] += factor * p[i]);
        }
    }
    Equations { moments, right, squared, is_regular: least > HORIZON }
}

#[cfg(test)]
mod tests {
    use super::super::fit::squared_error;
    use super::*;
    use crate::products::model::mapped;
    use crate::synth::random::{gaussian, hash};

    #[test]
    fn the_distance_is_smaller_than_after_the_direct_linear_transformation() {
        let truth = [[1.1, 0.2, -7.0], [-0.3, 0.9, 22.0], [4e-4, -3e-4, 1.0]];
        let noisy = |i: u64| {
            let from = [((i * 197 + 31) % 640) as f64, ((i * 331 + 77) % 480) as f64];
            let to = mapped(&truth, from).expect("before the horizon");
            Correspondence { from, to: [to[0] + gaussian(hash(1, i, 0)), to[1] + gaussian(hash(1, i, 1))] }
        };
        let all: Vec<_> = (0..60).map(noisy).collect();
        let sum = |matrix: &Matrix3| all.iter().map(|m| squared_error(matrix, m)).sum::<f64>();
        let linear = fit(Model::Homography, &all).expect("points in general position");
        let refined = least_squares(Model::Homography, &all).expect("points in general position");
        assert!(sum(&refined) <= sum(&linear), "{} after {}", sum(&refined), sum(&linear));
        // At the minimum no change of an entry lowers the cost.
        for (i, j) in [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2), (2, 0), (2, 1)] {
            for by in [-1e-5, 1e-5] {
                let mut other = refined;
                other[i][j] *= 1.0 + by;
                assert!(sum(&other) >= sum(&refined), "entry {i}, {j}");
            }
        }
    }
}
