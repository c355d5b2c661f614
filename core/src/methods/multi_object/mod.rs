//! Multi-object tracking: sources of detections, track management, and the explanation of both.
//!
//! [`MultiTracking`] turns any `MultiTracker` into an estimator; the state that all of them share is a `TrackerRun`. A
//! `Detector` supplies detections: rows of a file, ground truth with noise, or a stage. `Dynamics` are the noise parameters of
//! the filters, `gating.rs` finds the pairs inside the gates, and `partial.rs` completes the box of a blob of which one side is
//! hidden. Trackers that weigh explanations share the probabilities of detections (`chances.rs`) and rank explanations as
//! assignments (`products/objects/k_best.rs`). Events hold filters, from which a step recomputes its matrices.
//!
//! The product is an `ObjectField` with the mask, detections and objects of each frame; `Followed` says which objects are
//! tracked, which determines scores, tables and files.

pub(crate) mod chances;
pub(crate) mod density;
pub mod directions;
mod drawing;
pub(crate) mod dynamics;
pub(crate) mod explain;
mod extent;
pub(crate) mod gating;
pub(crate) mod lifecycle;
pub(crate) mod partial;
pub(crate) mod selected;
pub mod source;
mod tables;
pub(crate) mod tracker_run;
pub(crate) mod tracking;
pub(crate) mod truth;
pub(crate) mod vocabulary;

pub use extent::Extent;
pub use tracking::MultiTracking;
