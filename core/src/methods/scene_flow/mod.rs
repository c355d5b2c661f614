//! Scene flow: the motion of the cameras, estimated from points in space.
//!
//! `scene-flow` asks one stage for disparities in both frames and one for the flow, and follows each pixel. The measurements of
//! a pixel are a `Measured` (`data/scene_flow.rs`), from which position, displacement and covariance follow; the product
//! `SceneFlowField` holds the maps alone. `ego.rs` estimates the motion of the cameras from a grid of pixels. Without
//! calibration or right view the run has fewer stages and says why; measured depths (`DepthSource`) take the place of
//! disparities.

mod ego;

pub use ego::{Consensus, Draw, Ego, EgoSettings, FEWEST, Fit};
