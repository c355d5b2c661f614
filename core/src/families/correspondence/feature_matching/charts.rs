//! The plots and tiles of feature matching.

use super::{FeatureMatching, State};
use crate::methods::differential::explain;
use crate::methods::matching::Neighbors;
use crate::products::keypoints::{Descriptor, Keypoint};
use crate::products::{Match, MatchField, MatchStatus};
use crate::scene::{Role, Series, Tile};

/// Number of ratio limits in the plot of precision.
const LIMITS: usize = 20;

impl FeatureMatching {
    /// Precision and share of the nearest neighbours that limits of the ratio accept, where the truth is known; else the share alone.
    pub(super) fn precision(&self, state: &State) -> Option<Series> {
        let is_tested = |found: &Match| found.ratio.is_some() || found.status == MatchStatus::RejectedRatio;
        let all: Vec<Match> = state.matches().filter(is_tested).collect();
        if all.is_empty() {
            return None;
        }
        let mut limits: Vec<f32> = (0..=LIMITS).map(|i| 0.5 + 0.5 * i as f32 / LIMITS as f32).collect();
        limits.retain(|limit| *limit != self.settings.ratio);
        limits.insert(limits.partition_point(|limit| *limit < self.settings.ratio), self.settings.ratio);
        let (mut shares, mut precisions) = (Vec::new(), Vec::new());
        for limit in limits {
            let accepted = || all.iter().filter(|found| found.ratio.is_some_and(|ratio| ratio < limit));
            shares.push([limit, accepted().count() as f32 / all.len() as f32]);
            let truth = state.fixed.truth.as_ref();
            let precision = truth.and_then(|truth| MatchField::compare(accepted(), truth).precision());
            precisions.push([limit, precision.map_or(f32::NAN, |share| share as f32)]);
        }
        let mut lines = vec![("accepted", Role::Reference, shares)];
        if precisions.iter().any(|point| point[1].is_finite()) {
            lines.push(("precision: right of accepted", Role::Result, precisions));
        }
        Some(Series {
            is_sweep: true,
            chosen: Some(self.settings.ratio),
            ..Series::new("Ratio test", ["ratio limit", "share"], 1, lines)
        })
    }

    /// The neighbourhoods of the keypoint and of its neighbours.
    pub(super) fn tiles(&self, state: &State, index: usize, neighbors: &Neighbors) -> Vec<Tile> {
        let reach = self.settings.reach().min(7);
        let tile = |side: usize, index: usize, label, role| {
            let luma = state.fixed.pair.frames[side].luma();
            let place = luma.cell_at(state.fixed.pair.sides[side].points[index].at)?;
            Some(Tile::gray(label, explain::around(luma, place, reach)).with_role(role))
        };
        let first = neighbors.first.and_then(|(index, _)| tile(1, index, "Nearest", Role::Best));
        let second = neighbors.second.and_then(|(index, _)| tile(1, index, "Second nearest", Role::Rejected));
        [tile(0, index, "Keypoint", Role::Reference), first, second].into_iter().flatten().collect()
    }
}

/// The entries of two descriptors of real values.
pub(super) fn descriptors(keypoint: &Keypoint, other: Option<&Keypoint>) -> Option<Series> {
    let entries = |keypoint: &Keypoint| match keypoint.descriptor.as_ref()? {
        Descriptor::Reals(values) => {
            Some(values.iter().enumerate().map(|(i, v)| [(i + 1) as f32, *v]).collect::<Vec<_>>())
        }
        Descriptor::Bits(_) => None,
    };
    let own = entries(keypoint)?;
    let x_max = own.len();
    let mut lines = vec![("a, of the keypoint", Role::Reference, own)];
    lines.extend(other.and_then(entries).map(|values| ("b, of the nearest", Role::Best, values)));
    Some(Series { is_sweep: true, fits_values: true, ..Series::new("Descriptors", ["entry", "value"], x_max, lines) })
}

/// Bins of the histogram of distances.
const BINS: usize = 16;

/// The histogram of the distances of all nearest neighbours: of right and of wrong ones where the truth is known.
pub(super) fn distances(state: &State) -> Option<Series> {
    let all: Vec<Match> = state.matches().collect();
    let most = all.iter().map(|found| found.distance).fold(0.0, f32::max);
    if all.len() < 2 || most <= 0.0 {
        return None;
    }
    let line = |is_counted: &dyn Fn(&Match) -> bool| {
        let mut counts = [0.0f32; BINS];
        for found in all.iter().filter(|found| is_counted(found)) {
            counts[((found.distance / most * BINS as f32) as usize).min(BINS - 1)] += 1.0;
        }
        let middle = |i: usize| (i as f32 + 0.5) / BINS as f32 * most;
        counts.iter().enumerate().map(|(i, count)| [middle(i), *count]).collect::<Vec<_>>()
    };
    let lines = match state.fixed.truth.as_deref() {
        Some(truth) => vec![
            ("right", Role::Best, line(&|found| MatchField::is_right(found, truth) == Some(true))),
            ("wrong", Role::Error, line(&|found| MatchField::is_right(found, truth) == Some(false))),
        ],
        None => vec![("nearest neighbours", Role::Reference, line(&|_| true))],
    };
    Some(Series {
        is_sweep: true,
        ..Series::new(
            "Distances of nearest neighbours",
            ["distance of the descriptors", "keypoints"],
            most.ceil() as usize,
            lines,
        )
    })
}
