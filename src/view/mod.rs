//! What one step of a run shows, for the window and for files alike.

pub mod motion;
pub mod panes;
pub mod sheet;
pub mod shot;
pub mod tile;
