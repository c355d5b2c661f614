//! Optical flow against plain references and against motion that is known exactly.

mod common;

use common::{central, set, waves};
use motionscope_core::{
    AnyEstimator, Clip, Cursor, Flow, Frame, Grid, Move, Output, Role, Threads, Way, metrics, scene, synth,
};

fn flow(id: &str, settings: &[(&str, &str)], clip: &Clip) -> Flow {
    set(id, settings).run(clip, 0, &Threads::single()).expect("a run").flow()
}

const SIZE: (usize, usize) = (96, 80);

/// Two frames of waves; what frame t + 1 shows at a place lay at `before` in frame t.
fn moving(before: impl Fn([f64; 2]) -> [f64; 2]) -> Clip {
    let frame = |place: &dyn Fn([f64; 2]) -> [f64; 2]| {
        Frame::gray(Grid::from_fn(SIZE.0, SIZE.1, |x, y| {
            let [x, y] = place([x as f64, y as f64]);
            (waves(x, y) + 0.5) as u8
        }))
    };
    Clip::from_frames("waves", vec![frame(&|place| place), frame(&before)]).expect("frames of one size")
}

/// A linear motion about the middle of the picture, x ← x + A (x − middle) + d, and frames that move so.
fn linear_motion(a: [[f64; 2]; 2], d: [f64; 2]) -> (Clip, Flow) {
    let middle = [(SIZE.0 as f64 - 1.0) / 2.0, (SIZE.1 as f64 - 1.0) / 2.0];
    let times = |m: [[f64; 2]; 2], p: [f64; 2]| [0, 1].map(|i| m[i][0] * p[0] + m[i][1] * p[1]);
    let forward = [[1.0 + a[0][0], a[0][1]], [a[1][0], 1.0 + a[1][1]]];
    let det = forward[0][0] * forward[1][1] - forward[0][1] * forward[1][0];
    let inverse = [[forward[1][1] / det, -forward[0][1] / det], [-forward[1][0] / det, forward[0][0] / det]];
    let clip = moving(|p| {
        let from_middle = [0, 1].map(|i| p[i] - middle[i] - d[i]);
        let back = times(inverse, from_middle);
        [0, 1].map(|i| middle[i] + back[i])
    });
    let truth = Grid::from_fn(SIZE.0, SIZE.1, |x, y| {
        let moved = times(a, [x as f64 - middle[0], y as f64 - middle[1]]);
        [0, 1].map(|i| (moved[i] + d[i]) as f32)
    });
    (clip, Flow(truth))
}

/// Mean endpoint error in px, `margin` px away from the border.
fn error(found: &Flow, truth: &Flow, margin: usize) -> f64 {
    let inside = |x: usize, y: usize| (margin..SIZE.0 - margin).contains(&x) && (margin..SIZE.1 - margin).contains(&y);
    let truth = Flow(Grid::from_fn(SIZE.0, SIZE.1, |x, y| if inside(x, y) { truth.0[(x, y)] } else { Flow::UNKNOWN }));
    metrics::flow_error(found, &truth).expect("one size").expect("known pixels").epe_px
}

