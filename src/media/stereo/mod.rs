//! The right view of a clip, given or found beside it, and the calibration of both cameras.
//!
//! `Clip::with_right` refuses views of different sizes or lengths. A found view that does not fit causes a warning, a given one
//! an error. Files named like two views of one moment are cut from the sequence (`keep_left`). Side-by-side frames are two
//! decoders of one file, each of which keeps its half (`halves.rs`). Each view has a cache of half the limit.

mod calibration;
mod find;
mod halves;

use std::path::{Path, PathBuf};

use motionscope_core::base::Error;
use motionscope_core::data::{Calibration, Clip};

use super::companion::{Companion, LeftView};
use super::detect_format::{self, Kind};
use super::export::InputKind;
use super::input::Input;
use super::names::file_name;
use super::reader::{self, guarded, is_still_or_folder};
use super::sequence::{Sequence, parent};
use super::{Given, GivenCalibration, Open, RightView, Source, about, cache, stills, truth};
use crate::files;

use calibration::Cameras;
pub(crate) use find::{keep_left, right_view};
pub(crate) use halves::{Half, half};

/// The right view of a clip.
pub(crate) enum SecondView {
    /// The right half of each frame.
    SideBySide,
    /// A given path, and the pictures there that belong to those of the left view, if it is made of pictures.
    Given(PathBuf, Option<Vec<PathBuf>>),
    /// A view found beside the clip.
    Beside(find::Right),
}

impl SecondView {
    /// Whether there is a picture for each of the left view, as far as that is known before it is read.
    pub(crate) fn is_complete(&self) -> bool {
        !matches!(self, Self::Beside(find::Right { incomplete: Some(_), .. }))
    }
}

impl Companion for SecondView {
    const KIND: InputKind = InputKind::RightView;
    const IGNORED: &'static str = "the right view beside the clip is ignored";

    fn given(left: &LeftView<'_>, given: &Given) -> Option<Self> {
        Some(match given.right.as_ref()? {
            RightView::SideBySide => Self::SideBySide,
            RightView::File(path) => Self::Given(path.clone(), pictures(path, left)),
        })
    }

    fn beside(left: &LeftView<'_>, _given: &Given) -> Option<Self> {
        Some(find::right(left)).filter(|right| *right != find::Right::default()).map(Self::Beside)
    }

    fn files(&self) -> Vec<PathBuf> {
        match self {
            Self::SideBySide => Vec::new(),
            Self::Given(path, pictures) => pictures.clone().unwrap_or_else(|| vec![path.clone()]),
            Self::Beside(right) => right.files.clone(),
        }
    }

    fn attach(self, clip: Clip, left: &LeftView<'_>, options: &Open) -> Result<Clip, Error> {
        let join = |right: Source| clip.clone().with_right(cache::clip(right, options.cache_bytes));
        match self {
            Self::SideBySide => join(right_half(left, options)?),
            Self::Given(path, pictures) => {
                let right = guarded(|| given(&path, pictures, options)).map(|right| named(right, &path, left));
                right.and_then(join).map_err(|why| about(&path, &why))
            }
            Self::Beside(find::Right { incomplete: Some(why), .. }) => Err(Error::new(why)),
            Self::Beside(find::Right { files, .. }) => {
                let Some(first) = files.first().cloned() else { return Ok(clip) };
                let right = guarded(|| found(files, left, options)).map(|right| named(right, &first, left));
                right.and_then(join).map_err(|why| Error::new(format!("{}: {why}", file_name(&first))))
            }
        }
    }
}

/// The `source` of a right view at `path`, called as it is found from the left view: both may have the same file name.
fn named(mut source: Source, path: &Path, left: &LeftView<'_>) -> Source {
    let [left, right] = [(left.files, left.path), (&*source.files, path)]
        .map(|(files, path)| files.first().map_or(path, PathBuf::as_path));
    source.info.name = truth::name_from(parent(left), right);
    source
}

