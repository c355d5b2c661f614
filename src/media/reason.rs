//! Readable reasons why a file cannot be opened.

use std::io;
use std::path::Path;

use motionscope_core::base::Error;

use crate::files::{self, IN_PAGE};

/// The most characters of such words.
const MOST: usize = 90;

/// The `words` of another crate's decoder in brackets after a blank; nothing if they are those of a program to its programmer.
pub(crate) fn bracketed(words: &str) -> String {
    let words = words.lines().next().unwrap_or_default().trim().trim_end_matches('.');
    if is_plain(words) { format!(" ({words})") } else { String::new() }
}

/// Puts the file's name in front of what is wrong with it.
pub(crate) fn about(path: &Path, error: &Error) -> Error {
    Error::new(format!("cannot open {}: {error}", Error::short_name(&files::label(path).to_string())))
}

/// Why a file cannot be read, without its name.
pub(crate) fn cannot_read(error: &io::Error) -> Error {
    Error::new(match error.kind() {
        io::ErrorKind::NotFound if IN_PAGE => {
            "it is not among the files given to this page; drop it here as well".into()
        }
        io::ErrorKind::NotFound => "there is no such file; check the path".into(),
        io::ErrorKind::PermissionDenied => "you may not read this file; ask its owner".into(),
        io::ErrorKind::InvalidData => "it is not a text file; give another file".into(),
        _ => format!("it cannot be read ({error})"),
    })
}

fn is_plain(words: &str) -> bool {
    let is_usual = |c: char| c.is_alphanumeric() || " ,;:'’-–+/×%=".contains(c);
    !words.is_empty()
        && words.chars().count() <= MOST
        && words.chars().all(is_usual)
        && !words.split(' ').any(is_identifier)
}

/// Whether this is the name of something in a program: `UnexpectedEof`, `image::Error`.
fn is_identifier(word: &str) -> bool {
    let pairs = word.chars().zip(word.chars().skip(1));
    word.contains("::") || pairs.clone().any(|(a, b)| a.is_lowercase() && b.is_uppercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_words_for_people_are_passed_on() {
        for plain in ["no color table available", "index out of bounds: the len is 3 but the index is 7", "CRC error"] {
            assert_eq!(bracketed(plain), format!(" ({plain})"));
        }
        assert_eq!(bracketed("unexpected end.\nat line 3"), " (unexpected end)");
        for odd in [
            "",
            "Unknown(48)",
            "photometric [Unknown(1), Unknown(2)]",
            "called `Option::unwrap()` on a `None` value",
            "The decoder for Png does not support UnexpectedEof",
            "a\u{1B}[31m",
            &"x ".repeat(99),
        ] {
            assert_eq!(bracketed(odd), "", "{odd}");
        }
    }
}
