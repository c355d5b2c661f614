//! The steps of FAST in values, words and formulas.

use super::probe::{Probe, number};
use super::{Event, Fast, Stage, State, case, corners, features, line, value};
use crate::methods::features::{
    Selection, Status, be, case as selection,
    segment::{Candidate, Circle, RADIUS, Shade, suppressed_by},
};
use crate::run::Seen;
use crate::scene::{Name, Role, Step};

impl Fast {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let Some(last) = seen.events.last() else { return self.limits(Step::at(line::EACH_PIXEL)).say(case::OPENING) };
        let Some(probe) = self.probe(seen) else { return self.of_row(seen.before, *last) };
        if probe.is_pointed_at {
            return self.verdict(seen, &probe);
        }
        let at = |line, role| {
            let step = self.put_pixel(seen, line, &probe);
            if let Some(role) = role { step.put_value(features::PIXEL.is(probe.place).inked(role)) } else { step }
        };
        let step = match (last, &probe.circle) {
            (Event::Tested(_), Some(circle)) => {
                self.tell_tests(self.put_pixel(seen, self.line_of(circle), &probe), circle)
            }
            (Event::Compared(_, None), _) => at(line::SUPPRESS, Some(Role::Best)).say(case::MAXIMUM),
            (Event::Compared(_, Some(by)), _) => {
                let step = at(line::SUPPRESS, Some(Role::Rejected)).put(features::NEIGHBOUR, *by);
                let is_higher = seen.before.map[*by] > seen.before.map[probe.place];
                let step = step.put(value::OTHER_SCORE, seen.before.map[*by]).say(case::SUPPRESSED);
                step.say(if is_higher { case::BY_HIGHER } else { case::BY_EQUAL })
            }
            (Event::Peak(_, None), _) => {
                let count = seen.events.iter().filter(|event| matches!(event, Event::Peak(_, None))).count();
                at(line::KEEP, Some(Role::Result)).put(features::KEPT, count).say(case::KEPT)
            }
            (Event::Peak(peak, Some(near)), _) => {
                let [score, other] = [peak, near].map(|index| seen.before.response(*index));
                let step =
                    at(line::DROP_NEAR, Some(Role::Rejected)).put(features::NEAR_CORNER, seen.before.place(*near));
                let step = step.put(value::OTHER_SCORE, other).say(case::NEAR);
                step.say(if other > score { case::TO_HIGHER } else { case::TO_EQUAL })
            }
            _ => {
                let count = seen.before.peaks.len();
                at(line::EACH_PEAK, None).put(value::CORNERS, count).put(features::BE, be(count)).say(case::RANKED)
            }
        };
        self.add_charts(seen, self.conclude(seen, step), &probe)
    }

    /// Puts the parameters.
    fn limits(&self, step: Step) -> Step {
        let Selection { min_distance, max_points } = self.selection;
        let step = step.put(value::THRESHOLD, self.threshold).put(value::ARC, self.arc);
        let step = step.put(value::COMPASS, self.test().compass_points());
        step.put(features::MAX_POINTS, max_points).put(features::MIN_DISTANCE, min_distance)
    }

    /// Explains an event of a row, or that there is nothing to select from.
    fn of_row(&self, state: &State, event: Event) -> Step {
        let row = |line| self.limits(Step::at(line)).fact_of(features::ROW.is(state.row).inked(Role::Window));
        match event {
            Event::Row => {
                let (all, passing) = self.passing(state, state.row);
                let step = row(line::HIGH_SPEED).fact(value::WITH_CIRCLE, all).fact(value::PASSING, passing);
                step.say(if all == 0 { case::NO_CIRCLE } else { case::HIGH_SPEED })
            }
            Event::Corners => {
                let count = corners(&state.map, state.row).count();
                let said = if count == 0 { case::NO_CORNERS_IN_ROW } else { case::CORNERS_IN_ROW };
                row(line::EACH_CORNER).fact(value::CORNERS, count).say(said)
            }
            _ => {
                let has_corners = state.map.cells().iter().any(|score| *score > 0);
                let step = self.limits(Step::at(line::EACH_PEAK)).fact(features::LOCAL_MAXIMA, state.peaks.len());
                let step = step.put(value::HIGHEST_SCORE, self.test().highest_score(state.picture.luma()));
                step.say(if has_corners { case::NO_MAXIMA } else { case::NO_CORNERS })
            }
        }
    }

    /// The number of pixels of a row with a circle, and of those that pass the high-speed test.
    fn passing(&self, state: &State, y: usize) -> (usize, usize) {
        let mut passing: Vec<Candidate> = Vec::new();
        let mut scores = vec![0; state.map.width()];
        self.test().row(state.picture.luma(), y, &mut scores, &mut passing);
        let (width, height) = state.map.size();
        let has_circles = (RADIUS..height.saturating_sub(RADIUS)).contains(&y);
        (if has_circles { width.saturating_sub(2 * RADIUS) } else { 0 }, passing.len())
    }

    /// Puts the known values of a pixel, and its score if it is a corner.
    fn put_pixel(&self, seen: &Seen<Self>, line: Name, Probe { place, circle, .. }: &Probe) -> Step {
        let step = self.limits(Step::at(line)).fact(features::PIXEL, *place);
        let Some(circle) = circle else { return step };
        let (start, length) = circle.run.unwrap_or_default();
        let step = step.fact(value::LEVEL, circle.level).fact(value::BRIGHTER, circle.count(Shade::Brighter));
        let step = step.fact(value::DARKER, circle.count(Shade::Darker)).fact(value::RUN, length);
        let step = step.fact(value::ARC, self.arc).fact(value::SCORE, circle.score);
        let step = step.put(value::COMPASS_RUN, circle.compass).put(value::RUN_START, number(start));
        let step = step.put(value::RUN_END, number(start + length.max(1) - 1));
        let (level, threshold) = (i32::from(circle.level), self.threshold as i32);
        let is_darker = circle.shades[start] == Shade::Darker;
        let step = step.put(value::RUN_LIMIT, if is_darker { level - threshold } else { level + threshold });
        if circle.arc.is_none() {
            return step;
        }
        let (weakest, difference) = weakest(circle, self.arc);
        let step = step.put(value::WEAKEST, number(weakest)).put(value::DIFFERENCE, u32::from(difference));
        let step = step.put(value::WEAKEST_LEVEL, level + i32::from(circle.differences[weakest]));
        let step = self.status(seen, *place).into_iter().fold(step, |step, of| step.fact(features::STATUS, of.words));
        let step = step.formula(r"V = \text{max over arcs of }{arc}\text{ pixels of (min }|I_k - I_p|\text{)} - 1");
        step.formula("V = |{weakest_level} - {level}| - 1 = {score}")
    }

    /// The line that decides about a pixel by its circle.
    fn line_of(&self, circle: &Circle) -> Name {
        match circle.compass < self.test().compass_points() {
            true => line::HIGH_SPEED,
            false if circle.arc.is_none() => line::SEGMENT_TEST,
            false => line::SCORE,
        }
    }

    fn tell_tests(&self, step: Step, circle: &Circle) -> Step {
        let role = if circle.arc.is_some() { Role::Best } else { Role::Rejected };
        let step = step.put_value(features::PIXEL.is(circle.center).inked(role));
        if self.line_of(circle) == line::HIGH_SPEED {
            return step.say(case::FAILS_COMPASS);
        }
        let (start, length) = circle.run.unwrap_or_default();
        let step = step.say(if circle.arc.is_some() { case::CONTIGUOUS } else { case::LONGEST });
        let step = step.say_if(length == 1, case::AT).say_if((2..16).contains(&length), case::FROM_TO);
        match (circle.arc.is_some(), circle.shades[start] == Shade::Darker) {
            (false, false) => step.say(case::BRIGHTER).say(case::TOO_SHORT),
            (false, true) => step.say(case::DARKER).say(case::TOO_SHORT),
            (true, false) => step.say(case::ARE_BRIGHTER).say(case::CORNER),
            (true, true) => step.say(case::ARE_DARKER).say(case::CORNER),
        }
    }

    fn conclude(&self, seen: &Seen<Self>, step: Step) -> Step {
        let Some(after) = seen.after.filter(|_| seen.before.stage == Stage::Choice) else { return step };
        let (Some(first), Some(last)) = (after.kept.first(), after.kept.last()) else { return step };
        let found = after.map.cells().iter().filter(|score| **score > 0).count();
        let step = step.put(features::KEPT, after.kept.len()).put(features::LOCAL_MAXIMA, after.peaks.len());
        let step =
            step.put(value::HIGHEST_SCORE, after.response(*first)).put(value::LOWEST_SCORE, after.response(*last));
        let step = step.put(value::FOUND, found);
        let step = step.say(if after.kept.len() == 1 { case::END_WITH_ONE } else { case::END });
        step.say(self.selection.advice(after.kept.len(), after.peaks.len()))
    }

    /// Explains the pixel pointed at as far as its outcome is known.
    fn verdict(&self, seen: &Seen<Self>, probe: &Probe) -> Step {
        let Some(circle) = &probe.circle else {
            let step = self.put_pixel(seen, line::EACH_PIXEL, probe);
            let step = step.put_value(features::PIXEL.is(probe.place).inked(Role::Rejected)).say(case::OUTSIDE);
            return self.add_charts(seen, step, probe);
        };
        let status = self.status(seen, probe.place).filter(|_| circle.arc.is_some());
        let line = status.as_ref().map_or(self.line_of(circle), |status| status.line);
        let step = self.tell_tests(self.put_pixel(seen, line, probe), circle);
        let step = match &status {
            Some(status) => {
                let score = status.by.map_or(0, |by| seen.before.map[by]);
                status.say(step.put(value::OTHER_SCORE, score))
            }
            None => step,
        };
        self.add_charts(seen, step, probe)
    }

    /// Returns the outcome for a corner after the segment test.
    fn status(&self, seen: &Seen<Self>, place: (usize, usize)) -> Option<Status> {
        let state = seen.before;
        let is_compared = match state.stage {
            Stage::Response => false,
            Stage::Suppression => place.1 < state.row,
            Stage::Choice => true,
        };
        if !is_compared {
            return None;
        }
        let status = |line, words, case, by| Some(Status { line, words, case, by });
        if let Some(by) = suppressed_by(&state.map, place) {
            return status(line::SUPPRESS, "suppressed", case::HAS_NEIGHBOUR, Some(by));
        }
        let index = (place.1 * state.map.width() + place.0) as u32;
        let choice = seen.events.iter().find_map(|event| match event {
            Event::Peak(peak, near) if *peak == index => Some(*near),
            _ => None,
        });
        match choice {
            Some(None) => status(line::KEEP, "kept", selection::HAS_STATUS, None),
            Some(Some(near)) => status(line::DROP_NEAR, "rejected", selection::HAS_NEAR, Some(state.place(near))),
            None if seen.after.is_some() && state.stage == Stage::Choice => {
                status(line::KEEP, "not kept", case::IS_BEYOND, None)
            }
            None => status(line::SUPPRESS, "local maximum of the score", selection::HAS_STATUS, None),
        }
    }
}

/// The pixel of the arc that limits the score, and the size of its difference.
fn weakest(circle: &Circle, arc: usize) -> (usize, u16) {
    let start = circle.arc.unwrap_or_default();
    let sizes = (start..start + arc).map(|k| (k % 16, circle.differences[k % 16].unsigned_abs()));
    sizes.min_by_key(|(_, size)| *size).unwrap_or_default()
}
