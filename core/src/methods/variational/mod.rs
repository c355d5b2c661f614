//! What the methods share that make an energy of the whole field small: from the coarsest level of a pyramid to the picture,
//! in warps, frame t + 1 is brought back by what was found, and iterations go on from there.
//!
//! A method is a [`Model`]: what an iteration is, what its energy is, and how both are told. One blanket implementation makes
//! every [`Model`] an estimator, [`Variational`].

mod declare;
mod explain;
mod local;
mod model;
pub mod primal_dual;
mod run;
mod solver;

pub use declare::Settings;
pub use local::{Local, MotionTensor};
pub use model::{Looked, Model, Told, Warp};
pub use primal_dual::Dual;
pub use run::Variational;
pub use solver::Solver;
