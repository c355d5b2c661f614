//! Explanations and drawings shared by all contours.

use super::vocabulary::{case, value};
use super::{Edges, LEAST_AREA_PX, Model, Point, Verdict};
use crate::geometry::Grid;
use crate::methods::region::{Ending, Outcome};
use crate::scene::{Arrow, Case, Picture, Role, Scene, Shape, Step};

/// The distance of drawn arrows in px.
const ARROWS_PX: usize = 6;

/// Tells how the edges of a frame were found around a contour of this many points.
pub(crate) fn edges(step: Step, edges: &Edges, (sigma_px, points): (f32, usize)) -> Step {
    let (width, height) = edges.strength.size();
    let step = step.put(value::WINDOW_WIDTH, width).put(value::WINDOW_HEIGHT, height).put(value::SIGMA, sigma_px);
    step.fact(value::POINTS, points).fact(value::STEEPEST, edges.steepest).say(case::EDGES)
}

/// The judgement of a fit, and as the reason of a loss.
fn judgement(verdict: &Verdict) -> (&'static Case, Option<&'static Case>) {
    match verdict {
        _ if verdict.crosses => (case::CROSSES, Some(case::LOST_CROSSED)),
        _ if verdict.area <= -LEAST_AREA_PX => (case::INSIDE_OUT, Some(case::LOST_INSIDE_OUT)),
        _ if verdict.area < LEAST_AREA_PX => (case::COLLAPSED, Some(case::LOST_COLLAPSED)),
        _ if verdict.is_lost => (case::OFF_EDGES, Some(case::LOST_OFF_EDGES)),
        _ => (case::ACCEPTED, None),
    }
}

pub(crate) fn tell_verdict(step: Step, verdict: &Verdict, min_edge_strength: f32) -> Step {
    let step = step.fact(value::EDGE_STRENGTH, verdict.strength).fact(value::AREA, verdict.area);
    let step = step.put(value::ENCLOSED, verdict.area.abs()).put(value::LEAST_AREA, LEAST_AREA_PX);
    step.put(value::MIN_EDGE_STRENGTH, min_edge_strength).say(case::JUDGED).say(judgement(verdict).0)
}

/// Tells why a fit is rejected, if it is.
pub(crate) fn loss(step: Step, verdict: Option<&Verdict>) -> Step {
    match verdict.and_then(|verdict| judgement(verdict).1) {
        Some(why) => step.say(why),
        None => step,
    }
}

/// Tells the lesson of a run with its last judgement; `reach` names the parameter that reaches farther.
pub(crate) fn advice(step: Step, ending: Ending, (verdict, reach): (Option<&Verdict>, &'static Case)) -> Step {
    let told: &[&'static Case] = match (ending.outcome, verdict) {
        (Outcome::Followed, _) => &[case::FOLLOWED],
        (Outcome::Lost, _) if ending.hidden > 0 => &[case::HIDDEN],
        (_, Some(verdict)) if verdict.crosses => &[case::FOLDED, case::PATTERN],
        (_, Some(verdict)) if verdict.area.abs() < LEAST_AREA_PX => &[case::NOT_HELD],
        (Outcome::Shrunk, _) => &[case::SHRUNK, case::PATTERN],
        (Outcome::Grown, _) => &[case::GROWN],
        (Outcome::Regained, _) => &[case::REGAINED],
        (Outcome::Beside | Outcome::Unknown, _) => &[case::BESIDE, case::PATTERN],
        (Outcome::Lost, _) => &[case::OUTRUN, reach, case::PATTERN],
    };
    told.iter().fold(step, |step, case| step.say(case))
}

fn marked(points: &[Point]) -> Vec<[f32; 2]> {
    points.iter().map(|at| at.map(|c| c as f32)).collect()
}

pub(crate) fn contour(scene: &mut Scene, (role, meaning): (Role, &'static str), points: &[Point]) {
    scene.draw(Picture::CURRENT, (role, meaning), Shape::outline(marked(points)));
}

pub(crate) fn dots(scene: &mut Scene, role: Role, points: &[Point]) {
    scene.mark(Picture::CURRENT, role, Shape::Points(marked(points)));
}

/// Draws a quantity in a window as a heat map, with the outline of the window.
pub(crate) fn heat(scene: &mut Scene, name: &'static str, (origin, values): ([usize; 2], &Grid<f32>)) {
    let (width, height) = values.size();
    let values = values.clone();
    scene.mark(Picture::CURRENT, Role::Candidate, Shape::Heat { origin: origin.map(|c| c as f32), values });
    scene.heat = Some(name);
    let [x, y] = origin.map(|c| c as i32);
    scene.draw(Picture::CURRENT, (Role::Window, "window"), Shape::pixels(x, y, width, height));
}

/// Draws a force as arrows, the longest as long as their distance.
pub(crate) fn arrows(scene: &mut Scene, [left, top]: [usize; 2], values: &Grid<[f32; 2]>) {
    let (width, height) = values.size();
    let length = |force: [f32; 2]| force[0].hypot(force[1]);
    let most = values.cells().iter().map(|force| length(*force)).fold(0.0, f32::max);
    if most == 0.0 {
        return;
    }
    let steps = |extent: usize| (ARROWS_PX / 2..extent).step_by(ARROWS_PX);
    let arrow = |(x, y): (usize, usize)| {
        let force = values[(x, y)];
        let from = [(left + x) as f32, (top + y) as f32];
        // Weak forces far from edges matter, and would not be visible beside the strong ones.
        let scale = ARROWS_PX as f32 * (length(force) / most).sqrt() / length(force).max(f32::MIN_POSITIVE);
        Arrow { from, to: [0, 1].map(|i| from[i] + scale * force[i]) }
    };
    let all = steps(height).flat_map(|y| steps(width).map(move |x| (x, y))).map(arrow).collect();
    scene.draw(Picture::CURRENT, (Role::Predicted, "external force, √ of its length"), Shape::Arrows(all));
}

/// Draws the result of a frame.
pub(crate) fn result(scene: &mut Scene, model: &Model) {
    if !model.result.is_lost {
        contour(scene, (Role::Best, "contour"), &model.points);
    }
}
