//! Y4M (YUV4MPEG2): uncompressed planes behind a line of text.
//!
//! Frame headers may have parameters of their own, so the file is walked once from header to header; after that any
//! frame is one read away.

use motionscope_core::base::{Error, Stop};
use motionscope_core::data::{ClipInfo, Frame};

use super::color::{Chroma, Colors, Matrix, Yuv};
use crate::media::input::Input;
use crate::media::{Decoder, Open, Source, check_size};

/// Longest header line that is believed, in bytes.
pub(crate) const MAX_LINE_BYTES: u64 = 4096;

/// Tag X of our own files with the matrix, as ISO/IEC 23091-2 numbers it.
pub(crate) const MATRIX: &str = "MATRIX=";

/// Opens Y4M video.
///
/// # Errors
/// One sentence, without the file's name.
pub(crate) fn open(mut input: Input, options: &Open) -> Result<Source, Error> {
    let line = read_line(&mut input, 0)?.ok_or_else(|| Error::new("its first line has no end; it is not Y4M video"))?;
    let header = Header::parse(&line)?;
    check_size(header.width, header.height)?;
    let mut warnings = header.warnings();
    let offsets = walk(&mut input, line.len() as u64 + 1, header.frame_bytes(), options, &mut warnings)?;
    let info = ClipInfo {
        name: input.name().to_owned(),
        width: header.width,
        height: header.height,
        frames: Some(offsets.len()),
        fps: header.fps,
        container: "y4m".into(),
        codec: header.chroma.name(header.depth),
        warnings,
    };
    Ok(Source::new(info, Y4m { input, header, offsets }))
}

struct Y4m {
    input: Input,
    header: Header,
    /// Where the samples of each frame begin.
    offsets: Vec<u64>,
}

impl Decoder for Y4m {
    fn decode(&mut self, index: usize, _stop: &Stop, keep: &mut dyn FnMut(usize, Frame)) -> Result<(), Error> {
        let Some(&offset) = self.offsets.get(index) else { return Ok(()) };
        let bytes = self.input.read(offset, self.header.frame_bytes())?;
        keep(index, self.header.frame(bytes)?);
        Ok(())
    }
}

/// What the first line tells of every frame.
#[derive(Clone, Debug)]
pub(crate) struct Header {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Frames per second, if it tells.
    pub fps: Option<f64>,
    chroma: Chroma,
    depth: u32,
    alpha: bool,
    interlaced: bool,
    /// Width and height of a pixel, in proportion.
    pixel: [u64; 2],
    colors: Colors,
}

