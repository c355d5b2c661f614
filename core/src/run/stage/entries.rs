//! The list that stages are chosen from.

use super::super::{AnyEstimator, Estimator};
use crate::base::{Error, words};
use crate::products::ProductKind;

/// An estimator before it is made.
pub struct Entry {
    /// Its id.
    pub id: &'static str,
    /// The kinds of products that it makes.
    pub produces: &'static [&'static ProductKind],
    /// Makes it, with its default parameters.
    pub make: fn() -> Box<dyn AnyEstimator>,
}

impl Entry {
    /// The entry of an estimator.
    pub const fn of<E: Estimator>() -> Self {
        Self { id: E::INFO.id, produces: E::PRODUCES, make: || Box::new(E::default()) }
    }
}

/// All estimators that stages are chosen from. Stages stand below the estimators that have them, so the list of these is
/// filled in from above.
pub struct Course;

/// A list of estimators.
pub trait Entries {
    /// All of them, in the order of the course.
    const ENTRIES: &'static [Entry];

    /// The one called `id`.
    ///
    /// # Errors
    /// A sentence with the ids there are.
    fn entry(id: &str) -> Result<&'static Entry, Error> {
        Self::ENTRIES.iter().find(|entry| entry.id == id).ok_or_else(|| {
            let ids: Vec<_> = Self::ENTRIES.iter().map(|entry| entry.id).collect();
            Error::new(words::there_is_no("estimator", id, &ids))
        })
    }
}
