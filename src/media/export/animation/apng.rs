//! Animated PNG: after the first picture only the rectangle that changes.

use motionscope_core::base::Error;
use png::{BlendOp, ColorType, Compression, DisposeOp, Encoder, EncodingError, SrgbRenderingIntent};

use super::{AnimationFormat, Area, Progress, Reel, Shots, failed};

/// Encodes `reel` as an animated PNG.
///
/// # Errors
/// If a picture cannot be encoded or the work was cancelled.
pub async fn encode(reel: &Reel, progress: Option<&dyn Progress>) -> Result<Vec<u8>, Error> {
    let why = |error: EncodingError| failed(AnimationFormat::Apng, &error);
    let [width, height] = reel.size;
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_compression(Compression::Fast);
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    encoder.set_animated(u32::try_from(reel.shots()).unwrap_or(u32::MAX), 0).map_err(why)?;
    encoder.set_dispose_op(DisposeOp::None).map_err(why)?;
    encoder.set_blend_op(BlendOp::Source).map_err(why)?;
    encoder.add_text_chunk("Software".into(), "Motionscope".into()).map_err(why)?;
    let mut writer = encoder.write_header().map_err(why)?;
    let mut before: Option<Vec<u8>> = None;
    let mut shots = Shots::new(reel, AnimationFormat::Apng, progress);
    while let Some(shot) = shots.next().await? {
        let delay_ms = u16::try_from(shot.ticks(1000.0)).unwrap_or(u16::MAX);
        let now = shot.picture.into_raw();
        let area = before.as_ref().map_or(Area::whole(reel.size), |before| Area::of_changes([before, &now], width, 3));
        if before.is_some() {
            // The smaller rectangle first: position and size together must stay within the picture.
            writer.set_frame_position(0, 0).map_err(why)?;
            writer.set_frame_dimension(area.width, area.height).map_err(why)?;
            writer.set_frame_position(area.x, area.y).map_err(why)?;
        }
        writer.set_frame_delay(delay_ms, 1000).map_err(why)?;
        writer.write_image_data(&area.cut(&now, width, 3)).map_err(why)?;
        before = Some(now);
    }
    writer.finish().map_err(why)?;
    Ok(bytes)
}
