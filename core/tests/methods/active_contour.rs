//! Active contours, held to their definitions by dense and naive references, and to what they say of the scenes that break them.

use crate::common::set;
use motionscope_core::base::Threads;
use motionscope_core::course::estimator;
use motionscope_core::data::{Clip, Frame};
use motionscope_core::geometry::Grid;
use motionscope_core::params::Params;
use motionscope_core::products::{MaskField, RegionField};
use motionscope_core::run::{AnyEstimator, Direction, Move, Walk};
use motionscope_core::scene::{Readout, Role, Shape, Step};
use motionscope_core::synth;

type Point = [f64; 2];

/// A number of 0 to 255 that belongs to a pixel.
fn noise(x: usize, y: usize, seed: u64) -> u8 {
    let mixed = (x as u64 * 0x9E37_79B9) ^ (y as u64 * 0x85EB_CA6B) ^ (seed * 0xC2B2_AE35);
    (mixed.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 40) as u8
}

fn is_in((x, y): (usize, usize), center: Point, radius: f64) -> bool {
    (x as f64 - center[0]).hypot(y as f64 - center[1]) < radius
}

/// A bright disc with some noise on a dark ground.
fn disc((width, height): (usize, usize), center: Point, radius: f64, seed: u64) -> Frame {
    Frame::gray(Grid::from_fn(width, height, |x, y| {
        noise(x, y, seed) / 16 + if is_in((x, y), center, radius) { 170 } else { 60 }
    }))
}

/// The same without noise, at rest.
fn plain(radius: f64) -> Clip {
    let level = |x, y| if is_in((x, y), [31.0, 27.0], radius) { 170 } else { 60 };
    clip(vec![Frame::gray(Grid::from_fn(64, 56, level)); 2])
}

fn clip(frames: Vec<Frame>) -> Clip {
    Clip::from_frames("frames", frames).expect("frames of one size")
}

/// A circle as the value of the parameter `contour`.
fn circle(center: Point, radius: f64) -> String {
    let corner = |i: usize| {
        let (sin, cos) = (i as f64 * std::f64::consts::TAU / 40.0).sin_cos();
        format!("{:.2},{:.2}", center[0] + radius * cos, center[1] + radius * sin)
    };
    (0..40).map(corner).collect::<Vec<_>>().join(" ")
}

/// The corners of a value of the parameter `contour`.
fn corners(text: &str) -> Vec<Point> {
    let place = |at: &str| {
        let (x, y) = at.split_once(',').expect("a place");
        [x, y].map(|c| f64::from(c.parse::<f32>().expect("a number")))
    };
    text.split(' ').map(place).collect()
}

/// The contour that a step draws.
fn drawn(walk: &dyn Walk) -> Vec<Point> {
    let marks = walk.scene(None).marks;
    let contour = marks.iter().rev().find_map(|mark| match &mark.shape {
        Shape::Path { points, closed: true } if mark.role == Role::Best => Some(points.clone()),
        _ => None,
    });
    contour.expect("a contour").into_iter().map(|at| at.map(f64::from)).collect()
}

/// The contours of the steps of the first frame that say `phrase`, in their order.
fn contours(estimator: &dyn AnyEstimator, clip: &Clip, phrase: &str) -> Vec<Vec<Point>> {
    let mut walk = estimator.walk(clip, 0).expect("a walk");
    let mut found = Vec::new();
    while walk.cursor().unit == 0 && !walk.at_end() {
        if walk.step(None).sentence.plain().contains(phrase) {
            found.push(drawn(&*walk));
        }
        walk.jump(Move::Granularity(2, Direction::Forward));
    }
    found
}

/// `count` points at equal distances along a polygon.
fn spread(corners: &[Point], count: usize) -> Vec<Point> {
    let apart = |a: Point, b: Point| (b[0] - a[0]).hypot(b[1] - a[1]);
    let closed: Vec<Point> = corners.iter().chain([&corners[0]]).copied().collect();
    let length: f64 = closed.windows(2).map(|pair| apart(pair[0], pair[1])).sum();
    let at = |mut way: f64| {
        for pair in closed.windows(2) {
            let long = apart(pair[0], pair[1]);
            if way <= long {
                return [0, 1].map(|k| pair[0][k] + way / long * (pair[1][k] - pair[0][k]));
            }
            way -= long;
        }
        closed[0]
    };
    (0..count).map(|i| at(length * i as f64 / count as f64)).collect()
}

