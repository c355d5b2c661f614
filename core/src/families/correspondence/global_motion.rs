//! The global motion of a pair of frames: one transformation of the plane for all matches.

mod mosaic;
mod vocabulary;

use mosaic::{mosaic, outlines};
use vocabulary::{case, value};

use crate::geometry::Gray;
use crate::methods::camera_path::differences;
use crate::methods::geometric::{
    Correspondence,
    fit::{across_horizon, fit, is_on_line, squared_errors},
    refine::least_squares,
    robust::{self, Best, Estimate, Place, RobustModel, robust_pseudocode},
    system::System,
};
use crate::methods::matching;
use crate::params;
use crate::products::model::{Matrix3, Model, mapped};
use crate::products::{ModelField, Output, Product, ProductKind, Support, metrics};
use crate::run::Info;
use crate::scene::{Canvas, Focus, Name, Picture, PictureRole, Role, Scene, Shape, Step};

params! {
    /// One transformation that maps frame t to frame t + 1: RANSAC over matched keypoints.
    pub struct GlobalMotion {
        /// Model of the motion.
        model: Model = Model::Homography;
        /// Detector, descriptor and tests of the matches.
        matching: matching::Settings = matching::Settings::default();
        /// Parameters of random sample consensus.
        robust: robust::Settings = robust::Settings::default();
    }
}

/// Inliers within a smaller share of the picture may belong to a single object.
const SMALL_HULL: f64 = 0.25;

/// A registration that raises the mean difference above this multiple does harm; interpolation alone changes it by less.
const HARMFUL: f64 = 1.05;

/// Frames registered in the coordinates of frame t.
const MOSAIC: Picture = Picture { role: PictureRole::Mosaic, ..Picture::CURRENT };

robust_pseudocode!(
    "  H ← the model through the sample",
    "  count the inliers: matches with |x′ − H x| at most the threshold",
    "fit H to all inliers by least squares of |x′ − H x|; again while the cost falls",
    REGISTER: "register frame t+1 in the coordinates of frame t by H⁻¹, and blend both: the mosaic"
);

impl RobustModel for GlobalMotion {
    const INFO: Info = Info {
        id: "global-motion",
        name: "Global motion (RANSAC)",
        family: "Correspondence",
        summary: "One transformation for the whole picture, estimated from matches of which some are wrong.",
        source: "M. A. Fischler and R. C. Bolles, Random sample consensus, Communications of the ACM 24(6), 1981; R. Hartley and A. Zisserman, \
                 Multiple view geometry in computer vision, 2004, chapter 4",
        pseudocode: line::ALL,
        granularities: &["frame", "iteration", "step"],
        frames: 2,
    };
    const PRODUCT: &'static ProductKind = ModelField::KIND;
    const SYMBOL: &'static str = "H";
    const DISTANCE: &'static str = "distance |x′ − H x|";

    fn matching(&self) -> &matching::Settings {
        &self.matching
    }

    fn settings(&self) -> &robust::Settings {
        &self.robust
    }

