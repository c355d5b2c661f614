//! Motion JPEG: a JPEG for each frame, or one for each of its two fields.

use std::borrow::Cow;
use std::io::Cursor;

use image::codecs::jpeg::JpegDecoder;
use image::{DynamicImage, ImageDecoder};
use motionscope_core::base::Error;
use motionscope_core::data::Frame;
use motionscope_core::geometry::Grid;

use super::coded::{Codec, MAX_SAMPLES, Sample, Track};
use super::color::Picture;
use crate::media::input::Input;
use crate::media::{Open, check_size, picture};

/// What a decoder takes as the sign that the standard's Huffman tables are to be used.
const USE_STANDARD_TABLES: [u8; 9] = *b"\xFF\xE0\0\x07AVI1\0";

/// Decodes Motion JPEG.
#[derive(Clone, Debug)]
pub(crate) struct Mjpeg {
    /// Rows of a frame, if the container tells: a picture with half as many is a field.
    height: Option<usize>,
    fields: bool,
}

impl Mjpeg {
    /// A decoder of frames with `height` rows, if that is known.
    pub(crate) fn new(height: Option<usize>) -> Self {
        Self { height, fields: false }
    }
}

impl Codec for Mjpeg {
    fn reset(&mut self) -> Result<(), Error> {
        Ok(())
    }

    fn decode(&mut self, sample: &[u8]) -> Result<Picture, Error> {
        let first = Jpeg::parse(sample).ok_or_else(|| Error::new("it is no JPEG"))?;
        let frame = first.decode(sample)?;
        let rest = sample.get(first.end..).unwrap_or_default();
        let rows = frame.size().1;
        let second = match (self.height, Jpeg::parse(rest)) {
            (Some(height), Some(second)) if height.div_ceil(2) == rows && height > rows => second.decode(rest)?,
            _ => return Ok(Picture::Ready(frame)),
        };
        self.fields = true;
        weave(&frame, &second).map(Picture::Ready)
    }

    fn starts(&self, _sample: &[u8]) -> bool {
        true
    }

    fn warnings(&self) -> Vec<String> {
        self.fields.then(super::interlaced).into_iter().collect()
    }
}

/// The rows of `top` and `bottom` by turns.
fn weave(top: &Frame, bottom: &Frame) -> Result<Frame, Error> {
    let (width, rows) = top.size();
    if bottom.size() != (width, rows) {
        return Err(Error::new("its two fields have different sizes"));
    }
    let field = |y: usize| if y.is_multiple_of(2) { top } else { bottom };
    Ok(match (top.color(), bottom.color()) {
        (Some(a), Some(b)) => Frame::rgb(Grid::from_fn(width, 2 * rows, |x, y| [a, b][y % 2][(x, y / 2)])),
        _ => Frame::gray(Grid::from_fn(width, 2 * rows, |x, y| field(y).luma()[(x, y / 2)])),
    })
}

/// Bytes that are read at once to find the end of a JPEG; doubled until it is found.
const CHUNK_BYTES: u64 = 1 << 18;
/// Largest JPEG of a stream, in bytes.
const LARGEST_BYTES: u64 = 64 << 20;

/// Whether a file that begins with a JPEG goes on with another one right behind it, and is no stereo picture.
///
/// # Errors
/// If it cannot be read.
pub(crate) fn is_stream(input: &mut Input) -> Result<bool, Error> {
    let Some(first) = jpeg_at(input, 0)? else { return Ok(false) };
    // Pictures of several lenses (MPO) hold JPEGs one behind the other as well.
    let is_stereo = input.read_up_to(0, CHUNK_BYTES)?.windows(4).any(|tag| tag == b"MPF\0");
    Ok(!is_stereo && input.read_up_to(u64::from(first.size), 3)?.starts_with(&[0xFF, 0xD8, 0xFF]))
}

/// The JPEG that begins at `offset`, if one does and is whole.
fn jpeg_at(input: &mut Input, offset: u64) -> Result<Option<Sample>, Error> {
    let mut count = CHUNK_BYTES;
    loop {
        let data = input.read_up_to(offset, count)?;
        if !data.starts_with(&[0xFF, 0xD8, 0xFF]) {
            return Ok(None);
        }
        let end = Jpeg::parse(&data).map(|jpeg| jpeg.end).filter(|end| data[..*end].ends_with(&[0xFF, 0xD9]));
        if let Some(size) = end.and_then(|end| u32::try_from(end).ok()) {
            return Ok(Some(Sample { offset, size, time: 0, key: true }));
        }
        if (data.len() as u64) < count || count >= LARGEST_BYTES {
            return Ok(None);
        }
        count *= 2;
    }
}

/// The pictures of a stream without a container, whose rate is not known.
///
/// # Errors
/// If it cannot be read, or is stopped.
pub(crate) fn open(input: &mut Input, options: &Open) -> Result<Track, Error> {
    let mut track = Track { container: "mjpeg", codec: "mjpeg".into(), ..Track::default() };
    let mut offset = 0;
    while let Some(sample) = jpeg_at(input, offset)?.filter(|_| track.samples.len() < MAX_SAMPLES) {
        options.report(offset as f32 / input.len() as f32)?;
        offset += u64::from(sample.size);
        track.samples.push(Sample { time: track.samples.len() as i64, ..sample });
    }
    let left = input.len() - offset;
    if left > 0 {
        track.warnings.push(format!("the last {left} bytes are no whole picture and are left out"));
    }
    track.order_by_time();
    Ok(track)
}

/// Where the parts of a JPEG lie.
struct Jpeg {
    start: usize,
    end: usize,
    has_tables: bool,
}

