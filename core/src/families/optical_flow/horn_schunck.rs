//! Horn and Schunck's method: the smoothest field that the gradient constraints allow.

use crate::base::{Threads, words};
use crate::methods::{
    differential::{FLAT, Field, Linear, explain, relax},
    variational::{Looked, Model, Settings, Solver, Told, Warp},
};
use crate::run::{Guarantee, Info};
use crate::scene::{Math, Name, Role, Sentence};
use crate::{params, pseudocode};

params! {
    /// Horn and Schunck's method. The energy ∫∫ (I_x u + I_y v + I_t)² + α² (|∇u|² + |∇v|²) is made as small as can be.
    /// Where course notes multiply the second part by (I_x² + I_y²) as well, that is a misprint: smoothness counts
    /// everywhere alike, and most of all where there is no gradient.
    /// Between pixels, |∇u|² is three times what the weights of the average make of the differences to the eight neighbours: as in
    /// the paper, that 3 is left out, so that α² counts as α²/3 would. One level and warp, no smoothing and the 2×2×2 cube make it the paper's.
    pub struct HornSchunck {
        /// Weight α of smoothness: the larger, the smoother the field; about the gradient, in gray levels per px, that counts as much.
        alpha: f32 = 8.0, 0.1..=1000.0;
        /// How the equations are solved.
        solver: Solver = Solver::Jacobi;
        /// How far SOR goes beyond Gauss and Seidel: 1 is theirs, from 2 on nothing converges.
        relaxation: f32 = 1.9, 1.0..=1.99;
        /// What all variational methods have.
        settings: Settings = Settings { iterations: 100, levels: 4, warps: 3, smoothing: 0.5, ..Settings::default() };
    }
}

/// The steps in which an iteration is told.
const AVERAGED: usize = 0;

pseudocode! {
    ENERGY: "E(u, v) = ∫∫ (I_x u + I_y v + I_t)² + α² (|∇u|² + |∇v|²)",
    EACH_LEVEL: "(u, v) ← 0; for each level, from the coarsest to the picture itself",
    EACH_WARP: "  for each warp",
    TAKE_MEDIANS: "    (u₀, v₀) ← medians of 3×3 px of (u, v), but for the first warp of all",
    WARP: "    bring frame t+1 back along (u₀, v₀), take I_x, I_y, I_t; c ← I_t − I_x u₀ − I_y v₀",
    EACH_ITERATION: "    for each iteration",
    AVERAGE: "      (u_m, v_m) ← mean of the neighbours, for each pixel",
    UPDATE: "      (u, v) ← (u_m, v_m) − ∇I (I_x u_m + I_y v_m + c) / (α² + |∇I|²)",
}

impl Model for HornSchunck {
    const INFO: Info = Info {
        id: "horn-schunck",
        name: "Horn–Schunck",
        family: "Optical flow",
        summary: "Finds the field that fits the gradient constraints of all pixels and is as smooth as can be.",
        source: "B. K. P. Horn and B. G. Schunck, Determining optical flow, Artificial Intelligence 17, 1981; pyramid and \
                 warping: E. Meinhardt-Llopis, J. Sánchez and D. Kondermann, Horn–Schunck optical flow with a multi-scale \
                 strategy, Image Processing On Line 3, 2013; medians: D. Sun, S. Roth and M. J. Black, Secrets of optical flow \
                 estimation and their principles, CVPR 2010",
        pseudocode: line::ALL,
        granularities: &["frame", "level", "warp", "iteration", "step"],
        frames: 2,
    };
    const GUARANTEE: Guarantee = Guarantee::SubPixel { off_centi_px: 5 };
    const STEPS: &'static [Name] = &[line::AVERAGE, line::UPDATE];
    const ENERGY_UNIT: &'static str = "gray levels²";
    const OPENING: &'static str = "The energy to be made small has two parts: how far the gradient constraints are off, and α² \
                                   times how unlike neighbours move. (In some course notes the second part is multiplied by \
                                   I_x² + I_y² as well: a misprint, for where there is no gradient, smoothness is all there is.)";
    const SYSTEM_PARTS: usize = 3;
    const NEED: [f64; 2] = [76.0, 150.0];
    type System = relax::System;
    type Unknowns = Field;

    fn settings(&self) -> Settings {
        self.settings
    }

    fn system(&self, linear: &Linear, threads: &Threads) -> relax::System {
        relax::System::new(linear, self.alpha, threads)
    }

    fn iterate(&self, warp: &Warp<Self>, from: &Field, count: usize, threads: &Threads) -> Field {
        let Some(relaxation) = self.solver.relaxation(self.relaxation) else {
            return warp.system.jacobi(from, count, threads);
        };
        let mut field = from.clone();
        (0..count).for_each(|_| warp.system.sweep(&mut field, relaxation));
        field
    }

    fn energy(&self, warp: &Warp<Self>, at: &Field) -> [f64; 2] {
        relax::energy(&warp.linear, self.alpha, at)
    }

