//! The steps of the Kalman tracker in words, formulas and marks.

use super::association::{Costs, MatchingStage, Pair};
use super::charts::{lit, matrices_of, update_matrices, widest};
use super::formulas::update_formula;
use super::vocabulary::{case, value};
use super::{Event, KalmanTracker, PairCost, Track, line};
use crate::methods::{
    kalman::Measurement,
    multi_object::{
        explain::{self, Names},
        tracking::{self, MultiTracking, selected},
        vocabulary::{case as shared_case, value as shared},
    },
};
use crate::products::TrackStatus;
use crate::run::Seen;
use crate::scene::{Arrow, Name, Picture, Readout, Role, Scene, Shape, Step, Unit};

impl KalmanTracker {
    pub(super) fn explanation(&self, seen: &Seen<MultiTracking<Self>>) -> Step {
        let run = &seen.after.unwrap_or(seen.before).run;
        let step = self.tell_event(seen);
        let is_of_track = track_of(seen).is_some();
        let of_selected = selected(seen).filter(|_| seen.after.is_some() && !is_of_track);
        let of_selected = of_selected.map(|selected| matrices_of(selected.id, seen.events)).unwrap_or_default();
        let (step, tables) = match (seen.events.last(), seen.events.get(2)) {
            (Some(Event::Updated(both, _)), _) => (step, update_matrices(&both[0].filter, &both[1].filter)),
            (_, Some(Event::Costs(costs))) => {
                let rows = costs.tracks.iter().map(|track| track.id.to_string());
                let names = Names::new(rows, 0..costs.detections.len());
                (names.add_shown_part(step), self.tables(costs, &names, &lit(seen, costs)))
            }
            _ => (step, Vec::new()),
        };
        let tables = if of_selected.is_empty() { tables } else { of_selected };
        let step = step.show_all((!tables.is_empty()).then_some(Readout::Matrices(tables)));
        step.show_all(explain::series(run)).show_all(self.density(seen).and_then(|density| density.landscape()))
    }

    fn tell_event(&self, seen: &Seen<MultiTracking<Self>>) -> Step {
        let tracks = seen.after.unwrap_or(seen.before).tracks.len();
        let facts =
            |line: Name| Step::at(line).fact(shared::FRAME, seen.before.run.frame()).fact(shared::TRACKS, tracks);
        let at = |line: Name| tracking::add_errors_and_selected(facts(line), seen);
        let of = |line: Name, track: &Track| explain::add_track(facts(line), &track.shown(), self.rules);
        match seen.events.last() {
            None => at(line::EACH_FRAME).say(case::OPENING),
            Some(Event::Detected(all, discarded)) => {
                let discarded = (*discarded, self.settings.min_score);
                explain::tell_detections(at(line::DETECT), (all.len(), Unit::count("detection")), discarded)
            }
            Some(Event::Predicted(tracks)) => match widest(tracks) {
                None => at(line::PREDICT).say(shared_case::NONE_TO_PREDICT),
                Some(widest) => {
                    let deviation = |track: &Track| shared::DEVIATION.is(explain::deviation(&track.filter));
                    let most = deviation(widest);
                    let alike = tracks.iter().filter(|track| deviation(track).bare() == most.bare()).count();
                    let step = at(line::PREDICT).put(shared::TRACKS, tracks.len()).put(value::WIDEST, widest.id);
                    let step = step.put(value::AS_WIDE, alike).put_value(most);
                    step.say(if alike == 1 { case::PREDICTED } else { case::PREDICTED_ALIKE })
                }
            },
            Some(Event::Costs(costs)) => self.tell_gates(at(line::COMPUTE_COSTS), costs),
            Some(Event::Assigned(costs, row, pair)) => {
                self.tell_assignment(of(line::ASSIGN, &costs.tracks[*row]), costs, *row, pair)
            }
            Some(Event::Updated(both, measurement)) => {
                self.tell_update(of(line::UPDATE_TRACK, &both[1]), both, measurement)
            }
            Some(Event::Missed(track)) => {
                let step = of(line::COAST_OR_END, track).say(case::COASTS);
                explain::tell_misses(step, track.age.missed).say(case::GROWN)
            }
            Some(Event::Deleted(track)) => {
                explain::tell_deletion(of(line::COAST_OR_END, track), &track.shown(), self.rules)
            }
            Some(Event::Begun(track)) => {
                let deviation = track.filter.covariance()[(2, 2)].max(0.0).sqrt();
                let step = of(line::BEGIN_TRACK, track).put(value::SPEED_DEVIATION, deviation).say(case::BEGUN);
                explain::tell_tentative(step, track.age.status, self.rules)
            }
            Some(Event::Done(done, conclusion)) => tracking::tell_end(at(line::EACH_FRAME), seen, (done, conclusion)),
        }
    }

