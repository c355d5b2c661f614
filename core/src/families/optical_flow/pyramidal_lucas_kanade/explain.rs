//! The explanation and the drawing of pyramidal Lucas–Kanade.

use super::{Event, Points, PyramidalLucasKanade, State, line, nearest};
use crate::methods::{
    differential::explain::value as shared,
    features::{
        Trace, be, conclude, follow,
        level_trace::{LevelTrace, value as tracking},
        trails::{displacements, points},
        value as features,
    },
};
use crate::products::Status;
use crate::run::Seen;
use crate::scene::{Arrow, Name, Readout, Role, Scene, Stack, Step, Unit};
use crate::{cases, variables};

variables! {
    /// The number of the point, from 1.
    POINT: "Point", "", Unit::WHOLE, Role::Reference;
    /// The number of points.
    POINTS: "Points", "", Unit::count("point");
    /// The number of pyramid levels.
    LEVELS: "", "", Unit::count("level");
}

cases! { over value, shared, features, tracking;
    EVERY_PIXEL: "Every pixel is tracked, row by row",
    POINTS: "{points} {be} tracked",
    ONE_LEVEL: " at full resolution only, so only small motion is within reach of the linearisation.",
    SEVERAL_LEVELS: " from the coarsest of {levels} to full resolution. Motion too large for the linearisation is small on coarse \
                     levels.",
    NO_CLICKS: "No clicked points in this frame, so nothing to track. Click on the frame to add points.",
    NO_KEYPOINTS: "The detector finds no keypoints in this frame, so nothing to track. Lower its threshold.",
    PIXEL: "{reference|Pixel} {pixel}",
    POINT: "{reference|Point} {point}",
    POINT_AT: "{point} of {points:bare} at {position:bare}",
    END_OF_RUN: "End of the run:",
}

/// The inspected point: the one pointed at, else the current one.
pub(super) struct Probe<'a> {
    index: usize,
    pub trace: Trace<'a>,
}

impl PyramidalLucasKanade {
    pub(super) fn probe<'a>(&self, seen: &Seen<'a, Self>) -> Option<Probe<'a>> {
        let (state, fixed) = (seen.before, &*seen.before.fixed);
        let first = state.found.len() * fixed.group;
        let at_work = match seen.events.last()? {
            Event::Nothing => return None,
            Event::Of(_) => first,
            Event::Pixel => first + seen.events.len() - 1,
        };
        // Every point up to the current one can be inspected.
        let pointed_at = seen.point().and_then(|place| {
            let index = nearest(&fixed.points[..=at_work], place)?;
            let reach = if self.points == Points::Dense { 0.5 } else { self.reach() as f32 + 0.5 };
            let at = fixed.points[index];
            (0..2).all(|i| (at[i] - place[i]).abs() <= reach).then_some(index)
        });
        let index = pointed_at.unwrap_or(at_work);
        let level = if index < first { 0 } else { state.level };
        let trace = Trace::new(self.follow(), fixed.pyramids(), fixed.points[index], level);
        let is_in_steps = index == at_work && self.points != Points::Dense;
        Some(Probe { index, trace: if is_in_steps { trace.until(seen.events.len()) } else { trace } })
    }

    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let fixed = &seen.before.fixed;
        let Some(probe) = self.probe(seen) else { return self.opening(seen) };
        let (at, level_trace) = (probe.trace.at, probe.trace.level_trace());
        let step = Step::at(line_of(&level_trace)).put(value::POINTS, fixed.points.len()).put(tracking::POSITION, at);
        let (step, subject) = match self.points {
            Points::Dense => (step.fact(shared::PIXEL, at), case::PIXEL),
            _ => (step.fact_as(value::POINT.is(probe.index + 1), case::POINT_AT), case::POINT),
        };
        let truth = fixed.truth.as_ref().and_then(|truth| truth.at(at[0] as usize, at[1] as usize));
        let step = level_trace.put(step).fact_if(tracking::TRUE_DISPLACEMENT, truth);
        let step = self.conclude(seen, level_trace.tell(step, subject));
        let stack = Stack { levels: fixed.shown(probe.trace.level()), floors: probe.trace.floors() };
        level_trace.show_charts(step, truth).show(Readout::Stack(stack))
    }

    /// Explains a run before its first event, or without points.
    fn opening(&self, seen: &Seen<Self>) -> Step {
        let (fixed, step) = (&seen.before.fixed, Step::at(line::MAKE_PYRAMIDS));
        let (count, levels) = (fixed.points.len(), fixed.levels[0].len());
        if !seen.events.is_empty() {
            let is_clicked = self.points == Points::Clicks;
            return step.fact(value::POINTS, count).say(if is_clicked { case::NO_CLICKS } else { case::NO_KEYPOINTS });
        }
        let step = step.put(value::POINTS, count).put(features::BE, be(count)).put(value::LEVELS, levels);
        let step = step.say(if self.points == Points::Dense { case::EVERY_PIXEL } else { case::POINTS });
        step.say(if levels == 1 { case::ONE_LEVEL } else { case::SEVERAL_LEVELS })
    }

    fn conclude(&self, seen: &Seen<Self>, step: Step) -> Step {
        let (Some(after), None) = (seen.after, seen.point()) else { return step };
        if after.found.len() < after.fixed.groups() {
            return step;
        }
        let one = if self.points == Points::Dense { "pixel" } else { "point" };
        conclude(step.say(case::END_OF_RUN), one, after.features(), after.fixed.truth.as_deref())
    }
}

/// The line of the last event of a point.
fn line_of(level_trace: &LevelTrace) -> Name {
    match level_trace.events.last() {
        None => line::MAKE_PYRAMIDS,
        Some(follow::Event::Window(_)) => line::TAKE_TENSOR,
        Some(follow::Event::Iteration { .. }) if level_trace.has_converged() => line::UNTIL_CONVERGED,
        Some(follow::Event::Iteration { .. }) => line::UPDATE,
        Some(follow::Event::PassedDown(_, Some(Status::Flat)) | follow::Event::End(_, Err(Status::Flat))) => {
            line::IS_SINGULAR
        }
        Some(follow::Event::PassedDown(..)) => line::HAND_ON,
        Some(follow::Event::End(..)) => line::CHECK,
    }
}

pub(super) fn draw_points(state: &State, scene: &mut Scene) {
    let tracked = state.features().filter_map(|point| Some(Arrow { from: point.at, to: point.end()? }));
    let lost = state.features().filter(|point| point.displacement.is_none()).map(|point| point.at);
    points(scene, Role::Measured, "point, not yet tracked", state.fixed.points[state.found.len()..].to_vec());
    points(scene, Role::Rejected, "lost", lost.collect());
    displacements(scene, tracked.collect());
    if state.fixed.points.is_empty() {
        scene.legend(Role::Rejected, "no points");
    }
}
