//! The state of a corner detector that goes through the rows of a frame twice, then selects among the local maxima.

use std::sync::Arc;

use crate::data::Frame;
use crate::geometry::Grid;
use crate::products::{Feature, Keypoint, PointField};
use crate::run::{Granularity, Progress};

/// The state of a run with responses of type `T`.
#[derive(Clone)]
pub struct Scan<T> {
    /// Frame t.
    pub(crate) picture: Arc<Frame>,
    /// The response of each pixel; 0 where there is no corner, and in rows not yet computed.
    pub(crate) map: Arc<Grid<T>>,
    pub(crate) stage: Stage,
    /// The next row of this stage.
    pub(crate) row: usize,
    /// The local maxima; once ranked, in order of decreasing response.
    pub(crate) peaks: Vec<u32>,
    pub(crate) kept: Vec<u32>,
}

/// The stages of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// The responses, a row per unit.
    Response,
    /// Non-maximum suppression, a row per unit.
    Suppression,
    /// Selection by response and distance, in one unit.
    Choice,
}

impl<T: Copy + Default + PartialOrd + Into<f32>> Scan<T> {
    pub(crate) fn new(picture: Arc<Frame>) -> Self {
        let (width, height) = picture.size();
        let map = Arc::new(Grid::new(width, height, T::default()));
        Self { picture, map, stage: Stage::Response, row: 0, peaks: Vec::new(), kept: Vec::new() }
    }

    /// Returns the position of a row-major index.
    pub(crate) fn place(&self, index: u32) -> (usize, usize) {
        let width = self.map.width();
        (index as usize % width, index as usize / width)
    }

    pub(crate) fn response(&self, index: u32) -> T {
        self.map.cells()[index as usize]
    }

    /// Returns the position of the strongest local maximum.
    pub(crate) fn strongest(&self) -> Option<(usize, usize)> {
        let better = |a: u32, b: u32| if self.response(b) > self.response(a) { b } else { a };
        self.peaks.iter().copied().reduce(better).map(|peak| self.place(peak))
    }

    /// Goes on to the next row, after the last one to the next stage.
    pub(crate) fn next_row(&mut self) -> Progress {
        self.row += 1;
        if self.row == self.map.height() {
            let next = if self.stage == Stage::Response { Stage::Suppression } else { Stage::Choice };
            (self.stage, self.row) = (next, 0);
        }
        Progress::More
    }

    /// Returns the number of units: the rows of both passes, and the selection.
    pub(crate) fn units(&self) -> usize {
        2 * self.map.height() + 1
    }

    /// Returns the next frame, stage and row.
    pub(crate) fn granularities(&self) -> Vec<Granularity> {
        let granularity = |index, of| Granularity { index, of: Some(of) };
        let rows = if self.stage == Stage::Choice { 1 } else { self.map.height() };
        vec![granularity(0, 1), granularity(self.stage as usize, 3), granularity(self.row, rows)]
    }

    /// Returns the unit that explains a pixel: in its row of the first pass, or of the second one.
    pub(crate) fn unit_at(&self, point: [f32; 2]) -> Option<usize> {
        let (_, y) = self.map.cell_at(point)?;
        Some(if self.stage == Stage::Response { y } else { self.map.height() + y })
    }

    /// Returns the kept corners.
    pub(crate) fn features(&self) -> PointField {
        let feature = |&index: &u32| {
            let (x, y) = self.place(index);
            Feature::found([x as f32, y as f32])
        };
        PointField {
            picture: self.map.size(),
            points: self.kept.iter().map(feature).collect(),
            keypoints: self.kept.iter().map(|&index| Keypoint::of_response(self.response(index).into())).collect(),
        }
    }

    /// Memory of responses and corners in bytes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(self.map.cells()) + size_of_val(&self.peaks[..]) + size_of_val(&self.kept[..])
    }
}
