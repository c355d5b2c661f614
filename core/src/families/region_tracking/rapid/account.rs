//! The poses of a run: the number of wrong ones if the truth is known, and the fit of their edges if it is not.

use super::vocabulary::{case, value};
use super::{Judged, Pose};
use crate::scene::Step;

/// The error of a rotation in degrees from which on wrong edges were matched: noise makes one far below.
pub const WRONG_DEG: f64 = 5.0;
/// The same of a translation, as a share of the distance of the object from the camera.
pub const WRONG_SHARE: f64 = 0.05;

/// The length of a vector.
pub fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// The errors of a pose.
#[derive(Clone, Copy, Debug)]
pub struct PoseError {
    /// The angle of the rotation between both poses in degrees.
    pub degrees: f64,
    /// The length of the translation between them in mm.
    pub mm: f64,
    /// Its share of the distance from the camera.
    pub share: f64,
}

impl PoseError {
    pub fn of(pose: &Pose, truth: &Pose) -> Self {
        let [rotation, shift] = pose.motion_to(truth).map(length);
        let share = shift / length(truth.translation).max(f64::MIN_POSITIVE);
        Self { degrees: rotation.to_degrees(), mm: 1000.0 * shift, share }
    }

    /// Whether wrong edges were matched.
    pub fn is_wrong(&self) -> bool {
        self.degrees > WRONG_DEG || self.share > WRONG_SHARE
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
        let Judged { share, residual_px, loss, .. } = *judged;
        Self { pose: judged.is_kept().then_some(judged.view.pose), share, residual_px, is_lost: loss.is_some() }
    }
}

/// The frames with a true pose.
#[derive(Clone, Copy, Debug)]
pub struct Count {
    frames: usize,
    /// Frames with a wrong pose, and those of them that are not reported as lost.
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

    fn tell(self, step: Step) -> Step {
        let Self { frames, wrong, unreported } = self;
        let step = step.put(value::TRUE_POSES, frames).put(value::WRONG_POSES, wrong);
        let step = step.put(value::UNREPORTED, unreported).put(value::WRONG_ANGLE, WRONG_DEG);
        let step = step.put(value::WRONG_SHARE, 100.0 * WRONG_SHARE);
        match (wrong, unreported) {
            (0, _) => step.say(case::NEVER_WRONG),
            (_, 0) => step.say(case::POSE_FAILURES).say(case::ALL_REPORTED),
            _ => step.say(case::POSE_FAILURES).say(case::SOME_UNREPORTED),
        }
    }
}

/// Summarises all frames of a run; `truth` has the true poses by the index of their frame, where they are known.
pub fn tell(step: Step, all: &[Past], truth: impl Fn(usize) -> Option<Pose>) -> Step {
    match Count::of(all, truth) {
        Some(count) => count.tell(step),
        None => by_edges(step, all),
    }
}

/// Tells how well the edges fit where the object is not lost.
fn by_edges(step: Step, all: &[Past]) -> Step {
    let kept: Vec<_> = all.iter().filter(|past| !past.is_lost).collect();
    let mean = |of: fn(&Past) -> f64| kept.iter().map(|past| of(past)).sum::<f64>() / kept.len() as f64;
    if kept.is_empty() {
        return step;
    }
    let step = step.put(value::MEAN_SHARE, 100.0 * mean(|past| past.share));
    step.put(value::MEAN_RESIDUAL, mean(|past| past.residual_px)).say(case::BY_EDGES)
}

#[cfg(test)]
mod tests {
    use super::super::line;
    use super::*;

    fn past(pose: Option<Pose>, is_lost: bool) -> Past {
        Past { pose, share: 0.9, residual_px: 0.2, is_lost }
    }

    #[test]
    fn wrong_poses_are_counted_whether_they_are_reported_or_not() {
        let at = |z| Pose::tilted((0.0, 1.0), (0.0, 1.0), [0.0, 0.0, z]);
        let truth = |_| Some(at(2.0));
        let said = |all: &[Past]| tell(Step::at(line::MOVE), all, truth).sentence.plain();
        assert!(said(&[past(Some(at(2.09)), false)]).starts_with("In 1 frame the pose never differs"));
        let two = [past(Some(at(2.11)), true), past(Some(at(2.0)), false), past(None, true)];
        assert!(said(&two).contains("in 2 of 3 frames: pose failures, all of them reported"), "{}", said(&two));
        let one = [past(Some(at(2.11)), false), past(None, true)];
        assert!(said(&one).contains("in 2 of 2 frames: pose failures, 1 of them not reported"), "{}", said(&one));
    }

    #[test]
    fn without_true_poses_the_edges_are_told() {
        let said = |all: &[Past]| tell(Step::at(line::MOVE), all, |_| None).sentence.plain();
        let told = said(&[past(None, true), past(None, false)]);
        assert!(told.contains("90.0 % of the control points") && told.contains("0.20 px"), "{told}");
        assert_eq!(said(&[past(None, true)]), "");
    }
}
