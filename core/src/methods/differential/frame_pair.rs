//! The input of a run: a pair of frames in real numbers, with its ground truth.

use std::sync::Arc;

use crate::base::{Error, Threads, effort};
use crate::data::{Clip, Flow};
use crate::geometry::{Beyond, Grid, filter};

/// A pair of smoothed frames with its ground truth.
pub struct FramePair {
    /// Frames t and t + 1, in gray levels.
    pub pictures: [Grid<f32>; 2],
    /// The true flow, if it is known.
    pub truth: Option<Arc<Flow>>,
}

impl FramePair {
    /// Reads frames `frame` and `frame + 1` of `clip`, smoothed by a Gaussian of standard deviation `sigma_px`.
    ///
    /// # Errors
    /// If there is no such pair, or it cannot be read.
    pub fn new(clip: &Clip, frame: usize, sigma_px: f32, threads: &Threads) -> Result<Self, Error> {
        let pair = clip.pair(frame)?;
        let smooth = |i: usize| filter::smooth(pair[i].luma(), sigma_px, Beyond::Slope, threads);
        Ok(Self { pictures: [smooth(0), smooth(1)], truth: truth(clip, frame) })
    }

    /// Returns width and height in px.
    pub fn size(&self) -> (usize, usize) {
        self.pictures[0].size()
    }

    /// Returns the pixel at `point`, if that lies in the frame.
    pub fn pixel_at(&self, point: [f32; 2]) -> Option<(usize, usize)> {
        self.pictures[0].cell_at(point)
    }

    /// Returns the inner pixel with the largest product of spatial gradient and temporal difference, |∇I| |I_t|; the first of
    /// several: an example with both texture and change.
    pub fn strongest_constraint(&self) -> (usize, usize) {
        let [current, next] = &self.pictures;
        effort::add(current.cells().len());
        let squared = |(x, y): (usize, usize)| {
            let across = current[(x + 1, y)] - current[(x - 1, y)];
            let down = current[(x, y + 1)] - current[(x, y - 1)];
            (across * across + down * down) * (next[(x, y)] - current[(x, y)]).powi(2)
        };
        let (width, height) = self.size();
        let inner = (1..height.saturating_sub(1)).flat_map(|y| (1..width.saturating_sub(1)).map(move |x| (x, y)));
        let strongest =
            inner.map(|place| (place, squared(place))).reduce(|most, next| if next.1 > most.1 { next } else { most });
        strongest.map_or((0, 0), |(place, _)| place)
    }

    /// Returns the size in memory, in bytes, without the ground truth, which the clip holds.
    pub fn bytes(&self) -> usize {
        self.pictures.iter().map(|picture| size_of_val(picture.cells())).sum()
    }

    /// Returns the true displacement of a pixel, if it is known.
    pub fn true_displacement(&self, (x, y): (usize, usize)) -> Option<[f32; 2]> {
        self.truth.as_ref()?.at(x, y)
    }
}

/// The true flow of frame `frame`, if it is known.
pub fn truth(clip: &Clip, frame: usize) -> Option<Arc<Flow>> {
    // A run needs no truth; unreadable truth is reported where errors are computed.
    let truth = clip.truth().and_then(|truth| truth.flow(frame).ok().flatten());
    truth.filter(|truth| truth.0.size() == clip.size())
}
