//! The repeatability of a detector, for which it runs on the next frame as well.

use crate::base::{Error, Threads};
use crate::products::{Assessment, Output, PointField, Product, Reference};
use crate::run::AnyEstimator;

/// Whether `estimator` detects keypoints in single frames.
pub fn is_detector(estimator: &dyn AnyEstimator) -> bool {
    estimator.info().frames == 1 && estimator.produces().contains(&PointField::KIND)
}

/// Assesses how many of the keypoints of `output`, the result of `estimator` on the frame of `reference`, it detects again in the next frame. Empty
/// for what is no detector, and where the true flow is not known.
///
/// # Errors
/// If it cannot run on the next frame. Unreadable ground truth is reported in [`Assessment::truth_error`].
pub fn repeatability(
    estimator: &dyn AnyEstimator,
    output: &Output,
    reference: &Reference<'_>,
    threads: &Threads,
) -> Result<Assessment, Error> {
    let Reference { clip, frame } = *reference;
    let is_known = clip.truth().is_some_and(|truth| truth.kinds().contains(&"flow"));
    let Some(here) = output.get::<PointField>().filter(|_| is_known && is_detector(estimator)) else {
        return Ok(Assessment::default());
    };
    if !clip.has_frame(frame + 1)? {
        return Ok(Assessment::default());
    }
    let next = estimator.run(clip, frame + 1, threads)?;
    Ok(next.get::<PointField>().map_or_else(Assessment::default, |there| here.repeated(there, reference)))
}
