//! Data association: gating, costs and assignment of tracks and detections.

use std::sync::Arc;

use super::{Association, KalmanTracker, PairCost, Track};
use crate::base::Error;
use crate::data::{Clip, Detection};
use crate::geometry::Bounds;
use crate::methods::{
    kalman::chi_square,
    multi_object::gating::{MOST_NEAR, rows_of, squared_distances},
};
use crate::products::{
    TrackStatus,
    objects::{
        assignment::{Assigned, WorkBudget, least_cost, nearest_first},
        box_index::{BoxIndex, corners, nearest},
        pairs::Pairs,
    },
};

/// The stage of the matching in which a pair was assigned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MatchingStage {
    /// Confirmed tracks, or all, with high-score detections.
    First,
    /// Tracks matched in the previous frame with low-score detections.
    LowScore,
    /// Tentative tracks.
    Tentative,
    /// Confirmed tracks by their last detected boxes.
    LastBox,
}

/// The detection assigned to a track.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    pub column: usize,
    pub cost: f64,
    pub stage: MatchingStage,
}

/// The cost matrix and the assignment.
#[derive(Clone, Debug)]
pub struct Costs {
    pub tracks: Vec<Track>,
    pub detections: Arc<Vec<Detection>>,
    /// Whether the score of each detection reaches the score threshold.
    pub is_high: Vec<bool>,
    /// The costs of the pairs inside the gate; a row for each track.
    pub costs: Pairs,
    /// The gating threshold of d².
    pub limit: f64,
    /// Width and height of the picture in px.
    pub picture: (usize, usize),
    /// The detection of each track.
    pub pairs: Vec<Option<Pair>>,
    /// The number of tracks with more than [`MOST_NEAR`] detections nearby, of which only the nearest count.
    pub crowded: usize,
    /// The number of tracks assigned greedily because too many compete.
    pub greedy: usize,
}

/// The maximum number of pairs visited by an assignment, a few tenths of a second; beyond it the assignment is greedy.
const MOST_WORK: u64 = 20_000_000;

impl Costs {
    /// Returns the IoU of a track and a detection.
    pub fn overlap(&self, row: usize, column: usize) -> f64 {
        f64::from(self.tracks[row].bounds().iou(&self.detections[column].bounds))
    }
}

impl KalmanTracker {
    /// Computes the costs of the pairs inside the gate, and the assignment.
    ///
    /// # Errors
    /// If the work is cancelled.
    pub(super) fn costs(
        &self,
        clip: &Clip,
        (tracks, detections): (Vec<Track>, Arc<Vec<Detection>>),
        is_high: impl Fn(&Detection) -> bool,
    ) -> Result<Costs, Error> {
        let measured: Vec<_> = detections.iter().map(|detection| self.dynamics.measurement(detection)).collect();
        let limit = chi_square::quantile(f64::from(self.gate), 2);
        let boxes = BoxIndex::new(detections.iter().map(|detection| corners(&detection.bounds)));
        let (costs, crowded) = match self.cost {
            PairCost::Mahalanobis => {
                let filters = tracks.iter().map(|track| &track.filter);
                squared_distances(clip, filters, (&detections, &measured), limit)
            }
            PairCost::Overlap | PairCost::Both => self.by_overlap(clip, (&detections, limit), &boxes, &tracks),
        }?;
        let is_high = detections.iter().map(is_high).collect();
        let pairs = vec![None; tracks.len()];
        let mut all =
            Costs { tracks, detections, is_high, costs, limit, picture: clip.size(), pairs, crowded, greedy: 0 };
        self.associate(clip, &mut all, &boxes)?;
        Ok(all)
    }

