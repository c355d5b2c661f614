//! What scene flow tells.

mod drawing;

use std::sync::Arc;

use super::{Depths, Event, Part, SceneFlow, Source, line, space};
use crate::base::words::{self, fixed, grouped};
use crate::data::{Calibration, Disparity, Measured, Pose, SpaceMotion, mahalanobis_squared};
use crate::geometry::Grid;
use crate::methods::numbers::{percent, squared};
use crate::methods::scene_flow::{Draw, EgoSettings, FEWEST, Fit};
use crate::methods::stereo::{Settings, Views};
use crate::products::scene_flow::{depth_error, scene_flow_error};
use crate::products::{Reference, SceneFlowField};
use crate::run::Seen;
use crate::scene::{Fact, Math, Matrix, Readout, Role, Sentence, Series, Step};

/// Ranges of depth in the plot of errors.
const RANGES: usize = 12;

/// A vector in m as text, to a millimetre.
fn metres(vector: [f64; 3]) -> String {
    let [x, y, z] = vector.map(|c| fixed(c, 3));
    format!("({x}, {y}, {z}) m")
}

fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|c| c * c).sum::<f64>().sqrt()
}

fn px2([x, y]: [f64; 2]) -> String {
    format!("({}, {})", fixed(x, 2), fixed(y, 2))
}

fn degrees(pose: &Pose) -> String {
    format!("{}°", fixed(pose.angle_rad().to_degrees(), 3))
}

/// The pixel that a step explains, with the field of the run so far.
struct Shown {
    field: SceneFlowField,
    pixel: (usize, usize),
}

impl Shown {
    fn named(&self) -> Sentence {
        Sentence::default().ink(Role::Reference, format!("Pixel {}", words::pixel(self.pixel)))
    }

    fn measured(&self) -> Option<Measured> {
        self.field.measured(self.pixel)
    }

    fn motion(&self) -> Option<SpaceMotion> {
        self.field.motion(self.pixel)
    }
}

impl SceneFlow {
    /// The pixel pointed at, else the middle of the row at work or of the picture.
    fn shown(&self, seen: &Seen<Self>) -> Shown {
        let state = seen.after.unwrap_or(seen.before);
        let mut field = self.field(state);
        let (width, height) = field.size();
        let row = match seen.events.last() {
            Some(Event::Row(_, y)) if seen.after.is_none() => *y as usize,
            _ => height / 2,
        };
        let pointed_at = seen.point().and_then(|point| field.picture.luma().cell_at(point));
        let pixel = pointed_at.unwrap_or((width / 2, row));
        if state.followed.is_none() {
            // The pixel is explained before all others are done.
            let mut followed = Grid::new(width, height, Disparity::UNKNOWN);
            followed[pixel] = self.followed(state, pixel);
            field.next_disparity = Arc::new(Disparity(followed));
        }
        Shown { field, pixel }
    }

    pub(super) fn told(&self, seen: &Seen<Self>) -> Step {
        let Some(event) = seen.events.last() else { return Self::starting(seen) };
        let shown = self.shown(seen);
        let mut step = match event {
            Event::Whole(Part::Disparity) => self.told_disparity(&shown, seen),
            Event::Whole(Part::NextDisparity) => self.told_next(seen),
            Event::Whole(_) => self.told_flow(&shown, seen),
            Event::Row(Part::Positions, _) => self.told_position(&shown),
            Event::Row(..) => self.told_own(&shown),
            Event::Opened(counts) => self.told_opening(&shown, *counts, seen.point().is_some()),
            Event::Draw(draw) => self.told_draw(seen, draw),
            Event::NoEgo => Self::told_no_ego(seen),
        };
        if !step.readouts.iter().any(|readout| matches!(readout, Readout::Facts(_))) {
            step.readouts.insert(0, Readout::Facts(known_facts(&shown)));
        }
        let is_over = seen.after.is_some_and(|after| after.done == self.parts(&after.fixed).len());
        if is_over && seen.point().is_none() {
            step.sentence = step.sentence.text(self.concluded(seen, &shown.field));
            step.readouts.extend(self.error_plot(seen, &shown.field));
        }
        let has_depths = shown.field.disparity.0.cells().iter().any(|d| d.is_finite());
        let has_positions = shown.field.calibration.is_some() && has_depths;
        if has_positions {
            step.readouts.push(Readout::Cloud(space::cloud(shown.field, shown.pixel)));
        }
        step
    }

