//! Epipolar geometry of a pair of frames: the fundamental matrix, and the pose of a calibrated camera.

mod sequels;

use crate::base::words;
use crate::methods::geometric::{
    Correspondence,
    epipolar::{
        Camera, eight_point, epipoles, least_sampson, line as line_of, line_back, sampson_all, sampson_squared,
        seven_point,
    },
    planar::Planarity,
    robust::{self, Best, Estimate, RobustModel, Sequel, robust_pseudocode},
    system::System,
};
use crate::methods::matching;
use crate::methods::numbers::percent;
use crate::products::epipolar::{Planar, Pose};
use crate::products::model::{Matrix3, Support};
use crate::products::{EpipolarField, Output, Product, ProductKind};
use crate::run::Info;
use crate::scene::{Focus, Math, Picture, Role, Scene, Shape};
use crate::{choices, params};

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
    const SEQUELS: usize = 2;
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

    fn counting(&self) -> String {
        match self.sampling {
            Sampling::Seven => {
                "Each gives one equation; with det F = 0 the 7 degrees of freedom of F are determined up to three solutions."
            }
            Sampling::Eight => "Each gives one linear equation in the 9 entries of F, which is defined up to its scale.",
        }
        .into()
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

    fn conclusion(&self, estimate: &Estimate<'_>) -> String {
        let Some(best) = estimate.best else { return String::new() };
        let found = format!("RMS Sampson distance {} px.", words::fixed(best.rms_px(), 3));
        let planarity = self.planarity(estimate);
        if let Some(planar) = planarity.filter(Planarity::is_plane) {
            return format!(
                "{found} But a homography explains {} of the inliers, and is the better model by the information criterion GRIC, {} against \
                 {} of F; {}. {}",
                percent(planar.share),
                words::fixed(planar.of_homography, 0),
                words::fixed(planar.of_fundamental, 0),
                match planar.off {
                    [_, 0] => "no match is an outlier of the homography".to_owned(),
                    [agreeing, all] => format!(
                        "clear outliers of the homography: {}; agreeing with F: {}, no more than by chance",
                        words::grouped(all),
                        words::grouped(agreeing)
                    ),
                },
                undetermined(&planar)
            );
        }
        let dominant = match planarity.filter(Planarity::is_homography_better) {
            Some(Planarity { off: [agreeing, _], inliers, explained, .. }) => format!(
                " Of the {} inliers, {} follow a homography, so F rests on the other {}. {} of these lie clearly off its plane and agree beyond \
                 chance: parallax, or an object with a motion of its own, for which F is wrong.",
                words::grouped(inliers),
                words::grouped(explained),
                words::grouped(inliers - explained),
                words::grouped(agreeing)
            ),
            None => match planarity {
                Some(planar) if planar.share > NEARLY_PLANE => format!(
                    " A homography explains {} of the inliers: most points lie near a plane, so F and its epipoles are poorly determined, and \
                     other random seeds give others.",
                    percent(planar.share)
                ),
                _ => String::new(),
            },
        };
        // A doubt about F is one about the pose.
        let is_doubted = !dominant.is_empty();
        let pose = match self.pose(estimate) {
            None if is_doubted => {
                " With the focal length a pose of the camera would follow from F, as uncertain as F.".to_owned()
            }
            None => " With the focal length, the pose of the camera follows from F.".to_owned(),
            Some(pose) => self.doubt(&pose, estimate).unwrap_or_else(|| match is_doubted {
                true => format!("{} This pose is as uncertain as F.", posed(&pose)),
                false => posed(&pose),
            }),
        };
        format!(
            "{found}{dominant}{pose} Points of moving objects violate F unless they move along their epipolar lines."
        )
    }

    fn equations(&self, estimate: &Estimate<'_>) -> Vec<Math> {
        let Some(Best { matrix, .. }) = estimate.best else { return Vec::new() };
        let constraint = Math::Row(vec![
            Math::power(Math::Bold("x′"), Math::text("T")),
            Math::text(" "),
            Math::Var("F"),
            Math::text(" "),
            Math::Bold("x"),
            Math::text(" = 0"),
        ]);
        let Some([here, there]) = epipoles(&matrix) else { return vec![constraint] };
        let epipole = |name: &'static str, e: [f64; 3]| {
            let value = match on_plane(e) {
                Some([x, y]) => format!(" = ({}, {}) px", words::fixed(x, 1), words::fixed(y, 1)),
                None => " at infinity".to_owned(),
            };
            Math::Row(vec![Math::Bold(name), Math::ink(Role::Best, value)])
        };
        vec![constraint, epipole("e", here), epipole("e′", there)]
    }

    fn sequel(&self, index: usize, estimate: &Estimate<'_>, focus: Option<Focus>) -> Sequel {
        if index == 0 { self.guided(estimate, focus) } else { self.rectified(estimate) }
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
                    scene.mark(on, Role::Best, Shape::Points(vec![at.map(|c| c as f32)]));
                    scene.legend(Role::Best, "epipole");
                }
            }
        }
        // Those of a few matches, where no point is pointed at.
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
            scene.mark(on, Role::Reference, Shape::Ellipse { center: at, radii: [3.0; 2], angle_rad: 0.0 });
            scene.legend(Role::Reference, "point, whose match lies on the epipolar line");
        }
        for (on, ends) in lines.into_iter().filter_map(|(on, line)| Some((on, cut(line, size)?))) {
            scene.mark(on, Role::Predicted, Shape::Path { points: ends.to_vec(), closed: false });
            scene.legend(Role::Predicted, "epipolar line");
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

    /// Why the pose of a camera is rejected, as a sentence, if it is.
    fn doubt(&self, pose: &Pose, estimate: &Estimate<'_>) -> Option<String> {
        let ([narrowest, widest], spanned) = (VIEWS_DEG, self.field_of_view_deg(estimate.size()));
        if !(narrowest..=widest).contains(&spanned) {
            return Some(format!(
                " The pose is rejected: with this focal length the frame would span {}°, and a camera spans {}° to {}°.",
                words::fixed(spanned, 1),
                words::fixed(narrowest, 0),
                words::fixed(widest, 0)
            ));
        }
        if pose.singular_ratio < LEAST_RATIO {
            return Some(format!(
                " The pose is rejected: the ratio of the singular values of the essential matrix is {}, and at least {} is needed (1 with the right \
                 intrinsics). The focal length does not fit.",
                words::fixed(pose.singular_ratio, 2),
                words::fixed(LEAST_RATIO, 2)
            ));
        }
        let inliers = estimate.best?.score.inliers;
        (2 * pose.in_front <= inliers).then(|| {
            format!(
                " The pose is rejected: only {} of the {} inliers lie in front of both cameras, and more than half are needed.",
                words::grouped(pose.in_front),
                words::grouped(inliers)
            )
        })
    }
}

