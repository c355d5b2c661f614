//! Region tracking: one object, given by its region in the first frame, is found in every later one. Shared parts are in
//! `methods/region`.

mod camshift;
mod correlation_filter;
mod mean_shift;
mod particle_filter;

pub use camshift::Camshift;
pub use correlation_filter::CorrelationFilter;
pub use mean_shift::MeanShift;
pub use particle_filter::ParticleFilter;