    fn name(&self) -> &'static str {
        match self.model {
            Model::Translation => "translation",
            Model::Rigid => "rigid motion",
            Model::Similarity => "similarity",
            Model::Affine => "affine map",
            Model::Homography => "homography",
        }
    }

    fn sample_size(&self) -> usize {
        self.model.sample_size()
    }

    fn counting(&self, step: Step) -> Step {
        step.put(value::FREEDOM, self.model.freedom()).say(case::COUNTING)
    }

    fn hypotheses(&self, sample: &[Correspondence]) -> Vec<Matrix3> {
        fit(self.model, sample).into_iter().collect()
    }

    fn no_model(&self, step: Step, sample: &[Correspondence]) -> Step {
        let is_split = self.model == Model::Homography && !is_on_line(sample);
        match across_horizon(sample).filter(|count| is_split && *count > 0) {
            Some(count) => step.put(value::BEYOND, count).say(case::BEYOND_HORIZON),
            None => step.say(robust::case::COLLINEAR),
        }
    }

    fn system(&self, matches: &[Correspondence]) -> System {
        match self.model {
            Model::Homography => System::of_homography(matches),
            Model::Affine => System::of_affine(matches),
            Model::Translation | Model::Rigid | Model::Similarity => System::default(),
        }
    }

    /// Twice as many as determine it, so that errors average out and another consensus is within reach.
    fn resample_size(&self) -> usize {
        2 * self.sample_size()
    }

    fn local(&self, inliers: &[Correspondence]) -> Option<Matrix3> {
        fit(self.model, inliers)
    }

    fn last(&self, inliers: &[Correspondence]) -> Option<Matrix3> {
        least_squares(self.model, inliers)
    }

    fn squared_errors(matrix: &Matrix3, matches: &[Correspondence], errors: &mut [f64]) {
        squared_errors(matrix, matches, errors);
    }

    /// A disk around the predicted position.
    fn share_of_area(threshold_px: f64, [width, height]: [f64; 2]) -> f64 {
        std::f64::consts::PI * threshold_px * threshold_px / (width * height)
    }

    fn is_known_on_line(&self) -> bool {
        self.model.freedom() < Model::Affine.freedom()
    }

    fn output(&self, estimate: &Estimate<'_>) -> Output {
        Output::of(self.field(estimate))
    }

    fn conclusion(&self, step: Step, estimate: &Estimate<'_>) -> Step {
        let Some(Best { matrix, score }) = estimate.best else { return step };
        let step = self.tell_motion(step, &matrix);
        let step = match self.error(estimate) {
            Some(error) => step.put(value::ENDPOINT_ERROR, error).say(case::ERROR),
            None => step,
        };
        self.advise(step, score.inliers * 2 < estimate.points.len(), estimate.place)
    }

    fn formulas(&self, step: Step, estimate: &Estimate<'_>) -> Step {
        let (width, height) = estimate.size();
        let middle = [(width - 1) as f64 / 2.0, (height - 1) as f64 / 2.0];
        let Some(to) = estimate.best.and_then(|best| mapped(&best.matrix, middle)) else { return step };
        let step = step.put(value::CENTRE, middle).put(value::MAPPED_CENTRE, to);
        step.formula(r"\mathbf{x'} = H \mathbf{x}").formula(r"\text{centre } {centre} \to {mapped_centre}")
    }

    const SEQUELS: &'static [Name] = &[line::REGISTER];

    fn sequel(&self, step: Step, _: usize, estimate: &Estimate<'_>, _: Option<Focus>) -> Step {
        let differences = estimate.best.and_then(|best| differences(&best.matrix, lumas(estimate)));
        let Some([registered, at_rest]) = differences.map(|of| of.map(|of| of.mean)) else {
            return step.say(case::NO_OVERLAP);
        };
        let step = step.put(value::REGISTERED, registered).put(value::AT_REST, at_rest).say(case::REGISTERED);
        step.say(match registered {
            _ if registered > HARMFUL * at_rest => case::HARMFUL,
            _ if registered > at_rest => case::USELESS,
            _ => case::REMAINING,
        })
    }

    fn draw_sequel(&self, _: usize, estimate: &Estimate<'_>, _: Option<Focus>, scene: &mut Scene) {
        let Some(Best { matrix, .. }) = estimate.best else { return };
        let frames = estimate.pair.frames.clone();
        let made = move || mosaic([frames[0].luma(), frames[1].luma()], &matrix);
        scene.pictures = vec![Canvas::of_clip(Picture::CURRENT), Canvas::made(MOSAIC, made)];
        let roles = [(Role::Reference, "outline of frame t"), (Role::Window, "outline of frame t+1")];
        for ((role, meaning), corners) in roles.into_iter().zip(outlines(estimate.size(), &matrix)) {
            let points = corners.into_iter().map(|at| at.map(|c| c as f32)).collect();
            scene.draw(MOSAIC, (role, meaning), Shape::outline(points));
        }
    }

    fn draw(&self, estimate: &Estimate<'_>, matrix: Matrix3, focus: Option<Focus>, scene: &mut Scene) {
        draw_outline(estimate.size(), &matrix, scene);
        if let Some(Focus { on: Picture::CURRENT, at, .. }) = focus
            && let Some(to) = mapped(&matrix, at.map(f64::from))
        {
            for (on, center) in [(Picture::CURRENT, at), (Picture::NEXT, to.map(|c| c as f32))] {
                scene.mark(on, Role::Best, Shape::circle(center, 3.0));
            }
            scene.legend(Role::Best, "pixel pointed at, and H x");
        }
    }
}

