//! What a run is given: a pair of frames in real numbers, and the truth about them.

use std::sync::Arc;

use crate::base::{Error, Threads};
use crate::data::{Clip, Flow};
use crate::geometry::{Beyond, Grid, filter};

/// A pair of frames, smoothed.
pub struct Given {
    /// Frames t and t + 1, in gray levels.
    pub pictures: [Grid<f32>; 2],
    /// Where each pixel really goes, if that is known.
    pub truth: Option<Arc<Flow>>,
}

impl Given {
    /// Frames `frame` and `frame + 1` of `clip`, smoothed by a Gaussian of `sigma_px`.
    ///
    /// # Errors
    /// If there is no such pair, or it cannot be read.
    pub fn new(clip: &Clip, frame: usize, sigma_px: f32, threads: &Threads) -> Result<Self, Error> {
        let pair = clip.pair(frame)?;
        let smooth = |i: usize| filter::smooth(pair[i].luma(), sigma_px, Beyond::Slope, threads);
        Ok(Self { pictures: [smooth(0), smooth(1)], truth: truth(clip, frame) })
    }

    /// Width and height in px.
    pub fn size(&self) -> (usize, usize) {
        self.pictures[0].size()
    }

    /// The pixel at `point`, if that lies in the picture.
    pub fn pixel_at(&self, point: [f32; 2]) -> Option<(usize, usize)> {
        self.pictures[0].cell_at(point)
    }

    /// Memory that it takes, in bytes; the truth is the clip's.
    pub fn bytes(&self) -> usize {
        self.pictures.iter().map(|picture| size_of_val(picture.cells())).sum()
    }

    /// The true displacement of a pixel, if it is known.
    pub fn true_displacement(&self, (x, y): (usize, usize)) -> Option<[f32; 2]> {
        self.truth.as_ref()?.at(x, y)
    }
}

/// Where the pixels of frame `frame` really go, if that is known.
pub fn truth(clip: &Clip, frame: usize) -> Option<Arc<Flow>> {
    // A truth that cannot be read is told where errors are; a run needs none.
    let truth = clip.truth().and_then(|truth| truth.flow(frame).ok().flatten());
    truth.filter(|truth| truth.0.size() == clip.size())
}
