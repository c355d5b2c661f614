//! The application: its commands and keys, what they do, and the frame that is drawn.

mod acts;
mod camera;
mod files;
mod find;
mod focus;
mod keys;
mod lessons;
mod predict;
mod present;
mod start;
mod window;

pub use window::{App, Region};
