//! Decoding of a single image file of any format.

use std::error::Error as _;
use std::fmt::{self, Display};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::Path;
use std::str::FromStr;

use image::{ColorType, DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use motionscope_core::base::Error;
use motionscope_core::data::Frame;
use motionscope_core::geometry::Grid;

use super::tiff::{self, Page, Paged};
use super::{MAX_AREA_PX, MAX_SIDE_PX, cannot_read, check_size, reason};
use crate::files::File;

/// An image whose header was read but not its pixels.
pub(crate) struct Picture<D> {
    decoder: D,
    upright: image::metadata::Orientation,
    /// `png`, `jpeg` …
    pub codec: &'static str,
    /// Width and height in px, after applying the orientation.
    pub size: (usize, usize),
}

/// How a JPEG begins.
const JPEG: &[u8] = &[0xFF, 0xD8, 0xFF];

/// Reads the header of the picture at `path`.
///
/// # Errors
/// A sentence, without the file's name, if it is no picture or its header claims an impossible size.
pub(crate) fn open(path: &Path) -> Result<Picture<impl ImageDecoder + use<>>, Error> {
    open_page(path, None)
}

/// As [`open`], for the page of a TIFF whose directory is at `page`, or the first.
///
/// # Errors
/// As [`open`].
pub(crate) fn open_page(path: &Path, page: Option<u32>) -> Result<Picture<impl ImageDecoder + use<>>, Error> {
    let mut file = File::open(path).map_err(|e| cannot_read(&e))?;
    if is_cut_jpeg(&mut file).map_err(|e| cannot_read(&e))? {
        return Err(Error::new(CUT_SHORT));
    }
    let unreadable = unreadable(&mut file).map_err(|e| cannot_read(&e))?;
    unreadable.map_or(Ok(()), Err)?;
    read(BufReader::new(Paged::new(file, page).map_err(|e| cannot_read(&e))?))
}

/// Returns width and height in px of the image at `path`, after applying the orientation, from its header.
pub(crate) fn size(path: &Path) -> Option<(usize, usize)> {
    /// A JPEG's decoder reads all it is given, so it is given no more than headers take.
    const HEAD_BYTES: u64 = 64 << 10;
    let mut file = File::open(path).ok()?;
    let mut head = Vec::new();
    file.by_ref().take(HEAD_BYTES).read_to_end(&mut head).ok()?;
    if head.starts_with(JPEG) {
        return read(io::Cursor::new(head)).ok().map(|picture| picture.size);
    }
    file.rewind().ok()?;
    read(BufReader::new(file)).ok().map(|picture| picture.size)
}

/// Whether `file` is a JPEG without an end mark. Its decoder would make up what is missing.
fn is_cut_jpeg(file: &mut File) -> io::Result<bool> {
    /// Some programs append to the picture.
    const TAIL_BYTES: u64 = 64 << 10;
    let mut head = [0; 3];
    let is_jpeg = file.read(&mut head)? == 3 && head == JPEG;
    let mut tail = Vec::new();
    if is_jpeg {
        file.seek(SeekFrom::Start(file.size()?.saturating_sub(TAIL_BYTES)))?;
        file.read_to_end(&mut tail)?;
    }
    file.rewind()?;
    Ok(is_jpeg && !tail.windows(2).any(|mark| mark == [0xFF, 0xD9]))
}

/// The pages of the TIFF at `path` that may be frames, those of the size of the first, and how many others there are. None if it is no
/// TIFF.
pub(crate) fn pages(path: &Path) -> (Vec<Page>, usize) {
    let mut pages = File::open(path).map(|mut file| tiff::pages(&mut file)).unwrap_or_default();
    pages.retain(|page| !page.is_auxiliary);
    let (count, size) = (pages.len(), pages.first().map(|page| page.size));
    pages.retain(|page| Some(page.size) == size);
    let others = count - pages.len();
    (pages, others)
}

/// The error about a variant that the decoders do not know: BigTIFF, floating-point numbers, processes of JPEG.
fn unreadable(file: &mut File) -> io::Result<Option<Error>> {
    /// Enough for thumbnails and colour profiles before the frame header.
    const HEAD_BYTES: u64 = 1 << 20;
    let mut head = Vec::new();
    file.by_ref().take(4).read_to_end(&mut head)?;
    if tiff::is_big(&head) {
        let why = "it is a BigTIFF, which cannot be read; save it as a plain TIFF, or its pages as PNG files";
        return Ok(Some(Error::new(why)));
    }
    if tiff::first_page(file).is_some_and(|page| page.is_float) {
        let why = "its samples are floating-point numbers, which cannot be read; save it with 8 or 16 bits per channel";
        return Ok(Some(Error::new(why)));
    }
    if head.starts_with(JPEG) {
        file.rewind()?;
        head.clear();
        file.by_ref().take(HEAD_BYTES).read_to_end(&mut head)?;
    }
    file.rewind()?;
    Ok(unreadable_process(&head))
}

/// The error about a JPEG coded by a process that its decoder does not know (ITU-T T.81, table B.1).
fn unreadable_process(head: &[u8]) -> Option<Error> {
    let mut rest = head.strip_prefix(&JPEG[..2])?;
    while let [0xFF, marker, high, low, ..] = *rest {
        let process = match marker {
            0xC3 | 0xC7 | 0xCB | 0xCF => "lossless",
            0xC9 | 0xCA | 0xCD | 0xCE => "arithmetic-coded",
            0xC5 | 0xC6 => "hierarchical",
            // The other frame headers, or the first scan: this is what decoders know.
            0xC0..=0xC2 | 0xDA => return None,
            _ => {
                rest = rest.get(2 + usize::from(u16::from_be_bytes([high, low]))..)?;
                continue;
            }
        };
        return Some(Error::new(format!("it is a {process} JPEG, which cannot be read; save it again as PNG")));
    }
    None
}

fn read<'a>(input: impl BufRead + Seek + 'a) -> Result<Picture<impl ImageDecoder + 'a>, Error> {
    let mut reader = ImageReader::new(input).with_guessed_format().map_err(|e| cannot_read(&e))?;
    let codec = reader
        .format()
        .map(codec)
        .ok_or_else(|| Error::new("it holds no readable image; give PNG, JPEG, TIFF, BMP, PNM, WebP or GIF"))?;
    reader.limits(limits(MAX_AREA_PX as u64));
    let mut decoder = reader.into_decoder().map_err(|e| damaged(&e))?;
    let (width, height) = decoder.dimensions();
    check_size(width as usize, height as usize)?;
    decoder.set_limits(limits(decoder.total_bytes())).map_err(|e| damaged(&e))?;
    let upright = decoder.orientation().unwrap_or(image::metadata::Orientation::NoTransforms);
    let size = if turns(upright) { (height, width) } else { (width, height) };
    Ok(Picture { decoder, upright, codec, size: (size.0 as usize, size.1 as usize) })
}

