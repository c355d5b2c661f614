//! Tracked objects, frame by frame.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::trajectory::Trajectory;
use crate::data::{Detection, PackedMask};
use crate::geometry::Bounds;

/// The status of a track.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrackStatus {
    /// Not matched often enough to be confirmed.
    Tentative,
    /// Confirmed and matched in this frame.
    Confirmed,
    /// Not matched in this frame: predicted only.
    Coasting,
}

impl TrackStatus {
    /// Kebab-case name, for tables.
    pub fn name(self) -> &'static str {
        match self {
            TrackStatus::Tentative => "tentative",
            TrackStatus::Confirmed => "confirmed",
            TrackStatus::Coasting => "coasting",
        }
    }
}

/// A tracked object in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Object {
    /// Its identity, the same in every frame, from 1.
    pub id: u32,
    /// Its box.
    pub bounds: Bounds,
    /// The status of its track.
    pub status: TrackStatus,
    /// The estimated position in px.
    pub position: [f64; 2],
    /// Its velocity in px/frame, where that is estimated.
    pub velocity: Option<[f64; 2]>,
    /// The covariance of the position in px², by rows, where that is known.
    pub covariance: Option<[[f64; 2]; 2]>,
    /// The index of its detection in this frame.
    pub detection: Option<usize>,
}

/// The results of one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjectFrame {
    /// The foreground mask, where one was computed.
    pub mask: Option<PackedMask>,
    /// The detections.
    pub detections: Vec<Detection>,
    /// The objects, by identity; none where [`Followed::Nothing`] is.
    pub objects: Vec<Object>,
}

/// The objects that an estimator tracks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Followed {
    /// None: each frame is processed by itself.
    Nothing,
    /// One object at a time, with the true identities of all of them, where known.
    One(BTreeSet<u32>),
    /// All.
    All,
}

/// The detections and tracks of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectField {
    /// The objects that are tracked.
    pub followed: Followed,
    /// Width and height of the picture in px.
    pub picture: (usize, usize),
    /// The first frame.
    pub first: usize,
    /// Its results and those of the frames that follow.
    pub frames: Vec<Arc<ObjectFrame>>,
    /// The trajectories of the tracks, where they were analysed.
    pub trajectories: Vec<Arc<Trajectory>>,
    /// The lines and zones of that analysis.
    pub watched: Watched,
}

/// The number of lines and zones at which trajectories are counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Watched {
    /// Counting lines.
    pub lines: usize,
    /// Zones of dwell times.
    pub zones: usize,
}

impl ObjectFrame {
    /// Returns the object with an identity, if it is in the frame.
    pub fn object(&self, id: u32) -> Option<&Object> {
        self.place(id).map(|place| &self.objects[place])
    }

    /// Returns the index of that object.
    pub(crate) fn place(&self, id: u32) -> Option<usize> {
        self.objects.binary_search_by_key(&id, |object| object.id).ok()
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>()
            + self.mask.as_ref().map_or(0, PackedMask::bytes)
            + size_of_val(&self.detections[..])
            + size_of_val(&self.objects[..])
    }
}
