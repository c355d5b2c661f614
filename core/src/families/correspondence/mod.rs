//! Correspondence of pictures: templates, phases and whole pictures that are aligned; features that are matched.

mod phase_correlation;
mod template_matching;

pub use phase_correlation::PhaseCorrelation;
pub use template_matching::TemplateMatching;