    fn told_no_ego(seen: &Seen<Self>) -> Step {
        let state = seen.after.unwrap_or(seen.before);
        let (line, why) = match (seen.before.consensus.is_some(), state.points.len()) {
            (true, _) => (
                line::OWN,
                "The motion of the cameras is not determined, so motions of its own are unknown.".to_owned(),
            ),
            (false, count) => (
                line::SAMPLE,
                format!(
                    "A rigid motion needs {FEWEST} points with known positions in both frames, and the grid has {count}. A smaller spacing gives more."
                ),
            ),
        };
        Step { line, sentence: Sentence::default().ink(Role::Error, why), readouts: Vec::new() }
    }

    fn starting(seen: &Seen<Self>) -> Step {
        let state = seen.before;
        let said = Sentence::default();
        let sentence = match (state.fixed.depths, state.fixed.calibration) {
            (Depths::Unknown, _) => said.ink(
                Role::Error,
                "The clip has no right view, so depths are not known and only the optical flow is estimated. Open a right view, or put \
                 measured depths into a folder depth beside the frames.",
            ),
            (Depths::Stereo, None) => said.ink(
                Role::Error,
                "The cameras are not calibrated: disparities and flow are known, positions in metres are not. Open their calibration, or type focal \
                 length and baseline.",
            ),
            (Depths::Sensor, None) => said.ink(
                Role::Error,
                "Depths are known, but not the focal length that positions need, so only the optical flow is estimated. Type the calibration, focal \
                 length and a baseline: the baseline sets the assumed error of a depth.",
            ),
            (Depths::Stereo, Some(rig)) => said.text(format!(
                "Two views give a point its position: with focal length {} px and baseline {} m the depth is Z = f B / d. The optical flow \
                 leads to the same point in frame t + 1, where its disparity gives the next position. The difference is the scene flow.",
                fixed(rig.focal_px, 0),
                fixed(rig.baseline_m, 3)
            )),
            (Depths::Sensor, Some(rig)) => said.text(format!(
                "A depth and the focal length, {} px, give a point its position. The optical flow leads to the same point in frame t + 1, where the \
                 depth gives the next position. The difference is the scene flow. Depths are given as disparities at a baseline of {} m, which sets their assumed error.",
                fixed(rig.focal_px, 0),
                fixed(rig.baseline_m, 3)
            )),
        };
        let sentence = match swapped(seen) {
            Some(warning) => sentence.ink(Role::Error, format!(" The views are {warning}.")),
            None => sentence,
        };
        Step { line: line::TAKE_VIEWS, sentence, readouts: Vec::new() }
    }

    fn method(&self, name: &'static str) -> &'static str {
        if self.source == Source::Truth { "The ground truth" } else { name }
    }

    /// The origin of the disparities, for a sentence.
    fn depths_of(&self, seen: &Seen<Self>) -> &'static str {
        match (self.source, seen.before.fixed.depths) {
            (Source::Estimated, Depths::Sensor) => "The depth sensor",
            _ => self.method(self.disparity.estimator().info().name),
        }
    }

