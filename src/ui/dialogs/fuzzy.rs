//! Finds what a few letters mean.

use crate::search::is_one_slip;

/// The shortest word that may be misspelt, in letters: shorter ones are initials.
const SHORTEST: usize = 4;

/// What something is found by.
#[derive(Clone, Copy, Debug, Default)]
pub struct Words<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its name in scripts, or its menu.
    pub also: &'a str,
    /// The kind of thing that it is, such as its family.
    pub kind: &'a str,
    /// What people call it who do not know its name.
    pub tags: &'a str,
    /// What it is about.
    pub about: &'a str,
}

/// Where the words of a query begin words, then the score of their letters; the larger, the better.
pub type Rank = (Place, i32);

/// Where every word of a query begins a word, from the worst to the best.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// Nowhere: its letters are strewn over a name.
    Strewn,
    /// In everything together, but for a slip in a word.
    Misspelt,
    /// In everything together.
    About,
    /// In the name together with the kind, and the menu or the name for scripts.
    Beside,
    /// In the name.
    Name,
    /// In what people call it.
    Tags,
    /// The name begins with it.
    Begins,
}

/// How well `query` fits what has these words; `None` if it does not.
pub fn rank(query: &str, Words { name, also, kind, tags, about }: Words<'_>) -> Option<Rank> {
    // A match in the kind ranks below one in the name.
    let of_kind = score(query, &format!("{kind} {also}")).map(|score| score - 100);
    let score = score(query, name).max(of_kind);
    let beside = format!("{name} {kind} {also}");
    // The kind of thing comes before its own name.
    let own = name.split_once(": ").map_or(name, |(_, own)| own);
    let place = match () {
        () if begins(query, own) || begins(query, also) => Place::Begins,
        () if mentions(query, tags) => Place::Tags,
        () if mentions(query, name) => Place::Name,
        () if mentions(query, &beside) => Place::Beside,
        () if mentions(query, &format!("{beside} {tags} {about}")) => Place::About,
        () if nearly_mentions(query, &format!("{beside} {tags} {about}")) => Place::Misspelt,
        () => return Some((Place::Strewn, score?)),
    };
    Some((place, score.unwrap_or_default()))
}

/// How well `query` fits `text`: larger is better, `None` if its letters do not occur in order.
///
/// Letters at the start of a word and letters in a row count most.
pub fn score(query: &str, text: &str) -> Option<i32> {
    let (query, text) = (&*plain(query), &*plain(text));
    let letters: Vec<char> = query.chars().filter(|c| !c.is_whitespace()).flat_map(char::to_lowercase).collect();
    let text: Vec<char> = text.chars().flat_map(char::to_lowercase).collect();
    let starts = (0..text.len()).filter(|&at| Some(&text[at]) == letters.first());
    if letters.is_empty() {
        return Some(0);
    }
    let scattered = starts.filter_map(|at| from(&letters, &text, at)).max()?;
    Some(scattered + words(query, &text.iter().collect::<String>()))
}

/// Whether every word of `query` begins a word of `text`: `pyramid` is what a text about pyramids is about.
fn mentions(query: &str, text: &str) -> bool {
    let (query, text) = (plain(query), plain(text));
    let begins = |word: &str| {
        text.match_indices(word).any(|(at, _)| !text[..at].chars().next_back().is_some_and(char::is_alphanumeric))
    };
    query.split_whitespace().count() > 0 && query.split_whitespace().all(begins)
}

/// Whether every word of `query` begins a word of `text`, or does but for a slip after its first letter: `oclu` is a misspelt `occlusion`.
fn nearly_mentions(query: &str, text: &str) -> bool {
    let (query, text) = (plain(query), plain(text));
    let is_near = |typed: &str| {
        let (first, count) = (typed.chars().next(), typed.chars().count());
        let begins = |word: &str| {
            let end = |letters: usize| word.char_indices().nth(letters).map_or(word.len(), |(end, _)| end);
            (count - 1..=count + 1).any(|letters| is_one_slip(typed, &word[..end(letters)]))
        };
        let mut words = text.split(|c: char| !c.is_alphanumeric());
        mentions(typed, &text) || count >= SHORTEST && words.any(|word| word.chars().next() == first && begins(word))
    };
    query.split_whitespace().count() > 0 && query.split_whitespace().all(is_near)
}