impl<D: ImageDecoder> Picture<D> {
    /// Warnings about changes: reduced bit depth, transparency.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let color = self.decoder.color_type();
        let bits = u16::from(color.bytes_per_pixel()) * 8 / u16::from(color.channel_count());
        let deep = (bits > 8 && !self.is_deep()).then(|| format!("{bits} bits per channel are reduced to 8"));
        let clear = color.has_alpha().then(|| "transparent pixels are shown on black".to_owned());
        deep.into_iter().chain(clear).collect()
    }

    /// Decodes the pixels.
    ///
    /// # Errors
    /// A sentence, without the file's name, if they are damaged.
    pub(crate) fn frame(self, contrast: Contrast) -> Result<Frame, Error> {
        let mut image = DynamicImage::from_decoder(self.decoder).map_err(|e| damaged(&e))?;
        contrast.stretch(&mut image);
        image.apply_orientation(self.upright);
        frame(image)
    }

    /// Whether the samples have 16 bits.
    pub(crate) fn is_deep(&self) -> bool {
        matches!(self.decoder.color_type(), ColorType::L16 | ColorType::La16 | ColorType::Rgb16 | ColorType::Rgba16)
    }

    /// The least and the largest sample, if they have 16 bits.
    ///
    /// # Errors
    /// As [`Picture::frame`].
    pub(crate) fn extremes(self) -> Result<Option<Contrast>, Error> {
        let mut image = DynamicImage::from_decoder(self.decoder).map_err(|e| damaged(&e))?;
        let mut found: Option<Contrast> = None;
        deep_samples(&mut image, |sample| {
            let own = Contrast { low: *sample, high: *sample };
            found = Some(found.map_or(own, |found| found.with(own)));
        });
        Ok(found)
    }
}

/// The range of 16-bit samples that is shown from black to white.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contrast {
    /// The sample that is black.
    pub low: u16,
    /// The sample that is white.
    pub high: u16,
}

impl Default for Contrast {
    fn default() -> Self {
        Self { low: 0, high: u16::MAX }
    }
}

impl FromStr for Contrast {
    type Err = Error;

    /// Parses `LOW..HIGH`, samples from 0 to 65535.
    fn from_str(text: &str) -> Result<Self, Error> {
        let why = || Error::new(format!("the contrast is LOW..HIGH with samples from 0 to 65535, not {text}"));
        let (low, high) = text.split_once("..").ok_or_else(why)?;
        let [low, high] = [low, high].map(|sample| sample.trim().parse::<u16>().map_err(|_| why()));
        let contrast = Self { low: low?, high: high? };
        if contrast.low < contrast.high { Ok(contrast) } else { Err(why()) }
    }
}

impl Display for Contrast {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}..{}", self.low, self.high)
    }
}