    fn told_disparity(&self, shown: &Shown, seen: &Seen<Self>) -> Step {
        let field = &shown.field;
        let known = field.disparity.known() as f64 / field.picture.luma().cells().len() as f64;
        let name = self.depths_of(seen);
        let said = Sentence::default()
            .text(format!("{name} has a disparity for {} of the pixels of frame t. ", percent(known)));
        let (x, y) = shown.pixel;
        let said = joined(said, shown.named());
        let sentence = match field.disparity.at(x, y) {
            None => said.text(match (self.source, seen.before.fixed.depths) {
                (Source::Truth, _) => " has none: its true disparity is not known.",
                (_, Depths::Sensor) => " has none: the sensor measured no depth there.",
                _ => " has none: it is ambiguous, or the right camera does not see it.",
            }),
            Some(d) => {
                let said = said.text(": ").ink(Role::Best, format!("d = {} px", fixed(d.into(), 2)));
                match field.calibration.and_then(|rig| rig.depth_m(d.into())) {
                    Some(depth) => said.text(format!(", so its depth is Z = f B / d = {} m.", fixed(depth, 2))),
                    None => said.text("."),
                }
            }
        };
        Step { line: line::DISPARITY, sentence, readouts: vec![self.depth_equation(shown)] }
    }

    fn depth_equation(&self, shown: &Shown) -> Readout {
        let formula = Math::Row(vec![
            Math::Var("Z"),
            Math::text(" = "),
            Math::over(Math::Row(vec![Math::Var("f"), Math::text(" "), Math::Var("B")]), Math::Var("d")),
        ]);
        let numbers = || {
            let (x, y) = shown.pixel;
            let (d, rig) = (f64::from(shown.field.disparity.at(x, y)?), shown.field.calibration?);
            let depth = rig.depth_m(d)?;
            Some(Math::Row(vec![
                Math::Var("Z"),
                Math::text(" = "),
                Math::over(
                    Math::text(format!("{} px · {} m", fixed(rig.focal_px, 0), fixed(rig.baseline_m, 3))),
                    Math::text(format!("{} px", fixed(d + rig.offset_px, 2))),
                ),
                Math::text(" = "),
                Math::ink(Role::Result, format!("{} m", fixed(depth, 2))),
            ]))
        };
        Readout::Equation([formula].into_iter().chain(numbers()).collect())
    }

    fn told_next(&self, seen: &Seen<Self>) -> Step {
        let map = seen.after.and_then(|after| after.next.as_ref());
        let known = map.map_or(0.0, |map| map.known() as f64 / map.0.cells().len().max(1) as f64);
        let name = self.depths_of(seen);
        let sentence = Sentence::default().text(match self.source {
            Source::Truth => {
                format!("{name} has the disparity in frame t + 1 of the points at {} of the pixels of frame t.", percent(known))
            }
            Source::Estimated => format!(
                "{name} has a disparity for {} of the pixels of frame t + 1. The flow leads from each point of frame t to its disparity there.",
                percent(known)
            ),
        });
        Step { line: line::NEXT_DISPARITY, sentence, readouts: Vec::new() }
    }

    fn told_flow(&self, shown: &Shown, seen: &Seen<Self>) -> Step {
        let name = self.method(self.flow.estimator().info().name);
        let (x, y) = shown.pixel;
        let said = shown.named();
        let sentence = match shown.field.flow.at(x, y) {
            Some([u, v]) => said
                .text(" moves by ")
                .ink(Role::Result, format!("(u, v) = {} px", px2([u.into(), v.into()])))
                .text(format!(
                    " to {} in frame t + 1 ({name}). Near the principal point a motion along the depth leaves hardly any flow; the change of \
                     the disparity measures it.",
                    px2([x as f64 + f64::from(u), y as f64 + f64::from(v)])
                )),
            None => said.text(" has no flow."),
        };
        let ends_here = seen.after.is_some_and(|after| after.done == self.parts(&after.fixed).len());
        let sentence = match ends_here {
            false => sentence,
            true => sentence.ink(Role::Error, " Without positions there is no scene flow, and the run ends here."),
        };
        Step { line: line::FLOW, sentence, readouts: Vec::new() }
    }

