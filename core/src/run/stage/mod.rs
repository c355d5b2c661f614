//! Stages: estimators inside others, each chosen by its product, with its own parameters.
//!
//! A parameter of type [`Stage<M>`] is an estimator with the product `M`. Its parameters have dotted names
//! (`detector.learning-rate`), and a chain may be long: mixture of Gaussians, connected components, Kalman tracker and
//! trajectory analysis are a chain of four. `kinds.rs` lists the products that can be asked for. An estimator with another
//! product is refused, and so is one that could contain itself.
//!
//! The results of a stage are computed on demand and shared by all copies of a state ([`Frames`]). [`open()`] describes how a
//! stage is walked by itself: the frames that it processes may be earlier frames or a pyramid level (`Estimator::stage_view`).
//! An estimator that depends on few earlier frames (`Estimator::earlier_frames`) begins shortly before the frame shown. The
//! coarse search of hierarchical search is a stage that lends only its pattern (`Estimator::lends`), because each level has its
//! own blocks and costs.
//!
//! This layer cannot see the estimators: it declares [`Entries`], which the registry of the course implements for [`Course`].

mod chosen;
mod entries;
mod frames;
mod kinds;
mod open;

use std::fmt;
use std::marker::PhantomData;

pub use chosen::{estimator_of, value_of};
pub use entries::{Course, Entries, Entry};
pub use frames::Frames;
pub use kinds::{
    BlockVectors, DenseFlow, Disparities, FeatureTracks, Foreground, GlobalModel, Keypoints, Masks, Tracks,
};
pub use open::{Opened, open, stages};

use super::{AnyEstimator, Need};
use crate::base::Error;
use crate::data::Clip;
use crate::params::{Kind, Parameter, Part, PartKind, StageValue, Value};
use crate::products::ProductKind;
use chosen::Chosen;

/// The requirement on the estimators that can be a stage.
pub trait Makes: Clone + Copy + fmt::Debug + Send + Sync + 'static {
    /// The kind of product asked for, in one word. An estimator with a stage of this kind, or with one that can come to
    /// contain such a stage, cannot be one itself: so no estimator contains itself.
    const ASKS: &'static str;
    /// The product that they make above all.
    const PRODUCT: &'static ProductKind;
    /// The same in words, with an article.
    const WORDS: &'static str;
    /// Values that their parameters have unless set, as far as they have these, where those of an estimator by itself do
    /// not suit a stage.
    const DEFAULTS: &'static [(&'static str, &'static str)] = &[];

    /// Parameters that the parent decides: of a stage they are not shown, and cannot be set.
    const DECIDED: &'static [&'static str] = &[];

    /// Why an estimator with that product cannot be such a stage, if it cannot, as a phrase.
    fn lacks(_estimator: &dyn AnyEstimator) -> Option<&'static str> {
        None
    }
}

/// An estimator with the product that `M` requires, as a parameter of another.
pub struct Stage<M> {
    estimator: Box<dyn AnyEstimator>,
    makes: PhantomData<M>,
}

impl<M> Clone for Stage<M> {
    fn clone(&self) -> Self {
        Self { estimator: self.estimator.boxed_clone(), makes: PhantomData }
    }
}

impl<M> fmt::Debug for Stage<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple(self.estimator.info().id).field(&self.estimator.values()).finish()
    }
}

impl<M: Makes> Stage<M> {
    /// The estimator called `id`, with its default parameters.
    ///
    /// # Panics
    /// If there is none that makes what is asked for: ids are written in declarations.
    pub fn named(id: &str) -> Self {
        // Suitability is not checked here: that looks at all estimators, and this is how their defaults are made.
        #[expect(clippy::expect_used, reason = "ids stand in declarations, and a law tries all of them")]
        let entry = Course::entry(id).expect("a declared stage exists");
        Self { estimator: prepared::<M>((entry.make)()), makes: PhantomData }
    }

    /// The same with a parameter set.
    ///
    /// # Panics
    /// If it has no such parameter or value: both are written in declarations.
    #[must_use]
    pub fn with(mut self, name: &str, value: &str) -> Self {
        #[expect(clippy::expect_used, reason = "values stand in declarations, and a law tries all of them")]
        self.estimator.set(name, value).expect("a declared stage has what is set");
        self
    }

    /// The estimator.
    pub fn estimator(&self) -> &dyn AnyEstimator {
        &*self.estimator
    }

    /// Memory that a run of it takes while its parent waits.
    pub fn need(&self, clip: &Clip) -> Need {
        let Need { run, .. } = self.estimator.need(clip);
        Need { run, walk: run }
    }
}

/// The estimator called `id` if it has the product that `M` requires.
fn candidate<M: Makes>(id: &str) -> Result<Box<dyn AnyEstimator>, Error> {
    let entry = Course::entry(id)?;
    let refused = |why: String| {
        let ids: Vec<_> = candidates::<M>().map(|estimator| estimator.info().id).collect();
        Err(Error::new(format!("{id} {why}; choose {}", ids.join(", "))))
    };
    if entry.produces.first() != Some(&M::PRODUCT) {
        let made: Vec<_> = entry.produces.iter().map(|kind| kind.name.to_lowercase()).collect();
        return refused(format!("makes {}, not {}", made.join(" or "), M::WORDS));
    }
    let estimator = (entry.make)();
    match unsuited::<M>(&*estimator) {
        Some(why) => refused(why),
        None => Ok(prepared::<M>(estimator)),
    }
}

