//! The explanation and the drawing of image alignment.

use super::{Event, ImageAlignment, Stage, State, line};
use crate::base::words::{counted, fixed, percent};
use crate::geometry::Grid;
use crate::methods::alignment::explain::{hessian, parameters, warp_matrix};
use crate::methods::alignment::{self, difference, places, rank};
use crate::methods::differential::numbers;
use crate::products::Model;
use crate::products::metrics;
use crate::products::model::{Matrix3, mapped};
use crate::run::Seen;
use crate::scene::{Fact, Math, Matrix, Picture, Readout, Role, Scene, Sentence, Series, Shape, Step, Tile};

fn px(length: f64) -> String {
    format!("{} px", fixed(length, 3))
}

fn gray(value: f64) -> String {
    format!("{} gray levels", fixed(value, 2))
}

/// Mean endpoint error in px from which on an alignment is called wrong.
const WRONG_PX: f64 = 0.5;

impl ImageAlignment {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let Some(Event { stage, state }) = seen.events.last() else {
            let levels = seen.before.fixed.levels.len();
            let said = format!(
                "Image alignment fits one warp ({}) to all gray levels, from the coarsest of {levels} levels to full resolution.",
                self.model.label().to_lowercase()
            );
            return Step {
                values: Vec::new(),
                line: line::START,
                sentence: Sentence::default().text(said),
                readouts: Vec::new(),
            };
        };
        let line = match stage {
            Stage::SteepestDescent => line::STEEPEST_DESCENT,
            Stage::Hessian | Stage::Singular => line::HESSIAN,
            Stage::Warp => line::WARP,
            Stage::Diverged | Stage::Worse => line::STEP_BACK,
            Stage::Solve | Stage::Undetermined => line::SOLVE,
            Stage::Update => line::UPDATE,
            Stage::Converged => line::UNTIL_CONVERGED,
        };
        let sentence = self.sentence(*stage, state, Sentence::default());
        let sentence = match seen.after.filter(|after| after.is_over) {
            Some(after) if seen.events.last().is_some_and(|event| event.state.level == 0) => {
                self.concluded(after, sentence)
            }
            _ => sentence,
        };
        Step { values: Vec::new(), line, sentence, readouts: self.readouts(*stage, state) }
    }

    fn sentence(&self, stage: Stage, state: &State, said: Sentence) -> Sentence {
        let compared = state.compared.as_deref();
        let (rms, overlap) = compared.map_or((0.0, 0.0), |compared| (compared.rms, compared.overlap));
        let moved = state.increment.as_ref().map_or(0.0, |increment| increment.moved_px);
        let count = self.model.freedom();
        match stage {
            Stage::SteepestDescent => said.text(format!(
                "Level {}: the steepest-descent images show how each pixel of frame t changes with each of the {count} parameters. \
                 They belong to the fixed frame t, so they are computed once for all iterations of the level.",
                state.level
            )),
            Stage::Hessian => said.text(format!(
                "The Hessian, in the Gauss–Newton approximation, holds the sums of products of the {count} steepest-descent \
                 images. It is invertible: the texture determines all parameters."
            )),
            Stage::Singular => said
                .text("The Hessian is ")
                .ink(Role::Rejected, "singular")
                .text(format!(
                    ": it has rank {}, and {count} parameters need rank {count}. The texture of level {} does not determine all of them; a model \
                     with fewer degrees of freedom may still fit.",
                    rank(&state.hessian, count),
                    state.level
                )),
            Stage::Warp => said
                .text("Warping frame t+1 toward frame t leaves an RMS difference of ")
                .ink(Role::Error, gray(rms))
                .text(format!(" over the {} of the pixels that stay inside the frame.", percent(rounded(overlap)))),
            Stage::Diverged => said
                .text(format!(
                    "The warp keeps {} of the pixels inside the frame, below the minimum of {}: the alignment has ",
                    percent(rounded(overlap)),
                    percent(self.min_overlap)
                ))
                .ink(Role::Rejected, "diverged")
                .text(", and the last update is undone."),
            Stage::Worse => {
                let previous = fixed(state.previous_error().unwrap_or(rms), 2);
                let told = match previous == fixed(rms, 2) {
                    true => format!("The error no longer falls; it stays at {}: ", gray(rms)),
                    false => format!("The error has risen from {previous} to {}: ", gray(rms)),
                };
                said.text(told).ink(Role::Rejected, "the last update is undone")
                    .text(", and the level ends with the warp before it.")
            }
            Stage::Solve => said
                .text("Solving H Δp = b gives the increment. Its warp moves the corners by at most ")
                .ink(Role::Estimate, px(moved))
                .text(match overlap < 1.0 {
                    true => format!(
                        ". H and b are the sums over the {} of the pixels that the warp keeps inside the frame.",
                        percent(rounded(overlap))
                    ),
                    false => ".".to_owned(),
                }),
            Stage::Undetermined => said
                .text(format!("The {} of the pixels inside the frame have a ", percent(rounded(overlap))))
                .ink(Role::Rejected, "singular Hessian")
                .text(format!(
                    " of rank {}, and {count} parameters need rank {count}: their texture does not determine the increment, and the level ends \
                     with the present warp.",
                    compared.map_or(0, |compared| rank(&compared.hessian, count))
                )),
            Stage::Update => said.text(format!(
                "The increment is applied to frame t, so its inverse is composed with the warp of frame t+1. It moved a corner by \
                 {}, more than ε = {}: another iteration.",
                px(moved),
                px(self.epsilon.into())
            )),
            Stage::Converged if moved <= f64::from(self.epsilon) => said.text(format!(
                "The increment moves the corners by at most {} ≤ ε = {}: level {} has converged.",
                px(moved),
                px(self.epsilon.into()),
                state.level
            )),
            Stage::Converged => said.text(format!(
                "The increment still moves a corner by {}, but {} iterations are done: level {} ends.",
                px(moved),
                self.iterations,
                state.level
            )),
        }
    }

    fn concluded(&self, after: &State, said: Sentence) -> Sentence {
        let model = after.model(self.model);
        if model.matrix.is_none() {
            return said.text(match after.errors.is_empty() {
                true => format!(
                    " End of the run: no level has texture for {}; on level {} it determines {}, so the motion of the picture remains \
                     unknown.",
                    counted(self.model.freedom(), "parameter"),
                    after.level,
                    rank(&after.hessian, self.model.freedom())
                ),
                false => " End of the run: no level has found an update, so the motion of the picture remains unknown."
                    .into(),
            });
        }
        let (width, height) = after.fixed.pair[0].size();
        let middle = [width, height].map(|extent| (extent as f64 - 1.0) / 2.0);
        let to = mapped(&after.matrix, middle).unwrap_or(middle);
        let at_rest = difference_rms(after, &crate::products::model::IDENTITY);
        let aligned = difference_rms(after, &after.matrix);
        let said = said
            .text(format!(
                " End of the run after {} iterations: the centre of the picture moves by ",
                after.errors.len()
            ))
            .ink(Role::Result, format!("{} px", numbers::vector([0, 1].map(|i| (to[i] - middle[i]) as f32))))
            .text(format!(". The RMS difference has gone from {} to {}.", fixed(at_rest, 2), gray(aligned)));
        let truth = after.fixed.truth.as_deref();
        let error = truth.and_then(|truth| metrics::flow_error(&model.displacements_of_pixels(), truth).ok().flatten());
        let said = match error {
            Some(error) => said.text(format!(" Mean endpoint error over all pixels: {} px.", fixed(error.epe_px, 3))),
            None => said,
        };
        said.text(match (after.failed > 0, self.model, aligned > 0.5 * at_rest && at_rest > 1.0) {
            (true, ..) => " Some levels found no alignment: fewer degrees of freedom or fewer levels would help.",
            (_, Model::Homography, true) => {
                " The residual stays large: parallax, moving objects or a change of light, which no single warp explains, or a motion too \
                 large for the coarsest level, for which more levels would help."
            }
            (.., true) => " The residual stays large: a model with more degrees of freedom, or more levels for larger motion, would help.",
            _ if error.is_some_and(|error| error.epe_px > WRONG_PX) => {
                " The squared differences of objects with another motion pulled the warp away from the true one. Global motion leaves such matches out as \
                 outliers."
            }
            _ => " One warp explains the motion; the places that still differ move on their own or are new.",
        })
    }

    fn readouts(&self, stage: Stage, state: &State) -> Vec<Readout> {
        let mut readouts = vec![Readout::Facts(self.facts(state)), Readout::Equation(self.equation(stage, state))];
        readouts.push(Readout::Tiles(match stage {
            Stage::SteepestDescent | Stage::Hessian | Stage::Singular => {
                alignment::explain::steepest_descent(&self.aligner(state))
            }
            _ => compared(state),
        }));
        let matrices = self.matrices(stage, state);
        readouts.extend((!matrices.is_empty()).then_some(Readout::Matrices(matrices)));
        readouts.extend(plot(state).map(Readout::Series));
        readouts
    }

    fn facts(&self, state: &State) -> Vec<Fact> {
        let mut facts = vec![
            Fact::new(
                "Model",
                format!("{}, {} parameters", self.model.label().to_lowercase(), self.model.freedom()),
                None,
            ),
            Fact::new("Level", state.level.to_string(), None),
            Fact::new("Iterations", state.errors.len().to_string(), None),
        ];
        if let Some(compared) = &state.compared {
            facts.push(Fact::new("Error (RMS)", gray(compared.rms), Some(Role::Error)));
            facts.push(Fact::new("Overlap", percent(rounded(compared.overlap)), None));
        }
        let moved = state.increment.as_ref();
        facts.extend(
            moved.map(|increment| Fact::new("Largest corner motion", px(increment.moved_px), Some(Role::Estimate))),
        );
        facts
    }

    fn equation(&self, stage: Stage, state: &State) -> Vec<Math> {
        let text = |text: &str| Math::text(text.to_owned());
        let transposed = || Math::power(Math::Bold("D"), text("T"));
        let sum = || Math::Sum(Box::new(text("x")));
        match stage {
            Stage::SteepestDescent => vec![Math::Row(vec![
                Math::Bold("D"),
                text(" = ∇T · "),
                Math::over(text("∂W"), text("∂p")),
                text(match self.model {
                    Model::Translation => " = (T_x, T_y)",
                    Model::Rigid => " = (T_y x − T_x y, T_x, T_y)",
                    Model::Similarity => " = (T_x x + T_y y, T_y x − T_x y, T_x, T_y)",
                    Model::Affine => " = (T_x x, T_x y, T_x, T_y x, T_y y, T_y)",
                    Model::Homography => {
                        " = (T_x x, T_x y, T_x, T_y x, T_y y, T_y, −(T_x x + T_y y) x, −(T_x x + T_y y) y)"
                    }
                }),
            ])],
            Stage::Hessian | Stage::Singular => {
                vec![Math::Row(vec![Math::Bold("H"), text(" = "), sum(), transposed(), Math::Bold("D")])]
            }
            Stage::Solve | Stage::Undetermined => vec![Math::Row(vec![
                Math::Bold("H"),
                text(" Δp = "),
                Math::Bold("b"),
                text(" = "),
                sum(),
                transposed(),
                text(" (I(W(x)) − T(x))"),
            ])],
            Stage::Update | Stage::Converged => vec![text("W ← W ∘ W(Δp)⁻¹")],
            Stage::Warp | Stage::Diverged | Stage::Worse => vec![Math::Row(vec![
                text("RMS = "),
                Math::root(Math::Row(vec![
                    Math::over(text("1"), Math::Var("N")),
                    sum(),
                    Math::squared(text("(I(W(x)) − T(x))")),
                ])),
                text(" = "),
                Math::ink(Role::Error, gray(state.compared.as_ref().map_or(0.0, |compared| compared.rms))),
            ])],
        }
    }

    fn matrices(&self, stage: Stage, state: &State) -> Vec<Matrix> {
        match (stage, &state.compared, &state.increment) {
            (Stage::Hessian | Stage::Singular, ..) => vec![hessian(self.model, &state.hessian)],
            (Stage::Solve, Some(compared), Some(increment)) => vec![
                parameters(self.model, ("b", "right-hand side", Role::Error), &compared.right),
                parameters(self.model, ("Δp", "increment", Role::Estimate), &increment.parameters),
            ],
            (Stage::Update | Stage::Converged, _, Some(increment)) => vec![
                warp_matrix(("ΔW", "warp of the increment, px of the level", Role::Estimate), &increment.matrix),
                warp_matrix(("W", "warp, px of the picture", Role::Result), &state.matrix),
            ],
            _ => vec![warp_matrix(("W", "warp, px of the picture", Role::Result), &state.matrix)],
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
            scene.mark(
                Picture::CURRENT,
                Role::Result,
                Shape::Flow { origin: [0.0; 2], values: values.displacements_of_pixels().0 },
            );
            scene.legend(Role::Result, "displacement by the warp");
        } else if state.compared.is_some() && matches!(stage, Stage::Warp | Stage::Diverged | Stage::Worse) {
            scene.mark(Picture::CURRENT, Role::Error, error_picture(state));
            scene.legend(Role::Error, "absolute difference after warping");
            scene.heat = Some("gray levels");
        }
        scene.mark(Picture::NEXT, Role::Estimate, Shape::Path { points: outline, closed: true });
        scene.legend(Role::Estimate, "frame t, warped into frame t+1");
    }
}

/// A share to a tenth of a percent.
fn rounded(share: f64) -> f32 {
    ((1000.0 * share).round() / 1000.0) as f32
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
    Shape::Heat { origin: [0.0; 2], values }
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
