//! Errors: one sentence each.

/// The most characters that a sentence has.
const LONGEST: usize = 300;
/// The most characters that a name has in a sentence.
const LONGEST_NAME: usize = 80;
/// A word of more characters is shortened where a sentence is too long.
const LONGEST_WORD: usize = 40;
/// Characters at the end of a sentence that is cut: they say what to do.
const TAIL: usize = 110;

/// One sentence: the problem, its place, and the remedy.
///
/// It has at most 300 characters, all on one line, and no control characters, whatever names and words of other programs were
/// put into it: what is too long is shortened in the middle.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Error(String);

impl Error {
    /// An error that reads as `sentence` (no final full stop).
    pub fn new(sentence: impl Into<String>) -> Self {
        let sentence = visible(&sentence.into());
        let sentence = sentence.trim();
        let whole = sentence.strip_suffix('.').filter(|rest| !rest.ends_with('.')).unwrap_or(sentence);
        Self(fitted(whole))
    }

    /// A name as a sentence has room for it: on one line, and shortened in the middle.
    pub fn short_name(name: &str) -> String {
        shortened(&visible(name), LONGEST_NAME)
    }
}

/// `text` on one line: line ends and tabs are blanks, and what cannot be seen or turns the direction of writing is a `�`.
fn visible(text: &str) -> String {
    let blank = |c: char| if matches!(c, '\t' | '\n' | '\r' | '\u{2028}' | '\u{2029}') { ' ' } else { c };
    printable(&text.replace("\r\n", "\n").chars().map(blank).collect::<String>())
}

/// Whether a terminal obeys this character instead of showing it, or writes what follows in another direction.
pub fn is_command(c: char) -> bool {
    matches!(c, '\u{200E}' | '\u{200F}' | '\u{202A}'..='\u{202E}' | '\u{2066}'..='\u{2069}')
        || (c.is_control() && !matches!(c, '\t' | '\n'))
}

/// `text` as a terminal may show it: lines and tabs stay, and each other character that a terminal would obey is a `�`.
///
/// ```
/// assert_eq!(motionscope_core::base::printable("a\u{1B}]0;title\u{7}\n\tb"), "a�]0;title�\n\tb");
/// ```
pub fn printable(text: &str) -> String {
    text.replace("\r\n", "\n").chars().map(|c| if is_command(c) { char::REPLACEMENT_CHARACTER } else { c }).collect()
}

/// `text` with at most `most` characters: the middle of a longer one is left out.
fn shortened(text: &str, most: usize) -> String {
    let all: Vec<char> = text.chars().collect();
    if all.len() <= most {
        return text.to_owned();
    }
    let tail = (most - 1) / 2;
    let (head, tail) = (&all[..most - 1 - tail], &all[all.len() - tail..]);
    head.iter().chain(&['…']).chain(tail).collect()
}

/// `sentence` with at most [`LONGEST`] characters: first its longest words are shortened, which are names, then words in its
/// middle are left out.
fn fitted(sentence: &str) -> String {
    let excess = |sentence: &str| sentence.chars().count().saturating_sub(LONGEST);
    let mut fitted = sentence.to_owned();
    while excess(&fitted) > 0 {
        let lengths = fitted.split(' ').map(|word| word.chars().count()).enumerate();
        let Some((place, length)) = lengths.max_by_key(|(place, length)| (*length, usize::MAX - place)) else { break };
        if length <= LONGEST_WORD {
            return without_middle(&fitted);
        }
        let most = length.saturating_sub(excess(&fitted)).max(LONGEST_WORD);
        let words = fitted.split(' ').enumerate();
        let words = words.map(|(i, word)| if i == place { shortened(word, most) } else { word.to_owned() });
        fitted = words.collect::<Vec<_>>().join(" ");
    }
    fitted
}

/// The first and the last words of a sentence that is too long.
fn without_middle(sentence: &str) -> String {
    let all: Vec<char> = sentence.chars().collect();
    let (head, tail) = (&all[..LONGEST - TAIL - 3], &all[all.len() - TAIL..]);
    let head = head.iter().rposition(|c| *c == ' ').map_or(head, |end| &head[..end]);
    let tail = tail.iter().position(|c| *c == ' ').map_or(tail, |start| &tail[start + 1..]);
    head.iter().chain(&[' ', '…', ' ']).chain(tail).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn cleaned(sentence: &str) -> String {
        Error::new(sentence).to_string()
    }

    #[test]
    fn a_sentence_that_fits_is_left_as_it_is() {
        for sentence in ["", "frame 3 of ball.mp4 is damaged; copy it again", "a name ends in .flo", "and so on..."] {
            assert_eq!(cleaned(sentence), sentence);
        }
        assert_eq!(cleaned("cannot open a.mp4: it is damaged."), "cannot open a.mp4: it is damaged");
    }

    #[test]
    fn it_is_one_line_without_control_characters() {
        assert_eq!(
            cleaned("cannot open a\u{1B}[31m\u{0}b.mp4:\r\nit is\tdamaged\n"),
            "cannot open a�[31m�b.mp4: it is damaged"
        );
        assert_eq!(cleaned("a\u{202E}4pm.exe"), "a�4pm.exe");
    }

    #[test]
    fn long_names_are_shortened_in_the_middle() {
        let name = format!("/home/{}/ball.mp4", "x".repeat(4000));
        let cleaned = cleaned(&format!("cannot open {name}: its index (the moov box) is missing; copy it again"));
        assert_eq!(cleaned.chars().count(), LONGEST);
        assert!(
            cleaned.starts_with("cannot open /home/xxx") && cleaned.contains("xxx/ball.mp4: its index"),
            "{cleaned}"
        );
        let short = Error::short_name(&name);
        assert!(
            short.chars().count() == LONGEST_NAME && short.contains('…') && short.ends_with("/ball.mp4"),
            "{short}"
        );
        assert_eq!(Error::short_name("ball.mp4"), "ball.mp4");
    }

    #[test]
    fn two_long_names_share_the_room() {
        let [a, b] = ["a", "b"].map(|c| c.repeat(500));
        let cleaned = cleaned(&format!("{a} and {b} differ"));
        assert!(cleaned.contains("aaa") && cleaned.contains("bbb") && cleaned.ends_with(" differ"), "{cleaned}");
    }

    #[test]
    fn of_many_words_the_first_and_the_last_are_reported() {
        let cleaned =
            cleaned(&format!("there is no estimator magic; there are {}full-search", "three-step, ".repeat(60)));
        assert!(cleaned.starts_with("there is no estimator magic; there are three-step,"), "{cleaned}");
        assert!(cleaned.contains("three-step, … three-step,") && cleaned.ends_with("full-search"), "{cleaned}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]
        #[test]
        fn any_text_makes_one_sentence(parts in prop::collection::vec(".{0,40}|[ a-z]{0,200}|[\\x00-\\x20]{0,9}", 0..12)) {
            let cleaned = cleaned(&parts.concat());
            prop_assert!(cleaned.chars().count() <= LONGEST && !cleaned.chars().any(char::is_control), "{cleaned:?}");
            prop_assert_eq!(Error::new(cleaned.clone()).to_string().chars().count() <= LONGEST, true);
        }
    }
}
