//! The right view of a clip, given or found beside it, and the calibration of both cameras.
//!
//! `Clip::with_right` refuses views of different sizes or lengths. A found view that does not fit causes a warning, a given one
//! an error. Files named like two views of one moment are cut from the sequence (`keep_left`). Side-by-side frames are two
//! decoders of one file, each of which keeps its half (`halves.rs`). Each view has a cache of half the limit.

mod calibration;
mod find;
mod halves;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use motionscope_core::base::Error;
use motionscope_core::data::{Calibration, Clip};

use super::input::Input;
use super::names::file_name;
use super::sequence::{Sequence, parent};
use super::{
    Given, Kind, Open, Source, about, cache, detect_format, guarded, is_still_or_folder, open_source, stills, truth,
};

use calibration::Cameras;
pub use calibration::GivenCalibration;
pub(crate) use find::{calibration_beside, keep_left};
pub(crate) use halves::{Half, half};

/// A right view given explicitly.
#[derive(Clone, Debug, PartialEq)]
pub enum RightView {
    /// A clip of its own: pictures, a folder of them, or a video.
    File(PathBuf),
    /// The right half of each frame; the left half is the left view.
    SideBySide,
}

impl RightView {
    /// The word for [`RightView::SideBySide`].
    pub const SIDE_BY_SIDE: &'static str = "side-by-side";

    /// The view at `path`, or that of side-by-side frames.
    pub fn of(path: &Path) -> Self {
        if path == Path::new(Self::SIDE_BY_SIDE) { Self::SideBySide } else { Self::File(path.into()) }
    }

    /// The same with `f` applied to its path, if it has one.
    #[must_use]
    pub fn map_path(self, f: impl FnOnce(&Path) -> PathBuf) -> Self {
        match self {
            Self::File(path) => Self::File(f(&path)),
            Self::SideBySide => Self::SideBySide,
        }
    }

    /// Its path, or the word for side-by-side frames.
    pub fn path(&self) -> &Path {
        match self {
            Self::File(path) => path,
            Self::SideBySide => Path::new(Self::SIDE_BY_SIDE),
        }
    }
}

/// Where the frames of the left view lie.
pub(crate) struct LeftView<'a> {
    /// The opened path.
    pub path: &'a Path,
    /// The file of each frame, where each has one of its own.
    pub files: &'a [PathBuf],
}

/// The same clip with its right view and its calibration, given or found.
///
/// # Errors
/// One sentence if what is given cannot be read or does not fit the clip. A found file that does not fit only causes a warning.
pub(crate) fn with_right_view(clip: Clip, left: &LeftView<'_>, options: &Open) -> Result<Clip, Error> {
    let clip = match &options.given.right {
        Some(RightView::File(path)) => {
            let right = guarded(|| given(path, left, options)).map_err(|why| about(path, &why))?;
            clip.with_right(decoded(named(right, path, left), options)).map_err(|why| about(path, &why))?
        }
        Some(RightView::SideBySide) => clip.with_right(decoded(right_half(left, options)?, options))?,
        None => with_found(clip, left, options),
    };
    with_calibration(clip, left, &options.given)
}

/// Whether a right view is given, or lies beside the clip.
pub(crate) fn has_right_view(left: &LeftView<'_>, options: &Open) -> bool {
    options.given.right.is_some() || !find::right(left).files.is_empty()
}

/// The files that the right view and the calibration are read from.
pub(crate) fn files(left: &LeftView<'_>, options: &Open) -> (Vec<PathBuf>, Option<PathBuf>) {
    let right = match &options.given.right {
        Some(RightView::File(path)) => pictures(path, left).unwrap_or_else(|| vec![path.clone()]),
        Some(RightView::SideBySide) => Vec::new(),
        None => find::right(left).files,
    };
    let calibration = match &options.given.calibration {
        Some(GivenCalibration::File(path)) => Some(path.clone()),
        Some(GivenCalibration::Typed { .. }) => None,
        None => calibration_beside(left),
    };
    (right, calibration)
}

