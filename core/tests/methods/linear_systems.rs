//! The matrices shown of the normalised DLT and of the eight-point algorithm: put together, they are the models that are estimated.

use motionscope_core::geometry::Grid;
use motionscope_core::methods::geometric::Correspondence;
use motionscope_core::methods::geometric::epipolar::{eight_point, seven_point};
use motionscope_core::methods::geometric::fit::{fit, inverse, product};
use motionscope_core::methods::geometric::system::System;
use motionscope_core::products::model::{Matrix3, Model};
use nalgebra::Matrix3 as Square;

/// Points of a picture, moved by a projective map and a depth that is no function of the place, so that both models have a residual.
fn matches(count: usize) -> Vec<Correspondence> {
    let one = |i: usize| {
        let [x, y] = [(37 * i % 101) as f64 * 3.0, (53 * i % 89) as f64 * 2.5];
        let (depth, w) = (1.0 + (i * i % 7) as f64, 1.0 + 2e-4 * x);
        Correspondence { from: [x, y], to: [(x + 9.0) / w + depth, (0.98 * y + 0.05 * x) / w + 0.2 * depth] }
    };
    // The first four of them keep the horizon away from the picture.
    (2..=count + 1).map(one).collect()
}

fn of<'a>(system: &'a System, symbol: &str) -> &'a Grid<f64> {
    &system.matrices.iter().find(|matrix| matrix.symbol == symbol).expect("it is shown").entries
}

fn square(grid: &Grid<f64>) -> Matrix3 {
    std::array::from_fn(|y| std::array::from_fn(|x| grid[(x, y)]))
}

/// The largest difference of two matrices up to a factor.
fn apart(a: &Matrix3, b: &Matrix3) -> f64 {
    let unit = |m: &Matrix3| {
        let (norm, all) = (m.iter().flatten().map(|v| v * v).sum::<f64>().sqrt(), m.iter().flatten());
        let sign = all.copied().fold(0.0, |most: f64, v| if v.abs() > most.abs() { v } else { most }).signum();
        m.map(|row| row.map(|v| sign * v / norm))
    };
    let (a, b) = (unit(a), unit(b));
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn the_matrices_shown_give_the_homography() {
    for count in [4, 5, 40] {
        let all = matches(count);
        let system = System::of_homography(&all);
        let [t, t_next, h] = ["T", "T′", "H"].map(|symbol| square(of(&system, symbol)));
        let found = product(&inverse(&t_next).expect("a similarity"), &product(&h, &t));
        let off = apart(
            &found,
            &fit(Model::Homography, &all).unwrap_or_else(|| panic!("{count} points in general position")),
        );
        assert!(off < 1e-6, "{count} matches: {off}");
        let values = of(&system, "λ").cells();
        assert!(values.is_sorted_by(|a, b| a >= b) && (values[3] < 1e-12) == (count == 4), "{values:?}");
        assert_eq!(system.equations, Some(2 * count));
    }
}

#[test]
fn the_matrices_shown_give_the_fundamental_matrix() {
    let all = matches(30);
    let system = System::of_fundamental(&all);
    let [t, t_next, f] = ["T", "T′", "F"].map(|symbol| square(of(&system, symbol)));
    let svd = Square::from_fn(|i, j| f[i][j]).svd(true, true);
    let mut values = svd.singular_values;
    let shown = of(&system, "s").cells();
    assert!((values.max() - shown[0]).abs() < 1e-9 && (values.min() - shown[2]).abs() < 1e-9, "{shown:?}");
    values[svd.singular_values.imin()] = 0.0;
    let flat = svd.u.expect("asked for") * Square::from_diagonal(&values) * svd.v_t.expect("asked for");
    let flat: Matrix3 = std::array::from_fn(|i| std::array::from_fn(|j| flat[(i, j)]));
    let turned: Matrix3 = std::array::from_fn(|i| std::array::from_fn(|j| t_next[j][i]));
    let off = apart(&product(&turned, &product(&flat, &t)), &eight_point(&all).expect("a solution"));
    assert!(off < 1e-6, "{off}");
}

#[test]
fn seven_points_leave_two_solutions_that_are_mixed() {
    let all = matches(7);
    let system = System::of_fundamental(&all);
    let [t, t_next, a, b] = ["T", "T′", "F₁", "F₂"].map(|symbol| square(of(&system, symbol)));
    let [back, back_next] = [t, t_next].map(|m| inverse(&m).expect("a similarity"));
    let turned: Matrix3 = std::array::from_fn(|i| std::array::from_fn(|j| back_next[j][i]));
    let dot = |a: &Matrix3, b: &Matrix3| a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a * b).sum::<f64>();
    let found = seven_point(&all);
    assert!(!found.is_empty());
    for matrix in found {
        let normal = product(&turned, &product(&matrix, &back));
        let [on_a, on_b] = [&a, &b].map(|of| dot(&normal, of));
        let rest = dot(&normal, &normal) - on_a * on_a - on_b * on_b;
        assert!(rest < 1e-9 * dot(&normal, &normal), "{rest}");
    }
}
