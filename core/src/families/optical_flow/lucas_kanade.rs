//! Lucas and Kanade's method: least squares over the gradient constraints of a window.

mod explain;

use std::sync::{Arc, OnceLock};

use crate::base::{Error, Mapped, Observer, Tally, Threads};
use crate::data::{Clip, Flow};
use crate::geometry::Grid;
use crate::methods::differential::{
    Advice, Constraints, Field, FramePair, Linear, Scheme, Sums, Tensor, Texture, Weights, Window,
};
use crate::products::{Confidence, DenseField, Output, Product, ProductKind};
use crate::run::{
    Cursor, Estimator, Explained, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen,
};
use crate::scene::{Chart, Focus, Question, Reply, Scene, Step};
use crate::{cases, params, pseudocode};
use explain::case as explain_case;

params! {
    /// Lucas and Kanade's method for every pixel. Its normal equations are Σ w I_x² u + Σ w I_x I_y v = −Σ w I_x I_t and
    /// Σ w I_x I_y u + Σ w I_y² v = −Σ w I_y I_t, with weights w that sum to 1. Course notes with
    /// (I_x, I_y; I_t, I_y) (u, v) = −(I_t, I_x) are misprinted: I_t does not belong in the matrix nor I_x on the right, and
    /// without sums of products over a window there is no least-squares problem.
    pub struct LucasKanade {
        /// Side of the window of the least-squares fit; an even side is rounded up. Larger windows suppress noise but mix different motions.
        window: usize = 15, 3..=31, "px";
        /// Weights w of the pixels in the window.
        weights: Weights = Weights::Gaussian;
        /// Smallest accepted eigenvalue λ₂ of the structure tensor, in (gray levels per px)². Windows below it are ill-conditioned and get no flow.
        min_eigenvalue: f32 = 0.5, 0.0..=100.0;
        /// Number of linearisations: each warps frame t+1 toward frame t by the current flow and solves again.
        iterations: usize = 2, 1..=20;
        /// Kernel that estimates the derivatives I_x and I_y.
        derivatives: Scheme = Scheme::FivePoint;
        /// Standard deviation σ of the Gaussian that smooths both frames before derivatives are taken. 0 does not smooth.
        sigma: f32 = 0.5, 0.0..=5.0, "px";
    }
    advanced { "derivatives" }
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    frame_pair: Arc<FramePair>,
    /// The flow of the current linearisation.
    start: Arc<Field>,
    /// Its constraints, computed on demand.
    linear: Arc<OnceLock<Linear>>,
    iteration: usize,
    /// The next row.
    y: usize,
    /// The solutions, row by row: of this iteration before row `y`, of the previous one from there on.
    found: Vec<Solution>,
}

/// The least-squares solution of a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution {
    /// The flow in px/frame; NaN where the window is ill-conditioned.
    displacement: [f32; 2],
    /// The eigenvalues of the structure tensor, the larger first.
    eigenvalues: [f32; 2],
    texture: Texture,
}

/// An event in a row.
#[derive(Clone, Copy, Debug)]
pub enum Event {
    /// Frame t + 1 was warped and the constraints were linearised, before the first row of an iteration.
    Linearized,
    /// The solution of the next pixel of the row.
    Solved(Solution),
}

/// The events of a row that are solutions.
fn solved(events: &[Event]) -> &[Event] {
    match events {
        [Event::Linearized, solved @ ..] => solved,
        all => all,
    }
}

impl LucasKanade {
    fn window(&self) -> Window {
        self.weights.window(self.window / 2)
    }

    fn prepare(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let frame_pair = Arc::new(FramePair::new(clip, frame, self.sigma, threads)?);
        let start = Arc::new(Field::new(frame_pair.size(), [0.0; 2]));
        Ok(State { frame_pair, start, linear: Arc::default(), iteration: 0, y: 0, found: Vec::new() })
    }

