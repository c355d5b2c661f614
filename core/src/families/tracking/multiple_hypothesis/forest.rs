//! The hypotheses of a scan in clusters: tracks that compete for no detection are independent, and each cluster has hypotheses of
//! its own (Reid 1979, section V).

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::super::object_of;
use crate::geometry::Bounds;
use crate::methods::{
    kalman::Filter,
    multi_object::{Extent, lifecycle::TrackAge},
};
use crate::products::Object;

/// A track after a scan, in all hypotheses that explain its past alike.
#[derive(Clone, Debug)]
pub struct Track {
    pub id: u32,
    pub filter: Filter,
    pub extent: Extent,
    /// Its detection in the scan.
    pub detection: Option<usize>,
    /// Its age before the scan, and after it.
    pub(crate) before: TrackAge,
    pub(crate) age: TrackAge,
}

impl Track {
    /// Returns the box at the estimated position.
    pub fn bounds(&self) -> Bounds {
        self.extent.around(self.filter.place())
    }

    pub fn object(&self) -> Object {
        let object = object_of(&self.filter, self.id, self.bounds(), self.age.status);
        Object { detection: self.detection, ..object }
    }
}

/// The origin of a detection in a hypothesis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A track that existed before.
    Track(u32),
    /// A new track.
    New(u32),
    /// A false alarm.
    False,
}

/// How a hypothesis explains a detection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Claim {
    pub detection: usize,
    pub origin: Origin,
}

/// How a hypothesis explains the detections of a scan.
#[derive(Clone, Debug)]
pub struct Scan {
    pub frame: usize,
    /// The tracks after the scan.
    pub tracks: Vec<Arc<Track>>,
    /// The origins of the detections, by detection.
    pub claims: Vec<Claim>,
}

/// A hypothesis: one explanation of all detections of its cluster.
#[derive(Clone, Debug)]
pub struct Hypothesis {
    /// Its tracks among those of the cluster.
    pub tracks: Vec<usize>,
    /// The natural logarithm of its probability.
    pub ln_probability: f64,
    /// The scans that are not decided yet, by frame.
    pub past: Vec<Arc<Scan>>,
}

/// The hypotheses about tracks that compete for detections; the most probable first.
#[derive(Clone, Debug)]
pub struct Cluster {
    /// The tracks of all hypotheses.
    pub tracks: Vec<Arc<Track>>,
    pub hypotheses: Vec<Hypothesis>,
}

impl Hypothesis {
    pub fn probability(&self) -> f64 {
        self.ln_probability.exp()
    }

    /// Returns its explanation of a frame.
    pub fn scan(&self, frame: usize) -> Option<&Arc<Scan>> {
        self.past.iter().find(|scan| scan.frame == frame)
    }
}

impl Scan {
    fn and(&self, other: &Self) -> Self {
        let tracks = self.tracks.iter().chain(&other.tracks).cloned().collect();
        let mut claims: Vec<Claim> = self.claims.iter().chain(&other.claims).copied().collect();
        claims.sort_unstable_by_key(|claim| claim.detection);
        Self { frame: self.frame, tracks, claims }
    }

    fn empty(frame: usize) -> Self {
        Self { frame, tracks: Vec::new(), claims: Vec::new() }
    }

    /// Returns the part that is about tracks for which `counts` holds, with the false alarms.
    fn part(&self, counts: impl Fn(u32) -> bool) -> Self {
        let claims = self.claims.iter().filter(|claim| match claim.origin {
            Origin::Track(id) | Origin::New(id) => counts(id),
            Origin::False => true,
        });
        let tracks = self.tracks.iter().filter(|track| counts(track.id));
        Self { frame: self.frame, tracks: tracks.cloned().collect(), claims: claims.copied().collect() }
    }
}

/// Returns the parts of a past that are about each of these tracks alone, in one pass.
fn parts(past: &[Arc<Scan>], ids: &[u32]) -> Vec<Vec<Arc<Scan>>> {
    let place: BTreeMap<u32, usize> = ids.iter().enumerate().map(|(place, id)| (*id, place)).collect();
    let mut parts = vec![Vec::with_capacity(past.len()); ids.len()];
    for scan in past {
        let mut own = vec![Scan::empty(scan.frame); ids.len()];
        for track in &scan.tracks {
            if let Some(place) = place.get(&track.id) {
                own[*place].tracks.push(Arc::clone(track));
            }
        }
        for claim in &scan.claims {
            let (Origin::Track(id) | Origin::New(id)) = claim.origin else { continue };
            if let Some(place) = place.get(&id) {
                own[*place].claims.push(*claim);
            }
        }
        parts.iter_mut().zip(own).for_each(|(part, own)| part.push(Arc::new(own)));
    }
    parts
}

