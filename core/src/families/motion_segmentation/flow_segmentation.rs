//! Flow segmentation: neighbouring pixels with similar flow, merged along a graph or grown from seeds.

mod explain;

use std::sync::Arc;

use crate::base::{Error, Observer, Threads, effort};
use crate::data::{Clip, Flow};
use crate::geometry::Grid;
use crate::methods::segmentation::explain::{case, value::SEGMENTS};
use crate::methods::segmentation::{FlowInput, Record, SegmentationRun, Segmenter, SegmenterState, forest::Forest};
use crate::products::SegmentFrame;
use crate::run::{Info, Progress, Seen};
use crate::scene::{Question, Reply, Role, Scene, Step};
use crate::{choices, params, pseudocode};

choices! {
    /// The method of the segmentation.
    pub enum Growth {
        /// Merging along the edges of a graph, the smallest difference first.
        Graph = "graph" "Graph-based merging",
        /// Regions that grow from a pixel as long as their neighbours are near the mean.
        Growing = "region-growing" "Region growing",
    }
}

params! {
    /// Segmentation of a flow into connected regions.
    pub struct FlowSegmentation {
        /// Method of the segmentation.
        method: Growth = Growth::Graph;
        /// Scale k of graph-based merging. A region of n px tolerates a difference of k / n beyond its internal one, so larger values
        /// make larger regions.
        scale: f32 = 20.0, 0.0..=10_000.0, "px²/frame";
        /// Largest difference of a pixel from the mean displacement of a growing region.
        tolerance: f32 = 0.75, 0.0..=50.0, "px/frame";
        /// Smallest area of a region, as a share of the picture. Smaller ones are merged with a neighbour.
        min_area: f32 = 0.5, 0.0..=50.0, "%";
        /// Number of frames, including the last one, which has no successor and so no segments.
        frames: usize = 2, 2..=10_000;
        /// The flow that is segmented.
        input: FlowInput = FlowInput::default();
    }
    when {
        "scale": |p| p.method == Growth::Graph, "The scale has no effect on region growing.";
        "tolerance": |p| p.method == Growth::Growing, "The tolerance has no effect on graph-based merging.";
    }
}

/// Parts into which the sorted edges are divided, each a unit.
const PARTS: usize = 24;

/// An edge between two neighbouring pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Edge {
    /// Length of the difference of their displacements in px/frame.
    weight: f32,
    ends: [u32; 2],
}

/// The flow of a frame and its edges, in ascending order of their weights.
pub struct Data {
    flow: Arc<Flow>,
    edges: Vec<Edge>,
}

/// The next unit of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Merge,
    Label,
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    record: Record,
    phase: Phase,
    /// Units of the current frame so far.
    round: usize,
    data: Option<Arc<Data>>,
    forest: Arc<Forest>,
    /// The pixels that belong to a grown region.
    taken: Arc<Vec<bool>>,
    /// The next pixel from which a region may grow.
    next: usize,
    /// Number of regions after each unit.
    counts: Vec<u32>,
}

/// A comparison of two regions across an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    weight: f32,
    areas: [u32; 2],
    /// Internal difference plus k / area of each, in px/frame.
    limits: [f32; 2],
}

/// The result of processing a part of the edges.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Part {
    /// The largest weight of its edges in px/frame.
    up_to: f32,
    merged: usize,
    refused: usize,
    regions: usize,
    /// The merge and the refusal of the largest regions.
    merge: Option<Comparison>,
    refusal: Option<Comparison>,
}

/// A region that has grown.
#[derive(Clone, Debug, PartialEq)]
pub struct Region {
    seed: usize,
    /// Its pixels in the order in which they were added.
    pixels: Vec<u32>,
    /// Its mean displacement in px/frame.
    mean: [f64; 2],
    /// Comparisons with a neighbour that was too different; a neighbour is compared from either side.
    refused: usize,
}

