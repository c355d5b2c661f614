//! Uncompressed video as AVI holds it, behind Windows' `BITMAPINFOHEADER`.

use motionscope_core::base::Error;
use motionscope_core::data::Frame;
use motionscope_core::geometry::Grid;

use super::bytes::{Bytes, text};
use super::coded::Codec;
use super::color::{Chroma, Colors, Matrix, Picture, Yuv};
use crate::media::check_size;

/// How the samples of a pixel lie in memory.
#[derive(Clone, Debug, PartialEq)]
enum Layout {
    /// An index into a table of colours.
    Palette(Vec<[u8; 3]>),
    /// Five bits each of red, green and blue, little-endian.
    Rgb555,
    /// Blue, green, red, and as many bytes more.
    Bgr(usize),
    /// Luma alone.
    Gray,
    /// Planes of luma, then U, V; or V, U.
    Yuv420 { v_first: bool },
    /// Two pixels in four bytes, luma first or second.
    Yuv422 { luma: usize },
}

/// Unpacks uncompressed pictures.
#[derive(Clone, Debug)]
pub(crate) struct Raw {
    width: usize,
    height: usize,
    layout: Layout,
    bottom_up: bool,
}

impl Raw {
    /// Pictures as `header`, a `BITMAPINFOHEADER` and its palette, describes them.
    ///
    /// # Errors
    /// If it is damaged or describes a layout that is not known.
    pub(crate) fn new(header: &[u8]) -> Result<Self, Error> {
        Self::parse(header).unwrap_or_else(|| Err(Error::new("the header of its video is damaged; copy it again")))
    }

    fn parse(header: &[u8]) -> Option<Result<Self, Error>> {
        let mut bytes = Bytes(header);
        let header_bytes = bytes.le32()? as usize;
        let (width, height) = (bytes.le32()?, bytes.le32()? as i32);
        bytes.le16()?;
        let bits = bytes.le16()?;
        let compression = bytes.tag()?.map(|c| c.to_ascii_uppercase());
        let (width, rows) = (width as usize, height.unsigned_abs() as usize);
        if let Err(error) = check_size(width, rows) {
            return Some(Err(error));
        }
        let mut bottom_up = false;
        let layout = match &compression {
            [0, 0, 0, 0] | b"DIB " | b"RGB " | b"RAW " => {
                bottom_up = height > 0;
                match bits {
                    8 => Layout::Palette(palette(header.get(header_bytes..).unwrap_or_default())),
                    16 => Layout::Rgb555,
                    24 => Layout::Bgr(0),
                    32 => Layout::Bgr(1),
                    _ => {
                        return Some(Err(Error::new(format!("its uncompressed pixels of {bits} bits need ffmpeg"))));
                    }
                }
            }
            b"Y800" | b"GREY" => Layout::Gray,
            b"I420" | b"IYUV" => Layout::Yuv420 { v_first: false },
            b"YV12" => Layout::Yuv420 { v_first: true },
            b"YUY2" | b"YUYV" => Layout::Yuv422 { luma: 0 },
            b"UYVY" => Layout::Yuv422 { luma: 1 },
            other => {
                return Some(Err(Error::new(format!("its uncompressed pixels {} need ffmpeg", text(*other)))));
            }
        };
        Some(Ok(Self { width, height: rows, layout, bottom_up }))
    }

