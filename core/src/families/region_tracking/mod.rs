//! Region tracking: one object, given by its region or its contour in the first frame, is found in every later one. Shared parts are
//! in `methods/region` and `methods/contour`.

mod active_contour;
mod camshift;
mod chan_vese;
mod correlation_filter;
mod greedy_contour;
mod mean_shift;
mod particle_filter;
mod rapid;
mod template_tracker;

pub use crate::methods::contour::{Placement, Snake};
pub use crate::methods::region::color::{ColorBins, ColorSpace};
pub use crate::methods::region::{RegionTracking, Settings};
pub use active_contour::{ActiveContour, External};
pub use camshift::{Background as CamshiftBackground, Camshift};
pub use chan_vese::ChanVese;
pub use correlation_filter::CorrelationFilter;
pub use greedy_contour::GreedyContour;
pub use mean_shift::{Background, MeanShift};
pub use particle_filter::{ParticleFilter, Resampling};
pub use rapid::{Prediction, Rapid, Solid, Weighting};
pub use template_tracker::{TemplateTracker, Update, Warp};