impl Header {
    /// The header in the first line of a stream.
    ///
    /// # Errors
    /// If it does not tell the size, or its colour space is not known.
    pub(crate) fn parse(line: &[u8]) -> Result<Self, Error> {
        let text = String::from_utf8_lossy(line);
        let mut width = None;
        let mut height = None;
        let mut fps = None;
        let mut space = "420";
        let mut interlaced = false;
        let mut pixel = [1, 1];
        let mut full_range = None;
        let mut matrix = None;
        for token in text.split_ascii_whitespace().skip(1) {
            let Some((tag, value)) = token.split_at_checked(1) else { continue };
            match tag {
                "W" => width = value.parse().ok(),
                "H" => height = value.parse().ok(),
                "F" => fps = ratio(value),
                "I" => interlaced = matches!(value, "t" | "b" | "m"),
                "A" => {
                    pixel = value
                        .split_once(':')
                        .and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]))
                        .unwrap_or(pixel)
                }
                "C" => space = value,
                "X" => {
                    full_range = full_range.or(range(value));
                    matrix = matrix.or(value.strip_prefix(MATRIX).and_then(|code| code.parse().ok()));
                }
                _ => {}
            }
        }
        let (Some(width), Some(height)) = (width, height) else {
            return Err(Error::new("its first line does not tell width and height; it is damaged"));
        };
        let (chroma, depth, alpha) = color_space(space).ok_or_else(|| {
            Error::new(format!(
                "its colour space {space} is not known; convert it with `ffmpeg -i IN -pix_fmt yuv420p OUT.y4m`"
            ))
        })?;
        // Gray is full range unless it says otherwise, colour is not.
        let full_range = full_range.unwrap_or(chroma == Chroma::Mono);
        let matrix = matrix.map_or(Matrix::by_height(height), |code| Matrix::from_code(code, height));
        let colors = Colors { matrix, full_range };
        Ok(Self { width, height, fps, chroma, depth, alpha, interlaced, pixel, colors })
    }

    /// The frame whose samples are `bytes`.
    ///
    /// # Errors
    /// If there are not as many as the size needs.
    pub(crate) fn frame(&self, mut bytes: Vec<u8>) -> Result<Frame, Error> {
        let Header { width, height, chroma, depth, colors, .. } = *self;
        let sizes = Yuv::plane_sizes(width, height, chroma);
        let [luma, small, _] = sizes.map(|(w, h)| w * h * depth.div_ceil(8) as usize);
        if bytes.len() < luma + 2 * small {
            return Err(Error::new("a frame of it is cut off"));
        }
        // Alpha, if any, comes last and is left out.
        bytes.truncate(luma + 2 * small);
        let v = bytes.split_off(luma + small);
        let u = bytes.split_off(luma);
        Yuv { width, height, chroma, depth, planes: [bytes, u, v], colors }.into_frame()
    }

    /// Bytes of the samples of a frame.
    pub(crate) fn frame_bytes(&self) -> u64 {
        let [luma, u, v] = Yuv::plane_sizes(self.width, self.height, self.chroma).map(|(w, h)| (w * h) as u64);
        let samples = luma + u + v + if self.alpha { luma } else { 0 };
        samples * u64::from(self.depth.div_ceil(8))
    }

    fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.depth > 8 {
            warnings.push(format!("{} bits per sample are rounded to 8", self.depth));
        }
        if self.interlaced {
            warnings.push(super::interlaced());
        }
        warnings.extend(super::pixel_aspect(self.pixel));
        warnings
    }
}

/// Layout, bits per sample and whether alpha follows, from the value of tag C.
fn color_space(name: &str) -> Option<(Chroma, u32, bool)> {
    let (chroma, rest) = if let Some(rest) = name.strip_prefix("mono") {
        (Chroma::Mono, rest)
    } else {
        let (chroma, rest) = name.split_at_checked(3)?;
        let chroma = match chroma {
            "420" => Chroma::Yuv420,
            "411" => Chroma::Yuv411,
            "422" => Chroma::Yuv422,
            "440" => Chroma::Yuv440,
            "444" => Chroma::Yuv444,
            _ => return None,
        };
        (chroma, rest)
    };
    match rest {
        // Where chroma lies between the luma samples does not show at 8-bit pixels.
        "" | "jpeg" | "mpeg2" | "paldv" => Some((chroma, 8, false)),
        "alpha" if chroma == Chroma::Yuv444 => Some((chroma, 8, true)),
        _ => {
            let depth = rest.trim_start_matches('p').parse().ok()?;
            matches!(depth, 9 | 10 | 12 | 14 | 16).then_some((chroma, depth, false))
        }
    }
}

/// Whether values are full range, from the value of tag X.
fn range(value: &str) -> Option<bool> {
    match value {
        "COLORRANGE=FULL" => Some(true),
        "COLORRANGE=LIMITED" => Some(false),
        _ => None,
    }
}

/// `30000:1001` as a number; `None` if it is unknown (`0:0`).
fn ratio(value: &str) -> Option<f64> {
    let (n, d) = value.split_once(':')?;
    let (n, d): (u32, u32) = (n.parse().ok()?, d.parse().ok()?);
    (n > 0 && d > 0).then(|| f64::from(n) / f64::from(d))
}

