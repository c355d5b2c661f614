//! Keypoints: features of one picture, with their displacements where they were tracked.

use std::sync::Arc;

use super::assessment::{fact, scores};
use super::{Assessment, Cell, Measure, Motion, Product, ProductKind, Reference, Table, flow_error};
use crate::base::{Error, words::grouped};
use crate::data::Flow;
use crate::geometry::Grid;

/// Features of a picture, the strongest first where they were ranked.
#[derive(Clone, Debug, PartialEq)]
pub struct PointField {
    /// Width and height of the picture in px.
    pub picture: (usize, usize),
    /// The features.
    pub points: Vec<Feature>,
    /// Detector response, scale and orientation of each; empty if this run did not detect them.
    pub keypoints: Vec<Keypoint>,
}

/// Side of the described window in units of the scale σ: 4 cells of 3 σ each, as of SIFT.
pub(crate) const WINDOW_SIGMAS: f32 = 12.0;

/// How a feature was detected.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Keypoint {
    /// Detector response; larger is stronger.
    pub response: f32,
    /// Scale σ in px, for detectors with a scale space: the standard deviation of the blob; of a patch the twelfth of its side.
    pub scale_px: Option<f32>,
    /// Orientation in radians, from x towards y, for detectors that assign one.
    pub angle_rad: Option<f32>,
    /// Its descriptor, if it was described.
    pub descriptor: Option<Descriptor>,
}

impl Keypoint {
    /// A keypoint of which only the response is known.
    pub fn of_response(response: f32) -> Self {
        Self { response, ..Self::default() }
    }
}

/// Descriptor of a keypoint's neighbourhood; descriptors of one detector have one kind and length.
#[derive(Clone, Debug, PartialEq)]
pub enum Descriptor {
    /// Real values, compared by Euclidean distance.
    Reals(Arc<[f32]>),
    /// Bits, compared by Hamming distance.
    Bits(Arc<[u64]>),
}

impl Descriptor {
    /// The distance of two descriptors: Euclidean for real values, Hamming for bits. `None` if kind or length differ.
    pub fn distance(&self, other: &Self) -> Option<f32> {
        match (self, other) {
            (Self::Reals(a), Self::Reals(b)) if a.len() == b.len() => {
                Some(a.iter().zip(&**b).map(|(a, b)| (a - b).powi(2)).sum::<f32>().sqrt())
            }
            (Self::Bits(a), Self::Bits(b)) if a.len() == b.len() => {
                Some(a.iter().zip(&**b).map(|(a, b)| (a ^ b).count_ones()).sum::<u32>() as f32)
            }
            _ => None,
        }
    }
}

/// One feature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feature {
    /// Position in frame t in px.
    pub at: [f32; 2],
    /// Its displacement `[u, v]` in px/frame, if it was tracked.
    pub displacement: Option<[f32; 2]>,
    /// Outcome of tracking.
    pub status: Status,
    /// Residual: mean absolute difference of its windows in both frames in gray levels, if known.
    pub residual: Option<f32>,
}

impl Feature {
    /// A feature that is detected, and not tracked.
    pub const fn found(at: [f32; 2]) -> Self {
        Self { at, displacement: None, status: Status::Found, residual: None }
    }

    /// A feature with the displacement and the residual of its tracking, or the reason of its loss.
    pub fn tracked(at: [f32; 2], result: Result<([f32; 2], f32), Status>) -> Self {
        let displacement = result.ok().map(|(displacement, _)| displacement);
        let status = result.err().unwrap_or(Status::Tracked);
        Self { at, displacement, status, residual: result.ok().map(|(_, residual)| residual) }
    }

    /// Its position in frame t + 1, unless it is lost.
    pub fn end(&self) -> Option<[f32; 2]> {
        self.displacement.map(|uv| [0, 1].map(|i| self.at[i] + uv[i]))
    }
}

