//! What is given, and what is seen of it: clips with their truth, masks and the components in them, detections.

mod clip;
mod components;
mod detection;
mod histogram;
mod interpolation;
mod mask;
mod morphology;
mod pose;
mod scene_flow;
mod stereo;
mod true_mask;

pub use clip::{Clip, ClipInfo, DepthSource, Flow, Frame, FrameSource, ObjectBox, Truth};
pub(crate) use components::area_opened;
pub use components::{Connectivity, Event as LabelEvent, Finals, Labelling, Run};
pub use detection::{Blob, Detection};
pub use histogram::{Counted, Histogram};
pub(crate) use interpolation::Between;
pub use interpolation::Interpolation;
pub use mask::{Mask, PackedMask};
pub use morphology::MAX_RADIUS_PX;
pub use pose::Pose;
pub(crate) use scene_flow::mahalanobis_squared;
pub use scene_flow::{Measured, Sigma, SpaceMotion};
pub use stereo::{Calibration, Disparity, Viewpoint};
pub use true_mask::{MaskErrors, PixelClass, TrueMask};