impl Region {
    /// Makes its pixels one region of `forest`.
    fn join(&self, forest: &mut Forest) {
        for pixel in &self.pixels[1..] {
            let root = forest.root(self.seed as u32);
            forest.join(root, *pixel, 0.0);
        }
    }
}

/// The merging of small regions.
#[derive(Clone)]
pub struct Absorbed {
    /// Number of merges; one may join two small regions.
    merges: usize,
    /// Number of regions left.
    left: usize,
    /// The regions afterwards.
    forest: Arc<Forest>,
}

/// An event of a unit.
#[derive(Clone)]
pub enum Event {
    /// The flow is there, and the edges are sorted.
    Flow(Arc<Data>),
    /// The number of edges.
    Sorted(usize),
    /// Part of the edges is gone through; the forest afterwards.
    Merged(Part, Arc<Forest>),
    /// A region has grown.
    Grown(Arc<Region>),
    /// Regions are merged because one of them is small.
    Absorbed(Absorbed),
    /// The segments of the frame.
    Labelled(Arc<SegmentFrame>),
}

impl Data {
    fn new(flow: Arc<Flow>) -> Self {
        let (width, height) = flow.0.size();
        effort::add(2 * width * height);
        let mut edges = Vec::new();
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let Some(here) = flow.at(x, y) else { continue };
            for (to_x, to_y) in [(x + 1, y), (x, y + 1)] {
                if let Some(there) = flow.at(to_x, to_y) {
                    let weight = (here[0] - there[0]).hypot(here[1] - there[1]);
                    edges.push(Edge { weight, ends: [y * width + x, to_y * width + to_x].map(|i| i as u32) });
                }
            }
        }
        // Stable: raster order decides between equal weights.
        edges.sort_by(|a, b| a.weight.total_cmp(&b.weight));
        Self { flow, edges }
    }

    fn is_known(&self, pixel: usize) -> bool {
        self.flow.0.cells()[pixel].iter().all(|c| c.is_finite())
    }

    fn bytes(&self) -> usize {
        size_of_val(self.flow.0.cells()) + size_of_val(&self.edges[..])
    }
}

impl FlowSegmentation {
    /// Processes the next part of the sorted edges.
    fn merge_part(&self, data: &Data, state: &mut State, observer: &mut impl Observer<Event>) {
        let part = state.counts.len();
        let bound = |part: usize| part * data.edges.len() / PARTS;
        let edges = &data.edges[bound(part)..bound(part + 1)];
        effort::add(edges.len());
        let forest = Arc::make_mut(&mut state.forest);
        let mut found = Part { up_to: edges.last().map_or(0.0, |edge| edge.weight), ..Part::default() };
        for Edge { weight, ends } in edges {
            let roots = ends.map(|end| forest.root(end));
            if roots[0] == roots[1] {
                continue;
            }
            let areas = roots.map(|root| forest.area(root));
            let limits = [0, 1].map(|i| forest.internal(roots[i]) + self.scale / areas[i] as f32);
            let comparison = Comparison { weight: *weight, areas, limits };
            let is_merged = *weight <= limits[0].min(limits[1]);
            let (count, example) = match is_merged {
                true => (&mut found.merged, &mut found.merge),
                false => (&mut found.refused, &mut found.refusal),
            };
            *count += 1;
            let smaller = |comparison: &Comparison| comparison.areas[0].min(comparison.areas[1]);
            if example.as_ref().is_none_or(|other| smaller(&comparison) > smaller(other)) {
                *example = Some(comparison);
            }
            if is_merged {
                forest.join(roots[0], roots[1], *weight);
            }
        }
        found.regions = forest.regions();
        observer.see(|| Event::Merged(found, Arc::clone(&state.forest)));
        state.counts.push(found.regions as u32);
        if state.counts.len() == PARTS {
            state.phase = Phase::Label;
        }
    }

