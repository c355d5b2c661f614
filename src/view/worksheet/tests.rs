//! Every estimator has worksheets, and what is left out on them is told nowhere but on the sheet with answers.

use motionscope_core::scene::{Math, Matrix, Readout};
use motionscope_core::{AnyEstimator, Cursor, estimators, examples};

use super::blanks::{Answer, Part};
use super::equation::exercise;
use super::numbers::{is_telling, of};
use super::*;
use crate::experiment::source::Source;
use crate::experiment::{Experiment, Prepared};
use crate::media::Open;
use crate::paint::charts::explanation::equation_of;
use crate::paint::charts::matrices::entries;
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

fn numbers_in(answers: &[Answer], part: Part) -> Vec<String> {
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
    let known = numbers_in(&left_out.answers, Part::Matrices);
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

#[test]
fn answers_stand_on_the_sheet_with_answers_alone() {
    for (id, cursor) in [("full-search", "40.60"), ("kalman-filter", "4.4"), ("horn-schunck", "1.3")] {
        let estimator = motionscope_core::estimator(id).expect("an estimator");
        let prepared = sample(&*estimator);
        let cursor: Cursor = cursor.parse().expect("a cursor");
        let look = Look { theme: THEME, ..Look::default() };
        let stand = Stand { prepared: &prepared, cursor, pixel: None, look, freehand: Freehand::default() };
        let sheets = |answers: bool| {
            let about = About { title: "A title", prose: None, answers };
            about.sheets(&stand, None).unwrap_or_else(|why| panic!("{id}: {why}"))
        };
        let (left_out, solved) = (words(&sheets(false)), words(&sheets(true)));
        let text = |words: &[(f32, String)]| words.iter().map(|(_, words)| format!("{words}\n")).collect::<String>();
        let texts = [text(&left_out), text(&solved)];
        assert!(texts[0].contains("Name") && texts[0].contains("Calculation"), "{id}");
        assert!(texts[1].contains("Why") && !texts[1].contains("Name"), "{id}");
        let [given, all] = texts.map(|text| of(&text));
        let added: Vec<_> = all.into_iter().filter(|number| !given.contains(number)).collect();
        assert!(added.iter().any(|number| is_telling(number)), "{id}: {added:?}");
        let small = left_out.iter().chain(&solved).find(|(size, words)| *size < 7.9 && words.chars().count() > 3);
        assert_eq!(small, None, "{id}");
        for placed in [sheets(false), sheets(true)].iter().flatten().flat_map(|sheet| &sheet.figures) {
            let end = [0, 1].map(|i| placed.at[i] + placed.figure.size[i] * placed.scale);
            assert!(end[0] <= 596.0 && end[1] <= 843.0, "{id}: {end:?}");
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
