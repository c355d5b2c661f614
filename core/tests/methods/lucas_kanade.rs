//! Lucas and Kanade's method against a plain one, and what it tells of its windows.

use crate::common::{SIZE, explained_at, fact, linear_motion, numbers, set, tile};
use motionscope_core::base::Threads;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::Grid;
use motionscope_core::products::DenseField;
use motionscope_core::run::{Cursor, Direction, Move, Walk};
use motionscope_core::scene::{self, Focus, Role};

/// Lucas and Kanade's method at one pixel, as plainly as can be: central differences, all pixels of the window alike, in f64.
/// The displacement, the smaller eigenvalue, and the root mean square by which the constraints are off.
fn plain_lucas_kanade(clip: &Clip, reach: isize, (x, y): (usize, usize)) -> ([f64; 2], f64, f64) {
    let [a, b] = clip.pair(0).expect("a pair");
    let at = |frame: &Frame, x: isize, y: isize| f64::from(frame.luma()[(x as usize, y as usize)]);
    let mean = |x: isize, y: isize| (at(&a, x, y) + at(&b, x, y)) / 2.0;
    let window = (-reach..=reach).flat_map(|j| (-reach..=reach).map(move |i| (x as isize + i, y as isize + j)));
    let constraint = |(x, y): (isize, isize)| {
        [(mean(x + 1, y) - mean(x - 1, y)) / 2.0, (mean(x, y + 1) - mean(x, y - 1)) / 2.0, at(&b, x, y) - at(&a, x, y)]
    };
    let constraints: Vec<_> = window.map(constraint).collect();
    let sum = |i: usize, j: usize| constraints.iter().map(|c| c[i] * c[j]).sum::<f64>() / constraints.len() as f64;
    let det = sum(0, 0) * sum(1, 1) - sum(0, 1) * sum(0, 1);
    // Cramer's rule.
    let u = (-sum(0, 2) * sum(1, 1) + sum(1, 2) * sum(0, 1)) / det;
    let v = (-sum(1, 2) * sum(0, 0) + sum(0, 2) * sum(0, 1)) / det;
    let trace = sum(0, 0) + sum(1, 1);
    let smaller = trace / 2.0 - (trace * trace / 4.0 - det).sqrt();
    let off = constraints.iter().map(|c| (c[0] * u + c[1] * v + c[2]).powi(2)).sum::<f64>() / constraints.len() as f64;
    ([u, v], smaller, off.sqrt())
}

#[test]
fn lucas_kanade_agrees_with_a_plain_one() {
    let (clip, _) = linear_motion([[0.01, -0.01], [0.01, 0.02]], [0.3, -0.2]);
    for (window, reach) in [("3", 1), ("8", 4), ("15", 7)] {
        let settings = [
            ("window", window),
            ("weights", "box"),
            ("iterations", "1"),
            ("sigma", "0"),
            ("derivatives", "central"),
            ("min-eigenvalue", "0"),
        ];
        let output = set("lucas-kanade", &settings).run(&clip, 0, &Threads::single()).unwrap();
        let Some(field) = output.get::<DenseField>().cloned() else { panic!("a dense field") };
        let smaller = field.confidence.expect("eigenvalues").values;
        for (x, y) in [(8, 8), (40, 30), (41, 30), (87, 71), (60, 9)] {
            let (plain, eigenvalue, _) = plain_lucas_kanade(&clip, reach, (x, y));
            let found = field.flow.at(x, y).expect("known");
            let near = |a: f32, b: f64| (f64::from(a) - b).abs() < 1e-3 * (1.0 + b.abs());
            assert!(near(found[0], plain[0]) && near(found[1], plain[1]), "{found:?} at ({x}, {y}), plainly {plain:?}");
            assert!(near(smaller[(x, y)], eigenvalue), "{} at ({x}, {y}), plainly {eigenvalue}", smaller[(x, y)]);
        }
    }
}

