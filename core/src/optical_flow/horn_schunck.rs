//! Horn and Schunck's method: the smoothest field that the gradient constraints allow.

use crate::differential::{Field, Linear, relax, tell};
use crate::scene::{Math, Sentence};
use crate::variational::{Looked, Model, Solver, Told, Warp, variational_params};
use crate::{Info, Promise, Role, Threads};

variational_params! {
    /// Horn and Schunck's method. The energy ∫∫ (Iₓ u + I_y v + Iₜ)² + α² (|∇u|² + |∇v|²) is made as small as can be.
    /// Where course notes multiply the second part by (Iₓ² + I_y²) as well, that is a misprint: smoothness counts everywhere alike.
    pub struct HornSchunck {
        /// Weight α of smoothness: the larger, the smoother the field; about the gradient, in gray levels per px, that counts as much.
        alpha: f32 = 8.0, 0.1..=1000.0;
        /// How the equations are solved.
        solver: Solver = Solver::Jacobi;
        /// How far SOR goes beyond Gauss and Seidel: 1 is theirs, from 2 on nothing converges.
        relaxation: f32 = 1.9, 1.0..=1.99;
    }
    iterations = 100, levels = 4, warps = 3, smoothing = 0.5
}

/// The steps in which an iteration is told.
const AVERAGED: usize = 0;

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
        pseudocode: &[
            "E(u, v) = ∫∫ (Iₓ u + I_y v + Iₜ)² + α² (|∇u|² + |∇v|²)",
            "(u, v) ← 0 on the coarsest level",
            "for each level, from the coarsest to the picture itself",
            "  for each warp",
            "    (u, v) ← medians of 3×3 px: nothing astray is carried on",
            "    bring frame t+1 back along (u, v), take Iₓ, I_y, Iₜ",
            "    for each iteration",
            "      (u_m, v_m) ← mean of the neighbours, for each pixel",
            "      (u, v) ← (u_m, v_m) − ∇I (Iₓ u_m + I_y v_m + Iₜ) / (α² + |∇I|²)",
        ],
        rungs: &["frame", "level", "warp", "iteration", "step"],
        frames: 2,
    };
    const PROMISE: Promise = Promise::SubPixel { off_centi_px: 5 };
    const LINES: (usize, &'static [usize]) = (5, &[7, 8]);
    const ENERGY_UNIT: &'static str = "gray levels²";
    const OPENING: &'static str = "The energy to be made small has two parts: how far the gradient constraints are off, and α² \
                                   times how unlike neighbours move. (In some course notes the second part is multiplied by \
                                   Iₓ² + I_y² as well: a misprint.)";
    const SYSTEM_PARTS: usize = 3;
    type System = relax::System;
    type Unknowns = Field;

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
        let mean = self.solver.mean_of(looked);
        let mut points = vec![("average", Role::Predicted, mean), ("after", Role::Result, looked.to())];
        if step == AVERAGED {
            points.pop();
        }
        Told {
            sentence: self.sentence(step, looked, mean),
            facts: Vec::new(),
            equation: self.equation(looked, mean),
            points,
            lines: tell::line(looked.factors(), 1.0, Role::Candidate).into_iter().collect(),
        }
    }
}

impl HornSchunck {
    fn sentence(&self, step: usize, looked: &Looked<Self>, mean: [f32; 2]) -> Sentence {
        if step == AVERAGED {
            return looked.averaged(mean);
        }
        let [a, b, c] = looked.factors();
        let off = tell::number(a * mean[0] + b * mean[1] + c);
        if off.chars().all(|letter| "−0.".contains(letter)) {
            return Sentence::default()
                .text("With the average, the constraint of ")
                .ink(Role::Reference, looked.pixel())
                .text(" holds already: it moves as its neighbours do, by ")
                .ink(Role::Result, format!("{} px", tell::vector(looked.to())))
                .text(".");
        }
        let relaxed = if self.solver == Solver::Sor { " and beyond" } else { "" };
        Sentence::default()
            .text(format!("With the average, the constraint is off by {off} gray levels at "))
            .ink(Role::Reference, looked.pixel())
            .text(format!(". It is moved along its gradient towards the line{relaxed}, to "))
            .ink(Role::Result, format!("{} px", tell::vector(looked.to())))
            .text(
                ". Where the gradient is large beside α, it comes near the line; where it is small, the average stays.",
            )
    }

    /// The update in symbols, and with the numbers of the pixel.
    fn equation(&self, looked: &Looked<Self>, mean: [f32; 2]) -> Vec<Math> {
        let ([a, b, c], to) = (looked.factors(), looked.to());
        let (off, weight) = (a * mean[0] + b * mean[1] + c, self.alpha * self.alpha + a * a + b * b);
        let squared = |base: Math| Math::power(base, Math::text("2"));
        let mean_of = |name: &'static str| Math::indexed(Math::Var(name), Math::Var("m"));
        let symbols = |to: &'static str, along: &'static str| {
            let top = vec![
                tell::derivative("x"),
                Math::text(" "),
                mean_of("u"),
                Math::text(" + "),
                tell::derivative("y"),
                Math::text(" "),
                mean_of("v"),
                Math::text(" + "),
                tell::derivative("t"),
            ];
            let bottom = vec![
                squared(Math::Var("α")),
                Math::text(" + "),
                squared(tell::derivative("x")),
                Math::text(" + "),
                squared(tell::derivative("y")),
            ];
            Math::Row(vec![
                Math::Var(to),
                Math::text(" = "),
                mean_of(to),
                Math::text(" − "),
                tell::derivative(along),
                Math::text(" "),
                Math::Frac(Box::new(Math::Row(top)), Box::new(Math::Row(bottom))),
            ])
        };
        let numbers = |gradient: f32, mean: f32, to: f32| {
            let over = if self.solver == Solver::Sor { " → " } else { " = " };
            Math::Row(vec![
                Math::text("= "),
                Math::ink(Role::Predicted, tell::number(mean)),
                Math::text(" − "),
                Math::ink(Role::Reference, tell::number(gradient)),
                Math::text(" · "),
                Math::Frac(Box::new(Math::text(tell::number(off))), Box::new(Math::text(tell::number(weight)))),
                Math::text(over),
                Math::ink(Role::Result, tell::number(to)),
            ])
        };
        vec![symbols("u", "x"), numbers(a, mean[0], to[0]), symbols("v", "y"), numbers(b, mean[1], to[1])]
    }
}