    /// Returns the costs of the pairs above the IoU threshold and, if both count, inside the gate.
    fn by_overlap(
        &self,
        clip: &Clip,
        (detections, limit): (&[Detection], f64),
        boxes: &BoxIndex,
        tracks: &[Track],
    ) -> Result<(Pairs, usize), Error> {
        let least = f64::from(self.iou_threshold);
        rows_of(clip, detections.len(), tracks.iter(), |track, found| {
            self.overlapping(&track.bounds(), (boxes, detections), found);
            let is_cut = nearest(found, track.filter.place(), (detections, MOST_NEAR));
            let cost = |x: usize, overlap: f64| {
                if self.cost == PairCost::Overlap {
                    return Some(1.0 - overlap);
                }
                let measured = self.measured(track, &detections[x], clip.size());
                let distance = track.filter.squared_distance(&measured)?;
                let apart = (1.0 - overlap) / (1.0 - least);
                (distance <= limit).then(|| (distance / limit + apart) / 2.0)
            };
            (found.iter().filter_map(|(x, overlap)| Some((*x, cost(*x, *overlap)?))).collect(), is_cut)
        })
    }

    /// Finds the detections above the IoU threshold with a box, and their IoU.
    fn overlapping(&self, bounds: &Bounds, (boxes, all): (&BoxIndex, &[Detection]), found: &mut Vec<(usize, f64)>) {
        let is_enough = |overlap: &f64| *overlap > 0.0 && *overlap >= f64::from(self.iou_threshold);
        let overlap = |x: usize| Some(f64::from(bounds.iou(&all[x].bounds))).filter(is_enough);
        boxes.touching(corners(bounds), found, overlap);
    }

    /// Assigns detections in stages.
    fn associate(&self, clip: &Clip, all: &mut Costs, boxes: &BoxIndex) -> Result<(), Error> {
        let is_first = |track: &Track| !self.cascade || track.age.status != TrackStatus::Tentative;
        let by_cost = all.costs.clone();
        self.match_stage(clip, (all, MatchingStage::First), &by_cost, |track, is_high| is_high && is_first(track))?;
        self.match_stage(clip, (all, MatchingStage::LowScore), &by_cost, |track, is_high| {
            !is_high && is_first(track) && track.age.missed == 0
        })?;
        if self.cascade {
            self.match_stage(clip, (all, MatchingStage::Tentative), &by_cost, |track, is_high| {
                is_high && !is_first(track)
            })?;
        }
        if self.recover {
            let by_last_box = self.by_last_box(all, boxes);
            self.match_stage(clip, (all, MatchingStage::LastBox), &by_last_box, |track, is_high| {
                is_high && track.age.status != TrackStatus::Tentative
            })?;
        }
        Ok(())
    }

    /// Returns the costs of unassigned tracks by their last detected boxes.
    fn by_last_box(&self, all: &Costs, boxes: &BoxIndex) -> Pairs {
        let (mut pairs, mut found) = (Pairs::new(all.detections.len()), Vec::new());
        for (track, pair) in all.tracks.iter().zip(&all.pairs) {
            found.clear();
            if pair.is_none() && track.age.status != TrackStatus::Tentative {
                self.overlapping(&track.last, (boxes, &all.detections), &mut found);
            }
            nearest(&mut found, track.filter.place(), (&all.detections, MOST_NEAR));
            pairs.push(found.iter().map(|(x, overlap)| (*x, 1.0 - overlap)));
        }
        pairs
    }

