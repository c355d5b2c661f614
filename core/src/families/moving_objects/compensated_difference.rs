//! Motion-compensated difference: the previous frame, warped by the camera motion, is the background.

use std::sync::{Arc, OnceLock};

use crate::base::{Error, Threads};
use crate::data::{Clip, Frame, Mask};
use crate::geometry::Grid;
use crate::methods::camera_path::{Refused, displacement, refusal, usable};
use crate::methods::subtraction::{
    self, Background, CameraMotion, Cases, Comparison, Differencing, Explanation, Exposure, Found, Probe, Settings,
    Setup, Steadiness, automatic_threshold, difference_rule, displaced, noise_of, subtraction_pseudocode,
};
use crate::products::model::{IDENTITY, Matrix3, inverse, product};
use crate::products::registration::{gray_at, inside};
use crate::products::{ModelField, Support};
use crate::run::{GlobalModel, Info, Need, Stage, StageView};
use crate::scene::{Case, Chart, Matrix, Readout, Role, Step, Unit};
use crate::{cases, params, variables};

params! {
    /// Motion-compensated difference: moving objects before a moving camera.
    pub struct CompensatedDifference {
        /// Method of the motion of the background, from the previous frame to the present one.
        motion: Stage<GlobalModel> = Stage::named("global-motion").with("model", "similarity").with("detector.double", "off");
        /// Number of frames that are compared: two-frame or three-frame differencing, each frame warped to the present one.
        differencing: Differencing = Differencing::Three;
        /// Difference threshold in gray levels. Pixels with a larger difference are foreground. 0 chooses 4 standard deviations of the
        /// noise, which the median absolute difference gives (1.4826 times the median), and at least 8.
        threshold: usize = 0, 0..=255;
        /// Radius of the shake suppression. A foreground pixel that fits the warped frame within this radius is an error of the registration;
        /// 0 turns it off.
        shake: usize = 1, 0..=3, "px";
        /// The parameters of all background subtractions.
        settings: Settings = Settings { opening: 0, area_opening: 9, closing: 4, ..Settings::default() };
    }
}

/// A previous frame with the map from it to the latest previous frame.
#[derive(Clone)]
struct Earlier {
    frame: Arc<Frame>,
    to_latest: Matrix3,
}

/// The previous frames, the latest one first, and their comparison with the present one once that is computed.
#[derive(Clone)]
pub struct Model {
    before: Vec<Earlier>,
    compared: OnceLock<Arc<Registered>>,
}

/// The previous frames in the coordinates of the present one.
struct Registered {
    /// The map from the latest previous frame to the present one.
    motion: Matrix3,
    is_usable: bool,
    /// Why the motion of the stage is not used, if so.
    refused: Option<Refused>,
    support: Option<Support>,
    /// The gray levels of each previous frame; NaN where it does not show the place.
    levels: Vec<Grid<f32>>,
    /// The threshold in gray levels.
    limit: u8,
}

impl Registered {
    /// The gray level of the previous frames that is most similar to `value`; NaN where none shows the place.
    fn nearest(&self, place: (usize, usize), value: f32) -> f32 {
        let known = self.levels.iter().map(|levels| levels[place]).filter(|level| !level.is_nan());
        known.reduce(|a, b| if (b - value).abs() < (a - value).abs() { b } else { a }).unwrap_or(f32::NAN)
    }

    /// Whether a level differs from all previous frames that show its place.
    fn differs(&self, place: (usize, usize), level: u8) -> bool {
        let value = f32::from(level);
        (self.nearest(place, value) - value).abs() > f32::from(self.limit)
    }
}

impl CompensatedDifference {
    fn steady(&self) -> Steadiness {
        Steadiness { camera: CameraMotion::Still, shake: self.shake, exposure: Exposure::Ignored }
    }

    /// Warps the previous frames to the present one by the estimate of the stage.
    fn register(&self, model: &Model, frame: &Frame, field: Option<&ModelField>) -> Registered {
        let latest = model.before.first().map(|earlier| earlier.frame.luma());
        let found = field.zip(latest).map(|(field, latest)| usable(field, [latest, frame.luma()]));
        let known = found.and_then(Result::ok);
        let motion = known.unwrap_or(IDENTITY);
        let (width, height) = frame.size();
        let level = |earlier: &Earlier| {
            let back = inverse(&product(&motion, &earlier.to_latest));
            let luma = earlier.frame.luma();
            Grid::from_fn(width, height, |x, y| {
                let at = back.as_ref().and_then(|back| inside(back, [x as f64, y as f64], (width, height)));
                at.map_or(f32::NAN, |at| gray_at(luma, at))
            })
        };
        let levels: Vec<_> = model.before.iter().map(level).collect();
        let limit = match (self.threshold, levels.first()) {
            (0, Some(latest)) => {
                let both = latest.cells().iter().zip(frame.luma().cells()).filter(|(level, _)| !level.is_nan());
                let differences = both.map(|(level, now)| (f32::from(*now) - level).abs() as u8);
                automatic_threshold(noise_of(differences))
            }
            (threshold, _) => threshold as u8,
        };
        let (support, refused) = (field.and_then(|field| field.support), found.and_then(Result::err));
        Registered { motion, is_usable: known.is_some(), refused, support, levels, limit }
    }

