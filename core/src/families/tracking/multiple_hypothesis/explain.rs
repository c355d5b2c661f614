//! The steps of multiple hypothesis tracking in words, formulas and marks.

use std::sync::Arc;

use super::charts::{ROWS, branch_tables, density, distances};
use super::expand::{Expansion, Gates};
use super::forest::{Claim, Origin, Scan, Track};
use super::vocabulary::{case, value};
use super::{Cluster, Event, Leading, MultipleHypothesis, Pruning, Revision, State, line};
use crate::methods::multi_object::{
    explain::{self, ShownTrack},
    tracking::{self, MultiTracking},
    vocabulary::{case as shared_case, value as shared},
};
use crate::run::Seen;
use crate::scene::{Arrow, Case, Name, Readout, Role, Scene, Step, Unit};

impl MultipleHypothesis {
    pub(super) fn explanation(&self, seen: &Seen<MultiTracking<Self>>) -> Step {
        let tables = match seen.events.last() {
            Some(Event::Gated(gates)) => distances(gates).into_iter().collect(),
            Some(Event::Expanded(_, expansion)) => branch_tables(expansion),
            _ => Vec::new(),
        };
        let step = self.tell_event(seen).show_all(self.tree(seen).map(Readout::Diagram));
        let step = step.show_all((!tables.is_empty()).then_some(Readout::Matrices(tables)));
        let step = step.show_all(explain::series(&seen.after.unwrap_or(seen.before).run));
        step.show_all(density(seen).and_then(|density| density.landscape()))
    }

