//! Gating: the pairs of a track and a detection within a squared Mahalanobis distance, their likelihoods, and the sets of tracks that
//! compete.

use std::f64::consts::PI;

use super::Extent;
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

/// Returns ln N(ν; 0, S) of a measurement at squared Mahalanobis distance d², a density in 1/px². Of interacting modes it is the logarithm
/// of the mixture Σ μ_m N(ν_m; 0, S_m) (Blom and Bar-Shalom 1988), not of the normal distribution with its moments.
pub fn ln_likelihood(filter: &Filter, measured: &Measurement, squared: f64) -> f64 {
    if let Some((probabilities, logs)) = filter.probabilities().zip(filter.log_likelihoods(measured)) {
        let most = logs[0].max(logs[1]);
        return most + [0, 1].map(|m| probabilities[m] * (logs[m] - most).exp()).iter().sum::<f64>().ln();
    }
    let [[xx, xy], [_, yy]] = filter.place_covariance();
    let variance = measured.place_deviation * measured.place_deviation;
    let det = (xx + variance) * (yy + variance) - xy * xy;
    -0.5 * (squared + det.max(f64::MIN_POSITIVE).ln()) - (2.0 * PI).ln()
}

/// The range of sizes in which those of false alarms and new tracks are distributed evenly, as ln of the largest by the smallest width or
/// height: a factor of 4.
const SIZE_RANGE: f64 = 2.0 * std::f64::consts::LN_2;

/// Returns the logarithm of the likelihood ratio of a detection's size: that of a track with this box, whose width and height deviate by
/// `deviation` in their logarithms, against that of any other object. Attributes count as a factor of the likelihood of the position (S.
/// Blackman and R. Popoli, Design and analysis of modern tracking systems, 1999, section 6.2).
pub fn ln_size_ratio(extent: &Extent, found: &Detection, deviation: f64) -> f64 {
    let peak = SIZE_RANGE * SIZE_RANGE / (2.0 * PI * deviation * deviation);
    peak.ln() - extent.size_distance(found, deviation) / 2.0
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::kalman::{MotionModel, Noises};

    #[test]
    fn interacting_modes_weigh_a_measurement_by_the_mixture_of_their_likelihoods() {
        let model = MotionModel::Interacting.model(Noises { acceleration: 0.5, turn_deg: 3.0, switch: 0.05 });
        let measured = |place| Measurement { place, place_deviation: 1.0, velocity: None };
        let mut filter = Filter::begun(model, &measured([0.0; 2]), 4.0);
        // Along a circle, until both modes predict other positions.
        for t in 1..20 {
            let (sin, cos) = (f64::from(t) * 0.15).sin_cos();
            filter = filter.predicted().updated(&measured([60.0 * sin, 60.0 - 60.0 * cos])).expect("sound").0;
        }
        for _ in 0..4 {
            filter = filter.predicted();
        }
        let (modes, probabilities) = filter.modes().zip(filter.probabilities()).expect("it has modes");
        let apart = [0, 1].map(|i| modes[0].place()[i] - modes[1].place()[i]);
        assert!(apart[0].hypot(apart[1]) > 5.0, "{apart:?}");
        for at in [modes[0].place(), modes[1].place(), [40.0, 80.0]].map(measured) {
            let density =
                |filter: &Filter| ln_likelihood(filter, &at, filter.squared_distance(&at).expect("sound")).exp();
            let mixture = probabilities[0] * density(&modes[0]) + probabilities[1] * density(&modes[1]);
            let found = density(&filter);
            assert!((found / mixture - 1.0).abs() < 1e-9, "{found}, not {mixture}");
        }
    }
}
