//! MP4 and QuickTime: boxes, and the video track in them.

use motionscope_core::base::Error;

use super::bytes::{Bytes, text};
use super::coded::Track;
use super::mp4_boxes::{box_header, boxes, find};
use super::mp4_samples::{Fragment, Table};
use super::turn::Turn;
use crate::media::Open;
use crate::media::input::Input;

/// Largest index that is read into memory, in bytes.
const MAX_INDEX_BYTES: u64 = 1 << 30;

/// Finds the video track.
///
/// # Errors
/// One sentence, without the file's name.
pub(crate) fn open(input: &mut Input, options: &Open) -> Result<Track, Error> {
    let (moov, fragments) = read_index(input, options)?;
    let video = video_track(&moov)?;
    let mut track = video.describe();
    // QuickTime has a brand of its own; its oldest files have none.
    let head = input.read_up_to(0, 12)?;
    track.container = if head.get(4..8) == Some(b"ftyp") && !head.ends_with(b"qt  ") { "mp4" } else { "mov" };
    let mut table = Table::default();
    table.read(video.stbl)?;
    let movie_ticks = find(&moov, b"mvhd").and_then(timescale).unwrap_or(0);
    let defaults = find(&moov, b"mvex").and_then(|mvex| default_fragment(mvex, video.id)).unwrap_or_default();
    for (start, moof) in &fragments {
        table.read_fragment(*start, moof, video.id, defaults)?;
    }
    track.samples = table.samples;
    track.order_by_time();
    table_edits(&mut track, &video, movie_ticks);
    track.drop_lost(input.len())?;
    track.measure_rate();
    Ok(track)
}

/// The `moov` box, and the `moof` boxes with their places.
type Index = (Vec<u8>, Vec<(u64, Vec<u8>)>);

fn read_index(input: &mut Input, options: &Open) -> Result<Index, Error> {
    let mut moov = None;
    let mut fragments = Vec::new();
    let mut held = 0;
    let mut at = 0;
    while at < input.len() {
        options.report(at as f32 / input.len() as f32)?;
        let head = input.read_up_to(at, 16)?;
        let Some((kind, header, size)) = box_header(&head) else { break };
        let size = if size == 0 { input.len() - at } else { size };
        let whole = at.checked_add(size).is_some_and(|end| end <= input.len());
        if matches!(&kind, b"moov" | b"moof") && whole && size >= header {
            held += size;
            if held > MAX_INDEX_BYTES {
                return Err(Error::new("its index claims more than a gigabyte; the file is damaged"));
            }
            let payload = input.read(at + header, size - header)?;
            if kind == *b"moof" { fragments.push((at, payload)) } else { moov = moov.or(Some(payload)) }
        }
        if size < header {
            break;
        }
        at = at.saturating_add(size);
    }
    let moov = moov.ok_or_else(|| {
        Error::new(
            "its index (the moov box) is missing, as when a recording or a copy was interrupted; copy it again, or \
             repair it with the program that recorded it",
        )
    })?;
    Ok((moov, fragments))
}

/// The boxes of the video track that matter.
struct Video<'a> {
    id: u32,
    ticks: u32,
    tkhd: &'a [u8],
    stbl: &'a [u8],
    edits: Option<&'a [u8]>,
    kind: [u8; 4],
    entry: &'a [u8],
}

fn video_track(moov: &[u8]) -> Result<Video<'_>, Error> {
    let mut sound = false;
    for (_, trak) in boxes(moov).filter(|(kind, _)| kind == b"trak") {
        let Some(mdia) = find(trak, b"mdia") else { continue };
        match find(mdia, b"hdlr").and_then(|hdlr| hdlr.get(8..12)) {
            Some(b"vide") => {
                return video(trak, mdia)
                    .ok_or_else(|| Error::new("the index of its video track is damaged; copy it again"));
            }
            Some(b"soun") => sound = true,
            _ => {}
        }
    }
    Err(Error::new(if sound {
        "it holds sound but no video; open a clip with pictures"
    } else {
        "it holds no video track; open a clip with pictures"
    }))
}

fn video<'a>(trak: &'a [u8], mdia: &'a [u8]) -> Option<Video<'a>> {
    let tkhd = find(trak, b"tkhd")?;
    let stbl = find(find(mdia, b"minf")?, b"stbl")?;
    // A sample description: version and flags, count, then boxes.
    let (kind, entry) = boxes(find(stbl, b"stsd")?.get(8..)?).next()?;
    let id_at = if tkhd.first() == Some(&1) { 20 } else { 12 };
    Some(Video {
        id: Bytes(tkhd.get(id_at..)?).be32()?,
        ticks: timescale(find(mdia, b"mdhd")?)?,
        tkhd,
        stbl,
        edits: find(trak, b"edts").and_then(|edts| find(edts, b"elst")),
        kind,
        entry,
    })
}

/// Ticks per second out of an `mdhd` or `mvhd` box.
fn timescale(header: &[u8]) -> Option<u32> {
    let at = if header.first() == Some(&1) { 20 } else { 12 };
    Bytes(header.get(at..)?).be32()
}

