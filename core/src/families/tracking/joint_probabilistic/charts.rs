//! The matrices and the density of a step of joint probabilistic data association.

use super::events::{Joint, Validation};
use super::{Event, JointProbabilistic, Track};
use crate::geometry::Grid;
use crate::methods::{
    kalman::{AssociationNumbers, Measurement},
    multi_object::{
        density::TrackDensity,
        explain::Names,
        tracking::{MultiTracking, selected},
    },
    numbers::{LENGTH_DECIMALS, RATIO_DECIMALS, SQUARED_DECIMALS},
};
use crate::run::Seen;
use crate::scene::{Matrix, Role};

/// The most joint events in a matrix.
const ROWS: usize = 12;

impl JointProbabilistic {
    /// The density of the track of the step, or else of the selected one; of a cluster without it, of its first track.
    pub(super) fn density<'a>(&self, seen: &Seen<'a, MultiTracking<Self>>) -> Option<TrackDensity<'a>> {
        let selected = selected(seen).map(|selected| selected.id);
        let of = |tracks: &'a [Track]| tracks.iter().find(|track| Some(track.id) == selected);
        match seen.events.last() {
            Some(Event::Updated(both, weights)) => {
                let measured =
                    |&(place, _): &_| Measurement { place, place_deviation: weights.deviation, velocity: None };
                Some(TrackDensity {
                    updated: Some(&both[1].filter),
                    measured: weights.measured.iter().map(measured).collect(),
                    ..TrackDensity::predicted(&both[0].filter)
                })
            }
            Some(Event::Validated(validation)) => {
                let row = validation.tracks.iter().position(|track| Some(track.id) == selected)?;
                Some(self.validated_track(validation, row))
            }
            Some(Event::Enumerated(validation, joint) | Event::Weighed(validation, joint)) => {
                let mut rows = joint.tracks.iter();
                let found = rows.find(|row| Some(validation.tracks[**row].id) == selected);
                Some(self.validated_track(validation, *found.or(joint.tracks.first())?))
            }
            Some(Event::Predicted(tracks)) => of(tracks).map(|track| TrackDensity::predicted(&track.filter)),
            Some(Event::Missed(track, _) | Event::Deleted(track)) => Some(TrackDensity::predicted(&track.filter)),
            Some(Event::Begun(track, _)) => Some(TrackDensity::estimated(&track.filter)),
            None | Some(Event::Detected(..) | Event::Done(..)) => {
                of(&seen.after.unwrap_or(seen.before).tracks).map(|track| TrackDensity::estimated(&track.filter))
            }
        }
    }

    /// A predicted track with the detections in its gate.
    fn validated_track<'a>(&self, validation: &'a Validation, row: usize) -> TrackDensity<'a> {
        let track = &validation.tracks[row];
        let mut near: Vec<_> = validation.distances.row(row).collect();
        near.sort_by(|a, b| a.1.total_cmp(&b.1));
        let measured = |(column, _): (usize, f64)| self.measurement(track, &validation.detections[column]);
        TrackDensity {
            measured: near.into_iter().map(measured).collect(),
            limit: Some(validation.limit),
            ..TrackDensity::predicted(&track.filter)
        }
    }
}

pub(super) fn validation_table(validation: &Validation) -> Option<Matrix> {
    let names = Names::new(validation.tracks.iter().map(|track| track.id.to_string()), 0..validation.detections.len());
    let distance = |row, column| validation.distances.get(row, column).unwrap_or(f64::INFINITY);
    names
        .table(("d²", "squared Mahalanobis distance in the gate: tracks (rows), detections (columns)"), distance, &[])
        .map(|table| table.with_decimals(SQUARED_DECIMALS))
}

/// The joint events with their probabilities.
pub(super) fn event_tables(validation: &Validation, joint: &Joint) -> Vec<Matrix> {
    let all = &joint.events[..joint.events.len().min(ROWS)];
    let names = Names::new((1..=all.len()).map(|i| format!("θ{i}")), joint.detections.iter().copied());
    let entry = |row: usize, column: usize| match all[row].tracks[column] {
        Some(track) => f64::from(validation.tracks[joint.tracks[track]].id),
        None => 0.0,
    };
    let name = "track of each detection (columns) in each joint event (rows); 0: false alarm";
    let probability = Matrix {
        symbol: "P(θ)",
        name: "probability of the joint event",
        role: Some(Role::Best),
        entries: Grid::from_fn(1, all.len(), |_, y| all[y].probability),
        rows: names.rows.clone(),
        columns: Vec::new(),
        changed: None,
        decimals: Some(RATIO_DECIMALS),
    };
    let origins = names.table(("θ", name), entry, &[]).map(|table| table.with_decimals(0));
    origins.into_iter().chain((!all.is_empty()).then_some(probability)).collect()
}

/// β of each track and detection, with β₀ in the last column.
pub(super) fn weight_table(validation: &Validation, joint: &Joint) -> Option<Matrix> {
    let mut names = Names::new(
        joint.tracks.iter().map(|track| validation.tracks[*track].id.to_string()),
        joint.detections.iter().copied(),
    );
    names.columns.push("none".into());
    let entry = |row: usize, column: usize| match column < joint.detections.len() {
        true => joint.weight(row, column),
        false => joint.missed(row),
    };
    names
        .table(("β", "probability of the association: tracks (rows), detections (columns)"), entry, &[])
        .map(|table| table.with_decimals(RATIO_DECIMALS))
}

/// The combined innovation, its covariance, the spread of the innovations and the gain.
pub(super) fn update_tables(before: &Track, numbers: AssociationNumbers) -> Vec<Matrix> {
    let axes: Vec<String> = ["x", "y"].map(String::from).into();
    let states: Vec<String> = before.filter.names().iter().map(|name| (*name).into()).collect();
    let matrix = |symbol, name, role, entries: Grid<f64>, rows: &[String]| Matrix {
        symbol,
        name,
        role: Some(role),
        columns: if entries.width() > 1 { axes.clone() } else { Vec::new() },
        rows: rows.to_vec(),
        changed: None,
        decimals: None,
        entries,
    };
    let innovation = Grid::from_fn(1, 2, |_, y| numbers.innovation[y]);
    vec![
        matrix("ν", "combined innovation", Role::Measured, innovation, &axes).with_decimals(LENGTH_DECIMALS),
        matrix("S", "innovation covariance", Role::Predicted, numbers.covariance, &axes),
        matrix("K", "Kalman gain", Role::Estimate, numbers.gain, &states),
        matrix("V", "spread of the innovations", Role::Candidate, numbers.spread, &axes),
    ]
}
