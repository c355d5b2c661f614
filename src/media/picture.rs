//! Decoding of a single image file of any format.

use std::error::Error as _;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};
use motionscope_core::{Error, Frame, Grid};

use super::{MAX_AREA_PX, MAX_SIDE_PX, cannot_read, check_size, reason};

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
    let mut file = File::open(path).map_err(|e| cannot_read(&e))?;
    if is_cut_jpeg(&mut file).map_err(|e| cannot_read(&e))? {
        return Err(Error::new(CUT_SHORT));
    }
    read(BufReader::new(file))
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
        file.seek(SeekFrom::Start(file.metadata()?.len().saturating_sub(TAIL_BYTES)))?;
        file.read_to_end(&mut tail)?;
    }
    file.rewind()?;
    Ok(is_jpeg && !tail.windows(2).any(|mark| mark == [0xFF, 0xD9]))
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
        let deep = (bits > 8).then(|| format!("{bits} bits per channel are reduced to 8"));
        let clear = color.has_alpha().then(|| "transparent pixels are shown on black".to_owned());
        deep.into_iter().chain(clear).collect()
    }

    /// Decodes the pixels.
    ///
    /// # Errors
    /// A sentence, without the file's name, if they are damaged.
    pub(crate) fn frame(self) -> Result<Frame, Error> {
        let mut image = DynamicImage::from_decoder(self.decoder).map_err(|e| damaged(&e))?;
        image.apply_orientation(self.upright);
        frame(image)
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
    ((u32::from(value) * u32::from(alpha) + 127) / 255) as u8
}

/// Returns the size and allocation limits for decoding an image of `bytes`.
pub(crate) fn limits(bytes: u64) -> Limits {
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE_PX as u32);
    limits.max_image_height = Some(MAX_SIDE_PX as u32);
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
