//! Questions about the next step, answered before it is shown.
//!
//! A question is declared by what a step is: the line of pseudocode that it is at, the cases that it tells, a value, or the marks of a
//! role. So the truth is that of the run itself, and nothing is computed twice.
//!
//! [`asked`] compares two steps and gives one of the questions that the second step answers; where it answers several, they
//! take turns. A question may declare when its answer is obvious: with some cases (`unless_told`), in the first unit of a run,
//! or again about the same reference (`once_per_reference`). Laws check that some run gives each answer, that places agree with
//! the results, and that no choice has the same answer on all examples.

use super::value::{Decimals, Value};
use super::{Case, Name, Picture, Role, Scene, Shape, Step, Variable};
use crate::base::words::plural;

/// A question about the next result of an estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Question {
    /// Stable id in kebab case, unique in its estimator: `new-minimum`.
    pub id: &'static str,
    /// The question, as it is asked.
    pub text: &'static str,
    /// What is asked for.
    pub asked: Asked,
    /// The cases in which the answer needs no thought.
    pub obvious: &'static [&'static Case],
    /// Whether it is asked in the first unit of a run.
    pub in_first_unit: bool,
    /// Whether it is asked only once about each reference.
    pub once: bool,
    /// The values of the step that answers it which it takes for granted.
    pub given: &'static [&'static Variable],
}

/// What a question asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Asked {
    /// A place on a picture: the centre of a mark of `role` at a step of `line`.
    Place {
        /// The line of the step.
        line: Name,
        /// The role of the mark.
        role: Role,
    },
    /// One of several answers: that of the first case that a step is.
    Choice(&'static [Reply]),
    /// A value that a step of `line` shows.
    Value {
        /// The line of the step.
        line: Name,
        /// The variable.
        of: &'static Variable,
    },
}

/// A case of a question with several answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reply {
    /// The answer.
    pub answer: &'static str,
    /// The line of the step.
    pub line: Name,
    /// The case that the step tells; `None` if it does not matter.
    pub case: Option<&'static Case>,
    /// A variable, and what its value exceeds.
    pub above: Option<(&'static Variable, f64)>,
}

/// The true answer to a question.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// The places of the marks, of which the nearest to a guess counts.
    Place {
        /// The picture that they lie on.
        on: Picture,
        /// The places in px.
        at: Vec<[f32; 2]>,
        /// The middle of what is looked for, where the step marks it: the reference.
        from: Option<[f32; 2]>,
    },
    /// The index of the answer in [`Question::choices`].
    Choice(usize),
    /// The number, and as the sentence shows it.
    Number {
        /// Its value.
        value: f64,
        /// Its text without the unit.
        shown: String,
    },
}

/// A step with its scene.
#[derive(Clone, Copy)]
pub struct Shown<'a> {
    /// The explanation.
    pub step: &'a Step,
    /// The marks.
    pub scene: &'a Scene,
}

impl Shown<'_> {
    /// The middle of the block, window or pixel that the step is about, if it has one.
    pub fn reference(self) -> Option<[f32; 2]> {
        reference(self.scene)
    }
}

/// Distance in px below which two marks are at one place, and one that is shown already gives it away.
const GIVEN_AWAY_PX: f32 = 0.75;

impl Reply {
    /// The case of a step at `line`.
    pub const fn at(line: Name, answer: &'static str) -> Self {
        Self { answer, line, case: None, above: None }
    }

    /// The answer where a step at `line` tells `case`.
    pub const fn told(line: Name, case: &'static Case, answer: &'static str) -> Self {
        Self { case: Some(case), ..Self::at(line, answer) }
    }

    /// The answer where the value of a step at `line` exceeds `limit`.
    pub const fn above(line: Name, (of, limit): (&'static Variable, f64), answer: &'static str) -> Self {
        Self { above: Some((of, limit)), ..Self::at(line, answer) }
    }

    /// Whether `step` is this case.
    pub fn holds(&self, step: &Step) -> bool {
        let exceeds = |(of, limit)| step.value(of).and_then(Value::rounded).is_some_and(|value| value > limit);
        self.line == step.line && self.case.is_none_or(|case| step.is(case)) && self.above.is_none_or(exceeds)
    }
}

impl Question {
    /// A question for the place of a mark of `role` at a step of `line`.
    pub const fn place(id: &'static str, text: &'static str, line: Name, role: Role) -> Self {
        Self::new(id, text, Asked::Place { line, role })
    }

