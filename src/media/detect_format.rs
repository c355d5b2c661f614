//! Format detection from the first bytes of a file.

use std::path::Path;

use motionscope_core::base::Error;

use super::input::Input;
use super::unsupported;
use super::video::{Format, is_stream};

/// The kind of decoder that a file needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A still image, possibly of a numbered sequence.
    Still,
    /// GIF, animated PNG or animated WebP.
    Animation,
    /// Video, or an unknown format that ffmpeg may decode.
    Video(Format),
}

impl Kind {
    /// Returns the content in words.
    fn words(self) -> &'static str {
        match self {
            Kind::Still => "a picture",
            Kind::Animation => "an animated picture",
            Kind::Video(Format::Y4m) => "Y4M video",
            Kind::Video(Format::Mp4) => "MP4 or QuickTime video",
            Kind::Video(Format::Matroska) => "Matroska or WebM video",
            Kind::Video(Format::Avi) => "AVI video",
            Kind::Video(Format::Mjpeg) => "Motion JPEG video",
            Kind::Video(Format::Other) => "something else",
        }
    }
}

/// Enough to see whether a PNG or a WebP moves, even past its colour profile.
const HEAD_BYTES: u64 = 64 << 10;

/// What `input` holds.
///
/// # Errors
/// A sentence, without the file's name, if it cannot be read, is empty, or is known to be no clip.
pub(crate) fn kind(input: &mut Input) -> Result<Kind, Error> {
    if input.len() == 0 {
        return Err(Error::new("the file is empty; copy it again from its source"));
    }
    let head = input.read_up_to(0, HEAD_BYTES)?;
    match (kind_of(&head), unsupported::refusal(&head)) {
        (Kind::Video(Format::Other), Some(refusal)) => Err(refusal),
        (Kind::Still, _) if is_jpeg(&head) && is_stream(input)? => Ok(Kind::Video(Format::Mjpeg)),
        (kind, _) => Ok(kind),
    }
}

/// What a file holds that begins with `head`.
fn kind_of(head: &[u8]) -> Kind {
    let at = |offset: usize, magic: &[u8]| head.get(offset..).is_some_and(|rest| rest.starts_with(magic));
    if at(0, b"YUV4MPEG2") {
        Kind::Video(Format::Y4m)
    } else if at(0, &[0x1A, 0x45, 0xDF, 0xA3]) {
        Kind::Video(Format::Matroska)
    } else if at(0, b"RIFF") && at(8, b"AVI ") {
        Kind::Video(Format::Avi)
    } else if at(0, b"RIFF") && at(8, b"WEBP") {
        if holds(head, b"ANIM") { Kind::Animation } else { Kind::Still }
    } else if at(0, b"GIF8") {
        Kind::Animation
    } else if at(0, b"\x89PNG\r\n\x1a\n") {
        if holds(head, b"acTL") { Kind::Animation } else { Kind::Still }
    } else if is_jpeg(head) || is_bmp(head) || is_tiff(head) || is_pnm(head) {
        Kind::Still
    } else if is_mp4(head) {
        Kind::Video(Format::Mp4)
    } else {
        Kind::Video(Format::Other)
    }
}

fn holds(head: &[u8], chunk: &[u8; 4]) -> bool {
    head.windows(4).any(|name| name == chunk)
}

fn is_jpeg(head: &[u8]) -> bool {
    head.starts_with(&[0xFF, 0xD8, 0xFF])
}

fn is_bmp(head: &[u8]) -> bool {
    // The header's size follows two reserved words that are zero.
    head.starts_with(b"BM") && head.get(14).is_some_and(|size| matches!(size, 12 | 40 | 52 | 56 | 64 | 108 | 124))
}

fn is_tiff(head: &[u8]) -> bool {
    [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"].iter().any(|magic| head.starts_with(*magic))
}

fn is_pnm(head: &[u8]) -> bool {
    matches!(head, [b'P', b'1'..=b'7', space, ..] if space.is_ascii_whitespace())
}

fn is_mp4(head: &[u8]) -> bool {
    let first_boxes: [&[u8]; 8] = [b"ftyp", b"moov", b"mdat", b"free", b"skip", b"wide", b"styp", b"pnot"];
    head.get(4..8).is_some_and(|name| first_boxes.contains(&name))
}

/// A warning if the name of `path` promises something else than `kind`.
pub(crate) fn mislabelled(path: &Path, kind: Kind) -> Option<String> {
    let extension = path.extension()?.to_str()?.to_ascii_lowercase();
    let promised = match extension.as_str() {
        "y4m" => Kind::Video(Format::Y4m),
        "mp4" | "m4v" | "mov" | "3gp" | "qt" => Kind::Video(Format::Mp4),
        "mkv" | "webm" => Kind::Video(Format::Matroska),
        "avi" => Kind::Video(Format::Avi),
        "gif" => Kind::Animation,
        "mjpeg" | "mjpg" => Kind::Video(Format::Mjpeg),
        "jpg" | "jpeg" | "bmp" | "tif" | "tiff" | "pnm" | "pgm" | "ppm" | "pbm" => Kind::Still,
        // These may move or stand still.
        "png" | "apng" | "webp" if matches!(kind, Kind::Still | Kind::Animation) => kind,
        "png" | "apng" | "webp" => Kind::Still,
        _ => return None,
    };
    (promised != kind).then(|| format!("the file is named .{extension} but holds {}", kind.words()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_decides() {
        let cases: [(&[u8], Kind); 14] = [
            (b"YUV4MPEG2 W2 H2\n", Kind::Video(Format::Y4m)),
            (b"\x1A\x45\xDF\xA3....", Kind::Video(Format::Matroska)),
            (b"RIFF....AVI LIST", Kind::Video(Format::Avi)),
            (b"RIFF....WEBPVP8X..............ANIM", Kind::Animation),
            (b"RIFF....WEBPVP8 ", Kind::Still),
            (b"GIF89a", Kind::Animation),
            (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", Kind::Still),
            (b"\x89PNG\r\n\x1a\n....IHDR....acTL", Kind::Animation),
            (b"\xFF\xD8\xFF\xE0", Kind::Still),
            (b"P5\n2 2\n255\n", Kind::Still),
            (b"\0\0\0\x18ftypisom", Kind::Video(Format::Mp4)),
            (b"\0\0\0\x08wide", Kind::Video(Format::Mp4)),
            (b"PIEH", Kind::Video(Format::Other)),
            (b"x", Kind::Video(Format::Other)),
        ];
        for (head, kind) in cases {
            assert_eq!(kind_of(head), kind, "{head:?}");
        }
    }

    #[test]
    fn a_false_name_is_reported() {
        assert_eq!(mislabelled(Path::new("a.MOV"), Kind::Video(Format::Mp4)), None);
        assert_eq!(mislabelled(Path::new("a.png"), Kind::Animation), None);
        assert_eq!(mislabelled(Path::new("clip"), Kind::Video(Format::Avi)), None);
        let message = mislabelled(Path::new("a.mp4"), Kind::Video(Format::Y4m)).unwrap();
        assert_eq!(message, "the file is named .mp4 but holds Y4M video");
    }
}
