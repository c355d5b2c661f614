//! What all block searches share: the pair of frames, the window, the events, and how they are told and drawn.

mod probe;
mod readouts;
mod tell;

use std::sync::Arc;

use crate::cost::{Cut, Sum};
use crate::{Block, BlockField, BlockGrid, BlockVector, Border, Clip, Error, Frame, Output, choices};

pub(crate) use probe::Probe;

choices! {
    /// How unlike two blocks are.
    pub enum Cost {
        /// Sum of absolute differences, Σ |Iₜ − Iₜ₊₁|.
        Sad = "sad" "SAD",
        /// Sum of squared differences, Σ (Iₜ − Iₜ₊₁)²; large differences weigh more.
        Ssd = "ssd" "SSD",
        /// Mean squared error: SSD divided by the number of pixels N of the block, so it chooses the same vectors.
        Mse = "mse" "MSE",
    }
}

impl Cost {
    /// What is summed.
    pub(crate) fn sum(self) -> Sum {
        match self {
            Cost::Sad => Sum::Absolute,
            Cost::Ssd | Cost::Mse => Sum::Squared,
        }
    }

    /// The cost that a sum over `block` amounts to.
    pub(crate) fn of(self, sum: u32, block: Block) -> f64 {
        match self {
            Cost::Sad | Cost::Ssd => sum.into(),
            Cost::Mse => f64::from(sum) / (block.width * block.height) as f64,
        }
    }

    pub(super) fn show(self, sum: u32, block: Block) -> String {
        match self {
            Cost::Sad | Cost::Ssd => sum.to_string(),
            Cost::Mse => format!("{:.2}", self.of(sum, block)),
        }
    }
}

choices! {
    /// What happens where the window leaves the picture.
    pub enum BorderRule {
        /// Only candidates that lie wholly inside the picture are tested: the window is cut.
        Inside = "inside" "Stay inside",
        /// The edge pixel is repeated outwards, as video coders do.
        Replicate = "replicate" "Repeat the edge",
        /// The picture is mirrored at its edge.
        Mirror = "mirror" "Mirror",
    }
}

impl BorderRule {
    /// How pixels outside are read.
    pub fn border(self) -> Border {
        match self {
            BorderRule::Inside | BorderRule::Replicate => Border::Replicate,
            BorderRule::Mirror => Border::Mirror,
        }
    }
}

/// A displacement `[u, v]` in whole px from frame t to t + 1.
pub type Displacement = [i32; 2];

/// The displacements that may be tested for a block: a rectangle, row by row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Smallest displacement, both ways.
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

    /// Column and row of a displacement.
    pub(super) fn place(&self, displacement: Displacement) -> (usize, usize) {
        ((displacement[0] - self.min[0]) as usize, (displacement[1] - self.min[1]) as usize)
    }
}

/// Which of two equally good displacements is chosen: the shorter, then the first in raster order.
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
    /// What happens at the border.
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
                "a block of {size} px does not fit into a picture of {width}×{height} px; choose a smaller block"
            )));
        }
        let step = if step == 0 { size } else { step };
        Ok(Self { current, next, blocks: BlockGrid { picture: (width, height), size, step }, rule })
    }

    /// The window of ±`range` px around `block`, cut where the border rule says so.
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

/// The pixels of one block and of all that its window reaches.
#[derive(Default)]
pub(crate) struct Patch {
    /// The block in frame t.
    pub block: Cut,
    /// The pixels under the window in frame t + 1.
    pub area: Cut,
}

impl Patch {
    /// Copies them out of the pair.
    pub fn take(&mut self, pair: &Pair, block: Block, window: Window) {
        let border = pair.rule.border();
        let size = (block.width, block.height);
        let (x, y) = (block.x as isize, block.y as isize);
        self.block.take(pair.current.luma(), (x, y), size, border);
        let reach = (size.0 + window.size.0 - 1, size.1 + window.size.1 - 1);
        let start = (x + window.min[0] as isize, y + window.min[1] as isize);
        self.area.take(pair.next.luma(), start, reach, border);
    }
}

/// What happens while a block is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The window was laid out.
    Window,
    /// A candidate was tested.
    Candidate {
        /// Its displacement.
        displacement: Displacement,
        /// The sum over the rows that were looked at.
        sum: u32,
        /// The rows that were looked at; fewer than the block has if it was given up early.
        rows: usize,
    },
    /// That candidate is the best so far.
    NewBest {
        /// The best before, if there was one.
        before: Option<Match>,
    },
    /// The block is done.
    Found(Match),
}

/// A displacement and its sum of differences.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Match {
    /// The displacement.
    pub displacement: Displacement,
    /// Sum of differences over the block.
    pub sum: u32,
}

/// The result so far of a search that found `found`, block by block.
pub(crate) fn output(pair: &Pair, cost: Cost, found: &[Match], candidates: u64) -> Output {
    let vector = |(i, found): (usize, &Match)| BlockVector {
        displacement: found.displacement.map(|c| c as f32),
        cost: cost.of(found.sum, pair.blocks.block(i)),
    };
    let mut vectors: Vec<_> = found.iter().enumerate().map(|entry| Some(vector(entry))).collect();
    vectors.resize(pair.blocks.len(), None);
    Output::Blocks(BlockField {
        blocks: pair.blocks,
        vectors,
        cost: cost.label(),
        candidates,
        border: pair.rule.border(),
    })
}
