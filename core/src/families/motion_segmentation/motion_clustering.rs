//! Motion clustering: pixels grouped by their displacements, by k-means, a mixture of Gaussians or mean shift.

mod charts;
mod explain;
mod marks;
mod view;
mod vocabulary;

use std::sync::Arc;

use crate::base::{Error, Observer, Threads};
use crate::data::{Clip, Flow};
use crate::geometry::Grid;
use crate::methods::segmentation::explain::{case, value::SEGMENTS};
use crate::methods::segmentation::{
    FlowInput, Place, Points, Record, SegmentationRun, Segmenter, SegmenterState, kmeans,
    kmeans::Trial,
    mixture::{self, Component},
    seeds::{Seed, Seeds},
    shift::{self, Density, Mode},
};
use crate::products::SegmentFrame;
use crate::run::{Info, Progress, Seen};
use crate::scene::{Question, Role, Scene, Step};
use crate::{choices, params, pseudocode};

choices! {
    /// The method of the clustering.
    pub enum Method {
        /// Means and nearest pixels in turn: clusters of equal size and round shape.
        KMeans = "k-means" "k-means",
        /// Weighted Gaussians with soft responsibilities: clusters of any size and elliptic shape.
        GaussianMixture = "gaussian-mixture" "Gaussian mixture",
        /// Ascent to the modes of the density: the number of clusters follows from the bandwidth.
        MeanShift = "mean-shift" "Mean shift",
    }
}

choices! {
    /// The coordinates of a pixel.
    pub enum Features {
        /// Its displacement (u, v).
        Displacement = "displacement" "Displacement (u, v)",
        /// Its position, weighted, and its displacement (x, y, u, v).
        PositionAndDisplacement = "position-and-displacement" "Position and displacement (x, y, u, v)",
    }
}

choices! {
    /// The choice of the number of clusters.
    pub enum Selection {
        /// The number that is set.
        Given = "given" "Given",
        /// The number with the largest mean silhouette, from 2 up to the number that is set.
        Silhouette = "silhouette" "Largest silhouette",
    }
}

params! {
    /// Clustering of pixels by their displacements.
    pub struct MotionClustering {
        /// Method of the clustering.
        method: Method = Method::KMeans;
        /// Number of clusters k; with the silhouette, the largest that is tried.
        clusters: usize = 3, 1..=16;
        /// Choice of the number of clusters.
        selection: Selection = Selection::Given;
        /// Coordinates of a pixel. With the position, clusters are compact in the picture, and a large object may be split.
        features: Features = Features::Displacement;
        /// Weight of the position: displacement that counts as much as a distance of 1 px in the picture.
        position_weight: f32 = 0.02, 0.0..=1.0, "1/frame";
        /// Radius of the window of mean shift. Motions closer than that become one cluster.
        bandwidth: f32 = 0.75, 0.05..=50.0, "px/frame";
        /// Number of iterations, at most; of mean shift, for each start.
        iterations: usize = 30, 1..=200;
        /// Seed of the random numbers of k-means++. Another seed may lead to another local minimum.
        seed: usize = 1, 0..=9999;
        /// Number of frames, including the last one, which has no successor and so no segments.
        frames: usize = 2, 2..=10_000;
        /// The flow that is segmented.
        input: FlowInput = FlowInput::default();
    }
    advanced { "position-weight", "iterations", "seed" }
    when {
        "clusters": |p| p.method != Method::MeanShift, "The number has no effect on mean shift, where it follows from the bandwidth.";
        "selection": |p| p.method != Method::MeanShift, "The choice has no effect on mean shift, where the number follows from the bandwidth.";
        "seed": |p| p.method != Method::MeanShift, "The seed has no effect on mean shift, which draws no random numbers.";
        "bandwidth": |p| p.method == Method::MeanShift, "The bandwidth has no effect unless the method is mean shift.";
        "position-weight": |p| p.features == Features::PositionAndDisplacement,
            "The weight has no effect on displacements alone.";
    }
}

/// Rise of the log-likelihood per pixel below which expectation maximisation has converged.
const LEAST_RISE: f64 = 1e-4;

/// Whether expectation maximisation has converged with this log-likelihood per pixel.
fn has_converged(before: Option<&f64>, likelihood: f64) -> bool {
    before.is_some_and(|before| likelihood - before < LEAST_RISE)
}

/// The points of a frame.
pub struct Data {
    flow: Arc<Flow>,
    points: Points,
    /// The index of the pixel of each point.
    pixels: Vec<u32>,
}

