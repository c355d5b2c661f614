//! The validation matrix, the feasible joint events and the probabilities of the associations.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::{Event, JointProbabilistic, Track, Weights};
use crate::base::{Error, Observer};
use crate::data::{Clip, Detection};
use crate::methods::{
    kalman::Measurement,
    multi_object::gating::{MOST_NEAR, Sets, rows_of},
};
use crate::products::objects::{
    assignment::{WorkBudget, most_worth},
    box_index::{BoxIndex, nearest},
    k_best::{Choice, Problem, Row, k_best},
    pairs::Pairs,
};

/// The maximum number of pairs visited in the joint events of a frame, a few tenths of a second.
const MOST_WORK: u64 = 20_000_000;

/// The validation matrix of a frame.
#[derive(Clone, Debug)]
pub struct Validation {
    pub tracks: Vec<Track>,
    pub detections: Arc<Vec<Detection>>,
    /// Squared Mahalanobis distances d² in the gates: tracks by detections.
    pub distances: Pairs,
    /// The gating threshold of d².
    pub limit: f64,
    /// The number of tracks with more detections nearby than are compared.
    pub crowded: usize,
    /// The false alarms per px².
    density: f64,
    /// Tracks and detections of each cluster, with the tracks that have no detection left out.
    pub clusters: Vec<[Vec<usize>; 2]>,
}

/// A joint event.
#[derive(Clone, Debug)]
pub struct JointEvent {
    pub probability: f64,
    /// The track of each detection of the cluster, as its place among the tracks; `None` for a false alarm.
    pub tracks: Vec<Option<usize>>,
}

/// The feasible joint events of a cluster, the most probable first.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Its tracks and its detections.
    pub tracks: Vec<usize>,
    pub detections: Vec<usize>,
    pub events: Vec<JointEvent>,
    /// Whether less probable events were left out: by the maximum number, and by the limit of the work.
    pub has_more: bool,
    pub is_exhausted: bool,
}

impl Joint {
    /// Returns β of a track (by its place in the cluster) and a detection: the sum of the events in which it is the track's.
    pub fn weight(&self, track: usize, detection: usize) -> f64 {
        let has = |event: &&JointEvent| event.tracks[detection] == Some(track);
        self.events.iter().filter(has).map(|event| event.probability).sum()
    }

    /// Returns β₀ of a track: the sum of the events in which it has no detection.
    pub fn missed(&self, track: usize) -> f64 {
        let lacks = |event: &&JointEvent| !event.tracks.contains(&Some(track));
        self.events.iter().filter(lacks).map(|event| event.probability).sum()
    }
}

impl JointProbabilistic {
    /// Returns the standard deviation of a measurement of a track in px. It is the same for all detections, so that they share one S.
    fn deviation(&self, track: &Track, known: Option<f32>) -> f64 {
        self.dynamics.deviation_px(known, track.extent.height_px())
    }

    pub(super) fn measurement(&self, track: &Track, detection: &Detection) -> Measurement {
        let place_deviation = self.deviation(track, detection.deviation_px);
        Measurement { place: detection.center.map(f64::from), place_deviation, velocity: None }
    }

    /// Returns the validation matrix of predicted tracks.
    ///
    /// # Errors
    /// If the work is cancelled.
    pub(super) fn validated(
        &self,
        clip: &Clip,
        (tracks, detections): (Vec<Track>, Arc<Vec<Detection>>),
    ) -> Result<Validation, Error> {
        let limit = self.chances.limit();
        let known = detections.first().and_then(|found| found.deviation_px);
        let places = BoxIndex::new(detections.iter().map(|found| [found.center.map(f64::from); 2]));
        let (distances, crowded) = rows_of(clip, detections.len(), tracks.iter(), |track, found| {
            let ([[xx, _], [_, yy]], [x, y]) = (track.filter.place_covariance(), track.filter.place());
            let variance = self.deviation(track, known) * self.deviation(track, known);
            // The ellipse of the gate touches this box.
            let [right, down] = [xx, yy].map(|of_place| (limit * (of_place + variance)).sqrt() + 1e-6);
            let distance = |at: usize| track.filter.squared_distance(&self.measurement(track, &detections[at]));
            let corners = [[x - right, y - down], [x + right, y + down]];
            places.touching(corners, found, |at| distance(at).filter(|squared| *squared <= limit));
            let is_cut = nearest(found, [x, y], (&detections, MOST_NEAR));
            (found.clone(), is_cut)
        })?;
        let (density, clusters) = (self.chances.density(clip.size()), clusters(&distances));
        Ok(Validation { tracks, detections, distances, limit, crowded, density, clusters })
    }

