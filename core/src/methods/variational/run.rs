//! The run of a variational method: levels, warps and iterations.

use std::sync::{Arc, OnceLock};

use super::declare::Settings;
use super::model::{Iteration, Model, Note, Unknowns, Warp};
use crate::base::{Error, Observer, Tally, Threads};
use crate::data::{Clip, Flow, Frame};
use crate::geometry::{Grid, filter};
use crate::methods::differential::{Field, Linear, Multiscale, field, relax};
use crate::params::inner_params;
use crate::products::{DenseField, Output, Product, ProductKind};
use crate::run::{Estimator, Explained, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen};
use crate::scene::{Chart, Focus, Level, Question, Scene, Step};

/// Numbers per pixel in [`Linear`].
const LINEAR_PARTS: usize = 5;

/// Iterations between two tests for cancellation, and their maximum in pixels: some hundredths of a second.
const BATCH: usize = 128;
const BATCH_PIXELS: usize = 40_000_000;

/// The estimator of the model `M`.
#[derive(Clone, Debug, Default)]
pub struct Variational<M>(pub M);

inner_params!(Variational<M: Model>);

/// The state of a run.
pub struct State<M: Model> {
    pub(super) fixed: Arc<Fixed>,
    /// The next level (0 is full resolution), warp and iteration.
    pub(super) level: usize,
    pub(super) warp: usize,
    pub(super) iteration: usize,
    /// The current unknowns, on the level of the last iteration.
    unknowns: Arc<M::Unknowns>,
    /// The results of the completed levels, the coarsest first.
    coarser: Vec<Arc<M::Unknowns>>,
    /// The constraints of the last iteration.
    constraints: Constraints<M>,
    /// Number of iterations done in all.
    pub(super) done: usize,
    /// Energy, change and error of the plotted iterations; none where the run is not walked through.
    pub(super) notes: Vec<Note>,
    pub(super) is_done: bool,
}

/// The constraints of a warp, or the flow to linearise about.
enum Constraints<M: Model> {
    /// The next iteration begins a warp, from the current flow.
    Next,
    /// To be linearised about this flow.
    About(Arc<Field>),
    /// Computed.
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
            coarser: self.coarser.clone(),
            constraints: self.constraints.clone(),
            notes: self.notes.clone(),
            ..*self
        }
    }
}

/// The constant part of a run.
pub(super) struct Fixed {
    pub(super) frames: Multiscale,
    /// Frames t and t + 1.
    pair: [Arc<Frame>; 2],
    /// The levels as pictures, made on demand.
    pictures: OnceLock<Arc<[Level]>>,
}

impl Fixed {
    pub(super) fn pictures(&self) -> Arc<[Level]> {
        let seen = |level: &Grid<f32>| Arc::new(Frame::gray(level.map(|v| v.round().clamp(0.0, 255.0) as u8)));
        let coarser = |level: usize| Level::covering(self.frames.pair(level).map(seen));
        let make = || {
            let picture = [Level::covering(self.pair.clone())].into_iter();
            picture.chain((1..self.frames.count()).map(coarser)).collect()
        };
        Arc::clone(self.pictures.get_or_init(make))
    }
}

/// The stopping criterion is tested after every group of this many iterations of a warp.
const TESTED: usize = 8;

/// Number of further iterations up to the next plotted one, after `iteration` of a warp. Energy, change and error are plotted
/// after iterations 1, 2, 4, 8 and so on of each warp, and after its last: there the curves bend, and as they take about as long as an
/// iteration, a walk stays about as fast as a run.
fn until_plotted(iteration: usize) -> usize {
    (iteration + 1).next_power_of_two() - iteration
}

/// An event of an iteration.
pub enum Event<M: Model> {
    /// The median filter has removed outliers.
    Medians,
    /// Frame t + 1 was warped, and the constraints were linearised.
    Warped,
    /// A step of the iteration is done.
    Step(usize, Arc<Iteration<M>>),
}

