//! The terms of the course with their definitions, and where they occur in a text.

mod roles;

use std::collections::HashMap;
use std::fmt;
use std::ops::Range;
use std::sync::{LazyLock, OnceLock};

use serde::Deserialize;

use super::bundled;
use crate::base::{Error, words};

pub use roles::role_of;

/// Every term of the course, sorted by name without regard to case.
pub static GLOSSARY: LazyLock<Vec<Term>> = LazyLock::new(|| {
    bundled::read("glossary.toml", include_str!("../../assets/glossary.toml")).expect("the laws read it")
});

/// A term of the field, with the definition that a reader sees on hover.
#[derive(Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Term {
    /// The name by which the program calls it everywhere.
    pub name: &'static str,
    /// Other spellings by which it is found: plurals, abbreviations, American spellings. One without a lower-case letter, such as
    /// `SAD` or `FAST`, is an abbreviation and is found in a text only as it is written.
    #[serde(default)]
    pub aliases: Vec<&'static str>,
    /// Its usual symbol in formulas; a letter below the line follows a low line, as in `I_t`.
    pub symbol: Option<&'static str>,
    /// One sentence.
    pub definition: &'static str,
    /// The chapter that introduces it.
    pub chapter: Chapter,
}

impl Term {
    /// The name and the aliases.
    pub fn spellings(&self) -> impl Iterator<Item = &'static str> {
        std::iter::once(self.name).chain(self.aliases.iter().copied())
    }
}

/// A chapter of the course.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Chapter {
    /// Scenes, cameras and the ways in which things move.
    DynamicScenes,
    /// Block matching and its use in video compression.
    MotionVectors,
    /// Optical flow from derivatives.
    DifferentialMethods,
    /// Foreground masks and their regions.
    MovingObjects,
    /// Paths of points and objects.
    Trajectories,
    /// Features, descriptors, and matches between them.
    InterestPoints,
    /// Recursive estimation of a state.
    KalmanFilters,
    /// Several objects with their identities.
    MultipleObjects,
    /// Errors, scores and experiments.
    Evaluation,
}

impl Chapter {
    /// All chapters in the order of the course.
    pub const ALL: [Self; 9] = [
        Self::DynamicScenes,
        Self::MotionVectors,
        Self::DifferentialMethods,
        Self::MovingObjects,
        Self::Trajectories,
        Self::InterestPoints,
        Self::KalmanFilters,
        Self::MultipleObjects,
        Self::Evaluation,
    ];

    /// The chapter's heading.
    pub fn title(self) -> &'static str {
        match self {
            Self::DynamicScenes => "Dynamic scene analysis",
            Self::MotionVectors => "Estimating motion vectors",
            Self::DifferentialMethods => "Differential motion analysis",
            Self::MovingObjects => "Detection of moving objects",
            Self::Trajectories => "Trajectory detection",
            Self::InterestPoints => "Correspondence of interest points",
            Self::KalmanFilters => "Kalman filters",
            Self::MultipleObjects => "Multi-object tracking",
            Self::Evaluation => "Evaluation",
        }
    }
}

impl fmt::Display for Chapter {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.title())
    }
}

/// The term with this name or alias, without regard to case; hyphens and dashes are the same.
///
/// ```
/// let term = motionscope_core::course::glossary::find("Horn-Schunck").expect("it is in the glossary");
/// assert_eq!(term.name, "Horn–Schunck method");
/// ```
pub fn find(word: &str) -> Option<&'static Term> {
    index().terms.get(&Normal::new(word.trim()).text).copied()
}

/// The chapters from which the formulas of a family of estimators take their symbols, the nearest first.
pub fn chapters_of(family: &str) -> &'static [Chapter] {
    match family {
        "Block matching" => &[Chapter::MotionVectors],
        "Optical flow" => &[Chapter::DifferentialMethods, Chapter::DynamicScenes, Chapter::MotionVectors],
        "Correspondence" => &[Chapter::InterestPoints, Chapter::MotionVectors],
        "Motion segmentation" => &[Chapter::DynamicScenes, Chapter::MovingObjects],
        "Interest points" => &[Chapter::InterestPoints, Chapter::DifferentialMethods],
        "Moving objects" => &[Chapter::MovingObjects, Chapter::DynamicScenes],
        "Stereo" => &[Chapter::InterestPoints, Chapter::DynamicScenes],
        "Tracking" => &[Chapter::KalmanFilters, Chapter::MultipleObjects],
        "Region tracking" => &[Chapter::Trajectories, Chapter::MovingObjects],
        _ => &[],
    }
}