    fn tell_gates(&self, step: Step, costs: &Costs) -> Step {
        let (has_gate, has_threshold) = (self.cost != PairCost::Overlap, self.iou_threshold > 0.0);
        let step = explain::tell_gate(self.limits(step, costs).put(value::GREEDY, costs.greedy), shared_case::GATED);
        let step = step.say_if(has_gate, shared_case::GATE).say(match (self.cost, has_threshold) {
            (PairCost::Mahalanobis, _) => shared_case::END,
            (PairCost::Overlap, true) => case::THRESHOLD,
            (PairCost::Overlap, false) => case::OVERLAP,
            (PairCost::Both, true) => case::AND_THRESHOLD,
            (PairCost::Both, false) => case::AND_OVERLAP,
        });
        let step = explain::tell_crowding(step, costs.crowded).say_if(costs.greedy > 0, case::GREEDY);
        let conditions = match self.cost {
            PairCost::Mahalanobis => r"d^2 \le \text{gate } {gate}".to_owned(),
            PairCost::Overlap => format!(r"\text{{IoU}} {}", self.iou_limit()),
            PairCost::Both => format!(r"d^2 \le \text{{gate }} {{gate}}, \text{{IoU}} {}", self.iou_limit()),
        };
        let step = step.formula(format!("C = {}", self.cost_symbols()));
        step.formula(format!(r"C = \infty \text{{ unless }} {conditions}"))
    }

    fn limits(&self, step: Step, costs: &Costs) -> Step {
        let sizes = [costs.costs.rows(), costs.costs.columns()];
        let step = explain::put_gates(step, costs.costs.len(), sizes, (costs.limit, self.gate));
        step.put(value::IOU_THRESHOLD, self.iou_threshold)
    }

