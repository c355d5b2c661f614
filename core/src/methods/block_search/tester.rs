//! The tester: tests candidates in the search window, keeps the minimum, counts, and reports events.

use std::sync::Arc;

use super::{Displacement, Event, Match, Neighbours, Pair, Patch, Rate, Settings, Skipped, Stage, Window};
use crate::base::Observer;
use crate::data::Between;
use crate::methods::cost::{bounds::PartSums, windows::Windows};
use crate::products::Block;
use crate::scene::Step;

/// Buffers reused from block to block.
#[derive(Default)]
pub(crate) struct Workspace {
    /// The pixels of the block, and of an area of frame t + 1.
    pub patch: Patch,
    /// One bit for each displacement of the search window: whether it was tested.
    tested: Vec<u64>,
    /// The costs of the tested ones.
    costs: Vec<f64>,
    /// The best match, interpolated at fractions of a pixel.
    pub between: Between,
    /// The sums of a whole search window.
    pub sums: Vec<u32>,
    /// The costs of a whole search window, where they are no sums.
    pub window_costs: Vec<f64>,
    /// Working memory for the costs of a whole search window.
    pub windows: Windows,
    /// The order of the candidates of a search window, and that window.
    pub order: (Option<Window>, Vec<u32>),
}

/// One block under search. A search names candidates; the tester skips those outside the search window or tested before,
/// keeps the minimum, counts, and reports events to the observer.
pub struct Tester<'a, O> {
    pub(crate) pair: &'a Pair,
    pub(crate) settings: Settings,
    pub(crate) block: Block,
    pub(crate) window: Window,
    /// The matches of neighbouring blocks; none for a search without prediction.
    pub neighbours: Neighbours,
    pub(crate) work: &'a mut Workspace,
    pub(crate) observer: &'a mut O,
    /// The part of the search window that remains, for searches that narrow it.
    pub(crate) narrowed: Option<Window>,
    /// The rate term of displacements.
    pub(crate) rate: Rate,
    /// The sums of parts of frame t + 1, for a search that [asks](super::BlockSearch::part_sides) for them.
    pub(crate) sums: Option<Arc<PartSums>>,
    pub(super) best: Option<Match>,
    pub(crate) tested: usize,
    /// Number of candidates of the search window that were skipped by a bound.
    pub(crate) skipped: usize,
}

