//! The explanation and the drawing of feature tracking by matching.

use super::{Event, FeatureTracker, Linked, Pair, case, features, line, value};
use crate::methods::features::trails::{self, points};
use crate::products::MatchStatus;
use crate::run::Seen;
use crate::scene::{Arrow, Link, Name, Number, Picture, Role, Scene, Step};

impl FeatureTracker {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let step = match seen.events.last() {
            None => return Step::at(line::EACH_PAIR).put(value::FRAMES, self.frames).say(case::OPENING),
            Some(Event::Detected(pair)) => self.tell_detection(seen, pair),
            Some(Event::Linked(pair, linked)) => Self::tell_link(seen, pair, linked),
            Some(Event::Ended(pair)) => Self::tell_end(seen, pair),
        };
        let now = seen.after.unwrap_or(seen.before);
        step.show_all(trails::turnover("Tracks", &now.counts, &now.tracks, &now.span))
    }

    /// Puts the tracks that a pair continues, begins and loses.
    fn put_counts(seen: &Seen<Self>, step: Step) -> Step {
        let [continued, lost, begun] = turnover(seen.events);
        step.fact(value::CONTINUED, continued).fact(value::BEGUN, begun).fact(value::LOST, lost)
    }

    /// Puts the frames of a pair.
    fn at(seen: &Seen<Self>, line: Name) -> Step {
        let t = seen.before.frame;
        Step::at(line).fact(value::FRAME, t).fact(value::NEXT_FRAME, t + 1)
    }

    fn tell_detection(&self, seen: &Seen<Self>, pair: &Pair) -> Step {
        let [here, there] = pair.sides.each_ref().map(|side| side.points.len());
        let step = Self::put_counts(seen, Self::at(seen, line::DETECT));
        let step = step.put(value::DETECTOR, self.matching.detector.estimator().info().name);
        let step = step.put(value::KEYPOINTS, here).put(value::KEYPOINTS_THERE, there);
        let step = step.put(value::RADIUS, self.matching.radius);
        step.say(if self.matching.radius == 0 { case::DETECTED } else { case::DETECTED_NEAR })
    }

    fn tell_link(seen: &Seen<Self>, pair: &Pair, linked: &Linked) -> Step {
        let (line, case) = match (linked.track, linked.to) {
            (Some(_), Some(_)) => (line::CONTINUE, case::CONTINUES),
            (None, Some(_)) => (line::BEGIN, case::BEGINS),
            (Some(_), None) => (line::LOSE, case::IS_LOST),
            (None, None) => (line::REMAIN, case::REMAINS),
        };
        let (outcome, from) = (linked.outcome, pair.sides[0].points[linked.index].at);
        let to = linked.to.map(|to| pair.sides[1].points[to].at);
        let keypoint = features::KEYPOINT.is(linked.index + 1).inked(Role::Reference);
        let step = Self::at(seen, line).fact_of(keypoint).fact(value::KEYPOINTS, pair.sides[0].points.len());
        let step = step.fact_if(value::DISTANCE, outcome.map(|found| found.distance));
        let neighbors = outcome.map(|found| found.neighbors).filter(|found| found.second.is_some());
        let ratio = |ratio: Option<f32>| ratio.map_or(Number::from("undefined: 0 / 0"), Number::from);
        let step = step.fact_if(value::RATIO, neighbors.map(|found| ratio(found.ratio())));
        let step = step.fact_if(value::DISPLACEMENT, to.map(|to| [to[0] - from[0], to[1] - from[1]]));
        let truth = pair.truth.as_ref().and_then(|truth| truth.sample(from));
        let step = Self::put_counts(seen, step.fact_if(value::TRUE_DISPLACEMENT, truth));
        let step = step.put(features::POSITION, from);
        let step = match to {
            Some(to) => step.put(value::MATCH, to).say(case::MATCHED),
            None => step.say(case::UNMATCHED).say(match outcome.map(|found| found.status) {
                None => case::NO_CANDIDATE,
                Some(MatchStatus::RejectedRatio) => case::FAILS_RATIO,
                Some(MatchStatus::RejectedCrossCheck) => case::FAILS_CROSS_CHECK,
                Some(MatchStatus::Match | MatchStatus::Outlier) => case::IS_FARTHER,
            }),
        };
        let step = linked.track.into_iter().fold(step, |step, number| {
            let length = seen.before.tracks.get(number as usize).map_or(0, |track| track.points.len());
            step.put(value::TRACK, number + 1).put(value::LENGTH, length + usize::from(to.is_some()))
        });
        step.say(case)
    }

    /// Explains the end of a pair, and of the run at its end.
    fn tell_end(seen: &Seen<Self>, pair: &Pair) -> Step {
        let state = seen.after.unwrap_or(seen.before);
        let step = Self::put_counts(seen, Self::at(seen, line::END_PAIR));
        let [continued, lost, _] = turnover(seen.events);
        let step = step.put(value::TRACKS, continued + lost).say(case::PAIR_ENDED);
        let step = match mean_error(seen.events, pair) {
            Some(error) => step.put(value::MEAN_ERROR, error).say(case::ERROR),
            None => step,
        };
        let count = state.tracks.len();
        if !state.span.is_over(seen.clip, state.frame + 1) || count == 0 {
            return step;
        }
        let lengths: usize = state.tracks.iter().map(|track| track.points.len()).sum();
        step.put(value::TRACKS, count).put(value::MEAN_LENGTH, lengths as f64 / count as f64).say(case::END)
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let t = seen.before.frame;
        for track in seen.before.tracks.iter().filter(|track| track.at(t).is_some()) {
            trails::trail(scene, (Role::Estimate, "trail"), track, t);
        }
        let Some(Event::Detected(pair) | Event::Linked(pair, _) | Event::Ended(pair)) = seen.events.last() else {
            return;
        };
        points(scene, Role::Reference, "keypoint", pair.sides[0].points.iter().map(|point| point.at).collect());
        let (mut arrows, mut lost, mut begun) = (Vec::new(), Vec::new(), Vec::new());
        for event in seen.events {
            let Event::Linked(pair, linked) = event else { continue };
            let from = pair.sides[0].points[linked.index].at;
            match (linked.track, linked.to) {
                (track, Some(to)) => {
                    arrows.push(Arrow { from, to: pair.sides[1].points[to].at });
                    begun.extend(track.is_none().then_some(from));
                }
                (Some(_), None) => lost.push(from),
                (None, None) => {}
            }
        }
        trails::displacements(scene, arrows);
        points(scene, Role::Best, "new track", begun);
        points(scene, Role::Rejected, "lost track", lost);
        if let Some(Event::Linked(pair, linked)) = seen.events.last() {
            let from = pair.sides[0].points[linked.index].at;
            if let Some(to) = linked.to.map(|to| pair.sides[1].points[to].at) {
                scene.links.push(Link { role: Role::Result, ends: [(Picture::CURRENT, from), (Picture::NEXT, to)] });
                scene.legend(Role::Result, "displacement to frame t+1");
            } else if linked.track.is_none() {
                points(scene, Role::Candidate, "keypoint without a match", vec![from]);
            }
        }
    }
}

