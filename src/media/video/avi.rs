//! AVI: one walk from chunk to chunk finds the video stream's samples.
//!
//! The walk needs no index, so that interrupted recordings open too; OpenDML's further `RIFF`s are met like the first.

use motionscope_core::base::Error;

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
        return Err(Error::new("its header is missing; copy it again from its source"));
    };
    track.samples = chunks.samples;
    track.order = chunks.order;
    track.drop_lost(input.len())?;
    track.fps = (track.ticks_per_second > 0.0).then_some(track.ticks_per_second);
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
        let last = self.samples.len().checked_sub(1).and_then(|last| u32::try_from(last).ok());
        self.order.extend(last);
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
            .map(|track| Track { warnings: shape(find(stream, b"vprp").unwrap_or_default()), ..track })
            .map(|track| (number, track))
            .ok_or_else(|| Error::new("the header of its video is damaged; copy it again from its source"));
    }
    Err(Error::new("it holds no video; open a clip with pictures"))
}

/// The warnings about fields and about pixels that are not square in a video properties header (OpenDML 1.02, 5.0).
fn shape(vprp: &[u8]) -> Vec<String> {
    let mut properties = Bytes(vprp.get(20..).unwrap_or_default());
    let mut number = || properties.le32().map_or(0, u64::from);
    let (shape, width, height, fields) = (number(), number(), number(), number());
    // The shape of the frame: its width in the upper half, its height in the lower one.
    let pixel = super::pixel_aspect([(shape >> 16) * height, (shape & 0xFFFF) * width]);
    (fields == 2).then(super::interlaced).into_iter().chain(pixel).collect()
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
        container: "avi",
        codec,
        config: strf.to_vec(),
        ..Track::default()
    })
}

#[cfg(test)]
mod tests {
    use motionscope_core::data::{ClipInfo, Frame};

    use super::*;
    use crate::media::video;

    fn chunk(id: &[u8; 4], payload: &[u8]) -> Vec<u8> {
        let mut bytes = id.to_vec();
        bytes.extend((payload.len() as u32).to_le_bytes());
        bytes.extend(payload);
        bytes.resize(bytes.len().next_multiple_of(2), 0);
        bytes
    }

    fn list(id: &[u8; 4], kind: &[u8; 4], parts: &[Vec<u8>]) -> Vec<u8> {
        chunk(id, &[kind.as_slice(), &parts.concat()].concat())
    }

    /// A header for 25 frames per second; sound is stream 0, video stream 1.
    fn header(size: (i32, i32), bits: u16, compression: &[u8; 4], palette: &[u8]) -> Vec<u8> {
        let numbers = |numbers: &[u32]| numbers.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<_>>();
        let strh = [b"vids".to_vec(), compression.to_vec(), numbers(&[0, 0, 0, 1, 25, 0, 9, 0, 0, 0])].concat();
        let mut strf = numbers(&[40, size.0 as u32, size.1 as u32]);
        strf.extend([1_u16.to_le_bytes(), bits.to_le_bytes()].concat());
        strf.extend(compression);
        strf.extend(numbers(&[0, 0, 0, 0, 0]));
        strf.extend(palette);
        let sound = list(b"LIST", b"strl", &[chunk(b"strh", b"auds"), chunk(b"strf", b"")]);
        let video = list(b"LIST", b"strl", &[chunk(b"strh", &strh), chunk(b"strf", &strf)]);
        list(b"LIST", b"hdrl", &[chunk(b"avih", &[0; 56]), sound, video])
    }

    fn file(header: Vec<u8>, chunks: &[Vec<u8>]) -> Vec<u8> {
        list(b"RIFF", b"AVI ", &[header, list(b"LIST", b"movi", chunks)])
    }

    fn read(bytes: Vec<u8>) -> Result<(ClipInfo, Vec<Frame>), Error> {
        let options = Open { ffmpeg: false, ..Open::default() };
        let input = Input::memory("test.avi".into(), bytes);
        let mut source = video::open("test.avi".as_ref(), video::Format::Avi, input, &options)?;
        let mut frames = Vec::new();
        for index in (0..source.info.frames.unwrap()).rev() {
            source.decoder.decode(index, &motionscope_core::base::Stop::default(), &mut |at, frame| {
                assert_eq!(at, index);
                frames.insert(0, frame);
            })?;
        }
        Ok((source.info, frames))
    }

