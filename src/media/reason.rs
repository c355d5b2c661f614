//! Readable error messages of decoders of other crates.

/// The most characters of such words.
const MOST: usize = 90;

/// `words` in brackets after a blank; nothing if they are those of a program to its programmer.
pub(crate) fn bracketed(words: &str) -> String {
    let words = words.lines().next().unwrap_or_default().trim().trim_end_matches('.');
    if is_plain(words) { format!(" ({words})") } else { String::new() }
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
