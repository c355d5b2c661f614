//! A region that is found again after a loss, reported or not: the colours or the pattern may belong to another object.

use super::vocabulary::{case, value};
use crate::products::RegionFrame;
use crate::scene::{Case, Step, Unit};

/// Below this share of the similarity in the first frame the object is lost, whatever the tracker reports.
const GONE: f32 = 0.25;

/// The frame that ends a loss.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Regained {
    /// Its index in the run.
    pub index: usize,
    /// Frames of the loss, in a row before it, and those of them that are reported.
    lost: usize,
    reported: usize,
    /// Similarity in the last frame before the loss, and in it.
    similarities: [f32; 2],
    /// Distance of its region from that before the loss in px.
    distance_px: f32,
}

impl Regained {
    /// The frame `now` that follows `past`, if it ends a loss.
    pub fn of(past: &[RegionFrame], now: &RegionFrame) -> Option<Self> {
        let least = GONE * past.first()?.similarity;
        let is_gone = |frame: &RegionFrame| frame.is_lost || frame.similarity < least;
        let lost = past.iter().rev().take_while(|frame| is_gone(frame)).count();
        let reported = past[past.len() - lost..].iter().filter(|frame| frame.is_lost).count();
        let is_end = lost > 0 && !is_gone(now);
        let before = past.len().checked_sub(lost + 1).filter(|_| is_end).map(|last| &past[last])?;
        let [u, v] = [0, 1].map(|i| now.region.center[i] - before.region.center[i]);
        let similarities = [before, now].map(|frame| frame.similarity);
        Some(Self { index: past.len(), lost, reported, similarities, distance_px: u.hypot(v) })
    }

    /// The end of the longest loss of a run, the first of equals; `None` without a loss.
    pub fn longest(frames: &[RegionFrame]) -> Option<Self> {
        let all = (0..frames.len()).rev().filter_map(|index| Self::of(&frames[..index], &frames[index]));
        all.max_by_key(|regained| regained.lost)
    }

    /// Tells it in its own frame; `is_known` if the truth tells which object was found.
    pub fn tell(&self, step: Step, unit: Unit, is_known: bool) -> Step {
        let case = if self.reported == 0 { case::REGAINED_UNREPORTED } else { case::REGAINED };
        self.compare(step, unit, case).say_if(!is_known, case::DOUBTFUL)
    }

    /// Tells it about frame `frame` at the end of the run, with the `overlap` with the true box if that is known; says
    /// nothing if the region is on the object.
    pub fn conclude(&self, step: Step, unit: Unit, (frame, overlap): (usize, Option<f64>)) -> Step {
        let verdict = match overlap {
            None => case::DOUBTFUL,
            Some(0.0) => case::ON_ANOTHER,
            Some(_) => return step,
        };
        let case = if self.reported == 0 { case::WAS_REGAINED_UNREPORTED } else { case::WAS_REGAINED };
        self.compare(step.put(value::FRAME_AFTER, frame), unit, case).say(verdict)
    }

    /// Tells the loss by `case`, the distance, and both similarities in their unit.
    fn compare(&self, step: Step, unit: Unit, case: &'static Case) -> Step {
        let [before, after] = self.similarities;
        let step = step.put(value::LOST_FRAMES, self.lost).put(value::DISTANCE, self.distance_px);
        let step = step.put_value(value::SIMILARITY_BEFORE.is(before).in_unit(unit));
        step.put_value(value::SIMILARITY_AFTER.is(after).in_unit(unit)).say(case).say(case::AFTER_LOSS)
    }
}

#[cfg(test)]
mod tests {
    use super::super::line;
    use super::*;
    use crate::products::Region;

    /// Frames by their places, with those reported as lost below 0.
    fn frames(places: &[f32]) -> Vec<RegionFrame> {
        let frame = |place: &f32| RegionFrame {
            region: Region { center: [place.abs(), 0.0], ..Region::default() },
            similarity: place.abs() / 100.0,
            is_lost: *place < 0.0,
        };
        places.iter().map(frame).collect()
    }

    #[test]
    fn a_region_found_again_is_compared_with_that_before_the_loss() {
        let all = frames(&[10.0, 20.0, -20.0, -21.0, 50.0, 51.0]);
        let at = |index: usize| Regained::of(&all[..index], &all[index]);
        assert_eq!(
            at(4),
            Some(Regained { index: 4, lost: 2, reported: 2, similarities: [0.2, 0.5], distance_px: 30.0 })
        );
        assert_eq!([0, 1, 2, 3, 5].map(at), [None; 5]);
    }

    #[test]
    fn a_similarity_that_collapses_is_a_loss_that_is_not_reported() {
        let all = frames(&[40.0, 40.0, 9.0, 8.0, 30.0]);
        let found = Regained::longest(&all).expect("a loss that ends");
        assert_eq!((found.index, found.lost, found.reported), (4, 2, 0));
        let step = found.tell(Step::at(line::MOVE), Unit::RATIO, true);
        assert!(step.is(case::REGAINED_UNREPORTED) && step.real(value::LOST_FRAMES) == 2.0, "{step:?}");
        assert_eq!(Regained::longest(&frames(&[40.0, 40.0, 11.0, 40.0])), None, "not below a quarter");
    }

    #[test]
    fn a_loss_from_the_start_or_to_the_end_is_not_one_that_ends() {
        assert_eq!(Regained::longest(&frames(&[-10.0, 20.0, -20.0])), None);
        let index = |places: &[f32]| Regained::longest(&frames(places)).map(|regained| regained.index);
        assert_eq!(index(&[10.0, -10.0, 10.0, -10.0, -10.0, 30.0, -30.0, -30.0, -30.0]), Some(5));
        assert_eq!(index(&[10.0, -10.0, 10.0, -10.0, 10.0]), Some(2), "the first of equals");
    }
}
