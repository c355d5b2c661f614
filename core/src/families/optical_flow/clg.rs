//! The combined local-global method (CLG): a windowed data term with a global smoothness term.

use std::sync::OnceLock;

use crate::base::Threads;
use crate::geometry::filter;
use crate::methods::{
    differential::{Advice, Field, Linear, explain, relax},
    variational::{
        Explanation, Local, Model, MotionTensor, PixelUpdate, Probe, Settings, Solver, Warp, value as variational,
    },
};
use crate::run::{Guarantee, Info};
use crate::scene::{Case, Constraint, Name, Question, Reply, Role, Step, Unit};
use crate::{cases, params, pseudocode, variables};

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
    when {
        "relaxation": |p| p.solver == Solver::Sor, "Relaxation has no effect unless the solver is SOR.";
    }
}

/// The coefficients of a warp.
pub struct System {
    solutions: Local,
    /// The motion tensors, computed when they are explained.
    tensor: OnceLock<MotionTensor>,
}

variables! {
    /// The spatial part of the motion tensor of the pixel.
    TENSOR: "T_xx, T_xy, T_yy", "(T_{xx}, T_{xy}, T_{yy})", Unit::FINE;
    /// The temporal part of the motion tensor of the pixel, about the flow of the linearisation.
    TEMPORAL_TENSOR: "T_xt, T_yt", "(T_{xt}, T_{yt})", Unit::FINE;
    /// The temporal part of the motion tensor about zero flow.
    CONSTANT_TERMS: "", "(c_x, c_y)", Unit::FINE, Role::Reference;
    /// The trace of the spatial part.
    TRACE: "", r"\text{tr }T", Unit::FINE;
    /// The diagonal of the normal equations.
    DIAGONAL: "", r"(T_{xx} + \alpha^2, T_{yy} + \alpha^2)", Unit::FINE;
    /// The standard deviation of the window.
    RHO: "", r"\rho", Unit::PX;
}

cases! { over value, explain::value, variational;
    OPENING: "The data term averages the squared gradient constraints over a Gaussian window of standard deviation ρ; the \
              smoothness term is the sum of the squared gradients of u and v, weighted by α². The window suppresses noise; \
              the smoothness term fills areas without texture.",
    WINDOW: "Least squares combines the gradient constraints in the Gaussian window (ρ = {rho}) of {reference|pixel} {pixel} with the \
             neighbourhood mean.",
    ONE_CONSTRAINT: "Least squares combines the gradient constraint of {reference|pixel} {pixel} with the neighbourhood mean.",
    DATA_DOMINATES: "tr T = {trace} against α² = {alpha_squared}, so the data term dominates: (u, v) = {update}.",
    SMOOTHNESS_DOMINATES: "tr T = {trace} against α² = {alpha_squared}, so the smoothness term dominates: (u, v) = {update}.",
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
            Reply::told(line::SOLVE, case::DATA_DOMINATES, "The data term"),
            Reply::told(line::SOLVE, case::SMOOTHNESS_DOMINATES, "The smoothness term"),
        ],
    )
    .once_per_reference()];
    const GUARANTEE: Guarantee = Guarantee::SubPixel { off_centi_px: 5 };
    const ENERGY_UNIT: &'static str = "gray levels²";
    const OPENING: &'static Case = case::OPENING;
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

    fn explanation(&self, index: usize, probe: &Probe<Self>, step: Step) -> Explanation {
        let mean = self.solver.mean_of(probe);
        let tensor = self.tensor(&probe.iteration.warp).at(probe.place);
        let update = solution(tensor, self.alpha * self.alpha, mean);
        let [xx, xy, yy, xt, yt] = about_zero(tensor, probe.start().unwrap_or_default());
        let step = step.fact(value::TENSOR, [xx, xy, yy]).fact(value::TEMPORAL_TENSOR, [xt, yt]);
        let found = PixelUpdate { mean, to: update, relaxation: self.relaxation };
        let (step, points) = self
            .solver
            .explain((index, step), probe, found, |step| self.tell_update(step, probe.start().is_some(), tensor));
        Explanation {
            step,
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

    /// Tells which term dominates the update, and writes the normal equations in symbols and numbers; after warping,
    /// c_x and c_y replace T_xt and T_yt.
    fn tell_update(&self, step: Step, is_warped: bool, [xx, _, yy, xt, yt, _]: [f32; 6]) -> Step {
        let (weight, trace) = (self.alpha * self.alpha, xx + yy);
        let step = step.put(variational::ALPHA_SQUARED, weight).put(value::TRACE, trace).put(value::RHO, self.rho);
        let step = step.put(value::DIAGONAL, [xx + weight, yy + weight]).put(value::CONSTANT_TERMS, [xt, yt]);
        let step = step.say(if self.rho > 0.0 { case::WINDOW } else { case::ONE_CONSTRAINT });
        let step = step.say(if trace > weight { case::DATA_DOMINATES } else { case::SMOOTHNESS_DOMINATES });
        let step = match is_warped {
            true => step
                .formula("c_x = T_{xt} - T_{xx} u_0 - T_{xy} v_0")
                .formula(r"= {temporal_tensor:1} - {tensor:1} \cdot {start:1} - {tensor:2} \cdot {start:2} = {constant_terms:1}")
                .formula("c_y = T_{yt} - T_{xy} u_0 - T_{yy} v_0")
                .formula(r"= {temporal_tensor:2} - {tensor:2} \cdot {start:1} - {tensor:3} \cdot {start:2} = {constant_terms:2}"),
            false => step,
        };
        let [x, y] = if is_warped { ["c_x", "c_y"] } else { ["T_{xt}", "T_{yt}"] };
        step.formula(format!(r"(T_{{xx}} + \alpha^2) u + T_{{xy}} v = \alpha^2 \bar{{u}} - {x}"))
            .formula(format!(r"T_{{xy}} u + (T_{{yy}} + \alpha^2) v = \alpha^2 \bar{{v}} - {y}"))
            .formula(r"{diagonal:1} u {tensor:2:signed} v = {alpha_squared} \cdot {neighbourhood_mean:1} - {constant_terms:1}")
            .formula(r"{tensor:2} u {diagonal:2:signed} v = {alpha_squared} \cdot {neighbourhood_mean:2} - {constant_terms:2}")
            .formula(format!("(u, v){} = {{update}}", self.solver.index()))
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