/// A picture of numbers by rows, repeated beyond its border.
struct Plane {
    size: (usize, usize),
    values: Vec<f64>,
}

impl Plane {
    fn of((width, height): (usize, usize), at: impl Fn(isize, isize) -> f64) -> Self {
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x as isize, y as isize)));
        Self { size: (width, height), values: places.map(|(x, y)| at(x, y)).collect() }
    }

    fn at(&self, x: isize, y: isize) -> f64 {
        let [x, y] = [x.clamp(0, self.size.0 as isize - 1), y.clamp(0, self.size.1 as isize - 1)];
        self.values[y as usize * self.size.0 + x as usize]
    }

    fn between(&self, [x, y]: Point) -> f64 {
        let [x, y] = [x.clamp(0.0, self.size.0 as f64 - 1.0), y.clamp(0.0, self.size.1 as f64 - 1.0)];
        let (i, j) = (x.floor(), y.floor());
        let at = |di: isize, dj: isize| self.at(i as isize + di, j as isize + dj);
        let (u, v) = (x - i, y - j);
        (1.0 - v) * ((1.0 - u) * at(0, 0) + u * at(1, 0)) + v * ((1.0 - u) * at(0, 1) + u * at(1, 1))
    }

    fn differences(&self) -> [Plane; 2] {
        let along = |dx, dy| Plane::of(self.size, |x, y| (self.at(x + dx, y + dy) - self.at(x - dx, y - dy)) / 2.0);
        [along(1, 0), along(0, 1)]
    }
}

/// The edge strength of a whole frame, smoothed with σ = 2 px over two dimensions at once.
fn edge_strength(frame: &Frame) -> Plane {
    let luma = frame.luma();
    let gray = Plane::of(luma.size(), |x, y| f64::from(luma[(x as usize, y as usize)]));
    let weight = |i: isize, j: isize| (-((i * i + j * j) as f64) / 8.0).exp();
    let window = || (-6..=6).flat_map(|j: isize| (-6..=6).map(move |i: isize| (i, j)));
    let norm: f64 = window().map(|(i, j)| weight(i, j)).sum();
    let smooth =
        Plane::of(gray.size, |x, y| window().map(|(i, j)| weight(i, j) * gray.at(x + i, y + j)).sum::<f64>() / norm);
    let [dx, dy] = smooth.differences();
    let magnitude = Plane::of(gray.size, |x, y| dx.at(x, y).hypot(dy.at(x, y)));
    let most = magnitude.values.iter().fold(1.0f64, |most, value| most.max(*value));
    Plane { values: magnitude.values.iter().map(|value| value / most).collect(), ..magnitude }
}

/// Gradient vector flow by its equation, scaled to the largest length of `force`.
fn diffused(force: &[Plane; 2], mu: f64, steps: usize) -> [Plane; 2] {
    let square = |x, y| force[0].at(x, y).powi(2) + force[1].at(x, y).powi(2);
    let flow = [0, 1].map(|k| {
        let mut now = Plane::of(force[k].size, |x, y| force[k].at(x, y));
        for _ in 0..steps {
            now = Plane::of(now.size, |x, y| {
                let around = now.at(x - 1, y) + now.at(x + 1, y) + now.at(x, y - 1) + now.at(x, y + 1);
                let change = mu * (around - 4.0 * now.at(x, y)) - square(x, y) * (now.at(x, y) - force[k].at(x, y));
                now.at(x, y) + change
            });
        }
        now
    });
    let longest =
        |of: &[Plane; 2]| of[0].values.iter().zip(&of[1].values).map(|(x, y)| x.hypot(*y)).fold(0.0, f64::max);
    let scale = longest(force) / longest(&flow);
    flow.map(|plane| Plane { values: plane.values.iter().map(|value| scale * value).collect(), ..plane })
}

