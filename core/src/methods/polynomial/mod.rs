//! Farnebäck's method: polynomial expansion, and displacement estimation from the expansions of two frames.

mod expansion;
mod explain;
mod shift;
mod vocabulary;

pub use expansion::{Applicability, Expander, Packed, Polynomial};
pub use explain::{Inspected, Part, Probe};
pub use shift::{DisplacementEquation, Estimate, ExpansionPair, WindowSolver};
pub use vocabulary::case;
