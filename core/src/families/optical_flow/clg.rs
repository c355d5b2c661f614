//! The combined local-global method (CLG): a windowed data term with a global smoothness term.

use std::sync::OnceLock;

use crate::base::Threads;
use crate::geometry::filter;
use crate::methods::{
    differential::{Advice, Field, Linear, explain, numbers, relax},
    variational::{Explanation, Local, Model, MotionTensor, Probe, Settings, Solver, Warp},
};
use crate::run::{Guarantee, Info};
use crate::scene::{Constraint, Fact, Math, Name, Question, Reply, Role, Sentence};
use crate::{cases, params, pseudocode};

params! {
    /// The combined local-global method (CLG), which minimises the energy ∫∫ (w, 1) · T (w, 1) + α² (|∇u|² + |∇v|²), w = (u, v).
    /// T is the motion tensor, smoothed by a Gaussian of ρ px: α = 0 gives Lucas–Kanade, ρ = 0 gives Horn–Schunck.
    pub struct Clg {
        /// Regularisation weight α, in gray levels per px. Larger values give smoother flow and fill areas without texture; where |∇I| = α, data term and smoothness term weigh equally.
        alpha: f32 = 8.0, 0.1..=1000.0;
        /// Standard deviation ρ of the Gaussian window that averages the gradient constraints around each pixel. Larger values suppress noise but blur motion boundaries; 0 is Horn–Schunck. The image border is mirrored.
        rho: f32 = 1.0, 0.0..=10.0, "px";
        /// Iterative solver of the linear system.
        solver: Solver = Solver::Sor;
        /// Relaxation factor ω of SOR; the other solvers ignore it. 1 is Gauss–Seidel, and SOR diverges from 2 on.
        relaxation: f32 = 1.9, 1.0..=1.99;
        /// Parameters that all variational methods share.
        settings: Settings = Settings { iterations: 20, levels: 4, warps: 3, sigma: 0.5, ..Settings::default() };
    }
    renamed { "smoothing" => "sigma" }
    when {
        "relaxation": |p| p.solver == Solver::Sor, "Relaxation has no effect unless the solver is SOR.";
    }
}

/// The step of an iteration that computes the neighbourhood mean.
const AVERAGED: usize = 0;
/// The step of SOR that extrapolates the update.
const EXTRAPOLATED: usize = 2;

/// The coefficients of a warp.
pub struct System {
    solutions: Local,
    /// The motion tensors, computed when they are explained.
    tensor: OnceLock<MotionTensor>,
}

cases! {
    ADVISE_TEXTURE: "A larger α and more iterations carry flow in from textured neighbours.",
    ADVISE_BOUNDARY: "Window and smoothness term blur the boundary; smaller ρ and α or TV-L1 keep it sharper.",
    ADVISE_MOTION: "More pyramid levels and warps would reach this motion.",
}

pseudocode! {
    ENERGY: "E(u, v) = ∫∫ (w, 1) · T (w, 1) + α² (|∇u|² + |∇v|²), where w = (u, v)",
    EACH_LEVEL: "(u, v) ← 0; for each pyramid level, from the coarsest to full resolution",
    EACH_WARP: "  for each warp",
    TAKE_MEDIANS: "    (u₀, v₀) ← 3×3 median filter of (u, v); not before the very first warp",
    WARP: "    warp frame t+1 toward frame t by (u₀, v₀); I_x, I_y, I_t ← derivatives; T ← their products, smoothed by a Gaussian of ρ px",
    EACH_ITERATION: "    for each iteration",
    AVERAGE: "      for each pixel: (ū, v\u{304}) ← weighted mean of its eight neighbours (newest values unless Jacobi)",
    SOLVE: "        w solves (T + α² I) w = α² (ū, v\u{304}) + T (u₀, v₀) − (T_xt, T_yt)",
    EXTRAPOLATE: "        (u, v) ← (u, v) + ω (w − (u, v)); ω = 1 unless SOR",
}

