//! Laws about the questions of every estimator: each is asked, each of its answers is one that a run gives.

use motionscope_core::scene::{Asked, Question, Reading, Reply, Sentence};
use motionscope_core::{Info, Step, pseudocode};

use crate::common::toy;
use crate::rules;
use crate::walks::{ALL, Seen};

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
    let said = |line| seen.sentences.values().filter(move |(lines, _)| lines.contains(&line)).map(|(_, said)| said);
    match question.asked {
        Asked::Choice(cases) => {
            let never = cases.iter().enumerate().filter(|(i, case)| {
                // A question of several estimators may be about a line that one of them lacks.
                info.line(case.line).is_some() && !seen.cases.contains(&(question.id, *i))
            });
            never.map(|(_, case)| format!("{place}: no step of {} {}", case.line, told(case))).collect()
        }
        Asked::Number(reading) => {
            let is_there = said(reading.line).any(|said| reading.number(said).is_some());
            (!is_there)
                .then(|| format!("{place}: no sentence of {} has the number", reading.line))
                .into_iter()
                .collect()
        }
        Asked::Value { line, of } => {
            let is_there = seen.values.contains(&(line, of.name));
            (!is_there).then(|| format!("{place}: no step of {line} has the value {}", of.name)).into_iter().collect()
        }
        Asked::Place { line, role } => {
            let is_there = seen.marked.contains(&(line, role));
            (!is_there).then(|| format!("{place}: no step of {line} has a mark of {role:?}")).into_iter().collect()
        }
    }
}

/// What a step of a case tells.
fn told(case: &Reply) -> String {
    match (case.over, case.case, case.above) {
        (Some((reading, limit)), ..) => format!("has more than {limit} after “{}”", reading.after),
        (_, Some(case), _) => format!("tells the case {}", case.name),
        (_, _, Some((of, limit))) => format!("has {} above {limit}", of.name),
        _ => format!("says “{}”", case.says),
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

#[test]
fn a_limit_that_no_number_exceeds_is_found() {
    const SHARE: Reading = Reading { line: line::UPDATE, after: "covers ", before: " %", unit: "%" };
    const MOST: &[Reply] = &[Reply::over(SHARE, 50.0, "Yes"), Reply::says(line::UPDATE, "covers", "No")];
    const ALL_OF_IT: &[Reply] = &[Reply::over(SHARE, 100.0, "Yes"), Reply::says(line::UPDATE, "covers", "No")];
    let info = toy(line::ALL);
    let questions = [("most", MOST), ("all", ALL_OF_IT)].map(|(id, cases)| Question::choice(id, "Is it so?", cases));
    let mut seen = Seen::default();
    for said in ["It covers 40 % of it.", "It covers 100 % of it."] {
        let step = Step { sentence: Sentence::default().text(said), ..Step::at(line::UPDATE) };
        seen.decide(&questions, &step);
    }
    let found = questions.map(|question| unanswered(&info, &question, &seen));
    assert_eq!(found, [vec![], vec!["toy: all: no step of update has more than 100 after “covers ”".to_owned()]]);
}
