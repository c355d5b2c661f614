//! The explanation and the drawing of RAPiD.

use super::account::{Count, Past, PoseError, summary};
use super::fit::{FREEDOM, Sought};
use super::{End, Event, Iteration, Judged, Model, Motion, Prediction, Rapid, Solid, View, Weighting};
use crate::base::words::{counted, fixed};
use crate::data::Pose;
use crate::geometry::{Bounds, Grid};
use crate::methods::numbers::{px, ratio};
use crate::methods::region::{At, Ending, Explained, Outcome};
use crate::scene::{Arrow, Fact, Math, Matrix, Picture, Readout, Role, Scene, Sentence, Series, Shape};

/// The rows of the six parameters.
const PARAMETERS: [&str; FREEDOM] = ["θ_x", "θ_y", "θ_z", "Δ_x", "Δ_y", "Δ_z"];

/// An angle in degrees as text.
pub fn degrees(rad: f64) -> String {
    format!("{}°", fixed(rad.to_degrees(), 2))
}

/// A coordinate in m as text.
fn metres(value: f64) -> String {
    fixed(value, 3)
}

/// A translation as text.
fn translation([x, y, z]: [f64; 3]) -> String {
    format!("({}, {}, {}) m", metres(x), metres(y), metres(z))
}

/// Turn about the vertical axis of the model, tilt towards the camera, and roll about the optical axis, in rad.
fn angles(pose: &Pose) -> [f64; 3] {
    let r = &pose.rotation;
    [(-r[2][0]).atan2(r[2][2]), r[2][1].clamp(-1.0, 1.0).asin(), (-r[0][1]).atan2(r[1][1])]
}

pub fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// The standard deviations of the parameters: of the rotation in rad, of the translation in m.
fn deviations(covariance: &[f64]) -> [f64; FREEDOM] {
    std::array::from_fn(|i| covariance.get(i * FREEDOM + i).map_or(0.0, |variance| variance.max(0.0).sqrt()))
}

impl Explained for Rapid {
    fn sentence(&self, at: &At<'_, Self>) -> Sentence {
        let said = Sentence::default();
        match at.event {
            Event::Placed(view) => self.placed_at(view, said),
            Event::Predicted([before, after]) => {
                if at.model.is_some_and(|model| model.motion == Motion::default()) {
                    return said.text(
                        "Constant velocity: after the start or a loss there is no last motion, so the search starts at the last pose.",
                    );
                }
                let [rotation, shift] = before.pose.motion_to(&after.pose);
                said.text("Constant velocity: the pose is predicted with the last motion, a rotation by ")
                    .ink(Role::Predicted, degrees(length(rotation)))
                    .text(" and a translation by ")
                    .ink(Role::Predicted, translation(shift))
                    .text(". The search range must cover the error of the prediction alone.")
            }
            Event::Iterated(iteration) => self.iterated(iteration, said),
            Event::Judged(judged) => self.judged(judged, said),
        }
    }

