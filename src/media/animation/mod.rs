//! Animated GIF, PNG and WebP: composed pictures, one after the other.

mod gif;
mod scan;

use std::io::{BufReader, Read};
use std::iter;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use image::codecs::png::PngDecoder;
use image::codecs::webp::WebPDecoder;
use image::{AnimationDecoder, Frames, ImageDecoder, ImageResult, RgbaImage};
use motionscope_core::base::{Error, Stop};
use motionscope_core::data::{ClipInfo, Frame};

use self::scan::Scan;
use super::names::file_name;
use super::{Decoder, Open, Source, cannot_read, catch_panic, check_size, picture, reason, stills};
use crate::files::File;
use crate::work::Ahead;

/// What can be animated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Gif,
    Png,
    WebP,
}

impl Format {
    fn of(path: &Path) -> Result<Self, Error> {
        let mut head = [0; 4];
        File::open(path).and_then(|mut file| file.read_exact(&mut head)).map_err(|e| cannot_read(&e))?;
        match &head {
            b"GIF8" => Ok(Format::Gif),
            b"\x89PNG" => Ok(Format::Png),
            b"RIFF" => Ok(Format::WebP),
            _ => Err(Error::new("it is not an animated GIF, PNG or WebP")),
        }
    }

    /// Container and codec.
    fn names(self) -> (&'static str, &'static str) {
        match self {
            Format::Gif => ("gif", "gif"),
            Format::Png => ("apng", "png"),
            Format::WebP => ("webp", "webp"),
        }
    }
}

/// Opens the animation at `path`.
///
/// # Errors
/// One sentence, without the file's name.
pub(crate) fn open(path: &Path, options: &Open) -> Result<Source, Error> {
    let format = Format::of(path)?;
    let scan = scan::scan(path, format, options)?;
    if scan.delays_ms.is_empty() && format != Format::Gif {
        // It only looked as if it moved.
        return stills::open(path, options);
    }
    let (width, height) = scan.size;
    check_size(width, height)?;
    if scan.delays_ms.is_empty() {
        return Err(Error::new("it is cut short within its first picture; copy it again from its source"));
    }
    let mut warnings = warnings(&scan);
    let (frames, fps) = (scan.delays_ms.len(), fps(&scan.delays_ms));
    let (decoder, is_clear) = decoder(path, format, scan)?;
    if is_clear {
        warnings.push("transparent pixels are shown on black".into());
    }
    let (container, codec) = format.names();
    let info = ClipInfo {
        name: file_name(path),
        width,
        height,
        frames: Some(frames),
        fps,
        container: container.into(),
        codec: codec.into(),
        warnings,
    };
    Ok(Source { info, decoder, files: Arc::default(), contrast: None })
}

/// What decodes the pictures, and whether pixels of the first one are clear.
fn decoder(path: &Path, format: Format, scan: Scan) -> Result<(Box<dyn Decoder>, bool), Error> {
    if format == Format::Gif {
        let mut gif = gif::Gif::new(path, scan);
        let is_clear = gif.is_clear()?;
        return Ok((Box::new(gif), is_clear));
    }
    let animation = Animation { path: path.into(), format, stream: None };
    let is_clear = animation.first()?.pixels().any(|pixel| pixel[3] < 255);
    Ok((Box::new(animation), is_clear))
}

/// How long browsers show a picture that asks for no time, in milliseconds.
const HURRIED_MS: f64 = 100.0;

fn shown_ms(delay_ms: f64) -> f64 {
    if delay_ms <= 10.0 { HURRIED_MS } else { delay_ms }
}

fn fps(delays_ms: &[f64]) -> Option<f64> {
    let total_ms: f64 = delays_ms.iter().copied().map(shown_ms).sum();
    (delays_ms.len() > 1).then(|| 1000.0 * delays_ms.len() as f64 / total_ms)
}