/// Smallest ratio of both singular values of an essential matrix for which the intrinsics are accepted.
const LEAST_RATIO: f64 = 0.8;
/// Widest field of view of a camera without a fisheye lens, and the narrowest of a telephoto lens, in degrees.
const VIEWS_DEG: [f64; 2] = [1.0, 150.0];

/// Why points that a homography explains better do not determine F, and what to do.
fn undetermined(planar: &Planarity) -> String {
    if planar.is_one_plane() {
        return "So the scene is a plane, or the camera only rotated. F is not determined by such points; use the global motion with a \
                homography."
            .to_owned();
    }
    format!(
        "So F is not determined by these points. Whether the scene is a plane cannot be told either: {} of {} inliers do not follow the \
         homography, as with several planes or several motions. Motion segmentation tells motions apart.",
        words::grouped(planar.inliers - planar.explained),
        words::grouped(planar.inliers)
    )
}

/// The pose of the camera in words.
fn posed(pose: &Pose) -> String {
    let [x, y, z] = pose.camera_direction().map(|c| words::fixed(c, 2));
    format!(
        " The camera turned by {}° and moved along ({x}, {y}, {z}); {} of the inliers lie in front of both cameras. Ratio of the singular values of the \
         essential matrix: {}.",
        words::fixed(pose.angle_deg(), 2),
        words::grouped(pose.in_front),
        words::fixed(pose.singular_ratio, 2)
    )
}

/// A homogeneous point in px; `None` at infinity.
fn on_plane([x, y, w]: [f64; 3]) -> Option<[f64; 2]> {
    /// Farther away the direction alone counts.
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
