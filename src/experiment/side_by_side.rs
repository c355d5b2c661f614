//! The estimators in lockstep, shared by window, command line and sessions.
//!
//! They take over the parameters that they share with the leader. The same estimator may be there twice, with parameters of its
//! own (`2.alpha=20`); `Estimator::CONTRASTS` proposes them.

use std::collections::BTreeSet;

use motionscope_core::base::{Error, Threads};
use motionscope_core::course::{estimator, estimators};
use motionscope_core::data::Clip;
use motionscope_core::params::{Kind, Spec, Value};
use motionscope_core::run::{AnyEstimator, Info, Pace, Walk, lockstep};

use crate::experiment::{first, source};

/// An estimator in lockstep with the leader.
pub struct Companion {
    /// The estimator.
    pub estimator: Box<dyn AnyEstimator>,
    /// The parameters that are set for it alone; the others follow the leader.
    own: BTreeSet<String>,
}

impl Clone for Companion {
    fn clone(&self) -> Self {
        Self { estimator: self.estimator.boxed_clone(), own: self.own.clone() }
    }
}

impl PartialEq for Companion {
    fn eq(&self, other: &Self) -> bool {
        self.estimator.info().id == other.estimator.info().id
            && self.estimator.all_values() == other.estimator.all_values()
    }
}

impl Companion {
    /// An estimator that follows `leader` in every parameter that both have.
    pub fn new(estimator: Box<dyn AnyEstimator>, leader: &dyn AnyEstimator) -> Self {
        let mut companion = Self { estimator, own: BTreeSet::new() };
        companion.follow(leader);
        companion
    }

    /// The value that parameter `index` has where it is not set for this estimator alone: that of `leader`, or its default.
    ///
    /// Block searches all run under the conditions of the leader. Parameters of other estimators differ in their defaults for
    /// good reasons, so these take over what was changed, from an estimator of their family.
    pub fn followed(&self, index: usize, leader: &dyn AnyEstimator) -> Value {
        let spec = &self.estimator.specs()[index];
        let value = leader.get(&spec.name);
        if self.estimator.tests_candidates() && leader.tests_candidates() {
            return value.unwrap_or_else(|_| self.estimator.value(index));
        }
        let is_alike = |other: &&Spec| (&other.name, other.unit, &other.kind) == (&spec.name, spec.unit, &spec.kind);
        let same =
            leader.specs().iter().find(is_alike).filter(|_| leader.info().family == self.estimator.info().family);
        let changed = same.and_then(|other| value.ok().filter(|value| *value != other.default));
        changed.unwrap_or_else(|| spec.default.clone())
    }

    /// Sets every parameter that is not its own to what it follows.
    fn follow(&mut self, leader: &dyn AnyEstimator) {
        for index in 0..self.estimator.specs().len() {
            if !self.own.contains(&self.estimator.specs()[index].name) {
                let value = self.followed(index, leader);
                // A value that is not allowed here is skipped.
                self.estimator.set_value(index, value).ok();
            }
        }
    }

    /// Sets parameter `name` for this estimator alone; a dotted name is that of a parameter of its stage.
    fn set(&mut self, name: &str, value: &str) -> Result<(), Error> {
        self.estimator.set(name, value)?;
        self.own.insert(name.split('.').next().unwrap_or(name).to_owned());
        Ok(())
    }

    /// Sets parameter `index` for this estimator alone.
    ///
    /// # Errors
    /// If the value is out of range.
    pub fn set_value(&mut self, index: usize, value: Value) -> Result<(), Error> {
        self.estimator.set_value(index, value)?;
        self.own.insert(self.estimator.specs()[index].name.clone());
        Ok(())
    }

    /// The values that a session keeps: those that do not follow from `leader`.
    pub fn own_values(&self, leader: &dyn AnyEstimator) -> Vec<(String, Value)> {
        let is_own = |name: &str| {
            let first = name.split('.').next().unwrap_or(name);
            self.own.contains(first) || leader.get(name).is_err()
        };
        self.estimator.all_values().into_iter().filter(|(name, _)| is_own(name)).collect()
    }
}

/// The estimators in lockstep with the leader; empty for a single estimator.
#[derive(Clone, PartialEq)]
pub struct SideBySide {
    /// The other estimators, from left to right.
    pub beside: Vec<Companion>,
    /// What the steps have in common.
    pub pace: Pace,
}

impl Default for SideBySide {
    fn default() -> Self {
        Self { beside: Vec::new(), pace: Pace::Block }
    }
}

