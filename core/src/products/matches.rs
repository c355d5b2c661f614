//! Matches: keypoints of frame t with their counterparts in frame t + 1.

use super::assessment::{fact, scores};
use super::{Assessment, Cell, Figure, Measure, Motion, Product, ProductKind, Reference, Table};
use crate::base::{Error, words::grouped};
use crate::data::Flow;
use crate::geometry::Grid;

/// Matches of the keypoints of frame t, in the order of these.
#[derive(Clone, Debug, PartialEq)]
pub struct MatchField {
    /// Width and height of the picture in px.
    pub picture: (usize, usize),
    /// The keypoints that were compared, each with its nearest neighbour.
    pub matches: Vec<Match>,
}

/// A keypoint of frame t and its nearest neighbour among the descriptors of frame t + 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Match {
    /// Position in frame t in px.
    pub from: [f32; 2],
    /// Position of the nearest neighbour in frame t + 1 in px.
    pub to: [f32; 2],
    /// Distance of the descriptors.
    pub distance: f32,
    /// Distance divided by that of the second nearest neighbour, if there is one; undefined where both are 0.
    pub ratio: Option<f32>,
    /// Outcome.
    pub status: MatchStatus,
}

impl Match {
    /// The displacement `[u, v]` in px.
    pub fn displacement(&self) -> [f32; 2] {
        [self.to[0] - self.from[0], self.to[1] - self.from[1]]
    }
}

/// The outcome of a comparison with the nearest neighbour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MatchStatus {
    /// Accepted.
    Match,
    /// The second nearest neighbour is almost as near.
    RejectedRatio,
    /// The nearest neighbour has another nearest neighbour.
    RejectedCrossCheck,
    /// A match that a geometric model contradicts.
    Outlier,
}

impl MatchStatus {
    /// Kebab-case name, for tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Match => "match",
            Self::RejectedRatio => "rejected-ratio",
            Self::RejectedCrossCheck => "rejected-cross-check",
            Self::Outlier => "outlier",
        }
    }
}

/// Largest error of a right match in px.
pub const RIGHT_WITHIN_PX: f32 = 3.0;

/// Matches with known true displacement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MatchErrors {
    /// Number of matches with known true displacement.
    pub known: usize,
    /// Number of those within [`RIGHT_WITHIN_PX`] of it.
    pub right: usize,
}

impl MatchErrors {
    /// Share of right matches, 0 to 1, if any is known.
    pub fn precision(self) -> Option<f64> {
        (self.known > 0).then(|| self.right as f64 / self.known as f64)
    }
}

impl MatchField {
    /// The accepted matches.
    pub fn accepted(&self) -> impl Iterator<Item = &Match> {
        self.matches.iter().filter(|found| found.status == MatchStatus::Match)
    }

    /// Number of matches with this status.
    pub fn count(&self, status: MatchStatus) -> usize {
        self.matches.iter().filter(|found| found.status == status).count()
    }

    /// Compares `matches` with the true flow from frame t.
    pub fn compare<'a>(matches: impl Iterator<Item = &'a Match>, truth: &Flow) -> MatchErrors {
        matches.fold(MatchErrors::default(), |errors, found| match Self::is_right(found, truth) {
            Some(is_right) => MatchErrors { known: errors.known + 1, right: errors.right + usize::from(is_right) },
            None => errors,
        })
    }

    /// Whether a match agrees with the true flow; `None` where that is unknown.
    pub fn is_right(found: &Match, truth: &Flow) -> Option<bool> {
        let ([u, v], [true_u, true_v]) = (found.displacement(), truth.sample(found.from)?);
        Some((u - true_u).hypot(v - true_v) <= RIGHT_WITHIN_PX)
    }
}

const MEASURES: [Measure; 4] = [
    Measure::new("matches", "Number of matches that pass the tests, outliers of a geometric model included.")
        .in_column("matches", 0),
    Measure::new(
        "match_ratio_rejected",
        "Number of nearest neighbours that the ratio test rejects; unknown where the result holds accepted matches alone.",
    ),
    Measure::new(
        "match_cross_check_rejected",
        "Number of nearest neighbours that the cross-check rejects; unknown where the result holds accepted matches alone.",
    ),
    Measure::new(
        "match_precision",
        "Share of the matches, of the inliers where a geometric model is fitted, with a displacement within 3 px of the true one, of \
         those where it is known.",
    )
    .in_column("match precision", 3).larger_is_better()
    .against_truth(),
];