    /// Boxes that do not overlap are never a pair.
    fn iou_limit(&self) -> &'static str {
        if self.iou_threshold > 0.0 { r"\ge {iou_threshold}" } else { "> 0" }
    }

    fn cost_symbols(&self) -> &'static str {
        match self.cost {
            PairCost::Mahalanobis => "d^2",
            PairCost::Overlap => r"1 - \text{IoU}",
            PairCost::Both => {
                r"\frac{1}{2} \left( \frac{d^2}{\text{gate}} + \frac{1 - \text{IoU}}{1 - \text{IoU threshold}} \right)"
            }
        }
    }

    fn tell_assignment(&self, step: Step, costs: &Costs, row: usize, pair: &Pair) -> Step {
        let step = self.limits(step, costs).put(shared::DETECTION, pair.column + 1).put(value::COST, pair.cost);
        let step = step.put(value::SCORE_THRESHOLD, self.score_threshold).say(case::ASSIGNED);
        let at_least = if self.iou_threshold > 0.0 { case::AT_LEAST } else { case::ABOVE_ZERO };
        let limit = self.iou_limit();
        if pair.stage == MatchingStage::LastBox {
            let step = step.put(value::LAST_OVERLAP, 1.0 - pair.cost).say(case::BY_LAST_BOX).say(at_least);
            let step = step.formula(r"C = 1 - \text{IoU of the last box}").formula("C = 1 - {last_overlap} = {cost}");
            return step.formula(format!(r"\text{{with IoU}} = {{last_overlap}} {limit}"));
        }
        let distance = self.distance(costs, row, pair.column);
        let step = step.put(value::D_SQUARED, distance).put(value::OVERLAP, costs.overlap(row, pair.column));
        let step = match self.cost {
            PairCost::Mahalanobis => step.say(case::IN_GATE).say(shared_case::END),
            PairCost::Overlap => step.say(case::IOU).say(at_least),
            PairCost::Both => step.say(case::IN_GATE).say(case::AND_IOU).say(at_least),
        };
        let step = step.say_if(pair.stage == MatchingStage::LowScore, case::LOW_SCORE);
        let step = step.say_if(pair.stage == MatchingStage::Tentative, case::LEFT_BY_CONFIRMED);
        let symbols = format!("C = {}", self.cost_symbols());
        match self.cost {
            PairCost::Mahalanobis => self
                .distance_formula(step.formula(symbols), costs, [row, pair.column])
                .formula(r"\text{with } d^2 = {d_squared} \le \text{gate } {gate}"),
            PairCost::Overlap => {
                let step = step.formula(symbols).formula("= 1 - {overlap} = {cost}");
                step.formula(format!(r"\text{{with IoU}} = {{overlap}} {limit}"))
            }
            PairCost::Both => {
                step.formula(symbols).formula(
                    r"= \frac{1}{2} \left( \frac{{d_squared}}{{gate}} + \frac{1 - {overlap}}{1 - {iou_threshold}} \right) = {cost}",
                )
            }
        }
    }

    /// The update of the state and its standard deviation, with the gain along x.
    fn tell_update(&self, step: Step, [before, after]: &[Track; 2], measurement: &Measurement) -> Step {
        let step = explain::put_prediction(step, &before.filter);
        // Each of several modes has a gain of its own.
        let numbers = before.filter.update_numbers(measurement).filter(|_| before.filter.modes().is_none());
        let step = match numbers {
            None => step.say(case::BY_BOTH_MODES),
            Some(numbers) => {
                let along_x = [before.filter.place()[0], measurement.place[0], after.filter.place()[0]];
                let gain = value::GAIN.is(numbers.gain[(0, 0)]);
                let is_half = gain.rounded() == Some(0.5);
                // The question asks for the gain of the sentence, not for that of the formula with its further digits.
                let step = update_formula(step, &numbers, along_x).put_value(gain);
                step.say(if is_half { case::HALF_WAY } else { case::BY_GAIN })
            }
        };
        let step = step.say(case::UPDATED).say_if(after.size.hidden_frames > 0, case::HIDDEN);
        let travel = after.age.movement;
        let step = travel.into_iter().fold(step, |step, travel| {
            step.put(value::TRAVEL, travel.net_px()).put(value::MIN_TRAVEL, travel.least_px(self.rules.min_travel))
        });
        match (before.age.status, after.age.status) {
            (TrackStatus::Tentative, TrackStatus::Confirmed) => {
                step.say(case::CONFIRMED).say_if(travel.is_some(), case::TRAVELLED).say(shared_case::END)
            }
            (TrackStatus::Tentative, TrackStatus::Tentative) if after.age.hits >= self.rules.min_hits => {
                step.say_if(travel.is_some(), case::STILL_TENTATIVE)
            }
            (TrackStatus::Coasting, _) => step.put(shared::MISSED, before.age.missed).say(case::MATCHED_AGAIN),
            _ => step,
        }
    }

    pub(super) fn draw_step(&self, seen: &Seen<MultiTracking<Self>>, scene: &mut Scene) {
        let detected = match seen.events.first() {
            Some(Event::Detected(all, _)) => &all[..],
            _ => &[],
        };
        tracking::draw_detections(scene, seen, detected);
        draw_tracks(scene, seen);
        if let Some(track) = track_of(seen) {
            explain::work_at(scene, track.bounds());
        }
    }
}

/// Draws the tracks: within a frame updated, or else predicted, with the assigned pairs as arrows.
fn draw_tracks(scene: &mut Scene, seen: &Seen<MultiTracking<KalmanTracker>>) {
    let state = seen.after.unwrap_or(seen.before);
    let predicted = match seen.events.get(1) {
        Some(Event::Predicted(predicted)) if seen.after.is_none() => predicted,
        _ => return state.tracks.iter().for_each(|track| track.shown().draw_with_trail(scene, &state.run)),
    };
    let done = seen.events.iter().filter_map(|event| match event {
        Event::Updated(both, _) => Some((both[1].id, Some(both[1].shown()))),
        Event::Missed(track) | Event::Begun(track) => Some((track.id, Some(track.shown()))),
        Event::Deleted(track) => Some((track.id, None)),
        _ => None,
    });
    explain::draw_progress(scene, &state.run, predicted.iter().map(Track::shown), done);
    let chosen = seen.events.iter().filter_map(|event| match event {
        Event::Assigned(costs, row, pair) => {
            let from = costs.tracks[*row].filter.place().map(|c| c as f32);
            Some(Arrow { from, to: costs.detections[pair.column].center })
        }
        _ => None,
    });
    let arrows: Vec<Arrow> = chosen.collect();
    if !arrows.is_empty() {
        scene.mark(Picture::CURRENT, Role::Measured, Shape::Arrows(arrows));
    }
}

