//! The steps of joint probabilistic data association in words, numbers and marks.

use super::coalescence::Neighbors;
use super::events::{Joint, Validation};
use super::tables::{event_tables, update_tables, validation_table, weight_table};
use super::vocabulary::{case, value};
use super::{Event, JointProbabilistic, Track, Weights, line};
use crate::base::words::{further_digits, rounded};
use crate::geometry::Grid;
use crate::methods::{
    kalman::Measurement,
    multi_object::{
        density::TrackDensity,
        explain,
        tracking::{self, MultiTracking, selected},
        vocabulary::{case as shared_case, value as shared},
    },
    numbers::{LENGTH_DECIMALS, RATIO_DECIMALS, finer},
};
use crate::run::Seen;
use crate::scene::{Arrow, Name, Picture, Readout, Role, Scene, Shape, Step, Unit};

/// The most innovations in a formula.
const LISTED: usize = 4;

impl JointProbabilistic {
    pub(super) fn explanation(&self, seen: &Seen<MultiTracking<Self>>) -> Step {
        let tables = match seen.events.last() {
            Some(Event::Validated(validation)) => validation_table(validation).into_iter().collect(),
            Some(Event::Enumerated(validation, joint)) => event_tables(validation, joint),
            Some(Event::Weighed(validation, joint)) => weight_table(validation, joint).into_iter().collect(),
            Some(Event::Updated(both, weights)) => update_tables(&both[0], weights),
            _ => Vec::new(),
        };
        let step = self.tell_event(seen).show_all((!tables.is_empty()).then_some(Readout::Matrices(tables)));
        let step = step.show_all(explain::series(&seen.after.unwrap_or(seen.before).run));
        step.show_all(self.density(seen).and_then(|density| density.landscape()))
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
            Some(Event::Predicted(tracks)) => {
                let step = at(line::PREDICT).put(shared::TRACKS, tracks.len());
                step.say(if tracks.is_empty() { shared_case::NONE_TO_PREDICT } else { case::PREDICTED })
            }
            Some(Event::Validated(validation)) => {
                let sizes = [validation.tracks.len(), validation.detections.len()];
                let gate = (validation.limit, self.chances.gate);
                let step = explain::put_gates(at(line::VALIDATE), validation.distances.len(), sizes, gate);
                let step = explain::tell_gate(step, case::VALIDATED)
                    .put(shared::CLUSTERS, validation.clusters.len())
                    .say(case::CLUSTERED);
                explain::tell_crowding(step, validation.crowded)
            }
            Some(Event::Enumerated(validation, joint)) => {
                self.tell_joint_events(at(line::ENUMERATE), validation, joint)
            }
            Some(Event::Weighed(validation, joint)) => tell_weights(at(line::WEIGH), validation, joint),
            Some(Event::Updated(both, weights)) => tell_update(of(line::UPDATE_TRACK, &both[1]), both, weights),
            Some(Event::Missed(track, missed)) => {
                let step = of(line::COAST_OR_END, track).put(value::MISSED_WEIGHT, *missed).say(case::COASTS);
                explain::tell_misses(step, track.age.missed)
            }
            Some(Event::Deleted(track)) => {
                explain::tell_deletion(of(line::COAST_OR_END, track), &track.shown(), self.rules)
            }
            Some(Event::Begun(track, share)) => {
                let step = of(line::BEGIN_TRACK, track).put(value::SHARE, *share).say(case::BEGUN);
                explain::tell_tentative(step, track.age.status, self.rules)
            }
            Some(Event::Done(done, conclusion)) => {
                let after = seen.after.filter(|_| conclusion.run.is_some() && selected(seen).is_none());
                let neighbors = after.and_then(|after| Neighbors::of(&after.run, seen.clip));
                let step = neighbors.into_iter().fold(at(line::EACH_FRAME), Neighbors::tell);
                tracking::tell_end(step, seen, (done, conclusion))
            }
        }
    }

    fn tell_joint_events(&self, step: Step, validation: &Validation, joint: &Joint) -> Step {
        let step = step.put(shared::CLUSTER_TRACKS, joint.tracks.len());
        let step = step.put(shared::CLUSTER_DETECTIONS, joint.detections.len()).put(value::MAX_EVENTS, self.max_events);
        let step = step.fact(value::JOINT_EVENTS, joint.events.len()).say(case::ENUMERATED);
        let step = joint.events.first().into_iter().fold(step, |step, best| {
            let id =
                |track: &Option<usize>| Some((validation.tracks[joint.tracks[(*track)?]].id, shared_case::OF_TRACK));
            let origins: Vec<_> = joint.detections.iter().copied().zip(best.tracks.iter().map(id)).collect();
            let step = step.put(value::PROBABILITY, best.probability).say(case::MOST_PROBABLE);
            explain::tell_origins(step, &origins).say(shared_case::END)
        });
        match (joint.is_exhausted, joint.has_more) {
            (true, _) => step.say(case::EXHAUSTED),
            (false, has_more) => step.say_if(has_more, case::LEFT_OUT),
        }
    }

    /// The density of the track of the step, or else of the selected one; of a cluster without it, of its first track.
    fn density<'a>(&self, seen: &Seen<'a, MultiTracking<Self>>) -> Option<TrackDensity<'a>> {
        let selected = selected(seen).map(|selected| selected.id);
        let of = |tracks: &'a [Track]| tracks.iter().find(|track| Some(track.id) == selected);
        match seen.events.last() {
            Some(Event::Updated(both, weights)) => {
                let measured =
                    |&(place, _): &_| Measurement { place, place_deviation: weights.deviation, velocity: None };
                Some(TrackDensity {
                    updated: Some(&both[1].filter),
                    measured: weights.measured.iter().map(measured).collect(),
                    ..TrackDensity::predicted(&both[0].filter)
                })
            }
            Some(Event::Validated(validation)) => {
                let row = validation.tracks.iter().position(|track| Some(track.id) == selected)?;
                Some(self.validated_track(validation, row))
            }
            Some(Event::Enumerated(validation, joint) | Event::Weighed(validation, joint)) => {
                let mut rows = joint.tracks.iter();
                let found = rows.find(|row| Some(validation.tracks[**row].id) == selected);
                Some(self.validated_track(validation, *found.or(joint.tracks.first())?))
            }
            Some(Event::Predicted(tracks)) => of(tracks).map(|track| TrackDensity::predicted(&track.filter)),
            Some(Event::Missed(track, _) | Event::Deleted(track)) => Some(TrackDensity::predicted(&track.filter)),
            Some(Event::Begun(track, _)) => Some(TrackDensity::estimated(&track.filter)),
            None | Some(Event::Detected(..) | Event::Done(..)) => {
                of(&seen.after.unwrap_or(seen.before).tracks).map(|track| TrackDensity::estimated(&track.filter))
            }
        }
    }

    /// A predicted track with the detections in its gate.
    fn validated_track<'a>(&self, validation: &'a Validation, row: usize) -> TrackDensity<'a> {
        let track = &validation.tracks[row];
        let mut near: Vec<_> = validation.distances.row(row).collect();
        near.sort_by(|a, b| a.1.total_cmp(&b.1));
        let measured = |(column, _): (usize, f64)| self.measurement(track, &validation.detections[column]);
        TrackDensity {
            measured: near.into_iter().map(measured).collect(),
            limit: Some(validation.limit),
            ..TrackDensity::predicted(&track.filter)
        }
    }

    pub(super) fn draw_step(&self, seen: &Seen<MultiTracking<Self>>, scene: &mut Scene) {
        let detected = match seen.events.first() {
            Some(Event::Detected(all, _)) => &all[..],
            _ => &[],
        };
        tracking::draw_detections(scene, seen, detected);
        draw_tracks(scene, seen);
        match seen.events.last() {
            Some(Event::Enumerated(validation, joint) | Event::Weighed(validation, joint)) => {
                let tracks = joint.tracks.iter().map(|track| validation.tracks[*track].bounds());
                let detections = joint.detections.iter().map(|found| validation.detections[*found].bounds);
                explain::work_on(scene, tracks.chain(detections));
            }
            _ => track_of(seen).into_iter().for_each(|track| explain::work_at(scene, track.bounds())),
        }
    }
}

