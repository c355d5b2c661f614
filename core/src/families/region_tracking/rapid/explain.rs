//! The explanation and the drawing of RAPiD.

use super::account::{Count, Past, PoseError, length, tell};
use super::fit::{FREEDOM, Sought, matched};
use super::vocabulary::{case, value};
use super::{Cause, End, Event, Iteration, Judged, Model, Motion, Prediction, Rapid, Solid, View, Weighting};
use crate::data::Pose;
use crate::geometry::{Bounds, Grid};
use crate::methods::region::vocabulary::case as shared;
use crate::methods::region::{At, Ending, Explained, Outcome};
use crate::scene::{Arrow, Case, Matrix, Picture, Readout, Role, Scene, Series, Shape, Step};

/// The rows of the six parameters.
const PARAMETERS: [&str; FREEDOM] = ["θ_x", "θ_y", "θ_z", "Δ_x", "Δ_y", "Δ_z"];

/// The projection of a point m of the model.
const PROJECTION: &str =
    r"u = f \, \frac{X}{Z}, \quad v = f \, \frac{Y}{Z}, \quad (X, Y, Z) = \mathbf{R} \, \mathbf{m} + \mathbf{T}";

/// Turn about the vertical axis of the model, tilt towards the camera, and roll about the optical axis, in rad.
fn angles(pose: &Pose) -> [f64; 3] {
    let r = &pose.rotation;
    [(-r[2][0]).atan2(r[2][2]), r[2][1].clamp(-1.0, 1.0).asin(), (-r[0][1]).atan2(r[1][1])]
}

/// The standard deviations of the parameters: of the rotation in rad, of the translation in m.
fn deviations(covariance: &[f64]) -> [f64; FREEDOM] {
    std::array::from_fn(|i| covariance.get(i * FREEDOM + i).map_or(0.0, |variance| variance.max(0.0).sqrt()))
}

impl Explained for Rapid {
    fn step(&self, at: &At<'_, Self>, step: Step) -> Step {
        let step = match at.event {
            Event::Placed(view) => {
                let solid = match self.solid {
                    Solid::Box => "box",
                    Solid::Cylinder => "cylinder",
                };
                let step = step.fact(value::FOCAL_LENGTH, view.camera.focal).put(value::SOLID, solid);
                let step = step.put(value::MODEL_WIDTH, self.model_width).put(value::MODEL_HEIGHT, self.model_height);
                let step = pose_facts(step.put(value::MODEL_DEPTH, self.model_depth), Role::Reference, &view.pose);
                let pose = pose_matrix("initial pose of the model", Role::Reference, &view.pose);
                step.say(case::PLACED).formula(PROJECTION).show(Readout::Matrices(vec![pose]))
            }
            Event::Predicted([before, after]) => {
                let is_first = at.model.is_some_and(|model| model.motion == Motion::default());
                let motion = before.pose.motion_to(&after.pose);
                let step = put_motion(pose_facts(step, Role::Predicted, &after.pose), Role::Predicted, &motion);
                step.say(if is_first { case::NO_MOTION } else { case::PREDICTED }).show(Readout::Matrices(vec![
                    pose_matrix("last pose", Role::Reference, &before.pose),
                    pose_matrix("predicted pose", Role::Predicted, &after.pose),
                ]))
            }
            Event::Iterated(iteration) => self.tell_iteration(step, iteration),
            Event::Judged(judged) => self.tell_verdict(step, judged, error(at)),
        };
        step.show_all(distances(at).map(Readout::Series))
    }

    fn draw(&self, at: &At<'_, Self>, scene: &mut Scene) {
        if at.model.is_none() {
            scene.work = at.event.view().bounds().map(|bounds| [bounds.min, bounds.max]);
        }
        match at.event {
            Event::Placed(view) => wireframe(scene, (Role::Best, "projected model"), view),
            Event::Predicted([before, after]) => {
                wireframe(scene, (Role::Rejected, "model at the last pose"), before);
                wireframe(scene, (Role::Predicted, "model at the predicted pose"), after);
            }
            Event::Iterated(iteration) => {
                wireframe(scene, (Role::Rejected, "model before the iteration"), &iteration.view);
                searches(scene, &iteration.sought);
                if let Some((_, pose, _)) = &iteration.moved {
                    wireframe(scene, (Role::Best, "refitted model"), &iteration.view.at(*pose));
                }
            }
            Event::Judged(judged) => {
                searches(scene, &judged.sought);
                wireframe(scene, (Role::Best, "refitted model"), &judged.view);
            }
        }
    }

