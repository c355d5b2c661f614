//! The tracks of a frame beside the ground truth: matches, misses, false alarms and identity switches.

use super::explain::{label, rect};
use super::tracker_run::TrackerRun;
use crate::data::Clip;
use crate::geometry::Bounds;
use crate::products::objects::score::{FrameErrors, errors_on};
use crate::scene::{Fact, Role, Scene};

/// The distance in px of the frame around a false alarm from its box.
const AROUND_PX: f32 = 2.0;

/// The most objects of a frame whose errors are told: more cannot be seen apart, and their matching takes seconds.
const MOST_OBJECTS: usize = 500;

/// Returns the errors of the last finished frame, if the truth of the run is known.
pub(crate) fn errors_of_last(clip: &Clip, run: &TrackerRun) -> Option<FrameErrors> {
    if run.frames().iter().any(|frame| frame.objects.len() > MOST_OBJECTS) {
        return None;
    }
    errors_on(clip, &run.field()).ok().flatten()?.pop()
}

/// Draws the true boxes, and marks misses, false alarms and identity switches.
pub(crate) fn draw(scene: &mut Scene, errors: &FrameErrors) {
    for (_, bounds) in &errors.matches {
        rect(scene, Role::Truth, *bounds);
        scene.legend(Role::Truth, "true box, matched");
    }
    for (_, bounds) in &errors.misses {
        rect(scene, Role::Error, *bounds);
        scene.legend(Role::Error, "miss: true box without a track");
    }
    for (_, Bounds { min, max }) in &errors.false_alarms {
        let grown = Bounds { min: min.map(|c| c - AROUND_PX), max: max.map(|c| c + AROUND_PX) };
        rect(scene, Role::Rejected, grown);
        scene.legend(Role::Rejected, "false alarm: track without a true box");
    }
    for switch in &errors.switches {
        let Bounds { min, max } = switch.bounds;
        label(scene, Role::Window, [min[0], max[1]], format!("{} → {}", switch.before, switch.now));
        scene.legend(Role::Window, "identity switch");
    }
}

/// Returns the errors as facts.
pub(crate) fn facts(errors: &FrameErrors) -> Vec<Fact> {
    let FrameErrors { matches, misses, false_alarms, .. } = errors;
    let all = matches.len() + misses.len();
    let mut facts = vec![
        Fact::new("Matched true objects", format!("{} of {all}", matches.len()), Some(Role::Truth)),
        Fact::new("Misses", misses.len().to_string(), Some(Role::Error)),
        Fact::new("False alarms", false_alarms.len().to_string(), Some(Role::Rejected)),
    ];
    facts.extend(errors.switches.iter().map(|switch| {
        let value = format!("object {}: track {} → {}", switch.object, switch.before, switch.now);
        Fact::new("Identity switch", value, Some(Role::Window))
    }));
    facts
}

/// Returns the identity switches of a frame in words.
pub(crate) fn switches(errors: &FrameErrors) -> String {
    let one = |of: &crate::products::objects::score::Switch| {
        format!(" Identity switch: true object {} was track {} and is track {} now.", of.object, of.before, of.now)
    };
    errors.switches.iter().map(one).collect()
}
