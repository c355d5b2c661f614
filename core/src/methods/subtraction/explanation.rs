//! The classification of a single pixel and the update of its model, in words and numbers.

use super::channels::{Channel, largest};
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
pub struct FrameComparison {
    /// Its result, as sentences.
    pub sentence: Sentence,
    /// Its numbers.
    pub facts: Vec<Fact>,
    /// Its matrices.
    pub matrices: Vec<Matrix>,
}

/// A pixel and the background that it is compared with, in one channel or in three.
pub struct Comparison<'a> {
    /// The levels of the pixel.
    pub pixel: &'a [u8],
    /// The levels of the background.
    pub background: &'a [f32],
    /// Whether the background holds whole levels only.
    pub is_whole: bool,
    /// The threshold on the difference.
    pub threshold: f32,
}

/// Values in one channel or in three as text.
pub fn tuple<T: Copy>(values: &[T], text: impl Fn(T) -> String) -> String {
    match values {
        [one] => text(*one),
        // No-break spaces.
        all => format!("({})", all.iter().map(|value| text(*value)).collect::<Vec<_>>().join(",\u{a0}")),
    }
}

/// What is compared, with and without a capital: a gray level or a color.
pub fn kind(channels: usize) -> [&'static str; 2] {
    if channels == 1 { ["Gray level", "gray level"] } else { ["Colour", "colour"] }
}

/// A variable, with c for the channel where there are several.
pub fn of_channel(symbol: &'static str, channels: usize) -> Math {
    if channels == 1 { Math::Var(symbol) } else { Math::indexed(Math::Var(symbol), Math::Var("c")) }
}

/// A difference with the channel that it is found in, where there are several.
pub fn in_channel(difference: &str, channel: Channel) -> String {
    channel.name().map_or_else(|| difference.to_owned(), |name| format!("{difference} in {name}"))
}

/// The maximum over the channels of a difference, where there are several.
pub fn most(difference: Math, channels: usize) -> Math {
    if channels == 1 {
        return difference;
    }
    Math::Row(vec![Math::indexed(Math::text("max"), Math::Var("c")), Math::text(" "), difference])
}

impl Comparison<'_> {
    /// The classification of the pixel by its largest absolute difference from the background and the threshold.
    pub fn explained(&self) -> Explanation {
        let channels = self.pixel.len();
        let text = |value: f32| if self.is_whole { level(value) } else { gray(value) };
        let offs: Vec<f32> = self.pixel.iter().zip(self.background).map(|(i, b)| (f32::from(*i) - b).abs()).collect();
        let (channel, difference) = largest(&offs);
        let at = channel.index();
        let is_foreground = difference > self.threshold;
        let role = if is_foreground { Role::Result } else { Role::Rejected };
        let [off, limit] = [difference, self.threshold].map(text);
        let [shown, background] = [tuple(self.pixel, |i| level(f32::from(i))), tuple(self.background, text)];
        let size = |inner: Vec<Math>| Math::Abs(Box::new(Math::Row(inner)));
        let [pixel, expected] =
            [("I", channels), ("B", channels)].map(|(symbol, channels)| of_channel(symbol, channels));
        let symbols = Math::Row(vec![
            most(size(vec![pixel, Math::text(" − "), expected]), channels),
            Math::text(" > "),
            Math::Var("T"),
        ]);
        let numbers = Math::Row(vec![
            size(vec![
                Math::ink(Role::Measured, level(f32::from(self.pixel[at]))),
                Math::text(" − "),
                Math::ink(Role::Predicted, text(self.background[at])),
            ]),
            Math::text(" = "),
            Math::ink(role, off.clone()),
            Math::text(if is_foreground { format!(" > {limit}") } else { format!(" ≤ {limit}") }),
            Math::text(channel.name().map_or_else(String::new, |name| format!(" in {name}"))),
        ]);
        let [name, lower] = kind(channels);
        let label = if channels == 1 { "Difference" } else { "Largest difference" };
        let off = in_channel(&off, channel);
        Explanation {
            facts: vec![
                Fact::new(name, shown.clone(), Some(Role::Measured)),
                Fact::new("Background", background.clone(), Some(Role::Predicted)),
                Fact::new(label, off.clone(), Some(role)),
                Fact::new("Threshold", limit.clone(), None),
            ],
            equation: vec![symbols, numbers],
            verdict: Sentence::default()
                .text(format!(": {lower} "))
                .ink(Role::Measured, shown)
                .text(", background ")
                .ink(Role::Predicted, background)
                .text(format!(". The {} ", label.to_lowercase()))
                .ink(role, off)
                .text(match is_foreground {
                    true => format!(" exceeds the threshold {limit}: foreground."),
                    false => format!(" is within the threshold {limit}: background."),
                }),
            ..Explanation::default()
        }
    }
}