    /// Assigns the free tracks and detections that take part in a stage.
    fn match_stage(
        &self,
        clip: &Clip,
        (all, stage): (&mut Costs, MatchingStage),
        costs: &Pairs,
        takes_part: impl Fn(&Track, bool) -> bool,
    ) -> Result<(), Error> {
        let mut is_free = vec![true; costs.columns()];
        all.pairs.iter().flatten().for_each(|pair| is_free[pair.column] = false);
        let costs = costs
            .filtered(|y, x, _| is_free[x] && all.pairs[y].is_none() && takes_part(&all.tracks[y], all.is_high[x]));
        if costs.is_empty() {
            return Ok(());
        }
        let Assigned { columns, greedy } = match self.association {
            Association::Nearest => Assigned { columns: nearest_first(&costs), greedy: 0 },
            Association::Assignment => least_cost(&costs, &mut WorkBudget::limited(MOST_WORK, &|| clip.wanted()))?,
        };
        all.greedy += greedy;
        for (row, column) in columns.into_iter().enumerate() {
            let cost = column.and_then(|column| Some((column, costs.get(row, column)?)));
            all.pairs[row] = all.pairs[row].or(cost.map(|(column, cost)| Pair { column, cost, stage }));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::{kalman::MotionModel, multi_object::dynamics::Dynamics};
    use crate::synth::random::hash;

    /// Detections of all sizes, some far away, some as large as the picture, one without coordinates.
    fn detections(count: u64, seed: u64) -> Vec<Detection> {
        let of = |i: u64| {
            let chance = |k: u64| (hash(seed, i, k) >> 40) as f32 / (1u64 << 24) as f32;
            let scale = [6.0, 40.0, 90.0, 400.0][(4.0 * chance(0)) as usize];
            let center = [700.0 * chance(1) - 30.0, 500.0 * chance(2) - 30.0];
            let bounds = match i {
                7 => Bounds { min: [f32::NAN; 2], max: [9.0; 2] },
                _ => Bounds::around(center, [scale * chance(3), scale * chance(4)]),
            };
            Detection {
                bounds,
                center: if i == 11 { [1e7, -1e7] } else { center },
                score: 1.0,
                blob: None,
                deviation_px: None,
            }
        };
        (0..count).map(of).collect()
    }

    #[test]
    fn gating_by_boxes_finds_the_same_pairs_as_comparing_all() {
        let clip = Clip::blank("boxes", (640, 480), 2);
        let mut allowed = 0;
        for (motion, cost, unseen, min_overlap) in [
            (MotionModel::Velocity, PairCost::Both, 0, 0.2),
            (MotionModel::Velocity, PairCost::Mahalanobis, 0, 0.2),
            (MotionModel::Turn, PairCost::Mahalanobis, 6, 0.2),
            (MotionModel::Acceleration, PairCost::Mahalanobis, 30, 0.2),
            (MotionModel::Acceleration, PairCost::Overlap, 3, 0.0),
        ] {
            let tracker = KalmanTracker {
                dynamics: Dynamics { motion, ..Dynamics::default() },
                cost,
                iou_threshold: min_overlap,
                gate: 0.99,
                ..KalmanTracker::default()
            };
            let seen = detections(150, 2);
            let tracks: Vec<Track> = detections(170, 1)
                .iter()
                .zip(1..)
                .map(|(found, id)| {
                    let mut track = tracker.begun(found, id);
                    track = tracker.updated(&track, &seen[id as usize % 140], (640, 480));
                    (0..=unseen).for_each(|_| track.filter = track.filter.predicted());
                    track
                })
                .collect();
            let costs = tracker.costs(&clip, (tracks, Arc::new(seen)), |_| true).expect("it is wanted");
            assert_eq!((costs.crowded, costs.greedy), (0, 0));
            for (y, x) in (0..170).flat_map(|y| (0..150).map(move |x| (y, x))) {
                let measured = tracker.dynamics.measurement(&costs.detections[x]);
                let distance = costs.tracks[y].filter.squared_distance(&measured).unwrap_or(f64::INFINITY);
                let (near, overlap) = (distance <= costs.limit, costs.overlap(y, x));
                let has_overlap = overlap > 0.0 && overlap >= f64::from(min_overlap);
                let apart = (1.0 - overlap) / (1.0 - f64::from(min_overlap));
                let expected = match cost {
                    PairCost::Mahalanobis => near.then_some(distance),
                    PairCost::Overlap => has_overlap.then_some(1.0 - overlap),
                    PairCost::Both => (near && has_overlap).then(|| (distance / costs.limit + apart) / 2.0),
                };
                assert_eq!(costs.costs.get(y, x), expected, "{motion:?}, {cost:?}: object {y}, detection {x}");
                allowed += usize::from(expected.is_some());
            }
        }
        assert!(allowed > 2000, "{allowed}");
    }
}