/// The next unit of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Begin,
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
    data: Option<Arc<Data>>,
    means: Vec<Place>,
    components: Vec<Component>,
    density: Arc<Density>,
    modes: Vec<Mode>,
    /// The cluster of each point.
    nearest: Arc<Vec<u8>>,
    /// The objective after each iteration of the frame.
    progress: Vec<f64>,
}

/// An event of a unit.
#[derive(Clone)]
pub enum Event {
    /// The flow is there.
    Flow(Arc<Data>),
    /// Numbers of clusters are compared; the one that is chosen.
    Compared(Arc<Vec<Trial>>, usize),
    /// A seed is drawn.
    Seeded(usize, Seed),
    /// All points coincide with these seeds.
    Exhausted(usize),
    /// The points are sampled for mean shift; the number of starts.
    Sampled(Arc<Density>),
    /// Each point goes to its nearest mean; the number of changes, and the mean squared distance.
    Assigned(Arc<Vec<u8>>, usize, f64),
    /// A mean moves to the average of its points.
    Averaged { index: usize, from: Place, to: Place, count: usize },
    /// Responsibilities; number of changes and log-likelihood per pixel.
    Expected(Arc<Vec<u8>>, usize, f64),
    /// A component is refitted.
    Maximized(usize, Arc<Component>),
    /// A window shifts.
    Shifted(Place, Mode),
    /// A window has converged to a mode; its index, and whether it is new.
    Found(Mode, usize, bool),
    /// The modes with enough support.
    Kept(Vec<Place>),
    /// The segments of the frame.
    Labelled(Arc<SegmentFrame>),
}

impl MotionClustering {
    /// The coordinates of the pixels of known flow.
    fn data(&self, flow: Arc<Flow>) -> Data {
        let (width, _) = flow.0.size();
        let (mut pixels, mut u, mut v) = (Vec::new(), Vec::new(), Vec::new());
        for (i, [a, b]) in flow.0.cells().iter().enumerate().filter(|(_, uv)| uv.iter().all(|c| c.is_finite())) {
            pixels.push(i as u32);
            u.push(*a);
            v.push(*b);
        }
        let position = |of: &dyn Fn(usize) -> usize| -> Vec<f32> {
            pixels.iter().map(|i| self.position_weight * of(*i as usize) as f32).collect()
        };
        let coordinates = match self.features {
            Features::Displacement => vec![u, v],
            Features::PositionAndDisplacement => {
                vec![position(&|i| i % width), position(&|i| i / width), u, v]
            }
        };
        Data { points: Points::new(coordinates), pixels, flow }
    }

    /// The coordinate of the points that is u.
    fn first_displacement(&self) -> usize {
        match self.features {
            Features::Displacement => 0,
            Features::PositionAndDisplacement => 2,
        }
    }

    /// Finds the flow of the next frame and the starts of the clustering.
    fn begin(
        &self,
        (clip, threads): (&Clip, &Threads),
        state: &mut State,
        observer: &mut impl Observer<Event>,
    ) -> Result<(), Error> {
        state.record.check(clip)?;
        let flow = self.input.between(clip, state.record.frame(), threads)?;
        let data = Arc::new(self.data(flow));
        observer.see(|| Event::Flow(Arc::clone(&data)));
        // No cluster yet: the first assignment changes all labels.
        state.nearest = Arc::new(vec![u8::MAX; data.points.len()]);
        match self.method {
            Method::KMeans | Method::GaussianMixture => self.seed((&data, threads), state, observer),
            Method::MeanShift => {
                state.density = Arc::new(Density::new(&data.points));
                observer.see(|| Event::Sampled(Arc::clone(&state.density)));
            }
        }
        state.phase = if data.pixels.is_empty() { Phase::Label } else { Phase::Iterate };
        state.data = Some(data);
        Ok(())
    }

    fn seed(&self, (data, threads): (&Data, &Threads), state: &mut State, observer: &mut impl Observer<Event>) {
        let mut count = self.clusters;
        if self.selection == Selection::Silhouette {
            let trials = Arc::new(kmeans::trials(&data.points, self.clusters, self.seed));
            count = kmeans::best(&trials).map_or(1, |trial| trial.clusters);
            observer.see(|| Event::Compared(trials, count));
        }
        let mut seeds = Seeds::new(&data.points, count, self.seed);
        for index in 0..count {
            let Some(seed) = seeds.next(&data.points) else {
                observer.see(|| Event::Exhausted(index));
                break;
            };
            observer.see(|| Event::Seeded(index, seed));
            state.means.push(seed.place);
        }
        if self.method == Method::GaussianMixture && !state.means.is_empty() {
            let nearest = Arc::make_mut(&mut state.nearest);
            data.points.assign(&state.means, nearest, threads);
            state.components = mixture::initial(&data.points, &state.means, nearest);
        }
    }

