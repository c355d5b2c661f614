//! Motion segmentation: clusterings of points, the flow that is segmented, labels that stay from frame to frame.
//!
//! A [`Segmenter`] divides the flow of a frame ([`FlowInput`]) in rounds and adds it to a [`Record`]; [`SegmentationRun`] makes
//! an estimator of it. `relabel` pairs the labels of a frame with those of the previous one, moved by the flow, so that colours
//! stay. [`Points`] stores coordinates apart, in chunks of a fixed length, so that an assignment to means vectorises and its
//! sums do not depend on the number of threads. Affine motions of blocks are points as well, scaled so that their squared
//! distance is the mean squared difference over the picture (`affine.rs`).

pub(crate) mod affine;
pub(crate) mod explain;
pub(crate) mod forest;
pub(crate) mod input;
pub(crate) mod kmeans;
pub(crate) mod mixture;
pub mod points;
pub(crate) mod record;
pub(crate) mod run;
pub(crate) mod seeds;
pub(crate) mod shift;
pub(crate) mod spectral;

pub use input::{FlowInput, FlowSource};
pub use points::{Place, Points, squared_distance};
pub use record::Record;
pub use run::{SegmentationRun, Segmenter, SegmenterState};
