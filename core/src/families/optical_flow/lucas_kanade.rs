//! Lucas and Kanade's method: the displacement on which the pixels of a window agree best.

mod explain;

use std::sync::{Arc, OnceLock};

use crate::base::{Error, Mapped, Observer, Threads};
use crate::data::{Clip, Flow};
use crate::geometry::Grid;
use crate::methods::differential::{Constraints, Field, Given, Linear, Scheme, Sums, Tensor, Texture, Weights, Window};
use crate::products::{Confidence, DenseField, Output, Product, ProductKind};
use crate::run::{
    Cursor, Estimator, Explained, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen,
};
use crate::scene::{Chart, Focus, Scene, Step};
use crate::{params, pseudocode};

params! {
    /// Lucas and Kanade's method for every pixel. Its system is Σ w I_x² u + Σ w I_x I_y v = −Σ w I_x I_t and
    /// Σ w I_x I_y u + Σ w I_y² v = −Σ w I_y I_t, the weights w summing to 1. Course notes that have
    /// (I_x, I_y; I_t, I_y) (u, v) = −(I_t, I_x) are misprinted: I_t does not belong into the matrix, nor I_x to the right, and
    /// without products summed over a window there is nothing that fits best.
    pub struct LucasKanade {
        /// Side of the window around each pixel; an even one reaches as far as the next odd one.
        window: usize = 15, 3..=31, "px";
        /// How much the pixels of the window count.
        weights: Weights = Weights::Gaussian;
        /// Where the smaller eigenvalue of the structure tensor, in (gray levels per px)² for a pixel, is less, nothing is said.
        threshold: f32 = 0.5, 0.0..=100.0;
        /// How often the displacements are found; each time frame t+1 is first brought back by those of the time before.
        iterations: usize = 2, 1..=20;
        /// How derivatives are estimated from pixels.
        derivatives: Scheme = Scheme::FivePoint;
        /// Standard deviation of the Gaussian that smooths both frames first; 0 leaves them as they are.
        smoothing: f32 = 0.5, 0.0..=5.0, "px";
    }
    advanced { "derivatives" }
}

/// What a run reads and writes.
#[derive(Clone)]
pub struct State {
    given: Arc<Given>,
    /// The displacements about which the iteration at hand is linear.
    start: Arc<Field>,
    /// Its constraints, once they are needed.
    linear: Arc<OnceLock<Linear>>,
    iteration: usize,
    /// The row that comes next.
    y: usize,
    /// What was found row by row: before row `y` in this iteration, from there on in the one before.
    found: Vec<Solution>,
}

/// What a window says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution {
    /// The displacement in px/frame; NaN where the window does not tell.
    displacement: [f32; 2],
    /// The eigenvalues of the structure tensor, the larger first.
    eigenvalues: [f32; 2],
    texture: Texture,
}

/// What happens in a row.
#[derive(Clone, Copy, Debug)]
pub enum Event {
    /// Frame t + 1 is brought back and the constraints are taken: before the first row of an iteration.
    Linearized,
    /// The next pixel of the row has this solution.
    Solved(Solution),
}

