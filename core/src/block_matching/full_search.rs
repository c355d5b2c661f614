//! Full search, also called sequential or exhaustive search: every displacement in the window is tested.

use std::ops::Range;
use std::sync::Arc;

use crate::block_search::{self, BorderRule, Cost, Displacement, Event, Match, Pair, Patch, Probe, Window, shorter};
use crate::cost::Sum;
use crate::{
    Block, Clip, Error, Estimator, Info, Observer, Output, Progress, Role, Rung, Scene, Seen, Step, Threads, choices,
    cost, params,
};

choices! {
    /// The order in which the candidates of a window are tested.
    pub enum Order {
        /// Row by row from the upper left corner.
        Raster = "raster" "Raster",
        /// In square rings outwards from the zero displacement, so that an early exit finds a low cost soon.
        Spiral = "spiral" "Spiral",
    }
}

params! {
    /// Full search: every displacement in the window is tested, so the smallest cost is found for certain.
    pub struct FullSearch {
        /// Side of the square blocks.
        block: usize = 16, 4..=64, "px";
        /// Largest displacement to the left, right, up and down that is tested.
        range: usize = 16, 1..=64, "px";
        /// How unlike two blocks are. SSD and MSE are one divided by the other, so they choose the same vectors.
        cost: Cost = Cost::Sad;
        /// The order in which the candidates are tested. It never changes the result.
        order: Order = Order::Raster;
        /// Distance from one block to the next; 0 sets them edge to edge, less than the block lets them overlap.
        step: usize = 0, 0..=64, "px";
        /// Stop adding up a candidate after the row at which its sum exceeds the best (partial distortion). It never
        /// changes the result. The saving is told in rows; in time there is none here, where whole windows are summed at once.
        early_exit: bool = false;
        /// What happens where the window leaves the picture.
        border: BorderRule = BorderRule::Inside;
    }
}

/// What a full search reads and writes.
#[derive(Clone)]
pub struct State {
    pair: Pair,
    /// The displacements of a window that the border does not cut, in the order of the search; `None` for raster.
    order: Option<Arc<[Displacement]>>,
    found: Vec<Match>,
    candidates: u64,
}

impl FullSearch {
    /// The displacements up to ±range in the order of the search; `None` if that is simply row by row.
    fn order(&self) -> Option<Arc<[Displacement]>> {
        let (min, side) = (-(self.range as i32), 2 * self.range + 1);
        let whole = Window { min: [min, min], size: (side, side) };
        let mut displacements: Vec<_> = (0..whole.count()).map(|index| whole.displacement(index)).collect();
        match self.order {
            Order::Raster => return None,
            Order::Spiral => displacements.sort_by_cached_key(|&displacement| ring_place(displacement)),
        }
        Some(displacements.into())
    }

    /// Searches one block.
    fn search(&self, state: &State, block: Block, task: &mut Task, observer: &mut impl Observer<Event>) -> Match {
        task.set(self, state, block);
        observer.see(|| Event::Window);
        let best = self.scan(task, observer);
        observer.see(|| Event::Found(best));
        best
    }

    /// Tests the candidates in order. This is the loop that is taught, timed and trusted: there is no other.
    fn scan(&self, task: &Task, observer: &mut impl Observer<Event>) -> Match {
        let (window, count) = (task.window, task.window.count());
        let found = |index| Match { displacement: window.displacement(index), sum: task.sums[index] };
        let event = |index, limit| {
            let (sum, rows) = if self.early_exit { task.until(index, limit) } else { (task.sums[index], task.height) };
            Event::Candidate { displacement: window.displacement(index), sum, rows }
        };
        // An index: the displacement is only worked out where it is asked for.
        let mut best: Option<usize> = None;
        let mut limit = u32::MAX;
        for first in (0..count).step_by(RUN) {
            let run = first..count.min(first + RUN);
            if task.all_exceed(limit, run.clone()) {
                // None of these can win: whoever looks sees them, and otherwise there is nothing to do.
                run.for_each(|place| observer.see(|| event(task.index(place), limit)));
                continue;
            }
            for index in run.map(|place| task.index(place)) {
                let sum = task.sums[index];
                observer.see(|| event(index, limit));
                let wins_tie = |other| shorter(window.displacement(index), window.displacement(other));
                if sum < limit || sum == limit && best.is_none_or(wins_tie) {
                    observer.see(|| Event::NewBest { before: best.map(found) });
                    best = Some(index);
                    limit = sum;
                }
            }
        }
        best.map_or(Match { displacement: [0, 0], sum: limit }, found)
    }
}

/// How many candidates are passed over at once where none of them can win.
const RUN: usize = 16;

/// One block's pixels, those under its window, and the sums of all candidates.
struct Task {
    patch: Patch,
    window: Window,
    height: usize,
    sum: Sum,
    /// By index into the window.
    sums: Vec<u32>,
    /// The indices into the window in the order of the search; empty for raster.
    order: Vec<u32>,
}

