//! The matrices of a step, with changed entries lit.

use super::{Event, FrameRecord, Gated, modes};
use crate::geometry::Grid;
use crate::methods::kalman::{Filter, UpdateNumbers};
use crate::methods::numbers::LENGTH_DECIMALS;
use crate::scene::{Matrix, Role};

/// The names of the components of a measurement.
const MEASURED: [&str; 4] = ["x", "y", "u", "v"];
/// The rounding tolerance of entries, as a share of the largest one of the matrix.
const ROUNDING: f64 = 1e-12;

/// A square matrix with the same labels of rows and columns.
fn square(symbol: &'static str, name: &'static str, entries: Grid<f64>, labels: &[&str]) -> Matrix {
    let matrix = Matrix::new(symbol, name, entries);
    matrix.with_rows(labels.iter().copied()).with_columns(labels.iter().copied())
}

/// Lights the entries that differ from `before`, if that is comparable.
fn lit(matrix: Matrix, before: Option<&Grid<f64>>) -> Matrix {
    let before = before.filter(|before| before.size() == matrix.entries.size());
    let changed = before.map(|before| changes(&matrix.entries, before));
    Matrix { changed, ..matrix }
}

/// Returns where two matrices of equal size differ by more than rounding.
fn changes(now: &Grid<f64>, before: &Grid<f64>) -> Grid<bool> {
    let largest = now.cells().iter().chain(before.cells()).fold(0.0_f64, |most, v| most.max(v.abs()));
    let (width, height) = now.size();
    Grid::from_fn(width, height, |x, y| (now[(x, y)] - before[(x, y)]).abs() > ROUNDING * largest)
}

/// The state and its covariance.
fn estimate_matrices(filter: &Filter, before: Option<&Filter>, role: Role) -> [Matrix; 2] {
    let names = if role == Role::Predicted {
        [("x⁻", "predicted state"), ("P⁻", "predicted covariance")]
    } else {
        [("x", "state"), ("P", "state covariance")]
    };
    named_matrices(filter, before, role, names)
}

/// The state and its covariance under these names.
fn named_matrices(
    filter: &Filter,
    before: Option<&Filter>,
    role: Role,
    [x, p]: [(&'static str, &'static str); 2],
) -> [Matrix; 2] {
    let names = filter.names();
    let state = |filter: &Filter| Matrix::column(x.0, x.1, &filter.state()).with_rows(names.iter().copied());
    let covariance = square(p.0, p.1, filter.covariance(), names).with_role(role);
    [
        lit(
            state(filter).with_role(role).with_decimals(filter.decimals()),
            before.map(|before| state(before).entries).as_ref(),
        ),
        lit(covariance, before.map(Filter::covariance).as_ref()),
    ]
}

