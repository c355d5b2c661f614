//! Lessons on paper: the handout with all pages, and the worksheet of one.

use motionscope_core::Error;

use super::{Lesson, Page};
use crate::experiment::pixel::Chosen;
use crate::experiment::{Position, Prepared};
use crate::media::export::Inputs;
use crate::media::{Open, Progress};
use crate::paint::Freehand;
use crate::session::Session;
use crate::view::handout::{Handout, Options};
use crate::view::look::Look;
use crate::view::page::{Stand, Words};
use crate::view::paper::THEME;
use crate::view::worksheet::About;

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
    fn open(page: &Page, guard: Guard<'_>) -> Result<Self, Error> {
        let Session { experiment, position, look, freehand, .. } = page.session.clone()?;
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
pub fn handout(
    lesson: &Lesson,
    options: Options,
    guard: Guard<'_>,
    progress: Option<&dyn Progress>,
) -> Result<Vec<u8>, Error> {
    filled(lesson, options, guard, progress)?.encode()
}

/// The handout with all pages.
fn filled(
    lesson: &Lesson,
    options: Options,
    guard: Guard<'_>,
    progress: Option<&dyn Progress>,
) -> Result<Handout, Error> {
    lesson.check()?;
    let count = lesson.pages.len();
    let mut handout = Handout::new(&lesson.title, options);
    for (page, number) in lesson.pages.iter().zip(1..) {
        let printed = Printed::open(page, guard)?;
        let prose = page.words.as_ref().map_err(Clone::clone)?;
        let words = Words { lesson: &lesson.title, title: &page.title, number: [number, count], prose };
        let answer = page.until.filter(|_| page.has_answer());
        handout.add(&words, printed.stand(), answer, progress)?;
        if let Some(progress) = progress {
            progress.report(number as f32 / count as f32);
        }
    }
    Ok(handout)
}

/// Makes the worksheet of the page of `lesson` with this index: of the step that it leads to, filled in if `answers` are asked for.
///
/// # Errors
/// If there is no such page, it is wrong, its step computes nothing that can be asked for, or the work was cancelled.
pub fn worksheet(
    (lesson, index): (&Lesson, usize),
    answers: bool,
    guard: Guard<'_>,
    progress: Option<&dyn Progress>,
) -> Result<Vec<u8>, Error> {
    let page = lesson.page(index)?;
    let prose = page.words.as_ref().map_err(Clone::clone)?;
    let printed = Printed::open(page, guard)?;
    let stand = printed.stand();
    let stand = Stand { cursor: page.until.unwrap_or(stand.cursor), ..stand };
    let title = format!("{} · {}", lesson.title, page.title);
    About { title: &title, prose: Some(prose), answers }.encode(&stand, progress)
}

#[cfg(test)]
mod tests {
    use super::super::all;
    use super::*;
    use crate::paint::Placed;
    use crate::paint::Primitive;
    use crate::paint::primitive::Rect;
    use crate::view::handout::PerSheet;

    /// What a placed figure covers of the sheet.
    fn covered(placed: &Placed) -> Rect {
        Rect::new(placed.at, placed.figure.size.map(|side| side * placed.scale))
    }

    /// The sizes of type on paper, and the words.
    fn words(placed: &Placed) -> Vec<(f32, String)> {
        let primitives = placed.figure.layers.iter().flat_map(|layer| &layer.primitives);
        let words = primitives.filter_map(|primitive| match primitive {
            Primitive::Text(line) => {
                Some((line.size * placed.scale, line.runs.iter().map(|run| run.text.as_str()).collect()))
            }
            _ => None,
        });
        words.collect()
    }

    fn faults(lesson: &Lesson, options: Options) -> Vec<String> {
        let handout = filled(lesson, options, &|_| Ok(()), None).unwrap_or_else(|why| panic!("{}: {why}", lesson.slug));
        let sheets = handout.into_sheets();
        assert_eq!(sheets.len(), lesson.pages.len().div_ceil(options.per_sheet.count()), "{}", lesson.slug);
        let mut faults = Vec::new();
        for (sheet, number) in sheets.iter().zip(1..) {
            let place = format!("{}, {options:?}, sheet {number}", lesson.slug);
            let rects: Vec<Rect> = sheet.figures[1..].iter().map(covered).collect();
            for (i, rect) in rects.iter().enumerate() {
                if rect.min[0] < 39.0 || rect.max[0] > 556.0 || rect.max[1] > 790.0 {
                    faults.push(format!("{place}: {rect:?} leaves the sheet"));
                }
                let met = rects[..i].iter().find(|other| other.grown(-1.0).meets(&rect.grown(-1.0)));
                faults.extend(met.map(|other| format!("{place}: {rect:?} covers {other:?}")));
            }
            let all = sheet.figures.iter().flat_map(words);
            let small: Vec<_> = all.filter(|(size, words)| *size < 7.9 && words.chars().count() > 3).collect();
            faults.extend(small.first().map(|(size, words)| format!("{place}: {words} in {size} pt")));
        }
        faults
    }

    #[test]
    fn every_lesson_can_be_read_on_paper() {
        let faults: Vec<_> = all().iter().flat_map(|lesson| faults(lesson, Options::default())).collect();
        assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
    }

    #[test]
    fn a_lesson_has_as_many_pages_on_a_sheet_as_are_asked_for_and_its_answers() {
        let lesson = &all()[1];
        let choices = PerSheet::ALL.into_iter().flat_map(|per_sheet| [(per_sheet, false), (per_sheet, true)]);
        let found: Vec<_> =
            choices.flat_map(|(per_sheet, answers)| faults(lesson, Options { per_sheet, answers })).collect();
        assert!(found.is_empty(), "{}", found.join("\n"));
        let text = |answers: bool| {
            let options = Options { answers, ..Options::default() };
            let handout = filled(lesson, options, &|_| Ok(()), None).expect("a lesson of the course");
            let figures = handout.into_sheets().into_iter().flat_map(|sheet| sheet.figures);
            figures.flat_map(|placed| words(&placed)).map(|(_, words)| words).collect::<Vec<_>>().join("\n")
        };
        assert!(lesson.pages.iter().any(Page::has_answer));
        let (with, without) = (text(true), text(false));
        assert!(with.contains("Answer: ") && !without.contains("Answer: "));
        let titles = lesson.pages.iter().zip(1..).map(|(page, number)| format!("{number}  {}", page.title));
        let places: Vec<_> = titles.map(|title| without.find(&title)).collect();
        assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{places:?}");
    }
}
