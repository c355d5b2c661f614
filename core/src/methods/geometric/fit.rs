//! Least-squares fits of the transformations of the plane (Hartley and Zisserman 2004, chapter 4).

use nalgebra::{SMatrix, SVector};

use super::Correspondence;
use super::moments::Moments;
use super::normalisation::{Normalisation, mean};
use crate::base::wide::wide;
use crate::products::model::{HORIZON, Matrix3, Model, beyond_horizon, oriented};
pub use crate::products::model::{inverse, product};

/// Fits `model` to correspondences. With as many as determine it the fit is exact; with more, translation, rigid, similarity and affine
/// minimise the squared distance in frame t + 1, a homography the algebraic distance of the normalised DLT. `None` if they do not determine
/// it: too few, on a line, or on both sides of the horizon of the homography.
pub fn fit(model: Model, matches: &[Correspondence]) -> Option<Matrix3> {
    if matches.len() < model.sample_size() {
        return None;
    }
    let matrix = match model {
        Model::Translation => translation(matches),
        Model::Rigid => rotation(matches, false)?,
        Model::Similarity => rotation(matches, true)?,
        Model::Affine => affine(matches)?,
        Model::Homography => homography(matches)?,
    };
    matrix.iter().flatten().all(|entry| entry.is_finite()).then_some(matrix)
}

fn translation(matches: &[Correspondence]) -> Matrix3 {
    let [u, v] = mean(matches.iter().map(|m| [m.to[0] - m.from[0], m.to[1] - m.from[1]]));
    [[1.0, 0.0, u], [0.0, 1.0, v], [0.0, 0.0, 1.0]]
}

/// Rotation and translation, with scale or without, in closed form (Umeyama 1991, in the plane).
fn rotation(matches: &[Correspondence], has_scale: bool) -> Option<Matrix3> {
    let (from, to) = (mean(matches.iter().map(|m| m.from)), mean(matches.iter().map(|m| m.to)));
    let (mut along, mut across, mut spread) = (0.0, 0.0, 0.0);
    for m in matches {
        let [x, y] = [m.from[0] - from[0], m.from[1] - from[1]];
        let [u, v] = [m.to[0] - to[0], m.to[1] - to[1]];
        along += x * u + y * v;
        across += x * v - y * u;
        spread += x * x + y * y;
    }
    let length = along.hypot(across);
    if spread < 1e-9 || length < 1e-9 {
        return None;
    }
    let scale = if has_scale { length / spread } else { 1.0 };
    let (cos, sin) = (scale * along / length, scale * across / length);
    let offset = [to[0] - cos * from[0] + sin * from[1], to[1] - sin * from[0] - cos * from[1]];
    Some([[cos, -sin, offset[0]], [sin, cos, offset[1]], [0.0, 0.0, 1.0]])
}

/// The normal equations of an affine map: the mean of the points of frame t, the sums of products of these points relative to it, and their sums
/// of products with the points of frame t + 1.
pub(super) fn normal_equations(matches: &[Correspondence]) -> ([f64; 2], SMatrix<f64, 3, 3>, SMatrix<f64, 3, 2>) {
    let centre = mean(matches.iter().map(|m| m.from));
    let (mut normal, mut right) = (SMatrix::<f64, 3, 3>::zeros(), SMatrix::<f64, 3, 2>::zeros());
    for m in matches {
        let row = SVector::<f64, 3>::new(m.from[0] - centre[0], m.from[1] - centre[1], 1.0);
        normal += row * row.transpose();
        right += row * SMatrix::<f64, 1, 2>::new(m.to[0], m.to[1]);
    }
    (centre, normal, right)
}

fn affine(matches: &[Correspondence]) -> Option<Matrix3> {
    let (centre, normal, right) = normal_equations(matches);
    // The spread of points across the line that fits them best decides whether they determine the map.
    let spread = normal[(0, 0)] * normal[(1, 1)] - normal[(0, 1)] * normal[(1, 0)];
    let size = normal[(0, 0)] + normal[(1, 1)];
    if spread < 1e-9 * size * size {
        return None;
    }
    let solution = normal.cholesky()?.solve(&right);
    let row = |i: usize| {
        let [a, b, c] = [solution[(0, i)], solution[(1, i)], solution[(2, i)]];
        [a, b, c - a * centre[0] - b * centre[1]]
    };
    Some([row(0), row(1), [0.0, 0.0, 1.0]])
}

/// The homography, with all matches before its horizon.
fn homography(matches: &[Correspondence]) -> Option<Matrix3> {
    oriented(&linear(matches)?, matches.iter().map(|m| m.from))
}

/// The number of matches that the homography through all of them maps beyond its horizon from the others; `None` if they determine none.
pub(crate) fn across_horizon(matches: &[Correspondence]) -> Option<usize> {
    Some(beyond_horizon(&linear(matches)?, matches.iter().map(|m| m.from)))
}

