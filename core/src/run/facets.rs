//! What is asked of estimators beside their work: memory, candidates, and what a person points at.

use super::{Cursor, Need};
use crate::data::Clip;
use crate::params::Value;
use crate::scene::{Focus, Picture};

/// The memory that an estimator takes, whose states are `S`.
pub trait Footprint<S: Clone> {
    /// Memory that a run on a clip takes, known before it starts: about the most, beside the frames of the clip. A run for which
    /// there is not so much is refused.
    fn need(&self, clip: &Clip) -> Need;

    /// The state as a checkpoint keeps it: without what [`Estimator::advance`](super::Estimator::advance) makes again where it
    /// is missing.
    fn at_rest(&self, state: &S) -> S {
        state.clone()
    }

    /// Memory that one state at rest takes by itself, in bytes, for the budget of checkpoints.
    fn state_bytes(&self, state: &S) -> usize;

    /// Memory of all that a run needs beside the two frames, in bytes: what its states share as well.
    fn memory_bytes(&self, state: &S) -> usize {
        self.state_bytes(state)
    }
}

/// A search that tests candidates for blocks, one at an event `E`, and has states `S`.
pub trait TestsCandidates<S, E> {
    /// The units that lead to the result of block `block`, the last one being that which finds it.
    fn way_to(&self, _state: &S, block: usize) -> Vec<usize> {
        vec![block]
    }

    /// Whether a candidate is tested at `event`: what estimators beside each other are counted by.
    fn is_evaluation(&self, event: &E) -> bool;

    /// How many such events each unit had that `state` has behind it.
    fn evaluations(&self, state: &S) -> Vec<u32>;
}

/// From when on a pixel can be explained by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Explained {
    /// At every step, since each is about all pixels.
    Always,
    /// From this place of the run on: there it is its turn.
    From(Cursor),
}

impl Explained {
    /// Whether that is so at `cursor`.
    pub fn at(self, cursor: Cursor) -> bool {
        match self {
            Self::Always => true,
            Self::From(turn) => turn <= cursor,
        }
    }
}

/// What the stages of an estimator look at, where that is not the pair of the clip that it works on.
#[derive(Clone, Debug)]
pub struct StageView {
    /// The clip of whose first pair they run.
    pub clip: Clip,
    /// The values that it gives to parameters which it decides.
    pub set: Vec<(&'static str, Value)>,
}

/// An estimator that has something to show where a person points, and has states `S`.
pub trait Pointed<S> {
    /// Whether pixels of `picture` can be pointed at: a click on frame t + 1 is not one on frame t.
    fn takes(&self, picture: Picture) -> bool {
        picture == Picture::CURRENT
    }

    /// The unit whose result lies at `focus`, for a click on the stage.
    fn unit_at(&self, _state: &S, _focus: Focus) -> Option<usize> {
        None
    }

    /// From when on the pixel at `focus` can be explained by itself; `None` where the unit that lies there is what
    /// is explained, or nothing lies there. Before that nobody sees what a pixel will come to by pointing at it.
    fn explained(&self, _state: &S, _focus: Focus) -> Option<Explained> {
        None
    }
}
