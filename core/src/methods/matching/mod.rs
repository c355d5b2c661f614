//! Matching of keypoints by their descriptors: nearest neighbours, ratio test and cross-check.

mod describe;
mod nearest;
mod settings;

pub use describe::Described;
pub use nearest::{Admits, Candidates, Event, Neighbors, Outcome};
pub use settings::{Pair, Settings};
