//! Motion layers: affine motions of blocks, clustered, assigned to pixels, split and merged until they are stable.

mod explain;
mod vocabulary;

use std::sync::Arc;

use crate::base::{Error, Observer, Threads};
use crate::data::{Clip, Connectivity, Flow, Labelling, Mask};
use crate::geometry::Grid;
use crate::methods::segmentation::affine::{self, Frame, Moments};
use crate::methods::segmentation::kmeans::Clustering;
use crate::methods::segmentation::{FlowInput, Place, Points, Record, SegmentationRun, Segmenter, SegmenterState};
use crate::products::SegmentFrame;
use crate::run::{Info, Progress, Seen};
use crate::scene::{Question, Reply, Role, Scene, Step};
use crate::{params, pseudocode};
use vocabulary::{case, value};

params! {
    /// Layers of affine motion.
    pub struct MotionLayers {
        /// Side of the blocks. Their affine motions are the first hypotheses.
        block_size: usize = 20, 4..=128, "px";
        /// Largest root mean squared residual of the affine motion of a block. Blocks above it lie across a motion boundary.
        max_residual: f32 = 0.3, 0.01..=20.0, "px/frame";
        /// Number of clusters of the affine motions of blocks: the largest number of layers to begin with.
        clusters: usize = 8, 1..=32;
        /// Root mean squared difference of the motions of two layers over their pixels below which both are merged.
        merge_below: f32 = 0.5, 0.0..=20.0, "px/frame";
        /// Largest residual with which a pixel belongs to a layer. Connected pixels above it become a new layer.
        tolerance: f32 = 1.0, 0.05..=50.0, "px/frame";
        /// Smallest area of a layer, as a share of the picture.
        min_area: f32 = 1.0, 0.0..=50.0, "%";
        /// Number of iterations, at most.
        iterations: usize = 20, 1..=100;
        /// Seed of the random numbers of k-means++.
        seed: usize = 1, 0..=9999;
        /// Number of frames, including the last one, which has no successor and so no layers.
        frames: usize = 2, 2..=10_000;
        /// The flow that is segmented.
        input: FlowInput = FlowInput::default();
    }
    advanced { "iterations", "seed" }
}

/// Share of the pixels that may change their layer in the last iteration.
const FEW_CHANGES: f64 = 0.001;

/// An affine motion with the pixels that it was fitted to.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    motion: Place,
    moments: Moments,
}

/// A block with its affine motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Its first pixel and its size in px.
    at: (usize, usize),
    size: (usize, usize),
    motion: Place,
    /// Root mean squared residual in px/frame.
    residual: f64,
    /// Whether it is a hypothesis.
    is_kept: bool,
}

/// The result of an iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Note {
    layers: usize,
    /// Share of the pixels of no layer.
    unexplained: f64,
}

/// The next unit of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Blocks,
    Clusters,
    Iterate,
    Label,
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    record: Record,
    phase: Phase,
    /// Units of the current frame so far.
    round: usize,
    flow: Option<Arc<Flow>>,
    blocks: Arc<Vec<Block>>,
    layers: Vec<Layer>,
    /// The layer of each pixel, counted from 1; 0 for none.
    labels: Arc<Grid<u32>>,
    notes: Vec<Note>,
}

/// An event of a unit.
#[derive(Clone)]
pub enum Event {
    /// The flow is there.
    Flow(Arc<Flow>),
    /// The affine motion of a block is fitted.
    Fitted(Block),
    /// The motions of the blocks are clustered: the mean motions, and the cluster of each hypothesis.
    Clustered(Arc<Clustering>),
    /// Two layers are merged; their difference in px/frame.
    Merged { kept: usize, gone: usize, difference: f64 },
    /// A layer of few pixels is removed.
    Removed { index: usize, area: usize },
    /// Each pixel goes to the layer of smallest residual; numbers of changes and of pixels without a layer.
    Assigned { labels: Arc<Grid<u32>>, changed: usize, unexplained: usize },
    /// Connected pixels of no layer become one, with this index.
    Split { index: usize, layer: Layer, labels: Arc<Grid<u32>> },
    /// The motion of a layer is refitted; its old motion.
    Refitted { index: usize, from: Place, layer: Layer },
    /// The segments of the frame, and the motions of the layers.
    Labelled(Arc<SegmentFrame>),
}

