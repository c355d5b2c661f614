//! The fits of geometric models against the textbook: the singular value decomposition of all equations (Hartley and Zisserman 2004,
//! algorithms 4.2 and 11.1, section 11.1.2).

use motionscope_core::methods::geometric::Correspondence;
use motionscope_core::methods::geometric::epipolar::{eight_point, seven_point};
use motionscope_core::methods::geometric::fit::fit;
use motionscope_core::products::Model;
use nalgebra::{Matrix3, SMatrix, Vector3};

/// Pseudorandom numbers from −1 to 1.
fn random(i: usize, k: usize) -> f64 {
    let mixed = (i as u64 * 131 + k as u64 * 17 + 7).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    (mixed >> 40) as f64 / (1u64 << 23) as f64 - 1.0
}

/// Points of a scene with depth, seen by a camera that moves and turns, with errors of up to 0.5 px.
fn views(count: usize, seed: usize) -> Vec<Correspondence> {
    let view = |i: usize| {
        let [x, y, z] = [0, 1, 2].map(|k| random(i + 1000 * seed, k));
        let (point, turn) =
            (Vector3::new(3.0 * x, 2.0 * y, 7.0 + 3.0 * z), nalgebra::Rotation3::new(Vector3::new(0.02, 0.07, 0.01)));
        let seen = |p: Vector3<f64>, k: usize| {
            let off = [0, 1].map(|axis| 0.5 * random(i + 1000 * seed, 10 + 2 * k + axis));
            [500.0 * p[0] / p[2] + 320.0 + off[0], 500.0 * p[1] / p[2] + 240.0 + off[1]]
        };
        Correspondence { from: seen(point, 0), to: seen(turn * point + Vector3::new(0.7, 0.1, 0.2), 1) }
    };
    (0..count).map(view).collect()
}

/// The similarity that moves points to mean zero and mean distance √2.
fn normalisation(points: &[[f64; 2]]) -> Matrix3<f64> {
    let count = points.len() as f64;
    let mean = [0, 1].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / count);
    let distance = points.iter().map(|p| (p[0] - mean[0]).hypot(p[1] - mean[1])).sum::<f64>() / count;
    let s = 2f64.sqrt() / distance;
    Matrix3::new(s, 0.0, -s * mean[0], 0.0, s, -s * mean[1], 0.0, 0.0, 1.0)
}

/// Normalised homogeneous points of both frames, with the similarities.
fn normalised(matches: &[Correspondence]) -> (Vec<[Vector3<f64>; 2]>, [Matrix3<f64>; 2]) {
    let sides = [matches.iter().map(|m| m.from).collect::<Vec<_>>(), matches.iter().map(|m| m.to).collect()];
    let by = sides.each_ref().map(|points| normalisation(points));
    let pair = |m: &Correspondence| {
        [by[0] * Vector3::new(m.from[0], m.from[1], 1.0), by[1] * Vector3::new(m.to[0], m.to[1], 1.0)]
    };
    (matches.iter().map(pair).collect(), by)
}

/// The rows of a matrix of unit norm with a positive largest entry.
fn unit(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
    let largest = matrix.iter().copied().fold(0.0f64, |most, v| if v.abs() > most.abs() { v } else { most });
    let scaled = matrix / (matrix.norm() * largest.signum());
    std::array::from_fn(|i| std::array::from_fn(|j| scaled[(i, j)]))
}

