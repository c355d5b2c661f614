//! Farnebäck's method: neighbourhoods are polynomials, and how these change tells how far they have moved.

use std::sync::Arc;

use crate::base::{Error, Observer, Threads, words};
use crate::data::Clip;
use crate::geometry::Grid;
use crate::methods::{
    differential::{Field, Multiscale, Weights, Window, explain, field, relax},
    polynomial::{Agreed, Agreement, Applicability, Expander, Looked, Moved, Packed, Part},
};
use crate::products::{Confidence, DenseField, Output, Product, ProductKind};
use crate::run::{Estimator, Explained, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen};
use crate::scene::{Chart, Fact, Focus, Readout, Role, Scene, Sentence, Series, Step};
use crate::{params, pseudocode};

params! {
    /// Farnebäck's method: the neighbourhood of each pixel becomes a polynomial of the second degree. Where the picture moves
    /// by d, so does the polynomial, and its gradient changes from b to b − 2 A d.
    pub struct Farneback {
        /// Side of the neighbourhood that becomes a polynomial; an even one reaches as far as the next odd one.
        neighborhood: usize = 9, 3..=15, "px";
        /// Standard deviation of the Gaussian by which the pixels of a neighbourhood count.
        sigma: f32 = 1.2, 0.6..=5.0, "px";
        /// Side of the window whose pixels agree on a displacement; an even one reaches as far as the next odd one.
        window: usize = 13, 1..=63, "px";
        /// How much the pixels of the window count.
        weights: Weights = Weights::Gaussian;
        /// Weight λ of the displacement found before, in the square of A's gray levels per px²: windows that say less than that leave it as it is.
        damping: f32 = 0.02, 0.0001..=10.0;
        /// How often on each level displacements are found anew, from where the ones before lead to.
        iterations: usize = 3, 1..=20;
        /// Levels of the pyramid, each half as large as the one before; fewer where a side would be less than 16 px.
        levels: usize = 5, 1..=10;
    }
}

/// What a run reads and writes.
#[derive(Clone)]
pub struct State {
    frames: Arc<Multiscale>,
    /// What comes next: the level, 0 being the picture itself, and the iteration on it.
    level: usize,
    iteration: usize,
    /// What was found by now, on the level of the last iteration, and how certain it is.
    field: Arc<Field>,
    certainty: Arc<Grid<f32>>,
    /// The polynomials of the level at hand; they are made where they are missing.
    polynomials: Option<Arc<[Grid<Packed>; 2]>>,
    /// The iterations before the eyes of someone.
    notes: Vec<Note>,
    is_done: bool,
}

/// An iteration in numbers, in px of the picture.
#[derive(Clone, Copy, Debug)]
struct Note {
    level: usize,
    /// Mean change of the displacements.
    change: f32,
    /// Mean endpoint error; NaN where there is no truth.
    error: f32,
}

/// What has happened in an iteration.
#[derive(Clone)]
pub struct Event {
    part: Part,
    iteration: Arc<Iteration>,
}

/// An iteration that was done.
struct Iteration {
    polynomials: Arc<[Grid<Packed>; 2]>,
    from: Arc<Field>,
    to: Arc<Field>,
    /// The pixel that changes most.
    most: (usize, usize),
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
        Applicability::new(self.sigma, self.neighborhood / 2)
    }

    fn window(&self) -> Window {
        self.weights.window(self.window / 2)
    }

    /// The polynomials of a level.
    fn expand(&self, frames: &Multiscale, level: usize, threads: &Threads) -> [Grid<Packed>; 2] {
        let expander = Expander::new(self.applicability(), frames.size(level));
        frames.pair(level).map(|picture| expander.expand(picture, threads))
    }

    /// Does an iteration, and takes the place of the next. What it began with, and the polynomials that it compared.
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
        let moved = Moved { pair: polynomials.each_ref(), from: &from };
        let agreement = Agreement { window: self.window(), damping: self.damping };
        let Agreed { field, certainty } = agreement.on(&moved, threads);
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
    EACH_LEVEL: "for each level, from the coarsest to the picture itself",
    EACH_NEIGHBORHOOD: "  for each pixel of frames t and t+1, over the neighbourhood around it",
    EXPAND: "    A, b, c ← the polynomial x · A x + b · x + c that fits best",
    EACH_ITERATION: "  for each iteration",
    EACH_PIXEL: "    for each pixel of frame t, with A₁ and b₁",
    PAIR: "      (m, n) ← (u, v) in whole px; A₂, b₂ ← those of frame t+1 as far away",
    COMPARE: "      A ← ½ (A₁ + A₂), Δb ← A (m, n) − ½ (b₂ − b₁)",
    EACH_WINDOW: "    for each pixel, over the window around it",
    AVERAGE: "      T ← Σ w A A, h ← Σ w A Δb",
    SOLVE: "      (u, v) ← (T + λ 1)⁻¹ (h + λ (u, v))",
}