    /// A question with several answers.
    pub const fn choice(id: &'static str, text: &'static str, cases: &'static [Reply]) -> Self {
        Self::new(id, text, Asked::Choice(cases))
    }

    const fn new(id: &'static str, text: &'static str, asked: Asked) -> Self {
        Self { id, text, asked, obvious: &[], in_first_unit: true, once: false, given: &[] }
    }

    /// A question for a value of a step at `line`.
    pub const fn value(id: &'static str, text: &'static str, line: Name, of: &'static Variable) -> Self {
        Self::new(id, text, Asked::Value { line, of })
    }

    /// The same question, but not asked about a step that tells one of `cases`: there the answer needs no thought.
    #[must_use]
    pub const fn unless_told(self, cases: &'static [&'static Case]) -> Self {
        Self { obvious: cases, ..self }
    }

    /// The same question, but not asked in the first unit of a run, in which the answer is always the same.
    #[must_use]
    pub const fn after_first_unit(self) -> Self {
        Self { in_first_unit: false, ..self }
    }

    /// The same question, but asked only once about each reference: as long as this stays, so does the answer.
    #[must_use]
    pub const fn once_per_reference(self) -> Self {
        Self { once: true, ..self }
    }

    /// The same question, with `values` of the step that answers it, without which it cannot be answered.
    #[must_use]
    pub const fn with_given(self, values: &'static [&'static Variable]) -> Self {
        Self { given: values, ..self }
    }

    /// The values of the step that answers it which are told with the question.
    pub fn given_by<'a>(&self, answer: &'a Step) -> impl Iterator<Item = &'a Value> {
        self.given.iter().filter_map(|of| answer.value(of))
    }

    /// The unit of the number that is asked for, of a count what is counted; empty if it has none, or no number is asked for.
    pub fn unit(&self) -> String {
        match self.asked {
            Asked::Value { of, .. } if of.unit.decimals == Decimals::Count => plural(of.unit.name),
            Asked::Value { of, .. } => of.unit.name.into(),
            Asked::Choice(_) | Asked::Place { .. } => String::new(),
        }
    }

    /// Whether it is asked about a step of the unit `unit` of a run, from 0.
    pub fn is_asked_in(&self, unit: usize) -> bool {
        self.in_first_unit || unit > 0
    }

    /// The answers to choose from, in the order of their declaration but with a yes first, so that its key is the same everywhere; empty if a place or a number is asked for.
    pub fn choices(&self) -> Vec<&'static str> {
        let Asked::Choice(cases) = self.asked else { return Vec::new() };
        let mut choices = Vec::new();
        for case in cases {
            if !choices.contains(&case.answer) {
                choices.push(case.answer);
            }
        }
        choices.sort_by_key(|answer| !answer.starts_with("Yes"));
        choices
    }

    /// The answer that `after` gives; `None` if it does not answer the question, or if `before` gives the answer away.
    pub fn answer(&self, before: Shown<'_>, after: Shown<'_>) -> Option<Answer> {
        if self.obvious.iter().any(|case| after.step.is(case)) {
            return None;
        }
        match &self.asked {
            Asked::Place { line, role } if *line == after.step.line => place(*role, before.scene, after.scene),
            Asked::Place { .. } => None,
            Asked::Choice(cases) => {
                let case = cases.iter().find(|case| case.holds(after.step))?;
                self.choices().iter().position(|answer| *answer == case.answer).map(Answer::Choice)
            }
            Asked::Value { line, of } if *line == after.step.line => {
                let value = after.step.value(of).filter(|_| after.step.shows(of))?;
                Some(Answer::Number { value: value.rounded()?, shown: value.bare() })
            }
            Asked::Value { .. } => None,
        }
    }
}