fn tell_weights(step: Step, validation: &Validation, joint: &Joint) -> Step {
    let all = (0..joint.tracks.len()).flat_map(|track| (0..joint.detections.len()).map(move |at| (track, at)));
    let largest =
        all.map(|(track, at)| (joint.weight(track, at), track, at)).reduce(|a, b| if b.0 > a.0 { b } else { a });
    let step = step.formula(r"\beta_{tj} = \sum_{\theta \ni (t, j)} P(\theta)");
    let step = step.formula(r"\beta_{t0} = 1 - \sum_j \beta_{tj}").say(case::WEIGHED);
    let Some((weight, track, at)) = largest else { return step };
    let step = step.put(value::WEIGHT, weight).put(shared::TRACK, validation.tracks[joint.tracks[track]].id);
    let step = step.put(shared::DETECTION, joint.detections[at] + 1);
    step.put(value::MISSED_WEIGHT, joint.missed(track)).say(case::LARGEST)
}

fn tell_update(step: Step, [before, _]: &[Track; 2], weights: &Weights) -> Step {
    let Some((likeliest, weight)) = weights.likeliest() else { return step };
    let step = explain::put_prediction(step, &before.filter).fact(value::MISSED_WEIGHT, weights.missed());
    let step = step.put(value::IN_GATE, weights.detections.len()).put(shared::DETECTION, likeliest + 1);
    let step = step.put(value::WEIGHT, weight).say(case::UPDATED);
    let step = step.say(if weights.detections.len() == 1 { case::PART_FOR_NONE } else { case::SPREAD });
    let step = match weights.own {
        Some((own, _)) => step.put(value::OWN_DETECTION, own + 1).say_if(own != likeliest, case::OTHER_COUNTS),
        None => step.say_if(weights.is_detected(), case::ALL_COUNT_ELSEWHERE),
    };
    let step = innovation(step, before, weights);
    let step = step.formula(
        r"\mathbf{P} \gets \beta_0 \, \mathbf{P} + (1 - \beta_0) (\mathbf{P} - \mathbf{K} \mathbf{S} \mathbf{K}^\top) + \mathbf{K} \mathbf{V} \mathbf{K}^\top",
    );
    let step = step
        .formula(r"\mathbf{V} = \sum_j \beta_j \, \mathbf{\nu}_j \mathbf{\nu}_j^\top - \mathbf{\nu} \mathbf{\nu}^\top");
    step.formula(r"\beta_0 = {missed_weight}")
}