impl Contrast {
    /// The range that holds both.
    #[must_use]
    pub(crate) fn with(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// The range to show samples that lie in this one: the bits that they have, or the range itself where it is a smaller part of
    /// them.
    #[must_use]
    pub(crate) fn shown(self) -> Self {
        let bits = u16::BITS - self.high.leading_zeros();
        let full = Self { low: 0, high: u16::MAX >> (u16::BITS - bits.max(8)) };
        let is_most = u32::from(self.high - self.low) * 2 >= u32::from(full.high);
        if is_most || self.high <= 255 || self.high == self.low { full } else { self }
    }

    /// Stretches the range over all 16 bits.
    fn stretch(self, image: &mut DynamicImage) {
        if self != Self::default() {
            let (low, width) = (u32::from(self.low), u32::from(self.high - self.low).max(1));
            deep_samples(image, |sample| {
                let above = u32::from(*sample).saturating_sub(low).min(width);
                *sample = ((u64::from(above) * 65_535 + u64::from(width) / 2) / u64::from(width)).min(65_535) as u16;
            });
        }
    }
}

/// Hands over each 16-bit sample of colours, not of alpha.
fn deep_samples(image: &mut DynamicImage, mut each: impl FnMut(&mut u16)) {
    match image {
        DynamicImage::ImageLuma16(image) => image.iter_mut().for_each(each),
        DynamicImage::ImageRgb16(image) => image.iter_mut().for_each(each),
        DynamicImage::ImageLumaA16(image) => image.pixels_mut().for_each(|pixel| each(&mut pixel.0[0])),
        DynamicImage::ImageRgba16(image) => {
            image.pixels_mut().for_each(|pixel| pixel.0[..3].iter_mut().for_each(&mut each));
        }
        _ => {}
    }
}

/// `image` as a frame: eight bits per channel, on black, in colour where it has any.
pub(crate) fn frame(image: DynamicImage) -> Result<Frame, Error> {
    let (width, height) = (image.width() as usize, image.height() as usize);
    let color = image.color();
    let rgb = |cells| Grid::from_vec(width, height, cells).map(Frame::rgb);
    let gray = |cells| Grid::from_vec(width, height, cells).map(Frame::gray);
    match (color.has_color(), color.has_alpha()) {
        (true, false) => rgb(image.into_rgb8().as_chunks().0.to_vec()),
        (false, false) => gray(image.into_luma8().into_raw()),
        (true, true) => {
            let pixels = image.into_rgba8();
            rgb(pixels.as_chunks().0.iter().map(|&[r, g, b, a]| [r, g, b].map(|c| on_black(c, a))).collect())
        }
        (false, true) => gray(image.into_luma_alpha8().as_chunks().0.iter().map(|&[c, a]| on_black(c, a)).collect()),
    }
}

fn on_black(value: u8, alpha: u8) -> u8 {
    ((u32::from(value) * u32::from(alpha) + 127) / 255).min(255) as u8
}

/// Returns the size and allocation limits for decoding an image of `bytes`.
pub(crate) fn limits(bytes: u64) -> Limits {
    let mut limits = Limits::default();
    limits.max_image_width = u32::try_from(MAX_SIDE_PX).ok();
    limits.max_image_height = u32::try_from(MAX_SIDE_PX).ok();
    // The pixels twice more while they are decoded, and some tables.
    limits.max_alloc = Some(bytes.saturating_mul(3).saturating_add(64 << 20));
    limits
}

/// Says in our words what a decoder found.
pub(crate) fn damaged(error: &ImageError) -> Error {
    Error::new(match error {
        ImageError::Limits(_) => {
            format!(
                "its header claims more than {MAX_SIDE_PX} px a side, so it is damaged or must be scaled down first"
            )
        }
        ImageError::Unsupported(_) => "it uses a rare variant that cannot be read; save it again as a plain PNG".into(),
        ImageError::IoError(e) if e.kind() == io::ErrorKind::UnexpectedEof => CUT_SHORT.into(),
        _ => format!("it is damaged{}; copy it again from its source", words(error)),
    })
}

pub(crate) const CUT_SHORT: &str = "it is cut short; copy it again from its source";

/// The decoder's own words, without those around them.
fn words(error: &ImageError) -> String {
    reason::bracketed(&error.source().map_or_else(|| error.to_string(), ToString::to_string))
}

fn turns(orientation: image::metadata::Orientation) -> bool {
    use image::metadata::Orientation::{Rotate90, Rotate90FlipH, Rotate270, Rotate270FlipH};
    matches!(orientation, Rotate90 | Rotate270 | Rotate90FlipH | Rotate270FlipH)
}

fn codec(format: ImageFormat) -> &'static str {
    match format {
        ImageFormat::Png => "png",
        ImageFormat::Jpeg => "jpeg",
        ImageFormat::Tiff => "tiff",
        ImageFormat::Bmp => "bmp",
        ImageFormat::Pnm => "pnm",
        ImageFormat::WebP => "webp",
        ImageFormat::Gif => "gif",
        _ => "picture",
    }
}