impl Model for Clg {
    const INFO: Info = Info {
        id: "clg",
        name: "Combined local-global",
        family: "Optical flow",
        summary: "Dense optical flow from windowed gradient constraints, as in Lucas–Kanade, and a global smoothness term, as in Horn–Schunck.",
        source: "A. Bruhn, J. Weickert and C. Schnörr, Lucas/Kanade meets Horn/Schunck: combining local and global optic flow \
                 methods, International Journal of Computer Vision 61(3), 2005; medians: D. Sun, S. Roth and M. J. Black, \
                 Secrets of optical flow estimation and their principles, CVPR 2010",
        pseudocode: line::ALL,
        granularities: &["frame", "level", "warp", "iteration", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[Question::choice(
        "term",
        "Which term dominates the update of the pixel?",
        &[
            Reply::says(line::SOLVE, "the data term dominates", "The data term"),
            Reply::says(line::SOLVE, "the smoothness term dominates", "The smoothness term"),
        ],
    )
    .once_per_reference()];
    const GUARANTEE: Guarantee = Guarantee::SubPixel { off_centi_px: 5 };
    const ENERGY_UNIT: &'static str = "gray levels²";
    const OPENING: &'static str = "The data term averages the squared gradient constraints over a Gaussian window of standard \
                                   deviation ρ; the smoothness term is the sum of the squared gradients of u and v, weighted by \
                                   α². The window suppresses noise; the smoothness term fills areas without texture.";
    const ADVICE: Advice =
        Advice { texture: case::ADVISE_TEXTURE, boundary: case::ADVISE_BOUNDARY, motion: case::ADVISE_MOTION };
    const SYSTEM_PARTS: usize = 5;
    const NEED: [f64; 2] = [112.0, 220.0];
    type System = System;
    type Unknowns = Field;

    fn settings(&self) -> Settings {
        self.settings
    }

    fn steps(&self) -> &'static [Name] {
        self.solver.steps(&[line::AVERAGE, line::SOLVE, line::EXTRAPOLATE])
    }

    fn last_formula(&self) -> &'static str {
        self.solver.last_formula()
    }

    fn system(&self, linear: &Linear, threads: &Threads) -> System {
        let tensor = MotionTensor::new(linear, self.rho, threads);
        let relaxation = self.solver.relaxation(self.relaxation);
        System { solutions: Local::new(&tensor, self.alpha, relaxation, threads), tensor: OnceLock::new() }
    }

    fn iterate(&self, warp: &Warp<Self>, from: &Field, count: usize, threads: &Threads) -> Field {
        warp.system.solutions.iterate(from, count, threads)
    }

    fn energy(&self, warp: &Warp<Self>, at: &Field) -> [f64; 2] {
        [self.tensor(warp).energy(at), f64::from(self.alpha).powi(2) * relax::roughness(at)]
    }

    fn explanation(&self, step: usize, probe: &Probe<Self>) -> Explanation {
        let mean = self.solver.mean_of(probe);
        let tensor = self.tensor(&probe.iteration.warp).at(probe.place);
        let update = solution(tensor, self.alpha * self.alpha, mean);
        let before = ("mean", Role::Predicted, mean);
        // The result of the update is not known before it.
        let (sentence, equation, points) = match step {
            AVERAGED => (probe.averaged(self.solver, mean), probe.averages(mean), vec![before]),
            EXTRAPOLATED => (
                probe.extrapolated(update, self.relaxation),
                probe.relaxed(update, self.relaxation),
                vec![("Gauss–Seidel", Role::Predicted, update), ("after", Role::Result, probe.to())],
            ),
            _ => (
                self.updated(probe, tensor[0] + tensor[2], update),
                self.equation(tensor, (mean, update), probe),
                vec![before, (self.solver.update_name(), Role::Result, update)],
            ),
        };
        let [xx, xy, yy, xt, yt] = about_zero(tensor, probe.start().unwrap_or_default()).map(numbers::gray);
        Explanation {
            sentence,
            facts: vec![
                Fact::new("T_xx, T_xy, T_yy", format!("{xx}, {xy}, {yy}"), None),
                Fact::new("T_xt, T_yt", format!("{xt}, {yt}"), None),
            ],
            equation,
            points,
            lines: self.lines(probe),
            energy: Some(Box::new(energy(tensor, self.alpha * self.alpha, mean))),
        }
    }
}

