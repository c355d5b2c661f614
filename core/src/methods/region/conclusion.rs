//! The conclusion at the end of a run of a tracker of a region.

use super::explain::{errors, put_verdict, verdict};
use super::regained::Regained;
use super::start::WHOLE;
use super::vocabulary::{case, value};
use super::{Ending, Explained, Outcome, RegionTracking, State, content};
use crate::data::Clip;
use crate::products::region::{NEAR_PX, RegionError, RegionScores, Sight};
use crate::products::{RegionField, RegionFrame};
use crate::run::Seen;
use crate::scene::Step;

impl<T: Explained> RegionTracking<T> {
    /// Tells the scores, the outcome of the region, and its cause.
    pub(super) fn conclude(
        &self,
        (seen, after): (&Seen<Self>, &State<T::Model>),
        result: &RegionFrame,
        step: Step,
    ) -> Step {
        let errors = errors(seen.clip, after);
        let ending = Ending::in_clip(&after.field(), seen.clip, &errors);
        let step = step.put(value::REPORTED, ending.reported).put(value::HIDDEN, ending.hidden);
        let step = match RegionScores::of(&errors) {
            Some(of) => put_scores(step, &of, ending),
            None => step.put(value::FRAMES, after.past.len()).say(case::UNSCORED),
        };
        let last = errors.last().filter(|error| error.frame + 1 == after.frame);
        let step = match last.and_then(|error| Some((error, verdict(error)?))) {
            _ if result.is_lost => {
                Self::with_last(seen, step.say(case::LAST_LOST), |at, step| self.0.tell_loss(at, step)).say(case::END)
            }
            Some((error, verdict)) => put_verdict(step, error).say(case::LAST).say(verdict).say(case::END),
            None => Self::with_last(seen, step, |at, step| self.0.tell_caveat(at, step)),
        };
        let step = match self.0.settings().restart {
            true => tell_restarts(after, step),
            false => Self::tell_regained((after, &errors), step),
        };
        let step = content::tell(step, seen.clip, &after.mask_field(), &errors);
        let vanished = Vanished::of(&after.field(), seen.clip);
        let step = match &vanished {
            Some(vanished) => vanished.tell(step),
            None => step,
        };
        let step = Self::with_last(seen, step, |at, step| self.0.tell_summary(at, step));
        if ending.outcome == Outcome::Unknown {
            return step.say(case::UNJUDGED);
        }
        // The last regions are off because there is little or nothing to see, whatever feature a tracker compares.
        let tells_cause = T::JUDGES_LOSS && ending.loss.is_some();
        if vanished.is_some() && !tells_cause && !matches!(ending.outcome, Outcome::Followed | Outcome::Regained) {
            return step;
        }
        Self::with_last(seen, step, |at, step| self.0.advise(ending, at, step))
    }

    /// Tells at the end of a run about the region that was found again after its longest loss.
    fn tell_regained((after, errors): (&State<T::Model>, &[RegionError]), step: Step) -> Step {
        let Some(regained) = Regained::longest(&after.past) else { return step };
        let frame = after.span.first + regained.index;
        // An object without a true box in the frame is hidden there.
        let overlap = || errors.iter().find(|error| error.frame == frame).map_or(0.0, |error| error.overlap);
        regained.conclude(step, Self::UNIT, (frame, (!errors.is_empty()).then(overlap)))
    }
}

/// An object that cannot be seen at the end of a run.
struct Vanished {
    /// The first of the last frames in which it is not wholly visible.
    from: usize,
    /// The first of the last frames in which no part of it can be seen.
    gone: usize,
    /// Why, there.
    sight: Sight,
}

impl Vanished {
    /// Finds it in a run; `None` where the object is visible in the last frame, or its visibility is unknown.
    fn of(field: &RegionField, clip: &Clip) -> Option<Self> {
        let last: Vec<(usize, Sight)> = (1..field.frames.len())
            .rev()
            .map_while(|index| Some((field.first + index, field.sight(clip, index).ok()??)))
            .take_while(|(_, sight)| !matches!(sight, Sight::Seen(share) if *share >= WHOLE))
            .collect();
        let is_gone = |(_, sight): &&(usize, Sight)| !matches!(sight, Sight::Seen(_));
        let (gone, sight) = *last.iter().take_while(is_gone).last()?;
        Some(Self { from: last.last().map_or(gone, |(frame, _)| *frame), gone, sight })
    }

    fn tell(&self, step: Step) -> Step {
        let step = step.put(value::DISAPPEARING, self.from).put(value::GONE, self.gone).say(case::BY_TRUTH);
        let is_absent = self.sight == Sight::Absent;
        let step = step.say_if(self.from < self.gone, case::DISAPPEARS);
        step.say(if is_absent { case::IS_ABSENT } else { case::IS_HIDDEN }).say(case::UNSEEN)
    }
}

fn put_scores(step: Step, of: &RegionScores, ending: Ending) -> Step {
    let step = step.put(value::FRAMES, of.frames).put(value::MEAN_OVERLAP, of.overlap).put(value::SUCCESS, of.success);
    let step = step.put(value::NEAR, NEAR_PX).put(value::PRECISION, of.precision).put(value::FAILURES, of.failures);
    step.say(case::SCORED).say(match (of.failures, ending.reported) {
        (0, 0) => case::END,
        (_, 0) => case::NO_LOSS,
        (_, _) => case::LOSSES,
    })
}

fn tell_restarts<M>(state: &State<M>, step: Step) -> Step {
    match state.restarts.count {
        0 => step,
        1 => step.say(case::RESTARTED_ONCE),
        count => step.put(value::RESTARTS, count).say(case::RESTARTED),
    }
}
