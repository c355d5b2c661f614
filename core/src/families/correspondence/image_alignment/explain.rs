//! The explanation and the drawing of image alignment.

use super::{Event, ImageAlignment, Stage, State, line};
use crate::geometry::Grid;
use crate::methods::alignment::explain::{hessian, parameter_vectors};
use crate::methods::alignment::{self, difference, places, rank};
use crate::products::Model;
use crate::products::metrics;
use crate::products::model::{IDENTITY, Matrix3, mapped};
use crate::run::Seen;
use crate::scene::{Decimals, Matrix, Name, Picture, Readout, Role, Scene, Series, Shape, Step, Tile, Unit};
use crate::{cases, variables};

/// Mean endpoint error in px from which an alignment is called wrong.
const WRONG_PX: f64 = 0.5;

variables! { pub(super) mod value;
    /// The group of transformations that the warp belongs to.
    MODEL: "Model", "", Unit::WHOLE;
    /// The number of parameters of the warp.
    PARAMETERS: "Parameters", "", Unit::count("parameter");
    /// The number of pyramid levels.
    LEVELS: "Levels", "", Unit::count("level");
    /// The pyramid level; level 0 has the full resolution.
    LEVEL: "Level", "", Unit::WHOLE;
    /// The number of iterations so far.
    ITERATIONS: "Iterations", "", Unit::count("");
    /// The largest number of iterations on a level.
    MAX_ITERATIONS: "Largest number of iterations", "", Unit::count("iteration");
    /// The root mean square difference of frame t and the warped frame t+1.
    RMS: "Error (RMS)", r"\text{RMS}", Unit::GRAY, Role::Error;
    /// The RMS difference before the last update.
    RMS_BEFORE: "Error before", "", Unit::GRAY;
    /// The RMS difference of the frames as they are.
    RMS_AT_REST: "Error without motion", "", Unit::GRAY;
    /// The RMS difference of the frames under the final warp.
    RMS_ALIGNED: "Error of the alignment", "", Unit::GRAY;
    /// The share of the pixels that the warp keeps inside frame t+1.
    OVERLAP: "Overlap", "", Unit::PERCENT;
    /// The overlap below which the alignment has diverged.
    MIN_OVERLAP: "Smallest overlap", "", Unit { name: "%", decimals: Decimals::AtMost(4) };
    /// The farthest motion of a corner of the picture by the increment.
    MOVED: "Largest corner motion", "", Unit::SUBPIXEL, Role::Estimate;
    /// The corner motion from which on the iterations go on.
    EPSILON: "Stopping criterion", r"\epsilon", Unit::SUBPIXEL;
    /// The rank of the Hessian.
    RANK: "Rank", "", Unit::WHOLE;
    /// The displacement of the centre of the picture by the final warp.
    CENTER_MOTION: "Motion of the centre", "", Unit::SUBPIXEL, Role::Result;
    /// The mean endpoint error over all pixels.
    ENDPOINT_ERROR: "Mean endpoint error", "", Unit::SUBPIXEL;
}

