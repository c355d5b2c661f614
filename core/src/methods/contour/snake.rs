//! Parts shared by curves of points: parameters, points, and the acceptance of a fit.

use super::vocabulary::{case, value};
use super::{Edges, LEAST_AREA_PX, Placement, Point};
use crate::data::Frame;
use crate::geometry::polygon;
use crate::methods::region::Refusal;
use crate::params;
use crate::products::Region;

params! {
    /// The parameters of all contours that edges attract.
    pub struct Snake {
        /// Start and frames.
        placement: Placement = Placement::default();
        /// Distance of the points along the contour at the start of each frame.
        spacing: f32 = 4.0, 1.0..=32.0, "px";
        /// Standard deviation of the Gaussian that smooths the frame. Large values attract from farther, and blur details of the outline.
        sigma: f32 = 2.0, 0.5..=10.0, "px";
        /// Margin of the window around the contour, beyond which it cannot move in a frame.
        margin: usize = 24, 4..=200, "px";
        /// Mean edge strength along the contour below which the object is lost: contour and region stay.
        min_edge_strength: f32 = 0.15, 0.0..=1.0;
    }
    advanced { "margin" }
}

/// The fewest points of a contour.
const LEAST_POINTS: usize = 8;
/// The most points of a contour.
const MOST_POINTS: usize = 400;
/// The smallest range of gray levels with an edge.
const LEAST_GRAY_RANGE: u8 = 8;

/// The judgement of a fit.
#[derive(Clone, Copy, Debug)]
pub struct Verdict {
    /// Mean edge strength along the contour.
    pub strength: f32,
    /// The enclosed area in px²; negative if the contour has turned inside out.
    pub area: f64,
    /// Whether the contour crosses itself.
    pub crosses: bool,
    /// Whether the object is lost.
    pub is_lost: bool,
}

impl Snake {
    /// The contour with its points at equal distances.
    pub(crate) fn resampled(&self, points: &[Point]) -> Vec<Point> {
        let count = (polygon::length(points) / f64::from(self.spacing)).round() as usize;
        polygon::resampled(points, count.clamp(LEAST_POINTS, MOST_POINTS))
    }

    pub(crate) fn edges(&self, frame: &Frame, points: &[Point]) -> Edges {
        Edges::around(frame.luma(), points, (self.sigma, self.margin))
    }

    pub(crate) fn judge(&self, edges: &Edges, points: &[Point]) -> Verdict {
        let strength = points.iter().map(|at| edges.strength_at(*at)).sum::<f32>() / points.len() as f32;
        let (area, crosses) = (polygon::area(points), polygon::crossing(points).is_some());
        // A contour with NaN coordinates is unsound, too.
        let is_sound = !crosses && area >= LEAST_AREA_PX && strength >= self.min_edge_strength;
        Verdict { strength, area, crosses, is_lost: !is_sound }
    }

    /// Why the region of the first frame has no edge around it, if that is so.
    pub(crate) fn refuse(&self, frame: &Frame, region: Region) -> Option<Refusal> {
        let (luma, bounds) = (frame.luma(), region.bounds());
        let side = |i: usize, extent: usize| {
            let margin = self.margin as f32;
            let first = ((bounds.min[i] - margin).ceil().max(0.0) as usize).min(extent - 1);
            first..((bounds.max[i] + margin).floor().max(0.0) as usize + 1).clamp(first + 1, extent)
        };
        let (columns, rows) = (side(0, luma.width()), side(1, luma.height()));
        let levels = rows.flat_map(|y| &luma.row(y)[columns.clone()]);
        let [low, high] = levels.fold([u8::MAX, 0], |[low, high], level| [low.min(*level), high.max(*level)]);
        let range = high.saturating_sub(low);
        (range < LEAST_GRAY_RANGE).then(|| {
            let limits = vec![value::GRAY_RANGE.is(range), value::LEAST_GRAY_RANGE.is(LEAST_GRAY_RANGE)];
            (case::WITHOUT_EDGES, limits)
        })
    }
}
