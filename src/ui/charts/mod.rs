//! Charts of what a step tells, as they are pointed at in the window; [`crate::paint::charts`] draws them.

pub mod cloud3d;
pub mod diagram;
pub mod distribution;
pub mod handwriting;
pub mod heat_map;
pub mod histogram;
pub mod matrices;
pub mod plane;
pub mod plots;
pub mod regions;
pub mod series;
pub mod stack3d;
pub mod surface3d;
pub mod tiles;
