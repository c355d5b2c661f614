//! The explanation and the drawing of the template tracker.

use super::template::{Pyramid, outline};
use super::{
    Correction, End, Event, Iteration, Judged, LEAST_OVERLAP, MOST_STRETCH, Model, Stretch, Template, TemplateTracker,
    Update,
};
use crate::base::words::{counted, fixed};
use crate::geometry::{Bounds, Grid, Sampling, polygon};
use crate::methods::alignment::explain::{compared, errors, hessian, parameters, steepest_descent, warp_matrix};
use crate::methods::numbers::{percent, px, ratio};
use crate::methods::region::{At, Ending, Explained, Loss, Outcome};
use crate::products::model::{Matrix3, inverse, mapped};
use crate::scene::{Fact, Math, Picture, PlaneCost, Readout, Role, Scene, Sentence, Series, Shape, Surface, Tile};

/// The visible share of an object from which on nothing covers it: the rest are pixels at its outline.
const VISIBLE: f64 = 0.97;
/// The motion between two frames, as a share of the shorter side of the object, from which on it is far for the iterations.
const FAR: f64 = 0.3;
/// The landscapes of a template reach this far to each side, in px of the level.
const REACH_PX: f32 = 6.0;

/// A difference in gray levels as text.
fn gray(value: f64) -> String {
    fixed(value, 2)
}

/// A sub-pixel motion as text.
fn fine(length: f64) -> String {
    format!("{} px", fixed(length, 3))
}

impl Explained for TemplateTracker {
    const JUDGES_LOSS: bool = true;

    fn sentence(&self, at: &At<'_, Self>) -> Sentence {
        let said = Sentence::default();
        match at.event {
            Event::Learned(first) => {
                let (width, height) = first.size();
                said.ink(Role::Reference, format!("The template T₁ of {width}×{height} px")).text(format!(
                    " on {}, with the steepest-descent images of its {}. They belong to the template, so they are computed once for all \
                     iterations. The Hessian is invertible: the texture determines the warp.",
                    counted(first.levels.len(), "pyramid level"),
                    counted(self.warp.group().freedom(), "parameter")
                ))
            }
            Event::Iterated(iteration) => self.iterated(iteration, said),
            Event::Judged(judged) => self.judged(judged, said),
            Event::Corrected(correction) => self.corrected(correction, said),
            Event::Updated(_) if self.update == Update::EveryFrame => said.text(
                "The warped window becomes the template of the next frame. It follows changes of appearance, but it keeps the error of the \
                 warp too: over many frames, errors add up to drift.",
            ),
            Event::Updated(_) => said.text(
                "The window at the corrected warp becomes the template of the next frame: changes of appearance are followed without drift.",
            ),
        }
    }

    fn facts(&self, at: &At<'_, Self>) -> Vec<Fact> {
        match at.event {
            Event::Learned(first) | Event::Updated([_, first]) => {
                let (width, height) = first.size();
                vec![Fact::new("Template", format!("{width}×{height} px"), Some(Role::Reference))]
            }
            Event::Iterated(iteration) => {
                let mut facts = vec![
                    Fact::new("Level", iteration.level.to_string(), None),
                    Fact::new("Iteration", iteration.number.to_string(), None),
                    Fact::new("Error (RMS)", gray(iteration.compared.rms), Some(Role::Error)),
                ];
                let moved = iteration.moved.as_ref();
                facts.extend(
                    moved.map(|moved| Fact::new("Largest corner motion", fine(moved.px), Some(Role::Estimate))),
                );
                facts
            }
            Event::Judged(judged) => vec![
                Fact::new("Correlation with the template", ratio(judged.correlation), Some(Role::Measured)),
                Fact::new("Template inside the frame", percent(judged.overlap), None),
            ],
            Event::Corrected(correction) => {
                vec![Fact::new("Drift", fine(correction.px), Some(Role::Error))]
            }
        }
    }

