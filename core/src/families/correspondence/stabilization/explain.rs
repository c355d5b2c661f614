//! The explanation and the drawing of video stabilisation.

use super::{Event, Stabilization, Stable, State, line};
use crate::methods::camera_path::explain::value as path;
use crate::methods::camera_path::{
    chain_step, conclude, displacement, draw_link, draw_outline, estimate_step, outline, path_series,
};
use crate::products::Views;
use crate::products::model::{IDENTITY, inverse, mapped};
use crate::products::path::{PathErrors, middle};
use crate::products::registration::{Window, registered};
use crate::run::Seen;
use crate::scene::{Canvas, Matrix, Name, Picture, Readout, Role, Scene, Step, Unit};
use crate::{cases, variables};

/// More of the picture empty than this is much.
const MUCH_EMPTY: f64 = 0.1;
/// A smaller empty share of a stabilised frame is not mentioned.
const LEAST_EMPTY: f64 = 5e-4;
/// Error at the corners in px above which a motion is not that of the background.
const FOREIGN_PX: f64 = 1.0;
/// A jitter below this share of that before is suppressed well.
const SUPPRESSED: f64 = 0.5;

variables! {
    /// The standard deviation of the Gaussian weights of the frames.
    SMOOTHING: "Smoothing σ", r"\sigma", Unit::new("frames", 1);
    /// The place of the centre of the frame in the stabilised one.
    CENTER: "Centre of the frame to", "", Unit::PX, Role::Result;
    /// The displacement of the centre of the frame to the smoothed path.
    SHIFT: "Shift", "", Unit::PX, Role::Result;
    /// The share of the stabilised frame that is empty.
    EMPTY: "Empty", "", Unit::PERCENT, Role::Rejected;
    /// The share of the stabilised frames that is empty, on average.
    MEAN_EMPTY: "Mean empty share", "", Unit::PERCENT;
    /// The jitter of the path before smoothing.
    JITTER_BEFORE: "Jitter before", "", Unit::PX;
    /// The jitter of the path after smoothing.
    JITTER: "Jitter", "", Unit::PX;
    /// The jitter that is left by the true motion of the background.
    TRUE_JITTER: "True jitter", "", Unit::PX;
    /// The largest error of the motion of a pair at the corners.
    MOTION_ERROR: "Error of a motion", "", Unit::PX;
    /// The number of frames without a place on the smoothed path.
    UNSMOOTHED: "Without a smoothed place", "", Unit::count("frame");
}

cases! { over value, path;
    OPENING: "Stabilisation first estimates the motion of the background between all consecutive frames and chains it to the path of the camera. \
              Then it smooths the path and warps each frame to its smoothed place.",
    NO_PLACE: "Frame {frame} has {rejected|no place on the smoothed path}: a map between it and one of its neighbours has no inverse. It stays where \
               it is; less smoothing or a simpler motion model helps.",
    SMOOTHED: "The path is averaged around frame {frame} with Gaussian weights of σ = {smoothing}. The centre of the frame moves by {shift} to the \
               smoothed path: the shake is removed; a steady pan stays.",
    WARPED: "Frame {frame} is warped by S.",
    COVERS: "It covers the whole stabilised frame.",
    EMPTY: "{empty} of the stabilised frame is empty, because the frame does not cover it; zoom hides that.",
    UNKNOWN_ERRORS: "End of the run: the errors of the path are unknown. {read_error}.",
    TOO_SHORT: "End of the run: with fewer than three frames there is no jitter to suppress.",
    JITTER: "End of the run: the jitter of the path falls from {jitter_before} to {jitter}.",
    MORE_SMOOTHING: "More smoothing would suppress more of it.",
    BY_TRUTH: "Measured by the true motion of the background, it is {true_jitter}",
    DRIFT: ", and at the end of the chained path the corners are up to {drift} off.",
    END: ".",
    FOREIGN: "The motion of a pair is up to {motion_error} off at the corners: a large object, parallax or a motion that the model does not have, as a \
              rotation for a translation, dominates it, so it is not that of the background.",
    MUCH_EMPTY: "On average {mean_empty} of the frames is empty; less smoothing or zoom helps.",
    UNSMOOTHED: "Without a smoothed place: {unsmoothed}.",
}

