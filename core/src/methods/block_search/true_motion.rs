//! The true motion of a block beside its match: the error of the match, and its cause.

use std::cmp::Ordering;

use super::probe::Probe;
use super::vocabulary::{case, value};
use super::whole_window::WholeWindow;
use super::{Displacement, Match};
use crate::scene::Step;

/// A motion vector is called wrong from this distance from the true motion, in px.
pub(super) const CLOSE_PX: f32 = 1.0;
/// A block is called occluded from this share of hidden pixels.
const OCCLUDED: f64 = 0.5;
/// No search range is longer, in px.
const LONGEST_PX: f32 = 65_536.0;

/// The place of the true displacement among the candidates of the search window.
pub(super) enum Standing {
    /// The nearest candidate.
    Candidate(Displacement),
    /// The displacement is longer than the search range.
    BeyondRange,
    /// The displaced block leaves the picture.
    OutsidePicture,
}

impl Probe<'_> {
    /// Tells the true motion of the block beside the match, if it is known, and why a wrong match was preferred.
    pub(super) fn true_motion(&self, step: Step, found: Match) -> Step {
        let Some((truth, off)) = self.true_error(found) else { return step };
        let step = step.put(value::TRUE_MOTION, truth).put(value::ENDPOINT_ERROR, off).say(case::TRUTH);
        if off < CLOSE_PX { step } else { self.reason(step, truth, self.as_tested(found)) }
    }

    /// Why the match is not the true displacement.
    fn reason(&self, step: Step, truth: [f32; 2], found: Match) -> Step {
        let at = match self.standing(truth) {
            Standing::Candidate(at) => at,
            Standing::BeyondRange => return step.say(case::BEYOND_RANGE),
            Standing::OutsidePicture => return step.say(case::OUTSIDE_PICTURE),
        };
        let Some(true_cost) = self.full_search().cost(at).filter(|_| at != found.displacement) else { return step };
        let is_rounded = truth.iter().any(|c| c.fract() != 0.0);
        let step = step.put(value::TRUE_CANDIDATE, at).put_value(self.settings.cost(value::TRUE_COST, true_cost));
        let step = step.put(value::OCCLUDED, 100.0 * self.hidden_share());
        step.say(case::TRUE_DISPLACEMENT).say_if(is_rounded, case::ROUNDED).say(
            match true_cost.total_cmp(&found.cost) {
                Ordering::Less => case::NOT_TESTED,
                Ordering::Equal => case::COSTS_THE_SAME,
                Ordering::Greater if self.hidden_share() >= OCCLUDED => case::OCCLUDED,
                Ordering::Greater => case::COSTS_MORE,
            },
        )
    }

    /// Whether the true displacement is a candidate with a lower cost than the match, so that a test would have found it.
    pub(super) fn costs_less(&self, truth: [f32; 2], found: Match, surface: &WholeWindow) -> bool {
        match self.standing(truth) {
            Standing::Candidate(at) => surface.cost(at).is_some_and(|cost| cost < found.cost),
            Standing::BeyondRange | Standing::OutsidePicture => false,
        }
    }

    /// Whether the truth explains the error of the match.
    pub(super) fn is_explained(&self, found: Match) -> bool {
        let wrong = self.true_error(found).filter(|(_, off)| *off >= CLOSE_PX);
        wrong.is_some_and(|(truth, _)| match self.standing(truth) {
            Standing::Candidate(_) => self.hidden_share() >= OCCLUDED,
            Standing::BeyondRange | Standing::OutsidePicture => true,
        })
    }

    /// The place of a true displacement in px in the search window.
    fn standing(&self, truth: [f32; 2]) -> Standing {
        let at = truth.map(|c| c.clamp(-LONGEST_PX, LONGEST_PX).round() as i32);
        let length = at.map(i32::unsigned_abs).into_iter().max().unwrap_or(0) as usize;
        match self.window.index(at) {
            Some(_) => Standing::Candidate(at),
            None if self.pair.window(self.block(), length).index(at).is_some() => Standing::BeyondRange,
            None => Standing::OutsidePicture,
        }
    }

    /// The true motion of the block where it is a displacement of the search window.
    pub(super) fn truth_in_window(&self) -> Option<[f32; 2]> {
        self.truth_of_block().filter(|truth| matches!(self.standing(*truth), Standing::Candidate(_)))
    }

    /// The share of the pixels of the block that are hidden in frame t + 1; 0 where it is not known.
    fn hidden_share(&self) -> f64 {
        let hidden = self.truth.and_then(|(truth, frame)| truth.occlusion(frame).ok().flatten());
        let (Some(hidden), block) = (hidden, self.block()) else { return 0.0 };
        let places =
            (block.y..block.y + block.height).flat_map(|y| (block.x..block.x + block.width).map(move |x| (x, y)));
        let count = places.filter(|(x, y)| hidden.get(*x, *y).copied().unwrap_or(false)).count();
        count as f64 / (block.width * block.height) as f64
    }

    /// The true motion of the block and the endpoint error in px, where the truth is known.
    pub(super) fn true_error(&self, found: Match) -> Option<([f32; 2], f32)> {
        let truth = self.truth_of_block()?;
        let [u, v] = found.vector();
        Some((truth, (u - truth[0]).hypot(v - truth[1])))
    }

    /// The median of the true flow over the block, for each component; `None` where it is not known.
    pub(super) fn truth_of_block(&self) -> Option<[f32; 2]> {
        let (truth, frame) = self.truth?;
        let (flow, block) = (truth.flow(frame).ok().flatten()?, self.block());
        let places =
            (block.y..block.y + block.height).flat_map(|y| (block.x..block.x + block.width).map(move |x| (x, y)));
        let known: Vec<[f32; 2]> = places.filter_map(|(x, y)| flow.at(x, y)).collect();
        if known.is_empty() {
            return None;
        }
        Some([0, 1].map(|i| {
            let mut parts: Vec<f32> = known.iter().map(|uv| uv[i]).collect();
            parts.sort_by(f32::total_cmp);
            parts[parts.len() / 2]
        }))
    }
}
