//! Every estimator has worksheets, and what is left out of a formula or a matrix stands in no later part of it.

use motionscope_core::scene::{Math, Matrix, Readout};
use motionscope_core::{AnyEstimator, Cursor, estimators, examples};

use super::blanks::{Answer, Part as Place};
use super::equation::exercise;
use super::numbers::{is_telling, of};
use super::*;
use crate::experiment::source::Source;
use crate::experiment::{Experiment, Prepared};
use crate::media::Open;
use crate::paint::charts::explanation::equation_of;
use crate::paint::charts::matrices::entries;
use crate::paint::charts::prose::{Part, Span};
use crate::paint::primitive::Line;
use crate::paint::{Freehand, Placed, Primitive};
use crate::view::look::Look;
use crate::view::paper::THEME;

/// Steps of a run that are looked at.
const STEPS: usize = 40;

/// The first example of an estimator, or a moving scene.
fn sample(estimator: &dyn AnyEstimator) -> Prepared {
    let example = examples::of(estimator.info().id).next();
    let mut estimator = estimator.boxed_clone();
    let settings = example.map_or(&[][..], |example| example.settings);
    settings.iter().for_each(|(name, value)| estimator.set(name, value).expect("a setting of an example"));
    let clip = example.map_or("traffic", |example| example.clip);
    let source = Source::parse(format!("synth:{clip}")).expect("a scene of an example");
    let frame = example.map_or(0, |example| example.frame);
    let experiment = Experiment { frame, ..Experiment::new(source, estimator) };
    Prepared::open(experiment, Open::default()).expect("the clip of an example")
}

fn steps(prepared: &Prepared) -> Vec<Step> {
    let mut walk = prepared.experiment.walk(&prepared.clip).expect("a run");
    let last = walk.info().granularities.len() - 1;
    let mut steps = vec![walk.step(None)];
    while steps.len() < STEPS && !walk.at_end() {
        walk.go(Move::Granularity(last, Direction::Forward));
        while !walk.work(&mut || true) {}
        steps.push(walk.step(None));
    }
    steps
}

/// The last step of a run.
fn last(prepared: &Prepared) -> Step {
    let mut walk = prepared.experiment.walk(&prepared.clip).expect("a run");
    walk.jump(Move::End);
    walk.step(None)
}

fn has_matrices(step: &Step) -> bool {
    step.readouts.iter().any(|readout| matches!(readout, Readout::Matrices(all) if !all.is_empty()))
}

fn plain(lines: &[Math]) -> Vec<String> {
    lines.iter().map(Math::plain).collect()
}

fn numbers_in(answers: &[Answer], part: Place) -> Vec<String> {
    answers.iter().filter(|answer| answer.part == part).map(|answer| answer.number.clone()).collect()
}

/// The entries of a matrix that are not left out.
fn left(matrix: &Matrix) -> Vec<String> {
    let values = matrix.entries.cells().iter();
    let words = entries(matrix).cells().to_vec();
    values.zip(words).filter(|(value, _)| !value.is_nan()).map(|(_, word)| word).collect()
}

/// What is wrong with the exercise of a step.
fn faults(step: &Step, before: &Step) -> Vec<String> {
    let [left_out, solved] = [Fill::Blank, Fill::Answer].map(|fill| Exercise::of(step, Some(before), fill));
    let mut faults = Vec::new();
    if plain(&solved.equation) != plain(equation_of(step)) {
        faults.push(format!("the filled formula is not that of the step: {:?}", plain(&solved.equation)));
    }
    // A result stands in no later line of its formula; where it is equal to what is given it stands before its sign.
    let known = numbers_in(&left_out.answers, Place::Matrices);
    let equation = exercise(equation_of(step), &known, Fill::Blank);
    for (line, answer) in equation.answers.iter().filter(|(_, answer)| is_telling(answer)) {
        let mut later = equation.lines.iter().skip(line + 1).flat_map(|line| of(&line.plain()));
        if later.any(|number| number == *answer) {
            faults.push(format!("{answer} stands in a later line: {:?}", plain(&equation.lines)));
        }
    }
    for number in known {
        if left_out.matrices.iter().any(|matrix| left(matrix).contains(&number)) {
            faults.push(format!("the entry {number} is not left out everywhere"));
        }
        if !solved.matrices.iter().any(|matrix| left(matrix).contains(&number)) {
            faults.push(format!("the entry {number} is no answer"));
        }
    }
    faults
}

#[test]
fn every_estimator_with_formulas_or_matrices_has_exercises() {
    let mut all = Vec::new();
    for estimator in estimators() {
        let id = estimator.info().id;
        let steps = steps(&sample(&*estimator));
        let pairs = || steps.windows(2).map(|pair| (&pair[1], &pair[0]));
        all.extend(pairs().flat_map(|(step, before)| faults(step, before)).map(|fault| format!("{id}: {fault}")));
        let asks = |step: &Step| !equation_of(step).is_empty() || has_matrices(step);
        let has_exercise = pairs().any(|(step, before)| !Exercise::of(step, Some(before), Fill::Blank).is_empty());
        let asked = steps.iter().any(asks);
        // What has no numbers in its first steps has some at the end.
        if asked && !has_exercise && Exercise::of(&last(&sample(&*estimator)), None, Fill::Blank).is_empty() {
            all.push(format!("{id}: nothing is left out in {} steps or at the end", steps.len()));
        }
    }
    all.dedup();
    assert!(all.is_empty(), "{} faults:\n{}", all.len(), all.join("\n"));
}

