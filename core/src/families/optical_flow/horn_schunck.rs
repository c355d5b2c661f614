//! Horn and Schunck's method: gradient constraints with a global smoothness term.

use crate::base::Threads;
use crate::base::words::{further_digits, rounded};
use crate::methods::{
    differential::{Advice, FLAT, Field, Linear, explain, numbers, relax},
    variational::{Explanation, Model, Probe, Settings, Solver, Warp},
};
use crate::run::{Guarantee, Info};
use crate::scene::{Math, Name, Question, Reading, Reply, Role, Sentence};
use crate::{cases, params, pseudocode};

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
    renamed { "smoothing" => "sigma" }
    when {
        "relaxation": |p| p.solver == Solver::Sor, "Relaxation has no effect unless the solver is SOR.";
    }
}

/// The step of an iteration that computes the neighbourhood mean.
const AVERAGED: usize = 0;
/// The step of SOR that extrapolates the update.
const EXTRAPOLATED: usize = 2;

cases! {
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
    UPDATE: "        (u, v)_GS ← (ū, v\u{304}) − ∇I (I_x ū + I_y v\u{304} + c) / (α² + |∇I|²)",
    EXTRAPOLATE: "        (u, v) ← (u, v) + ω ((u, v)_GS − (u, v)); ω = 1 unless SOR",
}

/// Where an update says how much of the way to the constraint line it covers.
const SHARE: Reading = Reading { line: line::UPDATE, after: "the update covers ", before: " % of the way", unit: "%" };

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
        Question::number(
            "share",
            "How much of the way from the neighbourhood mean to the constraint line does the update cover?",
            SHARE,
        )
        .once_per_reference(),
        Question::choice(
            "term",
            "Which term dominates the update of the pixel?",
            &[
                Reply::over(SHARE, 50.0, "The data term"),
                Reply::says(line::UPDATE, "the update covers", "The smoothness term"),
                Reply::says(line::UPDATE, "Only the smoothness term counts", "The smoothness term"),
            ],
        )
        .once_per_reference(),
    ];
    const GUARANTEE: Guarantee = Guarantee::SubPixel { off_centi_px: 5 };
    const ENERGY_UNIT: &'static str = "gray levels²";
    const OPENING: &'static str = "The data term is the squared violation of the gradient constraint; the smoothness term is the \
                                   sum of the squared gradients of u and v, weighted by α². Without image gradient the \
                                   smoothness term alone determines the flow.";
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

    fn explanation(&self, step: usize, probe: &Probe<Self>) -> Explanation {
        let update = Update::of(self, probe);
        let mean = ("mean", Role::Predicted, update.mean);
        // The result of the update is not known before it.
        let (sentence, equation, points) = match step {
            AVERAGED => (probe.averaged(self.solver, update.mean), probe.averages(update.mean), vec![mean]),
            EXTRAPOLATED => (
                probe.extrapolated(update.to, self.relaxation),
                probe.relaxed(update.to, self.relaxation),
                vec![("Gauss–Seidel", Role::Predicted, update.to), ("after", Role::Result, probe.to())],
            ),
            _ => (
                update.sentence(self, probe),
                update.equation(self, probe),
                vec![mean, (self.solver.update_name(), Role::Result, update.to)],
            ),
        };
        Explanation {
            sentence,
            facts: Vec::new(),
            equation,
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

    fn sentence(&self, model: &HornSchunck, probe: &Probe<HornSchunck>) -> Sentence {
        let (said, pixel) = (Sentence::default(), probe.pixel());
        let [a, b, _] = probe.factors();
        let squared = a * a + b * b;
        if squared <= FLAT {
            let why = match probe.is_known() {
                true => "has no gradient, so any flow satisfies its constraint",
                false => "has no constraint, because (u₀, v₀) leads out of frame t+1",
            };
            let said = said
                .text("Only the smoothness term counts: ")
                .ink(Role::Reference, pixel)
                .text(format!(" {why}. The update takes the neighbourhood mean: (u, v) = "));
            return said.ink(Role::Result, probe.px(self.to)).text(".");
        }
        let off = numbers::gray(self.off.abs());
        if off == "0.00" {
            let said = said
                .text("The neighbourhood mean satisfies the gradient constraint of ")
                .ink(Role::Reference, pixel)
                .text(" to within 0.01 gray levels, so the update keeps it: (u, v) = ");
            return said.ink(Role::Result, probe.px(self.to)).text(".");
        }
        let said = said
            .text("The neighbourhood mean violates the gradient constraint of ")
            .ink(Role::Reference, pixel)
            .text(format!(
                " by {off} gray levels. With |∇I|² = {} against α² = {}, the update covers {} of the way to the constraint \
                 line: (u, v) = ",
                numbers::gray(squared),
                numbers::gray(model.alpha * model.alpha),
                match 100.0 * squared / self.weight {
                    share if share < 1.0 => "less than 1 %".to_owned(),
                    share => format!("{share:.0} %"),
                }
            ));
        said.ink(Role::Result, probe.px(self.to)).text(".")
    }

    /// Returns the update in symbols, and with the numbers of the pixel.
    fn equation(&self, model: &HornSchunck, probe: &Probe<HornSchunck>) -> Vec<Math> {
        let name = |name: &'static str| match model.solver {
            Solver::Sor => Math::indexed(Math::Var(name), Math::text("GS")),
            Solver::Jacobi | Solver::GaussSeidel => Math::Var(name),
        };
        let [a, b, _] = probe.factors();
        let is_warped = probe.start().is_some();
        vec![
            symbols(name("u"), ("u", "x"), is_warped),
            self.numbers(a, self.mean[0], self.to[0]),
            symbols(name("v"), ("v", "y"), is_warped),
            self.numbers(b, self.mean[1], self.to[1]),
        ]
    }

    fn numbers(&self, gradient: f32, mean: f32, to: f32) -> Math {
        let (length, level) = (numbers::PX_DECIMALS, 2);
        let further = further_digits(|further| {
            let [gradient, off, weight] =
                [gradient, self.off, self.weight].map(|of| rounded(of.into(), level + further));
            let found = rounded(mean.into(), length + further) - gradient * off / weight;
            numbers::px(found as f32) == numbers::px(to)
        });
        let level = |of: f32| numbers::fixed(of, level + further);
        Math::Row(vec![
            Math::text("= "),
            Math::ink(Role::Predicted, numbers::fixed(mean, length + further)),
            Math::text(" − "),
            Math::ink(Role::Reference, numbers::factor(level(gradient))),
            Math::text(" · "),
            Math::over(Math::text(level(self.off)), Math::text(level(self.weight))),
            Math::text(" = "),
            Math::ink(Role::Result, numbers::px(to)),
        ])
    }
}