    fn draw_result(&self, model: &Model, scene: &mut Scene) {
        if !model.result.is_lost {
            wireframe(scene, (Role::Best, "refitted model"), &model.view);
        }
    }

    fn work(&self, model: &Model) -> Option<Bounds> {
        model.view.bounds()
    }

    fn open(&self, step: Step) -> Step {
        step.say(case::OPENING)
    }

    fn tell_loss(&self, at: &At<'_, Self>, step: Step) -> Step {
        let Event::Judged(judged) = at.event else { return step };
        match judged.loss {
            Some(cause) => step.say(cause.cases()[1]),
            None => step,
        }
    }

    fn tell_summary(&self, at: &At<'_, Self>, step: Step) -> Step {
        tell(step, &past(at), &at.poses)
    }

    fn tell_caveat(&self, at: &At<'_, Self>, step: Step) -> Step {
        match error(at).filter(PoseError::is_wrong) {
            Some(error) => put_error(step, &error).say(case::WRONG_POSE),
            None => step,
        }
    }

    fn advise(&self, ending: Ending, at: &At<'_, Self>, step: Step) -> Step {
        let has_failures = Count::of(&past(at), &at.poses).is_some_and(|count| count.has_failures());
        let is_followed = ending.outcome == Outcome::Followed && ending.reported == 0 && !has_failures;
        let step = step.say(match (is_followed, self.pose_prediction) {
            (true, _) => case::FOLLOWED,
            (false, Prediction::None) => case::UNPREDICTED,
            (false, Prediction::ConstantVelocity) => case::MISPREDICTED,
        });
        // A wrong pose has its own sentence above.
        match error(at).filter(|error| !error.is_wrong()) {
            Some(error) => put_error(step, &error).say(case::LAST_POSE),
            None => step,
        }
    }
}

impl Rapid {
    fn tell_iteration(&self, step: Step, iteration: &Iteration) -> Step {
        let (equations, view) = (&iteration.equations, &iteration.view);
        let step = self.put_search(step.fact(value::ITERATION, iteration.number), &iteration.sought);
        let rms = (equations.edges > 0).then_some(equations.rms);
        let step = step.fact_if(value::RMS, rms).say(if rms.is_some() { case::SEARCHED } else { case::NO_EDGES });
        let (weight, normal) = (self.weight(), self.normal_matrix(view));
        let formula = format!(r"({normal}) \, (\theta, \Delta) = \sum_i {weight} \mathbf{{c}}_i \, l_i");
        // Parameters in units that move control points alike: degrees and centimetres.
        let unit = |i: usize| if i < 3 { 1f64.to_radians() } else { 0.01 };
        let entry = |x: usize, y: usize| equations.matrix[y * FREEDOM + x] * unit(x) * unit(y);
        let matrix = of_parameters("C", "normal matrix, in px² per ° and cm", entry).with_role(Role::Measured);
        let Some((motion, pose, moved)) = &iteration.moved else {
            return step.say(case::UNDETERMINED).formula(formula).show(Readout::Matrices(vec![matrix]));
        };
        let step = put_motion(pose_facts(step, Role::Estimate, pose), Role::Estimate, motion);
        let is_held = view.sight().axis.is_some();
        let step = step.say(match self.weighting {
            Weighting::Equal => case::EQUAL,
            Weighting::Robust => case::ROBUST,
        });
        let step = step.say(if is_held { case::HELD } else { case::FREE }).say(case::SOLVED);
        let step = step.put(value::EPSILON, self.epsilon).put(value::MOVED, *moved).say(match iteration.end {
            Some(End::Converged) => case::CONVERGED,
            Some(End::Exhausted | End::Undetermined) => case::EXHAUSTED,
            None => case::MOVED,
        });
        let pose = pose_matrix("pose after the iteration", Role::Estimate, pose);
        step.formula(formula).show(Readout::Matrices(vec![matrix, pose]))
    }

