//! What one step tells.

use super::{Name, Readout, Sentence};

/// What a step tells: the line of the pseudocode, why, and the numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// The line of [`crate::run::Info::pseudocode`] that is at work.
    pub line: Name,
    /// What happened and why, in one or two sentences.
    pub sentence: Sentence,
    /// What the panels show.
    pub readouts: Vec<Readout>,
}
