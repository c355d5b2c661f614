//! The steps of scene flow in values, words and formulas.

mod drawing;

use std::sync::Arc;

use super::charts::{history, motion_matrices, vector};
use super::vocabulary::{case, value};
use super::{Depths, Event, Part, SceneFlow, Source, line, space};
use crate::data::{Calibration, Disparity, Pose};
use crate::geometry::Grid;
use crate::methods::scene_flow::{Draw, FEWEST, Fit};
use crate::methods::stereo::value::PIXEL;
use crate::methods::stereo::{Settings, Views, add_warning};
use crate::products::scene_flow::scene_flow_error;
use crate::products::{Reference, SceneFlowField};
use crate::run::Seen;
use crate::scene::{Matrix, Name, Readout, Role, Sentence, Step};

fn length(vector: [f64; 3]) -> f64 {
    vector.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// The pixel that a step explains, with the field of the run so far.
struct Shown {
    field: SceneFlowField,
    pixel: (usize, usize),
}

impl Shown {
    /// A step with the known values of the pixel.
    fn step(&self, line: Name) -> Step {
        let (x, y) = self.pixel;
        let step = Step::at(line).fact(PIXEL, self.pixel).fact_if(value::DISPARITY, self.field.disparity.at(x, y));
        step.fact_if(value::FLOW, self.field.flow.at(x, y))
    }
}

impl SceneFlow {
    /// The pixel pointed at, else the middle of the current row or of the picture.
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

    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let Some(event) = seen.events.last() else { return starting(seen) };
        let shown = self.shown(seen);
        let step = match event {
            Event::Whole(Part::Disparity) => self.tell_disparity(&shown, seen),
            Event::Whole(Part::NextDisparity) => self.tell_next(&shown, seen),
            Event::Whole(_) => self.tell_flow(&shown, seen),
            Event::Row(Part::Positions, _) => tell_position(&shown),
            Event::Row(..) => self.tell_own(&shown),
            Event::Opened(counts) => self.tell_opening(&shown, *counts, seen.point().is_some()),
            Event::Draw(draw) => self.tell_draw(&shown, seen, draw),
            Event::NoEgo if seen.before.consensus.is_some() => shown.step(line::OWN).say(case::EGO_UNKNOWN),
            Event::NoEgo => {
                let points = seen.after.unwrap_or(seen.before).points.len();
                shown
                    .step(line::SAMPLE)
                    .put(value::FEWEST_POINTS, FEWEST)
                    .put(value::POINTS, points)
                    .say(case::TOO_FEW_POINTS)
            }
        };
        let step = match seen.point() {
            None if self.is_over(seen) => {
                let step = conclude(step, seen, &shown.field);
                step.show_all(self.error_plot(seen, &shown.field))
            }
            _ => step,
        };
        let has_depths = shown.field.disparity.0.cells().iter().any(|d| d.is_finite());
        let has_positions = shown.field.calibration.is_some() && has_depths;
        step.show_all(has_positions.then(|| Readout::Cloud(space::cloud(shown.field, shown.pixel))))
    }

    fn is_over(&self, seen: &Seen<Self>) -> bool {
        seen.after.is_some_and(|after| after.done == self.parts(&after.fixed).len())
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

    fn tell_disparity(&self, shown: &Shown, seen: &Seen<Self>) -> Step {
        let (field, (x, y)) = (&shown.field, shown.pixel);
        let density = 100.0 * field.disparity.known() as f64 / field.picture.luma().cells().len() as f64;
        let step = shown.step(line::DISPARITY).put(value::METHOD, self.depths_of(seen)).put(value::DENSITY, density);
        let step = step.say(case::DISPARITIES).formula(r"Z = \frac{f \, B}{d}");
        let Some(d) = field.disparity.at(x, y).map(f64::from) else {
            return step.say(match (self.source, seen.before.fixed.depths) {
                (Source::Truth, _) => case::TRUTH_UNKNOWN,
                (_, Depths::Sensor) => case::NOT_SENSED,
                _ => case::NOT_MATCHED,
            });
        };
        let Some((rig, depth)) = field.calibration.and_then(|rig| Some((rig, rig.depth_m(d)?))) else {
            return step.say(case::MATCHED);
        };
        let step = step.put(value::DEPTH, depth).put(value::SHIFT, d + rig.offset_px).say(case::AT_DEPTH);
        put_rig(step, &rig).formula(r"Z = \frac{{focal:unit} \cdot {baseline:unit}}{{shift:unit}} = {depth:unit}")
    }

    fn tell_next(&self, shown: &Shown, seen: &Seen<Self>) -> Step {
        let map = seen.after.and_then(|after| after.next.as_ref());
        let known = map.map_or(0.0, |map| map.known() as f64 / map.0.cells().len().max(1) as f64);
        let step = shown.step(line::NEXT_DISPARITY).put(value::METHOD, self.depths_of(seen));
        step.put(value::DENSITY, 100.0 * known).say(match self.source {
            Source::Truth => case::NEXT_TRUTH,
            Source::Estimated => case::NEXT_DISPARITIES,
        })
    }

    fn tell_flow(&self, shown: &Shown, seen: &Seen<Self>) -> Step {
        let (x, y) = shown.pixel;
        let name = self.method(self.flow.estimator().info().name);
        let step = shown.step(line::FLOW).put(value::METHOD, name);
        let step = match shown.field.flow.at(x, y) {
            Some([u, v]) => step.put(value::TARGET, [x as f32 + u, y as f32 + v]).say(case::MOVES),
            None => step.say(case::NO_FLOW),
        };
        step.say_if(self.is_over(seen), case::ENDS)
    }

    fn tell_draw(&self, shown: &Shown, seen: &Seen<Self>, draw: &Draw) -> Step {
        let step = Step::at(if draw.sample.is_some() { line::SAMPLE } else { line::REFIT });
        let step = step.fact(value::SAMPLES, draw.drawn).fact(value::NEEDED, draw.needed);
        let step = step.fact_if(value::INLIERS, draw.fit.map(|fit| fit.score.inliers));
        let step = step.fact_if(value::RMS, draw.fit.map(|fit| fit.rms_px()));
        let step = step.fact_if(value::BEST_INLIERS, draw.best.map(|best| best.score.inliers));
        let step = match (draw.sample, draw.fit) {
            (Some(_), Some(fit)) => self.tell_sample(step, draw, &fit),
            (Some(_), None) => step.say(case::NO_MOTION),
            (None, Some(_)) if draw.fit == draw.best => step.say(case::REFITTED),
            (None, Some(_)) => step.say(case::CONVERGED),
            (None, None) => step.say(case::NO_REFIT),
        };
        let step = match shown.field.ego.filter(|_| seen.after.is_some()) {
            Some(ego) => {
                let agreeing = 100.0 * ego.inliers as f64 / ego.points.max(1) as f64;
                let step = step.put(value::CAMERAS, ego.camera_m()).put(value::AGREEING, agreeing);
                let step = step.put(value::ROTATION, ego.pose.angle_rad().to_degrees()).say(case::EGO);
                step.say_if(!ego.is_of_majority(), case::MINORITY)
            }
            None => step,
        };
        let step = step.formula(
            r"E(R, t) = \sum_i (x' - \hat{x})^2 + (y' - \hat{y})^2 + (d' - \hat{d})^2, \quad
              (\hat{x}, \hat{y}, \hat{d}) = \text{projection of } R \, P + t",
        );
        let pose = if draw.sample.is_some() { draw.fit } else { draw.best }.map(|fit| fit.pose);
        let covariance = seen.after.and_then(|after| after.consensus.as_ref()?.covariance);
        step.show_all(pose.map(|pose| motion_matrices(&pose, covariance))).show(history(seen.events))
    }

    /// Tells the rigid motion of a sample, and how it compares with the best.
    fn tell_sample(&self, step: Step, draw: &Draw, fit: &Fit) -> Step {
        let step = step.put(value::ROTATION, fit.pose.angle_rad().to_degrees());
        let step = step.put(value::TRANSLATION, fit.pose.translation).put(value::THRESHOLD, self.ego.threshold);
        let step = step.put(value::ALLOWED, self.ego.iterations).say(case::SAMPLE);
        step.say(match draw.best {
            Some(best) if best == *fit && draw.needed == self.ego.iterations => case::BEST_OF_ALL,
            Some(best) if best == *fit => case::BEST,
            Some(_) => case::WORSE,
            None => case::STOP,
        })
    }

    fn tell_own(&self, shown: &Shown) -> Step {
        let (Some(motion), field) = (shown.field.motion(shown.pixel), &shown.field) else {
            return shown.step(line::SKIP).say(case::NOT_JUDGED);
        };
        let (Some(ego), Some(distance)) = (field.ego, self.own_squared(field, shown.pixel)) else {
            return shown.step(line::OWN).say(case::WITHOUT_EGO);
        };
        let (own, prediction) = (motion.own(&ego.pose), ego.pose.moved(motion.from));
        let step = Step::at(line::OWN).fact(PIXEL, shown.pixel).fact(value::REMAINING, length(own));
        let step = step.fact(value::DISTANCE, distance).fact(value::GATE, self.gate);
        let step = step.put(value::PREDICTION, prediction).put(value::REMAINDER, own).say(case::REMAINS);
        let step = step.say(match self.is_beyond(distance) {
            true if !ego.is_of_majority() => case::AGAINST_MINORITY,
            true => case::OWN_MOTION,
            false => case::AT_REST,
        });
        step.show(Readout::Matrices(vec![
            vector("P′", "position in frame t + 1, in m", motion.to).with_role(Role::Measured),
            vector("RP+t", "prediction for a point at rest, in m", prediction).with_role(Role::Predicted),
            vector("r", "remaining motion, in m", own).with_role(Role::Error),
            Matrix::of_rows("Σ", "covariance of r, in m²", &motion.covariance(&ego.pose, &field.sigma)),
        ]))
    }

    fn tell_opening(&self, shown: &Shown, [before, after]: [u32; 2], is_pointed: bool) -> Step {
        // A pixel pointed at keeps its numbers.
        let step = if is_pointed { self.tell_own(shown) } else { shown.step(line::OPEN) };
        let step = Step { line: line::OPEN, sentence: Sentence::default(), ..step };
        let step = step.put(value::BEYOND, before).put(value::KEPT, after).put(value::SIDE, 2 * self.opening + 1);
        step.say(if self.opening == 0 { case::NOT_OPENED } else { case::OPENED })
    }
}

/// Explains the beginning of a run: the input and the method, or the input that is missing.
fn starting(seen: &Seen<SceneFlow>) -> Step {
    let (depths, rig) = (seen.before.fixed.depths, seen.before.fixed.calibration);
    let step = Step::at(line::TAKE_VIEWS);
    let step = if let Some(rig) = rig { put_rig(step, &rig) } else { step };
    let step = step.say(match (depths, rig) {
        (Depths::Unknown, _) => case::NO_DEPTHS,
        (Depths::Stereo, None) => case::NOT_CALIBRATED,
        (Depths::Sensor, None) => case::NO_FOCAL_LENGTH,
        (Depths::Stereo, Some(_)) => case::TWO_VIEWS,
        (Depths::Sensor, Some(_)) => case::DEPTH_SENSOR,
    });
    add_warning(step, swapped(seen))
}

/// Puts focal length and baseline.
fn put_rig(step: Step, rig: &Calibration) -> Step {
    step.put(value::FOCAL, rig.focal_px).put(value::BASELINE, rig.baseline_m)
}

/// The warning about views that seem to be swapped or not rectified, if there is one.
fn swapped(seen: &Seen<SceneFlow>) -> Option<String> {
    let fixed = &seen.before.fixed;
    let views = (fixed.depths == Depths::Stereo).then(|| Views::new(seen.clip, fixed.frame).ok()).flatten()?;
    views.warning(Settings::default().disparities)
}

fn conclude(step: Step, seen: &Seen<SceneFlow>, field: &SceneFlowField) -> Step {
    let percent = |count: usize| 100.0 * count as f64 / field.picture.luma().cells().len().max(1) as f64;
    let step = add_warning(step, swapped(seen)).put(value::DENSITY, percent(field.known())).say(case::KNOWN);
    let is_doubtful = field.ego.is_some_and(|ego| !ego.is_of_majority());
    let step = match &field.moving {
        Some(_) if is_doubtful => step.say(case::DOUBTFUL),
        Some(moving) if moving.count() > 0 => step.put(value::MOVING, percent(moving.count())).say(case::SOME_MOVE),
        Some(_) => step.say(case::NONE_MOVES),
        None => {
            let is_new = field.calibration.is_some() && !step.is(case::EGO_UNKNOWN);
            step.say(case::STOP).say_if(is_new, case::EGO_UNKNOWN)
        }
    };
    let reference = Reference { clip: seen.clip, frame: seen.before.fixed.frame };
    // Truth that cannot be read is reported where the product is assessed.
    let error = scene_flow_error(field, &reference).unwrap_or_default();
    let step = match (error.epe_m, error.median_percent) {
        (Some(epe), Some(median)) => {
            step.put(value::MEDIAN_ERROR, median).put(value::MEAN_ERROR, epe).say(case::ERRORS)
        }
        _ => step,
    };
    match error.ego {
        Some([_, off]) => step.put(value::CAMERA_ERROR, off).say(case::CAMERA_ERROR),
        None => step,
    }
}

fn tell_position(shown: &Shown) -> Step {
    let (field, (x, y)) = (&shown.field, shown.pixel);
    let Some(measured) = field.measured(shown.pixel) else {
        return shown.step(line::SKIP).say(match (field.disparity.at(x, y), field.flow.at(x, y)) {
            (None, _) => case::SKIP_DISPARITY,
            (_, None) => case::SKIP_FLOW,
            _ => case::SKIP_NEXT,
        });
    };
    let step = shown.step(line::TRIANGULATE).fact(value::NEXT_DISPARITY, measured.next_disparity);
    let (Some(rig), Some(motion)) = (field.calibration, field.motion(shown.pixel)) else {
        let why = if field.calibration.is_none() { case::WITHOUT_DEPTH } else { case::AT_INFINITY };
        return step.say(case::BOTH_DISPARITIES).say(why);
    };
    let (flow, covariance) = (motion.displacement(), motion.covariance(&Pose::IDENTITY, &field.sigma));
    let step = step.put(value::POSITION, motion.from).put(value::NEXT_POSITION, motion.to);
    let step = step.put(value::SCENE_FLOW, flow).put(value::SIGMA_Z, covariance[2][2].sqrt()).say(case::DISPLACED);
    let seen_at = |step: Step, [x, y]: [f64; 2], disparity: f64| {
        let step = step.put(value::OFFSET_X, x - rig.principal_px[0]).put(value::OFFSET_Y, y - rig.principal_px[1]);
        step.put(value::SHIFT, disparity + rig.offset_px)
    };
    let line = |point: &str, position: &str| {
        let factor = r"\frac{{baseline:unit}}{{shift:unit}} \, ({offset_x}, {offset_y}, {focal}) \, \text{px}";
        format!(r"\mathbf{{P}}{point} = {factor} = {position}")
    };
    let step = put_rig(step, &rig).formula(r"\mathbf{P} = \frac{B}{d} \, (x - c_x, y - c_y, f)");
    let step = seen_at(step, measured.pixel, measured.disparity).formula(line("", "{position:unit}"));
    let step = seen_at(step, measured.next_pixel(), measured.next_disparity).formula(line("'", "{next_position:unit}"));
    let step = step.formula(r"\sigma_V = \sqrt{\sigma_Z^2 + \sigma_{Z'}^2}, \sigma_Z = \frac{Z^2 \, \sigma_d}{f \, B}");
    step.show(Readout::Matrices(vec![
        vector("P", "position in frame t, in m", motion.from).with_role(Role::Reference),
        vector("P′", "position in frame t + 1, in m", motion.to).with_role(Role::Measured),
        vector("V", "scene flow, in m", flow).with_role(Role::Result),
        Matrix::of_rows("Σ", "covariance of the scene flow, in m²", &covariance),
    ]))
}