    /// One iteration of k-means; returns whether it is the last.
    fn k_means(&self, data: &Data, threads: &Threads, state: &mut State, observer: &mut impl Observer<Event>) -> bool {
        let tally = data.points.assign(&state.means, Arc::<Vec<u8>>::make_mut(&mut state.nearest), threads);
        let within = tally.inertia / data.points.len() as f64;
        observer.see(|| Event::Assigned(Arc::clone(&state.nearest), tally.changed, within));
        state.progress.push(within);
        if tally.changed == 0 || state.progress.len() >= self.iterations {
            return true;
        }
        for (index, mean) in state.means.iter_mut().enumerate() {
            let (from, count) = (*mean, tally.counts[index]);
            let to = tally.mean(index).unwrap_or(from);
            observer.see(|| Event::Averaged { index, from, to, count });
            *mean = to;
        }
        false
    }

    /// One iteration of expectation maximisation; returns whether it is the last.
    fn maximize(&self, data: &Data, threads: &Threads, state: &mut State, observer: &mut impl Observer<Event>) -> bool {
        let nearest = Arc::make_mut(&mut state.nearest);
        let expected = mixture::expect(&data.points, &state.components, nearest, threads);
        let likelihood = expected.log_likelihood / data.points.len() as f64;
        observer.see(|| Event::Expected(Arc::clone(&state.nearest), expected.changed, likelihood));
        let is_over = has_converged(state.progress.last(), likelihood);
        state.progress.push(likelihood);
        if is_over || state.progress.len() >= self.iterations {
            return true;
        }
        for (index, component) in state.components.iter_mut().enumerate() {
            *component = expected.maximized(index, component, &data.points);
            observer.see(|| Event::Maximized(index, Arc::new(component.clone())));
        }
        false
    }

    /// The ascent from one start; returns whether it is the last.
    fn ascend(&self, state: &mut State, observer: &mut impl Observer<Event>) -> bool {
        let start = state.progress.len();
        let mut at = state.density.starts[start];
        let mut mode = Mode { place: at, support: 0 };
        for _ in 0..self.iterations {
            mode = state.density.shifted(&at, self.bandwidth);
            observer.see(|| Event::Shifted(at, mode));
            if shift::has_converged(&at, &mode.place) {
                break;
            }
            at = mode.place;
        }
        let (index, is_new) = shift::merge(&mut state.modes, mode, self.bandwidth);
        observer.see(|| Event::Found(mode, index, is_new));
        state.progress.push(mode.support as f64 / state.density.len() as f64);
        state.progress.len() == state.density.starts.len()
    }

    /// Labels the pixels, and goes on to the next frame.
    fn label(&self, (data, threads): (&Data, &Threads), state: &mut State, observer: &mut impl Observer<Event>) {
        if self.method == Method::MeanShift && !data.pixels.is_empty() {
            state.means = shift::supported(&state.modes, state.density.len());
            observer.see(|| Event::Kept(state.means.clone()));
            data.points.assign(&state.means, Arc::<Vec<u8>>::make_mut(&mut state.nearest), threads);
        }
        let labels = data.labels(&state.nearest);
        let frame = state.record.add(&labels, &data.flow, |_| None);
        observer.see(|| Event::Labelled(frame));
        *state = State::before(state.record.clone());
    }
}

impl Data {
    /// The cluster of each pixel, counted from 1; 0 where the flow is unknown.
    fn labels(&self, nearest: &[u8]) -> Grid<u32> {
        let (width, height) = self.flow.0.size();
        let mut labels = Grid::new(width, height, 0);
        let cells = labels.cells_mut();
        self.pixels.iter().zip(nearest).for_each(|(pixel, index)| cells[*pixel as usize] = u32::from(*index) + 1);
        labels
    }

    /// The point of a pixel, if its flow is known.
    fn point_of(&self, (x, y): (usize, usize)) -> Option<usize> {
        self.pixels.binary_search(&((y * self.flow.0.width() + x) as u32)).ok()
    }

    fn bytes(&self) -> usize {
        self.points.bytes() + size_of_val(&self.pixels[..]) + size_of_val(self.flow.0.cells())
    }
}

