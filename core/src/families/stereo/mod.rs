//! Stereo: the disparity of two rectified views. One file per estimator; the shared parts are in `methods/stereo`.

mod block_stereo;
mod semi_global_matching;

pub use block_stereo::{BlockStereo, Cost};
pub use semi_global_matching::{Paths, SemiGlobalMatching};
