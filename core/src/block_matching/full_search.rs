//! Full search, also called sequential or exhaustive search: every displacement in the window is tested.
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

use crate::block_search::{
    BlockSearch, Cost, Displacement, Event, Match, Patch, Tester, Window, block_search_params, shorter,
};
use crate::{Block, Info, Observer, Promise, choices, cost};

choices! {
    /// The order in which the candidates of a window are tested.
    pub enum Order {
        /// Row by row from the upper left corner.
        Raster = "raster" "Raster",
        /// In square rings outwards from the zero displacement, so that an early exit finds a low cost soon.
        Spiral = "spiral" "Spiral",
    }
}

block_search_params! {
    /// Full search: every displacement in the window is tested, so the smallest cost is found for certain.
    pub struct FullSearch {
        /// The order in which the candidates are tested. It never changes the result.
        order: Order = Order::Raster;
        /// Stop adding up a candidate after the row at which its sum exceeds the best (partial distortion). It never
        /// changes the result. The saving is told in rows; in time there is none here, where whole windows are summed at once.
        early_exit: bool = false;
    }
}

impl BlockSearch for FullSearch {
    const INFO: Info = Info {
        id: "full-search",
        name: "Full search",
        family: "Block matching",
        summary: "Tests every displacement in a window and keeps the one with the smallest difference.",
        source: "A. K. Jain, Fundamentals of Digital Image Processing, Prentice Hall 1989; \
                 early exit: C.-D. Bei and R. M. Gray, IEEE Trans. Communications 33(10), 1985",
        pseudocode: &[
            "for each block B of frame t",
            "  lay the window of ±range px around B in frame t+1",
            "  for each displacement (u, v) in the window",
            "    cost ← difference of B and the block at (u, v)",
            "    if cost < best, or equal and (u, v) shorter, then first",
            "      best ← cost at (u, v)",
            "  displacement of B ← (u, v) of the best",
        ],
        rungs: &["frame", "block", "step"],
        frames: 2,
    };
    const PROMISE: Promise = Promise::Translation;

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        // The kernel works out whole windows at once. An early exit is therefore only for the eye: what it passes
        // over could not have won.
        let Tester { pair, settings, block, window, .. } = *tester;
        let work = &mut *tester.work;
        work.patch.take_area(pair, block, window);
        cost::window(settings.cost.sum(), &work.patch.block, &work.patch.area, window.size, &mut work.sums);
        if self.order == Order::Spiral && work.order.0 != Some(window) {
            work.order = (Some(window), spiral(window));
        }
        let (patch, sums, order) = (&work.patch, &work.sums[..], &work.order.1[..]);
        let early_exit = self.early_exit;
        let best = Scan { patch, sums, order, window, block, cost: settings.cost, early_exit }.run(tester.observer);
        tester.settle(best, window.count());
    }

    fn line(event: &Event) -> usize {
        match event {
            Event::Window => 1,
            Event::Stage(_) => 2,
            Event::Candidate { .. } => 3,
            Event::NewBest { .. } => 5,
            Event::Found(_) => 6,
        }
    }
}

/// How many candidates are passed over at once where none of them can win.
const RUN: usize = 16;

/// One block's pixels, those under its window, and the sums of all candidates.
struct Scan<'a> {
    patch: &'a Patch,
    window: Window,
    block: Block,
    cost: Cost,
    early_exit: bool,
    /// By index into the window.
    sums: &'a [u32],
    /// The indices into the window in the order of the search; empty for raster.
    order: &'a [u32],
}

impl Scan<'_> {
    /// Tests the candidates in order. This is the loop that is taught, timed and trusted: there is no other.
    fn run(&self, observer: &mut impl Observer<Event>) -> Match {
        let (window, count) = (self.window, self.window.count());
        let found = |index| Match {
            displacement: window.displacement(index),
            cost: self.cost.of(self.sums[index], self.block),
        };
        let event = |index, limit| {
            let (sum, rows) =
                if self.early_exit { self.until(index, limit) } else { (self.sums[index], self.block.height) };
            let cost = self.cost.of(sum, self.block);
            Event::Candidate { displacement: window.displacement(index), cost, rows }
        };
        // An index: the displacement is only worked out where it is asked for.
        let mut best: Option<usize> = None;
        let mut limit = u32::MAX;
        for first in (0..count).step_by(RUN) {
            let run = first..count.min(first + RUN);
            if self.all_exceed(limit, run.clone()) {
                // None of these can win: whoever looks sees them, and otherwise there is nothing to do.
                run.for_each(|place| observer.see(|| event(self.index(place), limit)));
                continue;
            }
            for index in run.map(|place| self.index(place)) {
                let sum = self.sums[index];
                observer.see(|| event(index, limit));
                let wins_tie = |other| shorter(window.displacement(index), window.displacement(other));
                if sum < limit || sum == limit && best.is_none_or(wins_tie) {
                    observer.see(|| Event::NewBest { before: best.map(found) });
                    best = Some(index);
                    limit = sum;
                }
            }
        }
        best.map_or(Match { displacement: [0, 0], cost: f64::INFINITY }, found)
    }

    /// The index into the window of the candidate at `place` in the order of the search.
    #[inline(always)]
    fn index(&self, place: usize) -> usize {
        self.order.get(place).map_or(place, |&index| index as usize)
    }

    /// Sum and number of rows of a candidate that is given up after the first row at which it exceeds `limit`.
    fn until(&self, index: usize, limit: u32) -> (u32, usize) {
        let place = (index % self.window.size.0, index / self.window.size.0);
        cost::until(self.cost.sum(), &self.patch.block, &self.patch.area, place, limit)
    }

    /// Whether the sums at these places of the order all exceed `limit`.
    #[inline(always)]
    fn all_exceed(&self, limit: u32, places: Range<usize>) -> bool {
        match self.order.get(places.clone()) {
            Some(order) if !order.is_empty() => order.iter().all(|&index| self.sums[index as usize] > limit),
            // Without stopping at the first, so that it becomes vector instructions.
            _ => self.sums[places].iter().fold(true, |all, &sum| all & (sum > limit)),
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