    fn facts(&self, at: &At<'_, Self>) -> Vec<Fact> {
        let of_pose = |role, pose: &Pose| {
            let [turn, tilt, roll] = angles(pose).map(degrees);
            vec![
                Fact::new("Turn, tilt, roll", format!("{turn}, {tilt}, {roll}"), Some(role)),
                Fact::new("Translation", translation(pose.translation), Some(role)),
            ]
        };
        match at.event {
            Event::Placed(view) => {
                let focal = Fact::new("Focal length", format!("{} px", px(view.camera.focal)), None);
                [vec![focal], of_pose(Role::Reference, &view.pose)].concat()
            }
            Event::Predicted([_, after]) => of_pose(Role::Predicted, &after.pose),
            Event::Iterated(iteration) => {
                let edges = format!("{} of {}", iteration.equations.edges, iteration.sought.len());
                let facts = vec![
                    Fact::new("Iteration", iteration.number.to_string(), None),
                    Fact::new("Control points with an edge", edges, Some(Role::Measured)),
                    Fact::new(
                        "Distance of the edges (RMS)",
                        format!("{} px", px(iteration.equations.rms)),
                        Some(Role::Error),
                    ),
                ];
                let pose = iteration.moved.as_ref().map(|(_, pose, _)| of_pose(Role::Estimate, pose));
                [facts, pose.unwrap_or_default()].concat()
            }
            Event::Judged(judged) => {
                let mut facts = of_pose(Role::Estimate, &judged.view.pose);
                let residual = match judged.residual_px.is_nan() {
                    true => "undefined: no edge was found".into(),
                    false => format!("{} px", px(judged.residual_px)),
                };
                facts.push(Fact::new("Distance of the edges (median)", residual, Some(Role::Error)));
                if let Some(covariance) = &judged.covariance {
                    let [a, b, c, x, y, z] = deviations(covariance);
                    let [a, b, c] = [a, b, c].map(degrees);
                    let [x, y, z] = [x, y, z].map(|m| fixed(1000.0 * m, 1));
                    facts.push(Fact::new("σ of the rotation about X, Y, Z", format!("{a}, {b}, {c}"), None));
                    facts.push(Fact::new("σ of the translation along X, Y, Z", format!("{x}, {y}, {z} mm"), None));
                }
                if judged.view.sight().axis.is_some() {
                    facts.push(Fact::new("Rotation about the axis of the cylinder", "held", None));
                }
                if let Some([angle, distance, _]) = error(at).map(|error| error.words()) {
                    facts.push(Fact::new("Error of the rotation", angle, Some(Role::Error)));
                    facts.push(Fact::new("Error of the translation", distance, Some(Role::Error)));
                }
                facts
            }
        }
    }

    fn readouts(&self, at: &At<'_, Self>) -> Vec<Readout> {
        let mut readouts = match at.event {
            Event::Placed(view) => vec![
                Readout::Equation(vec![projection()]),
                Readout::Matrices(vec![pose_matrix("initial pose of the model", Role::Reference, &view.pose)]),
            ],
            Event::Predicted([before, after]) => vec![Readout::Matrices(vec![
                pose_matrix("last pose", Role::Reference, &before.pose),
                pose_matrix("predicted pose", Role::Predicted, &after.pose),
            ])],
            Event::Iterated(iteration) => self.of_iteration(iteration),
            Event::Judged(judged) => {
                let mut matrices = vec![pose_matrix("pose of the model", Role::Estimate, &judged.view.pose)];
                matrices.extend(judged.covariance.as_deref().map(covariance_matrix));
                vec![Readout::Equation(vec![self.formula_of_covariance(&judged.view)]), Readout::Matrices(matrices)]
            }
        };
        readouts.extend(distances(at).map(Readout::Series));
        readouts
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

    fn opening(&self) -> String {
        format!(
            "RAPiD is given the shape of an object: its wireframe model fits the region in the first frame at the initial rotation, and follows the \
             edges in at most {}.",
            counted(self.settings.frames, "frame")
        )
    }

    fn loss(&self, at: &At<'_, Self>) -> Option<String> {
        let Event::Judged(judged) = at.event else { return None };
        let why = match judged.covariance {
            None => "the edges do not determine its pose",
            Some(_) if !judged.is_kept && judged.share >= f64::from(self.min_share) => {
                "a corner of its model lies behind the camera"
            }
            Some(_) if !judged.is_kept => "too few control points have an edge",
            Some(_) => "the edges do not fit one pose",
        };
        judged.is_lost.then(|| why.into())
    }

    fn summary(&self, at: &At<'_, Self>) -> Option<String> {
        summary(&past(at), &at.poses)
    }

    fn caveat(&self, at: &At<'_, Self>) -> Option<String> {
        let error = error(at).filter(PoseError::is_wrong)?;
        let [angle, distance, share] = error.words();
        Some(format!(
            "But the pose differs from the true one by {angle} and {distance}, {share} of the distance: wrong edges were matched, which the \
             rectangle around the model does not show."
        ))
    }

    fn advice(&self, ending: Ending, at: &At<'_, Self>) -> String {
        let has_failures = Count::of(&past(at), &at.poses).is_some_and(|count| count.has_failures());
        let is_followed = ending.outcome == Outcome::Followed && ending.reported == 0 && !has_failures;
        let advice = match (is_followed, self.pose_prediction) {
            (true, _) => {
                "The edges of the object stayed within the search range, so each frame determined the pose anew: errors do not add up."
            }
            (false, Prediction::None) => {
                "The edges left the search range between two frames, or edges of something else were nearer. Constant velocity predicts the \
                 motion, so that the edges are near their control points."
            }
            (false, Prediction::ConstantVelocity) => {
                "The prediction missed by more than the search range, or edges of something else were nearer. Robust weights take influence \
                 from single wrong edges; a wrong pose that many of them support is not corrected."
            }
        };
        // A wrong pose has its own sentence above.
        let off = error(at).filter(|error| !error.is_wrong()).map(|error| {
            let [angle, distance, _] = error.words();
            format!(" The last pose differs from the true one by {angle} and {distance}.")
        });
        format!("{advice}{}", off.unwrap_or_default())
    }
}

impl Rapid {
    fn placed_at(&self, view: &View, said: Sentence) -> Sentence {
        let [width, height, depth] =
            [self.model_width, self.model_height, self.model_depth].map(|side| metres(side.into()));
        let solid = match self.solid {
            Solid::Box => "box",
            Solid::Cylinder => "cylinder",
        };
        said.ink(Role::Reference, format!("The model, a {solid} of {width}×{height}×{depth} m,")).text(format!(
            " fills the region at the initial rotation when its centre lies at {}. The focal length of {} px relates size and distance: one \
             camera knows only their ratio, the model gives the scale.",
            translation(view.pose.translation),
            px(view.camera.focal)
        ))
    }

