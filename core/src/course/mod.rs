//! All estimators in the order of the course, and some of them beside each other.

pub mod compare;
mod registry;

pub use registry::{estimator, estimators};
