//! Where a search tests displacements: the window, the costs, the best, and what an observer sees of it.

use std::cmp::Ordering;

use super::subpixel::BESIDE;
use super::{Displacement, Event, Match, Neighbours, Pair, Patch, Rate, Settings, Stage, Window, shorter};
use crate::base::Observer;
use crate::data::Between;
use crate::products::Block;
use crate::scene::Name;

/// Buffers that are used again from block to block.
#[derive(Default)]
pub(crate) struct Workspace {
    /// The pixels of the block, and of an area of frame t + 1.
    pub patch: Patch,
    /// One bit for each displacement of the window: whether it was tested.
    tested: Vec<u64>,
    /// What those that were tested cost.
    costs: Vec<f64>,
    /// The block's best match, moved by fractions of a pixel.
    pub between: Between,
    /// The sums of a whole window.
    pub sums: Vec<u32>,
    /// The costs of a whole window, where they are no sums.
    pub window_costs: Vec<f64>,
    /// An order in which to go through a window, and that window.
    pub order: (Option<Window>, Vec<u32>),
}

/// One block under search. A search asks for displacements; the tester passes over those that lie outside the window
/// or were tested before, keeps the best, counts, and tells the observer.
pub struct Tester<'a, O> {
    pub(crate) pair: &'a Pair,
    pub(crate) settings: Settings,
    pub(crate) block: Block,
    pub(crate) window: Window,
    /// What was found nearby; nothing for a search that does not predict.
    pub neighbours: Neighbours,
    pub(crate) work: &'a mut Workspace,
    pub(crate) observer: &'a mut O,
    /// The part of the window to which the search has narrowed down, if it does so.
    pub(crate) narrowed: Option<Window>,
    /// What a displacement costs to send.
    pub(crate) rate: Rate,
    pub(super) best: Option<Match>,
    pub(super) tested: usize,
}

impl<'a, O: Observer<Event>> Tester<'a, O> {
    /// Block `index` of `pair`, of which nothing was tested yet.
    pub(crate) fn new(
        (pair, index): (&'a Pair, usize),
        settings: Settings,
        neighbours: Neighbours,
        work: &'a mut Workspace,
        observer: &'a mut O,
    ) -> Self {
        let block = pair.blocks.block(index);
        let window = pair.window(block, settings.matching.range);
        work.patch.take_block(pair, block);
        work.tested.clear();
        work.tested.resize(window.count().div_ceil(64), 0);
        work.costs.resize(window.count(), f64::NAN);
        let rate = Rate::new(&settings, &neighbours);
        Self { pair, settings, block, window, neighbours, work, observer, narrowed: None, rate, best: None, tested: 0 }
    }

    /// The best displacement so far; at the very start, the zero displacement.
    pub fn best(&self) -> Displacement {
        self.best.map_or([0, 0], |best| best.displacement)
    }

    /// What the best displacement so far costs; at the very start, more than anything.
    pub fn best_cost(&self) -> f64 {
        self.best.map_or(f64::INFINITY, |best| best.cost)
    }

    /// How badly the best displacement so far fits: what it costs without the price of sending it.
    pub fn best_distortion(&self) -> f64 {
        self.best.map_or(f64::INFINITY, |best| self.rate.distortion(best))
    }

    /// What it costs if pixels differ by `levels` gray levels on average.
    pub fn cost_of_levels(&self, levels: f32) -> f64 {
        self.settings.matching.cost.of_levels(levels.into(), self.block)
    }

    /// What `displacement` costs, if it was tested.
    pub fn known(&self, displacement: Displacement) -> Option<f64> {
        let index = self.window.index(displacement)?;
        is_set(&self.work.tested, index).then(|| self.work.costs[index])
    }

    /// Whether `displacement` lies in the window and was not tested yet.
    pub fn is_new(&self, displacement: Displacement) -> bool {
        self.window.index(displacement).is_some_and(|index| !is_set(&self.work.tested, index))
    }

    /// Which of two displacements is better, of those that were tested; of equal ones the shorter.
    pub fn compare(&self, a: Displacement, b: Displacement) -> Ordering {
        let cost = |displacement| self.known(displacement).unwrap_or(f64::INFINITY);
        let by_length = if shorter(a, b) { Ordering::Less } else { Ordering::Greater };
        cost(a).total_cmp(&cost(b)).then(if a == b { Ordering::Equal } else { by_length })
    }

    /// Tells of a decision after which nothing is tested at once; `line` is its line of the pseudocode.
    pub fn tell(&mut self, line: Name, why: impl FnOnce() -> String) {
        self.stage(line, std::iter::empty(), why);
    }

    /// Tests `points` one after the other. `line` is the line of the pseudocode that asks for them; `why` says why.
    pub fn stage(
        &mut self,
        line: Name,
        points: impl Iterator<Item = Displacement> + Clone,
        why: impl FnOnce() -> String,
    ) {
        self.announce(points, |stage| Event::Stage { line, stage }, why);
    }

    /// Tells of a stage, as `event` makes an event of it, and tests its points.
    pub(super) fn announce(
        &mut self,
        points: impl Iterator<Item = Displacement> + Clone,
        event: impl FnOnce(Stage) -> Event,
        why: impl FnOnce() -> String,
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
            event(Stage { narrowed, asked: points.clone().count(), points: new, why: why() })
        });
        points.for_each(|point| self.test(point));
    }

    /// Tests `displacement`, unless it lies outside the window or was tested before.
    #[inline]
    fn test(&mut self, displacement: Displacement) {
        let Some(index) = self.window.index(displacement).filter(|&index| !is_set(&self.work.tested, index)) else {
            return;
        };
        let cost = self.distortion(displacement) + self.rate.price(displacement.map(|c| 4 * c));
        self.note(index, cost);
        self.take(Match::whole(displacement, cost));
    }

    /// Remembers that displacement `index` of the window was tested.
    #[inline]
    fn note(&mut self, index: usize, cost: f64) {
        self.work.tested[index / 64] |= 1 << (index % 64);
        self.work.costs[index] = cost;
    }

    /// Takes `found`, which was tested, as the best if it is.
    #[inline]
    pub(super) fn take(&mut self, found: Match) {
        self.tested += 1;
        self.observer.see(|| Event::Candidate { tested: found, rows: self.block.height });
        let before = self.best;
        let wins = |best: Match| {
            found.cost < best.cost || found.cost == best.cost && shorter(found.quarters(), best.quarters())
        };
        if before.is_none_or(wins) {
            self.observer.see(|| Event::NewBest { before });
            self.best = Some(found);
        }
    }

    /// How badly `displacement` fits. The candidate is read straight from frame t + 1 where it lies inside.
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

    /// Takes the result of a search that tested the whole window by its own means; `cost` gives each by its index.
    pub(crate) fn settle(&mut self, best: Match, cost: impl Fn(&Workspace, usize) -> f64) {
        (self.best, self.tested) = (Some(best), self.window.count());
        // Only a parabola asks again what the neighbours of the best cost.
        for point in around(best.displacement, &BESIDE, 1) {
            if let Some(index) = self.window.index(point) {
                let cost = cost(self.work, index);
                self.note(index, cost);
            }
        }
    }

    /// The best of all, refined, and how many displacements were tested.
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

/// The points of `pattern`, enlarged by `scale`, around `centre`.
pub(crate) fn around(
    centre: Displacement,
    pattern: &'static [Displacement],
    scale: i32,
) -> impl Iterator<Item = Displacement> + Clone {
    pattern.iter().map(move |[u, v]| [centre[0] + scale * u, centre[1] + scale * v])
}