impl Task {
    fn new(search: &FullSearch) -> Self {
        let window = Window { min: [0, 0], size: (0, 0) };
        let (patch, sum) = (Patch::default(), search.cost.sum());
        Self { patch, window, height: 0, sum, sums: Vec::new(), order: Vec::new() }
    }

    fn set(&mut self, search: &FullSearch, state: &State, block: Block) {
        let window = state.pair.window(block, search.range);
        self.patch.take(&state.pair, block, window);
        self.height = block.height;
        // The kernel works out whole windows at once. An early exit is therefore only for the eye: what it passes
        // over could not have won.
        cost::window(self.sum, &self.patch.block, &self.patch.area, window.size, &mut self.sums);
        if window != self.window {
            self.window = window;
            let order = state.order.iter().flat_map(|order| order.iter());
            self.order.clear();
            self.order.extend(order.filter_map(|&displacement| window.index(displacement)).map(|index| index as u32));
        }
    }

    /// The index into the window of the candidate at `place` in the order of the search.
    #[inline(always)]
    fn index(&self, place: usize) -> usize {
        self.order.get(place).map_or(place, |&index| index as usize)
    }

    /// Sum and number of rows of a candidate that is given up after the first row at which it exceeds `limit`.
    fn until(&self, index: usize, limit: u32) -> (u32, usize) {
        let place = (index % self.window.size.0, index / self.window.size.0);
        cost::until(self.sum, &self.patch.block, &self.patch.area, place, limit)
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

/// Ring around the zero displacement, then the place along it, clockwise from its upper left corner.
fn ring_place([u, v]: [i32; 2]) -> (i32, i32) {
    let ring = u.abs().max(v.abs());
    let along = if v == -ring {
        u + ring
    } else if u == ring {
        2 * ring + v + ring
    } else if v == ring {
        4 * ring + ring - u
    } else {
        6 * ring + ring - v
    };
    (ring, along)
}

impl Estimator for FullSearch {
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
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        let pair = Pair::new(clip, frame, self.block, self.step, self.border)?;
        Ok(State { pair, order: self.order(), found: Vec::new(), candidates: 0 })
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let block = state.pair.blocks.block(state.found.len());
        let found = self.search(state, block, &mut Task::new(self), observer);
        state.found.push(found);
        state.candidates += state.pair.window(block, self.range).count() as u64;
        Ok(if state.found.len() == state.pair.blocks.len() { Progress::Done } else { Progress::More })
    }

    fn units(&self, state: &State) -> Option<usize> {
        Some(state.pair.blocks.len())
    }

    fn place(&self, state: &State) -> Vec<Rung> {
        let block = Rung { index: state.found.len(), of: Some(state.pair.blocks.len()) };
        vec![Rung { index: 0, of: Some(1) }, block]
    }

    fn unit_at(&self, state: &State, [x, y]: [f32; 2]) -> Option<usize> {
        let (width, height) = state.pair.blocks.picture;
        let inside = |c: f32, extent: usize| (c >= -0.5 && c < extent as f32 - 0.5).then(|| c.round() as usize);
        let (column, row) = state.pair.blocks.nearest(inside(x, width)?, inside(y, height)?);
        Some(row * state.pair.blocks.counts().0 + column)
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of::<State>() + state.found.len() * size_of::<Match>()
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        matches!(event, Event::NewBest { .. }).then_some(Role::Best)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        let line = match seen.events.last() {
            None => 0,
            Some(Event::Window) => 1,
            Some(Event::Candidate { .. }) => 3,
            Some(Event::NewBest { .. }) => 5,
            Some(Event::Found(_)) => 6,
        };
        let probe = self.probe(seen);
        Step { line, sentence: probe.sentence(), readouts: probe.readouts() }
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.probe(seen).draw(scene);
    }

    fn output(&self, state: &State) -> Output {
        block_search::output(&state.pair, self.cost, &state.found, state.candidates)
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let mut state = self.start(clip, frame)?;
        let blocks = state.pair.blocks;
        let (columns, rows) = blocks.counts();
        let rows = threads.map(rows, |row| {
            let mut task = Task::new(self);
            let row = row * columns..(row + 1) * columns;
            row.map(|i| self.search(&state, blocks.block(i), &mut task, &mut ())).collect::<Vec<_>>()
        });
        state.found = rows.concat();
        state.candidates =
            (0..blocks.len()).map(|i| state.pair.window(blocks.block(i), self.range).count() as u64).sum();
        Ok(state)
    }
}

impl FullSearch {
    fn probe<'a>(&self, seen: &'a Seen<Self>) -> Probe<'a> {
        let Seen { before, events, focus, .. } = *seen;
        let index = before.found.len();
        let window = before.pair.window(before.pair.blocks.block(index), self.range);
        Probe {
            pair: &before.pair,
            cost: self.cost,
            index,
            window,
            range: self.range,
            found: &before.found,
            events,
            focus,
        }
    }
}
