//! What the field does not say, and how numbers are written: for the texts of estimators and those of the program.

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

/// What is wrong with a text; where it is no prose, its numbers alone are looked at.
pub fn faults(text: &str, is_prose: bool) -> Vec<String> {
    let mut faults = Vec::new();
    if is_prose {
        let phrases = PHRASES.iter().filter(|(phrase, _)| says(text, phrase));
        faults.extend(phrases.map(|(phrase, instead)| format!("“{phrase}” ({instead})")));
        let american = AMERICAN.iter().filter(|word| says(text, word));
        faults.extend(american.map(|word| format!("“{word}” is American")));
    }
    faults.extend(wrong_number(text).map(str::to_owned));
    faults
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
