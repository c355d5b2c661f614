//! Estimators and their runs: to the end, step by step in both directions, side by side, and as stages of others.

mod any;
mod cursor;
mod estimator;
mod facets;
pub mod lockstep;
pub mod need;
mod span;
pub mod stage;
mod timeline;
mod walk;

pub use any::{AnyEstimator, AnyRun, CountedRun, Extent, RunSummary};
pub use cursor::Cursor;
pub use estimator::{
    Estimator, FRAME, Granularity, Guarantee, Info, LEVEL, Progress, ROW, Seen, run_counted, run_observed,
};
pub use facets::{Explained, Footprint, Pointed, StageView, TestsCandidates};
pub use lockstep::Pace;
pub use need::Need;
pub use span::{FRAMES, Span};
pub use stage::{
    BlockVectors, Course, DenseFlow, Disparities, Entries, Entry, FeatureTracks, Foreground, Frames, GlobalModel,
    Keypoints, Masks, Stage, Tracks,
};
pub use timeline::Timeline;
pub use walk::{Beside, CandidateCount, Direction, Move, Walk};
