//! Farnebäck's method against a plain one.

use crate::common::{SIZE, error, flow, linear_motion, set};
use motionscope_core::data::Clip;
use motionscope_core::geometry::Grid;
use motionscope_core::products::DenseField;
use motionscope_core::run::{Cursor, Move};
use motionscope_core::scene::{self, Focus};

/// The polynomial c + b_x x + b_y y + a_xx x² + a_yy y² + 2 a_xy x y that fits a picture best around a pixel, as plainly as can
/// be: the normal equations of the pixels in the picture, by elimination. Its b, and its A as (a_xx, a_xy, a_yy).
fn plain_polynomial(picture: &Grid<u8>, (x, y): (usize, usize), sigma: f64, reach: isize) -> ([f64; 2], [f64; 3]) {
    let mut rows = [[0.0; 7]; 6];
    for (i, j) in (-reach..=reach).flat_map(|j| (-reach..=reach).map(move |i| (i, j))) {
        let place = (x.checked_add_signed(i), y.checked_add_signed(j));
        let (Some(px), Some(py)) = place else { continue };
        let Some(value) = picture.get(px, py) else { continue };
        let (i, j) = (i as f64, j as f64);
        let weight = (-(i * i + j * j) / (2.0 * sigma * sigma)).exp();
        let basis = [1.0, i, j, i * i, j * j, i * j];
        for (row, left) in rows.iter_mut().zip(basis) {
            row.iter_mut().zip(basis).for_each(|(sum, right)| *sum += weight * left * right);
            row[6] += weight * left * f64::from(*value);
        }
    }
    for i in 0..6 {
        let pivot = rows[i];
        for row in (0..6).filter(|row| *row != i) {
            let factor = rows[row][i] / pivot[i];
            rows[row].iter_mut().zip(pivot).for_each(|(value, of)| *value -= factor * of);
        }
    }
    let s: Vec<f64> = (0..6).map(|i| rows[i][6] / rows[i][i]).collect();
    ([s[1], s[2]], [s[3], s[5] / 2.0, s[4]])
}

/// Farnebäck's method on one level as plainly as can be, in f64, at pixel `at`: one iteration from the displacements `from`.
fn plain_farneback(clip: &Clip, at: (usize, usize), from: &dyn Fn(usize, usize) -> [f64; 2]) -> [f64; 2] {
    let (sigma, reach, window, damping) = (1.1, 3, 4isize, 0.05);
    let [a, b] = clip.pair(0).expect("a pair");
    let weight = |c: isize| (-0.5 * (c as f64 / 2.0).powi(2)).exp();
    let all: f64 = (-window..=window).map(weight).sum();
    let (mut t, mut h) = ([damping, 0.0, damping], from(at.0, at.1).map(|c| damping * c));
    for (i, j) in (-window..=window).flat_map(|j| (-window..=window).map(move |i| (i, j))) {
        let (Some(x), Some(y)) = (at.0.checked_add_signed(i), at.1.checked_add_signed(j)) else { continue };
        if x >= SIZE.0 || y >= SIZE.1 {
            continue;
        }
        let whole = from(x, y).map(|c| (c + 0.5).floor());
        let (to_x, to_y) = (x as f64 + whole[0], y as f64 + whole[1]);
        if to_x < 0.0 || to_y < 0.0 || to_x >= SIZE.0 as f64 || to_y >= SIZE.1 as f64 {
            continue;
        }
        let (b1, a1) = plain_polynomial(a.luma(), (x, y), sigma, reach);
        let (b2, a2) = plain_polynomial(b.luma(), (to_x as usize, to_y as usize), sigma, reach);
        let [xx, xy, yy] = [0, 1, 2].map(|k| (a1[k] + a2[k]) / 2.0);
        let db = [
            xx * whole[0] + xy * whole[1] - (b2[0] - b1[0]) / 2.0,
            xy * whole[0] + yy * whole[1] - (b2[1] - b1[1]) / 2.0,
        ];
        let weight = weight(i) * weight(j) / (all * all);
        let squares = [xx * xx + xy * xy, xx * xy + xy * yy, xy * xy + yy * yy];
        t.iter_mut().zip(squares).for_each(|(sum, square)| *sum += weight * square);
        h[0] += weight * (xx * db[0] + xy * db[1]);
        h[1] += weight * (xy * db[0] + yy * db[1]);
    }
    let det = t[0] * t[2] - t[1] * t[1];
    [(t[2] * h[0] - t[1] * h[1]) / det, (t[0] * h[1] - t[1] * h[0]) / det]
}

