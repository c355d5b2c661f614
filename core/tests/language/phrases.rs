//! What estimators say is the language of the field: no phrase that a textbook would not print, and numbers by one rule.

use motionscope_core::glossary;

use crate::walks::ALL;

/// Words that do not stand for what they mean, with what to write instead.
const PHRASES: &[(&str, &str)] = &[
    ("vector found", "motion vector"),
    ("how far it moves", "displacement"),
    ("what is tested", "candidates"),
    ("what is expected", "the prediction"),
    ("what differs", "the difference image"),
    ("what moves", "foreground"),
    ("what is left", "the residual"),
    ("what is taken", "the update"),
    ("difference of b", "cost"),
    ("so many frames", "a number of frames"),
    ("so many", "a number"),
    ("as far as there is room", "a limit"),
    ("the line that each pixel allows", "constraint line"),
    ("that was the last", "converged"),
    ("there and back", "forward–backward check"),
    ("bring back", "warp"),
    ("brought back", "warped"),
    ("squared distance from", "squared Mahalanobis distance"),
    ("in units of what", "Mahalanobis distance"),
    ("shared out", "assigned"),
    ("at first", "initial or by default"),
    ("which noise", "random seed"),
    ("looks back in time", "causal"),
    ("of the work", "done"),
    ("gray levels off", "a difference in gray levels"),
    ("is off by", "violates, differs by"),
    ("takes off", "opening removes"),
    ("by itself alone", "alone"),
    ("who ", "data are not persons"),
    ("whose", "data are not persons"),
    ("nobody", "data are not persons"),
    ("someone", "data are not persons"),
    ("believed", "confirmed"),
    ("believe", "confirm"),
    (" wants", "asks for"),
    ("is told", "is reported"),
    ("gives up", "is cancelled, is deleted"),
    ("give up", "cancel, delete"),
    ("patience", "max age"),
];

/// Spellings of the identifiers in what is read.
const AMERICAN: &[&str] =
    &["color", "neighbor", "center", "initialize", "minimize", "regulariz", "normalize", "linearize"];

/// Whether `text` contains `phrase`, from the start of a word on.
fn says(text: &str, phrase: &str) -> bool {
    let text = text.to_lowercase();
    let mut from = 0;
    while let Some(at) = text[from..].find(phrase) {
        let before = text[..from + at].chars().next_back();
        if phrase.starts_with(' ') || before.is_none_or(|letter| !letter.is_alphanumeric()) {
            return true;
        }
        from += at + phrase.len();
    }
    false
}

/// What is wrong with the numbers of a text.
fn wrong_number(text: &str) -> Option<&'static str> {
    let letters: Vec<char> = text.chars().collect();
    let digit = |i: Option<usize>| i.and_then(|i| letters.get(i)).is_some_and(char::is_ascii_digit);
    for (i, letter) in letters.iter().enumerate() {
        let before = i.checked_sub(1).and_then(|i| letters.get(i));
        if *letter == '-' && digit(Some(i + 1)) && before.is_none_or(|c| " (,=|".contains(*c)) {
            return Some("a hyphen stands for a minus sign");
        }
        let is_start = digit(Some(i)) && !digit(i.checked_sub(1)) && !before.is_some_and(|c| ".\u{202f}".contains(*c));
        if is_start && (i..i + 5).all(|i| digit(Some(i))) {
            return Some("five digits stand together");
        }
    }
    None
}

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
            let phrases = PHRASES.iter().filter(|(phrase, _)| is_prose(place) && says(text, phrase));
            faults.extend(phrases.map(|(phrase, instead)| format!("{id}, {place}: “{phrase}” ({instead}): {text}")));
            let american = AMERICAN.iter().filter(|word| is_prose(place) && says(text, word));
            faults.extend(american.map(|word| format!("{id}, {place}: “{word}” is American: {text}")));
            faults.extend(wrong_number(text).map(|fault| format!("{id}, {place}: {fault}: {text}")));
        }
    }
    let shown: Vec<_> = faults.iter().take(60).map(String::as_str).collect();
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), shown.join("\n"));
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

#[test]
fn faults_are_found() {
    assert!(says("An object is believed in once", "believed") && says("Data who see", "who "));
    assert!(!says("the whole picture", "who ") && !says("a coloured one", "lour"));
    assert!(says("the color of", "color") && !says("colour", "color"));
    assert_eq!(wrong_number("moves by -3 px"), Some("a hyphen stands for a minus sign"));
    assert_eq!(wrong_number("costs 12345"), Some("five digits stand together"));
    for right in ["moves by −3 px", "12\u{202f}345 of 1234", "0.12345", "frames 3-5", "x-3"] {
        assert_eq!(wrong_number(right), None, "{right}");
    }
}