    fn told_position(&self, shown: &Shown) -> Step {
        let (x, y) = shown.pixel;
        let Some(measured) = shown.measured() else {
            let why = match (shown.field.disparity.at(x, y), shown.field.flow.at(x, y)) {
                (None, _) => "has no disparity in frame t",
                (_, None) => "has no flow",
                _ => "has no disparity in frame t + 1, or leaves the picture",
            };
            let sentence = shown.named().text(format!(" {why}, so it has no scene flow."));
            return Step { line: line::SKIP, sentence, readouts: Vec::new() };
        };
        let facts = measured_facts(shown.pixel, &measured);
        let Some(motion) = shown.motion() else {
            let why = match shown.field.calibration {
                None => {
                    "Without the calibration of the cameras the change of the disparity is all that is known of the motion along the depth."
                }
                Some(_) => "The point is at infinity, so it has no position.",
            };
            let sentence = shown.named().text(format!(
                ": disparity {} px in frame t, {} px in frame t + 1. {why}",
                fixed(measured.disparity, 2),
                fixed(measured.next_disparity, 2)
            ));
            return Step { line: line::TRIANGULATE, sentence, readouts: vec![Readout::Facts(facts)] };
        };
        let covariance = motion.covariance(&Pose::IDENTITY, &shown.field.sigma);
        let sigmas = [0, 1, 2].map(|i| covariance[i][i].sqrt());
        let sentence = shown
            .named()
            .text(format!(
                " is at P = {} in frame t and at P′ = {} in frame t + 1. Scene flow ",
                metres(motion.from),
                metres(motion.to)
            ))
            .ink(Role::Result, format!("V = P′ − P = {}", metres(motion.displacement())))
            .text(format!(
                ". Along the depth its standard deviation is {} m: the error of a depth grows with its square.",
                fixed(sigmas[2], 3)
            ));
        let matrices = vec![
            vector("P", "position in frame t, in m", motion.from, Some(Role::Reference)),
            vector("P′", "position in frame t + 1, in m", motion.to, Some(Role::Measured)),
            vector("V", "scene flow, in m", motion.displacement(), Some(Role::Result)),
            square("Σ", "covariance of the scene flow, in m²", covariance),
        ];
        let readouts = vec![
            Readout::Facts(facts),
            Readout::Equation(triangulation(&measured, shown.field.calibration.as_ref(), &motion)),
            Readout::Matrices(matrices),
        ];
        Step { line: line::TRIANGULATE, sentence, readouts }
    }

    fn told_draw(&self, seen: &Seen<Self>, draw: &Draw) -> Step {
        let sentence = match (draw.sample, draw.fit) {
            (Some(_), fit) => sample_told(draw, fit, &self.ego),
            (None, Some(fit)) if draw.fit == draw.best => Sentence::default()
                .text("Gauss–Newton steps over all inliers of the best sample: RMS reprojection error ")
                .ink(Role::Result, format!("{} px", fixed(fit.rms_px(), 3)))
                .text(format!(", {} inliers. More points than three average their noise.", grouped(fit.score.inliers))),
            (None, Some(_)) => Sentence::default()
                .text("Another round over the inliers does not lower the cost, so the fit has converged."),
            (None, None) => {
                Sentence::default().text("The inliers determine no better fit, so that of the sample is kept.")
            }
        };
        let told = draw.best.map(|best| self.ego_told(seen, &best)).filter(|_| seen.after.is_some());
        let sentence = match told {
            Some(told) => sentence.text(told),
            None => sentence,
        };
        let mut readouts = vec![Readout::Facts(draw_facts(draw))];
        readouts.push(Readout::Equation(reprojection()));
        let pose = if draw.sample.is_some() { draw.fit } else { draw.best }.map(|fit| fit.pose);
        readouts.extend(pose.map(|pose| {
            let mut matrices = vec![
                square("R", "rotation of the scene", pose.rotation).with_decimals(4),
                vector("t", "translation of the scene, in m", pose.translation, Some(Role::Result)),
            ];
            let covariance = seen.after.and_then(|after| after.consensus.as_ref()?.covariance);
            matrices.extend(covariance.map(|all| Matrix {
                entries: Grid::from_fn(3, 3, |x, y| all[3 + y][3 + x]),
                ..square("C", "covariance of t, in m²", [[0.0; 3]; 3])
            }));
            Readout::Matrices(matrices)
        }));
        readouts.push(history(seen.events));
        let line = if draw.sample.is_some() { line::SAMPLE } else { line::REFIT };
        Step { line, sentence, readouts }
    }

