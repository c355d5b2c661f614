//! Keypoints: features of one picture, with their displacements where they were tracked.

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
    /// What each was chosen by, as far as it is a corner that this run has found; else empty.
    pub responses: Vec<f32>,
}

/// One feature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feature {
    /// Its place in frame t, in px.
    pub at: [f32; 2],
    /// Its displacement `[u, v]` in px/frame, if it was tracked.
    pub displacement: Option<[f32; 2]>,
    /// What became of it.
    pub status: Status,
    /// Mean absolute difference of its window in both frames, in gray levels, if that is known.
    pub residual: Option<f32>,
}

/// What became of a feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// It was found, and nobody looked where it goes.
    Found,
    /// It was found again in frame t + 1.
    Tracked,
    /// Lost: it leaves the picture.
    Outside,
    /// Lost: its window has too little texture to tell two directions apart.
    Flat,
    /// Lost: what it led to looks too different.
    Unlike,
    /// Lost: tracked back, it does not come to where it was.
    Astray,
    /// Lost: it no longer looks as it did where it was first seen.
    Changed,
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
        }
    }
}

impl PointField {
    /// The displacements of the features at the pixels nearest to them; unknown everywhere else.
    pub fn flow(&self) -> Flow {
        let mut flow = Grid::new(self.picture.0, self.picture.1, Flow::UNKNOWN);
        for Feature { at: [x, y], displacement, .. } in &self.points {
            let place = (x.round() as usize, y.round() as usize);
            if let Some(displacement) = displacement.filter(|_| flow.get(place.0, place.1).is_some()) {
                flow[place] = displacement;
            }
        }
        Flow(flow)
    }

    /// How many features have a status for which `is` holds.
    pub fn count(&self, is: impl Fn(Status) -> bool) -> usize {
        self.points.iter().filter(|point| is(point.status)).count()
    }
}

pub(super) const MEASURES: [Measure; 2] = [
    Measure::new("points", "Features; of a run through several frames, tracks.").in_column("features", 0),
    Measure::new("tracked", "Features that were tracked; of tracks, those that were not lost."),
];

/// How many features there are, and how many of them were tracked, if any were to be.
pub(super) fn counts(points: usize, tracked: Option<usize>) -> Assessment {
    let told = tracked.map_or_else(String::new, |tracked| format!(", tracked {}", grouped(tracked)));
    let text = format!("{}{told}", grouped(points));
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
        summary: "Single features of a picture, with their displacements where they were tracked.",
        motion: Motion::Points,
        is_of_single_frames: false,
        measures: &[&MEASURES, &flow_error::MEASURES],
    };

    /// Place of each feature, its displacement per frame if it has one, what became of it, and the response that it was
    /// chosen by.
    fn table(&self) -> Option<Table> {
        Some(if self.responses.is_empty() {
            let columns = ["x_px", "y_px", "u_px", "v_px", "status", "residual"];
            Table::new(columns, self.points.iter().map(row))
        } else {
            let columns = ["x_px", "y_px", "u_px", "v_px", "status", "residual", "response"];
            let with_response = |(point, response): (&Feature, &f32)| {
                let [x, y, u, v, status, residual] = row(point);
                [x, y, u, v, status, residual, (*response).into()]
            };
            Table::new(columns, self.points.iter().zip(&self.responses).map(with_response))
        })
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
        let field = PointField { picture: (4, 3), points, responses: Vec::new() };
        let flow = Product::flow(&field).expect("they were tracked");
        assert_eq!(flow.at(1, 2), Some([0.5, -0.25]));
        assert_eq!(flow.0.cells().iter().filter(|uv| uv[0].is_finite()).count(), 1);
        assert_eq!(field.prediction(&Grid::new(4, 3, 9)), None);
        assert_eq!(field.count(|status| status == Status::Tracked), 2);
    }

    #[test]
    fn what_was_not_looked_for_is_left_empty() {
        let found = Feature { at: [1.0, 2.5], displacement: None, status: Status::Found, residual: None };
        let told = |responses| {
            let field = PointField { picture: (8, 8), points: vec![found], responses };
            assert_eq!(Product::flow(&field), None);
            let table = Product::table(&field).expect("a table");
            let rows: Vec<String> = table.rows().flatten().map(Cell::to_string).collect();
            (table.columns().len(), rows.join(","))
        };
        assert_eq!(told(Vec::new()), (6, "1,2.5,,,found,".to_owned()));
        assert_eq!(told(vec![12.5]), (7, "1,2.5,,,found,,12.5".to_owned()));
    }
}
