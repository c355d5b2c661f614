//! Epipolar geometry of a pair of frames: the fundamental matrix, and the pose of a calibrated camera.

mod sequels;
mod vocabulary;

use crate::methods::geometric::{
    Correspondence,
    epipolar::{
        Camera, eight_point, epipoles, least_sampson, line as line_of, line_back, sampson_all, sampson_squared,
        seven_point,
    },
    planar::Planarity,
    robust::{self, Estimate, RobustModel, robust_pseudocode},
    system::System,
};
use crate::methods::matching;
use crate::products::epipolar::{Planar, Pose};
use crate::products::model::{Matrix3, Support};
use crate::products::{EpipolarField, Output, Product, ProductKind};
use crate::run::Info;
use crate::scene::{Case, Focus, Name, Picture, Role, Scene, Shape, Step};
use crate::{choices, params};
use vocabulary::{case, value};

choices! {
    /// Number of matches of a sample.
    pub enum Sampling {
        /// Seven: the smallest sample. The constraint det F = 0 gives one to three solutions.
        Seven = "seven" "7 points",
        /// Eight: a linear solution, but more iterations for the same share of outliers.
        Eight = "eight" "8 points",
    }
}

params! {
    /// The fundamental matrix of a pair of frames: RANSAC over matched keypoints.
    pub struct EpipolarGeometry {
        /// Algorithm for a sample.
        sampling: Sampling = Sampling::Seven;
        /// Detector, descriptor and tests of the matches.
        matching: matching::Settings = matching::Settings::default();
        /// Parameters of random sample consensus.
        robust: robust::Settings = robust::Settings { threshold: 1.5, ..robust::Settings::default() };
        /// Focal length of the camera; its principal point is the centre of the frame. With it the essential matrix and the pose are computed. 0: unknown.
        focal_length: f32 = 0.0, 0.0..=9999.0, "px";
    }
}

robust_pseudocode!(
    "  F ← the fundamental matrices through the sample, of rank 2",
    "  count the inliers: matches with a Sampson distance of at most the threshold",
    "fit F to all inliers by eight points, then by least Sampson distances; again while the cost falls",
    GUIDE: "match each keypoint again, only with those near its epipolar line",
    RECTIFY: "rectify both frames: H′ sends e′ to infinity along x, H makes the rows equal"
);

/// Above this share of inliers on a plane the fundamental matrix rests on few of them.
const NEARLY_PLANE: f64 = 0.5;

impl RobustModel for EpipolarGeometry {
    const INFO: Info = Info {
        id: "epipolar-geometry",
        name: "Epipolar geometry",
        family: "Correspondence",
        summary: "The fundamental matrix of a moving camera: each point corresponds to a point on its epipolar line.",
        source: "R. Hartley, In defense of the eight-point algorithm, IEEE PAMI 19(6), 1997; R. Hartley and A. Zisserman, Multiple view \
                 geometry in computer vision, 2004, chapter 11; degenerate scenes: P. Torr, Geometric motion segmentation and model \
                 selection, Philosophical Transactions of the Royal Society A 356, 1998; O. Chum, T. Werner and J. Matas, Two-view geometry estimation \
                 unaffected by a dominant plane, CVPR 2005",
        pseudocode: line::ALL,
        granularities: &["frame", "iteration", "step"],
        frames: 2,
    };
    const PRODUCT: &'static ProductKind = EpipolarField::KIND;
    const SEQUELS: &'static [Name] = &[line::GUIDE, line::RECTIFY];
    const SYMBOL: &'static str = "F";
    const DISTANCE: &'static str = "Sampson distance";

    fn matching(&self) -> &matching::Settings {
        &self.matching
    }

    fn settings(&self) -> &robust::Settings {
        &self.robust
    }

