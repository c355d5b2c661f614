//! How a variational method runs: levels, warps and iterations.

use std::sync::Arc;

use super::declare::Settings;
use super::model::{Iteration, Model, Unknowns, Warp};
use crate::differential::{Field, Given, Linear, field, filter, relax};
use crate::{
    Clip, DenseField, Error, Estimator, Explained, Flow, Grid, Info, Observer, Output, Params, Progress, Promise, Rung,
    Scene, Seen, Spec, Step, Threads, Value, pyramid,
};

/// From one level of the pyramid to the next.
const FACTOR: f32 = 0.5;
/// How many numbers for each pixel [`Linear`] holds.
const LINEAR_PARTS: usize = 5;

/// The estimator that `M` makes.
#[derive(Clone, Debug, Default)]
pub struct Variational<M>(pub M);

impl<M: Model> Params for Variational<M> {
    fn specs(&self) -> &'static [Spec] {
        self.0.specs()
    }

    fn value(&self, index: usize) -> Value {
        self.0.value(index)
    }

    fn set_value(&mut self, index: usize, value: Value) -> Result<(), Error> {
        self.0.set_value(index, value)
    }
}

/// What a run reads and writes.
pub struct State<M: Model> {
    pub(super) fixed: Arc<Fixed>,
    /// What comes next: the level, 0 being the picture itself, the warp on it, and the iteration for that.
    pub(super) level: usize,
    pub(super) warp: usize,
    pub(super) iteration: usize,
    /// What was found by now, on the level of the last iteration.
    unknowns: Arc<M::Unknowns>,
    /// The constraints of the last iteration.
    constraints: Constraints<M>,
    /// The iterations before the eyes of someone.
    pub(super) notes: Vec<Note>,
    is_done: bool,
}

/// The constraints of a warp, or what they are made from.
enum Constraints<M: Model> {
    /// The next iteration begins a warp: they come from what was found.
    Next,
    /// They are about this field.
    About(Arc<Field>),
    /// They are made.
    Made(Arc<Warp<M>>),
}

impl<M: Model> Clone for Constraints<M> {
    fn clone(&self) -> Self {
        match self {
            Constraints::Next => Constraints::Next,
            Constraints::About(start) => Constraints::About(Arc::clone(start)),
            Constraints::Made(warp) => Constraints::Made(Arc::clone(warp)),
        }
    }
}

impl<M: Model> Clone for State<M> {
    fn clone(&self) -> Self {
        Self {
            fixed: Arc::clone(&self.fixed),
            unknowns: Arc::clone(&self.unknowns),
            constraints: self.constraints.clone(),
            notes: self.notes.clone(),
            ..*self
        }
    }
}

/// What stays the same all along.
pub(super) struct Fixed {
    pub(super) given: Given,
    /// The levels of frames t and t + 1, the picture first.
    levels: [Vec<Grid<f32>>; 2],
}

/// An iteration in numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Note {
    /// The parts of the energy, on average over the pixels.
    pub(super) data: f32,
    pub(super) smoothness: f32,
    /// Mean change of the displacements, in px of the picture.
    pub(super) change: f32,
    /// Mean endpoint error in px of the picture; NaN where there is no truth.
    pub(super) error: f32,
}

/// What happens in an iteration.
pub enum Event<M: Model> {
    /// Frame t + 1 is brought back, and the constraints are taken anew.
    Warped,
    /// Step so many of the iteration is done.
    Step(usize, Arc<Iteration<M>>),
}

impl<M: Model> Clone for Event<M> {
    fn clone(&self) -> Self {
        match self {
            Event::Warped => Event::Warped,
            Event::Step(step, iteration) => Event::Step(*step, Arc::clone(iteration)),
        }
    }
}

impl<M: Model> Variational<M> {
    pub(super) fn settings(&self) -> Settings {
        self.0.settings()
    }