/// Why an estimator of the right product cannot be a stage of `M`, if it cannot.
fn unsuited<M: Makes>(estimator: &dyn AnyEstimator) -> Option<String> {
    if let Some(what) = M::lacks(estimator) {
        return Some(format!("{what}, but {} are needed here", M::WORDS));
    }
    let below = |product: &str| {
        let makers =
            Course::ENTRIES.iter().filter(|entry| entry.produces.first().is_some_and(|made| made.id == product));
        makers.flat_map(|entry| asked_by(&*(entry.make)())).collect()
    };
    let circle = match circle(M::ASKS, asked_by(estimator), below)? {
        Circle::Own => "has a stage of this kind itself",
        Circle::Below => "has a stage that can contain one of this kind",
    };
    Some(format!("{circle}, and an estimator cannot contain itself"))
}

/// The requirement of a stage, and the id of its product.
type Asked = (&'static str, &'static str);

/// The requirements of an estimator's stages.
fn asked_by(estimator: &dyn AnyEstimator) -> Vec<Asked> {
    let kinds = estimator.specs().iter().filter_map(|spec| match &spec.kind {
        Kind::Stage(kind) => Some((kind.asks, kind.product)),
        _ => None,
    });
    kinds.collect()
}

/// The cycle that makes an estimator contain a stage of its own kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Circle {
    Own,
    Below,
}

/// Where a stage that asks for `asks` can stand in an estimator whose stages ask for `own`; `below` tells what is asked for by
/// the stages of all that make a product.
fn circle(asks: &str, own: Vec<Asked>, below: impl Fn(&str) -> Vec<Asked>) -> Option<Circle> {
    if own.iter().any(|stage| stage.0 == asks) {
        return Some(Circle::Own);
    }
    let (mut reached, mut at) = (own, 0);
    while let Some((_, product)) = reached.get(at).copied() {
        for stage in below(product) {
            if stage.0 == asks {
                return Some(Circle::Below);
            }
            if !reached.contains(&stage) {
                reached.push(stage);
            }
        }
        at += 1;
    }
    None
}

/// An estimator with the values that suit a stage.
fn prepared<M: Makes>(mut estimator: Box<dyn AnyEstimator>) -> Box<dyn AnyEstimator> {
    for (name, value) in M::DEFAULTS {
        if estimator.specs().iter().any(|spec| spec.name == *name) {
            #[expect(clippy::expect_used, reason = "values stand in declarations, and a law tries all of them")]
            estimator.set(name, value).expect("a declared value is in range");
        }
    }
    estimator
}

/// The estimators with the product that `M` requires, in the order of the course.
fn candidates<M: Makes>() -> impl Iterator<Item = Box<dyn AnyEstimator>> {
    let right = Course::ENTRIES.iter().filter(|entry| entry.produces.first() == Some(&M::PRODUCT));
    let made = right.map(|entry| (entry.make)()).filter(|estimator| unsuited::<M>(&**estimator).is_none());
    made.map(prepared::<M>)
}

fn chosen<M: Makes>(estimator: Box<dyn AnyEstimator>) -> Chosen {
    Chosen { estimator, decided: M::DECIDED }
}

impl<M: Makes> Parameter for Stage<M> {
    type Range = ();

    fn kind((): ()) -> Kind {
        Kind::Stage(PartKind {
            asks: M::ASKS,
            product: M::PRODUCT.id,
            makes: M::WORDS,
            all: || candidates::<M>().map(|estimator| Box::new(chosen::<M>(estimator)) as Box<dyn Part>).collect(),
            refuse: |id| candidate::<M>(id).err().unwrap_or_else(|| Error::new(format!("{id} cannot be chosen here"))),
        })
    }

    fn to_value(&self) -> Value {
        Value::Stage(StageValue::new(Box::new(chosen::<M>(self.estimator.boxed_clone()))))
    }

    fn from_value(value: Value) -> Option<Self> {
        let Value::Stage(value) = value else { return None };
        Some(Self { estimator: estimator_of(&value)?.boxed_clone(), makes: PhantomData })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An estimator as the search for circles sees it.
    struct Toy {
        makes: &'static str,
        asks: Vec<Asked>,
    }

    fn circle_in(toys: &[Toy], asks: &str, toy: usize) -> Option<Circle> {
        let below = |product: &str| {
            let makers = toys.iter().filter(|toy| toy.makes == product);
            makers.flat_map(|toy| toy.asks.clone()).collect()
        };
        circle(asks, toys[toy].asks.clone(), below)
    }

    #[test]
    fn two_estimators_cannot_contain_each_other() {
        let toys = [
            Toy { makes: "flow", asks: vec![("points", "points")] },
            Toy { makes: "points", asks: vec![("flow", "flow")] },
            Toy { makes: "points", asks: Vec::new() },
        ];
        assert_eq!(circle_in(&toys, "points", 1), Some(Circle::Below));
        assert_eq!(circle_in(&toys, "flow", 0), Some(Circle::Below));
        assert_eq!(circle_in(&toys, "flow", 1), Some(Circle::Own));
        assert_eq!(circle_in(&toys, "points", 2), None);
        // Without the way back each can be the other's stage, and a circle elsewhere does not keep the search going.
        assert_eq!(circle_in(&toys, "masks", 0), None);
        assert_eq!(circle_in(&toys[..1], "flow", 0), None);
    }
}
