//! Epipolar geometry: the fundamental matrix from seven, eight or more correspondences, epipoles, and the pose of a calibrated camera
//! (Hartley and Zisserman 2004, chapters 9 and 11).

use nalgebra::{Matrix3 as Square, SVector, Vector3};

use super::fit::product;
use super::moments::{Moments, Normal};
use super::normalisation::Normalisation;
use super::{Correspondence, sampson};
use crate::base::wide::wide;
use crate::products::epipolar::Pose;
use crate::products::model::Matrix3;

/// The fundamental matrices through seven correspondences: one to three. None if they do not determine one.
pub fn seven_point(matches: &[Correspondence]) -> Vec<Matrix3> {
    let Some([from, to]) = normalisations(matches) else { return Vec::new() };
    let Some([a, b]) = null_space(matches, [&from, &to]) else { return Vec::new() };
    // det(λ A + (1 − λ) B) is a cubic in λ, known by four values.
    let at = |lambda: f64| mixed(&a, &b, lambda).determinant();
    let [d0, d1, d2, d3] = [0.0, 1.0, -1.0, 2.0].map(at);
    let (c0, c2) = (d0, (d1 + d2) / 2.0 - d0);
    let c3 = (d3 - 2.0 * d1 + d0 - 2.0 * c2) / 6.0;
    let c1 = d1 - c0 - c2 - c3;
    let of_root = |lambda: f64| in_px(&mixed(&a, &b, lambda), [&from, &to]);
    cubic_roots([c0, c1, c2, c3]).into_iter().filter_map(of_root).collect()
}

/// The fundamental matrix by the normalised eight-point algorithm (Hartley 1997), from eight correspondences or more. `None` if they do not
/// determine one.
pub fn eight_point(matches: &[Correspondence]) -> Option<Matrix3> {
    weighted_eight_point(matches, &normalisations(matches)?, &vec![1.0; matches.len()])
}

/// Rounds of reweighting.
const ROUNDS: usize = 6;

/// The fundamental matrix that minimises the sum of squared Sampson distances: up to six rounds of the eight-point algorithm, each with
/// weights from the estimate before, then steps to the minimum near by.
pub(crate) fn least_sampson(matches: &[Correspondence]) -> Option<Matrix3> {
    let by = normalisations(matches)?;
    let mut numbers = vec![1.0; matches.len()];
    let mut matrix = weighted_eight_point(matches, &by, &numbers)?;
    let cost = |matrix: &Matrix3, errors: &mut [f64]| {
        sampson_all(matrix, matches, errors);
        errors.iter().sum::<f64>()
    };
    let mut least = cost(&matrix, &mut numbers);
    for _ in 0..ROUNDS {
        weights_of(&matrix, matches, &mut numbers);
        let Some(next) = weighted_eight_point(matches, &by, &numbers) else { break };
        let sum = cost(&next, &mut numbers);
        if sum >= least {
            break;
        }
        (matrix, least) = (next, sum);
    }
    let refined = sampson::refined(&matrix, matches);
    // If the first is exact, rounding decides.
    Some(refined.filter(|refined| cost(refined, &mut numbers) < least).unwrap_or(matrix))
}

/// The normalisations of the points of both frames; `None` if all points of a frame are at one place.
fn normalisations(matches: &[Correspondence]) -> Option<[Normalisation; 2]> {
    Some([Normalisation::of(matches.iter().map(|m| m.from))?, Normalisation::of(matches.iter().map(|m| m.to))?])
}

fn weighted_eight_point(
    matches: &[Correspondence],
    [from, to]: &[Normalisation; 2],
    weights: &[f64],
) -> Option<Matrix3> {
    if matches.len() < 8 {
        return None;
    }
    let normal = Moments::of(matches, [from, to], weights).bilinear();
    let [least, next] = two_least_values(&normal);
    // A second solution is equally good: the points lie in a plane, or the camera has only rotated.
    if next.0 < 1e-10 * normal.trace() {
        return None;
    }
    denormalised(&square(&least.1), [from, to])
}

/// The epipolar constraint of a correspondence as a linear equation in the entries of F by rows.
fn equation([x, y]: [f64; 2], [u, v]: [f64; 2]) -> [f64; 9] {
    [u * x, u * y, u, v * x, v * y, v, x, y, 1.0]
}