    fn name(&self) -> &'static str {
        "fundamental matrix"
    }

    fn sample_size(&self) -> usize {
        match self.sampling {
            Sampling::Seven => 7,
            Sampling::Eight => 8,
        }
    }

    fn counting(&self, step: Step) -> Step {
        step.say(match self.sampling {
            Sampling::Seven => case::SEVEN_POINTS,
            Sampling::Eight => case::EIGHT_POINTS,
        })
    }

    fn hypotheses(&self, sample: &[Correspondence]) -> Vec<Matrix3> {
        match self.sampling {
            Sampling::Seven => seven_point(sample),
            Sampling::Eight => eight_point(sample).into_iter().collect(),
        }
    }

    fn system(&self, matches: &[Correspondence]) -> System {
        System::of_fundamental(matches)
    }

    fn local(&self, inliers: &[Correspondence]) -> Option<Matrix3> {
        eight_point(inliers)
    }

    fn last(&self, inliers: &[Correspondence]) -> Option<Matrix3> {
        least_sampson(inliers)
    }

    fn squared_errors(matrix: &Matrix3, matches: &[Correspondence], errors: &mut [f64]) {
        sampson_all(matrix, matches, errors);
    }

    /// A strip on both sides of the epipolar line.
    fn share_of_area(threshold_px: f64, [width, height]: [f64; 2]) -> f64 {
        2.0 * threshold_px * width.hypot(height) / (width * height)
    }

    fn is_known_on_line(&self) -> bool {
        false
    }

    fn output(&self, estimate: &Estimate<'_>) -> Output {
        let planarity = self.planarity(estimate);
        let is_plane = planarity.as_ref().is_some_and(Planarity::is_plane);
        Output::of(EpipolarField {
            matrix: estimate.best.map(|best| best.matrix),
            iterations: estimate.iterations,
            residual_px: estimate.best.map(|best| best.rms_px()),
            support: Support {
                inliers: estimate.best.map_or(0, |best| best.score.inliers),
                matches: estimate.points.len(),
            },
            planar: planarity.map(|found| Planar { share: found.share, is_plane: found.is_plane() }),
            pose: self.pose(estimate).filter(|_| !is_plane).filter(|pose| self.doubt(pose, estimate).is_none()),
        })
    }

    fn conclusion(&self, step: Step, estimate: &Estimate<'_>) -> Step {
        let (step, planarity) = (step.say(case::DISTANCE), self.planarity(estimate));
        let Some(planar) = planarity else { return self.tell_pose(step, estimate, false).say(case::MOVING_OBJECTS) };
        let unexplained = planar.inliers - planar.explained;
        let step = step.put(value::ON_PLANE, 100.0 * planar.share).put(value::EXPLAINED, planar.explained);
        let step = step.put(value::HOMOGRAPHY_CRITERION, planar.of_homography).put(value::UNEXPLAINED, unexplained);
        let step = step.put(value::FUNDAMENTAL_CRITERION, planar.of_fundamental);
        let step = step.put(value::OFF_PLANE_INLIERS, planar.off[0]).put(value::OFF_PLANE, planar.off[1]);
        if planar.is_plane() {
            let step = step.say(case::PLANAR);
            let step = step.say(if planar.off[1] == 0 { case::NONE_OFF_PLANE } else { case::OFF_PLANE });
            return step.say(if planar.is_one_plane() { case::ONE_PLANE } else { case::UNDETERMINED });
        }
        let doubt = match planar.is_homography_better() {
            true => Some(case::DOMINANT_PLANE),
            false => (planar.share > NEARLY_PLANE).then_some(case::NEARLY_PLANE),
        };
        let step = doubt.into_iter().fold(step, Step::say);
        // A doubt about F is one about the pose.
        self.tell_pose(step, estimate, doubt.is_some()).say(case::MOVING_OBJECTS)
    }

    fn formulas(&self, step: Step, estimate: &Estimate<'_>) -> Step {
        let Some(best) = estimate.best else { return step };
        let step = step.formula(r"\mathbf{x'}^\top \, F \, \mathbf{x} = 0");
        let Some(found) = epipoles(&best.matrix) else { return step };
        let [here, there] = found.map(on_plane);
        let step = match here {
            Some(at) => step.put(value::EPIPOLE, at).formula(r"\mathbf{e} = {epipole:unit}"),
            None => step.formula(r"\mathbf{e} \text{ at infinity}"),
        };
        match there {
            Some(at) => step.put(value::NEXT_EPIPOLE, at).formula(r"\mathbf{e'} = {next_epipole:unit}"),
            None => step.formula(r"\mathbf{e'} \text{ at infinity}"),
        }
    }

    fn sequel(&self, step: Step, index: usize, estimate: &Estimate<'_>, focus: Option<Focus>) -> Step {
        if index == 0 { self.tell_guidance(step, estimate, focus) } else { self.tell_rectification(step, estimate) }
    }

    fn draw_sequel(&self, index: usize, estimate: &Estimate<'_>, focus: Option<Focus>, scene: &mut Scene) {
        if index == 0 { self.draw_guided(estimate, focus, scene) } else { self.draw_rectified(estimate, scene) }
    }

    fn draw(&self, estimate: &Estimate<'_>, matrix: Matrix3, focus: Option<Focus>, scene: &mut Scene) {
        let size = estimate.size();
        if let Some(found) = epipoles(&matrix) {
            for (on, epipole) in [Picture::CURRENT, Picture::NEXT].into_iter().zip(found) {
                let inside = on_plane(epipole).filter(|at| is_inside(*at, size));
                if let Some(at) = inside {
                    scene.draw(on, (Role::Best, "epipole"), Shape::Points(vec![at.map(|c| c as f32)]));
                }
            }
        }
        // Without a point pointed at, the lines of a few matches.
        const SHOWN: usize = 8;
        let few = estimate.points.iter().step_by(estimate.points.len().div_ceil(SHOWN).max(1));
        let lines: Vec<(Picture, [f64; 3])> = match focus {
            Some(Focus { on: Picture::CURRENT, at, .. }) => vec![(Picture::NEXT, line_of(&matrix, at.map(f64::from)))],
            Some(Focus { on: Picture::NEXT, at, .. }) => {
                vec![(Picture::CURRENT, line_back(&matrix, at.map(f64::from)))]
            }
            _ => few
                .flat_map(|m| [(Picture::NEXT, line_of(&matrix, m.from)), (Picture::CURRENT, line_back(&matrix, m.to))])
                .collect(),
        };
        if let Some(Focus { on, at, .. }) = focus {
            scene.draw(on, (Role::Reference, "point, whose match lies on the epipolar line"), Shape::circle(at, 3.0));
        }
        for (on, ends) in lines.into_iter().filter_map(|(on, line)| Some((on, cut(line, size)?))) {
            scene.draw(on, (Role::Predicted, "epipolar line"), Shape::line(ends.to_vec()));
        }
    }
}

