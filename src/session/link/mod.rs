//! Links: a session in one line, behind the `#` of an address.
//!
//! ```text
//! #lesson:kalman-filter/3                                          a page of a lesson
//! #example:horn-schunck/filling-in                                 an example
//! #synth:pillar,noise=5&estimator=diamond&step=164.14&set.search-range=8
//! #ball.mp4&estimator=lucas-kanade&frame=12&pixel=303,202          a clip that has to be given again
//! #lesson:kalman-filter/3&view=embed                               stage, chart, sentence and transport alone
//! ```
//!
//! The first part is what is opened, by its name on the command line. The others are the keys of a session file with their values,
//! those of a section behind its name: `set.block-size=8`, `picture.view=blend`, `sight.zoom=4`. Estimators in lockstep are named as on
//! the command line: `beside=three-step,diamond`, `set.2.levels=4`. A key without a value takes back what the page or the example sets;
//! with another `clip` or `estimator` nothing else of its run is left.
//!
//! All other settings have their defaults; the theme stays as it is. Ink is not part of a link. Files are named without their folders.
//! The keys come from the writer of sessions and go through their reader, so a new key of a session is one of links as well.

mod base;
mod keys;
mod percent;

use std::ffi::{OsStr, OsString};
use std::path::Path;

use motionscope_core::base::{Error, words};

use super::Session;
use super::lesson::Address;
use crate::experiment::Experiment;
use crate::experiment::first;
use crate::experiment::source::Source;
use crate::files;
use crate::media::Given;
use crate::view::look::{Changes, Look};
use base::{Base, file_name, portable};
use keys::{Fault, Keys};
use percent::{decode, encode};

pub use percent::decoded_bytes;

/// The page of a browser that copied links lead to, unless another one is set.
pub const PUBLISHED: &str = "https://motionscope.github.io/motionscope/";

/// The most bytes of a link.
const MOST_BYTES: usize = 8000;
/// Faults of a link that are left out one by one.
const MOST_FAULTS: usize = 8;
/// The key of the parts of the window that are shown.
const PARTS: &str = "view";
/// The keys that come first, in this order; the others follow by name.
const FIRST_KEYS: [&str; 4] = ["clip", "estimator", "frame", "step"];

/// The parts of the window that a link shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Parts {
    /// The whole window.
    #[default]
    All,
    /// Stage, chart, sentence and transport alone, for a frame in slides or in a learning platform.
    Embedded,
    /// Stage, chart and sentence in full screen, for a class.
    Presented,
}

impl Parts {
    const NAMES: [(&str, Self); 2] = [("embed", Self::Embedded), ("present", Self::Presented)];

    fn parse(name: &str) -> Result<Self, Error> {
        let found = Self::NAMES.into_iter().find(|(known, _)| *known == name);
        let names = Self::NAMES.map(|(name, _)| name);
        found.map(|(_, parts)| parts).ok_or_else(|| Error::new(words::there_is_no("view", name, &names)))
    }

    /// Returns the link `fragment` with the key that shows these parts.
    #[must_use]
    pub fn added_to(self, fragment: String) -> String {
        let named = Self::NAMES.into_iter().find(|(_, parts)| *parts == self);
        named.map_or(fragment.clone(), |(name, _)| format!("{fragment}&{PARTS}={name}"))
    }
}

/// The content of a link.
#[derive(Clone, Default)]
pub struct Link {
    /// The page of a lesson whose words stand beside the run.
    pub page: Option<Address>,
    /// The verdict on an example, and its reason.
    pub description: Option<String>,
    /// The run and its step; the start page if there is none.
    pub session: Option<Session>,
    /// The parts of the window that are shown.
    pub parts: Parts,
}

impl Link {
    /// Whether `name` is a link: it begins with `#`, or is an address with a `#`, and no file has this name.
    pub fn is_one(name: &OsStr) -> bool {
        let text = name.to_string_lossy();
        let is_link = text.split_once('#').is_some_and(|(address, _)| address.is_empty() || address.contains("://"));
        is_link && !files::exists(Path::new(name))
    }

    /// Reads a link, or the part of one behind its `#`, and says what is wrong with it, in a sentence each; the rest is opened.
    pub fn parse(text: &str) -> (Self, Vec<Error>) {
        let fragment = text.split_once('#').map_or(text, |(_, fragment)| fragment);
        if fragment.len() > MOST_BYTES {
            let why =
                format!("the link has more than {MOST_BYTES} letters, which no address has; save a session instead");
            return (Self::default(), vec![Error::new(why)]);
        }
        let mut faults = Vec::new();
        let link = read(fragment, &mut faults);
        (link, faults)
    }

    /// Returns the part behind the `#` of the link that opens `session` beside the words of a `page`.
    ///
    /// # Errors
    /// If the clip comes from a pipe, or a name cannot be written.
    pub fn of(session: &Session, page: Option<&Address>) -> Result<String, Error> {
        if matches!(&session.experiment.source, Source::File(path) if path == Path::new("-")) {
            let why = "the clip came through a pipe, which a link cannot name; save it as a file and open that";
            return Err(Error::new(why));
        }
        let session = without_folders(session.clone());
        let base = Base::of(&session, page)?;
        let mut keys = keys::of(&session)?;
        for (key, value) in base.kept(&keys) {
            match keys.get(&key) {
                Some(own) if *own == value => drop(keys.remove(&key)),
                Some(_) => {}
                None => drop(keys.insert(key, String::new())),
            }
        }
        Ok(written(&base, keys))
    }

    /// The names of the files of its clip, which have to be given again, if it is one of files.
    pub fn own_files(&self) -> Option<Vec<OsString>> {
        own_files(&self.session.as_ref()?.experiment.source)
    }
}