/// The homography by the normalised direct linear transformation (Hartley 1997), up to a factor.
fn linear(matches: &[Correspondence]) -> Option<Matrix3> {
    let from = Normalisation::of(matches.iter().map(|m| m.from))?;
    let to = Normalisation::of(matches.iter().map(|m| m.to))?;
    let normalised = |m: &Correspondence| Correspondence { from: from.apply(m.from), to: to.apply(m.to) };
    let matrix = match matches.len() {
        4 => exact(matches.iter().map(normalised))?,
        count => direct_linear(&Moments::of(matches, [&from, &to], &vec![1.0; count]))?,
    };
    Some(product(&to.inverse(), &product(&matrix, &from.matrix())))
}

/// The homography through four correspondences, with its last entry 1: their mean lies before the horizon where they all do.
fn exact(matches: impl Iterator<Item = Correspondence>) -> Option<Matrix3> {
    let (mut system, mut right) = (SMatrix::<f64, 8, 8>::zeros(), SVector::<f64, 8>::zeros());
    for (i, Correspondence { from: [x, y], to: [u, v] }) in matches.enumerate() {
        let rows = [[x, y, 1.0, 0.0, 0.0, 0.0, -x * u, -y * u], [0.0, 0.0, 0.0, x, y, 1.0, -x * v, -y * v]];
        for (j, row) in rows.into_iter().enumerate() {
            row.into_iter().enumerate().for_each(|(k, entry)| system[(2 * i + j, k)] = entry);
        }
        (right[2 * i], right[2 * i + 1]) = (u, v);
    }
    let lu = system.lu();
    // Three of four points on a line make it singular.
    let pivots = (0..8).map(|i| lu.u()[(i, i)].abs());
    if pivots.fold(f64::INFINITY, f64::min) < 1e-6 {
        return None;
    }
    let h = lu.solve(&right)?;
    Some([[h[0], h[1], h[2]], [h[3], h[4], h[5]], [h[6], h[7], 1.0]])
}

/// The unit vector h that minimises |A h| for the equations A of normalised correspondences.
fn direct_linear(moments: &Moments) -> Option<Matrix3> {
    let normal = moments.transfer();
    let eigen = normal.symmetric_eigen();
    let mut order: Vec<usize> = (0..9).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
    // Two solutions are equally good if the points lie on a line.
    let [least, next, most] = [order[0], order[1], order[8]].map(|i| eigen.eigenvalues[i]);
    if next - least < 1e-9 * most {
        return None;
    }
    let h = eigen.eigenvectors.column(order[0]);
    Some([[h[0], h[1], h[2]], [h[3], h[4], h[5]], [h[6], h[7], h[8]]])
}

/// Whether three of the points of a sample lie on a line, in one of the frames.
pub fn is_on_line(sample: &[Correspondence]) -> bool {
    /// Largest height of a flat triangle as a share of its longest side.
    const FLAT: f64 = 1e-3;
    let is_flat = |[a, b, c]: [[f64; 2]; 3]| {
        let side = |p: [f64; 2], q: [f64; 2]| (q[0] - p[0]).hypot(q[1] - p[1]);
        let area = ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])).abs();
        area <= FLAT * side(a, b).max(side(b, c)).max(side(c, a)).powi(2)
    };
    let count = sample.len();
    let triples = (0..count).flat_map(|i| (0..i).flat_map(move |j| (0..j).map(move |k| [i, j, k])));
    triples.into_iter().any(|of| is_flat(of.map(|i| sample[i].from)) || is_flat(of.map(|i| sample[i].to)))
}

/// The squared distance of a correspondence from the model in px², in frame t + 1; infinite beyond the horizon.
#[inline(always)]
pub fn squared_error(matrix: &Matrix3, m: &Correspondence) -> f64 {
    let [x, y] = m.from;
    let [a, b, w] = matrix.map(|row| row[0] * x + row[1] * y + row[2]);
    let [dx, dy] = [a / w - m.to[0], b / w - m.to[1]];
    if w > HORIZON { dx * dx + dy * dy } else { f64::INFINITY }
}

wide! {
    /// Writes the squared distance of each correspondence from the model.
    pub fn squared_errors(matrix: &Matrix3, matches: &[Correspondence], errors: &mut [f64]) = squared_errors_body
}

#[inline(always)]
fn squared_errors_body(matrix: &Matrix3, matches: &[Correspondence], errors: &mut [f64]) {
    errors.iter_mut().zip(matches).for_each(|(error, m)| *error = squared_error(matrix, m));
}

#[cfg(test)]
mod tests {
    use super::super::refine::least_squares;
    use super::*;
    use crate::products::model::mapped;
    use crate::synth::random::{hash, unit};

    const ALL: [Model; 5] = [Model::Translation, Model::Rigid, Model::Similarity, Model::Affine, Model::Homography];