    fn readouts(&self, at: &At<'_, Self>) -> Vec<Readout> {
        let group = self.warp.group();
        let mut readouts = match at.event {
            Event::Learned(first) => {
                let level = &first.levels[0];
                let tiles = [template_tile("template T₁", first)].into_iter();
                vec![
                    Readout::Equation(vec![formula_of_hessian()]),
                    Readout::Tiles(tiles.chain(steepest_descent(&level.aligner(group))).collect()),
                    Readout::Matrices(vec![hessian(group, &level.hessian)]),
                ]
            }
            Event::Iterated(iteration) => self.of_iteration(at, iteration),
            Event::Judged(judged) => vec![
                Readout::Landscape(self.correlations(judged)),
                Readout::Equation(vec![formula_of_correlation(judged.correlation)]),
                Readout::Tiles(tiles("template T", (&judged.frame, &judged.template), (0, &judged.warp))),
            ],
            Event::Corrected(correction) => {
                let [warp, corrected] = &correction.warps;
                vec![
                    Readout::Equation(vec![formula_of_drift(correction.px)]),
                    Readout::Tiles(tiles("template T₁", (&correction.frame, &correction.first), (0, corrected))),
                    Readout::Matrices(vec![
                        warp_matrix(("W", "warp, px of the picture", Role::Predicted), warp),
                        warp_matrix(("W*", "warp of T₁, px of the picture", Role::Estimate), corrected),
                    ]),
                ]
            }
            Event::Updated([before, after]) => vec![
                Readout::Equation(vec![Math::text("T(x) ← I(W(x))")]),
                Readout::Tiles(vec![template_tile("template T", before), template_tile("template, updated", after)]),
            ],
        };
        readouts.extend(errors_of(at).map(Readout::Series));
        readouts
    }

    fn draw(&self, at: &At<'_, Self>, scene: &mut Scene) {
        match at.event {
            Event::Learned(_) | Event::Updated(_) => {}
            Event::Iterated(iteration) => {
                heat(scene, (&iteration.frame, &iteration.template), (iteration.level, &iteration.before));
                let size = iteration.template.size();
                path(scene, (Role::Rejected, "template before the iteration"), (&iteration.before, size));
                if let Some(moved) = &iteration.moved {
                    path(scene, (Role::Best, "warped template"), (&moved.after, size));
                }
            }
            Event::Judged(judged) => {
                heat(scene, (&judged.frame, &judged.template), (0, &judged.warp));
                path(scene, (Role::Best, "warped template"), (&judged.warp, judged.template.size()));
            }
            Event::Corrected(correction) => {
                let ([warp, corrected], size) = (&correction.warps, correction.first.size());
                heat(scene, (&correction.frame, &correction.first), (0, corrected));
                path(scene, (Role::Predicted, "warp of the template"), (warp, size));
                let role = if correction.is_accepted { Role::Best } else { Role::Rejected };
                path(scene, (role, "warp of the first template"), (corrected, size));
            }
        }
    }

    fn draw_result(&self, model: &Model, scene: &mut Scene) {
        if model.lost_frames == 0 {
            path(scene, (Role::Best, "warped template"), (&model.warp, model.first.size()));
        }
    }

    fn loss(&self, at: &At<'_, Self>) -> Option<String> {
        let judged = at.events.iter().rev().find_map(|event| match event {
            Event::Judged(judged) => Some(judged),
            _ => None,
        })?;
        let why = match () {
            () if judged.overlap < LEAST_OVERLAP => "too little of the template lies inside the frame",
            () if judged.stretch.is_collapsed() => "the alignment has failed, since its warp changes a length too much",
            () => "the correlation is too low",
        };
        judged.is_lost.then(|| why.into())
    }

    fn advice(&self, ending: Ending, _at: &At<'_, Self>) -> String {
        match (ending.outcome, self.update) {
            (Outcome::Unknown, _) => {
                "Without ground truth drift is seen in the warped template alone: it should still show the object of the first frame."
            }
            (Outcome::Followed, Update::None) => {
                "The first template fits the object in all frames, so nothing drifts. A change of its appearance would not be followed."
            }
            (Outcome::Followed, Update::EveryFrame) => {
                "Each frame gave the next template, so changes of appearance were followed. The errors of all frames add up to drift, \
                 which the correlation with the present template does not show."
            }
            (Outcome::Followed, Update::Corrected) => {
                "The template followed changes of appearance, and the first one took out the drift wherever both agreed."
            }
            (_, update) if ending.reported == 0 => unreported(update),
            (..) => return ending.loss.map_or_else(|| UNKNOWN_CAUSE.into(), cause),
        }
        .into()
    }
}

/// What is said of a loss in frames of which the truth is not known.
const UNKNOWN_CAUSE: &str = "Without the true box at the start of the loss its cause is not known: cover, a motion farther than the iterations \
                             converge and a change of appearance all lower the correlation.";