/// One of the `questions` that `after` answers, with the answer. Where there are several, they take turns by the number `turn`:
/// a question that is asked only where another has no answer would give its own away.
pub fn asked<'q>(
    questions: impl IntoIterator<Item = &'q Question>,
    before: Shown<'_>,
    after: Shown<'_>,
    turn: usize,
) -> Option<(&'q Question, Answer)> {
    let answered = questions.into_iter().filter_map(|question| Some((question, question.answer(before, after)?)));
    let mut answered: Vec<_> = answered.collect();
    if answered.is_empty() { None } else { Some(answered.swap_remove(turn % answered.len())) }
}

/// The places of the last picture with marks of `role` in `after`, unless `before` shows one of them already.
fn place(role: Role, before: &Scene, after: &Scene) -> Option<Answer> {
    let on = after.marks.iter().rev().find(|mark| mark.role == role && !middles(&mark.shape).is_empty())?.on;
    let mut at: Vec<[f32; 2]> = Vec::new();
    for place in marked(after, |of| of == role, on) {
        // A point within its ellipse is one place.
        if !at.iter().any(|known| (known[0] - place[0]).hypot(known[1] - place[1]) < GIVEN_AWAY_PX) {
            at.push(place);
        }
    }
    let gives_away = |of| {
        matches!(of, Role::Best | Role::Candidate | Role::Predicted | Role::Estimate | Role::Measured) || of == role
    };
    let is_shown = |place: &[f32; 2]| {
        marked(before, gives_away, on).any(|shown| (shown[0] - place[0]).hypot(shown[1] - place[1]) < GIVEN_AWAY_PX)
    };
    if at.iter().any(is_shown) {
        return None;
    }
    Some(Answer::Place { on, at, from: reference(after) })
}

/// The middle of the first reference in `scene`.
fn reference(scene: &Scene) -> Option<[f32; 2]> {
    let mut references = scene.marks.iter().filter(|mark| mark.role == Role::Reference);
    references.find_map(|mark| middles(&mark.shape).first().copied())
}

/// The middles of the marks on a picture with a role of which `is_meant` holds.
fn marked(scene: &Scene, is_meant: impl Fn(Role) -> bool, on: Picture) -> impl Iterator<Item = [f32; 2]> {
    let marks = scene.marks.iter().filter(move |mark| is_meant(mark.role) && mark.on.is_aligned_with(on));
    marks.flat_map(|mark| middles(&mark.shape))
}