/// The solutions of a row among its events.
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
        let given = Arc::new(Given::new(clip, frame, self.smoothing, threads)?);
        let start = Arc::new(Field::new(given.size(), [0.0; 2]));
        Ok(State { given, start, linear: Arc::default(), iteration: 0, y: 0, found: Vec::new() })
    }

    /// The constraints of the iteration at hand.
    fn linear<'a>(&self, state: &'a State, threads: &Threads) -> &'a Linear {
        state.linear.get_or_init(|| {
            let [current, next] = &state.given.pictures;
            Linear::about(Arc::clone(&state.start), [current, next], self.derivatives, threads)
        })
    }

    fn solve(&self, tensor: &Tensor) -> Solution {
        let (texture, solution) = (tensor.texture(self.threshold), tensor.solution());
        let is_told = texture == Texture::Corner && solution.iter().all(|c| c.is_finite());
        let displacement = if is_told { solution } else { Flow::UNKNOWN };
        Solution { displacement, eigenvalues: tensor.eigenvalues(), texture }
    }

    /// Asks the windows of row `y`.
    fn row(&self, sums: &mut Sums, y: usize, row: &mut [Solution], observer: &mut impl Observer<Solution>) {
        sums.row(y, |x, tensor| {
            row[x] = self.solve(&tensor);
            observer.see(|| row[x]);
        });
    }

    /// Asks all windows of an iteration.
    ///
    /// # Errors
    /// If the work is cancelled.
    fn all(&self, clip: &Clip, of: &Constraints, threads: &Threads) -> Result<Vec<Solution>, Error> {
        let ((width, height), window) = (of.a.size(), self.window());
        let rows = threads.rows_at_once(height);
        let (mut found, given_up) = (vec![NOTHING; width * height], OnceLock::new());
        let bands = found.chunks_mut(rows * width).enumerate().collect();
        threads.each(bands, |(band, found): (usize, &mut [Solution])| {
            let mut sums = window.sums(of);
            for (y, row) in found.chunks_mut(width).enumerate() {
                if let Err(error) = clip.wanted() {
                    // The first that notices says so for all.
                    let _ = given_up.set(error);
                    return;
                }
                self.row(&mut sums, band * rows + y, row, &mut ());
            }
        });
        given_up.into_inner().map_or(Ok(found), Err)
    }

    /// Goes on after the last row of an iteration.
    fn next_iteration(&self, state: &mut State, threads: &Threads) -> Progress {
        (state.iteration, state.y) = (state.iteration + 1, 0);
        if state.iteration == self.iterations {
            return Progress::Done;
        }
        // A pixel that nobody answered for is looked for where it was before.
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

const NOTHING: Solution = Solution { displacement: Flow::UNKNOWN, eigenvalues: [0.0; 2], texture: Texture::Gone };

impl State {
    /// Notes what was found in the next row.
    fn take(&mut self, row: &[Solution]) {
        let begin = self.y * row.len();
        match self.found.get_mut(begin..begin + row.len()) {
            Some(before) => before.copy_from_slice(row),
            None => self.found.extend_from_slice(row),
        }
        self.y += 1;
    }

    /// `f` of what was found by now, with `more` of the next row; where this iteration has not come yet, in the one before.
    fn solutions<T>(&self, more: &[Event], f: impl Fn(Option<&Solution>) -> T) -> Grid<T> {
        let (width, height) = self.given.size();
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

pseudocode! {
    START_AT_ZERO: "(u, v) ← 0 for each pixel",
    EACH_ITERATION: "for each iteration",
    LINEARIZE: "  (u₀, v₀) ← (u, v) where known; bring frame t+1 back along it, take I_x, I_y, I_t; c ← I_t − I_x u₀ − I_y v₀, unknown where a pixel left the picture",
    EACH_PIXEL: "  for each pixel: T ← Σ w (I_x², I_x I_y; I_x I_y, I_y²) over what is known of the window around it, Σ w = 1",
    IS_SINGULAR: "    if the smaller eigenvalue of T < threshold, then unknown",
    SOLVE: "    else (u, v) ← −T⁻¹ Σ w c (I_x, I_y)",
}

impl Estimator for LucasKanade {
    const INFO: Info = Info {
        id: "lucas-kanade",
        name: "Lucas–Kanade",
        family: "Optical flow",
        summary: "Finds for every pixel the displacement that fits the gradient constraints of a window best.",
        source: "B. D. Lucas and T. Kanade, An iterative image registration technique with an application to stereo vision, \
                 IJCAI 1981; uncertainty: E. P. Simoncelli, E. H. Adelson and D. J. Heeger, Probability distributions of \
                 optical flow, CVPR 1991",
        pseudocode: line::ALL,
        granularities: &["frame", "iteration", "row", "pixel"],
        frames: 2,
    };
    const GUARANTEE: Guarantee = Guarantee::SubPixel { off_centi_px: 3 };
    const TELLS_CONFIDENCE: bool = true;
    const CHARTS: &'static [Chart] = &[Chart::Tiles, Chart::Plane];
    const PRODUCES: &'static [&'static ProductKind] = &[DenseField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        self.prepare(clip, frame, &Threads::single())
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let (width, height) = state.given.size();
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
        Some(self.iterations * state.given.size().1)
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        let granularity = |index, of| Granularity { index, of: Some(of) };
        vec![
            granularity(0, 1),
            granularity(state.iteration, self.iterations),
            granularity(state.y, state.given.size().1),
        ]
    }

    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.told(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.drawn(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        let smaller = state.solutions(&[], |solution| solution.map_or(0.0, |solution| solution.eigenvalues[1]));
        let confidence = Some(Confidence { name: "smaller_eigenvalue", values: smaller });
        Output::of(DenseField { flow: Flow(state.flow(&[])), confidence })
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let mut state = self.prepare(clip, frame, threads)?;
        loop {
            clip.wanted()?;
            state.found = self.all(clip, &self.linear(&state, threads).factors, threads)?;
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
        self.state_bytes(state) + state.given.bytes() + constraints
    }
}

impl Pointed<State> for LucasKanade {
    fn unit_at(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<usize> {
        let iteration = state.iteration.min(self.iterations - 1);
        state.given.pixel_at(point).map(|(_, y)| iteration * state.given.size().1 + y)
    }

    fn explained(&self, state: &State, focus: Focus) -> Option<Explained> {
        let (x, y) = state.given.pixel_at(focus.at)?;
        // The first row of an iteration begins with its constraints.
        let event = x + 1 + usize::from(y == 0);
        Some(Explained::From(Cursor { unit: self.unit_at(state, focus)?, event }))
    }
}
