//! The branches of a scan: gates, clusters, and the k best explanations of the detections of each.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::MultipleHypothesis;
use super::forest::{Claim, Cluster, Hypothesis, Origin, Scan, Track};
use crate::base::Error;
use crate::data::{Clip, Detection};
use crate::methods::{
    kalman::Measurement,
    multi_object::{
        Extent,
        gating::{Sets, squared_distances},
    },
};
use crate::products::objects::{
    assignment::WorkBudget,
    k_best::{Choice, Problem, Ranking, Row, k_best},
    pairs::Pairs,
};

/// The maximum number of pairs visited in the branches of a frame, a few tenths of a second.
const MOST_WORK: u64 = 20_000_000;

/// The way in which a detection belongs to no track of the scan before: it is a false alarm.
const FALSE_ALARM: usize = 0;

/// The detections of a frame and the gates of the predicted tracks.
#[derive(Clone, Debug)]
pub struct Gates {
    pub frame: usize,
    pub detections: Arc<Vec<Detection>>,
    pub measured: Vec<Measurement>,
    /// The predicted tracks of all clusters.
    pub tracks: Vec<Arc<Track>>,
    /// Squared Mahalanobis distances d² in the gates: tracks by detections.
    pub distances: Pairs,
    /// The gating threshold of d².
    pub limit: f64,
    /// The number of tracks with more detections nearby than are compared.
    pub crowded: usize,
    /// Width and height of the picture in px.
    picture: (usize, usize),
    /// The clusters after the merge: the number of all, and of those merged of several.
    pub clusters: [usize; 2],
}

impl Gates {
    /// Width and height of the picture in px.
    pub fn size(&self) -> (usize, usize) {
        self.picture
    }
}

/// A cluster with the detections in its gates.
pub struct Group {
    cluster: Cluster,
    /// Its tracks among those of the gates.
    rows: Vec<usize>,
    pub detections: Vec<usize>,
}

impl Group {
    /// The number of entries of its assignment problems, if all pairs are in the gates.
    fn entries(&self) -> usize {
        let columns: usize = self.cluster.hypotheses.iter().map(|one| 1 + one.tracks.len()).sum();
        columns * self.detections.len()
    }
}

/// A branch of a scan.
#[derive(Clone, Debug)]
pub struct Branch {
    /// The hypothesis that it continues, from 0.
    pub parent: usize,
    pub probability: f64,
    pub scan: Arc<Scan>,
}

/// The branches of a cluster in a scan.
#[derive(Clone, Debug)]
pub struct Expansion {
    /// The predicted tracks.
    pub tracks: Vec<Arc<Track>>,
    pub detections: Vec<usize>,
    /// The probabilities of the hypotheses before the scan.
    pub parents: Vec<f64>,
    pub branches: Vec<Branch>,
    /// Whether further branches were left out: by the maximum number, and by the limit of the work.
    pub has_more: bool,
    pub is_exhausted: bool,
    /// The terms of the logarithm of the leading branch's weight.
    pub terms: Terms,
}

/// The terms of the logarithm of a branch's weight.
#[derive(Clone, Copy, Debug, Default)]
pub struct Terms {
    /// Tracks with a detection, without one, false alarms and new tracks.
    pub counts: [usize; 4],
    pub ln_parent: f64,
    /// Σ ln N(ν; 0, S) over the tracks with a detection, and that of the likelihood ratios of their sizes.
    pub ln_innovations: f64,
    pub ln_sizes: f64,
}

impl MultipleHypothesis {
    /// Returns the densities of false alarms and of new tracks in 1/px².
    pub(super) fn densities(&self, (width, height): (usize, usize)) -> [f64; 2] {
        [self.chances.density((width, height)), f64::from(self.new_tracks) / (width * height) as f64]
    }

