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

pub use active_contour::ActiveContour;
pub use camshift::Camshift;
pub use chan_vese::ChanVese;
pub use correlation_filter::CorrelationFilter;
pub use greedy_contour::GreedyContour;
pub use mean_shift::MeanShift;
pub use particle_filter::ParticleFilter;
pub use rapid::Rapid;
pub use template_tracker::TemplateTracker;
