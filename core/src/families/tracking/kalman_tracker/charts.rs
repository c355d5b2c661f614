//! The matrices and the density of a step of the Kalman tracker.

use super::association::Costs;
use super::{Event, KalmanTracker, PairCost, Track};
use crate::geometry::Grid;
use crate::methods::{
    kalman::{Filter, Measurement},
    multi_object::{
        density::TrackDensity,
        explain::Names,
        tracking::{MultiTracking, selected},
    },
    numbers::{RATIO_DECIMALS, SQUARED_DECIMALS},
};
use crate::run::Seen;
use crate::scene::{Matrix, Role};

/// The larger variance of the position in px².
fn variance(track: &Track) -> f64 {
    let [[xx, _], [_, yy]] = track.filter.place_covariance();
    xx.max(yy)
}

/// The track with the least certain position.
pub(super) fn widest(tracks: &[Track]) -> Option<&Track> {
    tracks.iter().max_by(|a, b| variance(a).total_cmp(&variance(b)))
}

/// The state and the covariance of a filter, with the entries that differ from those of `before` lit.
fn estimate_matrices(
    filter: &Filter,
    before: Option<&Filter>,
    role: Role,
    named: [(&'static str, &'static str); 2],
) -> [Matrix; 2] {
    let names: Vec<String> = filter.names().iter().map(|name| (*name).into()).collect();
    let state = |filter: &Filter| Grid::from_fn(1, names.len(), |_, y| filter.state()[y]);
    let matrix = |(symbol, name), entries: Grid<f64>, old: Option<Grid<f64>>| {
        let columns = if entries.width() > 1 { names.clone() } else { Vec::new() };
        let differs = |old: Grid<f64>| Grid::from_fn(old.width(), old.height(), |x, y| entries[(x, y)] != old[(x, y)]);
        let changed = old.map(differs);
        let matrix = Matrix::new(symbol, name, entries).with_role(role).with_rows(names.clone()).with_columns(columns);
        Matrix { changed, ..matrix }
    };
    [
        matrix(named[0], state(filter), before.map(state)).with_decimals(filter.decimals()),
        matrix(named[1], filter.covariance(), before.map(Filter::covariance)),
    ]
}

/// State and covariance of a prediction.
fn prediction_matrices(predicted: &Filter) -> [Matrix; 2] {
    let named = [("x⁻", "predicted state"), ("P⁻", "predicted covariance")];
    estimate_matrices(predicted, None, Role::Predicted, named)
}

/// State and covariance before and after an update.
pub(super) fn update_matrices(predicted: &Filter, updated: &Filter) -> Vec<Matrix> {
    let [state, covariance] = prediction_matrices(predicted);
    let named = [("x", "updated state"), ("P", "updated covariance")];
    let [new_state, new_covariance] = estimate_matrices(updated, Some(predicted), Role::Estimate, named);
    vec![state, new_state, covariance, new_covariance]
}

/// The matrices of a track in a frame: of its update, of its start, or of the prediction alone.
pub(super) fn matrices_of(id: u32, events: &[Event]) -> Vec<Matrix> {
    let of_track = events.iter().rev().find_map(|event| match event {
        Event::Updated(both, _) if both[1].id == id => Some(update_matrices(&both[0].filter, &both[1].filter)),
        Event::Missed(track) | Event::Deleted(track) if track.id == id => {
            Some(prediction_matrices(&track.filter).to_vec())
        }
        Event::Begun(track) if track.id == id => {
            let named = [("x", "initial state"), ("P", "initial covariance")];
            Some(estimate_matrices(&track.filter, None, Role::Reference, named).to_vec())
        }
        _ => None,
    });
    of_track.unwrap_or_default()
}