impl Clg {
    fn tensor<'a>(&self, warp: &'a Warp<Self>) -> &'a MotionTensor {
        warp.system.tensor.get_or_init(|| MotionTensor::new(&warp.linear, self.rho, &Threads::single()))
    }

    fn updated(&self, probe: &Probe<Self>, trace: f32, update: [f32; 2]) -> Sentence {
        let weight = self.alpha * self.alpha;
        let window = if self.rho > 0.0 {
            format!(
                "Least squares combines the gradient constraints in the Gaussian window (ρ = {} px) of ",
                numbers::gray(self.rho)
            )
        } else {
            "Least squares combines the gradient constraint of ".into()
        };
        let said = Sentence::default().text(window).ink(Role::Reference, probe.pixel()).text(format!(
            " with the neighbourhood mean. tr T = {} against α² = {}, so the {} dominates: (u, v) = ",
            numbers::gray(trace),
            numbers::gray(weight),
            if trace > weight { "data term" } else { "smoothness term" }
        ));
        said.ink(Role::Result, probe.px(update)).text(".")
    }

    /// Returns the normal equations of the pixel, in symbols and with numbers.
    fn equation(&self, tensor: [f32; 6], (mean, update): ([f32; 2], [f32; 2]), probe: &Probe<Self>) -> Vec<Math> {
        let (weight, [xx, xy, yy, xt, yt, _]) = (self.alpha * self.alpha, tensor);
        let mut lines = probe.start().map(|start| definitions(tensor, start).to_vec()).unwrap_or_default();
        lines.extend(symbols(probe.start().is_some()));
        lines.push(numbers([xx + weight, xy], weight, mean[0], xt));
        lines.push(numbers([xy, yy + weight], weight, mean[1], yt));
        let named = if self.solver == Solver::Sor { "(u, v) by Gauss–Seidel = " } else { "(u, v) = " };
        lines.push(Math::Row(vec![Math::text(named), Math::ink(Role::Result, numbers::vector(update))]));
        lines
    }

    /// Returns the constraint lines of the window by their weights; a subset for large windows.
    fn lines(&self, probe: &Probe<Self>) -> Vec<Constraint> {
        let Linear { factors, start } = &probe.iteration.warp.linear;
        let (width, height) = start.u.size();
        let (x, y) = probe.place;
        let [u, v] = start.at(x, y);
        let weights = filter::gaussian(self.rho);
        let reach = weights.len() as isize / 2;
        let apart = (reach as usize / 4).max(1);
        let along = || (-(reach / apart as isize)..=reach / apart as isize).map(|i| i * apart as isize);
        let places = along().flat_map(|j| along().map(move |i| (i, j))).filter_map(|(i, j)| {
            let place = (x.checked_add_signed(i)?, y.checked_add_signed(j)?);
            let weight = |k: isize| weights[(k + reach) as usize] / weights[reach as usize];
            (place.0 < width && place.1 < height).then(|| (place, weight(i) * weight(j)))
        });
        let line = |(place, weight): ((usize, usize), f32)| {
            let ([a, b, c], [other_u, other_v]) = (factors.at(place), start.at(place.0, place.1));
            // The increment there, added to the flow here.
            explain::line([a, b, c + a * (other_u - u) + b * (other_v - v)], weight, Role::Candidate)
        };
        places.filter_map(line).collect()
    }
}

/// The solution of (T + α² I) (u, v) = α² (ū, v̄) − (xt, yt).
fn solution([xx, xy, yy, xt, yt, _]: [f32; 6], weight: f32, mean: [f32; 2]) -> [f32; 2] {
    let (a, d, e, f) = (xx + weight, yy + weight, weight * mean[0] - xt, weight * mean[1] - yt);
    let det = a * d - xy * xy;
    [(e * d - xy * f) / det, (a * f - xy * e) / det]
}

/// The energy of a pixel's flow while its neighbours stay, up to a constant: its minimum is the [`solution`].
fn energy([xx, xy, yy, xt, yt, tt]: [f32; 6], weight: f32, mean: [f32; 2]) -> impl Fn([f32; 2]) -> f32 {
    move |[u, v]| {
        let data = xx * u * u + 2.0 * xy * u * v + yy * v * v + 2.0 * (xt * u + yt * v) + tt;
        data + weight * ((u - mean[0]).powi(2) + (v - mean[1]).powi(2))
    }
}

