//! How the linear equations of a quadratic energy are solved.

use super::model::{Looked, Model};
use crate::differential::{Field, relax, tell};
use crate::scene::Sentence;
use crate::{Role, choices};

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
            .ink(Role::Predicted, format!("{} px", tell::vector(mean)))
            .text(" on average. If smoothness alone counted, so would the pixel.")
    }
}
