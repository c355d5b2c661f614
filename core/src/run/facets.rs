//! Further traits of estimators: memory, candidates, and pixels pointed at.

use super::{Cursor, Need};
use crate::data::Clip;
use crate::params::Value;
use crate::scene::{Focus, Picture};

/// The memory of an estimator with states `S`.
pub trait Footprint<S: Clone> {
    /// Estimated peak memory of a run on a clip, without the frames of the clip. A run without enough memory is refused.
    fn need(&self, clip: &Clip) -> Need;

    /// The state as a checkpoint keeps it: without the parts that [`Estimator::advance`](super::Estimator::advance) recomputes if they
    /// are missing.
    fn at_rest(&self, state: &S) -> S {
        state.clone()
    }

    /// Memory of a single state at rest in bytes, for the budget of checkpoints.
    fn state_bytes(&self, state: &S) -> usize;

    /// Memory of a run without the two frames in bytes, including what its states share.
    fn memory_bytes(&self, state: &S) -> usize {
        self.state_bytes(state)
    }
}

/// A search that tests candidates for blocks, one at an event `E`, and has states `S`.
pub trait TestsCandidates<S, E> {
    /// The units that lead to the result of block `block`, the last of which finds it.
    fn way_to(&self, _state: &S, block: usize) -> Vec<usize> {
        vec![block]
    }

    /// Whether `event` tests a candidate: the count of estimators in lockstep.
    fn is_evaluation(&self, event: &E) -> bool;

    /// Number of such events of each unit before `state`.
    fn evaluations(&self, state: &S) -> Vec<u32>;
}

/// The first step at which a pixel can be explained by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Explained {
    /// At every step, since each is about all pixels.
    Always,
    /// From this position of the run, at which the pixel is processed.
    From(Cursor),
}

impl Explained {
    /// Whether the pixel can be explained at `cursor`.
    pub fn at(self, cursor: Cursor) -> bool {
        match self {
            Self::Always => true,
            Self::From(turn) => turn <= cursor,
        }
    }
}

/// The frames that the stages of an estimator read, if not the current pair of the clip.
#[derive(Clone, Debug)]
pub struct StageView {
    /// The clip on whose first pair they run.
    pub clip: Clip,
    /// The values of the parameters that it decides.
    pub set: Vec<(&'static str, Value)>,
}

/// An estimator with states `S` that explains pixels pointed at.
pub trait Pointed<S> {
    /// Whether pixels of `picture` can be pointed at: a click on frame t + 1 is not one on frame t.
    fn takes(&self, picture: Picture) -> bool {
        picture == Picture::CURRENT
    }

    /// The unit with its result at `focus`, for a click on the stage.
    fn unit_at(&self, _state: &S, _focus: Focus) -> Option<usize> {
        None
    }

    /// The first step at which the pixel at `focus` can be explained by itself, so that no result shows in advance; `None` where
    /// its unit is explained instead, or there is none.
    fn explained(&self, _state: &S, _focus: Focus) -> Option<Explained> {
        None
    }

    /// The identity of the object at `focus`, where a click selects an object rather than a pixel.
    fn object_at(&self, _state: &S, _focus: Focus) -> Option<u32> {
        None
    }

    /// Where an object is, or was last, so that its selection follows it; `None` before it is there.
    fn place_of(&self, _state: &S, _object: u32) -> Option<[f32; 2]> {
        None
    }
}