impl<M: Model> Clone for Event<M> {
    fn clone(&self) -> Self {
        match self {
            Event::Medians => Event::Medians,
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
        let Settings { levels, sigma, .. } = self.settings();
        let frames = Multiscale::new((clip, frame), sigma, levels, threads)?;
        let level = frames.count() - 1;
        let start = Field::new(frames.size(level), [0.0; 2]);
        Ok(State {
            unknowns: Arc::new(M::Unknowns::begin(&start, None)),
            fixed: Arc::new(Fixed { frames, pair: clip.pair(frame)?, pictures: OnceLock::new() }),
            level,
            warp: 0,
            iteration: 0,
            coarser: Vec::new(),
            constraints: Constraints::Next,
            done: 0,
            notes: Vec::new(),
            is_done: false,
        })
    }

    /// Returns the constraints of the current warp, linearised anew where it begins.
    fn constraints(&self, state: &State<M>, threads: &Threads) -> Arc<Warp<M>> {
        let start = match &state.constraints {
            Constraints::Made(warp) => return Arc::clone(warp),
            Constraints::About(start) => Arc::clone(start),
            Constraints::Next => Arc::new(state.next_start(threads)),
        };
        let pictures = state.fixed.frames.pair(state.level);
        let linear = Linear::about(start, pictures, self.settings().derivatives, threads);
        let system = self.0.system(&linear, threads);
        Arc::new(Warp { linear, system })
    }

    /// Does up to `most` iterations of the current warp and moves on. With `plots`, it ends with the next plotted iteration.
    fn work(&self, state: &mut State<M>, (most, plots): (usize, bool), threads: &Threads) -> Done<M> {
        let Settings { iterations, tolerance, warps, .. } = self.settings();
        let count = self.at_once(state, (most, plots));
        let warp = self.constraints(state, threads);
        let from = match state.iteration {
            0 => Arc::new(M::Unknowns::begin(&warp.linear.start, (state.warp > 0).then_some(&state.unknowns))),
            _ => Arc::clone(&state.unknowns),
        };
        let end = state.iteration + count;
        let is_plotted = plots && (until_plotted(state.iteration) == count || end == iterations);
        let is_tested = tolerance > 0.0 && end.is_multiple_of(TESTED);
        let (to, change) = if is_tested || is_plotted {
            let (to, change) = self.0.iterate_measured(&warp, &from, count, threads);
            (to, Some(f64::from(state.fixed.frames.scale(state.level)[0]) * change))
        } else {
            (self.0.iterate(&warp, &from, count, threads), None)
        };
        let (place, to) = ((state.level, state.warp), Arc::new(to));
        let has_converged = change.filter(|_| is_tested).map(|change| change < f64::from(tolerance));
        let mut done = Done { place, count, warp, from, to, change, has_converged, is_plotted };
        state.unknowns = Arc::clone(&done.to);
        state.constraints = Constraints::Made(Arc::clone(&done.warp));
        (state.iteration, state.done) = (state.iteration + count, state.done + count);
        // Whether the iteration was the last of its warp.
        if end >= iterations || has_converged == Some(true) {
            (state.iteration, state.warp) = (0, state.warp + 1);
            state.constraints = Constraints::Next;
            done.is_plotted = plots;
        }
        if state.warp == warps {
            state.warp = 0;
            match state.level.checked_sub(1) {
                Some(level) => {
                    state.level = level;
                    state.coarser.push(Arc::clone(&done.to));
                }
                None => state.is_done = true,
            }
        }
        done
    }

    /// Returns how many of `most` iterations are done at once.
    fn at_once(&self, state: &State<M>, (most, plots): (usize, bool)) -> usize {
        let Settings { iterations, tolerance, .. } = self.settings();
        let (width, height) = state.fixed.frames.size(state.level);
        let batch = (BATCH_PIXELS / (width * height)).clamp(1, BATCH);
        let tested = if tolerance > 0.0 { TESTED - state.iteration % TESTED } else { batch };
        let plotted = if plots { until_plotted(state.iteration) } else { batch };
        [batch, tested, plotted, iterations - state.iteration].into_iter().fold(most.max(1), usize::min)
    }

    /// Returns energy, change and error of an iteration of the run.
    fn note(&self, frames: &Multiscale, number: usize, done: &Done<M>) -> Note {
        let (level, to) = (done.place.0, done.to.field());
        let [data, smoothness] = self.0.energy(&done.warp, &done.to).map(|part| part as f32);
        // One iteration that was not measured.
        let change = || f64::from(frames.scale(level)[0]) * relax::change(done.from.field(), to);
        let change = done.change.unwrap_or_else(change) as f32;
        Note { number, place: done.place, data, smoothness, change, error: frames.error(level, to) }
    }

    /// Returns energy, change and error of the iteration after `before`.
    pub(super) fn note_of(&self, before: &State<M>, iteration: &Iteration<M>) -> Note {
        *iteration.note.get_or_init(|| {
            let done = Done {
                place: (before.level, before.warp),
                count: 1,
                warp: Arc::clone(&iteration.warp),
                from: Arc::clone(&iteration.from),
                to: Arc::clone(&iteration.to),
                change: None,
                has_converged: iteration.has_converged,
                is_plotted: false,
            };
            self.note(&before.fixed.frames, before.done + 1, &done)
        })
    }

    /// Adds the last of the iterations `done` to the plots, if it is one of those plotted.
    fn plot(&self, state: &mut State<M>, done: &Done<M>) {
        if done.is_plotted {
            let note = self.note(&state.fixed.frames, state.done, done);
            state.notes.push(note);
        }
    }

    /// Returns the number of events of `count` iterations of a warp.
    fn events(&self, state: &State<M>, count: usize) -> u64 {
        let begins = match state.iteration {
            0 if state.is_first_warp() => 1,
            0 => 2,
            _ => 0,
        };
        begins + (count * self.0.steps().len()) as u64
    }
}

/// Some iterations, and the unknowns before and after them.
struct Done<M: Model> {
    /// Their level and warp.
    place: (usize, usize),
    count: usize,
    warp: Arc<Warp<M>>,
    from: Arc<M::Unknowns>,
    to: Arc<M::Unknowns>,
    /// Mean change of the flow in the last of them, in px of level 0, if it was measured.
    change: Option<f64>,
    /// Whether it met the stopping criterion, if that was tested.
    has_converged: Option<bool>,
    /// Whether the last of them is plotted.
    is_plotted: bool,
}

impl<M: Model> State<M> {
    /// Returns the initial flow of the next warp.
    fn next_start(&self, threads: &Threads) -> Field {
        let (found, size) = (self.unknowns.field(), self.fixed.frames.size(self.level));
        let start = if found.u.size() == size { found.clone() } else { found.resized(size, threads) };
        if self.is_first_warp() {
            return start;
        }
        Field { u: filter::median(&start.u, threads), v: filter::median(&start.v, threads) }
    }

