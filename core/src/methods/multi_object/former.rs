//! The words of trackers whose steps are still put together from texts.

pub(crate) use crate::base::words::counted as count;

use super::selected::Selected;
use super::tables::Names;
use super::tracker_run::Conclusion;
use super::vocabulary::value;
use super::{explain, truth};
use crate::products::{ObjectFrame, objects::score::FrameErrors};
use crate::scene::{Fact, Sentence, Step, Unit};

crate::line_names!(NO_LINE);

/// The detections of a frame in words, and those discarded by the minimum score.
pub(crate) fn detected((all, one): (usize, &'static str), frame: usize, discarded: (usize, f32)) -> Sentence {
    let step = Step::at(NO_LINE).put(value::FRAME, frame);
    explain::found(step, (all, Unit::count(one)), discarded).sentence
}

/// The conclusion of a frame in words.
pub(crate) fn done(number: usize, frame: &ObjectFrame, conclusion: &Conclusion) -> String {
    explain::concluded(Step::at(NO_LINE).put(value::FRAME, number), frame, conclusion).sentence.plain()
}

/// The missed frames in a row.
pub(crate) fn missed_in_a_row(missed: usize) -> String {
    count(missed, "missed frame") + if missed == 1 { "" } else { " in a row" }
}

/// A velocity as speed and heading.
pub(crate) fn velocity(velocity: [f64; 2]) -> String {
    explain::moving(Step::at(NO_LINE), velocity).facts().iter().map(|fact| &*fact.value).collect()
}

impl Selected {
    /// Returns the track in words.
    pub fn sentence(&self) -> Sentence {
        self.told(self.noted(Step::at(NO_LINE))).sentence
    }

    /// Returns the track in numbers.
    pub fn facts(&self) -> Vec<Fact> {
        self.noted(Step::at(NO_LINE)).facts().to_vec()
    }
}

impl Names {
    /// Returns the shown part of a table that is too large.
    pub fn shown(&self) -> Option<Fact> {
        self.noted(Step::at(NO_LINE)).facts().first().cloned()
    }
}

/// Returns the errors as facts.
pub(crate) fn facts(errors: &FrameErrors) -> Vec<Fact> {
    truth::noted(Step::at(NO_LINE), errors).facts().to_vec()
}

/// Returns the identity switches of a frame in words.
pub(crate) fn switches(errors: &FrameErrors) -> String {
    let said = truth::switched(Step::at(NO_LINE), errors).sentence.plain();
    if said.is_empty() { said } else { format!(" {said}") }
}
