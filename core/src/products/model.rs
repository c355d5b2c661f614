//! A geometric model of the motion of the whole picture: one matrix for all pixels.

use super::assessment::{fact, scores};
use super::{
    Assessment, Cell, Figure, Measure, Motion, Product, ProductKind, Reference, Table, flow_error, predict, prediction,
};
use crate::base::{Error, words::grouped};
use crate::choices;
use crate::data::{Flow, Interpolation};
use crate::geometry::{Border, Gray, Grid};

choices! {
    /// A group of transformations of the plane, in the order of their degrees of freedom.
    pub enum Model {
        /// Translation: 2 degrees of freedom.
        Translation = "translation" "Translation",
        /// Rotation and translation: 3 degrees of freedom; lengths are kept.
        Rigid = "rigid" "Rigid",
        /// Rotation, translation and scale: 4 degrees of freedom; angles are kept.
        Similarity = "similarity" "Similarity",
        /// Affine map: 6 degrees of freedom; parallel lines stay parallel.
        Affine = "affine" "Affine",
        /// Projective map: 8 degrees of freedom; straight lines stay straight. Exact for a plane and for a rotating camera.
        Homography = "homography" "Homography",
    }
}

impl Model {
    /// Number of degrees of freedom.
    pub fn freedom(self) -> usize {
        match self {
            Self::Translation => 2,
            Self::Rigid => 3,
            Self::Similarity => 4,
            Self::Affine => 6,
            Self::Homography => 8,
        }
    }

    /// Number of correspondences that determine it; each gives two equations.
    pub fn sample_size(self) -> usize {
        self.freedom().div_ceil(2)
    }

    /// Its kebab-case name.
    pub fn id(self) -> &'static str {
        match self {
            Self::Translation => "translation",
            Self::Rigid => "rigid",
            Self::Similarity => "similarity",
            Self::Affine => "affine",
            Self::Homography => "homography",
        }
    }
}

/// A 3×3 matrix by rows, that maps homogeneous pixel positions of frame t to frame t + 1.
pub type Matrix3 = [[f64; 3]; 3];

/// The matrix of no motion.
pub const IDENTITY: Matrix3 = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Smallest third homogeneous coordinate of a position before the horizon.
pub(crate) const HORIZON: f64 = 1e-9;

/// The position to which `matrix` maps a position; `None` where it lies on or behind the horizon.
pub fn mapped(matrix: &Matrix3, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
    let [a, b, w] = matrix.map(|row| row[0] * x + row[1] * y + row[2]);
    (w > HORIZON).then(|| [a / w, b / w])
}

/// The product of two matrices.
pub fn product(a: &Matrix3, b: &Matrix3) -> Matrix3 {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

/// The inverse of a matrix; `None` if it is singular.
pub fn inverse(matrix: &Matrix3) -> Option<Matrix3> {
    let [[a, b, c], [d, e, f], [g, h, i]] = *matrix;
    let adjugate = [
        [e * i - f * h, c * h - b * i, b * f - c * e],
        [f * g - d * i, a * i - c * g, c * d - a * f],
        [d * h - e * g, b * g - a * h, a * e - b * d],
    ];
    let determinant = a * adjugate[0][0] + b * adjugate[1][0] + c * adjugate[2][0];
    (determinant.abs() > 1e-15).then(|| adjugate.map(|row| row.map(|entry| entry / determinant)))
}

/// The same map by a positive factor, so that what lies before the horizon stays there: with a last entry of 1, or of −1 if the origin lies
/// behind the horizon, or with a largest entry of 1 if the origin lies on it. `None` where an entry is not finite.
pub fn normalised(matrix: &Matrix3) -> Option<Matrix3> {
    let last = matrix[2][2].abs();
    let most = matrix.iter().flatten().fold(0.0f64, |most, entry| most.max(entry.abs()));
    // A last entry that is nothing but rounding says nothing about the scale.
    let size = if last > 1e-9 * most { last } else { most };
    let scaled = matrix.map(|row| row.map(|entry| entry / size));
    scaled.iter().flatten().all(|entry| entry.is_finite()).then_some(scaled)
}

/// The third homogeneous coordinate of a mapped position; the horizon is where it is 0.
fn depth(matrix: &Matrix3, [x, y]: [f64; 2]) -> f64 {
    matrix[2][0] * x + matrix[2][1] * y + matrix[2][2]
}

/// The homography, normalised, with the sign by which these positions lie before its horizon. `None` if that lies between them.
pub fn oriented(matrix: &Matrix3, mut positions: impl Iterator<Item = [f64; 2]> + Clone) -> Option<Matrix3> {
    let sign = depth(matrix, positions.clone().next()?).signum();
    let scaled = normalised(&matrix.map(|row| row.map(|entry| sign * entry)))?;
    positions.all(|at| depth(&scaled, at) > HORIZON).then_some(scaled)
}

/// The number of positions beyond the horizon from most of them.
pub(crate) fn beyond_horizon(matrix: &Matrix3, positions: impl ExactSizeIterator<Item = [f64; 2]>) -> usize {
    let count = positions.len();
    let positive = positions.filter(|at| depth(matrix, *at) > 0.0).count();
    positive.min(count - positive)
}

/// One transformation for all pixels of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelField {
    /// Width and height of the picture in px.
    pub picture: (usize, usize),
    /// The group of transformations.
    pub model: Model,
    /// Its matrix, normalised to a last entry of 1 (of −1 if the origin lies behind its horizon, with a largest entry of 1 if it lies on it), if it could be estimated.
    pub matrix: Option<Matrix3>,
    /// Number of iterations of the estimation.
    pub iterations: usize,
    /// Root mean square distance of the inliers from their predicted positions in px, if it was estimated from matches.
    pub residual_px: Option<f64>,
    /// Number of inliers and of all matches, if it was estimated from matches.
    pub support: Option<Support>,
}