    fn tell_event(&self, seen: &Seen<MultiTracking<Self>>) -> Step {
        let frame = seen.before.run.frame();
        let at = |line: Name| {
            let of = |clusters: &[Cluster]| clusters.iter().map(|cluster| cluster.hypotheses.len()).sum::<usize>();
            let (state, clusters, hypotheses) = match seen.after {
                Some(after) => (after, shared::CLUSTERS, value::HYPOTHESES),
                None => (seen.before, value::CLUSTERS_BEFORE, value::HYPOTHESES_BEFORE),
            };
            let step = Step::at(line).fact(shared::FRAME, frame).fact(clusters, state.tracks.len());
            tracking::add_errors_and_selected(step.fact(hypotheses, of(&state.tracks)), seen)
        };
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
            Some(Event::Gated(gates)) => {
                let ([all, merged], sizes) = (gates.clusters, [gates.tracks.len(), gates.detections.len()]);
                let gate = (gates.limit, self.chances.gate);
                let step = explain::put_gates(at(line::GATE), gates.distances.len(), sizes, gate);
                let step = explain::tell_gate(step, shared_case::GATED);
                let step = step.say(shared_case::GATE).say(shared_case::END).put(shared::CLUSTERS, all);
                explain::tell_crowding(step.put(value::MERGED, merged).say(case::CLUSTERED), gates.crowded)
            }
            Some(Event::Expanded(gates, expansion)) => self.tell_expansion(at(line::EXPAND), gates, expansion),
            Some(Event::Pruned(pruning)) => {
                let Pruning { frame, clusters, removed, probability, .. } = **pruning;
                let step = at(line::PRUNE).put(value::DECIDED_FRAME, frame).put(value::LATER_FRAMES, self.n_scan);
                let step = step.put(value::DELETED, removed).put(value::PRUNED_CLUSTERS, clusters);
                let step = step.put(value::DELETED_PROBABILITY, probability);
                step.say(if removed == 0 { case::ALIKE } else { case::PRUNED })
            }
            Some(Event::Led(leading)) => self.tell_leading(at(line::LEAD), leading),
            Some(Event::Revised(revisions)) => tell_revisions(at(line::REVISE), revisions),
            Some(Event::Done(done, conclusion)) => tracking::tell_end(at(line::EACH_FRAME), seen, (done, conclusion)),
        }
    }

    fn tell_expansion(&self, step: Step, gates: &Gates, expansion: &Expansion) -> Step {
        let mut ids: Vec<u32> = expansion.tracks.iter().map(|track| track.id).collect();
        ids.dedup();
        let step = step.fact(value::PARENTS, expansion.parents.len()).fact(value::BRANCHES, expansion.branches.len());
        let step =
            step.put(shared::CLUSTER_TRACKS, ids.len()).put(shared::CLUSTER_DETECTIONS, expansion.detections.len());
        let step = step.put(value::MIN_RATIO, self.min_ratio).put(value::MAX_HYPOTHESES, self.max_hypotheses);
        let step = match (&ids[..], expansion.detections.len()) {
            ([], _) => step.say(case::IN_NO_GATE),
            ([id], 0) => step.put(shared::TRACK, *id).say(case::NONE_IN_GATES),
            ([id], _) => step.put(shared::TRACK, *id).say(case::IN_GATES),
            _ => step.say(case::COMPETE),
        };
        let Some((best, others)) = expansion.branches.split_first() else { return step };
        let step = claims(step.put(value::PROBABILITY, best.probability).say(case::MOST_PROBABLE), &best.scan.claims);
        let (is_cut, has_ratio) = (expansion.has_more || expansion.is_exhausted, self.min_ratio > 0.0);
        let step = match others.split_first() {
            Some((next, more)) => {
                let step = step.put(value::NEXT_PROBABILITY, next.probability).say(case::NEXT);
                let step = claims(step, &next.scan.claims).put(value::MORE, more.len());
                step.say_if(!more.is_empty(), if has_ratio { case::MORE_ABOVE } else { case::MORE })
            }
            None => step.say_if(!is_cut, if has_ratio { case::NO_OTHER_ABOVE } else { case::NO_OTHER }),
        };
        let step = step.say_if(expansion.is_exhausted, case::EXHAUSTED);
        let step = step.say_if(expansion.has_more && !expansion.is_exhausted, case::LEFT_OUT);
        self.formulas(step, gates, expansion)
    }

    fn tell_leading(&self, step: Step, leading: &Leading) -> Step {
        let Leading { probability, clusters, hypotheses, scans, second, .. } = leading;
        let explained: Vec<Claim> = scans.iter().flat_map(|scan| scan.claims.iter().copied()).collect();
        let step = step.put(value::HYPOTHESES, *hypotheses).put(shared::CLUSTERS, *clusters);
        let step = claims(step.fact(value::LEADING_PROBABILITY, *probability).say(case::LED), &explained);
        let Some(second) = second else { return step.say(case::NO_SECOND) };
        let step = step.fact(value::SECOND_PROBABILITY, second.probability).say(case::SECOND);
        let [one, other] = second.scans.each_ref().map(|scan| &scan.claims);
        let Some((leading, second_claim)) = one.iter().zip(other).find(|(a, b)| a != b) else {
            return step.say(case::EXPLAINS_OTHERS);
        };
        let step = step.put(value::SECOND_FRAME, second.frame).put(value::DECIDING_FRAME, second.frame + self.n_scan);
        let step = step.put(shared::DETECTION, second_claim.detection + 1).say(case::SAYS);
        let step = origin(step.say(shared_case::DETECTION_IS), of_claim(second_claim));
        origin(step.say(case::LEADING_SAYS), of_claim(leading)).say(case::DECIDES)
    }

    /// The probability of the leading branch: its formula, the logarithm of its weight with the numbers of the step, and of the normalised one.
    fn formulas(&self, step: Step, gates: &Gates, expansion: &Expansion) -> Step {
        let Some(best) = expansion.branches.first() else { return step };
        let (terms, [false_density, new_density]) = (expansion.terms, self.densities(gates.size()));
        let [found, missed, wrong, new] = terms.counts;
        let [ln_detected, ln_missed] = [self.chances.detected(), self.chances.missed()].map(f64::ln);
        let [ln_false, ln_new] = [false_density, new_density].map(f64::ln);
        let of_counts = [(found, ln_detected), (missed, ln_missed), (wrong, ln_false), (new, ln_new)];
        let of_counts: f64 = of_counts.iter().map(|(count, ln)| *count as f64 * ln).sum();
        let ln_weight = terms.ln_parent + of_counts + terms.ln_innovations + terms.ln_sizes;
        let ln_probability = best.probability.ln();
        let step = step.put(value::DETECTED_TRACKS, found).put(value::MISSED_TRACKS, missed);
        let step = step.put(shared::CLUTTER, wrong).put(value::NEW_TRACKS, new).put(value::LN_DETECTED, ln_detected);
        let step = step.put(value::LN_MISSED, ln_missed).put(value::LN_FALSE, ln_false).put(value::LN_NEW, ln_new);
        let step = step.put(value::LN_PARENT, terms.ln_parent).put(value::LN_INNOVATIONS, terms.ln_innovations);
        let step = step.put(value::LN_SIZES, terms.ln_sizes).put(value::LN_WEIGHT, ln_weight);
        let step = step.put(value::LN_SUM, ln_weight - ln_probability).put(value::LN_PROBABILITY, ln_probability);
        step.formula(
            r"P = c^{-1} \cdot P_{\text{parent}} \cdot P_D^{\text{DT}} \cdot (1 - P_D P_G)^{\text{missed}} \cdot \beta_{\text{FT}}^{\text{FT}} \cdot \beta_{\text{NT}}^{\text{NT}} \cdot \prod N(\nu; 0, S) \, L_{\text{size}}",
        )
        .formula(r"\text{with DT} = {detected_tracks}, \text{missed} = {missed_tracks}, \text{FT} = {clutter}, \text{NT} = {new_tracks}")
        .formula(r"c \text{: sum over the branches}")
        .formula(
            r"\ln (c P) = {ln_parent} + {detected_tracks} \cdot {ln_detected} + {missed_tracks} \cdot {ln_missed} + {clutter} \cdot {ln_false} + {new_tracks} \cdot {ln_new} + {ln_innovations} + {ln_sizes} = {ln_weight}",
        )
        .formula(r"\ln P = \ln (c P) - \ln c = {ln_weight} - {ln_sum} = {ln_probability}, P = {probability}")
    }

    pub(super) fn draw_step(&self, seen: &Seen<MultiTracking<Self>>, scene: &mut Scene) {
        let detected = match seen.events.first() {
            Some(Event::Detected(all, _)) => &all[..],
            _ => &[],
        };
        tracking::draw_detections(scene, seen, detected);
        if let Some(after) = seen.after {
            return draw_leading(scene, after);
        }
        match seen.events.last() {
            None | Some(Event::Detected(..)) => draw_leading(scene, seen.before),
            Some(Event::Predicted(tracks)) => tracks.iter().for_each(|track| draw_prediction(scene, track)),
            Some(Event::Gated(gates)) => gates.tracks.iter().for_each(|track| draw_prediction(scene, track)),
            Some(Event::Expanded(gates, expansion)) => draw_branches(scene, gates, expansion),
            Some(Event::Led(leading)) => draw_second(scene, leading, seen.before.run.frame()),
            Some(Event::Revised(revisions)) => draw_revisions(scene, seen, revisions),
            Some(Event::Pruned(_) | Event::Done(..)) => {
                let led = seen.events.iter().find_map(|event| match event {
                    Event::Led(leading) => Some(leading),
                    _ => None,
                });
                let scans = led.into_iter().flat_map(|leading| &leading.scans);
                scans.flat_map(|scan| &scan.tracks).for_each(|track| draw_track(scene, track));
            }
        }
    }
}

