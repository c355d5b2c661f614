//! What is found in one frame by itself.

use crate::geometry::Bounds;

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