/// The two smallest eigenvalues with their eigenvectors.
fn two_least_values(normal: &Normal) -> [(f64, SVector<f64, 9>); 2] {
    let eigen = normal.symmetric_eigen();
    let mut order: Vec<usize> = (0..9).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
    [0, 1].map(|i| (eigen.eigenvalues[order[i]], eigen.eigenvectors.column(order[i]).into_owned()))
}

/// Two matrices that span the solutions of seven equations, by elimination with complete pivoting; `None` if there are more.
fn null_space(matches: &[Correspondence], [from, to]: [&Normalisation; 2]) -> Option<[Square<f64>; 2]> {
    /// Smallest pivot of equations that do not depend on each other.
    const LEAST_PIVOT: f64 = 1e-5;
    let mut rows: [[f64; 9]; 7] = [[0.0; 9]; 7];
    for (row, m) in rows.iter_mut().zip(matches) {
        *row = equation(from.apply(m.from), to.apply(m.to));
    }
    // The unknown in each column.
    let mut unknowns: [usize; 9] = std::array::from_fn(|i| i);
    for k in 0..7 {
        let places = (k..7).flat_map(|i| (k..9).map(move |j| (i, j)));
        let (i, j) = places.reduce(|a, b| if rows[b.0][b.1].abs() > rows[a.0][a.1].abs() { b } else { a })?;
        rows.swap(k, i);
        rows.iter_mut().for_each(|row| row.swap(k, j));
        unknowns.swap(k, j);
        let pivot = rows[k];
        if pivot[k].abs() < LEAST_PIVOT {
            return None;
        }
        for (_, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = row[k] / pivot[k];
            row.iter_mut().zip(pivot).skip(k).for_each(|(entry, of_pivot)| *entry -= factor * of_pivot);
        }
    }
    // One of the last two unknowns is 1, the other 0.
    Some([7, 8].map(|free| {
        let mut entries = SVector::<f64, 9>::zeros();
        entries[unknowns[free]] = 1.0;
        (0..7).for_each(|k| entries[unknowns[k]] = -rows[k][free] / rows[k][k]);
        square(&entries.normalize())
    }))
}

fn square(entries: &SVector<f64, 9>) -> Square<f64> {
    Square::from_row_slice(entries.as_slice())
}

fn mixed(a: &Square<f64>, b: &Square<f64>, lambda: f64) -> Square<f64> {
    a * lambda + b * (1.0 - lambda)
}

/// The real roots of c₀ + c₁ x + c₂ x² + c₃ x³.
fn cubic_roots([c0, c1, c2, c3]: [f64; 4]) -> Vec<f64> {
    if c3.abs() < 1e-12 {
        return quadratic_roots([c0, c1, c2]);
    }
    let (a, b, c) = (c2 / c3, c1 / c3, c0 / c3);
    let (q, r) = ((a * a - 3.0 * b) / 9.0, (2.0 * a * a * a - 9.0 * a * b + 27.0 * c) / 54.0);
    if r * r < q * q * q {
        let angle = (r / q.powf(1.5)).clamp(-1.0, 1.0).acos();
        let root = |k: f64| -2.0 * q.sqrt() * ((angle + k * std::f64::consts::TAU) / 3.0).cos() - a / 3.0;
        return [0.0, 1.0, -1.0].map(root).to_vec();
    }
    let large = -r.signum() * (r.abs() + (r * r - q * q * q).sqrt()).cbrt();
    let small = if large == 0.0 { 0.0 } else { q / large };
    vec![large + small - a / 3.0]
}

fn quadratic_roots([c0, c1, c2]: [f64; 3]) -> Vec<f64> {
    let inner = c1 * c1 - 4.0 * c2 * c0;
    if c2.abs() < 1e-12 || inner < 0.0 {
        return if c2.abs() < 1e-12 && c1.abs() > 1e-12 { vec![-c0 / c1] } else { Vec::new() };
    }
    [1.0, -1.0].map(|sign: f64| (-c1 + sign * inner.sqrt()) / (2.0 * c2)).to_vec()
}