/// What took the template off an object that was not reported as lost.
fn unreported(update: Update) -> &'static str {
    match update {
        Update::EveryFrame => {
            "No frame had a low correlation, because the template of each was the window of the last: the errors added up to drift. \
             The drift correction removes it."
        }
        Update::None | Update::Corrected => {
            "No frame had a low correlation: the warp fitted a part of the object or its surroundings. A smaller group of warps, or a higher \
             minimum correlation, keeps the template from that."
        }
    }
}

/// The cause of a loss, by what the truth says of its first frame.
fn cause(loss: Loss) -> String {
    let (frame, moved) = (loss.frame, px(loss.moved_px));
    let seen = percent(loss.visibility);
    if loss.is_leaving {
        format!(
            "The loss begins in frame {frame}, where {seen} of the object was still in the picture: it was leaving."
        )
    } else if loss.visibility < VISIBLE {
        format!(
            "The loss begins in frame {frame}, where {seen} of the object was visible: it was covered. No velocity is predicted, \
             so the template searches where the object was last seen."
        )
    } else if loss.moved_px > FAR * loss.side_px {
        format!(
            "The loss begins in frame {frame}, where the object was in full view but had moved by {moved} px: farther than the iterations \
             converge. Mean shift or a particle filter with more process noise reaches farther."
        )
    } else {
        format!(
            "The loss begins in frame {frame}, where nothing covered the object and it had moved by only {moved} px: a rotation, a change of light, blur or another \
             change of its appearance lowered the correlation. A colour histogram, as in mean shift, changes less."
        )
    }
}

impl TemplateTracker {
    fn iterated(&self, iteration: &Iteration, said: Sentence) -> Sentence {
        let number = iteration.number;
        let said = match iteration.is_correction {
            true => said.text(format!(
                "Drift correction, iteration {number}: under the warp, the first template T₁ and frame t have an RMS difference of "
            )),
            false => said.text(format!(
                "Iteration {number} on level {}: warping frame t toward the template leaves an RMS difference of ",
                iteration.level
            )),
        };
        let said = said.ink(Role::Error, format!("{} gray levels", gray(iteration.compared.rms))).text(". ");
        let moved = iteration.moved.as_ref().map_or(0.0, |moved| moved.px);
        let epsilon = fine(self.epsilon.into());
        match iteration.end {
            None => said
                .text("Solving H Δp = b moves a corner by ")
                .ink(Role::Estimate, fine(moved))
                .text(format!(", more than ε = {epsilon}: another iteration.")),
            Some(End::Converged) => said
                .text("Solving H Δp = b moves the corners by at most ")
                .ink(Role::Estimate, fine(moved))
                .text(format!(" ≤ ε = {epsilon}: converged.")),
            Some(End::Exhausted) => said
                .text("Solving H Δp = b still moves a corner by ")
                .ink(Role::Estimate, fine(moved))
                .text(format!(", but this is the maximum of {}.", counted(self.iterations, "iteration"))),
            Some(End::Worse) => {
                said.text("The error no longer falls: ").ink(Role::Rejected, "the last update is undone").text(".")
            }
            Some(End::Outside) => said
                .text(format!(
                    "Only {} of the template lies inside the frame, less than {}: the alignment has ",
                    percent(iteration.compared.overlap),
                    percent(LEAST_OVERLAP)
                ))
                .ink(Role::Rejected, "diverged")
                .text("."),
            Some(End::Singular) => said
                .text("The pixels inside have a ")
                .ink(Role::Rejected, "singular Hessian")
                .text(": they determine no increment."),
        }
    }

    fn judged(&self, judged: &Judged, said: Sentence) -> Sentence {
        if judged.overlap < LEAST_OVERLAP {
            return said.text(format!(
                "Only {} of the template lies inside the frame, less than {}: the object has left it.",
                percent(judged.overlap),
                percent(LEAST_OVERLAP)
            ));
        }
        if judged.stretch.is_collapsed() {
            let Stretch { largest, smallest, most } = judged.stretch;
            let limit = match judged.stretch.is_beyond() {
                true => format!("beyond {} to {}", ratio(1.0 / most), ratio(most)),
                false => format!("which differ by more than a factor of {}", ratio(MOST_STRETCH)),
            };
            return said
                .text("Since the last frame with the object, the warp changes lengths by factors between ")
                .ink(Role::Error, format!("{} and {}", ratio(smallest), ratio(largest)))
                .text(format!(
                    ", {limit}: the alignment has failed, with ρ = {}. The warp is discarded.",
                    ratio(judged.correlation)
                ));
        }
        let said = said
            .text("The warped window has a correlation with its template of ")
            .ink(Role::Measured, format!("ρ = {}", ratio(judged.correlation)));
        let least = ratio(self.min_correlation.into());
        if judged.is_lost {
            said.text(format!(
                ", below {least}: this is not the object, or not all of it. The warp is discarded, and the template stays."
            ))
        } else {
            said.text(format!(", not below {least}: the alignment is accepted."))
        }
    }

