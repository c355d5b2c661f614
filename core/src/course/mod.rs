//! All estimators in the order of the course, comparisons between them, and the terms of the course.
//!
//! An example is a claim: a synthetic clip with settings on which an estimator works or fails, with the cause, a limit of a
//! measure, and an estimator or settings that work instead. A law measures both, and requires of every estimator an example of
//! success, which comes first, and failures of two causes.

mod bundled;
pub mod compare;
pub mod detection;
pub mod examples;
pub mod glossary;
mod registry;

pub use registry::{estimator, estimators};
