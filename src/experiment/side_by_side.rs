//! The estimators in lockstep, shared by window, command line and sessions.

use motionscope_core::compare::alike;
use motionscope_core::{AnyEstimator, Clip, Error, Info, Lockstep, Pace, Threads, Walk, estimator, lockstep};

use crate::experiment::{comparison, first, source};

/// The estimators in lockstep with the leader; empty for a single estimator.
///
/// They take over the leader's values of the parameters that they share, so that all run under the same conditions.
pub struct SideBySide {
    /// The other estimators, from left to right.
    pub beside: Vec<Box<dyn AnyEstimator>>,
    /// What the steps have in common.
    pub pace: Pace,
}

impl Default for SideBySide {
    fn default() -> Self {
        Self { beside: Vec::new(), pace: Pace::Block }
    }
}

impl Clone for SideBySide {
    fn clone(&self) -> Self {
        Self { beside: self.beside.iter().map(|estimator| estimator.boxed_clone()).collect(), pace: self.pace }
    }
}

impl PartialEq for SideBySide {
    fn eq(&self, other: &Self) -> bool {
        let told = |side_by_side: &Self| -> Vec<_> {
            side_by_side.beside.iter().map(|estimator| (estimator.info().id, estimator.values())).collect()
        };
        self.pace == other.pace && told(self) == told(other)
    }
}

impl SideBySide {
    /// Returns the estimators `ids` in lockstep with `leader`.
    ///
    /// # Errors
    /// If there is no such estimator, one is named twice, or there are too many.
    pub fn of(leader: &dyn AnyEstimator, ids: &[impl AsRef<str>], pace: Pace) -> Result<Self, Error> {
        let beside = ids.iter().map(|id| estimator(id.as_ref())).collect::<Result<_, _>>()?;
        let mut side_by_side = Self { beside, pace };
        side_by_side.follow(leader);
        side_by_side.check(leader)?;
        Ok(side_by_side)
    }

