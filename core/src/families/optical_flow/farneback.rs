//! Farnebäck's method: displacement estimation from polynomial expansions of both frames.

mod explain;

use std::sync::Arc;

use crate::base::{Error, Observer, Tally, Threads};
use crate::data::Clip;
use crate::geometry::Grid;
use crate::methods::{
    differential::{Field, Multiscale, Weights, Window, explain as shared, field, relax},
    polynomial::{self, Applicability, Estimate, Expander, ExpansionPair, Packed, Part, WindowSolver},
};
use crate::products::{Confidence, DenseField, Output, Product, ProductKind};
use crate::run::{Estimator, Explained, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen};
use crate::scene::{Chart, Focus, Question, Readout, Reply, Scene, Step};
use crate::{params, pseudocode};

params! {
    /// Farnebäck's method: a quadratic polynomial approximates the neighbourhood of each pixel. A shift of the image by d
    /// changes the linear term of the polynomial from b to b − 2 A d.
    pub struct Farneback {
        /// Side of the neighbourhood of the polynomial expansion; an even side is rounded up. Larger ones are smoother and more robust to noise.
        poly_n: usize = 9, 3..=15, "px";
        /// Standard deviation σ of the Gaussian weights of the polynomial expansion.
        poly_sigma: f32 = 1.2, 0.6..=5.0, "px";
        /// Side of the averaging window; an even side is rounded up. Larger windows suppress noise but blur motion boundaries.
        window: usize = 13, 1..=63, "px";
        /// Weights w of the pixels in the window.
        weights: Weights = Weights::Gaussian;
        /// Damping λ (Levenberg), in (gray levels per px²)²: weight of the prior displacement. Windows with less curvature keep their prior displacement.
        damping: f32 = 0.02, 0.0001..=10.0;
        /// Number of iterations per level; each starts from the previous displacements.
        iterations: usize = 3, 1..=20;
        /// Number of pyramid levels, each half the size of the one below, down to 16 px per side. More levels reach larger motion.
        levels: usize = 5, 1..=10;
    }
    advanced { "weights", "damping" }
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    frames: Arc<Multiscale>,
    /// The next level (0 is full resolution) and iteration.
    level: usize,
    iteration: usize,
    /// The current displacements, on the level of the last iteration, with their confidence.
    field: Arc<Field>,
    certainty: Arc<Grid<f32>>,
    /// The polynomial expansions of the current level, computed on demand.
    polynomials: Option<Arc<[Grid<Packed>; 2]>>,
    /// Change and error of each stepped iteration.
    notes: Vec<Note>,
    is_done: bool,
}

/// Change and error of an iteration, in px of level 0.
#[derive(Clone, Copy, Debug)]
struct Note {
    level: usize,
    /// Mean change of the displacements.
    change: f32,
    /// Mean endpoint error; NaN without truth.
    error: f32,
}

/// An event of an iteration.
#[derive(Clone)]
pub struct Event {
    part: Part,
    iteration: Arc<Iteration>,
}

/// A completed iteration.
struct Iteration {
    polynomials: Arc<[Grid<Packed>; 2]>,
    from: Arc<Field>,
    to: Arc<Field>,
}

impl Farneback {
    fn prepare(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let frames = Arc::new(Multiscale::new((clip, frame), 0.0, self.levels, threads)?);
        let level = frames.count() - 1;
        let (width, height) = frames.size(level);
        Ok(State {
            level,
            iteration: 0,
            field: Arc::new(Field::new((width, height), [0.0; 2])),
            certainty: Arc::new(Grid::new(width, height, 0.0)),
            polynomials: None,
            notes: Vec::new(),
            is_done: false,
            frames,
        })
    }

    fn applicability(&self) -> Applicability {
        Applicability::new(self.poly_sigma, self.poly_n / 2)
    }

    fn window(&self) -> Window {
        self.weights.window(self.window / 2)
    }