impl Product for MatchField {
    const KIND: &'static ProductKind = &ProductKind {
        id: "matches",
        name: "Matches",
        summary: "Keypoints of frame t with their nearest neighbours in frame t + 1.",
        motion: Motion::Points,
        is_of_single_frames: false,
        has_pictures: false,
        measures: &[&MEASURES],
    };

    /// Position, displacement and descriptor distance of each nearest neighbour, and whether it was accepted.
    fn table(&self) -> Option<Table> {
        let row = |found: &Match| -> [Cell; 7] {
            let ([x, y], [u, v]) = (found.from, found.displacement());
            let Match { distance, ratio, status, .. } = *found;
            [x.into(), y.into(), u.into(), v.into(), distance.into(), ratio.into(), Cell::Word(status.name())]
        };
        let columns = ["x_px", "y_px", "u_px", "v_px", "distance", "ratio", "status"];
        Some(Table::new(columns, self.matches.iter().map(row)))
    }

    fn assess(&self, reference: &Reference<'_>) -> Result<Assessment, Error> {
        let truth = reference.clip.truth().map(|truth| truth.flow(reference.frame)).transpose();
        let (truth, truth_error) = match truth {
            Ok(truth) => (truth.flatten(), None),
            Err(error) => (None, Some(error)),
        };
        let precision = truth.and_then(|truth| Self::compare(self.accepted(), &truth).precision());
        let [accepted, outliers] = [MatchStatus::Match, MatchStatus::Outlier].map(|status| self.count(status));
        let passed = accepted + outliers;
        // Where no rejected neighbour is kept, their number is not known.
        let is_known = passed < self.matches.len();
        let rejected = [MatchStatus::RejectedRatio, MatchStatus::RejectedCrossCheck]
            .map(|status| Figure::from(is_known.then(|| self.count(status))));
        let values = [passed.into(), rejected[0], rejected[1], Figure::from(precision)];
        let told = match (is_known, outliers > 0) {
            (true, _) => format!("{} of {} nearest neighbours", grouped(passed), grouped(self.matches.len())),
            (false, true) => format!("{}, {} of them inliers", grouped(passed), grouped(accepted)),
            (false, false) => grouped(passed),
        };
        let mut facts = vec![fact("Matches", told)];
        facts.extend(precision.map(|share| fact("Right matches (within 3 px)", format!("{:.1} %", 100.0 * share))));
        let inliers = if outliers > 0 { format!(", {} inliers", grouped(accepted)) } else { String::new() };
        let noun = if passed == 1 { "match" } else { "matches" };
        let headline = format!("{} {noun}{inliers}", grouped(passed));
        Ok(Assessment { headline, truth_error, ..Assessment::default() }.with(scores(&MEASURES, values), facts))
    }

    /// The displacements of the accepted matches at the pixels nearest to them; unknown everywhere else.
    fn flow(&self) -> Option<Flow> {
        let mut flow = Grid::new(self.picture.0, self.picture.1, Flow::UNKNOWN);
        for found in self.accepted() {
            if let Some(place) = flow.cell_at(found.from) {
                flow[place] = found.displacement();
            }
        }
        Some(Flow(flow))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::{Clip, Frame};

    #[test]
    fn outliers_are_matches_and_unknown_rejections_are_not_counted() {
        let of = |statuses: &[MatchStatus]| {
            let found = |status| Match { from: [2.0, 1.0], to: [5.0, 1.0], distance: 5.0, ratio: None, status };
            let field = MatchField { picture: (8, 4), matches: statuses.iter().copied().map(found).collect() };
            let clip = Clip::from_frames("flat", vec![Frame::gray(Grid::new(8, 4, 90)); 2]).expect("frames");
            let assessment = field.assess(&Reference { clip: &clip, frame: 0 }).expect("no truth");
            let values: Vec<_> = assessment.scores[..3].iter().map(|score| score.value.real()).collect();
            (values, assessment.facts[0].value.clone(), assessment.headline)
        };
        use MatchStatus::{Match as Inlier, Outlier, RejectedRatio};
        let robust = of(&[Inlier, Outlier, Inlier]);
        assert_eq!(robust, (vec![Some(3.0), None, None], "3, 2 of them inliers".into(), "3 matches, 2 inliers".into()));
        let tested = of(&[Inlier, RejectedRatio, RejectedRatio]);
        let values = vec![Some(1.0), Some(2.0), Some(0.0)];
        assert_eq!(tested, (values, "1 of 3 nearest neighbours".into(), "1 match".into()));
    }

    #[test]
    fn a_match_is_right_within_three_px_of_the_truth() {
        let found = |to: [f32; 2], status| Match { from: [2.0, 1.0], to, distance: 5.0, ratio: None, status };
        let matches = vec![
            found([5.0, 1.0], MatchStatus::Match),
            found([9.0, 1.0], MatchStatus::Match),
            found([5.0, 1.0], MatchStatus::RejectedRatio),
        ];
        let field = MatchField { picture: (8, 4), matches };
        let truth = Flow(Grid::new(8, 4, [3.0, 2.5]));
        let errors = MatchField::compare(field.accepted(), &truth);
        assert_eq!((errors.known, errors.right, errors.precision()), (2, 1, Some(0.5)));
        let unknown = Flow(Grid::new(8, 4, Flow::UNKNOWN));
        assert_eq!(MatchField::compare(field.accepted(), &unknown).precision(), None);
        assert_eq!(Product::flow(&field).and_then(|flow| flow.at(2, 1)), Some([7.0, 0.0]));
        let table = field.table().expect("a table");
        assert_eq!(table.columns().join(","), "x_px,y_px,u_px,v_px,distance,ratio,status");
        let last: Vec<String> = table.rows().nth(2).expect("three rows").iter().map(Cell::to_string).collect();
        assert_eq!(last.join(","), "2,1,3,0,5,,rejected-ratio");
    }
}
