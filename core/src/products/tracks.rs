//! Feature tracks over several frames.

use std::sync::Arc;

use super::keypoints::{counts, row};
use super::{
    Assessment, Cell, Feature, Motion, PointField, Product, ProductKind, Reference, Status, Table, flow_error,
    keypoints,
};
use crate::base::Error;
use crate::data::Flow;

/// The feature tracks of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackField {
    /// Width and height of the picture in px.
    pub picture: (usize, usize),
    /// The first frame.
    pub first: usize,
    /// The last frame.
    pub last: usize,
    /// The tracks in the order of their first frames.
    pub tracks: Vec<Arc<Track>>,
}

/// The track of one feature.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Its first frame.
    pub first: usize,
    /// The feature in that frame and those that follow: tracked in all but the last, where it is lost or the run ends.
    pub points: Vec<Feature>,
}

impl Track {
    /// The track of a feature that is detected in frame `first`.
    pub fn begin(first: usize, at: [f32; 2]) -> Self {
        Self { first, points: vec![Feature::found(at)] }
    }

    /// Stores the outcome of tracking from its last frame, and its position in the next one, unless it is lost.
    pub fn record(&mut self, outcome: Feature, next: Option<[f32; 2]>) {
        if let Some(last) = self.points.last_mut() {
            *last = outcome;
        }
        self.points.extend(next.map(Feature::found));
    }

    /// Returns the feature in frame `t`.
    pub fn at(&self, t: usize) -> Option<&Feature> {
        self.points.get(t.checked_sub(self.first)?)
    }

    /// Returns whether the feature is not lost.
    pub fn is_alive(&self) -> bool {
        self.points.last().is_some_and(|point| point.status == Status::Found)
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>() + size_of_val(&self.points[..])
    }
}

impl TrackField {
    /// Returns the frames that features were tracked from.
    pub fn frames(&self) -> std::ops::Range<usize> {
        self.first..self.last
    }

    /// Returns the features in frame `t`.
    pub fn at(&self, t: usize) -> PointField {
        let points = self.tracks.iter().filter_map(|track| track.at(t).copied()).collect();
        PointField { picture: self.picture, points, keypoints: Vec::new() }
    }
}

impl Product for TrackField {
    const KIND: &'static ProductKind = &ProductKind {
        id: "feature-tracks",
        name: "Feature tracks",
        summary: "Features tracked over several frames.",
        motion: Motion::Points,
        is_of_single_frames: false,
        has_pictures: false,
        measures: &[&keypoints::MEASURES, &flow_error::MEASURES],
    };

    /// The position, displacement and status of each track in each frame.
    fn table(&self) -> Option<Table> {
        let columns = ["track", "frame", "x_px", "y_px", "u_px", "v_px", "status", "residual"];
        let rows = self.tracks.iter().enumerate().flat_map(|(number, track)| {
            track.points.iter().enumerate().map(move |(i, point)| -> [Cell; 8] {
                let [x, y, u, v, status, residual] = row(point);
                [(number + 1).into(), (track.first + i).into(), x, y, u, v, status, residual]
            })
        });
        Some(Table::new(columns, rows))
    }

    fn assess(&self, reference: &Reference<'_>) -> Result<Assessment, Error> {
        let alive = self.tracks.iter().filter(|track| track.is_alive()).count();
        let own = counts(self.tracks.len(), Some(alive));
        let moved =
            |frame| self.at(frame).points.iter().filter_map(|point| Some((point.at, point.displacement?))).collect();
        Ok(own.and(flow_error::of_frames(self.frames().map(|frame| (frame, moved(frame))), reference)))
    }

    /// The displacements of the features tracked from the last frame but one.
    fn flow(&self) -> Option<Flow> {
        Some(self.frames().last().map_or_else(|| self.at(0), |t| self.at(t)).flow())
    }

    fn last_frame(&self) -> Option<usize> {
        Some(self.last)
    }
}
