//! Input: videos, animations, image sequences, ground truth and detections.
//!
//! [`open`] lets the content decide on the `reader`, puts the frame cache in front of its decoder, and adds the clip's companions:
//! ground truth, depths, a right view, a calibration and detections, given or found beside it. A `Decoder` handles one format and
//! nothing of caching, threads or ground truth.

// Tests make pictures of patterns of bytes.
#![cfg_attr(not(test), warn(clippy::cast_possible_truncation))]

mod animation;
mod cache;
pub mod camera;
mod catch_panic;
mod companion;
mod decoder;
mod depths;
mod detect_format;
mod detections;
pub mod export;
mod given;
mod helper;
mod info;
pub(crate) mod input;
#[cfg(target_arch = "wasm32")]
mod javascript;
pub(crate) mod names;
mod numbers;
mod open;
mod options;
mod picture;
#[cfg(target_arch = "wasm32")]
mod planes;
mod reader;
mod reason;
mod sequence;
mod size;
mod stereo;
mod stills;
pub(crate) mod table;
mod tiff;
mod truth;
mod unsupported;
mod video;

use std::path::Path;

use motionscope_core::base::Error;

use crate::files;

pub use companion::OpenedClip;
pub(crate) use decoder::{Decoder, Source};
pub use given::{Given, GivenCalibration, RightView, depth_scale, disparity_scale};
pub use info::Info;
use input::Node;
pub(crate) use open::needs_ffmpeg;
pub use open::{decode_ahead, open, open_pair, open_scene};
pub use options::{Open, Progress};
pub use picture::Contrast;
pub(crate) use reason::{about, cannot_read};
pub(crate) use sequence::is_called_truth;
pub(crate) use size::{MAX_AREA_PX, MAX_SIDE_PX, check_size};
pub(crate) use stereo::right_view;

/// Refuses a path at which a pipe or a device lies instead of a file or a folder: opening one could block, or do something.
///
/// # Errors
/// One sentence with the path.
pub fn check_is_file(path: &Path) -> Result<(), Error> {
    // What is not there is told when it is opened.
    let node = if files::exists(path) { Node::of(path) } else { Ok(Node::File) };
    match node {
        Ok(Node::File | Node::Folder) => Ok(()),
        Ok(Node::Stream) => Err(about(path, &Error::new("it is a named pipe; sessions and lessons name files"))),
        Err(error) => Err(about(path, &error)),
    }
}

/// Whether the file at `path` can be read as a table of detections, whatever its name and first line.
///
/// # Errors
/// A sentence that names the line that cannot be understood.
pub fn check_detections(path: &Path) -> Result<(), Error> {
    if Node::of(path) == Ok(Node::Stream) {
        let why =
            "it is a pipe, and detections by themselves are read more than once; save them to a file and give that";
        return Err(about(path, &Error::new(why)));
    }
    detections::read(path).map(drop)
}

/// The text in the file at `path`.
///
/// # Errors
/// A sentence, without the path, if it cannot be read, is no text, or too large for one.
pub fn read_text(path: &Path) -> Result<String, Error> {
    input::text(path)
}

/// Whether the file at `path` is a picture, an animation or a video, by its content.
pub fn is_clip(path: &Path) -> bool {
    files::is_file(path) && !is_truth(path) && reader::kind(path).is_ok()
}

/// Whether the folder at `path` holds pictures of a clip.
pub fn holds_pictures(path: &Path) -> bool {
    sequence::Sequence::find(path).is_ok()
}

/// Whether the file at `path` is a table of detections without identities, as `det.txt` is.
pub fn is_detections(path: &Path) -> bool {
    detections::is(path)
}

/// Whether the file at `path` tells what is true of a clip, and holds no pictures: true objects, a flow, or disparities.
pub fn is_truth(path: &Path) -> bool {
    matches!(names::extension(path).as_str(), "flo" | "pfm") || detections::is_truth(path)
}
