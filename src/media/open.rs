//! Opening of a clip with all that belongs to it.

use std::iter;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use motionscope_core::base::Error;
use motionscope_core::data::{Clip, ClipInfo};

use super::catch_panic::catch_panic;
use super::companion::{Companion, Found, LeftView, OpenedClip};
use super::depths::Depths;
use super::detect_format::Kind;
use super::detections::{self, Detections};
use super::export::InputKind;
use super::input::Node;
use super::stereo::{CameraCalibration, Half, SecondView, half};
use super::truth::GroundTruth;
#[cfg(target_arch = "wasm32")]
use super::video;
use super::video::Format;
use super::{Given, Open, RightView, Source, about, cache, reader, reason, stills};
use crate::files;

/// Opens any clip: a picture or a folder of pictures, an animation, a video file, or `-` for standard input.
///
/// The content decides, not the name: a mislabelled file opens with a warning. Call it off the window's thread.
///
/// # Errors
/// One sentence that names the file, tells what is wrong and what to do.
pub fn open(path: &Path, options: &Open) -> Result<OpenedClip, Error> {
    // Before anything is opened that never ends.
    if files::exists(path) {
        Node::of(path).map_err(|error| about(path, &error))?;
    }
    let OpenedClip { clip, inputs } =
        if detections::is(path) { open_detections(path, options)? } else { open_frames(path, options)? };
    // Warnings with file names and words of other decoders are one sentence as well.
    let warnings = clip.info().warnings.iter().map(|message| Error::new(message.as_str()).to_string()).collect();
    let info = ClipInfo { warnings, ..clip.info().clone() };
    Ok(OpenedClip { clip: clip.with_info(info), inputs })
}

/// Opens a table of detections as a clip of empty pictures.
fn open_detections(path: &Path, options: &Open) -> Result<OpenedClip, Error> {
    let clip = detections::open(path)?;
    let left = LeftView { path, files: &[], size: clip.size() };
    let mut opened = with_truth(clip.into(), &left, options)?;
    opened.inputs.add(InputKind::Detections, path);
    Ok(opened)
}

/// Opens pictures, an animation or a video.
fn open_frames(path: &Path, options: &Open) -> Result<OpenedClip, Error> {
    let source = reader::guarded(|| reader::read(path, options)).map_err(|error| about(path, &error))?;
    let pictures = Arc::clone(&source.files);
    let mut opened = with_companions(path, source, options)?;
    if !pictures.is_empty() {
        opened.inputs.add_pictures(path, pictures.iter().cloned());
    } else if path != Path::new("-") {
        opened.inputs.add(InputKind::Clip, path);
    }
    Ok(opened)
}

/// Opens two pictures as a clip of two frames. Call it off the window's thread.
///
/// # Errors
/// One sentence that names the file, tells what is wrong and what to do.
pub fn open_pair(files: &[PathBuf; 2], options: &Open) -> Result<OpenedClip, Error> {
    for file in files {
        let kind = reader::guarded(|| reader::kind(file)).map_err(|error| about(file, &error))?;
        if !matches!(kind, Kind::Still) {
            let why = "it is no picture; two files are a clip only if both are pictures";
            return Err(about(file, &Error::new(why)));
        }
    }
    let source = reader::guarded(|| stills::pair(files, options)).map_err(|error| about(&files[0], &error))?;
    let mut opened = with_companions(&files[0], source, options)?;
    files.iter().for_each(|file| opened.inputs.add(InputKind::Frame, file));
    Ok(opened)
}

/// Opens a synthetic clip with the truth and the detections that are given in place of its own.
///
/// # Errors
/// One sentence if they cannot be read or do not fit the clip, or if a right view is given, which a scene has of its own.
pub fn open_scene(clip: Clip, options: &Open) -> Result<OpenedClip, Error> {
    let (name, given) = (clip.info().name.clone(), &options.given);
    let left = LeftView { path: Path::new(&name), files: &[], size: clip.size() };
    let opened = OpenedClip::from(clip).with(Found::<GroundTruth>::given(&left, given), &left, options)?;
    if given.right.is_some() || given.calibration.is_some() {
        let why = "a synthetic scene has the views and the calibration of its own cameras; open it without another right view and \
                   calibration, or render it with motionscope synth and open the folder";
        return Err(Error::new(why));
    }
    opened.with(Found::<Detections>::given(&left, given), &left, options)
}

