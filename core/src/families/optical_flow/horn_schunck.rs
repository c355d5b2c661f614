//! Horn and Schunck's method: gradient constraints with a global smoothness term.

use crate::base::Threads;
use crate::base::words::{further_digits, rounded};
use crate::methods::{
    differential::{Advice, FLAT, Field, Linear, explain, numbers, relax},
    variational::{
        Explanation, Model, PixelUpdate, Probe, Settings, Solver, Warp, case as shared, value as variational,
    },
};
use crate::run::{Guarantee, Info};
use crate::scene::{Case, Name, Question, Reply, Role, Step, Unit, Value};
use crate::{cases, params, pseudocode, variables};

params! {
    /// Horn and Schunck's method, which minimises the energy ∫∫ (I_x u + I_y v + I_t)² + α² (|∇u|² + |∇v|²).
    /// Course notes that multiply the smoothness term by (I_x² + I_y²) are misprinted: it has the same weight everywhere.
    /// Discretised by the weighted differences to the eight neighbours, |∇u|² is three times as large; as in the paper the factor 3
    /// is absorbed, so α² acts as α²/3. One level, one warp, sigma 0, the 2×2×2 cube and the Jacobi solver with 100 iterations give the method of the paper.
    pub struct HornSchunck {
        /// Regularisation weight α, in gray levels per px. Larger values give smoother flow and fill areas without texture; where |∇I| = α, data term and smoothness term weigh equally.
        alpha: f32 = 8.0, 0.1..=1000.0;
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

variables! {
    /// The squared magnitude of the image gradient at the pixel.
    SQUARED_GRADIENT: "", r"|\nabla I|^2", Unit::FINE;
    /// The residual of the gradient constraint at the neighbourhood mean.
    RESIDUAL: "", r"\rho(\bar{u}, \bar{v})", Unit::GRAY;
    /// The size of that residual.
    VIOLATION: "", r"|\rho(\bar{u}, \bar{v})|", Unit::GRAY;
    /// The sum of the squared gradient and the squared regularisation weight.
    WEIGHT: "", r"\alpha^2 + |\nabla I|^2", Unit::FINE;
    /// The share of the way from the neighbourhood mean to the constraint line that the update covers.
    SHARE: "", "", Unit::WHOLE_PERCENT;
}

cases! { over value, explain::value, variational;
    OPENING: "The data term is the squared violation of the gradient constraint; the smoothness term is the sum of the \
              squared gradients of u and v, weighted by α². Without image gradient the smoothness term alone determines \
              the flow.",
    ONLY_SMOOTHNESS: "Only the smoothness term counts:",
    NO_GRADIENT: "{reference|pixel} {pixel} has no gradient, so any flow satisfies its constraint.",
    UNKNOWN: "{reference|pixel} {pixel} has no constraint, because (u₀, v₀) leads out of frame t+1.",
    TAKES_MEAN: "The update takes the neighbourhood mean: (u, v) = {update}.",
    SATISFIED: "The neighbourhood mean satisfies the gradient constraint of {reference|pixel} {pixel} to within 0.01 gray levels, so the \
                update keeps it: (u, v) = {update}.",
    VIOLATED: "The neighbourhood mean violates the gradient constraint of {reference|pixel} {pixel} by {violation}. With |∇I|² = \
               {squared_gradient} against α² = {alpha_squared}, the update covers",
    COVERS: "{share} of the way to the constraint line: (u, v) = {update}.",
    COVERS_LITTLE: "less than 1 % of the way to the constraint line: (u, v) = {update}.",
    ADVISE_TEXTURE: "A larger α and more iterations carry flow in from textured neighbours.",
    ADVISE_BOUNDARY: "The quadratic smoothness term blurs the boundary; a smaller α or TV-L1 keeps it sharper.",
    ADVISE_MOTION: "More pyramid levels and warps would reach this motion.",
}

pseudocode! {
    ENERGY: "E(u, v) = ∫∫ (I_x u + I_y v + I_t)² + α² (|∇u|² + |∇v|²)",
    EACH_LEVEL: "(u, v) ← 0; for each pyramid level, from the coarsest to full resolution",
    EACH_WARP: "  for each warp",
    TAKE_MEDIANS: "    (u₀, v₀) ← 3×3 median filter of (u, v); not before the very first warp",
    WARP: "    warp frame t+1 toward frame t by (u₀, v₀); I_x, I_y, I_t ← derivatives; c ← I_t − I_x u₀ − I_y v₀",
    EACH_ITERATION: "    for each iteration",
    AVERAGE: "      for each pixel: (ū, v\u{304}) ← weighted mean of its eight neighbours (newest values unless Jacobi)",
    UPDATE: "        (u_GS, v_GS) ← (ū, v\u{304}) − ∇I (I_x ū + I_y v\u{304} + c) / (α² + |∇I|²)",
    EXTRAPOLATE: "        (u, v) ← (u, v) + ω ((u_GS, v_GS) − (u, v)); ω = 1 unless SOR",
}

/// The end of the run tells its result instead of the update.
const CONCLUDED: &[&Case] = &[shared::FORMULA];

impl Model for HornSchunck {
    const INFO: Info = Info {
        id: "horn-schunck",
        name: "Horn–Schunck",
        family: "Optical flow",
        summary: "Dense optical flow from gradient constraints and a quadratic smoothness term, minimised over the whole image.",
        source: "B. K. P. Horn and B. G. Schunck, Determining optical flow, Artificial Intelligence 17, 1981; pyramid and \
                 warping: E. Meinhardt-Llopis, J. Sánchez and D. Kondermann, Horn–Schunck optical flow with a multi-scale \
                 strategy, Image Processing On Line 3, 2013; medians: D. Sun, S. Roth and M. J. Black, Secrets of optical flow \
                 estimation and their principles, CVPR 2010; SOR: D. M. Young, Iterative solution of large linear systems, Academic Press, 1971",
        pseudocode: line::ALL,
        granularities: &["frame", "level", "warp", "iteration", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::value(
            "share",
            "How much of the way from the neighbourhood mean to the constraint line does the update cover?",
            line::UPDATE,
            value::SHARE,
        )
        .unless_told(CONCLUDED)
        .once_per_reference(),
        Question::choice(
            "term",
            "Which term dominates the update of the pixel?",
            &[
                Reply::above(line::UPDATE, (value::SHARE, 50.0), "The data term"),
                Reply::told(line::UPDATE, case::VIOLATED, "The smoothness term"),
                Reply::told(line::UPDATE, case::ONLY_SMOOTHNESS, "The smoothness term"),
            ],
        )
        .unless_told(CONCLUDED)
        .once_per_reference(),
    ];
    const GUARANTEE: Guarantee = Guarantee::SubPixel { off_centi_px: 5 };
    const ENERGY_UNIT: &'static str = "gray levels²";
    const OPENING: &'static Case = case::OPENING;
    const ADVICE: Advice =
        Advice { texture: case::ADVISE_TEXTURE, boundary: case::ADVISE_BOUNDARY, motion: case::ADVISE_MOTION };
    const SYSTEM_PARTS: usize = 3;
    const NEED: [f64; 2] = [76.0, 150.0];
    type System = relax::System;
    type Unknowns = Field;

    fn settings(&self) -> Settings {
        self.settings
    }

    fn steps(&self) -> &'static [Name] {
        self.solver.steps(&[line::AVERAGE, line::UPDATE, line::EXTRAPOLATE])
    }

    fn last_formula(&self) -> &'static str {
        self.solver.last_formula()
    }

    fn system(&self, linear: &Linear, threads: &Threads) -> relax::System {
        relax::System::new(linear, self.alpha, self.solver.relaxation(self.relaxation), threads)
    }

    fn iterate(&self, warp: &Warp<Self>, from: &Field, count: usize, threads: &Threads) -> Field {
        warp.system.iterate(from, count, threads)
    }

    fn energy(&self, warp: &Warp<Self>, at: &Field) -> [f64; 2] {
        relax::energy(&warp.linear, self.alpha, at)
    }

    fn smoothness_share(&self, linear: &Linear, place: (usize, usize)) -> Option<f32> {
        let ([a, b, _], weight) = (linear.factors.at(place), self.alpha * self.alpha);
        Some(weight / (weight + a * a + b * b))
    }

    fn explanation(&self, index: usize, probe: &Probe<Self>, step: Step) -> Explanation {
        let update = Update::of(self, probe);
        let found = PixelUpdate { mean: update.mean, to: update.to, relaxation: self.relaxation };
        let (step, points) = self.solver.explain((index, step), probe, found, |step| update.tell(self, probe, step));
        Explanation {
            step,
            points,
            lines: explain::line(probe.factors(), 1.0, Role::Candidate).into_iter().collect(),
            energy: Some(Box::new(update.energy(self.alpha, probe.factors()))),
        }
    }
}

/// The update of a pixel in numbers.
struct Update {
    /// The neighbourhood mean (ū, v̄).
    mean: [f32; 2],
    /// The violation of the constraint by the mean, in gray levels.
    off: f32,
    /// α² + |∇I|².
    weight: f32,
    /// The result, before over-relaxation.
    to: [f32; 2],
}

impl Update {
    /// The energy of the pixel's flow while its neighbours stay: its minimum is the update.
    fn energy(&self, alpha: f32, [a, b, c]: [f32; 3]) -> impl Fn([f32; 2]) -> f32 + use<> {
        let mean = self.mean;
        move |[u, v]| {
            let off = a * u + b * v + c;
            off * off + alpha * alpha * ((u - mean[0]).powi(2) + (v - mean[1]).powi(2))
        }
    }

    fn of(model: &HornSchunck, probe: &Probe<HornSchunck>) -> Self {
        let (mean, [a, b, c]) = (model.solver.mean_of(probe), probe.factors());
        let (off, weight) = (a * mean[0] + b * mean[1] + c, model.alpha * model.alpha + a * a + b * b);
        Self { mean, off, weight, to: [mean[0] - a * off / weight, mean[1] - b * off / weight] }
    }

    /// Tells which term dominates the update, and writes it in symbols and with the numbers of the pixel.
    fn tell(&self, model: &HornSchunck, probe: &Probe<HornSchunck>, step: Step) -> Step {
        let [a, b, _] = probe.factors();
        let (squared, violation) = (a * a + b * b, value::VIOLATION.is(self.off.abs()));
        let share = 100.0 * squared / self.weight;
        let step =
            step.put(value::SQUARED_GRADIENT, squared).put(variational::ALPHA_SQUARED, model.alpha * model.alpha);
        let step = match () {
            () if !probe.is_known() => {
                let step = step.say(case::ONLY_SMOOTHNESS).say(case::UNKNOWN).say(case::TAKES_MEAN);
                return step.formula(r"(u, v) = (\bar{u}, \bar{v}) = {update}");
            }
            () if squared <= FLAT => step.say(case::ONLY_SMOOTHNESS).say(case::NO_GRADIENT).say(case::TAKES_MEAN),
            () if violation.rounded() == Some(0.0) => step.say(case::SATISFIED),
            () if share < 1.0 => step.put_value(violation).say(case::VIOLATED).say(case::COVERS_LITTLE),
            () => step.put_value(violation).put(value::SHARE, share).say(case::VIOLATED).say(case::COVERS),
        };
        let (step, name) = (self.put(probe, step), model.solver.index());
        // After warping, the gradient constraint is linearised at (u₀, v₀).
        let residual = match probe.start() {
            Some(_) => r"I_x (\bar{u} - u_0) + I_y (\bar{v} - v_0) + I_t",
            None => r"I_x \bar{u} + I_y \bar{v} + I_t",
        };
        let line = |[of, along]: [&str; 2]| {
            format!(r"{of}{name} = \bar{{{of}}} - I_{along} \frac{{{residual}}}{{\alpha^2 + I_x^2 + I_y^2}}")
        };
        step.formula(line(["u", "x"]))
            .formula(r"= {neighbourhood_mean:1} - {i_x} \cdot \frac{{residual}}{{weight}} = {update:1}")
            .formula(line(["v", "y"]))
            .formula(r"= {neighbourhood_mean:2} - {i_y} \cdot \frac{{residual}}{{weight}} = {update:2}")
    }

    /// Puts the parts of the update with the fewest decimals that reproduce it.
    fn put(&self, probe: &Probe<HornSchunck>, step: Step) -> Step {
        let ([a, b, _], result) = (probe.factors(), |update: [f64; 2]| variational::UPDATE.is(update).bare());
        let written = |further: usize| {
            let mean = self.mean.map(|c| rounded(c.into(), numbers::PX_DECIMALS + further));
            let parts = [a, b, self.off, self.weight];
            let [a, b, off, weight] = parts.map(|part| rounded(part.into(), numbers::GRAY_DECIMALS + further));
            result([mean[0] - a * off / weight, mean[1] - b * off / weight])
        };
        let further = further_digits(|further| written(*further) == result(self.to.map(f64::from)));
        let finer = |value: Value| {
            let unit = value.unit.finer(further as u8);
            value.in_unit(unit)
        };
        let mean = probe.px(variational::NEIGHBOURHOOD_MEAN, self.mean);
        let parts = [explain::value::I_X.is(a), explain::value::I_Y.is(b), value::RESIDUAL.is(self.off)];
        let parts = parts.into_iter().chain([value::WEIGHT.is(self.weight), mean]);
        parts.fold(step, |step, part| step.put_value(finer(part)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_update_is_the_minimum_of_the_energy() {
        let (alpha, factors, mean) = (7.0, [12.0, -5.0, 20.0], [0.8, -0.4]);
        let [a, b, c] = factors;
        let (off, weight) = (a * mean[0] + b * mean[1] + c, alpha * alpha + a * a + b * b);
        let to = [mean[0] - a * off / weight, mean[1] - b * off / weight];
        let energy = Update { mean, off, weight, to }.energy(alpha, factors);
        for [du, dv] in [[0.1, 0.0], [-0.1, 0.0], [0.0, 0.1], [0.0, -0.1], [0.07, 0.07]] {
            assert!(energy(to) < energy([to[0] + du, to[1] + dv]), "({du}, {dv})");
        }
        assert!(energy(to) < energy(mean));
    }
}
