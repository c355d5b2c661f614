//! What one step of a run shows, and how it is looked at, for the window and for files alike.

mod encode;
pub mod handout;
pub mod look;
pub mod moment;
pub mod motion;
pub mod named;
pub mod page;
pub mod panes;
pub mod paper;
pub mod rendering;
#[cfg(test)]
mod samples;
pub mod sheet;
pub mod steps;
pub mod still;
pub mod sweep_plot;
pub mod tile;
pub mod worksheet;
