//! The global motion of a pair of frames: one transformation of the plane for all matches.

mod mosaic;

use mosaic::{mosaic, outlines};

use crate::base::words;
use crate::geometry::Gray;
use crate::methods::camera_path::differences;
use crate::methods::geometric::{
    Correspondence,
    fit::{across_horizon, fit, is_on_line, squared_errors},
    refine::least_squares,
    robust::{self, Best, Estimate, Place, RobustModel, Sequel, robust_pseudocode},
    system::System,
};
use crate::methods::matching;
use crate::methods::numbers::percent;
use crate::params;
use crate::products::model::{Matrix3, Model, mapped};
use crate::products::{ModelField, Output, Product, ProductKind, Support, metrics};
use crate::run::Info;
use crate::scene::{Canvas, Focus, Math, Picture, PictureRole, Role, Scene, Sentence, Shape};

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

/// Inliers within a smaller share of the picture may lie on a single object.
const SMALL_HULL: f64 = 0.25;

/// A registration that raises the mean difference to more than this multiple does harm; interpolation alone changes it by less.
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

    fn counting(&self) -> String {
        format!("Each gives two equations, and the {} has {} degrees of freedom.", self.name(), self.model.freedom())
    }

    fn hypotheses(&self, sample: &[Correspondence]) -> Vec<Matrix3> {
        fit(self.model, sample).into_iter().collect()
    }

    fn why_none(&self, sample: &[Correspondence]) -> String {
        let is_split = self.model == Model::Homography && !is_on_line(sample);
        match across_horizon(sample).filter(|count| is_split && *count > 0) {
            Some(count) => format!(
                "the homography through it maps {count} of its {} points beyond the horizon line of the plane, which a camera cannot see",
                sample.len()
            ),
            None => "its points lie on a line or at one place".to_owned(),
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

    fn conclusion(&self, estimate: &Estimate<'_>) -> String {
        let Some(Best { matrix, score }) = estimate.best else { return String::new() };
        let quality = self
            .error(estimate)
            .map_or_else(String::new, |error| format!(" Mean endpoint error {} px.", words::fixed(error, 3)));
        format!(
            "{}.{quality} {}",
            self.described(&matrix),
            self.advice(score.inliers * 2 < estimate.points.len(), estimate.place)
        )
    }

    fn equations(&self, estimate: &Estimate<'_>) -> Vec<Math> {
        let Some(Best { matrix, .. }) = estimate.best else { return Vec::new() };
        let (width, height) = estimate.size();
        let middle = [(width - 1) as f64 / 2.0, (height - 1) as f64 / 2.0];
        let Some(to) = mapped(&matrix, middle) else { return Vec::new() };
        let point = |[x, y]: [f64; 2]| Math::column([x, y].map(|c| Math::text(words::fixed(c, 2))));
        vec![
            Math::Row(vec![Math::Bold("x′"), Math::text(" = "), Math::Var("H"), Math::text(" "), Math::Bold("x")]),
            Math::Row(vec![Math::text("centre "), point(middle), Math::text(" → "), point(to)]),
        ]
    }

    const SEQUELS: usize = 1;

    fn sequel(&self, _: usize, estimate: &Estimate<'_>, _: Option<Focus>) -> Sequel {
        let registered = estimate.best.and_then(|best| differences(&best.matrix, lumas(estimate)));
        let sentence = match registered {
            Some([registered, at_rest]) => Sentence::default()
                .text("Registered by H, both frames differ by ")
                .ink(Role::Result, format!("{} gray levels", words::fixed(registered.mean, 2)))
                .text(format!(
                    " on average where they overlap, and by {} as they are. {}",
                    words::fixed(at_rest.mean, 2),
                    registration(registered.mean, at_rest.mean)
                )),
            None => Sentence::default().text("Registered by H, the frames do not overlap."),
        };
        Sequel { line: Some(line::REGISTER), sentence, ..Sequel::default() }
    }

    fn draw_sequel(&self, _: usize, estimate: &Estimate<'_>, _: Option<Focus>, scene: &mut Scene) {
        let Some(Best { matrix, .. }) = estimate.best else { return };
        let frames = estimate.pair.frames.clone();
        let made = move || mosaic([frames[0].luma(), frames[1].luma()], &matrix);
        scene.pictures = vec![Canvas::of_clip(Picture::CURRENT), Canvas::made(MOSAIC, made)];
        let roles = [(Role::Reference, "outline of frame t"), (Role::Window, "outline of frame t+1")];
        for ((role, meaning), corners) in roles.into_iter().zip(outlines(estimate.size(), &matrix)) {
            let points = corners.into_iter().map(|at| at.map(|c| c as f32)).collect();
            scene.mark(MOSAIC, role, Shape::Path { points, closed: true });
            scene.legend(role, meaning);
        }
    }

    fn draw(&self, estimate: &Estimate<'_>, matrix: Matrix3, focus: Option<Focus>, scene: &mut Scene) {
        draw_outline(estimate.size(), &matrix, scene);
        if let Some(Focus { on: Picture::CURRENT, at, .. }) = focus
            && let Some(to) = mapped(&matrix, at.map(f64::from))
        {
            for (on, center) in [(Picture::CURRENT, at), (Picture::NEXT, to.map(|c| c as f32))] {
                scene.mark(on, Role::Best, Shape::Ellipse { center, radii: [3.0; 2], angle_rad: 0.0 });
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

    /// What the inliers say about the model; `is_few` if most matches are outliers.
    fn advice(&self, is_few: bool, place: Option<Place>) -> String {
        if let Some(share) = place.and_then(|place| place.foreground).filter(|share| *share > 0.5) {
            return format!(
                "By the ground truth, {} of the inliers lie on foreground objects: the consensus is the motion of an object and not that of \
                 the background, as RANSAC follows the majority of the matches.",
                percent(share)
            );
        }
        let advice = match (is_few, self.robust.outliers > 0.0, self.model) {
            (true, true, _) => {
                "Fewer than half of the matches agree, because a share of them was replaced by random ones."
            }
            (true, false, Model::Homography) => {
                "Fewer than half of the matches agree: many are wrong, or parallax and moving objects need local motion."
            }
            (true, false, _) => {
                "Fewer than half of the matches agree: many are wrong, or parallax and moving objects need a model with more freedom."
            }
            (false, ..) => "Outliers are wrong matches, moving objects, or parallax the model cannot explain.",
        };
        match place.filter(|place| place.foreground.is_none() && place.hull < SMALL_HULL) {
            Some(place) => format!(
                "{advice} The convex hull of the inliers covers {} of the picture: they may lie on a single object, and the model is \
                 extrapolated elsewhere.",
                percent(place.hull)
            ),
            None => advice.to_owned(),
        }
    }

    /// The motion in words: translation, and rotation and scale where these are defined.
    fn described(&self, matrix: &Matrix3) -> String {
        let [[a, _, u], [c, _, v], _] = *matrix;
        let motion = |[u, v]: [f64; 2]| format!("translation ({}, {}) px", words::fixed(u, 2), words::fixed(v, 2));
        let degrees = words::fixed(c.atan2(a).to_degrees(), 2);
        match self.model {
            Model::Translation => motion([u, v]),
            Model::Rigid => format!("rotation {degrees}°, {}", motion([u, v])),
            Model::Similarity => {
                format!("rotation {degrees}°, scale {}, {}", words::fixed(a.hypot(c), 3), motion([u, v]))
            }
            Model::Affine | Model::Homography => match mapped(matrix, [0.0; 2]) {
                Some(origin) => format!("{} with the {} at the origin", self.name(), motion(origin)),
                None => format!("{} that maps the origin beyond its horizon line", self.name()),
            },
        }
    }
}

/// Judges the model by the mean difference of the registered frames beside that of the frames as they are.
fn registration(registered: f64, at_rest: f64) -> &'static str {
    if registered > HARMFUL * at_rest {
        "Registration makes the difference larger, so the model does not hold for the picture as a whole."
    } else if registered > at_rest {
        "Registration does not reduce the difference, so the pictures give no evidence for the model."
    } else {
        "The remaining difference is noise and motion that the model does not have."
    }
}

/// The gray levels of both frames.
fn lumas<'a>(estimate: &'a Estimate<'_>) -> [&'a Gray; 2] {
    estimate.pair.frames.each_ref().map(|frame| frame.luma())
}

/// The outline of frame t where the model maps it to in frame t + 1.
fn draw_outline((width, height): (usize, usize), matrix: &Matrix3, scene: &mut Scene) {
    let [right, bottom] = [(width - 1) as f64, (height - 1) as f64];
    let corners = [[0.0, 0.0], [right, 0.0], [right, bottom], [0.0, bottom]];
    let Some(moved) = corners.iter().map(|corner| mapped(matrix, *corner)).collect::<Option<Vec<_>>>() else { return };
    // Far beyond the picture there is nothing to see.
    let reach = 4.0 * right.max(bottom);
    if moved.iter().flatten().all(|c| c.abs() < reach) {
        let points = moved.into_iter().map(|at| at.map(|c| c as f32)).collect();
        scene.mark(Picture::NEXT, Role::Window, Shape::Path { points, closed: true });
        scene.legend(Role::Window, "outline of frame t");
    }
}
