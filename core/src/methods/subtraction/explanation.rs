//! The classification of a single pixel and the update of its model, in words and numbers.

use crate::methods::numbers::{gray, level};
use crate::scene::{Fact, Math, Matrix, Role, Sentence};

/// The classification of a pixel.
#[derive(Default)]
pub struct Explanation {
    /// The numbers of the comparison.
    pub facts: Vec<Fact>,
    /// The formula that decides.
    pub equation: Vec<Math>,
    /// The model of the pixel, where that is more than one number.
    pub matrices: Vec<Matrix>,
    /// The comparison and the class that follows from it, behind the pixel's name.
    pub verdict: Sentence,
    /// The model before and after the update, once the update is done.
    pub update: Sentence,
}

/// The comparison of a whole frame with the model.
#[derive(Default)]
pub struct Comparison {
    /// Its result, as sentences.
    pub sentence: Sentence,
    /// Its numbers.
    pub facts: Vec<Fact>,
    /// Its matrices.
    pub matrices: Vec<Matrix>,
}

/// The background value that a pixel is compared with.
#[derive(Clone, Copy)]
pub struct Expected {
    /// The gray level.
    pub value: f32,
    /// Its symbol in the formula.
    pub symbol: &'static str,
    /// Whether the background holds whole gray levels only.
    pub is_whole: bool,
}

impl Expected {
    /// A gray level of this background as text.
    pub fn text(self, value: f32) -> String {
        if self.is_whole { level(value) } else { gray(value) }
    }
}

/// The classification of a gray value by its absolute difference from the background and a threshold in gray levels.
pub fn compared(value: f32, expected: Expected, threshold: f32) -> Explanation {
    let difference = (value - expected.value).abs();
    let is_foreground = difference > threshold;
    let role = if is_foreground { Role::Result } else { Role::Rejected };
    let [background, off, limit] = [expected.value, difference, threshold].map(|value| expected.text(value));
    let shown = level(value);
    let symbols = Math::Row(vec![
        Math::Abs(Box::new(Math::Row(vec![Math::Var("I"), Math::text(" − "), Math::Var(expected.symbol)]))),
        Math::text(" > "),
        Math::Var("T"),
    ]);
    let numbers = Math::Row(vec![
        Math::Abs(Box::new(Math::Row(vec![
            Math::ink(Role::Measured, shown.clone()),
            Math::text(" − "),
            Math::ink(Role::Predicted, background.clone()),
        ]))),
        Math::text(" = "),
        Math::ink(role, off.clone()),
        Math::text(if is_foreground { format!(" > {limit}") } else { format!(" ≤ {limit}") }),
    ]);
    Explanation {
        facts: vec![
            Fact::new("Gray level", shown.clone(), Some(Role::Measured)),
            Fact::new("Background", background.clone(), Some(Role::Predicted)),
            Fact::new("Difference", off.clone(), Some(role)),
            Fact::new("Threshold", limit.clone(), None),
        ],
        equation: vec![symbols, numbers],
        verdict: Sentence::default()
            .text(": gray level ")
            .ink(Role::Measured, shown)
            .text(", background ")
            .ink(Role::Predicted, background)
            .text(". The difference ")
            .ink(role, off)
            .text(match is_foreground {
                true => format!(" exceeds the threshold {limit}: foreground."),
                false => format!(" is within the threshold {limit}: background."),
            }),
        ..Explanation::default()
    }
}