/// A shift, a turn by 1.2°, a growth by 2 %, and a shear.
fn motions() -> [(&'static str, Clip, Flow); 4] {
    let of = |name, (clip, truth)| (name, clip, truth);
    [
        of("shift", linear_motion([[0.0; 2]; 2], [0.55, -0.35])),
        of("turn", linear_motion([[0.0, -0.021], [0.021, 0.0]], [0.0; 2])),
        of("growth", linear_motion([[0.02, 0.0], [0.0, 0.02]], [0.0; 2])),
        of("shear", linear_motion([[0.015, 0.02], [-0.005, -0.01]], [0.3, -0.6])),
    ]
}

/// How far off each may be on average. Over the windows of Lucas and Kanade and of Farnebäck displacements are taken to be
/// the same, which they are not in a turn.
const MOST_PX: [(&str, f64); 5] =
    [("horn-schunck", 0.05), ("lucas-kanade", 0.07), ("clg", 0.05), ("tv-l1", 0.05), ("farneback", 0.07)];

#[test]
fn shifts_turns_growths_and_shears_are_recovered() {
    for (name, clip, truth) in motions() {
        for (id, most_px) in MOST_PX {
            let off = error(&flow(id, &[], &clip), &truth, 8);
            assert!(off < most_px, "{id}: {off:.3} px off for a {name}");
        }
    }
}

#[test]
fn several_levels_find_what_one_cannot() {
    let (clip, truth) = linear_motion([[0.0; 2]; 2], [6.0, 4.5]);
    let off = |levels| error(&flow("horn-schunck", &[("levels", levels), ("warps", "5")], &clip), &truth, 16);
    let (one, many) = (off("1"), off("3"));
    assert!(many < 0.3 && one > 2.0, "{many:.2} px off with three levels, {one:.2} with one");
}

#[test]
fn normal_flow_is_the_point_of_the_line_nearest_to_zero() {
    let clip = moving(|[x, y]| [x - 0.4, y + 0.3]);
    let [a, b] = clip.pair(0).unwrap();
    let found = flow("normal-flow", &[("smoothing", "0"), ("threshold", "0")], &clip);
    let at = |frame: &Frame, x: usize, y: usize| f64::from(frame.luma()[(x, y)]);
    for (x, y) in (1..79).flat_map(|y| (1..95).map(move |x| (x, y))) {
        let mean = |x: usize, y: usize| (at(&a, x, y) + at(&b, x, y)) / 2.0;
        let gradient = [(mean(x + 1, y) - mean(x - 1, y)) / 2.0, (mean(x, y + 1) - mean(x, y - 1)) / 2.0];
        let (change, squared) = (at(&b, x, y) - at(&a, x, y), gradient[0].powi(2) + gradient[1].powi(2));
        let Some(uv) = found.at(x, y) else {
            assert!(squared < 1e-6, "({x}, {y}) is left out");
            continue;
        };
        for i in 0..2 {
            let plain = -change * gradient[i] / squared;
            assert!((f64::from(uv[i]) - plain).abs() < 1e-4 * (1.0 + plain.abs()), "{uv:?} at ({x}, {y}), not {plain}");
        }
    }
}

/// Horn and Schunck's method as plainly as can be: one level, central differences, Jacobi iterations, all in f64.
fn plain_horn_schunck(clip: &Clip, alpha: f64, iterations: usize) -> Vec<[f64; 2]> {
    let [a, b] = clip.pair(0).expect("a pair");
    let (width, height) = clip.size();
    let inside =
        |x: isize, y: isize| (x.clamp(0, width as isize - 1) as usize, y.clamp(0, height as isize - 1) as usize);
    let value = |frame: &Frame, x: isize, y: isize| f64::from(frame.luma()[inside(x, y)]);
    let mean = |x: isize, y: isize| (value(&a, x, y) + value(&b, x, y)) / 2.0;
    let mut field = vec![[0.0f64; 2]; width * height];
    for _ in 0..iterations {
        let before = field.clone();
        for y in 0..height as isize {
            for x in 0..width as isize {
                let at = |i: isize, j: isize, part: usize| {
                    let (x, y) = inside(x + i, y + j);
                    before[y * width + x][part]
                };
                let average = [0, 1].map(|p| {
                    (at(1, 0, p) + at(-1, 0, p) + at(0, 1, p) + at(0, -1, p)) / 6.0
                        + (at(1, 1, p) + at(-1, 1, p) + at(1, -1, p) + at(-1, -1, p)) / 12.0
                });
                let ix = central(|x| mean(x, y), x, width);
                let iy = central(|y| mean(x, y), y, height);
                let it = value(&b, x, y) - value(&a, x, y);
                let off = (ix * average[0] + iy * average[1] + it) / (alpha * alpha + ix * ix + iy * iy);
                field[y as usize * width + x as usize] = [average[0] - ix * off, average[1] - iy * off];
            }
        }
    }
    field
}

const PAPER: [(&str, &str); 5] =
    [("levels", "1"), ("warps", "1"), ("smoothing", "0"), ("derivatives", "central"), ("alpha", "10")];

#[test]
fn horn_schunck_agrees_with_a_plain_one() {
    let (clip, _) = linear_motion([[0.0, -0.01], [0.01, 0.0]], [0.3, -0.2]);
    // More than are done at once while the rows are in the cache, and not a multiple of it.
    let found = flow("horn-schunck", &[&PAPER[..], &[("iterations", "41")]].concat(), &clip);
    let plain = plain_horn_schunck(&clip, 10.0, 41);
    for (found, plain) in found.0.cells().iter().zip(plain) {
        assert!((0..2).all(|i| (f64::from(found[i]) - plain[i]).abs() < 1e-4), "{found:?}, plainly {plain:?}");
    }
}

#[test]
fn all_solvers_come_to_the_same_field_and_the_faster_ones_sooner() {
    let (clip, _) = linear_motion([[0.02, 0.0], [0.0, 0.02]], [0.3, 0.0]);
    let solve = |solver, iterations| {
        let more = [("solver", solver), ("iterations", iterations), ("relaxation", "1.7")];
        flow("horn-schunck", &[&PAPER[..], &more].concat(), &clip)
    };
    let end = solve("jacobi", "1000");
    let off = |other: &Flow| -> f32 {
        let pairs = other.0.cells().iter().flatten().zip(end.0.cells().iter().flatten());
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    };
    assert!(off(&solve("gauss-seidel", "600")) < 1e-3 && off(&solve("sor", "300")) < 1e-3);
    let [jacobi, gauss_seidel, sor] = ["jacobi", "gauss-seidel", "sor"].map(|solver| off(&solve(solver, "20")));
    assert!(sor < gauss_seidel && gauss_seidel < jacobi, "{sor} {gauss_seidel} {jacobi}");
}

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
            ("smoothing", "0"),
            ("derivatives", "central"),
            ("threshold", "0"),
        ];
        let output = set("lucas-kanade", &settings).run(&clip, 0, &Threads::single()).unwrap();
        let Output::Dense(field) = output else { panic!("a dense field") };
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

