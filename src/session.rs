//! The session file, `*.motionscope`: a small text file that restores clip, estimator, parameters, step and view.
//!
//! ```toml
//! motionscope = 1
//! clip = "clips/ball.mp4"          # beside the session file, or synth:NAME,SLIDER=VALUE
//! truth = "truth.flo"              # ground truth given explicitly, relative to the session file as well
//! detections = "det.txt"
//! right = "right.mp4"              # right view, or side-by-side
//! calibration = "calib.txt"        # or typed: "721.5,0.54"
//! disparity-scale = 4              # gray levels per px of an 8-bit true disparity
//! depths = "depth"                 # folder of measured depths, 16-bit PNG
//! depth-scale = 5000               # their units per m
//! contrast = "0..4095"             # the 16-bit samples that are black and white
//! estimator = "full-search"
//! pace = "block"                   # of the lockstep: block, budget, frame, iteration, level, stage or result
//! frame = 12
//! step = "35.412"                  # without it: where the run was left, or its start
//! pixel = "303,202"                # the held pixel to explain
//! object = 3                       # the object that was there and is held wherever it goes
//!
//! [set]
//! block-size = 8
//!
//! [[beside]]                       # up to three more estimators in lockstep
//! estimator = "hierarchical"
//! set = { levels = 4 }             # parameters that the first does not have
//! # or above, as in a link: beside = "hierarchical", and in the section set "2.levels" = 4
//!
//! [picture]                        # the view options
//! view = "side-by-side"
//! layer = "error"                  # the flow layer
//!
//! [sight]                          # the visible part of the picture, if it was chosen by hand
//! center = [120.5, 88]             # px of the picture
//! zoom = 6.5                       # points per px
//! size = [96, 72]                  # width and height in px, which pictures from the command line show
//!
//! [[ink]]                          # a line drawn by hand, seen on its step
//! step = "35.412"
//! picture = "t+1"                  # without it: frame t
//! estimator = 2                    # of those in lockstep; without it: the first
//! color = "vermilion"              # vermilion, yellow, blue or green
//! points = "120.5,33 121,35.25"    # px of the picture
//! # chart = "surface"              # instead of a picture: the chart that it lies on
//! # size = [412, 300]              # and the size of that in points, as are the points of the line
//! # view = [-0.5, 0.68, 1.2, 0, 0, 0]  # its viewpoint, section or scroll position, unless it is the first one
//! ```

pub mod example;
mod ink;
pub mod lesson;
pub mod link;
mod read;
mod toml_text;
pub mod trust;
mod write;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use motionscope_core::base::Error;
use motionscope_core::run::Pace;
use serde::Serialize;

use crate::experiment::source::Source;
use crate::experiment::{Experiment, Position};
use crate::files;
use crate::media::{self, Given, export};
use crate::paint::Freehand;
use crate::paint::primitive::Rect;
use crate::view::look::Changes;

/// The version of the format.
const VERSION: u32 = 1;
/// The file extension of a session.
pub const EXTENSION: &str = "motionscope";

/// A session: an experiment, the position in it, and the view options.
#[derive(Clone, PartialEq)]
pub struct Session {
    /// The experiment.
    pub experiment: Experiment,
    /// The position in the run.
    pub position: Position,
    /// The view options that it sets; the others keep their values.
    pub look: Changes,
    /// The visible part of the picture, if not all of it.
    pub sight: Option<VisiblePart>,
    /// What was drawn by hand on its steps.
    pub freehand: Freehand,
}

/// A clip as named by the user: the clip itself, or a session with a clip.
pub struct Named {
    /// The source of the clip.
    pub source: Source,
    /// Files given explicitly.
    pub given: Given,
    /// The session, if one was named.
    pub session: Option<Session>,
    /// The faults of the link that was named, the rest of which is opened.
    pub faults: Vec<Error>,
}

impl Named {
    /// A clip without a session.
    pub fn clip(source: Source, given: Given) -> Self {
        Self { source, given, session: None, faults: Vec::new() }
    }

    fn session(session: Session, given: Given, faults: Vec<Error>) -> Self {
        Self { source: session.experiment.source.clone(), given, session: Some(session), faults }
    }