    fn truth(model: Model) -> Matrix3 {
        let (sin, cos) = 0.3f64.sin_cos();
        match model {
            Model::Translation => [[1.0, 0.0, 12.5], [0.0, 1.0, -3.25], [0.0, 0.0, 1.0]],
            Model::Rigid => [[cos, -sin, 5.0], [sin, cos, 40.0], [0.0, 0.0, 1.0]],
            Model::Similarity => [[1.4 * cos, -1.4 * sin, 5.0], [1.4 * sin, 1.4 * cos, 40.0], [0.0, 0.0, 1.0]],
            Model::Affine => [[1.1, 0.2, -7.0], [-0.3, 0.9, 22.0], [0.0, 0.0, 1.0]],
            Model::Homography => [[1.1, 0.2, -7.0], [-0.3, 0.9, 22.0], [4e-4, -3e-4, 1.0]],
        }
    }

    fn matches(matrix: &Matrix3, count: usize) -> Vec<Correspondence> {
        matches_from([0.0; 2], matrix, count)
    }

    /// Exact matches of points in 640×480 px.
    fn matches_from([left, top]: [f64; 2], matrix: &Matrix3, count: usize) -> Vec<Correspondence> {
        let random = |i: usize, k: u64| unit(hash(3, i as u64, k));
        let point = |i: usize| [left + 640.0 * random(i, 0), top + 480.0 * random(i, 1)];
        let moved = |from| mapped(matrix, from).expect("before the horizon");
        (0..count).map(point).map(|from| Correspondence { from, to: moved(from) }).collect()
    }

    #[test]
    fn exact_correspondences_give_the_exact_model() {
        for model in ALL {
            let matrix = truth(model);
            for count in [model.sample_size(), model.sample_size() + 1, 50] {
                let found = fit(model, &matches(&matrix, count)).expect("points in general position");
                let off = matches(&matrix, 80).iter().map(|m| squared_error(&found, m).sqrt()).fold(0.0, f64::max);
                assert!(off < 1e-6, "{model:?} from {count}: {off}");
            }
        }
    }

    #[test]
    fn the_horizon_may_lie_between_the_origin_and_the_points() {
        let truth = |last: f64| [[1.1, 0.2, -7.0], [-0.3, 0.9, 22.0], [1e-2, -1e-3, last]];
        // The third homogeneous coordinate at (0, 0): behind the horizon, on it, and before it. At the points it is at least 0.5.
        for matrix in [-1.0, 0.0, 1.0].map(truth) {
            for count in [4, 5, 50] {
                let exact = matches_from([200.0, 0.0], &matrix, count);
                for fitted in [fit, least_squares] {
                    let found = fitted(Model::Homography, &exact).expect("all points lie before the horizon");
                    let back = inverse(&found).expect("regular");
                    for m in matches_from([200.0, 0.0], &matrix, 80) {
                        let there = squared_error(&found, &m).sqrt();
                        let here = squared_error(&back, &Correspondence { from: m.to, to: m.from }).sqrt();
                        assert!(there < 1e-6 && here < 1e-6, "{matrix:?} from {count}: {there} px and back {here} px");
                    }
                }
            }
        }
    }

    #[test]
    fn a_horizon_between_the_points_is_refused() {
        let matrix = [[1.1, 0.2, -7.0], [-0.3, 0.9, 22.0], [1e-2, -1e-3, -3.0]];
        let at = |[x, y]: [f64; 2]| {
            let [a, b, w] = matrix.map(|row: [f64; 3]| row[0] * x + row[1] * y + row[2]);
            Correspondence { from: [x, y], to: [a / w, b / w] }
        };
        let sample = [[200.0, 50.0], [500.0, 40.0], [600.0, 300.0], [420.0, 400.0]].map(at);
        assert_eq!((fit(Model::Homography, &sample), across_horizon(&sample)), (None, Some(1)));
        assert_eq!(across_horizon(&matches(&truth(Model::Homography), 9)), Some(0));
    }

    #[test]
    fn degenerate_points_determine_no_model() {
        let on_line = |i: usize| {
            let from = [10.0 + 7.0 * i as f64, 20.0 + 3.5 * i as f64];
            Correspondence { from, to: [from[0] + 1.0, from[1]] }
        };
        let line: Vec<_> = (0..9).map(on_line).collect();
        let one_place = vec![Correspondence { from: [3.0, 4.0], to: [5.0, 6.0] }; 9];
        for model in [Model::Affine, Model::Homography] {
            assert_eq!(fit(model, &line), None, "{model:?}");
            assert_eq!(fit(model, &line[..model.sample_size()]), None, "{model:?}");
        }
        for model in &ALL[1..] {
            assert_eq!(fit(*model, &one_place), None, "{model:?}");
            assert_eq!(fit(*model, &line[..model.sample_size() - 1]), None, "{model:?}");
        }
    }

    #[test]
    fn an_inverse_undoes_its_matrix() {
        let matrix = truth(Model::Homography);
        let one = product(&matrix, &inverse(&matrix).expect("regular"));
        for (i, row) in one.iter().enumerate() {
            assert!(row.iter().enumerate().all(|(j, v)| (v - f64::from(u8::from(i == j))).abs() < 1e-12));
        }
        assert_eq!(inverse(&[[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [0.0, 0.0, 1.0]]), None);
    }
}