    /// Returns the constraints of the current iteration.
    fn linear<'a>(&self, state: &'a State, threads: &Threads) -> &'a Linear {
        state.linear.get_or_init(|| {
            let [current, next] = &state.frame_pair.pictures;
            Linear::about(Arc::clone(&state.start), [current, next], self.derivatives, threads)
        })
    }

    fn solve(&self, tensor: &Tensor) -> Solution {
        let (texture, solution) = (tensor.texture(self.min_eigenvalue), tensor.solution());
        let is_solvable = texture == Texture::Corner && solution.iter().all(|c| c.is_finite());
        let displacement = if is_solvable { solution } else { Flow::UNKNOWN };
        Solution { displacement, eigenvalues: tensor.eigenvalues(), texture }
    }

    /// Solves the windows of row `y`.
    fn row(&self, sums: &mut Sums, y: usize, row: &mut [Solution], observer: &mut impl Observer<Solution>) {
        sums.row(y, |x, tensor| {
            row[x] = self.solve(&tensor);
            observer.see(|| row[x]);
        });
    }

    /// Solves all windows of an iteration.
    ///
    /// # Errors
    /// If the work is cancelled.
    fn all(
        &self,
        clip: &Clip,
        of: &Constraints,
        (threads, tally): (&Threads, &impl Tally<Event>),
    ) -> Result<Vec<Solution>, Error> {
        let ((width, height), window) = (of.a.size(), self.window());
        let rows = threads.rows_at_once(height);
        let (mut found, cancelled) = (vec![NOTHING; width * height], OnceLock::new());
        let bands = found.chunks_mut(rows * width).enumerate();
        threads.each(bands, |(band, found): (usize, &mut [Solution])| {
            let mut sums = window.sums(of);
            for (y, row) in found.chunks_mut(width).enumerate() {
                if let Err(error) = clip.wanted() {
                    // The first thread that notices reports it.
                    let _ = cancelled.set(error);
                    return;
                }
                self.row(
                    &mut sums,
                    band * rows + y,
                    row,
                    &mut Mapped { observer: &mut tally.counter(), map: Event::Solved },
                );
            }
        });
        cancelled.into_inner().map_or(Ok(found), Err)
    }

    /// Ends an iteration after its last row.
    fn next_iteration(&self, state: &mut State, threads: &Threads) -> Progress {
        (state.iteration, state.y) = (state.iteration + 1, 0);
        if state.iteration == self.iterations {
            return Progress::Done;
        }
        // A pixel without solution keeps its previous flow.
        let Field { u, v } = Arc::make_mut(&mut state.start);
        let width = u.width();
        threads.rows_of([u, v], |y, [u, v]| {
            for ((u, v), Solution { displacement, .. }) in u.iter_mut().zip(v).zip(&state.found[y * width..]) {
                if displacement[0].is_finite() {
                    [*u, *v] = *displacement;
                }
            }
        });
        state.linear = Arc::default();
        Progress::More
    }
}

/// No solution.
const NOTHING: Solution = Solution { displacement: Flow::UNKNOWN, eigenvalues: [0.0; 2], texture: Texture::Unknown };

impl State {
    /// Stores the solutions of the next row.
    fn take(&mut self, row: &[Solution]) {
        let begin = self.y * row.len();
        match self.found.get_mut(begin..begin + row.len()) {
            Some(before) => before.copy_from_slice(row),
            None => self.found.extend_from_slice(row),
        }
        self.y += 1;
    }

    /// Maps the solutions so far, with `more` of the next row; beyond that, those of the previous iteration.
    fn solutions<T>(&self, more: &[Event], f: impl Fn(Option<&Solution>) -> T) -> Grid<T> {
        let (width, height) = self.frame_pair.size();
        Grid::from_fn(width, height, |x, y| {
            let of_row = solved(more).get(x).filter(|_| y == self.y).and_then(|event| match event {
                Event::Solved(solution) => Some(solution),
                Event::Linearized => None,
            });
            f(of_row.or_else(|| self.found.get(y * width + x)))
        })
    }

    fn flow(&self, more: &[Event]) -> Grid<[f32; 2]> {
        self.solutions(more, |solution| solution.map_or(Flow::UNKNOWN, |solution| solution.displacement))
    }
}

/// Remedies where Lucas–Kanade fails.
const ADVICE: Advice =
    Advice { texture: case::ADVISE_TEXTURE, boundary: case::ADVISE_BOUNDARY, motion: case::ADVISE_MOTION };

cases! {
    ADVISE_TEXTURE: "A larger window may contain other gradients; the smoothness term of Horn–Schunck fills such areas.",
    ADVISE_BOUNDARY: "The window mixes the motions of both sides; a smaller window or TV-L1 mixes them less.",
    ADVISE_MOTION: "A pyramid, as in pyramidal Lucas–Kanade, would reach it.",
}

pseudocode! {
    START_AT_ZERO: "(u, v) ← 0 for each pixel",
    EACH_ITERATION: "for each iteration",
    LINEARIZE: "  (u₀, v₀) ← (u, v) where known; warp frame t+1 toward frame t by it; I_x, I_y, I_t ← derivatives; c ← I_t − I_x u₀ − I_y v₀",
    EACH_PIXEL: "  for each pixel: T ← Σ w (I_x², I_x I_y; I_x I_y, I_y²) over the known pixels of the window around it, Σ w = 1",
    IS_SINGULAR: "    if λ₂ of T < min-eigenvalue: flow unknown (aperture problem)",
    SOLVE: "    else (u, v) ← −T⁻¹ Σ w c (I_x, I_y)",
}

