//! Partial observation: the box of a blob of which something else hides one side.
//!
//! M. Xu and T. Ellis, Partial observation vs. blind tracking through occlusion, BMVC 2002: where only some edges of an object are
//! visible, those and its size give its position. Without them the centroid of what is visible would pull the track back.

use crate::data::Detection;
use crate::geometry::Bounds;

/// The share of its size that a box is shorter by at least, where a side is hidden.
const LEAST_HIDDEN: f32 = 0.12;
/// The greatest deviation of the visible edge from its prediction, as a share of the hidden length. If both edges move
/// inward, one of them is always within half of it.
const VISIBLE: f32 = 0.4;
/// The greatest change of the other dimension, along which nothing is hidden, as a share.
const OTHER: f32 = 0.3;
/// The greatest change of the size between frames as a share: by growing and by shrinking.
const CHANGE: [f32; 2] = [0.1, 0.05];
/// An edge within this distance of the picture's border is there because the picture ends, in px.
const BORDER_PX: f32 = 1.5;

/// The size of an object when no side is hidden.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WholeSize {
    /// Width and height in px.
    size: [f32; 2],
    /// The frames in a row in which a side has been hidden.
    pub hidden_frames: usize,
}

impl WholeSize {
    /// Returns the size of a first detection.
    pub fn of(found: &Detection) -> Self {
        Self { size: found.bounds.size(), hidden_frames: 0 }
    }

    /// Returns the size after a detection of which a side is hidden or not.
    #[must_use]
    pub fn seen(&self, found: &Detection, is_hidden: bool) -> Self {
        if is_hidden {
            return Self { hidden_frames: self.hidden_frames + 1, ..*self };
        }
        let size = found.bounds.size();
        let next = [0, 1].map(|i| size[i].max(self.size[i] * (1.0 - CHANGE[1])).min(self.size[i] * (1.0 + CHANGE[0])));
        Self { size: next, hidden_frames: 0 }
    }

    /// Returns the whole box of a blob, if one of its sides is hidden: along one axis it is shorter than the object, one of its edges
    /// is near the prediction, and the other is not.
    pub fn completed(&self, found: &Bounds, predicted: &Bounds, picture: (usize, usize)) -> Option<Bounds> {
        let predicted = Bounds::around(predicted.center(), self.size);
        let extent = [picture.0 as f32, picture.1 as f32];
        let side = |axis: usize| {
            let (length, other) = (found.size()[axis], found.size()[1 - axis] / self.size[1 - axis]);
            let hidden = self.size[axis] - length;
            if hidden < LEAST_HIDDEN * self.size[axis] || (other - 1.0).abs() > OTHER {
                return None;
            }
            let [low, high] = [found.min[axis] - predicted.min[axis], predicted.max[axis] - found.max[axis]];
            let is_cut_low = high.abs() <= VISIBLE * hidden && found.min[axis] > -0.5 + BORDER_PX;
            let is_cut_high = low.abs() <= VISIBLE * hidden && found.max[axis] < extent[axis] - 0.5 - BORDER_PX;
            let mut whole = *found;
            match (is_cut_low && high.abs() < low.abs(), is_cut_high && low.abs() < high.abs()) {
                (true, _) => whole.min[axis] = found.max[axis] - self.size[axis],
                (_, true) => whole.max[axis] = found.min[axis] + self.size[axis],
                _ => return None,
            }
            Some(whole)
        };
        side(0).or_else(|| side(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PICTURE: (usize, usize) = (320, 240);

    fn bounds([left, right]: [f32; 2]) -> Bounds {
        Bounds { min: [left, 50.0], max: [right, 80.0] }
    }

    fn completed(found: [f32; 2], predicted: [f32; 2]) -> Option<Bounds> {
        let size = WholeSize { size: [60.0, 30.0], hidden_frames: 0 };
        size.completed(&bounds(found), &bounds(predicted), PICTURE)
    }

    #[test]
    fn the_visible_edge_and_the_size_give_the_box() {
        assert_eq!(completed([100.0, 140.0], [101.0, 161.0]), Some(bounds([100.0, 160.0])), "the right is hidden");
        assert_eq!(completed([120.0, 158.0], [99.0, 159.0]), Some(bounds([98.0, 158.0])), "the left is hidden");
    }

    #[test]
    fn what_is_seen_whole_shrinks_in_the_middle_or_leaves_the_picture_is_taken_as_it_is() {
        assert_eq!(completed([103.0, 160.0], [101.0, 161.0]), None, "noise");
        assert_eq!(completed([110.0, 151.0], [100.0, 160.0]), None, "both edges move inward");
        assert_eq!(completed([280.0, 319.5], [281.0, 341.0]), None, "the picture ends");
        assert_eq!(completed([-0.5, 40.0], [-20.0, 40.0]), None, "the picture begins");
        let low = Bounds { min: [100.0, 65.0], max: [140.0, 80.0] };
        let size = WholeSize { size: [60.0, 30.0], hidden_frames: 0 };
        assert_eq!(size.completed(&low, &bounds([101.0, 161.0]), PICTURE), None, "another shape");
    }

    #[test]
    fn the_size_follows_slowly_and_not_at_all_while_hidden() {
        let found = |width: f32| Detection {
            bounds: bounds([100.0, 100.0 + width]),
            center: [0.0; 2],
            score: 1.0,
            blob: None,
            deviation_px: None,
        };
        let size = WholeSize::of(&found(60.0));
        assert_eq!(size.seen(&found(120.0), false).size, [66.0, 30.0]);
        assert_eq!(size.seen(&found(30.0), false).size, [57.0, 30.0]);
        let hidden = size.seen(&found(30.0), true);
        assert_eq!((hidden.size, hidden.hidden_frames), ([60.0, 30.0], 1));
    }
}
