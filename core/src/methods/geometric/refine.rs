//! Refinement of a homography: the squared distance in frame t + 1, minimised by Gauss–Newton steps.

use nalgebra::{SMatrix, SVector};

use super::Correspondence;
use super::fit::fit;
use crate::products::model::{Matrix3, Model};

/// Gauss–Newton steps after the DLT: more change nothing in double precision.
const STEPS: usize = 4;

/// Fits `model` to all of `matches` by least squares of the distance in frame t + 1.
pub fn least_squares(model: Model, matches: &[Correspondence]) -> Option<Matrix3> {
    let first = fit(model, matches)?;
    if model != Model::Homography {
        return Some(first);
    }
    let mut matrix = first;
    for _ in 0..STEPS {
        matrix = step(&matrix, matches)?;
    }
    Some(matrix)
}

fn step(matrix: &Matrix3, matches: &[Correspondence]) -> Option<Matrix3> {
    let (mut normal, mut right) = (SMatrix::<f64, 8, 8>::zeros(), SVector::<f64, 8>::zeros());
    // In units of about 1, so that the normal equations are well conditioned.
    let size = matches.iter().flat_map(|m| m.from).fold(1.0f64, |most, c| most.max(c.abs()));
    for Correspondence { from, to } in matches {
        let [x, y] = *from;
        let [a, b, w] = matrix.map(|row| row[0] * x + row[1] * y + row[2]);
        if w <= 1e-9 {
            return None;
        }
        let (u, v, [x, y, one]) = (a / w, b / w, [x / w, y / w, size / w]);
        let rows = [
            (SVector::from([x, y, one, 0.0, 0.0, 0.0, -u * x, -u * y]), to[0] - u),
            (SVector::from([0.0, 0.0, 0.0, x, y, one, -v * x, -v * y]), to[1] - v),
        ];
        for (row, error) in rows {
            normal += row * row.transpose();
            right += row * error;
        }
    }
    let d = normal.cholesky()?.solve(&right);
    let [[a, b, c], [e, f, g], [h, i, _]] = *matrix;
    Some([[a + d[0], b + d[1], c + size * d[2]], [e + d[3], f + d[4], g + size * d[5]], [h + d[6], i + d[7], 1.0]])
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
        // At the minimum no entry can be changed for the better.
        for (i, j) in [(0, 0), (0, 2), (1, 1), (1, 2), (2, 0), (2, 1)] {
            for by in [-1e-5, 1e-5] {
                let mut other = refined;
                other[i][j] *= 1.0 + by;
                assert!(sum(&other) >= sum(&refined), "entry {i}, {j}");
            }
        }
    }
}
