//! The matrices of a step.

use super::{Event, Gated};
use crate::kalman::{Filter, UpdateNumbers};
use crate::scene::Matrix;
use crate::{Grid, Role};

/// Names of what a sensor measures.
const MEASURED: [&str; 4] = ["x", "y", "u", "v"];

fn column(values: &[f64]) -> Grid<f64> {
    Grid::from_fn(1, values.len(), |_, y| values[y])
}

/// A matrix by its symbol, its name, its role and its entries.
fn matrix(symbol: &'static str, name: &'static str, role: Option<Role>, entries: Grid<f64>) -> Matrix {
    Matrix { symbol, name, role, entries, rows: Vec::new(), columns: Vec::new(), changed: None }
}

/// The state and its covariance, with what differs from `before` lit.
fn belief(filter: &Filter, before: Option<&Filter>, role: Role) -> [Matrix; 2] {
    let differs = |now: &Grid<f64>, old: Option<Grid<f64>>| {
        let old = old.filter(|old| old.size() == now.size())?;
        let (width, height) = now.size();
        Some(Grid::from_fn(width, height, |x, y| now[(x, y)] != old[(x, y)]))
    };
    let (state, covariance) = (column(&filter.state()), filter.covariance());
    let rows = filter.names().to_vec();
    let changed = [
        differs(&state, before.map(|before| column(&before.state()))),
        differs(&covariance, before.map(Filter::covariance)),
    ];
    let [of_state, of_covariance] = changed;
    [
        Matrix { rows: rows.clone(), changed: of_state, ..matrix("x", "state", Some(role), state) },
        Matrix {
            columns: rows.clone(),
            rows,
            changed: of_covariance,
            ..matrix("P", "its covariance", Some(role), covariance)
        },
    ]
}

fn of_update(numbers: UpdateNumbers, names: &[&'static str]) -> [Matrix; 5] {
    let UpdateNumbers { observation, noise, residual, covariance, gain, .. } = numbers;
    let measured = MEASURED[..residual.len()].to_vec();
    let square = |name: &'static str, meaning, entries| Matrix {
        rows: measured.clone(),
        columns: measured.clone(),
        ..matrix(name, meaning, None, entries)
    };
    [
        Matrix { rows: measured.clone(), ..matrix("ν", "innovation", Some(Role::Measured), column(&residual)) },
        square("S", "its covariance", covariance),
        Matrix { rows: names.to_vec(), columns: measured.clone(), ..matrix("K", "gain", None, gain) },
        square("R", "noise of the measurement", noise),
        Matrix {
            rows: measured.clone(),
            columns: names.to_vec(),
            ..matrix("H", "what is measured", None, observation)
        },
    ]
}

/// All matrices of a step.
pub(super) fn matrices(event: Option<&Event>, believed: Option<(&Filter, Role)>) -> Vec<Matrix> {
    match event {
        None | Some(Event::Kept(None)) => Vec::new(),
        Some(Event::Predicted(both)) => {
            let [before, after] = &**both;
            let numbers = before.prediction_numbers();
            let names = before.names().to_vec();
            let square = |name: &'static str, meaning, entries| Matrix {
                rows: names.clone(),
                columns: names.clone(),
                ..matrix(name, meaning, None, entries)
            };
            let mut all = belief(after, Some(before), Role::Predicted).to_vec();
            all.push(square("F", "transition", numbers.transition));
            all.push(square("Q", "noise of the motion", numbers.noise));
            all
        }
        Some(Event::Gated(gated)) => with_update(belief(&gated.expected, None, Role::Predicted), gated),
        Some(Event::Updated(update)) => {
            with_update(belief(&update.1, Some(&update.0.expected), Role::Estimate), &update.0)
        }
        Some(Event::Smoothed(both)) => {
            let [filtered, smoothed] = &**both;
            let names = filtered.names().to_vec();
            let gain = filtered.smoothing_gain().map(|gain| Matrix {
                rows: names.clone(),
                columns: names,
                ..matrix("C", "gain of smoothing", None, gain)
            });
            belief(smoothed, Some(filtered), Role::Result).into_iter().chain(gain).collect()
        }
        Some(_) => believed.map_or_else(Vec::new, |(filter, role)| belief(filter, None, role).to_vec()),
    }
}

fn with_update(belief: [Matrix; 2], gated: &Gated) -> Vec<Matrix> {
    let mut all = belief.to_vec();
    let numbers = gated.expected.update_numbers(&gated.measurement);
    all.extend(numbers.into_iter().flat_map(|numbers| of_update(numbers, gated.expected.names())));
    all
}
