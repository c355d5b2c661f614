//! The end of a run in words: what became of the region, by its lost frames and, where it is known, the true box.

use crate::products::RegionFrame;
use crate::products::region::{RegionError, RegionScores, area_ratio};

/// A region with less of an overlap does not follow the object.
pub(crate) const FAIR: f64 = 0.5;
/// A region so many times as large as the true box has grown, one with the inverse has shrunk.
pub(super) const GROWN: f64 = 2.0;
/// So many frames before an occlusion a region that met the object is lost by it.
const SHORTLY: usize = 5;

/// What became of the region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It followed the object.
    Followed,
    /// It left the object, or most of it, for some frames and met it again.
    Regained,
    /// It is on the object, and at least twice as large.
    Grown,
    /// It is on the object, and at most half as large.
    Shrunk,
    /// It lies beside the object, with a part of it.
    Beside,
    /// It is not on the object, or the tracker reports the object as lost.
    Lost,
    /// No true boxes are known, and the tracker reports no loss that lasts.
    Unknown,
}

/// The end of a run.
#[derive(Clone, Copy, Debug)]
pub struct Ending {
    /// What became of the region.
    pub outcome: Outcome,
    /// Frames in which the tracker reports the object as lost.
    pub reported: usize,
    /// Frames of occlusions before which the region was on the object, where the truth is known.
    pub hidden: usize,
}

impl Ending {
    /// That of a run, with the comparisons of its frames.
    pub(super) fn of(past: &[RegionFrame], errors: &[RegionError]) -> Self {
        let reported = past.iter().filter(|frame| frame.is_lost).count();
        let Some((scores, last)) = RegionScores::of(errors).zip(errors.last()) else {
            let is_lost = 2 * reported >= past.len() || past.last().is_some_and(|frame| frame.is_lost);
            let outcome = if is_lost { Outcome::Lost } else { Outcome::Unknown };
            return Self { outcome, reported, hidden: 0 };
        };
        let ratio = area_ratio(last);
        let outcome = match last.overlap {
            0.0 => Outcome::Lost,
            0.0..FAIR if ratio >= GROWN => Outcome::Grown,
            0.0..FAIR if ratio <= 1.0 / GROWN => Outcome::Shrunk,
            0.0..FAIR => Outcome::Beside,
            _ if scores.failures > 0 || scores.overlap < FAIR => Outcome::Regained,
            _ => Outcome::Followed,
        };
        Self { outcome, reported, hidden: hidden(errors) }
    }
}

/// Frames without a visible object between others, if the region met the object shortly before.
fn hidden(errors: &[RegionError]) -> usize {
    let gap = |i: usize| {
        let frames = errors[i + 1].frame.saturating_sub(errors[i].frame + 1);
        let is_on = errors[..=i].iter().rev().take(SHORTLY).any(|error| error.overlap > 0.0);
        if is_on { frames } else { 0 }
    };
    (0..errors.len().saturating_sub(1)).map(gap).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Bounds;
    use crate::products::Region;

    fn frame(is_lost: bool) -> RegionFrame {
        RegionFrame { is_lost, ..RegionFrame::default() }
    }

    /// The outcome of a run over these regions, of a true box of 10×10 px around (50, 50) px.
    fn outcome(regions: &[([f32; 2], f32)]) -> Outcome {
        let truth = Bounds::around([50.0; 2], [10.0; 2]);
        let error = |(center, side): &([f32; 2], f32)| {
            let bounds = Bounds::around(*center, [*side; 2]);
            let overlap = f64::from(bounds.iou(&truth));
            RegionError { frame: 1, truth, bounds: Region::from(bounds).bounds(), overlap, center_px: 0.0 }
        };
        let errors: Vec<_> = regions.iter().map(error).collect();
        Ending::of(&vec![frame(false); regions.len() + 1], &errors).outcome
    }

    #[test]
    fn the_outcome_is_that_of_the_regions() {
        let (on, gone) = (([50.0; 2], 10.0), ([90.0; 2], 10.0));
        assert_eq!(outcome(&[on, on]), Outcome::Followed);
        assert_eq!(outcome(&[on, gone]), Outcome::Lost);
        assert_eq!(outcome(&[on, gone, on]), Outcome::Regained);
        assert_eq!(outcome(&[on, ([50.0; 2], 40.0)]), Outcome::Grown);
        assert_eq!(outcome(&[on, ([50.0; 2], 5.0)]), Outcome::Shrunk);
        assert_eq!(outcome(&[on, ([56.0, 50.0], 10.0)]), Outcome::Beside);
        assert_eq!(outcome(&[([57.0; 2], 10.0), ([57.0; 2], 10.0), on]), Outcome::Regained);
    }

    #[test]
    fn an_occlusion_counts_for_a_region_that_met_the_object() {
        let truth = Bounds::around([50.0; 2], [10.0; 2]);
        let of = |all: &[(usize, f64)]| {
            let error = |(frame, overlap): &(usize, f64)| RegionError {
                frame: *frame,
                truth,
                bounds: truth,
                overlap: *overlap,
                center_px: 0.0,
            };
            hidden(&all.iter().map(error).collect::<Vec<_>>())
        };
        assert_eq!(of(&[(1, 0.8), (2, 0.1), (3, 0.0), (9, 0.0), (10, 0.0)]), 5);
        assert_eq!(of(&[(1, 0.8), (2, 0.0), (3, 0.0), (4, 0.0), (5, 0.0), (6, 0.0), (9, 0.0)]), 0);
        assert_eq!(of(&[(1, 0.8), (2, 0.7)]), 0);
    }

    #[test]
    fn without_truth_no_success_is_known() {
        let of = |lost: &[bool]| Ending::of(&lost.iter().map(|lost| frame(*lost)).collect::<Vec<_>>(), &[]).outcome;
        assert_eq!(of(&[false; 6]), Outcome::Unknown);
        assert_eq!(of(&[false, true, true, true, false]), Outcome::Lost);
        assert_eq!(of(&[false, false, false, false, true]), Outcome::Lost);
        assert_eq!(of(&[false, true, false, false, false]), Outcome::Unknown);
    }
}
