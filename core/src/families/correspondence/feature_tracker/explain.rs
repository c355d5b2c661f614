//! The explanation and the drawing of feature tracking by matching.

use super::{Event, FeatureTracker, Linked, Pair, line};
use crate::base::words::{self, grouped};
use crate::methods::differential::numbers;
use crate::methods::features::trails::{self, points};
use crate::products::MatchStatus;
use crate::run::Seen;
use crate::scene::{Arrow, Fact, Link, Name, Picture, Readout, Role, Scene, Sentence, Step};

fn apart(distance: f32) -> String {
    words::fixed(distance.into(), 3)
}

impl FeatureTracker {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let Some(event) = seen.events.last() else {
            let said = format!(
                "Keypoints are detected in every frame and matched with those of the next one by their descriptors. Consecutive matches form a \
                 track, through at most {} frames. Unlike in KLT, the motion may be large, but a keypoint must be \
                 detected again.",
                self.frames
            );
            return Step { line: line::EACH_PAIR, sentence: Sentence::default().text(said), readouts: Vec::new() };
        };
        let (line, sentence) = match event {
            Event::Detected(pair) => (line::DETECT, self.detected(seen, pair)),
            Event::Linked(pair, linked) => Self::linked(seen, pair, linked),
            Event::Ended(pair) => (line::END_PAIR, Self::ended(seen, pair)),
        };
        Step { line, sentence, readouts: Self::readouts(seen, event) }
    }

    fn detected(&self, seen: &Seen<Self>, pair: &Pair) -> Sentence {
        let t = seen.before.frame;
        let counts = pair.sides.each_ref().map(|side| grouped(side.points.len()));
        let within = match self.matching.radius {
            0 => "in the whole frame".to_owned(),
            radius => format!("within {radius} px of its position"),
        };
        Sentence::default()
            .text(format!("{}: ", self.matching.detector.estimator().info().name))
            .ink(Role::Reference, format!("{} keypoints", counts[0]))
            .text(format!(" in frame {t} and "))
            .ink(Role::Candidate, counts[1].clone())
            .text(format!(" in frame {}. The candidates of a keypoint are those {within}.", t + 1))
    }

    /// The line and the sentence of a keypoint.
    fn linked(seen: &Seen<Self>, pair: &Pair, linked: &Linked) -> (Name, Sentence) {
        let at = words::place(pair.sides[0].points[linked.index].at);
        let said = Sentence::default().ink(Role::Reference, format!("Keypoint {at}"));
        let length = |number: u32| seen.before.tracks.get(number as usize).map_or(0, |track| track.points.len());
        match (linked.track, linked.to, linked.outcome) {
            (Some(number), Some(to), outcome) => {
                let place = words::place(pair.sides[1].points[to].at);
                let told = format!(
                    ", distance {}. Track {} continues: {} so far.",
                    outcome.map_or_else(String::new, |found| apart(found.distance)),
                    number + 1,
                    words::counted(length(number) + 1, "frame")
                );
                (line::CONTINUE, said.text(" matches ").ink(Role::Result, place).text(told))
            }
            (None, Some(to), outcome) => {
                let place = words::place(pair.sides[1].points[to].at);
                let told = format!(
                    ", distance {}. It is in no track, so a new one begins.",
                    outcome.map_or_else(String::new, |found| apart(found.distance))
                );
                (line::BEGIN, said.text(" matches ").ink(Role::Result, place).text(told))
            }
            (Some(number), None, outcome) => {
                let told = format!(
                    " {}. Track {} is lost after {}.",
                    reason(outcome.map(|found| found.status)),
                    number + 1,
                    words::counted(length(number), "frame")
                );
                (line::LOSE, said.ink(Role::Rejected, " has no match").text(told))
            }
            (None, None, outcome) => {
                let told =
                    format!(" {}. It is in no track and begins none.", reason(outcome.map(|found| found.status)));
                (line::REMAIN, said.ink(Role::Rejected, " has no match").text(told))
            }
        }
    }

    /// The conclusion of the pair, and of the run at its end.
    fn ended(seen: &Seen<Self>, pair: &Pair) -> Sentence {
        let state = seen.after.unwrap_or(seen.before);
        let t = seen.before.frame;
        let [continued, lost, begun] = turnover(seen.events);
        let said = Sentence::default().text(format!(
            "End of the pair of frames {t} and {}: {} of {} continued, {} lost without an accepted match, {} begun.{}",
            t + 1,
            grouped(continued),
            words::counted(continued + lost, "track"),
            grouped(lost),
            grouped(begun),
            mean_error(seen.events, pair).map_or_else(String::new, |error| format!(
                " Mean endpoint error of this pair: {} px.",
                numbers::px(error)
            ))
        ));
        let is_over = state.span.is_over(seen.clip, state.frame + 1);
        if !is_over || state.tracks.is_empty() {
            return said;
        }
        let lengths: usize = state.tracks.iter().map(|track| track.points.len()).sum();
        let mean = lengths as f64 / state.tracks.len() as f64;
        said.text(format!(
            " End of the run: {} of {} frames on average. A track ends where its keypoint is not detected again or its match is rejected: a \
             lower threshold of the detector or a higher ratio limit makes tracks longer.",
            words::counted(state.tracks.len(), "track"),
            words::fixed(mean, 1)
        ))
    }

    fn readouts(seen: &Seen<Self>, event: &Event) -> Vec<Readout> {
        let state = seen.before;
        let mut facts = vec![Fact::new("Pair", format!("frames {} and {}", state.frame, state.frame + 1), None)];
        let [continued, lost, begun] = turnover(seen.events).map(grouped);
        if let Event::Linked(pair, linked) = event {
            let of = pair.sides[0].points.len();
            facts.push(Fact::new(
                "Keypoint",
                format!("{} of {}", linked.index + 1, grouped(of)),
                Some(Role::Reference),
            ));
            facts.extend(linked.outcome.map(|found| Fact::new("Distance", apart(found.distance), None)));
            let neighbors = linked.outcome.map(|found| found.neighbors).filter(|found| found.second.is_some());
            let ratio = |ratio: Option<f32>| ratio.map_or_else(|| "undefined: 0 / 0".into(), words::fine);
            facts.extend(neighbors.map(|found| Fact::new("Ratio", ratio(found.ratio()), None)));
            let to = linked.to.map(|to| pair.sides[1].points[to].at);
            let from = pair.sides[0].points[linked.index].at;
            let moved = to.map(|to| [to[0] - from[0], to[1] - from[1]]);
            let px = |uv| format!("{} px", numbers::vector(uv));
            facts.extend(moved.map(|moved| Fact::new("Displacement", px(moved), Some(Role::Result))));
            let truth = pair.truth.as_ref().and_then(|truth| truth.sample(from));
            facts.extend(truth.map(|truth| Fact::new("True displacement", px(truth), Some(Role::Truth))));
        }
        facts.extend([
            Fact::new("Tracks continued", continued, Some(Role::Result)),
            Fact::new("Tracks begun", begun, Some(Role::Best)),
            Fact::new("Tracks lost", lost, Some(Role::Rejected)),
        ]);
        let now = seen.after.unwrap_or(state);
        let plot = trails::turnover("Tracks", &now.counts, &now.tracks, &now.span);
        [Readout::Facts(facts)].into_iter().chain(plot).collect()
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

/// Why a keypoint has no match.
fn reason(status: Option<MatchStatus>) -> &'static str {
    match status {
        None => "(no candidate)",
        Some(MatchStatus::RejectedRatio) => "(ratio test)",
        Some(MatchStatus::RejectedCrossCheck) => "(cross-check)",
        Some(MatchStatus::Match | MatchStatus::Outlier) => "(another keypoint is nearer to its neighbour)",
    }
}