impl Estimator for LucasKanade {
    const INFO: Info = Info {
        id: "lucas-kanade",
        name: "Lucas–Kanade",
        family: "Optical flow",
        summary: "Dense optical flow by least squares over the gradient constraints of a window around each pixel.",
        source: "B. D. Lucas and T. Kanade, An iterative image registration technique with an application to stereo vision, \
                 IJCAI 1981; uncertainty: E. P. Simoncelli, E. H. Adelson and D. J. Heeger, Probability distributions of \
                 optical flow, CVPR 1991",
        pseudocode: line::ALL,
        granularities: &["frame", "iteration", "row", "pixel"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[Question::choice(
        "determined",
        "Does the window of the next pixel determine its flow?",
        &[
            Reply::told(line::SOLVE, explain_case::WELL_CONDITIONED, "Yes: the constraint lines intersect well"),
            Reply::told(line::SOLVE, explain_case::NOISY, "Yes, but noise has much influence on it"),
            Reply::told(line::IS_SINGULAR, explain_case::EDGE, "No: an edge, its lines are nearly parallel"),
            Reply::told(line::IS_SINGULAR, explain_case::FLAT, "No: a flat window"),
        ],
    )];
    const GUARANTEE: Guarantee = Guarantee::SubPixel { off_centi_px: 3 };
    const TELLS_CONFIDENCE: bool = true;
    const CHARTS: &'static [Chart] = &[Chart::Plane, Chart::Tiles];
    const PRODUCES: &'static [&'static ProductKind] = &[DenseField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        self.prepare(clip, frame, &Threads::single())
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let (width, height) = state.frame_pair.size();
        let mut row = vec![NOTHING; width];
        let linear = self.linear(state, &Threads::single());
        if state.y == 0 {
            observer.see(|| Event::Linearized);
        }
        let mut solved = Mapped { observer, map: Event::Solved };
        self.row(&mut self.window().sums(&linear.factors), state.y, &mut row, &mut solved);
        state.take(&row);
        Ok(if state.y < height { Progress::More } else { self.next_iteration(state, &Threads::single()) })
    }

    fn units(&self, state: &State) -> Option<usize> {
        Some(self.iterations * state.frame_pair.size().1)
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        let granularity = |index, of| Granularity { index, of: Some(of) };
        vec![
            granularity(0, 1),
            granularity(state.iteration, self.iterations),
            granularity(state.y, state.frame_pair.size().1),
        ]
    }

    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.draw_step(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        let smaller = state.solutions(&[], |solution| solution.map_or(0.0, |solution| solution.eigenvalues[1]));
        let confidence = Some(Confidence { name: "smaller_eigenvalue", values: smaller });
        Output::of(DenseField { flow: Flow(state.flow(&[])), confidence })
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads, tally: &impl Tally<Event>) -> Result<State, Error> {
        let mut state = self.prepare(clip, frame, threads)?;
        loop {
            clip.wanted()?;
            // The linearisation.
            tally.add_events(1);
            tally.add_units(state.frame_pair.size().1);
            state.found = self.all(clip, &self.linear(&state, threads).factors, (threads, tally))?;
            if self.next_iteration(&mut state, threads) == Progress::Done {
                return Ok(state);
            }
        }
    }
}

impl Footprint<State> for LucasKanade {
    fn need(&self, clip: &Clip) -> Need {
        Need::per_pixel(clip, [80.0, 210.0])
    }

    fn at_rest(&self, state: &State) -> State {
        State { linear: Arc::default(), ..state.clone() }
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of::<State>() + size_of_val(&state.found[..]) + state.start.bytes()
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let constraints = state.linear.get().map_or(0, |linear| linear.factors.bytes());
        self.state_bytes(state) + state.frame_pair.bytes() + constraints
    }
}

impl Pointed<State> for LucasKanade {
    fn unit_at(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<usize> {
        let iteration = state.iteration.min(self.iterations - 1);
        state.frame_pair.pixel_at(point).map(|(_, y)| iteration * state.frame_pair.size().1 + y)
    }

    fn explained(&self, state: &State, focus: Focus) -> Option<Explained> {
        let (x, y) = state.frame_pair.pixel_at(focus.at)?;
        // The first row of an iteration begins with the linearisation.
        let event = x + 1 + usize::from(y == 0);
        Some(Explained::From(Cursor { unit: self.unit_at(state, focus)?, event }))
    }
}
