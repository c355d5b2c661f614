//! What a background model begins with: the first frame, or the median of frames from all over the run.

use std::sync::Arc;

use crate::base::Error;
use crate::choices;
use crate::data::{Clip, Frame};
use crate::geometry::Grid;
use crate::run::Span;

choices! {
    /// What the background is before anything was learned.
    pub enum Initial {
        /// The first frame: what moves in it stays behind as a ghost until the model has forgotten it.
        FirstFrame = "first-frame" "First frame",
        /// The median of frames from all over the run: no ghosts, but it looks ahead, as a live camera cannot.
        Median = "median" "Median",
    }
}

/// How many frames the median is of.
const SAMPLES: usize = 9;
/// Frames of a clip of unknown length that these are taken from.
const REACH: usize = 60;

/// The picture that a model of the frames `span` of a clip begins with.
///
/// # Errors
/// If a frame cannot be read.
pub fn picture(initial: Initial, clip: &Clip, span: &Span) -> Result<Arc<Frame>, Error> {
    match initial {
        Initial::FirstFrame => clip.frame(span.first),
        Initial::Median => median_of(clip, span).map(Arc::new),
    }
}

/// The median of frames that lie evenly in `span` (B. P. L. Lo and S. A. Velastin, Automatic congestion detection system for
/// underground platforms, 2001): what moves is seen at a place in less than half of them.
fn median_of(clip: &Clip, span: &Span) -> Result<Frame, Error> {
    let count = span.frames().unwrap_or(REACH);
    let samples = count.min(SAMPLES);
    let mut frames = Vec::new();
    for i in 0..samples {
        let t = span.first + i * (count - 1) / (samples - 1).max(1);
        // A clip of unknown length may be shorter; a damaged frame, or one that is not wanted any more, is no end.
        if span.frames().is_none() && !clip.has_frame(t)? {
            break;
        }
        clip.wanted()?;
        frames.push(clip.frame(t)?);
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

/// The value in the middle, of an even number the mean of both that are there.
fn median(values: &mut [u8]) -> u8 {
    values.sort_unstable();
    let [low, high] = [values[(values.len() - 1) / 2], values[values.len() / 2]].map(u32::from);
    (low + high).div_ceil(2) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_an_even_number_is_not_what_is_bright() {
        assert_eq!([median(&mut [90, 10]), median(&mut [30, 200, 10, 40])], [50, 35]);
        assert_eq!([median(&mut [9]), median(&mut [7, 1, 200])], [9, 7]);
    }
}
