//! What estimators of disparity share: the two views, the census transform, the tests of a match, and their explanation.

mod census;
mod explain;
mod matching;
mod settings;
mod views;

pub(crate) use census::{BITS, census};
pub(crate) use explain::{Curve, Pair, WHOLE_PX, concluded, draw_map, draw_match, measured, starting, value, warned};
pub use matching::{Kept, Verdict};
pub(crate) use matching::{Winners, accept, smallest, vertex};
pub use settings::Settings;
pub(crate) use views::Views;
