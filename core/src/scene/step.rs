//! The explanation of one step.

use super::{Name, Readout, Sentence};

/// The explanation of a step: the pseudocode line, a sentence, and the numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// The current line of [`crate::run::Info::pseudocode`].
    pub line: Name,
    /// What happened and why, in one or two sentences.
    pub sentence: Sentence,
    /// The contents of the panels.
    pub readouts: Vec<Readout>,
}
