//! The conclusion at the end of a pair or a run: how many features were tracked, how well, and why the others were lost.

use std::collections::BTreeMap;

use crate::data::Flow;
use crate::products::{Feature, Status};
use crate::scene::{Case, Name, Number, Role, Step, Unit};
use crate::{cases, variables};

variables! {
    /// The features that were tracked.
    TRACKED: "", "", Unit::count("");
    /// All features.
    FEATURES: "", "", Unit::count("feature");
    /// The mean endpoint error of the tracked features.
    MEAN_ERROR: "", "", Unit::SUBPIXEL, Role::Error;
    /// The mean residual of the tracked features.
    MEAN_RESIDUAL: "", "", Unit::GRAY, Role::Error;
    /// The features that were lost, by the reasons.
    LOST: "", "", Unit::WHOLE;
}

cases! { over value;
    TRACKED: "{tracked} of {features} tracked.",
    TRACKED_WITH_ERROR: "{tracked} of {features} tracked, mean endpoint error {mean_error}.",
    TRACKED_WITH_RESIDUAL: "{tracked} of {features} tracked, mean residual {mean_residual}.",
    LOST: "Lost: {lost}.",
    OUTSIDE: "Features that leave the frame cannot be kept.",
    FLAT: "A larger window or a lower minimum eigenvalue keeps more of them.",
    UNLIKE: "More levels help if the motion is large; occluded features cannot be kept.",
    ASTRAY: "Occlusion and wrong matches cause this; more levels or a larger window reduce wrong matches.",
    CHANGED: "A higher maximum dissimilarity keeps more of them, at the risk of drift.",
    UNMATCHED: "The detector does not find them again, or their descriptors are ambiguous: a lower threshold or a higher \
                ratio limit keeps more.",
}

/// Says how many of `features`, each called `one`, were tracked, how well, and why the others were lost.
pub fn conclude(step: Step, one: &'static str, features: impl Iterator<Item = Feature>, truth: Option<&Flow>) -> Step {
    let (mut all, mut tracked, mut errors, mut residuals) = (0usize, 0usize, Vec::new(), Vec::new());
    let mut lost: BTreeMap<&'static str, (usize, &'static Case)> = BTreeMap::new();
    for feature in features {
        all += 1;
        let Some(uv) = feature.displacement else {
            if let Some((reason, advice)) = reason(feature.status) {
                lost.entry(reason).or_insert((0, advice)).0 += 1;
            }
            continue;
        };
        tracked += 1;
        residuals.extend(feature.residual);
        let true_uv = truth.and_then(|truth| truth.sample(feature.at));
        errors.extend(true_uv.map(|truth| (uv[0] - truth[0]).hypot(uv[1] - truth[1])));
    }
    let step = step.put(value::TRACKED, tracked).put_value(value::FEATURES.is(all).in_unit(Unit::count(one)));
    let step = match (mean(&errors), mean(&residuals)) {
        (Some(error), _) => step.put(value::MEAN_ERROR, error).say(case::TRACKED_WITH_ERROR),
        (None, Some(residual)) => step.put(value::MEAN_RESIDUAL, residual).say(case::TRACKED_WITH_RESIDUAL),
        (None, None) => step.say(case::TRACKED),
    };
    let reasons: Number = lost.iter().map(|(reason, (count, _))| format!("{count} {reason}")).collect();
    match lost.values().max_by_key(|(count, _)| *count) {
        Some((_, advice)) => step.put(value::LOST, reasons).say(case::LOST).say(advice),
        None => step,
    }
}

/// The same as text, for steps whose sentences are not made of cases yet; `name` is in the plural.
pub fn conclusion(name: &'static str, features: impl Iterator<Item = Feature>, truth: Option<&Flow>) -> String {
    conclude(Step::at(Name::new(b"end")), name.trim_end_matches('s'), features, truth).sentence.plain()
}

fn mean(values: &[f32]) -> Option<f32> {
    (!values.is_empty()).then(|| values.iter().sum::<f32>() / values.len() as f32)
}

/// Why a feature was lost, in words; `None` for a tracked one.
pub fn reason_of(status: Status) -> Option<&'static str> {
    reason(status).map(|(reason, _)| reason)
}

/// Why a feature was lost, and what would help.
fn reason(status: Status) -> Option<(&'static str, &'static Case)> {
    match status {
        Status::Outside => Some(("out of the frame", case::OUTSIDE)),
        Status::Flat => Some(("ill-conditioned", case::FLAT)),
        Status::Unlike => Some(("above the residual limit", case::UNLIKE)),
        Status::Astray => Some(("inconsistent forward and backward", case::ASTRAY)),
        Status::Changed => Some(("changed in appearance", case::CHANGED)),
        Status::Unmatched => Some(("without a match", case::UNMATCHED)),
        Status::Found | Status::Tracked => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;

    #[test]
    fn errors_come_from_the_truth_and_losses_are_counted() {
        let feature = |displacement, status| Feature { at: [2.0, 2.0], displacement, status, residual: Some(1.5) };
        let all = [
            feature(Some([1.0, 0.0]), Status::Tracked),
            feature(None, Status::Flat),
            feature(None, Status::Flat),
            feature(None, Status::Outside),
        ];
        let truth = Flow(Grid::new(6, 6, [1.0, 0.5]));
        let with = conclusion("points", all.into_iter(), Some(&truth));
        assert!(
            with.starts_with("1 of 4 points tracked, mean endpoint error 0.500 px. Lost: 2 ill-conditioned, 1 out")
        );
        assert!(with.contains("lower minimum eigenvalue"), "{with}");
        assert!(conclusion("points", all.into_iter(), None).contains("mean residual 1.50 gray levels"));
        assert_eq!(conclusion("points", [].into_iter(), None), "0 of 0 points tracked.");
    }
}
