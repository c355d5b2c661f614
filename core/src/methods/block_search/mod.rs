//! Parts shared by all block searches: frames and blocks, search window, events, explanations and marks.
//!
//! A block search is its pattern: [`BlockSearch::search`] states which displacements a [`Tester`] tests, as in the paper. The
//! tester enforces the search window, tests no candidate twice, keeps the minimum, counts, reports events, and refines the
//! minimum to sub-pixel accuracy. Ties are resolved in favour of the shorter displacement, then of raster order, so the order
//! of testing never changes a result. A blanket implementation turns every `BlockSearch` into an estimator. Predictive searches
//! read the vectors of earlier blocks ([`Neighbours`]); threads process rows with the necessary delay, so results equal those
//! of stepping. A search declares whether it may miss the global minimum (`Guarantee`), and the laws test that.

mod estimator;
mod explain;
mod neighbours;
mod pattern;
mod probe;
mod rate;
mod readouts;
mod search;
mod settings;
mod subpixel;
mod tester;
mod true_motion;
mod vocabulary;
mod whole_readouts;
mod whole_window;

use std::sync::Arc;

use crate::base::Error;
use crate::data::{Between, Clip, Frame, Interpolation};
use crate::methods::cost::Cut;
use crate::products::{Block, BlockGrid, BlockVector};
use crate::scene::{Role, Step};

pub(crate) use estimator::need;
pub(crate) use explain::percent;
pub use neighbours::Neighbours;
pub use pattern::{Pattern, Relay};
pub(crate) use probe::Probe;
pub(crate) use rate::Rate;
pub use search::BlockSearch;
pub(crate) use search::{QUESTIONS, search_pseudocode};
pub(crate) use settings::block_search_params;
pub use settings::{BorderRule, Cost, HasSettings, Matching, Refinement, Settings, Subpixel};
pub use subpixel::Fit;
pub use tester::Tester;
pub(crate) use tester::{Workspace, around};
pub(crate) use vocabulary::value;

/// A displacement `[u, v]` in whole px from frame t to t + 1.
pub type Displacement = [i32; 2];

/// The search window: the displacements that may be tested for a block, row by row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Smallest displacement along u and v.
    pub min: Displacement,
    /// Number of columns and rows.
    pub size: (usize, usize),
}

impl Window {
    /// Number of candidates.
    pub fn count(&self) -> usize {
        self.size.0 * self.size.1
    }

    /// Candidate `index`, row by row.
    #[inline(always)]
    pub fn displacement(&self, index: usize) -> Displacement {
        [self.min[0] + (index % self.size.0) as i32, self.min[1] + (index / self.size.0) as i32]
    }

    /// The index of a displacement, if it lies in the window.
    #[inline(always)]
    pub fn index(&self, [u, v]: Displacement) -> Option<usize> {
        let (column, row) = (usize::try_from(u - self.min[0]).ok()?, usize::try_from(v - self.min[1]).ok()?);
        (column < self.size.0 && row < self.size.1).then(|| row * self.size.0 + column)
    }

    /// Whether a displacement in quarters of a px lies in the window, or between its outermost columns and rows.
    pub(super) fn holds_quarters(&self, [u, v]: [i32; 2]) -> bool {
        let within = |c: i32, min: i32, size: usize| (4 * min..=4 * (min + size as i32 - 1)).contains(&c);
        within(u, self.min[0], self.size.0) && within(v, self.min[1], self.size.1)
    }

    /// Whether a displacement of the window lies at its edge.
    pub fn is_at_edge(&self, displacement: Displacement) -> bool {
        let (column, row) = self.place(displacement);
        column == 0 || row == 0 || column + 1 == self.size.0 || row + 1 == self.size.1
    }

    /// Column and row of a displacement.
    pub(super) fn place(&self, displacement: Displacement) -> (usize, usize) {
        ((displacement[0] - self.min[0]) as usize, (displacement[1] - self.min[1]) as usize)
    }
}

