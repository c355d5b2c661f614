//! Lessons: pages of words, each beside a step of a run. A page is a session with words.
//!
//! ```markdown
//! # Full search
//!
//! What is learned, in a sentence.
//!
//! +++
//! title = "The search window"
//! clip = "synth:pillar"            # the keys of a session; clip, estimator, parameters and frame may be those of the page before
//! estimator = "full-search"
//! step = "27.1"
//! until = "27.12"                  # the arrow key steps up to here before it turns the page
//! predict = true                   # each step asks before it shows its result
//! notes = "Ask for a guess."       # for the teacher
//! +++
//! Words with *emphasis*, [links](lesson:logarithmic-search) and formulas: $u + v$, or displayed, $$E = \sum_{i} e_i^2$$
//! ```
//!
//! `example = "full-search/aperture"` stands for clip, estimator, frame and parameters of that example.
//!
//! The header of a page has the keys of a session; clip, estimator, parameters and frame default to those of the page before.
//! So a page is opened like a session, under a name of its own (`lesson:kalman-filter/3`), in the window and on the command
//! line. A page with a mistake keeps its place and shows the line of the mistake.

pub(crate) mod bundled;
pub mod formula;
pub mod handout;
mod read;
mod words;

use std::ffi::{OsStr, OsString};
use std::path::Path;

use motionscope_core::base::Error;
use motionscope_core::run::Cursor;

use super::{Session, folder_of, trust, write};
use crate::files;
use crate::media;
use crate::paint::charts::prose::Prose;

pub use bundled::{all, chapters};

/// The prefix of the name of a bundled lesson.
const LESSON: &str = "lesson:";
/// The extension of a lesson's file.
const EXTENSION: &str = "md";

/// What a paragraph that asks for a prediction begins with.
const QUESTIONS: [&str; 3] = ["Predict:", "Before you step on:", "Before you turn the page:"];

/// The most bytes of a lesson's file: it is read between two frames of the window.
const MOST_BYTES: u64 = 300_000;

/// A lesson.
#[derive(Clone)]
pub struct Lesson {
    /// Its short name: `full-search`.
    pub slug: String,
    /// Its title.
    pub title: String,
    /// What is learned, in a sentence.
    pub summary: String,
    /// Its pages, at least one.
    pub pages: Vec<Page>,
}

/// A page of a lesson.
#[derive(Clone)]
pub struct Page {
    /// Its title.
    pub title: String,
    /// What the teacher is reminded of.
    pub notes: String,
    /// The step up to which it walks before the page is turned.
    pub until: Option<Cursor>,
    /// Whether its steps ask before they show their results.
    pub predicts: bool,
    /// Its words, or what is wrong with them.
    pub words: Result<Prose, Error>,
    /// What is run, and the step that is shown; or what is wrong with its header.
    pub session: Result<Session, Error>,
}

impl Page {
    /// Whether it asks the reader to predict something: by its header, or by a paragraph that begins as a question does.
    pub fn asks(&self) -> bool {
        let has_question =
            |prose: &Prose| prose.plain().lines().any(|line| QUESTIONS.iter().any(|begins| line.starts_with(begins)));
        self.predicts || self.words.as_ref().is_ok_and(has_question)
    }
}

impl Lesson {
    /// Parses a lesson with files relative to `folder`. A page that is wrong keeps its place and says why.
    ///
    /// # Errors
    /// If the text does not begin with a title, or has no page.
    pub fn parse(slug: &str, text: &str, folder: &Path) -> Result<Self, Error> {
        read::lesson(slug, text, folder)
    }

