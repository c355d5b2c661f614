//! Who belongs to whom in a frame.

use std::sync::Arc;

use super::{Association, KalmanTracker, PairCost, Track};
use crate::Grid;
use crate::kalman::{Measurement, chi_square};
use crate::objects::assignment::{least_cost, nearest_first};
use crate::objects::{Bounds, Detection, Life};

/// In whose turn a pair was chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// Of objects that are believed in, or of all, with sure detections.
    First,
    /// Of objects that were seen in the frame before, with detections that are less sure.
    LessSure,
    /// Of tentative objects.
    Tentative,
    /// Of objects that are believed in, by the boxes in which they were last seen.
    LastBox,
}

/// The detection of an object.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    pub column: usize,
    pub cost: f64,
    pub turn: Turn,
}

/// Objects beside detections.
#[derive(Clone, Debug)]
pub struct Costs {
    pub tracks: Vec<Track>,
    pub detections: Arc<Vec<Detection>>,
    /// Which detections are sure.
    pub is_sure: Vec<bool>,
    /// Squared Mahalanobis distances and overlaps; a row for each object.
    pub distances: Grid<f64>,
    pub overlaps: Grid<f64>,
    /// What a pair costs, infinite where it is not allowed.
    pub costs: Grid<f64>,
    /// The limit of the squared distances.
    pub limit: f64,
    /// The detection of each object.
    pub pairs: Vec<Option<Pair>>,
}

impl KalmanTracker {
    /// What each pair of `tracks` and `detections` would cost, and who belongs to whom.
    pub(super) fn costs(
        &self,
        tracks: Vec<Track>,
        detections: Arc<Vec<Detection>>,
        is_sure: impl Fn(&Detection) -> bool,
    ) -> Costs {
        let size = (detections.len(), tracks.len());
        let measured: Vec<Measurement> = detections.iter().map(|detection| self.measurement(detection)).collect();
        let distances = Grid::from_fn(size.0, size.1, |x, y| {
            tracks[y].filter.squared_distance(&measured[x]).unwrap_or(f64::INFINITY)
        });
        let boxes: Vec<Bounds> = tracks.iter().map(Track::bounds).collect();
        let overlaps = Grid::from_fn(size.0, size.1, |x, y| f64::from(boxes[y].iou(&detections[x].bounds)));
        let limit = chi_square::quantile(f64::from(self.gate), 2);
        let least = f64::from(self.min_overlap);
        let costs = Grid::from_fn(size.0, size.1, |x, y| {
            let (distance, overlap) = (distances[(x, y)], overlaps[(x, y)]);
            let (is_near, has_overlap) = (distance <= limit, overlap > 0.0 && overlap >= least);
            let apart = (1.0 - overlap) / (1.0 - least);
            match self.cost {
                PairCost::Mahalanobis if is_near => distance,
                PairCost::Overlap if has_overlap => 1.0 - overlap,
                PairCost::Both if is_near && has_overlap => (distance / limit + apart) / 2.0,
                _ => f64::INFINITY,
            }
        });
        let is_sure = detections.iter().map(is_sure).collect();
        let pairs = vec![None; tracks.len()];
        let mut all = Costs { tracks, detections, is_sure, distances, overlaps, costs, limit, pairs };
        self.share(&mut all);
        all
    }

    /// Chooses pairs, turn after turn.
    fn share(&self, all: &mut Costs) {
        let is_first = |track: &Track| !self.in_turns || track.age.life != Life::Tentative;
        let by_cost = all.costs.clone();
        self.take_turn(all, Turn::First, &by_cost, |track, is_sure| is_sure && is_first(track));
        self.take_turn(all, Turn::LessSure, &by_cost, |track, is_sure| {
            !is_sure && is_first(track) && track.age.missed == 0
        });
        if self.in_turns {
            self.take_turn(all, Turn::Tentative, &by_cost, |track, is_sure| is_sure && !is_first(track));
        }
        if self.recover {
            let least = f64::from(self.min_overlap);
            let by_last_box = Grid::from_fn(all.detections.len(), all.tracks.len(), |x, y| {
                let overlap = f64::from(all.tracks[y].last.iou(&all.detections[x].bounds));
                if overlap > 0.0 && overlap >= least { 1.0 - overlap } else { f64::INFINITY }
            });
            self.take_turn(all, Turn::LastBox, &by_last_box, |track, is_sure| {
                is_sure && track.age.life != Life::Tentative
            });
        }
    }

    /// Chooses pairs of objects and detections that are left, as far as they take part.
    fn take_turn(&self, all: &mut Costs, turn: Turn, costs: &Grid<f64>, takes_part: impl Fn(&Track, bool) -> bool) {
        let (width, height) = costs.size();
        let mut is_free = vec![true; width];
        all.pairs.iter().flatten().for_each(|pair| is_free[pair.column] = false);
        let costs = Grid::from_fn(width, height, |x, y| {
            let is_open = is_free[x] && all.pairs[y].is_none() && takes_part(&all.tracks[y], all.is_sure[x]);
            if is_open { costs[(x, y)] } else { f64::INFINITY }
        });
        if costs.cells().iter().all(|cost| cost.is_infinite()) {
            return;
        }
        let chosen = match self.association {
            Association::Nearest => nearest_first(&costs),
            Association::Assignment => least_cost(&costs),
        };
        for (row, column) in chosen.into_iter().enumerate().filter_map(|(row, column)| Some((row, column?))) {
            all.pairs[row] = Some(Pair { column, cost: costs[(column, row)], turn });
        }
    }
}
