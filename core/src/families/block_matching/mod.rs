//! Block matching: one displacement per block. One file per estimator; the shared parts are in `block_search`.

mod adaptive_rood;
mod diamond;
mod four_step;
mod full_search;
mod hexagon;
mod hierarchical;
mod log_search;
mod new_three_step;
mod predictive;
mod quadrant_search;
mod successive_elimination;
mod three_step;

pub use crate::methods::block_search::{BorderRule, Cost, Matching, Refinement, Settings, Subpixel};
pub use adaptive_rood::AdaptiveRood;
pub use diamond::Diamond;
pub use four_step::FourStep;
pub use full_search::{FullSearch, Order};
pub use hexagon::Hexagon;
pub use hierarchical::Hierarchical;
pub use log_search::LogSearch;
pub use new_three_step::NewThreeStep;
pub use predictive::Predictive;
pub use quadrant_search::QuadrantSearch;
pub use successive_elimination::SuccessiveElimination;
pub use three_step::ThreeStep;
