//! The tracks of a frame beside the ground truth: matches, misses, false alarms and identity switches.

use super::drawing::{label, rect};
use super::tracker_run::TrackerRun;
use super::vocabulary::{case, value};
use crate::data::Clip;
use crate::geometry::Bounds;
use crate::products::objects::score::{FrameErrors, errors_on};
use crate::scene::{Role, Scene, Step};

/// The distance in px of the frame around a false alarm from its box.
const AROUND_PX: f32 = 2.0;

/// The maximum number of objects of a frame whose errors are shown: more cannot be told apart, and their matching takes seconds.
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

pub(crate) fn add_errors(step: Step, errors: &FrameErrors) -> Step {
    let FrameErrors { matches, misses, false_alarms, switches, .. } = errors;
    let step = step.put(value::TRUTHS, matches.len() + misses.len());
    let step = step.fact_as(value::MATCHED.is(matches.len()), case::MATCHED_OF).fact(value::MISSES, misses.len());
    switches.iter().fold(step.fact(value::FALSE_ALARMS, false_alarms.len()), |step, switch| {
        let step = step.put(value::TRUE_OBJECT, switch.object).put(value::TRACK_NOW, switch.now);
        step.fact_as(value::TRACK_BEFORE.is(switch.before), case::SWITCH)
    })
}

pub(crate) fn tell_switches(step: Step, errors: &FrameErrors) -> Step {
    errors.switches.iter().fold(step, |step, switch| {
        let step = step.put(value::TRUE_OBJECT, switch.object).put(value::TRACK_BEFORE, switch.before);
        step.put(value::TRACK_NOW, switch.now).say(case::SWITCHED)
    })
}
