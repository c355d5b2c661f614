//! Full search, also called sequential or exhaustive search: every displacement in the search window is tested.
//!
//! ```text
//! ● ● ● ● ● ● ●
//! ● ● ● ● ● ● ●
//! ● ● ● ● ● ● ●
//! ● ● ● ○ ● ● ●     ±3 px: 49 candidates. ○ is the zero displacement.
//! ● ● ● ● ● ● ●
//! ● ● ● ● ● ● ●
//! ● ● ● ● ● ● ●
//! ```

use std::ops::Range;

use crate::base::Observer;
use crate::methods::{
    block_search::{
        BlockSearch, Displacement, Event, Match, Matching, Patch, Settings, Tester, Window, block_search_params,
        shorter,
    },
    cost::{self, Sum},
};
use crate::run::{Guarantee, Info};
use crate::{choices, pseudocode};

choices! {
    /// Order in which the candidates of a search window are tested.
    pub enum Order {
        /// Row by row from the upper left corner of the search window.
        Raster = "raster" "Raster",
        /// In square rings outwards from (0, 0): a low cost is found early, so early exit rejects more rows.
        Spiral = "spiral" "Spiral",
    }
}

block_search_params! {
    /// Full search: every displacement in the search window is tested, which guarantees the global minimum.
    pub struct FullSearch {
        /// Order in which the candidates are tested. It does not change the result.
        order: Order = Order::Raster;
        /// Partial distortion elimination: reject a candidate at the row where its partial sum exceeds the minimum so far. It
        /// does not change the result, and applies to SAD, SSD and MSE. The rows saved are counted; here it saves no time,
        /// since whole search windows are summed at once.
        early_exit: bool = false;
    }
}

pseudocode! {
    EACH_BLOCK: "for each block B of frame t",
    LAY_WINDOW: "  place the search window of ±search range around B in frame t+1",
    EACH_CANDIDATE: "  for each candidate (u, v) in the search window",
    COMPUTE_COST: "    c ← cost of B and the block of frame t+1 displaced by (u, v) [+ λR(u, v)]",
    EXIT_EARLY: "    if a partial sum s > minimum: reject, c ≥ s (early exit)",
    COMPARE_COST: "    if c < minimum, or c = minimum and (u, v) is shorter than best",
    KEEP_BEST: "      minimum ← c; best ← (u, v)",
    REFINE_BEST: "  refine best to sub-pixel accuracy (if subpixel is set)",
    SET_DISPLACEMENT: "  motion vector of B ← best",
}

impl BlockSearch for FullSearch {
    const INFO: Info = Info {
        id: "full-search",
        name: "Full search",
        family: "Block matching",
        summary: "Tests every displacement in the search window and keeps the global minimum of the cost.",
        source: "A. K. Jain, Fundamentals of Digital Image Processing, Prentice Hall 1989; \
                 early exit: C.-D. Bei and R. M. Gray, IEEE Trans. Communications 33(10), 1985",
        pseudocode: line::ALL,
        granularities: &["frame", "block", "step"],
        frames: 2,
    };
    const GUARANTEE: Guarantee = Guarantee::Translation;

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        let Tester {
            pair, settings: Settings { matching: Matching { cost: kind, .. }, .. }, block, window, rate, ..
        } = *tester;
        let (observer, work) = (&mut *tester.observer, &mut *tester.work);
        work.patch.take_area(pair, block, window);
        if self.order == Order::Spiral && work.order.0 != Some(window) {
            work.order = (Some(window), spiral(window));
        }
        let (Patch { block: cut, area }, order) = (&work.patch, &work.order.1[..]);
        let price = |index| rate.price(window.displacement(index).map(|c| 4 * c));
        // The kernel computes whole search windows at once. Early exit is therefore only shown: the rows it skips could not
        // change the minimum.
        let until = |sum, index: usize, limit| {
            cost::until(sum, cut, area, (index % window.size.0, index / window.size.0), limit)
        };
        let summed = kind.sum().inspect(|&sum| match sum {
            Sum::Absolute => cost::window(cut, area, window.size, &mut work.sums),
            Sum::Squared => work.windows.squared_differences(cut, area, window.size, &mut work.sums),
        });
        if let Some(sum) = summed.filter(|_| rate.lambda == 0.0) {
            let scan = Scan { window, order, costs: &work.sums[..], most: u32::MAX, of: |sum| kind.of(sum, block) };
            let best = scan.run(observer, |index, limit| {
                let whole = (work.sums[index], block.height);
                let (sum, rows) = if self.early_exit { until(sum, index, limit) } else { whole };
                (kind.of(sum, block), rows)
            });
            return tester.settle(best, |work, index| kind.of(work.sums[index], block));
        }
        match summed {
            Some(_) => {
                work.window_costs.clear();
                work.window_costs.extend(work.sums.iter().map(|&sum| kind.of(sum, block)));
            }
            None => kind.window(cut, area, window.size, (&mut work.windows, &mut work.window_costs)),
        }
        if rate.lambda > 0.0 {
            work.window_costs.iter_mut().enumerate().for_each(|(index, cost)| *cost += price(index));
        }
        let scan = Scan { window, order, costs: &work.window_costs[..], most: f64::INFINITY, of: |cost| cost };
        let best = scan.run(observer, |index, limit| match summed.filter(|_| self.early_exit) {
            Some(sum) => {
                let (sum, rows) = until(sum, index, kind.sum_within(limit - price(index), block));
                (kind.of(sum, block) + price(index), rows)
            }
            None => (work.window_costs[index], block.height),
        });
        tester.settle(best, |work, index| work.window_costs[index]);
    }
}

