//! What was probably meant where the words that were typed find nothing.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};
use std::iter::once;
use std::ops::Bound;
use std::sync::OnceLock;

use motionscope_core::base::words::nearest;

use super::text::{Query, TRANSPOSED, is_of_word, tokens};
use super::{finds, index};

/// The shortest word that is suggested, in letters.
const SHORTEST: usize = 3;
/// Letters by which a suggestion is longer or shorter at most: no word that differs more is near.
const LONGER: usize = 2;
/// Words that are tried for each one that was typed, at most.
const MOST_WORDS: usize = 8;
/// Queries that are tried, at most.
const MOST_QUERIES: usize = 16;

/// How a word is written.
struct Spelling {
    /// As it is most often.
    written: &'static str,
    /// Number of times that it occurs, whatever its case and number.
    count: usize,
    /// Whether a name or a title has it.
    is_of_title: bool,
}

/// The words of everything that can be found, by their letters as they are searched.
struct Vocabulary(BTreeMap<String, Spelling>);

impl Vocabulary {
    fn get() -> &'static Self {
        static VOCABULARY: OnceLock<Vocabulary> = OnceLock::new();
        VOCABULARY.get_or_init(Self::new)
    }

    fn new() -> Self {
        let (mut counts, mut titles) = (BTreeMap::<String, BTreeMap<&'static str, usize>>::new(), BTreeSet::new());
        for entry in index() {
            let names = [&entry.title].into_iter().chain(&entry.also).map(|text| (text, true));
            let texts = entry.texts.iter().map(|text| (text, false));
            for (text, is_name) in names.chain(texts) {
                let words = text.original().split(|letter: char| !is_of_word(letter));
                for word in words.filter(|word| is_suggested(word)) {
                    let letters = letters(word);
                    *counts.entry(letters.clone()).or_default().entry(word).or_default() += 1;
                    if is_name {
                        titles.insert(letters);
                    }
                }
            }
        }
        let spelled = |(letters, all): (String, BTreeMap<&'static str, usize>)| {
            let (count, is_of_title) = (all.values().sum(), titles.contains(&letters));
            let (written, _) = all.into_iter().max_by_key(|(_, count)| *count)?;
            Some((letters, Spelling { written, count, is_of_title }))
        };
        Self(counts.into_iter().filter_map(spelled).collect())
    }

    /// The words that begin with these letters, those of titles first, then the most frequent.
    fn completions(&self, letters: &str) -> Vec<&'static str> {
        let from = self.0.range::<str, _>((Bound::Included(letters), Bound::Unbounded));
        let mut all: Vec<_> = from.take_while(|(word, _)| word.starts_with(letters)).map(|(_, of)| of).collect();
        all.sort_by_key(|of| (!of.is_of_title, Reverse(of.count)));
        all.into_iter().map(|of| of.written).collect()
    }

    /// The words that these letters may be a misspelling of: the nearest first, then those of titles, then the most frequent.
    fn near(&self, letters: &str) -> Vec<&'static str> {
        let length = letters.chars().count();
        let is_near = |(word, _): &(&String, &Spelling)| {
            word.chars().count().abs_diff(length) <= LONGER && nearest(letters, once(word.as_str())).is_some()
        };
        let mut all: Vec<_> = self.0.iter().filter(is_near).collect();
        all.sort_by_key(|(word, of)| (!is_one_slip(letters, word), !of.is_of_title, Reverse(of.count)));
        all.into_iter().map(|(_, of)| of.written).collect()
    }

    /// What may be meant by a word, the likeliest first: itself where it is a word, too short to be judged, or a number or symbol; else
    /// the words that begin with it, then those that it may be a misspelling of.
    fn meanings<'a>(&self, word: &'a str) -> Vec<&'a str> {
        let letters = letters(word);
        if !is_suggested(word) || self.0.contains_key(&letters) {
            return vec![word];
        }
        let mut all = self.completions(&letters);
        // Room is left for the others.
        all.truncate(MOST_WORDS / 2);
        all.extend(self.near(&letters));
        all.truncate(MOST_WORDS);
        all
    }
}

/// Whether a word is one that can be misspelt: no number, no symbol.
fn is_suggested(word: &str) -> bool {
    word.chars().count() >= SHORTEST && word.chars().all(|letter| letter.is_alphabetic() && letter != TRANSPOSED)
}

/// The letters of a word as they are searched.
fn letters(word: &str) -> String {
    Query::new(word).phrase().iter().collect()
}

/// Whether one word becomes the other by a letter that is dropped, added or replaced, or by a swap of two neighbours.
pub fn is_one_slip(one: &str, other: &str) -> bool {
    let [one, other] = [one, other].map(|word| word.chars().collect::<Vec<_>>());
    let begins_alike = one.iter().zip(&other).take_while(|(a, b)| a == b).count();
    let (one, other) = (&one[begins_alike..], &other[begins_alike..]);
    let ends_alike = one.iter().rev().zip(other.iter().rev()).take_while(|(a, b)| a == b).count();
    match (&one[..one.len() - ends_alike], &other[..other.len() - ends_alike]) {
        ([] | [_], [] | [_]) => true,
        ([first, second], [third, fourth]) => first == fourth && second == third,
        _ => false,
    }
}

/// Returns `query`, where nothing has all of its words, with each word that nothing has replaced by a near one and each beginning of a
/// word completed: the likeliest of those that find anything.
pub fn suggest(query: &str) -> Option<String> {
    if finds(query) {
        return None;
    }
    let mut tried: Vec<(usize, Vec<&str>)> = vec![(0, Vec::new())];
    for word in tokens(query) {
        let meanings = Vocabulary::get().meanings(word);
        let mut longer = Vec::new();
        for (doubt, before) in &tried {
            for (i, meaning) in meanings.iter().enumerate() {
                let mut words = before.clone();
                words.push(*meaning);
                longer.push((doubt + i, words));
            }
        }
        longer.sort_by_key(|(doubt, _)| *doubt);
        longer.truncate(MOST_QUERIES);
        tried = longer;
    }
    tried.into_iter().map(|(_, words)| words.join(" ")).find(|query| finds(query))
}
