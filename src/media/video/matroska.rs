//! Matroska and WebM: one walk from block to block finds the video track's samples.

use std::collections::BTreeSet;

use motionscope_core::base::Error;

use super::bytes::Bytes;
use super::coded::{MAX_SAMPLES, Sample, Track};
use crate::media::Open;
use crate::media::input::Input;

/// Largest header that is read into memory, in bytes.
const MAX_HEADER_BYTES: u64 = 64 << 20;

// Elements, named as in RFC 9559.
const EBML: u32 = 0x1A45_DFA3;
const DOC_TYPE: u32 = 0x4282;
const SEGMENT: u32 = 0x1853_8067;
const INFO: u32 = 0x1549_A966;
const TIMESTAMP_SCALE: u32 = 0x2A_D7B1;
const TRACKS: u32 = 0x1654_AE6B;
const TRACK_ENTRY: u32 = 0xAE;
const TRACK_NUMBER: u32 = 0xD7;
const TRACK_TYPE: u32 = 0x83;
const CODEC_ID: u32 = 0x86;
const CODEC_PRIVATE: u32 = 0x63A2;
const CONTENT_ENCODINGS: u32 = 0x6D80;
const CONTENT_ENCODING: u32 = 0x6240;
const CONTENT_ENCRYPTION: u32 = 0x5035;
const VIDEO: u32 = 0xE0;
const FLAG_INTERLACED: u32 = 0x9A;
const PIXEL_WIDTH: u32 = 0xB0;
const PIXEL_HEIGHT: u32 = 0xBA;
const DISPLAY_WIDTH: u32 = 0x54B0;
const DISPLAY_HEIGHT: u32 = 0x54BA;
const COLOUR: u32 = 0x55B0;
const MATRIX_COEFFICIENTS: u32 = 0x55B1;
const RANGE: u32 = 0x55B9;
const CLUSTER: u32 = 0x1F43_B675;
const TIMESTAMP: u32 = 0xE7;
const SIMPLE_BLOCK: u32 = 0xA3;
const BLOCK_GROUP: u32 = 0xA0;
const BLOCK: u32 = 0xA1;
const REFERENCE_BLOCK: u32 = 0xFB;

/// Finds the video track.
///
/// # Errors
/// One sentence, without the file's name.
pub(crate) fn open(input: &mut Input, options: &Open) -> Result<Track, Error> {
    let mut walk = Walk { scale_ns: 1_000_000, end: u64::MAX, ..Walk::default() };
    let mut at = 0;
    let mut steps = 0_u32;
    while at < input.len() {
        if steps.is_multiple_of(1024) {
            options.report(at as f32 / input.len() as f32)?;
        }
        steps = steps.wrapping_add(1);
        let head = input.read_up_to(at, 12)?;
        let mut bytes = Bytes(&head);
        let Some((id, size)) = element(&mut bytes) else {
            walk.damaged = true;
            break;
        };
        at += (head.len() - bytes.0.len()) as u64;
        match (id, size) {
            // Their elements are met one by one: they may be without an end.
            (SEGMENT, size) => walk.end = at.saturating_add(size.unwrap_or(0)),
            (CLUSTER | BLOCK_GROUP, _) => {}
            (_, Some(size)) => {
                let met = walk.meet(input, id, at, size);
                if met.is_err() && walk.track.is_some() {
                    // What was found before it can be used.
                    walk.damaged = true;
                    break;
                }
                met?;
                at = at.saturating_add(size);
            }
            (_, None) => {
                walk.damaged = true;
                break;
            }
        }
    }
    walk.finish(input)
}

/// Identity and size of the next element; the size is `None` if it is not known.
fn element(bytes: &mut Bytes) -> Option<(u32, Option<u64>)> {
    let first = *bytes.0.first()?;
    let length = first.leading_zeros() as usize + 1;
    if length > 4 {
        return None;
    }
    let id = bytes.take(length)?.iter().fold(0, |id, &byte| id << 8 | u32::from(byte));
    variable(bytes).map(|size| (id, size))
}