    fn iterated(&self, iteration: &Iteration, said: Sentence) -> Sentence {
        let equations = &iteration.equations;
        let said = said
            .text(format!("Iteration {}: ", iteration.number))
            .ink(Role::Measured, format!("{} of {} control points", equations.edges, iteration.sought.len()))
            .text(format!(
                " have an edge within {} px of their projection, at an RMS distance of {} px.",
                self.search_range,
                px(equations.rms)
            ));
        let Some((motion, _, moved)) = &iteration.moved else {
            return said.text(" These edges do not determine a pose, so the iterations end.");
        };
        let [rotation, shift] = *motion;
        let what = match self.weighting {
            Weighting::Equal => "Least squares",
            Weighting::Robust => "Weighted least squares",
        };
        let said = said
            .text(format!(" {what} over {}: rotation by ", Self::unknowns(&iteration.view)))
            .ink(Role::Estimate, degrees(length(rotation)))
            .text(", translation by ")
            .ink(Role::Estimate, translation(shift))
            .text(". ");
        let least = fixed(self.epsilon.into(), 3);
        said.text(match iteration.end {
            Some(End::Converged) => format!("No control point moves by more than ε = {least} px: converged."),
            Some(_) => "The maximum number of iterations is reached.".into(),
            None => format!(
                "The control points move by up to {} px. A distance along the normal constrains one direction alone (aperture problem); edges \
                 of several directions together determine the pose.",
                px(*moved)
            ),
        })
    }

