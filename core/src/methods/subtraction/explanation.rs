//! The classification of a single pixel and the update of its model, and the explanation shared by the background models.

use super::channels::{Channel, largest};
use super::noise::NOISE_SIGMAS;
use super::vocabulary::{case, value};
use crate::data::Frame;
use crate::scene::{Case, Number, Role, Step, Unit, Value};

/// Cases that are told one after the other.
pub type Cases = Vec<&'static Case>;

/// Tells cases.
pub fn say(step: Step, cases: &[&'static Case]) -> Step {
    cases.iter().fold(step, |step, case| step.say(case))
}

/// A pixel of a frame with the models that explain it.
pub struct Probe<'a, T> {
    /// The model that it is compared with.
    pub before: &'a T,
    /// The model after the update, once that is done.
    pub after: Option<&'a T>,
    /// The frame.
    pub frame: &'a Frame,
    /// The pixel.
    pub place: (usize, usize),
}

/// The classification of a pixel.
pub struct Explanation {
    /// The step with the values and formulas of the comparison, and the model of the pixel.
    pub step: Step,
    /// The comparison and the class that follows from it, behind the pixel's name.
    pub verdict: Cases,
    /// The model before and after the update, once the update is done.
    pub update: Cases,
}

impl Explanation {
    /// A step of which nothing more is known.
    pub fn of(step: Step) -> Self {
        Self { step, verdict: Vec::new(), update: Vec::new() }
    }
}

/// A pixel and the background that it is compared with, in one channel or in three.
pub struct Comparison {
    /// The levels of the pixel.
    pub pixel: Vec<u8>,
    /// The levels of the background.
    pub background: Vec<f32>,
    /// The levels of the background after the update, once that is done.
    pub after: Option<Vec<f32>>,
    /// The threshold on the difference, without decimals where the background holds whole levels only.
    pub threshold: Value,
    /// The class of the pixel.
    pub is_foreground: bool,
}

/// The end of a formula about the channel that decides.
pub const IN_CHANNEL: &str = r"\text{ in }{channel}";

/// Values in one channel or in three.
pub fn tuple<T: Copy + Into<f64>>(values: &[T]) -> Number {
    match values {
        [one] => Number::Real((*one).into()),
        all => Number::Vector(all.iter().map(|value| (*value).into()).collect()),
    }
}

/// Puts the levels of a pixel in one channel or in three; returns the case that tells them.
pub fn put_pixel<T: Copy + Into<f64>>(step: Step, pixel: &[T]) -> (Step, &'static Case) {
    let is_gray = pixel.len() == 1;
    let (of, case) = if is_gray { (value::GRAY_LEVEL, case::GRAY_LEVEL) } else { (value::COLOUR, case::COLOUR) };
    (step.fact(of, tuple(pixel)), case)
}

/// The role of a difference and the sign between it and the threshold, by the class of the pixel.
pub fn class(is_foreground: bool) -> (Role, &'static str) {
    if is_foreground { (Role::Result, ">") } else { (Role::Rejected, r"\le") }
}

impl Comparison {
    /// The classification of the pixel by its largest absolute difference from the background and the threshold.
    pub fn explained(&self, step: Step) -> Explanation {
        let offs: Vec<f32> = self.pixel.iter().zip(&self.background).map(|(i, b)| (f32::from(*i) - b).abs()).collect();
        let ((channel, difference), (role, sign)) = (largest(&offs), class(self.is_foreground));
        let (unit, at) = (self.threshold.unit, channel.index());
        let bare = |value: Value| value.in_unit(Unit { name: "", ..unit });
        let (step, level) = put_pixel(step, &self.pixel);
        let step = step
            .fact_of(bare(value::BACKGROUND.is(tuple(&self.background))))
            .fact_of(value::DIFFERENCE.is(difference).in_unit(unit).inked(role))
            .fact_if(value::CHANNEL, channel.name())
            .fact_of(self.threshold.clone())
            .put(value::LEVEL, self.pixel[at])
            .put_value(bare(value::EXPECTED.is(self.background[at])));
        let (symbols, within, off, moves) = match channel {
            Channel::Gray => ("|I - B| > T", "", case::DIFFERENCE, case::MOVES_TO_LEVEL),
            Channel::Color(_) => {
                (r"\max_c |I_c - B_c| > T", IN_CHANNEL, case::LARGEST_DIFFERENCE, case::MOVES_TO_COLOUR)
            }
        };
        let numbers = format!("|{{level}} - {{expected}}| = {{difference}} {sign} {{threshold}}{within}");
        let step = step.formula(symbols).formula(numbers);
        let verdict = vec![level, case::BACKGROUND, off, if self.is_foreground { case::EXCEEDS } else { case::WITHIN }];
        let Some(after) = &self.after else { return Explanation { step, verdict, update: Vec::new() } };
        let step = step.fact_of(bare(value::BACKGROUND_AFTER.is(tuple(after))));
        Explanation { step, verdict, update: vec![moves] }
    }
}

/// Puts the rule of a difference `from` frames, above a threshold in gray levels or, if that is 0, above the noise; returns with it the cases
/// that tell it.
pub fn difference_rule(step: Step, threshold: usize, [from, end]: [&'static Case; 2]) -> (Step, Cases) {
    let rule = if threshold == 0 { case::ABOVE_NOISE } else { case::ABOVE_THRESHOLD };
    let step = step.put(value::NOISE_SIGMAS, NOISE_SIGMAS);
    (step.put_value(value::THRESHOLD.is(threshold).in_unit(Unit::LEVEL)), vec![from, rule, end])
}