cases! { pub(super) over value;
    OPENING: "Image alignment fits one warp ({model}) to all gray levels, from the coarsest of {levels} to full resolution.",
    STEEPEST_DESCENT: "Level {level}: the steepest-descent images show how each pixel of frame t changes with each of the {parameters}. They \
                       belong to the fixed frame t, so they are computed once for all iterations of the level.",
    HESSIAN: "The Hessian, in the Gauss–Newton approximation, holds the sums of products of the {parameters:bare} steepest-descent images. It is \
              invertible: the texture determines all parameters.",
    SINGULAR: "The Hessian is {rejected|singular}: it has rank {rank}, and {parameters} need rank {parameters:bare}. The texture of level {level} \
               does not determine all of them; a model with fewer degrees of freedom may still fit.",
    WARPED: "Warping frame t+1 toward frame t leaves an RMS difference of {rms} over the {overlap} of the pixels that stay inside the frame.",
    DIVERGED: "The warp keeps {overlap} of the pixels inside the frame, below the minimum of {min_overlap}: the alignment has {rejected|diverged}, \
               and the last update is undone.",
    STALLED: "The error no longer falls; it stays at {rms}: ",
    WORSE: "The error has risen from {rms_before:bare} to {rms}: ",
    UNDONE: "{rejected|the last update is undone}, and the level ends with the warp before it.",
    SOLVED: "Solving H Δp = b gives the increment. Its warp moves the corners by at most {moved}.",
    PARTIAL: "H and b are the sums over the {overlap} of the pixels that the warp keeps inside the frame.",
    UNDETERMINED: "The {overlap} of the pixels inside the frame have a {rejected|singular Hessian} of rank {rank}, and {parameters} need rank \
                   {parameters:bare}: their texture does not determine the increment, and the level ends with the present warp.",
    UPDATED: "The increment is applied to frame t, so its inverse is composed with the warp of frame t+1. It moved a corner by {moved}, more than ε = \
              {epsilon}: another iteration.",
    CONVERGED: "The increment moves the corners by at most {moved} ≤ ε = {epsilon}: level {level} has converged.",
    EXHAUSTED: "The increment still moves a corner by {moved}, but {max_iterations} are done: level {level} ends.",
    NO_TEXTURE: "End of the run: no level has texture for {parameters}; on level {level} it determines {rank}, so the motion of the picture remains \
                 unknown.",
    NO_UPDATE: "End of the run: no level has found an update, so the motion of the picture remains unknown.",
    ALIGNED: "End of the run after {iterations} iterations: the centre of the picture moves by {center_motion}. The RMS difference has gone from \
              {rms_at_rest:bare} to {rms_aligned}.",
    AGAINST_TRUTH: "Mean endpoint error over all pixels: {endpoint_error}.",
    SOME_FAILED: "Some levels found no alignment: fewer degrees of freedom or fewer levels would help.",
    UNEXPLAINED: "The residual stays large: parallax, moving objects or a change of light, which no single warp explains, or a motion too large for \
                  the coarsest level, for which more levels would help.",
    TOO_RIGID: "The residual stays large: a model with more degrees of freedom, or more levels for larger motion, would help.",
    PULLED_AWAY: "The squared differences of objects with another motion pulled the warp away from the true one. Global motion leaves such matches \
                  out as outliers.",
    EXPLAINED: "One warp explains the motion; the places that still differ move on their own or are new.",
    MODEL: "{model}, {parameters}",
}