    /// Grows regions from unassigned pixels in the next row that has any. A row is one unit: with a small tolerance
    /// there are as many regions as pixels.
    fn grow(&self, data: &Data, state: &mut State, observer: &mut impl Observer<Event>) {
        let free = |state: &State, from: usize| (from..state.taken.len()).find(|pixel| !state.taken[*pixel]);
        let Some(first) = free(state, state.next) else {
            // The phase ends with the last pixel.
            state.phase = Phase::Label;
            return;
        };
        let width = data.flow.0.width();
        state.next = (first / width + 1) * width;
        for seed in first..state.next {
            if !state.taken[seed] {
                let region = self.region(data, seed, Arc::<Vec<bool>>::make_mut(&mut state.taken));
                effort::add(region.pixels.len());
                region.join(Arc::make_mut(&mut state.forest));
                state.counts.push(region.pixels.len() as u32);
                observer.see(|| Event::Grown(Arc::new(region)));
            }
        }
        if free(state, state.next).is_none() {
            state.phase = Phase::Label;
        }
    }

    /// The region around a pixel: neighbours are added in the order in which they are reached.
    fn region(&self, data: &Data, seed: usize, taken: &mut [bool]) -> Region {
        let (width, height) = data.flow.0.size();
        let cells = data.flow.0.cells();
        let mut region = Region { seed, pixels: vec![seed as u32], mean: cells[seed].map(f64::from), refused: 0 };
        taken[seed] = true;
        let mut next = 0;
        while let Some(pixel) = region.pixels.get(next).map(|pixel| *pixel as usize) {
            next += 1;
            let (x, y) = (pixel % width, pixel / width);
            let around = [
                (x > 0).then(|| pixel - 1),
                (x + 1 < width).then(|| pixel + 1),
                (y > 0).then(|| pixel - width),
                (y + 1 < height).then(|| pixel + width),
            ];
            for neighbor in around.into_iter().flatten().filter(|neighbor| data.is_known(*neighbor)) {
                if taken[neighbor] {
                    continue;
                }
                let uv = cells[neighbor].map(f64::from);
                if (uv[0] - region.mean[0]).hypot(uv[1] - region.mean[1]) > f64::from(self.tolerance) {
                    region.refused += 1;
                    continue;
                }
                taken[neighbor] = true;
                region.pixels.push(neighbor as u32);
                let share = 1.0 / region.pixels.len() as f64;
                region.mean = [0, 1].map(|i| region.mean[i] + share * (uv[i] - region.mean[i]));
            }
        }
        region
    }

    /// Merges small regions, labels the pixels, and goes on to the next frame.
    fn label(&self, data: &Arc<Data>, state: &mut State, observer: &mut impl Observer<Event>) {
        let pixels = data.flow.0.cells().len();
        let least = (f64::from(self.min_area) / 100.0 * pixels as f64).ceil() as u32;
        let forest = Arc::make_mut(&mut state.forest);
        let before = forest.regions();
        for Edge { weight, ends } in &data.edges {
            let roots = ends.map(|end| forest.root(end));
            if roots[0] != roots[1] && roots.iter().any(|root| forest.area(*root) < least) {
                forest.join(roots[0], roots[1], *weight);
            }
        }
        let unknown = (0..pixels).filter(|pixel| !data.is_known(*pixel)).count();
        let (merges, left) = (before - forest.regions(), forest.regions() - unknown);
        observer.see(|| Event::Absorbed(Absorbed { merges, left, forest: Arc::clone(&state.forest) }));
        let segments = state.record.add(&data.labels(&state.forest), &data.flow, |_| None);
        observer.see(|| Event::Labelled(segments));
        *state = State::before(state.record.clone());
    }
}

impl Data {
    /// The regions of a forest as labels; 0 where the flow is unknown.
    fn labels(&self, forest: &Forest) -> Grid<u32> {
        let (width, height) = self.flow.0.size();
        let labels = forest.labels(|pixel| self.is_known(pixel));
        Grid::from_fn(width, height, |x, y| labels[y * width + x])
    }
}

