//! The protection of inputs, and of results of the same run, against being overwritten.
//!
//! Files are compared by identity, not by name, so links are recognized. Command line and window check before anything runs.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use crate::files::{self, Kind};
use crate::media::names::file_name;
use crate::media::sequence::{parent, would_join};

/// The role of an input file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputKind {
    /// The whole clip.
    Clip,
    /// A frame of the clip.
    Frame,
    /// Ground truth.
    Truth,
    /// Detections.
    Detections,
    /// The right view.
    RightView,
    /// The calibration.
    Calibration,
    /// Measured depths.
    Depths,
    /// The session.
    Session,
}

impl InputKind {
    fn words(self) -> &'static str {
        match self {
            Self::Clip => "the clip",
            Self::Frame => "a frame of the clip",
            Self::Truth => "the ground truth of the clip",
            Self::Detections => "the detections",
            Self::RightView => "the right view",
            Self::Calibration => "the calibration",
            Self::Depths => "the measured depths",
            Self::Session => "the session",
        }
    }
}

/// All input files of a run.
#[derive(Clone, Debug, Default)]
pub struct Inputs {
    files: Vec<(InputKind, PathBuf)>,
    /// The opened path, if the clip consists of images.
    pictures: Option<PathBuf>,
}

impl Inputs {
    /// Adds a file.
    pub fn add(&mut self, what: InputKind, file: impl Into<PathBuf>) {
        self.files.push((what, file.into()));
    }

    /// Adds the images of `opened`: a folder, a pattern, or the first image.
    pub fn add_pictures(&mut self, opened: &Path, files: impl IntoIterator<Item = PathBuf>) {
        self.files.extend(files.into_iter().map(|file| (InputKind::Frame, file)));
        self.pictures = Some(opened.into());
    }

    /// Returns the inputs without those of role `what`.
    #[must_use]
    pub fn without(mut self, what: InputKind) -> Self {
        self.files.retain(|(other, _)| *other != what);
        self
    }

    /// `folder`, or the folder around it where it holds the frames of the clip.
    pub fn outside(&self, folder: &Path) -> PathBuf {
        let frames = self.first_frame().map(|first| Identity::of(parent(first)));
        let holds_frames = self.pictures.is_some() && frames == Some(Identity::of(folder));
        let whole = || files::canonicalize(folder).unwrap_or_else(|_| folder.into());
        match holds_frames.then(whole).as_deref().and_then(Path::parent) {
            Some(around) => around.into(),
            None => folder.into(),
        }
    }

    fn first_frame(&self) -> Option<&Path> {
        self.files.iter().find(|(what, _)| *what == InputKind::Frame).map(|(_, file)| file.as_path())
    }
}

/// The target of a result.
#[derive(Clone, Copy, Debug)]
pub enum Target<'a> {
    /// A file; `-` is standard output.
    File(&'a Path),
    /// Numbered files in a folder, with this prefix.
    Numbered(&'a Path, &'static str),
}

impl<'a> Target<'a> {
    /// Returns the file or the folder.
    pub fn path(self) -> &'a Path {
        match self {
            Self::File(path) | Self::Numbered(path, _) => path,
        }
    }

    /// Returns what to choose instead.
    pub fn other(self) -> &'static str {
        if matches!(self, Self::File(_)) { "another name" } else { "another folder" }
    }

    /// Whether this is a regular file or folder, rather than a pipe or device.
    fn is_kept(self) -> bool {
        match self {
            Self::File(path) => {
                path != Path::new("-") && files::facts(path).map_or(true, |facts| facts.kind == Kind::File)
            }
            Self::Numbered(..) => true,
        }
    }

    /// Whether both would write the same file, or one a file where the other needs a folder.
    fn meets(self, other: Self) -> bool {
        let is_in = |file: &Path, folder: &Path, begin: &str| {
            file_name(file).starts_with(begin) && Identity::of(parent(file)) == Identity::of(folder)
        };
        let is_same = Identity::of(self.path()) == Identity::of(other.path());
        is_same
            || match (self, other) {
                (Self::File(file), Self::Numbered(folder, begin))
                | (Self::Numbered(folder, begin), Self::File(file)) => is_in(file, folder, begin),
                _ => false,
            }
    }

    /// Returns the existing files that would be replaced.
    fn replaced(self) -> Vec<PathBuf> {
        match self {
            Self::File(path) => vec![path.into()],
            Self::Numbered(folder, begin) => {
                let entries = files::entries(folder);
                let ours = entries.filter(|path| file_name(path).starts_with(begin));
                ours.collect()
            }
        }
    }
}

