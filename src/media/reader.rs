//! The reader of a file, which its content decides.

use std::path::Path;

use motionscope_core::base::Error;

use super::catch_panic::catch_panic;
use super::detect_format::{self, Kind};
use super::input::{Input, Node};
use super::{Open, Source, animation, reason, sequence, stills, video};
use crate::files;

/// Reads the pictures, the animation or the video at `path`, or `-` for standard input.
///
/// # Errors
/// One sentence, without the file's name.
pub(crate) fn read(path: &Path, options: &Open) -> Result<Source, Error> {
    if files::is_dir(path) || sequence::is_pattern(path) {
        return stills::open(path, options);
    }
    let mut input = Input::open(path)?;
    let kind = detect_format::kind(&mut input)?;
    let mut source = match kind {
        Kind::Still | Kind::Animation if path == Path::new("-") || Node::of(path) == Ok(Node::Stream) => {
            return Err(Error::new("pictures cannot come from a pipe; save them to files and open those"));
        }
        Kind::Still => stills::open(path, options)?,
        Kind::Animation => animation::open(path, options)?,
        Kind::Video(format) => video::open(path, format, input, options)?,
    };
    source.info.warnings.extend(detect_format::mislabelled(path, kind));
    Ok(source)
}

/// The kind of the file at `path`.
///
/// # Errors
/// One sentence, without the file's name, if it is a folder or cannot be read.
pub(crate) fn kind(path: &Path) -> Result<Kind, Error> {
    if files::is_dir(path) {
        return Err(Error::new("it is a folder; name two picture files"));
    }
    detect_format::kind(&mut Input::open(path)?)
}

/// Whether `path` is a picture, a folder of pictures or a pattern.
pub(crate) fn is_still_or_folder(path: &Path) -> bool {
    files::is_dir(path) || sequence::is_pattern(path) || matches!(kind(path), Ok(Kind::Still))
}

/// Returns what `read` gives; a panic in a decoder is an error.
///
/// # Errors
/// As `read`, and if a decoder panics.
pub(crate) fn guarded<T>(read: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
    catch_panic(read).unwrap_or_else(|panic| {
        Err(Error::new(format!("it is damaged and cannot be decoded{}", reason::bracketed(&panic))))
    })
}