/// The identity of a track with the case of its kind; none of a false alarm.
fn of_claim(claim: &Claim) -> Option<(u32, &'static Case)> {
    match claim.origin {
        Origin::Track(id) => Some((id, shared_case::OF_TRACK)),
        Origin::New(id) => Some((id, shared_case::OF_NEW_TRACK)),
        Origin::False => None,
    }
}

fn origin(step: Step, of: Option<(u32, &'static Case)>) -> Step {
    match of {
        Some((id, kind)) => step.put(shared::ORIGIN, id).say(kind),
        None => step.say(shared_case::OF_NO_TRACK),
    }
}

/// Says how a hypothesis explains the detections of a frame.
fn claims(step: Step, all: &[Claim]) -> Step {
    let origins: Vec<_> = all.iter().map(|claim| (claim.detection, of_claim(claim))).collect();
    explain::tell_origins(step.say_if(all.is_empty(), case::NONE_TO_EXPLAIN), &origins).say(shared_case::END)
}

fn tell_revisions(step: Step, revisions: &[Revision]) -> Step {
    let Some(first) = revisions.first() else { return step };
    let of = |id: Option<u32>| id.map(|id| (id, shared_case::OF_TRACK));
    let step = step.fact(value::REVISED, revisions.len()).put(value::REVISED_FRAME, first.frame);
    let step = step.put(shared::DETECTION, first.detection + 1).say(case::REVISED).say(case::DETECTION_WAS);
    let step = origin(origin(step, of(first.before)).say(case::AND_IS), of(first.now)).say(case::REWRITTEN);
    step.say_if(revisions.len() > 1, case::MORE_REVISED)
}

impl Track {
    fn shown(&self) -> ShownTrack<'_> {
        ShownTrack { id: self.id, filter: &self.filter, bounds: self.bounds(), age: self.age }
    }
}

