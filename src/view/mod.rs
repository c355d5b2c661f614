//! What one step of a run shows, for the window and for files alike.

pub mod motion;
pub mod shot;
pub mod tile;