    /// Resolves `name`; files in `given` override those of a session.
    ///
    /// # Errors
    /// If it is a session that cannot be read, or a scene that does not exist.
    pub fn find(name: &OsStr, given: Given) -> Result<Self, Error> {
        if let Some(found) = link::named(name) {
            let (session, faults) = found?;
            let given = session.experiment.given.clone().then(given);
            return Ok(Self::session(session, given, faults));
        }
        if let Some(session) = example::named(name).or_else(|| lesson::named(name)) {
            return Ok(Self::session(session?, given, Vec::new()));
        }
        if !Session::is_named(Path::new(name)) {
            return Ok(Self::clip(Source::typed(name)?, given));
        }
        let mut session = Session::load(Path::new(name))?;
        let experiment = &mut session.experiment;
        experiment.given = std::mem::take(&mut experiment.given).then(given);
        let given = experiment.given.clone();
        Ok(Self::session(session, given, Vec::new()))
    }
}

/// The visible part of the picture on the stage.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct VisiblePart {
    /// The pixel at the center of the stage.
    pub center: [f32; 2],
    /// Points per pixel.
    pub zoom: f32,
    /// Width and height in px, if they are known: of the stage, which is larger in a larger window.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<[f32; 2]>,
}

impl VisiblePart {
    fn is_sound(&self) -> bool {
        let has_size = self.size.is_none_or(|size| size.iter().all(|side| (1e-3..=1e9).contains(side)));
        self.center.iter().all(|c| c.abs() < 1e6) && (1e-3..=1e3).contains(&self.zoom) && has_size
    }

    /// Returns the part as a rectangle in px of the picture, if its size is known.
    pub fn section(&self) -> Option<Rect> {
        self.size.map(|size| Rect::centered(self.center, size))
    }
}

impl Session {
    /// Whether `path` has the extension of a session.
    pub fn is_named(path: &Path) -> bool {
        path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(EXTENSION))
    }

    /// Reads the session in `path`; the clip is not opened.
    ///
    /// # Errors
    /// One sentence that names the file, the reason and a remedy.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let name = Error::short_name(&files::label(path).to_string());
        let about = |error: String| Error::new(format!("cannot open the session {name}: {error}"));
        let text = media::read_text(path).map_err(|error| about(error.to_string()))?;
        let read = || {
            let session = Self::parse(&text, folder_of(path))?;
            trust::check(path, &text, [&session]).map(|()| session)
        };
        read().map_err(|error: Error| about(error.to_string()))
    }

    /// The files that it names and that are not there.
    pub fn missing_files(&self) -> Vec<PathBuf> {
        self.paths().filter(|path| !files::exists(path)).map(Path::to_owned).collect()
    }

    /// The files that it names.
    fn paths(&self) -> impl Iterator<Item = &Path> {
        self.experiment.source.paths().into_iter().chain(self.experiment.given.paths())
    }

    /// Parses a session whose paths are relative to `folder`.
    ///
    /// # Errors
    /// If the text is no session, or names an unknown estimator, parameter or scene.
    pub fn parse(text: &str, folder: &Path) -> Result<Self, Error> {
        read::session(text, folder)
    }

    /// Saves the session to `path` atomically.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), Error> {
        export::save(path, self.text(folder_of(path))?.as_bytes())?;
        // It opens again whatever it names.
        trust::trust(path);
        Ok(())
    }

    /// Returns the text of a session file in `folder`.
    ///
    /// # Errors
    /// If it cannot be written as TOML, or a path is not Unicode.
    pub fn text(&self, folder: &Path) -> Result<String, Error> {
        write::text(self, folder)
    }
}

/// Returns the session key of the view option `name`.
fn key(name: &'static str) -> &'static str {
    if name == "arrow-scale" { "arrows" } else { name }
}

/// Returns the pace `id`.
///
/// # Errors
/// A sentence with the known paces.
pub fn pace(id: &str) -> Result<Pace, Error> {
    let message = || Error::new(format!("there is no pace {id}; there are {}", Pace::ALL.map(Pace::name).join(", ")));
    Pace::ALL.into_iter().find(|pace| pace.name() == id).ok_or_else(message)
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

#[cfg(test)]
mod tests;
