//! Correspondence of pictures and the motion that explains it, one file each; shared parts are in `methods/matching` and
//! `methods/geometric`.

mod epipolar_geometry;
mod feature_matching;
mod feature_tracker;
mod global_motion;
mod image_alignment;
mod mosaic;
mod phase_correlation;
mod stabilization;
mod template_matching;

pub use crate::methods::camera_path::Blending;
pub use crate::methods::correlation::Score;
pub use crate::methods::geometric::ransac::Scoring;
pub use crate::methods::geometric::robust::Robust;
pub use crate::methods::matching::{DescriptorKind, PatchCost, Settings};
pub use epipolar_geometry::{EpipolarGeometry, Sampling};
pub use feature_matching::FeatureMatching;
pub use feature_tracker::FeatureTracker;
pub use global_motion::GlobalMotion;
pub use image_alignment::ImageAlignment;
pub use mosaic::Mosaic;
pub use phase_correlation::{PhaseCorrelation, Subpixel};
pub use stabilization::Stabilization;
pub use template_matching::{Method, TemplateMatching, Update};
