//! Active contours: a closed curve around an object is fitted to each frame, from where it was in the frame before.
//!
//! Here are the start of the curve, the edges that attract it, the judgement of a fit, and what all contours explain alike.

mod edges;
pub(crate) mod explain;
mod fit;
mod pentadiagonal;
mod snake;
mod start;
pub(crate) mod vocabulary;

use std::sync::Arc;

pub(crate) use edges::{Edges, Force};
pub use fit::Fit;
pub(crate) use pentadiagonal::Pentadiagonal;
pub use snake::Snake;
pub(crate) use snake::Verdict;
pub use start::Placement;

use crate::data::{Mask, PackedMask};
use crate::geometry::polygon;
use crate::products::{Region, RegionFrame};

/// A place in px.
pub type Point = [f64; 2];

/// A contour that encloses less has collapsed, in px².
pub(crate) const LEAST_AREA_PX: f64 = 16.0;

/// The contour of the last frame.
#[derive(Clone, Debug)]
pub struct Model {
    /// Its points, clockwise as seen on the picture.
    pub points: Arc<[Point]>,
    /// Width and height of the picture in px.
    pub picture: (usize, usize),
    /// The result of the frame.
    pub result: RegionFrame,
}

impl Model {
    /// The model after a fit; a lost one leaves contour and region as they were `before`.
    pub(crate) fn of(
        picture: (usize, usize),
        (before, region): (&Arc<[Point]>, Region),
        points: Vec<Point>,
        &Verdict { strength: similarity, is_lost, .. }: &Verdict,
    ) -> Self {
        match polygon::bounds(&points).filter(|_| !is_lost) {
            Some(bounds) => {
                let result = RegionFrame { region: bounds.into(), similarity, is_lost: false };
                Self { points: points.into(), picture, result }
            }
            None => {
                let result = RegionFrame { region, similarity, is_lost: true };
                Self { points: Arc::clone(before), picture, result }
            }
        }
    }

    /// The pixels inside.
    pub(crate) fn mask(&self) -> PackedMask {
        PackedMask::new(&filled(&self.points, self.picture))
    }

    /// Memory in bytes.
    pub(crate) fn bytes(&self) -> usize {
        size_of::<Self>() + size_of_val(&self.points[..])
    }
}

/// The pixels of a picture inside a closed curve.
pub(crate) fn filled(points: &[Point], picture: (usize, usize)) -> Mask {
    const BITS: usize = u64::BITS as usize;
    let mut mask = Mask::new(picture.0, picture.1);
    polygon::fill(points, picture, |y, xs| {
        mask.write_row(y, |words| xs.for_each(|x| words[x / BITS] |= 1 << (x % BITS)));
    });
    mask
}
