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

/// A shift, a turn by 1.2°, and a growth by 2 %.
fn motions() -> [(&'static str, Clip, Flow); 3] {
    let of = |name, (clip, truth)| (name, clip, truth);
    [
        of("shift", linear_motion([[0.0; 2]; 2], [0.55, -0.35])),
        of("turn", linear_motion([[0.0, -0.021], [0.021, 0.0]], [0.0; 2])),
        of("growth", linear_motion([[0.02, 0.0], [0.0, 0.02]], [0.0; 2])),
    ]
}

/// How far off each may be on average. Over the window of Lucas and Kanade displacements are taken to be the same, which they
/// are not in a turn.
const MOST_PX: [(&str, f64); 4] = [("horn-schunck", 0.05), ("lucas-kanade", 0.07), ("clg", 0.05), ("tv-l1", 0.05)];

#[test]
fn shifts_turns_and_growths_are_recovered() {
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
                let derivatives = numbers(&fact(&step, "Iₓ, I_y, Iₜ").expect("derivatives"));
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
    let [x, y, t] = numbers(&fact(&step, "Iₓ, I_y, Iₜ").unwrap())[..] else { panic!("three") };
    let [u, v] = numbers(&fact(&step, "Before, (u₀, v₀)").unwrap())[..] else { panic!("two") };
    // What is told of time is the difference of the pictures that are shown.
    let [current, back, change] = ["Frame t", "Brought back", "Iₜ"].map(|label| tile(&step, label));
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

#[test]
fn the_update_that_is_told_is_the_one_that_is_done() {
    let (clip, _) = linear_motion([[0.01, 0.0], [0.0, 0.01]], [0.2, 0.4]);
    for solver in ["jacobi", "gauss-seidel", "sor"] {
        let estimator = set("horn-schunck", &[&PAPER[..], &[("solver", solver), ("relaxation", "1")]].concat());
        let mut walk = estimator.walk(&clip, 0).unwrap();
        walk.jump(Move::To(Cursor { unit: 6, event: usize::MAX }));
        let focus = [40.0, 30.0];
        let Output::Dense(field) = walk.output() else { panic!("a dense field") };
        let step = walk.step(Some(focus));
        let plane = step.readouts.iter().find_map(|readout| match readout {
            scene::Readout::Plane(plane) => Some(plane),
            _ => None,
        });
        let plane = plane.expect("a plane");
        let point = |name: &str| plane.points.iter().find(|(known, ..)| *known == name).expect("a point").2;
        let (mean, after) = (point("average"), point("after"));
        assert_eq!(after, field.flow.at(40, 30).unwrap());
        let [a, b, c] = plane.lines[0].factors;
        let off = (a * mean[0] + b * mean[1] + c) / (100.0 + a * a + b * b);
        let told = [mean[0] - a * off, mean[1] - b * off];
        assert!((0..2).all(|i| (told[i] - after[i]).abs() < 1e-4), "{solver}: {told:?}, done {after:?}");
        walk.jump(Move::Rung(4, Way::Back));
        assert!(walk.step(Some(focus)).sentence.plain().contains("pixel (40, 30)"));
    }
}