impl SideBySide {
    /// Returns the estimators `ids` in lockstep with `leader`, at `pace` if they can go at that.
    ///
    /// # Errors
    /// If there is no such estimator, there are too many, or they cannot go together.
    pub fn of(leader: &dyn AnyEstimator, ids: &[impl AsRef<str>], pace: Pace) -> Result<Self, Error> {
        let companion = |id: &_| Ok(Companion::new(estimator(AsRef::as_ref(id))?, leader));
        let beside = ids.iter().map(companion).collect::<Result<_, Error>>()?;
        let mut side_by_side = Self { beside, pace };
        side_by_side.check(leader)?;
        side_by_side.suit(leader);
        Ok(side_by_side)
    }

    /// Returns the default estimators in lockstep with `leader`: the best-known searches, the same estimator with another value of
    /// the parameter that it contrasts, or the next of its family.
    pub fn usual(leader: &dyn AnyEstimator) -> Self {
        let Info { id, family, .. } = *leader.info();
        let mut usual = Self::default();
        if let Some(name) = leader.contrasts() {
            let mut twin = Companion::new(leader.boxed_clone(), leader);
            if let Some(value) = another(leader, name) {
                // It is one of the choices.
                twin.set(name, &value).ok();
            }
            usual.beside.push(twin);
        } else {
            let suits = |other: &dyn AnyEstimator| {
                let (info, both) = (other.info(), [leader, other]);
                let is_known = !leader.tests_candidates() || first::BESIDE.contains(&info.id);
                let has_pace = lockstep::paces(&both).iter().any(|pace| *pace != Pace::Result);
                let is_same_kind = leader.produces().first() == other.produces().first();
                info.id != id && info.family == family && is_known && has_pace && is_same_kind
            };
            let others = estimators().into_iter().filter(|other| suits(&**other)).take(2);
            usual.beside = others.map(|other| Companion::new(other, leader)).collect();
        }
        if usual.beside.is_empty() {
            usual.beside.push(Companion::new(leader.boxed_clone(), leader));
        }
        usual.suit(leader);
        usual
    }

    /// Whether `leader` is alone.
    pub fn is_empty(&self) -> bool {
        self.beside.is_empty()
    }

    /// Has the others follow `leader` in the parameters that are not their own.
    pub fn follow(&mut self, leader: &dyn AnyEstimator) {
        self.beside.iter_mut().for_each(|companion| companion.follow(leader));
    }

    /// Has companion `index` follow `leader` in every parameter.
    pub fn reset(&mut self, index: usize, leader: &dyn AnyEstimator) {
        if let Some(companion) = self.beside.get_mut(index)
            && let Ok(fresh) = estimator(companion.estimator.info().id)
        {
            *companion = Companion::new(fresh, leader);
        }
    }

    /// Makes `leader` lead; if it was among the others, `before` takes its place. Those that cannot go with it leave.
    pub fn relieve(&mut self, before: &dyn AnyEstimator, leader: &dyn AnyEstimator) {
        let is_leader = |companion: &&mut Companion| companion.estimator.info().id == leader.info().id;
        if let Some(place) = self.beside.iter_mut().find(is_leader) {
            *place = Companion::new(before.boxed_clone(), leader);
        }
        self.beside.retain(|companion| lockstep::check(&[leader, &*companion.estimator]).is_ok());
        self.follow(leader);
        self.suit(leader);
    }

    /// Takes the usual pace where the estimators cannot go at this one.
    pub fn suit(&mut self, leader: &dyn AnyEstimator) {
        let paces = lockstep::paces(&self.all(leader));
        if !paces.contains(&self.pace) {
            self.pace = paces.first().copied().unwrap_or(self.pace);
        }
    }

    /// Sets `NAME=VALUE` for `leader` and all that share the parameter, or `ESTIMATOR.NAME=VALUE` for one alone; `2.NAME=VALUE` is
    /// that of the second estimator. A dotted name that the leader has is that of a parameter of its stage.
    ///
    /// # Errors
    /// If none has such a parameter, or the value is out of range.
    pub fn set(&mut self, leader: &mut dyn AnyEstimator, setting: &str) -> Result<(), Error> {
        let (name, value) = setting.split_once('=').unwrap_or((setting, ""));
        let name = name.trim();
        let of_leader = leader.get(name).is_ok() || self.is_empty() || !setting.contains('=');
        match name.split_once('.').filter(|_| !of_leader) {
            Some((whose, name)) => match self.place(leader, whose)?.checked_sub(1) {
                None => source::set(leader, &format!("{name}={value}"))?,
                Some(index) => self.beside[index].set(name, value)?,
            },
            None if of_leader => source::set(leader, setting)?,
            None => {
                let has = |companion: &&mut Companion| companion.estimator.get(name).is_ok();
                let mut having: Vec<_> = self.beside.iter_mut().filter(has).collect();
                if having.is_empty() {
                    return Err(Error::new(format!("none of these estimators has a parameter {name}")));
                }
                having.iter_mut().try_for_each(|companion| companion.set(name, value))?;
            }
        }
        self.follow(leader);
        Ok(())
    }

