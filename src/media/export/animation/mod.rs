//! Animations of pictures: GIF, animated PNG and WebP, and MP4.

mod apng;
mod gif;
mod mp4;
mod palette;
mod webp;

use std::io::Cursor;
use std::path::Path;

use image::{ImageFormat, Rgb, RgbImage};
use motionscope_core::base::Error;

use crate::media::Progress;
use crate::media::export::h264;
use crate::media::numbers::{single, whole};
use crate::work;

/// The time for which the last picture stays before an animation begins anew, in seconds.
const LAST_S: f64 = 2.0;
/// The share of a picture's time in which it turns into the next, if it does.
const TURN: f64 = 0.5;

/// The file format of an animation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnimationFormat {
    /// 256 colours, chosen for all pictures together.
    Gif,
    /// Animated PNG, without loss.
    Apng,
    /// Animated WebP, without loss.
    WebP,
    /// H.264 video, encoded by the user's ffmpeg, or the browser in a page.
    Mp4,
}

impl AnimationFormat {
    /// All formats.
    pub const ALL: [Self; 4] = [Self::Gif, Self::Apng, Self::WebP, Self::Mp4];

    /// Returns the format by the extension of `path`.
    ///
    /// # Errors
    /// A sentence with the extensions.
    pub fn of(path: &Path) -> Result<Self, Error> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        // Animated PNG files are often called .png.
        let extension = extension.map(|ending| if ending == "png" { "apng".to_owned() } else { ending });
        let refused = || {
            Error::new(format!("{}: the name of an animation must end in .gif, .apng, .webp or .mp4", path.display()))
        };
        let found = extension.and_then(|ending| Self::ALL.into_iter().find(|format| format.extension() == ending));
        found.ok_or_else(refused)
    }

    /// Returns the file extension.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Gif => "gif",
            Self::Apng => "apng",
            Self::WebP => "webp",
            Self::Mp4 => "mp4",
        }
    }

    /// Returns the shortest time of a picture in seconds: viewers show a GIF with shorter ones much slower.
    fn least_s(self) -> f64 {
        match self {
            Self::Gif => f64::from(gif::LEAST_DELAY) / 100.0,
            Self::Apng | Self::WebP | Self::Mp4 => 0.0,
        }
    }

    /// Returns what the format is good for.
    pub fn doc(self) -> &'static str {
        match self {
            Self::Gif => "GIF, 256 colours, plays everywhere",
            Self::Apng => "Animated PNG, exact colours, plays in browsers",
            Self::WebP => "Animated WebP, exact colours, smaller than PNG",
            Self::Mp4 => h264::MP4_DESCRIPTION,
        }
    }
}

/// How fast an animation plays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Steps per second.
    pub rate_hz: f32,
    /// Pictures that lead from each step to the next, blended with an eased weight; 0 for none.
    pub between: u32,
}

impl Timing {
    /// The slowest and the fastest rate in steps per second.
    pub const RATE_HZ: std::ops::RangeInclusive<f32> = 0.1..=60.0;
    /// The largest number of pictures between two steps.
    pub const MOST_BETWEEN: u32 = 8;

    /// Returns the steps per second that it plays.
    fn rate(self) -> f64 {
        self.rate_hz.clamp(*Self::RATE_HZ.start(), *Self::RATE_HZ.end()).into()
    }

    /// Returns the timing with which a file of this `format` plays: slower where its pictures would have too little time.
    #[must_use]
    pub fn played(self, format: AnimationFormat) -> Self {
        let most_hz = 1.0 / (format.least_s() * f64::from(1 + self.between));
        Self { rate_hz: self.rate_hz.min(single(most_hz)), ..self }
    }

    /// Returns the time of each picture in seconds, if each has at least `least_s`: of a step, and of one that leads to the next.
    fn times_s(self, least_s: f64) -> [f64; 2] {
        let (whole, count) = (1.0 / self.rate(), f64::from(self.between));
        if self.between == 0 {
            return [whole, 0.0];
        }
        let between = (whole * TURN / count).max(least_s);
        [whole - count * between, between]
    }
}

impl Default for Timing {
    fn default() -> Self {
        Self { rate_hz: 8.0, between: 0 }
    }
}

/// The steps of an animation in order, each as a PNG file, so that hundreds fit into memory.
pub struct Reel {
    steps: Vec<Vec<u8>>,
    /// Width and height that all of them fit into.
    size: [u32; 2],
    background: Rgb<u8>,
    timing: Timing,
}

