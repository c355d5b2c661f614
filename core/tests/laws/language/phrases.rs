//! What estimators say is the language of the field: no phrase that a textbook would not print, and numbers by one rule.

use motionscope_core::course::glossary;

use super::rules;
use super::walks::ALL;

/// Places whose text is read as it stands; pseudocode has a syntax of its own.
fn is_prose(place: &str) -> bool {
    place != "pseudocode" && place != "equation"
}

#[test]
fn nothing_is_said_that_no_textbook_says() {
    let mut faults = Vec::new();
    for (estimator, seen) in ALL.iter() {
        let id = estimator.info().id;
        for (place, text) in seen.texts.iter() {
            let found = rules::faults(text, is_prose(place)).into_iter();
            faults.extend(found.map(|fault| format!("{id}, {place}: {fault}: {text}")));
        }
    }
    let shown: Vec<_> = faults.iter().take(60).map(String::as_str).collect();
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), shown.join("\n"));
}

/// A value that was not put leaves its name in braces, and a formula that cannot be read stands as it is.
#[test]
fn no_template_is_shown_as_it_stands() {
    let is_template = |place: &str, text: &str| match place {
        "sentence" => text.contains(['{', '}']),
        "equation" => text.contains(['\\', '{']),
        _ => false,
    };
    for (estimator, seen) in ALL.iter() {
        let all: Vec<_> = seen.texts.iter().filter(|(place, text)| is_template(place, text)).collect();
        assert!(all.is_empty(), "{}: {all:?}", estimator.info().id);
    }
}

#[test]
fn a_quantity_has_one_number_of_decimals() {
    let faults = ALL.iter().flat_map(|(estimator, seen)| {
        seen.texts.with_changing_decimals().map(|text| format!("{}: {text}", estimator.info().id))
    });
    let faults: Vec<_> = faults.collect();
    let shown: Vec<_> = faults.iter().take(60).map(String::as_str).collect();
    assert!(faults.is_empty(), "{} texts:\n{}", faults.len(), shown.join("\n"));
}

#[test]
fn every_estimator_uses_terms_that_the_glossary_defines() {
    for (estimator, seen) in ALL.iter() {
        let terms = seen.texts.iter().filter(|(place, _)| *place == "sentence");
        let count: usize = terms.map(|(_, text)| glossary::occurrences(text).len()).sum();
        assert!(count > 3, "{}: {count} terms in all its sentences", estimator.info().id);
    }
}

/// Writes what every estimator says into the folder `PRINT_TEXTS`, a file for each, for whoever reads it as an editor.
#[test]
fn every_estimator_says_something_at_each_place() {
    for (estimator, seen) in ALL.iter() {
        let id = estimator.info().id;
        let count = |place| seen.texts.iter().filter(|(other, _)| *other == place).count();
        assert!(count("sentence") > 2 && count("legend") > 0 && count("parameter") > 0, "{id} says too little");
        if let Some(folder) = std::env::var_os("PRINT_TEXTS") {
            let lines: Vec<String> = seen.texts.iter().map(|(place, text)| format!("{place:<11} | {text}\n")).collect();
            let path = std::path::Path::new(&folder).join(format!("{id}.txt"));
            std::fs::write(path, lines.concat()).expect("a folder that can be written");
        }
    }
}

/// In prose a parameter is called by its name in words; its id is for the command line.
#[test]
fn parameters_are_called_by_their_names() {
    let mut faults = Vec::new();
    for (estimator, seen) in ALL.iter() {
        let specs = estimator.specs();
        let ids = specs.iter().filter_map(|spec| spec.name.rsplit('.').next()).filter(|id| id.contains('-'));
        // Some ids are terms of the field.
        let ids: Vec<&str> = ids.filter(|id| glossary::find(id).is_none()).collect();
        let prose = seen.texts.iter().filter(|(place, _)| ["sentence", "fact", "legend", "plot"].contains(place));
        for (place, text) in prose {
            let words = text.split(|c: char| !(c.is_alphanumeric() || c == '-'));
            let found = words.filter(|word| ids.contains(word));
            faults.extend(found.map(|id| format!("{}, {place}: {id}: {text}", estimator.info().id)));
        }
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}
