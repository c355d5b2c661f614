//! Animated WebP: pictures without loss in a RIFF container, after the first only the rectangle that changes.

use image::codecs::webp::WebPEncoder;
use image::{ExtendedColorType, ImageEncoder as _};
use motionscope_core::base::Error;

use super::{AnimationFormat, Area, Progress, Reel, Shots, failed};

/// The largest side of a picture in px.
const MOST_SIDE: u32 = 1 << 14;
/// The flag of an animation in the header of the extended format.
const ANIMATED: u8 = 0b10;
/// The flag of a picture that replaces what is below it.
const REPLACES: u8 = 0b10;
/// `RIFF`, the size and `WEBP`, before the first chunk of a file.
const HEADER: usize = 12;

/// Encodes `reel` as an animated WebP.
///
/// # Errors
/// If a side is larger than the format allows or the work was cancelled.
pub async fn encode(reel: &Reel, progress: Option<&dyn Progress>) -> Result<Vec<u8>, Error> {
    let [width, height] = reel.size;
    if width.max(height) > MOST_SIDE {
        return Err(failed(AnimationFormat::WebP, &"it has at most 16\u{2009}384 px a side; choose a smaller scale"));
    }
    let mut chunks = Vec::new();
    let canvas = [[ANIMATED, 0, 0, 0].as_slice(), &u24(width - 1), &u24(height - 1)].concat();
    chunk(&mut chunks, b"VP8X", &canvas);
    // A transparent background, and no end of repetitions.
    chunk(&mut chunks, b"ANIM", &[0; 6]);
    let mut before: Option<Vec<u8>> = None;
    let mut shots = Shots::new(reel, AnimationFormat::WebP, progress);
    while let Some(shot) = shots.next().await? {
        let ms = shot.ticks(1000.0);
        let now = shot.picture.into_raw();
        let area =
            before.as_ref().map_or(Area::whole(reel.size), |before| even(Area::of_changes([before, &now], width, 3)));
        let still = still(&area.cut(&now, width, 3), area)?;
        let place = [area.x / 2, area.y / 2, area.width - 1, area.height - 1, ms].map(u24).concat();
        chunk(&mut chunks, b"ANMF", &[&place, [REPLACES].as_slice(), &still[HEADER..]].concat());
        before = Some(now);
    }
    let mut bytes = Vec::new();
    chunk(&mut bytes, b"RIFF", &[b"WEBP", chunks.as_slice()].concat());
    Ok(bytes)
}

/// Returns the rectangle with an even corner, as the format has it.
fn even(area: Area) -> Area {
    let (x, y) = (area.x & !1, area.y & !1);
    Area { x, y, width: area.width + area.x - x, height: area.height + area.y - y }
}

/// Encodes a single picture as a file of its own.
fn still(rgb: &[u8], area: Area) -> Result<Vec<u8>, Error> {
    let mut bytes = Vec::new();
    let encoder = WebPEncoder::new_lossless(&mut bytes);
    let written = encoder.write_image(rgb, area.width, area.height, ExtendedColorType::Rgb8);
    written.map_err(|error| failed(AnimationFormat::WebP, &error))?;
    Ok(bytes)
}

/// Appends a chunk; those of an odd length are filled up.
fn chunk(to: &mut Vec<u8>, name: &[u8; 4], content: &[u8]) {
    to.extend_from_slice(name);
    to.extend_from_slice(&u32::try_from(content.len()).unwrap_or(u32::MAX).to_le_bytes());
    to.extend_from_slice(content);
    to.extend(std::iter::repeat_n(0, content.len() % 2));
}

/// Returns a number in 24 bits, the lowest byte first.
fn u24(number: u32) -> [u8; 3] {
    let [a, b, c, _] = number.to_le_bytes();
    [a, b, c]
}
