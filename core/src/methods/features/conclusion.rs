//! The conclusion at the end of a pair or a run: how many features were tracked, how well, and why the others were lost.

use std::collections::BTreeMap;

use crate::data::Flow;
use crate::products::{Feature, Status};
use crate::scene::{Case, Role, Step, Unit};
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
    /// The features that were lost for one reason.
    LOST: "Lost so far", "", Unit::count(""), Role::Rejected;
    /// The reason of a loss.
    REASON: "", "", Unit::WHOLE;
}

cases! { over value;
    TRACKED: "{tracked} of {features} tracked.",
    TRACKED_WITH_ERROR: "{tracked} of {features} tracked, mean endpoint error {mean_error}.",
    TRACKED_WITH_RESIDUAL: "{tracked} of {features} tracked, mean residual {mean_residual}.",
    LOST: "Lost: {lost} {reason}",
    LOST_TOO: ", {lost} {reason}",
    LOST_FOR: "{lost} {reason}",
    END: ".",
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
    let all: Vec<_> = features.collect();
    let tracked: Vec<_> = all.iter().filter_map(|feature| Some((feature, feature.displacement?))).collect();
    let error = |(feature, uv): &(&Feature, [f32; 2])| {
        let true_uv = truth?.sample(feature.at)?;
        Some((uv[0] - true_uv[0]).hypot(uv[1] - true_uv[1]))
    };
    let (errors, residuals) =
        (tracked.iter().filter_map(error), tracked.iter().filter_map(|(feature, _)| feature.residual));
    let step = step.put(value::TRACKED, tracked.len());
    let step = step.put_value(value::FEATURES.is(all.len()).in_unit(Unit::count(one)));
    let step = match (mean(errors), mean(residuals)) {
        (Some(error), _) => step.put(value::MEAN_ERROR, error).say(case::TRACKED_WITH_ERROR),
        (None, Some(residual)) => step.put(value::MEAN_RESIDUAL, residual).say(case::TRACKED_WITH_RESIDUAL),
        (None, None) => step.say(case::TRACKED),
    };
    let losses = losses(all.iter().map(|feature| feature.status));
    let Some((_, advice)) = losses.values().max_by_key(|(count, _)| *count) else { return step };
    let step = losses.iter().enumerate().fold(step, |step, (i, (reason, (count, _)))| {
        let step = step.put(value::LOST, *count).put(value::REASON, *reason);
        step.say(if i == 0 { case::LOST } else { case::LOST_TOO })
    });
    step.say(case::END).say(advice)
}

/// Adds a fact for each reason for which features were lost.
pub fn lost(step: Step, statuses: impl Iterator<Item = Status>) -> Step {
    losses(statuses).into_iter().fold(step, |step, (reason, (count, _))| {
        step.put(value::REASON, reason).fact_as(value::LOST.is(count), case::LOST_FOR)
    })
}

/// The number of lost features for each reason, with the remedy.
fn losses(statuses: impl Iterator<Item = Status>) -> BTreeMap<&'static str, (usize, &'static Case)> {
    let mut losses = BTreeMap::new();
    for (reason, advice) in statuses.filter_map(reason) {
        losses.entry(reason).or_insert((0, advice)).0 += 1;
    }
    losses
}

fn mean(values: impl Iterator<Item = f32>) -> Option<f32> {
    let (sum, count) = values.fold((0.0, 0u32), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / count as f32)
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

    crate::line_names!(END);

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
        let said =
            |all: &[Feature], truth| conclude(Step::at(END), "point", all.iter().copied(), truth).sentence.plain();
        let with = said(&all, Some(&truth));
        assert!(
            with.starts_with("1 of 4 points tracked, mean endpoint error 0.500 px. Lost: 2 ill-conditioned, 1 out")
        );
        assert!(with.contains("lower minimum eigenvalue"), "{with}");
        assert!(said(&all, None).contains("mean residual 1.50 gray levels"));
        assert_eq!(said(&[], None), "0 of 0 points tracked.");
    }
}
