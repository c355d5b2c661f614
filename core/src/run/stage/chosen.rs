//! An estimator as the value of a parameter.

use std::any::Any;
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use super::super::AnyEstimator;
use crate::base::Error;
use crate::params::{Params, Part, Spec, StageValue, Value, set_by_name};

/// The parameter for the number of frames, of all estimators that process a clip.
pub(super) const FRAMES: &str = "frames";

/// The estimator of a stage's value.
pub fn estimator_of(value: &StageValue) -> Option<&dyn AnyEstimator> {
    value.part().as_any().downcast_ref::<Chosen>().map(|chosen| &*chosen.estimator)
}

/// The value of a stage with `estimator`.
pub fn value_of(estimator: &dyn AnyEstimator) -> Value {
    Value::Stage(StageValue::new(Box::new(Chosen { estimator: estimator.boxed_clone(), decided: &[] })))
}

/// The parameters of a stage that its parent decides.
pub(super) fn decided(value: &StageValue) -> &'static [&'static str] {
    value.part().as_any().downcast_ref::<Chosen>().map_or(&[], |chosen| chosen.decided)
}

/// An estimator chosen as a stage. It has all parameters but those that its parent decides.
pub(super) struct Chosen {
    pub estimator: Box<dyn AnyEstimator>,
    pub decided: &'static [&'static str],
}

impl Chosen {
    /// The index of a parameter in the estimator by itself.
    fn whole(&self, index: usize) -> usize {
        let own = self.estimator.specs().iter().enumerate();
        let left = own.filter(|(_, spec)| !self.decided.contains(&spec.name.as_str()));
        left.map(|(whole, _)| whole).nth(index).unwrap_or(usize::MAX)
    }
}

/// The declarations of an estimator except the `decided` ones, made once for each.
fn without(id: &'static str, specs: &'static [Spec], decided: &'static [&'static str]) -> &'static [Spec] {
    type Key = (&'static str, &'static [&'static str]);
    static MADE: Mutex<BTreeMap<Key, &'static [Spec]>> = Mutex::new(BTreeMap::new());
    let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
    made.entry((id, decided)).or_insert_with(|| {
        let left = specs.iter().filter(|spec| !decided.contains(&spec.name.as_str()));
        Vec::leak(left.cloned().collect())
    })
}

impl Params for Chosen {
    fn specs(&self) -> &'static [Spec] {
        let specs = self.estimator.specs();
        match self.decided {
            [] => specs,
            decided => without(self.estimator.info().id, specs, decided),
        }
    }

    fn value(&self, index: usize) -> Value {
        self.estimator.value(self.whole(index))
    }

    fn set_value(&mut self, index: usize, value: Value) -> Result<(), Error> {
        let index = self.whole(index);
        self.estimator.set_value(index, value)
    }

    fn idle(&self, index: usize) -> Option<&'static str> {
        self.estimator.idle(self.whole(index))
    }

    /// Refuses a parameter that the parent decides.
    fn set(&mut self, name: &str, text: &str) -> Result<(), Error> {
        let is_decided = self.decided.contains(&name) && self.estimator.specs().iter().any(|spec| spec.name == name);
        if !is_decided {
            return set_by_name(self, name, text);
        }
        Err(Error::new(format!("{name} is set by the parent estimator; set {name} there")))
    }
}

impl Part for Chosen {
    fn id(&self) -> &'static str {
        self.estimator.info().id
    }

    fn name(&self) -> &'static str {
        self.estimator.info().name
    }

    fn summary(&self) -> &'static str {
        self.estimator.info().summary
    }

    fn clone_part(&self) -> Box<dyn Part> {
        Box::new(Self { estimator: self.estimator.boxed_clone(), decided: self.decided })
    }

    fn as_any(&self) -> &dyn Any {
        self
    }
}
