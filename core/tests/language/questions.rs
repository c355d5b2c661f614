//! Laws about the questions of every estimator: each is asked, each of its answers is one that a run gives.

use motionscope_core::Info;
use motionscope_core::scene::{Asked, Question};

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
            let holds = |i: usize, said: &str| said.contains(cases[i].says);
            let is_first = |i: usize, said: &String| {
                holds(i, said) && !(0..i).any(|other| cases[other].line == cases[i].line && holds(other, said))
            };
            let never = (0..cases.len()).filter(|i| info.line(cases[*i].line).is_some());
            let never = never.filter(|i| !said(cases[*i].line).any(|said| is_first(*i, said)));
            never.map(|i| format!("{place}: no step of {} says “{}”", cases[i].line, cases[i].says)).collect()
        }
        Asked::Number(reading) => {
            let is_there = said(reading.line).any(|said| reading.number(said).is_some());
            (!is_there)
                .then(|| format!("{place}: no sentence of {} has the number", reading.line))
                .into_iter()
                .collect()
        }
        Asked::Place { line, role } => {
            let is_there = seen.marked.contains(&(line, role));
            (!is_there).then(|| format!("{place}: no step of {line} has a mark of {role:?}")).into_iter().collect()
        }
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
