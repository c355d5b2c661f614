//! Every estimator has worksheets, and what is left out of a formula or a matrix stands in no later part of it.

use motionscope_core::course::estimators;
use motionscope_core::run::Cursor;
use motionscope_core::scene::{Math, Matrix, Name, Question, Readout, Role, Unit};

use super::blanks::{Answer, Part as Place};
use super::numbers::{is_telling, of};
use super::*;
use crate::experiment::source::Source;
use crate::experiment::{Experiment, Prepared};
use crate::media::Open;
use crate::paint::charts::matrices::entries;
use crate::paint::charts::prose::{Part, Span};
use crate::paint::primitive::Line;
use crate::paint::{Freehand, Placed, Primitive};
use crate::view::look::Look;
use crate::view::paper::THEME;
use crate::view::samples::{InUnit, last, sample, steps, translated};
use crate::work;

motionscope_core::variables! {
    /// A number.
    A: "a", "a", Unit::FINE;
    /// A number.
    B: "b", "b", Unit::FINE, Role::Reference;
    /// A result.
    S: "s", "s", Unit::FINE;
    /// The result with further digits.
    FINER: "s", "s", Unit::new("", 4);
    /// A position.
    X: "x", "x", Unit::new("px", 2);
}

/// A formula of a = 0.25, b = 3.50, the result s = 5.25 and the position x = (65.44, 127.73).
pub(super) fn formula(template: &str) -> Math {
    let step = Step::at(Name::new(b"add")).put(value::A, 0.25).put(value::B, 3.5).put(value::S, 5.25);
    let step = step.put(value::FINER, 5.2501);
    step.put(value::X, [65.44, 127.73]).formula(template).formulas()[0].clone()
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

/// The exercise of the last of `steps`.
fn exercise(steps: &[InUnit], questions: &[Question], fill: Fill) -> Exercise {
    let ((step, unit), before) = steps.split_last().expect("a step");
    let earlier = before.iter().rev().take(windows::steps_before(step)).map(|(step, _)| step.clone());
    let earlier: Vec<Step> = earlier.collect();
    Exercise::of(&Asked { step, unit: *unit, earlier: &earlier, questions }, fill)
}

/// What is wrong with the exercise of the last of `steps`.
fn faults(steps: &[InUnit], questions: &[Question]) -> Vec<String> {
    let [left_out, solved] = [Fill::Blank, Fill::Answer].map(|fill| exercise(steps, questions, fill));
    let (step, unit) = &steps[steps.len() - 1];
    let mut faults = Vec::new();
    let alone = |step: Step| exercise(&[(step, *unit)], questions, Fill::Blank);
    let (foreign, own) = (alone(translated(step)), alone(step.clone()));
    if (&foreign.answers, &foreign.decision) != (&own.answers, &own.decision) {
        faults.push(format!("in another language {:?} are left out", foreign.answers));
    }
    if plain(&solved.equation.lines) != plain(step.formulas()) {
        faults.push(format!("the filled formula is not that of the step: {:?}", plain(&solved.equation.lines)));
    }
    // A result stands in no later line of its formula; where it is equal to what is given it stands before its sign.
    let known = numbers_in(&left_out.answers, Place::Matrices);
    let equation = &left_out.equation;
    for (line, answer) in equation.answers.iter().filter(|(_, answer)| is_telling(answer)) {
        let mut later = equation.lines.iter().skip(line + 1).flat_map(|line| of(&line.plain()));
        if later.any(|number| number == *answer) {
            faults.push(format!("{answer} stands in a later line: {:?}", plain(&equation.lines)));
        }
    }
    let is_open = solved.decision.as_ref().is_none_or(|decision| decision.right < decision.choices.len());
    if !is_open || left_out.decision != solved.decision {
        faults.push(format!("the decision has no answer: {:?}", solved.decision));
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
        let questions = estimator.questions();
        let whole = steps.as_slice();
        let up_to = || (2..=whole.len()).map(move |end| &whole[..end]);
        all.extend(up_to().flat_map(|steps| faults(steps, questions)).map(|fault| format!("{id}: {fault}")));
        let asks = |step: &Step| !step.formulas().is_empty() || has_matrices(step);
        let has_exercise = up_to().any(|steps| !exercise(steps, questions, Fill::Blank).is_empty());
        // What has no numbers in its first steps has some at the end.
        let at_end = || exercise(&[last(&sample(&*estimator))], questions, Fill::Blank);
        if steps.iter().any(|(step, _)| asks(step)) && !has_exercise && at_end().is_empty() {
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
    let earlier = steps_before(&mut *walk, None, windows::steps_before(&step));
    let questions = stand.estimator().questions();
    let asked = Asked { step: &step, unit: stand.cursor.unit, earlier: &earlier, questions };
    let answers = Exercise::of(&asked, Fill::Blank).answers;
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
        let estimator = motionscope_core::course::estimator(id).expect("an estimator");
        let prepared = sample(&*estimator);
        let cursor: Cursor = cursor.parse().expect("a cursor");
        let look = Look { theme: THEME, ..Look::default() };
        let stand = Stand { prepared: &prepared, cursor, pixel: None, look, freehand: Freehand::default() };
        let (title, numbers) = ("A title of many words. ".repeat(12), telling(&stand));
        let number = numbers.first().unwrap_or_else(|| panic!("{id}: nothing is left out"));
        let prose = Prose(vec![said("Given words.".into()), said(format!("Telling words: {number}."))]);
        let sheets = |answers: bool| {
            let about = About { title: &title, prose: Some(&prose), answers };
            work::finish(about.sheets(&stand, None)).unwrap_or_else(|why| panic!("{id}: {why}"))
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
    let estimator = motionscope_core::course::estimator("full-search").expect("an estimator");
    let prepared = sample(&*estimator);
    let stand = Stand {
        prepared: &prepared,
        cursor: Cursor::default(),
        pixel: None,
        look: Look::default(),
        freehand: Freehand::default(),
    };
    let about = About { title: "", prose: None, answers: false };
    let refused = work::finish(about.sheets(&stand, None)).expect_err("no results").to_string();
    assert!(refused.contains("choose a step"), "{refused}");
}

/// The sheets of a step.
fn sheets(prepared: &Prepared, cursor: &str, answers: bool) -> Vec<Sheet> {
    let cursor: Cursor = cursor.parse().expect("a cursor");
    let look = Look { theme: THEME, ..Look::default() };
    let stand = Stand { prepared, cursor, pixel: None, look, freehand: Freehand::default() };
    let about = About { title: "", prose: None, answers };
    work::finish(about.sheets(&stand, None)).unwrap_or_else(|why| panic!("{why}"))
}

/// The text of some sheets.
fn text_of_sheets(sheets: &[Sheet]) -> String {
    words(sheets).iter().map(|(_, words)| format!("{words}\n")).collect()
}

/// The text of the sheets of a step.
fn text(prepared: &Prepared, cursor: &str, answers: bool) -> String {
    text_of_sheets(&sheets(prepared, cursor, answers))
}

/// The first example of the estimator that is called so.
fn sample_of(id: &str) -> Prepared {
    sample(&*motionscope_core::course::estimator(id).expect("an estimator"))
}

#[test]
fn numbers_with_decimals_come_with_a_word_on_their_last_digit() {
    let count = |id: &str, cursor: &str, answers| {
        let text = text(&sample_of(id), cursor, answers);
        text.matches(sheet::PRECISION).count()
    };
    assert_eq!([false, true].map(|answers| count("kalman-filter", "4.4", answers)), [1, 1]);
    assert_eq!([false, true].map(|answers| count("full-search", "40.60", answers)), [0, 0], "whole numbers");
}

#[test]
fn there_is_room_to_calculate_where_something_is_computed() {
    let left_out = text(&sample_of("mean-shift"), "2.2", false);
    assert!(left_out.contains("Does this shift end the iterations?"), "{left_out}");
    assert!(!left_out.contains("Calculation") && left_out.contains("Why? Explain"), "{left_out}");
}

#[test]
fn no_sheet_has_nothing_but_lines() {
    let all = sheets(&sample_of("kalman-filter"), "4.4", false);
    assert!(all.len() > 1, "all that has no room on one sheet");
    let texts: Vec<String> = all.iter().map(|sheet| text_of_sheets(std::slice::from_ref(sheet))).collect();
    let last = texts.last().expect("a sheet");
    assert!(last.contains("Calculation") && last.contains("Compute the empty entries"), "{last}");
}

#[test]
fn the_algorithm_is_printed_once_with_the_parameters() {
    let solved = text(&sample_of("horn-schunck"), "1.2", true);
    assert!(solved.contains("Which line of the algorithm is this step?"), "{solved}");
    assert_eq!(solved.matches("for each iteration").count(), 1, "{solved}");
    let solved = text(&sample_of("kalman-filter"), "4.4", true).replace('\n', " ");
    assert!(solved.contains("Joseph form") && solved.contains("process noise"), "{solved}");
    assert!(!solved.contains("default parameters"), "{solved}");
}

#[test]
fn what_was_decided_stands_in_no_label() {
    let estimator = motionscope_core::course::estimator("harris").expect("an estimator");
    let source = Source::parse("synth:pillar").expect("a scene");
    let prepared = Prepared::open(Experiment::new(source, estimator), Open::default()).expect("a clip");
    let mut walk = prepared.experiment.walk(&prepared.clip).expect("a run");
    walk.jump(Move::End);
    let cursor = walk.cursor().to_string();
    let [left_out, solved] = [false, true].map(|answers| text(&prepared, &cursor, answers));
    assert!(left_out.contains("Is this local maximum kept?"), "{left_out}");
    assert!(!left_out.contains("Status") && left_out.contains("Threshold"), "{left_out}");
    assert!(solved.contains("Status"), "{solved}");
}

#[test]
fn a_search_is_done_on_paper_with_corners_of_several_candidates() {
    let estimator = motionscope_core::course::estimator("full-search").expect("an estimator");
    let prepared = sample(&*estimator);
    let [left_out, solved] = [false, true].map(|answers| text(&prepared, "40.60", answers));
    let part = "The 4×4 pixels in the upper left corner of each 16×16 window are printed.";
    assert!(left_out.contains(part) && left_out.contains("frame 0 · block size"), "{left_out}");
    assert!(left_out.matches("|difference|").count() == 3, "the candidate and two before it: {left_out}");
    assert!(left_out.matches("Sum over the other 240 pixels").count() == 3, "{left_out}");
    assert!(left_out.contains("u to the right, v down."), "the words of the table are whole: {left_out}");
    assert!(left_out.contains("Does this candidate lower the minimum of the block?"), "{left_out}");
    assert!(solved.contains("Why") && solved.contains("lower the minimum"), "{solved}");
}

#[test]
fn the_order_of_a_difference_with_a_sign_is_told() {
    let estimator = motionscope_core::course::estimator("block-stereo").expect("an estimator");
    let left_out = text(&sample(&*estimator), "2.30", false);
    assert!(left_out.contains("Compute the empty differences (best match − window)."), "{left_out}");
    assert!(left_out.contains("upper left corner of each 9×9 window"), "{left_out}");
}

#[test]
fn a_gate_is_decided_by_the_reader() {
    let estimator = motionscope_core::course::estimator("kalman-filter").expect("an estimator");
    let prepared = sample(&*estimator);
    let [left_out, solved] = [false, true].map(|answers| text(&prepared, "4.3", answers));
    let before_why = |text: &str| text.split_once("\nWhy").map_or(text, |(tasks, _)| tasks).to_owned();
    let [tasks, shown] = [left_out, solved].map(|text| before_why(&text));
    assert!(!tasks.contains('≤') && tasks.contains("9.21") && tasks.contains("inside the gate?"), "{tasks}");
    assert!(shown.contains('≤'), "{shown}");
}

#[test]
fn the_words_of_a_page_do_not_tell_a_decision() {
    let prepared = sample_of("kalman-filter");
    let cursor: Cursor = "4.3".parse().expect("a cursor");
    let look = Look { theme: THEME, ..Look::default() };
    let stand = Stand { prepared: &prepared, cursor, pixel: None, look, freehand: Freehand::default() };
    let parts = ["Gates reject outliers.", "This one was accepted.", "The gate is 9.21 here."];
    let prose = Prose(parts.map(|part| said(part.into())).to_vec());
    let about = About { title: "", prose: Some(&prose), answers: false };
    let shown = text_of_sheets(&work::finish(about.sheets(&stand, None)).expect("a decision"));
    assert!(shown.contains(parts[0]) && !shown.contains(parts[1]) && !shown.contains(parts[2]), "{shown}");
}

#[test]
fn a_question_whose_answer_is_always_the_same_in_the_first_unit_is_not_asked_there() {
    let estimator = motionscope_core::course::estimator("chan-vese").expect("an estimator");
    let prepared = sample(&*estimator);
    let stand = |unit| Stand {
        prepared: &prepared,
        cursor: Cursor { unit, event: usize::MAX },
        pixel: None,
        look: Look { theme: THEME, ..Look::default() },
        freehand: Freehand::default(),
    };
    let about = About { title: "", prose: None, answers: false };
    let refused = work::finish(about.sheets(&stand(0), None)).expect_err("nothing else is asked for").to_string();
    assert!(refused.contains("nothing to compute or decide"), "{refused}");
    let asked = words(&work::finish(about.sheets(&stand(1), None)).expect("a decision"));
    assert!(asked.iter().any(|(_, words)| words.contains("Does the tracker report")), "{asked:?}");
}

#[test]
fn the_response_of_a_corner_detector_begins_with_determinant_and_trace() {
    let estimator = motionscope_core::course::estimator("harris").expect("an estimator");
    let prepared = sample(&*estimator);
    let cursor: Cursor = "1.3".parse().expect("a cursor");
    let look = Look { theme: THEME, ..Look::default() };
    let stand = Stand { prepared: &prepared, cursor, pixel: None, look, freehand: Freehand::default() };
    assert_eq!(telling(&stand).len(), 4, "determinant, trace, the response in its formula and in its label");
    let left_out = text(&prepared, "1.3", false);
    assert!(left_out.contains("What does the structure tensor of this pixel show?"), "{left_out}");
}