/// The clip of `source`, read from `path`, behind the frame cache and with all that belongs to it.
fn with_companions(path: &Path, source: Source, options: &Open) -> Result<OpenedClip, Error> {
    let mut source = match options.given.right {
        Some(RightView::SideBySide) => half(source, Half::Left).map_err(|why| about(path, &why))?,
        _ => source,
    };
    if options.given.contrast.is_some() && source.contrast.is_none() {
        source.info.warnings.push("the contrast is not used: the clip has no 16-bit pictures".into());
    }
    let files = Arc::clone(&source.files);
    let left = &LeftView { path, files: &files, size: (source.info.width, source.info.height) };
    let right = Found::<SecondView>::find(left, &options.given);
    let views = if right.as_ref().is_some_and(|right| right.companion().is_complete()) { 2 } else { 1 };
    // Both views are shown alike, or the same point would have two brightnesses.
    let given = Given { contrast: source.contrast.or(options.given.contrast), ..options.given.clone() };
    let options = &Open { cache_bytes: options.cache_bytes / views, given, ..options.clone() };
    with_truth(cache::clip(source, options.cache_bytes).into(), left, options)?
        .with(Found::<Depths>::find(left, &options.given), left, options)?
        .with(right, left, options)?
        .with(Found::<CameraCalibration>::find(left, &options.given), left, options)?
        .with(Found::<Detections>::find(left, &options.given), left, options)
}

/// The same clip with its ground truth; a panic in a decoder is an error.
fn with_truth(opened: OpenedClip, left: &LeftView<'_>, options: &Open) -> Result<OpenedClip, Error> {
    let with_truth = || opened.with(Found::<GroundTruth>::find(left, &options.given), left, options);
    catch_panic(with_truth).unwrap_or_else(|panic| {
        let why = format!("its ground truth is damaged and cannot be decoded{}", reason::bracketed(&panic));
        Err(about(left.path, &Error::new(why)))
    })
}

/// Whether the video at `path`, or the right view beside it, is given to an installed ffmpeg, because no built-in decoder shows it.
pub(crate) fn needs_ffmpeg(path: &Path) -> bool {
    foreign(path, &Given::default()).next().is_some()
}

/// Has the browser decode the videos of `paths` that no built-in decoder shows, their right views included, so that [`open`] finds the frames
/// in memory. Does nothing on a desktop.
///
/// # Errors
/// One sentence that names the file, tells what is wrong and what to do.
pub async fn decode_ahead(paths: &[&Path], options: &Open) -> Result<(), Error> {
    #[cfg(target_arch = "wasm32")]
    for (path, format) in paths.iter().flat_map(|path| foreign(path, &options.given)) {
        video::browser::decode(&path, format, options).await.map_err(|error| about(&path, &error))?;
    }
    #[cfg(not(target_arch = "wasm32"))]
    let _ = (paths, options);
    Ok(())
}

/// The videos at `path` and of its right view that no built-in decoder shows.
fn foreign(path: &Path, given: &Given) -> impl Iterator<Item = (PathBuf, Format)> {
    let left = LeftView { path, files: &[], size: (0, 0) };
    let right = Found::<SecondView>::find(&left, given).map_or_else(Vec::new, |right| right.companion().files());
    let built_in = Open { ffmpeg: false, cache_bytes: 0, ..Open::default() };
    // Others are not opened: a pipe could be waited for without end.
    let all = iter::once(path.to_owned()).chain(right).filter(|path| files::is_file(path));
    all.filter_map(move |path| match reader::kind(&path) {
        Ok(Kind::Video(format)) => {
            reader::guarded(|| reader::read(&path, &built_in)).is_err().then_some((path, format))
        }
        _ => None,
    })
}
