//! What makes a variational method.

use std::sync::Arc;

use super::Settings;
use crate::base::{Threads, words};
use crate::methods::differential::{Field, Linear, explain};
use crate::params::Params;
use crate::run::{Guarantee, Info};
use crate::scene::{Constraint, Fact, Math, Name, Role, Sentence};

/// What iterations change: a field, and whatever else goes with it.
pub trait Unknowns: Clone + Send + Sync + 'static {
    /// Those with which a warp begins at `start`; `last` are those of the warp before on the same level.
    fn begin(start: &Field, last: Option<&Self>) -> Self;

    /// The displacements.
    fn field(&self) -> &Field;

    /// Memory that they take, in bytes.
    fn bytes(&self) -> usize;
}

impl Unknowns for Field {
    fn begin(start: &Field, _: Option<&Self>) -> Self {
        start.clone()
    }

    fn field(&self) -> &Field {
        self
    }

    fn bytes(&self) -> usize {
        2 * size_of_val(self.u.cells())
    }
}

/// A method that makes an energy of the whole field small.
pub trait Model: Params + Default + Clone + Send + Sync + 'static {
    /// What there is to say about the method.
    const INFO: Info;
    /// What it can be relied on to find.
    const GUARANTEE: Guarantee;
    /// The lines of the pseudocode in whose steps an iteration is told.
    const STEPS: &'static [Name];
    /// What the energy is measured in.
    const ENERGY_UNIT: &'static str;
    /// What is said before anything was done.
    const OPENING: &'static str;
    /// How many numbers for each pixel [`Model::System`] holds.
    const SYSTEM_PARTS: usize;
    /// Memory that a run takes for each pixel at most, in bytes, and one that is walked through.
    const NEED: [f64; 2];
    /// What is worked out from the constraints once for all iterations of a warp.
    type System: Send + Sync + 'static;
    /// What iterations change.
    type Unknowns: Unknowns;

    /// The parameters that all variational methods have.
    fn settings(&self) -> Settings;

    /// What all iterations of a warp need.
    fn system(&self, linear: &Linear, threads: &Threads) -> Self::System;

    /// `count` iterations of a warp from `from` on.
    fn iterate(&self, warp: &Warp<Self>, from: &Self::Unknowns, count: usize, threads: &Threads) -> Self::Unknowns;

    /// The parts of the energy for data and for smoothness, on average over the pixels.
    fn energy(&self, warp: &Warp<Self>, at: &Self::Unknowns) -> [f64; 2];

    /// How step `step` of an iteration is told at a pixel.
    fn told(&self, step: usize, looked: &Looked<Self>) -> Told;
}

/// The constraints of a warp.
pub struct Warp<M: Model> {
    /// Those of the pixels.
    pub linear: Linear,
    /// What the method makes of them.
    pub system: M::System,
}

/// An iteration that was done.
pub struct Iteration<M: Model> {
    /// The warp it belongs to.
    pub warp: Arc<Warp<M>>,
    /// What it went from.
    pub from: Arc<M::Unknowns>,
    /// What it came to.
    pub to: Arc<M::Unknowns>,
    /// The pixel that changes most; the first of several.
    pub most: (usize, usize),
}

/// An iteration at one pixel of its level.
pub struct Looked<'a, M: Model> {
    /// The iteration.
    pub iteration: &'a Iteration<M>,
    /// The pixel.
    pub place: (usize, usize),
    /// The level, 0 being the picture itself.
    pub level: usize,
    /// How many px of the picture one of the level is, across and down.
    pub scale: [f32; 2],
}

impl<M: Model> Looked<'_, M> {
    /// Its derivatives a and b, and c of the constraint a u + b v + c = 0.
    pub fn factors(&self) -> [f32; 3] {
        self.iteration.warp.linear.factors.at(self.place)
    }

    /// Its displacement before the iteration, in px of the level.
    pub fn from(&self) -> [f32; 2] {
        self.iteration.from.field().at(self.place.0, self.place.1)
    }

    /// Its displacement after the iteration, in px of the level.
    pub fn to(&self) -> [f32; 2] {
        self.iteration.to.field().at(self.place.0, self.place.1)
    }

    /// Whether the constraint of the pixel is known, and not that of one that left the picture.
    pub fn is_known(&self) -> bool {
        self.iteration.warp.linear.factors.is_known(self.place)
    }

    /// The displacement (u₀, v₀) by which frame t + 1 was brought back to the pixel, if it was brought back.
    pub fn start(&self) -> Option<[f32; 2]> {
        let start = &self.iteration.warp.linear.start;
        (!start.is_zero()).then(|| start.at(self.place.0, self.place.1))
    }

    /// What stands for I_t in the constraint.
    pub fn rest(&self) -> Math {
        if self.start().is_some() { Math::Var("c") } else { explain::derivative("t") }
    }

    /// What that is, where it is not I_t.
    pub fn definition(&self) -> Vec<Math> {
        let definition = || self.iteration.warp.linear.definition(self.place, Role::Reference);
        self.start().map(|_| definition().to_vec()).unwrap_or_default()
    }

    /// A displacement in px of the level as it is told.
    pub fn px(&self, uv: [f32; 2]) -> String {
        format!("{} {}", words::vector(uv), self.unit())
    }

    /// What displacements on the level are measured in.
    pub fn unit(&self) -> String {
        if self.level == 0 { "px".into() } else { format!("px of level {}", self.level) }
    }

    /// What the pixel is called.
    pub fn pixel(&self) -> String {
        format!("pixel ({}, {})", self.place.0, self.place.1)
    }
}

/// How a step of an iteration is told.
pub struct Told {
    /// What happens to the pixel, and why.
    pub sentence: Sentence,
    /// What there is to say about it beside its derivatives and its displacement before.
    pub facts: Vec<Fact>,
    /// What is done, in symbols and with its numbers.
    pub equation: Vec<Math>,
    /// Displacements to be shown beside the one before and the true one.
    pub points: Vec<(&'static str, Role, [f32; 2])>,
    /// What is shown of the constraints.
    pub lines: Vec<Constraint>,
}