/// A picture of an animation, and from when until when it is shown, in seconds from the start.
struct Shot {
    picture: RgbImage,
    from_s: f64,
    until_s: f64,
}

impl Shot {
    /// Returns its time in units of which `per_second` make a second. Both ends are rounded, so that rounding errors do not add up.
    fn ticks(&self, per_second: f64) -> u32 {
        // The end of one picture and the start of the next are computed apart: halves are rounded to the same side.
        let end = |time: f64| whole((time * per_second + 1e-6).round()).unwrap_or(u32::MAX);
        end(self.until_s).saturating_sub(end(self.from_s))
    }
}

impl Reel {
    /// Returns an animation without pictures; where one is smaller than others, `background` is seen.
    pub fn new(timing: Timing, background: [u8; 3]) -> Self {
        Self { steps: Vec::new(), size: [1, 1], background: Rgb(background), timing }
    }

    /// Adds a step, as a PNG file.
    ///
    /// # Errors
    /// If it is none.
    pub fn push(&mut self, png: Vec<u8>) -> Result<(), Error> {
        let header = ::png::Decoder::new(Cursor::new(&png)).read_info();
        let (width, height) = header.map_err(|error| unread(&error))?.info().size();
        self.size = [self.size[0].max(width), self.size[1].max(height)];
        self.steps.push(png);
        Ok(())
    }

    /// Encodes the animation; it plays again and again.
    ///
    /// # Errors
    /// If there is no picture, it is too large for the format, the video cannot be encoded, or the work was cancelled.
    pub async fn encode(&self, format: AnimationFormat, progress: Option<&dyn Progress>) -> Result<Vec<u8>, Error> {
        if self.steps.is_empty() {
            return Err(Error::new("there is no step to animate"));
        }
        match format {
            AnimationFormat::Gif => gif::encode(self, progress).await,
            AnimationFormat::Apng => apng::encode(self, progress).await,
            AnimationFormat::WebP => webp::encode(self, progress).await,
            AnimationFormat::Mp4 => mp4::encode(self, progress).await,
        }
    }

    /// Returns the number of pictures.
    fn shots(&self) -> usize {
        (self.steps.len() - 1) * (1 + self.timing.between as usize) + 1
    }

    /// Returns the weight of the next step in the picture `i`, from 1, of those that lead to it: slow, fast, slow.
    fn weight(&self, i: u32) -> f32 {
        let share = i as f32 / (self.timing.between + 1) as f32;
        share * share * (3.0 - 2.0 * share)
    }

    /// Decodes a step; it is put at the top left of a picture of the common size.
    fn picture(&self, step: usize) -> Result<RgbImage, Error> {
        let png = image::load_from_memory_with_format(&self.steps[step], ImageFormat::Png);
        let picture = png.map_err(|error| unread(&error))?.into_rgb8();
        let [width, height] = self.size;
        if picture.dimensions() == (width, height) {
            return Ok(picture);
        }
        let mut whole = RgbImage::from_pixel(width, height, self.background);
        image::imageops::replace(&mut whole, &picture, 0, 0);
        Ok(whole)
    }
}

/// Goes through the pictures of an animation in order.
struct Shots<'a> {
    reel: &'a Reel,
    progress: Option<&'a dyn Progress>,
    /// The time of the picture of a step, and of one between two steps.
    times_s: [f64; 2],
    /// Number of pictures returned.
    index: usize,
    /// The picture of the current step, and that of the next one.
    pair: [RgbImage; 2],
}

impl<'a> Shots<'a> {
    /// The pictures of `reel` with their times in a file of this `format`.
    fn new(reel: &'a Reel, format: AnimationFormat, progress: Option<&'a dyn Progress>) -> Self {
        let times_s = reel.timing.times_s(format.least_s());
        Self { reel, progress, times_s, index: 0, pair: Default::default() }
    }