    /// Returns the polynomial expansions of a level.
    fn expand(&self, frames: &Multiscale, level: usize, threads: &Threads) -> [Grid<Packed>; 2] {
        let expander = Expander::new(self.applicability(), frames.size(level));
        frames.pair(level).map(|picture| expander.expand(picture, threads))
    }

    /// Does an iteration and moves on. Returns the prior displacements and the polynomial expansions.
    fn work(&self, state: &mut State, threads: &Threads) -> (Arc<Field>, Arc<[Grid<Packed>; 2]>) {
        let size = state.frames.size(state.level);
        let from = match state.field.u.size() == size {
            true => Arc::clone(&state.field),
            false => Arc::new(state.field.resized(size, threads)),
        };
        let polynomials = match state.polynomials.take() {
            Some(polynomials) => polynomials,
            None => Arc::new(self.expand(&state.frames, state.level, threads)),
        };
        let expansions = ExpansionPair { pair: polynomials.each_ref(), from: &from };
        let solver = WindowSolver { window: self.window(), damping: self.damping };
        let Estimate { field, certainty } = solver.solve(&expansions, threads);
        (state.field, state.certainty) = (Arc::new(field), Arc::new(certainty));
        state.iteration += 1;
        if state.iteration < self.iterations {
            state.polynomials = Some(Arc::clone(&polynomials));
        } else {
            state.iteration = 0;
            match state.level.checked_sub(1) {
                Some(level) => state.level = level,
                None => state.is_done = true,
            }
        }
        (from, polynomials)
    }
}

pseudocode! {
    START_AT_ZERO: "(u, v) ← 0 on the coarsest level",
    EACH_LEVEL: "for each pyramid level, from the coarsest to full resolution",
    EACH_NEIGHBORHOOD: "  for each pixel of frames t and t+1, over its Gaussian-weighted neighbourhood",
    EXPAND: "    A, b, c ← least-squares fit of x · A x + b · x + c",
    EACH_ITERATION: "  for each iteration",
    EACH_PIXEL: "    for each pixel of frame t, with A₁ and b₁",
    PAIR: "      (m, n) ← (u, v), rounded to whole px; A₂, b₂ ← those of frame t+1, (m, n) px away",
    COMPARE: "      A ← ½ (A₁ + A₂), Δb ← A (m, n) − ½ (b₂ − b₁)",
    EACH_WINDOW: "    for each pixel, over the window around it",
    AVERAGE: "      T ← Σ w A^TA, h ← Σ w A^TΔb, Σ w = 1",
    SOLVE: "      (u, v) ← (T + λ I)⁻¹ (h + λ (u, v))",
}

