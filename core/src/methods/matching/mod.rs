//! Matching of keypoints by their descriptors: nearest neighbours, ratio test and cross-check.
//!
//! Keypoints come from a stage with their descriptors, or are described by `describe.rs`. A `MatchField` has every nearest
//! neighbour with the outcome of its tests; `Scene::links` draws matches from picture to picture.

mod describe;
mod nearest;
mod settings;

pub use describe::{Described, DescriptorKind, PatchCost};
pub use nearest::{Admits, Candidates, Event, Neighbors, Outcome};
pub use settings::{Pair, Settings};