    fn prepare(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State<M>, Error> {
        let Settings { levels, smoothing, .. } = self.settings();
        let given = Given::new(clip, frame, smoothing, threads)?;
        let levels = [0, 1].map(|i| pyramid::levels(given.pictures[i].clone(), FACTOR, levels, threads));
        let level = levels[0].len() - 1;
        let start = Field::new(levels[0][level].size(), [0.0; 2]);
        Ok(State {
            unknowns: Arc::new(M::Unknowns::begin(&start, None)),
            fixed: Arc::new(Fixed { given, levels }),
            level,
            warp: 0,
            iteration: 0,
            constraints: Constraints::Next,
            notes: Vec::new(),
            is_done: false,
        })
    }

    /// The constraints of the warp at hand; those that there are, unless it begins.
    fn constraints(&self, state: &State<M>, threads: &Threads) -> Arc<Warp<M>> {
        let start = match &state.constraints {
            Constraints::Made(warp) => return Arc::clone(warp),
            Constraints::About(start) => Arc::clone(start),
            Constraints::Next => Arc::new(state.next_start(threads)),
        };
        let pictures = [0, 1].map(|i| &state.fixed.levels[i][state.level]);
        let linear = Linear::about(start, pictures, self.settings().derivatives, threads);
        let system = self.0.system(&linear, threads);
        Arc::new(Warp { linear, system })
    }

    /// Does `count` iterations of the warp at hand, and takes the place of the next. How far displacements changed on average
    /// is known where that is one.
    fn work(&self, state: &mut State<M>, count: usize, threads: &Threads) -> (Done<M>, f64) {
        let Settings { iterations, tolerance, warps, .. } = self.settings();
        let warp = self.constraints(state, threads);
        let from = match state.iteration {
            0 => Arc::new(M::Unknowns::begin(&warp.linear.start, (state.warp > 0).then_some(&state.unknowns))),
            _ => Arc::clone(&state.unknowns),
        };
        let to = Arc::new(self.0.iterate(&warp, &from, count, threads));
        let change = if count == 1 { relax::change(from.field(), to.field()) } else { f64::INFINITY };
        state.unknowns = Arc::clone(&to);
        state.constraints = Constraints::Made(Arc::clone(&warp));
        state.iteration += count;
        // Whether the iteration was the last of its warp.
        if state.iteration >= iterations || change < f64::from(tolerance) {
            (state.iteration, state.warp) = (0, state.warp + 1);
            state.constraints = Constraints::Next;
        }
        if state.warp == warps {
            state.warp = 0;
            match state.level.checked_sub(1) {
                Some(level) => state.level = level,
                None => state.is_done = true,
            }
        }
        (Done { warp, from, to }, change)
    }

    /// An iteration on `level` in numbers.
    fn note(&self, state: &State<M>, level: usize, done: &Iteration<M>, change: f64) -> Note {
        let [data, smoothness] = self.0.energy(&done.warp, &done.to).map(|part| part as f32);
        let change = change as f32 * state.scale(level)[0];
        Note { data, smoothness, change, error: state.error(level) }
    }
}

/// What some iterations went from and came to.
struct Done<M: Model> {
    warp: Arc<Warp<M>>,
    from: Arc<M::Unknowns>,
    to: Arc<M::Unknowns>,
}

impl<M: Model> State<M> {
    /// The field at which the next warp begins.
    fn next_start(&self, threads: &Threads) -> Field {
        let (found, size) = (self.unknowns.field(), self.level_size(self.level));
        let start = if found.u.size() == size { found.clone() } else { found.resized(size, threads) };
        if self.warp == 0 && self.level + 1 == self.levels() {
            return start;
        }
        Field { u: filter::median(&start.u, threads), v: filter::median(&start.v, threads) }
    }

    /// How many levels there are.
    pub(super) fn levels(&self) -> usize {
        self.fixed.levels[0].len()
    }

    /// Width and height of a level in its own px.
    pub(super) fn level_size(&self, level: usize) -> (usize, usize) {
        self.fixed.levels[0][level].size()
    }

    /// How many px of the picture one of a level is, across and down.
    pub(super) fn scale(&self, level: usize) -> [f32; 2] {
        let ((width, height), (w, h)) = (self.fixed.given.size(), self.level_size(level));
        [width as f32 / w as f32, height as f32 / h as f32]
    }

    /// What was found by now, on the picture.
    fn flow(&self) -> Flow {
        let (found, size) = (self.unknowns.field(), self.fixed.given.size());
        if found.u.size() == size { found.flow() } else { found.resized(size, &Threads::single()).flow() }
    }

    /// The true displacement of a pixel of a level, in px of the picture, if it is known.
    pub(super) fn truth(&self, (x, y): (usize, usize), scale: [f32; 2]) -> Option<[f32; 2]> {
        let place = |i: usize, scale: f32| ((i as f32 + 0.5) * scale) as usize;
        self.fixed.given.true_displacement((place(x, scale[0]), place(y, scale[1])))
    }

    /// Mean endpoint error in px of the picture, over the pixels of `level` whose true motion is known.
    fn error(&self, level: usize) -> f32 {
        let (found, scale) = (self.unknowns.field(), self.scale(level));
        let (width, height) = found.u.size();
        let (mut sum, mut known) = (0.0, 0u32);
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let Some([true_u, true_v]) = self.truth((x, y), scale) else { continue };
            let [u, v] = found.at(x, y);
            sum += f64::from((u * scale[0] - true_u).hypot(v * scale[1] - true_v));
            known += 1;
        }
        (sum / f64::from(known)) as f32
    }
}

