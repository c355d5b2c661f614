//! VP9.

use motionscope_core::base::Error;
use rusty_vp9::{BitReader, DecodedFrame, FrameHeader, Vp9Decoder, parse_uncompressed_header};

use super::coded::Codec;
use super::color::{Chroma, Colors, Matrix, Picture, Yuv};
use crate::media::{check_size, reason};

/// Decodes VP9.
pub(crate) struct Vp9 {
    decoder: Vp9Decoder,
    /// Size of the first picture, in pixels: the references of the following ones have it too.
    size: (usize, usize),
    depth: u32,
    colors: Option<Colors>,
    container: Option<(u32, bool)>,
}

fn damaged(what: &str) -> Error {
    Error::new(format!("its VP9 data are damaged{}", reason::bracketed(what)))
}

impl Vp9 {
    /// A decoder; `container` is what the container says of the colours.
    pub(crate) fn new(container: Option<(u32, bool)>) -> Self {
        Self { decoder: Vp9Decoder::new(), size: (0, 0), depth: 8, colors: None, container }
    }

    /// Refuses sizes that no picture can have before the decoder makes room for them.
    fn check(&mut self, sample: &[u8]) -> Result<(), Error> {
        let side = |side| u32::try_from(side).unwrap_or(u32::MAX);
        let known = [(side(self.size.0), side(self.size.1)); 8];
        for frame in frames(sample) {
            let header = parse_uncompressed_header(&mut BitReader::new(frame), &known)
                .map_err(|error| damaged(&error.to_string()))?;
            if header.show_existing_frame {
                continue;
            }
            let size = (header.width as usize, header.height as usize);
            check_size(size.0, size.1)?;
            if self.size == (0, 0) {
                self.size = size;
            }
            if size != self.size {
                return Err(Error::new(format!(
                    "the size of its pictures changes to {}×{} px; split it where that happens",
                    size.0, size.1
                )));
            }
            if header.key_frame {
                self.colors = Some(self.colors_of(&header));
                self.depth = header.bit_depth;
            }
        }
        Ok(())
    }

    fn colors_of(&self, header: &FrameHeader) -> Colors {
        let height = header.height as usize;
        let full_range = self.container.is_some_and(|(_, full)| full);
        // VP9's own numbers: 2 is BT.709, 5 BT.2020, 7 RGB, 0 unknown.
        let matrix = match header.color_space {
            1 | 3 | 4 => Matrix::Bt601,
            2 => Matrix::Bt709,
            5 => Matrix::Bt2020,
            7 => Matrix::Identity,
            _ => Matrix::from_code(self.container.filter(|&(code, _)| code != 0).map_or(2, |(code, _)| code), height),
        };
        Colors { matrix, full_range }
    }

    fn picture(&self, frame: DecodedFrame) -> Result<Yuv, Error> {
        let chroma = match (frame.subsampling_x, frame.subsampling_y) {
            (1, 1) => Chroma::Yuv420,
            (1, 0) => Chroma::Yuv422,
            (0, 1) => Chroma::Yuv440,
            _ => Chroma::Yuv444,
        };
        let (width, height) = (frame.width as usize, frame.height as usize);
        let default = Colors { matrix: Matrix::by_height(height), full_range: false };
        let planes = frame.planes.try_into().map_err(|_| damaged("a plane is missing"))?;
        Ok(Yuv { width, height, chroma, depth: frame.bit_depth, planes, colors: self.colors.unwrap_or(default) })
    }
}

impl Codec for Vp9 {
    fn reset(&mut self) -> Result<(), Error> {
        *self = Self::new(self.container);
        Ok(())
    }

    fn decode(&mut self, sample: &[u8]) -> Result<Picture, Error> {
        self.check(sample)?;
        self.decoder.push(sample, None).map_err(|error| damaged(&error.to_string()))?;
        let mut shown = None;
        // A sample may hold pictures that are not shown beside the one that is.
        for _ in frames(sample) {
            match self.decoder.next_frame() {
                Ok(frame) => shown = Some(frame),
                Err(rusty_vp9::Error::Again) => {}
                Err(error) => return Err(damaged(&error.to_string())),
            }
        }
        self.picture(shown.ok_or_else(|| damaged("a picture is missing"))?).map(Picture::Planes)
    }

    fn starts(&self, sample: &[u8]) -> bool {
        key_header(sample).is_ok()
    }

    fn warnings(&self) -> Vec<String> {
        let deep = (self.depth > 8).then(|| format!("{} bits per sample are rounded to 8", self.depth));
        deep.into_iter().collect()
    }
}

/// The header of the first picture of `sample`, if it is a key frame.
fn key_header(sample: &[u8]) -> Result<FrameHeader, Error> {
    let first = frames(sample).into_iter().next().unwrap_or_default();
    parse_uncompressed_header(&mut BitReader::new(first), &[(0, 0); 8])
        .map_err(|error| damaged(&error.to_string()))
        .and_then(
            |header| if header.key_frame { Ok(header) } else { Err(damaged("its first picture is no key frame")) },
        )
}

/// The coded pictures in `sample`, split by the index at its end (VP9 specification, annex B).
fn frames(sample: &[u8]) -> Vec<&[u8]> {
    split(sample).unwrap_or_else(|| vec![sample])
}

fn split(sample: &[u8]) -> Option<Vec<&[u8]>> {
    let marker = *sample.last().filter(|&last| last & 0xE0 == 0xC0)?;
    let count = usize::from(marker & 7) + 1;
    let width = usize::from(marker >> 3 & 3) + 1;
    let (mut coded, index) = sample.split_at_checked(sample.len().checked_sub(2 + width * count)?)?;
    if index.first() != Some(&marker) {
        return None;
    }
    let mut frames = Vec::new();
    for size in index[1..index.len() - 1].chunks_exact(width) {
        let size = size.iter().rev().fold(0, |sum, &byte| sum << 8 | usize::from(byte));
        let (frame, rest) = coded.split_at_checked(size)?;
        frames.push(frame);
        coded = rest;
    }
    Some(frames)
}