impl Estimator for Farneback {
    const INFO: Info = Info {
        id: "farneback",
        name: "Farnebäck",
        family: "Optical flow",
        summary: "Dense optical flow from quadratic polynomial expansions of both frames, solved over a window around each pixel.",
        source: "G. Farnebäck, Two-frame motion estimation based on polynomial expansion, SCIA 2003; expansion: G. Farnebäck, \
                 Polynomial expansion for orientation and motion estimation, dissertation, Linköping 2002; damping: \
                 K. Levenberg, A method for the solution of certain non-linear problems in least squares, Quarterly of \
                 Applied Mathematics 2, 1944",
        pseudocode: line::ALL,
        granularities: &["frame", "level", "iteration", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::choice(
            "second",
            "Is there a second polynomial to compare with?",
            &[
                Reply::told(line::PAIR, polynomial::case::OUTSIDE, "No: the displacement leads out of frame t+1"),
                Reply::at(line::PAIR, "Yes"),
            ],
        ),
        Question::value(
            "change",
            "How large is the mean change of the iteration?",
            line::SOLVE,
            shared::value::MEAN_CHANGE,
        ),
    ];
    const GUARANTEE: Guarantee = Guarantee::SubPixel { off_centi_px: 5 };
    const PRODUCES: &'static [&'static ProductKind] = &[DenseField::KIND];
    type State = State;
    type Event = Event;
    const TELLS_CONFIDENCE: bool = true;
    const CHARTS: &'static [Chart] = &[Chart::Tiles, Chart::Series, Chart::Plane];

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        self.prepare(clip, frame, &Threads::single())
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let (level, is_first) = (state.level, state.iteration == 0);
        let (from, polynomials) = self.work(state, &Threads::single());
        let change = relax::change(&from, &state.field) as f32 * state.frames.scale(level)[0];
        state.notes.push(Note { level, change, error: state.frames.error(level, &state.field) });
        let mut iteration = None;
        for &part in Part::of_iteration(is_first) {
            observer.see(|| {
                let done = || {
                    let (from, to) = (Arc::clone(&from), Arc::clone(&state.field));
                    Arc::new(Iteration { polynomials: Arc::clone(&polynomials), from, to })
                };
                Event { part, iteration: Arc::clone(iteration.get_or_insert_with(done)) }
            });
        }
        Ok(if state.is_done { Progress::Done } else { Progress::More })
    }

    fn units(&self, state: &State) -> Option<usize> {
        Some(state.frames.count() * self.iterations)
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        let levels = state.frames.count();
        let granularity = |index, of| Granularity { index, of: Some(of) };
        vec![
            granularity(0, 1),
            granularity(levels - 1 - state.level, levels),
            granularity(state.iteration, self.iterations),
        ]
    }

    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        let Some(probe) = self.probe(seen) else { return Step::at(line::START_AT_ZERO).say(explain::case::OPENING) };
        let line = match probe.part {
            Part::Expanded => line::EXPAND,
            Part::Paired => line::PAIR,
            Part::Compared => line::COMPARE,
            Part::Averaged => line::AVERAGE,
            Part::Solved => line::SOLVE,
        };
        let State { frames, iteration, .. } = seen.before;
        let step = frames.put(Step::at(line), probe.level, (iteration + 1, self.iterations));
        let step = self.conclude(seen, probe.tell(step));
        step.show_all(self.series(seen).into_iter().map(Readout::Series))
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.after.unwrap_or(seen.before);
        field::draw(state.frames.flow(&state.field).0, scene);
        if let Some(probe) = self.probe(seen) {
            probe.draw(scene);
        }
    }

    fn output(&self, state: &State) -> Output {
        let is_whole = state.certainty.size() == state.frames.size(0);
        let confidence =
            is_whole.then(|| Confidence { name: "smaller_eigenvalue", values: Grid::clone(&state.certainty) });
        Output::of(DenseField { flow: state.frames.flow(&state.field), confidence })
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads, tally: &impl Tally<Event>) -> Result<State, Error> {
        let mut state = self.prepare(clip, frame, threads)?;
        while !state.is_done {
            clip.wanted()?;
            tally.add_units(1);
            tally.add_events(Part::of_iteration(state.iteration == 0).len() as u64);
            self.work(&mut state, threads);
        }
        Ok(state)
    }
}

impl Footprint<State> for Farneback {
    fn need(&self, clip: &Clip) -> Need {
        Need::per_pixel(clip, [130.0, 240.0])
    }

    /// The polynomial expansions are recomputed.
    fn at_rest(&self, state: &State) -> State {
        State { polynomials: None, ..state.clone() }
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of::<State>() + size_of_val(&state.notes[..]) + 3 * size_of_val(state.certainty.cells())
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let (width, height) = state.frames.size(0);
        // Two expansions, five products, and the displacements before and after with their confidence.
        let working = width * height * (2 * size_of::<Packed>() + (5 + 2 + 3) * size_of::<f32>());
        state.frames.bytes() + working
    }
}

impl Pointed<State> for Farneback {
    fn explained(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<Explained> {
        state.frames.pixel_at(0, point).map(|_| Explained::Always)
    }
}