/// The line that begins at `offset`, without its end; `None` if it has no end.
fn read_line(input: &mut Input, offset: u64) -> Result<Option<Vec<u8>>, Error> {
    // Frame headers are short; only odd ones need the long read.
    for bytes in [64, MAX_LINE_BYTES] {
        let mut head = input.read_up_to(offset, bytes)?;
        if let Some(end) = head.iter().position(|&byte| byte == b'\n') {
            head.truncate(end);
            return Ok(Some(head));
        }
    }
    Ok(None)
}

/// Where the samples of each frame begin. A damaged tail is left out and told.
fn walk(
    input: &mut Input,
    start: u64,
    frame_bytes: u64,
    options: &Open,
    warnings: &mut Vec<String>,
) -> Result<Vec<u64>, Error> {
    let mut offsets = Vec::new();
    let mut at = start;
    let lost = loop {
        if at >= input.len() {
            break None;
        }
        if offsets.len() % 1024 == 0 {
            options.report(at as f32 / input.len() as f32)?;
        }
        let Some(line) = read_line(input, at)?.filter(|line| line.starts_with(b"FRAME")) else {
            break Some("does not begin as a frame should");
        };
        let samples = at + line.len() as u64 + 1;
        let Some(end) = samples.checked_add(frame_bytes).filter(|&end| end <= input.len()) else {
            break Some("is cut off");
        };
        offsets.push(samples);
        at = end;
    };
    match lost {
        Some(how) if offsets.is_empty() => Err(Error::new(format!(
            "its first frame {how}, so there is nothing to show; copy it again from its source"
        ))),
        None if offsets.is_empty() => Err(Error::new("it has a header but no frames; copy it again from its source")),
        Some(how) => {
            warnings.push(format!("frame {} {how}; it and what follows are left out", offsets.len()));
            Ok(offsets)
        }
        None => Ok(offsets),
    }
}

#[cfg(test)]
mod tests {
    use motionscope_core::geometry::Grid;
    use proptest::prelude::*;

    use super::*;

    fn read(bytes: Vec<u8>) -> Result<(ClipInfo, Vec<Frame>), Error> {
        let mut source = open(Input::memory("test.y4m".into(), bytes), &Open::default())?;
        let count = source.info.frames.unwrap();
        let mut frames = Vec::new();
        // Backwards: any frame must be one read away.
        for index in (0..count).rev() {
            source.decoder.decode(index, &Stop::default(), &mut |at, frame| {
                assert_eq!(at, index);
                frames.push(frame);
            })?;
        }
        frames.reverse();
        Ok((source.info, frames))
    }

    /// Frames of luma `50 + t`, neutral chroma, in the given colour space.
    fn file(header: &str, size: (usize, usize), space: &str, frames: usize) -> Vec<u8> {
        let (chroma, depth, alpha) = color_space(space).unwrap();
        let mut bytes = format!("YUV4MPEG2 W{} H{} {header} C{space}\n", size.0, size.1).into_bytes();
        for t in 0..frames {
            bytes.extend(if t % 2 == 1 { b"FRAME Ip XREMARK\n".as_slice() } else { b"FRAME\n" });
            let [luma, u, v] = Yuv::plane_sizes(size.0, size.1, chroma).map(|(w, h)| w * h);
            let mut put = |value: usize, count: usize| {
                for _ in 0..count {
                    let sample = ((value as u16) << (depth - 8)).to_le_bytes();
                    bytes.extend(&sample[..if depth > 8 { 2 } else { 1 }]);
                }
            };
            put(50 + t, luma);
            put(128, u + v);
            put(255, if alpha { luma } else { 0 });
        }
        bytes
    }

