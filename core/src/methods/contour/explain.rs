//! What all contours explain and draw alike.

use super::{Edges, LEAST_AREA_PX, Model, Point, Verdict};
use crate::base::words::{counted, fixed};
use crate::geometry::Grid;
use crate::methods::numbers::{gray, ratio};
use crate::methods::region::{Ending, Outcome};
use crate::scene::{Arrow, Fact, Picture, Role, Scene, Sentence, Shape};

/// The distance of drawn arrows in px.
const ARROWS_PX: usize = 6;

/// An area as text.
pub(crate) fn area(px2: f64) -> String {
    format!("{} px²", fixed(px2, 0))
}

/// How the edges of a frame were found.
pub(crate) fn edges(said: Sentence, edges: &Edges, sigma_px: f32) -> Sentence {
    let (width, height) = edges.strength.size();
    said.ink(Role::Measured, "Edge strength f")
        .text(format!(
            " in a window of {width}×{height} px around the contour: the gradient magnitude after smoothing with σ = "
        ))
        .text(format!(
            "{} px, as a share of the steepest, {} gray levels/px.",
            fixed(sigma_px.into(), 1),
            gray(edges.steepest)
        ))
}

/// The judgement of a fit.
pub(crate) fn judged(said: Sentence, verdict: &Verdict, min_edge: f32) -> Sentence {
    let said = said
        .text("The contour has a mean edge strength of ")
        .ink(Role::Measured, ratio(verdict.strength.into()))
        .text(format!(" and encloses {}", area(verdict.area.abs())));
    if verdict.crosses {
        said.text(", but it crosses itself and has no inside: edges inside the object or in the background drew its points past each other.")
    } else if verdict.area <= -LEAST_AREA_PX {
        said.text(", but it has turned inside out.")
    } else if verdict.area < LEAST_AREA_PX {
        said.text(format!(", less than {}: it has collapsed.", area(LEAST_AREA_PX)))
    } else if verdict.is_lost {
        said.text(format!(". That is below {}: on average its points do not lie on edges.", ratio(min_edge.into())))
    } else {
        said.text(format!(". That is not below {}: it lies on edges, and the fit is accepted.", ratio(min_edge.into())))
    }
}

/// Why a fit is refused, as a clause.
pub(crate) fn loss(verdict: &Verdict) -> Option<&'static str> {
    match verdict {
        _ if !verdict.is_lost => None,
        _ if verdict.crosses => Some("the contour crosses itself"),
        _ if verdict.area <= -LEAST_AREA_PX => Some("the contour has turned inside out"),
        _ if verdict.area < LEAST_AREA_PX => Some("the contour has collapsed"),
        _ => Some("its points do not lie on edges"),
    }
}

/// What a patterned object does to a contour, and what helps.
const PATTERN: &str = "Where a pattern has stronger edges than the outline, no weight helps; trackers of colours or texture follow patterned \
                       objects.";

/// The lesson of a run with its last judgement; `reach` says what reaches farther.
pub(crate) fn advice(ending: Ending, verdict: Option<&Verdict>, reach: &str) -> String {
    match (ending.outcome, verdict) {
        (Outcome::Followed, _) => {
            "The edges held the contour, because they moved less from frame to frame than their force reaches. It knows neither colour \
             nor texture: a stronger edge nearby would attract it."
                .into()
        }
        (Outcome::Lost, _) if ending.hidden > 0 => {
            format!(
                "The object was hidden in {}, and a contour searches only where it was. A velocity is not predicted.",
                counted(ending.hidden, "frame")
            )
        }
        (_, Some(verdict)) if verdict.crosses => {
            format!("Edges inside the object or in the background drew the points past each other, so the contour folded. {PATTERN}")
        }
        (_, Some(verdict)) if verdict.area.abs() < LEAST_AREA_PX => {
            "No edge held the contour against its own elasticity, so it collapsed. A smaller α or a balloon pressure keeps it open.".into()
        }
        (Outcome::Shrunk, _) => format!("The contour slipped onto edges inside the object. {PATTERN}"),
        (Outcome::Grown, _) => "The contour spread to edges of the background, which are stronger than the outline.".into(),
        (Outcome::Regained, _) => {
            "The contour left the object and met it again: it finds only what comes back to it. A velocity is not predicted.".into()
        }
        (Outcome::Beside | Outcome::Unknown, _) => {
            format!("A part of the contour lies on edges that are not the outline. {PATTERN}")
        }
        (Outcome::Lost, _) => {
            format!("The object moved farther between two frames than its edges attract, or other edges were nearer. {reach} {PATTERN}")
        }
    }
}

/// The numbers of a judgement.
pub(crate) fn verdict_facts(verdict: &Verdict) -> Vec<Fact> {
    vec![
        Fact::new("Mean edge strength", ratio(verdict.strength.into()), Some(Role::Measured)),
        Fact::new("Area", area(verdict.area), None),
    ]
}

/// Points as those of a mark.
fn marked(points: &[Point]) -> Vec<[f32; 2]> {
    points.iter().map(|at| at.map(|c| c as f32)).collect()
}

/// Draws a contour.
pub(crate) fn contour(scene: &mut Scene, (role, meaning): (Role, &'static str), points: &[Point]) {
    scene.mark(Picture::CURRENT, role, Shape::Path { points: marked(points), closed: true });
    scene.legend(role, meaning);
}

/// Draws the points of a contour.
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
    scene.mark(Picture::CURRENT, Role::Window, Shape::pixels(x, y, width, height));
    scene.legend(Role::Window, "window");
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
        // Weak forces far from edges matter, and would not be seen beside the strong ones.
        let scale = ARROWS_PX as f32 * (length(force) / most).sqrt() / length(force).max(f32::MIN_POSITIVE);
        Arrow { from, to: [0, 1].map(|i| from[i] + scale * force[i]) }
    };
    let all = steps(height).flat_map(|y| steps(width).map(move |x| (x, y))).map(arrow).collect();
    scene.mark(Picture::CURRENT, Role::Predicted, Shape::Arrows(all));
    scene.legend(Role::Predicted, "external force, √ of its length");
}

/// Draws the result of a frame.
pub(crate) fn result(scene: &mut Scene, model: &Model) {
    if !model.result.is_lost {
        contour(scene, (Role::Best, "contour"), &model.points);
    }
}
