//! Geometric models from correspondences: least squares, the normalised DLT, and robust estimation by RANSAC.

pub mod epipolar;
pub mod fit;
mod moments;
mod normalisation;
pub(crate) mod planar;
pub(crate) mod ransac;
pub(crate) mod rectify;
pub(crate) mod refine;
pub mod robust;
mod sampson;
pub mod system;

/// A correspondence: the positions of a point in frame t and in frame t + 1 in px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correspondence {
    /// Position in frame t.
    pub from: [f64; 2],
    /// Position in frame t + 1.
    pub to: [f64; 2],
}
