//! Search over all text: lessons, glossary, estimators, parameters, charts and examples, for the window and the command line.
//!
//! [`search()`] ranks entries: titles come before text, phrases before words. [`suggest`] replaces words that nothing has by
//! the nearest of titles, or else of texts. A [`Target`] says what is opened, in the window and as arguments of the program.

mod entries;
mod spelling;
mod text;

use std::ops::Range;
use std::sync::OnceLock;

use motionscope_core::course::examples::Example;
use motionscope_core::course::glossary::Term;

use crate::session::example;
use crate::session::lesson::Address;
use crate::view::panes::Pane;
use entries::Entry;
pub use entries::is_same_parameter;
pub use spelling::{is_one_slip, suggest};
pub use text::TRANSPOSED;
use text::{Query, Searched};

/// What a hit is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// A term of the glossary.
    Term,
    /// An estimator.
    Estimator,
    /// A page of a lesson.
    Page,
    /// A parameter.
    Parameter,
    /// A chart.
    Chart,
    /// An example of an estimator.
    Example,
}

impl Kind {
    /// The heading over hits of this kind.
    pub fn title(self) -> &'static str {
        match self {
            Self::Term => "Glossary",
            Self::Estimator => "Estimators",
            Self::Page => "Lessons",
            Self::Parameter => "Parameters",
            Self::Chart => "Charts",
            Self::Example => "Examples",
        }
    }

    /// One of this kind, as scripts call it.
    pub fn id(self) -> &'static str {
        match self {
            Self::Term => "term",
            Self::Estimator => "estimator",
            Self::Page => "page",
            Self::Parameter => "parameter",
            Self::Chart => "chart",
            Self::Example => "example",
        }
    }
}

/// What is opened.
#[derive(Clone, Debug)]
pub enum Target {
    /// The glossary at a term.
    Term(&'static Term),
    /// The estimator with this id.
    Estimator(&'static str),
    /// A page of a lesson.
    Page(Address),
    /// A parameter of the estimator with this id, by its name.
    Parameter(&'static str, &'static str),
    /// A chart.
    Chart(&'static Pane),
    /// An example of the estimator with this id.
    Example(&'static str, &'static Example),
}

impl Target {
    /// The arguments of the program that show it, without its name.
    pub fn arguments(&self) -> String {
        match self {
            Self::Term(term) => format!("glossary {}", term.name),
            Self::Estimator(id) | Self::Parameter(id, _) => format!("list {id}"),
            Self::Page(address) => address.name().to_string_lossy().into_owned(),
            Self::Chart(pane) => format!("run CLIP --panes {} --overlay FILE", pane.id),
            Self::Example(id, example) => example::name(id, example),
        }
    }
}

/// The words around a match.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Excerpt {
    /// A part of the text, with an ellipsis where more of it stands before or behind.
    pub text: String,
    /// Where the words that were sought stand in it.
    pub marks: Vec<Range<usize>>,
}

/// Something that was found.
#[derive(Clone, Debug)]
pub struct Hit {
    /// What it is.
    pub kind: Kind,
    /// Its name or title.
    pub title: String,
    /// Where it is from: the lesson, the chapter, the family.
    pub place: String,
    /// The words around the match.
    pub excerpt: Excerpt,
    /// What is opened.
    pub target: Target,
}

/// Returns everything with all words of `query` in it, the best first: titles before text, whole phrases before single words.
///
/// A word stands for all that begin with it, whatever their case, accents and dashes.
pub fn search(query: &str) -> Vec<Hit> {
    let query = Query::new(query);
    if query.is_empty() {
        return Vec::new();
    }
    let mut found: Vec<_> = index().iter().filter_map(|entry| Some((rank(entry, &query)?, entry))).collect();
    // Equal ranks stay in the order of the course.
    found.sort_by_key(|(rank, entry)| (*rank, entry.kind));
    found.into_iter().map(|(_, entry)| hit(entry, &query)).collect()
}

/// Whether anything has all words of `query`.
fn finds(query: &str) -> bool {
    let query = Query::new(query);
    !query.is_empty() && index().iter().any(|entry| rank(entry, &query).is_some())
}

/// Returns `hits` by kind, the kind with the best of them first.
pub fn grouped(hits: &[Hit]) -> Vec<(Kind, Vec<&Hit>)> {
    let mut groups: Vec<(Kind, Vec<&Hit>)> = Vec::new();
    for hit in hits {
        match groups.iter_mut().find(|(kind, _)| *kind == hit.kind) {
            Some((_, group)) => group.push(hit),
            None => groups.push((hit.kind, vec![hit])),
        }
    }
    groups
}

fn index() -> &'static [Entry] {
    static INDEX: OnceLock<Vec<Entry>> = OnceLock::new();
    INDEX.get_or_init(entries::all)
}

/// How well an entry fits, the best first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    /// It is called so.
    Title,
    /// So is another spelling of it.
    Alias,
    /// Its title begins so.
    TitleBegins,
    /// Its title has all words.
    InTitle,
    /// Another spelling of it does.
    InAlias,
    /// Its title has some of the words, and its text the others.
    PartlyInTitle,
    /// Its text has the words one after the other.
    Phrase,
    /// Its text has all words.
    InText,
}

fn rank(entry: &Entry, query: &Query) -> Option<Rank> {
    let has_all = |text: &Searched| query.words().all(|word| text.has(word));
    let (title, also, texts) = (&entry.title, &entry.also, &entry.texts);
    if title.is(query) {
        return Some(Rank::Title);
    }
    if also.iter().any(|alias| alias.is(query)) {
        return Some(Rank::Alias);
    }
    if title.begins(query) {
        return Some(Rank::TitleBegins);
    }
    if has_all(title) {
        return Some(Rank::InTitle);
    }
    if also.iter().any(has_all) {
        return Some(Rank::InAlias);
    }
    let anywhere = |word: &[char]| [title].into_iter().chain(also).chain(texts).any(|text| text.has(word));
    if !query.words().all(anywhere) {
        return None;
    }
    Some(match () {
        () if query.words().any(|word| title.has(word)) => Rank::PartlyInTitle,
        () if texts.iter().any(|text| text.has(query.phrase())) => Rank::Phrase,
        () => Rank::InText,
    })
}

/// The excerpt of an entry: the part of its text with most of the words.
fn hit(entry: &Entry, query: &Query) -> Hit {
    let count = |text: &Searched| {
        let words = query.words().filter(|word| text.has(word)).count();
        words + usize::from(text.has(query.phrase()))
    };
    // A hit by name has its first text as excerpt, which defines it; so have equal hits.
    let is_named = query.words().all(|word| entry.title.has(word));
    let texts = if is_named { &entry.texts[..entry.texts.len().min(1)] } else { &entry.texts };
    let best = texts.iter().rev().max_by_key(|text| count(text));
    Hit {
        kind: entry.kind,
        title: entry.title.original().to_owned(),
        place: entry.place.clone(),
        excerpt: best.map(|text| text.excerpt(query)).unwrap_or_default(),
        target: entry.target.clone(),
    }
}

#[cfg(test)]
mod tests;