/// T_xx, T_xy, T_yy, T_xt and T_yt for the increment to `start`; those of a [`MotionTensor`] are for the whole flow.
fn about_zero([xx, xy, yy, xt, yt, _]: [f32; 6], [u, v]: [f32; 2]) -> [f32; 5] {
    [xx, xy, yy, xt + xx * u + xy * v, yt + xy * u + yy * v]
}

fn part(along: &'static str) -> Math {
    Math::indexed(Math::Var("T"), Math::Var(along))
}

/// c_x and c_y, which replace T_xt and T_yt after warping by `start`, in symbols and numbers.
fn definitions(tensor: [f32; 6], start: [f32; 2]) -> [Math; 2] {
    let [xx, xy, yy, xt, yt] = about_zero(tensor, start);
    let [u, v] = start.map(|component| numbers::factor(numbers::px(component)));
    let zero = |name| Math::indexed(Math::Var(name), Math::text("0"));
    let line = |[to, t, first, second]: [&'static str; 4], [total, a, b, rest]: [f32; 4]| {
        let product = |factor: f32, by: &str| {
            [Math::text(" − "), Math::text(format!("{} · {by}", numbers::factor(numbers::gray(factor))))]
        };
        let mut row = vec![
            Math::indexed(Math::Var("c"), Math::Var(to)),
            Math::text(" = "),
            part(t),
            Math::text(" − "),
            part(first),
            Math::text(" "),
            zero("u"),
            Math::text(" − "),
            part(second),
            Math::text(" "),
            zero("v"),
            Math::text(" = "),
            Math::text(numbers::gray(total)),
        ];
        row.extend(product(a, &u).into_iter().chain(product(b, &v)));
        row.extend([Math::text(" = "), Math::ink(Role::Reference, numbers::gray(rest))]);
        Math::Row(row)
    };
    [line(["x", "xt", "xx", "xy"], [xt, xx, xy, tensor[3]]), line(["y", "yt", "xy", "yy"], [yt, xy, yy, tensor[4]])]
}

/// The normal equations in symbols; after warping (`is_about`), c_x and c_y replace T_xt and T_yt.
fn symbols(is_about: bool) -> [Math; 2] {
    let squared = || Math::power(Math::Var("α"), Math::text("2"));
    let time = |t: &'static str, c: &'static str| {
        if is_about { Math::indexed(Math::Var("c"), Math::Var(c)) } else { part(t) }
    };
    let right = |name: &'static str, time: Math| {
        let mean = Math::mean(Math::Var(name));
        Math::Row(vec![Math::text(" = "), squared(), Math::text(" "), mean, Math::text(" − "), time])
    };
    let with_weight = |along: &'static str| {
        Math::Row(vec![Math::text("("), part(along), Math::text(" + "), squared(), Math::text(") ")])
    };
    let mixed = || Math::Row(vec![part("xy"), Math::text(" ")]);
    let row =
        |first, second, right| Math::Row(vec![first, Math::Var("u"), Math::text(" + "), second, Math::Var("v"), right]);
    [
        row(with_weight("xx"), mixed(), right("u", time("xt", "x"))),
        row(mixed(), with_weight("yy"), right("v", time("yt", "y"))),
    ]
}

/// One normal equation in numbers.
fn numbers([a, b]: [f32; 2], weight: f32, mean: f32, t: f32) -> Math {
    Math::Row(vec![
        Math::text(format!("{} ", numbers::gray(a))),
        Math::Var("u"),
        Math::text(format!(" {} ", numbers::summand(numbers::gray(b)))),
        Math::Var("v"),
        Math::text(format!(" = {} · ", numbers::gray(weight))),
        Math::ink(Role::Predicted, numbers::factor(numbers::px(mean))),
        Math::text(format!(" {}", numbers::summand(numbers::gray(-t)))),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solution_is_the_minimum_of_the_energy() {
        let (tensor, weight, mean) = ([150.0, -40.0, 30.0, 210.0, -75.0, 400.0], 49.0, [0.8, -0.4]);
        let (energy, to) = (energy(tensor, weight, mean), solution(tensor, weight, mean));
        for [du, dv] in [[0.05, 0.0], [-0.05, 0.0], [0.0, 0.05], [0.0, -0.05], [0.04, 0.04], [-0.04, 0.04]] {
            assert!(energy(to) < energy([to[0] + du, to[1] + dv]), "({du}, {dv})");
        }
        assert!(energy(to) < energy(mean));
    }
}
