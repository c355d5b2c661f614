//! What questions hold to be true, against the results of whole runs.

use std::collections::{BTreeMap, BTreeSet};

use crate::common::{self, clip_of, set};
use motionscope_core::base::Threads;
use motionscope_core::course::estimators;
use motionscope_core::course::examples::{self, Example};
use motionscope_core::data::Clip;
use motionscope_core::params::Params as _;
use motionscope_core::products::{BlockField, RegionField};
use motionscope_core::run::{AnyEstimator, Cursor, Direction, Move, Walk};
use motionscope_core::scene::{Answer, Picture, Question, Scene, Shown, Step, asked};
use motionscope_core::synth;
use rayon::prelude::*;

/// A bundled scene, of the first `frames` frames where it has such a slider.
fn scene(id: &str, frames: &str) -> Clip {
    let scene = synth::scene(id).expect("it is bundled");
    let mut small = scene.difficulty();
    // Not every scene has as many frames as one likes.
    let _ = small.set("frames", frames);
    synth::make(id, &small).expect("a clip")
}

/// What is asked when a run is walked unit by unit: the step that is asked about, the question and its answer.
fn by_unit(estimator: &dyn AnyEstimator, clip: &Clip) -> Vec<(Step, &'static Question, Answer)> {
    let mut walk = estimator.walk(clip, 0).expect("a walk");
    let unit = walk.info().granularities.len() - 2;
    let look = |walk: &dyn Walk| -> (Step, Scene) { (walk.step(None), walk.scene(None)) };
    let (mut before, mut all) = (look(&*walk), Vec::new());
    while !walk.at_end() {
        walk.jump(Move::Granularity(unit, Direction::Forward));
        let after = look(&*walk);
        let [shown, next] = [&before, &after].map(|(step, scene)| Shown { step, scene });
        if let Some((question, answer)) = asked(estimator.questions(), shown, next, walk.cursor().unit) {
            all.push((after.0.clone(), question, answer));
        }
        before = after;
    }
    all
}

fn place(answer: &Answer) -> (Picture, [f32; 2]) {
    let Answer::Place { on, at, .. } = answer else { panic!("{answer:?} is no place") };
    assert_eq!(at.len(), 1, "one place");
    (*on, at[0])
}

#[test]
fn the_place_of_a_match_is_that_of_the_motion_vector() {
    let clip = scene("pillar", "2");
    for id in ["full-search", "diamond", "three-step"] {
        let estimator = set(id, &[]);
        let output = estimator.run(&clip, 0, &Threads::single()).expect("a run");
        let field = output.get::<BlockField>().expect("block vectors");
        let asked: Vec<_> = by_unit(&*estimator, &clip);
        let matches = asked.iter().filter(|(_, question, _)| question.id == "match");
        let mut count = 0;
        for (step, _, answer) in matches {
            // Block n of the sentence is the n-th of the result.
            let number = common::numbers(&step.sentence.plain())[0] as usize - 1;
            let (block, vector) = (field.blocks.block(number), field.vectors[number].expect("a vector"));
            let middle = [(block.x, block.width), (block.y, block.height)]
                .map(|(at, side)| at as f32 + (side as f32 - 1.0) / 2.0);
            let expected = [0, 1].map(|i| middle[i] + vector.displacement[i]);
            assert_eq!(place(answer), (Picture::NEXT, expected), "{id}, block {number}");
            count += 1;
        }
        assert!(count * 10 > field.vectors.len() * 9, "{id}: asked of {count} of {} blocks", field.vectors.len());
    }
}

#[test]
fn the_place_of_an_object_is_that_of_its_region() {
    let clip = scene("tunnel", "12");
    for id in ["mean-shift", "correlation-filter", "template-tracker"] {
        let estimator = set(id, &[]);
        let output = estimator.run(&clip, 0, &Threads::single()).expect("a run");
        let field = output.get::<RegionField>().expect("a region");
        let asked = by_unit(&*estimator, &clip);
        let places: Vec<_> = asked.iter().filter(|(_, question, _)| question.id == "where").collect();
        let mut compared = 0;
        for (step, _, answer) in places {
            let said = step.sentence.plain();
            // At its end a run sums up instead.
            let Some(frame) = said.strip_prefix("Frame ").map(|_| common::numbers(&said)[0] as usize) else { continue };
            compared += 1;
            let center = field.frames[frame - field.first].region.center;
            let (_, at) = place(answer);
            let off = (at[0] - center[0]).hypot(at[1] - center[1]);
            assert!(off < 0.01, "{id}, frame {frame}: {at:?} and {center:?}");
        }
        assert!(compared > 2, "{id}: compared {compared} times");
    }
}

#[test]
fn every_question_has_a_different_text() {
    for estimator in estimators() {
        let mut texts: Vec<_> = estimator.questions().iter().map(|question| question.text).collect();
        let all = texts.len();
        texts.sort_unstable();
        texts.dedup();
        assert_eq!(texts.len(), all, "{}", estimator.info().id);
    }
}

