//! The explanation of the template tracker.

use super::charts::{errors_of, heat, path, template_tile, tiles};
use super::vocabulary::{case, value};
use super::{
    Cause, Correction, End, Event, Iteration, Judged, LEAST_OVERLAP, MOST_STRETCH, Model, Stretch, Template,
    TemplateTracker, Update,
};
use crate::methods::alignment::explain::{hessian, parameter_vectors, steepest_descent};
use crate::methods::region::{At, Ending, Explained, Loss, Outcome};
use crate::scene::{Case, Matrix, Readout, Role, Scene, Step};

/// The visible share of an object from which it counts as uncovered: the rest are pixels at its outline.
const VISIBLE: f64 = 0.97;
/// The motion between two frames, as a share of the shorter side of the object, from which it counts as far for the iterations.
const FAR: f64 = 0.3;

impl Explained for TemplateTracker {
    const JUDGES_LOSS: bool = true;

    fn step(&self, at: &At<'_, Self>, step: Step) -> Step {
        let step = match at.event {
            Event::Learned(first) => {
                let (group, level) = (self.warp.group(), &first.levels[0]);
                let step = put_size(step, first).put(value::LEVELS, first.levels.len());
                let step = step.put(value::PARAMETERS, group.freedom()).say(case::LEARNED);
                let images = steepest_descent(&level.aligner(group));
                let tiles = [template_tile("template T₁", first)].into_iter().chain(images);
                step.formula(
                    r"\mathbf{H} = \sum_x \mathbf{D}^\top \mathbf{D}, \mathbf{D} = \nabla T \cdot \frac{\partial W}{\partial p}",
                )
                .show(Readout::Tiles(tiles.collect()))
                .show(Readout::Matrices(vec![hessian(group, &level.hessian)]))
            }
            Event::Iterated(iteration) => self.tell_iteration(at, iteration, step),
            Event::Judged(judged) => self.tell_verdict(judged, step),
            Event::Corrected(correction) => self.tell_correction(correction, step),
            Event::Updated([before, after]) => {
                let is_corrected = self.update == Update::Corrected;
                let step = put_size(step, after).formula(r"T(x) \gets I(W(x))");
                let tiles = vec![template_tile("template T", before), template_tile("template, updated", after)];
                step.say(if is_corrected { case::UPDATED_CORRECTED } else { case::UPDATED }).show(Readout::Tiles(tiles))
            }
        };
        step.show_all(errors_of(at).map(Readout::Series))
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

    fn tell_loss(&self, at: &At<'_, Self>, step: Step) -> Step {
        let loss = at.events.iter().rev().find_map(|event| match event {
            Event::Judged(judged) => judged.loss,
            _ => None,
        });
        match loss {
            None => step,
            Some(Cause::Outside) => step.say(case::LOST_OUTSIDE),
            Some(Cause::Warp) => step.say(case::LOST_WARP),
            Some(Cause::Correlation) => step.say(case::LOST_CORRELATION),
        }
    }

    fn advise(&self, ending: Ending, _at: &At<'_, Self>, step: Step) -> Step {
        let advice = match (ending.outcome, self.update, ending.loss) {
            (Outcome::Followed, Update::None, _) => case::FOLLOWED,
            (Outcome::Followed, Update::EveryFrame, _) => case::FOLLOWED_UPDATED,
            (Outcome::Followed, Update::Corrected, _) => case::FOLLOWED_CORRECTED,
            (_, Update::EveryFrame, _) if ending.reported == 0 => case::DRIFTED,
            (_, Update::None | Update::Corrected, _) if ending.reported == 0 => case::MISFITTED,
            (.., None) => case::UNKNOWN_CAUSE,
            (.., Some(loss)) => {
                let step = step.put(value::LOSS_FRAME, loss.frame).put(value::VISIBLE, 100.0 * loss.visibility);
                return step.put(value::LOSS_MOTION, loss.moved_px).say(cause(&loss));
            }
        };
        step.say(advice)
    }
}

/// The cause of a loss, from the truth of its first frame.
fn cause(loss: &Loss) -> &'static Case {
    match () {
        () if loss.is_leaving => case::LEAVING,
        () if loss.visibility < VISIBLE => case::COVERED,
        () if loss.moved_px > FAR * loss.side_px => case::FAR,
        () => case::CHANGED,
    }
}

fn put_size(step: Step, template: &Template) -> Step {
    let (width, height) = template.size();
    let step = step.put(value::TEMPLATE_WIDTH, width).put(value::TEMPLATE_HEIGHT, height);
    step.fact_as(value::TEMPLATE.is([width, height]), case::SIZE)
}

