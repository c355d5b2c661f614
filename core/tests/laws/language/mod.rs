//! What estimators say, and the laws that hold for it.
//!
//! Every text of every estimator is collected on sample clips, with each parameter changed in turn: a test fails on phrases
//! that the field does not use, on American spelling, on hyphens for minus signs, on five digits without a thin space, on a
//! quantity whose decimals change, on a line of pseudocode that is never reached, and on a sentence that belongs to two lines.
//! `tests/window/language.rs` of the application holds all texts of the window to the same rules (`rules.rs`).

mod phrases;
mod pseudocode;
mod questions;
mod rules;
mod texts;
mod walks;