/// Draws a prediction with its 95 % ellipse.
fn draw_prediction(scene: &mut Scene, track: &Track) {
    track.shown().draw(scene, (Role::Predicted, "prediction"));
}

fn draw_track(scene: &mut Scene, track: &Track) {
    track.shown().draw(scene, explain::role(track.age.status));
}

/// Draws the tracks of the leading hypotheses with their trajectories.
fn draw_leading(scene: &mut Scene, state: &State) {
    for cluster in &state.tracks {
        for track in cluster.hypotheses.first().iter().flat_map(|leader| &leader.tracks) {
            cluster.tracks[*track].shown().draw_with_trail(scene, &state.run);
        }
    }
}

/// The arrows of a branch, from the predictions to the detections.
fn arrows(gates: &Gates, expansion: &Expansion, scan: &Scan) -> Vec<Arrow> {
    let of = |claim: &Claim| {
        let Origin::Track(id) = claim.origin else { return None };
        let track = expansion.tracks.iter().find(|track| track.id == id)?;
        Some(Arrow { from: track.filter.place().map(|c| c as f32), to: gates.detections[claim.detection].center })
    };
    scan.claims.iter().filter_map(of).collect()
}

fn draw_branches(scene: &mut Scene, gates: &Gates, expansion: &Expansion) {
    expansion.tracks.iter().for_each(|track| draw_prediction(scene, track));
    let mut all = expansion.branches.iter().map(|branch| arrows(gates, expansion, &branch.scan));
    let best = all.next().unwrap_or_default();
    let others: Vec<Arrow> = all.take(ROWS).flatten().filter(|arrow| !best.contains(arrow)).collect();
    explain::draw_arrows(
        scene,
        [(Role::Candidate, "other branches", others), (Role::Best, "most probable branch", best)],
    );
    for detection in &expansion.detections {
        explain::rect(scene, Role::Window, gates.detections[*detection].bounds);
        scene.legend(Role::Window, "detection of the cluster");
    }
    let detections = expansion.detections.iter().map(|detection| gates.detections[*detection].bounds);
    explain::work_on(scene, expansion.tracks.iter().map(|track| track.bounds()).chain(detections));
}

/// Draws the leading hypothesis, and the boxes of the second where it explains this frame differently.
fn draw_second(scene: &mut Scene, leading: &Leading, frame: usize) {
    let tracks = leading.scans.iter().flat_map(|scan| &scan.tracks);
    tracks.clone().for_each(|track| draw_track(scene, track));
    let Some(second) = leading.second.as_ref().filter(|second| second.frame == frame) else { return };
    for track in &second.scans[1].tracks {
        if !tracks.clone().any(|other| Arc::ptr_eq(other, track)) {
            track.shown().draw(scene, (Role::Reference, "second hypothesis"));
        }
    }
}

/// Draws where the revised detections were.
fn draw_revisions(scene: &mut Scene, seen: &Seen<MultiTracking<MultipleHypothesis>>, revisions: &[Revision]) {
    let first = seen.before.run.span.first;
    for revision in revisions {
        let frame = revision.frame.checked_sub(first).and_then(|i| seen.before.run.frames().get(i));
        let Some(found) = frame.and_then(|frame| frame.detections.get(revision.detection)) else { continue };
        explain::rect(scene, Role::Reference, found.bounds);
        scene.legend(Role::Reference, "revised detection of an earlier frame");
    }
}
