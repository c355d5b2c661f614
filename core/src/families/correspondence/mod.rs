//! Correspondence of pictures: templates, phases and whole pictures that are aligned; features that are matched.

mod image_alignment;
mod phase_correlation;
mod template_matching;

pub use image_alignment::ImageAlignment;
pub use phase_correlation::PhaseCorrelation;
pub use template_matching::TemplateMatching;
