//! The marks of the blob tracker.

use std::collections::BTreeSet;

use super::explain::ids;
use super::{BlobTracker, Decision, EventKind, State, TrackedBlob};
use crate::geometry::Bounds;
use crate::methods::multi_object::{
    explain,
    tracking::{MultiTracking, errors},
    truth,
};
use crate::run::Seen;
use crate::scene::{Arrow, Picture, Role, Scene, Shape};

impl BlobTracker {
    pub(super) fn draw_step(&self, seen: &Seen<MultiTracking<Self>>, scene: &mut Scene) {
        let detected = seen
            .events
            .iter()
            .find_map(|event| if let EventKind::Detected(all, _) = &event.0 { Some(all) } else { None });
        let blobs = detected.into_iter().flat_map(|all| all.iter());
        explain::draw_detections(scene, blobs.clone().map(|blob| &blob.detection));
        if seen.after.is_none() {
            for (i, blob) in blobs.enumerate() {
                let Bounds { min, max } = blob.detection.bounds;
                explain::label(scene, Role::Measured, [min[0], max[1]], format!("blob {}", i + 1));
            }
        }
        scene.is_overview = seen.after.is_some() && seen.point().is_none();
        errors(seen).iter().for_each(|errors| truth::draw(scene, errors));
        let state = seen.after.unwrap_or(seen.before);
        if seen.after.is_some() || seen.events.is_empty() {
            return state.tracks.iter().for_each(|tracked| draw_tracked(scene, tracked, state));
        }
        draw_work(seen, scene);
    }
}

/// Draws the tracks within a frame: updated, or else predicted.
fn draw_work(seen: &Seen<MultiTracking<BlobTracker>>, scene: &mut Scene) {
    let before = seen.before;
    let predicted =
        seen.events.iter().find_map(|event| if let EventKind::Predicted(all) = &event.0 { Some(all) } else { None });
    let Some(predicted) = predicted else {
        return before.tracks.iter().for_each(|tracked| draw_tracked(scene, tracked, before));
    };
    let (mut gone, mut done, mut arrows) = (BTreeSet::new(), Vec::new(), Vec::new());
    for event in seen.events {
        match &event.0 {
            EventKind::Decided(decision) => {
                arrows.extend(moves(decision));
                done.extend(decision.after.iter().map(|(_, tracked)| tracked));
                gone.extend(decision.members().iter().map(|member| member.id));
            }
            EventKind::Missed(tracked) => {
                done.push(&**tracked);
                gone.extend(tracked.members.iter().map(|member| member.id));
            }
            EventKind::Deleted(tracked) => gone.extend(tracked.members.iter().map(|member| member.id)),
            EventKind::Begun(tracked) => done.push(&**tracked),
            _ => {}
        }
    }
    for tracked in predicted.iter().filter(|tracked| !tracked.members.iter().any(|member| gone.contains(&member.id))) {
        explain::rect(scene, Role::Predicted, tracked.bounds);
        explain::label(scene, Role::Predicted, tracked.bounds.min, ids(&tracked.members));
        scene.legend(Role::Predicted, "prediction");
    }
    done.into_iter().for_each(|tracked| draw_tracked(scene, tracked, before));
    if !arrows.is_empty() {
        scene.mark(Picture::CURRENT, Role::Measured, Shape::Arrows(arrows));
    }
}

fn moves(decision: &Decision) -> impl Iterator<Item = Arrow> {
    let table = &decision.table;
    decision.after.iter().flat_map(move |(column, tracked)| {
        let to = table.blobs[*column].detection.center;
        let tracked_blobs = decision.rows.iter().map(|&row| &table.tracked_blobs[row]);
        let own = tracked_blobs.filter(|before| before.members.iter().any(|member| tracked.has(member.id)));
        own.map(move |before| Arrow { from: before.center().map(|c| c as f32), to })
    })
}

/// Draws a track, or those of a group within its blob.
fn draw_tracked(scene: &mut Scene, tracked: &TrackedBlob, state: &State) {
    if tracked.is_group() {
        explain::rect(scene, Role::Window, tracked.bounds);
        let at = [tracked.bounds.min[0], tracked.bounds.max[1]];
        explain::label(scene, Role::Window, at, format!("group {}", ids(&tracked.members)));
        scene.legend(Role::Window, "group");
    }
    for member in &tracked.members {
        let (role, meaning) = explain::role(member.age.status);
        explain::trail(scene, &state.run, role, (member.id, member.center));
        explain::rect(scene, role, member.bounds);
        explain::label(scene, role, member.bounds.min, member.id.to_string());
        scene.legend(role, meaning);
    }
}
