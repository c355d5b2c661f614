//! Gating: the pairs of a track and a detection within a squared Mahalanobis distance, their likelihoods, and the sets of tracks that
//! compete.

use std::f64::consts::PI;

use crate::base::Error;
use crate::data::{Clip, Detection};
use crate::methods::kalman::{Filter, Measurement};
use crate::products::objects::{
    box_index::{BoxIndex, Corners, nearest},
    pairs::Pairs,
};

/// The maximum number of detections compared with a track, the nearest ones. It bounds the work in dense crowds.
pub const MOST_NEAR: usize = 500;

/// The number of tracks between checks for cancellation.
const TRACKS_PER_CHECK: usize = 64;

/// Tolerance of the quick gate test for rounding. Pairs that pass are tested again exactly.
const ROUNDING: f64 = 1.001;

/// The minimum determinant, as a share of the product of the variances, for the quick test to be accurate.
const SOUND: f64 = 1e-6;

/// Returns the squared Mahalanobis distances d² up to `limit` of detections (columns) from predicted tracks (rows), and the number of
/// tracks with more than [`MOST_NEAR`] detections nearby.
///
/// # Errors
/// If the work is cancelled.
pub fn squared_distances<'a>(
    clip: &Clip,
    filters: impl Iterator<Item = &'a Filter>,
    (detections, measured): (&[Detection], &[Measurement]),
    limit: f64,
) -> Result<(Pairs, usize), Error> {
    // Along an axis the gate reaches at most √limit (σ + σ'), of track and measurement: |a + b| ≤ |a| + |b|.
    let reach = (limit * ROUNDING).sqrt();
    let gates = measured.iter().map(|measured| around(measured.place, [reach * measured.place_deviation; 2]));
    let gates = BoxIndex::new(gates);
    rows_of(clip, detections.len(), filters, |filter, found| {
        let gate = Gate::of(filter, limit);
        let corners = around(gate.place, [gate.xx, gate.yy].map(|variance| reach * variance.sqrt()));
        gates.touching(corners, found, |x| (!gate.is_far(&measured[x])).then_some(0.0));
        let is_cut = nearest(found, gate.place, (detections, MOST_NEAR));
        let near = |x: usize| filter.squared_distance(&measured[x]).filter(|d| *d <= limit);
        (found.iter().filter_map(|(x, _)| Some((*x, near(*x)?))).collect(), is_cut)
    })
}

/// A row of pairs, and whether nearby detections were left out.
pub type PairRow = (Vec<(usize, f64)>, bool);

/// Returns the rows of all tracks, and the number of rows with detections left out.
///
/// # Errors
/// If the work is cancelled.
pub fn rows_of<T>(
    clip: &Clip,
    columns: usize,
    tracks: impl Iterator<Item = T>,
    row: impl Fn(T, &mut Vec<(usize, f64)>) -> PairRow,
) -> Result<(Pairs, usize), Error> {
    let (mut pairs, mut found, mut cut) = (Pairs::new(columns), Vec::new(), 0);
    for (y, track) in tracks.enumerate() {
        if y.is_multiple_of(TRACKS_PER_CHECK) {
            clip.wanted()?;
        }
        let (row, is_cut) = row(track, &mut found);
        pairs.push(row);
        cut += usize::from(is_cut);
    }
    Ok((pairs, cut))
}

/// The gate of a track, for a quick test without the filter.
struct Gate {
    place: [f64; 2],
    /// The covariance of the position.
    xx: f64,
    xy: f64,
    yy: f64,
    limit: f64,
}

impl Gate {
    fn of(filter: &Filter, limit: f64) -> Self {
        let [[xx, xy], [_, yy]] = filter.place_covariance();
        Self { place: filter.place(), xx, xy, yy, limit }
    }

    /// Returns whether a measurement is clearly outside the gate.
    fn is_far(&self, measured: &Measurement) -> bool {
        let variance = measured.place_deviation * measured.place_deviation;
        let [x, y] = [0, 1].map(|i| measured.place[i] - self.place[i]);
        let (xx, yy) = (self.xx + variance, self.yy + variance);
        let det = xx * yy - self.xy * self.xy;
        // νᵀ S⁻¹ ν > limit, times det S.
        let squared = x * x * yy - 2.0 * x * y * self.xy + y * y * xx;
        det > SOUND * xx * yy && squared > self.limit * ROUNDING * det
    }
}

/// Returns the box around a position.
fn around(place: [f64; 2], reach: [f64; 2]) -> Corners {
    [[place[0] - reach[0], place[1] - reach[1]], [place[0] + reach[0], place[1] + reach[1]]]
}

/// Returns ln N(ν; 0, S) of a measurement at squared Mahalanobis distance d², a density in 1/px².
pub fn ln_likelihood(filter: &Filter, measured: &Measurement, squared: f64) -> f64 {
    let [[xx, xy], [_, yy]] = filter.place_covariance();
    let variance = measured.place_deviation * measured.place_deviation;
    let det = (xx + variance) * (yy + variance) - xy * xy;
    -0.5 * (squared + det.max(f64::MIN_POSITIVE).ln()) - (2.0 * PI).ln()
}

/// Disjoint sets.
pub struct Sets(Vec<usize>);

impl Sets {
    /// Creates sets of one member each.
    pub fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    /// Returns the smallest member of the set of `at`.
    pub fn root(&mut self, mut at: usize) -> usize {
        while self.0[at] != at {
            self.0[at] = self.0[self.0[at]];
            at = self.0[at];
        }
        at
    }

    /// Unites the sets of two members.
    pub fn unite(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        let (low, high) = (a.min(b), a.max(b));
        self.0[high] = low;
    }
}
