//! The conclusion at the end of a pair or a run: how many features were tracked, how well, and why the others were lost.

use crate::data::Flow;
use crate::products::{Feature, Status};
use crate::scene::{Case, Readout, Role, Sentence, Step, Unit, Variable};
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
    /// The features that were lost.
    LOST: "Lost so far", "", Unit::count(""), Role::Rejected;
    /// The features that left the frame.
    LOST_OUTSIDE: "", "", Unit::count("");
    /// The features that were lost because their windows are ill-conditioned.
    LOST_FLAT: "", "", Unit::count("");
    /// The features that were lost because their residuals exceed the limit.
    LOST_UNLIKE: "", "", Unit::count("");
    /// The features that were lost because tracking back leads elsewhere.
    LOST_ASTRAY: "", "", Unit::count("");
    /// The features that were lost because they no longer look like their first views.
    LOST_CHANGED: "", "", Unit::count("");
    /// The features that were lost because the next frame has no match of theirs.
    LOST_UNMATCHED: "", "", Unit::count("");
}

cases! { over value;
    TRACKED: "{tracked} of {features} tracked.",
    TRACKED_WITH_ERROR: "{tracked} of {features} tracked, mean endpoint error {mean_error}.",
    TRACKED_WITH_RESIDUAL: "{tracked} of {features} tracked, mean residual {mean_residual}.",
    LOST: "Lost:",
    LOST_OUTSIDE: "{lost_outside} out of the frame",
    LOST_FLAT: "{lost_flat} ill-conditioned",
    LOST_UNLIKE: "{lost_unlike} above the residual limit",
    LOST_ASTRAY: "{lost_astray} inconsistent forward and backward",
    LOST_CHANGED: "{lost_changed} changed in appearance",
    LOST_UNMATCHED: "{lost_unmatched} without a match",
    COMMA: ",",
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
    let Some((Loss { advice, .. }, _)) = losses.iter().max_by_key(|(_, count)| *count) else { return step };
    let (step, reasons) = (put_losses(step, &losses), list(&losses));
    reasons.into_iter().fold(step.say(case::LOST), Step::say).say(case::END).say(advice)
}

/// Adds the fact how many features were lost, for each reason.
pub fn put_lost(step: Step, statuses: impl Iterator<Item = Status>) -> Step {
    let losses = losses(statuses);
    if losses.is_empty() {
        return step;
    }
    let mut step = put_losses(step, &losses);
    let reasons = list(&losses).into_iter().fold(Sentence::default(), |said, case| said.say(case, &step.values));
    step = step.fact(value::LOST, losses.iter().map(|(_, count)| count).sum::<usize>());
    if let Some(Readout::Facts(facts)) = step.readouts.first_mut()
        && let Some(fact) = facts.last_mut()
    {
        fact.value = reasons.plain();
    }
    step
}

fn put_losses(step: Step, losses: &[(Loss, usize)]) -> Step {
    losses.iter().fold(step, |step, (loss, count)| step.put(loss.lost, *count))
}

fn list(losses: &[(Loss, usize)]) -> Vec<&'static Case> {
    let mut cases: Vec<_> = losses.iter().flat_map(|(loss, _)| [loss.case, case::COMMA]).collect();
    cases.pop();
    cases
}

/// The number of lost features for each reason, in the order of its words.
fn losses(statuses: impl Iterator<Item = Status>) -> Vec<(Loss, usize)> {
    let mut losses: Vec<(Loss, usize)> = Vec::new();
    for loss in statuses.filter_map(loss) {
        match losses.iter_mut().find(|(known, _)| *known == loss) {
            Some((_, count)) => *count += 1,
            None => losses.push((loss, 1)),
        }
    }
    losses.sort_by_key(|(loss, _)| loss.words());
    losses
}

fn mean(values: impl Iterator<Item = f32>) -> Option<f32> {
    let (sum, count) = values.fold((0.0, 0u32), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / count as f32)
}

/// A reason for which features are lost.
#[derive(Clone, Copy, PartialEq)]
struct Loss {
    /// The number of these features.
    lost: &'static Variable,
    /// The case that tells it.
    case: &'static Case,
    /// The remedy.
    advice: &'static Case,
}

impl Loss {
    /// The reason in words, which stand behind the number.
    fn words(self) -> &'static str {
        self.case.text.split_once(' ').map_or("", |(_, words)| words)
    }
}

/// The reason for which a feature was lost, in words; `None` for a tracked one.
pub fn reason_of(status: Status) -> Option<&'static str> {
    loss(status).map(Loss::words)
}

fn loss(status: Status) -> Option<Loss> {
    let (lost, case, advice) = match status {
        Status::Outside => (value::LOST_OUTSIDE, case::LOST_OUTSIDE, case::OUTSIDE),
        Status::Flat => (value::LOST_FLAT, case::LOST_FLAT, case::FLAT),
        Status::Unlike => (value::LOST_UNLIKE, case::LOST_UNLIKE, case::UNLIKE),
        Status::Astray => (value::LOST_ASTRAY, case::LOST_ASTRAY, case::ASTRAY),
        Status::Changed => (value::LOST_CHANGED, case::LOST_CHANGED, case::CHANGED),
        Status::Unmatched => (value::LOST_UNMATCHED, case::LOST_UNMATCHED, case::UNMATCHED),
        Status::Found | Status::Tracked => return None,
    };
    Some(Loss { lost, case, advice })
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