impl Video<'_> {
    /// The track without its samples.
    fn describe(&self) -> Track {
        let children = self.entry.get(78..).unwrap_or_default();
        let config = [b"avcC", b"hvcC", b"av1C"].into_iter().find_map(|kind| find(children, kind));
        let mut warnings = Vec::new();
        let turn = self.turn().unwrap_or_else(|| {
            warnings.push("it is to be shown turned by an odd angle or skewed; it is shown as recorded".into());
            Turn::default()
        });
        let pixel = find(children, b"pasp").and_then(|pasp| {
            let mut sides = Bytes(pasp);
            Some([sides.be32()?, sides.be32()?].map(u64::from))
        });
        warnings.extend(pixel.and_then(super::pixel_aspect));
        // QuickTime's field handling: two fields.
        warnings.extend(find(children, b"fiel").filter(|fiel| fiel.first() == Some(&2)).map(|_| super::interlaced()));
        Track {
            ticks_per_second: f64::from(self.ticks),
            encrypted: self.kind == *b"encv",
            codec: codec_name(self.kind),
            config: config.unwrap_or_default().to_vec(),
            turn,
            colors: find(children, b"colr").and_then(colors),
            warnings,
            ..Track::default()
        }
    }

    fn turn(&self) -> Option<Turn> {
        let at = if self.tkhd.first() == Some(&1) { 52 } else { 40 };
        let mut bytes = Bytes(self.tkhd.get(at..).unwrap_or_default());
        let mut matrix = [0; 9];
        for value in &mut matrix {
            *value = bytes.be32().unwrap_or(0) as i32;
        }
        let [a, b, _, c, d, ..] = matrix;
        // Some writers leave the matrix empty.
        if matrix == [0; 9] { Some(Turn::default()) } else { Turn::from_matrix([a, b, c, d]) }
    }
}

/// The matrix code and range of a `colr` box.
fn colors(colr: &[u8]) -> Option<(u32, bool)> {
    let mut bytes = Bytes(colr);
    let kind = bytes.tag()?;
    bytes.take(4)?;
    let matrix = u32::from(bytes.be16()?);
    match &kind {
        b"nclx" => Some((matrix, bytes.u8()? & 0x80 != 0)),
        b"nclc" => Some((matrix, false)),
        _ => None,
    }
}

/// A codec's usual name from its sample description.
fn codec_name(kind: [u8; 4]) -> String {
    match &kind {
        b"avc1" | b"avc3" => "h264".into(),
        b"vp09" => "vp9".into(),
        b"vp08" => "vp8".into(),
        b"hvc1" | b"hev1" => "hevc".into(),
        b"av01" => "av1".into(),
        b"mp4v" => "mpeg4".into(),
        b"jpeg" | b"mjpa" => "mjpeg".into(),
        b"apcn" | b"apch" | b"apcs" | b"apco" | b"ap4h" | b"ap4x" => "prores".into(),
        _ => text(kind).trim().to_owned(),
    }
}

fn default_fragment(mvex: &[u8], id: u32) -> Option<Fragment> {
    boxes(mvex).filter(|(kind, _)| kind == b"trex").find_map(|(_, trex)| {
        let mut bytes = Bytes(trex.get(4..)?);
        let own = bytes.be32()? == id;
        bytes.be32()?;
        let fragment = Fragment { duration: bytes.be32()?, size: bytes.be32()?, flags: bytes.be32()? };
        own.then_some(fragment)
    })
}

/// Shows what the edit list says; one that leaves nothing is not believed.
fn table_edits(track: &mut Track, video: &Video, movie_ticks: u32) {
    let edits = video.edits.map(|elst| read_edits(elst, video.ticks, movie_ticks)).unwrap_or_default();
    if edits.is_empty() {
        return;
    }
    let mut order = Vec::new();
    for (start, end) in edits {
        // The pictures stand in the order of their times, so that many edits cost little.
        let before = |time: i64| track.order.partition_point(|&s| track.samples[s as usize].time < time);
        order.extend(track.order.get(before(start)..before(end)).unwrap_or_default());
        if order.len() > super::coded::MAX_SAMPLES {
            order.clear();
            break;
        }
    }
    if order.is_empty() {
        track.warnings.push("its edit list leaves no frame and is not heeded".into());
    } else {
        track.order = order;
    }
}

/// From and to when each edit shows the track, in its ticks.
fn read_edits(elst: &[u8], ticks: u32, movie_ticks: u32) -> Vec<(i64, i64)> {
    let mut bytes = Bytes(elst);
    let long = bytes.u8() == Some(1);
    bytes.take(3);
    let count = bytes.be32().unwrap_or(0);
    let mut edits = Vec::new();
    for _ in 0..count {
        let (duration, start) = if long {
            (bytes.be64(), bytes.be64().map(|v| v as i64))
        } else {
            (bytes.be32().map(u64::from), bytes.be32().map(|v| i64::from(v as i32)))
        };
        let (Some(duration), Some(start), Some(_rate)) = (duration, start, bytes.be32()) else { break };
        // An empty edit shows nothing for a while: a pause is no frame.
        if start < 0 {
            continue;
        }
        let scaled = u128::from(duration) * u128::from(ticks);
        let length = (scaled + u128::from(movie_ticks) / 2).checked_div(u128::from(movie_ticks)).unwrap_or(0);
        let length = i64::try_from(length).unwrap_or(i64::MAX);
        // Without a length, as in fragmented files, the edit lasts to the end.
        edits.push((start, if length == 0 { i64::MAX } else { start.saturating_add(length) }));
    }
    edits
}
