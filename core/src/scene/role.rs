//! What a mark stands for.

/// What a mark or a word stands for. A role has one colour, and one shape or line style, everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Role {
    /// The block, point or feature that is being matched.
    Reference,
    /// The search window.
    Window,
    /// The candidate under test.
    Candidate,
    /// A candidate that lost.
    Rejected,
    /// The best candidate so far.
    Best,
    /// A result: the displacement that was chosen.
    Result,
    /// What a model predicts.
    Predicted,
    /// What was measured.
    Measured,
    /// The estimate after prediction and measurement.
    Estimate,
    /// What is truly so.
    Truth,
    /// How far off something is.
    Error,
}

impl Role {
    /// Every role, in the order of a legend.
    pub const ALL: [Role; 11] = [
        Role::Reference,
        Role::Window,
        Role::Candidate,
        Role::Rejected,
        Role::Best,
        Role::Result,
        Role::Predicted,
        Role::Measured,
        Role::Estimate,
        Role::Truth,
        Role::Error,
    ];
}
