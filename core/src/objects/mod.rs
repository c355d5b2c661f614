//! What moving objects are told with, from pixels that differ to objects with a past: masks, detections, objects.

pub mod assignment;
mod components;
pub(crate) mod course;
pub mod directions;
mod extent;
pub(crate) mod lives;
mod mask;
mod morphology;
pub(crate) mod near;
pub mod pairs;
mod record;
pub mod score;
pub mod source;
pub(crate) mod tell;
pub mod trajectory;

use std::collections::BTreeSet;
use std::sync::Arc;

pub use components::{Connectivity, Event as LabelEvent, Finals, Labelling, Run};
pub use extent::Extent;
pub use mask::{Mask, PackedMask};
pub use morphology::MAX_RADIUS_PX;
pub use record::Record;

use crate::ObjectBox;
use trajectory::Trajectory;

/// An axis-parallel rectangle by its outer edges, in px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Left and top edge; that of the first pixel lies at −0.5.
    pub min: [f32; 2],
    /// Right and bottom edge.
    pub max: [f32; 2],
}

impl Bounds {
    /// The rectangle of a width and height around a centre.
    pub fn around(center: [f32; 2], size: [f32; 2]) -> Self {
        Self { min: [0, 1].map(|i| center[i] - size[i] / 2.0), max: [0, 1].map(|i| center[i] + size[i] / 2.0) }
    }

    /// The centre.
    pub fn center(&self) -> [f32; 2] {
        [0, 1].map(|i| (self.min[i] + self.max[i]) / 2.0)
    }

    /// Width and height.
    pub fn size(&self) -> [f32; 2] {
        [0, 1].map(|i| self.max[i] - self.min[i])
    }

    /// The same rectangle elsewhere.
    #[must_use]
    pub fn moved(&self, by: [f32; 2]) -> Self {
        let add = |corner: [f32; 2]| [0, 1].map(|i| corner[i] + by[i]);
        Self { min: add(self.min), max: add(self.max) }
    }

    /// The area in px².
    pub fn area(&self) -> f32 {
        let [width, height] = self.size();
        width.max(0.0) * height.max(0.0)
    }

    /// The area in px² that both have in common.
    fn shared_area(&self, other: &Bounds) -> f32 {
        let both = Bounds {
            min: [0, 1].map(|i| self.min[i].max(other.min[i])),
            max: [0, 1].map(|i| self.max[i].min(other.max[i])),
        };
        both.area()
    }

    /// Intersection over union, 0 to 1.
    pub fn iou(&self, other: &Bounds) -> f32 {
        let (shared, all) = (self.shared_area(other), self.area() + other.area());
        if shared > 0.0 { shared / (all - shared) } else { 0.0 }
    }

    /// The intersection as a share of the smaller one, 0 to 1.
    pub fn shared(&self, other: &Bounds) -> f32 {
        let (shared, smaller) = (self.shared_area(other), self.area().min(other.area()));
        if shared > 0.0 { shared / smaller } else { 0.0 }
    }
}

impl From<&ObjectBox> for Bounds {
    fn from(object: &ObjectBox) -> Self {
        let min = [object.x, object.y];
        Self { min, max: [min[0] + object.width, min[1] + object.height] }
    }
}

/// Something that was found in one frame by itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detection {
    /// Its box.
    pub bounds: Bounds,
    /// Where it is: its centroid, or the centre of its box.
    pub center: [f32; 2],
    /// How sure the detector is, as large as it likes; 1 where it does not say.
    pub score: f32,
    /// What it looks like, where its pixels are known.
    pub blob: Option<Blob>,
}

/// The shape of a connected region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blob {
    /// Its label, from 1.
    pub label: u32,
    /// Pixels.
    pub area_px: u32,
    /// Half axes in px of the ellipse with the same second moments, the longer one first.
    pub radii: [f32; 2],
    /// From x towards y to the longer axis, in radians, −π/2 to π/2.
    pub angle_rad: f32,
    /// Mean gray value.
    pub gray: f32,
}

/// Where an object stands in its life.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Life {
    /// Seen too seldom to be believed in.
    Tentative,
    /// Seen in this frame.
    Confirmed,
    /// Not seen in this frame, but expected back.
    Coasting,
}

impl Life {
    /// Kebab-case name, for tables.
    pub fn name(self) -> &'static str {
        match self {
            Life::Tentative => "tentative",
            Life::Confirmed => "confirmed",
            Life::Coasting => "coasting",
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
    pub life: Life,
    /// Where it is believed to be, in px.
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
    /// The objects, by identity; none where [`Followed::Nobody`] is.
    pub objects: Vec<Object>,
}

/// Whom an estimator follows from frame to frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Followed {
    /// Nobody: each frame is looked at by itself.
    Nobody,
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
