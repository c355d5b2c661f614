//! Iterative solvers of the linear system of a quadratic energy.

use super::model::{Model, Probe};
use crate::choices;
use crate::methods::differential::{Field, numbers, relax, sor};
use crate::scene::{Math, Name, Role, Sentence};

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

    /// Returns what the last step of an iteration does to a pixel.
    pub fn last_formula(self) -> &'static str {
        if self == Solver::Sor { "over-relaxation" } else { "update" }
    }

    /// Returns the name of the update of a pixel in the plane: SOR extrapolates it.
    pub fn update_name(self) -> &'static str {
        if self == Solver::Sor { "Gauss–Seidel" } else { "after" }
    }

    /// Returns the neighbourhood mean that the update of a pixel used.
    pub fn mean_of<M: Model<Unknowns = Field>>(self, probe: &Probe<M>) -> [f32; 2] {
        let iteration = probe.iteration;
        let earlier = if self == Solver::Jacobi { &iteration.from } else { &iteration.to };
        relax::mean_around(earlier, &iteration.from, probe.place, sor::is_earlier)
    }
}

impl<M: Model<Unknowns = Field>> Probe<'_, M> {
    /// Explains the neighbourhood mean.
    pub fn averaged(&self, solver: Solver, mean: [f32; 2]) -> Sentence {
        let of = if solver == Solver::Jacobi {
            "Neighbourhood mean at "
        } else {
            "Neighbourhood mean of the newest values at "
        };
        Sentence::default()
            .text(of)
            .ink(Role::Reference, self.pixel())
            .text(": ")
            .ink(Role::Predicted, self.px(mean))
            .text(". It minimises the smoothness term: the four nearest neighbours weigh 1/6 each, the diagonal ones 1/12, \
                 and the image border is replicated.")
    }

    /// Returns the neighbourhood mean, in symbols and with its value.
    pub fn averages(&self, mean: [f32; 2]) -> Vec<Math> {
        let share = |of: &'static str| Math::over(Math::text("1"), Math::text(of));
        let sum = |over: &'static str| Math::Sum(Box::new(Math::text(over)));
        let line = |i: usize, name: &'static str| {
            Math::Row(vec![
                Math::mean(Math::Var(name)),
                Math::text(" = "),
                share("6"),
                Math::text(" "),
                sum("nearest"),
                Math::text(" "),
                Math::Var(name),
                Math::text(" + "),
                share("12"),
                Math::text(" "),
                sum("diagonal"),
                Math::text(" "),
                Math::Var(name),
                Math::text(" = "),
                Math::ink(Role::Predicted, numbers::px(mean[i])),
            ])
        };
        vec![line(0, "u"), line(1, "v")]
    }

    /// Explains the extrapolation of an update by SOR.
    pub fn extrapolated(&self, update: [f32; 2], relaxation: f32) -> Sentence {
        if relaxation == 1.0 || update == self.from() {
            return Sentence::default()
                .text("There is nothing to extrapolate for SOR: ")
                .ink(Role::Reference, self.pixel())
                .text(" has the Gauss–Seidel update ")
                .ink(Role::Result, self.px(self.to()))
                .text(".");
        }
        Sentence::default()
            .text(format!("SOR extrapolates the Gauss–Seidel update by ω = {}: ", numbers::gray(relaxation)))
            .ink(Role::Reference, self.pixel())
            .text(" goes from ")
            .ink(Role::Best, numbers::vector(self.from()))
            .text(" beyond ")
            .ink(Role::Predicted, numbers::vector(update))
            .text(" to ")
            .ink(Role::Result, self.px(self.to()))
            .text(". Smooth errors, which single updates hardly reduce, vanish in fewer iterations.")
    }

    /// Returns the extrapolation of SOR, in symbols and in numbers.
    pub fn relaxed(&self, update: [f32; 2], relaxation: f32) -> Vec<Math> {
        let (from, to) = (self.from(), self.to());
        let line = |i: usize, name: &'static str| {
            let indexed = |index: &'static str| Math::indexed(Math::Var(name), Math::text(index));
            Math::Row(vec![
                Math::Var(name),
                Math::text(" = "),
                indexed("old"),
                Math::text(" + "),
                Math::Var("ω"),
                Math::text(" ("),
                indexed("GS"),
                Math::text(" − "),
                indexed("old"),
                Math::text(")"),
                Math::text(" = "),
                Math::ink(Role::Best, numbers::px(from[i])),
                Math::text(format!(" + {} · (", numbers::gray(relaxation))),
                Math::ink(Role::Predicted, numbers::px(update[i])),
                Math::text(" − "),
                Math::ink(Role::Best, numbers::factor(numbers::px(from[i]))),
                Math::text(") = "),
                Math::ink(Role::Result, numbers::px(to[i])),
            ])
        };
        vec![line(0, "u"), line(1, "v")]
    }
}