/// Number of candidates skipped at once if none of them can be the minimum.
const RUN: usize = 16;

/// The costs of all candidates of a search window, or sums from which they follow.
struct Scan<'a, T, F> {
    window: Window,
    /// The indices into the search window in the order of the search; empty for raster.
    order: &'a [u32],
    /// By index into the search window.
    costs: &'a [T],
    /// An upper bound of the costs.
    most: T,
    /// The cost for a sum.
    of: F,
}

impl<T: Copy + PartialOrd, F: Fn(T) -> f64> Scan<'_, T, F> {
    /// Tests the candidates in order; the only loop, both for stepping and for timing. `seen` gives the cost of a candidate and
    /// the rows summed until it exceeded a limit.
    fn run(&self, observer: &mut impl Observer<Event>, seen: impl Fn(usize, T) -> (f64, usize)) -> Match {
        let (window, count) = (self.window, self.window.count());
        let found = |index| Match::whole(window.displacement(index), (self.of)(self.costs[index]));
        let event = |index, limit| {
            let (cost, rows) = seen(index, limit);
            Event::Candidate { tested: Match::whole(window.displacement(index), cost), rows }
        };
        // An index: the displacement is computed only where it is needed.
        let mut best: Option<usize> = None;
        let mut limit = self.most;
        for first in (0..count).step_by(RUN) {
            let run = first..count.min(first + RUN);
            if self.all_exceed(limit, run.clone()) {
                // None of these can be the minimum: they are only reported.
                run.for_each(|place| observer.see(|| event(self.index(place), limit)));
                continue;
            }
            for index in run.map(|place| self.index(place)) {
                let cost = self.costs[index];
                observer.see(|| event(index, limit));
                let wins_tie = |other| shorter(window.displacement(index), window.displacement(other));
                if cost < limit || cost == limit && best.is_none_or(wins_tie) {
                    observer.see(|| Event::NewBest { before: best.map(found) });
                    best = Some(index);
                    limit = cost;
                }
            }
        }
        best.map_or(Match::whole([0, 0], f64::INFINITY), found)
    }

    /// The index into the search window of the candidate at `place` in the order of the search.
    #[inline(always)]
    fn index(&self, place: usize) -> usize {
        self.order.get(place).map_or(place, |&index| index as usize)
    }

    /// Whether the costs at these places of the order all exceed `limit`.
    #[inline(always)]
    fn all_exceed(&self, limit: T, places: Range<usize>) -> bool {
        match self.order.get(places.clone()) {
            Some(order) if !order.is_empty() => order.iter().all(|&index| self.costs[index as usize] > limit),
            // Without an early return, so that it is vectorised.
            _ => self.costs[places].iter().fold(true, |all, &cost| all & (cost > limit)),
        }
    }
}

/// The indices into `window` ring by ring around the zero displacement, each clockwise from its upper left corner.
fn spiral(window: Window) -> Vec<u32> {
    let reach = |i: usize, size: usize| window.min[i].abs().max(window.min[i] + size as i32 - 1);
    let rings = 0..=reach(0, window.size.0).max(reach(1, window.size.1));
    let displacements = rings.flat_map(|ring| (0..(8 * ring).max(1)).map(move |along| on_ring(ring, along)));
    displacements.filter_map(|displacement| window.index(displacement)).map(|index| index as u32).collect()
}

/// The displacement `along` px along the square ring at distance `ring` around the zero displacement.
fn on_ring(ring: i32, along: i32) -> Displacement {
    let (side, rest) = (along / (2 * ring).max(1), along % (2 * ring).max(1));
    match side {
        0 => [rest - ring, -ring],
        1 => [ring, rest - ring],
        2 => [ring - rest, ring],
        _ => [-ring, ring - rest],
    }
}
