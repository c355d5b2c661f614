//! Motion segmentation: clusterings of points, the flow that is segmented, labels that stay from frame to frame.

pub mod affine;
pub mod explain;
pub mod forest;
pub mod input;
pub mod kmeans;
pub mod mixture;
pub mod points;
pub mod record;
pub mod run;
pub mod seeds;
pub mod shift;
pub mod spectral;

pub use input::{FlowInput, FlowSource};
pub use points::{Place, Points, squared_distance};
pub use record::Record;
pub use run::{SegmentationRun, Segmenter, SegmenterState};