/// A clip of the frames of `source`, behind a cache of its own.
fn decoded(source: Source, options: &Open) -> Clip {
    Clip::new(source.info.clone(), Arc::new(cache::Lazy::new(source, options.cache_bytes)))
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
    if path.is_dir() && namesakes.iter().all(|file| file.is_file()) {
        return Some(namesakes);
    }
    let mut files = Sequence::find(path).ok()?.files;
    files.truncate(left.files.len());
    Some(files)
}

/// The right view at the given `path`.
fn given(path: &Path, left: &LeftView<'_>, options: &Open) -> Result<Source, Error> {
    // What stands for frames beside each other is no concern of the right view.
    let options = Open { given: Given { contrast: options.given.contrast, ..Given::default() }, ..options.clone() };
    match pictures(path, left) {
        Some(files) => stills::of_files(files, &options),
        None => open_source(path, &options),
    }
}

/// The right half of the frames of the clip.
fn right_half(left: &LeftView<'_>, options: &Open) -> Result<Source, Error> {
    let path = left.path;
    if path == Path::new("-") {
        return Err(Error::new("side-by-side frames are read twice, which a pipe does not allow; save them to a file"));
    }
    let whole =
        if left.files.is_empty() { open_source(path, options) } else { stills::of_files(left.files.to_vec(), options) };
    half(whole.map_err(|why| about(path, &why))?, Half::Right).map_err(|why| about(path, &why))
}

/// The same clip with the right view that lies beside it, if there is one; with a warning if it does not fit.
fn with_found(clip: Clip, left: &LeftView<'_>, options: &Open) -> Clip {
    let found = find::right(left);
    let mut ignored = found.incomplete;
    if !found.files.is_empty() {
        let open = || match left.files {
            [] => Input::open(&found.files[0]).and_then(|mut input| match detect_format::kind(&mut input)? {
                Kind::Video(_) | Kind::Animation => open_source(&found.files[0], options),
                Kind::Still => Err(Error::new("it is a picture, and the left view is not")),
            }),
            _ => stills::of_files(found.files.clone(), options),
        };
        let right = guarded(open).map(|right| named(right, &found.files[0], left));
        match right.and_then(|right| clip.clone().with_right(decoded(right, options))) {
            Ok(both) => return both,
            Err(why) => ignored = Some(format!("{}: {why}", file_name(&found.files[0]))),
        }
    }
    warned(clip, ignored.map(|why| format!("the right view beside the clip is ignored: {why}")))
}

/// The same clip with the calibration of its cameras, given or beside it.
fn with_calibration(clip: Clip, left: &LeftView<'_>, given: &Given) -> Result<Clip, Error> {
    let cameras = left.files.first().map_or(Cameras::Any, |first| Cameras::of(first));
    let checked = |calibration: Calibration| calibration.checked();
    match &given.calibration {
        Some(GivenCalibration::Typed { focal_px, baseline_m, principal_px }) => {
            let (width, height) = clip.size();
            let centre = [(width - 1) as f64 / 2.0, (height - 1) as f64 / 2.0];
            let typed = Calibration {
                focal_px: *focal_px,
                baseline_m: *baseline_m,
                principal_px: principal_px.unwrap_or(centre),
                offset_px: 0.0,
            };
            Ok(clip.with_calibration(checked(typed)?))
        }
        Some(GivenCalibration::File(path)) => {
            let read = calibration::read(path, cameras).and_then(checked).map_err(|why| about(path, &why))?;
            Ok(clip.with_calibration(read))
        }
        None if clip.right().is_none() => Ok(clip),
        None => {
            Ok(match calibration_beside(left).map(|path| (calibration::read(&path, cameras).and_then(checked), path)) {
                Some((Ok(found), _)) => clip.with_calibration(found),
                Some((Err(why), path)) => warned(
                    clip,
                    Some(format!("the calibration beside the clip is ignored: {}: {why}", file_name(&path))),
                ),
                None => clip,
            })
        }
    }
}

/// The same clip with a further warning, if there is one.
fn warned(clip: Clip, warning: Option<String>) -> Clip {
    let Some(warning) = warning else { return clip };
    let mut info = clip.info().clone();
    info.warnings.push(warning);
    clip.with_info(info)
}
