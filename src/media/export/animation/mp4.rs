//! MP4: the rate of the video is a multiple of the rate of the steps, so that every step takes the time that was asked for.

use motionscope_core::base::Error;

use super::{AnimationFormat, Progress, Reel, Shots, Timing};
use crate::media::export::h264::{Pipe, Video};

/// Players handle videos of fewer frames per second badly.
const LEAST_HZ: f64 = 10.0;
/// The least frames per second where pictures lead from step to step.
const SMOOTH_HZ: f64 = 50.0;

/// Encodes `reel` as H.264 in an MP4 file.
///
/// # Errors
/// If there is no ffmpeg, it or the browser cannot encode H.264, or the work was cancelled.
pub async fn encode(reel: &Reel, progress: Option<&dyn Progress>) -> Result<Vec<u8>, Error> {
    let (size, rate_hz) = (reel.size.map(|side| side as usize), video_rate(reel.timing));
    let video = Video { what: "animation", instead: "save as .gif, .apng or .webp", size, rate_hz, crf: 16 };
    video
        .encode(progress, async |pipe: &mut Pipe<'_>| {
            let mut shots = Shots::new(reel, AnimationFormat::Mp4, progress);
            while let Some(shot) = shots.next().await? {
                pipe.put(shot.picture.as_raw(), shot.ticks(rate_hz)).await?;
            }
            Ok(())
        })
        .await
}

/// Frames per second of the video.
fn video_rate(timing: Timing) -> f64 {
    let least = if timing.between == 0 { LEAST_HZ } else { SMOOTH_HZ };
    timing.rate() * (least / timing.rate()).ceil().max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_of_the_video_is_a_multiple_of_that_of_the_steps() {
        let rate = |rate_hz, between| video_rate(Timing { rate_hz, between });
        for (rate_hz, expected) in [(12.0, 12.0), (30.0, 30.0), (40.0, 40.0), (50.0, 50.0), (4.0, 12.0), (0.5, 10.0)] {
            assert_eq!(rate(rate_hz, 0), expected, "{rate_hz} steps per second");
        }
        assert_eq!([rate(30.0, 3), rate(8.0, 2)], [60.0, 56.0]);
    }
}