/// The pixel whose displacement changes most from one field to the other; the first of several.
fn most_changed(from: &Field, to: &Field) -> (usize, usize) {
    let squared = |place: (usize, usize)| (to.u[place] - from.u[place]).powi(2) + (to.v[place] - from.v[place]).powi(2);
    let (width, height) = from.u.size();
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    places.fold((0, 0), |most, place| if squared(place) > squared(most) { place } else { most })
}

impl<M: Model> Estimator for Variational<M> {
    const INFO: Info = M::INFO;
    const PROMISE: Promise = M::PROMISE;
    type State = State<M>;
    type Event = Event<M>;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State<M>, Error> {
        self.prepare(clip, frame, &Threads::single())
    }

    fn advance(
        &self,
        _: &Clip,
        state: &mut State<M>,
        observer: &mut impl Observer<Event<M>>,
    ) -> Result<Progress, Error> {
        let (level, is_first) = (state.level, state.iteration == 0);
        let (Done { warp, from, to }, change) = self.work(state, 1, &Threads::single());
        if is_first {
            observer.see(|| Event::Warped);
        }
        let most = most_changed(from.field(), to.field());
        let done = Arc::new(Iteration { warp, from, to, most });
        (0..M::LINES.1.len()).for_each(|step| observer.see(|| Event::Step(step, Arc::clone(&done))));
        let note = self.note(state, level, &done, change);
        state.notes.push(note);
        Ok(if state.is_done { Progress::Done } else { Progress::More })
    }

    fn units(&self, state: &State<M>) -> Option<usize> {
        let Settings { iterations, tolerance, warps, .. } = self.settings();
        (tolerance == 0.0).then(|| state.levels() * warps * iterations)
    }

    fn place(&self, state: &State<M>) -> Vec<Rung> {
        let Settings { iterations, warps, .. } = self.settings();
        let (rung, levels) = (|index, of| Rung { index, of: Some(of) }, state.levels());
        vec![
            rung(0, 1),
            rung(levels - 1 - state.level, levels),
            rung(state.warp, warps),
            rung(state.iteration, iterations),
        ]
    }

    /// The constraints of a warp are made again from the field at which it began.
    fn at_rest(&self, state: &State<M>) -> State<M> {
        let constraints = match &state.constraints {
            Constraints::Made(warp) => Constraints::About(Arc::clone(&warp.linear.start)),
            constraints => constraints.clone(),
        };
        State { constraints, ..state.clone() }
    }

    fn explained(&self, state: &State<M>, point: [f32; 2]) -> Option<Explained> {
        state.fixed.given.pixel_at(point).map(|_| Explained::Always)
    }

    fn state_bytes(&self, state: &State<M>) -> usize {
        let constraints = match &state.constraints {
            Constraints::Next => 0,
            Constraints::About(start) => start.bytes(),
            Constraints::Made(warp) => size_of_val(warp.linear.start.u.cells()) * (LINEAR_PARTS + M::SYSTEM_PARTS),
        };
        size_of::<State<M>>() + size_of_val(&state.notes[..]) + state.unknowns.bytes() + constraints
    }

    fn memory_bytes(&self, state: &State<M>) -> usize {
        let Fixed { given, levels } = &*state.fixed;
        let pictures: usize =
            given.pictures.iter().chain(levels.iter().flatten()).map(|p| size_of_val(p.cells())).sum();
        let constraints = size_of_val(given.pictures[0].cells()) * (LINEAR_PARTS + M::SYSTEM_PARTS);
        // What an iteration goes from, and what it comes to.
        self.state_bytes(state) + pictures + constraints + 2 * state.unknowns.bytes()
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.told(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.after.unwrap_or(seen.before);
        field::draw(state.flow().0, scene);
        self.draw_pixel(seen, scene);
    }

    fn output(&self, state: &State<M>) -> Output {
        Output::Dense(DenseField { flow: state.flow(), confidence: None })
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State<M>, Error> {
        let mut state = self.prepare(clip, frame, threads)?;
        let Settings { iterations, tolerance, .. } = self.settings();
        // Where each change decides whether to go on, iterations come one by one.
        let count = if tolerance > 0.0 { 1 } else { iterations };
        while !state.is_done {
            self.work(&mut state, count, threads);
        }
        Ok(state)
    }
}
