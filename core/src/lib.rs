//! Everything about motion estimation that can be known without a screen, a file or a codec.
//!
//! An estimator is one file in the folder of its family. It implements [`Estimator`]; the registry,
//! [`estimators`], makes it known to the window, the command line and the laws that test it.
//!
//! A run makes products: [`Output::get`] gives each by its kind.
//!
//! ```
//! use motionscope_core::{BlockField, Threads, estimator, synth};
//!
//! let sample = synth::scene("pillar")?;
//! let clip = synth::make(sample.id, &sample.difficulty())?;
//! let mut search = estimator("diamond")?;
//! search.set("block", "8")?;
//! let output = search.run(&clip, 0, &Threads::all()?)?;
//! let blocks = output.get::<BlockField>().expect("a block search makes block vectors");
//! println!("{} candidates for {} blocks", blocks.candidates(), blocks.vectors.len());
//! # assert!(blocks.candidates() > 0);
//! # Ok::<(), motionscope_core::Error>(())
//! ```
//!
//! The same run can be walked through, in both directions, with a sentence for every step:
//!
//! ```
//! use motionscope_core::{Cursor, Move, Way, estimator, synth};
//!
//! # let sample = synth::scene("pillar")?;
//! # let clip = synth::make(sample.id, &sample.difficulty())?;
//! let mut walk = estimator("diamond")?.walk(&clip, 0)?;
//! walk.jump(Move::To(Cursor { unit: 34, event: 2 }));
//! let there = walk.step(None).sentence;
//! println!("{}", there.plain());
//! let event = walk.info().rungs.len() - 1;
//! walk.jump(Move::Rung(event, Way::Forward));
//! walk.jump(Move::Rung(event, Way::Back));
//! assert_eq!(walk.step(None).sentence, there);
//! # Ok::<(), motionscope_core::Error>(())
//! ```
//!
//! An estimator can be a stage of another, with parameters of its own:
//!
//! ```
//! use motionscope_core::estimator;
//!
//! let mut tracker = estimator("kalman-tracker")?;
//! tracker.set("detector", "mixture-of-gaussians")?;
//! tracker.set("detector.rate", "0.01")?;
//! assert!(tracker.set("detector", "full-search").unwrap_err().to_string().contains("makes block vectors"));
//! # Ok::<(), motionscope_core::Error>(())
//! ```

mod any;
pub mod block_matching;
mod block_search;
mod bounds;
mod clip;
mod coding;
pub mod compare;
mod consistency;
mod cost;
mod cursor;
mod detection;
mod differential;
mod entropy;
mod error;
mod estimator;
mod features;
mod grid;
mod heap;
mod histogram;
pub mod interest_points;
mod interpolation;
pub mod kalman;
mod levels;
pub mod lockstep;
pub mod metrics;
pub mod moving_objects;
mod need;
pub mod objects;
mod observer;
pub mod optical_flow;
pub mod params;
mod polynomial;
pub mod products;
pub mod pseudocode;
mod pyramid;
mod registry;
mod role;
mod rows;
pub mod scene;
mod span;
pub mod stage;
mod stop;
mod streaks;
mod subtraction;
pub mod synth;
pub mod table;
mod threads;
mod timeline;
pub mod tracking;
mod variational;
mod walk;
mod wide;
mod words;

/// Memory: how much is free, and what a run needs.
pub mod memory {
    pub use crate::heap::{ASSUMED_FREE, free, measure_with};
    pub use crate::need::Need;
}

pub use any::{AnyEstimator, AnyRun, Extent};
pub use bounds::Bounds;
pub use clip::{Clip, ClipInfo, Flow, Frame, FrameSource, ObjectBox, Truth};
pub use coding::Coding;
pub use consistency::{Agreement, Consistency};
pub use cursor::Cursor;
pub use detection::{Blob, Detection};
pub use error::Error;
pub use estimator::{Estimator, Explained, Info, Progress, Promise, Rung, Seen, run_observed};
pub use grid::{Border, Gray, Grid};
pub use histogram::{Counted, Histogram};
pub use interpolation::Interpolation;
pub use levels::{Floor, Level, Levels, Stack};
pub use lockstep::{Lockstep, Pace};
pub use objects::{Followed, Life, Mask, Object, ObjectField, ObjectFrame, PackedMask};
pub use observer::{Count, Observer};
pub use params::{Params, Spec, Value};
pub use products::{
    Block, BlockField, BlockGrid, BlockVector, Confidence, DenseField, Feature, MaskField, Output, PointField, Product,
    ProductKind, Status, Track, TrackField, predict,
};
pub use registry::{estimator, estimators};
pub use role::Role;
pub use scene::{Scene, Step};
pub use stop::Stop;
pub use streaks::{Streak, Streaks};
pub use threads::Threads;
pub use timeline::Timeline;
pub use walk::{Beside, Move, Walk, Way};
pub use words::{grouped, spaced};
