//! How a single pixel is decided, in words and numbers.

use crate::base::words;
use crate::scene::{Fact, Math, Matrix, Role, Sentence};

/// How a pixel was decided.
#[derive(Default)]
pub struct Explanation {
    /// Its numbers.
    pub facts: Vec<Fact>,
    /// The formula that decides.
    pub equation: Vec<Math>,
    /// What the model holds, where that is more than one number.
    pub matrices: Vec<Matrix>,
    /// Why it counts as what it does, to follow its name.
    pub verdict: Sentence,
}

/// How a gray value is decided that may differ by `threshold` from the one that is expected, which `symbol` stands for.
pub fn compared(value: f32, (expected, symbol): (f32, &'static str), threshold: f32) -> Explanation {
    let difference = (value - expected).abs();
    let is_foreground = difference > threshold;
    let role = if is_foreground { Role::Result } else { Role::Rejected };
    let [shown, expectation, off, limit] = [value, expected, difference, threshold].map(words::number);
    let symbols = Math::Row(vec![
        Math::Abs(Box::new(Math::Row(vec![Math::Var("I"), Math::text(" − "), Math::Var(symbol)]))),
        Math::text(" > "),
        Math::Var("T"),
    ]);
    let numbers = Math::Row(vec![
        Math::Abs(Box::new(Math::Row(vec![
            Math::ink(Role::Measured, shown.clone()),
            Math::text(" − "),
            Math::ink(Role::Predicted, expectation.clone()),
        ]))),
        Math::text(" = "),
        Math::ink(role, off.clone()),
        Math::text(if is_foreground { format!(" > {limit}") } else { format!(" ≤ {limit}") }),
    ]);
    Explanation {
        facts: vec![
            Fact::new("Gray", shown.clone(), Some(Role::Measured)),
            Fact::new("Background", expectation.clone(), Some(Role::Predicted)),
            Fact::new("Difference", off.clone(), Some(role)),
            Fact::new("Threshold", limit.clone(), None),
        ],
        equation: vec![symbols, numbers],
        matrices: Vec::new(),
        verdict: Sentence::default()
            .text(" is ")
            .ink(Role::Measured, shown)
            .text(" where ")
            .ink(Role::Predicted, expectation)
            .text(" is expected. It differs by ")
            .ink(role, off)
            .text(match is_foreground {
                true => format!(", more than {limit}: foreground."),
                false => format!(", not more than {limit}: background."),
            }),
    }
}
