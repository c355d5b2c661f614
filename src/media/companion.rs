//! Companions of a clip, in files of their own: ground truth, depths, a right view, a calibration, detections.

use std::path::{Path, PathBuf};

use motionscope_core::base::Error;
use motionscope_core::data::{Clip, ClipInfo};

use super::export::{InputKind, Inputs};
use super::{Given, Open};

/// Where the frames of a clip, or of its left view, lie.
#[derive(Clone, Copy)]
pub(crate) struct LeftView<'a> {
    /// The opened path.
    pub path: &'a Path,
    /// The file of each frame, where each has one of its own.
    pub files: &'a [PathBuf],
    /// Width and height in px.
    pub size: (usize, usize),
}

/// Something that belongs to a clip. Where it is given explicitly, it must fit; one that lies beside the clip, as in the folders of a
/// benchmark, is ignored with a warning if it does not.
pub(crate) trait Companion: Sized {
    /// The role of its files.
    const KIND: InputKind;
    /// The beginning of the warning about one beside the clip that does not fit.
    const IGNORED: &'static str;

    /// The given one.
    fn given(left: &LeftView<'_>, given: &Given) -> Option<Self>;

    /// The one that lies beside the clip.
    fn beside(left: &LeftView<'_>, given: &Given) -> Option<Self>;

    /// The files that it is read from.
    fn files(&self) -> Vec<PathBuf>;

    /// Reads it and gives it to the clip.
    ///
    /// # Errors
    /// One sentence if it cannot be read or does not fit the clip.
    fn attach(self, clip: Clip, left: &LeftView<'_>, options: &Open) -> Result<Clip, Error>;
}

/// A companion that was found, and whether it was given.
pub(crate) struct Found<C> {
    companion: C,
    is_given: bool,
}

impl<C: Companion> Found<C> {
    /// The companion, before it is read.
    pub(crate) fn companion(&self) -> &C {
        &self.companion
    }

    /// The given companion, or else the one beside the clip.
    pub(crate) fn find(left: &LeftView<'_>, given: &Given) -> Option<Self> {
        Self::given(left, given).or_else(|| C::beside(left, given).map(|companion| Self { companion, is_given: false }))
    }

    /// The given companion.
    pub(crate) fn given(left: &LeftView<'_>, given: &Given) -> Option<Self> {
        C::given(left, given).map(|companion| Self { companion, is_given: true })
    }
}

/// An opened clip with the files that it is read from, which nothing must be written over.
#[derive(Debug)]
pub struct OpenedClip {
    /// The clip.
    pub clip: Clip,
    /// Its files and those of its companions.
    pub inputs: Inputs,
}

impl From<Clip> for OpenedClip {
    fn from(clip: Clip) -> Self {
        Self { clip, inputs: Inputs::default() }
    }
}

impl OpenedClip {
    /// The same with a companion, if one was found.
    ///
    /// # Errors
    /// One sentence if a given one cannot be read or does not fit the clip.
    pub(crate) fn with<C: Companion>(
        mut self,
        found: Option<Found<C>>,
        left: &LeftView<'_>,
        options: &Open,
    ) -> Result<Self, Error> {
        let Some(Found { companion, is_given }) = found else { return Ok(self) };
        companion.files().into_iter().for_each(|file| self.inputs.add(C::KIND, file));
        self.clip = match companion.attach(self.clip.clone(), left, options) {
            Err(why) if !is_given => warned(self.clip, [format!("{}: {why}", C::IGNORED)]),
            attached => attached?,
        };
        Ok(self)
    }
}

/// The same clip with further warnings.
pub(crate) fn warned(clip: Clip, warnings: impl IntoIterator<Item = String>) -> Clip {
    let warnings = clip.info().warnings.iter().cloned().chain(warnings).collect();
    let info = ClipInfo { warnings, ..clip.info().clone() };
    clip.with_info(info)
}