/// Whether `a` wins a tie of costs against `b`: the shorter displacement, then the first in raster order.
#[inline]
pub fn shorter(a: Displacement, b: Displacement) -> bool {
    let rank = |[u, v]: Displacement| (u * u + v * v, v, u);
    rank(a) < rank(b)
}

/// The two frames, and the blocks of the first.
#[derive(Clone)]
pub struct Pair {
    /// Frame t.
    pub current: Arc<Frame>,
    /// Frame t + 1.
    pub next: Arc<Frame>,
    /// The blocks of frame t.
    pub blocks: BlockGrid,
    /// The treatment of candidates beyond the border.
    pub rule: BorderRule,
}

impl Pair {
    /// Frames `frame` and `frame + 1` of `clip`, with blocks of `size` px every `step` px (0: edge to edge).
    ///
    /// # Errors
    /// If there is no such pair, or the picture is smaller than a block.
    pub fn new(clip: &Clip, frame: usize, size: usize, step: usize, rule: BorderRule) -> Result<Self, Error> {
        let [current, next] = clip.pair(frame)?;
        let (width, height) = current.size();
        if next.size() != (width, height) {
            return Err(Error::new(format!("frames {frame} and {} differ in size", frame + 1)));
        }
        if width < size || height < size {
            return Err(Error::new(format!(
                "a block of {size}×{size} px does not fit into a picture of {width}×{height} px; choose a smaller block size"
            )));
        }
        Ok(Self { current, next, blocks: grid((width, height), size, step), rule })
    }

    /// Copies `block` displaced by `displacement` out of frame t + 1, for interpolation at fractions of a pixel.
    pub(crate) fn take_between(
        &self,
        block: Block,
        [u, v]: Displacement,
        filter: Interpolation,
        between: &mut Between,
    ) {
        let corner = (block.x as isize + u as isize, block.y as isize + v as isize);
        between.take((self.next.luma(), self.rule.border()), corner, (block.width, block.height), filter);
    }

    /// The search window of ±`range` px for `block`, cut at the border by [`BorderRule::Inside`].
    pub fn window(&self, block: Block, range: usize) -> Window {
        let (width, height) = self.blocks.picture;
        let span = |start: usize, length: usize, extent: usize| match self.rule {
            BorderRule::Inside => (range.min(start), range.min(extent - start - length)),
            BorderRule::Replicate | BorderRule::Mirror => (range, range),
        };
        let (left, right) = span(block.x, block.width, width);
        let (up, down) = span(block.y, block.height, height);
        Window { min: [-(left as i32), -(up as i32)], size: (left + right + 1, up + down + 1) }
    }
}

/// The grid of blocks of `size` px every `step` px (0: edge to edge).
pub(crate) fn grid(picture: (usize, usize), size: usize, step: usize) -> BlockGrid {
    BlockGrid { picture, size, step: if step == 0 { size } else { step } }
}

/// The pixels of one block and of the area under its search window.
#[derive(Default)]
pub(crate) struct Patch {
    /// The block in frame t.
    pub block: Cut,
    /// The pixels under the window in frame t + 1.
    pub area: Cut,
}

impl Patch {
    /// Copies the block out of frame t.
    pub fn take_block(&mut self, pair: &Pair, block: Block) {
        let corner = (block.x as isize, block.y as isize);
        self.block.take(pair.current.luma(), corner, (block.width, block.height), pair.rule.border());
    }

    /// Copies the area under the block's search window out of frame t + 1.
    pub fn take_area(&mut self, pair: &Pair, block: Block, window: Window) {
        let reach = (block.width + window.size.0 - 1, block.height + window.size.1 - 1);
        let start = (block.x as isize + window.min[0] as isize, block.y as isize + window.min[1] as isize);
        self.area.take(pair.next.luma(), start, reach, pair.rule.border());
    }
}

