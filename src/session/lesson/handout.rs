//! Lessons on paper: the handout with all pages, and the worksheet of one.

use motionscope_core::base::Error;

use super::{Lesson, Page};
use crate::experiment::pixel::Chosen;
use crate::experiment::{Position, Prepared};
use crate::media::export::Inputs;
use crate::media::{self, Open, Progress};
use crate::paint::Freehand;
use crate::session::Session;
use crate::view::handout::{Goal, Handout, Options};
use crate::view::look::Look;
use crate::view::page::{Stand, Words};
use crate::view::paper::THEME;
use crate::view::worksheet::About;
use crate::work;

/// What is asked about the files that a page reads, before anything of it is computed.
pub type Guard<'a> = &'a dyn Fn(&Inputs) -> Result<(), Error>;

/// A page as it is printed.
struct Printed {
    prepared: Prepared,
    position: Position,
    look: Look,
    freehand: Freehand,
}

impl Printed {
    /// Opens the run of `page`, in the colours of print.
    async fn open(page: &Page, guard: Guard<'_>) -> Result<Self, Error> {
        let Session { experiment, position, look, freehand, .. } = page.session.clone()?;
        let options = Open::from(experiment.given.clone());
        media::decode_ahead(&experiment.source.paths(), &options).await?;
        let prepared = Prepared::open(experiment, Open::default())?;
        guard(&prepared.inputs)?;
        Ok(Self { prepared, position, look: Look { theme: THEME, ..look.over(Look::default()) }, freehand })
    }

    /// The step of the page.
    fn stand(&self) -> Stand<'_> {
        let Self { prepared, position, look, freehand } = self;
        let cursor = position.cursor.unwrap_or_default();
        Stand { prepared, cursor, pixel: position.held.map(Chosen::Held), look: *look, freehand: freehand.clone() }
    }
}

/// Makes the handout of `lesson`. Before anything of a page is computed, `guard` is asked about the files that it reads.
///
/// # Errors
/// One sentence that names the page, or if the work was cancelled.
pub async fn handout(
    lesson: &Lesson,
    options: Options,
    guard: Guard<'_>,
    progress: Option<&dyn Progress>,
) -> Result<Vec<u8>, Error> {
    filled(lesson, options, guard, progress).await?.encode()
}

/// The handout with all pages.
async fn filled(
    lesson: &Lesson,
    options: Options,
    guard: Guard<'_>,
    progress: Option<&dyn Progress>,
) -> Result<Handout, Error> {
    lesson.check()?;
    let count = lesson.pages.len();
    let mut handout = Handout::new(&lesson.title, options);
    for number in 1..=count {
        work::breathe().await;
        let added = add(&mut handout, (lesson, number), guard, progress).await;
        added.map_err(|why| named(why, (lesson, number), progress))?;
        if let Some(progress) = progress {
            progress.report(number as f32 / count as f32);
        }
    }
    Ok(handout)
}

/// Adds the page with this number, from 1.
async fn add(
    handout: &mut Handout,
    (lesson, number): (&Lesson, usize),
    guard: Guard<'_>,
    progress: Option<&dyn Progress>,
) -> Result<(), Error> {
    let page = lesson.page(number - 1)?;
    let printed = Printed::open(page, guard).await?;
    let prose = page.words.as_ref().map_err(Clone::clone)?;
    let words = Words { lesson: &lesson.title, title: &page.title, number: [number, lesson.pages.len()], prose };
    handout.add(&words, printed.stand(), Goal { asks: page.asks(), until: page.until }, progress).await
}

/// What went wrong with a page, with its name, unless the work was cancelled.
fn named(why: Error, (lesson, number): (&Lesson, usize), progress: Option<&dyn Progress>) -> Error {
    if progress.is_some_and(|progress| progress.cancelled()) { why } else { lesson.fault(number, &why) }
}

/// Makes the worksheet of the page of `lesson` with this index: of the step that it leads to, filled in if `answers` are asked for.
///
/// # Errors
/// If there is no such page, it is wrong, its step computes nothing that can be asked for, or the work was cancelled.
pub async fn worksheet(
    (lesson, index): (&Lesson, usize),
    answers: bool,
    guard: Guard<'_>,
    progress: Option<&dyn Progress>,
) -> Result<Vec<u8>, Error> {
    let page = lesson.page(index)?;
    encoded(lesson, page, answers, (guard, progress)).await.map_err(|why| named(why, (lesson, index + 1), progress))
}

/// The worksheet of a page of `lesson`.
async fn encoded(
    lesson: &Lesson,
    page: &Page,
    answers: bool,
    (guard, progress): (Guard<'_>, Option<&dyn Progress>),
) -> Result<Vec<u8>, Error> {
    let prose = page.words.as_ref().map_err(Clone::clone)?;
    let printed = Printed::open(page, guard).await?;
    let stand = printed.stand();
    // What was drawn on the step can tell its results.
    let freehand = if answers { stand.freehand } else { Freehand::default() };
    let stand = Stand { cursor: page.until.unwrap_or(stand.cursor), freehand, ..stand };
    let title = format!("{} · {}", lesson.title, page.title);
    About { title: &title, prose: Some(prose), answers }.encode(&stand, progress).await
}

#[cfg(test)]
mod tests;