    /// Whether this is the first warp of the run, at zero flow.
    pub(super) fn is_first_warp(&self) -> bool {
        self.warp == 0 && self.level + 1 == self.fixed.frames.count()
    }

    /// Returns the flow of `level`, if that is completed.
    pub(super) fn found(&self, level: usize) -> Option<&Field> {
        self.coarser.get(self.fixed.frames.count() - 1 - level).map(|found| found.field())
    }

    /// Returns the current flow at full resolution.
    pub(super) fn flow(&self) -> Flow {
        self.fixed.frames.flow(self.unknowns.field())
    }
}

impl<M: Model> Estimator for Variational<M> {
    const INFO: Info = M::INFO;
    const QUESTIONS: &'static [Question] = M::QUESTIONS;
    const GUARANTEE: Guarantee = M::GUARANTEE;
    const CHARTS: &'static [Chart] = &[Chart::Plane, Chart::Series, Chart::Stack];
    const PRODUCES: &'static [&'static ProductKind] = &[DenseField::KIND];
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
        let (is_first, has_medians) = (state.iteration == 0, !state.is_first_warp());
        let done = self.work(state, (1, true), &Threads::single());
        if is_first {
            if has_medians {
                observer.see(|| Event::Medians);
            }
            observer.see(|| Event::Warped);
        }
        let mut iteration = None;
        for step in 0..self.0.steps().len() {
            observer.see(|| {
                let parts = || {
                    let unknowns = [&done.from, &done.to].map(Arc::clone);
                    Arc::new(Iteration::new(Arc::clone(&done.warp), unknowns, done.has_converged))
                };
                Event::Step(step, Arc::clone(iteration.get_or_insert_with(parts)))
            });
        }
        self.plot(state, &done);
        Ok(if state.is_done { Progress::Done } else { Progress::More })
    }

    fn advance_many(&self, clip: &Clip, state: &mut State<M>, most: usize) -> Result<(usize, Progress), Error> {
        clip.wanted()?;
        let done = self.work(state, (most, true), &Threads::single());
        self.plot(state, &done);
        Ok((done.count, if state.is_done { Progress::Done } else { Progress::More }))
    }

    fn units(&self, state: &State<M>) -> Option<usize> {
        let Settings { iterations, tolerance, warps, .. } = self.settings();
        (tolerance == 0.0).then(|| state.fixed.frames.count() * warps * iterations)
    }

    fn place(&self, state: &State<M>) -> Vec<Granularity> {
        let Settings { iterations, warps, .. } = self.settings();
        let (granularity, levels) = (|index, of| Granularity { index, of: Some(of) }, state.fixed.frames.count());
        vec![
            granularity(0, 1),
            granularity(levels - 1 - state.level, levels),
            granularity(state.warp, warps),
            granularity(state.iteration, iterations),
        ]
    }

    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.after.unwrap_or(seen.before);
        field::draw(state.flow().0, scene);
        self.draw_pixel(seen, scene);
        scene.levels = self.levels(seen);
        scene.layers = self.layers(seen);
    }

    fn output(&self, state: &State<M>) -> Output {
        Output::of(DenseField { flow: state.flow(), confidence: None })
    }

    fn run(
        &self,
        clip: &Clip,
        frame: usize,
        threads: &Threads,
        tally: &impl Tally<Event<M>>,
    ) -> Result<State<M>, Error> {
        let mut state = self.prepare(clip, frame, threads)?;
        while !state.is_done {
            clip.wanted()?;
            let count = self.at_once(&state, (usize::MAX, false));
            tally.add_units(count);
            tally.add_events(self.events(&state, count));
            self.work(&mut state, (count, false), threads);
        }
        Ok(state)
    }
}

