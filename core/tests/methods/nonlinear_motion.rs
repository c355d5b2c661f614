//! The unscented filter and the interacting modes against plain implementations with matrices as rows, and against single models.

use std::f64::consts::TAU;

use crate::common::set;
use motionscope_core::base::Threads;
use motionscope_core::data::{Clip, Detection};
use motionscope_core::geometry::Bounds;
use motionscope_core::methods::kalman::{
    Acceleration, Estimate, Filter, Interacting, Measurement, Model, Motion, Nonlinear, Sensor, Turn, Velocity,
    smoothed,
};
use motionscope_core::products::ObjectField;
use motionscope_core::run::{Direction, Move, Walk};
use motionscope_core::scene::{Matrix, Readout, Role, Series};
use nalgebra::{SMatrix, SVector, Vector2};

type Rows = Vec<Vec<f64>>;

fn product(a: &Rows, b: &Rows) -> Rows {
    let entry = |row: &Vec<f64>, j: usize| row.iter().zip(b).map(|(value, row)| value * row[j]).sum();
    a.iter().map(|row| (0..b[0].len()).map(|j| entry(row, j)).collect()).collect()
}

fn transposed(a: &Rows) -> Rows {
    (0..a[0].len()).map(|j| a.iter().map(|row| row[j]).collect()).collect()
}

fn sum(a: &Rows, b: &Rows, factor: f64) -> Rows {
    a.iter().zip(b).map(|(a, b)| a.iter().zip(b).map(|(a, b)| a + factor * b).collect()).collect()
}

/// The inverse of a 2×2 matrix, and its determinant.
fn inverse(a: &Rows) -> (Rows, f64) {
    let determinant = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    let over = |value: f64| value / determinant;
    (vec![vec![over(a[1][1]), over(-a[0][1])], vec![over(-a[1][0]), over(a[0][0])]], determinant)
}

/// L of P = L Lᵀ.
fn cholesky(p: &Rows) -> Rows {
    let mut l: Rows = Vec::new();
    for row in p {
        let mut own: Vec<f64> = Vec::new();
        for value in row.iter().take(l.len() + 1) {
            let earlier = l.get(own.len());
            let known: f64 = own.iter().zip(earlier.unwrap_or(&own)).map(|(a, b)| a * b).sum();
            own.push(match earlier {
                Some(earlier) => (value - known) / earlier[own.len()],
                None => (value - known).sqrt(),
            });
        }
        own.resize(p.len(), 0.0);
        l.push(own);
    }
    l
}

/// A mean and a covariance.
#[derive(Clone, Debug)]
struct Plain {
    x: Vec<f64>,
    p: Rows,
}

impl Plain {
    fn of<const N: usize>(estimate: &Estimate<N>) -> Self {
        let p = (0..N).map(|i| (0..N).map(|j| estimate.covariance[(i, j)]).collect()).collect();
        Self { x: estimate.state.iter().copied().collect(), p }
    }

    /// The moments of weighted points; with weights for the mean and for the covariance.
    fn of_points(points: &[Vec<f64>], [of_mean, of_spread]: [&[f64]; 2]) -> Self {
        let n = points[0].len();
        let mean = |i: usize| points.iter().zip(of_mean).map(|(point, w)| w * point[i]).sum::<f64>();
        let x: Vec<f64> = (0..n).map(mean).collect();
        let entry = |i: usize, j: usize| {
            points.iter().zip(of_spread).map(|(point, w)| w * (point[i] - x[i]) * (point[j] - x[j])).sum()
        };
        let p = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
        Self { x, p }
    }

    /// The textbook's update with a position: the estimate, and the likelihood.
    fn updated(&self, place: [f64; 2], deviation: f64) -> (Self, f64) {
        let n = self.x.len();
        let h: Rows = (0..2).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
        let noise = vec![vec![deviation * deviation, 0.0], vec![0.0, deviation * deviation]];
        let s = sum(&product(&product(&h, &self.p), &transposed(&h)), &noise, 1.0);
        let (inverse, determinant) = inverse(&s);
        let gain = product(&product(&self.p, &transposed(&h)), &inverse);
        let residual: Rows = (0..2).map(|i| vec![place[i] - self.x[i]]).collect();
        let step = product(&gain, &residual);
        let squared = product(&product(&transposed(&residual), &inverse), &residual)[0][0];
        let x = self.x.iter().zip(&step).map(|(x, step)| x + step[0]).collect();
        let p = sum(&self.p, &product(&gain, &product(&h, &self.p)), -1.0);
        (Self { x, p }, (-0.5 * squared).exp() / (TAU * determinant.sqrt()))
    }