    /// What the motion of the cameras is, at the end of its estimation.
    fn ego_told(&self, seen: &Seen<Self>, best: &Fit) -> String {
        let camera = best.pose.inverse().translation;
        let points = seen.after.map_or(0, |after| after.points.len());
        let share = best.score.inliers as f64 / points.max(1) as f64;
        let doubt = if share < 0.5 {
            " Less than half of the points agree, so it may be the motion of a large object instead."
        } else {
            ""
        };
        format!(
            " The cameras moved by {} and turned by {}; {} of the points agree.{doubt}",
            metres(camera),
            degrees(&best.pose),
            percent(share)
        )
    }

    fn told_own(&self, shown: &Shown) -> Step {
        let Some(motion) = shown.motion() else {
            let sentence = shown.named().text(" has no scene flow, so it is not judged.");
            return Step { line: line::SKIP, sentence, readouts: Vec::new() };
        };
        let Some(ego) = shown.field.ego else {
            let sentence = shown
                .named()
                .text(": without the motion of the cameras, a motion of its own cannot be distinguished from theirs.");
            return Step { line: line::OWN, sentence, readouts: Vec::new() };
        };
        let (own, covariance) = (motion.own(&ego.pose), motion.covariance(&ego.pose, &shown.field.sigma));
        let distance = mahalanobis_squared(own, &covariance);
        let is_beyond = distance > f64::from(self.gate);
        let said = shown
            .named()
            .text(format!(": the motion of the cameras predicts R P + t = {}. ", metres(ego.pose.moved(motion.from))))
            .ink(Role::Error, format!("r = P′ − (R P + t) = {}", metres(own)))
            .text(" remains. ");
        let gate = fixed(self.gate.into(), 2);
        let said = said.text(format!("Squared Mahalanobis distance {} against a gate of {gate}: ", squared(distance)));
        let sentence = match is_beyond {
            true if !ego.is_of_majority() => said
                .text("the pixel does not move with the points that determine the motion of the cameras. They are less than half of all, so either may be at rest."),
            true => said.ink(Role::Result, "the pixel has a motion of its own").text("."),
            false => said
                .text("consistent with a point at rest. A motion smaller than its uncertainty would not be detected."),
        };
        let matrices = vec![
            vector("P′", "position in frame t + 1, in m", motion.to, Some(Role::Measured)),
            vector("RP+t", "prediction for a point at rest, in m", ego.pose.moved(motion.from), Some(Role::Predicted)),
            vector("r", "remaining motion, in m", own, Some(Role::Error)),
            square("Σ", "covariance of r, in m²", covariance),
        ];
        let facts = vec![
            Fact::new("Pixel", words::pixel(shown.pixel), Some(Role::Reference)),
            Fact::new("Remaining motion", format!("{} m", fixed(length(own), 3)), Some(Role::Error)),
            Fact::new("Squared Mahalanobis distance", squared(distance), None),
            Fact::new("Gate", gate, None),
        ];
        Step { line: line::OWN, sentence, readouts: vec![Readout::Facts(facts), Readout::Matrices(matrices)] }
    }