    /// Computes the gates of predicted clusters.
    ///
    /// # Errors
    /// If the work is cancelled.
    pub(super) fn gates(
        &self,
        clip: &Clip,
        frame: usize,
        (clusters, detections): (&[Cluster], Arc<Vec<Detection>>),
    ) -> Result<Gates, Error> {
        let measured: Vec<_> = detections.iter().map(|found| self.dynamics.measurement(found)).collect();
        let limit = self.chances.limit();
        let tracks: Vec<Arc<Track>> = clusters.iter().flat_map(|cluster| cluster.tracks.iter().cloned()).collect();
        let filters = tracks.iter().map(|track| &track.filter);
        let (distances, crowded) = squared_distances(clip, filters, (&detections, &measured), limit)?;
        let (picture, clusters) = (clip.size(), [0; 2]);
        Ok(Gates { frame, detections, measured, tracks, distances, limit, crowded, picture, clusters })
    }

    /// Merges the clusters that share a detection. A detection in no gate has a cluster of its own.
    pub(super) fn grouped(&self, clusters: Vec<Cluster>, gates: &mut Gates) -> Vec<Group> {
        let count = clusters.len();
        let mut sets = Sets::new(count + gates.detections.len());
        let owners = clusters.iter().enumerate().flat_map(|(i, cluster)| vec![i; cluster.tracks.len()]);
        let owners: Vec<usize> = owners.collect();
        for (row, column, _) in gates.distances.iter() {
            sets.unite(owners[row], count + column);
        }
        let mut groups: BTreeMap<usize, (Vec<Cluster>, Group)> = BTreeMap::new();
        let mut row = 0;
        let empty = || (Vec::new(), Group { cluster: Cluster::empty(), rows: Vec::new(), detections: Vec::new() });
        for (i, cluster) in clusters.into_iter().enumerate() {
            let (all, group) = groups.entry(sets.root(i)).or_insert_with(empty);
            group.rows.extend(row..row + cluster.tracks.len());
            row += cluster.tracks.len();
            all.push(cluster);
        }
        for column in 0..gates.detections.len() {
            let (_, group) = groups.entry(sets.root(count + column)).or_insert_with(empty);
            group.detections.push(column);
        }
        gates.clusters = [groups.len(), groups.values().filter(|(all, _)| all.len() > 1).count()];
        let merged = groups.into_values().map(|(all, mut group)| {
            let merged = all.into_iter().reduce(|one, other| one.merged(other, self.max_hypotheses));
            group.cluster = merged.unwrap_or_else(Cluster::empty);
            group
        });
        merged.collect()
    }

    /// Ranks the explanations of the detections of all groups, the smallest first, so that a large one leaves them their shares of the work.
    ///
    /// # Errors
    /// If the work is cancelled.
    pub(super) fn rankings(&self, clip: &Clip, groups: &[Group], gates: &Gates) -> Result<Vec<Ranking>, Error> {
        let wanted = || clip.wanted();
        let mut budget = WorkBudget::limited(MOST_WORK, &wanted);
        budget.shared(groups, Group::entries, |group, budget| self.ranked(group, gates, budget))
    }

    /// Ranks the explanations of the detections of a group by all of its hypotheses together.
    fn ranked(&self, group: &Group, gates: &Gates, budget: &mut WorkBudget) -> Result<Ranking, Error> {
        let problems: Vec<Problem> =
            group.cluster.hypotheses.iter().map(|one| self.problem(group, one, gates)).collect();
        // Infinite for a ratio of 0, which leaves out nothing.
        let excess = -f64::from(self.min_ratio).ln();
        k_best(&problems, (self.max_hypotheses, excess), budget)
    }