    #[test]
    fn bitmaps_lie_either_way_up() {
        // Three pixels a row: red, green, blue over black, white, gray; rows are padded to four bytes.
        let top = [0, 0, 255, 0, 255, 0, 255, 0, 0, 0, 0, 0];
        let bottom = [0, 0, 0, 255, 255, 255, 100, 100, 100, 0, 0, 0];
        let expected = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [0; 3], [255; 3], [100; 3]];
        for (height, rows) in [(2, [bottom, top]), (-2, [top, bottom])] {
            let avi =
                file(header((3, height), 24, &[0; 4], &[]), &[chunk(b"00wb", b"hi!"), chunk(b"01db", &rows.concat())]);
            let (info, frames) = read(avi).unwrap();
            assert_eq!((info.width, info.height, info.frames, info.fps), (3, 2, Some(1), Some(25.0)));
            assert_eq!((info.container.as_str(), info.codec.as_str()), ("avi", "bgr24"));
            assert_eq!(frames[0].color().unwrap().cells(), expected);
        }
    }

    #[test]
    fn every_layout_is_unpacked() {
        /// Compression, bits per pixel, bytes, name of the codec, gray values.
        type Case = (&'static [u8; 4], u16, &'static [u8], &'static str, [u8; 2]);
        let cases: [Case; 9] = [
            (&[0; 4], 8, &[10, 20, 0, 0], "pal8", [10, 20]),
            (&[0; 4], 16, &[0xFF, 0x7F, 0, 0], "rgb555", [255, 0]),
            (&[0; 4], 32, &[7, 7, 7, 0, 9, 9, 9, 0], "bgr32", [7, 9]),
            (b"Y800", 8, &[3, 4], "gray", [3, 4]),
            (b"I420", 12, &[235, 16, 128, 128], "yuv420p", [255, 0]),
            (b"YV12", 12, &[235, 16, 128, 128], "yuv420p", [255, 0]),
            (b"YUY2", 16, &[235, 128, 16, 128], "yuyv422", [255, 0]),
            (b"UYVY", 16, &[128, 235, 128, 16], "uyvy422", [255, 0]),
            (b"yuy2", 16, &[235, 128, 16, 128], "yuyv422", [255, 0]),
        ];
        for (compression, bits, sample, name, luma) in cases {
            let (info, frames) = read(file(header((2, 1), bits, compression, &[]), &[chunk(b"01dc", sample)])).unwrap();
            assert_eq!((info.codec.as_str(), frames[0].luma().cells()), (name, luma.as_slice()));
        }
    }

    #[test]
    fn a_palette_colours() {
        let palette = [0, 0, 200, 0, 0, 150, 0, 0];
        let (_, frames) = read(file(header((2, 1), 8, &[0; 4], &palette), &[chunk(b"01db", &[0, 1, 0, 0])])).unwrap();
        assert_eq!(frames[0].color().unwrap().cells(), [[200, 0, 0], [0, 150, 0]]);
    }

    fn gray(value: u8) -> Vec<u8> {
        chunk(b"01db", &[value; 16])
    }

    fn values(frames: &[Frame]) -> Vec<u8> {
        frames.iter().map(|frame| frame.luma()[(0, 0)]).collect()
    }

    #[test]
    fn dropped_frames_repeat_and_further_riffs_go_on() {
        let head = header((4, 4), 8, b"Y800", &[]);
        let index = chunk(b"idx1", &[0; 32]);
        let group = list(b"LIST", b"rec ", &[gray(2), chunk(b"00wb", b"sound")]);
        let mut avi = file(head, &[gray(1), chunk(b"01db", b""), group, index]);
        avi.extend(list(b"RIFF", b"AVIX", &[list(b"LIST", b"movi", &[gray(3), chunk(b"ix01", b"xx")])]));
        let (info, frames) = read(avi).unwrap();
        assert_eq!((values(&frames), info.fps), (vec![1, 1, 2, 3], Some(25.0)));
        assert!(info.warnings.is_empty(), "{:?}", info.warnings);
    }

    #[test]
    fn an_interrupted_recording_keeps_its_frames() {
        let avi = file(header((4, 4), 8, b"Y800", &[]), &[gray(1), gray(2), gray(3)]);
        let (info, frames) = read(avi[..avi.len() - 3].to_vec()).unwrap();
        assert_eq!(values(&frames), [1, 2]);
        assert!(info.warnings[0].contains("1 of 3 frames are left out"), "{:?}", info.warnings);
        let mut torn = avi;
        let third = torn.len() - 24;
        torn[third..third + 4].copy_from_slice(&[0, 1, 2, 3]);
        let (info, frames) = read(torn).unwrap();
        assert_eq!(values(&frames), [1, 2]);
        assert!(info.warnings[0].contains("2 frames that were found"), "{:?}", info.warnings);
    }

    #[test]
    fn hostile_headers_are_refused() {
        let one = [gray(1)];
        let cases = [
            (header((0, 4), 8, b"Y800", &[]), "shows nothing"),
            (header((70_000, 70_000), 8, b"Y800", &[]), "70000×70000"),
            (header((4, i32::MIN), 8, b"Y800", &[]), "2147483648"),
            (header((400, 400), 8, b"Y800", &[]), "160000 are needed"),
            (header((4, 4), 7, &[0; 4], &[]), "7 bits"),
            (header((4, 4), 24, b"cvid", &[]), "cvid"),
            (list(b"LIST", b"hdrl", &[chunk(b"avih", &[0; 56])]), "no video"),
            (vec![], "header is missing"),
        ];
        for (header, why) in cases {
            let message = read(file(header, &one)).unwrap_err().to_string();
            assert!(message.contains(why), "{why}: {message}");
        }
    }

    #[test]
    fn the_shape_of_pixels_and_fields_is_read() {
        // A frame of 8:3 in 64×48 px, of two fields.
        let header = |shape: u32, fields: u32| {
            let numbers = [0, 0, 25, 64, 48, shape, 64, 48, fields];
            numbers.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>()
        };
        let wide = header(8 << 16 | 3, 2);
        assert_eq!(shape(&wide), [super::super::interlaced(), super::super::pixel_aspect([2, 1]).unwrap()]);
        assert!(shape(&header(4 << 16 | 3, 1)).is_empty() && shape(&header(0, 0)).is_empty());
        assert!(shape(&wide[..30]).is_empty() && shape(&[]).is_empty());
    }
}