/// A part of a page that says `text`.
fn said(text: String) -> Part {
    Part::Paragraph(vec![Span { text, ..Span::default() }])
}

/// The words on sheets with their sizes on paper.
fn words(sheets: &[Sheet]) -> Vec<(f32, String)> {
    let of_figure = |placed: &Placed| -> Vec<(f32, String)> {
        let primitives = placed.figure.layers.iter().flat_map(|layer| &layer.primitives);
        let words = primitives.filter_map(|primitive| match primitive {
            Primitive::Text(line) => {
                Some((line.size * placed.scale, line.runs.iter().map(|run| run.text.as_str()).collect()))
            }
            _ => None,
        });
        words.collect()
    };
    sheets.iter().flat_map(|sheet| &sheet.figures).flat_map(of_figure).collect()
}

fn text_of(primitive: &Primitive) -> Option<&Line> {
    if let Primitive::Text(line) = primitive { Some(line) } else { None }
}

/// The numbers that are left out of the step at `stand`.
fn telling(stand: &Stand<'_>) -> Vec<String> {
    let mut walk = stand.prepared.experiment.walk(&stand.prepared.clip).expect("a run");
    walk.jump(Move::To(stand.cursor));
    let step = walk.step(None);
    let last = walk.info().granularities.len() - 1;
    walk.jump(Move::Granularity(last, Direction::Back));
    let answers = Exercise::of(&step, Some(&walk.step(None)), Fill::Blank).answers;
    answers.into_iter().map(|answer| answer.number).filter(|number| is_telling(number)).collect()
}

/// How often each number stands on a sheet before the explanation at its end.
fn counts(text: &str, numbers: &[String]) -> Vec<usize> {
    let tasks = text.split_once("\nWhy").map_or(text, |(tasks, _)| tasks);
    let all = of(tasks);
    numbers.iter().map(|number| all.iter().filter(|other| *other == number).count()).collect()
}

#[test]
fn answers_are_left_out_and_the_words_of_the_page_do_not_tell_them() {
    for (id, cursor) in [("full-search", "40.60"), ("kalman-filter", "4.4"), ("horn-schunck", "1.3")] {
        let estimator = motionscope_core::estimator(id).expect("an estimator");
        let prepared = sample(&*estimator);
        let cursor: Cursor = cursor.parse().expect("a cursor");
        let look = Look { theme: THEME, ..Look::default() };
        let stand = Stand { prepared: &prepared, cursor, pixel: None, look, freehand: Freehand::default() };
        let (title, numbers) = ("A title of many words. ".repeat(12), telling(&stand));
        let number = numbers.first().unwrap_or_else(|| panic!("{id}: nothing is left out"));
        let prose = Prose(vec![said("Given words.".into()), said(format!("Telling words: {number}."))]);
        let sheets = |answers: bool| {
            let about = About { title: &title, prose: Some(&prose), answers };
            about.sheets(&stand, None).unwrap_or_else(|why| panic!("{id}: {why}"))
        };
        let (left_out, solved) = (words(&sheets(false)), words(&sheets(true)));
        let text = |words: &[(f32, String)]| words.iter().map(|(_, words)| format!("{words}\n")).collect::<String>();
        let texts = [text(&left_out), text(&solved)];
        assert!(texts[0].contains("Name") && texts[0].contains("Calculation"), "{id}");
        assert!(texts[1].contains("Why") && !texts[1].contains("Name"), "{id}");
        assert!(texts[0].contains("Given words") && !texts[0].contains("Telling words"), "{id}: {number} is told");
        // One that is given as well stands there once more in its place.
        let [given, all] = texts.map(|text| counts(&text, &numbers));
        let is_left_out = given.iter().zip(&all).all(|(given, all)| given < all);
        assert!(is_left_out, "{id}: {numbers:?} stand there {given:?} times, with answers {all:?} times");
        let small = left_out.iter().chain(&solved).find(|(size, words)| *size < 7.9 && words.chars().count() > 3);
        assert_eq!(small, None, "{id}");
        for placed in [sheets(false), sheets(true)].iter().flatten().flat_map(|sheet| &sheet.figures) {
            let end = [0, 1].map(|i| placed.at[i] + placed.figure.size[i] * placed.scale);
            assert!(end[0] <= 596.0 && end[1] <= 843.0, "{id}: {end:?}");
            for line in placed.figure.layers.iter().flat_map(|layer| &layer.primitives).filter_map(text_of) {
                let right = placed.at[0] + (line.start()[0] + line.width()) * placed.scale;
                assert!(right <= 596.0, "{id}: {:?} ends at {right}", line.runs);
            }
        }
    }
}

#[test]
fn a_step_without_results_is_refused_with_what_to_do() {
    let estimator = motionscope_core::estimator("full-search").expect("an estimator");
    let prepared = sample(&*estimator);
    let stand = Stand {
        prepared: &prepared,
        cursor: Cursor::default(),
        pixel: None,
        look: Look::default(),
        freehand: Freehand::default(),
    };
    let about = About { title: "", prose: None, answers: false };
    let refused = about.sheets(&stand, None).expect_err("no results").to_string();
    assert!(refused.contains("choose a step"), "{refused}");
}