impl ImageAlignment {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let model = value::MODEL.is(self.model.label().to_lowercase());
        let Some(Event { stage, state }) = seen.events.last() else {
            let step = Step::at(line::START).put_value(model).put(value::LEVELS, seen.before.fixed.levels.len());
            return step.say(case::OPENING);
        };
        let at = |line| {
            let step = Step::at(line).put(value::PARAMETERS, self.model.freedom());
            Self::progress(step.fact_as(model.clone(), case::MODEL), state)
        };
        let step = self.tell_stage(*stage, state, at);
        let step = match seen.after.filter(|after| after.is_over && state.level == 0) {
            Some(after) => self.conclude(step, after),
            None => step,
        };
        self.add_charts(step, *stage, state)
    }

    /// Adds the level, the iterations and, once they are known, error and increment.
    fn progress(step: Step, state: &State) -> Step {
        let compared = state.compared.as_ref();
        let step = step.fact(value::LEVEL, state.level).fact(value::ITERATIONS, state.errors.len());
        let step = step.fact_if(value::RMS, compared.map(|compared| compared.rms));
        let step = step.fact_if(value::OVERLAP, compared.map(|compared| 100.0 * compared.overlap));
        step.fact_if(value::MOVED, state.increment.as_ref().map(|increment| increment.moved_px))
    }

    fn tell_stage(&self, stage: Stage, state: &State, at: impl Fn(Name) -> Step) -> Step {
        let rank = |hessian: &[f64]| rank(hessian, self.model.freedom());
        const RMS: &str = r"\text{RMS} = \sqrt{\frac{1}{N} \sum_x (I(W(x)) - T(x))^2} = {rms:unit}";
        const INCREMENT: &str = r"\mathbf{H} \, \Delta p = \mathbf{b} = \sum_x \mathbf{D}^\top (I(W(x)) - T(x))";
        const HESSIAN: &str = r"\mathbf{H} = \sum_x \mathbf{D}^\top \mathbf{D}";
        const UPDATE: &str = r"W \gets W \circ W(\Delta p)^{-1}";
        match stage {
            Stage::SteepestDescent => {
                let images = match self.model {
                    Model::Translation => r"(T_x, T_y)",
                    Model::Rigid => r"(T_y \, x - T_x \, y, T_x, T_y)",
                    Model::Similarity => r"(T_x \, x + T_y \, y, T_y \, x - T_x \, y, T_x, T_y)",
                    Model::Affine => r"(T_x \, x, T_x \, y, T_x, T_y \, x, T_y \, y, T_y)",
                    Model::Homography => {
                        r"(T_x \, x, T_x \, y, T_x, T_y \, x, T_y \, y, T_y, -(T_x \, x + T_y \, y) \, x, -(T_x \, x + T_y \, y) \, y)"
                    }
                };
                let definition = r"\mathbf{D} = \nabla T \cdot \frac{\partial W}{\partial p} = ";
                at(line::STEEPEST_DESCENT).say(case::STEEPEST_DESCENT).formula(definition.to_owned() + images)
            }
            Stage::Hessian => at(line::HESSIAN).say(case::HESSIAN).formula(HESSIAN),
            Stage::Singular => {
                at(line::HESSIAN).put(value::RANK, rank(&state.hessian)).say(case::SINGULAR).formula(HESSIAN)
            }
            Stage::Warp => at(line::WARP).say(case::WARPED).formula(RMS),
            Stage::Diverged => {
                let step = at(line::STEP_BACK).put(value::MIN_OVERLAP, 100.0 * self.min_overlap);
                step.say(case::DIVERGED).formula(RMS)
            }
            Stage::Worse { before } => {
                let step = at(line::STEP_BACK).put(value::RMS_BEFORE, before);
                let text = |of| step.value(of).map(|rms| rms.bare());
                let is_stalled = text(value::RMS) == text(value::RMS_BEFORE);
                step.say(if is_stalled { case::STALLED } else { case::WORSE }).say(case::UNDONE).formula(RMS)
            }
            Stage::Solve => {
                let step = at(line::SOLVE).say(case::SOLVED);
                let is_partial = step.real(value::OVERLAP) < 100.0;
                step.say_if(is_partial, case::PARTIAL).formula(INCREMENT)
            }
            Stage::Undetermined => {
                let inside = state.compared.as_ref().map_or(0, |compared| rank(&compared.hessian));
                at(line::SOLVE).put(value::RANK, inside).say(case::UNDETERMINED).formula(INCREMENT)
            }
            Stage::Update => at(line::UPDATE).put(value::EPSILON, self.epsilon).say(case::UPDATED).formula(UPDATE),
            Stage::Converged => {
                at(line::UNTIL_CONVERGED).put(value::EPSILON, self.epsilon).say(case::CONVERGED).formula(UPDATE)
            }
            Stage::Exhausted => {
                let step = at(line::UNTIL_CONVERGED).put(value::MAX_ITERATIONS, self.iterations);
                step.say(case::EXHAUSTED).formula(UPDATE)
            }
        }
    }

    fn conclude(&self, step: Step, after: &State) -> Step {
        let model = after.model(self.model);
        if model.matrix.is_none() {
            let step = step.put(value::RANK, rank(&after.hessian, self.model.freedom()));
            return step.say(if after.errors.is_empty() { case::NO_TEXTURE } else { case::NO_UPDATE });
        }
        let (width, height) = after.fixed.pair[0].size();
        let middle = [width, height].map(|extent| (extent as f64 - 1.0) / 2.0);
        let to = mapped(&after.matrix, middle).unwrap_or(middle);
        let [at_rest, aligned] = [&IDENTITY, &after.matrix].map(|warp| difference_rms(after, warp));
        let truth = after.fixed.truth.as_deref();
        let error = truth.and_then(|truth| metrics::flow_error(&model.displacements_of_pixels(), truth).ok().flatten());
        let step = step.put(value::CENTER_MOTION, [0, 1].map(|i| to[i] - middle[i])).put(value::RMS_AT_REST, at_rest);
        let step = step.put(value::RMS_ALIGNED, aligned).say(case::ALIGNED);
        let step = match error {
            Some(error) => step.put(value::ENDPOINT_ERROR, error.epe_px).say(case::AGAINST_TRUTH),
            None => step,
        };
        step.say(match (after.failed > 0, self.model, aligned > 0.5 * at_rest && at_rest > 1.0) {
            (true, ..) => case::SOME_FAILED,
            (_, Model::Homography, true) => case::UNEXPLAINED,
            (.., true) => case::TOO_RIGID,
            _ if error.is_some_and(|error| error.epe_px > WRONG_PX) => case::PULLED_AWAY,
            _ => case::EXPLAINED,
        })
    }

    /// Adds the pictures, the matrices and the plot of a step.
    fn add_charts(&self, step: Step, stage: Stage, state: &State) -> Step {
        let step = step.show(Readout::Tiles(match stage {
            Stage::SteepestDescent | Stage::Hessian | Stage::Singular => {
                alignment::explain::steepest_descent(&self.aligner(state))
            }
            _ => compared(state),
        }));
        step.show(Readout::Matrices(self.matrices(stage, state))).show_all(plot(state).map(Readout::Series))
    }

    fn matrices(&self, stage: Stage, state: &State) -> Vec<Matrix> {
        let warp = || Matrix::of_rows("W", "warp, px of the picture", &state.matrix).with_role(Role::Result);
        match (stage, &state.compared, &state.increment) {
            (Stage::Hessian | Stage::Singular, ..) => vec![hessian(self.model, &state.hessian)],
            (Stage::Solve, Some(compared), Some(increment)) => {
                parameter_vectors(self.model, &compared.right, &increment.parameters).into()
            }
            (Stage::Update | Stage::Converged | Stage::Exhausted, _, Some(increment)) => {
                let of_increment = Matrix::of_rows("ΔW", "warp of the increment, px of the level", &increment.matrix);
                vec![of_increment.with_role(Role::Estimate), warp()]
            }
            _ => vec![warp()],
        }
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let Some(Event { stage, state }) = seen.events.last() else { return };
        let (width, height) = state.fixed.pair[0].size();
        let [right, bottom] = [width, height].map(|extent| extent as f64 - 0.5);
        let corners = [[-0.5, -0.5], [right, -0.5], [right, bottom], [-0.5, bottom]];
        let outline: Vec<[f32; 2]> =
            corners.iter().filter_map(|at| mapped(&state.matrix, *at)).map(|at| at.map(|c| c as f32)).collect();
        if seen.after.is_some_and(|after| after.is_over) {
            let values = seen.after.map_or(state.model(self.model), |after| after.model(self.model));
            scene.draw(
                Picture::CURRENT,
                (Role::Result, "displacement by the warp"),
                Shape::Flow { origin: [0.0; 2], values: values.displacements_of_pixels().0 },
            );
        } else if state.compared.is_some() && matches!(stage, Stage::Warp | Stage::Diverged | Stage::Worse { .. }) {
            scene.draw(Picture::CURRENT, (Role::Error, "absolute difference after warping"), error_picture(state));
            scene.heat = Some("gray levels");
        }
        scene.draw(Picture::NEXT, (Role::Estimate, "frame t, warped into frame t+1"), Shape::outline(outline));
    }
}

