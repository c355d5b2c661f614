//! GIF: one palette for all pictures, and of each picture only what changes.

use std::borrow::Cow;

use ::gif::{DisposalMethod, Encoder, Frame, Repeat};
use motionscope_core::base::Error;

use super::palette::{Palette, UNCHANGED};
use super::{AnimationFormat, Area, Progress, Reel, Shots, failed};

/// The shortest time that viewers respect, in hundredths of a second.
pub(super) const LEAST_DELAY: u32 = 2;

/// Encodes `reel` as a GIF.
///
/// # Errors
/// If a side is larger than 65 535 px or the work was cancelled.
pub async fn encode(reel: &Reel, progress: Option<&dyn Progress>) -> Result<Vec<u8>, Error> {
    let too_large = || failed(AnimationFormat::Gif, &"it has at most 65\u{2009}535 px a side; choose a smaller scale");
    let side = |side: u32| u16::try_from(side).map_err(|_| too_large());
    let [width, height] = reel.size;
    let (wide, tall) = (side(width)?, side(height)?);
    let mut palette = Palette::of(reel, progress).await?;
    let mut bytes = Vec::new();
    let why = |error: ::gif::EncodingError| failed(AnimationFormat::Gif, &error);
    let mut encoder = Encoder::new(&mut bytes, wide, tall, &palette.bytes()).map_err(why)?;
    encoder.set_repeat(Repeat::Infinite).map_err(why)?;
    let mut before: Option<Vec<u8>> = None;
    let mut shots = Shots::new(reel, AnimationFormat::Gif, progress);
    while let Some(shot) = shots.next().await? {
        let now: Vec<u8> = shot.picture.pixels().map(|pixel| palette.index(pixel.0)).collect();
        let (area, pixels) = match &before {
            None => (Area::whole(reel.size), now.clone()),
            Some(before) => {
                let area = Area::of_changes([before, &now], width, 1);
                let pairs = area.cut(before, width, 1).into_iter().zip(area.cut(&now, width, 1));
                (area, pairs.map(|(old, new)| if old == new { UNCHANGED } else { new }).collect())
            }
        };
        let frame = Frame {
            left: side(area.x)?,
            top: side(area.y)?,
            width: side(area.width)?,
            height: side(area.height)?,
            delay: u16::try_from(shot.ticks(100.0).max(LEAST_DELAY)).unwrap_or(u16::MAX),
            dispose: DisposalMethod::Keep,
            transparent: before.is_some().then_some(UNCHANGED),
            buffer: Cow::Owned(pixels),
            ..Frame::default()
        };
        encoder.write_frame(&frame).map_err(why)?;
        before = Some(now);
    }
    drop(encoder);
    Ok(bytes)
}
