//! The curves of costs of semi-global matching, and the canyon that they form along a row.

use super::paths::NONE;
use super::shown::Shown;
use super::{SemiGlobalMatching, Stage};
use crate::geometry::Grid;
use crate::methods::stereo::{Curve, smallest};
use crate::scene::{Axes, Picture, PictureRole, Readout, Role, Surface};

/// The cut through the cost volume along a row.
pub(super) const SLICE: Picture = Picture { role: PictureRole::Slice, ..Picture::CURRENT };

impl SemiGlobalMatching {
    pub(super) fn curve(
        &self,
        shown: &Shown,
        title: &'static str,
        lines: Vec<(&'static str, Role, &[u32])>,
    ) -> Readout {
        let best = lines.last().map_or(0, |(.., costs)| smallest(costs).at);
        let real = |costs: &[u32]| costs.iter().map(|cost| *cost as f32).collect();
        let lines = lines.into_iter().map(|(name, role, costs)| (name, role, real(costs))).collect();
        Curve { title, y_label: "cost (bits)", lines, best, thresholds: Vec::new(), pair: self.pair(shown) }.readout()
    }

    pub(super) fn sum_curve(&self, shown: &Shown, sums: &[u32]) -> Readout {
        self.curve(shown, "Sum of path costs along the epipolar line", vec![("sum S(p, d)", Role::Estimate, sums)])
    }

    /// The costs along the row of the pixel, x to the right and d down: the sums so far and of how many paths they are, else the matching
    /// costs.
    pub(super) fn row(&self, shown: &Shown) -> (Grid<u32>, u32) {
        let (fixed, y) = (&shown.before.fixed, shown.pixel.1);
        let (width, depth) = (fixed.views.size().0, fixed.depth);
        let paths = (shown.state.done.min(self.directions().len() + 1) as u32).saturating_sub(1);
        let values: Vec<u32> = if paths > 0 {
            shown.state.sums[y * width * depth..(y + 1) * width * depth].iter().map(|sum| u32::from(*sum)).collect()
        } else {
            let mut row = vec![NONE; width * depth];
            self.cost_row(fixed, y, &mut row);
            row.into_iter().map(u32::from).collect()
        };
        (Grid::from_fn(width, self.settings.disparities, |x, d| values[x * depth + d]), paths)
    }

    /// The costs around the pixel on that cut as a canyon, with the disparities of least cost along its bed.
    pub(super) fn canyon(&self, shown: &Shown) -> Surface {
        /// How far it reaches to each side, in px.
        const REACH: usize = 24;
        let (row, paths) = self.row(shown);
        let (x, (width, depth)) = (shown.pixel.0, row.size());
        let (left, right) = (x.saturating_sub(REACH), (x + REACH).min(width - 1));
        // Beyond the border of the other view there is no match.
        let cost = |x: usize, d: usize| if d <= self.last(x) { row[(x, d)] as f32 } else { f32::NAN };
        let values = Grid::from_fn(right - left + 1, depth, |i, d| cost(left + i, d));
        let center = [(left + values.width() / 2) as f32, (depth / 2) as f32];
        let title = match shown.stage {
            _ if paths == 0 => "cost C(p, d)",
            Stage::Path(_) => "sum of the finished paths",
            _ => "sum S(p, d)",
        };
        let surface = Surface::over_picture((title, "bits"), (SLICE, center, 1.0), values);
        let least = |x: usize| smallest(&(0..=self.last(x)).map(|d| row[(x, d)]).collect::<Vec<_>>()).at;
        let bed = (left..=right).map(|x| surface.axes.displacement([x as f32, least(x) as f32]));
        let best = surface.axes.displacement([x as f32, least(x) as f32]).map(|c| c as i32);
        Surface {
            axes: Axes { names: ["x, px", "d, px"], ..surface.axes },
            trail: bed.collect(),
            probe: Some(best),
            ..surface
        }
    }
}