/// The matrix with rank two in px, of unit norm.
fn denormalised(matrix: &Square<f64>, by: [&Normalisation; 2]) -> Option<Matrix3> {
    let svd = matrix.svd(true, true);
    let (u, v_t) = (svd.u?, svd.v_t?);
    let mut values = svd.singular_values;
    let least = values.imin();
    values[least] = 0.0;
    in_px(&(u * Square::from_diagonal(&values) * v_t), by)
}

/// The matrix of normalised points in px, of unit norm.
fn in_px(matrix: &Square<f64>, [from, to]: [&Normalisation; 2]) -> Option<Matrix3> {
    let rows: Matrix3 = std::array::from_fn(|i| std::array::from_fn(|j| matrix[(i, j)]));
    let transposed = |m: Matrix3| -> Matrix3 { std::array::from_fn(|i| std::array::from_fn(|j| m[j][i])) };
    let matrix = product(&transposed(to.matrix()), &product(&rows, &from.matrix()));
    let norm = matrix.iter().flatten().map(|v| v * v).sum::<f64>().sqrt();
    let is_sound = norm.is_finite() && norm > 0.0;
    is_sound.then(|| matrix.map(|row| row.map(|v| v / norm)))
}

/// The epipolar line a x + b y + c = 0 in frame t + 1 of a point of frame t, as (a, b, c).
#[inline(always)]
pub fn line(matrix: &Matrix3, [x, y]: [f64; 2]) -> [f64; 3] {
    matrix.map(|row| row[0] * x + row[1] * y + row[2])
}

/// The same in frame t of a point of frame t + 1.
#[inline(always)]
pub fn line_back(matrix: &Matrix3, [x, y]: [f64; 2]) -> [f64; 3] {
    let [a, b, c] = matrix;
    [0, 1, 2].map(|j| a[j] * x + b[j] * y + c[j])
}

/// The value of x′ᵀ F x, and the squared length of its gradient over the four coordinates.
#[inline(always)]
fn constraint(matrix: &Matrix3, m: &Correspondence) -> [f64; 2] {
    let ([a, b, e], [c, d, _]) = (line(matrix, m.from), line_back(matrix, m.to));
    [a * m.to[0] + b * m.to[1] + e, a * a + b * b + c * c + d * d]
}

/// The squared Sampson distance of a correspondence in px²: first-order distance from the nearest pair that satisfies x′ᵀ F x = 0.
#[inline(always)]
pub(crate) fn sampson_squared(matrix: &Matrix3, m: &Correspondence) -> f64 {
    let [value, gradient] = constraint(matrix, m);
    if gradient > 0.0 { value * value / gradient } else { f64::INFINITY }
}

wide! {
    /// Writes the squared Sampson distance of each correspondence.
    pub fn sampson_all(matrix: &Matrix3, matches: &[Correspondence], errors: &mut [f64]) = sampson_body
}

wide! {
    /// Writes the weight of each correspondence, with which the algebraic distance becomes the Sampson distance, in terms of their mean.
    fn weights_of(matrix: &Matrix3, matches: &[Correspondence], weights: &mut [f64]) = weights_body
}

#[inline(always)]
fn sampson_body(matrix: &Matrix3, matches: &[Correspondence], errors: &mut [f64]) {
    errors.iter_mut().zip(matches).for_each(|(error, m)| *error = sampson_squared(matrix, m));
}

#[inline(always)]
fn weights_body(matrix: &Matrix3, matches: &[Correspondence], weights: &mut [f64]) {
    for (weight, m) in weights.iter_mut().zip(matches) {
        *weight = 1.0 / constraint(matrix, m)[1].max(1e-12);
    }
    let mean = weights.iter().sum::<f64>() / weights.len() as f64;
    weights.iter_mut().for_each(|weight| *weight /= mean);
}

/// The epipoles in frames t and t + 1 in homogeneous coordinates: F e = 0 and Fᵀ e′ = 0.
pub(crate) fn epipoles(matrix: &Matrix3) -> Option<[[f64; 3]; 2]> {
    let square = Square::from_fn(|i, j| matrix[i][j]);
    let svd = square.svd(true, true);
    let (u, v_t, least) = (svd.u?, svd.v_t?, svd.singular_values.imin());
    let [right, left] = [v_t.row(least).transpose(), u.column(least).into_owned()];
    Some([right, left].map(|e| [e[0], e[1], e[2]]))
}