    /// Returns the next picture, or `None` after the last.
    ///
    /// # Errors
    /// If a step cannot be read back or the work was cancelled.
    async fn next(&mut self) -> Result<Option<Shot>, Error> {
        let count = self.reel.shots();
        if let Some(progress) = self.progress.filter(|_| self.index > 0) {
            progress.report(self.index as f32 / count as f32);
        }
        if self.index == count {
            return Ok(None);
        }
        if self.progress.is_some_and(|progress| progress.cancelled()) {
            return Err(Error::new("saving was cancelled"));
        }
        work::breathe().await;
        let ([step_s, between_s], of_step) = (self.times_s, 1 + self.reel.timing.between as usize);
        let (step, part) = (self.index / of_step, self.index % of_step);
        if part == 0 {
            self.turn_to(step)?;
        }
        let picture = match u32::try_from(part) {
            Ok(part @ 1..) => blend([&self.pair[0], &self.pair[1]], self.reel.weight(part)),
            _ if self.reel.timing.between == 0 => std::mem::take(&mut self.pair[0]),
            _ => self.pair[0].clone(),
        };
        self.index += 1;
        let begin_s = step as f64 / self.reel.timing.rate();
        let (from_s, for_s) = match part {
            0 if self.index == count => (begin_s, step_s.max(LAST_S)),
            0 => (begin_s, step_s),
            _ => (begin_s + step_s + (part - 1) as f64 * between_s, between_s),
        };
        Ok(Some(Shot { picture, from_s, until_s: from_s + for_s }))
    }

    /// Reads the pictures of `step` and of the one after it, if there are any between them.
    fn turn_to(&mut self, step: usize) -> Result<(), Error> {
        let Self { reel, pair: [now, next], .. } = self;
        if step == 0 || reel.timing.between == 0 {
            *now = reel.picture(step)?;
        } else {
            std::mem::swap(now, next);
        }
        if reel.timing.between > 0 && step + 1 < reel.steps.len() {
            *next = reel.picture(step + 1)?;
        }
        Ok(())
    }
}

/// Mixes two pictures of one size; `weight` is that of the second.
fn blend([first, second]: [&RgbImage; 2], weight: f32) -> RgbImage {
    let mut mixed = first.clone();
    let part = whole((weight * 256.0).round().into()).unwrap_or(256).min(256);
    for (to, from) in mixed.iter_mut().zip(second.iter()) {
        *to = ((u32::from(*to) * (256 - part) + u32::from(*from) * part + 128) >> 8).min(255) as u8;
    }
    mixed
}

/// A rectangle of a picture in px.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Area {
    x: u32,
    y: u32,
    width: u32,
    height: u32,
}

impl Area {
    /// Returns the whole of a picture.
    fn whole([width, height]: [u32; 2]) -> Self {
        Self { x: 0, y: 0, width, height }
    }

    /// Returns the smallest rectangle that contains every pixel in which two pictures differ, `bytes` for each pixel; one
    /// pixel if they are equal, because no format has pictures without pixels.
    fn of_changes([before, now]: [&[u8]; 2], width: u32, bytes: usize) -> Self {
        let row = width as usize * bytes;
        let rows = before.chunks_exact(row).zip(now.chunks_exact(row));
        let (mut top, mut bottom, mut left, mut right) = (None, 0, usize::MAX, 0);
        for (y, (before, now)) in rows.enumerate() {
            let differs = |(a, b): (&[u8], &[u8])| a != b;
            let pixels = || before.chunks_exact(bytes).zip(now.chunks_exact(bytes));
            if let (Some(first), Some(last)) = (pixels().position(differs), pixels().rposition(differs)) {
                top = top.or(Some(y));
                (bottom, left, right) = (y, left.min(first), right.max(last));
            }
        }
        let Some(top) = top else { return Self { x: 0, y: 0, width: 1, height: 1 } };
        let [x, y, width, height] =
            [left, top, right + 1 - left, bottom + 1 - top].map(|side| u32::try_from(side).unwrap_or(u32::MAX));
        Self { x, y, width, height }
    }

    /// Returns the pixels of the rectangle, row by row.
    fn cut(self, pixels: &[u8], width: u32, bytes: usize) -> Vec<u8> {
        let rows = pixels.chunks_exact(width as usize * bytes).skip(self.y as usize).take(self.height as usize);
        let columns = self.x as usize * bytes..(self.x + self.width) as usize * bytes;
        rows.flat_map(|row| &row[columns.clone()]).copied().collect()
    }
}

fn unread(why: &dyn std::fmt::Display) -> Error {
    Error::new(format!("a picture of the animation could not be read back: {why}"))
}

/// Says that a format could not be written, and why.
fn failed(format: AnimationFormat, why: &dyn std::fmt::Display) -> Error {
    Error::new(format!("the {} animation could not be made: {why}", format.extension().to_uppercase()))
}

#[cfg(test)]
mod tests;