/// The matrix α DᵀD + β DᵀD DᵀD + γ I, where D has the differences of neighbouring points of a closed curve.
fn dense(count: usize, [alpha, beta, gamma]: [f64; 3]) -> Vec<Vec<f64>> {
    let product = |a: &[Vec<f64>], b: &[Vec<f64>]| -> Vec<Vec<f64>> {
        let entry = |i: usize, j: usize| (0..count).map(|k| a[i][k] * b[k][j]).sum();
        (0..count).map(|i| (0..count).map(|j| entry(i, j)).collect()).collect()
    };
    let mut d = vec![vec![0.0; count]; count];
    (0..count).for_each(|i| (d[i][i], d[i][(i + 1) % count]) = (-1.0, 1.0));
    let transposed: Vec<Vec<f64>> = (0..count).map(|i| (0..count).map(|j| d[j][i]).collect()).collect();
    let second = product(&transposed, &d);
    let fourth = product(&second, &second);
    let entry = |i: usize, j: usize| alpha * second[i][j] + beta * fourth[i][j] + if i == j { gamma } else { 0.0 };
    (0..count).map(|i| (0..count).map(|j| entry(i, j)).collect()).collect()
}

/// The solution of a dense system by elimination with pivots.
fn solved(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Vec<f64> {
    let count = right.len();
    for i in 0..count {
        let pivot = (i..count).max_by(|a, b| matrix[*a][i].abs().total_cmp(&matrix[*b][i].abs())).expect("rows");
        matrix.swap(i, pivot);
        right.swap(i, pivot);
        for row in i + 1..count {
            let factor = matrix[row][i] / matrix[i][i];
            (i..count).for_each(|column| matrix[row][column] -= factor * matrix[i][column]);
            right[row] -= factor * right[i];
        }
    }
    for i in (0..count).rev() {
        let rest: f64 = (i + 1..count).map(|j| matrix[i][j] * right[j]).sum();
        right[i] = (right[i] - rest) / matrix[i][i];
    }
    right
}

/// The area inside a polygon, by triangles from the origin.
fn area(points: &[Point]) -> f64 {
    let next = |i: usize| points[(i + 1) % points.len()];
    points.iter().enumerate().map(|(i, a)| (a[0] * next(i)[1] - a[1] * next(i)[0]) / 2.0).sum()
}

/// The derivative of the area for each point, by differences.
fn area_derivatives(points: &[Point]) -> Vec<Point> {
    let moved = |i: usize, k: usize, by: f64| {
        let mut other = points.to_vec();
        other[i][k] += by;
        area(&other)
    };
    (0..points.len()).map(|i| [0, 1].map(|k| (moved(i, k, 0.5) - moved(i, k, -0.5)) / 1.0)).collect()
}

fn farthest(found: &[Point], expected: &[Point]) -> f64 {
    assert_eq!(found.len(), expected.len(), "points");
    found.iter().zip(expected).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f64::max)
}

#[test]
fn iterations_solve_the_dense_system() {
    let frame = disc((64, 56), [31.0, 27.0], 15.0, 1);
    let clip = clip(vec![frame.clone(); 2]);
    // Not a circle, so that elasticity and rigidity differ from point to point.
    let contour = "12,9 34,6 52,12 50,30 54,46 28,48 10,38 14,24";
    let strength = edge_strength(&frame);
    for (force, balloon) in [("gradient", 0.0), ("gradient", 0.06), ("gradient-vector-flow", -0.02)] {
        let (pressure, margin) = (balloon.to_string(), "200");
        let settings = [
            ("contour", contour),
            ("margin", margin),
            ("force", force),
            ("balloon", &pressure),
            ("alpha", "0.25"),
            ("beta", "0.5"),
            ("edge-weight", "2"),
            ("gamma", "0.75"),
            ("mu", "0.15"),
            ("diffusions", "30"),
            ("iterations", "12"),
            ("epsilon", "0.001"),
        ];
        let found = contours(&*set("active-contour", &settings), &clip, "the solution of");
        let corners = corners(contour);
        let gradient = strength.differences();
        let field = if force == "gradient" { gradient } else { diffused(&gradient, 0.15, 30) };
        let length: f64 = {
            let next = |i: usize| corners[(i + 1) % corners.len()];
            corners.iter().enumerate().map(|(i, a)| (next(i)[0] - a[0]).hypot(next(i)[1] - a[1])).sum()
        };
        let mut points = spread(&corners, (length / 4.0).round() as usize);
        let matrix = dense(points.len(), [0.25, 0.5, 0.75]);
        assert_eq!(found.len(), 12, "{force}: iterations");
        for (i, found) in found.iter().enumerate() {
            let inflation = area_derivatives(&points);
            let right = |k: usize| {
                let of = |(at, inflation): (&Point, &Point)| {
                    0.75 * at[k] + 2.0 * field[k].between(*at) + f64::from(balloon as f32) * inflation[k]
                };
                points.iter().zip(&inflation).map(of).collect::<Vec<f64>>()
            };
            let [x, y] = [0, 1].map(|k| solved(matrix.clone(), right(k)));
            points = x.into_iter().zip(y).map(|(x, y)| [x, y]).collect();
            let off = farthest(found, &points);
            assert!(off < 0.01, "{force}, pressure {balloon}: {off:.5} px off after iteration {}", i + 1);
        }
    }
}