/// The RMS difference of both frames at full resolution under a warp; NaN where they do not overlap.
fn difference_rms(state: &State, warp: &Matrix3) -> f64 {
    let [template, image] = &state.fixed.levels[0].pictures;
    let differences = places(template).filter_map(|place| difference([template, image], warp, place));
    let (squares, count) =
        differences.fold((0.0, 0usize), |(squares, count), value| (squares + f64::from(value * value), count + 1));
    (squares / count as f64).sqrt()
}

/// The absolute difference of the current level, over the whole picture.
fn error_picture(state: &State) -> Shape {
    let ([template, image], warp) = (&state.level().pictures, state.warp());
    let (width, height) = state.fixed.pair[0].size();
    let nearest = |c: usize, extent: usize| ((c + (1 << state.level) / 2) >> state.level).min(extent - 1);
    let values = Grid::from_fn(width, height, |x, y| {
        let place = (nearest(x, template.width()), nearest(y, template.height()));
        difference([template, image], &warp, place).map_or(f32::NAN, f32::abs)
    });
    Shape::heat(values)
}

/// Frame t, the warped frame t + 1, and their difference, on the current level.
fn compared(state: &State) -> Vec<Tile> {
    let [template, image] = &state.level().pictures;
    // The warp that was compared: an update comes after it.
    alignment::explain::compared("frame t", [template, image], &state.warp())
}

/// The error over the iterations, in a section for each level.
fn plot(state: &State) -> Option<Series> {
    alignment::explain::errors(state.errors.iter().map(|(level, rms)| (format!("level {level}"), *rms)))
}