    fn corrected(&self, correction: &Correction, said: Sentence) -> Sentence {
        let most = px(self.max_correction.into());
        let said = said
            .text(
                "From the warp of the template, the alignment with the first template T₁ moves the corners by at most ",
            )
            .ink(Role::Error, fine(correction.px));
        if correction.is_accepted {
            said.text(format!(", not more than {most} px. This is the drift of the frame, and it is removed."))
        } else {
            said.text(format!(
                ", more than {most} px: it has failed, since drift is slow. Warp and template stay as they are."
            ))
        }
    }

    fn of_iteration(&self, at: &At<'_, Self>, iteration: &Iteration) -> Vec<Readout> {
        let label = if iteration.is_correction { "template T₁" } else { "template T" };
        let mut matrices = Vec::new();
        if let Some(moved) = &iteration.moved {
            let group = self.warp.group();
            matrices.push(parameters(group, ("b", "right-hand side", Role::Error), &iteration.compared.right));
            matrices.push(parameters(group, ("Δp", "increment", Role::Estimate), &moved.parameters));
        }
        let warp = iteration.moved.as_ref().map_or(&iteration.before, |moved| &moved.after);
        matrices.push(warp_matrix(("W", "warp, px of the picture", Role::Result), warp));
        vec![
            Readout::Equation(vec![formula_of_increment()]),
            Readout::Tiles(tiles(label, (&iteration.frame, &iteration.template), (iteration.level, &iteration.before))),
            Readout::Matrices(matrices),
            Readout::Landscape(self.valley(at, iteration)),
        ]
    }

    /// The RMS difference where the warp of an iteration is shifted, with the path of the iterations of its level.
    fn valley(&self, at: &At<'_, Self>, iteration: &Iteration) -> Surface {
        let (level, image) = (&iteration.template.levels[iteration.level], &iteration.frame[iteration.level]);
        let aligner = level.aligner(self.warp.group());
        let error = |warp: &Matrix3| {
            let compared = aligner.compare(&level.hessian, image, &level.on_level(warp));
            (compared.rms, compared.overlap)
        };
        let before = at.events.iter().filter_map(|event| match event {
            Event::Iterated(other) if other.is_part_of(iteration) => Some(position(&other.before)),
            _ => None,
        });
        let mut path: Vec<_> = before.collect();
        let undone = path.len().checked_sub(2).filter(|_| iteration.end == Some(End::Worse)).map(|last| path[last]);
        path.extend(iteration.moved.as_ref().map(|moved| position(&moved.after)).or(undone));
        let first = path.first().copied().unwrap_or_else(|| position(&iteration.before));
        let reach = REACH_PX * (1u32 << iteration.level) as f32;
        let names = ("RMS difference", "gray levels");
        shifted(names, (&iteration.before, first, reach), level.pixels.cells().len(), error).with_trail(path)
    }

    /// The correlation where the warp of an alignment is shifted, with the contour below which the object is lost.
    fn correlations(&self, judged: &Judged) -> Surface {
        let level = &judged.template.levels[0];
        let (place, each) = (position(&judged.warp), level.pixels.cells().len());
        let correlation = |warp: &Matrix3| level.correlation(&judged.frame[0], warp);
        let surface = shifted(("ρ", ""), (&judged.warp, place, REACH_PX), each, correlation);
        Surface { is_similarity: true, best: Some([0; 2]), contour: Some(self.min_correlation), ..surface }
    }
}

impl Iteration {
    /// Whether it belongs to the same level of the same alignment.
    fn is_part_of(&self, other: &Self) -> bool {
        (self.is_correction, self.level) == (other.is_correction, other.level)
    }
}

/// Where a warp has the middle of the template, in px of the picture.
fn position(warp: &Matrix3) -> [f32; 2] {
    [warp[0][2] as f32, warp[1][2] as f32]
}

