//! H.264, as MP4 and Matroska hold it: parameter sets apart, units behind their length.

use motionscope_core::base::Error;
use rust_h264::decoder::{ChromaFormat, Decoder, Frame};
use rust_h264::error::DecodeError;
use rust_h264::nal::{NalUnit, NalUnitType, SpsInfo, parse_avcc, parse_avcc_config, parse_sps_info};

use super::coded::Codec;
use super::color::{Chroma, Colors, Matrix, Picture, Yuv};
use super::{pixel_aspect, sps};
use crate::media::{check_size, reason};

/// Most reference frames that the standard allows.
const MAX_REFERENCES: u32 = 16;

/// Decodes H.264 in decoding order.
pub(crate) struct H264 {
    config: Vec<u8>,
    length_size: usize,
    info: SpsInfo,
    /// Width and height of a pixel, as a ratio.
    pixel: Option<[u64; 2]>,
    colors: Colors,
    decoder: Decoder,
}

fn damaged(what: &str) -> Error {
    Error::new(format!("its H.264 data are damaged{}", reason::bracketed(what)))
}

/// The error about a stream that cannot be decoded: a tool of the standard that is not supported is no damage.
fn failed(error: &DecodeError) -> Error {
    match error {
        DecodeError::Unsupported(what) => Error::new(format!("its H.264 uses {what}, which needs ffmpeg")),
        _ => damaged(&error.to_string()),
    }
}

impl H264 {
    /// A decoder for the stream whose `avcC` record is `config`; `colors` is what the container tells of them.
    ///
    /// # Errors
    /// If the record is damaged, or asks for what cannot be decoded here.
    pub(crate) fn new(config: Vec<u8>, colors: Option<(u32, bool)>) -> Result<Self, Error> {
        let record = parse_avcc_config(&config).map_err(damaged)?;
        let unit = record.sps_nals.first().ok_or_else(|| damaged("it has no parameters"))?;
        let info = check_parameters(unit)?;
        let pixel = sps::pixel_aspect(&unit.rbsp);
        let length_size = record.length_size;
        drop(record);
        // What the stream says of its colours goes before what the container says.
        let (matrix, full_range) = match colors {
            Some(container) if info.matrix == 2 => container,
            _ => (u32::from(info.matrix), info.full_range),
        };
        let colors = Colors { matrix: Matrix::from_code(matrix, info.height as usize), full_range };
        Ok(Self { config, length_size, info, pixel, colors, decoder: Decoder::new() })
    }

    fn feed(&mut self, unit: &NalUnit) -> Result<Option<Frame>, Error> {
        if unit.nal_unit_type == NalUnitType::Sps {
            let info = check_parameters(unit)?;
            if (info.width, info.height) != (self.info.width, self.info.height) {
                return Err(Error::new(format!(
                    "the size of its pictures changes to {}×{} px; split it where that happens",
                    info.width, info.height
                )));
            }
        }
        self.decoder.decode_nal(unit).map_err(|error| failed(&error))
    }

    fn picture(&self, frame: Frame) -> Yuv {
        let (width, height) = (frame.width as usize, frame.height as usize);
        let chroma = match (self.info.chroma_format, frame.chroma_format) {
            (0, _) => Chroma::Mono,
            (_, ChromaFormat::Yuv420) => Chroma::Yuv420,
            (_, ChromaFormat::Yuv422) => Chroma::Yuv422,
        };
        let planes = if chroma == Chroma::Mono { [frame.y, vec![], vec![]] } else { [frame.y, frame.u, frame.v] };
        Yuv { width, height, chroma, depth: u32::from(frame.bit_depth), planes, colors: self.colors }
    }
}

impl Codec for H264 {
    fn reset(&mut self) -> Result<(), Error> {
        self.decoder = Decoder::new();
        let config = std::mem::take(&mut self.config);
        let fed = parse_avcc_config(&config).map_err(damaged).and_then(|record| {
            record.sps_nals.iter().chain(&record.pps_nals).try_for_each(|unit| self.feed(unit).map(|_| ()))
        });
        self.config = config;
        fed
    }

    fn decode(&mut self, sample: &[u8]) -> Result<Picture, Error> {
        let mut picture = None;
        for unit in units(sample, self.length_size) {
            for unit in parse_avcc(unit?, self.length_size) {
                picture = self.feed(&unit)?.or(picture);
            }
        }
        // A sample is one whole picture, so there is nothing to wait for.
        let frame = self.decoder.flush().or(picture).ok_or_else(|| damaged("a picture is missing"))?;
        let picture = self.picture(frame);
        if has_gap(&picture) {
            return Err(damaged("a part of this picture is missing"));
        }
        Ok(Picture::Planes(picture))
    }

    fn disposable(&self, sample: &[u8]) -> bool {
        // Two bits of each unit's header tell how much others need it.
        units(sample, self.length_size)
            .all(|unit| unit.ok().and_then(|unit| unit.get(self.length_size)).is_some_and(|header| header & 0x60 == 0))
    }

    fn starts(&self, sample: &[u8]) -> bool {
        units(sample, self.length_size).filter_map(|unit| unit.ok()?.get(self.length_size..)).any(|unit| match unit {
            [header, ..] if NalUnitType::from(header & 0x1F) == NalUnitType::SliceIdr => true,
            [header, payload @ ..] if NalUnitType::from(header & 0x1F) == NalUnitType::Sei => recovers_at_once(payload),
            _ => false,
        })
    }

    fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.info.bit_depth_luma > 8 {
            warnings.push(format!("{} bits per sample are rounded to 8", self.info.bit_depth_luma));
        }
        if !self.info.progressive {
            warnings.push(super::interlaced());
        }
        warnings.extend(self.pixel.and_then(pixel_aspect));
        warnings
    }
}

/// Whether a macroblock of the picture was never decoded: the decoder passes over errors and leaves it at zero, which
/// is a green beyond all that can be shown, in all of its 8×8 chroma samples.
fn has_gap(picture: &Yuv) -> bool {
    const SIDE: usize = 8;
    let [_, u, v] = &picture.planes;
    let bytes = if picture.depth > 8 { 2 } else { 1 };
    let (width, _) = Yuv::plane_sizes(picture.width, picture.height, picture.chroma)[1];
    let stride = width * bytes;
    if stride < SIDE * bytes {
        return false;
    }
    let is_zero = |plane: &[u8], first: usize, x: usize| {
        let rows = plane[first * stride..].chunks_exact(stride).take(SIDE);
        rows.len() == SIDE && rows.into_iter().all(|row| row[x..x + SIDE * bytes].iter().all(|&sample| sample == 0))
    };
    let rows = u.len().min(v.len()) / stride;
    let places =
        (0..rows).step_by(SIDE).flat_map(|y| (0..=stride - SIDE * bytes).step_by(SIDE * bytes).map(move |x| (x, y)));
    places.into_iter().any(|(x, y)| is_zero(u, y, x) && is_zero(v, y, x))
}

/// Refuses parameters that no real stream has before the decoder makes room for them.
fn check_parameters(sps: &NalUnit) -> Result<SpsInfo, Error> {
    let info = parse_sps_info(sps).map_err(|error| failed(&error))?;
    check_size(info.coded_width as usize, info.coded_height as usize)?;
    check_size(info.width as usize, info.height as usize)?;
    if info.width > info.coded_width || info.height > info.coded_height || info.reference_frames > MAX_REFERENCES {
        return Err(damaged("its parameters contradict each other"));
    }
    Ok(info)
}

/// Whether supplemental information says that all pictures shown from here on are right (H.264, D.2.8).
fn recovers_at_once(mut messages: &[u8]) -> bool {
    // Kind and size are written in bytes of 255 and a last smaller one.
    let number = |messages: &mut &[u8]| {
        let full = messages.iter().take_while(|&&byte| byte == 0xFF).count();
        let last = usize::from(*messages.get(full)?);
        *messages = &messages[full + 1..];
        Some(255 * full + last)
    };
    while let Some((kind, size)) = number(&mut messages).zip(number(&mut messages)) {
        let Some((message, rest)) = messages.split_at_checked(size) else { return false };
        // The count of frames until then comes first; a set bit is zero.
        if kind == 6 {
            return message.first().is_some_and(|byte| byte & 0x80 != 0);
        }
        messages = rest;
    }
    false
}

/// The units of `sample`, each with its length in front; an error where one is cut off.
fn units(sample: &[u8], length_size: usize) -> impl Iterator<Item = Result<&[u8], Error>> {
    let mut rest = sample;
    std::iter::from_fn(move || {
        if rest.is_empty() {
            return None;
        }
        let length = rest.get(..length_size).map(|bytes| bytes.iter().fold(0, |sum, &b| sum << 8 | usize::from(b)));
        let unit = length.and_then(|length| rest.split_at_checked(length_size + length));
        rest = unit.map_or(&[], |(_, rest)| rest);
        Some(unit.map(|(unit, _)| unit).ok_or_else(|| damaged("a unit is cut off")))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recovery_point_is_found_among_other_messages() {
        let mut other = vec![5, 0xFF, 3];
        other.resize(3 + 258, 7);
        assert!(recovers_at_once(&[6, 1, 0xC4, 0x80]));
        assert!(recovers_at_once(&[other.as_slice(), &[6, 1, 0xC4, 0x80]].concat()));
        assert!(!recovers_at_once(&[6, 1, 0x44, 0x80]));
        assert!(!recovers_at_once(&other));
        assert!([&[6_u8] as &[u8], &[6, 9, 0xFF], &[0xFF; 9], &[]].iter().all(|bytes| !recovers_at_once(bytes)));
    }

    #[test]
    fn a_tool_that_is_not_supported_is_no_damage() {
        let told = failed(&DecodeError::Unsupported("lossless (transform bypass) coding")).to_string();
        assert!(told.contains("lossless") && told.contains("ffmpeg") && !told.contains("damaged"), "{told}");
        assert!(failed(&DecodeError::InvalidSyntax("not an SPS NAL unit")).to_string().contains("damaged"));
    }

    #[test]
    fn cut_units_are_reported() {
        let whole = [0, 0, 0, 2, 1, 2, 0, 0, 0, 1, 3];
        assert!(units(&whole, 4).all(|unit| unit.is_ok()));
        assert_eq!(units(&whole[..10], 4).filter(Result::is_err).count(), 1);
        assert_eq!(units(&[0xFF; 20], 4).filter(Result::is_err).count(), 1);
    }
}
