//! Epipolar geometry: the fundamental matrix of a pair of frames.

use super::assessment::{fact, scores};
use super::model::{Matrix3, Support, product};
use super::{Assessment, Figure, Measure, Motion, Product, ProductKind, Reference, Table};
use crate::base::Error;
use crate::base::words::{fixed, grouped};

/// The fundamental matrix of a pair of frames: x′ᵀ F x = 0 for corresponding points of a rigid scene.
#[derive(Clone, Debug, PartialEq)]
pub struct EpipolarField {
    /// The matrix with unit norm and rank two, if it could be estimated.
    pub matrix: Option<Matrix3>,
    /// Number of iterations of the estimation.
    pub iterations: usize,
    /// Root mean square Sampson distance of the inliers in px.
    pub residual_px: Option<f64>,
    /// Number of inliers and of all matches.
    pub support: Support,
    /// How well a single homography explains the inliers, if they are enough to tell.
    pub planar: Option<Planar>,
    /// The pose of the camera, if its focal length is known and fits, and the matrix is determined.
    pub pose: Option<Pose>,
}

/// Rotation and direction of translation of a calibrated camera between both frames: X′ = R X + t.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The rotation matrix, by rows.
    pub rotation: Matrix3,
    /// The direction of the translation, of length 1.
    pub translation: [f64; 3],
    /// Number of inliers in front of both cameras.
    pub in_front: usize,
    /// Ratio of the second to the first singular value of KᵀFK: 1 for the right intrinsics and exact positions.
    pub singular_ratio: f64,
}

impl Pose {
    /// The angle of the rotation in degrees.
    pub fn angle_deg(&self) -> f64 {
        let trace: f64 = (0..3).map(|i| self.rotation[i][i]).sum();
        ((trace - 1.0) / 2.0).clamp(-1.0, 1.0).acos().to_degrees()
    }

    /// The direction of the camera's motion, of length 1, in its own axes of frame t: its centre moves to −Rᵀt.
    pub fn camera_direction(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| -(0..3).map(|j| self.rotation[j][i] * self.translation[j]).sum::<f64>())
    }

    /// The essential matrix E = \[t\]ₓ R, by rows: x̂′ᵀ E x̂ = 0 for positions in units of the focal length from the principal point.
    pub fn essential(&self) -> Matrix3 {
        let [x, y, z] = self.translation;
        product(&[[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]], &self.rotation)
    }
}

/// A homography on the inliers of a fundamental matrix.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planar {
    /// Share of the inliers that it explains.
    pub share: f64,
    /// Whether the matches lie on a plane, or the camera only rotated, so that the fundamental matrix is not determined.
    pub is_plane: bool,
}

const MEASURES: [Measure; 4] = [
    Measure::new("epipolar_inliers", "Number of matches that agree with the epipolar geometry.")
        .in_column("epipolar inliers", 0),
    Measure::new("epipolar_inlier_share", "Share of the matches that agree with the epipolar geometry.")
        .in_percent("epipolar inliers %", "epipolar_inlier_percent"),
    Measure::new("sampson_px", "Root mean square Sampson distance of the inliers in px.").in_column("Sampson px", 3),
    Measure::new("planar_share", "Share of the inliers that a single homography explains."),
];

impl Product for EpipolarField {
    const KIND: &'static ProductKind = &ProductKind {
        id: "epipolar-geometry",
        name: "Epipolar geometry",
        summary: "The fundamental matrix, which maps a point of frame t to its epipolar line in frame t + 1.",
        motion: Motion::Nowhere,
        is_of_single_frames: false,
        has_pictures: false,
        measures: &[&MEASURES],
    };

    /// None: the table of the matches says which of them agree.
    fn table(&self) -> Option<Table> {
        None
    }

    fn assess(&self, _: &Reference<'_>) -> Result<Assessment, Error> {
        let inliers = self.support.inliers;
        let values = [
            inliers.into(),
            Figure::from(self.support.share()),
            self.residual_px.into(),
            self.planar.map(|planar| planar.share).into(),
        ];
        let mut facts = vec![fact("Inliers", self.support.text())];
        facts.extend(self.residual_px.map(|residual| fact("Sampson distance (RMS)", format!("{residual:.3} px"))));
        facts.extend(self.planar.map(|Planar { share, is_plane }| {
            let plane = if is_plane { " of the inliers; F is not determined" } else { " of the inliers" };
            fact("Explained by a homography", format!("{:.0} %{plane}", 100.0 * share))
        }));
        facts.extend(self.pose.iter().flat_map(|pose| {
            let [x, y, z] = pose.camera_direction().map(|c| fixed(c, 2));
            let turned = fact("Rotation of the camera", format!("{}°", fixed(pose.angle_deg(), 2)));
            [turned, fact("Direction of the camera's motion", format!("({x}, {y}, {z})"))]
        }));
        let headline = format!("{} inliers", grouped(inliers));
        Ok(Assessment { headline, ..Assessment::default() }.with(scores(&MEASURES, values), facts))
    }
}