/// A number of one to eight bytes, told by the first one's leading zeros; `None` inside if all its bits are set.
fn variable(bytes: &mut Bytes) -> Option<Option<u64>> {
    let first = *bytes.0.first()?;
    let length = first.leading_zeros() as usize + 1;
    if length > 8 {
        return None;
    }
    let raw = bytes.take(length)?.iter().fold(0, |sum: u64, &byte| sum << 8 | u64::from(byte));
    let mask = (1_u64 << (7 * length)) - 1;
    let value = raw & mask;
    Some((value != mask).then_some(value))
}

/// The elements inside `data`; what is malformed ends them.
fn elements(data: &[u8]) -> impl Iterator<Item = (u32, &[u8])> {
    let mut bytes = Bytes(data);
    std::iter::from_fn(move || {
        let (id, size) = element(&mut bytes)?;
        Some((id, bytes.take(usize::try_from(size?).ok()?)?))
    })
}

fn find(data: &[u8], wanted: u32) -> Option<&[u8]> {
    elements(data).find(|&(id, _)| id == wanted).map(|(_, payload)| payload)
}

/// An unsigned number of up to eight bytes.
fn unsigned(payload: &[u8]) -> u64 {
    payload.iter().take(8).fold(0, |sum, &byte| sum << 8 | u64::from(byte))
}

/// What the walk has met so far.
#[derive(Default)]
struct Walk {
    /// Nanoseconds of one tick.
    scale_ns: u64,
    /// The video track and its number.
    track: Option<(u64, Track)>,
    sound: bool,
    webm: bool,
    /// When the cluster begins, in ticks.
    cluster: i64,
    samples: Vec<Sample>,
    /// The samples that only other ones are predicted from.
    hidden: BTreeSet<u32>,
    /// Whether the last block was one of ours.
    ours: bool,
    damaged: bool,
    /// Where the file should end at least, once that is known.
    end: u64,
}

