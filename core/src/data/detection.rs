//! Detections of a single frame.

use crate::geometry::Bounds;

/// A detection in a single frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detection {
    /// Its box.
    pub bounds: Bounds,
    /// Its position in px: the centroid of a blob, or the centre of the box.
    pub center: [f32; 2],
    /// The score of the detector, without a fixed scale; 1 where it has none.
    pub score: f32,
    /// Its blob, where its pixels are known.
    pub blob: Option<Blob>,
    /// Standard deviation of its position along each axis in px, where the source knows it.
    pub deviation_px: Option<f32>,
}

/// The shape of a connected region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blob {
    /// Its label, from 1.
    pub label: u32,
    /// Area in px.
    pub area_px: u32,
    /// Semi-axes in px of the ellipse of equal second moments, the longer one first.
    pub radii: [f32; 2],
    /// Angle of the longer axis from x toward y in radians, −π/2 to π/2.
    pub angle_rad: f32,
    /// Mean gray level.
    pub gray: f32,
    /// The displacement of the background since the first frame of the run in px, where the camera was followed.
    pub background_px: [f32; 2],
}