/// A pinhole camera with square pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Focal length in px.
    pub focal_px: f64,
    /// Principal point in px.
    pub centre: [f64; 2],
}

impl Camera {
    fn ray(&self, [x, y]: [f64; 2]) -> Vector3<f64> {
        Vector3::new((x - self.centre[0]) / self.focal_px, (y - self.centre[1]) / self.focal_px, 1.0)
    }

    /// The pose from a fundamental matrix: of the four that its essential matrix allows, the one with the most points in front of both
    /// cameras.
    pub fn pose(&self, matrix: &Matrix3, matches: &[Correspondence]) -> Option<Pose> {
        let intrinsics =
            Square::new(self.focal_px, 0.0, self.centre[0], 0.0, self.focal_px, self.centre[1], 0.0, 0.0, 1.0);
        let essential = intrinsics.transpose() * Square::from_fn(|i, j| matrix[i][j]) * intrinsics;
        let svd = essential.svd(true, true);
        let (mut u, mut v_t, least) = (svd.u?, svd.v_t?, svd.singular_values.imin());
        let mut values = svd.singular_values;
        values[least] = 0.0;
        let singular_ratio = (values.sum() - values.max()) / values.max();
        // The singular value 0 last, and proper rotations.
        u.swap_columns(least, 2);
        v_t.swap_rows(least, 2);
        u *= u.determinant().signum();
        v_t *= v_t.determinant().signum();
        let turn = Square::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
        let direction = u.column(2).into_owned();
        let rotations = [u * turn * v_t, u * turn.transpose() * v_t];
        let all = rotations.iter().flat_map(|rotation| [direction, -direction].map(|t| (*rotation, t)));
        let counted = all.map(|(rotation, t)| {
            let rays = matches.iter().map(|m| (self.ray(m.from), self.ray(m.to)));
            (rays.filter(|rays| is_in_front(&rotation, &t, rays)).count(), rotation, t)
        });
        let (in_front, rotation, t) = counted.reduce(|best, other| if other.0 > best.0 { other } else { best })?;
        let rotation = std::array::from_fn(|i| std::array::from_fn(|j| rotation[(i, j)]));
        Some(Pose { rotation, translation: [t[0], t[1], t[2]], in_front, singular_ratio })
    }
}

