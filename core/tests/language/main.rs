//! What estimators say, and the laws that hold for it.

#[path = "../common/mod.rs"]
mod common;
mod phrases;
mod pseudocode;
mod questions;
mod rules;
mod texts;
mod walks;