/// Words that mean something else in a family of estimators: the term, the family, and the term that is meant there.
const SENSES: [(&str, &str, &str); 3] = [
    ("hypothesis", "Region tracking", "state hypothesis"),
    ("hypothesis", "Tracking", "global hypothesis"),
    ("precision", "Region tracking", "precision plot"),
];

/// The term that is meant by `term` in a text of an estimator of this family.
///
/// ```
/// use motionscope_core::course::glossary::{find, in_family};
///
/// let hypothesis = find("hypotheses").expect("it is in the glossary");
/// assert_eq!(in_family(hypothesis, "Region tracking").name, "state hypothesis");
/// assert_eq!(in_family(hypothesis, "Correspondence").name, "hypothesis");
/// ```
pub fn in_family(term: &'static Term, family: &str) -> &'static Term {
    let sense = SENSES.iter().find(|(name, of, _)| (*name, *of) == (term.name, family));
    sense.and_then(|(.., meant)| find(meant)).unwrap_or(term)
}

/// The term with this name or alias, as [`find`] finds it.
///
/// # Errors
/// If there is none: a sentence with the nearest spelling, or with the terms that contain the word.
pub fn lookup(word: &str) -> Result<&'static Term, Error> {
    find(word).ok_or_else(|| Error::new(unknown(word.trim())))
}

fn unknown(word: &str) -> String {
    let normal = Normal::new(word).text;
    if let Some(nearest) = words::nearest(&normal, index().terms.keys().map(String::as_str)).and_then(find) {
        return format!("there is no term {word} in the glossary; the nearest is {}", nearest.name);
    }
    let has_it = |term: &&Term| {
        !normal.is_empty() && term.spellings().any(|written| Normal::new(written).text.contains(&normal))
    };
    match GLOSSARY.iter().filter(has_it).map(|term| term.name).take(8).collect::<Vec<_>>().join(", ") {
        names if names.is_empty() => format!("there is no term {word} in the glossary; without a term, all are listed"),
        names => format!("there is no term {word} in the glossary; terms that contain it: {names}"),
    }
}

/// Where terms occur in `text`: byte ranges in ascending order, each term at its first occurrence only.
///
/// Whole words are found, without regard to case; where several terms begin at a word, the longest wins. The time is proportional
/// to the length of the text.
///
/// ```
/// use motionscope_core::course::glossary::occurrences;
///
/// let text = "Both eigenvalues of the structure tensor are large.";
/// let found: Vec<_> = occurrences(text).into_iter().map(|(range, term)| (&text[range], term.name)).collect();
/// assert_eq!(found, [("eigenvalues", "eigenvalue"), ("structure tensor", "structure tensor")]);
/// ```
pub fn occurrences(text: &str) -> Vec<(Range<usize>, &'static Term)> {
    let (normal, index) = (Normal::new(text), index());
    let mut found: Vec<(Range<usize>, &'static Term)> = Vec::new();
    let mut end = 0;
    for word in words(&normal.text) {
        if word.start < end {
            continue;
        }
        let Some(spellings) = index.by_first_word.get(&normal.text[word.clone()]) else { continue };
        let here = spellings.iter().find_map(|spelling| spelling.at(text, &normal, word.start));
        let Some((range, term)) = here else { continue };
        end = range.end;
        if !found.iter().any(|(_, known)| std::ptr::eq(*known, term)) {
            found.push((normal.offsets[range.start]..normal.offsets[range.end], term));
        }
    }
    found
}

/// A way to write a term.
struct Spelling {
    written: &'static str,
    normal: String,
    term: &'static Term,
}

impl Spelling {
    /// The range of the normalized text in which it stands at `start`, as a whole word.
    fn at(&self, text: &str, normal: &Normal, start: usize) -> Option<(Range<usize>, &'static Term)> {
        let rest = normal.text[start..].strip_prefix(self.normal.as_str())?;
        let end = normal.text.len() - rest.len();
        let is_whole = !rest.starts_with(is_of_word);
        let as_written = || text[normal.offsets[start]..normal.offsets[end]] == *self.written;
        (is_whole && (!is_abbreviation(self.written) || as_written())).then_some((start..end, self.term))
    }
}

/// The spellings of all terms.
struct Index {
    /// By normalized spelling.
    terms: HashMap<String, &'static Term>,
    /// By first word, the longest spelling first.
    by_first_word: HashMap<String, Vec<Spelling>>,
}

fn index() -> &'static Index {
    static INDEX: OnceLock<Index> = OnceLock::new();
    INDEX.get_or_init(|| {
        let mut index = Index { terms: HashMap::new(), by_first_word: HashMap::new() };
        for (term, written) in GLOSSARY.iter().flat_map(|term| term.spellings().map(move |written| (term, written))) {
            let normal = Normal::new(written).text;
            index.terms.insert(normal.clone(), term);
            let first = words(&normal).next().unwrap_or_default();
            let spelling = Spelling { written, normal: normal.clone(), term };
            index.by_first_word.entry(normal[first].to_owned()).or_default().push(spelling);
        }
        for spellings in index.by_first_word.values_mut() {
            spellings.sort_by_key(|spelling| std::cmp::Reverse(spelling.normal.len()));
        }
        index
    })
}