/// The update of one flow component in symbols; after warping, the gradient constraint is linearised at (u₀, v₀).
fn symbols(to: Math, (part, along): (&'static str, &'static str), is_warped: bool) -> Math {
    let squared = |base: Math| Math::power(base, Math::text("2"));
    let product = |along: &'static str, component: &'static str| {
        let mean = Math::mean(Math::Var(component));
        let start = Math::indexed(Math::Var(component), Math::text("0"));
        let off = vec![Math::text("("), mean.clone(), Math::text(" − "), start, Math::text(")")];
        let off = if is_warped { Math::Row(off) } else { mean };
        Math::Row(vec![explain::derivative(along), Math::text(" "), off])
    };
    let top =
        vec![product("x", "u"), Math::text(" + "), product("y", "v"), Math::text(" + "), explain::derivative("t")];
    let bottom = vec![
        squared(Math::Var("α")),
        Math::text(" + "),
        squared(explain::derivative("x")),
        Math::text(" + "),
        squared(explain::derivative("y")),
    ];
    Math::Row(vec![
        to,
        Math::text(" = "),
        Math::mean(Math::Var(part)),
        Math::text(" − "),
        explain::derivative(along),
        Math::text(" "),
        Math::Frac(Box::new(Math::Row(top)), Box::new(Math::Row(bottom))),
    ])
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
