//! Which frame of a clip a file of truth belongs to.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

use crate::media::companion::LeftView;
use crate::media::names::{file_name, stem};
use crate::media::sequence::{number, parent};

/// The clip that truth is sought for.
pub(super) struct Subject {
    /// The opened path.
    path: PathBuf,
    /// Width and height in pixels.
    pub(super) size: (usize, usize),
    /// The first of the clip's pictures, if it is made of pictures.
    first: Option<PathBuf>,
    /// The numbers in the pictures' names, by frame.
    numbers: Vec<Option<u64>>,
    by_name: HashMap<String, usize>,
    by_number: HashMap<u64, usize>,
    /// Gray levels per px of disparity in 8-bit pictures, if given.
    pub(super) scale: Option<f32>,
}

impl Subject {
    /// Describes the clip whose frames lie in `left`, with the gray levels per px of disparity in 8-bit pictures.
    pub(super) fn new(left: &LeftView<'_>, scale: Option<f32>) -> Self {
        let mut subject = Self {
            path: left.path.into(),
            size: left.size,
            first: left.files.first().cloned(),
            numbers: Vec::new(),
            by_name: HashMap::new(),
            by_number: HashMap::new(),
            scale,
        };
        for (t, picture) in left.files.iter().enumerate() {
            let number = number(&file_name(picture));
            subject.numbers.push(number);
            subject.by_name.entry(stem(picture)).or_insert(t);
            if let Some(number) = number {
                subject.by_number.entry(number).or_insert(t);
            }
        }
        subject
    }

    /// Where the frames lie.
    pub(super) fn folder(&self) -> &Path {
        parent(self.first.as_ref().unwrap_or(&self.path))
    }

    /// Whether the clip is made of pictures rather than a single file.
    pub(super) fn has_pictures(&self) -> bool {
        self.first.is_some()
    }

    /// Returns the frame whose image has the name of `file`.
    pub(super) fn named(&self, file: &Path) -> Option<usize> {
        self.called(&stem(file))
    }

    /// Returns the frame whose image has the name `name` without extension.
    pub(super) fn called(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    /// Returns the frame with the number of `file`; in a video the number counts frames from 0.
    pub(super) fn numbered(&self, file: &Path) -> Option<usize> {
        let number = number(&file_name(file))?;
        if self.has_pictures() { self.by_number.get(&number).copied() } else { usize::try_from(number).ok() }
    }

    /// Whether the picture after frame `t` is missing, so that the clip's next frame is not what the flow leads to.
    pub(super) fn gap_after(&self, t: usize) -> bool {
        let number = |t: usize| self.numbers.get(t).copied().flatten();
        number(t).zip(number(t + 1)).is_some_and(|(this, next)| next > this.saturating_add(1))
    }

    /// The files of one folder by the frame that they belong to. Names count first; a number counts if only one file
    /// has it, because `000000_10` and `000001_10` are of different clips.
    pub(super) fn by_frame(&self, files: Vec<PathBuf>) -> BTreeMap<usize, PathBuf> {
        let mut frames = BTreeMap::new();
        let mut numbered: BTreeMap<usize, Vec<PathBuf>> = BTreeMap::new();
        for file in files {
            if let Some(t) = self.named(&file) {
                frames.entry(t).or_insert(file);
            } else if let Some(t) = self.numbered(&file) {
                numbered.entry(t).or_default().push(file);
            }
        }
        for (t, mut files) in numbered {
            if let (Some(file), true) = (files.pop(), files.is_empty()) {
                frames.entry(t).or_insert(file);
            }
        }
        frames.retain(|&t, _| !self.gap_after(t));
        frames
    }
}
