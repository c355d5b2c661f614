//! Correspondence of keypoints and the motion that explains it, one file each; the shared parts are in `methods/matching` and
//! `methods/geometric`.

mod epipolar_geometry;
mod feature_matching;
mod global_motion;

pub use epipolar_geometry::EpipolarGeometry;
pub use feature_matching::FeatureMatching;
pub use global_motion::GlobalMotion;