    fn tell_verdict(&self, step: Step, judged: &Judged, error: Option<PoseError>) -> Step {
        let residual = if judged.residual_px.is_nan() {
            value::RESIDUAL.is("undefined: no edge was found")
        } else {
            value::RESIDUAL.is(judged.residual_px)
        };
        let step = pose_facts(step, Role::Estimate, &judged.view.pose).fact_of(residual);
        let step = self.put_search(step, &judged.sought).say(case::POSE);
        let mut matrices = vec![pose_matrix("pose of the model", Role::Estimate, &judged.view.pose)];
        matrices.extend(judged.covariance.as_deref().map(covariance_matrix));
        let step = match &judged.covariance {
            Some(covariance) => put_deviations(step, covariance),
            None => step,
        };
        let step = step.fact_if(value::AXIS, judged.view.sight().axis.map(|_| "held"));
        let step = step.put(value::SHARE, judged.share).put(value::MIN_SHARE, self.min_share);
        let step = step.put(value::MAX_RESIDUAL, self.max_residual);
        let step = match judged.loss {
            Some(cause) => step.say(cause.cases()[0]),
            None => step,
        };
        let step = match error {
            Some(error) => step.fact(value::ROTATION_ERROR, error.degrees).fact(value::TRANSLATION_ERROR, error.mm),
            None => step,
        };
        let normal = self.normal_matrix(&judged.view);
        step.formula(format!(r"\mathbf{{P}} = \sigma^2 \, ({normal})^{{-1}}")).show(Readout::Matrices(matrices))
    }

    /// Adds the control points with an edge.
    fn put_search(&self, step: Step, sought: &[Sought]) -> Step {
        let step = step.put(value::CONTROL_POINTS, sought.len()).put(value::SEARCH_RANGE, self.search_range);
        step.fact_as(value::MATCHED.is(matched(sought)), case::MATCHED)
    }

    /// The weight of an edge, where the weights are robust.
    fn weight(&self) -> &'static str {
        match self.weighting {
            Weighting::Equal => "",
            Weighting::Robust => "w_i",
        }
    }

    /// The normal matrix: with a where a rotation is held.
    fn normal_matrix(&self, view: &View) -> String {
        let held = view.sight().axis.map_or("", |_| r" + \lambda \, \mathbf{a} \mathbf{a}^\top");
        format!(r"\sum_i {} \mathbf{{c}}_i \mathbf{{c}}_i^\top{held}", self.weight())
    }
}

impl Cause {
    /// The cause as a sentence, and as a clause.
    fn cases(self) -> [&'static Case; 2] {
        match self {
            Self::Undetermined => [case::LOST_UNDETERMINED, case::WHY_UNDETERMINED],
            Self::Edges => [case::LOST_EDGES, case::WHY_EDGES],
            Self::Behind => [case::LOST_BEHIND, case::WHY_BEHIND],
            Self::Fit => [case::LOST_FIT, case::WHY_FIT],
        }
    }
}

/// Adds the angles and the place of a model.
fn pose_facts(step: Step, role: Role, pose: &Pose) -> Step {
    let angles = angles(pose).map(f64::to_degrees);
    let each = [value::TURN, value::TILT, value::ROLL].into_iter().zip(angles);
    let step = each.fold(step, |step, (of, angle)| step.put_value(of.is(angle).inked(role)));
    let step = step.fact_as(value::ANGLES.is(angles).inked(role), case::ANGLES);
    step.fact_of(value::TRANSLATION.is(pose.translation).inked(role))
}

fn put_motion(step: Step, role: Role, [rotation, shift]: &Motion) -> Step {
    let step = step.put_value(value::ROTATION.is(length(*rotation).to_degrees()).inked(role));
    step.put_value(value::SHIFT.is(*shift).inked(role))
}

fn put_error(step: Step, error: &PoseError) -> Step {
    let step = step.put(value::ROTATION_ERROR, error.degrees).put(value::TRANSLATION_ERROR, error.mm);
    step.put(value::ERROR_SHARE, 100.0 * error.share)
}