/// Writes the combined innovation with the innovations of the first detections as columns.
fn innovation(step: Step, before: &Track, weights: &Weights) -> Step {
    let numbers = before.filter.association_numbers(weights.deviation, &weights.measured);
    let Some(numbers) = numbers else { return step };
    let (origin, listed) = (before.filter.place(), weights.measured.len().min(LISTED));
    let has_more = weights.measured.len() > LISTED;
    let innovations = Grid::from_fn(listed, 2, |j, y| weights.measured[j].0[y] - origin[y]);
    // The terms of a truncated sum do not give its result.
    let further = further_digits(|further| {
        let sum = |y: usize| -> f64 {
            let terms = weights.measured.iter().enumerate().take(listed).map(|(j, (_, weight))| {
                rounded(innovations[(j, y)], LENGTH_DECIMALS + further) * rounded(*weight, RATIO_DECIMALS + further)
            });
            terms.sum()
        };
        let shown = |number| rounded(number, LENGTH_DECIMALS);
        has_more || (0..2).all(|y| shown(sum(y)) == shown(numbers.innovation[y]))
    });
    let step = step.put_value(finer(value::INNOVATIONS, innovations, further));
    let factors = Grid::from_fn(1, listed, |_, j| weights.measured[j].1);
    let step = step.put_value(finer(value::WEIGHTS, factors, further));
    let step = step.put(value::INNOVATION, Grid::from_fn(1, 2, |_, y| numbers.innovation[y]));
    let more = if has_more { r" + \ldots" } else { "" };
    step.formula(format!(
        r"\mathbf{{\nu}} = \sum_j \beta_j \, \mathbf{{\nu}}_j = {{innovations}} {{weights}}{more} = {{innovation}}"
    ))
}

