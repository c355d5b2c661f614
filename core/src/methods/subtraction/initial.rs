//! Initialisation of a background model: the first frame, or the median of frames of the whole run.

use std::sync::Arc;

use super::Setup;
use super::camera::{CameraMotion, Steadiness, aligned};
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
/// The least share of the samples that is aligned, if the camera is followed: a median of fewer frames keeps objects.
const LEAST_ALIGNED: f32 = 0.75;
/// The number of leading frames that the samples are taken from in a clip of unknown length.
const REACH: usize = 60;

/// Returns the picture that initialises the model of the frames `span` of a clip. The samples of a median are aligned and have the
/// exposure of the first of them, where `setup` asks for it.
///
/// # Errors
/// If a frame cannot be read.
pub fn picture(Setup { initial, steady, .. }: Setup, clip: &Clip, span: &Span) -> Result<Arc<Frame>, Error> {
    match initial {
        None | Some(Initial::FirstFrame) => clip.frame(span.first),
        Some(Initial::Median) => median_of((clip, SAMPLES), span, steady).map(Arc::new),
    }
}

/// Returns the per-pixel median of `most` frames spaced evenly over `span`, or over the part of it in which the camera has moved little,
/// if it is followed. A pixel is the median of the frames that show it. An object that covers a pixel in less than half of them
/// leaves no trace.
///
/// B. P. L. Lo and S. A. Velastin, Automatic congestion detection system for underground platforms, 2001.
pub fn median_of((clip, most): (&Clip, usize), span: &Span, steady: Option<Steadiness>) -> Result<Frame, Error> {
    let mut samples =
        sampled((clip, most), span, steady.is_some_and(|steady| steady.camera == CameraMotion::Followed))?;
    if steady.is_some_and(|steady| steady.exposure == Exposure::Compensated) {
        expose(&mut samples);
    }
    let (width, height) = clip.size();
    let colors: Option<Vec<_>> = samples.iter().map(|sample| sample.frame.color()).collect();
    let of = |(x, y): (usize, usize), value: &dyn Fn(usize, (usize, usize)) -> u8| {
        let shown = samples.iter().enumerate().filter_map(|(i, sample)| Some(value(i, sample.place((x, y))?)));
        median(&mut shown.collect::<Vec<u8>>())
    };
    Ok(match colors {
        Some(colors) => Frame::rgb(Grid::from_fn(width, height, |x, y| {
            [0, 1, 2].map(|channel| of((x, y), &|i, at| colors[i][at][channel]))
        })),
        None => Frame::gray(Grid::from_fn(width, height, |x, y| of((x, y), &|i, at| samples[i].frame.luma()[at]))),
    })
}

/// A frame, and the displacement of its content from the first one in whole px.
struct Sample {
    frame: Arc<Frame>,
    at: [f32; 2],
}

impl Sample {
    /// The pixel that shows what the first frame shows at a pixel, if it is in the frame.
    fn place(&self, (x, y): (usize, usize)) -> Option<(usize, usize)> {
        let [u, v] = self.at.map(|c| c.round() as isize);
        let (width, height) = self.frame.size();
        let at = (x.checked_add_signed(u)?, y.checked_add_signed(v)?);
        (at.0 < width && at.1 < height).then_some(at)
    }
}

/// Gives all frames the exposure of the first one.
fn expose(samples: &mut [Sample]) {
    let Some((first, others)) = samples.split_first_mut() else { return };
    for sample in others {
        let luma = first.frame.luma();
        let expected = super::displaced_by(sample.at, luma.size(), |at| f32::from(luma[at]));
        if let Some(transfer) = Transfer::between(sample.frame.luma(), expected) {
            sample.frame = Arc::new(transfer.undone(&sample.frame));
        }
    }
}

/// Returns frames spaced evenly over a span, at most `most`. Where the camera is followed, the last half of the span is left out as
/// long as too few of them are near the first.
fn sampled((clip, most): (&Clip, usize), span: &Span, is_followed: bool) -> Result<Vec<Sample>, Error> {
    let mut count = span.frames().unwrap_or(REACH);
    loop {
        let times = times((clip, most), (span, count))?;
        if !is_followed {
            let frame = |t: &usize| clip.wanted().and_then(|()| clip.frame(*t));
            return times.iter().map(|t| Ok(Sample { frame: frame(t)?, at: [0.0; 2] })).collect();
        }
        let near = aligned(clip, &times)?;
        if near.len() as f32 >= LEAST_ALIGNED * times.len() as f32 || count < 2 * most {
            return Ok(near.into_iter().map(|(frame, at)| Sample { frame, at }).collect());
        }
        count /= 2;
    }
}

/// Returns the positions in the clip of `most` frames spaced evenly over the first `count` of a span.
fn times((clip, most): (&Clip, usize), (span, count): (&Span, usize)) -> Result<Vec<usize>, Error> {
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
    Ok(times)
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

    /// Waves of several directions and lengths under a camera that moves by `by` px/frame; a bright object leaves the corner after two
    /// frames.
    fn drifting(by: [f32; 2], has_object: bool) -> Clip {
        let wave = |x: f32, y: f32| {
            128.0 + 40.0 * (0.21 * x + 0.07 * y).sin() + 35.0 * (0.11 * x - 0.19 * y).sin() + 30.0 * (0.31 * y).cos()
        };
        let frame = |t: usize| {
            let [u, v] = by.map(|c| (c * t as f32).round());
            Frame::gray(Grid::from_fn(160, 120, |x, y| match has_object && t < 2 && x >= 120 && y >= 90 {
                true => 250,
                false => wave(x as f32 - u, y as f32 - v) as u8,
            }))
        };
        Clip::from_frames("drifting", (0..40).map(frame).collect()).unwrap()
    }

    #[test]
    fn the_median_of_a_drifting_camera_has_no_object_of_the_first_frame() {
        // The slow one uncovers what only later frames show beside the object; the fast one is away from the first frame after 4 frames.
        for by in [[0.0, 0.0], [-0.1, 0.15], [0.1, -2.0]] {
            let clip = drifting(by, true);
            let span = Span::new(&clip, 0, 40).unwrap();
            let found = median_of((&clip, SAMPLES), &span, Some(Steadiness::default())).unwrap();
            let expected = drifting(by, false).frame(0).unwrap();
            let all = found.luma().cells().iter().zip(expected.luma().cells());
            let wrong = all.filter(|(found, expected)| found.abs_diff(**expected) > 4).count();
            assert!(wrong < 60, "{by:?}: {wrong} px");
        }
    }
}