    #[test]
    fn every_colour_space_and_odd_size() {
        let spaces = [
            "mono", "mono10", "mono12", "mono16", "420jpeg", "420mpeg2", "420paldv", "420", "420p10", "420p12", "411",
            "422", "422p10", "440", "444", "444p10", "444p16", "444alpha",
        ];
        for space in spaces {
            for size in [(1, 1), (7, 5), (16, 8)] {
                let (info, frames) = read(file("F30:1 Ip XCOLORRANGE=FULL", size, space, 3)).unwrap();
                assert_eq!((info.width, info.height, info.frames), (size.0, size.1, Some(3)), "{space}");
                for (t, frame) in frames.iter().enumerate() {
                    assert_eq!(frame.luma(), &Grid::new(size.0, size.1, 50 + t as u8), "{space} {size:?}");
                    assert_eq!(frame.color().is_some(), !space.starts_with("mono"));
                }
                let deep =
                    space.contains('p') && !space.contains("peg") && !space.contains("alpha") && space != "420paldv"
                        || space.starts_with("mono1");
                assert_eq!(info.warnings.iter().any(|w| w.contains("rounded to 8")), deep, "{space}");
            }
        }
    }

    #[test]
    fn facts_come_from_the_header() {
        let (info, _) = read(file("F30000:1001 It A1:1", (4, 4), "420p10", 1)).unwrap();
        assert_eq!((info.container.as_str(), info.codec.as_str()), ("y4m", "yuv420p10"));
        assert!((info.fps.unwrap() - 29.97).abs() < 0.001);
        assert_eq!(info.warnings, ["10 bits per sample are rounded to 8", "interlaced video is shown as whole frames"]);
        let (info, frames) = read(file("F0:0", (4, 4), "420", 1)).unwrap();
        assert_eq!(info.fps, None);
        // 50 in limited range.
        assert_eq!(frames[0].luma()[(0, 0)], 40);
    }

    #[test]
    fn a_cut_tail_is_reported_and_the_rest_stays() {
        let whole = file("", (8, 8), "420", 3);
        let (info, frames) = read(whole[..whole.len() - 5].to_vec()).unwrap();
        assert_eq!((info.frames, frames.len()), (Some(2), 2));
        assert!(info.warnings[0].contains("frame 2 is cut off"));
        let mut broken = whole;
        let third = broken.len() - 96 - 6;
        broken[third] = b'G';
        assert!(read(broken).unwrap().0.warnings[0].contains("frame 2 does not begin"));
    }

    #[test]
    fn hostile_headers_are_refused() {
        let cases = [
            ("YUV4MPEG2 W100000 H100000\nFRAME\n", "100000×100000"),
            ("YUV4MPEG2 W16384 H16384\nFRAME\n", "128 megapixels"),
            ("YUV4MPEG2 W0 H5\nFRAME\n", "shows nothing"),
            ("YUV4MPEG2 W4294967296 H99999999999999999999\nFRAME\n", "does not tell"),
            ("YUV4MPEG2 H5\nFRAME\n", "does not tell"),
            ("YUV4MPEG2 W4 H4 C999\nFRAME\n", "999"),
            ("YUV4MPEG2 W4 H4", "no end"),
            ("YUV4MPEG2 W4 H4\n", "no frames"),
            ("YUV4MPEG2 W4 H4\nFRAME\nabc", "cut off"),
        ];
        for (bytes, why) in cases {
            let message = read(bytes.into()).unwrap_err().to_string();
            assert!(message.contains(why), "{bytes}: {message}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        #[test]
        fn damage_never_panics(flips in prop::collection::vec((0_usize..900, any::<u8>()), 1..8), cut in 0_usize..900) {
            let mut bytes = file("F25:1 Ip", (16, 16), "420", 2);
            for (at, value) in flips {
                let len = bytes.len();
                bytes[at % len.min(120)] = value;
            }
            bytes.truncate(cut.max(1));
            if let Ok((info, frames)) = read(bytes) {
                prop_assert_eq!(info.frames, Some(frames.len()));
            }
        }
    }
}