/// Whether the point on both rays, in the least-squares sense, lies in front of both cameras.
fn is_in_front(rotation: &Square<f64>, t: &Vector3<f64>, (from, to): &(Vector3<f64>, Vector3<f64>)) -> bool {
    // λ′ x′ = λ R x + t.
    let along = rotation * from;
    let (aa, bb, ab) = (along.dot(&along), to.dot(to), along.dot(to));
    let (at, bt) = (along.dot(t), to.dot(t));
    let determinant = aa * bb - ab * ab;
    let depths = [(ab * bt - bb * at) / determinant, (aa * bt - ab * at) / determinant];
    determinant > 1e-12 && depths.iter().all(|depth| *depth > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synth::random::{gaussian, hash, unit};

    const CAMERA: Camera = Camera { focal_px: 500.0, centre: [320.0, 240.0] };

    /// A rotation about y and a small one about x.
    fn rotation(angle: f64) -> Square<f64> {
        let (sin, cos) = angle.sin_cos();
        let (s, c) = (0.4 * angle).sin_cos();
        Square::new(cos, 0.0, sin, 0.0, 1.0, 0.0, -sin, 0.0, cos) * Square::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c)
    }

    /// Points of a cloud seen by two cameras.
    fn views(count: usize, noise_px: f64) -> (Vec<Correspondence>, Square<f64>, Vector3<f64>) {
        let (turn, t) = (rotation(0.08), Vector3::new(0.9, 0.1, 0.3).normalize());
        let view = |i: usize| {
            let random = |k: u64| unit(hash(5, i as u64, k)) - 0.5;
            let point = Vector3::new(6.0 * random(0), 4.0 * random(1), 6.0 + 5.0 * random(2));
            let seen = |p: Vector3<f64>, k: u64| {
                let off = |axis: u64| noise_px * gaussian(hash(9, i as u64, 10 * k + axis));
                [
                    CAMERA.focal_px * p[0] / p[2] + CAMERA.centre[0] + off(0),
                    CAMERA.focal_px * p[1] / p[2] + CAMERA.centre[1] + off(1),
                ]
            };
            Correspondence { from: seen(point, 1), to: seen(turn * point + t, 2) }
        };
        ((0..count).map(view).collect(), turn, t)
    }

    #[test]
    fn exact_points_satisfy_the_epipolar_constraint() {
        let (all, ..) = views(60, 0.0);
        let worst = |matrix: &Matrix3| all.iter().map(|m| sampson_squared(matrix, m).sqrt()).fold(0.0, f64::max);
        let eight = eight_point(&all[..8]).expect("points in general position");
        assert!(worst(&eight) < 1e-5, "{}", worst(&eight));
        assert!(worst(&least_sampson(&all).expect("points in general position")) < 1e-6);
        let seven = seven_point(&all[..7]);
        assert!((1..=3).contains(&seven.len()));
        let best = seven.iter().map(worst).fold(f64::INFINITY, f64::min);
        assert!(best < 1e-4, "one of {} is right: {best}", seven.len());
    }

    /// The determinant of the essential matrix of unit norm: that of F in px is small whatever its rank.
    fn determinant(matrix: &Matrix3) -> f64 {
        let [x, y] = CAMERA.centre;
        let intrinsics = Square::new(CAMERA.focal_px, 0.0, x, 0.0, CAMERA.focal_px, y, 0.0, 0.0, 1.0);
        let essential = intrinsics.transpose() * Square::from_fn(|i, j| matrix[i][j]) * intrinsics;
        (essential / essential.norm()).determinant().abs()
    }

    #[test]
    fn matrices_of_noisy_points_have_rank_two() {
        let (all, ..) = views(60, 0.5);
        let eight = eight_point(&all).expect("points in general position");
        let sampson = least_sampson(&all).expect("points in general position");
        for matrix in seven_point(&all[..7]).iter().chain([&eight, &sampson]) {
            assert!(determinant(matrix) < 1e-9, "{}", determinant(matrix));
        }
        // Without the singular value set to 0 the rank is three.
        let by = normalisations(&all).expect("several places");
        let normal = Moments::of(&all, [&by[0], &by[1]], &[1.0; 60]).bilinear();
        let full = in_px(&square(&two_least_values(&normal)[0].1), [&by[0], &by[1]]).expect("a matrix");
        assert!(determinant(&full) > 1e-8, "{}", determinant(&full));
    }

    #[test]
    fn epipoles_lie_on_all_epipolar_lines() {
        let (all, ..) = views(40, 0.0);
        let matrix = least_sampson(&all).expect("points in general position");
        let [here, there] = epipoles(&matrix).expect("a matrix of rank two").map(|e| [e[0] / e[2], e[1] / e[2]]);
        for m in &all {
            let on = |[a, b, c]: [f64; 3], [x, y]: [f64; 2]| (a * x + b * y + c).abs() / a.hypot(b);
            assert!(on(line(&matrix, m.from), there) < 1e-3 && on(line_back(&matrix, m.to), here) < 1e-3);
        }
    }

    #[test]
    fn the_pose_is_recovered_up_to_scale() {
        let (all, turn, t) = views(60, 0.0);
        let matrix = least_sampson(&all).expect("points in general position");
        let pose = CAMERA.pose(&matrix, &all).expect("a pose");
        assert_eq!(pose.in_front, all.len());
        assert!(pose.singular_ratio > 0.999, "{}", pose.singular_ratio);
        let off = (0..9).map(|i| (pose.rotation[i / 3][i % 3] - turn[(i / 3, i % 3)]).abs()).fold(0.0, f64::max);
        assert!(off < 1e-4, "{off}");
        let along: f64 = (0..3).map(|i| pose.translation[i] * t[i]).sum();
        assert!(along > 0.9999, "{along}");
        // The centre of the second camera is the point that X′ = R X + t maps to its origin.
        let center = pose.camera_direction();
        let mapped =
            [0, 1, 2].map(|i| (0..3).map(|j| pose.rotation[i][j] * center[j]).sum::<f64>() + pose.translation[i]);
        assert!(mapped.iter().all(|c| c.abs() < 1e-9), "{mapped:?}");
        let essential = pose.essential();
        for m in &all {
            let (from, to) = (CAMERA.ray(m.from), CAMERA.ray(m.to));
            let value = to.dot(&(Square::from_fn(|i, j| essential[i][j]) * from));
            assert!(value.abs() < 1e-6, "{value}");
        }
    }

    #[test]
    fn a_wrong_focal_length_makes_the_singular_values_differ() {
        let (all, ..) = views(60, 0.0);
        let matrix = least_sampson(&all).expect("points in general position");
        let ratio = |factor: f64| {
            let camera = Camera { focal_px: factor * CAMERA.focal_px, ..CAMERA };
            camera.pose(&matrix, &all).expect("a pose").singular_ratio
        };
        let all = [0.1, 0.3, 0.7, 1.0, 1.5, 3.0].map(ratio);
        assert!(all[..4].is_sorted() && all[3..].is_sorted_by(|a, b| a >= b), "{all:?}");
        assert!(all[0] < 0.7 && all[3] > 0.9999 && all[5] < 0.9, "{all:?}");
    }

    #[test]
    fn seven_points_solve_their_equations_as_the_null_space_of_the_singular_value_decomposition() {
        let (all, ..) = views(21, 0.4);
        for seven in all.chunks_exact(7) {
            let [from, to] = normalisations(seven).expect("points in general position");
            let rows = seven.iter().map(|m| equation(from.apply(m.from), to.apply(m.to)));
            let system = nalgebra::SMatrix::<f64, 9, 9>::from_row_iterator(rows.chain([[0.0; 9]; 2]).flatten());
            let v_t = system.svd(false, true).v_t.expect("it was asked for");
            for found in null_space(seven, [&from, &to]).expect("independent equations") {
                let entries = SVector::<f64, 9>::from_iterator(found.transpose().iter().copied());
                assert!((system * entries).amax() < 1e-12);
                // Of unit length, and within the span of the last two right singular vectors.
                let along = (0..7).map(|i| v_t.row(i).transpose().dot(&entries).abs()).fold(0.0, f64::max);
                assert!((entries.norm() - 1.0).abs() < 1e-12 && along < 1e-9, "{along}");
            }
        }
    }

    #[test]
    fn least_sampson_is_no_worse_than_eight_points_under_noise() {
        let (all, ..) = views(200, 0.5);
        let (exact, ..) = views(200, 0.0);
        let cost = |matrix: &Matrix3, of: &[Correspondence]| of.iter().map(|m| sampson_squared(matrix, m)).sum::<f64>();
        let [plain, refined] = [eight_point(&all), least_sampson(&all)].map(|found| found.expect("general position"));
        assert!(cost(&refined, &all) <= cost(&plain, &all));
        assert!((cost(&refined, &exact) / 200.0).sqrt() < 0.15);
    }

    #[test]
    fn points_of_a_plane_determine_no_matrix() {
        let plane = |i: usize| {
            let from = [((i * 197 + 31) % 640) as f64, ((i * 331 + 77) % 480) as f64];
            Correspondence { from, to: [1.1 * from[0] + 4.0, 0.9 * from[1] - 7.0] }
        };
        let all: Vec<_> = (0..30).map(plane).collect();
        assert_eq!(eight_point(&all), None);
        assert!(seven_point(&all[..7]).is_empty());
        assert_eq!(eight_point(&all[..7]), None);
    }

    #[test]
    fn roots_of_a_cubic_are_found() {
        let near = |found: Vec<f64>, expected: &[f64]| {
            let mut found = found;
            found.sort_by(f64::total_cmp);
            found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9)
        };
        // (x − 1)(x − 2)(x + 3), (x − 2)(x² + 1), (x − 1)(x + 2), and 2 x − 1.
        assert!(near(cubic_roots([6.0, -7.0, 0.0, 1.0]), &[-3.0, 1.0, 2.0]));
        assert!(near(cubic_roots([-2.0, 1.0, -2.0, 1.0]), &[2.0]));
        assert!(near(cubic_roots([-2.0, 1.0, 1.0, 0.0]), &[-2.0, 1.0]));
        assert!(near(cubic_roots([-1.0, 2.0, 0.0, 0.0]), &[0.5]));
    }
}