/// Outcome of tracking a feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Detected, and not tracked.
    Found,
    /// Tracked to frame t + 1.
    Tracked,
    /// Lost: it left the picture.
    Outside,
    /// Lost: the smaller eigenvalue of its structure tensor is too small (aperture problem).
    Flat,
    /// Lost: the residual between the windows is too large.
    Unlike,
    /// Lost: it failed the forward–backward check.
    Astray,
    /// Lost: it is too dissimilar to its first appearance.
    Changed,
    /// Lost: no keypoint of frame t + 1 is its match.
    Unmatched,
}

impl Status {
    /// Kebab-case name, for tables.
    pub fn name(self) -> &'static str {
        match self {
            Status::Found => "found",
            Status::Tracked => "tracked",
            Status::Outside => "lost-outside",
            Status::Flat => "lost-flat",
            Status::Unlike => "lost-unlike",
            Status::Astray => "lost-astray",
            Status::Changed => "lost-changed",
            Status::Unmatched => "lost-unmatched",
        }
    }
}

impl PointField {
    /// The displacements of the features at the pixels nearest to them; unknown everywhere else.
    pub fn flow(&self) -> Flow {
        let mut flow = Grid::new(self.picture.0, self.picture.1, Flow::UNKNOWN);
        for Feature { at, displacement, .. } in &self.points {
            if let Some((place, displacement)) = flow.cell_at(*at).zip(*displacement) {
                flow[place] = displacement;
            }
        }
        Flow(flow)
    }

    /// Number of features with a status for which `is` holds.
    pub fn count(&self, is: impl Fn(Status) -> bool) -> usize {
        self.points.iter().filter(|point| is(point.status)).count()
    }
}

pub(super) const MEASURES: [Measure; 2] = [
    Measure::new("points", "Number of features; tracks in a run through several frames.").in_column("features", 0),
    Measure::new("tracked", "Number of features tracked; tracks that were not lost."),
];

/// The measures of a detector that runs on the next frame as well.
pub(super) const REPEATABILITY: [Measure; 3] = [
    Measure::new(
        "repeatability",
        "Share of the keypoints that are detected again in frame t + 1, within 1.5 px of their true positions: repeated keypoints by \
         those visible in both frames.",
    )
    .in_column("repeatability", 3).larger_is_better()
    .against_truth(),
    Measure::new("repeated", "Number of keypoints that are detected again in frame t + 1."),
    Measure::new(
        "visible_in_both",
        "Number of keypoints visible in both frames, of the frame with fewer of them: the denominator of the repeatability.",
    ),
];

/// The number of features and, if tracking was attempted, of tracked ones.
pub(super) fn counts(points: usize, tracked: Option<usize>) -> Assessment {
    let of_tracked = tracked.map_or_else(String::new, |tracked| format!(", tracked {}", grouped(tracked)));
    let text = format!("{}{of_tracked}", grouped(points));
    let own = scores(&MEASURES, [points.into(), tracked.into()]);
    Assessment { headline: format!("{text} features"), ..Assessment::default() }.with(own, vec![fact("Features", text)])
}

/// The columns that a feature has in every table.
pub(super) fn row(point: &Feature) -> [Cell; 6] {
    let ([x, y], [u, v]) = (point.at, point.displacement.map_or([None; 2], |uv| uv.map(Some)));
    [x.into(), y.into(), u.into(), v.into(), Cell::Word(point.status.name()), point.residual.into()]
}