    /// Returns the assignment problem of a hypothesis: detections are rows, its tracks columns, the costs negative logarithms.
    fn problem(&self, group: &Group, hypothesis: &Hypothesis, gates: &Gates) -> Problem {
        let [ln_detected, ln_missed] = [self.chances.detected(), self.chances.missed()].map(f64::ln);
        let alone = self.densities(gates.picture).map(|density| -density.ln());
        let mut rows = vec![Row { columns: Vec::new(), alone }; group.detections.len()];
        for (column, track) in hypothesis.tracks.iter().enumerate() {
            let row = group.rows[*track];
            for (detection, squared) in gates.distances.row(row) {
                let Ok(place) = group.detections.binary_search(&detection) else { continue };
                let [of_place, of_size] = self.ln_likelihoods(gates, (row, detection), squared);
                rows[place].columns.push((column, -(ln_detected - ln_missed + of_place + of_size)));
            }
        }
        let missed = hypothesis.tracks.len() as f64 * ln_missed;
        Problem { base: -hypothesis.ln_probability - missed, columns: hypothesis.tracks.len(), rows }
    }

    /// Returns the logarithms of the likelihoods of position and size of a track and a detection.
    fn ln_likelihoods(&self, gates: &Gates, (row, detection): (usize, usize), squared: f64) -> [f64; 2] {
        let (track, found) = (&gates.tracks[row], &gates.detections[detection]);
        self.chances.ln_likelihoods((&track.filter, &track.extent), (found, &gates.measured[detection]), squared)
    }

    /// Returns the cluster after the scan: a hypothesis for each ranked explanation. `next_id` numbers new tracks.
    pub(super) fn branched(
        &self,
        group: &Group,
        gates: &Gates,
        ranking: &Ranking,
        mut next_id: impl FnMut() -> u32,
    ) -> Cluster {
        let is_new = |choice: &Choice| matches!(choice, Choice::Alone(way) if *way != FALSE_ALARM);
        let new = ranking.solutions.iter().flat_map(|solution| {
            let choices = solution.choices.iter().enumerate();
            choices.filter(|(_, choice)| is_new(choice)).map(|(row, _)| group.detections[row])
        });
        let ids: BTreeMap<usize, u32> =
            new.collect::<BTreeSet<_>>().into_iter().map(|detection| (detection, next_id())).collect();
        let mut branches = Branches { tracker: self, group, gates, ids, made: BTreeMap::new(), tracks: Vec::new() };
        let hypotheses = ranking.solutions.iter().map(|solution| {
            let parent = &group.cluster.hypotheses[solution.problem];
            branches.of(parent, &solution.choices, solution.cost)
        });
        let mut cluster = Cluster { hypotheses: hypotheses.collect(), tracks: Vec::new() };
        cluster.tracks = branches.tracks;
        cluster.normalize();
        cluster
    }

    /// Returns the branches of a cluster for their explanation.
    pub(super) fn expansion(&self, group: &Group, gates: &Gates, ranking: &Ranking, after: &Cluster) -> Expansion {
        let branches = ranking.solutions.iter().zip(&after.hypotheses).filter_map(|(solution, one)| {
            let scan = Arc::clone(one.past.last()?);
            Some(Branch { parent: solution.problem, probability: one.probability(), scan })
        });
        let branches: Vec<Branch> = branches.collect();
        Expansion {
            tracks: group.rows.iter().map(|row| Arc::clone(&gates.tracks[*row])).collect(),
            detections: group.detections.clone(),
            parents: group.cluster.hypotheses.iter().map(Hypothesis::probability).collect(),
            has_more: ranking.has_more,
            is_exhausted: ranking.is_exhausted,
            terms: self.terms(group, gates, ranking),
            branches,
        }
    }

    fn terms(&self, group: &Group, gates: &Gates, ranking: &Ranking) -> Terms {
        let Some(best) = ranking.solutions.first() else { return Terms::default() };
        let parent = &group.cluster.hypotheses[best.problem];
        let mut terms = Terms { ln_parent: parent.ln_probability, ..Terms::default() };
        for (place, choice) in best.choices.iter().enumerate() {
            match choice {
                Choice::Column(column) => {
                    let (row, detection) = (group.rows[parent.tracks[*column]], group.detections[place]);
                    let squared = gates.distances.get(row, detection).unwrap_or(f64::INFINITY);
                    terms.counts[0] += 1;
                    let [of_place, of_size] = self.ln_likelihoods(gates, (row, detection), squared);
                    terms.ln_innovations += of_place;
                    terms.ln_sizes += of_size;
                }
                Choice::Alone(way) => terms.counts[if *way == FALSE_ALARM { 2 } else { 3 }] += 1,
            }
        }
        terms.counts[1] = parent.tracks.len() - terms.counts[0];
        terms
    }
}

