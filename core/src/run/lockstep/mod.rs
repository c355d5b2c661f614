//! Several estimators in lockstep: beside each other on the same frames, each a step further at every step.
//!
//! The [`Pace`] decides what a step is. Block searches can be held at the same block and candidate (`candidates.rs`);
//! all others at the stops of a granularity that they share, such as a frame or an iteration (`stops.rs`).
//!
//! Either is a [`Walk`] itself, so stepping needs no special case; [`Walk::beside`] returns the step and the scene of each
//! member. `companions` says which estimators can go together, and why others cannot.

mod candidates;
mod stops;

use candidates::Candidates;
use stops::Stops;

use super::{AnyEstimator, Cursor, Direction, Info, Move, Walk};
use crate::base::{Error, Threads};
use crate::choices;
use crate::data::Clip;
use crate::params::{Kind, Parameter, Value};
use crate::scene::Focus;

choices! {
    /// The common position of estimators in lockstep at every step.
    pub enum Pace {
        /// All are at the same block, and have tested as many candidates for it.
        Block = "block" "same block",
        /// The same number of candidates tested in the whole picture; the run ends with that of the first estimator.
        Budget = "budget" "same budget",
        /// All are at the same frame of the clip.
        Frame = "frame" "same frame",
        /// All have done as many iterations.
        Iteration = "iteration" "same iteration",
        /// All have finished as many levels of their pyramids.
        Level = "level" "same level",
        /// All have finished as many stages of their computation.
        Stage = "stage" "same stage",
        /// The results of whole runs.
        Result = "result" "results",
    }
}

/// Maximum number of members.
pub const MEMBERS: std::ops::RangeInclusive<usize> = 2..=4;

/// The stops of an estimator in lockstep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stride {
    /// Every unit of its run, with the events inside.
    Unit,
    /// The ends of the groups of a granularity.
    Group(usize),
    /// The end of its run.
    Run,
}

impl Pace {
    /// Every pace, in the order in which they are offered.
    pub const ALL: [Self; 7] =
        [Self::Block, Self::Budget, Self::Frame, Self::Iteration, Self::Level, Self::Stage, Self::Result];

    /// The description of a run in lockstep at this pace.
    pub fn info(self) -> &'static Info {
        match self {
            Self::Block | Self::Budget => const { &info(&["frame", "block", "step"]) },
            Self::Frame => const { &info(&["clip", "frame", "step"]) },
            Self::Iteration => const { &info(&["frame", "iteration", "step"]) },
            Self::Level => const { &info(&["frame", "level", "step"]) },
            Self::Stage => const { &info(&["frame", "stage", "step"]) },
            Self::Result => const { &info(&["frame", "result", "step"]) },
        }
    }

    /// Its name in commands and files.
    pub fn name(self) -> &'static str {
        match self.to_value() {
            Value::Choice(name) => name,
            _ => "",
        }
    }

    /// The common position of the estimators, as a sentence.
    pub fn sentence(self) -> &'static str {
        match self {
            Self::Block => "All are at the same block, and have tested as many candidates for it.",
            Self::Budget => "All have tested as many candidates in the whole picture; the first one leads.",
            Self::Frame => "All are at the same frame of the clip.",
            Self::Iteration => "All have done as many iterations.",
            Self::Level => "All have finished as many levels of their pyramids.",
            Self::Stage => "All have finished as many stages of their computation.",
            Self::Result => "The results of whole runs.",
        }
    }

    /// Whether candidates are counted.
    pub fn counts_candidates(self) -> bool {
        matches!(self, Self::Block | Self::Budget)
    }

    /// The stops of an estimator at this pace, if it has any.
    fn stride(self, estimator: &dyn AnyEstimator) -> Option<Stride> {
        let names: &[&str] = match self {
            Self::Block | Self::Budget => return estimator.tests_candidates().then_some(Stride::Unit),
            Self::Result => return Some(Stride::Run),
            Self::Frame => &["frame", "pair"],
            Self::Iteration => &["iteration"],
            Self::Level => &["level"],
            Self::Stage => &["stage"],
        };
        let all = estimator.info().granularities;
        // The outermost granularity is the whole run, the innermost an event.
        let unit = all.len() - 2;
        let index = (1..=unit).find(|index| names.contains(&all[*index]))?;
        Some(if index == unit { Stride::Unit } else { Stride::Group(index) })
    }

    /// Whether `estimators` can go at this pace.
    fn suits(self, estimators: &[&dyn AnyEstimator]) -> bool {
        estimators.iter().all(|estimator| self.stride(*estimator).is_some())
    }
}

/// The declaration of a run of several estimators, with these granularities.
const fn info(granularities: &'static [&'static str]) -> Info {
    Info {
        id: "lockstep",
        name: "Lockstep",
        family: "Comparison",
        summary: "Several estimators on the same frames, in lockstep.",
        source: "as for each estimator",
        pseudocode: &[],
        granularities,
        frames: 2,
    }
}

/// The paces at which `estimators` can go in lockstep, the usual one first; none where they cannot.
pub fn paces(estimators: &[&dyn AnyEstimator]) -> Vec<Pace> {
    Pace::ALL.into_iter().filter(|pace| apart(estimators).is_none() && pace.suits(estimators)).collect()
}

