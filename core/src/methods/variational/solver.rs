//! Iterative solvers of the linear system of a quadratic energy.

use super::model::{Model, Probe};
use super::vocabulary::{case, value};
use crate::choices;
use crate::methods::differential::{Field, relax, sor};
use crate::scene::{Name, Role, Step};

/// The step of an iteration that computes the neighbourhood mean.
const AVERAGED: usize = 0;
/// The step of SOR that extrapolates the update.
const EXTRAPOLATED: usize = 2;

/// The neighbourhood mean in symbols, with its value.
const MEAN: [&str; 2] = [
    r"\bar{u} = \frac{1}{6} \sum_\text{nearest} u + \frac{1}{12} \sum_\text{diagonal} u = {neighbourhood_mean:1}",
    r"\bar{v} = \frac{1}{6} \sum_\text{nearest} v + \frac{1}{12} \sum_\text{diagonal} v = {neighbourhood_mean:2}",
];

choices! {
    /// Iterative solver of the linear system. All of them converge to the same flow.
    pub enum Solver {
        /// All pixels from the neighbourhood means of the previous iteration, as in Horn and Schunck (1981).
        Jacobi = "jacobi" "Jacobi",
        /// From the newest values, in four colours: the even rows before the odd ones, and in each row the even columns before the
        /// odd ones. Converges in about half as many iterations as Jacobi.
        GaussSeidel = "gauss-seidel" "Gauss–Seidel",
        /// Successive over-relaxation: Gauss–Seidel steps, extrapolated by the factor ω. Fastest to converge.
        Sor = "sor" "SOR",
    }
}

/// A point of the plane: its name, its role, and where it lies.
type NamedPoint = (&'static str, Role, [f32; 2]);

/// The update of a pixel.
pub struct PixelUpdate {
    /// The neighbourhood mean of the flow in px.
    pub mean: [f32; 2],
    /// The flow after it, without over-relaxation, in px.
    pub to: [f32; 2],
    /// The relaxation factor ω.
    pub relaxation: f32,
}

impl Solver {
    /// Returns the relaxation factor ω, 1 for Gauss–Seidel; `None` for Jacobi.
    pub fn relaxation(self, over: f32) -> Option<f32> {
        match self {
            Solver::Jacobi => None,
            Solver::GaussSeidel => Some(1.0),
            Solver::Sor => Some(over),
        }
    }

    /// Returns the lines of the steps of an iteration: the last, the extrapolation, is that of SOR alone.
    pub fn steps<const N: usize>(self, all: &'static [Name; N]) -> &'static [Name] {
        if self == Solver::Sor { all } else { &all[..N - 1] }
    }

    /// Returns the effect of the last step of an iteration on a pixel.
    pub fn last_formula(self) -> &'static str {
        if self == Solver::Sor { "over-relaxation" } else { "update" }
    }

    /// Returns the neighbourhood mean that the update of a pixel used.
    pub fn mean_of<M: Model<Unknowns = Field>>(self, probe: &Probe<M>) -> [f32; 2] {
        let iteration = probe.iteration;
        let earlier = if self == Solver::Jacobi { &iteration.from } else { &iteration.to };
        relax::mean_around(earlier, &iteration.from, probe.place, sor::is_earlier)
    }

    /// Returns the index of the update of u, v or both in a formula: SOR extrapolates it.
    pub fn index(self) -> &'static str {
        if self == Solver::Sor { r"_\text{GS}" } else { "" }
    }

    /// Explains the step `index` of an iteration at a pixel: the neighbourhood mean, the update, which `tell` explains, or its
    /// extrapolation. Returns with it the points of the plane; before the update its result is none of them.
    pub fn explain<M: Model<Unknowns = Field>>(
        self,
        (index, step): (usize, Step),
        probe: &Probe<M>,
        PixelUpdate { mean, to: update, relaxation }: PixelUpdate,
        tell: impl FnOnce(Step) -> Step,
    ) -> (Step, Vec<NamedPoint>) {
        let mean_point = ("mean", Role::Predicted, mean);
        let step = step.put_value(probe.px(value::NEIGHBOURHOOD_MEAN, mean));
        match index {
            AVERAGED => {
                let step =
                    step.say(if self == Solver::Jacobi { case::MEAN } else { case::NEWEST_MEAN }).say(case::WEIGHTS);
                (MEAN.iter().fold(step, Step::formula), vec![mean_point])
            }
            EXTRAPOLATED => {
                let step = step.put_value(probe.px(value::UPDATE, update).inked(Role::Predicted));
                let step = step.put(value::RELAXATION, relaxation).put_value(probe.px(value::FLOW_AFTER, probe.to()));
                let has_effect = relaxation != 1.0 && update != probe.from();
                let step = step.say(if has_effect { case::EXTRAPOLATED } else { case::NOT_EXTRAPOLATED });
                let step = step.formula(r"(u, v) = (u, v)_\text{old} + \omega ((u, v)_\text{GS} - (u, v)_\text{old})");
                let step = step.formula(
                    r"u = {flow_before:1} + {relaxation} \cdot ({update:1} - {flow_before:1}) = {flow_after:1}",
                );
                let step = step.formula(
                    r"v = {flow_before:2} + {relaxation} \cdot ({update:2} - {flow_before:2}) = {flow_after:2}",
                );
                (step, vec![("Gauss–Seidel", Role::Predicted, update), ("after", Role::Result, probe.to())])
            }
            _ => {
                let name = if self == Solver::Sor { "Gauss–Seidel" } else { "after" };
                let step = tell(step.put_value(probe.px(value::UPDATE, update)));
                (step, vec![mean_point, (name, Role::Result, update)])
            }
        }
    }
}