fn warnings(scan: &Scan) -> Vec<String> {
    let mut warnings = Vec::new();
    let shown = || scan.delays_ms.iter().copied().map(shown_ms);
    let (least, most) = (shown().fold(f64::INFINITY, f64::min), shown().fold(0.0, f64::max));
    if most > least {
        warnings.push(format!("the pictures are shown for {least} to {most} ms; the rate is their mean"));
    }
    if !scan.whole {
        let kept = match scan.delays_ms.len() {
            1 => "first picture".to_owned(),
            n => format!("first {n} pictures"),
        };
        warnings.push(format!("the file is cut short or damaged; what comes after its {kept} is lost"));
    }
    warnings
}

/// APNG and WebP: decodes from the start on, because each picture builds on those before it.
struct Animation {
    path: PathBuf,
    format: Format,
    stream: Option<Stream>,
}

impl Animation {
    fn first(&self) -> Result<RgbaImage, Error> {
        let mut stream = Stream::start(&self.path, self.format)?;
        stream.pictures.next().unwrap_or_else(|| Err(Error::new("it holds no picture; copy it again from its source")))
    }
}

impl Decoder for Animation {
    fn decode(&mut self, index: usize, stop: &Stop, keep: &mut dyn FnMut(usize, Frame)) -> Result<(), Error> {
        // Taken out, so that after an error the next call starts afresh.
        let mut stream = match self.stream.take() {
            Some(stream) if stream.next <= index => stream,
            _ => Stream::start(&self.path, self.format)?,
        };
        let from = stream.next;
        while stream.next <= index {
            stop.check()?;
            stop.report(stream.next - from, index + 1 - from);
            let Some(picture) = stream.pictures.next() else { return Ok(()) };
            keep(stream.next, picture::frame(picture?.into())?);
            stream.next += 1;
        }
        self.stream = Some(stream);
        Ok(())
    }
}

/// The composed pictures from the first on.
struct Stream {
    pictures: Ahead<Result<RgbaImage, Error>>,
    /// Number of the picture that comes next.
    next: usize,
}

impl Stream {
    fn start(path: &Path, format: Format) -> Result<Self, Error> {
        let path = path.to_path_buf();
        let pictures = Ahead::start("animation", move || pictures(&path, format))
            .map_err(|e| Error::new(format!("no thread can be started to decode it ({e}); close other programs")))?;
        Ok(Self { pictures, next: 0 })
    }
}

/// The composed pictures; after an error there are no more.
fn pictures(path: &Path, format: Format) -> Box<dyn Iterator<Item = Result<RgbaImage, Error>>> {
    match contained(|| frames(path, format)) {
        Err(error) => Box::new(iter::once(Err(error))),
        Ok(mut frames) => {
            let next = move || contained(|| frames.next().transpose().map_err(|e| picture::damaged(&e))).transpose();
            let mut has_failed = false;
            Box::new(iter::from_fn(next).map(|frame| frame.map(image::Frame::into_buffer)).take_while(move |picture| {
                let goes_on = !has_failed;
                has_failed |= picture.is_err();
                goes_on
            }))
        }
    }
}

/// Calls `decode`, and returns its panic as an error.
fn contained<T>(decode: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
    let damaged = |panic: String| Err(Error::new(format!("its data are damaged{}", reason::bracketed(&panic))));
    catch_panic::catch_panic(decode).unwrap_or_else(damaged)
}

fn frames(path: &Path, format: Format) -> Result<Frames<'static>, Error> {
    let input = BufReader::new(File::open(path).map_err(|e| cannot_read(&e))?);
    let frames = match format {
        Format::WebP => WebPDecoder::new(input).and_then(limited).map(AnimationDecoder::into_frames),
        _ => PngDecoder::new(input).and_then(limited).and_then(PngDecoder::apng).map(AnimationDecoder::into_frames),
    };
    frames.map_err(|e| picture::damaged(&e))
}

fn limited<D: ImageDecoder>(mut decoder: D) -> ImageResult<D> {
    let (width, height) = decoder.dimensions();
    // Canvas, its predecessor, and the part that changes.
    decoder.set_limits(picture::limits(4 * u64::from(width) * u64::from(height)))?;
    Ok(decoder)
}

#[cfg(test)]
mod tests;
