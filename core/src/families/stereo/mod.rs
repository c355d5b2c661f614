//! Stereo: the disparity of two rectified views, and the scene flow that follows from it. One file per estimator; the shared parts are in `methods/stereo`.

mod block_stereo;
mod scene_flow;
mod semi_global_matching;

pub use crate::methods::scene_flow::EgoSettings;
pub use crate::methods::stereo::Settings;
pub use block_stereo::{BlockStereo, Cost};
pub use scene_flow::{SceneFlow, Source};
pub use semi_global_matching::{Paths, SemiGlobalMatching};