/// The matrices of an update, lit where they differ from those before.
fn of_update(numbers: &UpdateNumbers, before: Option<&UpdateNumbers>, names: &[&'static str]) -> [Matrix; 5] {
    let UpdateNumbers { observation, noise, residual, covariance, gain, .. } = numbers;
    let measured = &MEASURED[..residual.len()];
    let innovation = |residual: &[f64]| Matrix::column("ν", "innovation", residual).with_rows(measured.iter().copied());
    let gain = named_gain(("K", "Kalman gain"), gain, names);
    let observation = square("H", "measurement matrix", observation.clone(), measured).with_decimals(0);
    [
        lit(
            innovation(residual).with_role(Role::Best).with_decimals(LENGTH_DECIMALS),
            before.map(|before| innovation(&before.residual).entries).as_ref(),
        ),
        lit(
            square("S", "innovation covariance", covariance.clone(), measured),
            before.map(|before| &before.covariance),
        ),
        lit(gain, before.map(|before| &before.gain)),
        lit(square("R", "measurement noise covariance", noise.clone(), measured), before.map(|before| &before.noise)),
        lit(observation.with_columns(names.iter().copied()), before.map(|before| &before.observation)),
    ]
}

fn named_gain((symbol, name): (&'static str, &'static str), gain: &Grid<f64>, names: &[&'static str]) -> Matrix {
    let columns = MEASURED.into_iter().take(gain.width());
    Matrix::new(symbol, name, gain.clone()).with_rows(names.iter().copied()).with_columns(columns)
}

/// State, covariance and gain of each mode after its update.
fn of_modes(gated: &Gated, after: &[Filter; 2]) -> Vec<Matrix> {
    const NAMES: [[(&str, &str); 3]; 2] = [
        [("x₁", "state of constant velocity"), ("P₁", "its covariance"), ("K₁", "its Kalman gain")],
        [("x₂", "state of the coordinated turn"), ("P₂", "its covariance"), ("K₂", "its Kalman gain")],
    ];
    let before = gated.expected.modes();
    let of_mode = |i: usize| {
        let ([x, p, k], before) = (NAMES[i], before.as_ref().map(|modes| &modes[i]));
        let numbers = before.and_then(|before| before.update_numbers(gated.measurement()));
        let gain = numbers.map(|numbers| named_gain(k, &numbers.gain, after[i].names()));
        named_matrices(&after[i], before, modes::ROLES[i], [x, p]).into_iter().chain(gain)
    };
    (0..2).flat_map(of_mode).collect()
}

/// F and Q of a prediction, lit where they differ from those of the prediction before; sigma points have a regression A instead of F.
fn of_prediction(from: &Filter, before: Option<&Filter>) -> [Matrix; 2] {
    let (now, before) = (from.prediction_numbers(), before.map(Filter::prediction_numbers));
    let names = from.names();
    // The entries of a linear model are 0, 1 and ½.
    let decimals = match from {
        Filter::Velocity(..) => Some(0),
        Filter::Acceleration(..) => Some(1),
        Filter::Turn(..) | Filter::Interacting(..) => None,
    };
    let (symbol, meaning) = match from.sigma() {
        Some(_) => ("A", "linear regression of f(x) on x"),
        None => ("F", "transition matrix"),
    };
    let transition = Matrix { decimals, ..square(symbol, meaning, now.transition, names) };
    [
        lit(transition, before.as_ref().map(|before| &before.transition)),
        lit(square("Q", "process noise covariance", now.noise, names), before.as_ref().map(|before| &before.noise)),
    ]
}

/// Returns the matrices of a step after the frames `records`.
pub(super) fn matrices<'a>(
    event: Option<&Event>,
    current: Option<(&Filter, Role)>,
    records: impl DoubleEndedIterator<Item = &'a FrameRecord>,
) -> Vec<Matrix> {
    // Records of the same track, the latest first.
    let mut earlier = Vec::new();
    for record in records.rev() {
        earlier.push(record);
        if record.begins {
            break;
        }
    }
    match event {
        None | Some(Event::Kept(None)) => Vec::new(),
        Some(Event::Predicted(both)) => {
            let [before, after] = &**both;
            let one_step_before = earlier.get(1).and_then(|record| record.filtered.as_ref());
            let mut all = estimate_matrices(after, Some(before), Role::Predicted).to_vec();
            match modes::probabilities(after, Some(before)) {
                Some(probabilities) => all.push(probabilities),
                None => all.extend(of_prediction(before, one_step_before)),
            }
            all
        }
        Some(Event::Mixed(before)) => modes::mixing_matrices(before),
        Some(Event::Gated(gated)) => {
            let role = if gated.is_updated { Role::Estimate } else { Role::Predicted };
            let before = earlier.iter().find_map(|record| record.of_sensor(gated.reading.sensor));
            with_update(estimate_matrices(&gated.expected, None, role), gated, before)
        }
        Some(Event::Updated(update) | Event::Weighed(update)) => {
            let (gated, after) = &**update;
            if let (Some(Event::Updated(_)), Some(modes)) = (event, after.modes()) {
                return of_modes(gated, &modes);
            }
            let mut all = with_update(estimate_matrices(after, Some(&gated.expected), Role::Estimate), gated, None);
            all.extend(modes::probabilities(after, Some(&gated.expected)));
            all
        }
        Some(Event::Smoothed(both)) => {
            let [filtered, smoothed] = &**both;
            let gain = filtered.smoothing_gain().map(|gain| square("C", "smoother gain", gain, filtered.names()));
            estimate_matrices(smoothed, Some(filtered), Role::Result).into_iter().chain(gain).collect()
        }
        Some(_) => current.map_or_else(Vec::new, |(filter, role)| estimate_matrices(filter, None, role).to_vec()),
    }
}

fn with_update(estimate_matrices: [Matrix; 2], gated: &Gated, before: Option<&Gated>) -> Vec<Matrix> {
    let numbers = |gated: &Gated| gated.expected.update_numbers(gated.measurement());
    let before = before.and_then(numbers);
    let mut all = estimate_matrices.to_vec();
    all.extend(
        numbers(gated).into_iter().flat_map(|numbers| of_update(&numbers, before.as_ref(), gated.expected.names())),
    );
    // Each mode has a gain of its own.
    all.retain(|matrix| gated.expected.modes().is_none() || matrix.symbol != "K");
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_lights_nothing() {
        let before = Grid::from_vec(2, 1, vec![100.0, 1e-15]).expect("two entries");
        let now = Grid::from_vec(2, 1, vec![100.0 + 1e-12, 0.5]).expect("two entries");
        assert_eq!(changes(&now, &before).cells(), [false, true]);
    }
}
