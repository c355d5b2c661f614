//! Moving objects: from pixels that do not look like the background to blobs. One file per estimator; the shared parts are
//! in `methods/subtraction`.

mod compensated_difference;
mod connected_components;
mod flow_magnitude;
mod frame_difference;
mod knn_background;
mod median_background;
mod mixture_of_gaussians;
mod running_average;
mod single_gaussian;

pub use crate::methods::subtraction::{
    CameraMotion, Channels, Differencing, Exposure, Initial, Settings, ShadowDetection, Steadiness, Subtraction,
};
pub use compensated_difference::CompensatedDifference;
pub use connected_components::{ConnectedComponents, Pixels};
pub use flow_magnitude::FlowMagnitude;
pub use frame_difference::FrameDifference;
pub use knn_background::KnnBackground;
pub use median_background::MedianBackground;
pub use mixture_of_gaussians::MixtureOfGaussians;
pub use running_average::RunningAverage;
pub use single_gaussian::SingleGaussian;