/// Most steps that are walked from one place of a run.
const STRETCH: usize = 160;
/// Parts of a run, each of which is walked from its start.
const PARTS: usize = 8;

/// The answers that steps give to questions with several ones, by the id of the question.
struct Answers(BTreeMap<&'static str, (&'static Question, BTreeSet<usize>)>);

impl Answers {
    /// Those of the questions of `estimator`, as long as no step was looked at.
    fn none(estimator: &dyn AnyEstimator) -> Self {
        let choices = estimator.questions().iter().filter(|question| !question.choices().is_empty());
        Self(choices.map(|question| (question.id, (question, BTreeSet::new()))).collect())
    }

    /// Whether each question got two of them.
    fn are_various(&self) -> bool {
        self.0.values().all(|(_, given)| given.len() > 1)
    }

    /// Walks on by steps of a granularity from where `walk` stands, until there are enough.
    fn walk_on(&mut self, walk: &mut dyn Walk, granularity: usize) {
        // Only places are read from the marks.
        let scene = Scene::default();
        for _ in 0..STRETCH {
            if walk.at_end() || self.are_various() {
                return;
            }
            walk.jump(Move::Granularity(granularity, Direction::Forward));
            let step = walk.step(None);
            let shown = Shown { step: &step, scene: &scene };
            let unit = walk.cursor().unit;
            for (question, given) in self.0.values_mut().filter(|(question, _)| question.is_asked_in(unit)) {
                if let Some(Answer::Choice(index)) = question.answer(shown, shown) {
                    given.insert(index);
                }
            }
        }
    }

    /// The questions that got a single answer, with it, or none.
    fn alike(&self) -> Vec<String> {
        let alike = self.0.values().filter(|(_, given)| given.len() < 2);
        let told = alike.map(|(question, given)| {
            let answer = given.first().map_or("no answer", |index| question.choices()[*index]);
            format!("{}: {answer}", question.text)
        });
        told.collect()
    }
}

/// The run of an example.
fn walk(id: &str, example: &Example) -> Box<dyn Walk> {
    set(id, &example.settings).walk(&clip_of(example), example.frame).expect("a walk")
}

/// The answers of an estimator's examples: first from their start by smaller and by larger steps, then from places all over their runs.
fn answers(estimator: &dyn AnyEstimator) -> Answers {
    let (id, mut answers) = (estimator.info().id, Answers::none(estimator));
    let event = estimator.info().granularities.len() - 1;
    for example in examples::of(id) {
        if answers.are_various() {
            break;
        }
        let mut walk = walk(id, example);
        for granularity in (1..=event).rev() {
            walk.jump(Move::To(Cursor::default()));
            answers.walk_on(&mut *walk, granularity);
        }
    }
    for example in examples::of(id) {
        if answers.are_various() {
            break;
        }
        let mut walk = walk(id, example);
        walk.jump(Move::End);
        let units = walk.cursor().unit + 1;
        for unit in (1..PARTS).map(|part| units * part / PARTS).chain([units - 1]) {
            walk.jump(Move::To(Cursor { unit, event: 0 }));
            answers.walk_on(&mut *walk, event);
        }
    }
    answers
}

#[test]
fn no_question_has_the_same_answer_throughout_the_examples() {
    let alike = |estimator: Box<dyn AnyEstimator>| {
        let alike = answers(&*estimator).alike().into_iter();
        alike.map(|told| format!("{}: {told}", estimator.info().id)).collect::<Vec<_>>()
    };
    let alike: Vec<_> = estimators().into_par_iter().with_max_len(1).map(alike).collect();
    let alike = alike.concat();
    assert!(alike.is_empty(), "{} are always answered alike:\n{}", alike.len(), alike.join("\n"));
}

#[test]
fn the_first_answer_of_a_run_needs_thought() {
    for (id, question) in [("global-motion", "better"), ("rapid", "lost")] {
        let example = examples::of(id).next().expect("an example");
        let mut walk = walk(id, example);
        let event = walk.info().granularities.len() - 1;
        let questions = estimator_questions(id);
        let question = questions.iter().find(|of| of.id == question).expect("it is declared");
        let plain = Question { obvious: &[], in_first_unit: true, ..*question };
        let mut needless = 0;
        while walk.cursor().unit == 0 {
            let (step, scene) = (walk.step(None), Scene::default());
            let shown = Shown { step: &step, scene: &scene };
            let answers = |question: &Question| question.is_asked_in(0) && question.answer(shown, shown).is_some();
            assert!(!answers(question), "{id}: {}", step.sentence.plain());
            needless += usize::from(answers(&plain));
            walk.jump(Move::Granularity(event, Direction::Forward));
        }
        assert!(needless > 0, "{id}: its first unit has no answer that could be asked for");
    }
}

fn estimator_questions(id: &str) -> &'static [Question] {
    set(id, &[]).questions()
}
