//! The first part of a link: the page of a lesson, an example or a clip.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use motionscope_core::base::Error;
use motionscope_core::course::examples;

use super::keys::{self, Keys};
use crate::experiment::source::Source;
use crate::experiment::{Experiment, first};
use crate::session::lesson::Address;
use crate::session::{Session, example};

/// The keys of a run that has nothing else of the base.
const OF_RUN: [&str; 2] = ["clip", "estimator"];

/// The page, example or clip that the first part of a link names, and the keys of its session.
#[derive(Default)]
pub(super) struct Base {
    /// Its name on the command line.
    pub name: String,
    /// The page of a lesson.
    pub page: Option<Address>,
    /// The verdict on an example, and its reason.
    pub description: Option<String>,
    /// The session of a page or an example.
    pub session: Option<Session>,
    /// The keys of that, or the clip.
    pub keys: Keys,
}

impl Base {
    /// The base from which the link of `session` differs least: the `page` of a bundled lesson, an example, or its clip.
    ///
    /// # Errors
    /// If the clip cannot be named.
    pub fn of(session: &Session, page: Option<&Address>) -> Result<Self, Error> {
        if let Some(address) = page.filter(|address| address.file().is_none()) {
            return Self::of_page(address.clone());
        }
        let experiment = &session.experiment;
        let id = experiment.estimator.info().id;
        let is_open = |name: &String| {
            let of_example = example::named(OsStr::new(name)).and_then(Result::ok);
            let frame = experiment.frame;
            of_example.is_some_and(|one| Experiment { frame, ..one.experiment } == *experiment)
        };
        match examples::of(id).map(|one| example::name(id, one)).find(is_open) {
            Some(name) => Self::of_example(&name),
            None => Ok(Self::of_clip(&experiment.source)),
        }
    }

    fn of_page(page: Address) -> Result<Self, Error> {
        let session = page.load()?.page(page.page)?.session.clone()?;
        let base = Self::of_session(page.name().to_string_lossy().into_owned(), session)?;
        Ok(Self { page: Some(page), ..base })
    }

    fn of_example(name: &str) -> Result<Self, Error> {
        let none = || Error::new(format!("there is no example {name}"));
        let session = example::named(OsStr::new(name)).ok_or_else(none)??;
        let description = example::of_name(OsStr::new(name)).map(example::description);
        Ok(Self { description, ..Self::of_session(name.to_owned(), session)? })
    }

    /// A session with a name, at the step where it begins wherever its clip was left.
    fn of_session(name: String, mut session: Session) -> Result<Self, Error> {
        session.position.cursor = Some(session.position.cursor.unwrap_or_default());
        Ok(Self { name, keys: keys::of(&session)?, session: Some(session), ..Self::default() })
    }

    fn of_clip(source: &Source) -> Self {
        let name = source.to_string();
        Self { keys: Keys::from([("clip".into(), name.clone())]), name, ..Self::default() }
    }

    /// The first sample.
    pub fn of_sample() -> Self {
        Source::synth(first::SAMPLE).map_or_else(|_| Self::default(), |source| Self::of_clip(&source))
    }

    /// Reads the first part of a link. Where it is wrong, `faults` says why, and what is known of it is opened.
    pub fn parse(name: &str, faults: &mut Vec<Error>) -> Self {
        let page = Address::parse(OsStr::new(name)).filter(|address| address.file().is_none());
        let read = match page {
            Some(page) => Self::of_page(page.clone()).or_else(|why| {
                let first = Self::of_page(Address { page: 0, ..page })?;
                faults.push(why);
                Ok(first)
            }),
            None if name.starts_with(example::EXAMPLE) => Self::of_example(name),
            None => return Self::of_clip(&portable(source(name, faults))),
        };
        read.unwrap_or_else(|why| {
            faults.push(why);
            Self::default()
        })
    }

    /// Its keys that apply to a run with the keys `own`: on another clip or with another estimator, only these two.
    pub fn kept(&self, own: &Keys) -> Keys {
        let is_other =
            |key: &&str| own.get(*key).is_some_and(|value| self.keys.get(*key).is_some_and(|of| of != value));
        let mut kept = self.keys.clone();
        if OF_RUN.iter().any(is_other) {
            kept.retain(|key, _| OF_RUN.contains(&key.as_str()));
        }
        kept
    }
}

/// The clip that is called `name`; a synthetic one without the sliders that are wrong.
fn source(name: &str, faults: &mut Vec<Error>) -> Source {
    let mut parts = if name.starts_with("synth:") { name.split(',') } else { return Source::File(name.into()) };
    let scene = Source::parse(parts.next().unwrap_or_default());
    let scene = scene.or_else(|why| {
        faults.push(why);
        Source::synth(first::SAMPLE)
    });
    let mut source = scene.unwrap_or_else(|_| Source::File(PathBuf::new()));
    parts.filter_map(|setting| source.set(setting).err()).for_each(|why| faults.push(why));
    source
}

/// The same clip with the names of its files alone: a link contains no folder of the person's disk, and opens none.
pub(super) fn portable(source: Source) -> Source {
    source.map_path(file_name)
}

/// The name of the file at `path`, whatever system it was written on.
pub(super) fn file_name(path: &Path) -> PathBuf {
    let text = path.to_string_lossy();
    text.rsplit(['/', '\\']).find(|part| !part.is_empty() && *part != "..").unwrap_or("clip").into()
}
