//! The poses of a run: how many are wrong where the true ones are known, and how well their edges fit where they are not.

use super::explain::{degrees, length};
use super::{Judged, Pose};
use crate::base::words::counted;
use crate::methods::numbers::{fixed, percent, px};

/// The error of a rotation in degrees from which on wrong edges were matched: noise makes one far below.
pub const WRONG_DEG: f64 = 5.0;
/// The same of a translation, as a share of the distance of the object from the camera.
pub const WRONG_SHARE: f64 = 0.05;

/// The errors of a pose.
#[derive(Clone, Copy, Debug)]
pub struct PoseError {
    /// The angle of the rotation between both poses in rad.
    pub angle: f64,
    /// The length of the translation between them in m, and its share of the distance from the camera.
    pub shift: f64,
    pub share: f64,
}

impl PoseError {
    pub fn of(pose: &Pose, truth: &Pose) -> Self {
        let [rotation, shift] = pose.motion_to(truth).map(length);
        Self { angle: rotation, shift, share: shift / length(truth.translation).max(f64::MIN_POSITIVE) }
    }

    /// The angle, the length and its share in words.
    pub fn words(&self) -> [String; 3] {
        [degrees(self.angle), format!("{} mm", fixed(1000.0 * self.shift, 1)), percent(self.share)]
    }

    /// Whether wrong edges were matched.
    pub fn is_wrong(&self) -> bool {
        self.angle > WRONG_DEG.to_radians() || self.share > WRONG_SHARE
    }
}

/// The judgement of a frame that the end of the run counts.
#[derive(Clone, Copy, Debug)]
pub struct Past {
    /// The pose that was kept, if one was.
    pose: Option<Pose>,
    /// Share of the control points with an edge, and their median distance from it in px.
    share: f64,
    residual_px: f64,
    is_lost: bool,
}

impl From<&Judged> for Past {
    fn from(judged: &Judged) -> Self {
        let Judged { share, residual_px, is_lost, is_kept, .. } = *judged;
        Self { pose: is_kept.then_some(judged.view.pose), share, residual_px, is_lost }
    }
}

/// The frames with a true pose.
#[derive(Clone, Copy, Debug)]
pub struct Count {
    frames: usize,
    /// Those with a wrong pose, and those of them that are not reported as lost.
    wrong: usize,
    unreported: usize,
}

impl Count {
    /// Counts the frames of a run; `truth` has the true poses by their index, where they are known.
    pub fn of(all: &[Past], truth: impl Fn(usize) -> Option<Pose>) -> Option<Self> {
        let mut count = Self { frames: 0, wrong: 0, unreported: 0 };
        for (past, truth) in all.iter().enumerate().filter_map(|(i, past)| Some((past, truth(i)?))) {
            let is_wrong = past.pose.is_none_or(|pose| PoseError::of(&pose, &truth).is_wrong());
            count.frames += 1;
            count.wrong += usize::from(is_wrong);
            count.unreported += usize::from(is_wrong && !past.is_lost);
        }
        (count.frames > 0).then_some(count)
    }

    /// Whether a pose is wrong.
    pub fn has_failures(&self) -> bool {
        self.wrong > 0
    }

    fn words(self) -> String {
        let Self { frames, wrong, unreported } = self;
        let bound = format!("{} or {} of the distance", degrees(WRONG_DEG.to_radians()), percent(WRONG_SHARE));
        let reported = match unreported {
            0 => "all of them reported as lost".to_owned(),
            _ => format!("{unreported} of them not reported as lost"),
        };
        match wrong {
            0 => format!(
                "In {} the pose never differs from the true one by more than {bound}.",
                counted(frames, "frame")
            ),
            _ => format!(
                "The pose differs from the true one by more than {bound} in {wrong} of {frames} frames: pose failures, {reported}."
            ),
        }
    }
}

/// What all frames of a run show, as a sentence; `truth` has the true poses by the index of their frame, where they are known.
pub fn summary(all: &[Past], truth: impl Fn(usize) -> Option<Pose>) -> Option<String> {
    Count::of(all, truth).map(Count::words).or_else(|| by_edges(all))
}

/// How well the edges fit where the object is not lost.
fn by_edges(all: &[Past]) -> Option<String> {
    let kept: Vec<_> = all.iter().filter(|past| !past.is_lost).collect();
    let mean = |of: fn(&Past) -> f64| kept.iter().map(|past| of(past)).sum::<f64>() / kept.len() as f64;
    (!kept.is_empty()).then(|| {
        format!(
            "Where it is not lost, {} of the control points have an edge, at a median distance of {} px (means over the frames). Edges of \
             something else may fit as closely: no true pose is known.",
            percent(mean(|past| past.share)),
            px(mean(|past| past.residual_px))
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn past(pose: Option<Pose>, is_lost: bool) -> Past {
        Past { pose, share: 0.9, residual_px: 0.2, is_lost }
    }

    #[test]
    fn wrong_poses_are_counted_whether_they_are_reported_or_not() {
        let at = |z| Pose::tilted((0.0, 1.0), (0.0, 1.0), [0.0, 0.0, z]);
        let truth = |_| Some(at(2.0));
        let said = |all: &[Past]| summary(all, truth).expect("a sentence");
        assert!(said(&[past(Some(at(2.09)), false)]).starts_with("In 1 frame the pose never differs"));
        let two = [past(Some(at(2.11)), true), past(Some(at(2.0)), false), past(None, true)];
        assert!(said(&two).contains("in 2 of 3 frames: pose failures, all of them reported"), "{}", said(&two));
        let one = [past(Some(at(2.11)), false), past(None, true)];
        assert!(said(&one).contains("in 2 of 2 frames: pose failures, 1 of them not reported"), "{}", said(&one));
    }

    #[test]
    fn without_true_poses_the_edges_are_told() {
        let said = summary(&[past(None, true), past(None, false)], |_| None).expect("a sentence");
        assert!(said.contains("90.0 % of the control points") && said.contains("0.20 px"), "{said}");
        assert_eq!(summary(&[past(None, true)], |_| None), None);
    }
}