/// The keypoints of a pair that were compared so far.
fn all_linked(events: &[Event]) -> impl Iterator<Item = &Linked> {
    events.iter().filter_map(|event| if let Event::Linked(_, linked) = event { Some(linked) } else { None })
}

/// Numbers of the tracks that a pair continues, loses and begins.
fn turnover(events: &[Event]) -> [usize; 3] {
    let count = |is: fn(&Linked) -> bool| all_linked(events).filter(|linked| is(linked)).count();
    [
        count(|of| of.track.is_some() && of.to.is_some()),
        count(|of| of.track.is_some() && of.to.is_none()),
        count(|of| of.track.is_none() && of.to.is_some()),
    ]
}

/// The mean endpoint error of the matches of a pair in px, where the true flow is known.
fn mean_error(events: &[Event], pair: &Pair) -> Option<f32> {
    let truth = pair.truth.as_ref()?;
    let error = |linked: &Linked| {
        let (from, to) = (pair.sides[0].points[linked.index].at, pair.sides[1].points[linked.to?].at);
        let [u, v] = truth.sample(from)?;
        Some((to[0] - from[0] - u).hypot(to[1] - from[1] - v))
    };
    let errors: Vec<f32> = all_linked(events).filter_map(error).collect();
    (!errors.is_empty()).then(|| errors.iter().sum::<f32>() / errors.len() as f32)
}