    /// Returns the weights of the detections of all tracks.
    ///
    /// # Errors
    /// If the work is cancelled.
    pub(super) fn weights(
        &self,
        clip: &Clip,
        validation: &Arc<Validation>,
        observer: &mut impl Observer<Event>,
    ) -> Result<Vec<Weights>, Error> {
        let known = validation.detections.first().and_then(|found| found.deviation_px);
        let none = |track| Weights {
            detections: Vec::new(),
            measured: Vec::new(),
            deviation: self.deviation(track, known),
            own: None,
        };
        let mut all: Vec<Weights> = validation.tracks.iter().map(none).collect();
        let wanted = || clip.wanted();
        let mut budget = WorkBudget::limited(MOST_WORK, &wanted);
        let size = |[tracks, detections]: &[Vec<usize>; 2]| tracks.len() * detections.len();
        let joints = budget.shared(&validation.clusters, size, |[tracks, detections], budget| {
            self.joint(validation, (tracks, detections), budget).map(Arc::new)
        })?;
        for ([tracks, detections], joint) in validation.clusters.iter().zip(joints) {
            observer.see(|| Event::Enumerated(Arc::clone(validation), Arc::clone(&joint)));
            observer.see(|| Event::Weighed(Arc::clone(validation), Arc::clone(&joint)));
            for (place, track) in tracks.iter().enumerate() {
                let in_gate = |at: &usize| validation.distances.get(*track, detections[*at]).is_some();
                for at in (0..detections.len()).filter(in_gate) {
                    let weight = joint.weight(place, at);
                    let center = validation.detections[detections[at]].center.map(f64::from);
                    all[*track].detections.push((detections[at], weight));
                    all[*track].measured.push((center, weight));
                }
            }
        }
        own(&mut all, validation.detections.len(), &mut WorkBudget::limited(MOST_WORK, &wanted))?;
        Ok(all)
    }

    /// Ranks the feasible joint events of a cluster.
    fn joint(
        &self,
        validation: &Validation,
        (tracks, detections): (&[usize], &[usize]),
        budget: &mut WorkBudget,
    ) -> Result<Joint, Error> {
        let [ln_detected, ln_missed] = [self.chances.detected(), self.chances.missed()].map(f64::ln);
        let alone = [-validation.density.ln(), f64::INFINITY];
        let mut rows = vec![Row { columns: Vec::new(), alone }; detections.len()];
        for (column, &row) in tracks.iter().enumerate() {
            let track = &validation.tracks[row];
            for (detection, squared) in validation.distances.row(row) {
                let Ok(place) = detections.binary_search(&detection) else { continue };
                let found = &validation.detections[detection];
                let measured = self.measurement(track, found);
                let of = self.chances.ln_likelihoods((&track.filter, &track.extent), (found, &measured), squared);
                rows[place].columns.push((column, -(ln_detected + of[0] + of[1] - ln_missed)));
            }
        }
        let problem = Problem { base: -(tracks.len() as f64) * ln_missed, columns: tracks.len(), rows };
        let ranking = k_best(&[problem], (self.max_events, f64::INFINITY), budget)?;
        let least = ranking.solutions.first().map_or(0.0, |best| best.cost);
        let sum: f64 = ranking.solutions.iter().map(|solution| (least - solution.cost).exp()).sum();
        let event = |solution: &crate::products::objects::k_best::Solution| JointEvent {
            probability: (least - solution.cost).exp() / sum,
            tracks: solution
                .choices
                .iter()
                .map(|choice| match choice {
                    Choice::Column(column) => Some(*column),
                    Choice::Alone(_) => None,
                })
                .collect(),
        };
        Ok(Joint {
            tracks: tracks.to_vec(),
            detections: detections.to_vec(),
            events: ranking.solutions.iter().map(event).collect(),
            has_more: ranking.has_more,
            is_exhausted: ranking.is_exhausted,
        })
    }
}

/// Gives each detected track a detection of its own: the pairs of the largest expected number of correct ones, Σ β. Several tracks may have
/// the same most probable detection.
fn own(all: &mut [Weights], columns: usize, budget: &mut WorkBudget) -> Result<(), Error> {
    let mut worths = Pairs::new(columns);
    for weights in all.iter() {
        let weighed = weights.detections.iter().copied().filter(|_| weights.is_detected());
        worths.push(weighed.collect::<Vec<_>>());
    }
    let assigned = most_worth(&worths, budget)?;
    for ((row, weights), column) in all.iter_mut().enumerate().zip(assigned.columns) {
        weights.own = column.and_then(|column| Some((column, worths.get(row, column)?)));
    }
    Ok(())
}

/// Returns the tracks and the detections of each cluster, in the order of its first track.
fn clusters(distances: &Pairs) -> Vec<[Vec<usize>; 2]> {
    let rows = distances.rows();
    let mut sets = Sets::new(rows + distances.columns());
    for (row, column, _) in distances.iter() {
        sets.unite(row, rows + column);
    }
    let mut all: BTreeMap<usize, [Vec<usize>; 2]> = BTreeMap::new();
    for row in 0..rows {
        all.entry(sets.root(row)).or_default()[0].push(row);
    }
    for column in 0..distances.columns() {
        all.entry(sets.root(rows + column)).or_default()[1].push(column);
    }
    all.into_values().filter(|[tracks, detections]| !tracks.is_empty() && !detections.is_empty()).collect()
}