/// The matches behind a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Support {
    /// Number of matches that agree with it.
    pub inliers: usize,
    /// Number of all matches.
    pub matches: usize,
}

impl Support {
    /// The share of the matches that agree; undefined without any.
    pub fn share(self) -> Option<f64> {
        (self.matches > 0).then(|| self.inliers as f64 / self.matches as f64)
    }

    /// Both numbers and the share in words.
    pub fn text(self) -> String {
        match self.share() {
            Some(share) => {
                format!("{} of {} matches, {:.1} %", grouped(self.inliers), grouped(self.matches), 100.0 * share)
            }
            None => "undefined: there are no matches".into(),
        }
    }
}

impl ModelField {
    /// The displacement of every pixel; unknown beyond the horizon of a homography, and everywhere without an estimate.
    pub fn displacements_of_pixels(&self) -> Flow {
        let (width, height) = self.picture;
        Flow(Grid::from_fn(width, height, |x, y| {
            let place = [x as f64, y as f64];
            self.matrix
                .as_ref()
                .and_then(|matrix| mapped(matrix, place))
                .map_or(Flow::UNKNOWN, |to| [0, 1].map(|i| (to[i] - place[i]) as f32))
        }))
    }
}

const MEASURES: [Measure; 4] = [
    Measure::new("inliers", "Number of matches that agree with the model.").in_column("inliers", 0),
    Measure::new("inlier_share", "Share of the matches that agree with the model.")
        .in_percent("inliers %", "inlier_percent"),
    Measure::new("residual_px", "Root mean square distance of the inliers from their predicted positions in px.")
        .in_column("residual px", 3),
    Measure::new("iterations", "Number of iterations of the estimation.").in_column("iterations", 0),
];

/// Border and interpolation of the prediction of frame t from frame t + 1.
const SAMPLING: (Border, Interpolation) = (Border::Replicate, Interpolation::Bilinear);

