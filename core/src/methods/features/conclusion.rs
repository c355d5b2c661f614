//! The conclusion at the end of a pair or a run: how many features were tracked, how well, and why the others were lost.

use std::collections::BTreeMap;

use crate::data::Flow;
use crate::methods::differential::numbers;
use crate::products::{Feature, Status};

/// The conclusion on `features`, called `name`: `9 of 12 points tracked, …`.
pub fn conclusion(name: &str, features: impl Iterator<Item = Feature>, truth: Option<&Flow>) -> String {
    let (mut all, mut tracked, mut errors, mut residuals) = (0usize, 0usize, Vec::new(), Vec::new());
    let mut lost: BTreeMap<&'static str, (usize, &'static str)> = BTreeMap::new();
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
    let quality = match (mean(&errors), mean(&residuals)) {
        (Some(error), _) => format!(", mean endpoint error {} px", numbers::px(error)),
        (None, Some(residual)) => format!(", mean residual {} gray levels", numbers::gray(residual)),
        (None, None) => String::new(),
    };
    let reasons: Vec<String> = lost.iter().map(|(reason, (count, _))| format!("{count} {reason}")).collect();
    let most = lost.values().max_by_key(|(count, _)| *count);
    let losses = match most {
        Some((_, advice)) => format!(" Lost: {}. {advice}", reasons.join(", ")),
        None => String::new(),
    };
    format!("{tracked} of {all} {name} tracked{quality}.{losses}")
}

fn mean(values: &[f32]) -> Option<f32> {
    (!values.is_empty()).then(|| values.iter().sum::<f32>() / values.len() as f32)
}

/// Why a feature was lost, in words; `None` for a tracked one.
pub fn reason_of(status: Status) -> Option<&'static str> {
    reason(status).map(|(reason, _)| reason)
}

/// Why a feature was lost, and what would help.
fn reason(status: Status) -> Option<(&'static str, &'static str)> {
    match status {
        Status::Outside => Some(("out of the frame", "Features that leave the frame cannot be kept.")),
        Status::Flat => Some(("ill-conditioned", "A larger window or a lower minimum eigenvalue keeps more of them.")),
        Status::Unlike => Some((
            "above the residual limit",
            "More levels help if the motion is large; occluded features cannot be kept.",
        )),
        Status::Astray => Some((
            "inconsistent forward and backward",
            "Occlusion and wrong matches cause this; more levels or a larger window reduce wrong matches.",
        )),
        Status::Changed => {
            Some(("changed in appearance", "A higher maximum dissimilarity keeps more of them, at the risk of drift."))
        }
        Status::Unmatched => Some((
            "without a match",
            "The detector does not find them again, or their descriptors are ambiguous: a lower threshold or a higher ratio limit keeps \
             more.",
        )),
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