impl KalmanTracker {
    /// The density of the track of the step, or else of the selected one.
    pub(super) fn density<'a>(&self, seen: &Seen<'a, MultiTracking<Self>>) -> Option<TrackDensity<'a>> {
        let selected = || selected(seen).map(|selected| selected.id);
        let of = |tracks: &'a [Track]| selected().and_then(|id| tracks.iter().find(|track| track.id == id));
        match seen.events.last() {
            Some(Event::Updated(both, measurement)) => Some(TrackDensity {
                updated: Some(&both[1].filter),
                measured: vec![*measurement],
                ..TrackDensity::predicted(&both[0].filter)
            }),
            Some(Event::Assigned(costs, row, pair)) => Some(self.compared(costs, *row, &[pair.column])),
            Some(Event::Costs(costs)) => {
                let id = selected()?;
                let row = costs.tracks.iter().position(|track| track.id == id)?;
                let columns: Vec<_> = costs.costs.row(row).map(|(column, _)| column).collect();
                Some(self.compared(costs, row, &columns))
            }
            Some(Event::Predicted(tracks)) => {
                let track = of(tracks).or_else(|| widest(tracks))?;
                Some(TrackDensity::predicted(&track.filter))
            }
            Some(Event::Missed(track) | Event::Deleted(track)) => Some(TrackDensity::predicted(&track.filter)),
            Some(Event::Begun(track)) => Some(TrackDensity::estimated(&track.filter)),
            None | Some(Event::Detected(..) | Event::Done(..)) => {
                of(&seen.after.unwrap_or(seen.before).tracks).map(|track| TrackDensity::estimated(&track.filter))
            }
        }
    }

    /// A predicted track with the detections of these columns.
    fn compared<'a>(&self, costs: &'a Costs, row: usize, columns: &[usize]) -> TrackDensity<'a> {
        let near = |column: &usize| (self.distance(costs, row, *column), self.measurement(costs, row, *column));
        let mut all: Vec<_> = columns.iter().map(near).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        TrackDensity {
            measured: all.into_iter().map(|(_, measured)| measured).collect(),
            limit: (self.cost != PairCost::Overlap).then_some(costs.limit),
            ..TrackDensity::predicted(&costs.tracks[row].filter)
        }
    }

    /// Returns the squared Mahalanobis distance of a detection from a track.
    pub(super) fn distance(&self, costs: &Costs, row: usize, column: usize) -> f64 {
        let measured = self.measurement(costs, row, column);
        costs.tracks[row].filter.squared_distance(&measured).unwrap_or(f64::INFINITY)
    }

    /// Returns the measurement by a detection that is compared with a track.
    pub(super) fn measurement(&self, costs: &Costs, row: usize, column: usize) -> Measurement {
        let (track, detection) = (&costs.tracks[row], &costs.detections[column]);
        match self.cost {
            PairCost::Mahalanobis => self.dynamics.measurement(detection),
            PairCost::Overlap | PairCost::Both => self.measured(track, detection, costs.picture),
        }
    }

    /// The cost matrices, with the pairs in `lit` lit.
    pub(super) fn tables(&self, costs: &Costs, names: &Names, lit: &[(usize, usize)]) -> Vec<Matrix> {
        let cost = |row, column| costs.costs.get(row, column).unwrap_or(f64::INFINITY);
        // The Mahalanobis distance is its own cost.
        let decimals = if self.cost == PairCost::Mahalanobis { SQUARED_DECIMALS } else { RATIO_DECIMALS };
        let in_decimals = |table: Matrix| table.with_decimals(decimals);
        let mut all =
            vec![names.table(("C", "cost matrix: tracks (rows), detections (columns)"), cost, lit).map(in_decimals)];
        if self.cost != PairCost::Overlap {
            let distance = |row, column| self.distance(costs, row, column);
            let table = names.table(("d²", "squared Mahalanobis distance"), distance, lit);
            all.push(table.map(|table| table.with_decimals(SQUARED_DECIMALS)));
        }
        if self.cost != PairCost::Mahalanobis {
            let overlap = |row, column| costs.overlap(row, column);
            let table = names.table(("IoU", "intersection over union"), overlap, lit);
            all.push(table.map(|table| table.with_decimals(RATIO_DECIMALS)));
        }
        all.into_iter().flatten().collect()
    }
}

/// The pairs of track and detection that a step is about: those inside the gate, the assigned one, or after the assignment all of it.
pub(super) fn lit(seen: &Seen<MultiTracking<KalmanTracker>>, costs: &Costs) -> Vec<(usize, usize)> {
    match seen.events.last() {
        Some(Event::Costs(_)) => {
            let row = |row| (0..costs.costs.columns()).map(move |column| (row, column));
            let all = (0..costs.costs.rows()).flat_map(row);
            all.filter(|(row, column)| costs.costs.get(*row, *column).is_some()).collect()
        }
        Some(Event::Assigned(_, row, pair)) => vec![(*row, pair.column)],
        _ => {
            let pairs = costs.pairs.iter().enumerate();
            pairs.filter_map(|(row, pair)| pair.map(|pair| (row, pair.column))).collect()
        }
    }
}
