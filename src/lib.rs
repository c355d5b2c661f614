//! Motionscope's window and command line over `motionscope-core`.

pub mod claims;
pub mod cli;
pub mod company;
pub mod comparison;
mod free_memory;
pub mod media;
pub mod motion;
pub mod paint;
pub mod pixel;
pub mod results;
pub mod session;
pub mod shot;
pub mod source;
pub mod tile;
pub mod ui;
pub mod unfinished;