/// A text as it is compared: lower case, plain hyphens and spaces.
struct Normal {
    text: String,
    /// For each byte of `text`, and for its end, where the character that it comes from begins in the original.
    offsets: Vec<usize>,
}

impl Normal {
    fn new(original: &str) -> Self {
        let (mut text, mut offsets) = (String::with_capacity(original.len()), Vec::with_capacity(original.len() + 1));
        for (offset, letter) in original.char_indices() {
            let plain = match letter {
                '\u{2010}'..='\u{2013}' => '-',
                '\u{a0}' | '\u{202f}' | '\n' | '\t' => ' ',
                // One letter for one, so that offsets stay simple.
                _ => letter.to_lowercase().next().unwrap_or(letter),
            };
            text.push(plain);
            offsets.resize(text.len(), offset);
        }
        offsets.push(original.len());
        Self { text, offsets }
    }
}

/// Whether a letter belongs to a word: letters with their marks, digits, and a low line, which joins a letter and its index.
fn is_of_word(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_' || ('\u{300}'..='\u{36f}').contains(&letter)
}

/// The ranges of the words of a text.
fn words(text: &str) -> impl Iterator<Item = Range<usize>> {
    let mut end = 0;
    std::iter::from_fn(move || {
        let start = end + text[end..].find(is_of_word)?;
        end = text[start..].find(|letter| !is_of_word(letter)).map_or(text.len(), |length| start + length);
        Some(start..end)
    })
}

