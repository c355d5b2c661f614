//! A scene at any time, from either viewpoint: of moving layers, or of bodies in space.

use super::layer::{self, TrackPoint};
use super::motion::Affine;
use super::shape::Point;
use super::space::{self, Space};
use super::texture::Rgb;
use crate::data::{Calibration, Pose, Viewpoint};

/// What a scene consists of.
pub enum Stage {
    /// Layers, seen by one camera.
    Flat(layer::Stage),
    /// Bodies in space, seen by two.
    Deep(Space),
}

impl Stage {
    /// Whether it has objects to be tracked.
    pub fn has_objects(&self) -> bool {
        match self {
            Self::Flat(stage) => stage.has_objects(),
            Self::Deep(space) => space.has_objects(),
        }
    }

    /// The pose of a rigid object at frame `t`, where it is known.
    pub fn pose(&self, id: u32, t: f64) -> Option<Pose> {
        match self {
            Self::Flat(_) => None,
            Self::Deep(space) => space.pose(id, t),
        }
    }

    /// The motion of all that is at rest from frame `t` to the next one, where it is known.
    pub fn ego_motion(&self, t: f64) -> Option<Pose> {
        match self {
            Self::Flat(_) => None,
            Self::Deep(space) => space.ego_motion(t),
        }
    }

    /// Whether two cameras see it.
    pub fn is_stereo(&self) -> bool {
        matches!(self, Self::Deep(_))
    }

    /// The calibration of its cameras, if there are two and it is the same in all frames.
    pub fn calibration(&self) -> Option<Calibration> {
        match self {
            Self::Flat(_) => None,
            Self::Deep(space) => space.calibration(),
        }
    }

    /// Everything in its place at frame `t`, which need not be whole, from the left or only viewpoint.
    pub fn at(&self, t: f64) -> Moment<'_> {
        self.seen_from(Viewpoint::Left, t)
    }

    /// The same from any viewpoint; layers look the same from both.
    pub fn seen_from(&self, viewpoint: Viewpoint, t: f64) -> Moment<'_> {
        match self {
            Self::Flat(stage) => Moment::Flat(stage.at(t)),
            Self::Deep(space) => Moment::Deep(space.seen_from(viewpoint, t)),
        }
    }
}

/// A scene at one moment from one viewpoint.
pub enum Moment<'a> {
    /// Layers.
    Flat(layer::Moment<'a>),
    /// Bodies in space.
    Deep(space::Moment<'a>),
}

impl Moment<'_> {
    /// The colour that the pixel at `p` sees.
    pub fn color(&self, p: Point) -> Rgb {
        match self {
            Self::Flat(moment) => moment.color(p),
            Self::Deep(moment) => moment.color(p),
        }
    }

    /// Number of the foremost surface at `p`.
    pub fn foremost(&self, p: Point) -> Option<usize> {
        match self {
            Self::Flat(moment) => moment.foremost(p),
            Self::Deep(moment) => moment.foremost(p),
        }
    }

    /// Whether surface `index` is an object.
    pub fn is_object(&self, index: usize) -> bool {
        match self {
            Self::Flat(moment) => moment.is_object(index),
            Self::Deep(moment) => moment.is_object(index),
        }
    }

    /// Where the point of surface `index` that is at `p` now is in `other`, another moment or viewpoint, and whether it is hidden there or
    /// outside the picture.
    pub fn follow(&self, index: usize, p: Point, other: &Self) -> Option<(Point, bool)> {
        match (self, other) {
            (Self::Flat(now), Self::Flat(then)) => {
                let to = now.carry(index, p, then)?;
                Some((to, !then.in_picture(to) || then.hides(index, to)))
            }
            (Self::Deep(now), Self::Deep(then)) => now.follow(index, p, then),
            _ => None,
        }
    }

    /// The disparity that the point of surface `index` that is at `p` now has at another moment, seen from both viewpoints.
    pub fn disparity_in(&self, index: usize, p: Point, other: &[Self; 2]) -> Option<f64> {
        match (self, other) {
            (Self::Deep(now), [Self::Deep(left), Self::Deep(right)]) => now.disparity_in(index, p, [left, right]),
            _ => None,
        }
    }

    /// The map of the rearmost layer from now to the moment `next`; `None` if it bends, or there are no layers.
    pub fn background(&self, next: &Self) -> Option<Affine> {
        match (self, next) {
            (Self::Flat(now), Self::Flat(next)) => now.background(next),
            _ => None,
        }
    }

    /// As [`layer::Moment::sightings`].
    pub fn sightings(&self) -> Vec<TrackPoint> {
        match self {
            Self::Flat(moment) => moment.sightings(),
            Self::Deep(moment) => moment.sightings(),
        }
    }
}