impl Walk {
    fn meet(&mut self, input: &mut Input, id: u32, at: u64, size: u64) -> Result<(), Error> {
        match id {
            EBML => self.webm = find(&header(input, at, size)?, DOC_TYPE).is_some_and(|kind| kind.starts_with(b"webm")),
            INFO => {
                let info = header(input, at, size)?;
                self.scale_ns = find(&info, TIMESTAMP_SCALE).map_or(self.scale_ns, unsigned).max(1);
            }
            TRACKS => {
                let tracks = header(input, at, size)?;
                for (_, entry) in elements(&tracks).filter(|&(id, _)| id == TRACK_ENTRY) {
                    self.enter(entry)?;
                }
            }
            TIMESTAMP => self.cluster = i64::try_from(unsigned(&input.read(at, size.min(8))?)).unwrap_or(i64::MAX / 2),
            SIMPLE_BLOCK | BLOCK => self.block(input, id, at, size)?,
            REFERENCE_BLOCK if self.ours => {
                if let Some(sample) = self.samples.last_mut() {
                    sample.key = false;
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Takes the first video track.
    fn enter(&mut self, entry: &[u8]) -> Result<(), Error> {
        match find(entry, TRACK_TYPE).map(unsigned) {
            Some(1) if self.track.is_none() => {}
            Some(2) => {
                self.sound = true;
                return Ok(());
            }
            _ => return Ok(()),
        }
        let encodings = find(entry, CONTENT_ENCODINGS).unwrap_or_default();
        let encrypted = elements(encodings)
            .any(|(id, encoding)| id == CONTENT_ENCODING && find(encoding, CONTENT_ENCRYPTION).is_some());
        if !encodings.is_empty() && !encrypted {
            return Err(Error::new("its video is packed once more inside the file, which needs ffmpeg"));
        }
        let number = find(entry, TRACK_NUMBER).map_or(0, unsigned);
        let video = find(entry, VIDEO).unwrap_or_default();
        let colour = find(video, COLOUR);
        let colors = colour.map(|colour| {
            let matrix = find(colour, MATRIX_COEFFICIENTS).map_or(2, unsigned);
            (u32::try_from(matrix).unwrap_or(2), find(colour, RANGE).map(unsigned) == Some(2))
        });
        let track = Track {
            codec: codec_name(&String::from_utf8_lossy(find(entry, CODEC_ID).unwrap_or_default())),
            config: find(entry, CODEC_PRIVATE).unwrap_or_default().to_vec(),
            encrypted,
            colors,
            warnings: shape(video),
            ..Track::default()
        };
        self.track = Some((number, track));
        Ok(())
    }

    fn block(&mut self, input: &mut Input, id: u32, at: u64, size: u64) -> Result<(), Error> {
        let head = input.read_up_to(at, size.min(12))?;
        let mut bytes = Bytes(&head);
        let parts = (variable(&mut bytes).flatten(), bytes.be16(), bytes.u8());
        let (Some(number), Some(shift), Some(flags)) = parts else {
            self.damaged = true;
            return Ok(());
        };
        self.ours = self.track.as_ref().is_some_and(|(ours, _)| *ours == number);
        if !self.ours {
            return Ok(());
        }
        let used = (head.len() - bytes.0.len()) as u64;
        let laced = flags & 0x06 != 0;
        let Some(size) = u32::try_from(size - used).ok().filter(|_| !laced && self.samples.len() < MAX_SAMPLES) else {
            self.damaged = true;
            return Ok(());
        };
        // A simple block says itself whether it is a key; another is one unless a reference follows.
        let key = id == BLOCK || flags & 0x80 != 0;
        let time = self.cluster.saturating_add(i64::from(shift as i16));
        // VP8 says in its first byte whether a picture is shown; other codecs put hidden ones into the sample of a shown one.
        if self.track.as_ref().is_some_and(|(_, track)| track.codec == "vp8")
            && bytes.u8().is_some_and(|tag| tag & 0x10 == 0)
        {
            self.hidden.extend(u32::try_from(self.samples.len()));
        }
        self.samples.push(Sample { offset: at + used, size, time, key });
        Ok(())
    }

    fn finish(self, input: &Input) -> Result<Track, Error> {
        let Some((_, mut track)) = self.track else {
            return Err(Error::new(match (self.sound, self.damaged || self.end > input.len()) {
                (true, _) => "it holds sound but no video; open a clip with pictures",
                (false, true) => "it is cut off or damaged before its first frame; copy it again from its source",
                (false, false) => "it holds no video track; open a clip with pictures",
            }));
        };
        track.container = if self.webm { "webm" } else { "matroska" };
        track.ticks_per_second = 1e9 / self.scale_ns as f64;
        track.samples = self.samples;
        track.order_by_time();
        track.order.retain(|sample| !self.hidden.contains(sample));
        track.drop_lost(input.len())?;
        track.measure_rate();
        if self.damaged {
            let count = track.order.len();
            track.warnings.push(format!("the file is damaged; the {count} frames that were found can be used"));
        }
        Ok(track)
    }
}

/// The warnings about fields and about pixels that are not square. The sides of the display may be pixels or a proportion.
fn shape(video: &[u8]) -> Vec<String> {
    let is_interlaced = find(video, FLAG_INTERLACED).map(unsigned) == Some(1);
    let side = |id| find(video, id).map(unsigned);
    let pixel = (|| {
        let (width, height) = (side(PIXEL_WIDTH)?, side(PIXEL_HEIGHT)?);
        let shown = [side(DISPLAY_WIDTH)?.checked_mul(height)?, side(DISPLAY_HEIGHT)?.checked_mul(width)?];
        // A display in pixels is rounded to whole ones, a proportion such as 4:3 is exact.
        let is_in_pixels = 2 * side(DISPLAY_WIDTH)? >= width;
        let is_square = shown[0].abs_diff(shown[1]) <= if is_in_pixels { width.max(height) } else { 0 };
        (!is_square).then_some(shown)
    })();
    let warned = is_interlaced.then(super::interlaced);
    warned.into_iter().chain(pixel.and_then(super::pixel_aspect)).collect()
}

fn header(input: &mut Input, at: u64, size: u64) -> Result<Vec<u8>, Error> {
    if size > MAX_HEADER_BYTES {
        return Err(Error::new("its header claims an impossible length; the file is damaged"));
    }
    input.read(at, size)
}

/// A codec's usual name from Matroska's.
fn codec_name(id: &str) -> String {
    match id.trim_end_matches('\0') {
        "V_MPEG4/ISO/AVC" => "h264".into(),
        "V_MPEGH/ISO/HEVC" => "hevc".into(),
        "V_MPEG4/ISO/ASP" | "V_MPEG4/ISO/SP" => "mpeg4".into(),
        other => other.strip_prefix("V_").unwrap_or(other).to_lowercase(),
    }
}