    /// The comparison of a frame with the previous ones.
    fn registered<'a>(&self, model: &'a Model, frame: &Frame) -> &'a Registered {
        model.compared.get_or_init(|| Arc::new(self.register(model, frame, None)))
    }
}

variables! {
    /// The name of the motion stage.
    STAGE: "", "", Unit::WHOLE;
    /// The motion of the centre of the picture.
    MOTION: "Motion of the centre", r"\mathbf{d}", Unit::PX, Role::Predicted;
    /// The pixels that the warped previous frame does not show.
    UNSEEN: "Not in the previous frame", "", Unit::new("px", 0), Role::Rejected;
    /// The matches that agree with the motion.
    INLIERS: "Inliers", "", Unit::WHOLE;
    /// The matches that the motion is estimated from.
    MATCHES: "Matches", "", Unit::WHOLE;
}

cases! { over value, subtraction::value;
    FROM_PREVIOUS: "the difference from the warped previous frame",
    FROM_BOTH: "the difference from both warped previous frames",
    REGISTERED: "{stage} from the previous frame to this one: {motion} {predicted|at the centre of the picture}. The previous \
                 frame is warped by this motion; objects with a motion of their own differ from it.",
    UNUSABLE: "{stage} from the previous frame to this one: {rejected|no usable motion}.",
    AT_REST: "The camera counts as at rest in this frame.",
    NEW_PLACE: "has come into the picture: {rejected|the previous frame does not show its place}, so it counts as background.",
    REPLACES: "this frame, with gray level {gray_level} here, becomes the reference; it is warped to the next.",
    NOT_EXPLAINED: "{differing_share} of the frame differs from the background: the motion that was found does not explain the \
                    background.",
    PARALLAX: "A scene with much depth shows parallax, and an object that covers most of the picture dominates the matches. A \
               motion model with more freedom helps against neither; compare the motion of objects with that of their \
               surroundings.",
}

subtraction_pseudocode! {
    begin: "frame 0 is the reference of frame 1",
    register: "  M ← motion of the background from frame t−1 to frame t; B ← frame t−1 warped by M",
    compare: "  d ← |I(t) − B|; with three frames the minimum with that of frame t−2, warped likewise",
    decide: "  foreground if d > threshold",
    shake: "  suppress pixels that fit B within shake",
    update: "  frame t becomes the reference of frame t+1",
}