impl EpipolarGeometry {
    fn inliers(&self, estimate: &Estimate<'_>, matrix: &Matrix3) -> Vec<Correspondence> {
        let limit = f64::from(self.robust.threshold).powi(2);
        estimate.points.iter().copied().filter(|m| sampson_squared(matrix, m) <= limit).collect()
    }

    /// The fundamental matrix compared with a homography on its inliers.
    fn planarity(&self, estimate: &Estimate<'_>) -> Option<Planarity> {
        let (matrix, robust::Settings { threshold, seed, .. }) = (estimate.best?.matrix, &self.robust);
        Planarity::of(&matrix, estimate.points, f64::from(*threshold), *seed as u64 + 1)
    }

    /// The angle that the frame spans across, with the focal length.
    fn field_of_view_deg(&self, (width, _): (usize, usize)) -> f64 {
        2.0 * (width as f64 / 2.0).atan2(self.focal_length.into()).to_degrees()
    }

    fn pose(&self, estimate: &Estimate<'_>) -> Option<Pose> {
        let matrix = estimate.best.filter(|_| self.focal_length > 0.0)?.matrix;
        let (width, height) = estimate.size();
        let centre = [(width - 1) as f64 / 2.0, (height - 1) as f64 / 2.0];
        let camera = Camera { focal_px: self.focal_length.into(), centre };
        camera.pose(&matrix, &self.inliers(estimate, &matrix))
    }