/// A slope of 4 gray levels per px that moves by half a px.
fn slope() -> Clip {
    let frame = |t: usize| Frame::gray(Grid::from_fn(40, 12, |x, _| (4 * x + 20 - 2 * t) as u8));
    Clip::from_frames("slope", vec![frame(0), frame(1)]).expect("frames of one size")
}

#[test]
fn a_slope_is_reported_alike_at_the_edge_and_inside() {
    for scheme in ["central", "sobel", "scharr", "cube", "five-point"] {
        for sigma in ["0", "1"] {
            let estimator = set("normal-flow", &[("sigma", sigma), ("derivatives", scheme)]);
            for x in [0.0, 1.0, 20.0, 38.0, 39.0] {
                let step = explained_at(&*estimator, &slope(), 4, [x, 4.0]);
                let derivatives = numbers(&fact(&step, "I_x, I_y, I_t").expect("derivatives"));
                assert_eq!(derivatives, [4.0, 0.0, -2.0], "{scheme} at {x}");
                let found = numbers(&fact(&step, "Normal flow").expect("a displacement"));
                assert_eq!(found, [0.5, 0.0], "{scheme} at {x}");
            }
        }
    }
}

#[test]
fn the_tensor_of_a_slope_is_the_square_of_it() {
    let step = explained_at(&*set("lucas-kanade", &[("sigma", "0")]), &slope(), 4, [20.0, 4.0]);
    assert_eq!(fact(&step, "Eigenvalues λ₁, λ₂").as_deref(), Some("16.00 and 0.00: edge"));
    let without =
        explained_at(&*set("lucas-kanade", &[("sigma", "0"), ("min-eigenvalue", "0")]), &slope(), 4, [20.0, 4.0]);
    let said = without.sentence.plain();
    assert!(said.contains("λ₂ = 0.00 is 0 up to rounding, an edge"), "{said}");
    let flat = Clip::from_frames("flat", vec![Frame::gray(Grid::new(40, 12, 77)); 2]).unwrap();
    for (threshold, why) in [("0", "0 up to rounding"), ("0.5", "below the threshold of 0.50")] {
        let step = explained_at(&*set("lucas-kanade", &[("min-eigenvalue", threshold)]), &flat, 4, [20.0, 4.0]);
        assert!(step.sentence.plain().contains(why), "{}", step.sentence.plain());
        assert!(fact(&step, "Eigenvalues λ₁, λ₂").is_some_and(|value| value.ends_with("flat")));
    }
}

#[test]
fn what_left_the_picture_does_not_count() {
    let (clip, _) = linear_motion([[0.0; 2]; 2], [1.5, 0.0]);
    let estimator = set("lucas-kanade", &[("window", "15"), ("weights", "box"), ("iterations", "2"), ("sigma", "0")]);
    let height = SIZE.1;
    // The windows in the last column see less of the picture in the second iteration, but what they see is as it was.
    let [before, after] = [30, height + 30].map(|unit| explained_at(&*estimator, &clip, unit, [95.0, 30.0]));
    let larger = |step: &scene::Step| numbers(&fact(step, "Eigenvalues λ₁, λ₂").expect("eigenvalues"))[0];
    assert!(larger(&after) > 0.5 * larger(&before), "{} was {}", larger(&after), larger(&before));
    assert!(fact(&before, "Outside frame t+1").is_none());
    let left = numbers(&fact(&after, "Outside frame t+1").expect("some left"));
    assert!(left[0] >= 30.0 && left[1] == 120.0, "{left:?}");
    // All goes far beyond the edge: nothing is left, and it is said why.
    let (clip, _) = linear_motion([[0.0; 2]; 2], [1.0, 0.0]);
    let narrow = Clip::from_frames(
        "narrow",
        [0, 1]
            .map(|t| {
                let frame = clip.frame(t).expect("a frame");
                Frame::gray(Grid::from_fn(5, 40, |x, y| frame.luma()[(40 + x, y)]))
            })
            .into(),
    )
    .unwrap();
    let thin = set("lucas-kanade", &[("window", "3"), ("iterations", "2"), ("sigma", "0"), ("min-eigenvalue", "0")]);
    let mut walk = thin.walk(&narrow, 0).unwrap();
    walk.jump(Move::End);
    let told = (0..40).map(|y| walk.step(Some(Focus::current([4.0, y as f32]))).sentence.plain());
    let gone: Vec<_> = told.filter(|said| said.contains("leads all its pixels out of frame t+1")).collect();
    assert!(!gone.is_empty());
}

