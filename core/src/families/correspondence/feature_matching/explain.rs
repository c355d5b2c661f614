//! The steps of feature matching in values, words and formulas.

use super::charts::{descriptors, distances};
use super::{Event, FeatureMatching, State, case, features, line, value};
use crate::methods::matching::{Event as Compared, Neighbors, Outcome};
use crate::products::{Match, MatchField, MatchStatus};
use crate::run::Seen;
use crate::scene::{Readout, Step};

impl FeatureMatching {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let state = seen.before;
        let [here, there] = state.fixed.pair.sides.each_ref().map(|side| side.points.len());
        let is_end = seen.after.is_some_and(|after| after.found.len() >= after.count());
        let step = match seen.events.last() {
            None => {
                let step = Step::at(line::DETECT).put(features::KEYPOINTS, here).put(value::KEYPOINTS_THERE, there);
                return step.say(case::OPENING);
            }
            Some(Event::Nothing) => Step::at(line::EACH_KEYPOINT).say(case::NO_KEYPOINTS),
            Some(Event::Of(event)) => self.tell_comparison(seen, *event, is_end),
        };
        if is_end { self.conclude(seen.after.unwrap_or(state), step) } else { step }
    }

    fn tell_comparison(&self, seen: &Seen<Self>, event: Compared, is_end: bool) -> Step {
        let (state, index) = (seen.before, seen.before.found.len());
        let [here, there] = state.fixed.pair.sides.each_ref();
        let line = match event {
            Compared::Nearer { .. } => line::EACH_CANDIDATE,
            Compared::Candidates(_) => line::EACH_KEYPOINT,
            Compared::Found(_) => line::KEEP_NEAREST,
            Compared::Ratio { .. } => line::RATIO_TEST,
            Compared::CrossCheck { .. } => line::CROSS_CHECK,
            Compared::Outcome(outcome) => match outcome.map(|outcome| outcome.status) {
                None => line::KEEP_NEAREST,
                Some(MatchStatus::RejectedRatio) => line::RATIO_TEST,
                Some(MatchStatus::RejectedCrossCheck) => line::CROSS_CHECK,
                Some(MatchStatus::Match | MatchStatus::Outlier) => line::ACCEPT,
            },
        };
        let neighbors = neighbors(seen);
        let step = Step::at(line).fact(features::KEYPOINT, index + 1).fact(features::KEYPOINTS, here.points.len());
        let step = self.put_neighbors(step.fact(features::POSITION, here.points[index].at), &neighbors, state);
        let is_near = self.settings.radius > 0;
        let step = match event {
            Compared::Nearer { index, distance } => {
                step.put(value::CANDIDATE, there.points[index].at).put(value::DISTANCE, distance).say(case::NEARER)
            }
            Compared::Candidates(count) => step.put(value::CANDIDATES, count).say(match (count, is_near) {
                (0, false) => case::NO_CANDIDATE,
                (0, true) => case::NO_CANDIDATE_NEAR,
                (_, false) => case::COMPARED,
                (_, true) => case::COMPARED_NEAR,
            }),
            Compared::Found(Neighbors { first, second }) => step.say(match (first, second) {
                (Some(_), Some(_)) => case::TWO,
                (Some(_), None) => case::ONE,
                _ => case::NONE,
            }),
            Compared::Ratio { ratio: None, .. } => {
                step.say(case::IS_UNDEFINED).say(case::IS_NOT_BELOW).say(case::EQUAL)
            }
            Compared::Ratio { passes: true, .. } => step.say(case::MEASURED).say(case::IS_BELOW),
            Compared::Ratio { .. } => step.say(case::MEASURED).say(case::IS_NOT_BELOW).say(case::ALIKE),
            Compared::CrossCheck { passes: true, .. } => step.say(case::MUTUAL),
            Compared::CrossCheck { back, .. } => step.put(value::BACK, here.points[back].at).say(case::NOT_MUTUAL),
            Compared::Outcome(None) => step.say(case::NO_OUTCOME),
            Compared::Outcome(Some(outcome)) => self.tell_outcome(step, state, &outcome),
        };
        if is_end {
            let after = seen.after.unwrap_or(state);
            return step.show_all([distances(after), self.precision(after)].into_iter().flatten().map(Readout::Series));
        }
        let other = neighbors.first.map(|(index, _)| &there.keypoints[index]);
        let step = match (neighbors.second, neighbors.ratio()) {
            (None, _) => step,
            (_, Some(_)) => step.formula(r"\frac{d_1}{d_2} = \frac{{d_1}}{{d_2}} = {ratio}"),
            (_, None) => step.formula(r"\frac{d_1}{d_2} = \frac{{d_1}}{{d_2}}\text{ is undefined}"),
        };
        let step = step.show(Readout::Tiles(self.tiles(state, index, &neighbors)));
        step.show_all(descriptors(&here.keypoints[index], other).map(Readout::Series))
    }

    /// Puts the known neighbours of a keypoint and the limits of the tests.
    fn put_neighbors(&self, step: Step, neighbors: &Neighbors, state: &State) -> Step {
        let at = |index: usize| state.fixed.pair.sides[1].points[index].at;
        let Neighbors { first, second } = neighbors;
        let step = step.fact_if(value::NEAREST, first.map(|(index, _)| at(index)));
        let step = step.fact_if(value::D_1, first.map(|(_, distance)| distance));
        let step = step.fact_if(value::SECOND, second.map(|(index, _)| at(index)));
        let step = step.fact_if(value::D_2, second.map(|(_, distance)| distance));
        let step = neighbors.ratio().into_iter().fold(step, |step, ratio| step.put(value::RATIO, ratio));
        let accepted = state.found.iter().flatten().filter(|outcome| outcome.status == MatchStatus::Match).count();
        let step = step.fact(value::MATCHES, accepted).put(value::LIMIT, self.settings.ratio);
        step.put(value::RADIUS, self.settings.radius)
    }

    fn tell_outcome(&self, step: Step, state: &State, outcome: &Outcome) -> Step {
        let found = state.match_of(state.found.len(), outcome);
        let step = step.put(value::DISPLACEMENT, found.displacement());
        let step = step.say(match found.status {
            MatchStatus::Match => case::MATCH,
            MatchStatus::RejectedRatio => case::FAILS_RATIO,
            _ => case::FAILS_CROSS_CHECK,
        });
        let is_right = state.fixed.truth.as_ref().and_then(|truth| MatchField::is_right(&found, truth));
        let step = step.say(match (is_right, found.status) {
            (Some(true), MatchStatus::Match) => case::IS_RIGHT,
            (Some(false), MatchStatus::Match) => case::IS_WRONG,
            (Some(true), _) => case::WAS_RIGHT,
            (Some(false), _) => case::WAS_WRONG,
            (None, _) => case::IS_UNKNOWN,
        });
        step.say_if(outcome.neighbors.second.is_none() && self.settings.ratio < 1.0, case::WAS_ALONE)
    }

    fn conclude(&self, state: &State, step: Step) -> Step {
        let (all, limit): (Vec<Match>, f32) = (state.matches().collect(), self.settings.ratio);
        if state.count() == 0 {
            return step.say(case::NO_MATCHES);
        }
        let accepted = || all.iter().filter(|found| found.status == MatchStatus::Match);
        let count = |status| all.iter().filter(|found| found.status == status).count();
        let rejected = count(MatchStatus::RejectedRatio);
        let step = step.put(value::MATCHES, accepted().count()).put(value::REJECTED_BY_RATIO, rejected);
        let step = step.put(value::REJECTED_BY_CROSS_CHECK, count(MatchStatus::RejectedCrossCheck)).say(case::END);
        let untested = accepted().filter(|found| found.ratio.is_none()).count();
        let step = step.put(value::UNTESTED, untested);
        let step = match untested {
            _ if limit >= 1.0 => step,
            0 => step,
            1 => step.say(case::ONE_UNTESTED),
            _ => step.say(case::SOME_UNTESTED),
        };
        let errors = state.fixed.truth.as_ref().map(|truth| MatchField::compare(accepted(), truth));
        let step = match errors.and_then(|errors| Some((errors.precision()?, errors))) {
            Some((precision, errors)) => {
                let step = step.put(value::RIGHT, errors.right).put(value::KNOWN, errors.known);
                let step = step.put(value::PRECISION, 100.0 * precision).say(case::QUALITY);
                step.say_if(state.fixed.is_of_plane && errors.right < errors.known, case::OFF_PLANE)
            }
            None => step,
        };
        match (accepted().count(), rejected) {
            (0, 0) => step.say_if(state.fixed.pair.sides[1].points.is_empty(), case::NOTHING_THERE),
            (0, _) => match all.iter().filter_map(|found| found.ratio).reduce(f32::min) {
                Some(least) => step.put(value::SMALLEST_RATIO, least).say(case::RAISE_LIMIT),
                None => step.say(case::ALL_UNDEFINED),
            },
            _ => step.say(if limit >= 1.0 { case::SET_LIMIT } else { case::LOWER_LIMIT }),
        }
    }
}

/// The neighbours of the keypoint found so far.
fn neighbors(seen: &Seen<FeatureMatching>) -> Neighbors {
    let found = seen.events.iter().rev().find_map(|event| match event {
        Event::Of(Compared::Found(neighbors)) => Some(*neighbors),
        _ => None,
    });
    let nearer = seen.events.iter().rev().find_map(|event| match event {
        Event::Of(Compared::Nearer { index, distance }) => Some((*index, *distance)),
        _ => None,
    });
    found.unwrap_or(Neighbors { first: nearer, second: None })
}
