//! Motionscope's window and command line over `motionscope-core`.

pub mod claims;
pub mod cli;
pub mod comparison;
pub mod media;
pub mod paint;
pub mod quality;
pub mod session;
pub mod shot;
pub mod source;
pub mod ui;
