//! The pseudocode that all corner detectors share.

use crate::scene::{Case, Question};

/// The lines that all corner detectors share.
pub(super) mod line {
    crate::line_names!(TAKE_DERIVATIVES, RESPOND, EACH_STRONG, SUPPRESS, EACH_PEAK, DROP_NEAR, KEEP);
}

/// The question of all detectors that select local maxima at a minimum distance.
pub(crate) const KEPT: Question = Question::choice(
    "kept",
    "Is the next local maximum kept?",
    &[Case::at(line::KEEP, "Yes"), Case::at(line::DROP_NEAR, "No: a stronger one is closer than the minimum distance")],
);

/// The questions of all of them.
pub(super) const QUESTIONS: &[Question] = &[
    Question::choice(
        "nature",
        "What does the structure tensor of the next pixel show?",
        &[
            Case::says(line::RESPOND, "possibly a corner", "A corner: gradients in two directions"),
            Case::says(line::RESPOND, "an edge", "An edge: gradients in one direction"),
            Case::says(line::RESPOND, "a flat area", "A flat area"),
        ],
    ),
    Question::choice(
        "maximum",
        "Is the next response a local maximum?",
        &[
            Case::says(line::SUPPRESS, "suppressed", "No: suppressed"),
            Case::says(line::SUPPRESS, "a local maximum", "Yes"),
        ],
    ),
    KEPT,
];

/// The pseudocode of a corner detector; `response` is the line that defines the response R.
macro_rules! corner_pseudocode {
    ($response:literal) => {
        $crate::pseudocode! {
            TAKE_DERIVATIVES: "I_x, I_y ← derivatives of frame t",
            EACH_PIXEL: "for each pixel: T ← Σ w (I_x², I_x I_y; I_x I_y, I_y²) over the window around it, Σ w = 1",
            RESPOND: $response,
            EACH_STRONG: "for each pixel with R ≥ threshold · max R",
            SUPPRESS: "  suppress it unless R is the maximum of its 3×3 neighbourhood",
            EACH_PEAK: "for each local maximum, in order of decreasing R",
            DROP_NEAR: "  reject it if a corner was kept within min-distance",
            KEEP: "  else keep it as a corner, up to max-points",
        }
    };
}
pub(crate) use corner_pseudocode;