fn is_abbreviation(written: &str) -> bool {
    !written.chars().any(char::is_lowercase)
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    fn found(text: &str) -> Vec<(&str, &str)> {
        occurrences(text).into_iter().map(|(range, term)| (&text[range], term.name)).collect()
    }

    #[test]
    fn terms_are_sorted_and_each_spelling_has_one_meaning() {
        assert!(GLOSSARY.len() >= 140, "{}", GLOSSARY.len());
        let names: Vec<_> = GLOSSARY.iter().map(|term| term.name.to_lowercase()).collect();
        assert!(names.is_sorted(), "{:?}", names.windows(2).find(|pair| pair[0] > pair[1]));
        let mut known = HashSet::new();
        for written in GLOSSARY.iter().flat_map(Term::spellings) {
            assert!(known.insert(Normal::new(written).text), "{written} is there twice");
            assert!(written.starts_with(is_of_word) && written.trim() == written, "{written}");
        }
        for chapter in Chapter::ALL {
            assert!(GLOSSARY.iter().filter(|term| term.chapter == chapter).count() >= 10, "{chapter}");
        }
        assert!(Chapter::ALL.is_sorted());
    }

    #[test]
    fn definitions_are_one_sentence_that_is_not_circular() {
        for Term { name, definition, symbol, .. } in GLOSSARY.iter() {
            assert!(definition.starts_with(char::is_uppercase), "{name}");
            assert!(definition.ends_with('.') && !definition.contains(". "), "{name}: {definition}");
            assert!((20..=240).contains(&definition.len()), "{name}: {}", definition.len());
            assert!(!definition.contains("  ") && !definition.contains(['"', '\n']), "{name}");
            let begins = definition.to_lowercase();
            assert!(!begins.starts_with(&format!("the {} ", name.to_lowercase())), "{name}");
            assert!(symbol.is_none_or(|symbol| !symbol.is_empty()));
        }
    }

    #[test]
    fn terms_are_found_by_name_and_alias() {
        for (word, name) in [
            ("Eigenvalues", "eigenvalue"),
            ("sad", "sum of absolute differences"),
            ("nis", "NIS"),
            ("Horn-Schunck", "Horn–Schunck method"),
            ("lucas–kanade", "Lucas–Kanade method"),
            (" sequential search ", "full search"),
            ("regularization", "regularisation"),
        ] {
            assert_eq!(find(word).map(|term| term.name), Some(name), "{word}");
        }
        assert!(["", "eigen", "the", "größe"].iter().all(|word| find(word).is_none()));
        for term in GLOSSARY.iter() {
            assert!(term.spellings().all(|written| find(written) == Some(term)), "{}", term.name);
        }
    }

    #[test]
    fn a_word_has_the_sense_of_the_family() {
        for (name, family, meant) in SENSES {
            let term = find(name).expect("a term");
            assert!(find(meant).is_some() && chapters_of(family).len() > 1, "{name} in {family}");
            assert_eq!(in_family(term, family).name, meant);
            assert_eq!(in_family(term, "Interest points"), term);
        }
    }

    #[test]
    fn an_unknown_term_is_answered_with_similar_ones() {
        let refused = |word: &str| lookup(word).expect_err("it is no term").to_string();
        assert!(refused("eigenvalu").ends_with("; the nearest is eigenvalue"), "{}", refused("eigenvalu"));
        assert!(refused("Kalman").contains("Kalman filter") && refused("Kalman").contains("contain it"));
        assert!(refused("quark").ends_with("; without a term, all are listed"));
        assert!(refused("").ends_with("; without a term, all are listed"));
    }

    #[test]
    fn the_longest_term_is_found_in_whole_words() {
        assert_eq!(found("The search window ends."), [("search window", "search window")]);
        assert_eq!(found("motion-compensated prediction"), [("motion-compensated prediction", "motion compensation")]);
        assert_eq!(found("costly unblocked tracker"), []);
        assert_eq!(found("I_costs costs_2"), []);
        assert_eq!(
            found("The Kalman gain weighs the innovation covariance S."),
            [("Kalman gain", "Kalman gain"), ("innovation covariance", "innovation covariance"),]
        );
        // A longer term that is not finished leaves the shorter one.
        assert_eq!(found("structure tensorial cost surfaced"), [("cost", "cost")]);
    }

    #[test]
    fn abbreviations_are_found_as_written() {
        assert_eq!(found("A sad, fast sort."), []);
        let names: Vec<_> = occurrences("SAD, FAST and SORT").into_iter().map(|(_, term)| term.name).collect();
        assert_eq!(names, ["sum of absolute differences", "FAST detector", "SORT"]);
    }

    #[test]
    fn each_term_is_linked_once() {
        assert_eq!(found("Corners are corners; a Corner is an edge."), [("Corners", "corner"), ("edge", "edge")]);
        assert_eq!(found("SAD: the sum of absolute differences"), [("SAD", "sum of absolute differences")]);
    }

    #[test]
    fn ranges_lie_between_characters() {
        let text = "Größe × λ₁: Farnebäck’s İ optical\u{a0}flow, Horn–Schunck, χ² gate ∇I";
        let names = ["Farnebäck", "optical\u{a0}flow", "Horn–Schunck", "χ²", "gate"];
        assert_eq!(found(text).iter().map(|(written, _)| *written).collect::<Vec<_>>(), names);
        for odd in ["", "∇", "e\u{301}dge", "edge\u{301}", "İİİ cost İ", "\u{fffd}"] {
            occurrences(odd);
        }
        assert_eq!(found("edge\u{301}"), []);
        assert_eq!(found("İİİ cost"), [("cost", "cost")]);
    }

    #[test]
    fn every_family_has_chapters() {
        for estimator in crate::course::estimators() {
            assert!(!chapters_of(estimator.info().family).is_empty(), "{}", estimator.info().family);
        }
    }
}