impl MotionLayers {
    /// Fits the affine motions of all blocks.
    fn fit_blocks(
        &self,
        (clip, threads): (&Clip, &Threads),
        state: &mut State,
        observer: &mut impl Observer<Event>,
    ) -> Result<(), Error> {
        state.record.check(clip)?;
        let flow = self.input.between(clip, state.record.frame(), threads)?;
        observer.see(|| Event::Flow(Arc::clone(&flow)));
        let (frame, (width, height)) = (Frame::of(flow.0.size()), flow.0.size());
        let starts = |extent: usize| (0..extent).step_by(self.block_size);
        let mut blocks = Vec::new();
        for (x, y) in starts(height).flat_map(|y| starts(width).map(move |x| (x, y))) {
            let (right, bottom) = ((x + self.block_size).min(width), (y + self.block_size).min(height));
            let moments = Moments::of_block(&flow, &frame, [x..right, y..bottom]);
            let Some(motion) = moments.fit() else { continue };
            let residual = moments.residual(&motion);
            let is_kept = residual <= f64::from(self.max_residual);
            let block = Block { at: (x, y), size: (right - x, bottom - y), motion, residual, is_kept };
            observer.see(|| Event::Fitted(block));
            blocks.push(block);
        }
        state.labels = Arc::new(Grid::new(width, height, 0));
        state.phase = if blocks.is_empty() { Phase::Label } else { Phase::Clusters };
        (state.blocks, state.flow) = (Arc::new(blocks), Some(flow));
        Ok(())
    }

    /// Clusters the motions of the blocks that are hypotheses, and assigns the pixels for the first time.
    fn cluster(&self, flow: &Flow, threads: &Threads, state: &mut State, observer: &mut impl Observer<Event>) {
        let motions = hypotheses(&state.blocks);
        let coordinate = |i: usize| motions.iter().map(|motion| motion[i]).collect();
        let points = Points::new((0..6).map(coordinate).collect());
        let found = Arc::new(Clustering::of(&points, self.clusters, self.seed));
        observer.see(|| Event::Clustered(Arc::clone(&found)));
        state.layers =
            found.means.iter().map(|motion| Layer { motion: *motion, moments: Moments::default() }).collect();
        self.assign(flow, threads, state, observer);
        self.refit(flow, threads, state, observer);
        state.phase = Phase::Iterate;
    }

    /// Merges, removes, assigns, splits and fits once.
    fn iterate(&self, flow: &Flow, threads: &Threads, state: &mut State, observer: &mut impl Observer<Event>) {
        let is_merged = self.merge(state, observer);
        let is_removed = self.remove(state, observer);
        let changed = self.assign(flow, threads, state, observer);
        let is_split = self.split(flow, state, observer);
        self.refit(flow, threads, state, observer);
        let pixels = state.labels.cells().len() as f64;
        let is_stable = !is_merged && !is_removed && !is_split && changed as f64 <= FEW_CHANGES * pixels;
        if is_stable || state.notes.len() >= self.iterations {
            state.phase = Phase::Label;
        }
    }

    /// Merges layers of similar motion; returns whether there were any.
    fn merge(&self, state: &mut State, observer: &mut impl Observer<Event>) -> bool {
        let mut is_merged = false;
        while let Some((kept, gone, difference)) = most_similar(&state.layers) {
            if difference >= f64::from(self.merge_below) {
                break;
            }
            let moments = state.layers[kept].moments.and(&state.layers[gone].moments);
            let motion = moments.fit().unwrap_or(state.layers[kept].motion);
            state.layers[kept] = Layer { motion, moments };
            state.layers.remove(gone);
            observer.see(|| Event::Merged { kept, gone, difference });
            is_merged = true;
        }
        is_merged
    }

    /// Smallest number of pixels of a layer in a picture of this many.
    fn least_area(&self, pixels: usize) -> usize {
        (f64::from(self.min_area) / 100.0 * pixels as f64).ceil() as usize
    }

    /// Removes layers of few pixels, but not the last one; returns whether there were any.
    fn remove(&self, state: &mut State, observer: &mut impl Observer<Event>) -> bool {
        let least = self.least_area(state.labels.cells().len());
        let mut is_removed = false;
        while state.layers.len() > 1 {
            let smallest = (0..state.layers.len()).min_by_key(|index| state.layers[*index].moments.count);
            let small = smallest.filter(|index| state.layers[*index].moments.count < least.max(1));
            let Some(index) = small else { break };
            let area = state.layers.remove(index).moments.count;
            observer.see(|| Event::Removed { index, area });
            is_removed = true;
        }
        is_removed
    }