/// The middles of what a shape shows; empty for words and for shapes of whole pictures.
fn middles(shape: &Shape) -> Vec<[f32; 2]> {
    let mean = |points: &[[f32; 2]]| {
        let sum = points.iter().fold([0.0; 2], |sum, point| [sum[0] + point[0], sum[1] + point[1]]);
        sum.map(|sum| sum / points.len() as f32)
    };
    match shape {
        Shape::Rect { min, max } => vec![mean(&[*min, *max])],
        Shape::Ellipse { center, .. } => vec![*center],
        Shape::Points(points) => points.clone(),
        Shape::Path { points, closed: true } if !points.is_empty() => vec![mean(points)],
        Shape::Arrows(_)
        | Shape::Path { .. }
        | Shape::Text { .. }
        | Shape::Heat { .. }
        | Shape::Flow { .. }
        | Shape::Mask(_)
        | Shape::Labels(_) => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::Unit;
    use super::*;

    crate::pseudocode! {
        TEST: "test a candidate",
        KEEP: "keep the best",
    }

    crate::variables! {
        /// The share of the way.
        SHARE: "Share", "", Unit::WHOLE_PERCENT;
    }

    crate::cases! { over value;
        COVERED: "The update covers {share} of the way.",
        BELOW: "It is below the minimum.",
        ABOVE: "It exceeds the minimum.",
    }

    const QUESTION: Question = Question::choice(
        "lower",
        "Is it lower?",
        &[
            Reply::told(line::TEST, case::BELOW, "Yes"),
            Reply::told(line::TEST, case::ABOVE, "No"),
            Reply::at(line::KEEP, "Yes"),
        ],
    );

    fn answer(question: &Question, after: &Step) -> Option<Answer> {
        let (before, scene) = (Step::at(line::TEST), Scene::default());
        question.answer(Shown { step: &before, scene: &scene }, Shown { step: after, scene: &scene })
    }

    #[test]
    fn the_first_case_that_holds_is_the_answer() {
        assert_eq!(QUESTION.choices(), ["Yes", "No"]);
        let test = || Step::at(line::TEST);
        assert_eq!(answer(&QUESTION, &test().say(case::BELOW)), Some(Answer::Choice(0)));
        assert_eq!(answer(&QUESTION, &test().say(case::ABOVE)), Some(Answer::Choice(1)));
        assert_eq!(answer(&QUESTION, &Step::at(line::KEEP)), Some(Answer::Choice(0)));
        assert_eq!(answer(&QUESTION, &test()), None, "no case");
    }

    #[test]
    fn a_question_reads_values_and_cases() {
        let told = |step: Step, question: &Question| answer(question, &step);
        let covered = |share: f64| Step::at(line::TEST).put(value::SHARE, share).say(case::COVERED);
        let share = Question::value("share", "Which share?", line::TEST, value::SHARE);
        assert_eq!(told(covered(92.6), &share), Some(Answer::Number { value: 93.0, shown: "93".into() }));
        assert_eq!(told(Step::at(line::KEEP), &share), None);
        assert_eq!(told(Step::at(line::TEST).put(value::SHARE, 92.6), &share), None, "it is not shown");
        assert_eq!(told(covered(92.6), &share.unless_told(&[case::COVERED])), None);
        const REPLIES: &[Reply] =
            &[Reply::above(line::TEST, (value::SHARE, 50.0), "More"), Reply::told(line::TEST, case::COVERED, "Less")];
        let half = Question::choice("half", "Is it more than half?", REPLIES);
        assert_eq!([50.4, 50.6].map(|share| told(covered(share), &half)), [1, 0].map(|i| Some(Answer::Choice(i))));
        assert_eq!(told(Step::at(line::TEST), &half), None);
    }

    #[test]
    fn what_needs_no_thought_is_not_asked() {
        let question = QUESTION.unless_told(&[case::BELOW]);
        assert_eq!(answer(&question, &Step::at(line::TEST).say(case::BELOW)), None);
        assert_eq!(answer(&question, &Step::at(line::TEST).say(case::ABOVE)), Some(Answer::Choice(1)));
        assert_eq!([0, 1].map(|unit| QUESTION.is_asked_in(unit)), [true, true]);
        let later = QUESTION.after_first_unit();
        assert_eq!([0, 1].map(|unit| later.is_asked_in(unit)), [false, true]);
        assert!(!QUESTION.once && QUESTION.once_per_reference().once);
    }

    #[test]
    fn a_place_is_asked_for_unless_it_is_shown_already() {
        let question = Question::place("match", "Where?", line::KEEP, Role::Best);
        let at = |role, x| {
            let mut scene = Scene::default();
            scene.mark(Picture::NEXT, role, Shape::pixels(x, 4, 3, 3));
            scene
        };
        let steps = [line::TEST, line::KEEP].map(Step::at);
        let answer = |before: &Scene, after: &Scene| {
            question.answer(Shown { step: &steps[0], scene: before }, Shown { step: &steps[1], scene: after })
        };
        let expected = Answer::Place { on: Picture::NEXT, at: vec![[8.0, 5.0]], from: None };
        assert_eq!(answer(&at(Role::Best, 2), &at(Role::Best, 7)), Some(expected.clone()));
        assert_eq!(answer(&at(Role::Window, 7), &at(Role::Best, 7)), Some(expected), "a window is no answer");
        assert_eq!(answer(&at(Role::Best, 7), &at(Role::Best, 7)), None);
        assert_eq!(answer(&at(Role::Candidate, 7), &at(Role::Best, 7)), None);
        assert_eq!(answer(&at(Role::Best, 2), &Scene::default()), None);
    }

    #[test]
    fn questions_with_an_answer_take_turns() {
        let questions = [QUESTION, Question::value("share", "Which share?", line::TEST, value::SHARE)];
        let (step, scene) = (Step::at(line::TEST).fact(value::SHARE, 12.0).say(case::BELOW), Scene::default());
        let shown = Shown { step: &step, scene: &scene };
        let id = |turn| asked(&questions, shown, shown, turn).map(|(question, _)| question.id);
        assert_eq!([0, 1, 2].map(id), [Some("lower"), Some("share"), Some("lower")]);
        assert_eq!(asked(&[], shown, shown, 3), None);
    }
}