/// The pictures at `path` that belong to those of the left view: by their names if all are there, else in order.
fn pictures(path: &Path, left: &LeftView<'_>) -> Option<Vec<PathBuf>> {
    if left.files.is_empty() || !is_still_or_folder(path) {
        return None;
    }
    let namesakes: Vec<_> = left.files.iter().map(|file| path.join(file_name(file))).collect();
    if files::is_dir(path) && namesakes.iter().all(|file| files::is_file(file)) {
        return Some(namesakes);
    }
    let mut files = Sequence::find(path).ok()?.files;
    files.truncate(left.files.len());
    Some(files)
}

/// The right view at the given `path`, which has these `pictures`.
fn given(path: &Path, pictures: Option<Vec<PathBuf>>, options: &Open) -> Result<Source, Error> {
    // What stands for frames beside each other is no concern of the right view.
    let options = Open { given: Given { contrast: options.given.contrast, ..Given::default() }, ..options.clone() };
    match pictures {
        Some(files) => stills::of_files(files, &options),
        None => reader::read(path, &options),
    }
}

/// The right half of the frames of the clip.
fn right_half(left: &LeftView<'_>, options: &Open) -> Result<Source, Error> {
    let path = left.path;
    if path == Path::new("-") {
        return Err(Error::new("side-by-side frames are read twice, which a pipe does not allow; save them to a file"));
    }
    let whole = if left.files.is_empty() {
        reader::read(path, options)
    } else {
        stills::of_files(left.files.to_vec(), options)
    };
    half(whole.map_err(|why| about(path, &why))?, Half::Right).map_err(|why| about(path, &why))
}

/// The right view in `files`, which were found beside the clip.
fn found(files: Vec<PathBuf>, left: &LeftView<'_>, options: &Open) -> Result<Source, Error> {
    match (left.files, files.as_slice()) {
        ([], [video, ..]) => match detect_format::kind(&mut Input::open(video)?)? {
            Kind::Video(_) | Kind::Animation => reader::read(video, options),
            Kind::Still => Err(Error::new("it is a picture, and the left view is not")),
        },
        _ => stills::of_files(files, options),
    }
}

/// The calibration of the cameras of both views.
pub(crate) enum CameraCalibration {
    /// Given explicitly.
    Given(GivenCalibration),
    /// A file found beside the clip.
    Beside(PathBuf),
}

impl Companion for CameraCalibration {
    const KIND: InputKind = InputKind::Calibration;
    const IGNORED: &'static str = "the calibration beside the clip is ignored";

    fn given(_left: &LeftView<'_>, given: &Given) -> Option<Self> {
        given.calibration.clone().map(Self::Given)
    }

    fn beside(left: &LeftView<'_>, _given: &Given) -> Option<Self> {
        find::calibration_beside(left).map(Self::Beside)
    }

    fn files(&self) -> Vec<PathBuf> {
        let (Self::Given(GivenCalibration::File(file)) | Self::Beside(file)) = self else { return Vec::new() };
        vec![file.clone()]
    }

    fn attach(self, clip: Clip, left: &LeftView<'_>, _options: &Open) -> Result<Clip, Error> {
        let read = |path: &Path| {
            let cameras = left.files.first().map_or(Cameras::Any, |first| Cameras::of(first));
            calibration::read(path, cameras).and_then(Calibration::checked)
        };
        let calibration = match self {
            Self::Beside(_) if clip.right().is_none() => return Ok(clip),
            Self::Beside(path) => read(&path).map_err(|why| Error::new(format!("{}: {why}", file_name(&path)))),
            Self::Given(GivenCalibration::File(path)) => read(&path).map_err(|why| about(&path, &why)),
            Self::Given(GivenCalibration::Typed { focal_px, baseline_m, principal_px }) => {
                let (width, height) = clip.size();
                let centre = [(width - 1) as f64 / 2.0, (height - 1) as f64 / 2.0];
                let principal_px = principal_px.unwrap_or(centre);
                Calibration { focal_px, baseline_m, principal_px, offset_px: 0.0 }.checked()
            }
        };
        Ok(clip.with_calibration(calibration?))
    }
}
