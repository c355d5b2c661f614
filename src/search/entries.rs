//! Everything that can be found, with its titles and texts.

use motionscope_core::base::words::capital;
use motionscope_core::course::estimators;
use motionscope_core::course::examples::{self, Cause};
use motionscope_core::course::glossary::GLOSSARY;
use motionscope_core::params::Spec;
use motionscope_core::run::{AnyEstimator, Info};

use super::text::Searched;
use super::{Kind, Target};
use crate::session::lesson::{self, Address, Lesson};
use crate::view::panes::{EXPLANATION, PANES, STAGE};

/// Something that can be found.
pub struct Entry {
    /// What it is.
    pub kind: Kind,
    /// Its name or title.
    pub title: Searched,
    /// Other spellings, names in scripts.
    pub also: Vec<Searched>,
    /// Where it is from.
    pub place: String,
    /// Its texts, the one that says what it is first.
    pub texts: Vec<Searched>,
    /// What is opened.
    pub target: Target,
}

/// Everything, kind by kind in the order of the course.
pub fn all() -> Vec<Entry> {
    let all = estimators();
    let mut entries: Vec<Entry> = terms().collect();
    entries.extend(all.iter().map(|one| of_estimator(&**one)));
    entries.extend(lesson::all().iter().flat_map(pages));
    entries.extend(parameters(&all));
    entries.extend(charts());
    entries.extend(examples(&all));
    entries
}

fn searched<'a>(texts: impl IntoIterator<Item = &'a str>) -> Vec<Searched> {
    texts.into_iter().filter(|text| !text.is_empty()).map(Searched::new).collect()
}

fn terms() -> impl Iterator<Item = Entry> {
    GLOSSARY.iter().map(|term| Entry {
        kind: Kind::Term,
        title: Searched::new(capital(term.name)),
        also: searched(term.spellings().skip(1).chain(term.symbol)),
        place: term.chapter.title().to_owned(),
        texts: searched([term.definition]),
        target: Target::Term(term),
    })
}

fn of_estimator(estimator: &dyn AnyEstimator) -> Entry {
    let info = estimator.info();
    let pseudocode = info.pseudocode.iter().map(|line| line.text);
    Entry {
        kind: Kind::Estimator,
        title: Searched::new(info.name),
        also: searched([info.id]),
        place: info.family.to_owned(),
        texts: searched([info.summary, info.source].into_iter().chain(pseudocode)),
        target: Target::Estimator(info.id),
    }
}

/// The pages of a lesson; the first one has the lesson's title and summary too.
fn pages(lesson: &'static Lesson) -> impl Iterator<Item = Entry> {
    lesson.pages.iter().enumerate().map(move |(page, written)| {
        let words = written.words.as_ref().map(|words| words.plain()).unwrap_or_default();
        let is_first = page == 0;
        Entry {
            kind: Kind::Page,
            title: Searched::new(written.title.as_str()),
            also: searched(is_first.then_some(lesson.title.as_str())),
            place: format!("{}, page {}", lesson.title, page + 1),
            texts: searched(is_first.then_some(lesson.summary.as_str()).into_iter().chain(words.lines())),
            target: Target::Page(Address { page, ..Address::from(lesson) }),
        }
    })
}

/// Whether two declarations are of one parameter that estimators share: others may have its name.
pub fn is_same_parameter(one: &Spec, other: &Spec) -> bool {
    one.name == other.name && one.label == other.label && one.doc == other.doc
}

/// The parameters of all estimators; one that several share is there once.
fn parameters(all: &[Box<dyn AnyEstimator>]) -> Vec<Entry> {
    let mut entries: Vec<(Entry, &'static Spec, usize)> = Vec::new();
    for estimator in all {
        for spec in estimator.specs() {
            match entries.iter_mut().find(|(_, other, _)| is_same_parameter(other, spec)) {
                Some((.., others)) => *others += 1,
                None => entries.push((parameter(estimator.info(), spec), spec, 0)),
            }
        }
    }
    let with_others = |(mut entry, _, others): (Entry, _, usize)| {
        if others > 0 {
            entry.place += &format!(" and {others} more");
        }
        entry
    };
    entries.into_iter().map(with_others).collect()
}

fn parameter(of: &'static Info, spec: &'static Spec) -> Entry {
    Entry {
        kind: Kind::Parameter,
        title: Searched::new(spec.label.as_str()),
        also: searched([spec.name.as_str()]),
        place: of.name.to_owned(),
        texts: searched([spec.doc.as_str()]),
        target: Target::Parameter(of.id, &spec.name),
    }
}

fn charts() -> impl Iterator<Item = Entry> {
    PANES.into_iter().filter(|pane| **pane != STAGE && **pane != EXPLANATION).map(|pane| Entry {
        kind: Kind::Chart,
        title: Searched::new(pane.title),
        also: searched([pane.id]),
        place: "Chart".to_owned(),
        texts: searched([format!("Shows {}, {}.", pane.doc, pane.when).as_str()]),
        target: Target::Chart(pane),
    })
}

/// The examples, each once for every estimator that it belongs to.
fn examples(all: &[Box<dyn AnyEstimator>]) -> Vec<Entry> {
    let name = |id: &str| all.iter().map(|one| one.info()).find(|info| info.id == id).map(|info| info.name);
    let pairs = examples::examples().flat_map(|example| example.of.iter().map(move |id| (*id, example)));
    let entry = |(id, example): (&'static str, &'static examples::Example)| {
        let of = name(id)?;
        let verdict = example.cause.map_or("works".to_owned(), |cause: Cause| format!("fails: {}", cause.name()));
        Some(Entry {
            kind: Kind::Example,
            title: Searched::new(example.title),
            also: searched([format!("{of} {verdict}").as_str()]),
            place: format!("{of}, {verdict}"),
            texts: searched([example.says]),
            target: Target::Example(id, example),
        })
    };
    pairs.filter_map(entry).collect()
}