/// Whether `text` begins with `query`.
fn begins(query: &str, text: &str) -> bool {
    let query = plain(query.trim());
    !query.is_empty() && plain(text).starts_with(&query)
}

/// As a keyboard types it: small letters without marks, and plain hyphens.
fn plain(text: &str) -> String {
    let letter = |c: char| match c {
        'ä' | 'á' | 'à' | 'â' => 'a',
        'é' | 'è' | 'ê' => 'e',
        'ö' | 'ó' | 'ô' => 'o',
        'ü' | 'ú' => 'u',
        '–' | '—' | '−' => '-',
        c => c,
    };
    text.to_lowercase().chars().map(letter).collect()
}

/// What whole stretches of `text` are worth: any word that is written out counts more than letters strewn about.
fn words(query: &str, text: &str) -> i32 {
    let query = query.to_lowercase();
    let worth = |word: &str| {
        let mut found = text.match_indices(word).map(|(at, _)| at).peekable();
        let occurs = found.peek().is_some();
        let starts = found.any(|at| !text[..at].chars().next_back().is_some_and(char::is_alphanumeric));
        200 * i32::from(occurs) + 200 * i32::from(starts)
    };
    query.split_whitespace().map(worth).sum()
}

/// The score with the first letter at `start`.
fn from(letters: &[char], text: &[char], start: usize) -> Option<i32> {
    let (mut score, mut at, mut last) = (-(start as i32) / 4, start, None);
    for letter in letters {
        let found = at + text[at..].iter().position(|c| c == letter)?;
        let starts_word = found == 0 || !text[found - 1].is_alphanumeric();
        score += if starts_word { 12 } else { 0 } + if last == found.checked_sub(1) { 8 } else { 0 };
        score -= (found - at) as i32 / 2;
        (last, at) = (Some(found), found + 1);
    }
    Some(score)
}

#[cfg(test)]
mod tests {
    use super::{mentions, nearly_mentions, score};

    #[test]
    fn a_text_is_about_the_words_that_begin_in_it() {
        assert!(mentions("pyr lev", "Levels of the pyramid."));
        assert!(
            !mentions("evels", "Levels of the pyramid.") && !mentions(" ", "Levels") && !mentions("level up", "Levels")
        );
    }

    #[test]
    fn a_word_with_a_slip_is_found_by_its_beginning() {
        let text = "Fills occlusions of the left view.";
        for typed in ["oclu", "ocllu", "occul", "ocxlu", "oclusions", "left oclu"] {
            assert!(nearly_mentions(typed, text) && !mentions(typed, text), "{typed}");
        }
        for other in ["ocl", "cclu", "oqlx", "oclu right", ""] {
            assert!(!nearly_mentions(other, text), "{other}");
        }
    }

    #[test]
    fn initials_and_runs_win() {
        let best = |query: &str, texts: &[&'static str]| texts.iter().copied().max_by_key(|t| score(query, t)).unwrap();
        let texts = ["Full screen", "Next video frame", "Play faster", "Frame t"];
        assert_eq!(best("fs", &texts), "Full screen");
        assert_eq!(best("frame", &texts), "Frame t");
        assert_eq!(best("fast", &texts), "Play faster");
        let themes = ["Pictures of several steps in the folder", "Next theme", "Dark theme", "Projector theme"];
        assert_eq!(best("projector", &themes), "Projector theme");
        assert_eq!(best("dark", &themes), "Dark theme");
        assert!(score("them", "Dark theme") > score("them", "To the end of the frame").map(|score| score + 100));
        assert_eq!(score("xyz", "Full screen"), None);
        assert!(score("lucas-kanade", "Lucas–Kanade").is_some() && score("farneback", "Farnebäck") > Some(200));
        assert_eq!(score("", "anything"), Some(0));
    }
}