fn put_deviations(step: Step, covariance: &[f64]) -> Step {
    let [a, b, c, x, y, z] = deviations(covariance);
    let [x, y, z] = [x, y, z].map(|m| 1000.0 * m);
    let step = step.fact(value::ROTATION_SIGMA, [a, b, c].map(f64::to_degrees));
    let step = step.fact(value::TRANSLATION_SIGMA, [x, y, z]).put(value::DEPTH_SIGMA, z);
    let step = step.put(value::LATERAL_SIGMA, x.max(y)).say(case::COVARIANCE);
    step.say(if z > x.max(y) { case::DEPTH } else { shared::END })
}

/// The error of a judged pose where the true one is known.
fn error(at: &At<'_, Rapid>) -> Option<PoseError> {
    let Event::Judged(judged) = at.event else { return None };
    Some(PoseError::of(&judged.view.pose, &at.pose?))
}

/// The judgements of all frames up to the current one.
fn past(at: &At<'_, Rapid>) -> Vec<Past> {
    let before = at.model.into_iter().flat_map(|model| model.past.iter().copied());
    let now = if let Event::Judged(judged) = at.event { Some(Past::from(&**judged)) } else { None };
    before.chain(now).collect()
}

fn pose_matrix(name: &'static str, role: Role, pose: &Pose) -> Matrix {
    let entry = |x: usize, y: usize| if x < 3 { pose.rotation[y][x] } else { pose.translation[y] };
    let matrix = Matrix::new("[R T]", name, Grid::from_fn(4, 3, entry)).with_role(role).with_decimals(3);
    matrix.with_rows(["X", "Y", "Z"]).with_columns(["X", "Y", "Z", "T in m"])
}

/// A square matrix of the six parameters.
fn of_parameters(symbol: &'static str, name: &'static str, entry: impl Fn(usize, usize) -> f64) -> Matrix {
    let matrix = Matrix::new(symbol, name, Grid::from_fn(FREEDOM, FREEDOM, entry)).with_decimals(2);
    matrix.with_rows(PARAMETERS).with_columns(PARAMETERS)
}

/// The covariance in degrees and millimetres.
fn covariance_matrix(entries: &[f64]) -> Matrix {
    let unit = |i: usize| if i < 3 { 1f64.to_degrees() } else { 1000.0 };
    let entry = |x: usize, y: usize| entries[y * FREEDOM + x] * unit(x) * unit(y);
    of_parameters("P", "covariance of the pose, in ° and mm", entry).with_role(Role::Estimate)
}

/// The distances of the edges over the iterations of the frame so far.
fn distances(at: &At<'_, Rapid>) -> Option<Series> {
    let of = |(i, event): (usize, &&Event)| match event {
        Event::Iterated(iteration) => Some((i + 1, [iteration.number as f32, iteration.equations.rms as f32])),
        _ => None,
    };
    let all: Vec<_> = at.events.iter().enumerate().filter_map(of).collect();
    let x_max = all.len();
    (x_max > 1).then(|| Series {
        events: all.iter().map(|(event, _)| *event).collect(),
        ..Series::new(
            "Distance of the edges",
            ["iteration", "px"],
            x_max,
            vec![("RMS", Role::Error, all.iter().map(|(_, point)| *point).collect())],
        )
    })
}

/// Draws the visible edges of a model.
fn wireframe(scene: &mut Scene, (role, meaning): (Role, &'static str), view: &View) {
    for edge in view.wireframe.outline(&view.camera, &view.pose) {
        scene.mark(Picture::CURRENT, role, Shape::line(edge.to_vec()));
    }
    scene.legend(role, meaning);
}

/// Draws the way from each control point to its edge, and the points without one.
fn searches(scene: &mut Scene, sought: &[Sought]) {
    let place = |at: [f64; 2]| at.map(|c| c as f32);
    let arrow = |s: &Sought| Some(Arrow { from: place(s.control.at), to: place(s.found()?) });
    scene.draw(
        Picture::CURRENT,
        (Role::Measured, "from control point to edge"),
        Shape::Arrows(sought.iter().filter_map(arrow).collect()),
    );
    let missed: Vec<_> = sought.iter().filter(|s| s.edge.is_none()).map(|s| place(s.control.at)).collect();
    if !missed.is_empty() {
        scene.draw(Picture::CURRENT, (Role::Error, "control point without an edge"), Shape::Points(missed));
    }
}