/// Returns the scans of two independent pasts together.
fn joined(one: &[Arc<Scan>], other: &[Arc<Scan>]) -> Vec<Arc<Scan>> {
    let (mut all, mut i, mut j) = (Vec::new(), 0, 0);
    while i < one.len() || j < other.len() {
        let frames = [one.get(i), other.get(j)].map(|scan| scan.map_or(usize::MAX, |scan| scan.frame));
        let is_next = frames.map(|frame| frame == frames[0].min(frames[1]));
        all.push(match is_next {
            [true, true] => Arc::new(one[i].and(&other[j])),
            [true, false] => Arc::clone(&one[i]),
            _ => Arc::clone(&other[j]),
        });
        i += usize::from(is_next[0]);
        j += usize::from(is_next[1]);
    }
    all
}

impl Cluster {
    /// A cluster without tracks, for detections in no gate.
    pub fn empty() -> Self {
        let none = Hypothesis { tracks: Vec::new(), ln_probability: 0.0, past: Vec::new() };
        Self { tracks: Vec::new(), hypotheses: vec![none] }
    }

    /// Returns the `most` most probable combinations of the hypotheses of two clusters, which were independent so far.
    pub fn merged(self, other: Self, most: usize) -> Self {
        let first = self.tracks.len();
        let pairs = self.hypotheses.iter().flat_map(|a| other.hypotheses.iter().map(move |b| (a, b)));
        let mut pairs: Vec<_> = pairs.map(|(a, b)| (a.ln_probability + b.ln_probability, a, b)).collect();
        pairs.sort_by(|a, b| b.0.total_cmp(&a.0));
        pairs.truncate(most);
        let hypotheses = pairs.into_iter().map(|(ln_probability, a, b)| Hypothesis {
            tracks: a.tracks.iter().copied().chain(b.tracks.iter().map(|track| first + track)).collect(),
            ln_probability,
            past: joined(&a.past, &b.past),
        });
        let hypotheses = hypotheses.collect();
        let mut merged = Self { tracks: self.tracks.into_iter().chain(other.tracks).collect(), hypotheses };
        merged.normalize();
        merged
    }

    /// Sorts the hypotheses by probability and scales their sum to 1.
    pub fn normalize(&mut self) {
        self.hypotheses.sort_by(|a, b| b.ln_probability.total_cmp(&a.ln_probability));
        let Some(most) = self.hypotheses.first().map(|leader| leader.ln_probability) else { return };
        let sum: f64 = self.hypotheses.iter().map(|one| (one.ln_probability - most).exp()).sum();
        self.hypotheses.iter_mut().for_each(|one| one.ln_probability -= most + sum.ln());
    }

    /// Unites hypotheses with the same tracks: only the past of the most probable one is kept.
    pub fn unite_equal(&mut self) {
        let mut kept: Vec<Hypothesis> = Vec::new();
        for one in std::mem::take(&mut self.hypotheses) {
            match kept.iter_mut().find(|other| other.tracks == one.tracks) {
                Some(other) => {
                    // The logarithm of the sum of both probabilities.
                    let less = one.ln_probability - other.ln_probability;
                    other.ln_probability += less.exp().ln_1p();
                }
                None => kept.push(one),
            }
        }
        self.hypotheses = kept;
        self.normalize();
    }

    /// Decides a frame as the leading hypothesis explains it; returns the hypotheses with another explanation, which are deleted.
    pub fn decide(&mut self, frame: usize) -> Vec<Hypothesis> {
        let claims = |one: &Hypothesis| one.scan(frame).map(|scan| scan.claims.clone());
        let Some(decided) = self.hypotheses.first().map(claims) else { return Vec::new() };
        let all = std::mem::take(&mut self.hypotheses).into_iter();
        let (kept, deleted) = all.partition::<Vec<_>, _>(|one| claims(one) == decided);
        self.hypotheses = kept;
        if !deleted.is_empty() {
            self.normalize();
        }
        deleted
    }

    /// Forgets the scans up to a frame.
    pub fn forget(&mut self, frame: usize) {
        self.hypotheses.iter_mut().for_each(|one| one.past.retain(|scan| scan.frame > frame));
    }

    /// Drops tracks that no hypothesis has.
    pub fn drop_unused(&mut self) {
        let mut place = vec![None; self.tracks.len()];
        self.hypotheses.iter().flat_map(|one| &one.tracks).for_each(|track| place[*track] = Some(0));
        let used = place.iter_mut().flatten().enumerate();
        used.for_each(|(i, place)| *place = i);
        let tracks = std::mem::take(&mut self.tracks).into_iter().zip(&place);
        self.tracks = tracks.filter(|(_, place)| place.is_some()).map(|(track, _)| track).collect();
        let moved = |track: &usize| place[*track];
        for one in &mut self.hypotheses {
            one.tracks = one.tracks.iter().filter_map(moved).collect();
        }
    }