    /// Assigns each pixel to the layer of smallest residual; returns the number of changes.
    fn assign(&self, flow: &Flow, threads: &Threads, state: &mut State, observer: &mut impl Observer<Event>) -> usize {
        let motions: Vec<Place> = state.layers.iter().map(|layer| layer.motion).collect();
        let frame = Frame::of(flow.0.size());
        let labels = Arc::new(affine::assign((flow, &frame), &motions, self.tolerance, threads));
        let changed = labels.cells().iter().zip(state.labels.cells()).filter(|(new, old)| new != old).count();
        let unexplained = labels.cells().iter().filter(|label| **label == 0).count();
        observer.see(|| Event::Assigned { labels: Arc::clone(&labels), changed, unexplained });
        let share = unexplained as f64 / labels.cells().len() as f64;
        state.notes.push(Note { layers: motions.len(), unexplained: share });
        state.labels = labels;
        changed
    }

    /// Makes the largest connected region of no layer a layer, if it is large enough; returns whether it is.
    fn split(&self, flow: &Flow, state: &mut State, observer: &mut impl Observer<Event>) -> bool {
        let (width, height) = state.labels.size();
        let is_free = |x, y| state.labels[(x, y)] == 0 && flow.at(x, y).is_some();
        let labelling = Labelling::of(&Mask::from_fn(width, height, is_free), Connectivity::Four);
        let regions = labelling.finals().grid(&labelling, (width, height));
        let most = regions.cells().iter().copied().max().unwrap_or(0) as usize;
        let mut areas = vec![0usize; most + 1];
        regions.cells().iter().for_each(|region| areas[*region as usize] += 1);
        // The first of several.
        let Some(largest) = (1..=most).rev().max_by_key(|region| areas[*region]) else { return false };
        if areas[largest] < self.least_area(width * height).max(1) {
            return false;
        }
        let index = state.layers.len();
        let label = index as u32 + 1;
        let labels = Arc::make_mut(&mut state.labels);
        let own = regions.cells().iter().zip(labels.cells_mut()).filter(|(region, _)| **region as usize == largest);
        own.for_each(|(_, cell)| *cell = label);
        let frame = Frame::of((width, height));
        let only = labels.map(|other| u32::from(*other == label));
        let moments = affine::moments_of_labels((flow, &frame), &only, 1, &Threads::single()).swap_remove(0);
        let Some(motion) = moments.fit() else { return false };
        let layer = Layer { motion, moments };
        state.layers.push(layer.clone());
        observer.see(|| Event::Split { index, layer, labels: Arc::clone(&state.labels) });
        true
    }

    /// Fits the motion of each layer to its pixels.
    fn refit(&self, flow: &Flow, threads: &Threads, state: &mut State, observer: &mut impl Observer<Event>) {
        let frame = Frame::of(flow.0.size());
        let all = affine::moments_of_labels((flow, &frame), &state.labels, state.layers.len(), threads);
        for ((index, layer), moments) in state.layers.iter_mut().enumerate().zip(all) {
            let from = layer.motion;
            *layer = Layer { motion: moments.fit().unwrap_or(from), moments };
            observer.see(|| Event::Refitted { index, from, layer: layer.clone() });
        }
    }

    /// Assigns a layer to every pixel of known flow, and goes on to the next frame.
    fn label(&self, flow: &Arc<Flow>, threads: &Threads, state: &mut State, observer: &mut impl Observer<Event>) {
        let frame = Frame::of(flow.0.size());
        let motions: Vec<Place> = state.layers.iter().map(|layer| layer.motion).collect();
        let labels = affine::assign((flow, &frame), &motions, f32::INFINITY, threads);
        let affine = |label: u32| motions.get((label as usize).checked_sub(1)?).map(|motion| frame.in_pixels(motion));
        let segments = state.record.add(&labels, flow, affine);
        observer.see(|| Event::Labelled(segments));
        *state = State::before(state.record.clone());
    }
}

/// The motions of the blocks that are hypotheses, or of all blocks if there are none.
fn hypotheses(blocks: &[Block]) -> Vec<Place> {
    let has_any = blocks.iter().any(|block| block.is_kept);
    blocks.iter().filter(|block| block.is_kept || !has_any).map(|block| block.motion).collect()
}