    fn judged(&self, judged: &Judged, said: Sentence) -> Sentence {
        let [turn, tilt, _] = angles(&judged.view.pose).map(degrees);
        let said = said
            .text("Pose: ")
            .ink(
                Role::Estimate,
                format!("turn {turn}, tilt {tilt}, translation {}", translation(judged.view.pose.translation)),
            )
            .text(format!(
                ". {} of {} have an edge.",
                judged.sought.iter().filter(|sought| sought.edge.is_some()).count(),
                counted(judged.sought.len(), "control point")
            ));
        let Some(covariance) = &judged.covariance else {
            return said.text(" The edges do not determine a pose: ").ink(Role::Error, "the object is lost").text(".");
        };
        let [.., x, y, z] = deviations(covariance);
        let across = x.max(y);
        let why = if z > across { ", since a change of distance moves the edges least" } else { "" };
        let said = said.text(format!(
            " The covariance is the variance of the residuals times the inverse of the normal matrix, for independent errors of the edges: σ is {} mm \
             along the optical axis and {} mm across it{why}.",
            fixed(1000.0 * z, 1),
            fixed(1000.0 * across, 1)
        ));
        if !judged.is_lost {
            return said;
        }
        let why = match judged.is_kept {
            false if judged.share >= f64::from(self.min_share) => {
                " A corner of the model lies behind the camera: ".to_owned()
            }
            false => format!(" Share {} < {}: ", ratio(judged.share), ratio(self.min_share.into())),
            true => format!(
                " Median distance of the edges {} px > {} px, so they do not fit one pose: ",
                px(judged.residual_px),
                px(self.max_residual.into())
            ),
        };
        said.text(why).ink(Role::Error, "the object is lost").text(".")
    }

    /// The parameters of an iteration in words.
    fn unknowns(view: &View) -> &'static str {
        match view.sight().axis {
            None => "6 parameters",
            Some(_) => "5 parameters, the rotation about the axis being held",
        }
    }

    fn weight(&self) -> Vec<Math> {
        let weight = || Math::indexed(Math::Var("w"), Math::Var("i"));
        (self.weighting == Weighting::Robust).then(weight).into_iter().collect()
    }

    /// Σ w c cᵀ + λ a aᵀ; w of robust weights, a where a rotation is held.
    fn normal_matrix(&self, view: &View) -> Vec<Math> {
        let product = |vector: fn() -> Math| vec![vector(), Math::power(vector(), Math::text("T"))];
        let sum = vec![Math::Sum(Box::new(Math::Var("i")))];
        let edges = product(|| Math::indexed(Math::Bold("c"), Math::Var("i")));
        let held = match view.sight().axis {
            None => Vec::new(),
            Some(_) => [vec![Math::text(" + λ ")], product(|| Math::Bold("a"))].concat(),
        };
        [sum, self.weight(), edges, held].concat()
    }

    /// (Σ w c cᵀ + λ a aᵀ)(θ, Δ) = Σ w c l.
    fn normal_equations(&self, view: &View) -> Math {
        let right = vec![Math::indexed(Math::Bold("c"), Math::Var("i")), Math::indexed(Math::Var("l"), Math::Var("i"))];
        let equals = vec![Math::text(") (θ, Δ) = "), Math::Sum(Box::new(Math::Var("i")))];
        Math::Row([vec![Math::text("(")], self.normal_matrix(view), equals, self.weight(), right].concat())
    }

    /// P = σ² (Σ w c cᵀ + λ a aᵀ)⁻¹.
    fn formula_of_covariance(&self, view: &View) -> Math {
        let inverse = Math::power(Math::text(")"), Math::text("−1"));
        let first = vec![Math::Bold("P"), Math::text(" = "), Math::squared(Math::text("σ")), Math::text(" (")];
        Math::Row([first, self.normal_matrix(view), vec![inverse]].concat())
    }

    fn of_iteration(&self, iteration: &Iteration) -> Vec<Readout> {
        let matrix = &iteration.equations.matrix;
        // Parameters in units that move control points alike: degrees and centimetres.
        let unit = |i: usize| if i < 3 { 1f64.to_radians() } else { 0.01 };
        let entry = |x: usize, y: usize| matrix[y * FREEDOM + x] * unit(x) * unit(y);
        let mut matrices = vec![of_parameters(("C", "normal matrix, in px² per ° and cm"), Role::Measured, entry)];
        matrices.extend(
            iteration.moved.as_ref().map(|(_, pose, _)| pose_matrix("pose after the iteration", Role::Estimate, pose)),
        );
        vec![Readout::Equation(vec![self.normal_equations(&iteration.view)]), Readout::Matrices(matrices)]
    }
}

