use super::*;
use crate::products::model::IDENTITY;

fn shift(u: f64, v: f64) -> Matrix3 {
    [[1.0, 0.0, u], [0.0, 1.0, v], [0.0, 0.0, 1.0]]
}

#[test]
fn weights_keep_constants_and_lines() {
    for (t, count) in [(0, 1), (0, 2), (0, 30), (3, 30), (15, 30), (29, 30)] {
        let (first, all) = weights((t, count), 4.0);
        let sum: f64 = all.iter().sum();
        let mean: f64 = all.iter().enumerate().map(|(i, w)| w * ((first + i) as f64 - t as f64)).sum();
        assert!((sum - 1.0).abs() < 1e-12 && mean.abs() < 1e-9, "{t} of {count}: {sum}, {mean}");
    }
    let (first, all) = weights((15, 30), 2.0);
    assert!(first == 9 && all.len() == 13 && all.windows(2).take(6).all(|pair| pair[0] < pair[1]), "{all:?}");
}

#[test]
fn a_steady_pan_is_not_corrected() {
    let pan: Vec<_> = (0..20).map(|t| shift(-3.0 * f64::from(t), f64::from(t))).collect();
    for t in 0..20 {
        let found = correction(&pan, t, 5.0).expect("translations have inverses");
        let off = found.as_flattened().iter().zip(IDENTITY.as_flattened()).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-9, "{t}: {found:?}");
    }
}

#[test]
fn a_jump_is_spread_over_its_neighbours() {
    let path: Vec<_> = (0..21).map(|t| shift(if t == 10 { 6.0 } else { 0.0 }, 0.0)).collect();
    let (_, all) = weights((10, 21), 3.0);
    // The frame moves back, except for its own weight.
    let corrected = |t| correction(&path, t, 3.0).expect("translations have inverses")[0][2];
    let found = corrected(10);
    assert!((found - (6.0 * all[all.len() / 2] - 6.0)).abs() < 1e-9, "{found}");
    assert!((0.0..1.0).contains(&corrected(8)));
}

#[test]
fn a_map_without_an_inverse_has_no_correction() {
    let mut path = vec![IDENTITY; 5];
    path[1] = [[0.0; 3], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(correction(&path, 1, 2.0), None);
    // Frame 3 is beyond the horizon of frame 2.
    path[1] = IDENTITY;
    path[3] = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
    assert_eq!(correction(&path, 2, 2.0), None);
    assert!(correction(&path[..3], 2, 2.0).is_some());
}