impl SegmenterState for State {
    fn before(record: Record) -> Self {
        Self {
            record,
            phase: Phase::Merge,
            round: 0,
            data: None,
            forest: Arc::default(),
            taken: Arc::default(),
            next: 0,
            counts: Vec::new(),
        }
    }

    fn record(&self) -> &Record {
        &self.record
    }

    fn round(&self) -> usize {
        self.round
    }

    fn own_bytes(&self) -> usize {
        self.forest.bytes() + size_of_val(&self.taken[..]) + size_of_val(&self.counts[..])
    }

    fn shared_bytes(&self) -> usize {
        self.data.as_ref().map_or(0, |data| data.bytes())
    }
}

pseudocode! {
    EACH_FRAME: "for each frame t",
    FIND_FLOW: "  w ← flow from frame t to t+1",
    SORT: "  graph: edges ← pairs of neighbours p, q in ascending order of |w(p) − w(q)|",
    EACH_EDGE: "  for each edge between regions A ≠ B",
    MERGE: "    merge A and B if |w(p) − w(q)| ≤ min(Int(A) + k / |A|, Int(B) + k / |B|), with Int the largest edge merged",
    GROW: "  region growing: from the first pixel of no region, add neighbours with |w − mean| ≤ tolerance",
    ABSORB: "  merge regions smaller than min-area across their smallest edges",
    LABEL: "  label of a segment ← that of frame t−1 which shares the most pixels with it, moved by w",
}

impl Segmenter for FlowSegmentation {
    const INFO: Info = Info {
        id: "flow-segmentation",
        name: "Flow segmentation",
        family: "Motion segmentation",
        summary: "Divides the flow into connected regions along its jumps, by graph-based merging or by region growing.",
        source: "P. Felzenszwalb and D. Huttenlocher, Efficient graph-based image segmentation, IJCV 59(2), 2004; region growing: S. W. \
                 Zucker, Region growing: childhood and adolescence, CGIP 5(3), 1976",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "round", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::choice(
            "refused",
            "Is a merge of the next group of edges refused?",
            &[
                Reply::told(line::MERGE, explain::case::REFUSAL, "Yes: there is a jump of the flow"),
                Reply::told(line::MERGE, explain::case::MERGE, "No: all edges are merged"),
            ],
        ),
        Question::value("segments", "How many segments will the frame have?", line::LABEL, SEGMENTS)
            .unless_told(&[case::NO_SEGMENT, case::ONE_SEGMENT]),
    ];
    // Flow, edges while they are sorted, forest and labels; a checkpoint has a forest of its own.
    const BYTES_PER_PIXEL: [f64; 2] = [80.0, 110.0];
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
        let Some(data) = state.data.clone() else {
            state.record.check(clip)?;
            let data = Arc::new(Data::new(self.input.between(clip, state.record.frame(), threads)?));
            observer.see(|| Event::Flow(Arc::clone(&data)));
            if self.method == Growth::Graph {
                observer.see(|| Event::Sorted(data.edges.len()));
            }
            let count = data.flow.0.cells().len();
            state.forest = Arc::new(Forest::new(count));
            state.taken = Arc::new((0..count).map(|pixel| !data.is_known(pixel)).collect());
            state.phase = if data.edges.is_empty() { Phase::Label } else { Phase::Merge };
            state.data = Some(data);
            return Ok(Progress::More);
        };
        match (state.phase, self.method) {
            (Phase::Merge, Growth::Graph) => self.merge_part(&data, state, observer),
            (Phase::Merge, Growth::Growing) => self.grow(&data, state, observer),
            (Phase::Label, _) => {
                self.label(&data, state, observer);
                return Ok(state.record.progress(clip));
            }
        }
        Ok(Progress::More)
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        matches!(event, Event::Labelled(_)).then_some(Role::Result)
    }

    fn explanation(&self, seen: &Seen<SegmentationRun<Self>>) -> Step {
        self.explain_step(seen)
    }

    fn draw_step(&self, seen: &Seen<SegmentationRun<Self>>, scene: &mut Scene) {
        self.draw_marks(seen, scene);
    }
}