/// An event of the search of a block.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// The search window was placed.
    Window,
    /// The search decided which candidates to test next, or to stop.
    Stage(Stage),
    /// Sub-pixel candidates, or neighbours for a parabola, are tested.
    Refine(Stage),
    /// Parabolas were fitted through the costs around the best match.
    Fit(Fit),
    /// A candidate was tested.
    Candidate {
        /// Its displacement, and the cost over the rows summed.
        tested: Match,
        /// The rows summed; fewer than the block has if it was rejected early.
        rows: usize,
    },
    /// A candidate was skipped, since a lower bound of its cost exceeds the minimum so far.
    Skipped(Skipped),
    /// That candidate has the minimum cost so far.
    NewBest {
        /// The best before, if there was one.
        before: Option<Match>,
    },
    /// The motion vector of the block was found.
    Found(Match),
}

impl Event {
    /// Whether a candidate was tested.
    pub(crate) fn is_candidate(&self) -> bool {
        matches!(self, Event::Candidate { .. })
    }

    /// The role of an event that is worth a mark on the timeline.
    pub(crate) fn landmark(&self) -> Option<Role> {
        match self {
            Event::NewBest { .. } | Event::Fit(_) => Some(Role::Best),
            Event::Stage(_) | Event::Refine(_) => Some(Role::Candidate),
            _ => None,
        }
    }
}

/// A candidate that was skipped without computing its cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Skipped {
    /// Its displacement.
    pub displacement: Displacement,
    /// The lower bound of its sum over the pixels, without the rate term.
    pub bound: u32,
    /// Side in px of the parts of the block whose sums give that bound.
    pub side: usize,
}

/// A decision of a search: the candidates that it tests next, with the reason.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// The part of the window to which the search has narrowed down, if it does so.
    pub narrowed: Option<Window>,
    /// Number of candidates in the pattern.
    pub asked: usize,
    /// The new candidates inside the search window, in px.
    pub points: Vec<[f32; 2]>,
    /// The reason, at its line of the pseudocode.
    pub reason: Box<Step>,
}

impl Stage {
    /// The stage that begins with `event`.
    fn of(event: &Event) -> Option<&Stage> {
        match event {
            Event::Stage(stage) | Event::Refine(stage) => Some(stage),
            _ => None,
        }
    }
}

/// A displacement and its cost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Match {
    /// The displacement in whole px.
    pub displacement: Displacement,
    /// The sub-pixel part in px: multiples of a quarter, or the minimum of a parabola.
    pub fraction: [f32; 2],
    /// The cost, with the rate term.
    pub cost: f64,
}

impl Match {
    /// A match at a whole-pixel displacement.
    pub fn whole(displacement: Displacement, cost: f64) -> Self {
        Self { displacement, fraction: [0.0; 2], cost }
    }

    /// The displacement `[u, v]` in px.
    pub fn vector(&self) -> [f32; 2] {
        [0, 1].map(|i| self.displacement[i] as f32 + self.fraction[i])
    }

    /// The block vector found after `candidates` tests.
    pub(crate) fn result(&self, candidates: u32) -> BlockVector {
        BlockVector { displacement: self.vector(), cost: self.cost, candidates }
    }

    /// Whether a candidate becomes the best in place of `best`: it costs less, or as much and wins the tie.
    #[inline]
    pub(crate) fn wins(&self, best: &Match) -> bool {
        self.cost < best.cost || self.cost == best.cost && shorter(self.quarters(), best.quarters())
    }

    /// The squared length of the displacement in quarters of a px.
    fn length(&self) -> i32 {
        self.quarters().iter().map(|c| c * c).sum()
    }

    /// The displacement in quarters of a px; one fitted by a parabola is rounded.
    pub(crate) fn quarters(&self) -> [i32; 2] {
        [0, 1].map(|i| 4 * self.displacement[i] + (4.0 * self.fraction[i]).round() as i32)
    }
}