/// The error of a judged pose where the true one is known.
fn error(at: &At<'_, Rapid>) -> Option<PoseError> {
    let Event::Judged(judged) = at.event else { return None };
    Some(PoseError::of(&judged.view.pose, &at.pose?))
}

/// The judgements of all frames up to the one at hand.
fn past(at: &At<'_, Rapid>) -> Vec<Past> {
    let before = at.model.into_iter().flat_map(|model| model.past.iter().copied());
    let now = if let Event::Judged(judged) = at.event { Some(Past::from(&**judged)) } else { None };
    before.chain(now).collect()
}

/// u = f X/Z, v = f Y/Z with (X, Y, Z) = R m + T.
fn projection() -> Math {
    Math::Row(vec![
        Math::text("u = f "),
        Math::over(Math::text("X"), Math::text("Z")),
        Math::text(",  v = f "),
        Math::over(Math::text("Y"), Math::text("Z")),
        Math::text(",  (X, Y, Z) = "),
        Math::Bold("R"),
        Math::text(" "),
        Math::Bold("m"),
        Math::text(" + "),
        Math::Bold("T"),
    ])
}

fn pose_matrix(name: &'static str, role: Role, pose: &Pose) -> Matrix {
    let entry = |x: usize, y: usize| if x < 3 { pose.rotation[y][x] } else { pose.translation[y] };
    Matrix {
        symbol: "[R T]",
        name,
        role: Some(role),
        entries: Grid::from_fn(4, 3, entry),
        rows: ["X", "Y", "Z"].map(String::from).to_vec(),
        columns: ["X", "Y", "Z", "T in m"].map(String::from).to_vec(),
        changed: None,
        decimals: Some(3),
    }
}

/// A square matrix of the six parameters.
fn of_parameters(
    (symbol, name): (&'static str, &'static str),
    role: Role,
    entry: impl Fn(usize, usize) -> f64,
) -> Matrix {
    Matrix {
        symbol,
        name,
        role: Some(role),
        entries: Grid::from_fn(FREEDOM, FREEDOM, entry),
        rows: PARAMETERS.map(String::from).to_vec(),
        columns: PARAMETERS.map(String::from).to_vec(),
        changed: None,
        decimals: Some(2),
    }
}

/// The covariance in degrees and millimetres.
fn covariance_matrix(entries: &[f64]) -> Matrix {
    let unit = |i: usize| if i < 3 { 1f64.to_degrees() } else { 1000.0 };
    let entry = |x: usize, y: usize| entries[y * FREEDOM + x] * unit(x) * unit(y);
    of_parameters(("P", "covariance of the pose, in ° and mm"), Role::Estimate, entry)
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
        title: "Distance of the edges",
        x_label: "iteration",
        y_label: "px",
        x_max,
        events: all.iter().map(|(event, _)| *event).collect(),
        lines: vec![("RMS", Role::Error, all.iter().map(|(_, point)| *point).collect())],
        ..Series::default()
    })
}

/// Draws the visible edges of a model.
fn wireframe(scene: &mut Scene, (role, meaning): (Role, &'static str), view: &View) {
    for edge in view.wireframe.outline(&view.camera, &view.pose) {
        scene.mark(Picture::CURRENT, role, Shape::Path { points: edge.to_vec(), closed: false });
    }
    scene.legend(role, meaning);
}

/// Draws the way from each control point to its edge, and the points without one.
fn searches(scene: &mut Scene, sought: &[Sought]) {
    let place = |at: [f64; 2]| at.map(|c| c as f32);
    let arrow = |s: &Sought| Some(Arrow { from: place(s.control.at), to: place(s.found()?) });
    scene.mark(Picture::CURRENT, Role::Measured, Shape::Arrows(sought.iter().filter_map(arrow).collect()));
    scene.legend(Role::Measured, "from control point to edge");
    let missed: Vec<_> = sought.iter().filter(|s| s.edge.is_none()).map(|s| place(s.control.at)).collect();
    if !missed.is_empty() {
        scene.mark(Picture::CURRENT, Role::Error, Shape::Points(missed));
        scene.legend(Role::Error, "control point without an edge");
    }
}