    /// Splits off each track that all hypotheses have in common: it depends on no other any more.
    pub fn split(mut self) -> Vec<Self> {
        let mut shared = vec![0; self.tracks.len()];
        self.hypotheses.iter().flat_map(|one| &one.tracks).for_each(|track| shared[*track] += 1);
        let count = self.hypotheses.len();
        let common: Vec<usize> = (0..self.tracks.len()).filter(|track| shared[*track] == count).collect();
        if common.is_empty() || count == 1 && self.tracks.len() == 1 {
            return vec![self];
        }
        let ids: Vec<u32> = common.iter().map(|track| self.tracks[*track].id).collect();
        let past = self.hypotheses.first().map(|leader| &leader.past[..]).unwrap_or_default();
        let alone = common.iter().zip(parts(past, &ids)).map(|(track, past)| {
            let hypotheses = vec![Hypothesis { tracks: vec![0], ln_probability: 0.0, past }];
            Self { tracks: vec![Arc::clone(&self.tracks[*track])], hypotheses }
        });
        let mut all: Vec<Self> = alone.collect();
        let split: BTreeSet<u32> = ids.into_iter().collect();
        for one in &mut self.hypotheses {
            one.tracks.retain(|track| shared[*track] != count);
            one.past = one.past.iter().map(|scan| Arc::new(scan.part(|id| !split.contains(&id)))).collect();
        }
        self.drop_unused();
        self.unite_equal();
        all.push(self);
        all
    }

    /// Whether it is finished: it has no tracks, and none in undecided frames.
    pub fn is_over(&self) -> bool {
        let mut scans = self.hypotheses.iter().flat_map(|one| &one.past);
        self.tracks.is_empty() && scans.all(|scan| scan.tracks.is_empty())
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        let scan = |scan: &Arc<Scan>| size_of::<Scan>() + size_of_val(&scan.tracks[..]) + size_of_val(&scan.claims[..]);
        let one = |one: &Hypothesis| {
            size_of::<Hypothesis>() + size_of_val(&one.tracks[..]) + one.past.iter().map(scan).sum::<usize>()
        };
        size_of::<Self>()
            + self.tracks.len() * (size_of::<Track>() + size_of::<Arc<Track>>())
            + self.hypotheses.iter().map(one).sum::<usize>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::Detection;
    use crate::methods::multi_object::{dynamics::Dynamics, lifecycle::Rules};

    /// A cluster of this many tracks in 3 scans: the first hypothesis has all but the last track, which only the second one has.
    fn cluster(count: u32) -> Cluster {
        let found = Detection {
            bounds: Bounds::around([9.0; 2], [8.0; 2]),
            center: [9.0; 2],
            score: 1.0,
            blob: None,
            deviation_px: None,
        };
        let (filter, age) = (Dynamics::default().begun(&found), Rules::default().begun(&found));
        let extent = Extent::of(&found);
        let track = |id| Arc::new(Track { id, filter, extent, detection: Some(id as usize), before: age, age });
        let tracks: Vec<Arc<Track>> = (0..count).map(track).collect();
        let scan = |frame, count: usize| {
            let claim = |id: usize| Claim { detection: id, origin: Origin::Track(id as u32) };
            let claims = (0..count).map(claim).chain([Claim { detection: count, origin: Origin::False }]);
            Arc::new(Scan { frame, tracks: tracks[..count].to_vec(), claims: claims.collect() })
        };
        let hypothesis = |count: usize, ln_probability| Hypothesis {
            tracks: (0..count).collect(),
            ln_probability,
            past: (0..3).map(|frame| scan(frame, count)).collect(),
        };
        let count = count as usize;
        let hypotheses = vec![hypothesis(count - 1, 0.75f64.ln()), hypothesis(count, 0.25f64.ln())];
        Cluster { tracks, hypotheses }
    }

    #[test]
    fn common_tracks_are_split_off_with_their_pasts() {
        let all = cluster(5).split();
        assert_eq!(all.len(), 5);
        for (id, alone) in all[..4].iter().enumerate() {
            let [one] = &alone.hypotheses[..] else { panic!("{:?}", alone.hypotheses) };
            assert_eq!((alone.tracks[0].id, &one.tracks[..], one.past.len()), (id as u32, &[0][..], 3));
            for scan in &one.past {
                let claim = Claim { detection: id, origin: Origin::Track(id as u32) };
                assert_eq!((&scan.claims[..], scan.tracks.len(), scan.tracks[0].id), (&[claim][..], 1, id as u32));
            }
        }
        let rest = &all[4];
        let sizes: Vec<(usize, f64)> =
            rest.hypotheses.iter().map(|one| (one.tracks.len(), one.probability())).collect();
        assert_eq!((rest.tracks.len(), sizes.len(), sizes[0].0, sizes[1].0), (1, 2, 0, 1));
        assert!((sizes[0].1 - 0.75).abs() < 1e-9, "{sizes:?}");
        let claims = |one: &Hypothesis| one.past.iter().map(|scan| scan.claims.len()).collect::<Vec<_>>();
        assert_eq!([claims(&rest.hypotheses[0]), claims(&rest.hypotheses[1])], [vec![1; 3], vec![2; 3]]);
    }

    #[test]
    fn many_tracks_are_split_off_as_well() {
        // This takes some milliseconds; comparing each track with all others would take a minute.
        assert_eq!(cluster(40_000).split().len(), 40_000);
    }
}
