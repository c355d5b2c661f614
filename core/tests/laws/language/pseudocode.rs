//! Laws about the pseudocode of every estimator of the registry: each line is lit by some step, and each sentence belongs to
//! one line. A new estimator is tested here unasked.

use std::collections::BTreeSet;

use motionscope_core::pseudocode;
use motionscope_core::run::Info;
use motionscope_core::scene::pseudocode::Name;
use motionscope_core::scene::{Sentence, Step};

use super::walks::{ALL, Seen};
use crate::common::toy;

/// What is wrong with the pseudocode of an estimator, and with the steps that were seen.
fn faults(info: &Info, seen: &Seen) -> Vec<String> {
    let names: BTreeSet<Name> = info.pseudocode.iter().map(|line| line.name).collect();
    let twice = (names.len() < info.pseudocode.len()).then(|| "two lines have one name".to_owned());
    let unknown = seen.unknown.iter().map(|name| format!("a step is at {name}, which no line is called"));
    let unlit = seen.unlit(info.pseudocode).into_iter().map(|name| format!("{name} is never lit"));
    let shared = seen.sentences.values().filter(|(lines, _)| lines.len() > 1);
    let shared = shared.map(|(lines, said)| format!("steps of {lines:?} are told alike: {said}"));
    let all = twice.into_iter().chain(unknown).chain(unlit).chain(shared);
    all.map(|fault| format!("{}: {fault}", info.id)).collect()
}

#[test]
fn every_line_is_lit_and_every_sentence_belongs_to_one() {
    let mut all = Vec::new();
    for (estimator, seen) in ALL.iter() {
        let id = estimator.info().id;
        assert!(seen.runs > 4 * seen.refused, "{id}: {} settings are refused, {} run", seen.refused, seen.runs);
        all.extend(faults(estimator.info(), seen));
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}

pseudocode! {
    EACH_FRAME: "for each frame",
    PREDICT: "  predict",
    UPDATE: "  update",
    SMOOTH: "smooth",
}

mod elsewhere {
    motionscope_core::line_names!(DETECT);
}

#[test]
fn what_is_wrong_is_found() {
    let info = toy(line::ALL);
    let mut seen = Seen::default();
    let mut see = |line, said: &str| {
        let step = Step { sentence: Sentence::default().text(said), ..Step::at(line) };
        seen.see(&info, &step);
    };
    see(line::PREDICT, "It goes on to (1.5, 2) px.");
    see(line::UPDATE, "It is measured at (3, −2.25) px.");
    see(line::UPDATE, "It goes on to (3, −2.25) px.");
    see(elsewhere::DETECT, "It is detected.");
    let expected = [
        "toy: a step is at detect, which no line is called",
        // The heading is reached with what is in it.
        "toy: smooth is never lit",
        "toy: steps of {\"predict\", \"update\"} are told alike: It goes on to (1.5, 2) px.",
    ];
    assert_eq!(faults(&info, &seen), expected);
}