/// The branches of a cluster; a track with one past is made once.
struct Branches<'a> {
    tracker: &'a MultipleHypothesis,
    group: &'a Group,
    gates: &'a Gates,
    /// The identities of new tracks, by detection.
    ids: BTreeMap<usize, u32>,
    /// The place of each track, by its track before, if any, and its detection, if any; `None` where it is deleted.
    made: BTreeMap<(Option<usize>, Option<usize>), Option<usize>>,
    tracks: Vec<Arc<Track>>,
}

impl Branches<'_> {
    fn of(&mut self, parent: &Hypothesis, choices: &[Choice], cost: f64) -> Hypothesis {
        let mut found = vec![None; parent.tracks.len()];
        let (mut claims, mut new) = (Vec::with_capacity(choices.len()), Vec::new());
        for (choice, &detection) in choices.iter().zip(&self.group.detections) {
            let origin = match choice {
                Choice::Column(column) => {
                    found[*column] = Some(detection);
                    Origin::Track(self.gates.tracks[self.group.rows[parent.tracks[*column]]].id)
                }
                Choice::Alone(FALSE_ALARM) => Origin::False,
                Choice::Alone(_) => {
                    new.push(detection);
                    Origin::New(self.ids.get(&detection).copied().unwrap_or(0))
                }
            };
            claims.push(Claim { detection, origin });
        }
        let continued = parent.tracks.iter().zip(found).map(|(track, found)| (Some(self.group.rows[*track]), found));
        let all: Vec<_> = continued.chain(new.into_iter().map(|detection| (None, Some(detection)))).collect();
        let mut tracks: Vec<usize> = all.into_iter().filter_map(|(row, found)| self.track(row, found)).collect();
        tracks.sort_unstable();
        let scan = Scan {
            frame: self.gates.frame,
            tracks: tracks.iter().map(|track| Arc::clone(&self.tracks[*track])).collect(),
            claims,
        };
        let past = parent.past.iter().cloned().chain([Arc::new(scan)]).collect();
        Hypothesis { tracks, ln_probability: -cost, past }
    }

    /// Returns the place of a track that continues one before, or that is new.
    fn track(&mut self, row: Option<usize>, found: Option<usize>) -> Option<usize> {
        if let Some(known) = self.made.get(&(row, found)) {
            return *known;
        }
        let made = match (row.map(|row| &self.gates.tracks[row]), found) {
            (Some(track), Some(detection)) => Some(self.updated(track, detection)),
            (Some(track), None) => self.tracker.missed(track, self.gates.picture),
            (None, Some(detection)) => Some(self.begun(detection)),
            (None, None) => None,
        };
        let place = made.map(|track| {
            self.tracks.push(Arc::new(track));
            self.tracks.len() - 1
        });
        self.made.insert((row, found), place);
        place
    }

    fn updated(&self, track: &Track, detection: usize) -> Track {
        let (found, measured) = (&self.gates.detections[detection], &self.gates.measured[detection]);
        let filter = track.filter.updated(measured).map_or(track.filter, |(filter, _)| filter);
        Track {
            id: track.id,
            filter,
            extent: track.extent.towards(found),
            detection: Some(detection),
            before: track.age,
            age: self.tracker.rules.seen(track.age, found),
        }
    }

    fn begun(&self, detection: usize) -> Track {
        let found = &self.gates.detections[detection];
        let age = self.tracker.rules.begun(found);
        Track {
            id: self.ids.get(&detection).copied().unwrap_or(0),
            filter: self.tracker.dynamics.begun(found),
            extent: Extent::of(found),
            detection: Some(detection),
            before: age,
            age,
        }
    }
}