/// The first of `estimators` that cannot run in lockstep with the leader.
fn apart<'a>(estimators: &[&'a dyn AnyEstimator]) -> Option<&'a dyn AnyEstimator> {
    let span = |estimator: &dyn AnyEstimator| estimator.info().granularities[0];
    let (leader, others) = estimators.split_first()?;
    others.iter().find(|other| span(**other) != span(*leader)).copied()
}

/// Rejects estimators that cannot go in lockstep.
///
/// # Errors
/// If there are too few or too many, or one works on a pair of frames and another one on a whole clip.
pub fn check(estimators: &[&dyn AnyEstimator]) -> Result<(), Error> {
    let count = estimators.len();
    if !MEMBERS.contains(&count) {
        return Err(Error::new(format!("2 to 4 estimators can run side by side, not {count}")));
    }
    let Some(other) = apart(estimators) else { return Ok(()) };
    let [leader, other] = [estimators[0], other].map(AnyEstimator::info);
    let (pair, clip) = if leader.granularities[0] == "clip" { (other, leader) } else { (leader, other) };
    Err(Error::new(format!(
        "{} works on a pair of frames and {} on a whole clip, so they cannot run in lockstep",
        pair.name, clip.name
    )))
}

/// The runs of `estimators` on `frame` in lockstep, at their start. For a budget, each is run once on `threads`.
///
/// # Errors
/// If they cannot go together, not at this pace, block searches do not have the same blocks, or one cannot run.
pub fn walk(
    estimators: &[&dyn AnyEstimator],
    pace: Pace,
    (clip, frame): (&Clip, usize),
    threads: &Threads,
) -> Result<Box<dyn Walk>, Error> {
    check(estimators)?;
    if !pace.suits(estimators) {
        let ids: Vec<_> = estimators.iter().map(|estimator| estimator.info().id).collect();
        let offered: Vec<_> = paces(estimators).iter().map(|pace| pace.name()).collect();
        return Err(Error::new(format!(
            "{} cannot run in lockstep by {}; choose {}",
            ids.join(" and "),
            pace.name(),
            offered.join(" or ")
        )));
    }
    Ok(match pace.counts_candidates() {
        true => Box::new(Candidates::new(estimators, pace, (clip, frame), threads)?),
        false => Box::new(Stops::new(estimators, pace, (clip, frame))?),
    })
}

/// The names of `estimators`, whole and short; those that are there more than once have the values in which they differ, and of
/// these the short name consists.
pub fn names(estimators: &[&dyn AnyEstimator]) -> Vec<[String; 2]> {
    let name = |estimator: &&dyn AnyEstimator| {
        let Info { id, name, .. } = *estimator.info();
        let twins = estimators.iter().filter(|other| other.info().id == id);
        let differs = |index: &usize| twins.clone().any(|twin| twin.value(*index) != estimator.value(*index));
        let set: Vec<_> =
            (0..estimator.specs().len()).filter(differs).map(|index| setting(*estimator, index)).collect();
        match set.join(" · ") {
            set if set.is_empty() => [name; 2].map(str::to_owned),
            set => [format!("{name} · {set}"), set],
        }
    };
    estimators.iter().map(name).collect()
}

/// A parameter with its value: `smoothness 20`, or the label of a choice.
fn setting(estimator: &dyn AnyEstimator, index: usize) -> String {
    let spec = &estimator.specs()[index];
    let value = estimator.value(index);
    match (&spec.kind, &value) {
        (Kind::Choice(choices), Value::Choice(now)) => {
            choices.iter().find(|choice| choice.name == *now).map_or_else(String::new, |choice| choice.label.to_owned())
        }
        _ => format!("{} {value} {}", spec.label, spec.unit).trim_end().to_owned(),
    }
}

/// An error of `estimator`, with its id.
fn of_member(estimator: &dyn AnyEstimator, error: &Error) -> Error {
    Error::new(format!("{}: {error}", estimator.info().id))
}

/// The same place in frame t.
fn in_frame_t(focus: Option<Focus>) -> Option<Focus> {
    focus.map(|focus| Focus::current(focus.at))
}

/// The goal of a move of units with events; unit and event may lie beyond the last.
fn goal(to: Move, walk: &impl Walk) -> Cursor {
    let (cursor, events) = (walk.cursor(), walk.events());
    let Cursor { unit, event } = cursor;
    let end_of = |unit| Cursor { unit, event: usize::MAX };
    match to {
        Move::To(Cursor { unit, event: 0 }) if unit > 0 => end_of(unit - 1),
        Move::To(cursor) => cursor,
        Move::End | Move::Granularity(0, Direction::Forward) => end_of(usize::MAX),
        Move::Granularity(0, Direction::Back) => Cursor::default(),
        Move::Granularity(_, Direction::Forward) if walk.at_end() => cursor,
        Move::Granularity(1, Direction::Forward) if event < events => end_of(unit),
        Move::Granularity(1, Direction::Forward) => end_of(unit + 1),
        Move::Granularity(_, Direction::Forward) if event < events => Cursor { unit, event: event + 1 },
        Move::Granularity(_, Direction::Forward) => Cursor { unit: unit + 1, event: 1 },
        Move::Granularity(2.., Direction::Back) if event > 1 => Cursor { unit, event: event - 1 },
        Move::Granularity(_, Direction::Back) => unit.checked_sub(1).map_or(Cursor::default(), end_of),
    }
}