fn track_of<'a>(seen: &Seen<'a, MultiTracking<KalmanTracker>>) -> Option<&'a Track> {
    match seen.events.last()? {
        Event::Updated(both, _) => Some(&both[1]),
        Event::Missed(track) | Event::Deleted(track) | Event::Begun(track) => Some(track),
        Event::Assigned(costs, row, _) => costs.tracks.get(*row),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::words::rounded;
    use crate::data::Detection;
    use crate::geometry::Bounds;
    use crate::methods::multi_object::tracking::MultiTracker;
    use crate::methods::numbers::LENGTH_DECIMALS;
    use crate::scene::{Answer, Question, Shown, Value};

    fn found(x: f32) -> Detection {
        let bounds = Bounds { min: [x - 8.0, 20.0], max: [x + 8.0, 52.0] };
        Detection { bounds, center: [x, 36.0], score: 1.0, blob: None, deviation_px: None }
    }

    /// A track updated with a detection, and the step of the update.
    fn updated(tracker: &KalmanTracker, before: &Track, found: &Detection) -> (Track, Step) {
        let (after, measurement) = (tracker.updated(before, found, (320, 240)), tracker.dynamics.measurement(found));
        let step = explain::add_track(Step::at(line::UPDATE_TRACK), &after.shown(), tracker.rules);
        let step = tracker.tell_update(step, &[before.clone(), after.clone()], &measurement);
        (after, step)
    }

    #[test]
    fn an_update_half_of_the_way_is_not_asked_for() {
        let tracker = KalmanTracker::default();
        let question = |of: &&Question| of.id == "gain";
        let question = KalmanTracker::QUESTIONS.iter().find(question).expect("it is declared");
        let answer = |step: &Step| {
            let scene = Scene::default();
            question.answer(Shown { step, scene: &scene }, Shown { step, scene: &scene })
        };
        // A new track is as uncertain as a measurement, an updated one less so, and a predicted one more.
        let begun = tracker.begun(&found(100.0), 1);
        let (once, half) = updated(&tracker, &begun, &found(104.0));
        assert_eq!(half.value(value::GAIN).and_then(Value::rounded), Some(0.5));
        assert!(half.is(case::HALF_WAY) && !half.is(case::BY_GAIN), "{}", half.sentence.plain());
        assert_eq!(answer(&half), None);
        let (_, small) = updated(&tracker, &once, &found(104.0));
        assert!(small.is(case::BY_GAIN), "{}", small.sentence.plain());
        assert_eq!(answer(&small), Some(Answer::Choice(1)));
        let predicted = Track { filter: tracker.dynamics.predicted(&begun.filter, &begun.extent), ..begun };
        let (_, large) = updated(&tracker, &predicted, &found(104.0));
        assert!(large.is(case::BY_GAIN), "{}", large.sentence.plain());
        assert_eq!(answer(&large), Some(Answer::Choice(0)));
    }

    #[test]
    fn the_numbers_of_an_update_give_its_result() {
        let tracker = KalmanTracker::default();
        let begun = tracker.begun(&found(100.123), 1);
        let predicted = Track { filter: tracker.dynamics.predicted(&begun.filter, &begun.extent), ..begun };
        let (_, step) = updated(&tracker, &predicted, &found(107.457));
        let text = step.formulas()[1].plain();
        let numbers: Vec<f64> =
            text.split(|c: char| !c.is_ascii_digit() && c != '.').filter_map(|n| n.parse().ok()).collect();
        let [from, gain, to, again, result] = numbers[..] else { panic!("{text}") };
        assert_eq!(from, again, "{text}");
        assert_eq!(rounded(from + gain * (to - from), LENGTH_DECIMALS), result, "{text}");
    }
}