/// The two layers whose motions differ least over their pixels, and that difference in px/frame.
fn most_similar(layers: &[Layer]) -> Option<(usize, usize, f64)> {
    let pairs = (0..layers.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
    let difference = |(a, b): (usize, usize)| {
        let both = layers[a].moments.and(&layers[b].moments);
        (a, b, both.difference(&layers[a].motion, &layers[b].motion))
    };
    pairs.map(difference).min_by(|a, b| a.2.total_cmp(&b.2))
}

impl SegmenterState for State {
    fn before(record: Record) -> Self {
        Self {
            record,
            phase: Phase::Blocks,
            round: 0,
            flow: None,
            blocks: Arc::default(),
            layers: Vec::new(),
            labels: Arc::new(Grid::new(1, 1, 0)),
            notes: Vec::new(),
        }
    }

    fn record(&self) -> &Record {
        &self.record
    }

    fn round(&self) -> usize {
        self.round
    }

    fn own_bytes(&self) -> usize {
        size_of_val(&self.layers[..]) + size_of_val(&self.notes[..]) + size_of_val(self.labels.cells())
    }

    fn shared_bytes(&self) -> usize {
        size_of_val(&self.blocks[..]) + self.flow.as_ref().map_or(0, |flow| size_of_val(flow.0.cells()))
    }
}

pseudocode! {
    EACH_FRAME: "for each frame t",
    FIND_FLOW: "  w ← flow from frame t to t+1",
    FIT_BLOCK: "  of each block: affine motion A of least squared residual; a hypothesis if its residual ≤ max-residual",
    CLUSTER: "  layers ← k-means of the hypotheses, by their mean squared difference over the picture",
    REPEAT: "  repeat until the layers hold",
    MERGE: "    merge layers with motions that differ by less than merge-below over their pixels",
    REMOVE: "    remove layers with less than min-area of the picture",
    ASSIGN: "    layer of each pixel ← smallest |w − A x|, none if that exceeds the tolerance",
    SPLIT: "    split: the largest connected region of no layer becomes a layer",
    REFIT: "    A of each layer ← affine motion of least squared residual over its pixels",
    LABEL: "  segments ← nearest layers; the motion of the most pixels is dominant; labels as in frame t−1",
}

impl Segmenter for MotionLayers {
    const INFO: Info = Info {
        id: "motion-layers",
        name: "Motion layers",
        family: "Motion segmentation",
        summary: "Describes the flow by a few affine motions: those of blocks, clustered, assigned to pixels, split and merged until they hold.",
        source: "J. Wang and E. Adelson, Representing moving images with layers, IEEE Trans. Image Processing 3(5), 1994",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "round", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::choice(
            "hypothesis",
            "Is the affine motion of the next block a hypothesis?",
            &[
                Reply::told(line::FIT_BLOCK, case::HYPOTHESIS, "Yes: one affine motion fits the block"),
                Reply::told(line::FIT_BLOCK, case::ACROSS, "No: the block lies across a motion boundary"),
            ],
        ),
        Question::value("changes", "How many pixels change their layer?", line::ASSIGN, value::CHANGES),
    ];
    // Flow, labels, connected regions; each event of a unit may hold labels of its own.
    const BYTES_PER_PIXEL: [f64; 2] = [36.0, 56.0];
    type State = State;
    type Event = Event;

    fn input(&self) -> &FlowInput {
        &self.input
    }

    fn frames(&self) -> usize {
        self.frames
    }

    fn work(
        &self,
        (clip, threads): (&Clip, &Threads),
        state: &mut State,
        observer: &mut impl Observer<Event>,
    ) -> Result<Progress, Error> {
        clip.wanted()?;
        state.round += 1;
        let Some(flow) = state.flow.clone() else {
            self.fit_blocks((clip, threads), state, observer)?;
            return Ok(Progress::More);
        };
        match state.phase {
            Phase::Blocks | Phase::Clusters => self.cluster(&flow, threads, state, observer),
            Phase::Iterate => self.iterate(&flow, threads, state, observer),
            Phase::Label => {
                self.label(&flow, threads, state, observer);
                return Ok(state.record.progress(clip));
            }
        }
        Ok(Progress::More)
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        match event {
            Event::Labelled(_) => Some(Role::Result),
            Event::Merged { .. } | Event::Split { .. } => Some(Role::Best),
            _ => None,
        }
    }

    fn explanation(&self, seen: &Seen<SegmentationRun<Self>>) -> Step {
        self.explain_step(seen)
    }

    fn draw_step(&self, seen: &Seen<SegmentationRun<Self>>, scene: &mut Scene) {
        self.draw_marks(seen, scene);
    }
}