impl GlobalMotion {
    fn field(&self, estimate: &Estimate<'_>) -> ModelField {
        ModelField {
            picture: estimate.size(),
            model: self.model,
            matrix: estimate.best.map(|best| best.matrix),
            iterations: estimate.iterations,
            residual_px: estimate.best.map(|best| best.rms_px()),
            support: Some(Support {
                inliers: estimate.best.map_or(0, |best| best.score.inliers),
                matches: estimate.points.len(),
            }),
        }
    }

    /// Mean endpoint error against the true flow.
    fn error(&self, estimate: &Estimate<'_>) -> Option<f64> {
        let flow = self.field(estimate).displacements_of_pixels();
        metrics::flow_error(&flow, estimate.truth?).ok().flatten().map(|error| error.epe_px)
    }

    /// Tells the meaning of the inliers; `is_few` if most matches are outliers.
    fn advise(&self, step: Step, is_few: bool, place: Option<Place>) -> Step {
        if let Some(share) = place.and_then(|place| place.foreground).filter(|share| *share > 0.5) {
            return step.put(value::FOREGROUND, 100.0 * share).say(case::ON_FOREGROUND);
        }
        let step = step.say(match (is_few, self.robust.outliers > 0.0, self.model) {
            (true, true, _) => case::REPLACED,
            (true, false, Model::Homography) => case::FEW,
            (true, false, _) => case::FEW_FOR_MODEL,
            (false, ..) => case::OUTLIERS,
        });
        match place.filter(|place| place.foreground.is_none() && place.hull < SMALL_HULL) {
            Some(place) => step.put(value::HULL, 100.0 * place.hull).say(case::SMALL_HULL),
            None => step,
        }
    }

    /// Tells the motion: translation, and rotation and scale where these are defined.
    fn tell_motion(&self, step: Step, matrix: &Matrix3) -> Step {
        let [[a, _, u], [c, _, v], _] = *matrix;
        let moved = |step: Step| step.put(value::TRANSLATION, [u, v]);
        let turned = |step: Step| moved(step).put(value::ROTATION, c.atan2(a).to_degrees());
        match self.model {
            Model::Translation => moved(step).say(case::TRANSLATION),
            Model::Rigid => turned(step).say(case::RIGID),
            Model::Similarity => turned(step).put(value::SCALE, a.hypot(c)).say(case::SIMILARITY),
            Model::Affine | Model::Homography => match mapped(matrix, [0.0; 2]) {
                Some(origin) => step.put(value::TRANSLATION, origin).say(case::WITH_ORIGIN),
                None => step.say(case::WITHOUT_ORIGIN),
            },
        }
    }
}

fn lumas<'a>(estimate: &'a Estimate<'_>) -> [&'a Gray; 2] {
    estimate.pair.frames.each_ref().map(|frame| frame.luma())
}

/// The outline of frame t where the model maps it to in frame t + 1.
fn draw_outline((width, height): (usize, usize), matrix: &Matrix3, scene: &mut Scene) {
    let [right, bottom] = [(width - 1) as f64, (height - 1) as f64];
    let corners = [[0.0, 0.0], [right, 0.0], [right, bottom], [0.0, bottom]];
    let Some(moved) = corners.iter().map(|corner| mapped(matrix, *corner)).collect::<Option<Vec<_>>>() else { return };
    // Far outside the picture there is nothing to see.
    let reach = 4.0 * right.max(bottom);
    if moved.iter().flatten().all(|c| c.abs() < reach) {
        let points = moved.into_iter().map(|at| at.map(|c| c as f32)).collect();
        scene.draw(Picture::NEXT, (Role::Window, "outline of frame t"), Shape::outline(points));
    }
}
