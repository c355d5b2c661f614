//! The conclusion of a background subtraction: the score of the masks, the likely cause of their errors, and what to change.

use std::cmp::Ordering;

use super::Conclusion;
use super::vocabulary::{AREA, case, value};
use crate::products::objects::score::Matches;
use crate::scene::{Case, Step, Unit, Variable};

/// The share of the picture that differs from the background where the camera or the light has changed, not objects.
const FLOODED: f64 = 0.3;
/// That share where the camera is known to have moved.
const FLOODED_BY_MOTION: f64 = 0.15;

/// From this F₁ score on the errors are too few for advice.
const GOOD_F1: f64 = 0.9;

impl Conclusion {
    /// The pixels of all masks compared with the truth at the end of the run, of this one before.
    fn pixels(&self) -> Option<Matches> {
        self.run_pixels.or_else(|| self.errors.as_ref().map(Matches::of_pixels))
    }

    /// Tells the result of the frame, its score, the likely cause of its errors and the parameters that reduce them.
    pub(super) fn tell(&self, step: Step, [cause, instead]: [&'static Case; 2]) -> Step {
        const BOXES: [&Variable; 3] = [value::BOX_PRECISION, value::BOX_RECALL, value::BOX_F1];
        let step =
            step.put(value::FINAL_FOREGROUND, self.foreground).put(value::DIFFERING_SHARE, 100.0 * self.differing);
        let step = match (self.frame, self.run) {
            (None, _) => step.say(case::FRAME_RESULT),
            (_, Some(run)) => put_scores(step, run, BOXES).say(case::RUN_SCORE),
            (Some(frame), None) => {
                put_scores(step.put(value::TRUE_OBJECTS, frame.truths), frame, BOXES).say(case::FRAME_SCORE)
            }
        };
        let (step, has_moved) = (self.of_mask(step), self.camera_moved().is_some());
        let step = match self.camera {
            Some(moved) => step.put(value::CAMERA, moved),
            None => step,
        };
        if self.differing >= if has_moved { FLOODED_BY_MOTION } else { FLOODED } {
            return step.say(cause).say_if(has_moved, case::CAMERA_MOVED).say(instead);
        }
        match self.run.or(self.frame) {
            Some(boxes) => self.advice(step, boxes, instead),
            None => step,
        }
    }

    /// Tells the quality of the mask against the true foreground.
    fn of_mask(&self, step: Step) -> Step {
        const MASKS: [&Variable; 3] = [value::MASK_PRECISION, value::MASK_RECALL, value::MASK_F1];
        let Some(all) = self.pixels() else { return step };
        let step = put_errors(put_scores(step, all, MASKS), all, AREA);
        if self.run_pixels.is_none() && self.errors.as_ref().is_some_and(|errors| errors.labelled == 0) {
            return step.say(case::UNLABELLED);
        }
        if all.f1().is_none() {
            return step.say(case::NO_FOREGROUND);
        }
        let has_errors = all.misses() + all.false_positives() > 0;
        let step = step.say(if self.run_pixels.is_some() { case::ALL_MASKS } else { case::ITS_MASK });
        step.say(if has_errors { case::ERRORS } else { case::NO_ERRORS })
    }

    /// The displacement of the background since the first frame in px, where the camera is known to have moved.
    fn camera_moved(&self) -> Option<[f32; 2]> {
        self.camera.filter(|by| by[0].hypot(by[1]) > 1.0)
    }

    /// Tells what to change, by the errors of the mask where its truth is known, otherwise by those of the boxes: a box that overlaps a true
    /// one by too little is a miss and a false alarm, whatever the threshold is. `instead` names what to use where the camera moves.
    fn advice(&self, step: Step, boxes: Matches, instead: &'static Case) -> Step {
        if self.ghosts > 0 {
            return step.put(value::GHOSTS, self.ghosts).say(if self.ghosts == 1 { case::GHOST } else { case::GHOSTS });
        }
        let masks = self.pixels();
        let all = masks.unwrap_or(boxes);
        let step = put_errors(step, all, if masks.is_some() { AREA } else { Unit::WHOLE });
        let is_good = |matches: Matches| matches.f1().is_none_or(|f1| f1 >= GOOD_F1);
        match (all.misses(), all.false_positives()) {
            _ if masks.is_some() && is_good(all) && !is_good(boxes) => {
                let shape = match boxes.estimates.cmp(&boxes.truths) {
                    Ordering::Greater => case::SPLIT,
                    Ordering::Less => case::JOINED,
                    Ordering::Equal => case::MISSHAPEN,
                };
                step.say(if boxes.false_positives() == 0 { case::HIDDEN } else { shape })
            }
            (0, 0) => step,
            _ if is_good(all) => step,
            (misses, alarms) if misses > alarms => step.say(case::MISSES),
            // Neither a threshold nor an opening registers the frames.
            (misses, alarms) if misses < alarms && self.camera_moved().is_some() => {
                step.say(case::CAMERA_ALARMS).say(instead)
            }
            (misses, alarms) if misses < alarms => step.say(case::FALSE_ALARMS),
            (1, _) => step.say(case::ONE_OF_EACH),
            _ => step.say(case::AS_MANY),
        }
    }
}

fn put_scores(step: Step, all: Matches, of: [&'static Variable; 3]) -> Step {
    let scores = of.into_iter().zip([all.precision(), all.recall(), all.f1()]);
    scores.fold(step, |step, (of, score)| step.fact(of, score.unwrap_or(f64::NAN)))
}

fn put_errors(step: Step, all: Matches, unit: Unit) -> Step {
    let step = step.put_value(value::MISSES.is(all.misses()).in_unit(unit));
    step.put_value(value::FALSE_ALARMS.is(all.false_positives()).in_unit(unit))
}

#[cfg(test)]
mod tests {
    use super::super::declare::line;
    use super::*;

    #[test]
    fn advice_is_for_many_errors_of_one_kind() {
        let of = |conclusion: Conclusion, truths, estimates, pairs| {
            let step = Step::at(line::UPDATE_MODEL).put(value::CAMERA, conclusion.camera.unwrap_or_default());
            conclusion.advice(step, Matches { truths, estimates, pairs }, case::USE_MOTION).sentence.plain()
        };
        let advice = |truths, estimates, pairs| of(Conclusion::default(), truths, estimates, pairs);
        assert_eq!([advice(500, 499, 499), advice(10, 10, 10)], ["", ""]);
        assert!(advice(10, 5, 5).contains("misses (5): try a lower threshold"));
        assert!(advice(5, 10, 5).contains("false alarms (5): try a higher threshold"));
        let moved = of(Conclusion { camera: Some([-3.0, 0.5]), ..Conclusion::default() }, 5, 10, 5);
        assert!(moved.contains("the camera moves") && moved.ends_with(case::USE_MOTION.text), "{moved}");
        assert!(!moved.contains("threshold"), "{moved}");
    }
}