/// The names of the files of a clip, if it is one of files.
pub fn own_files(source: &Source) -> Option<Vec<OsString>> {
    let names: Vec<OsString> = source.paths().into_iter().map(|path| file_name(path).into()).collect();
    (!names.is_empty()).then_some(names)
}

/// Returns the session that a link `name` opens, and what is wrong with the link; `None` where it is no link.
pub(super) fn named(name: &OsStr) -> Option<Result<(Session, Vec<Error>), Error>> {
    let is_link = Link::is_one(name);
    is_link.then(|| {
        let (link, mut faults) = Link::parse(&name.to_string_lossy());
        let none = || Error::new("the link opens the start page, which has no clip");
        match link.session {
            Some(session) => Ok((session, faults)),
            None => Err(faults.pop().unwrap_or_else(none)),
        }
    })
}

/// The link with these keys in addition to those of its `base`.
fn written(base: &Base, keys: Keys) -> String {
    // The sliders of a scene are written as on the command line; a file may be called like a key with its value.
    let also = if base.name.starts_with("synth:") { "=" } else { "" };
    let rank = |key: &str| FIRST_KEYS.iter().position(|first| *first == key).unwrap_or(FIRST_KEYS.len());
    let mut pairs: Vec<_> = keys.into_iter().collect();
    pairs.sort_by_key(|(key, _)| rank(key));
    let pairs = pairs.iter().map(|(key, value)| format!("&{}={}", encode(key, ""), encode(value, "")));
    encode(&base.name, also) + &pairs.collect::<String>()
}

/// Reads what stands behind the `#`.
fn read(fragment: &str, faults: &mut Vec<Error>) -> Link {
    let mut parts = fragment.split('&').filter(|part| !part.is_empty()).peekable();
    let name = parts.next_if(|part| !is_pair(part)).map(decode);
    let mut keys = pairs(parts, faults);
    let shown = keys.remove(PARTS).map(|name| Parts::parse(&name)).transpose().unwrap_or_else(|why| {
        faults.push(why);
        None
    });
    let base = match name {
        Some(name) => Base::parse(&name, faults),
        None if keys.is_empty() => Base::default(),
        None => Base::of_sample(),
    };
    let session = (!base.keys.is_empty()).then(|| session(&base, keys, faults)).flatten();
    let Base { page, description, .. } = base;
    Link { page, description, session, parts: shown.unwrap_or_default() }
}

/// Whether a part of a link is a key with its value, not the name of a clip such as `synth:pillar,noise=5`.
fn is_pair(part: &str) -> bool {
    part.split_once('=').is_some_and(|(key, _)| !decode(key).contains(':'))
}

fn pairs<'a>(parts: impl Iterator<Item = &'a str>, faults: &mut Vec<Error>) -> Keys {
    let mut keys = Keys::new();
    for part in parts {
        match part.split_once('=') {
            Some((key, value)) => drop(keys.insert(decode(key), decode(value))),
            None => {
                let part = Error::short_name(&decode(part)).to_string();
                faults.push(Error::new(format!("{part} is not written as KEY=VALUE")));
            }
        }
    }
    keys
}

/// The session of `base` with `own` keys, without those that are wrong.
fn session(base: &Base, own: Keys, faults: &mut Vec<Error>) -> Option<Session> {
    let mut keys = base.kept(&own);
    for (key, value) in own {
        if value.is_empty() { drop(keys.remove(&key)) } else { drop(keys.insert(key, value)) }
    }
    let session = loop {
        // An estimator that is not named, or not known, is the first of the course.
        keys.entry("estimator".into()).or_insert_with(|| first::EXAMPLE.into());
        keys.entry("clip".into()).or_insert_with(|| format!("synth:{}", first::SAMPLE));
        match keys::session(&keys) {
            Ok(session) => break session,
            Err(_) if faults.len() >= MOST_FAULTS => {
                faults
                    .push(Error::new("there is more wrong with it than can be left out; nothing else of it is opened"));
                return base.session.clone();
            }
            Err(Fault { key, why }) => {
                faults.push(why);
                let Some(key) = key.filter(|key| keys.remove(key).is_some()) else { return base.session.clone() };
                if key == "estimator" {
                    // The parameters and the steps of another one are not meant for this one.
                    keys.retain(|key, _| key == "clip" || key == "frame" || key.starts_with("picture."));
                }
            }
        }
    };
    if session.sight.is_none() && keys.keys().any(|key| key.starts_with("sight.")) {
        faults.push(Error::new("sight.center and sight.zoom name no part of a picture"));
    }
    let session = at_a_step(without_folders(session));
    let usual = Look::opening(session.experiment.estimator.shows_frame_alone());
    let look = Changes::from(usual).without("theme").then(&session.look);
    let drawn = base.session.as_ref().filter(|base| base.experiment == session.experiment);
    let freehand = drawn.map(|base| base.freehand.clone()).unwrap_or_default();
    Some(Session { look, freehand, ..session })
}

/// The same session at the step where it begins, if it names none: a link shows the same wherever its clip was left.
fn at_a_step(mut session: Session) -> Session {
    session.position.cursor.get_or_insert_default();
    session
}

/// The same session with the names of its files alone.
fn without_folders(session: Session) -> Session {
    let Experiment { source, given, .. } = session.experiment;
    // A synthetic clip needs no files; those of others are given by hand.
    let given = if own_files(&source).is_some() { given.map_path(file_name) } else { Given::default() };
    let experiment = Experiment { source: portable(source), given, ..session.experiment };
    Session { experiment, ..session }
}

#[cfg(test)]
mod tests;
