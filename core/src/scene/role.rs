//! The meaning of a mark.

/// The meaning of a mark or a word. A role has one colour, and one shape or line style, everywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Role {
    /// The block, point or feature to be matched.
    Reference,
    /// The search window.
    Window,
    /// The candidate under test.
    Candidate,
    /// A rejected candidate.
    Rejected,
    /// The best match so far.
    Best,
    /// A result: the motion vector.
    Result,
    /// A prediction.
    Predicted,
    /// A measurement.
    Measured,
    /// The estimate after the update.
    Estimate,
    /// Ground truth.
    Truth,
    /// An error or a residual.
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

    /// Its name in templates and data: `best`.
    pub const fn id(self) -> &'static str {
        match self {
            Role::Reference => "reference",
            Role::Window => "window",
            Role::Candidate => "candidate",
            Role::Rejected => "rejected",
            Role::Best => "best",
            Role::Result => "result",
            Role::Predicted => "predicted",
            Role::Measured => "measured",
            Role::Estimate => "estimate",
            Role::Truth => "truth",
            Role::Error => "error",
        }
    }

    /// The role of that name.
    pub fn called(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|role| role.id() == id)
    }
}