    /// The place of an estimator that is named by its number, from 1, or by its id; 0 is the leader.
    fn place(&self, leader: &dyn AnyEstimator, whose: &str) -> Result<usize, Error> {
        let all = self.all(leader);
        let by_number = whose.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
        let found = by_number.filter(|place| *place < all.len()).or(all.iter().position(|one| one.info().id == whose));
        found.ok_or_else(|| Error::new(format!("{whose} is not in lockstep; add it with --beside")))
    }

    /// Returns the description of the run of `leader` with the estimators in lockstep.
    pub fn info(&self, leader: &dyn AnyEstimator) -> &'static Info {
        if self.is_empty() { leader.info() } else { self.pace.info() }
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
        lockstep::walk(&self.all(leader), self.pace, (clip, frame), &threads)
    }

    /// Refuses what cannot go in lockstep.
    ///
    /// # Errors
    /// If there are too many, or they cannot go together.
    pub fn check(&self, leader: &dyn AnyEstimator) -> Result<(), Error> {
        if self.is_empty() { Ok(()) } else { lockstep::check(&self.all(leader)) }
    }

    /// `leader` and the others, from left to right.
    pub fn all<'a>(&'a self, leader: &'a dyn AnyEstimator) -> Vec<&'a dyn AnyEstimator> {
        std::iter::once(leader).chain(self.beside.iter().map(|companion| &*companion.estimator)).collect()
    }
}