impl Product for ModelField {
    const KIND: &'static ProductKind = &ProductKind {
        id: "model",
        name: "Geometric model",
        summary: "One transformation of the plane for all pixels of the picture.",
        motion: Motion::Pixels,
        is_of_single_frames: false,
        has_pictures: false,
        measures: &[&prediction::MEASURES, &flow_error::MEASURES, &MEASURES],
    };

    /// The matrix, row by row; none if it was estimated from matches, whose table says which of them agree.
    fn table(&self) -> Option<Table> {
        if self.support.is_some() {
            return None;
        }
        let rows = self.matrix.into_iter().flatten().map(|row| row.map(Cell::from));
        Some(Table::new(["column_1", "column_2", "column_3"], rows))
    }

    fn assess(&self, reference: &Reference<'_>) -> Result<Assessment, Error> {
        let next = &reference.clip.pair_or_last(reference.frame)?[1];
        let flow = self.displacements_of_pixels();
        let share = self.support.and_then(Support::share);
        let values = [
            Figure::from(self.support.map(|of| of.inliers)),
            share.into(),
            self.residual_px.into(),
            self.iterations.into(),
        ];
        let mut facts = Vec::new();
        facts.extend(self.support.map(|support| fact("Inliers", support.text())));
        facts.extend(self.residual_px.map(|residual| fact("Residual (RMS)", format!("{residual:.3} px"))));
        let predicted = match self.matrix {
            Some(_) => prediction::assess(&predict(&flow, next.luma(), SAMPLING), None, reference)?,
            None => prediction::undefined(),
        };
        let compared = predicted.and(flow_error::of_field(&flow, reference));
        Ok(compared.with(scores(&MEASURES, values), facts))
    }

    fn flow(&self) -> Option<Flow> {
        Some(self.displacements_of_pixels())
    }

    fn prediction(&self, next: &Gray) -> Option<Gray> {
        Some(predict(&self.displacements_of_pixels(), next, SAMPLING))
    }

    fn displacements(&self) -> Option<Vec<Option<[f32; 2]>>> {
        let known = |uv: &[f32; 2]| Some(*uv).filter(|uv| uv.iter().all(|c| c.is_finite()));
        Some(self.displacements_of_pixels().0.cells().iter().map(known).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_moves_every_pixel() {
        let shear = [[1.0, 0.5, 2.0], [0.0, 1.0, -1.0], [0.0, 0.0, 1.0]];
        let field = ModelField {
            picture: (4, 3),
            model: Model::Affine,
            matrix: Some(shear),
            iterations: 1,
            residual_px: None,
            support: None,
        };
        assert_eq!(field.displacements_of_pixels().at(3, 2), Some([3.0, -1.0]));
        assert_eq!(field.table().map(|table| table.rows().count()), Some(3));
    }

    #[test]
    fn beyond_the_horizon_nothing_is_known() {
        let tilted = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.5, 0.0, 1.0]];
        assert_eq!(mapped(&tilted, [1.0, 1.0]), Some([2.0, 2.0]));
        assert_eq!(mapped(&tilted, [2.0, 1.0]), None);
    }

    #[test]
    fn positions_decide_what_lies_before_the_horizon() {
        // The horizon x = 2 lies between the origin and the positions.
        let matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.5, 0.0, 1.0]];
        let beyond = [[3.0, 1.0], [4.0, 0.0], [8.0, 5.0]];
        let found = oriented(&matrix, beyond.into_iter()).expect("all are on one side");
        assert_eq!(found, matrix.map(|row| row.map(|entry| -entry)));
        assert_eq!((mapped(&found, [4.0, 1.0]), mapped(&found, [0.0, 0.0])), (Some([-4.0, -1.0]), None));
        // Composed with its inverse and normalised, it still does.
        let back = inverse(&found).expect("regular");
        let there = normalised(&product(&back, &found)).expect("finite");
        assert_eq!(mapped(&there, [4.0, 1.0]), Some([4.0, 1.0]));
        let both = [[1.0, 1.0], [3.0, 1.0], [4.0, 0.0]];
        assert_eq!((oriented(&matrix, both.into_iter()), beyond_horizon(&matrix, both.into_iter())), (None, 1));
    }

    #[test]
    fn an_origin_on_the_horizon_leaves_a_map() {
        let matrix = [[4.0, 0.0, 2.0], [0.0, 2.0, 0.0], [1.0, 0.0, 0.0]];
        assert_eq!(normalised(&matrix), Some(matrix.map(|row| row.map(|entry| entry / 4.0))));
        assert_eq!(normalised(&[[0.0; 3]; 3]), None);
    }

    #[test]
    fn two_equations_of_a_match_determine_two_parameters() {
        let sizes = [Model::Translation, Model::Rigid, Model::Similarity, Model::Affine, Model::Homography]
            .map(Model::sample_size);
        assert_eq!(sizes, [1, 2, 2, 3, 4]);
    }
}