    /// The layout's usual name.
    pub(crate) fn name(&self) -> &'static str {
        match self.layout {
            Layout::Palette(_) => "pal8",
            Layout::Rgb555 => "rgb555",
            Layout::Bgr(0) => "bgr24",
            Layout::Bgr(_) => "bgr32",
            Layout::Gray => "gray",
            Layout::Yuv420 { .. } => "yuv420p",
            Layout::Yuv422 { luma: 0 } => "yuyv422",
            Layout::Yuv422 { .. } => "uyvy422",
        }
    }

    /// Bytes from one row to the next, and of all rows.
    fn bytes(&self) -> (usize, usize) {
        let row = match self.layout {
            Layout::Palette(_) => self.width.next_multiple_of(4),
            Layout::Rgb555 => (2 * self.width).next_multiple_of(4),
            Layout::Bgr(more) => ((3 + more) * self.width).next_multiple_of(4),
            Layout::Gray | Layout::Yuv420 { .. } => self.width,
            Layout::Yuv422 { .. } => self.width.div_ceil(2) * 4,
        };
        let chroma = match self.layout {
            Layout::Yuv420 { .. } => 2 * self.width.div_ceil(2) * self.height.div_ceil(2),
            _ => 0,
        };
        (row, row * self.height + chroma)
    }

    /// A grid of what `pixel` makes of a row's bytes at a column.
    fn grid<T>(&self, sample: &[u8], mut pixel: impl FnMut(&[u8], usize) -> T) -> Grid<T> {
        let (row, _) = self.bytes();
        Grid::from_fn(self.width, self.height, |x, y| {
            let y = if self.bottom_up { self.height - 1 - y } else { y };
            pixel(&sample[y * row..], x)
        })
    }

    fn yuv(&self, chroma: Chroma, planes: [Vec<u8>; 3]) -> Picture {
        let colors = Colors { matrix: Matrix::by_height(self.height), full_range: false };
        Picture::Planes(Yuv { width: self.width, height: self.height, chroma, depth: 8, planes, colors })
    }
}

impl Codec for Raw {
    fn reset(&mut self) -> Result<(), Error> {
        Ok(())
    }

    fn decode(&mut self, sample: &[u8]) -> Result<Picture, Error> {
        let (row, all) = self.bytes();
        if sample.len() < all {
            return Err(Error::new(format!("it has {} bytes where {all} are needed", sample.len())));
        }
        let ready = match &self.layout {
            Layout::Palette(colors) if colors.iter().all(|[r, g, b]| r == g && g == b) => {
                Frame::gray(self.grid(sample, |row, x| colors[usize::from(row[x])][0]))
            }
            Layout::Palette(colors) => Frame::rgb(self.grid(sample, |row, x| colors[usize::from(row[x])])),
            Layout::Rgb555 => {
                Frame::rgb(self.grid(sample, |row, x| wide(u16::from_le_bytes([row[2 * x], row[2 * x + 1]]))))
            }
            Layout::Bgr(more) => Frame::rgb(self.grid(sample, |row, x| {
                let at = (3 + more) * x;
                [row[at + 2], row[at + 1], row[at]]
            })),
            Layout::Gray => Frame::gray(self.grid(sample, |row, x| row[x])),
            Layout::Yuv420 { v_first } => {
                let (luma, chroma) = sample[..all].split_at(self.width * self.height);
                let (first, second) = chroma.split_at(chroma.len() / 2);
                let (u, v) = if *v_first { (second, first) } else { (first, second) };
                return Ok(self.yuv(Chroma::Yuv420, [luma.to_vec(), u.to_vec(), v.to_vec()]));
            }
            Layout::Yuv422 { luma } => {
                let half = self.width.div_ceil(2);
                let every = |width: usize, step: usize, first: usize| {
                    Grid::from_fn(width, self.height, |x, y| sample[y * row + step * x + first]).into_cells()
                };
                let planes = [every(self.width, 2, *luma), every(half, 4, 1 - luma), every(half, 4, 3 - luma)];
                return Ok(self.yuv(Chroma::Yuv422, planes));
            }
        };
        Ok(Picture::Ready(ready))
    }

    fn starts(&self, _sample: &[u8]) -> bool {
        true
    }

    fn warnings(&self) -> Vec<String> {
        Vec::new()
    }
}

/// Five bits each, widened to eight.
fn wide(pixel: u16) -> [u8; 3] {
    [10, 5, 0].map(|shift| {
        let five = (pixel >> shift & 31) as u8;
        five << 3 | five >> 2
    })
}

/// 256 colours; the ones that are not told are gray.
fn palette(table: &[u8]) -> Vec<[u8; 3]> {
    let mut colors: Vec<_> = (0..=255).map(|v| [v; 3]).collect();
    for (color, entry) in colors.iter_mut().zip(table.chunks_exact(4)) {
        *color = [entry[2], entry[1], entry[0]];
    }
    colors
}
