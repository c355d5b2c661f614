//! An estimator of a kind of result that exists: the block search that never moves. Every other one must beat it.

use std::sync::Arc;

use motionscope_core::base::{Error, Observer};
use motionscope_core::data::{Clip, Frame, Interpolation};
use motionscope_core::geometry::Border;
use motionscope_core::products::{BlockField, BlockGrid, BlockVector, Output, Product, ProductKind};
use motionscope_core::run::{AnyEstimator, Estimator, Footprint, Granularity, Info, Move, Need, Progress, Seen};
use motionscope_core::scene::{Picture, Question, Role, Scene, Shape, Step, Unit};
use motionscope_core::{cases, params, pseudocode, synth, variables};

params! {
    /// Block matching without a search.
    pub struct Still {
        /// Side of a block.
        block: usize = 16, 4..=64, "px";
    }
}

pseudocode! {
    EACH_BLOCK: "for each block B of frame t",
    KEEP_ZERO: "  displacement of B ← (0, 0); its cost is the SAD there",
}

variables! {
    /// The sum of absolute differences of the block and the pixels at its place in frame t+1.
    COST: "SAD", r"\text{SAD}(0, 0)", Unit::WHOLE, Role::Result;
}

cases! { over value;
    OPENING: "The first block comes next.",
    KEPT: "The block stays where it is, at a cost of {cost}.",
}

/// All that a unit reads and writes: a run can be taken up from any copy of it.
#[derive(Clone)]
pub struct State {
    pair: [Arc<Frame>; 2],
    blocks: BlockGrid,
    costs: Vec<u64>,
}

impl Estimator for Still {
    const INFO: Info = Info {
        id: "still",
        name: "No search",
        family: "Block matching",
        summary: "Leaves every block where it is: what every search must beat.",
        source: "The zero motion vector of every video coding standard",
        pseudocode: line::ALL,
        granularities: &["frame", "block", "step"],
        frames: 2,
    };
    const PRODUCES: &'static [&'static ProductKind] = &[BlockField::KIND];
    const QUESTIONS: &'static [Question] = &[Question::value(
        "cost",
        "What does it cost to leave the next block where it is?",
        line::KEEP_ZERO,
        value::COST,
    )];
    type State = State;
    type Event = u64;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        let pair = clip.pair(frame)?;
        let blocks = BlockGrid { picture: clip.size(), size: self.block, step: self.block };
        Ok(State { pair, blocks, costs: Vec::new() })
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<u64>) -> Result<Progress, Error> {
        let block = state.blocks.block(state.costs.len());
        let [current, next] = state.pair.each_ref().map(|frame| frame.luma());
        let row = |y| (block.x..block.x + block.width).map(move |x| (x, y));
        let pixels = (block.y..block.y + block.height).flat_map(row);
        let sad = pixels.map(|place| u64::from(current[place].abs_diff(next[place]))).sum();
        // The only place that tells of it: `()` sees nothing, and costs nothing.
        observer.see(|| sad);
        state.costs.push(sad);
        Ok(if state.costs.len() < state.blocks.len() { Progress::More } else { Progress::Done })
    }

    fn units(&self, state: &State) -> Option<usize> {
        Some(state.blocks.len())
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        vec![
            Granularity { index: 0, of: Some(1) },
            Granularity { index: state.costs.len(), of: Some(state.blocks.len()) },
        ]
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        match seen.events.last() {
            None => Step::at(line::EACH_BLOCK).say(case::OPENING),
            Some(sad) => Step::at(line::KEEP_ZERO)
                .fact(value::COST, *sad)
                .say(case::KEPT)
                .formula(r"\text{SAD}(0, 0) = \sum_{x, y} |I_t(x, y) - I_{t+1}(x, y)| = {cost}"),
        }
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let block = seen.before.blocks.block(seen.before.costs.len());
        let shape = Shape::pixels(block.x as i32, block.y as i32, block.width, block.height);
        scene.draw(Picture::CURRENT, (Role::Reference, "block"), shape);
    }

    fn output(&self, state: &State) -> Output {
        let vector = |sad: &u64| Some(BlockVector { displacement: [0.0; 2], cost: *sad as f64, candidates: 1 });
        let mut vectors: Vec<_> = state.costs.iter().map(vector).collect();
        vectors.resize(state.blocks.len(), None);
        let (border, filter) = (Border::Replicate, Interpolation::Bilinear);
        Output::of(BlockField { blocks: state.blocks, vectors, cost: "SAD", border, filter })
    }
}

impl Footprint<State> for Still {
    fn need(&self, clip: &Clip) -> Need {
        // Bytes for each pixel: of a run, and of one that is walked through.
        Need::per_pixel(clip, [1.0, 1.0])
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of_val(&state.costs[..])
    }
}

fn main() -> Result<(), Error> {
    let sample = synth::scene("pillar")?;
    let clip = synth::make(sample.id, &sample.difficulty())?;
    let mut walk = AnyEstimator::walk(&Still::default(), &clip, 0)?;
    walk.jump(Move::To("7.1".parse()?));
    println!("{}", walk.step(None).sentence.plain());
    Ok(())
}
