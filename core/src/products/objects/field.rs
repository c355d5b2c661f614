//! Objects that are followed from frame to frame.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::trajectory::Trajectory;
use crate::data::{Detection, PackedMask};
use crate::geometry::Bounds;

/// Where an object stands in its life.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrackStatus {
    /// Seen too seldom to be confirmed.
    Tentative,
    /// Seen in this frame.
    Confirmed,
    /// Not seen in this frame, but expected back.
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

/// An object that is tracked, in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Object {
    /// Its identity, the same in every frame, from 1.
    pub id: u32,
    /// Its box.
    pub bounds: Bounds,
    /// Where it stands in its life.
    pub status: TrackStatus,
    /// The estimated place, in px.
    pub position: [f64; 2],
    /// Its velocity in px/frame, where that is estimated.
    pub velocity: Option<[f64; 2]>,
    /// The covariance of the position in px², by rows, where that is known.
    pub covariance: Option<[[f64; 2]; 2]>,
    /// The detection of this frame that belongs to it.
    pub detection: Option<usize>,
}

/// What one frame came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjectFrame {
    /// The pixels that do not belong to the background, where that was asked.
    pub mask: Option<PackedMask>,
    /// What was detected.
    pub detections: Vec<Detection>,
    /// The objects, by identity; none where [`Followed::Nothing`] is.
    pub objects: Vec<Object>,
}

/// Whom an estimator follows from frame to frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Followed {
    /// Nothing: each frame is looked at by itself.
    Nothing,
    /// One object at a time, with the true identities that these had, as far as they are known.
    One(BTreeSet<u32>),
    /// All.
    All,
}

/// What was found in frame after frame.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectField {
    /// Whom it is about.
    pub followed: Followed,
    /// Width and height of the picture in px.
    pub picture: (usize, usize),
    /// The first frame.
    pub first: usize,
    /// What it and those that follow came to.
    pub frames: Vec<Arc<ObjectFrame>>,
    /// The ways of the objects, where they were looked at.
    pub trajectories: Vec<Arc<Trajectory>>,
}

impl ObjectFrame {
    /// The object with an identity, if it is there.
    pub fn object(&self, id: u32) -> Option<&Object> {
        self.place(id).map(|place| &self.objects[place])
    }

    /// Where among the objects that is.
    pub(crate) fn place(&self, id: u32) -> Option<usize> {
        self.objects.binary_search_by_key(&id, |object| object.id).ok()
    }

    /// Memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        size_of::<Self>()
            + self.mask.as_ref().map_or(0, PackedMask::bytes)
            + size_of_val(&self.detections[..])
            + size_of_val(&self.objects[..])
    }
}