#[test]
fn what_a_later_iteration_tells_of_a_pixel_can_be_recomputed() {
    let (clip, _) = linear_motion([[0.0; 2]; 2], [1.3, -0.6]);
    let step =
        explained_at(&*set("lucas-kanade", &[("iterations", "2"), ("sigma", "0")]), &clip, SIZE.1 + 30, [40.0, 30.0]);
    let [x, y, t] = numbers(&fact(&step, "I_x, I_y, I_t").unwrap())[..] else { panic!("three") };
    let [u, v] = numbers(&fact(&step, "Linearised at").unwrap())[..] else { panic!("two") };
    // What is told of time is the difference of the pictures that are shown.
    let [current, back, change] = ["Frame t", "Warped t+1", "I_t"].map(|label| tile(&step, label));
    for (i, difference) in change.cells().iter().enumerate() {
        assert!((back.cells()[i] - current.cells()[i] - difference).abs() < 0.16, "{i}");
    }
    assert!((f64::from(change[(5, 5)]) - t).abs() < 0.06, "{} and {t}", change[(5, 5)]);
    // At nearly the true displacement, hardly any difference is left.
    assert!(t.abs() < 1.0 && (u - 1.3).abs() < 0.1 && (v + 0.6).abs() < 0.1);
    let lines = step.readouts.iter().find_map(|readout| match readout {
        scene::Readout::Equation(lines) => Some(lines.iter().map(scene::Math::plain).collect::<Vec<_>>()),
        _ => None,
    });
    let lines = lines.expect("an equation");
    assert!(lines[0].starts_with("c = "), "{lines:?}");
    let c = *numbers(&lines[1]).last().unwrap();
    assert!((c - (t - x * u - y * v)).abs() < 0.02 * (1.0 + c.abs()), "{lines:?}");
}

#[test]
fn what_nobody_answered_for_stays_unknown_in_the_next_iteration() {
    // A flat picture with a patch of waves: most windows say nothing.
    let (waves, _) = linear_motion([[0.0; 2]; 2], [0.4, 0.2]);
    let patch = |t: usize| {
        let frame = waves.frame(t).expect("a frame");
        let is_patch = |x: usize, y: usize| (20..50).contains(&x) && (20..50).contains(&y);
        Frame::gray(Grid::from_fn(SIZE.0, SIZE.1, |x, y| if is_patch(x, y) { frame.luma()[(x, y)] } else { 128 }))
    };
    let clip = Clip::from_frames("patch", vec![patch(0), patch(1)]).unwrap();
    let mut walk = set("lucas-kanade", &[("iterations", "2")]).walk(&clip, 0).unwrap();
    let mut unknown = |unit: usize| {
        walk.jump(Move::To(Cursor { unit, event: usize::MAX }));
        let Some(field) = walk.output().get::<DenseField>().cloned() else { panic!("a dense field") };
        field.flow.0.cells().iter().filter(|uv| uv[0].is_nan()).count()
    };
    let (first, later, end) = (unknown(SIZE.1 - 1), unknown(SIZE.1), unknown(2 * SIZE.1 - 1));
    assert!(first > 2000 && later.abs_diff(first) < 100 && end.abs_diff(first) < 500, "{first}, {later}, {end}");
}