impl SegmenterState for State {
    fn before(record: Record) -> Self {
        Self {
            record,
            phase: Phase::Begin,
            round: 0,
            data: None,
            means: Vec::new(),
            components: Vec::new(),
            density: Arc::default(),
            modes: Vec::new(),
            nearest: Arc::default(),
            progress: Vec::new(),
        }
    }

    fn record(&self) -> &Record {
        &self.record
    }

    fn round(&self) -> usize {
        self.round
    }

    fn own_bytes(&self) -> usize {
        size_of_val(&self.means[..])
            + size_of_val(&self.modes[..])
            + size_of_val(&self.progress[..])
            + size_of_val(&self.components[..])
            + size_of_val(&self.nearest[..])
    }

    fn shared_bytes(&self) -> usize {
        self.density.bytes() + self.data.as_ref().map_or(0, |data| data.bytes())
    }
}

pseudocode! {
    EACH_FRAME: "for each frame t",
    FIND_FLOW: "  w ← flow from frame t to t+1; point of a pixel ← (u, v), or (s x, s y, u, v) with weight s",
    CHOOSE_NUMBER: "  if k is chosen by the silhouette: k ← number of clusters of largest mean silhouette",
    PICK_SEED: "  k-means++: next seed ← point drawn with a probability in proportion to d², its squared distance to the nearest seed",
    EACH_ITERATION: "  k-means: repeat until no pixel changes its cluster",
    ASSIGN: "    cluster of each pixel ← nearest mean",
    UPDATE_MEAN: "    each mean ← average of its pixels",
    EACH_EXPECTATION: "  Gaussian mixture: repeat until the log-likelihood no longer rises",
    EXPECT: "    r(j) ← w(j) N(x; μ(j), Σ(j)) / Σ w N(x; μ, Σ) of each pixel",
    MAXIMIZE: "    w(j), μ(j), Σ(j) ← share, mean and covariance of the pixels, weighted by r(j)",
    EACH_START: "  mean shift: for each start of a sample of the pixels",
    SAMPLE: "    start at a pixel of the sample",
    SHIFT: "    repeat x ← mean of the sample within the bandwidth of x, until x stays",
    MERGE: "    mode ← x; modes within the bandwidth of each other are one",
    KEEP_MODES: "  mean shift: cluster of each pixel ← nearest mode with at least 2 % of the sample",
    LABEL: "  label of a segment ← that of frame t−1 which shares the most pixels with it, moved by w",
}

impl Segmenter for MotionClustering {
    const INFO: Info = Info {
        id: "motion-clustering",
        name: "Motion clustering",
        family: "Motion segmentation",
        summary: "Groups pixels by their displacements: k-means, a mixture of Gaussians, or mean shift in the plane of displacements.",
        source: "k-means: S. Lloyd, Least squares quantization in PCM, IEEE Trans. Information Theory 1982; D. Arthur and S. Vassilvitskii, \
                 k-means++, SODA 2007; P. Rousseeuw, Silhouettes, J. Comp. Appl. Math. 1987; mixture: A. Dempster, N. Laird and D. Rubin, \
                 J. Royal Statistical Society B 1977; mean shift: D. Comaniciu and P. Meer, PAMI 2002",
        pseudocode: line::ALL,
        granularities: &["clip", "frame", "round", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::value(
            "changes",
            "How many pixels change their cluster in the next iteration?",
            line::ASSIGN,
            vocabulary::value::CHANGES,
        )
        .unless_told(&[vocabulary::case::FIRST_ITERATION]),
        Question::value("segments", "How many segments will the frame have?", line::LABEL, SEGMENTS)
            .unless_told(&[case::NO_SEGMENT, case::ONE_SEGMENT]),
    ];
    // Flow, coordinates, indices, distances of the seeds and labels; each event of a unit may hold labels of its own.
    const BYTES_PER_PIXEL: [f64; 2] = [52.0, 64.0];
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
        match (state.phase, &state.data) {
            (Phase::Iterate, Some(data)) => {
                let data = Arc::clone(data);
                let is_done = match self.method {
                    Method::KMeans => self.k_means(&data, threads, state, observer),
                    Method::GaussianMixture => self.maximize(&data, threads, state, observer),
                    Method::MeanShift => self.ascend(state, observer),
                };
                if is_done {
                    state.phase = Phase::Label;
                }
                Ok(Progress::More)
            }
            (Phase::Label, Some(data)) => {
                let data = Arc::clone(data);
                self.label((&data, threads), state, observer);
                Ok(state.record.progress(clip))
            }
            _ => self.begin((clip, threads), state, observer).map(|()| Progress::More),
        }
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
