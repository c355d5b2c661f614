//! The matrices of the steps of joint probabilistic data association.

use super::events::{Joint, Validation};
use super::{Track, Weights};
use crate::geometry::Grid;
use crate::methods::{
    multi_object::explain::Names,
    numbers::{LENGTH_DECIMALS, RATIO_DECIMALS, SQUARED_DECIMALS},
};
use crate::scene::{Matrix, Role};

/// The most joint events in a matrix.
const ROWS: usize = 12;

/// The squared Mahalanobis distances in the gates.
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
pub(super) fn update_tables(before: &Track, weights: &Weights) -> Vec<Matrix> {
    let numbers = before.filter.association_numbers(weights.deviation, &weights.measured);
    let Some(numbers) = numbers else { return Vec::new() };
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
