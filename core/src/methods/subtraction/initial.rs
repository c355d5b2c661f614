//! Initialisation of a background model: the first frame, or the median of frames of the whole run.

use std::sync::Arc;

use super::camera::{CameraMotion, Steadiness, aligned, shifted_frame};
use super::exposure::{Exposure, Transfer};
use crate::base::Error;
use crate::choices;
use crate::data::{Clip, Frame};
use crate::geometry::Grid;
use crate::run::Span;

choices! {
    /// The initial background.
    pub enum Initial {
        /// The first frame. An object in this frame leaves a ghost: false foreground at its first position, until the model has learned
        /// the background there.
        FirstFrame = "first-frame" "First frame",
        /// The median of frames spread over the whole run. It leaves no ghosts, but works with hindsight (non-causal), not in real time.
        Median = "median" "Median",
    }
}

/// The number of frames of the median.
const SAMPLES: usize = 9;
/// The number of leading frames that the samples are taken from in a clip of unknown length.
const REACH: usize = 60;

/// Returns the picture that initialises the model of the frames `span` of a clip. The samples of a median are aligned and have the
/// exposure of the first of them, as far as `steady` asks for it.
///
/// # Errors
/// If a frame cannot be read.
pub fn picture(
    (initial, steady): (Initial, Option<Steadiness>),
    clip: &Clip,
    span: &Span,
) -> Result<Arc<Frame>, Error> {
    match initial {
        Initial::FirstFrame => clip.frame(span.first),
        Initial::Median => median_of((clip, SAMPLES), span, steady).map(Arc::new),
    }
}

/// Returns the per-pixel median of `most` frames spaced evenly over `span`. An object that covers a pixel in less than half of them
/// leaves no trace.
///
/// B. P. L. Lo and S. A. Velastin, Automatic congestion detection system for underground platforms, 2001.
pub fn median_of((clip, most): (&Clip, usize), span: &Span, steady: Option<Steadiness>) -> Result<Frame, Error> {
    let count = span.frames().unwrap_or(REACH);
    let samples = count.min(most);
    let mut times = Vec::new();
    for i in 0..samples {
        let t = span.first + i * (count - 1) / (samples - 1).max(1);
        // A clip of unknown length may be shorter; a damaged frame or a cancelled one is not its end.
        if span.frames().is_none() && !clip.has_frame(t)? {
            break;
        }
        times.push(t);
    }
    let mut frames = sampled(clip, &times, steady.is_some_and(|steady| steady.camera == CameraMotion::Followed))?;
    if steady.is_some_and(|steady| steady.exposure == Exposure::Compensated) {
        expose(&mut frames);
    }
    let (width, height) = clip.size();
    let colors: Option<Vec<_>> = frames.iter().map(|frame| frame.color()).collect();
    Ok(match colors {
        Some(colors) => Frame::rgb(Grid::from_fn(width, height, |x, y| {
            [0, 1, 2].map(|channel| median(&mut colors.iter().map(|frame| frame[(x, y)][channel]).collect::<Vec<u8>>()))
        })),
        None => Frame::gray(Grid::from_fn(width, height, |x, y| {
            median(&mut frames.iter().map(|frame| frame.luma()[(x, y)]).collect::<Vec<u8>>())
        })),
    })
}

/// Gives all frames the exposure of the first one.
fn expose(frames: &mut [Arc<Frame>]) {
    let Some((first, others)) = frames.split_first_mut() else { return };
    for frame in others {
        let expected = |x, y| Some(f32::from(first.luma()[(x, y)]));
        if let Some(transfer) = Transfer::between(frame.luma(), expected) {
            *frame = Arc::new(transfer.undone(frame));
        }
    }
}

/// Returns frames of a clip, aligned with the first of them where the camera is followed. What is outside a frame is taken from the
/// first one.
fn sampled(clip: &Clip, times: &[usize], is_followed: bool) -> Result<Vec<Arc<Frame>>, Error> {
    if !is_followed {
        return times.iter().map(|t| clip.wanted().and_then(|()| clip.frame(*t))).collect();
    }
    let frames = aligned(clip, times)?;
    let Some((first, _)) = frames.first().cloned() else { return Ok(Vec::new()) };
    let placed = frames.into_iter().map(|(frame, at)| match at {
        [0.0, 0.0] => frame,
        at => Arc::new(shifted_frame(&frame, at.map(|c| -c), &first)),
    });
    Ok(placed.collect())
}

/// Returns the median; of an even number of values the mean of the two in the middle.
fn median(values: &mut [u8]) -> u8 {
    values.sort_unstable();
    let [low, high] = [values[(values.len() - 1) / 2], values[values.len() / 2]].map(u32::from);
    (low + high).div_ceil(2) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_an_even_number_is_the_mean_of_the_middle_two() {
        assert_eq!([median(&mut [90, 10]), median(&mut [30, 200, 10, 40])], [50, 35]);
        assert_eq!([median(&mut [9]), median(&mut [7, 1, 200])], [9, 7]);
    }
}