#[test]
fn a_bar_is_an_edge_a_wall_is_flat_and_both_say_nothing() {
    // A bright half, whose edge leans to one side; a corner of it at (48, 60).
    let frame = |shift: f64| {
        Frame::gray(Grid::from_fn(SIZE.0, SIZE.1, |x, y| {
            let edge = |c: f64| 1.0 / (1.0 + (-c).exp());
            (40.0 + 160.0 * edge(x as f64 - 48.0 - shift) * edge(60.0 - y as f64)) as u8
        }))
    };
    let clip = Clip::from_frames("bar", vec![frame(0.0), frame(0.5)]).unwrap();
    let estimator = set("lucas-kanade", &[("window", "9")]);
    let found = estimator.run(&clip, 0, &Threads::single()).unwrap().flow().expect("a flow");
    assert_eq!((found.at(48, 25), found.at(15, 25), found.at(80, 70)), (None, None, None));
    let [u, v] = found.at(48, 60).expect("the corner is seen to move");
    assert!((u - 0.5).abs() < 0.1 && v.abs() < 0.1, "({u}, {v})");
    let mut walk = estimator.walk(&clip, 0).unwrap();
    walk.jump(Move::End);
    for (place, told) in [([48.0, 25.0], "edge"), ([15.0, 25.0], "flat"), ([48.0, 60.0], "corner")] {
        let facts = walk.step(Some(Focus::current(place))).readouts.into_iter().find_map(|readout| match readout {
            scene::Readout::Facts(facts) => facts.into_iter().find(|fact| fact.label == "Eigenvalues λ₁, λ₂"),
            _ => None,
        });
        assert!(facts.expect("eigenvalues").value.ends_with(told), "{told} at {place:?}");
    }
    let scene = walk.scene(None);
    let points = |role| scene.marks.iter().any(|m| m.role == role && matches!(m.shape, scene::Shape::Points(_)));
    assert!(points(Role::Rejected) && points(Role::Predicted), "edges and flat places are marked");
}

/// Random numbers that are the same every time (SplitMix64).
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Nearly normal, of standard deviation 1.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