impl Product for PointField {
    const KIND: &'static ProductKind = &ProductKind {
        id: "keypoints",
        name: "Keypoints",
        summary: "Feature points of a picture, with their displacements if they were tracked.",
        motion: Motion::Points,
        is_of_single_frames: false,
        has_pictures: false,
        measures: &[&MEASURES, &REPEATABILITY, &flow_error::MEASURES],
    };

    /// Place of each feature, its displacement per frame if it has one, its status, and how it was detected: the
    /// response that it was chosen by, and where that is known its scale and its orientation in degrees.
    fn table(&self) -> Option<Table> {
        let mut columns = vec!["x_px", "y_px", "u_px", "v_px", "status", "residual"];
        let has_scales = self.keypoints.iter().any(|keypoint| keypoint.scale_px.is_some());
        let has_angles = self.keypoints.iter().any(|keypoint| keypoint.angle_rad.is_some());
        columns.extend((!self.keypoints.is_empty()).then_some("response"));
        columns.extend(has_scales.then_some("scale_px"));
        columns.extend(has_angles.then_some("angle_deg"));
        let rows = self.points.iter().enumerate().map(|(i, point)| {
            let mut cells = row(point).to_vec();
            if let Some(keypoint) = self.keypoints.get(i) {
                cells.push(keypoint.response.into());
                cells.extend(has_scales.then(|| Cell::from(keypoint.scale_px)));
                cells.extend(has_angles.then(|| Cell::from(keypoint.angle_rad.map(f32::to_degrees))));
            }
            cells
        });
        Some(Table::of_rows(columns, rows))
    }

    fn assess(&self, reference: &Reference<'_>) -> Result<Assessment, Error> {
        let is_tracked = self.count(|status| status == Status::Found) < self.points.len();
        let tracked = is_tracked.then(|| self.count(|status| status == Status::Tracked));
        let own = counts(self.points.len(), tracked);
        Ok(match is_tracked {
            true => own.and(flow_error::of_points(&PointField::flow(self), reference)),
            false => own,
        })
    }

    /// The displacements of tracked features; `None` where none was to be tracked.
    fn flow(&self) -> Option<Flow> {
        let is_tracked = self.count(|status| status == Status::Found) < self.points.len();
        is_tracked.then(|| PointField::flow(self))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_tracked_features_are_known_to_move() {
        let feature = |at, displacement, status| Feature { at, displacement, status, residual: None };
        let points = vec![
            feature([1.0, 2.0], Some([0.5, -0.25]), Status::Tracked),
            feature([3.0, 0.0], None, Status::Flat),
            feature([9.0, 9.0], Some([1.0, 1.0]), Status::Tracked),
        ];
        let field = PointField { picture: (4, 3), points, keypoints: Vec::new() };
        let flow = Product::flow(&field).expect("they were tracked");
        assert_eq!(flow.at(1, 2), Some([0.5, -0.25]));
        assert_eq!(flow.0.cells().iter().filter(|uv| uv[0].is_finite()).count(), 1);
        assert_eq!(field.prediction(&Grid::new(4, 3, 9)), None);
        assert_eq!(field.count(|status| status == Status::Tracked), 2);
    }

    #[test]
    fn what_was_not_looked_for_is_left_empty() {
        let found = Feature { at: [1.0, 2.5], displacement: None, status: Status::Found, residual: None };
        let message = |keypoints| {
            let field = PointField { picture: (8, 8), points: vec![found], keypoints };
            assert_eq!(Product::flow(&field), None);
            let table = Product::table(&field).expect("a table");
            let rows: Vec<String> = table.rows().flatten().map(Cell::to_string).collect();
            (table.columns().join(","), rows.join(","))
        };
        let usual = "x_px,y_px,u_px,v_px,status,residual".to_owned();
        assert_eq!(message(Vec::new()), (usual.clone(), "1,2.5,,,found,".to_owned()));
        let corner = Keypoint::of_response(12.5);
        assert_eq!(message(vec![corner.clone()]), (format!("{usual},response"), "1,2.5,,,found,,12.5".to_owned()));
        let blob = Keypoint { scale_px: Some(3.5), angle_rad: Some(std::f32::consts::FRAC_PI_2), ..corner };
        let (columns, cells) =
            (format!("{usual},response,scale_px,angle_deg"), "1,2.5,,,found,,12.5,3.5,90".to_owned());
        assert_eq!(message(vec![blob]), (columns, cells));
    }

    #[test]
    fn descriptors_are_apart_by_numbers_or_bits() {
        let reals = |values: &[f32]| Descriptor::Reals(values.into());
        let bits = |values: &[u64]| Descriptor::Bits(values.into());
        assert_eq!(reals(&[1.0, 5.0]).distance(&reals(&[4.0, 1.0])), Some(5.0));
        assert_eq!(bits(&[0b1011, 1]).distance(&bits(&[0b0010, 0])), Some(3.0));
        assert_eq!(bits(&[1]).distance(&reals(&[1.0])), None);
        assert_eq!(reals(&[1.0]).distance(&reals(&[1.0, 2.0])), None);
    }
}