    fn told(&self, step: usize, looked: &Looked<Self>) -> Told {
        let update = Update::of(self, looked);
        let mut points = vec![("average", Role::Predicted, update.mean), ("after", Role::Result, looked.to())];
        if step == AVERAGED {
            points.pop();
        }
        Told {
            sentence: if step == AVERAGED { looked.averaged(update.mean) } else { update.sentence(self, looked) },
            facts: Vec::new(),
            equation: update.equation(self, looked),
            points,
            lines: explain::line(looked.factors(), 1.0, Role::Candidate).into_iter().collect(),
        }
    }
}

/// An iteration at a pixel in numbers.
struct Update {
    /// The average of its neighbours.
    mean: [f32; 2],
    /// By how much the constraint is off there.
    off: f32,
    /// α² + |∇I|².
    weight: f32,
    /// What fits the pixel and that average.
    to: [f32; 2],
}

impl Update {
    fn of(model: &HornSchunck, looked: &Looked<HornSchunck>) -> Self {
        let (mean, [a, b, c]) = (model.solver.mean_of(looked), looked.factors());
        let (off, weight) = (a * mean[0] + b * mean[1] + c, model.alpha * model.alpha + a * a + b * b);
        Self { mean, off, weight, to: [mean[0] - a * off / weight, mean[1] - b * off / weight] }
    }

    fn sentence(&self, model: &HornSchunck, looked: &Looked<HornSchunck>) -> Sentence {
        let (said, pixel) = (Sentence::default(), looked.pixel());
        let beyond = model.solver.beyond(model.relaxation);
        let [a, b, _] = looked.factors();
        if a * a + b * b <= FLAT {
            let why = if looked.is_known() { "has no gradient" } else { "has left the picture" };
            let said = said
                .ink(Role::Reference, pixel)
                .text(format!(" {why}: no constraint holds it. It takes the average, "));
            return looked.goes(said, self.to, beyond).text(".");
        }
        let off = words::number(self.off);
        if off.chars().all(|letter| "−0.".contains(letter)) {
            let said = said
                .text("With the average, the constraint of ")
                .ink(Role::Reference, pixel)
                .text(" holds already: it moves as its neighbours do, to ");
            return looked.goes(said, self.to, beyond).text(".");
        }
        let said = said
            .text(format!("With the average, the constraint is off by {off} gray levels at "))
            .ink(Role::Reference, pixel)
            .text(". From the average it is moved along its gradient towards the line, to ");
        match beyond {
            Some(_) => looked.goes(said, self.to, beyond).text("."),
            None => looked.goes(said, self.to, beyond).text(
                ". Where the gradient is large beside α, it comes near the line; where it is small, the average stays.",
            ),
        }
    }

    /// The update in symbols, and with the numbers of the pixel.
    fn equation(&self, model: &HornSchunck, looked: &Looked<HornSchunck>) -> Vec<Math> {
        let beyond = model.solver.beyond(model.relaxation);
        let name = |name: &'static str| match beyond {
            Some(_) => Math::indexed(Math::Var(name), Math::text("GS")),
            None => Math::Var(name),
        };
        let [a, b, _] = looked.factors();
        let mut lines = looked.definition();
        lines.extend([
            symbols(name("u"), ("u", "x"), looked.rest()),
            self.numbers(a, self.mean[0], self.to[0]),
            symbols(name("v"), ("v", "y"), looked.rest()),
            self.numbers(b, self.mean[1], self.to[1]),
        ]);
        lines.extend(beyond.into_iter().flat_map(|relaxation| looked.relaxed(self.to, relaxation)));
        lines
    }

    fn numbers(&self, gradient: f32, mean: f32, to: f32) -> Math {
        let share =
            Math::Frac(Box::new(Math::text(words::number(self.off))), Box::new(Math::text(words::number(self.weight))));
        Math::Row(vec![
            Math::text("= "),
            Math::ink(Role::Predicted, words::number(mean)),
            Math::text(" − "),
            Math::ink(Role::Reference, words::factor(gradient)),
            Math::text(" · "),
            share,
            Math::text(" = "),
            Math::ink(Role::Result, words::number(to)),
        ])
    }
}

/// The update of one part of the displacement in symbols; `rest` is what stands for I_t.
fn symbols(to: Math, (part, along): (&'static str, &'static str), rest: Math) -> Math {
    let squared = |base: Math| Math::power(base, Math::text("2"));
    let mean_of = |name: &'static str| Math::mean(Math::Var(name));
    let top = vec![
        explain::derivative("x"),
        Math::text(" "),
        mean_of("u"),
        Math::text(" + "),
        explain::derivative("y"),
        Math::text(" "),
        mean_of("v"),
        Math::text(" + "),
        rest,
    ];
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
        mean_of(part),
        Math::text(" − "),
        explain::derivative(along),
        Math::text(" "),
        Math::Frac(Box::new(Math::Row(top)), Box::new(Math::Row(bottom))),
    ])
}
