//! Parts shared by disparity estimators: the two views, the census transform, the tests of a match, and their explanation.
//!
//! A clip has at most one right view, a clip of its own (`Clip::with_right`), and a `Calibration`; [`Views::new`] gives both
//! views of a frame, or frames t and t + 1. The product is a `DisparityField`; depths follow from its calibration. Costs are
//! whole numbers, so sums in any order are equal: `semi-global-matching` steps direction by direction, while its `run` follows
//! the paths of all downward directions in one pass and all others in a second.

mod census;
mod explain;
mod matching;
mod settings;
mod views;

pub(crate) use census::{BITS, census};
pub(crate) use explain::{
    Curve, Pair, WHOLE_PX, add_warning, conclude, draw_map, draw_match, put_depth, starting, value,
};
pub use matching::{Kept, Verdict};
pub(crate) use matching::{Winners, accept, smallest, vertex};
pub use settings::Settings;
pub(crate) use views::Views;
