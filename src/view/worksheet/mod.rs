//! The worksheet of a step: what is given is printed, what the step computes is left out and asked for; and the same sheet filled in.
//!
//! Which numbers are results follows from the readouts alone, so every estimator has worksheets (`blanks.rs`). A number is left out only
//! where it can be computed by hand from what is printed (`reach.rs`); otherwise the decision of the step is asked for (`decision.rs`).
//! What would tell either is left out with it (`facts.rs`).
//!
//! A number that is left out is a box (`formula::blank`), an entry that is NaN, or an empty cell (`charts/table.rs`); the same
//! parts are filled in for the answers. `equation.rs` finds the value behind the last sign of a formula, `blanks.rs` the
//! matrices that the formulas define and the entries that no given matrix has, `grids.rs` cuts pixels and costs to a size that
//! can be computed by hand, and `windows.rs` prints corners of compared windows with the sums of their other pixels.
//! `settings.rs` lists every parameter with an effect.

mod blanks;
mod decision;
mod equation;
mod facts;
mod grids;
mod numbers;
mod reach;
mod settings;
mod sheet;
mod vector;
mod windows;

use motionscope_core::base::Error;
use motionscope_core::run::{Direction, Move, Walk};
use motionscope_core::scene::{Focus, Step};

use self::blanks::{Asked, Exercise};
use self::numbers::Fill;
use super::moment::{Moment, Viewer};
use super::page::Stand;
use crate::media::Progress;
use crate::paint::charts::prose::Prose;
use crate::paint::{Sheet, export_sheets};

/// What a worksheet is about.
#[derive(Clone, Copy)]
pub struct About<'a> {
    /// The title of the lesson or of the estimator.
    pub title: &'a str,
    /// The words of the page, if it is one of a lesson.
    pub prose: Option<&'a Prose>,
    /// Whether it is filled in.
    pub answers: bool,
}

impl About<'_> {
    fn fill(&self) -> Fill {
        if self.answers { Fill::Answer } else { Fill::Blank }
    }

    /// The worksheet of the step at `stand` as a PDF.
    ///
    /// # Errors
    /// As [`About::sheets`].
    pub async fn encode(&self, stand: &Stand<'_>, progress: Option<&dyn Progress>) -> Result<Vec<u8>, Error> {
        export_sheets(self.title, &self.sheets(stand, progress).await?)
    }

    /// The sheets of the worksheet of the step at `stand`.
    ///
    /// # Errors
    /// If the run cannot start or breaks off, the step computes nothing that can be asked for, or the work was cancelled.
    pub async fn sheets(&self, stand: &Stand<'_>, progress: Option<&dyn Progress>) -> Result<Vec<Sheet>, Error> {
        let sheets = |viewer: &mut Viewer<'_>, focus| {
            let moment = viewer.moment(focus)?;
            let step = asked(&moment).clone();
            let earlier = steps_before(&mut *viewer.walk, focus, windows::steps_before(&step));
            let questions = stand.estimator().questions();
            let asked = Asked { step: &step, unit: moment.cursor.unit, earlier: &earlier, questions };
            let exercise = Exercise::of(&asked, self.fill());
            if exercise.is_empty() {
                let why = format!(
                    "step {} of {} has nothing to compute or decide on paper; choose a step with a formula or matrices",
                    moment.cursor,
                    stand.estimator().info().id
                );
                return Err(Error::new(why));
            }
            Ok(sheet::Content { about: *self, stand, moment: &moment, step: &step, exercise: &exercise }.sheets())
        };
        stand.seen(progress, sheets).await
    }
}

/// The steps before the one at which `walk` stands, latest first, at most `count` of them.
fn steps_before(walk: &mut dyn Walk, focus: Option<Focus>, count: usize) -> Vec<Step> {
    let last = walk.info().granularities.len() - 1;
    let before = || {
        walk.jump(Move::Granularity(last, Direction::Back));
        walk.step(focus)
    };
    std::iter::repeat_with(before).take(count).collect()
}

/// The step that is asked for: of several in lockstep that of the first.
fn asked(moment: &Moment) -> &Step {
    moment.tiles.first().map_or(&moment.step, |tile| &tile.step)
}

#[cfg(test)]
mod tests;
