//! The marks of multiple hypothesis tracking.

use std::sync::Arc;

use super::charts::ROWS;
use super::expand::{Expansion, Gates};
use super::forest::{Claim, Origin, Scan, Track};
use super::{Event, Leading, MultipleHypothesis, Revision, State};
use crate::methods::multi_object::{
    explain::{self, ShownTrack},
    tracking::{MultiTracking, errors},
    truth,
};
use crate::run::Seen;
use crate::scene::{Arrow, Picture, Role, Scene, Shape};

impl MultipleHypothesis {
    pub(super) fn drawn(&self, seen: &Seen<MultiTracking<Self>>, scene: &mut Scene) {
        let detected = seen
            .events
            .iter()
            .find_map(|event| if let Event::Detected(all, _) = event { Some(&all[..]) } else { None });
        let detected = detected.unwrap_or_default();
        explain::draw_detections(scene, detected);
        scene.is_overview = seen.after.is_some() && seen.point().is_none();
        if let Some(after) = seen.after {
            errors(seen).iter().for_each(|errors| truth::draw(scene, errors));
            return draw_leading(scene, after, seen);
        }
        explain::number_detections(scene, detected);
        match seen.events.last() {
            None | Some(Event::Detected(..)) => draw_leading(scene, seen.before, seen),
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
fn draw_leading(scene: &mut Scene, state: &State, seen: &Seen<MultiTracking<MultipleHypothesis>>) {
    let run = &seen.after.unwrap_or(seen.before).run;
    for cluster in &state.tracks {
        for track in cluster.hypotheses.first().iter().flat_map(|leader| &leader.tracks) {
            let track = &cluster.tracks[*track];
            track.shown().draw_with_trail(scene, run);
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
    for (role, meaning, arrows) in
        [(Role::Candidate, "other branches", others), (Role::Best, "most probable branch", best)]
    {
        if !arrows.is_empty() {
            scene.mark(Picture::CURRENT, role, Shape::Arrows(arrows));
            scene.legend(role, meaning);
        }
    }
    for detection in &expansion.detections {
        explain::rect(scene, Role::Window, gates.detections[*detection].bounds);
        scene.legend(Role::Window, "detection of the cluster");
    }
    let detections = expansion.detections.iter().map(|detection| gates.detections[*detection].bounds);
    explain::work_on(scene, expansion.tracks.iter().map(|track| track.bounds()).chain(detections));
}

/// Draws the leading hypothesis, and the boxes of the second where it explains this frame otherwise.
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