/// The energies of the first frame over its iterations.
fn energies(estimator: &dyn AnyEstimator, clip: &Clip, line: &str) -> Vec<f32> {
    let mut walk = estimator.walk(clip, 0).expect("a walk");
    let mut last = Vec::new();
    while walk.cursor().unit == 0 && !walk.at_end() {
        let step = walk.step(None);
        if step.sentence.plain().starts_with("The contour has a mean edge strength") {
            last = values(&step, line);
        }
        walk.jump(Move::Granularity(2, Direction::Forward));
    }
    last
}

fn values(step: &Step, line: &str) -> Vec<f32> {
    let series = step.readouts.iter().find_map(|readout| match readout {
        Readout::Series(series) if series.title == "Energy of the contour" => Some(series),
        _ => None,
    });
    let lines = &series.expect("a plot").lines;
    lines.iter().find(|(name, ..)| *name == line).expect("a line").2.iter().map(|point| point[1]).collect()
}

/// The greedy algorithm on a whole frame, by its definition: the points after each iteration.
fn greedy(strength: &Plane, start: &[Point], passes: usize) -> Vec<Vec<Point>> {
    let (mut points, count) = (start.to_vec(), start.len());
    let apart = |a: Point, b: Point| (b[0] - a[0]).hypot(b[1] - a[1]);
    let distance =
        |points: &[Point]| (0..count).map(|i| apart(points[i], points[(i + 1) % count])).sum::<f64>() / count as f64;
    let (mut mean, mut beta) = (distance(&points), vec![1.0; count]);
    let mut all = Vec::new();
    for _ in 0..passes {
        for i in (0..count).chain([0]) {
            let (before, at, after) = (points[(i + count - 1) % count], points[i], points[(i + 1) % count]);
            let inside = |p: &Point| (0..2).all(|k| p[k] >= 0.0 && p[k] < [strength.size.0, strength.size.1][k] as f64);
            let places: Vec<Point> = (0..9)
                .map(|j| [at[0] + f64::from(j % 3) - 1.0, at[1] + f64::from(j / 3) - 1.0])
                .filter(inside)
                .collect();
            let continuity: Vec<f64> = places.iter().map(|p| (mean - apart(before, *p)).abs()).collect();
            let curvature: Vec<f64> = places
                .iter()
                .map(|p| apart([before[0] + after[0], before[1] + after[1]], [2.0 * p[0], 2.0 * p[1]]).powi(2))
                .collect();
            let edge: Vec<f64> = places.iter().map(|p| strength.at(p[0] as isize, p[1] as isize)).collect();
            let most = |of: &[f64]| of.iter().fold(0.0f64, |most, value| most.max(*value));
            let (high, low) = (most(&edge), edge.iter().fold(1.0f64, |least, value| least.min(*value)));
            let low = if high - low < 5.0 / 255.0 { high - 5.0 / 255.0 } else { low };
            let energy = |j: usize| {
                continuity[j] / most(&continuity).max(1e-300)
                    + beta[i] * curvature[j] / most(&curvature).max(1e-300)
                    + 1.2f32 as f64 * (low - edge[j]) / (high - low)
            };
            let present = places.iter().position(|p| *p == at).expect("it is there");
            let least = (0..places.len()).map(energy).fold(f64::INFINITY, f64::min);
            if energy(present) > least + 1e-9 {
                let best = (0..places.len()).find(|j| energy(*j) < least + 1e-9).expect("the least");
                points[i] = places[best];
            }
        }
        let turn = |i: usize| {
            let (before, at, after) = (points[(i + count - 1) % count], points[i], points[(i + 1) % count]);
            let unit = |a: Point, b: Point| [0, 1].map(|k| (b[k] - a[k]) / apart(a, b).max(1e-300));
            apart(unit(before, at), unit(at, after)).powi(2)
        };
        for (i, beta) in beta.iter_mut().enumerate() {
            let is_sharpest = turn(i) > turn((i + count - 1) % count) && turn(i) > turn((i + 1) % count);
            let is_corner = is_sharpest && turn(i) > 0.25 && strength.between(points[i]) >= 0.4;
            *beta = if is_corner { 0.0 } else { 1.0 };
        }
        mean = distance(&points);
        all.push(points.clone());
    }
    all
}