impl TemplateTracker {
    fn tell_iteration(&self, at: &At<'_, Self>, iteration: &Iteration, step: Step) -> Step {
        let Iteration { level, before, compared, moved, is_correction, .. } = iteration;
        let step = step.fact(value::LEVEL, *level).fact(value::ITERATION, iteration.number);
        let step =
            step.fact(value::RMS, compared.rms).fact_if(value::CORNER_MOTION, moved.as_ref().map(|moved| moved.px));
        let step = step.put(value::EPSILON, self.epsilon).put(value::ITERATIONS, self.iterations);
        let step = step.put(value::INSIDE, 100.0 * compared.overlap).put(value::MIN_INSIDE, 100.0 * LEAST_OVERLAP);
        let step = step.say(if *is_correction { case::CORRECTING } else { case::COMPARED }).say(match iteration.end {
            None => case::NOT_CONVERGED,
            Some(End::Converged) => case::CONVERGED,
            Some(End::Exhausted) => case::EXHAUSTED,
            Some(End::Worse) => case::UNDONE,
            Some(End::Outside) => case::DIVERGED,
            Some(End::Singular) => case::SINGULAR,
        });
        let mut matrices = Vec::new();
        if let Some(moved) = moved {
            matrices.extend(parameter_vectors(self.warp.group(), &compared.right, &moved.parameters));
        }
        let warp = moved.as_ref().map_or(before, |moved| &moved.after);
        matrices.push(Matrix::of_rows("W", "warp, px of the picture", warp).with_role(Role::Result));
        let label = if *is_correction { "template T₁" } else { "template T" };
        step.formula(
            r"\mathbf{H} \, \Delta p = \mathbf{b} = \sum_x \mathbf{D}^\top (I(W(x)) - T(x)), \quad W \gets W \text{ ∘ } W(\Delta p)^{-1}",
        )
        .show(Readout::Tiles(tiles(label, (&iteration.frame, &iteration.template), (*level, before))))
        .show(Readout::Matrices(matrices))
        .show(Readout::Landscape(self.valley(at, iteration)))
    }

    fn tell_verdict(&self, judged: &Judged, step: Step) -> Step {
        let Stretch { largest, smallest, most } = judged.stretch;
        let step = step.fact(value::CORRELATION, judged.correlation).fact(value::INSIDE, 100.0 * judged.overlap);
        let step = step.put(value::MIN_INSIDE, 100.0 * LEAST_OVERLAP).put(value::MIN_CORRELATION, self.min_correlation);
        let step = step.put(value::SMALLEST, smallest).put(value::LARGEST, largest).put(value::MAX_RATIO, MOST_STRETCH);
        let step = step.put(value::MIN_STRETCH, 1.0 / most).put(value::MAX_STRETCH, most);
        let step = match judged.loss {
            Some(Cause::Outside) => step.say(case::OUTSIDE),
            Some(Cause::Warp) => {
                let limit = if judged.stretch.is_beyond() { case::BEYOND } else { case::UNEQUAL };
                step.say(case::STRETCHED).say(limit).say(case::FAILED)
            }
            Some(Cause::Correlation) => step.say(case::CORRELATED).say(case::REJECTED),
            None => step.say(case::CORRELATED).say(case::ACCEPTED),
        };
        step.formula(
            r"\rho = \frac{\sum_x (I(W(x)) - \bar{I})(T(x) - \bar{T})}{\sqrt{\sum_x (I(W(x)) - \bar{I})^2 \, \sum_x (T(x) - \bar{T})^2}} = {correlation}",
        )
        .show(Readout::Landscape(self.correlations(judged)))
        .show(Readout::Tiles(tiles("template T", (&judged.frame, &judged.template), (0, &judged.warp))))
    }

    fn tell_correction(&self, correction: &Correction, step: Step) -> Step {
        let [warp, corrected] = &correction.warps;
        let step = step.fact(value::DRIFT, correction.px).put(value::MAX_DRIFT, self.max_correction);
        let verdict = if correction.is_accepted { case::CORRECTED } else { case::NOT_CORRECTED };
        step.say(case::REALIGNED)
            .say(verdict)
            .formula(r"\max_i |\text{W*}(x_i) - W(x_i)| = {drift:unit}")
            .show(Readout::Tiles(tiles("template T₁", (&correction.frame, &correction.first), (0, corrected))))
            .show(Readout::Matrices(vec![
                Matrix::of_rows("W", "warp, px of the picture", warp).with_role(Role::Predicted),
                Matrix::of_rows("W*", "warp of T₁, px of the picture", corrected).with_role(Role::Estimate),
            ]))
    }
}