#[test]
fn farneback_agrees_with_a_plain_one() {
    let (clip, _) = linear_motion([[0.0, -0.02], [0.02, 0.0]], [1.3, -0.8]);
    let of = |iterations| {
        let settings = [
            ("poly-n", "7"),
            ("poly-sigma", "1.1"),
            ("window", "9"),
            ("weights", "gaussian"),
            ("damping", "0.05"),
            ("levels", "1"),
            ("iterations", iterations),
        ];
        flow("farneback", &settings, &clip)
    };
    let (first, second) = (of("1"), of("2"));
    for at in [(40, 30), (41, 30), (2, 3), (95, 79), (0, 40), (70, 76)] {
        let plain = [
            plain_farneback(&clip, at, &|_, _| [0.0; 2]),
            plain_farneback(&clip, at, &|x, y| first.at(x, y).expect("known").map(f64::from)),
        ];
        for (found, plain) in [&first, &second].iter().zip(plain) {
            let found = found.at(at.0, at.1).expect("known").map(f64::from);
            let off = (found[0] - plain[0]).hypot(found[1] - plain[1]);
            assert!(off < 2e-3 * (1.0 + plain[0].hypot(plain[1])), "{found:?} at {at:?}, plainly {plain:?}");
        }
    }
}

#[test]
fn farneback_needs_its_levels_for_what_goes_far() {
    let (clip, truth) = linear_motion([[0.0; 2]; 2], [6.0, 4.5]);
    let off = |levels| error(&flow("farneback", &[("levels", levels)], &clip), &truth, 16);
    let (one, many) = (off("1"), off("3"));
    assert!(many < 0.1 && one > 2.0, "{many:.2} px off with three levels, {one:.2} with one");
}

#[test]
fn farneback_tells_what_it_does() {
    let (clip, _) = linear_motion([[0.01, 0.0], [0.0, 0.01]], [0.4, -0.3]);
    let estimator = set("farneback", &[("levels", "2"), ("iterations", "2")]);
    let mut walk = estimator.walk(&clip, 0).unwrap();
    let focus = [40.0, 30.0];
    // The last iteration, on the picture itself.
    walk.jump(Move::To(Cursor { unit: 3, event: usize::MAX }));
    let Some(field) = walk.output().get::<DenseField>().cloned() else { panic!("a dense field") };
    let step = walk.step(Some(Focus::current(focus)));
    let found = step.readouts.iter().find_map(|readout| match readout {
        scene::Readout::Plane(plane) => plane.points.iter().find(|(name, ..)| *name == "displacement"),
        _ => None,
    });
    assert_eq!(found.expect("a displacement").2, field.flow.at(40, 30).unwrap());
    assert!(step.sentence.plain().contains("pixel (40, 30)"), "{}", step.sentence.plain());
    // The first unit of a level shows the polynomials of both frames, and what they leave.
    walk.jump(Move::To(Cursor { unit: 2, event: 1 }));
    let tiles = walk.step(Some(Focus::current(focus))).readouts.into_iter().find_map(|readout| match readout {
        scene::Readout::Tiles(tiles) => Some(tiles),
        _ => None,
    });
    let tiles = tiles.expect("tiles");
    assert_eq!(tiles.len(), 6);
    for three in tiles.chunks(3) {
        // Over the middle, where the weights are, waves are nearly parabolas.
        let middle = |tile: &scene::Tile| {
            let places = (3..6).flat_map(|y| (3..6).map(move |x| (x, y)));
            places.map(|place| tile.values[place]).collect::<Vec<_>>()
        };
        let [pixels, left] = [middle(&three[0]), middle(&three[2])];
        let mean = pixels.iter().sum::<f32>() / 9.0;
        let (unlike, left) = (pixels.iter().map(|v| (v - mean).powi(2)), left.iter().map(|v| v * v));
        let (unlike, left): (f32, f32) = (unlike.sum(), left.sum());
        assert!(left < 0.02 * unlike, "{left} of {unlike} gray levels² are left");
    }
    // What a pixel says is two lines, what its window says many.
    for (event, lines) in [(3, 2..=2), (4, 20..=200)] {
        walk.jump(Move::To(Cursor { unit: 2, event }));
        let count = walk.step(Some(Focus::current(focus))).readouts.iter().find_map(|readout| match readout {
            scene::Readout::Plane(plane) => Some(plane.lines.len()),
            _ => None,
        });
        assert!(lines.contains(&count.expect("a plane")), "{count:?} lines at event {event}");
    }
}