    fn told_opening(&self, shown: &Shown, [before, after]: [u32; 2], is_pointed: bool) -> Step {
        let kept = format!("{} of {} pixels", grouped(after as usize), grouped(before as usize));
        let sentence = match self.opening {
            0 => Sentence::default()
                .ink(Role::Result, kept)
                .text(" keep a motion of their own, as the opening has a radius of 0 px."),
            radius => Sentence::default()
                .text(format!("Opening with a {0}×{0} square keeps ", 2 * radius + 1))
                .ink(Role::Result, kept)
                .text(" with a motion of their own. Groups narrower than the square are mostly errors at depth edges."),
        };
        // A pixel pointed at keeps its numbers.
        let readouts = if is_pointed { self.told_own(shown).readouts } else { Vec::new() };
        Step { line: line::OPEN, sentence, readouts }
    }

    /// What the run comes to.
    fn concluded(&self, seen: &Seen<Self>, field: &SceneFlowField) -> String {
        let all = field.picture.luma().cells().len().max(1) as f64;
        let mut told = swapped(seen).map_or_else(String::new, |warning| format!(" The views are {warning}."));
        told += &format!(" {} of the pixels have a scene flow", percent(field.known() as f64 / all));
        let is_doubtful = field.ego.is_some_and(|ego| !ego.is_of_majority());
        told += &match &field.moving {
            Some(_) if is_doubtful => {
                ". Less than half of the points agree with the motion of the cameras, so it cannot be \
                                       told which pixels have a motion of their own."
                    .to_owned()
            }
            Some(moving) if moving.count() > 0 => {
                format!("; {} have a motion of their own.", percent(moving.count() as f64 / all))
            }
            Some(_) => "; none has a significant motion of its own.".to_owned(),
            None if field.calibration.is_some() => {
                ". The motion of the cameras is not determined, so motions of its own are unknown.".to_owned()
            }
            None => ".".to_owned(),
        };
        let reference = Reference { clip: seen.clip, frame: seen.before.fixed.frame };
        // Truth that cannot be read is reported where the product is assessed.
        let error = scene_flow_error(field, &reference).unwrap_or_default();
        if let (Some(epe), Some(median)) = (error.epe_m, error.median_percent) {
            told += &format!(
                " Against the truth: median error {} % of the depth. The mean, {} m, is dominated by far points and depth edges.",
                fixed(median, 2),
                fixed(epe, 3)
            );
        }
        if let Some([_, off]) = error.ego {
            told += &format!(" The displacement of the camera is wrong by {} m.", fixed(off, 4));
        }
        told
    }

    /// The error along the depth, by theory and against the truth.
    fn error_plot(&self, seen: &Seen<Self>, field: &SceneFlowField) -> Option<Readout> {
        let reference = Reference { clip: seen.clip, frame: seen.before.fixed.frame };
        let rows = depth_error(field, &reference, (self.expected_sigma().disparity_px, RANGES));
        let line = |i: usize| rows.iter().map(|row| [row[0] as f32, row[i] as f32]).collect::<Vec<_>>();
        let deepest = rows.last()?[0];
        Some(Readout::Series(Series {
            title: "Error of the scene flow along the depth",
            x_label: "depth Z (m)",
            y_label: "m",
            x_max: deepest.ceil() as usize,
            lines: vec![
                ("σ by theory", Role::Predicted, line(2)),
                ("RMS error against the truth", Role::Error, line(1)),
            ],
            is_sweep: true,
            decimals: Some(3),
            ..Series::default()
        }))
    }
}

/// The warning about views that seem to be swapped or not rectified, if there is one.
fn swapped(seen: &Seen<SceneFlow>) -> Option<String> {
    let fixed = &seen.before.fixed;
    let views = (fixed.depths == Depths::Stereo).then(|| Views::new(seen.clip, fixed.frame).ok()).flatten()?;
    views.signs(Settings::default().disparities).warning()
}

fn joined(mut first: Sentence, second: Sentence) -> Sentence {
    first.0.extend(second.0);
    first
}

