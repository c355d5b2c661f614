//! Variational methods: minimisation of an energy of the whole flow field, coarse to fine, with image warping.
//!
//! A method is a [`Model`]: its iteration, its energy, and the explanation of both. One blanket implementation makes
//! every [`Model`] an estimator, [`Variational`].
//!
//! Energy, change and error are plotted after iterations 1, 2, 4, 8 and so on of each warp and after its last; those of the
//! iteration at the cursor are computed when it is explained.

mod declare;
mod explain;
mod local;
mod model;
pub mod primal_dual;
mod run;
mod solver;
mod vocabulary;

pub use declare::Settings;
pub use local::{Local, MotionTensor};
pub use model::{Explanation, Model, Probe, Warp};
pub use primal_dual::Dual;
pub use run::Variational;
pub use solver::{PixelUpdate, Solver};
pub use vocabulary::{case, value};
