//! Video: containers find the coded pictures, codecs decode them, the user's own ffmpeg or the browser does all the rest.

mod avi;
pub(super) mod browser;
mod bytes;
mod coded;
pub(super) mod color;
pub(super) mod ffmpeg;
mod h264;
mod matroska;
mod mjpeg;
mod mp4;
mod mp4_boxes;
mod mp4_samples;
mod raw;
mod sps;
mod turn;
mod vp9;
pub(super) mod y4m;

use std::collections::BTreeSet;

use std::path::Path;

use motionscope_core::base::Error;
use motionscope_core::data::ClipInfo;

use super::catch_panic::catch_panic;
use super::input::Input;
use super::{Open, Source, reason};
use crate::files::IN_PAGE;
use coded::{Codec, Coded, Track};
use h264::H264;
use mjpeg::Mjpeg;
pub(crate) use mjpeg::is_stream;
use raw::Raw;
use vp9::Vp9;

/// The reason why a codec without a decoder is not shown.
const NOT_DECODED: &str =
    if IN_PAGE { "which neither this page nor this browser decodes" } else { "which needs ffmpeg" };

/// What holds the pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// YUV4MPEG2.
    Y4m,
    /// MP4, QuickTime and their kin.
    Mp4,
    /// Matroska and WebM.
    Matroska,
    /// RIFF AVI.
    Avi,
    /// JPEGs one behind the other, without a container.
    Mjpeg,
    /// Something that ffmpeg may know.
    Other,
}

/// Opens the video in `input`, the file at `path`.
///
/// # Errors
/// One sentence, without the file's name.
pub(crate) fn open(path: &Path, format: Format, mut input: Input, options: &Open) -> Result<Source, Error> {
    if format == Format::Y4m {
        return y4m::open(input, options);
    }
    let track = track(format, &mut input, options);
    if track.as_ref().is_ok_and(|track| track.encrypted) {
        return Err(Error::new("its video is encrypted (copy protection); open an unprotected copy"));
    }
    // A file that our own decoders cannot begin may still be one that the browser has decoded, or that ffmpeg knows.
    let is_known = format != Format::Other;
    track.and_then(|track| decode(input, track)).or_else(|error| match browser::open(path, format, options) {
        Some(source) => source,
        None => ffmpeg::open(path, options, &FfmpegReason { error, is_known }),
    })
}

/// The video track in `input`.
pub(super) fn track(format: Format, input: &mut Input, options: &Open) -> Result<Track, Error> {
    match format {
        Format::Mp4 => mp4::open(input, options),
        Format::Matroska => matroska::open(input, options),
        Format::Avi => avi::open(input, options),
        Format::Mjpeg => mjpeg::open(input, options),
        Format::Y4m => Err(Error::new("its frames are not coded")),
        Format::Other => Err(Error::new("its format is not known")),
    }
}

/// What keeps us from showing a video by ourselves.
struct FfmpegReason {
    error: Error,
    /// Whether the format is known: then the error is the best that can be told, if ffmpeg does not help.
    is_known: bool,
}

/// Whether video that is coded so has a decoder of our own.
#[cfg(target_arch = "wasm32")]
fn is_built_in(codec: &str) -> bool {
    matches!(codec, "h264" | "vp9" | "mjpeg" | "rawvideo")
}

/// The frames of `track` by our own decoders.
fn decode(input: Input, mut track: Track) -> Result<Source, Error> {
    let codec: Box<dyn Codec> = match track.codec.as_str() {
        "h264" => Box::new(H264::new(std::mem::take(&mut track.config), track.colors)?),
        "vp9" => Box::new(Vp9::new(track.colors)),
        "mjpeg" => Box::new(Mjpeg::new(avi::height(&track.config))),
        "rawvideo" => {
            let raw = Raw::new(&track.config)?;
            track.codec = raw.name().into();
            Box::new(raw)
        }
        other => return Err(Error::new(format!("its video is coded as {other}, {NOT_DECODED}"))),
    };
    let mut info = ClipInfo {
        name: input.name().to_owned(),
        width: 0,
        height: 0,
        frames: Some(track.order.len()),
        fps: track.fps,
        container: track.container.into(),
        codec: track.codec.clone(),
        warnings: std::mem::take(&mut track.warnings),
    };
    let mut coded = Coded::new(input, track, codec);
    let (size, warnings) = catch_panic(|| coded.look()).unwrap_or_else(|panic| {
        Err(Error::new(format!("its first picture is damaged{}", reason::bracketed(&panic))))
    })?;
    (info.width, info.height) = size;
    info.warnings.extend(warnings);
    // Container and codec may both tell it.
    let mut told = BTreeSet::new();
    info.warnings.retain(|warning| told.insert(warning.clone()));
    Ok(Source::new(info, coded))
}

/// The greatest common divisor.
fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// The warning about video whose frames are made of two fields.
pub(super) fn interlaced() -> String {
    "interlaced video is shown as whole frames".into()
}

/// The warning about pixels that are not square: `width` to `height`, if both are known.
pub(super) fn pixel_aspect([width, height]: [u64; 2]) -> Option<String> {
    let divisor = gcd(width, height).max(1);
    let [width, height] = [width / divisor, height / divisor];
    let is_square = width == height || width == 0 || height == 0;
    (!is_square).then(|| {
        format!(
            "pixels are meant to be shown {width}:{height} as wide as high and are taken as square, so horizontal and vertical distances differ"
        )
    })
}
