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
//! search.set("block-size", "8")?;
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
//! use motionscope_core::{Cursor, Move, Direction, estimator, synth};
//!
//! # let sample = synth::scene("pillar")?;
//! # let clip = synth::make(sample.id, &sample.difficulty())?;
//! let mut walk = estimator("diamond")?.walk(&clip, 0)?;
//! walk.jump(Move::To(Cursor { unit: 34, event: 2 }));
//! let there = walk.step(None).sentence;
//! println!("{}", there.plain());
//! let event = walk.info().granularities.len() - 1;
//! walk.jump(Move::Granularity(event, Direction::Forward));
//! walk.jump(Move::Granularity(event, Direction::Back));
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

mod base;
mod course;
mod data;
mod families;
mod geometry;
mod methods;
pub mod params;
pub mod products;

mod run;
pub mod scene;
pub mod synth;

/// Memory: how much is free, and what a run needs.
pub mod memory {
    pub use crate::base::heap::{ASSUMED_FREE, free, measure_with};
    pub use crate::run::Need;
}

/// Work in pixels, counted where whole pictures are gone through.
pub mod effort {
    pub use crate::base::effort::pixels;
}

/// The points of a clustering.
pub mod segmentation {
    pub use crate::methods::segmentation::points::{MOST_DIMENSIONS, Place, Points, Tally, squared_distance};
}

/// What moving objects are told with, from pixels that differ to objects with a past.
pub mod objects {
    pub use crate::data::{
        Blob, Connectivity, Detection, Finals, LabelEvent, Labelling, MAX_RADIUS_PX, Mask, PackedMask, Run,
    };
    pub use crate::geometry::Bounds;
    pub use crate::methods::multi_object::{Extent, directions, source};
    pub use crate::products::objects::*;
}

pub use base::words::{capital, fixed, grouped, nearest, spaced, with_power};
pub use base::{Count, Error, Observer, Stop, Tally, Threads, is_command, printable};
pub use course::{compare, detection, estimator, estimators, examples, glossary};
pub use data::{
    Blob, Calibration, Clip, ClipInfo, Counted, DepthSource, Detection, Disparity, Flow, Frame, FrameSource, Histogram,
    Interpolation, Mask, MaskErrors, ObjectBox, PackedMask, PixelClass, Pose, TrueMask, Truth, Viewpoint,
};
pub use families::{
    block_matching, correspondence, interest_points, motion_segmentation, moving_objects, optical_flow,
    region_tracking, stereo, tracking,
};
pub use geometry::{Border, Bounds, Gray, Grid};
pub use methods::{geometric, kalman};
pub use params::{Params, Spec, Value};
pub use products::{
    Agreement, Block, BlockField, BlockGrid, BlockVector, Coding, Confidence, Consistency, DenseField, Descriptor,
    DisparityField, EpipolarField, Feature, Followed, Keypoint, MaskField, Match, MatchField, MatchStatus, Model,
    ModelField, Object, ObjectField, ObjectFrame, Output, PathField, PointField, Product, ProductKind, Region,
    RegionField, RegionFrame, SceneFlowField, Segment, SegmentField, SegmentFrame, Status, Streak, Streaks, Track,
    TrackField, TrackStatus, Watched, metrics, predict, table,
};
pub use run::{
    AnyEstimator, AnyRun, Beside, CandidateCount, Cursor, Direction, Estimator, Explained, Extent, FRAME, FRAMES,
    Footprint, Granularity, Guarantee, Info, LEVEL, Move, Pace, Pointed, Progress, ROW, RunSummary, Seen, StageView,
    TestsCandidates, Timeline, Walk, lockstep, run_observed, stage,
};
pub use scene::{Floor, Level, Levels, Role, Scene, Stack, Step, pseudocode};
