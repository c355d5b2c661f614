//! Laws about the questions of every estimator: each is asked, each of its answers is one that a run gives.

use motionscope_core::run::Info;
use motionscope_core::scene::{Asked, Question, Reply, Step, Unit};
use motionscope_core::{pseudocode, variables};

use super::rules;
use super::walks::{ALL, Seen};
use crate::common::toy;

/// What is wrong with a question by itself.
fn faults(info: &Info, question: &Question) -> Vec<String> {
    let place = format!("{}: {}", info.id, question.id);
    let mut all: Vec<String> = Vec::new();
    let is_kebab = question.id.chars().all(|c| c.is_ascii_lowercase() || c == '-');
    if !is_kebab || question.id.is_empty() {
        all.push(format!("{place} is no id"));
    }
    if !question.text.ends_with('?') {
        all.push(format!("{place}: “{}” is no question", question.text));
    }
    if matches!(question.asked, Asked::Choice(_)) && question.choices().len() < 2 {
        all.push(format!("{place} has a single answer"));
    }
    let texts = [question.text].into_iter().chain(question.choices());
    all.extend(texts.flat_map(|text| rules::faults(text, true)).map(|fault| format!("{place}: {fault}")));
    all
}

/// The answers that no step gives.
fn unanswered(info: &Info, question: &Question, seen: &Seen) -> Vec<String> {
    let place = format!("{}: {}", info.id, question.id);
    match question.asked {
        Asked::Choice(cases) => {
            let never = cases.iter().enumerate().filter(|(i, case)| {
                // A question of several estimators may be about a line that one of them lacks.
                info.line(case.line).is_some() && !seen.cases.contains(&(question.id, *i))
            });
            never.map(|(_, case)| format!("{place}: no step of {} {}", case.line, told(case))).collect()
        }
        Asked::Value { line, of } => {
            let is_there = seen.values.contains(&(line, of.name));
            (!is_there).then(|| format!("{place}: no step of {line} shows the value {}", of.name)).into_iter().collect()
        }
        Asked::Place { line, role } => {
            let is_there = seen.marked.contains(&(line, role));
            (!is_there).then(|| format!("{place}: no step of {line} has a mark of {role:?}")).into_iter().collect()
        }
    }
}

/// What a step of a case tells.
fn told(case: &Reply) -> String {
    match (case.case, case.above) {
        (Some(case), _) => format!("tells the case {}", case.name),
        (_, Some((of, limit))) => format!("has {} above {limit}", of.name),
        (None, None) => "is at it".into(),
    }
}

#[test]
fn every_estimator_asks_and_every_answer_is_given() {
    let mut all = Vec::new();
    for (estimator, seen) in ALL.iter() {
        let (info, questions) = (estimator.info(), estimator.questions());
        if questions.is_empty() {
            all.push(format!("{} has no question", info.id));
        }
        let mut ids: Vec<_> = questions.iter().map(|question| question.id).collect();
        ids.sort_unstable();
        ids.dedup();
        if ids.len() < questions.len() {
            all.push(format!("{}: two questions have one id", info.id));
        }
        all.extend(questions.iter().flat_map(|question| faults(info, question)));
        all.extend(questions.iter().flat_map(|question| unanswered(info, question, seen)));
        // A place is asked for on larger steps, on which it is not seen before.
        let by_event = questions.iter().filter(|question| !matches!(question.asked, Asked::Place { .. }));
        let silent = by_event.filter(|question| !seen.asked.contains(question.id));
        all.extend(silent.map(|question| format!("{}: {} is never asked", info.id, question.id)));
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}

pseudocode! {
    UPDATE: "update",
}

variables! {
    /// The share of the way.
    SHARE: "Share", "", Unit::WHOLE_PERCENT;
}

#[test]
fn a_limit_that_no_value_exceeds_is_found() {
    const MOST: &[Reply] = &[Reply::above(line::UPDATE, (value::SHARE, 50.0), "Yes"), Reply::at(line::UPDATE, "No")];
    const ALL_OF_IT: &[Reply] =
        &[Reply::above(line::UPDATE, (value::SHARE, 100.0), "Yes"), Reply::at(line::UPDATE, "No")];
    let info = toy(line::ALL);
    let questions = [("most", MOST), ("all", ALL_OF_IT)].map(|(id, cases)| Question::choice(id, "Is it so?", cases));
    let mut seen = Seen::default();
    for share in [40.0, 100.0] {
        seen.decide(&questions, &Step::at(line::UPDATE).put(value::SHARE, share));
    }
    let found = questions.map(|question| unanswered(&info, &question, &seen));
    assert_eq!(found, [vec![], vec!["toy: all: no step of update has share above 100".to_owned()]]);
}
