//! The two views of a scene at one moment.

use std::sync::Arc;

use crate::base::Error;
use crate::data::{Calibration, Clip, Disparity, Frame, Viewpoint};
use crate::products::disparity::signs;
use crate::scene::{Canvas, Picture};

/// The left view, and the right one or what serves as one, with what is known about both.
pub(crate) struct Views {
    pub left: Arc<Frame>,
    pub right: Arc<Frame>,
    /// Whether the clip has a right view; else frame t + 1 serves as one.
    pub is_stereo: bool,
    pub calibration: Option<Calibration>,
    /// The true disparities, if they are known and of the size of the views.
    pub truth: Option<Arc<Disparity>>,
}

impl Views {
    /// The views of frame `t`. Without a right view, frame `t + 1` serves as one, as of a camera that moves to the right.
    ///
    /// # Errors
    /// If a frame cannot be read. Truth that cannot be read is not known.
    pub fn new(clip: &Clip, t: usize) -> Result<Self, Error> {
        let is_stereo = clip.right().is_some();
        let [left, right] = match is_stereo {
            true => [clip.frame(t)?, clip.frame_from(Viewpoint::Right, t)?],
            false => clip.pair(t)?,
        };
        let truth = clip.truth().filter(|_| is_stereo).and_then(|truth| truth.disparity(t).ok().flatten());
        let truth = truth.filter(|truth| truth.0.size() == left.size());
        let calibration = clip.calibration().filter(|_| is_stereo).copied();
        Ok(Self { left, right, is_stereo, calibration, truth })
    }

    /// Width and height in px.
    pub fn size(&self) -> (usize, usize) {
        self.left.size()
    }

    /// The picture that the left view is matched with.
    pub fn second(&self) -> Picture {
        if self.is_stereo { Picture::RIGHT } else { Picture::NEXT }
    }

    /// Name of the picture.
    pub fn second_name(&self) -> &'static str {
        if self.is_stereo { "right view" } else { "frame t + 1" }
    }

    /// Both as pictures of a step.
    pub fn canvases(&self) -> Vec<Canvas> {
        vec![Canvas::of_clip(Picture::CURRENT), Canvas::of_clip(self.second())]
    }

    /// The warning about views that seem to be swapped or not rectified, if they do.
    pub fn warning(&self, disparities: usize) -> Option<String> {
        self.is_stereo.then(|| signs([self.left.luma(), self.right.luma()], disparities).warning()).flatten()
    }

    /// Memory that both views and the truth take.
    pub fn bytes(&self) -> usize {
        let truth = self.truth.as_ref().map_or(0, |truth| size_of_val(truth.0.cells()));
        self.left.bytes() + self.right.bytes() + truth
    }
}