impl Stabilization {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let (chain, name) = (&seen.before.chain, self.motion.estimator().info().name);
        match seen.events.last() {
            None => Step::at(line::EACH_PAIR).say(case::OPENING),
            Some(Event::Estimated(link)) => estimate_step(chain, link, (name, seen.clip)),
            Some(Event::Chained(link)) => {
                chain_step([chain, &seen.after.unwrap_or(seen.before).chain], link, seen.clip)
            }
            Some(Event::Smoothed(stable)) => {
                let step = self.frame_step(line::SMOOTH, seen, stable);
                step.say(if stable.is_smoothed { case::SMOOTHED } else { case::NO_PLACE })
            }
            Some(Event::Warped(stable)) => {
                let step = self.frame_step(line::WARP, seen, stable).say(case::WARPED);
                let step = step.say(if stable.empty() < LEAST_EMPTY { case::COVERS } else { case::EMPTY });
                match seen.after.filter(|after| after.corrections.len() == after.chain.to_frames.len()) {
                    Some(after) => conclude_run(step, seen, after),
                    None => step,
                }
            }
        }
    }

    /// A step of a frame with its numbers, its maps and the path.
    fn frame_step(&self, line: Name, seen: &Seen<Self>, stable: &Stable) -> Step {
        let (chain, index) = (&seen.before.chain, seen.before.corrections.len());
        let center = mapped(&stable.correction, middle(chain.picture)).unwrap_or([f64::NAN; 2]);
        let matrices = vec![
            Matrix::of_rows("P", "from the first frame", &chain.to_frames[index]).with_role(Role::Measured),
            Matrix::of_rows("S", "to the stabilised frame", &stable.correction).with_role(Role::Result),
        ];
        let corrections = [&seen.before.corrections[..], &[stable.correction]].concat();
        let step = Step::at(line).fact(path::FRAME, chain.span.first + index).fact(value::SMOOTHING, self.smoothing);
        let step = step.fact(value::CENTER, center).fact(value::EMPTY, 100.0 * stable.empty());
        let step = step.put(value::SHIFT, displacement(&stable.correction, chain.picture));
        let step = step.formula(r"S(t) = \sum_k w(k) \, P(t + k) \, P(t)^{-1}").show(Readout::Matrices(matrices));
        step.show_all(path_series(chain, &corrections, seen.clip))
    }

    pub(super) fn draw_step(&self, seen: &Seen<Self>, scene: &mut Scene) {
        match seen.events.last() {
            None => {}
            Some(Event::Estimated(link) | Event::Chained(link)) => draw_link(&seen.before.chain, link, scene),
            Some(Event::Smoothed(stable) | Event::Warped(stable)) => {
                let size = stable.frame.size();
                draw_kept(stable, scene);
                let (frame, back) = (stable.frame.clone(), inverse(&stable.correction).unwrap_or(IDENTITY));
                let made = move || registered(&frame, &back, &Window::of(size));
                scene.pictures = vec![Canvas::of_clip(Picture::CURRENT), Canvas::made(Picture::warped(0), made)];
            }
        }
    }
}

fn conclude_run(step: Step, seen: &Seen<Stabilization>, after: &State) -> Step {
    let PathErrors { before_px, after_px, drift_px, motion_px, residual_px, empty } =
        match after.chain.field(&after.corrections, Views::None).errors(seen.clip) {
            Ok(errors) => errors,
            Err(error) => return step.put(path::READ_ERROR, error.to_string()).say(case::UNKNOWN_ERRORS),
        };
    let step = match before_px.zip(after_px) {
        None => step.say(case::TOO_SHORT),
        Some((before, left)) => {
            let is_shaky = left > SUPPRESSED * before && before > 0.1;
            let step = step.put(value::JITTER_BEFORE, before).put(value::JITTER, left).say(case::JITTER);
            step.say_if(is_shaky, case::MORE_SMOOTHING)
        }
    };
    let step = match (residual_px, drift_px.filter(|drift| drift.is_finite())) {
        (None, _) => step,
        (Some(residual), None) => step.put(value::TRUE_JITTER, residual).say(case::BY_TRUTH).say(case::END),
        (Some(residual), Some(drift)) => {
            let step = step.put(value::TRUE_JITTER, residual).put(path::DRIFT, drift);
            step.say(case::BY_TRUTH).say(case::DRIFT)
        }
    };
    let step = match motion_px.filter(|motion| *motion > FOREIGN_PX) {
        Some(motion) => step.put(value::MOTION_ERROR, motion).say(case::FOREIGN),
        None => step,
    };
    let step = match empty.filter(|empty| *empty > MUCH_EMPTY) {
        Some(empty) => step.put(value::MEAN_EMPTY, 100.0 * empty).say(case::MUCH_EMPTY),
        None => step,
    };
    let step = conclude(step, &after.chain).put(value::UNSMOOTHED, after.unsmoothed);
    step.say_if(after.unsmoothed > 0, case::UNSMOOTHED)
}

/// The part of the frame that the stabilised one shows, and the outline of the frame in it.
fn draw_kept(stable: &Stable, scene: &mut Scene) {
    let outline = |map| outline(map, stable.frame.size());
    let back = inverse(&stable.correction);
    let meaning = "field of view of the stabilised frame";
    draw_outline(scene, Picture::CURRENT, (Role::Result, meaning), back.as_ref().and_then(outline));
    draw_outline(scene, Picture::warped(0), (Role::Window, "outline of frame t"), outline(&stable.correction));
}