/// A choice of parameter `name` that is not at hand: the one of which the present one is a variety, as `turn` of `unscented-turn`, or else
/// the first.
fn another(estimator: &dyn AnyEstimator, name: &str) -> Option<String> {
    let now = estimator.get(name).ok()?;
    let spec = estimator.specs().iter().find(|spec| spec.name == name)?;
    let Kind::Choice(choices) = &spec.kind else { return None };
    let others = || choices.iter().map(|choice| choice.name).filter(|choice| Value::Choice(choice) != now);
    let is_base = |other: &&str| matches!(now, Value::Choice(now) if now.strip_suffix(*other).is_some_and(|own| own.ends_with('-')));
    others().find(is_base).or_else(|| others().next()).map(str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use motionscope_core::params::Value;

    #[test]
    fn an_unscented_turn_is_contrasted_with_the_extended_one() {
        let mut leader = estimator("kalman-filter").unwrap();
        for (motion, other) in [("velocity", "acceleration"), ("unscented-turn", "turn"), ("imm", "velocity")] {
            leader.set("motion", motion).unwrap();
            let usual = SideBySide::usual(&*leader);
            assert_eq!(usual.beside[0].estimator.get("motion").unwrap(), Value::Choice(other), "beside {motion}");
        }
    }

    #[test]
    fn all_work_under_the_conditions_of_the_leader() {
        let mut leader = estimator("diamond").unwrap();
        leader.set("block-size", "8").unwrap();
        let mut side_by_side = SideBySide::of(&*leader, &["full-search", "hierarchical"], Pace::Budget).unwrap();
        let of = |side_by_side: &SideBySide, i: usize, name| side_by_side.beside[i].estimator.get(name).unwrap();
        assert_eq!(
            (of(&side_by_side, 0, "block-size"), of(&side_by_side, 1, "block-size")),
            (Value::Int(8), Value::Int(8))
        );
        for setting in
            ["search-range=7", "hierarchical.levels=2", "order=spiral", "diamond.block-size=12", "3.search-range=5"]
        {
            side_by_side.set(&mut *leader, setting).unwrap();
        }
        assert_eq!(
            (of(&side_by_side, 0, "search-range"), of(&side_by_side, 1, "levels")),
            (Value::Int(7), Value::Int(2))
        );
        assert_eq!(of(&side_by_side, 1, "search-range"), Value::Int(5), "set for the third alone");
        assert_eq!(
            (of(&side_by_side, 0, "order"), of(&side_by_side, 1, "block-size")),
            (Value::Choice("spiral"), Value::Int(12))
        );
        let mut message = |setting: &str| side_by_side.set(&mut *leader, setting).unwrap_err().to_string();
        assert!(message("hexagon.levels=4").contains("--beside"));
        assert!(message("coarse.order=spiral").contains("coarse is not in lockstep"));
        assert!(message("magic=4").contains("magic") && message("block-size").contains("NAME=VALUE"));
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
        assert_eq!(side_by_side.beside[0].estimator.get("order"), Ok(Value::Choice("spiral")));
        // The stage of one that stands beside it is set by the estimator and the stage.
        let mut leader = estimator("diamond").unwrap();
        let mut side_by_side = SideBySide::of(&*leader, &["hierarchical"], Pace::Block).unwrap();
        side_by_side.set(&mut *leader, "hierarchical.coarse.order=spiral").unwrap();
        assert_eq!(side_by_side.beside[0].estimator.get("coarse.order"), Ok(Value::Choice("spiral")));
    }

    #[test]
    fn what_cannot_go_together_is_refused() {
        let leader = estimator("diamond").unwrap();
        let message = |ids: &[&str]| SideBySide::of(&*leader, ids, Pace::Block).err().unwrap().to_string();
        assert!(
            message(&["hexagon", "kalman-tracker"])
                .contains("Diamond search works on a pair of frames and Kalman tracker")
        );
        assert!(message(&["hexagon", "three-step", "four-step", "predictive"]).contains("not 5"));
        assert!(message(&["magic"]).contains("there is no estimator magic"));
        let mut side_by_side = SideBySide::of(&*leader, &["full-search", "hexagon"], Pace::Block).unwrap();
        let next = side_by_side.beside[1].estimator.boxed_clone();
        side_by_side.relieve(&*leader, &*next);
        assert_eq!(
            side_by_side.all(&*next).iter().map(|e| e.info().id).collect::<Vec<_>>(),
            ["hexagon", "full-search", "diamond"]
        );
        side_by_side.check(&*next).unwrap();
        side_by_side.relieve(&*next, &*estimator("kalman-tracker").unwrap());
        assert!(side_by_side.is_empty(), "no block search goes with a tracker");
    }

    #[test]
    fn the_same_estimator_goes_twice_with_other_parameters() {
        let mut leader = estimator("kalman-filter").unwrap();
        let mut usual = SideBySide::usual(&*leader);
        let motions = |usual: &SideBySide, leader: &dyn AnyEstimator| -> Vec<_> {
            usual.all(leader).iter().map(|one| one.get("motion").unwrap()).collect()
        };
        assert_eq!(
            (usual.pace, motions(&usual, &*leader)),
            (Pace::Frame, vec![Value::Choice("velocity"), Value::Choice("acceleration")])
        );
        usual.set(&mut *leader, "gate=0.9").unwrap();
        usual.set(&mut *leader, "motion=turn").unwrap();
        assert_eq!(motions(&usual, &*leader), [Value::Choice("turn"), Value::Choice("acceleration")]);
        assert_eq!(usual.beside[0].estimator.get("gate"), Ok(Value::Real(0.9)), "what is not its own follows");
        usual.reset(0, &*leader);
        assert_eq!(motions(&usual, &*leader), vec![Value::Choice("turn"); 2]);
    }

    #[test]
    fn every_estimator_has_usual_companions_and_a_pace() {
        for leader in estimators() {
            let (usual, id) = (SideBySide::usual(&*leader), leader.info().id);
            usual.check(&*leader).unwrap_or_else(|error| panic!("{id}: {error}"));
            assert!(lockstep::paces(&usual.all(&*leader)).contains(&usual.pace), "{id}");
        }
    }

    #[test]
    fn defaults_of_other_estimators_stay_unless_changed() {
        let mut leader = estimator("running-average").unwrap();
        let mixture = estimator("mixture-of-gaussians").unwrap();
        let mut side_by_side = SideBySide::of(&*leader, &["mixture-of-gaussians"], Pace::Block).unwrap();
        assert_eq!(side_by_side.pace, Pace::Frame);
        assert_eq!(side_by_side.beside[0].estimator.all_values(), mixture.all_values());
        side_by_side.set(&mut *leader, "frames=20").unwrap();
        assert_eq!(side_by_side.beside[0].estimator.get("frames"), Ok(Value::Int(20)));
    }
}