impl Jpeg {
    /// Follows the markers from the first picture's start to its end.
    fn parse(data: &[u8]) -> Option<Self> {
        let start = data.windows(3).position(|bytes| bytes == [0xFF, 0xD8, 0xFF])?;
        let mut at = start + 2;
        let mut has_tables = false;
        loop {
            let Some(&[0xFF, marker]) = data.get(at..).and_then(<[u8]>::first_chunk::<2>) else {
                // Entropy-coded data, or rubbish: on to the next marker.
                let skipped = data.get(at..)?.windows(2).position(|pair| pair[0] == 0xFF && is_marker(pair[1]));
                at = match skipped {
                    Some(skipped) => at + skipped,
                    None => return Some(Self { start, end: data.len(), has_tables }),
                };
                continue;
            };
            match marker {
                0xD9 => return Some(Self { start, end: at + 2, has_tables }),
                0xFF => at += 1,
                0x00 | 0x01 | 0xD0..=0xD8 => at += 2,
                _ => {
                    has_tables |= marker == 0xC4;
                    let length = data.get(at + 2..at + 4)?;
                    at += 2 + usize::from(u16::from_be_bytes([length[0], length[1]]));
                }
            }
        }
    }

    fn decode(&self, data: &[u8]) -> Result<Frame, Error> {
        let whole = &data[self.start..self.end];
        let whole = if self.has_tables {
            Cow::Borrowed(whole)
        } else {
            // AVI leaves the tables out where they are the standard's.
            Cow::Owned([&whole[..2], &USE_STANDARD_TABLES, &whole[2..]].concat())
        };
        let mut decoder = JpegDecoder::new(Cursor::new(whole)).map_err(|error| picture::damaged(&error))?;
        let (width, height) = decoder.dimensions();
        check_size(width as usize, height as usize)?;
        let limits = picture::limits(decoder.total_bytes());
        decoder.set_limits(limits).map_err(|error| picture::damaged(&error))?;
        let image = DynamicImage::from_decoder(decoder).map_err(|error| picture::damaged(&error))?;
        picture::frame(image)
    }
}

/// Whether `byte` after 0xFF is a marker inside or after entropy-coded data.
fn is_marker(byte: u8) -> bool {
    !matches!(byte, 0x00 | 0xD0..=0xD7 | 0xFF)
}

#[cfg(test)]
mod tests {
    use image::codecs::jpeg::JpegEncoder;

    use super::*;

    /// A smooth picture as a JPEG with the standard's tables.
    fn jpeg(width: u32, height: u32, shift: u32) -> Vec<u8> {
        let picture =
            image::RgbImage::from_fn(width, height, |x, y| image::Rgb([(x * 3 + shift) as u8, (y * 4) as u8, 90]));
        let mut bytes = Vec::new();
        JpegEncoder::new_with_quality(&mut bytes, 90).encode_image(&picture).unwrap();
        bytes
    }

    #[test]
    fn pictures_one_behind_the_other_are_a_clip() {
        let all = [jpeg(32, 24, 0), jpeg(32, 24, 5), jpeg(32, 24, 9)];
        let mut cut = all.concat();
        cut.truncate(cut.len() - 20);
        let stereo = {
            let (head, rest) = all[0].split_at(2);
            [head, b"\xFF\xE2\0\x06MPF\0", rest, &all[1]].concat()
        };
        let open = |bytes: Vec<u8>| {
            let mut input = Input::memory("a.mjpeg".into(), bytes);
            (is_stream(&mut input).unwrap(), open(&mut input, &Open::default()).unwrap())
        };
        let (is_clip, track) = open(all.concat());
        assert!(is_clip && track.warnings.is_empty());
        let sizes: Vec<_> = track.samples.iter().map(|sample| sample.size as usize).collect();
        assert_eq!(sizes, all.each_ref().map(Vec::len));
        let (is_clip, track) = open(cut);
        assert!(is_clip && track.samples.len() == 2 && track.warnings[0].contains("no whole picture"));
        assert!(!open(all[0].clone()).0 && !open(stereo).0, "a picture, and one for each eye");
    }

    /// The same without its Huffman tables.
    fn without_tables(jpeg: &[u8]) -> Vec<u8> {
        let mut out = jpeg[..2].to_vec();
        let mut at = 2;
        while jpeg[at + 1] != 0xDA {
            let end = at + 2 + usize::from(u16::from_be_bytes([jpeg[at + 2], jpeg[at + 3]]));
            if jpeg[at + 1] != 0xC4 {
                out.extend(&jpeg[at..end]);
            }
            at = end;
        }
        out.extend(&jpeg[at..]);
        out
    }

    fn decode(height: usize, sample: &[u8]) -> Frame {
        Mjpeg::new(Some(height)).decode(sample).and_then(Picture::into_frame).unwrap()
    }

    #[test]
    fn missing_tables_are_the_standards() {
        let whole = jpeg(40, 24, 0);
        let bare = without_tables(&whole);
        assert!(bare.len() + 400 < whole.len());
        assert_eq!(decode(24, &bare), decode(24, &whole));
    }

    #[test]
    fn two_fields_make_a_frame() {
        let (top, bottom) = (jpeg(40, 24, 0), jpeg(40, 24, 60));
        let mut codec = Mjpeg::new(Some(48));
        let woven = codec.decode(&[top.as_slice(), &[0; 7], &bottom].concat()).and_then(Picture::into_frame).unwrap();
        assert_eq!(woven.size(), (40, 48));
        let (top, bottom) = (decode(24, &top), decode(24, &bottom));
        assert!((0..24).all(|y| woven.luma().row(2 * y) == top.luma().row(y)));
        assert!((0..24).all(|y| woven.luma().row(2 * y + 1) == bottom.luma().row(y)));
        assert_eq!(codec.warnings().len(), 1);
    }
}
