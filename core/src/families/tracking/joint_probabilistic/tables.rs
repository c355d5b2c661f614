//! The matrices of the steps of joint probabilistic data association.

use super::events::{Joint, Validation};
use super::{Track, Weights};
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
    let probabilities: Vec<f64> = all.iter().map(|event| event.probability).collect();
    let probability = Matrix::column("P(θ)", "probability of the joint event", &probabilities)
        .with_role(Role::Best)
        .with_rows(names.rows.iter())
        .with_decimals(RATIO_DECIMALS);
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
    const AXES: [&str; 2] = ["x", "y"];
    let matrix = |symbol, name, entries| Matrix::new(symbol, name, entries).with_rows(AXES).with_columns(AXES);
    let innovation = Matrix::column("ν", "combined innovation", &numbers.innovation).with_rows(AXES);
    let gain = matrix("K", "Kalman gain", numbers.gain).with_rows(before.filter.names().iter().copied());
    vec![
        innovation.with_role(Role::Measured).with_decimals(LENGTH_DECIMALS),
        matrix("S", "innovation covariance", numbers.covariance).with_role(Role::Predicted),
        gain.with_role(Role::Estimate),
        matrix("V", "spread of the innovations", numbers.spread).with_role(Role::Candidate),
    ]
}
