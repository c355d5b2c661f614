//! MP4: each step lasts as many frames as come nearest to its time.

use motionscope_core::Error;

use super::{Progress, Reel};
use crate::media::export::h264::Video;

/// Frames per second of the video.
const RATE: u32 = 50;

/// Encodes `reel` as H.264 in an MP4 file.
///
/// # Errors
/// If there is no ffmpeg, it cannot encode H.264, or the work was cancelled.
pub fn encode(reel: &Reel, progress: Option<&dyn Progress>) -> Result<Vec<u8>, Error> {
    let (size, rate_hz) = (reel.size.map(|side| side as usize), f64::from(RATE));
    let video = Video { what: "animation", instead: "save as .gif, .apng or .webp", size, rate_hz, crf: 16 };
    video.encode(progress, |pipe| {
        reel.each(progress, |_, shot| {
            let times = ((shot.ms * RATE + 500) / 1000).max(1);
            (0..times).try_for_each(|_| pipe.put(shot.picture.as_raw()))
        })
    })
}