    /// Tells the pose of the camera, or why it is rejected; `is_doubted` if it is as uncertain as F.
    fn tell_pose(&self, step: Step, estimate: &Estimate<'_>, is_doubted: bool) -> Step {
        let Some(pose) = self.pose(estimate) else {
            return step.say(if is_doubted { case::NO_POSE_DOUBTED } else { case::NO_POSE });
        };
        let step = step.put(value::VIEW, self.field_of_view_deg(estimate.size())).put(value::LEAST_RATIO, LEAST_RATIO);
        let step = step.put(value::NARROWEST_VIEW, VIEWS_DEG[0]).put(value::WIDEST_VIEW, VIEWS_DEG[1]);
        let step = step.put(value::ROTATION, pose.angle_deg()).put(value::DIRECTION, pose.camera_direction());
        let step = step.put(value::IN_FRONT, pose.in_front).put(value::SINGULAR_RATIO, pose.singular_ratio);
        match self.doubt(&pose, estimate) {
            Some(doubt) => step.say(doubt),
            None => step.say(case::POSE).say_if(is_doubted, case::POSE_DOUBTED),
        }
    }

    /// Why the pose of a camera is rejected, if it is.
    fn doubt(&self, pose: &Pose, estimate: &Estimate<'_>) -> Option<&'static Case> {
        let [narrowest, widest] = VIEWS_DEG;
        if !(narrowest..=widest).contains(&self.field_of_view_deg(estimate.size())) {
            return Some(case::WRONG_VIEW);
        }
        if pose.singular_ratio < LEAST_RATIO {
            return Some(case::WRONG_RATIO);
        }
        (2 * pose.in_front <= estimate.best?.score.inliers).then_some(case::BEHIND)
    }
}

/// Smallest ratio of both singular values of an essential matrix for which the intrinsics are accepted.
const LEAST_RATIO: f64 = 0.8;
/// Widest field of view of a camera without a fisheye lens, and narrowest of a telephoto lens, in degrees.
const VIEWS_DEG: [f64; 2] = [1.0, 150.0];

/// A homogeneous point in px; `None` at infinity.
fn on_plane([x, y, w]: [f64; 3]) -> Option<[f64; 2]> {
    /// Beyond this distance only the direction matters.
    const FAR_PX: f64 = 1e6;
    let at = [x / w, y / w];
    at.iter().all(|c| c.abs() < FAR_PX).then_some(at)
}

fn is_inside([x, y]: [f64; 2], (width, height): (usize, usize)) -> bool {
    // Pixels reach half a px around their middles.
    (-0.5..width as f64 - 0.5).contains(&x) && (-0.5..height as f64 - 0.5).contains(&y)
}

/// The part of the line a x + b y + c = 0 inside a picture.
fn cut([a, b, c]: [f64; 3], (width, height): (usize, usize)) -> Option<[[f32; 2]; 2]> {
    let norm = a.hypot(b);
    if norm < 1e-12 {
        return None;
    }
    let (foot, way) = ([-a * c / (norm * norm), -b * c / (norm * norm)], [-b / norm, a / norm]);
    let mut span = [f64::NEG_INFINITY, f64::INFINITY];
    for (i, extent) in [width, height].into_iter().enumerate() {
        let (low, high) = (-0.5, extent as f64 - 0.5);
        if way[i].abs() < 1e-12 {
            if foot[i] < low || foot[i] > high {
                return None;
            }
            continue;
        }
        let ends = [low, high].map(|edge| (edge - foot[i]) / way[i]);
        span = [span[0].max(ends[0].min(ends[1])), span[1].min(ends[0].max(ends[1]))];
    }
    let at = |s: f64| [0, 1].map(|i| (foot[i] + s * way[i]) as f32);
    (span[0] < span[1]).then(|| span.map(at))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_cut_at_the_edges_of_the_picture() {
        let ends = cut([1.0, -1.0, 0.0], (11, 6)).expect("it passes through");
        for [x, y] in ends {
            assert!((x - y).abs() < 1e-4 && (-0.51..=5.51).contains(&y), "({x}, {y})");
        }
        assert_eq!(cut([1.0, 0.0, 20.0], (11, 6)), None);
        assert_eq!(cut([0.0, 0.0, 1.0], (11, 6)), None);
    }
}
