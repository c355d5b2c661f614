use super::super::all;
use super::*;
use motionscope_core::scene::Picture;

use crate::paint::primitive::{Line, Rect};
use crate::paint::{FreehandLine, PenColor, Placed, Primitive};
use crate::view::handout::PerSheet;

/// The part of the sheet that a placed figure covers.
fn covered(placed: &Placed) -> Rect {
    Rect::new(placed.at, placed.figure.size.map(|side| side * placed.scale))
}

/// The lines of words of a figure.
fn texts(placed: &Placed) -> impl Iterator<Item = &Line> {
    let primitives = placed.figure.layers.iter().flat_map(|layer| &layer.primitives);
    primitives.filter_map(|primitive| if let Primitive::Text(line) = primitive { Some(line) } else { None })
}

fn plain(line: &Line) -> String {
    line.runs.iter().map(|run| run.text.as_str()).collect()
}

/// The sizes of type on paper, and the words.
fn words(placed: &Placed) -> Vec<(f32, String)> {
    texts(placed).map(|line| (line.size * placed.scale, plain(line))).collect()
}

/// The words of a block that leave its rectangle, where other figures can cover them.
fn cut(placed: &Placed) -> Vec<String> {
    let [width, height] = placed.figure.size;
    let leaves = |line: &&Line| {
        let [x, y] = line.start();
        x < -1.0 || x + line.width() > width + 1.0 || y < 0.0 || y > height + 1.0
    };
    texts(placed).filter(leaves).map(plain).collect()
}

fn faults(lesson: &Lesson, options: Options) -> Vec<String> {
    let handout =
        work::finish(filled(lesson, options, &|_| Ok(()), None)).unwrap_or_else(|why| panic!("{}: {why}", lesson.slug));
    let sheets = handout.into_sheets();
    // A page with many words has a sheet of its own.
    let least = lesson.pages.len().div_ceil(options.per_sheet.count());
    assert!((least..=lesson.pages.len()).contains(&sheets.len()), "{}", lesson.slug);
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
        // Only words have their own size; pictures take that of their panes.
        let blocks = sheet.figures.iter().filter(|placed| placed.scale == 1.0);
        faults.extend(blocks.flat_map(cut).map(|words| format!("{place}: {words} leaves its block")));
        let all = sheet.figures.iter().flat_map(words);
        let small: Vec<_> = all.filter(|(size, words)| *size < 7.9 && words.chars().count() > 3).collect();
        faults.extend(small.first().map(|(size, words)| format!("{place}: {words} in {size} pt")));
    }
    faults
}

fn assert_that_all_can_be_read(per_sheet: PerSheet) {
    let options = Options { per_sheet, ..Options::default() };
    let faults: Vec<_> = all().iter().flat_map(|lesson| faults(lesson, options)).collect();
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn every_lesson_can_be_read_with_a_page_on_a_sheet() {
    assert_that_all_can_be_read(PerSheet::One);
}

#[test]
fn every_lesson_can_be_read_with_two_pages_on_a_sheet() {
    assert_that_all_can_be_read(PerSheet::Two);
}

#[test]
fn every_lesson_can_be_read_with_four_pages_on_a_sheet() {
    assert_that_all_can_be_read(PerSheet::Four);
}

/// A lesson whose pages have so many words.
fn wordy(counts: &[usize]) -> Lesson {
    let page = |count: &usize| {
        let words = "word ".repeat(*count);
        format!("+++\ntitle = \"P\"\nclip = \"synth:pillar\"\nestimator = \"full-search\"\n+++\n{words}\n\n")
    };
    let text = format!("# Wordy\n\nWords.\n\n{}", counts.iter().map(page).collect::<String>());
    Lesson::parse("wordy", &text, std::path::Path::new(".")).expect("a lesson")
}

#[test]
fn words_without_room_get_a_sheet_or_are_refused() {
    let options = Options { per_sheet: PerSheet::Four, answers: false };
    let (short, long) = (wordy(&[10, 10, 10]), wordy(&[10, 500, 10]));
    let count = |lesson: &Lesson| {
        work::finish(filled(lesson, options, &|_| Ok(()), None))
            .unwrap_or_else(|why| panic!("{why}"))
            .into_sheets()
            .len()
    };
    assert_eq!([count(&short), count(&long)], [1, 3], "the long page has a sheet of its own");
    assert_eq!(faults(&long, options), Vec::<String>::new());
    let refused =
        work::finish(filled(&wordy(&[10, 1500]), options, &|_| Ok(()), None)).err().map(|why| why.to_string());
    let refused = refused.expect("more than a sheet");
    assert!(refused.starts_with("page 2 of Wordy: ") && refused.contains("do not fit"), "{refused}");
}

#[test]
fn a_page_asks_by_its_header_or_by_its_words() {
    let mut page = wordy(&[3]).pages.remove(0);
    page.until = Some(motionscope_core::run::Cursor { unit: 1, event: 2 });
    assert!(!page.asks(), "several steps are no question");
    page.predicts = true;
    assert!(page.asks());
    let asked = all().iter().flat_map(|lesson| &lesson.pages).filter(|page| !page.predicts && page.asks());
    assert!(asked.count() > 5, "questions in the words");
}

#[test]
fn a_worksheet_has_the_ink_of_its_page_with_answers_alone() {
    let plain = &all()[1];
    let index = plain.pages.iter().position(|page| page.until.is_some()).expect("a page with steps");
    let mut inked = plain.clone();
    let step = inked.pages[index].until.expect("its last step");
    let points = vec![[20.0, 20.0], [120.0, 90.0]];
    let line = FreehandLine { step, member: 0, on: Picture::CURRENT.into(), color: PenColor::Vermilion, points };
    inked.pages[index].session.as_mut().expect("a page of the course").freehand.lines.push(line);
    let sheet = |lesson: &Lesson, answers: bool| {
        work::finish(worksheet((lesson, index), answers, &|_| Ok(()), None)).unwrap_or_else(|why| panic!("{why}"))
    };
    assert!(sheet(plain, false) == sheet(&inked, false), "ink where results are left out");
    assert!(sheet(plain, true) != sheet(&inked, true), "no ink beside the answers");
}

#[test]
fn a_worksheet_that_cannot_be_made_names_its_page() {
    let refused =
        work::finish(worksheet((&wordy(&[3]), 0), false, &|_| Ok(()), None)).expect_err("no results").to_string();
    assert!(refused.starts_with("page 1 of Wordy: "), "{refused}");
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
        let handout = work::finish(filled(lesson, options, &|_| Ok(()), None)).expect("a lesson of the course");
        let figures = handout.into_sheets().into_iter().flat_map(|sheet| sheet.figures);
        figures.flat_map(|placed| words(&placed)).map(|(_, words)| words).collect::<Vec<_>>().join("\n")
    };
    assert!(lesson.pages.iter().any(|page| page.asks() && page.until.is_some()));
    let (with, without) = (text(true), text(false).replace('\n', " "));
    assert!(with.contains("Answer: ") && !without.contains("Answer: "));
    let titles = lesson.pages.iter().zip(1..).map(|(page, number)| format!("{number}  {}", page.title));
    let places: Vec<_> = titles.map(|title| without.find(&title)).collect();
    assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{places:?}");
}