impl<'a, O: Observer<Event>> Tester<'a, O> {
    /// The tester of block `index` of `pair`, with nothing tested yet.
    pub(crate) fn new(
        (pair, index): (&'a Pair, usize),
        settings: Settings,
        neighbours: Neighbours,
        work: &'a mut Workspace,
        observer: &'a mut O,
    ) -> Self {
        let block = pair.blocks.block(index);
        let window = pair.window(block, settings.matching.search_range);
        work.patch.take_block(pair, block);
        work.tested.clear();
        work.tested.resize(window.count().div_ceil(64), 0);
        work.costs.resize(window.count(), f64::NAN);
        let rate = Rate::new(&settings, &neighbours);
        Self {
            pair,
            settings,
            block,
            window,
            neighbours,
            work,
            observer,
            narrowed: None,
            rate,
            sums: None,
            best: None,
            tested: 0,
            skipped: 0,
        }
    }

    /// The displacement of minimum cost so far; zero before the first test.
    pub fn best(&self) -> Displacement {
        self.best.map_or([0, 0], |best| best.displacement)
    }

    /// The minimum cost so far; infinite before the first test.
    pub fn best_cost(&self) -> f64 {
        self.best.map_or(f64::INFINITY, |best| best.cost)
    }

    /// The distortion of the best displacement so far: its cost without the rate term.
    pub fn best_distortion(&self) -> f64 {
        self.best.map_or(f64::INFINITY, |best| self.rate.distortion(best))
    }

    /// The lowest cost of a neighbour in this pair, scaled to the pixels of the block: at the border it may be cut.
    pub fn least_of_neighbours(&self) -> Option<f64> {
        let least = self.neighbours.spatial().map(|found| found.cost).min_by(f64::total_cmp)?;
        let whole = self.pair.blocks.size.pow(2) as f64;
        let share = (self.block.width * self.block.height) as f64 / whole;
        Some(if self.settings.matching.cost.is_mean() { least } else { least * share })
    }

    /// The cost of a mean difference of `levels` gray levels per pixel.
    pub fn cost_of_levels(&self, levels: f32) -> f64 {
        self.settings.matching.cost.of_levels(levels.into(), self.block)
    }

    /// The cost of `displacement`, if it was tested.
    pub fn known(&self, displacement: Displacement) -> Option<f64> {
        let index = self.window.index(displacement)?;
        is_set(&self.work.tested, index).then(|| self.work.costs[index])
    }

    /// Whether `displacement` lies in the search window and was not tested yet.
    pub fn is_new(&self, displacement: Displacement) -> bool {
        self.window.index(displacement).is_some_and(|index| !is_set(&self.work.tested, index))
    }

    /// Reports a decision without candidates: `reason` tells why, at its line of the pseudocode.
    pub fn report(&mut self, reason: impl FnOnce() -> Step) {
        self.stage(std::iter::empty(), reason);
    }

    /// Tests the candidates `points` in order; `reason` tells why, at its line of the pseudocode.
    pub fn stage(&mut self, points: impl Iterator<Item = Displacement> + Clone, reason: impl FnOnce() -> Step) {
        self.announce(points, Event::Stage, reason);
    }

    /// Reports the stage that `event` makes an event of, and tests its candidates.
    pub(super) fn announce(
        &mut self,
        points: impl Iterator<Item = Displacement> + Clone,
        event: impl FnOnce(Stage) -> Event,
        reason: impl FnOnce() -> Step,
    ) {
        let (window, tested, narrowed) = (self.window, &self.work.tested, self.narrowed);
        self.observer.see(|| {
            let is_new = |point| window.index(point).is_some_and(|index| !is_set(tested, index));
            let mut new = Vec::new();
            for point in points.clone() {
                let place = point.map(|c| c as f32);
                if is_new(point) && !new.contains(&place) {
                    new.push(place);
                }
            }
            event(Stage { narrowed, asked: points.clone().count(), points: new, reason: Box::new(reason()) })
        });
        points.for_each(|point| self.test(point));
    }

    /// The largest sum over the block with which `displacement`, or any one, can still have the minimum cost.
    #[inline]
    pub(crate) fn sum_limit(&self, displacement: Option<Displacement>) -> u32 {
        let price = displacement.map_or(0.0, |displacement| self.rate.price(displacement.map(|c| 4 * c)));
        self.settings.matching.cost.sum_within(self.best_cost() - price, self.block)
    }

    /// Reports a candidate that is skipped, unless it was tested before.
    #[inline(always)]
    pub(crate) fn skip(&mut self, skipped: Skipped) {
        if O::WATCHES && self.is_new(skipped.displacement) {
            self.observer.see(|| Event::Skipped(skipped));
        }
    }

    /// Tests `displacement`, unless it lies outside the search window or was tested before.
    #[inline]
    pub(crate) fn test(&mut self, displacement: Displacement) {
        let Some(index) = self.window.index(displacement).filter(|&index| !is_set(&self.work.tested, index)) else {
            return;
        };
        let cost = self.distortion(displacement) + self.rate.price(displacement.map(|c| 4 * c));
        self.record(index, cost);
        self.take(Match::whole(displacement, cost));
    }

    /// Records the cost of displacement `index` of the search window.
    #[inline]
    fn record(&mut self, index: usize, cost: f64) {
        self.work.tested[index / 64] |= 1 << (index % 64);
        self.work.costs[index] = cost;
    }

    /// Makes the tested candidate `found` the best if its cost is the minimum.
    #[inline]
    pub(super) fn take(&mut self, found: Match) {
        self.tested += 1;
        self.observer.see(|| Event::Candidate { tested: found, rows: self.block.height });
        let before = self.best;
        if before.is_none_or(|best| found.wins(&best)) {
            self.observer.see(|| Event::NewBest { before });
            self.best = Some(found);
        }
    }

    /// The distortion of `displacement`. The candidate is read straight from frame t + 1 where it lies inside.
    #[inline]
    pub(super) fn distortion(&mut self, displacement: Displacement) -> f64 {
        let Self { pair, settings, block, .. } = *self;
        let picture = pair.next.luma();
        let [x, y] = [block.x as isize + displacement[0] as isize, block.y as isize + displacement[1] as isize];
        let inside = |start: isize, length: usize, extent: usize| start >= 0 && start as usize + length <= extent;
        if inside(x, block.width, picture.width()) && inside(y, block.height, picture.height()) {
            let first = y as usize * picture.width() + x as usize;
            settings.matching.cost.between(block, &self.work.patch.block, &picture.cells()[first..], picture.width())
        } else {
            self.work.patch.take_area(pair, block, Window { min: displacement, size: (1, 1) });
            let (pixels, stride) = self.work.patch.area.rows();
            settings.matching.cost.between(block, &self.work.patch.block, pixels, stride)
        }
    }

    /// Accepts the result of a search that tested the whole search window itself; `cost` gives the cost of each index.
    pub(crate) fn settle(&mut self, best: Match, cost: impl Fn(&Workspace, usize) -> f64) {
        (self.best, self.tested) = (Some(best), self.window.count());
        // Only a parabola needs the costs of the neighbours again.
        for point in around(best.displacement, &BESIDE, 1) {
            if let Some(index) = self.window.index(point) {
                let cost = cost(self.work, index);
                self.record(index, cost);
            }
        }
    }

    /// The best match, refined, and the number of candidates tested.
    pub(crate) fn finish(mut self) -> (Match, usize) {
        self.refine();
        let best = self.best.unwrap_or(Match::whole([0, 0], f64::INFINITY));
        self.observer.see(|| Event::Found(best));
        (best, self.tested)
    }
}

fn is_set(bits: &[u64], index: usize) -> bool {
    bits[index / 64] >> (index % 64) & 1 == 1
}

/// The points beside, above and below a centre.
pub(super) const BESIDE: [[i32; 2]; 4] = [[0, -1], [-1, 0], [1, 0], [0, 1]];

/// The candidates of `pattern`, enlarged by `scale`, around `centre`.
pub(crate) fn around(
    centre: Displacement,
    pattern: &'static [Displacement],
    scale: i32,
) -> impl Iterator<Item = Displacement> + Clone {
    pattern.iter().map(move |[u, v]| [centre[0] + scale * u, centre[1] + scale * v])
}