/// A conflict of a target with an input or with another target.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Conflict {
    /// Index of the target.
    pub at: usize,
    /// Index of the other target, if two are the same.
    pub also: Option<usize>,
    /// The consequence, as part of a sentence: `would replace a.png, a frame of the clip`.
    pub why: String,
}

/// Checks that all `targets` can be written without overwriting an input or each other.
///
/// # Errors
/// The first conflict.
pub fn check(inputs: &Inputs, targets: &[Target<'_>]) -> Result<(), Conflict> {
    let kept: Vec<_> = targets.iter().copied().enumerate().filter(|(_, target)| target.is_kept()).collect();
    for (i, &(also, first)) in kept.iter().enumerate() {
        if let Some(&(at, _)) = kept[i + 1..].iter().find(|(_, second)| first.meets(*second)) {
            return Err(Conflict { at, also: Some(also), why: "would be saved to the same file".into() });
        }
    }
    let mut known = None;
    kept.iter().try_for_each(|&(at, target)| {
        refuse(inputs, target, &mut known).map_or(Ok(()), |why| Err(Conflict { at, also: None, why }))
    })
}

/// Returns why `target` must not be written; the identities of `inputs` are read once, on demand.
fn refuse(inputs: &Inputs, target: Target<'_>, known: &mut Option<HashMap<Identity, usize>>) -> Option<String> {
    for file in target.replaced() {
        let Some(identity) = Identity::of_file(&file) else { continue };
        let known = known.get_or_insert_with(|| {
            let files = inputs.files.iter().enumerate().rev();
            files.filter_map(|(i, (_, file))| Some((Identity::of_file(file)?, i))).collect()
        });
        if let Some(&i) = known.get(&identity) {
            let (what, input) = &inputs.files[i];
            let (name, what) = (file_name(input), what.words());
            let is_target = name == file_name(target.path());
            return Some(if is_target {
                format!("would replace {what}")
            } else {
                format!("would replace {name}, {what}")
            });
        }
    }
    match target {
        Target::File(path) => {
            let joins = inputs.pictures.as_ref().is_some_and(|opened| would_join(opened, path));
            joins.then(|| "would become a frame of the clip".to_owned())
        }
        Target::Numbered(folder, _) if files::exists(folder) && !files::is_dir(folder) => {
            Some("is a file, not a folder".into())
        }
        Target::Numbered(folder, _) => {
            let frames = inputs.first_frame().map(|first| Identity::of(parent(first)));
            (frames == Some(Identity::of(folder)))
                .then(|| "would mix its pictures with the frames of the clip".to_owned())
        }
    }
}

/// The identity of a file, independent of its name.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Identity {
    /// Device and inode.
    Node(u64, u64),
    /// Canonical path.
    Place(PathBuf),
}

impl Identity {
    /// Returns the identity of `path`, which need not exist.
    fn of(path: &Path) -> Self {
        Self::of_file(path).unwrap_or_else(|| Self::Place(place(path)))
    }

    /// Returns the identity of `path`, if it exists.
    fn of_file(path: &Path) -> Option<Self> {
        let facts = files::facts(path).ok()?;
        Some(facts.node.map_or_else(|| Self::Place(place(path)), |(device, inode)| Self::Node(device, inode)))
    }
}

/// Returns the canonical form of `path`.
fn place(path: &Path) -> PathBuf {
    let whole = |path: &Path| files::canonicalize(path).ok();
    let beside = || Some(whole(parent(path))?.join(path.file_name()?));
    let place = whole(path).or_else(beside).unwrap_or_else(|| files::absolute(path));
    // These file systems ignore case.
    if cfg!(any(windows, target_os = "macos")) { place.to_string_lossy().to_lowercase().into() } else { place }
}
