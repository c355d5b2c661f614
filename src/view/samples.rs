//! Steps of every estimator, and laws that hold for all of them.

use motionscope_core::course::{estimators, examples};
use motionscope_core::run::{AnyEstimator, Direction, Move};
use motionscope_core::scene::{Math, Scene, Shown, Step, latex};

use crate::experiment::source::Source;
use crate::experiment::{Experiment, Prepared};
use crate::media::Open;
use crate::paint::charts::formula::typeset;
use crate::paint::script::parts;

/// Steps of a run that are looked at.
const STEPS: usize = 40;

/// The first example of an estimator, or a moving scene.
pub fn sample(estimator: &dyn AnyEstimator) -> Prepared {
    let example = examples::of(estimator.info().id).next();
    let mut estimator = estimator.boxed_clone();
    let settings = example.map_or(&[][..], |example| &example.settings);
    settings.iter().for_each(|(name, value)| estimator.set(name, value).expect("a setting of an example"));
    let clip = example.map_or("traffic", |example| example.clip);
    let source = Source::parse(format!("synth:{clip}")).expect("a scene of an example");
    let frame = example.map_or(0, |example| example.frame);
    let experiment = Experiment { frame, ..Experiment::new(source, estimator) };
    Prepared::open(experiment, Open::default()).expect("the clip of an example")
}

/// A step with the unit of the run that it belongs to.
pub type InUnit = (Step, usize);

/// The first steps of a run.
pub fn steps(prepared: &Prepared) -> Vec<InUnit> {
    let mut walk = prepared.experiment.walk(&prepared.clip).expect("a run");
    let last = walk.info().granularities.len() - 1;
    let mut steps = vec![(walk.step(None), walk.cursor().unit)];
    while steps.len() < STEPS && !walk.at_end() {
        walk.go(Move::Granularity(last, Direction::Forward));
        while !walk.work(&mut || true) {}
        steps.push((walk.step(None), walk.cursor().unit));
    }
    steps
}

/// The last step of a run.
pub fn last(prepared: &Prepared) -> InUnit {
    let mut walk = prepared.experiment.walk(&prepared.clip).expect("a run");
    walk.jump(Move::End);
    (walk.step(None), walk.cursor().unit)
}

#[test]
fn every_formula_is_drawn_with_characters_that_the_fonts_have_and_nothing_is_shown_as_it_is_typed() {
    assert!(is_typed(r"\omega") && is_typed("det_x") && !is_typed("(u_GS, v_GS)"));
    let mut faults = Vec::new();
    for estimator in estimators() {
        let id = estimator.info().id;
        let code = estimator.info().pseudocode.iter().map(|line| line.text).filter(|text| is_typed(text));
        faults.extend(code.map(|text| format!("{id}: {text}")));
        let prepared = sample(&*estimator);
        for (step, _) in steps(&prepared).into_iter().chain([last(&prepared)]) {
            let missing = |math: &Math| typeset(math, 16.0, 400.0).missing();
            for value in &step.values {
                let symbol = latex::parse(value.of.symbol).unwrap_or_else(|why| panic!("{}: {why}", value.of.name));
                assert_eq!(missing(&symbol), "", "{id}: {}", value.of.symbol);
                let texts = [value.of.label, value.of.definition, &symbol.plain()].map(str::to_owned);
                faults.extend(texts.into_iter().filter(|text| is_typed(text)).map(|text| format!("{id}: {text}")));
            }
            let of_step = step.formulas().iter().map(|math| (missing(math), math.plain()));
            faults.extend(
                of_step
                    .filter(|(missing, _)| !missing.is_empty())
                    .map(|(missing, plain)| format!("{id}: {missing:?} of {plain}")),
            );
        }
    }
    faults.sort();
    faults.dedup();
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

/// Whether an index or a command of a formula stands in a text as it is typed.
fn is_typed(text: &str) -> bool {
    parts(text).iter().any(|(words, _)| words.contains(['_', '\\']))
}

/// The step in a language that does not exist: the words of its templates are others, its values are the same.
pub fn translated(step: &Step) -> Step {
    let sentence = step.sentence.clone().in_words(|words| words.replace(char::is_alphabetic, "ß"));
    Step { sentence, ..step.clone() }
}

#[test]
fn questions_are_answered_in_any_language() {
    let mut asked = 0;
    for estimator in estimators() {
        let scene = Scene::default();
        for pair in steps(&sample(&*estimator)).windows(2) {
            let [before, after] = [&pair[0].0, &pair[1].0];
            let foreign = [before, after].map(translated);
            for question in estimator.questions() {
                let answer = |before, after| {
                    question.answer(Shown { step: before, scene: &scene }, Shown { step: after, scene: &scene })
                };
                let expected = answer(before, after);
                asked += usize::from(expected.is_some());
                assert_eq!(answer(&foreign[0], &foreign[1]), expected, "{}: {}", estimator.info().id, question.id);
            }
        }
    }
    assert!(asked > 500, "only {asked} questions were answered");
}
