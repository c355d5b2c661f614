//! Everything about motion estimation that can be known without a screen, a file or a codec.
//!
//! An estimator is one file in the folder of its family. It implements [`Estimator`]; the registry,
//! [`estimators`], makes it known to the window, the command line and the laws that test it.

pub mod block_matching;
mod block_search;
mod clip;
mod coding;
pub mod compare;
mod consistency;
mod cost;
mod dense;
mod differential;
mod error;
mod estimator;
mod features;
mod grid;
mod histogram;
pub mod interest_points;
mod interpolation;
pub mod kalman;
mod levels;
pub mod lockstep;
pub mod memory;
pub mod metrics;
pub mod moving_objects;
pub mod objects;
pub mod optical_flow;
mod output;
pub mod params;
mod polynomial;
mod pyramid;
mod registry;
pub mod scene;
mod span;
mod stop;
mod streaks;
mod subtraction;
pub mod synth;
mod threads;
mod timeline;
pub mod tracking;
mod variational;
mod wide;
mod words;

pub use clip::{Clip, ClipInfo, Flow, Frame, FrameSource, ObjectBox, Truth};
pub use coding::Coding;
pub use consistency::{Agreement, Consistency};
pub use error::Error;
pub use estimator::{
    AnyEstimator, Count, Estimator, Explained, Extent, Info, Observer, Progress, Promise, Rung, Seen, run_observed,
};
pub use grid::{Border, Gray, Grid};
pub use histogram::{Counted, Histogram};
pub use interpolation::Interpolation;
pub use levels::{Floor, Level, Levels, Stack};
pub use lockstep::{Beside, Lockstep, Pace};
pub use objects::{Blob, Bounds, Detection, Followed, Life, Mask, Object, ObjectField, ObjectFrame, PackedMask};
pub use output::{
    Block, BlockField, BlockGrid, BlockVector, Confidence, DenseField, Feature, Output, PointField, Status, Track,
    TrackField, predict,
};
pub use params::{Params, Spec, Value};
pub use registry::{estimator, estimators};
pub use scene::{Role, Scene, Step};
pub use stop::Stop;
pub use streaks::{Streak, Streaks};
pub use threads::Threads;
pub use timeline::{Cursor, Move, Timeline, Walk, Way};