/// The step at the end of unit `unit` for the pixel at `place`.
fn told(estimator: &dyn AnyEstimator, clip: &Clip, unit: usize, place: [f32; 2]) -> scene::Step {
    let mut walk = estimator.walk(clip, 0).expect("a walk");
    walk.jump(Move::To(Cursor { unit, event: usize::MAX }));
    walk.step(Some(place))
}

/// A row of the table of facts of a step.
fn fact(step: &scene::Step, label: &str) -> Option<String> {
    step.readouts.iter().find_map(|readout| match readout {
        scene::Readout::Facts(facts) => facts.iter().find(|fact| fact.label == label).map(|fact| fact.value.clone()),
        _ => None,
    })
}

/// The numbers in a text, in their order.
fn numbers(text: &str) -> Vec<f64> {
    let plain = text.replace('−', "-");
    let parts = plain.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-'));
    parts.filter_map(|part| part.parse().ok()).collect()
}

fn tile(step: &scene::Step, label: &str) -> Grid<f32> {
    let tiles = step.readouts.iter().find_map(|readout| match readout {
        scene::Readout::Tiles(tiles) => Some(tiles),
        _ => None,
    });
    let tile = tiles.expect("tiles").iter().find(|tile| tile.label == label);
    tile.unwrap_or_else(|| panic!("no tile {label}")).values.clone()
}

/// A slope of 4 gray levels per px that moves by half a px.
fn slope() -> Clip {
    let frame = |t: usize| Frame::gray(Grid::from_fn(40, 12, |x, _| (4 * x + 20 - 2 * t) as u8));
    Clip::from_frames("slope", vec![frame(0), frame(1)]).expect("frames of one size")
}