/// A value of a template of `each` pixels under a warp that is shifted: the middle of the template lies up to `reach` px from
/// `center`. `value` gives it with the share inside the frame; it is missing where that is too small.
fn shifted(
    names: (&'static str, &'static str),
    (warp, center, reach): (&Matrix3, [f32; 2], f32),
    each: usize,
    value: impl Fn(&Matrix3) -> (f64, f64),
) -> Surface {
    let from = position(warp);
    let at = |place: [f32; 2]| {
        let mut warp = *warp;
        (0..2).for_each(|i| warp[i][2] += f64::from(place[i] - from[i]));
        let (value, overlap) = value(&warp);
        if overlap < LEAST_OVERLAP { f32::NAN } else { value as f32 }
    };
    Surface::sampled_over_picture(names, (Picture::CURRENT, center, reach), PlaneCost::cells(each), at)
}

/// H = Σ Dᵀ D, D = ∇T · ∂W/∂p.
fn formula_of_hessian() -> Math {
    let transposed = Math::power(Math::Bold("D"), Math::text("T"));
    Math::Row(vec![
        Math::Bold("H"),
        Math::text(" = "),
        Math::Sum(Box::new(Math::text("x"))),
        transposed,
        Math::Bold("D"),
        Math::text(", "),
        Math::Bold("D"),
        Math::text(" = ∇T · "),
        Math::over(Math::text("∂W"), Math::text("∂p")),
    ])
}

/// H Δp = b = Σ Dᵀ (I(W(x)) − T(x)).
fn formula_of_increment() -> Math {
    Math::Row(vec![
        Math::Bold("H"),
        Math::text(" Δp = "),
        Math::Bold("b"),
        Math::text(" = "),
        Math::Sum(Box::new(Math::text("x"))),
        Math::power(Math::Bold("D"), Math::text("T")),
        Math::text(" (I(W(x)) − T(x)),  W ← W ∘ "),
        Math::power(Math::text("W(Δp)"), Math::text("−1")),
    ])
}

/// The zero-mean normalised cross-correlation with its value.
fn formula_of_correlation(value: f64) -> Math {
    let sum = |of: &str| Math::Row(vec![Math::Sum(Box::new(Math::text("x"))), Math::text(of)]);
    let square = |of: &str| Math::Row(vec![Math::Sum(Box::new(Math::text("x"))), Math::squared(Math::text(of))]);
    let (window, template) = (Math::Bar(Box::new(Math::Var("I"))), Math::Bar(Box::new(Math::Var("T"))));
    Math::Row(vec![
        Math::text("ρ = "),
        Math::over(
            Math::Row(vec![sum("(I(W(x)) − "), window, Math::text(")(T(x) − "), template, Math::text(")")]),
            Math::root(Math::Row(vec![square("(I(W(x)) − Ī)"), Math::text(" "), square("(T(x) − T̄)")])),
        ),
        Math::text(" = "),
        Math::ink(Role::Measured, ratio(value)),
    ])
}

/// The farthest motion of a corner with its value.
fn formula_of_drift(px: f64) -> Math {
    let corner = || Math::indexed(Math::Var("x"), Math::Var("i"));
    Math::Row(vec![
        Math::indexed(Math::text("max"), Math::Var("i")),
        Math::text(" "),
        Math::abs(Math::Row(vec![Math::text("W*("), corner(), Math::text(") − W("), corner(), Math::text(")")])),
        Math::text(" = "),
        Math::ink(Role::Error, fine(px)),
    ])
}

/// A template on a level of the frame, the warped window, and their difference.
fn tiles(label: &'static str, (frame, template): (&Pyramid, &Template), (level, warp): (usize, &Matrix3)) -> Vec<Tile> {
    let of_level = &template.levels[level];
    compared(label, [&of_level.pixels, &frame[level]], &of_level.on_level(warp))
}

fn template_tile(label: &'static str, template: &Template) -> Tile {
    Tile {
        label,
        role: Some(Role::Reference),
        values: template.levels[0].pixels.clone(),
        range: [0.0, 255.0],
        framed: Vec::new(),
    }
}

/// The errors of all iterations of the frame so far.
fn errors_of(at: &At<'_, TemplateTracker>) -> Option<Series> {
    let of = |(i, event): (usize, &&Event)| match event {
        Event::Iterated(iteration) => Some((i + 1, iteration.clone())),
        _ => None,
    };
    let all: Vec<_> = at.events.iter().enumerate().filter_map(of).collect();
    let section = |iteration: &Iteration| match iteration.is_correction {
        true => "drift correction".to_owned(),
        false => format!("level {}", iteration.level),
    };
    let series = errors(all.iter().map(|(_, iteration)| (section(iteration), iteration.compared.rms)))?;
    Some(Series { events: all.iter().map(|(event, _)| *event).collect(), ..series })
}

