//! The tree, the matrices and the density of a step of multiple hypothesis tracking.

use std::sync::Arc;

use super::expand::{Expansion, Gates};
use super::forest::{Claim, Origin, Track};
use super::{Event, MultipleHypothesis, State};
use crate::geometry::Grid;
use crate::methods::{
    multi_object::{
        density::TrackDensity,
        explain::Names,
        tracking::{MultiTracking, selected},
    },
    numbers::{SQUARED_DECIMALS, ratio},
};
use crate::run::Seen;
use crate::scene::{Diagram, Matrix, Role};

/// The most hypotheses in a matrix.
pub(super) const ROWS: usize = 12;

impl MultipleHypothesis {
    /// The tree of the hypotheses before and after the decision of an earlier frame.
    pub(super) fn tree(&self, seen: &Seen<MultiTracking<Self>>) -> Option<Diagram> {
        let tree = match seen.events.last()? {
            Event::Pruned(pruning) => pruning.tree.as_ref()?,
            Event::Led(leading) => leading.tree.as_ref()?,
            _ => return None,
        };
        let of_tree = seen.events.iter().find_map(|event| match event {
            Event::Expanded(_, expansion) => {
                expansion.branches.iter().any(|branch| tree.has(&branch.scan)).then_some(expansion)
            }
            _ => None,
        });
        let mut notes = Vec::new();
        if of_tree.is_some_and(|expansion| expansion.has_more) {
            notes.push(format!("k best: branches beyond the first {} are left out", self.max_hypotheses));
        }
        if self.min_ratio > 0.0 {
            notes.push(format!("ratio: branches below {} times the best are left out", ratio(self.min_ratio.into())));
        }
        Some(tree.drawn(&notes))
    }
}

/// The density of the selected track in the leading hypothesis; of a cluster without it, of its first track.
pub(super) fn density<'a>(seen: &Seen<'a, MultiTracking<MultipleHypothesis>>) -> Option<TrackDensity<'a>> {
    let selected = selected(seen).map(|selected| selected.id);
    let estimated = |track: &'a Arc<Track>| TrackDensity::estimated(&track.filter);
    match seen.events.last() {
        Some(Event::Predicted(tracks)) => {
            let row = leading_row(seen.before, selected?)?;
            Some(TrackDensity::predicted(&tracks.get(row)?.filter))
        }
        Some(Event::Gated(gates)) => gated_track(gates, leading_row(seen.before, selected?)?),
        Some(Event::Expanded(gates, expansion)) => {
            let ids = || expansion.tracks.iter().map(|track| track.id);
            let chosen = ids().filter(|id| Some(*id) == selected);
            gated_track(gates, chosen.chain(ids()).find_map(|id| leading_row(seen.before, id))?)
        }
        None | Some(Event::Detected(..)) => {
            let row = leading_row(seen.before, selected?)?;
            seen.before.tracks.iter().flat_map(|cluster| &cluster.tracks).nth(row).map(estimated)
        }
        Some(Event::Pruned(_) | Event::Led(_) | Event::Revised(_) | Event::Done(..)) => {
            let led = seen.events.iter().find_map(|event| match event {
                Event::Led(leading) => Some(leading),
                _ => None,
            });
            let mut tracks = led?.scans.iter().flat_map(|scan| &scan.tracks);
            tracks.find(|track| Some(track.id) == selected).map(estimated)
        }
    }
}

/// The place of a track of the leading hypotheses among the tracks of all clusters.
fn leading_row(state: &State, id: u32) -> Option<usize> {
    let mut first = 0;
    state.tracks.iter().find_map(|cluster| {
        let leading = cluster.hypotheses.first().map_or(&[][..], |leader| &leader.tracks);
        let found = leading.iter().find(|track| cluster.tracks[**track].id == id).map(|track| first + track);
        first += cluster.tracks.len();
        found
    })
}

/// A predicted track with the detections in its gate.
fn gated_track(gates: &Gates, row: usize) -> Option<TrackDensity<'_>> {
    let mut near: Vec<_> = gates.distances.row(row).collect();
    near.sort_by(|a, b| a.1.total_cmp(&b.1));
    Some(TrackDensity {
        measured: near.into_iter().map(|(column, _)| gates.measured[column]).collect(),
        limit: Some(gates.limit),
        ..TrackDensity::predicted(&gates.tracks.get(row)?.filter)
    })
}

/// The squared Mahalanobis distances in the gates.
pub(super) fn distances(gates: &Gates) -> Option<Matrix> {
    let named = gates.tracks.iter().enumerate().map(|(i, track)| {
        let before = gates.tracks[..i].iter().filter(|other| other.id == track.id).count();
        // Tracks of one object with different pasts.
        if before == 0 { track.id.to_string() } else { format!("{}, past {}", track.id, before + 1) }
    });
    let names = Names::new(named, 0..gates.detections.len());
    let distance = |row, column| gates.distances.get(row, column).unwrap_or(f64::INFINITY);
    names
        .table(("d²", "squared Mahalanobis distance in the gate: tracks (rows), detections (columns)"), distance, &[])
        .map(|table| table.with_decimals(SQUARED_DECIMALS))
}

/// Reid's matrix: the origin of each detection in each branch, with the probabilities.
pub(super) fn branch_tables(expansion: &Expansion) -> Vec<Matrix> {
    let all = &expansion.branches[..expansion.branches.len().min(ROWS)];
    let names = Names::new((1..=all.len()).map(|i| format!("H{i}")), expansion.detections.iter().copied());
    let entry = |row: usize, column: usize| match all[row].scan.claims.get(column).map(|claim| claim.origin) {
        Some(Origin::Track(id) | Origin::New(id)) => f64::from(id),
        _ => 0.0,
    };
    let is_new = |row: usize, column: usize| {
        matches!(all[row].scan.claims.get(column), Some(Claim { origin: Origin::New(_), .. }))
    };
    let cells = (0..all.len()).flat_map(|row| (0..expansion.detections.len()).map(move |column| (row, column)));
    let lit: Vec<(usize, usize)> = cells.filter(|(row, column)| is_new(*row, *column)).collect();
    let name = "track of each detection (columns) in each branch (rows); 0: false alarm, lit: new track";
    let column = |symbol, name, of: &dyn Fn(usize) -> f64| {
        let entries = Grid::from_fn(1, all.len(), |_, y| of(y));
        Matrix::new(symbol, name, entries).with_role(Role::Best).with_rows(names.rows.iter())
    };
    let table = names.table(("Ω", name), entry, &lit).map(|table| table.with_decimals(0));
    let probability = column("P", "probability of the branch", &|y| all[y].probability);
    let parent = column("P₀", "probability of its parent", &|y| expansion.parents[all[y].parent]);
    table.into_iter().chain((!all.is_empty()).then_some([probability, parent]).into_iter().flatten()).collect()
}
