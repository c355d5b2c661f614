//! An order to save a file: its content, its place and its look.

use std::path::{Path, PathBuf};

use crate::media::export::{Target, Timing};
use crate::results::Export;
use crate::view::handout::Options;
use crate::view::look::Look;
use crate::view::panes::Selection;
use crate::view::rendering::Format;
use crate::view::steps::{Range, STEP};

/// The beginning of the names of a clip's frames.
pub const CLIP_FRAME: &str = "frame_";

/// The content of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutputKind {
    /// The step that is shown.
    Picture,
    /// Numbered pictures of a range of steps.
    Steps(Range, Format),
    /// A range of steps as one animation.
    Animation(Range, Timing),
    /// What the run has made so far.
    Result(&'static Export),
    /// Everything that reopens the window as it is.
    Session,
    /// The questions that the class has answered.
    Scores,
    /// The frames of the clip.
    Clip(ClipFormat),
    /// All pages of the lesson that is open.
    Handout(Options),
    /// The step on paper, to be computed by hand, or filled in.
    Worksheet {
        /// Whether it is filled in.
        answers: bool,
    },
}

/// How the frames of a clip are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClipFormat {
    /// The file of the clip as it is.
    Copy,
    /// Numbered pictures in a folder, with what is known about the clip.
    Pictures,
    /// One file of compressed video.
    Video,
}

impl ClipFormat {
    /// Whether the frames keep their gray levels, so that a run on them has the same results.
    pub fn is_lossless(self) -> bool {
        match self {
            Self::Copy | Self::Pictures => true,
            Self::Video => false,
        }
    }
}

/// An order to save a file: its content, its place and its look.
#[derive(Clone, Debug, PartialEq)]
pub struct Order {
    /// What.
    pub what: OutputKind,
    /// The file, or the folder for several.
    pub path: PathBuf,
    /// Pixels for each pixel of the clip.
    pub scale: u32,
    /// How it looks.
    pub look: Look,
    /// The panes on pictures; none for the stage alone.
    pub panes: Selection,
}

impl OutputKind {
    /// Where this is written to, if `path` is what was chosen.
    pub fn target(self, path: &Path) -> Target<'_> {
        match self {
            Self::Steps(..) => Target::Numbered(path, STEP),
            Self::Result(export) => export.target(path),
            Self::Clip(ClipFormat::Pictures) => Target::Numbered(path, CLIP_FRAME),
            Self::Picture | Self::Animation(..) | Self::Session | Self::Scores => Target::File(path),
            Self::Clip(ClipFormat::Copy | ClipFormat::Video) => Target::File(path),
            Self::Handout(_) | Self::Worksheet { .. } => Target::File(path),
        }
    }
}