fn track_of<'a>(seen: &Seen<'a, MultiTracking<JointProbabilistic>>) -> Option<&'a Track> {
    match seen.events.last()? {
        Event::Updated(both, _) => Some(&both[1]),
        Event::Missed(track, _) | Event::Deleted(track) | Event::Begun(track, _) => Some(track),
        _ => None,
    }
}

/// Draws the tracks: within a frame updated, or else predicted.
fn draw_tracks(scene: &mut Scene, seen: &Seen<MultiTracking<JointProbabilistic>>) {
    let state = seen.after.unwrap_or(seen.before);
    let predicted = match seen.events.get(1) {
        Some(Event::Predicted(predicted)) if seen.after.is_none() => predicted,
        _ => return state.tracks.iter().for_each(|track| track.shown().draw_with_trail(scene, &state.run)),
    };
    let done = seen.events.iter().filter_map(|event| match event {
        Event::Updated(both, _) => Some((both[1].id, Some(both[1].shown()))),
        Event::Missed(track, _) | Event::Begun(track, _) => Some((track.id, Some(track.shown()))),
        Event::Deleted(track) => Some((track.id, None)),
        _ => None,
    });
    explain::draw_progress(scene, &state.run, predicted.iter().map(Track::shown), done);
    match seen.events.last() {
        Some(Event::Enumerated(validation, joint) | Event::Weighed(validation, joint)) => {
            draw_associations(scene, validation, joint);
        }
        Some(Event::Updated(both, weights)) => {
            let from = both[0].filter.place().map(|c| c as f32);
            let to = weights.measured.iter().map(|(at, _)| at.map(|c| c as f32));
            let arrows = to.map(|to| Arrow { from, to }).collect();
            scene.mark(Picture::CURRENT, Role::Measured, Shape::Arrows(arrows));
        }
        _ => {}
    }
}

/// Draws the possible associations of a cluster, and those of its most probable event.
fn draw_associations(scene: &mut Scene, validation: &Validation, joint: &Joint) {
    let arrow = |track: usize, at: usize| Arrow {
        from: validation.tracks[joint.tracks[track]].filter.place().map(|c| c as f32),
        to: validation.detections[joint.detections[at]].center,
    };
    let best: Vec<Arrow> = joint.events.first().map_or_else(Vec::new, |event| {
        event.tracks.iter().enumerate().filter_map(|(at, track)| Some(arrow((*track)?, at))).collect()
    });
    let pairs = (0..joint.tracks.len()).flat_map(|track| (0..joint.detections.len()).map(move |at| (track, at)));
    let is_possible =
        |&(track, at): &(usize, usize)| validation.distances.get(joint.tracks[track], joint.detections[at]).is_some();
    let possible = pairs.filter(is_possible).map(|(track, at)| arrow(track, at));
    let others: Vec<Arrow> = possible.filter(|arrow| !best.contains(arrow)).collect();
    explain::draw_arrows(
        scene,
        [(Role::Candidate, "possible association", others), (Role::Best, "most probable joint event", best)],
    );
}