#[test]
fn greedy_moves_are_those_of_the_definition() {
    // A bright square with a corner cut off: it has corners, and the contour begins outside.
    let frame = Frame::gray(Grid::from_fn(64, 56, |x, y| {
        let inside = (20..46).contains(&x) && (16..42).contains(&y) && x + y < 78;
        noise(x, y, 5) / 12 + if inside { 190 } else { 50 }
    }));
    let clip = clip(vec![frame.clone(); 2]);
    let contour = "12.3,10.2 33.4,7.1 52.2,9.4 55.6,27.3 50.7,45.2 35.1,49.8 14.2,47.3 9.6,30.4";
    let settings = [("contour", contour), ("margin", "200"), ("iterations", "14"), ("max-moved", "0")];
    let found = contours(&*set("greedy-contour", &settings), &clip, "End of iteration");
    let start: Vec<Point> = {
        let corners = corners(contour);
        let next = |i: usize| corners[(i + 1) % corners.len()];
        let length: f64 = corners.iter().enumerate().map(|(i, a)| (next(i)[0] - a[0]).hypot(next(i)[1] - a[1])).sum();
        spread(&corners, (length / 4.0).round() as usize).into_iter().map(|at| at.map(f64::round)).collect()
    };
    let expected = greedy(&edge_strength(&frame), &start, found.len());
    assert!(found.len() > 8 && farthest(&found[found.len() - 1], &start) > 5.0, "{} iterations", found.len());
    for (i, (found, expected)) in found.iter().zip(&expected).enumerate() {
        assert_eq!(found, expected, "iteration {}", i + 1);
    }
}

#[test]
fn small_steps_never_raise_the_energy() {
    let clip = clip(vec![disc((64, 56), [31.0, 27.0], 15.0, 1); 2]);
    for balloon in ["0", "-0.02"] {
        let start = circle([33.0, 28.0], 19.0);
        let settings = [
            ("contour", start.as_str()),
            ("gamma", "3"),
            ("balloon", balloon),
            ("iterations", "300"),
            ("epsilon", "0.002"),
        ];
        let total = energies(&*set("active-contour", &settings), &clip, "total");
        assert!(total.len() > 20 && total[total.len() - 1] < total[0] - 10.0, "{total:?}");
        // Interpolation of edges and of their gradient differ by little.
        assert!(total.windows(2).all(|pair| pair[1] < pair[0] + 1e-2), "{total:?}");
    }
}

/// Intersection over union of the masks with a disc, by frame; 0 where there is no mask.
fn overlaps(
    estimator: &dyn AnyEstimator,
    clip: &Clip,
    disc: impl Fn(usize) -> (Point, f64),
    frames: usize,
) -> Vec<f64> {
    let output = estimator.run(clip, 0, &Threads::single()).expect("a run");
    let field = output.get::<MaskField>().expect("masks");
    let mut all = vec![0.0; frames];
    for (t, mask) in field.masks().filter(|(t, _)| *t < frames) {
        let (mask, (center, radius)) = (mask.unpacked(), disc(t));
        let (mut both, mut either) = (0, 0);
        for (x, y) in (0..mask.height()).flat_map(|y| (0..mask.width()).map(move |x| (x, y))) {
            let inside = is_in((x, y), center, radius);
            both += usize::from(inside && mask.get(x, y));
            either += usize::from(inside || mask.get(x, y));
        }
        all[t] = f64::from(both as u32) / f64::from(either.max(1) as u32);
    }
    all
}

fn scene_with(id: &str, sliders: &[(&str, &str)]) -> Clip {
    let mut difficulty = synth::scene(id).expect("it is bundled").difficulty();
    sliders.iter().for_each(|(name, value)| difficulty.set(name, value).expect("in range"));
    synth::make(id, &difficulty).expect("a clip")
}