    /// Returns the default estimators in lockstep with `leader`.
    pub fn usual(leader: &str) -> Vec<&'static str> {
        first::BESIDE.into_iter().filter(|id| *id != leader).collect()
    }

    /// Whether `leader` is alone.
    pub fn is_empty(&self) -> bool {
        self.beside.is_empty()
    }

    /// Sets the shared parameters of the others to those of `leader`.
    pub fn follow(&mut self, leader: &dyn AnyEstimator) {
        for estimator in &mut self.beside {
            *estimator = alike(leader, estimator.boxed_clone());
        }
    }

    /// Makes `leader` lead; if it was among the others, `before` takes its place.
    pub fn relieve(&mut self, before: &dyn AnyEstimator, leader: &dyn AnyEstimator) {
        if let Some(place) = self.beside.iter_mut().find(|estimator| estimator.info().id == leader.info().id) {
            *place = before.boxed_clone();
        }
        self.follow(leader);
    }

    /// Sets `NAME=VALUE` for `leader` and all that share the parameter, or `ESTIMATOR.NAME=VALUE` for one alone. A dotted name
    /// that the leader has is that of a parameter of its stage.
    ///
    /// # Errors
    /// If none has such a parameter, one alone is to differ in what all share, or the value is out of range.
    pub fn set(&mut self, leader: &mut dyn AnyEstimator, setting: &str) -> Result<(), Error> {
        let (name, value) = setting.split_once('=').unwrap_or((setting, ""));
        let is_estimator = |_: &(&str, &str)| !self.is_empty() && leader.get(name.trim()).is_err();
        match name.trim().split_once('.').filter(is_estimator) {
            Some((id, _)) if id == leader.info().id => source::set(leader, &setting.trim()[id.len() + 1..])?,
            Some((_, name)) if leader.get(name).is_ok() => {
                return Err(Error::new(format!("{name} is shared by all estimators in lockstep; set {name}={value}")));
            }
            Some((id, name)) => {
                let told = || Error::new(format!("{id} is not in lockstep; add it with --beside"));
                self.beside.iter_mut().find(|e| e.info().id == id).ok_or_else(told)?.set(name, value)?;
            }
            None if !self.is_empty() && leader.get(name.trim()).is_err() && setting.contains('=') => {
                comparison::set_all(&mut self.beside, name.trim(), value)?;
            }
            None => source::set(leader, setting)?,
        }
        self.follow(leader);
        Ok(())
    }

    /// Returns the description of the run of `leader` with the estimators in lockstep.
    pub fn info(&self, leader: &dyn AnyEstimator) -> &'static Info {
        if self.is_empty() { leader.info() } else { const { &Lockstep::INFO } }
    }

    /// Starts the run of `leader`, or of all in lockstep.
    ///
    /// # Errors
    /// If one of them cannot run there.
    pub fn walk(&self, leader: &dyn AnyEstimator, clip: &Clip, frame: usize) -> Result<Box<dyn Walk>, Error> {
        if self.is_empty() {
            return leader.walk(clip, frame);
        }
        // Only a budget needs to know beforehand what each will spend.
        let threads = if self.pace == Pace::Budget { Threads::all()? } else { Threads::single() };
        Ok(Box::new(Lockstep::new(&self.all(leader), self.pace, (clip, frame), &threads)?))
    }

    /// Refuses what cannot go in lockstep.
    ///
    /// # Errors
    /// If one is there twice, or there are too many.
    pub fn check(&self, leader: &dyn AnyEstimator) -> Result<(), Error> {
        if self.is_empty() { Ok(()) } else { lockstep::check(&self.all(leader)) }
    }

    /// `leader` and the others, from left to right.
    pub fn all<'a>(&'a self, leader: &'a dyn AnyEstimator) -> Vec<&'a dyn AnyEstimator> {
        std::iter::once(leader).chain(self.beside.iter().map(|estimator| &**estimator)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use motionscope_core::Value;

    #[test]
    fn all_work_under_the_conditions_of_the_leader() {
        let mut leader = estimator("diamond").unwrap();
        leader.set("block", "8").unwrap();
        let mut side_by_side = SideBySide::of(&*leader, &["full-search", "hierarchical"], Pace::Budget).unwrap();
        let of = |side_by_side: &SideBySide, i: usize, name| side_by_side.beside[i].get(name).unwrap();
        assert_eq!((of(&side_by_side, 0, "block"), of(&side_by_side, 1, "block")), (Value::Int(8), Value::Int(8)));
        for setting in ["range=7", "hierarchical.levels=2", "order=spiral", "diamond.block=12"] {
            side_by_side.set(&mut *leader, setting).unwrap();
        }
        assert_eq!((of(&side_by_side, 0, "range"), of(&side_by_side, 1, "levels")), (Value::Int(7), Value::Int(2)));
        assert_eq!(
            (of(&side_by_side, 0, "order"), of(&side_by_side, 1, "block")),
            (Value::Choice("spiral"), Value::Int(12))
        );
        let mut told = |setting: &str| side_by_side.set(&mut *leader, setting).unwrap_err().to_string();
        assert!(told("hierarchical.block=4").contains("set block=4"));
        assert!(told("hexagon.levels=4").contains("--beside"));
        assert!(told("coarse.order=spiral").contains("coarse is not in lockstep"));
        assert!(told("magic=4").contains("magic") && told("block").contains("NAME=VALUE"));
    }

    #[test]
    fn the_stage_of_the_leader_is_set_by_its_name() {
        let mut leader = estimator("hierarchical").unwrap();
        let mut side_by_side = SideBySide::of(&*leader, &["full-search"], Pace::Block).unwrap();
        for setting in ["coarse.order=spiral", "full-search.order=spiral", "hierarchical.levels=2"] {
            side_by_side.set(&mut *leader, setting).unwrap();
        }
        assert_eq!(leader.get("coarse.order"), Ok(Value::Choice("spiral")));
        assert_eq!(leader.get("levels"), Ok(Value::Int(2)));
        assert_eq!(side_by_side.beside[0].get("order"), Ok(Value::Choice("spiral")));
        // The stage of one that stands beside it is set by the estimator and the stage.
        let mut leader = estimator("diamond").unwrap();
        let mut side_by_side = SideBySide::of(&*leader, &["hierarchical"], Pace::Block).unwrap();
        side_by_side.set(&mut *leader, "hierarchical.coarse.order=spiral").unwrap();
        assert_eq!(side_by_side.beside[0].get("coarse.order"), Ok(Value::Choice("spiral")));
    }

    #[test]
    fn nobody_stands_there_twice() {
        let leader = estimator("diamond").unwrap();
        let told = |ids: &[&str]| SideBySide::of(&*leader, ids, Pace::Block).err().unwrap().to_string();
        assert!(told(&["hexagon", "diamond"]).contains("is there twice"));
        assert!(told(&["hexagon", "three-step", "four-step", "predictive"]).contains("not 5"));
        assert!(told(&["magic"]).contains("there is no estimator magic"));
        let mut side_by_side = SideBySide::of(&*leader, &["full-search", "hexagon"], Pace::Block).unwrap();
        let next = side_by_side.beside[1].boxed_clone();
        side_by_side.relieve(&*leader, &*next);
        assert_eq!(
            side_by_side.all(&*next).iter().map(|e| e.info().id).collect::<Vec<_>>(),
            ["hexagon", "full-search", "diamond"]
        );
        side_by_side.check(&*next).unwrap();
    }
}
