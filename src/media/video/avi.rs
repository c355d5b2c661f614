//! AVI: one walk from chunk to chunk finds the video stream's samples.
//!
//! The walk needs no index, so that interrupted recordings open too; OpenDML's further `RIFF`s are met like the first.

use motionscope_core::Error;

use super::bytes::{Bytes, text};
use super::coded::{MAX_SAMPLES, Sample, Track};
use crate::media::Open;
use crate::media::input::Input;

/// Largest header that is read into memory, in bytes.
const MAX_HEADER_BYTES: u64 = 16 << 20;

/// Finds the video stream.
///
/// # Errors
/// One sentence, without the file's name.
pub(crate) fn open(input: &mut Input, options: &Open) -> Result<Track, Error> {
    let mut found = None;
    let mut chunks = Chunks::default();
    let mut at = 0;
    let mut steps = 0_u32;
    while at + 8 <= input.len() {
        if steps.is_multiple_of(1024) {
            options.report(at as f32 / input.len() as f32)?;
        }
        steps = steps.wrapping_add(1);
        let head = input.read_up_to(at, 12)?;
        let mut bytes = Bytes(&head);
        let (Some(id), Some(size)) = (bytes.tag(), bytes.le32()) else { break };
        let list = matches!(&id, b"RIFF" | b"LIST").then(|| bytes.tag().unwrap_or_default());
        match list.as_ref() {
            // What is inside is met chunk by chunk, whatever size an interrupted recording left here.
            Some(b"AVI " | b"AVIX" | b"movi" | b"rec ") => {
                at += 12;
                continue;
            }
            Some(b"hdrl") if found.is_none() => {
                let header = input.read(at + 12, u64::from(size).saturating_sub(4).min(MAX_HEADER_BYTES))?;
                found = Some(stream(&header)?);
            }
            Some(_) => {}
            None if !id.iter().all(u8::is_ascii_graphic) && !id.ends_with(b" ") => {
                chunks.damaged = true;
                break;
            }
            None => chunks.meet(id, at + 8, size, found.as_ref()),
        }
        // Chunks begin at even places.
        at += 8 + u64::from(size) + u64::from(size & 1);
    }
    let Some((_, mut track)) = found else {
        return Err(Error::new("its header is missing; copy it again from where it came"));
    };
    track.samples = chunks.samples;
    track.order = chunks.order;
    track.drop_lost(input.len())?;
    track.measure_rate();
    if chunks.damaged {
        let count = track.order.len();
        track.warnings.push(format!("the file is damaged; the {count} frames that were found can be used"));
    }
    Ok(track)
}

/// What the walk has met so far.
#[derive(Default)]
struct Chunks {
    samples: Vec<Sample>,
    order: Vec<u32>,
    damaged: bool,
}

impl Chunks {
    fn meet(&mut self, id: [u8; 4], offset: u64, size: u32, stream: Option<&(usize, Track)>) {
        let [tens, ones, b'd', b'b' | b'c'] = id else { return };
        let number = usize::from(tens.wrapping_sub(b'0')) * 10 + usize::from(ones.wrapping_sub(b'0'));
        if stream.is_none_or(|&(ours, _)| ours != number) || self.order.len() >= MAX_SAMPLES {
            return;
        }
        if size > 0 {
            self.samples.push(Sample { offset, size, time: self.order.len() as i64, key: true });
        }
        // An empty chunk shows the picture before it once more.
        if let Some(last) = self.samples.len().checked_sub(1) {
            self.order.push(last as u32);
        }
    }
}

/// The chunks inside `data`; what is malformed ends them.
fn chunks(mut data: &[u8]) -> impl Iterator<Item = ([u8; 4], &[u8])> {
    std::iter::from_fn(move || {
        let mut bytes = Bytes(data);
        let id = bytes.tag()?;
        let size = bytes.le32()? as usize;
        let payload = bytes.take(size)?;
        data = bytes.0.get(size & 1..).unwrap_or_default();
        Some((id, payload))
    })
}

fn find<'a>(data: &'a [u8], wanted: &[u8; 4]) -> Option<&'a [u8]> {
    chunks(data).find(|(id, _)| id == wanted).map(|(_, payload)| payload)
}

/// The first video stream and its number.
fn stream(header: &[u8]) -> Result<(usize, Track), Error> {
    let streams =
        chunks(header).filter_map(|(id, list)| (id == *b"LIST").then(|| list.strip_prefix(b"strl")).flatten());
    for (number, stream) in streams.enumerate() {
        let strh = find(stream, b"strh").unwrap_or_default();
        if !strh.starts_with(b"vids") {
            continue;
        }
        return find(stream, b"strf")
            .and_then(|strf| describe(strh, strf))
            .map(|track| (number, track))
            .ok_or_else(|| Error::new("the header of its video is damaged; copy it again from where it came"));
    }
    Err(Error::new("it holds no video; open a clip with pictures"))
}

/// Rows of a frame out of a `BITMAPINFOHEADER`.
pub(crate) fn height(strf: &[u8]) -> Option<usize> {
    Bytes(strf.get(8..)?).le32().map(|rows| (rows as i32).unsigned_abs() as usize)
}

fn describe(strh: &[u8], strf: &[u8]) -> Option<Track> {
    let mut times = Bytes(strh.get(20..)?);
    let (scale, rate) = (times.le32()?, times.le32()?);
    let compression = Bytes(strf.get(16..)?).tag()?;
    let codec = match &compression.map(|c: u8| c.to_ascii_uppercase()) {
        b"MJPG" | b"AVRN" | b"DMB1" => "mjpeg".into(),
        [0, 0, 0, 0] | b"DIB " | b"RGB " | b"RAW " => "rawvideo".into(),
        b"YUY2" | b"YUYV" | b"UYVY" | b"I420" | b"IYUV" | b"YV12" | b"Y800" | b"GREY" => "rawvideo".into(),
        b"XVID" | b"DIVX" | b"DX50" | b"FMP4" | b"MP4V" => "mpeg4".into(),
        b"H264" | b"X264" | b"AVC1" => "h264 in AVI".into(),
        _ => text(compression).trim().to_owned(),
    };
    Some(Track {
        ticks_per_second: if scale > 0 { f64::from(rate) / f64::from(scale) } else { 0.0 },
        codec,
        config: strf.to_vec(),
        ..Track::default()
    })
}