/// A disc of 12 px that moves by `speed` px/frame, and where it is.
fn moving(speed: f64) -> (Clip, impl Fn(usize) -> (Point, f64)) {
    let place = move |t: usize| ([24.0 + speed * t as f64, 30.0], 12.0);
    let frames = (0..FRAMES).map(|t| disc((128, 60), place(t).0, 12.0, t as u64)).collect();
    (clip(frames), place)
}

const FRAMES: usize = 20;
const BOTH: [&str; 2] = ["active-contour", "greedy-contour"];

#[test]
fn contours_follow_what_moves_less_than_its_edges_reach_and_lose_the_rest() {
    for id in BOTH {
        let start = circle([24.0, 30.0], 14.0);
        let estimator = set(id, &[("contour", &start)]);
        let (slow, place) = moving(2.0);
        let found = overlaps(&*estimator, &slow, place, FRAMES);
        assert!(found.iter().all(|overlap| *overlap > 0.8), "{id} at 2 px/frame: {found:.2?}");
        let (fast, place) = moving(4.6 * 3.0);
        let found = overlaps(&*estimator, &fast, place, 7);
        assert!(found[0] > 0.8 && found[6] < 0.1, "{id} at 13.8 px/frame: {found:.2?}");
    }
}

#[test]
fn gradient_vector_flow_attracts_from_farther_than_the_gradient() {
    // 9 px from the edge, and no internal energy that contracts the contour.
    let (clip, start) = (plain(12.0), circle([31.0, 27.0], 21.0));
    let overlap = |force: &str| {
        let own = [("contour", start.as_str()), ("force", force), ("min-edge-strength", "0")];
        let settings = [("alpha", "0"), ("beta", "0"), ("epsilon", "0.001")];
        let estimator = set("active-contour", &[own, settings].concat());
        overlaps(&*estimator, &clip, |_| ([31.0, 27.0], 12.0), 1)[0]
    };
    let [gradient, flow] = ["gradient", "gradient-vector-flow"].map(overlap);
    assert!(gradient < 0.4 && flow > 0.85, "gradient {gradient:.3}, gradient vector flow {flow:.3}");
}

#[test]
fn a_balloon_grows_to_the_edges_where_a_contour_without_one_collapses() {
    let (clip, start) = (plain(15.0), circle([31.0, 27.0], 6.0));
    let with = |balloon: &str| set("active-contour", &[("contour", start.as_str()), ("balloon", balloon)]);
    let grown = overlaps(&*with("0.05"), &clip, |_| ([31.0, 27.0], 15.0), 1)[0];
    assert!(grown > 0.85, "{grown:.3}");
    assert_eq!(contours(&*with("0"), &clip, "it has collapsed").len(), 1);
    let output = with("0").run(&clip, 0, &Threads::single()).expect("a run");
    let field = output.get::<RegionField>().expect("a region");
    assert!(field.frames[0].is_lost && output.get::<MaskField>().expect("masks").masks().count() == 0);
    assert_eq!(field.frames[0].region.size, [12.0, 12.0], "the region stays as it was placed");
}

#[test]
fn a_stronger_edge_in_the_background_holds_a_contour_back() {
    let last = |id: &str, bar: u8| {
        let place = |t: usize| ([24.0 + 2.0 * t as f64, 30.0], 12.0);
        let frame = |t: usize| {
            Frame::gray(Grid::from_fn(128, 60, |x, y| match (is_in((x, y), place(t).0, 12.0), (46..50).contains(&x)) {
                (true, _) => 120,
                (_, true) => bar,
                _ => 60,
            }))
        };
        let start = circle([24.0, 30.0], 13.0);
        let clip = clip((0..FRAMES).map(frame).collect());
        overlaps(&*set(id, &[("contour", &start)]), &clip, place, FRAMES)[FRAMES - 1]
    };
    for id in BOTH {
        let [without, with] = [60, 255].map(|bar| last(id, bar));
        assert!(without > 0.8 && with < without - 0.25, "{id}: {without:.3} without a bar, {with:.3} with one");
    }
}