/// Draws the outline of a template under a warp.
fn path(scene: &mut Scene, (role, meaning): (Role, &'static str), (warp, size): (&Matrix3, (usize, usize))) {
    scene.mark(Picture::CURRENT, role, Shape::Path { points: outline(warp, size), closed: true });
    scene.legend(role, meaning);
}

/// Draws the absolute difference of frame and warped template.
fn heat(scene: &mut Scene, (frame, template): (&Pyramid, &Template), (level, warp): (usize, &Matrix3)) {
    let (of_level, image, (width, height)) = (&template.levels[level], &frame[level], frame[0].size());
    let Some(back) = inverse(&of_level.on_level(warp)) else { return };
    let corners: Vec<_> = outline(warp, template.size()).into_iter().map(|at| at.map(f64::from)).collect();
    let Some(Bounds { min, max }) = polygon::bounds(&corners) else { return };
    let first = min.map(|c| c.ceil().max(0.0) as usize);
    let end = [0, 1].map(|i| ((max[i].floor() + 1.0).max(0.0) as usize).min([width, height][i]));
    if (0..2).any(|i| first[i] >= end[i]) {
        return;
    }
    let scale = f64::from(1u32 << level);
    let values = Grid::from_fn(end[0] - first[0], end[1] - first[1], |x, y| {
        let at = [(first[0] + x) as f64 / scale, (first[1] + y) as f64 / scale];
        let Some([u, v]) = mapped(&back, at) else { return f32::NAN };
        let [x, y] = at.map(|c| c as f32);
        (Sampling::Bilinear.sample_inside(&of_level.pixels, u as f32, v as f32) - image.sample(x, y)).abs()
    });
    scene.mark(Picture::CURRENT, Role::Error, Shape::Heat { origin: first.map(|c| c as f32), values });
    scene.legend(Role::Error, "absolute difference after warping");
    scene.heat = Some("gray levels");
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::data::Frame;
    use crate::methods::region::RegionModel as _;
    use crate::products::Region;

    /// A texture of waves, shifted.
    fn frame([dx, dy]: [f32; 2]) -> Arc<Frame> {
        let wave = |x: usize, y: usize| {
            let (x, y) = (x as f32 - dx, y as f32 - dy);
            (128.0 + 50.0 * (x / 5.0).sin() * (y / 6.0).cos() + 40.0 * ((x + 2.0 * y) / 9.0).sin()) as u8
        };
        Arc::new(Frame::gray(Grid::from_fn(90, 80, wave)))
    }

    #[test]
    fn the_landscapes_have_the_values_of_the_alignment() {
        let tracker = TemplateTracker::default();
        let region = Region { center: [44.0, 40.0], size: [31.0, 25.0], angle_rad: 0.0 };
        let (mut model, _) = tracker.begin(&frame([0.0; 2]), region, &mut ());
        let (before, mut events) = (model.clone(), Vec::<Event>::new());
        tracker.follow(&mut model, &frame([2.3, -1.4]), region, &mut events);
        let (mut levels, mut judged) = (0, 0);
        for (i, event) in events.iter().enumerate() {
            let all = events[..=i].iter().collect();
            let at = At { model: Some(&before), region, events: all, event, pose: None, poses: Box::new(|_| None) };
            match event {
                Event::Iterated(iteration) => {
                    let surface = tracker.valley(&at, iteration);
                    assert_eq!(surface.trail.len(), iteration.number + 1);
                    // The first warp of a level stands in the middle of a cell.
                    if iteration.number == 1 {
                        assert_eq!(surface.interpolated(surface.trail[0]), Some(iteration.compared.rms as f32));
                        levels += 1;
                    }
                    let [from, to] = [surface.trail[0], surface.trail[iteration.number]];
                    let is_far = (to[0] - from[0]).hypot(to[1] - from[1]) > 1.0;
                    let [high, low] = [from, to].map(|at| surface.interpolated(at));
                    assert!(!is_far || iteration.end.is_none() || low < high, "{high:?} to {low:?}");
                }
                Event::Judged(alignment) => {
                    let surface = tracker.correlations(alignment);
                    assert_eq!(surface.interpolated([0.0; 2]), Some(alignment.correlation as f32));
                    assert_eq!(surface.optimum().map(|(_, at)| at), Some(vec![[0; 2]]));
                    judged += 1;
                }
                _ => {}
            }
        }
        assert!(levels > 2 && judged == 1, "{levels} levels, {judged} judged");
    }
}