/// What is known of a pixel so far.
fn known_facts(shown: &Shown) -> Vec<Fact> {
    let (x, y) = shown.pixel;
    let length = |value: f32| format!("{} px", fixed(value.into(), 2));
    let mut facts = vec![Fact::new("Pixel", words::pixel(shown.pixel), Some(Role::Reference))];
    let disparity = shown.field.disparity.at(x, y);
    facts.extend(disparity.map(|d| Fact::new("Disparity d", length(d), Some(Role::Best))));
    let flow = shown.field.flow.at(x, y);
    facts.extend(
        flow.map(|uv| Fact::new("Flow (u, v)", format!("{} px", px2(uv.map(f64::from))), Some(Role::Measured))),
    );
    facts
}

fn measured_facts(pixel: (usize, usize), measured: &Measured) -> Vec<Fact> {
    vec![
        Fact::new("Pixel", words::pixel(pixel), Some(Role::Reference)),
        Fact::new("Disparity d", format!("{} px", fixed(measured.disparity, 2)), Some(Role::Best)),
        Fact::new("Flow (u, v)", format!("{} px", px2(measured.flow)), Some(Role::Measured)),
        Fact::new("Disparity d′ there", format!("{} px", fixed(measured.next_disparity, 2)), Some(Role::Measured)),
    ]
}

/// Both triangulations, in formulas and numbers.
fn triangulation(measured: &Measured, rig: Option<&Calibration>, motion: &SpaceMotion) -> Vec<Math> {
    let Some(rig) = rig else { return Vec::new() };
    let formula = Math::Row(vec![
        Math::Bold("P"),
        Math::text(" = "),
        Math::over(Math::Var("B"), Math::Var("d")),
        Math::text(" (x − "),
        Math::indexed(Math::Var("c"), Math::Var("x")),
        Math::text(", y − "),
        Math::indexed(Math::Var("c"), Math::Var("y")),
        Math::text(", f)"),
    ]);
    let line = |name: &'static str, role, [x, y]: [f64; 2], d: f64, at: [f64; 3]| {
        let [cx, cy] = rig.principal_px;
        Math::Row(vec![
            Math::Bold(name),
            Math::text(" = "),
            Math::over(
                Math::text(format!("{} m", fixed(rig.baseline_m, 3))),
                Math::text(format!("{} px", fixed(d + rig.offset_px, 2))),
            ),
            Math::text(format!(" ({}, {}, {}) px = ", fixed(x - cx, 2), fixed(y - cy, 2), fixed(rig.focal_px, 0))),
            Math::ink(role, metres(at)),
        ])
    };
    vec![
        formula,
        line("P", Role::Reference, measured.pixel, measured.disparity, motion.from),
        line("P′", Role::Measured, measured.next_pixel(), measured.next_disparity, motion.to),
        sigma_along_depth(),
    ]
}

/// The standard deviation of the scene flow along the depth, from that of a disparity.
fn sigma_along_depth() -> Math {
    let sigma = |index| Math::indexed(Math::Var("σ"), Math::Var(index));
    let both = Math::Row(vec![Math::squared(sigma("Z")), Math::text(" + "), Math::squared(sigma("Z′"))]);
    let one = Math::over(
        Math::Row(vec![Math::squared(Math::Var("Z")), Math::text(" "), sigma("d")]),
        Math::Row(vec![Math::Var("f"), Math::text(" "), Math::Var("B")]),
    );
    Math::Row(vec![
        sigma("V"),
        Math::text(" = "),
        Math::root(both),
        Math::text(", "),
        sigma("Z"),
        Math::text(" = "),
        one,
    ])
}

fn reprojection() -> Vec<Math> {
    let sum = Math::Row(vec![
        Math::text("E(R, t) = "),
        Math::Sum(Box::new(Math::Var("i"))),
        Math::text("(x′ − x̂)² + (y′ − ŷ)² + (d′ − d̂)²,   (x̂, ŷ, d̂) = projection of R P + t"),
    ]);
    vec![sum]
}

