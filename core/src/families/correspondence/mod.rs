//! Correspondence of pictures and the motion that explains it, one file each; shared parts are in `methods/matching` and
//! `methods/geometric`.

mod epipolar_geometry;
mod feature_matching;
mod global_motion;
mod image_alignment;
mod phase_correlation;
mod template_matching;

pub use epipolar_geometry::EpipolarGeometry;
pub use feature_matching::FeatureMatching;
pub use global_motion::GlobalMotion;
pub use image_alignment::ImageAlignment;
pub use phase_correlation::PhaseCorrelation;
pub use template_matching::TemplateMatching;
