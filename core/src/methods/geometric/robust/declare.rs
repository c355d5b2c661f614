//! The pseudocode that all robust estimators share.

use super::vocabulary::{case, value};
use crate::scene::{Question, Reply};

/// The lines that all robust estimators share.
pub(super) mod line {
    crate::line_names!(MATCH, REPEAT, DRAW, HYPOTHESISE, COUNT, OPTIMISE, KEEP_BEST, REFIT);
}

/// The questions of all of them.
pub(super) const QUESTIONS: &[Question] = &[
    Question::choice(
        "better",
        "Is the next hypothesis the best so far?",
        &[Reply::told(line::COUNT, case::DISCARDED, "No: discarded"), Reply::at(line::COUNT, "Yes")],
    )
    .unless_told(&[case::FIRST]),
    Question::value(
        "inliers",
        "How many matches are inliers of the model fitted to all inliers?",
        line::REFIT,
        value::INLIERS,
    ),
];

/// The pseudocode of a robust estimator; `model` is the line of the hypothesis, `count` that of the inliers.
macro_rules! robust_pseudocode {
    ($model:literal, $count:literal, $refit:literal $(, $name:ident: $text:literal)*) => {
        $crate::pseudocode! {
            MATCH: "match the keypoints of frames t and t+1; N ← max-iterations",
            REPEAT: "for each iteration k = 1, 2, … N",
            DRAW: "  draw a random sample of n matches, as many as determine the model",
            HYPOTHESISE: $model,
            COUNT: $count,
            OPTIMISE: "    LO-RANSAC: fit the model to its inliers while that lowers the cost",
            KEEP_BEST: "  if it is the best so far: keep it; w ← share of inliers, N ← log(1 − p) / log(1 − wⁿ)",
            REFIT: $refit,
            $($name: $text,)*
        }
    };
}
pub(crate) use robust_pseudocode;
