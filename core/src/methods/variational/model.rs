//! The interface of a variational method.

use std::sync::{Arc, OnceLock};

use super::Settings;
use crate::base::Threads;
use crate::methods::differential::{Advice, Field, Linear, relax, unit_of};
use crate::params::Params;
use crate::run::{Guarantee, Info};
use crate::scene::{Case, Constraint, Name, Question, Role, Step, Unit, Value, Variable};

/// The unknowns of the minimisation: the flow field and any auxiliary variables.
pub trait Unknowns: Clone + Send + Sync + 'static {
    /// Initialises a warp at the flow `start`; `last` are the unknowns of the previous warp on the same level.
    fn begin(start: &Field, last: Option<&Self>) -> Self;

    /// Returns the flow field.
    fn field(&self) -> &Field;

    /// Returns the size in memory, in bytes.
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

/// A method that minimises an energy of the whole flow field.
pub trait Model: Params + Default + Clone + Send + Sync + 'static {
    /// The method's name, source and pseudocode.
    const INFO: Info;
    /// As [`Estimator::QUESTIONS`](crate::run::Estimator::QUESTIONS).
    const QUESTIONS: &'static [Question];
    /// The guaranteed accuracy.
    const GUARANTEE: Guarantee;
    /// The unit of the energy.
    const ENERGY_UNIT: &'static str;
    /// The explanation of the energy, at the start of a run.
    const OPENING: &'static Case;
    /// Remedies where the method fails.
    const ADVICE: Advice;
    /// Numbers per pixel in [`Model::System`].
    const SYSTEM_PARTS: usize;
    /// Upper bound of the memory per pixel of a run and of a stepped run, in bytes.
    const NEED: [f64; 2];
    /// Coefficients that all iterations of a warp share.
    type System: Send + Sync + 'static;
    /// The unknowns of the minimisation.
    type Unknowns: Unknowns;

    /// Returns the parameters that all variational methods share.
    fn settings(&self) -> Settings;

    /// Returns the pseudocode lines of the steps of an iteration.
    fn steps(&self) -> &'static [Name];

    /// Returns the subject of the last step's formula.
    fn last_formula(&self) -> &'static str {
        "update"
    }

    /// Computes the coefficients of a warp.
    fn system(&self, linear: &Linear, threads: &Threads) -> Self::System;

    /// Does `count` iterations of a warp, starting at `from`.
    fn iterate(&self, warp: &Warp<Self>, from: &Self::Unknowns, count: usize, threads: &Threads) -> Self::Unknowns;

    /// The same, with the mean change of the flow in the last iteration, in px.
    fn iterate_measured(
        &self,
        warp: &Warp<Self>,
        from: &Self::Unknowns,
        count: usize,
        threads: &Threads,
    ) -> (Self::Unknowns, f64) {
        let before = (count > 1).then(|| self.iterate(warp, from, count - 1, threads));
        let before = before.as_ref().unwrap_or(from);
        let to = self.iterate(warp, before, 1, threads);
        let change = relax::change(before.field(), to.field());
        (to, change)
    }

    /// Returns the data term and the smoothness term of the energy, per pixel.
    fn energy(&self, warp: &Warp<Self>, at: &Self::Unknowns) -> [f64; 2];

    /// Returns the share of the smoothness term in the update of a pixel, 0 to 1, where it follows from the constraint alone.
    fn smoothness_share(&self, _linear: &Linear, _place: (usize, usize)) -> Option<f32> {
        None
    }

    /// Explains the step `index` of an iteration at a pixel; `step` has the values that all methods share.
    fn explanation(&self, index: usize, probe: &Probe<Self>, step: Step) -> Explanation;
}

/// A linearisation: the constraints of one warp.
pub struct Warp<M: Model> {
    /// The gradient constraints.
    pub linear: Linear,
    /// The method's coefficients.
    pub system: M::System,
}

/// Energy, change and error of an iteration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Note {
    /// The iteration in the run, from 1.
    pub(super) number: usize,
    /// Its level and its warp, from 0.
    pub(super) place: (usize, usize),
    /// Data term and smoothness term, per pixel.
    pub(super) data: f32,
    pub(super) smoothness: f32,
    /// Mean change of the flow, in px of level 0.
    pub(super) change: f32,
    /// Mean endpoint error in px of level 0; NaN without truth.
    pub(super) error: f32,
}

/// A completed iteration.
pub struct Iteration<M: Model> {
    /// Its warp.
    pub warp: Arc<Warp<M>>,
    /// The unknowns before it.
    pub from: Arc<M::Unknowns>,
    /// The unknowns after it.
    pub to: Arc<M::Unknowns>,
    /// Whether it met the stopping criterion; `None` where that was not tested.
    pub(super) has_converged: Option<bool>,
    /// Energy, change and error.
    pub(super) note: OnceLock<Note>,
}

impl<M: Model> Iteration<M> {
    pub(super) fn new(warp: Arc<Warp<M>>, [from, to]: [Arc<M::Unknowns>; 2], has_converged: Option<bool>) -> Self {
        Self { warp, from, to, has_converged, note: OnceLock::new() }
    }
}

/// An iteration at one pixel of its level.
pub struct Probe<'a, M: Model> {
    /// The iteration.
    pub iteration: &'a Iteration<M>,
    /// The pixel.
    pub place: (usize, usize),
    /// The level; 0 is full resolution.
    pub level: usize,
    /// Size of a pixel of the level in px of level 0, horizontally and vertically.
    pub scale: [f32; 2],
}

impl<M: Model> Probe<'_, M> {
    /// Returns a, b and c of the constraint a u + b v + c = 0.
    pub fn factors(&self) -> [f32; 3] {
        self.iteration.warp.linear.factors.at(self.place)
    }

    /// Returns the flow before the iteration, in px of the level.
    pub fn from(&self) -> [f32; 2] {
        self.iteration.from.field().at(self.place.0, self.place.1)
    }

    /// Returns the flow after the iteration, in px of the level.
    pub fn to(&self) -> [f32; 2] {
        self.iteration.to.field().at(self.place.0, self.place.1)
    }

    /// Whether the constraint is known: (u₀, v₀) stays within frame t + 1.
    pub fn is_known(&self) -> bool {
        self.iteration.warp.linear.factors.is_known(self.place)
    }

    /// Returns the flow (u₀, v₀) of the linearisation, if frame t + 1 was warped.
    pub fn start(&self) -> Option<[f32; 2]> {
        let start = &self.iteration.warp.linear.start;
        (!start.is_zero()).then(|| start.at(self.place.0, self.place.1))
    }

    /// Returns the unit of flow on the level.
    pub fn unit(&self) -> Unit {
        unit_of(self.level)
    }

    /// Returns the value of a flow vector in px of the level.
    pub fn px(&self, of: &'static Variable, uv: [f32; 2]) -> Value {
        of.is(uv).in_unit(self.unit())
    }
}

/// The explanation of one step of an iteration.
pub struct Explanation {
    /// The step, with values, sentence and formulas.
    pub step: Step,
    /// Points of the (u, v) plane beside the flow before the step and the true flow.
    pub points: Vec<(&'static str, Role, [f32; 2])>,
    /// Constraint lines.
    pub lines: Vec<Constraint>,
    /// The energy that the step minimises over the flow of the pixel, where it does, in [`Model::ENERGY_UNIT`] up to a constant.
    pub energy: Option<Box<dyn Fn([f32; 2]) -> f32>>,
}
