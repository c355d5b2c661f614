//! The end of a run in words: the outcome of the region, from its lost frames and the true box, where it is known.

use crate::data::{Clip, ObjectBox};
use crate::geometry::Bounds;
use crate::products::region::{RegionError, RegionScores, area_ratio};
use crate::products::{RegionField, RegionFrame};

/// A region with less of an overlap does not follow the object.
pub(crate) const FAIR: f64 = 0.5;
/// A region has grown if it is at least this many times as large as the true box, and shrunk at the inverse.
pub(super) const GROWN: f64 = 2.0;
/// A region that still covered the object this many frames before an occlusion was lost because of it.
const SHORTLY: usize = 5;

/// The outcome for the region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It followed the object.
    Followed,
    /// It left the object, or most of it, for some frames and then returned.
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
    /// The outcome for the region.
    pub outcome: Outcome,
    /// Frames in which the tracker reports the object as lost.
    pub reported: usize,
    /// Frames of occlusions before which the region was on the object, where the truth is known.
    pub hidden: usize,
    /// The object at the start of the longest loss that is reported, where there is one and the truth is known.
    pub loss: Option<Loss>,
}

/// The true object in the first of the frames in which a tracker reports it as lost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loss {
    /// The frame.
    pub frame: usize,
    /// The share of the object that can be seen, 0 to 1.
    pub visibility: f64,
    /// Whether most of its hidden part lies outside the picture.
    pub is_leaving: bool,
    /// Its motion from the frame before in px.
    pub moved_px: f64,
    /// The shorter side of its box in px.
    pub side_px: f64,
}

impl Loss {
    /// The start of the longest loss of a run; none without one, or without the object in the truth of it and the frame before.
    fn longest(field: &RegionField, clip: &Clip) -> Option<Self> {
        let index = longest(&field.frames)?;
        let (truth, id, frame) = (clip.truth()?, field.object?, field.first + index);
        let at = |t: usize| truth.objects(t).ok()??.into_iter().find(|object| object.id == id);
        Some(Self::of(frame, [&at(frame.checked_sub(1)?)?, &at(frame)?], field.picture))
    }

    fn of(frame: usize, [before, now]: [&ObjectBox; 2], (width, height): (usize, usize)) -> Self {
        let [old, bounds] = [before, now].map(Bounds::from);
        let [u, v] = [0, 1].map(|i| f64::from(bounds.center()[i] - old.center()[i]));
        let end = [width, height].map(|extent| extent as f32 - 0.5);
        let inside = [0, 1].map(|i| f64::from(bounds.max[i].min(end[i]) - bounds.min[i].max(-0.5)).max(0.0));
        let outside = 1.0 - inside[0] * inside[1] / f64::from(bounds.area()).max(f64::MIN_POSITIVE);
        Self {
            frame,
            visibility: now.visibility.into(),
            is_leaving: outside > 0.0 && 2.0 * outside > 1.0 - f64::from(now.visibility),
            moved_px: u.hypot(v),
            side_px: bounds.size().map(f64::from).into_iter().fold(f64::INFINITY, f64::min),
        }
    }
}

impl Ending {
    /// The same of a run through a clip, with the comparisons of its frames.
    pub(super) fn in_clip(field: &RegionField, clip: &Clip, errors: &[RegionError]) -> Self {
        Self { loss: Loss::longest(field, clip), ..Self::of(&field.frames, errors) }
    }

    fn of(past: &[RegionFrame], errors: &[RegionError]) -> Self {
        let reported = past.iter().filter(|frame| frame.is_lost).count();
        let Some((scores, last)) = RegionScores::of(errors).zip(errors.last()) else {
            let is_lost = 2 * reported >= past.len() || past.last().is_some_and(|frame| frame.is_lost);
            let outcome = if is_lost { Outcome::Lost } else { Outcome::Unknown };
            return Self { outcome, reported, hidden: 0, loss: None };
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
        Self { outcome, reported, hidden: hidden(errors), loss: None }
    }
}

/// The first of the most frames in a row that are reported as lost.
fn longest(past: &[RegionFrame]) -> Option<usize> {
    let mut best: Option<(usize, usize)> = None;
    let mut first = 0;
    for streak in past.chunk_by(|a, b| a.is_lost == b.is_lost) {
        if streak[0].is_lost && best.is_none_or(|(_, count)| streak.len() > count) {
            best = Some((first, streak.len()));
        }
        first += streak.len();
    }
    best.map(|(first, _)| first)
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
            RegionError {
                frame: 1,
                truth,
                bounds: Region::from(bounds).bounds(),
                overlap,
                center_px: 0.0,
                is_lost: false,
            }
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
                is_lost: false,
            };
            hidden(&all.iter().map(error).collect::<Vec<_>>())
        };
        assert_eq!(of(&[(1, 0.8), (2, 0.1), (3, 0.0), (9, 0.0), (10, 0.0)]), 5);
        assert_eq!(of(&[(1, 0.8), (2, 0.0), (3, 0.0), (4, 0.0), (5, 0.0), (6, 0.0), (9, 0.0)]), 0);
        assert_eq!(of(&[(1, 0.8), (2, 0.7)]), 0);
    }

    #[test]
    fn a_loss_tells_cover_motion_and_leaving() {
        let at = |x: f32, visibility| ObjectBox { id: 1, x, y: 20.0, width: 12.0, height: 10.0, visibility };
        let of = |x, visibility| Loss::of(7, [&at(30.0, 1.0), &at(x, visibility)], (64, 48));
        let covered = of(33.0, 0.25);
        assert_eq!((covered.frame, covered.visibility, covered.is_leaving), (7, 0.25, false));
        assert_eq!((covered.moved_px, covered.side_px), (3.0, 10.0));
        assert!(of(58.0, 0.45).is_leaving && !of(51.0, 1.0).is_leaving);
        assert!(!of(52.0, 0.1).is_leaving, "at the border, and covered");
    }

    #[test]
    fn the_longest_loss_is_that_of_most_frames_in_a_row() {
        let of = |lost: &[bool]| longest(&lost.iter().map(|lost| frame(*lost)).collect::<Vec<_>>());
        assert_eq!(of(&[false, true, false, true, true, false, true, true]), Some(3));
        assert_eq!(of(&[false, true]), Some(1));
        assert_eq!(of(&[false; 3]), None);
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