fn sample_told(draw: &Draw, fit: Option<Fit>, settings: &EgoSettings) -> Sentence {
    let said = Sentence::default();
    let Some(fit) = fit else {
        return said.text(format!(
            "Sample {}: its three points determine no rigid motion, as they lie on a line or one of them is wrong.",
            grouped(draw.drawn)
        ));
    };
    let said = said
        .text(format!("Sample {}: the rigid motion through ", grouped(draw.drawn)))
        .ink(Role::Reference, "three points")
        .text(format!(" turns the scene by {} and shifts it by {}. ", degrees(&fit.pose), metres(fit.pose.translation)))
        .ink(Role::Best, format!("{} points", grouped(fit.score.inliers)))
        .text(format!(" agree with it to {} px", fixed(settings.threshold.into(), 2)));
    match draw.best {
        Some(best) if best == fit && draw.needed == settings.iterations => said.text(format!(
            ": the best so far. All {} samples that are allowed are drawn.",
            grouped(settings.iterations)
        )),
        Some(best) if best == fit => said.text(format!(
            ": the best so far, so {} samples are enough to draw one without outliers with a probability of 99.9 %.",
            grouped(draw.needed)
        )),
        Some(best) => {
            said.text(format!(", fewer or with larger errors than the {} of the best.", grouped(best.score.inliers)))
        }
        None => said.text("."),
    }
}

fn draw_facts(draw: &Draw) -> Vec<Fact> {
    let mut facts = vec![Fact::new("Samples", format!("{} of {}", grouped(draw.drawn), grouped(draw.needed)), None)];
    if let Some(fit) = draw.fit {
        facts.push(Fact::new("Inliers", grouped(fit.score.inliers), Some(Role::Best)));
        facts.push(Fact::new("Reprojection error (RMS)", format!("{} px", fixed(fit.rms_px(), 3)), None));
    }
    facts.extend(
        draw.best.map(|best| Fact::new("Best so far", format!("{} inliers", grouped(best.score.inliers)), None)),
    );
    facts
}

/// Inliers of each sample and of the best one.
fn history(events: &[Event]) -> Readout {
    let draws: Vec<&Draw> = events
        .iter()
        .filter_map(|event| match event {
            Event::Draw(draw) if draw.sample.is_some() => Some(&**draw),
            _ => None,
        })
        .collect();
    let inliers = |fit: Option<Fit>| fit.map_or(0.0, |fit| fit.score.inliers as f32);
    let line = |of: &dyn Fn(&Draw) -> Option<Fit>| {
        draws.iter().enumerate().map(|(i, draw)| [(i + 1) as f32, inliers(of(draw))]).collect::<Vec<_>>()
    };
    Readout::Series(Series {
        title: "Inliers of the samples",
        x_label: "sample",
        y_label: "points",
        x_max: draws.last().map_or(1, |draw| draw.needed.max(draw.drawn)),
        lines: vec![
            ("sample", Role::Candidate, line(&|draw| draw.fit)),
            ("best so far", Role::Best, line(&|draw| draw.best)),
        ],
        events: (1..=draws.len()).collect(),
        decimals: Some(0),
        ..Series::default()
    })
}

fn square(symbol: &'static str, name: &'static str, entries: [[f64; 3]; 3]) -> Matrix {
    Matrix {
        symbol,
        name,
        role: None,
        entries: Grid::from_fn(3, 3, |x, y| entries[y][x]),
        rows: Vec::new(),
        columns: Vec::new(),
        changed: None,
        decimals: None,
    }
}

fn vector(symbol: &'static str, name: &'static str, entries: [f64; 3], role: Option<Role>) -> Matrix {
    Matrix {
        role,
        entries: Grid::from_fn(1, 3, |_, y| entries[y]),
        rows: ["X", "Y", "Z"].map(str::to_owned).to_vec(),
        decimals: Some(3),
        ..square(symbol, name, [[0.0; 3]; 3])
    }
}