impl<M: Model> Footprint<State<M>> for Variational<M> {
    fn need(&self, clip: &Clip) -> Need {
        Need::per_pixel(clip, M::NEED)
    }

    /// The constraints of a warp are recomputed from its initial flow.
    fn at_rest(&self, state: &State<M>) -> State<M> {
        let constraints = match &state.constraints {
            Constraints::Made(warp) => Constraints::About(Arc::clone(&warp.linear.start)),
            constraints => constraints.clone(),
        };
        State { constraints, ..state.clone() }
    }

    /// The results of coarser levels are shared by all states of a run.
    fn state_bytes(&self, state: &State<M>) -> usize {
        let constraints = match &state.constraints {
            Constraints::Next => 0,
            Constraints::About(start) => start.bytes(),
            Constraints::Made(warp) => size_of_val(warp.linear.start.u.cells()) * (LINEAR_PARTS + M::SYSTEM_PARTS),
        };
        size_of::<State<M>>() + size_of_val(&state.notes[..]) + state.unknowns.bytes() + constraints
    }

    fn memory_bytes(&self, state: &State<M>) -> usize {
        let frames = &state.fixed.frames;
        let grid = size_of_val(frames.frame_pair.pictures[0].cells());
        let constraints = grid * (LINEAR_PARTS + M::SYSTEM_PARTS);
        let coarser: usize = state.coarser.iter().map(|unknowns| unknowns.bytes()).sum();
        // The unknowns before and after an iteration.
        self.state_bytes(state) + frames.bytes() + constraints + coarser + 2 * state.unknowns.bytes()
    }
}

impl<M: Model> Pointed<State<M>> for Variational<M> {
    fn explained(&self, state: &State<M>, Focus { at: point, .. }: Focus) -> Option<Explained> {
        state.fixed.frames.frame_pair.pixel_at(point).map(|_| Explained::Always)
    }
}