#[test]
fn contours_that_enclose_nothing_and_pictures_without_edges_are_refused_in_words() {
    let still = plain(15.0);
    let flat = clip(vec![Frame::gray(Grid::new(64, 56, 90)); 2]);
    for id in BOTH {
        for (contour, said) in [
            (
                "10,10 40,10 40,40 70,40",
                "corner 4 of the contour at (70.00, 40.00) px lies outside the picture of 64×56 px",
            ),
            ("10,10 40,40 40,10 10,40", "crosses itself: its edges 1 and 3 meet"),
            ("10,10 20,20 30,30 40,40", "an area of 0.0 px²"),
        ] {
            let refusal = set(id, &[("contour", contour)]).walk(&still, 0).map(|_| ()).expect_err(contour).to_string();
            let plain = refusal.replace('\u{a0}', " ");
            assert!(plain.contains(said) && plain.ends_with("or set contour to none"), "{id}: {plain}");
        }
        let refusal =
            estimator(id).expect("it is registered").set("contour", "10,10 40,10 40,40").unwrap_err().to_string();
        assert!(refusal.contains("at least 4 corners"), "{refusal}");
        let mut walk = set(id, &[]).walk(&flat, 0).expect("a walk");
        walk.jump(Move::End);
        let (said, output) = (walk.step(None).sentence.plain(), walk.output());
        assert!(said.contains("without an edge no force acts"), "{id}: {said}");
        assert!(output.get::<RegionField>().is_some_and(|field| field.frames.len() == 1 && field.frames[0].is_lost));
    }
}

/// The mean overlap with the true box in frames of a scene with these sliders.
fn overlap_in(id: &str, clip: &Clip, frames: std::ops::Range<usize>) -> f64 {
    let output = set(id, &[]).run(clip, 0, &Threads::single()).expect("a run");
    let errors = output.get::<RegionField>().expect("a region").errors(clip).expect("readable");
    let all: Vec<f64> = errors.iter().filter(|e| frames.contains(&e.frame)).map(|e| e.overlap).collect();
    assert!(!all.is_empty(), "true boxes in {frames:?}");
    all.iter().sum::<f64>() / all.len() as f64
}

#[test]
fn plain_cars_are_followed_through_the_traffic() {
    let clip = scene_with("traffic", &[("speed", "0.3"), ("low-texture", "100")]);
    for id in BOTH {
        let overlap = overlap_in(id, &clip, 1..24);
        assert!(overlap > 0.95, "{id}: {overlap:.3}");
    }
}

#[test]
fn a_plain_ball_is_followed_to_the_tunnel_and_lost_in_it() {
    let clip = scene_with("tunnel", &[("low-texture", "100")]);
    for id in BOTH {
        let [before, after] = [1..11, 33..40].map(|frames| overlap_in(id, &clip, frames));
        assert!(before > 0.85 && after < 0.05, "{id}: {before:.3} before the tunnel, {after:.3} behind it");
    }
    // With its bands the ball has stronger edges inside than at its outline.
    let overlap = overlap_in("active-contour", &scene_with("tunnel", &[]), 1..11);
    assert!(overlap < 0.4, "{overlap:.3} with bands");
}

#[test]
fn a_plain_balloon_is_followed_and_a_banded_ball_folds_the_contour() {
    let balloon = scene_with("balloon", &[]);
    let end = |id: &str, clip: &Clip| {
        let mut walk = set(id, &[]).walk(clip, 0).expect("a walk");
        walk.jump(Move::End);
        walk.step(None).sentence.plain()
    };
    for id in BOTH {
        let overlap = overlap_in(id, &balloon, 1..40);
        assert!(overlap > 0.85, "{id}: {overlap:.3}");
        let said = end(id, &balloon);
        assert!(said.contains("The edges held the contour"), "{id}: {said}");
    }
    let tunnel = scene_with("tunnel", &[]);
    let mut walk = set("active-contour", &[]).walk(&tunnel, 0).expect("a walk");
    let mut losses = Vec::new();
    while !walk.at_end() && losses.is_empty() {
        walk.jump(Move::Granularity(2, Direction::Forward));
        losses.extend(Some(walk.step(None).sentence.plain()).filter(|said| said.contains("the object is lost")));
    }
    assert!(losses[0].contains("lost: the contour has collapsed (mean edge strength"), "{losses:?}");
    let said = end("active-contour", &tunnel);
    assert!(said.contains("no weight helps") && !said.contains("held the contour"), "{said}");
}
