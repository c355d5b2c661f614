//! How the linear equations of a quadratic energy are solved.

use super::model::{Looked, Model};
use crate::base::words;
use crate::choices;
use crate::methods::differential::{Field, relax};
use crate::scene::{Math, Role, Sentence};

choices! {
    /// How the equations are solved. All methods come to the same field in the end.
    pub enum Solver {
        /// All pixels at once, from the averages of the iteration before, as in the paper.
        Jacobi = "jacobi" "Jacobi",
        /// Pixel by pixel along the rows, from the newest values: about twice as fast to converge.
        GaussSeidel = "gauss-seidel" "Gauss–Seidel",
        /// As Gauss–Seidel, but each pixel goes farther than it should (successive over-relaxation): much faster.
        Sor = "sor" "SOR",
    }
}

impl Solver {
    /// How far beyond Gauss and Seidel's value a pixel goes, 1 being theirs; `None` where all pixels go at once.
    pub fn relaxation(self, over: f32) -> Option<f32> {
        match self {
            Solver::Jacobi => None,
            Solver::GaussSeidel => Some(1.0),
            Solver::Sor => Some(over),
        }
    }

    /// `over` where pixels are taken beyond Gauss and Seidel's value by it.
    pub fn beyond(self, over: f32) -> Option<f32> {
        (self == Solver::Sor).then_some(over)
    }

    /// The average of the neighbours from which a pixel was set.
    pub fn mean_of<M: Model<Unknowns = Field>>(self, looked: &Looked<M>) -> [f32; 2] {
        let iteration = looked.iteration;
        let earlier = if self == Solver::Jacobi { &iteration.from } else { &iteration.to };
        relax::mean_around(earlier, &iteration.from, looked.place)
    }
}

impl<M: Model<Unknowns = Field>> Looked<'_, M> {
    /// What is said when the average of the neighbours is taken.
    pub fn averaged(&self, mean: [f32; 2]) -> Sentence {
        Sentence::default()
            .text("The neighbours of ")
            .ink(Role::Reference, self.pixel())
            .text(" move by ")
            .ink(Role::Predicted, self.px(mean))
            .text(" on average. If smoothness alone counted, so would the pixel.")
    }

    /// The end of what is said of an update: where the pixel goes, with SOR `beyond` that.
    pub fn goes(&self, said: Sentence, update: [f32; 2], beyond: Option<f32>) -> Sentence {
        let to = self.px(self.to());
        let Some(relaxation) = beyond else { return said.ink(Role::Result, to) };
        said.ink(Role::Predicted, self.px(update))
            .text(format!(". SOR goes {} times as far from where it was, ", words::number(relaxation)))
            .ink(Role::Best, self.px(self.from()))
            .text(", to ")
            .ink(Role::Result, to)
    }

    /// How SOR goes beyond an update, in symbols and in numbers.
    pub fn relaxed(&self, update: [f32; 2], relaxation: f32) -> Vec<Math> {
        let (from, to) = (self.from(), self.to());
        let line = |i: usize, name: &'static str| {
            let indexed = |index: &'static str| Math::indexed(Math::Var(name), Math::text(index));
            Math::Row(vec![
                Math::Var(name),
                Math::text(" = "),
                indexed("before"),
                Math::text(" + "),
                Math::Var("ω"),
                Math::text(" ("),
                indexed("GS"),
                Math::text(" − "),
                indexed("before"),
                Math::text(") = "),
                Math::ink(Role::Best, words::number(from[i])),
                Math::text(format!(" + {} · (", words::number(relaxation))),
                Math::ink(Role::Predicted, words::number(update[i])),
                Math::text(" − "),
                Math::ink(Role::Best, words::factor(from[i])),
                Math::text(") = "),
                Math::ink(Role::Result, words::number(to[i])),
            ])
        };
        vec![line(0, "u"), line(1, "v")]
    }
}
