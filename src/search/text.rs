//! Texts as they are searched: without case, accents and dashes.

use super::Excerpt;

/// Letters of an excerpt before the first match, and in all.
const BEFORE: usize = 40;
const MOST: usize = 150;

/// The mark of a transposed matrix in a line of text, which formulas spell `^T`.
pub const TRANSPOSED: char = 'ᵀ';

/// The text with the mark of transposed matrices instead of its spelling.
fn transposed(text: &str) -> String {
    text.replace("^T", "ᵀ")
}

/// What is sought.
pub struct Query {
    words: Vec<Vec<char>>,
    phrase: Vec<char>,
}

impl Query {
    /// Reads the words of `text`.
    pub fn new(text: &str) -> Self {
        let text: String = transposed(&text.replace("^t", "^T")).chars().map(folded).collect();
        let words: Vec<Vec<char>> = text.split_whitespace().map(|word| singular(word).chars().collect()).collect();
        let phrase = singular(&text.split_whitespace().collect::<Vec<_>>().join(" ")).chars().collect();
        Self { words, phrase }
    }

    /// Whether nothing is sought.
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// The words.
    pub fn words(&self) -> impl Iterator<Item = &[char]> {
        self.words.iter().map(Vec::as_slice)
    }

    /// The words one after the other.
    pub fn phrase(&self) -> &[char] {
        &self.phrase
    }
}

/// The word without the letter of its plural: other forms begin with it.
fn singular(word: &str) -> &str {
    match word.strip_suffix('s') {
        Some(stem) if word.chars().count() > 3 && !stem.ends_with('s') => stem,
        _ => word,
    }
}

/// The letter as a keyboard types it, small, without the accents of European names; dashes are spaces.
fn folded(letter: char) -> char {
    match letter.to_lowercase().next().unwrap_or(letter) {
        'ä' | 'á' | 'à' | 'â' | 'ã' | 'å' | 'ą' | 'ă' => 'a',
        'ç' | 'č' | 'ć' => 'c',
        'ď' | 'đ' => 'd',
        'é' | 'è' | 'ê' | 'ë' | 'ě' | 'ę' => 'e',
        'ğ' => 'g',
        'í' | 'ì' | 'î' | 'ï' => 'i',
        'ł' => 'l',
        'ñ' | 'ň' | 'ń' => 'n',
        'ö' | 'ó' | 'ò' | 'ô' | 'õ' | 'ø' | 'ő' => 'o',
        'ř' => 'r',
        'š' | 'ś' | 'ş' => 's',
        'ť' | TRANSPOSED => 't',
        'ü' | 'ú' | 'ù' | 'û' | 'ů' | 'ű' => 'u',
        'ý' | 'ÿ' => 'y',
        'ž' | 'ź' | 'ż' => 'z',
        '-' | '–' | '—' | '\u{a0}' | '\n' => ' ',
        other => other,
    }
}

/// The words of a query as they are typed.
pub fn tokens(query: &str) -> impl Iterator<Item = &str> {
    query.split(|letter: char| folded(letter).is_whitespace()).filter(|word| !word.is_empty())
}

/// Whether a letter belongs to a word, and does not end it.
pub fn is_of_word(letter: char) -> bool {
    folded(letter).is_alphanumeric()
}

/// A text that is searched.
pub struct Searched {
    original: String,
    /// The same, letter by letter.
    folded: Vec<char>,
}

impl Searched {
    /// Prepares `original`.
    pub fn new(original: impl Into<String>) -> Self {
        let original: String = original.into();
        let original = transposed(&original);
        let folded = original.chars().map(folded).collect();
        Self { original, folded }
    }

    /// The text as it is written.
    pub fn original(&self) -> &str {
        &self.original
    }

    /// Whether it is what is sought, in the singular or the plural.
    pub fn is(&self, query: &Query) -> bool {
        let rest = self.folded.strip_prefix(query.phrase());
        rest.is_some_and(|rest| matches!(rest, [] | ['s']))
    }

    /// Whether it begins with what is sought.
    pub fn begins(&self, query: &Query) -> bool {
        self.folded.starts_with(query.phrase())
    }

    /// Whether a word of it begins with `sought`.
    pub fn has(&self, sought: &[char]) -> bool {
        self.places(sought).next().is_some()
    }

    /// Where a word begins with `sought`, in letters.
    fn places<'a>(&'a self, sought: &'a [char]) -> impl Iterator<Item = usize> + 'a {
        let begins_word = |at: &usize| *at == 0 || !self.folded[at - 1].is_alphanumeric();
        let last = self.folded.len().checked_sub(sought.len()).filter(|_| !sought.is_empty());
        let all = last.map_or(0..0, |last| 0..last + 1);
        all.filter(|at| self.folded[*at..].starts_with(sought)).filter(begins_word)
    }

    /// The part around the first match of the phrase, or else of a word; the beginning where there is none.
    pub fn excerpt(&self, query: &Query) -> Excerpt {
        let first = self.places(query.phrase()).next();
        let first = first.or_else(|| query.words().filter_map(|word| self.places(word).next()).min()).unwrap_or(0);
        let length = self.folded.len();
        // Where little is left behind the match, more of what stands before it is shown.
        let latest = length.saturating_sub(MOST);
        let from = self.word_from(first.saturating_sub(BEFORE).min(latest));
        let to = self.word_to((from + MOST).min(length), first);
        let mut marks: Vec<_> = query.words().flat_map(|word| self.places(word)).collect();
        marks.sort_unstable();
        marks.dedup();
        let mut excerpt = Excerpt { text: if from > 0 { "… ".into() } else { String::new() }, marks: Vec::new() };
        let mut marked_to = 0;
        for (at, letter) in self.original.chars().enumerate().skip(from).take(to - from) {
            if at >= marked_to && marks.binary_search(&at).is_ok() {
                marked_to = self.end_of_word(at);
                excerpt.marks.push(excerpt.text.len()..excerpt.text.len());
            }
            excerpt.text.push(if letter == '\n' { ' ' } else { letter });
            if at < marked_to
                && let Some(mark) = excerpt.marks.last_mut()
            {
                mark.end = excerpt.text.len();
            }
        }
        if to < length {
            excerpt.text += " …";
        }
        excerpt
    }

    /// The first letter of the word at `at`, or after it of the next one.
    fn word_from(&self, at: usize) -> usize {
        if at == 0 {
            return 0;
        }
        let space = self.folded[at - 1..].iter().position(|letter| *letter == ' ');
        space.map_or(at, |space| at + space)
    }

    /// The end of the last whole word before `at`, after the match at `after`.
    fn word_to(&self, at: usize, after: usize) -> usize {
        if at == self.folded.len() {
            return at;
        }
        let space = self.folded[..at].iter().rposition(|letter| *letter == ' ');
        space.filter(|space| *space > after).unwrap_or(at)
    }

    fn end_of_word(&self, at: usize) -> usize {
        let rest = self.folded[at..].iter().position(|letter| !letter.is_alphanumeric());
        // A sign that is no letter is marked by itself.
        rest.map_or(self.folded.len(), |rest| at + rest.max(1))
    }
}
