//! The session file, `*.motionscope`: a small text that reopens exactly what was on the screen.
//!
//! ```toml
//! motionscope = 1
//! clip = "clips/ball.mp4"          # beside the session file, or synth:NAME,SLIDER=VALUE
//! truth = "truth.flo"              # what is given for the clip by hand, beside the session file as well
//! detections = "det.txt"
//! estimator = "full-search"
//! pace = "block"                   # of those in lockstep: the same block, or the same budget
//! frame = 12
//! step = "35.412"
//! pixel = "303,202"                # the one that is held to be explained by itself
//!
//! [set]
//! block = 8
//!
//! [[beside]]                       # up to three more, which go in lockstep with it
//! estimator = "hierarchical"
//! set = { levels = 4 }             # what it does not share with the first
//!
//! [picture]                        # the entries of a look
//! view = "side-by-side"
//! layer = "error"                  # the colours that tell of motion
//! ```

mod read;
mod toml_text;
mod write;

use std::ffi::OsStr;
use std::path::Path;

use motionscope_core::params::Parameter;
use motionscope_core::{Error, Pace};
use serde::Serialize;

use crate::experiment::source::Source;
use crate::experiment::{Experiment, Position};
use crate::media::{self, Given, export};
use crate::view::look::Changes;

/// The version of the format that is written.
const VERSION: u32 = 1;
/// The ending of a session file's name.
pub const EXTENSION: &str = "motionscope";

/// Everything that a session keeps: what is run, where in it one is, and how it is looked at.
#[derive(Clone, PartialEq)]
pub struct Session {
    /// What is run.
    pub experiment: Experiment,
    /// Where in the run one is.
    pub position: Position,
    /// How it is looked at; what it does not set is left as it is where it is opened.
    pub look: Changes,
    /// Which part of the picture is seen, if not all of it.
    pub sight: Option<Sight>,
}

/// What a person called a clip: the clip itself, or a session that leads to it.
pub struct Named {
    /// Where the clip comes from.
    pub source: Source,
    /// What is given for it by hand.
    pub given: Given,
    /// The session, if one was named.
    pub session: Option<Session>,
}

impl Named {
    /// What `name` stands for; what is `given` overrides what a session gives.
    ///
    /// # Errors
    /// If it is a session that cannot be read, or a scene that does not exist.
    pub fn find(name: &OsStr, given: Given) -> Result<Self, Error> {
        if !Session::is_named(Path::new(name)) {
            return Ok(Self { source: Source::parse(name)?, given, session: None });
        }
        let mut session = Session::load(Path::new(name))?;
        let experiment = &mut session.experiment;
        experiment.given = std::mem::take(&mut experiment.given).then(given);
        let (source, given) = (experiment.source.clone(), experiment.given.clone());
        Ok(Self { source, given, session: Some(session) })
    }
}

/// The part of the picture that is seen on the stage.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sight {
    /// The pixel in the middle of the stage.
    pub center: [f32; 2],
    /// Points per pixel.
    pub zoom: f32,
}

impl Sight {
    fn is_sound(&self) -> bool {
        self.center.iter().all(|c| c.abs() < 1e6) && (1e-3..=1e3).contains(&self.zoom)
    }
}

impl Session {
    /// Whether `path` is called like a session.
    pub fn is_named(path: &Path) -> bool {
        path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(EXTENSION))
    }

    /// Reads the session in `path`; the clip is not opened.
    ///
    /// # Errors
    /// One sentence that names the file, tells what is wrong and what to do.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let name = Error::short_name(&path.display().to_string());
        let about = |error: String| Error::new(format!("cannot open the session {name}: {error}"));
        let text = media::read_text(path).map_err(|error| about(error.to_string()))?;
        Self::parse(&text, folder_of(path)).map_err(|error| about(error.to_string()))
    }

    /// Reads a session whose paths are told from `folder`.
    ///
    /// # Errors
    /// If the text is no session, or names what does not exist.
    pub fn parse(text: &str, folder: &Path) -> Result<Self, Error> {
        read::session(text, folder)
    }

    /// Writes the session to `path`, whole or not at all.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), Error> {
        export::save(path, self.text(folder_of(path))?.as_bytes())
    }

    /// The text of a session file in `folder`.
    ///
    /// # Errors
    /// If it cannot be told as TOML, or the name of the clip, its truth or its detections is no Unicode.
    pub fn text(&self, folder: &Path) -> Result<String, Error> {
        write::text(self, folder)
    }
}

/// What a session calls an entry of a look that is called `name` elsewhere.
fn key(name: &'static str) -> &'static str {
    if name == "arrow-scale" { "arrows" } else { name }
}

/// The pace called `id`.
///
/// # Errors
/// A sentence with the paces there are.
pub fn pace(id: &str) -> Result<Pace, Error> {
    let all = [Pace::Block, Pace::Budget];
    let name = |pace: &Pace| pace.to_value().to_string();
    let told = || Error::new(format!("there is no pace {id}; there are {}", all.each_ref().map(name).join(", ")));
    all.into_iter().find(|pace| name(pace) == id).ok_or_else(told)
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

#[cfg(test)]
mod tests;
