//! The application: its commands and keys, what they do, and the frame that is drawn.

pub mod action;
mod acts;
pub mod commands;
mod files;
pub mod keys;
mod lessons;
mod present;
mod window;

pub use window::{App, Region};