#[test]
fn the_spread_that_is_reported_is_that_of_many_noisy_pairs() {
    let (clean, _) = linear_motion([[0.0; 2]; 2], [0.3, 0.2]);
    let place = (48, 40);
    let settings = [("iterations", "1"), ("sigma", "0"), ("window", "11"), ("weights", "box")];
    let (mut found, mut told) = (Vec::new(), Vec::new());
    for seed in 0..60 {
        let noisy = |t: usize| {
            let frame = clean.frame(t).unwrap();
            let mut random = Random(1 + 2 * seed + t as u64);
            Frame::gray(frame.luma().map(|&v| (f64::from(v) + 3.0 * random.normal()).round().clamp(0.0, 255.0) as u8))
        };
        let clip = Clip::from_frames("noisy", vec![noisy(0), noisy(1)]).unwrap();
        let estimator = set("lucas-kanade", &settings);
        let [u, _] = estimator
            .run(&clip, 0, &Threads::single())
            .unwrap()
            .flow()
            .expect("a flow")
            .at(place.0, place.1)
            .expect("known");
        found.push(f64::from(u));
        let mut walk = estimator.walk(&clip, 0).unwrap();
        walk.jump(Move::To(Cursor { unit: place.1, event: place.0 + 1 }));
        let step = walk.step(None);
        let spread = step.readouts.iter().find_map(|readout| match readout {
            scene::Readout::Plane(plane) => plane.ellipse,
            _ => None,
        });
        let spread = spread.expect("a spread");
        let (sin, cos) = spread.angle_rad.sin_cos();
        told.push(f64::from((spread.radii[0] * cos).hypot(spread.radii[1] * sin)));
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let variance = mean(&found.iter().map(|u| (u - mean(&found)).powi(2)).collect::<Vec<_>>());
    let ratio = mean(&told) / variance.sqrt();
    // Noise in neighbouring differences is not quite by itself, so this is no better than a factor.
    assert!((0.6..1.7).contains(&ratio), "told {} px, found {} px", mean(&told), variance.sqrt());
}

/// The middle of the cell of least cost, and half the side of a cell.
fn least(plane: &scene::Plane) -> ([f32; 2], f32) {
    let values = &plane.cost.as_ref().expect("a cost").values;
    let cells = values.width();
    let places = (0..cells).flat_map(|y| (0..cells).map(move |x| (x, y))).filter(|place| values[*place].is_finite());
    let (x, y) = places.min_by(|a, b| values[*a].total_cmp(&values[*b])).expect("a cost that is known");
    let half = plane.reach / cells as f32;
    let along = |i: usize, index: usize| plane.center[i] - plane.reach + half * (2 * index + 1) as f32;
    ([along(0, x), along(1, y)], half)
}

/// The planes of a walk, event by event, with the pixel that is pointed at.
fn planes(walk: &mut dyn Walk, events: usize, focus: Option<Focus>) -> Vec<scene::Plane> {
    let innermost = walk.info().granularities.len() - 1;
    let mut found = Vec::new();
    for _ in 0..events {
        found.extend(walk.step(focus).readouts.into_iter().filter_map(|readout| match readout {
            scene::Readout::Plane(plane) => Some(plane),
            _ => None,
        }));
        walk.jump(Move::Granularity(innermost, Direction::Forward));
    }
    found
}

#[test]
fn the_estimates_go_down_into_the_valley_of_the_squared_difference() {
    let truth = [1.3, -0.8];
    let (clip, _) = linear_motion([[0.0; 2]; 2], truth.map(f64::from));
    for (id, settings) in [
        ("lucas-kanade", &[("sigma", "0")][..]),
        ("pyramidal-lucas-kanade", &[("points", "clicks"), ("clicks", "0:48,40"), ("levels", "1")]),
        ("klt", &[("levels", "1"), ("max-points", "1")]),
    ] {
        let mut walk = set(id, settings).walk(&clip, 0).unwrap();
        let focus = (id == "lucas-kanade").then_some(Focus::current([48.0, 40.0]));
        if focus.is_some() {
            walk.jump(Move::End);
        }
        let planes = planes(walk.as_mut(), 60, focus);
        let costed: Vec<_> = planes.iter().filter(|plane| plane.cost.is_some()).collect();
        assert!(costed.iter().any(|plane| plane.path.len() > 1), "{id} has a path");
        for plane in costed {
            let (at, half) = least(plane);
            assert!((0..2).all(|i| (at[i] - truth[i]).abs() <= half + 0.1), "{id}: {at:?}, truth {truth:?}");
            let costs: Vec<f32> = plane.path.iter().map(|at| plane.cost_at(*at).expect("a cost")).collect();
            assert!(costs.is_sorted_by(|before, after| before >= after), "{id}: {:?} cost {costs:?}", plane.path);
        }
    }
}

#[test]
fn a_window_that_leaves_the_picture_is_said_to() {
    let (clip, _) = linear_motion([[0.0; 2]; 2], [1.3, -0.8]);
    let mut walk = set("lucas-kanade", &[]).walk(&clip, 0).unwrap();
    walk.jump(Move::End);
    let (width, height) = clip.size();
    for (at, ends) in [([48.0, 40.0], false), ([2.0, 40.0], true), ([(width - 1) as f32, (height - 1) as f32], true)] {
        let step = walk.step(Some(Focus::current(at)));
        let said = step.sentence.plain().contains("ends where the window leaves frame t+1");
        let plane =
            step.readouts.iter().find_map(|r| if let scene::Readout::Plane(plane) = r { Some(plane) } else { None });
        let cost = plane.and_then(|plane| plane.cost.as_ref()).expect("a cost");
        assert_eq!((said, cost.has_gaps()), (ends, ends), "{at:?}: {}", step.sentence.plain());
    }
}