impl Estimator for Farneback {
    const INFO: Info = Info {
        id: "farneback",
        name: "Farnebäck",
        family: "Optical flow",
        summary: "Describes neighbourhoods by polynomials, and finds how far these have moved.",
        source: "G. Farnebäck, Two-frame motion estimation based on polynomial expansion, SCIA 2003; expansion: G. Farnebäck, \
                 Polynomial expansion for orientation and motion estimation, dissertation, Linköping 2002; damping: \
                 K. Levenberg, A method for the solution of certain non-linear problems in least squares, Quarterly of \
                 Applied Mathematics 2, 1944",
        pseudocode: line::ALL,
        granularities: &["frame", "level", "iteration", "step"],
        frames: 2,
    };
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
        for part in [Part::Expanded, Part::Paired, Part::Compared, Part::Averaged, Part::Moved] {
            if part == Part::Expanded && !is_first {
                continue;
            }
            observer.see(|| {
                let done = || {
                    let (from, to) = (Arc::clone(&from), Arc::clone(&state.field));
                    let most = field::most_changed(&from, &to);
                    Arc::new(Iteration { polynomials: Arc::clone(&polynomials), from, to, most })
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
        let Some(looked) = self.look(seen) else {
            let sentence = "A neighbourhood is described by the polynomial x · A x + b · x + c that fits it best. If the picture \
                            moves by d, the polynomial becomes that of x − d, and its b becomes b − 2 A d: what b has \
                            changed by tells d.";
            return Step {
                line: line::START_AT_ZERO,
                sentence: Sentence::default().text(sentence),
                readouts: Vec::new(),
            };
        };
        let line = match looked.part {
            Part::Expanded => line::EXPAND,
            Part::Paired => line::PAIR,
            Part::Compared => line::COMPARE,
            Part::Averaged => line::AVERAGE,
            Part::Moved => line::SOLVE,
        };
        Step { line, sentence: looked.sentence(), readouts: self.readouts(seen, &looked) }
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.after.unwrap_or(seen.before);
        field::draw(state.frames.flow(&state.field).0, scene);
        if let Some(looked) = self.look(seen) {
            looked.draw(scene);
        }
    }

    fn output(&self, state: &State) -> Output {
        let is_whole = state.certainty.size() == state.frames.size(0);
        let confidence =
            is_whole.then(|| Confidence { name: "smaller_eigenvalue", values: Grid::clone(&state.certainty) });
        Output::of(DenseField { flow: state.frames.flow(&state.field), confidence })
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let mut state = self.prepare(clip, frame, threads)?;
        while !state.is_done {
            clip.wanted()?;
            self.work(&mut state, threads);
        }
        Ok(state)
    }
}

impl Footprint<State> for Farneback {
    fn need(&self, clip: &Clip) -> Need {
        Need::per_pixel(clip, [130.0, 240.0])
    }

    /// The polynomials are made again.
    fn at_rest(&self, state: &State) -> State {
        State { polynomials: None, ..state.clone() }
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of::<State>() + size_of_val(&state.notes[..]) + 3 * size_of_val(state.certainty.cells())
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let (width, height) = state.frames.size(0);
        // Two polynomials, five products, the field before and the one after with its certainty.
        let working = width * height * (2 * size_of::<Packed>() + (5 + 2 + 3) * size_of::<f32>());
        state.frames.bytes() + working
    }
}

impl Pointed<State> for Farneback {
    fn explained(&self, state: &State, Focus { at: point, .. }: Focus) -> Option<Explained> {
        state.frames.pixel_at(0, point).map(|_| Explained::Always)
    }
}

impl Farneback {
    /// The iteration at the pixel pointed at, or else at the one that changes most.
    fn look<'a>(&self, seen: &Seen<'a, Self>) -> Option<Looked<'a>> {
        let Event { part, iteration } = seen.events.last()?;
        let (frames, level) = (&*seen.before.frames, seen.before.level);
        let pointed_at = seen.point().and_then(|point| frames.pixel_at(level, point));
        let place = pointed_at.unwrap_or(iteration.most);
        let moved = Moved { pair: iteration.polynomials.each_ref(), from: &iteration.from };
        let agreement = Agreement { window: self.window(), damping: self.damping };
        Some(Looked::new(*part, (frames, level), (moved, &iteration.to, place), agreement, self.neighborhood / 2))
    }

    fn readouts(&self, seen: &Seen<Self>, looked: &Looked) -> Vec<Readout> {
        let facts = Readout::Facts(self.facts(seen, looked));
        let series = self.series(seen).into_iter().map(Readout::Series);
        [facts].into_iter().chain(looked.readouts()).chain(series).collect()
    }

    fn facts(&self, seen: &Seen<Self>, looked: &Looked) -> Vec<Fact> {
        let state = seen.before;
        let fact = |label, value, role| Fact { label, value, role };
        let px = |uv: [f32; 2]| format!("{} {}", words::vector(uv), looked.unit());
        let (width, height) = state.frames.size(looked.level);
        let of = state.frames.count() - 1;
        let (x, y) = looked.place;
        let mut facts = vec![
            fact("Level", format!("{}, from {of} down to 0, {width}×{height} px", looked.level), None),
            fact("Iteration", format!("{} of {}", state.iteration + 1, self.iterations), None),
            fact("Pixel", format!("({x}, {y}) of the level"), Some(Role::Reference)),
            fact("Before", px(looked.from()), Some(Role::Best)),
        ];
        if looked.part == Part::Moved {
            let off = words::number(looked.off());
            facts.push(fact("Displacement", px(looked.to()), Some(Role::Result)));
            facts.push(fact("Off by", format!("{off} gray levels per px (root mean square of A d − Δb)"), None));
        }
        facts.extend(looked.truth().map(|truth| fact("Truth", px(truth), Some(Role::Truth))));
        if let Some(note) = seen.after.and_then(|after| after.notes.last()) {
            facts.push(fact("Mean change", format!("{:.4} px", note.change), None));
            if note.error.is_finite() {
                facts.push(fact("Mean error", format!("{:.3} px", note.error), Some(Role::Error)));
            }
        }
        facts
    }

    /// What became of the change and of the error, iteration by iteration.
    fn series(&self, seen: &Seen<Self>) -> Vec<Series> {
        let notes = &seen.after.unwrap_or(seen.before).notes;
        let line = |of: fn(&Note) -> f32| -> Vec<[f32; 2]> {
            notes.iter().enumerate().map(|(i, note)| [(i + 1) as f32, of(note)]).collect()
        };
        let x_max = seen.before.frames.count() * self.iterations;
        let counts = (seen.before.frames.count(), 1);
        let sections: Vec<_> = explain::sections(notes.iter().map(|note| (note.level, 0)), counts).collect();
        let series = |title, lines| {
            let sections = sections.clone();
            Series { title, x_label: "iteration", y_label: "px", x_max, sections, lines, ..Series::default() }
        };
        let mut all = Vec::new();
        if !notes.is_empty() {
            let change = series("Mean change", vec![("change", Role::Best, line(|note| note.change))]);
            all.push(Series { is_logarithmic: true, ..change });
            if notes.iter().all(|note| note.error.is_finite()) {
                all.push(series("Mean endpoint error", vec![("error", Role::Error, line(|note| note.error))]));
            }
        }
        all
    }
}