    /// Reads the lesson in the file `path`.
    ///
    /// # Errors
    /// One sentence that names the file and the reason.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let name = Error::short_name(&files::label(path).to_string());
        let about = |error: Error| Error::new(format!("cannot open the lesson {name}: {error}"));
        let slug = path.file_stem().unwrap_or_default().to_string_lossy();
        if files::facts(path).is_ok_and(|facts| facts.size > MOST_BYTES) {
            return Err(about(Error::new(format!("it has more than {} kB", MOST_BYTES / 1000))));
        }
        let read = |text: String| {
            let lesson = Self::parse(&slug, &text, folder_of(path))?;
            let sessions = lesson.pages.iter().filter_map(|page| page.session.as_ref().ok());
            trust::check(path, &text, sessions).map(|()| lesson)
        };
        media::read_text(path).and_then(read).map_err(about)
    }

    /// The page with this index.
    ///
    /// # Errors
    /// If it has fewer pages.
    pub fn page(&self, index: usize) -> Result<&Page, Error> {
        let lacks = || Error::new(format!("the lesson {} has {} pages", self.title, self.pages.len()));
        self.pages.get(index).ok_or_else(lacks)
    }

    /// Refuses a lesson of which a page is wrong.
    ///
    /// # Errors
    /// What is wrong with the first of these pages.
    pub fn check(&self) -> Result<(), Error> {
        self.faults().next().map_or(Ok(()), |(page, why)| Err(self.fault(page, why)))
    }

    /// What is wrong with the page of this number from 1, with its name.
    fn fault(&self, page: usize, why: &Error) -> Error {
        Error::new(format!("page {page} of {}: {why}", self.title))
    }

    /// What is wrong with its pages, each with its number from 1.
    pub fn faults(&self) -> impl Iterator<Item = (usize, &Error)> {
        self.pages.iter().zip(1..).flat_map(|(page, number)| {
            let faults = page.words.as_ref().err().into_iter().chain(page.session.as_ref().err());
            faults.map(move |fault| (number, fault))
        })
    }
}

/// The name of a page: `lesson:full-search/3`, or the path of a lesson's file with `#3` behind it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Address {
    /// The lesson: `lesson:full-search`, or a path.
    pub lesson: OsString,
    /// The page, from 0.
    pub page: usize,
}

impl Address {
    /// Reads the name of a page or of a lesson; `None` where it names something else.
    pub fn parse(name: &OsStr) -> Option<Self> {
        let text = name.to_string_lossy();
        let bundled = text.starts_with(LESSON);
        let mark = if bundled { '/' } else { '#' };
        let (lesson, page) = match text.rsplit_once(mark).map(|(lesson, page)| (lesson, page.parse::<usize>())) {
            Some((lesson, Ok(number))) => (OsString::from(lesson), number.saturating_sub(1)),
            _ => (name.to_owned(), 0),
        };
        let is_file = Path::new(&lesson).extension().is_some_and(|extension| extension.eq_ignore_ascii_case(EXTENSION));
        (bundled || is_file).then_some(Self { lesson, page })
    }

    /// The file that the lesson is read from, unless it is a bundled one.
    pub fn file(&self) -> Option<&Path> {
        let is_bundled = self.lesson.to_string_lossy().starts_with(LESSON);
        (!is_bundled).then(|| Path::new(&self.lesson))
    }

    /// Reads the lesson.
    ///
    /// # Errors
    /// If there is none of that name, or its file cannot be read.
    pub fn load(&self) -> Result<Lesson, Error> {
        match self.file() {
            Some(path) => Lesson::load(path),
            None => bundled::find(self.lesson.to_string_lossy().trim_start_matches(LESSON)).cloned(),
        }
    }

    /// The whole name, with the number of the page.
    pub fn name(&self) -> OsString {
        let mut name = self.lesson.clone();
        name.push(if self.file().is_some() { "#" } else { "/" });
        name.push((self.page + 1).to_string());
        name
    }
}

impl From<&Lesson> for Address {
    /// The first page of a bundled lesson.
    fn from(lesson: &Lesson) -> Self {
        Self { lesson: format!("{LESSON}{}", lesson.slug).into(), page: 0 }
    }
}

/// Returns a page for the file of a lesson in `folder`: the header that opens `session`, and a place for its words.
///
/// # Errors
/// If the session cannot be written.
pub fn page_text(session: &Session, folder: &Path) -> Result<String, Error> {
    let unwritten = |why: toml::ser::Error| Error::new(format!("the page cannot be written: {why}"));
    let keys =
        toml::to_string(&write::differing(session, &|path| write::relative(path, folder))?).map_err(unwritten)?;
    let fence = read::FENCE;
    Ok(format!("{fence}\ntitle = \"\"\n{keys}{fence}\n\n"))
}

/// Returns the session of the page with this `name`; `None` where it names no page.
pub(super) fn named(name: &OsStr) -> Option<Result<Session, Error>> {
    let address = Address::parse(name)?;
    Some(address.load().and_then(|lesson| lesson.page(address.page)?.session.clone()))
}

#[cfg(test)]
mod tests;
