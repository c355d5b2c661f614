//! All estimators in the order of the course, comparisons between them, and the terms of the course.

pub mod compare;
pub mod detection;
pub mod examples;
pub mod glossary;
mod registry;

pub use registry::{estimator, estimators};
