//! The pixel that a step of semi-global matching explains, with its costs.

use super::paths::{self, Job, Line, NONE};
use super::{Event, SemiGlobalMatching, Stage, State};
use crate::methods::stereo::Pair;
use crate::run::Seen;

/// The pixel that a step explains.
pub(super) struct Shown<'a> {
    /// The state with the results of the stage, if it is finished; else the state before it.
    pub state: &'a State,
    pub before: &'a State,
    pub stage: Stage,
    pub pixel: (usize, usize),
}

/// The path costs of a pixel along a direction, with their parts.
pub(super) struct Path {
    /// The first pixel of the path.
    pub from: (usize, usize),
    /// Path costs of the pixel and, unless the path begins there, of the one before.
    pub costs: Vec<u32>,
    pub before: Option<Vec<u32>>,
}

impl Shown<'_> {
    /// The costs of the disparities of a pixel, without those of matches beside the right view.
    fn costs(&self, of: &SemiGlobalMatching, (x, y): (usize, usize)) -> Vec<u8> {
        let (fixed, width) = (&self.before.fixed, self.before.fixed.views.size().0);
        let mut row = vec![NONE; width * fixed.depth];
        of.cost_row(fixed, y, &mut row);
        row[x * fixed.depth..(x + 1) * fixed.depth].to_vec()
    }

    /// The sums of a pixel so far, without those of matches beside the right view.
    pub(super) fn sums(&self, of: &SemiGlobalMatching) -> Vec<u32> {
        let ((x, y), width, depth) = (self.pixel, self.before.fixed.views.size().0, self.before.fixed.depth);
        let cells = &self.state.sums[(y * width + x) * depth..][..of.last(x) + 1];
        cells.iter().map(|sum| u32::from(*sum)).collect()
    }

    /// Follows a path from the border of the picture to the pixel.
    pub(super) fn path(&self, of: &SemiGlobalMatching, [dx, dy]: [isize; 2]) -> Path {
        let ((width, height), depth) = (self.before.fixed.views.size(), self.before.fixed.depth);
        let inside = |(x, y): (isize, isize)| (0..width as isize).contains(&x) && (0..height as isize).contains(&y);
        let mut from = (self.pixel.0 as isize, self.pixel.1 as isize);
        while inside((from.0 - dx, from.1 - dy)) {
            from = (from.0 - dx, from.1 - dy);
        }
        let (mut at, mut before) = (from, Line::outside(1, depth));
        let (mut last, mut sums) = (None, vec![0; depth]);
        loop {
            let costs = self.costs_on_path(of, at);
            let mut line = Line::outside(1, depth);
            // A path may be longer than the sums have room for.
            sums.fill(0);
            let job = Job {
                dx: 0,
                before: Some(&before),
                line: &mut line,
                costs,
                sums: &mut sums,
                penalties: of.penalties(),
            };
            paths::follow(job);
            if at == (self.pixel.0 as isize, self.pixel.1 as isize) {
                let path_costs =
                    |line: &Line, x: usize| line.at(0)[..of.last(x) + 1].iter().map(|cost| u32::from(*cost)).collect();
                let came_from = (at.0 - dx) as usize;
                return Path {
                    from: (from.0 as usize, from.1 as usize),
                    costs: path_costs(&line, self.pixel.0),
                    before: last.map(|()| path_costs(&before, came_from)),
                };
            }
            (before, last) = (line, Some(()));
            at = (at.0 + dx, at.1 + dy);
        }
    }

    /// The costs of a pixel out of the volume.
    fn costs_on_path(&self, of: &SemiGlobalMatching, (x, y): (isize, isize)) -> &[u8] {
        debug_assert_eq!(self.before.fixed.depth, of.settings.disparities.next_multiple_of(paths::LANES));
        let (width, depth) = (self.before.fixed.views.size().0, self.before.fixed.depth);
        &self.before.costs[(y as usize * width + x as usize) * depth..][..depth]
    }
}

impl SemiGlobalMatching {
    /// The largest disparity of a pixel with a match inside the right view.
    pub(super) fn last(&self, x: usize) -> usize {
        x.min(self.settings.disparities - 1)
    }

    /// The pixel pointed at, else the middle of the current row; `None` before the first.
    pub(super) fn shown<'a>(&self, seen: &'a Seen<Self>) -> Option<Shown<'a>> {
        let Event { stage, y } = *seen.events.last()?;
        let views = &seen.before.fixed.views;
        let pointed_at = seen.point().and_then(|point| views.left.luma().cell_at(point));
        let pixel = pointed_at.unwrap_or((views.size().0 / 2, y as usize));
        Some(Shown { state: seen.after.unwrap_or(seen.before), before: seen.before, stage, pixel })
    }

    pub(super) fn pair<'a>(&self, shown: &Shown<'a>) -> Pair<'a> {
        Pair { views: &shown.before.fixed.views, pixel: shown.pixel, reach: 4, disparities: self.settings.disparities }
    }

    pub(super) fn single_costs(&self, shown: &Shown) -> Vec<u32> {
        let costs = shown.costs(self, shown.pixel);
        costs[..self.last(shown.pixel.0) + 1].iter().map(|cost| u32::from(*cost)).collect()
    }
}
