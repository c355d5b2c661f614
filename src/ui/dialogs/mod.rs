//! What opens over the panes.

pub mod camera;
pub mod chooser;
pub mod compare;
pub mod find;
pub mod fuzzy;
pub mod gallery;
pub mod lessons;
pub mod open;
pub mod palette;
pub mod path;
pub mod save;
pub mod sheet;
pub mod terms;
pub mod typed;