fn apart(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> f64 {
    let of = |m: &[[f64; 3]; 3]| unit(&Matrix3::from_fn(|i, j| m[i][j]));
    let (a, b) = (of(a), of(b));
    (0..9).map(|i| (a[i / 3][i % 3] - b[i / 3][i % 3]).abs()).fold(0.0, f64::max)
}

const COUNT: usize = 24;

#[test]
fn the_homography_is_that_of_the_direct_linear_transformation() {
    for seed in 0..4 {
        let matches = views(COUNT, seed);
        let (points, by) = normalised(&matches);
        let mut system = SMatrix::<f64, { 2 * COUNT }, 9>::zeros();
        for (i, [p, q]) in points.iter().enumerate() {
            for k in 0..3 {
                (system[(2 * i, 3 + k)], system[(2 * i, 6 + k)]) = (-q[2] * p[k], q[1] * p[k]);
                (system[(2 * i + 1, k)], system[(2 * i + 1, 6 + k)]) = (q[2] * p[k], -q[0] * p[k]);
            }
        }
        let plain = Matrix3::from_row_slice(&least(system.svd(false, true)));
        let plain = by[1].try_inverse().expect("a similarity") * plain * by[0];
        let found = fit(Model::Homography, &matches).expect("points in general position");
        let off = apart(&found, &unit(&plain));
        assert!(off < 1e-8, "{seed}: {off}");
    }
}

/// The right singular vector of the smallest singular value.
fn least<const R: usize>(svd: nalgebra::SVD<f64, nalgebra::Const<R>, nalgebra::Const<9>>) -> [f64; 9]
where
    nalgebra::Const<R>: nalgebra::DimMin<nalgebra::Const<9>, Output = nalgebra::Const<9>>,
{
    let v_t = svd.v_t.expect("it was asked for");
    let row = v_t.row(svd.singular_values.imin()).into_owned();
    std::array::from_fn(|i| row[i])
}

/// The equations of the epipolar constraint of normalised points, by rows.
fn epipolar_row([p, q]: &[Vector3<f64>; 2]) -> [f64; 9] {
    std::array::from_fn(|i| q[i / 3] * p[i % 3])
}

#[test]
fn the_fundamental_matrix_is_that_of_the_normalised_eight_point_algorithm() {
    for seed in 0..4 {
        let matches = views(COUNT, seed);
        let (points, by) = normalised(&matches);
        let system = SMatrix::<f64, COUNT, 9>::from_row_iterator(points.iter().flat_map(epipolar_row));
        let full = Matrix3::from_row_slice(&least(system.svd(false, true)));
        let svd = full.svd(true, true);
        let mut values = svd.singular_values;
        values[svd.singular_values.imin()] = 0.0;
        let ranked =
            svd.u.expect("it was asked for") * Matrix3::from_diagonal(&values) * svd.v_t.expect("it was asked for");
        let plain = by[1].transpose() * ranked * by[0];
        let found = eight_point(&matches).expect("points in general position");
        let off = apart(&found, &unit(&plain));
        assert!(off < 1e-8, "{seed}: {off}");
    }
}

#[test]
fn seven_points_give_all_singular_matrices_that_satisfy_their_equations() {
    let mut several = 0;
    for seed in 0..40 {
        let matches = views(7, seed);
        let (points, by) = normalised(&matches);
        let mut system = SMatrix::<f64, 9, 9>::zeros();
        for (i, row) in points.iter().map(epipolar_row).enumerate() {
            (0..9).for_each(|k| system[(i, k)] = row[k]);
        }
        let v_t = system.svd(false, true).v_t.expect("it was asked for");
        let [a, b] = [7, 8].map(|i| {
            let row: Vec<f64> = v_t.row(i).iter().copied().collect();
            Matrix3::from_row_slice(&row)
        });
        // Every matrix of the null space is cos θ A + sin θ B, up to its scale; each change of sign of the determinant is a solution.
        let determinant = |theta: f64| (a * theta.cos() + b * theta.sin()).determinant();
        const STEPS: usize = 20_000;
        let at = |i: usize| determinant(std::f64::consts::PI * i as f64 / STEPS as f64);
        let changes = (0..STEPS).filter(|i| at(*i).signum() != at(i + 1).signum()).count();
        let found = seven_point(&matches);
        assert_eq!(found.len(), changes, "{seed}");
        several += usize::from(changes == 3);
        for matrix in &found {
            let matrix = Matrix3::from_fn(|i, j| matrix[i][j]);
            assert!(matrix.determinant().abs() < 1e-9 * matrix.norm().powi(3), "{seed}: rank two");
            for m in &matches {
                let (p, q) = (Vector3::new(m.from[0], m.from[1], 1.0), Vector3::new(m.to[0], m.to[1], 1.0));
                let line = matrix * p;
                assert!(q.dot(&line).abs() / line[0].hypot(line[1]) < 1e-6, "{seed}: on the epipolar line");
            }
            let inner =
                by[1].transpose().try_inverse().expect("regular") * matrix * by[0].try_inverse().expect("regular");
            let inner = inner / inner.norm();
            let [along_a, along_b] = [inner.dot(&a), inner.dot(&b)];
            assert!((along_a.hypot(along_b) - 1.0).abs() < 1e-9, "{seed}: in the null space");
        }
    }
    assert!(several > 3, "{several} with three solutions");
}