impl Background for CompensatedDifference {
    const INFO: Info = Info {
        id: "compensated-difference",
        name: "Motion-compensated difference",
        family: "Moving objects",
        summary: "Thresholds the difference between a frame and the previous one warped by the motion of the background, so that the camera may move.",
        source: "M. Irani, B. Rousso and S. Peleg, Computing occluding and transparent motions, International Journal of Computer Vision 12(1), \
                 1994; three frames: R. Collins et al., A system for video surveillance and monitoring, CMU-RI-TR-00-12, 2000",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "stage"],
        frames: 2,
    };
    const SHOWN: &'static str =
        "|I(t) − B|; B is the previous frame warped by the motion, or the more similar of the two previous frames";
    const COMPARED: &'static str = "motion-compensated difference";
    const CHARTS: &'static [Chart] = &[Chart::Matrices, Chart::Tiles, Chart::Series];
    const IS_REPLACED: bool = true;
    const IS_REGISTERED: bool = true;
    const FLOODED: [&'static Case; 2] = [case::NOT_EXPLAINED, case::PARALLAX];
    type Model = Model;

    fn setup(&self) -> Setup {
        Setup { settings: self.settings, initial: None, steady: Some(self.steady()) }
    }

    /// The motion leads from the frame before to the frame.
    fn stage_view(&self, clip: &Clip, now: usize) -> Result<Option<StageView>, Error> {
        clip.pair_from(now.saturating_sub(1)).map(|clip| Some(StageView { clip, set: Vec::new() }))
    }

    fn displaced(&self, model: &Model, frame: &Frame, mask: &Mask) -> Option<Mask> {
        let registered = self.registered(model, frame);
        let limit = f32::from(registered.limit);
        displaced(mask, Some(self.steady()), |place, of| {
            let value = f32::from(frame.luma()[place]);
            (registered.nearest(of, value) - value).abs() <= limit
        })
    }

    fn need(&self, clip: &Clip) -> Need {
        let Need { run, .. } = self.motion.need(clip);
        // Two frames, and both registered as real numbers.
        Need { run, ..Need::per_pixel(clip, [0.0, 16.0]) }
            .and([16.0 * (clip.size().0 * clip.size().1) as f64, run as f64 / 4.0])
    }

    fn begin(&self, first: &Arc<Frame>) -> Model {
        let first = Earlier { frame: Arc::clone(first), to_latest: IDENTITY };
        Model { before: vec![first], compared: OnceLock::new() }
    }

    fn look(&self, clip: &Clip, model: &Model, frame: &Frame, threads: &Threads) -> Result<(), Error> {
        if model.compared.get().is_some() {
            return Ok(());
        }
        let Some(latest) = model.before.first() else { return Ok(()) };
        let field = self.motion.between_frames(clip, [&latest.frame, frame], threads)?;
        model.compared.get_or_init(|| Arc::new(self.register(model, frame, Some(&field))));
        Ok(())
    }

    fn subtract(&self, model: &mut Model, frame: &Arc<Frame>, _: &Threads) -> Found {
        let registered = self.registered(model, frame);
        let (width, height) = frame.size();
        let mask = Mask::from_fn(width, height, |x, y| registered.differs((x, y), frame.luma()[(x, y)]));
        let motion = registered.motion;
        let mut before = vec![Earlier { frame: Arc::clone(frame), to_latest: IDENTITY }];
        if self.differencing == Differencing::Three {
            before.extend(model.before.first().map(|latest| Earlier { to_latest: motion, ..latest.clone() }));
        }
        *model = Model { before, compared: OnceLock::new() };
        Found { mask, shadows: None }
    }

    fn expected(&self, model: &Model, place: (usize, usize)) -> f32 {
        match (model.compared.get(), model.before.first()) {
            (Some(registered), _) => registered.levels.first().map_or(f32::NAN, |latest| latest[place]),
            (None, Some(latest)) => f32::from(latest.frame.luma()[place]),
            (None, None) => f32::NAN,
        }
    }

    fn compared_with(&self, model: &Model, frame: &Frame, place: (usize, usize)) -> f32 {
        self.registered(model, frame).nearest(place, f32::from(frame.luma()[place]))
    }

    fn difference(&self, model: &Model, frame: &Frame, place: (usize, usize)) -> f32 {
        (f32::from(frame.luma()[place]) - self.compared_with(model, frame, place)).abs()
    }

    fn comparison(&self, step: Step, model: &Model, frame: &Frame) -> (Step, Cases) {
        let registered = self.registered(model, frame);
        let unseen = registered
            .levels
            .first()
            .map_or(frame.luma().cells().len(), |all| all.cells().iter().filter(|level| level.is_nan()).count());
        let step = step
            .put(value::STAGE, self.motion.estimator().info().name)
            .fact(value::MOTION, displacement(&registered.motion, frame.size()))
            .fact_of(subtraction::value::THRESHOLD.is(registered.limit).in_unit(Unit::LEVEL))
            .fact(value::UNSEEN, unseen)
            .fact_if(value::INLIERS, registered.support.map(|support| support.inliers))
            .fact_if(value::MATCHES, registered.support.map(|support| support.matches))
            .show(Readout::Matrices(vec![
                Matrix::of_rows("M", "motion of the background", &registered.motion).with_role(Role::Predicted),
            ]));
        match registered.refused {
            _ if registered.is_usable => (step, vec![case::REGISTERED]),
            None => (step, vec![case::UNUSABLE, case::AT_REST]),
            Some(refused) => {
                let (step, why) = refusal(step, refused);
                (step, vec![case::UNUSABLE, why, case::AT_REST])
            }
        }
    }

    fn explain(&self, step: Step, probe: &Probe<Model>) -> Explanation {
        let &Probe { before, after, frame, place } = probe;
        let (registered, level) = (self.registered(before, frame), frame.luma()[place]);
        let nearest = registered.nearest(place, level.into());
        let update = after.map(|_| case::REPLACES).into_iter().collect();
        if nearest.is_nan() {
            let step = step.put(subtraction::value::GRAY_LEVEL, level);
            return Explanation { step, verdict: vec![case::NEW_PLACE], update };
        }
        let comparison = Comparison {
            pixel: vec![level],
            background: vec![nearest],
            after: None,
            threshold: subtraction::value::THRESHOLD.is(registered.limit),
            is_foreground: registered.differs(place, level),
        };
        Explanation { update, ..comparison.explained(step) }
    }

    fn rule(&self, step: Step) -> (Step, Cases) {
        let is_two = self.differencing == Differencing::Two;
        let from = if is_two { case::FROM_PREVIOUS } else { case::FROM_BOTH };
        difference_rule(step, self.threshold, [from, subtraction::case::END])
    }

    fn at_rest(&self, model: &Arc<Model>) -> Arc<Model> {
        Arc::new(Model { before: model.before.clone(), compared: OnceLock::new() })
    }

    fn model_bytes(&self, model: &Model) -> usize {
        let of = |earlier: &Earlier| earlier.frame.bytes() + earlier.frame.luma().cells().len() * size_of::<f32>();
        model.before.iter().map(of).sum()
    }
}