    fn off<const N: usize>(&self, estimate: &Estimate<N>) -> f64 {
        let other = Self::of(estimate);
        let values = |plain: &Self| [plain.x.clone(), plain.p.concat()].concat();
        values(self).iter().zip(values(&other)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }
}

/// The coordinated turn of a state (x, y, u, v, ω), with ω ≠ 0.
fn turned(state: &[f64]) -> Vec<f64> {
    let [x, y, u, v, rate] = state.try_into().expect("five components");
    let (sin, cos) = rate.sin_cos();
    vec![
        x + (sin * u - (1.0 - cos) * v) / rate,
        y + ((1.0 - cos) * u + sin * v) / rate,
        cos * u - sin * v,
        sin * u + cos * v,
        rate,
    ]
}

fn turn(acceleration: f64, rate_change: f64, prediction: Nonlinear) -> Turn {
    Turn { acceleration, rate_change, prediction }
}

/// Q of an acceleration that is constant over a frame, and of a change of the turn rate.
fn process_noise(n: usize, acceleration: f64, rate_change: f64) -> Rows {
    let gain = |i: usize| [0.5, 0.5, 1.0, 1.0, 0.0][i];
    let entry = |i: usize, j: usize| match (i, j) {
        (4, 4) => rate_change * rate_change,
        _ if i % 2 == j % 2 => gain(i) * gain(j) * acceleration * acceleration,
        _ => 0.0,
    };
    (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
}

/// Seeded normally distributed numbers.
struct Chance(u64);

impl Chance {
    /// Of a mixed seed, so that the streams of neighbours are independent.
    fn new(seed: u64) -> Self {
        let mixed = (seed + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        Self((mixed ^ (mixed >> 29)).wrapping_mul(0xBF58_476D_1CE4_E5B9))
    }

    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as f64 + 0.5) / f64::from(1_u32 << 31)
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (TAU * self.uniform()).cos()
    }
}

/// Constant velocity, predicted by sigma points.
struct Points(Velocity);

impl Motion<4> for Points {
    const NAMES: [&'static str; 4] = Velocity::NAMES;

    fn moved(&self, state: &SVector<f64, 4>) -> SVector<f64, 4> {
        self.0.moved(state)
    }

    fn transition(&self, state: &SVector<f64, 4>) -> SMatrix<f64, 4, 4> {
        self.0.transition(state)
    }

    fn noise(&self) -> SMatrix<f64, 4, 4> {
        self.0.noise()
    }

    fn initial_deviations(&self, speed: f64) -> [f64; 4] {
        self.0.initial_deviations(speed)
    }

    fn is_unscented(&self) -> bool {
        true
    }
}

const PLACES: [[f64; 2]; 7] =
    [[12.0, 7.0], [14.5, 6.25], [17.5, 6.0], [19.0, 5.5], [22.25, 3.75], [24.0, 4.0], [25.0, 1.0]];

#[test]
fn sigma_points_of_a_linear_motion_give_the_kalman_filter() {
    let motion = Velocity { acceleration: 0.7 };
    let sensor = Sensor::<4, 2>::first([1.5; 2]);
    let deviations = SVector::from([1.5, 1.5, 10.0, 10.0]);
    let covariance = SMatrix::from_diagonal(&deviations.map(|d| d * d));
    let mut both = [Estimate { state: SVector::from([10.0, 8.0, 0.0, 0.0]), covariance }; 2];
    for place in PLACES {
        let predictions = (both[0].predicted(&motion), both[1].predicted(&Points(motion)));
        assert!((predictions.0.transition - predictions.1.transition).norm() < 1e-9, "A is F");
        for (estimate, predicted) in both.iter_mut().zip([predictions.0, predictions.1]) {
            let innovation = predicted.estimate.innovation(&sensor, &Vector2::from(place)).expect("sound");
            *estimate = predicted.estimate.updated(&sensor, &innovation).estimate;
        }
        assert!(
            (both[0].state - both[1].state).norm() < 1e-9 && (both[0].covariance - both[1].covariance).norm() < 1e-9
        );
    }
}

#[test]
fn an_unscented_turn_is_that_of_a_plain_implementation() {
    let motion = turn(0.4, 0.05, Nonlinear::Unscented);
    let start = SVector::from([10.0, 8.0, 2.5, -0.5, 0.2]);
    let deviations = SVector::from([1.5, 1.5, 2.0, 2.0, 0.3]);
    let mut estimate = Estimate { state: start, covariance: SMatrix::from_diagonal(&deviations.map(|d| d * d)) };
    let sensor = Sensor::<5, 2>::first([1.5; 2]);
    let mut plain = Plain::of(&estimate);
    for place in PLACES {
        // 2 n + 1 points at √3 columns of L (Wan and van der Merwe 2000: α = 1, κ = 3 − n, so λ = −2; β = 2).
        let l = transposed(&cholesky(&plain.p));
        let far = 3.0_f64.sqrt();
        let mut points = vec![plain.x.clone()];
        for column in &l {
            for sign in [far, -far] {
                points.push(plain.x.iter().zip(column).map(|(x, l)| x + sign * l).collect());
            }
        }
        let weights = |center: f64| [vec![center], vec![1.0 / 6.0; 10]].concat();
        let (of_mean, of_spread) = (weights(-2.0 / 3.0), weights(-2.0 / 3.0 + 2.0));
        let moved: Vec<_> = points.iter().map(|point| turned(point)).collect();
        let mut predicted = Plain::of_points(&moved, [&of_mean, &of_spread]);
        predicted.p = sum(&predicted.p, &process_noise(5, 0.4, 0.05), 1.0);

        let prediction = estimate.predicted(&motion);
        assert!(predicted.off(&prediction.estimate) < 1e-9, "{predicted:?}");
        // The smoother's gain is the covariance of the state before and after times the inverse of the predicted one: C P⁺ = Ψ.
        let gain = smoothed(&estimate, &prediction, &prediction.estimate).expect("sound").gain;
        let crossed = gain * prediction.estimate.covariance;
        for (i, j) in (0..5).flat_map(|i| (0..5).map(move |j| (i, j))) {
            let terms = points.iter().zip(&moved).zip(&of_spread);
            let entry: f64 = terms.map(|((a, b), w)| w * (a[i] - plain.x[i]) * (b[j] - predicted.x[j])).sum();
            assert!((entry - crossed[(i, j)]).abs() < 1e-8, "{i}, {j}: {entry} and {}", crossed[(i, j)]);
        }
        let innovation = prediction.estimate.innovation(&sensor, &Vector2::from(place)).expect("sound");
        estimate = prediction.estimate.updated(&sensor, &innovation).estimate;
        let likelihood;
        (plain, likelihood) = predicted.updated(place, 1.5);
        assert!(plain.off(&estimate) < 1e-9, "{plain:?}");
        assert!((innovation.log_likelihood() - likelihood.ln()).abs() < 1e-9);
    }
}

#[test]
fn sigma_points_keep_the_curvature_that_a_jacobian_omits() {
    // 10 px/frame and a turn rate that is hardly known, against a hundred thousand drawn states.
    let state = SVector::from([0.0, 0.0, 10.0, 0.0, 0.3]);
    let deviations = SVector::from([0.5, 0.5, 1.0, 1.0, 0.5]);
    let estimate = Estimate { state, covariance: SMatrix::from_diagonal(&deviations.map(|d| d * d)) };
    let mut chance = Chance::new(7);
    let draw = |chance: &mut Chance| turned((state + deviations.map(|d| d * chance.normal())).as_slice());
    let drawn: Vec<_> = (0..100_000).map(|_| draw(&mut chance)).collect();
    let alike = vec![1e-5; drawn.len()];
    let truth = Plain::of_points(&drawn, [&alike, &alike]);
    let off = |prediction| {
        let found = estimate.predicted(&turn(0.0, 0.0, prediction)).estimate;
        let mean = (found.state[0] - truth.x[0]).hypot(found.state[1] - truth.x[1]);
        let entries = [(0, 0), (0, 1), (1, 0), (1, 1)];
        let spread: f64 = entries.iter().map(|(i, j)| (found.covariance[(*i, *j)] - truth.p[*i][*j]).powi(2)).sum();
        (mean, spread.sqrt())
    };
    let (extended, unscented) = (off(Nonlinear::Extended), off(Nonlinear::Unscented));
    assert!(unscented.0 < 0.05 && extended.0 > 5.0 * unscented.0, "means: {extended:?}, {unscented:?}");
    assert!(unscented.1 < 0.6 * extended.1, "covariances: {extended:?}, {unscented:?}");
}

/// The interacting multiple model of a textbook (Bar-Shalom, Li and Kirubarajan 2001, section 11.6.6), with the turn rate mixed as in
/// Yuan and others 2012.
struct Textbook {
    straight: Plain,
    turning: Plain,
    probabilities: [f64; 2],
}

/// The moments of two normal distributions with weights.
fn mixture(parts: [(f64, &Plain); 2]) -> Plain {
    let n = parts[0].1.x.len();
    let x: Vec<f64> = (0..n).map(|i| parts.iter().map(|(w, of)| w * of.x[i]).sum()).collect();
    let entry =
        |i: usize, j: usize| parts.iter().map(|(w, of)| w * (of.p[i][j] + (of.x[i] - x[i]) * (of.x[j] - x[j]))).sum();
    let p = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
    Plain { x, p }
}

fn first_four(of: &Plain) -> Plain {
    Plain { x: of.x[..4].to_vec(), p: of.p[..4].iter().map(|row| row[..4].to_vec()).collect() }
}

impl Textbook {
    fn step(&mut self, switch: f64, [straight, bent]: [f64; 2], rate_change: f64, place: [f64; 2]) {
        let transition = [[1.0 - switch, switch], [switch, 1.0 - switch]];
        let c: Vec<f64> = (0..2).map(|j| (0..2).map(|i| transition[i][j] * self.probabilities[i]).sum()).collect();
        let mu = |i: usize, j: usize| transition[i][j] * self.probabilities[i] / c[j];
        let mut with_rate = self.straight.clone();
        with_rate.x.push(self.turning.x[4]);
        with_rate.p.iter_mut().for_each(|row| row.push(0.0));
        with_rate.p.push(vec![0.0, 0.0, 0.0, 0.0, self.turning.p[4][4]]);
        let mixed = [
            mixture([(mu(0, 0), &self.straight), (mu(1, 0), &first_four(&self.turning))]),
            mixture([(mu(0, 1), &with_rate), (mu(1, 1), &self.turning)]),
        ];
        let f: Rows =
            (0..4).map(|i| (0..4).map(|j| f64::from(u8::from(i == j || (i < 2 && j == i + 2)))).collect()).collect();
        let x = product(&f, &mixed[0].x.iter().map(|x| vec![*x]).collect()).concat();
        let p = sum(&product(&product(&f, &mixed[0].p), &transposed(&f)), &process_noise(4, straight, 0.0), 1.0);
        // The Jacobian by central differences.
        let jacobian = transposed(
            &(0..5)
                .map(|j| {
                    let moved = |by: f64| {
                        let mut state = mixed[1].x.clone();
                        state[j] += by;
                        turned(&state)
                    };
                    moved(1e-5).iter().zip(moved(-1e-5)).map(|(a, b)| (a - b) / 2e-5).collect()
                })
                .collect(),
        );
        let noise = process_noise(5, bent, rate_change);
        let turning = Plain {
            x: turned(&mixed[1].x),
            p: sum(&product(&product(&jacobian, &mixed[1].p), &transposed(&jacobian)), &noise, 1.0),
        };
        let (straight, first) = Plain { x, p }.updated(place, 1.5);
        let (turning, second) = turning.updated(place, 1.5);
        let total = first * c[0] + second * c[1];
        *self = Self { straight, turning, probabilities: [first * c[0] / total, second * c[1] / total] };
    }
}

fn measured(place: [f64; 2]) -> Measurement {
    Measurement { place, place_deviation: 1.5, velocity: None }
}

fn interacting(acceleration: f64, rate_change: f64, switch: f64) -> Interacting {
    Interacting {
        velocity: Velocity { acceleration },
        turn: turn(acceleration, rate_change, Nonlinear::Extended),
        switch,
    }
}

#[test]
fn interacting_modes_are_those_of_a_textbook() {
    let model = interacting(0.4, 0.05, 0.1);
    let Filter::Interacting(_, mut modes) = Filter::begun(Model::Interacting(model), &measured([10.0, 8.0]), 5.0)
    else {
        panic!("modes");
    };
    // A turn rate of exactly 0 has no closed form in the plain implementation.
    modes.turn.state[4] = 0.05;
    let mut textbook = Textbook {
        straight: Plain::of(&modes.velocity),
        turning: Plain::of(&modes.turn),
        probabilities: modes.probabilities,
    };
    let mut filter = Filter::Interacting(model, modes);
    for place in PLACES {
        textbook.step(0.1, [0.4, 0.4], 0.05, place);
        filter = filter.predicted().updated(&measured(place)).expect("sound").0;
        let Filter::Interacting(_, modes) = filter else { panic!("modes") };
        let [velocity, turn] = modes.probabilities;
        assert!((velocity - textbook.probabilities[0]).abs() < 1e-6 && (velocity + turn - 1.0).abs() < 1e-12);
        assert!(textbook.straight.off(&modes.velocity) < 1e-6, "{:?}", textbook.straight);
        assert!(textbook.turning.off(&modes.turn) < 1e-6, "{:?}", textbook.turning);
        let parts = [
            (textbook.probabilities[0], &textbook.straight),
            (textbook.probabilities[1], &first_four(&textbook.turning)),
        ];
        assert!(mixture(parts).off(&modes.combined()) < 1e-6);
    }
}

/// Frames of a path that is straight, turns by 12° a frame, and is straight again.
const TURNING: std::ops::Range<usize> = 25..45;
const FRAMES: usize = 70;

/// The path, at 6 px/frame.
fn path() -> Vec<[f64; 2]> {
    let (mut place, mut heading) = ([60.0, 300.0], 0.0_f64);
    let step = |t: usize| {
        heading += if TURNING.contains(&t) { 12.0_f64.to_radians() } else { 0.0 };
        place = [place[0] + 6.0 * heading.cos(), place[1] + 6.0 * heading.sin()];
        place
    };
    (0..FRAMES).map(step).collect()
}

/// The error (RMS) of the estimates of a model over 100 seeds.
fn error(model: Model, path: &[[f64; 2]]) -> f64 {
    let mut sum = 0.0;
    for seed in 0..100 {
        let mut chance = Chance::new(seed);
        let mut noisy = |place: [f64; 2]| measured(place.map(|c| c + 1.5 * chance.normal()));
        let mut filter = Filter::begun(model, &noisy(path[0]), 10.0);
        for (t, place) in path.iter().enumerate().skip(1) {
            filter = filter.predicted().updated(&noisy(*place)).expect("sound").0;
            let [x, y] = filter.place();
            sum += if t > 5 { (x - place[0]).powi(2) + (y - place[1]).powi(2) } else { 0.0 };
        }
    }
    (sum / (100 * (path.len() - 6)) as f64).sqrt()
}

#[test]
fn interacting_modes_beat_each_of_their_models_on_a_path_that_turns_at_times() {
    let path = path();
    let (acceleration, rate_change) = (0.2, 3.0_f64.to_radians());
    let modes = error(Model::Interacting(interacting(acceleration, rate_change, 0.05)), &path);
    // Each alone has the same noise; constant velocity the one that is best for it, too.
    let turning = error(Model::Turn(turn(acceleration, rate_change, Nonlinear::Extended)), &path);
    let straight: Vec<f64> =
        [0.2, 0.5, 1.0, 1.5, 2.0].map(|acceleration| error(Model::Velocity(Velocity { acceleration }), &path)).into();
    let best = straight.iter().copied().fold(f64::INFINITY, f64::min);
    println!("modes {modes:.3} px, turn {turning:.3} px, velocity {straight:.3?} px");
    assert!(modes < 0.97 * turning && modes < 0.9 * best, "{modes:.3}, {turning:.3}, {straight:.3?}");
}

#[test]
fn a_small_probability_of_a_switch_reacts_late() {
    let path = path();
    let error = |switch| error(Model::Interacting(interacting(0.2, 3.0_f64.to_radians(), switch)), &path);
    let [late, early] = [error(1e-6), error(0.05)];
    assert!(late > 1.05 * early, "{late:.3} and {early:.3} px");
}

#[test]
fn neither_mode_fits_a_thrown_ball() {
    let path: Vec<[f64; 2]> =
        (0..30).map(|t| [8.0 * f64::from(t), 200.0 - 15.0 * f64::from(t) + 0.6 * f64::from(t * t)]).collect();
    let modes = error(Model::Interacting(interacting(0.1, 1.0_f64.to_radians(), 0.05)), &path);
    let acceleration = error(Model::Acceleration(Acceleration { change: 0.1 }), &path);
    assert!(modes > 1.5 * acceleration, "{modes:.3} and {acceleration:.3} px");
}

/// A clip of detections along the path.
fn clip() -> Clip {
    let mut chance = Chance::new(3);
    let found = |place: [f64; 2]| {
        let center = place.map(|c| (c + 1.5 * chance.normal()) as f32);
        vec![Detection {
            bounds: Bounds::around(center, [12.0; 2]),
            center,
            score: 1.0,
            blob: None,
            deviation_px: None,
        }]
    };
    let frames: Vec<_> = path().into_iter().map(found).collect();
    Clip::blank("path", (640, 480), frames.len()).with_detections(frames)
}

/// With a gate of 0.99 the first frames of so sharp a turn may be rejected, and the track with them.
const SETTINGS: [(&str, &str); 4] =
    [("process-noise", "0.2"), ("turn-noise", "3"), ("measurement-noise", "1.5"), ("gate", "0.9999")];

/// What the steps of a run show.
fn steps(motion: &str, mut look: impl FnMut(&dyn Walk)) {
    let mut walk =
        set("kalman-filter", &[&SETTINGS[..], &[("motion", motion)]].concat()).walk(&clip(), 0).expect("a run");
    let step = walk.info().granularities.len() - 1;
    while !walk.at_end() {
        walk.jump(Move::Granularity(step, Direction::Forward));
        look(&*walk);
    }
}

fn readouts<T>(walk: &dyn Walk, of: impl Fn(Readout) -> Option<T>) -> Vec<T> {
    walk.step(None).readouts.into_iter().filter_map(of).collect()
}

#[test]
fn the_probabilities_of_the_modes_are_plotted_and_follow_the_path() {
    let (mut last, mut matrices, mut told): (Vec<Series>, Vec<Matrix>, String) = Default::default();
    steps("imm", |walk| {
        last = readouts(walk, |readout| if let Readout::Series(series) = readout { Some(series) } else { None });
        let all = readouts(walk, |readout| if let Readout::Matrices(all) = readout { Some(all) } else { None });
        matrices.extend(all.into_iter().flatten().filter(|matrix| ["M", "Π", "μ"].contains(&matrix.symbol)));
        told += &walk.step(None).sentence.plain();
    });
    let plot = last.iter().find(|series| series.title == "Mode probabilities").expect("it is plotted");
    let turn = &plot.lines.iter().find(|(name, ..)| *name == "coordinated turn").expect("a line").2;
    let mean = |frames: std::ops::Range<usize>| {
        let values: Vec<f32> = turn[frames].iter().map(|point| point[1]).collect();
        values.iter().sum::<f32>() / values.len() as f32
    };
    assert_eq!(turn.len(), FRAMES);
    let (before, inside) = (mean(10..25), mean(30..45));
    assert!(inside > 0.7 && before < 0.4, "{before} before the turn, {inside} in it");
    // Weights of the mixing and transitions have columns or rows of the sum 1.
    for symbol in ["M", "Π", "μ"] {
        let of: Vec<_> = matrices.iter().filter(|matrix| matrix.symbol == symbol).collect();
        assert!(of.len() >= FRAMES - 1, "{symbol}");
        assert!(
            of.iter().all(|matrix| (matrix.entries[(0, 0)] + matrix.entries[(0, 1)] - 1.0).abs() < 1e-9),
            "{symbol}"
        );
    }
    assert!(!told.contains("Smoothing frame") && told.contains("the more probable mode in"), "no smoothing: {told}");
}

#[test]
fn sigma_points_are_drawn_and_moved() {
    let mut counts = Vec::new();
    let mut told = String::new();
    steps("unscented-turn", |walk| {
        let scene = walk.scene(None);
        let has = |role, meaning| scene.legend.contains(&(role, meaning));
        counts.push((has(Role::Candidate, "sigma points"), has(Role::Window, "moved sigma points")));
        told += &walk.step(None).sentence.plain();
    });
    let with = |of: (bool, bool)| counts.iter().filter(|both| **both == of).count();
    assert_eq!((with((true, false)), with((true, true))), (FRAMES - 1, FRAMES - 1));
    assert!(told.contains("11 sigma points") && told.contains("moved the predicted mean by up to"), "{told}");
}

/// The symbols of the matrices and the formulas of the steps at a line.
fn shown(motion: &str, line: &str) -> Vec<(Vec<&'static str>, String)> {
    let mut all = Vec::new();
    steps(motion, |walk| {
        let step = walk.step(None);
        let formulas: Vec<String> = step.formulas().iter().map(|line| line.plain()).collect();
        assert!(formulas.iter().all(|line| !line.contains(['\\', '{'])), "{formulas:?}");
        let matrices = readouts(walk, |readout| if let Readout::Matrices(all) = readout { Some(all) } else { None });
        if step.line.as_str() == line {
            all.push((matrices.concat().iter().map(|matrix| matrix.symbol).collect(), formulas.join("\n")));
        }
    });
    assert!(all.len() >= FRAMES - 2, "{line}: {}", all.len());
    all
}

#[test]
fn sigma_points_are_those_of_the_estimate_and_have_a_regression_instead_of_a_jacobian() {
    for (symbols, formulas) in shown("unscented-turn", "draw") {
        assert_eq!(symbols, ["x", "P"], "no prediction yet");
        assert!(formulas.contains("w_0 = 1 − (n)/(c^2) = 1 − (5)/(3) = −0.667"), "{formulas}");
        assert!(formulas.contains("w_0^(c) = w_0 + β = −0.667 + 2 = 1.333"), "{formulas}");
    }
    for (symbols, formulas) in shown("unscented-turn", "predict") {
        assert_eq!(symbols, ["x⁻", "P⁻", "A", "Q"]);
        assert!(formulas.contains("A = Σ_i") && !formulas.contains('F'), "{formulas}");
    }
}

#[test]
fn modes_are_combined_after_their_probabilities() {
    for (symbols, _) in shown("imm", "update") {
        assert_eq!(symbols, ["x₁", "P₁", "K₁", "x₂", "P₂", "K₂"]);
    }
    for (symbols, _) in shown("imm", "weigh-modes") {
        assert!(["x", "P", "μ"].iter().all(|symbol| symbols.contains(symbol)), "{symbols:?}");
    }
}

#[test]
fn runs_of_modes_and_of_sigma_points_follow_the_object() {
    let path = path();
    for motion in ["imm", "unscented-turn"] {
        let filter = set("kalman-filter", &[&SETTINGS[..], &[("motion", motion)]].concat());
        let output = filter.run(&clip(), 0, &Threads::single()).expect("a run");
        let field = output.get::<ObjectField>().expect("objects");
        let off = field.frames.iter().zip(&path).skip(6).map(|(frame, place)| {
            let [x, y] = frame.objects[0].position;
            (x - place[0]).hypot(y - place[1])
        });
        let off: Vec<f64> = off.collect();
        let mean = off.iter().sum::<f64>() / off.len() as f64;
        // The measurements are 1.88 px off on average.
        assert!(mean < 1.88, "{motion}: {mean:.2} px");
    }
}
