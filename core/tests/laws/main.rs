//! Laws for every estimator of the registry, and for the core as a whole.

#[path = "../common/mod.rs"]
mod common;
#[path = "../imports/mod.rs"]
mod imports;

mod conditional;
mod contributing;
mod examples;
mod language;
mod layers;
mod questions;
mod results;
mod runs;
mod stages;