#[test]
fn a_slope_is_told_alike_at_the_edge_and_inside() {
    for scheme in ["central", "sobel", "scharr", "cube", "five-point"] {
        for smoothing in ["0", "1"] {
            let estimator = set("normal-flow", &[("smoothing", smoothing), ("derivatives", scheme)]);
            for x in [0.0, 1.0, 20.0, 38.0, 39.0] {
                let step = told(&*estimator, &slope(), 4, [x, 4.0]);
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
    let step = told(&*set("lucas-kanade", &[("smoothing", "0")]), &slope(), 4, [20.0, 4.0]);
    assert_eq!(fact(&step, "Eigenvalues").as_deref(), Some("16.0 and 0.00: edge"));
    let without = told(&*set("lucas-kanade", &[("smoothing", "0"), ("threshold", "0")]), &slope(), 4, [20.0, 4.0]);
    let said = without.sentence.plain();
    assert!(said.contains("the other 0.00, nearly 0 beside it"), "{said}");
    let flat = Clip::from_frames("flat", vec![Frame::gray(Grid::new(40, 12, 77)); 2]).unwrap();
    for (threshold, why) in [("0", "nearly 0"), ("0.5", "below the threshold of 0.500")] {
        let step = told(&*set("lucas-kanade", &[("threshold", threshold)]), &flat, 4, [20.0, 4.0]);
        assert!(step.sentence.plain().contains(why), "{}", step.sentence.plain());
        assert!(fact(&step, "Eigenvalues").is_some_and(|value| value.ends_with("flat")));
    }
}

#[test]
fn what_left_the_picture_does_not_count() {
    let (clip, _) = linear_motion([[0.0; 2]; 2], [1.5, 0.0]);
    let estimator =
        set("lucas-kanade", &[("window", "15"), ("weights", "box"), ("iterations", "2"), ("smoothing", "0")]);
    let height = SIZE.1;
    // The windows in the last column see less of the picture in the second iteration, but what they see is as it was.
    let [before, after] = [30, height + 30].map(|unit| told(&*estimator, &clip, unit, [95.0, 30.0]));
    let larger = |step: &scene::Step| numbers(&fact(step, "Eigenvalues").expect("eigenvalues"))[0];
    assert!(larger(&after) > 0.5 * larger(&before), "{} was {}", larger(&after), larger(&before));
    assert!(fact(&before, "Left the picture").is_none());
    let left = numbers(&fact(&after, "Left the picture").expect("some left"));
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
    let thin = set("lucas-kanade", &[("window", "3"), ("iterations", "2"), ("smoothing", "0"), ("threshold", "0")]);
    let mut walk = thin.walk(&narrow, 0).unwrap();
    walk.jump(Move::End);
    let told = (0..40).map(|y| walk.step(Some([4.0, y as f32])).sentence.plain());
    let gone: Vec<_> = told.filter(|said| said.contains("all pixels of the window left the picture")).collect();
    assert!(!gone.is_empty());
}

#[test]
fn what_a_later_iteration_tells_of_a_pixel_can_be_recomputed() {
    let (clip, _) = linear_motion([[0.0; 2]; 2], [1.3, -0.6]);
    let step =
        told(&*set("lucas-kanade", &[("iterations", "2"), ("smoothing", "0")]), &clip, SIZE.1 + 30, [40.0, 30.0]);
    let [x, y, t] = numbers(&fact(&step, "I_x, I_y, I_t").unwrap())[..] else { panic!("three") };
    let [u, v] = numbers(&fact(&step, "Before, (u₀, v₀)").unwrap())[..] else { panic!("two") };
    // What is told of time is the difference of the pictures that are shown.
    let [current, back, change] = ["Frame t", "Brought back", "I_t"].map(|label| tile(&step, label));
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
        let Output::Dense(field) = walk.output() else { panic!("a dense field") };
        field.flow.0.cells().iter().filter(|uv| uv[0].is_nan()).count()
    };
    let (first, later, end) = (unknown(SIZE.1 - 1), unknown(SIZE.1), unknown(2 * SIZE.1 - 1));
    assert!(first > 2000 && later.abs_diff(first) < 100 && end.abs_diff(first) < 500, "{first}, {later}, {end}");
}

#[test]
fn the_memory_of_a_run_counts_its_pictures() {
    let (clip, _) = linear_motion([[0.0; 2]; 2], [0.4, 0.2]);
    // At least both pictures, their derivatives and the result, in four bytes each.
    for (id, least) in [("normal-flow", 7), ("lucas-kanade", 9), ("horn-schunck", 9), ("harris", 1), ("shi-tomasi", 1)]
    {
        let bytes = set(id, &[]).extent(&clip, 0).unwrap().memory_bytes;
        assert!(bytes >= 4 * least * SIZE.0 * SIZE.1, "{id}: {bytes}");
    }
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
    let found = estimator.run(&clip, 0, &Threads::single()).unwrap().flow();
    assert_eq!((found.at(48, 25), found.at(15, 25), found.at(80, 70)), (None, None, None));
    let [u, v] = found.at(48, 60).expect("the corner is seen to move");
    assert!((u - 0.5).abs() < 0.1 && v.abs() < 0.1, "({u}, {v})");
    let mut walk = estimator.walk(&clip, 0).unwrap();
    walk.jump(Move::End);
    for (place, told) in [([48.0, 25.0], "edge"), ([15.0, 25.0], "flat"), ([48.0, 60.0], "corner")] {
        let facts = walk.step(Some(place)).readouts.into_iter().find_map(|readout| match readout {
            scene::Readout::Facts(facts) => facts.into_iter().find(|fact| fact.label == "Eigenvalues"),
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
fn the_spread_that_is_told_is_that_of_many_noisy_pairs() {
    let (clean, _) = linear_motion([[0.0; 2]; 2], [0.3, 0.2]);
    let place = (48, 40);
    let settings = [("iterations", "1"), ("smoothing", "0"), ("window", "11"), ("weights", "box")];
    let (mut found, mut told) = (Vec::new(), Vec::new());
    for seed in 0..60 {
        let noisy = |t: usize| {
            let frame = clean.frame(t).unwrap();
            let mut random = Random(1 + 2 * seed + t as u64);
            Frame::gray(frame.luma().map(|&v| (f64::from(v) + 3.0 * random.normal()).round().clamp(0.0, 255.0) as u8))
        };
        let clip = Clip::from_frames("noisy", vec![noisy(0), noisy(1)]).unwrap();
        let estimator = set("lucas-kanade", &settings);
        let [u, _] = estimator.run(&clip, 0, &Threads::single()).unwrap().flow().at(place.0, place.1).expect("known");
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

/// The values of a line of a plot, at the end of the run.
fn plotted(estimator: &dyn AnyEstimator, clip: &Clip, title: &str, line: &str) -> Vec<f32> {
    let mut walk = estimator.walk(clip, 0).expect("a walk");
    walk.jump(Move::End);
    let series = walk.step(None).readouts.into_iter().find_map(|readout| match readout {
        scene::Readout::Series(series) if series.title == title => Some(series),
        _ => None,
    });
    let lines = series.expect("a plot").lines;
    let points = lines.into_iter().find(|(name, ..)| *name == line).expect("a line").2;
    points.into_iter().map(|[_, y]| y).collect()
}

#[test]
fn energy_never_rises_and_the_error_falls() {
    let scene = synth::scene("sub-pixel").unwrap();
    let clip = scene.clip(&scene.difficulty()).unwrap();
    for solver in ["jacobi", "gauss-seidel", "sor"] {
        let settings = [("levels", "1"), ("warps", "1"), ("iterations", "60"), ("solver", solver)];
        let estimator = set("horn-schunck", &settings);
        let energy = plotted(&*estimator, &clip, "Energy per pixel", "energy");
        assert_eq!(energy.len(), 60);
        assert!(energy.windows(2).all(|pair| pair[1] <= pair[0] * (1.0 + 1e-6)), "{solver}: {energy:?}");
        let error = plotted(&*estimator, &clip, "Mean endpoint error", "error");
        assert!(error[59] < 0.5 * error[0], "{solver}: {} px, then {}", error[0], error[59]);
    }
}

#[test]
fn horn_schunck_stops_when_little_changes() {
    let (clip, _) = linear_motion([[0.0; 2]; 2], [0.3, 0.1]);
    let estimator = set("horn-schunck", &[&PAPER[..], &[("tolerance", "0.002"), ("iterations", "500")]].concat());
    let mut walk = estimator.walk(&clip, 0).unwrap();
    assert_eq!(walk.units(), None, "nobody knows before");
    walk.jump(Move::End);
    let units = walk.units().expect("the end is reached");
    assert!((5..400).contains(&units), "{units} iterations");
    assert_eq!(walk.output(), estimator.run(&clip, 0, &Threads::new(2).unwrap()).unwrap());
    let change = plotted(&*estimator, &clip, "Mean change", "change");
    assert!(change[units - 1] < 0.002 && change[units - 2] >= 0.002);
}

fn plane(step: &scene::Step) -> &scene::Plane {
    let plane = step.readouts.iter().find_map(|readout| match readout {
        scene::Readout::Plane(plane) => Some(plane),
        _ => None,
    });
    plane.expect("a plane")
}

/// A point of the plane that a step shows.
fn point(step: &scene::Step, name: &str) -> [f32; 2] {
    plane(step).points.iter().find(|(known, ..)| *known == name).expect("a point").2
}

/// The lines of the equation that a step shows.
fn equation(step: &scene::Step) -> Vec<String> {
    let lines = step.readouts.iter().find_map(|readout| match readout {
        scene::Readout::Equation(lines) => Some(lines.iter().map(scene::Math::plain).collect()),
        _ => None,
    });
    lines.expect("an equation")
}

#[test]
fn the_update_that_is_told_is_the_one_that_is_done() {
    let (clip, _) = linear_motion([[0.01, 0.0], [0.0, 0.01]], [0.2, 0.4]);
    for (solver, relaxation) in [("jacobi", 1.0), ("gauss-seidel", 1.0), ("sor", 1.9f32)] {
        let estimator = set("horn-schunck", &[&PAPER[..], &[("solver", solver), ("relaxation", "1.9")]].concat());
        let mut walk = estimator.walk(&clip, 0).unwrap();
        walk.jump(Move::To(Cursor { unit: 6, event: usize::MAX }));
        let focus = [40.0, 30.0];
        let Output::Dense(field) = walk.output() else { panic!("a dense field") };
        let step = walk.step(Some(focus));
        let [before, mean, after] = ["before", "average", "after"].map(|name| point(&step, name));
        assert_eq!(after, field.flow.at(40, 30).unwrap());
        let [a, b, c] = plane(&step).lines[0].factors;
        let off = (a * mean[0] + b * mean[1] + c) / (100.0 + a * a + b * b);
        let update = [mean[0] - a * off, mean[1] - b * off];
        let told = [0, 1].map(|i| before[i] + relaxation * (update[i] - before[i]));
        assert!((0..2).all(|i| (told[i] - after[i]).abs() < 1e-4), "{solver}: {told:?}, done {after:?}");
        // The numbers of the last line are what was done.
        let last = equation(&step).pop().unwrap();
        assert!((numbers(&last).pop().unwrap() - f64::from(after[1])).abs() < 2e-3, "{last}");
        let said = step.sentence.plain();
        assert_eq!(said.contains("SOR goes 1.90 times as far from where it was"), solver == "sor", "{said}");
        if let [.., result] = &numbers(&said)[..] {
            assert!((result - f64::from(after[1])).abs() < 2e-3, "{said}");
        }
        walk.jump(Move::Rung(4, Way::Back));
        assert!(walk.step(Some(focus)).sentence.plain().contains("pixel (40, 30)"));
    }
}

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
            ("neighborhood", "7"),
            ("sigma", "1.1"),
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
    let Output::Dense(field) = walk.output() else { panic!("a dense field") };
    let step = walk.step(Some(focus));
    let found = step.readouts.iter().find_map(|readout| match readout {
        scene::Readout::Plane(plane) => plane.points.iter().find(|(name, ..)| *name == "displacement"),
        _ => None,
    });
    assert_eq!(found.expect("a displacement").2, field.flow.at(40, 30).unwrap());
    assert!(step.sentence.plain().contains("pixel (40, 30)"), "{}", step.sentence.plain());
    // The first unit of a level shows the polynomials of both frames, and what they leave.
    walk.jump(Move::To(Cursor { unit: 2, event: 1 }));
    let tiles = walk.step(Some(focus)).readouts.into_iter().find_map(|readout| match readout {
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
    for (event, lines) in [(2, 2..=2), (3, 20..=200)] {
        walk.jump(Move::To(Cursor { unit: 2, event }));
        let count = walk.step(Some(focus)).readouts.iter().find_map(|readout| match readout {
            scene::Readout::Plane(plane) => Some(plane.lines.len()),
            _ => None,
        });
        assert!(lines.contains(&count.expect("a plane")), "{count:?} lines at event {event}");
    }
}

#[test]
fn windows_larger_than_the_picture_and_half_known_truth_show_no_nan() {
    struct HalfKnown;
    impl motionscope_core::Truth for HalfKnown {
        fn flow(&self, _: usize) -> Result<Option<std::sync::Arc<Flow>>, motionscope_core::Error> {
            let flow = Grid::from_fn(19, 17, |x, _| if x < 9 { [0.5, 0.0] } else { Flow::UNKNOWN });
            Ok(Some(std::sync::Arc::new(Flow(flow))))
        }

        fn kinds(&self) -> Vec<&'static str> {
            vec!["flow"]
        }
    }
    let frame = |t: f64| Frame::gray(Grid::from_fn(19, 17, |x, y| waves(x as f64 - 0.5 * t, y as f64) as u8));
    let clip = Clip::from_frames("small", vec![frame(0.0), frame(1.0)]).unwrap();
    let clip = clip.with_truth(std::sync::Arc::new(HalfKnown));
    let estimator = set("farneback", &[("window", "63"), ("neighborhood", "15"), ("sigma", "5")]);
    let mut walk = estimator.walk(&clip, 0).unwrap();
    walk.jump(Move::End);
    assert!(walk.output().flow().0.cells().iter().flatten().all(|c| c.is_finite() && c.abs() < 3.0));
    for focus in [[3.0, 4.0], [15.0, 4.0]] {
        let step = format!("{:?}", walk.step(Some(focus)));
        assert!(step.contains("Mean endpoint error") && !step.contains("NaN"), "{step}");
    }
}

#[test]
fn what_a_later_warp_tells_of_a_pixel_can_be_recomputed() {
    let (clip, _) = linear_motion([[0.0; 2]; 2], [1.3, -0.6]);
    for id in ["horn-schunck", "clg", "tv-l1"] {
        let estimator = set(id, &[("levels", "1"), ("warps", "2"), ("iterations", "30"), ("smoothing", "0")]);
        let mut walk = estimator.walk(&clip, 0).unwrap();
        // The first event of an iteration in the middle of the second warp.
        walk.jump(Move::To(Cursor { unit: 40, event: 1 }));
        let step = walk.step(Some([40.0, 30.0]));
        let [x, y, t] = numbers(&fact(&step, "I_x, I_y, I_t").unwrap())[..] else { panic!("three") };
        let [u, v] = numbers(&fact(&step, "Warp (u₀, v₀)").unwrap())[..] else { panic!("two") };
        assert!(t.abs() < 2.0 && (u - 1.3).abs() < 0.2 && (v + 0.6).abs() < 0.2, "{id}: little is left to find");
        if id != "clg" {
            let lines = equation(&step);
            let c = numbers(&lines[1]).pop().unwrap();
            assert!((c - (t - x * u - y * v)).abs() < 0.02 * (1.0 + c.abs()), "{id}: {lines:?}");
            assert!(lines[2].contains(" + c"), "{id}: {lines:?}");
        }
    }
}

#[test]
fn displacements_on_a_level_are_told_in_its_px_and_as_on_the_picture() {
    let (clip, _) = linear_motion([[0.0; 2]; 2], [2.4, -1.2]);
    for id in ["horn-schunck", "clg", "tv-l1"] {
        let estimator = set(id, &[("levels", "2"), ("warps", "1"), ("iterations", "20")]);
        let coarse = told(&*estimator, &clip, 19, [40.0, 30.0]);
        assert!(fact(&coarse, "Before").is_some_and(|value| value.ends_with("px of level 1")), "{id}");
        let (on_level, on_picture) = (point(&coarse, "after"), numbers(&fact(&coarse, "On the picture").unwrap()));
        for i in 0..2 {
            assert!((2.0 * f64::from(on_level[i]) - on_picture[i]).abs() < 0.01, "{id}: {on_level:?}, {on_picture:?}");
        }
        let fine = told(&*estimator, &clip, 39, [40.0, 30.0]);
        assert!(
            fact(&fine, "Before").is_some_and(|value| value.ends_with(" px"))
                && fact(&fine, "On the picture").is_none()
        );
    }
}

#[test]
fn medians_are_told_where_they_are_taken() {
    let (clip, _) = linear_motion([[0.0; 2]; 2], [0.4, 0.2]);
    for id in ["horn-schunck", "clg", "tv-l1"] {
        let estimator = set(id, &[("levels", "2"), ("warps", "2"), ("iterations", "3")]);
        let mut walk = estimator.walk(&clip, 0).unwrap();
        let mut at = |unit, event| {
            walk.jump(Move::To(Cursor { unit, event }));
            let step = walk.step(None);
            (estimator.info().pseudocode[step.line], step.sentence.plain())
        };
        let first = at(0, 1);
        assert!(first.1.contains("nothing was found yet") && !first.0.contains("medians"), "{id}: {first:?}");
        for (unit, is_enlarged) in [(3, false), (6, true), (9, false)] {
            let (line, said) = at(unit, 1);
            assert!(line.contains("medians") && said.contains("median"), "{id}: {line}: {said}");
            assert_eq!(said.contains("enlarged"), is_enlarged, "{id}: {said}");
            assert!(at(unit, 2).1.contains("brought back by what was found"), "{id}");
        }
    }
}

#[test]
fn a_pixel_without_a_constraint_is_told_as_such() {
    let flat = Clip::from_frames("flat", vec![Frame::gray(Grid::new(40, 30, 77)); 2]).unwrap();
    let said = told(&*set("horn-schunck", &[]), &flat, 0, [20.0, 15.0]).sentence.plain();
    assert!(said.contains("has no gradient") && said.contains("takes the average"), "{said}");
    let (clip, _) = linear_motion([[0.0; 2]; 2], [1.5, 0.0]);
    for (id, event) in [("horn-schunck", usize::MAX), ("tv-l1", 1)] {
        let estimator = set(id, &[("levels", "1"), ("warps", "2"), ("iterations", "40")]);
        let mut walk = estimator.walk(&clip, 0).unwrap();
        walk.jump(Move::To(Cursor { unit: 50, event }));
        let step = walk.step(Some([95.0, 40.0]));
        assert!(step.sentence.plain().contains("has left the picture"), "{id}: {}", step.sentence.plain());
        assert_eq!(fact(&step, "I_x, I_y, I_t").as_deref(), Some("none: it left the picture"), "{id}");
    }
}

#[test]
fn the_tolerance_is_in_px_of_the_picture_on_every_level() {
    let (clip, _) = linear_motion([[0.0; 2]; 2], [1.3, 0.8]);
    let settings = [("levels", "3"), ("warps", "2"), ("tolerance", "0.004"), ("iterations", "400")];
    let estimator = set("horn-schunck", &settings);
    let mut walk = estimator.walk(&clip, 0).unwrap();
    walk.jump(Move::End);
    let change = plotted(&*estimator, &clip, "Mean change", "change");
    let mut ends = 0;
    for (unit, change) in change.iter().enumerate() {
        walk.jump(Move::To(Cursor { unit: unit + 1, event: 1 }));
        let is_last = walk.place()[3].index == 0;
        if unit + 1 < walk.units().unwrap() {
            assert_eq!(*change < 0.004, is_last, "iteration {unit} changes by {change}");
        } else {
            assert!(*change < 0.004);
        }
        ends += usize::from(*change < 0.004);
    }
    assert_eq!(ends, 6, "two warps on three levels");
}
