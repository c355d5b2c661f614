//! Image alignment by Lucas and Kanade's method in its inverse compositional form, coarse to fine.

mod explain;

use std::sync::{Arc, OnceLock};

use crate::base::{Error, Observer};
use crate::data::{Clip, Flow, Frame};
use crate::geometry::{Grid, pyramid::halvings};
use crate::methods::alignment::{Aligner, Compared, Increment, composed, gradients, solve};
use crate::methods::differential::truth;
use crate::params;
use crate::products::model::{IDENTITY, Matrix3};
use crate::products::{Model, ModelField, Output, Product, ProductKind};
use crate::pseudocode;
use crate::run::{Estimator, Footprint, Granularity, Guarantee, Info, Need, Progress, Seen};
use crate::scene::{Chart, Question, Reply, Scene, Step};

use explain::{case, value};

params! {
    /// Image alignment.
    pub struct ImageAlignment {
        /// Group of transformations. More degrees of freedom fit more motions, but need more texture.
        model: Model = Model::Affine;
        /// Number of pyramid levels including full resolution, each half the size of the one below, down to 16 px per side. More levels
        /// reach larger motion.
        levels: usize = 4, 1..=8;
        /// Largest number of iterations per level.
        iterations: usize = 30, 1..=200;
        /// Stopping criterion: the iterations of a level end with an increment that moves no corner of the picture farther, in px of
        /// the level.
        epsilon: f32 = 0.001, 0.0..=1.0, "px";
        /// Smallest share of the pixels that the warp keeps inside frame t + 1. Below it the alignment has diverged.
        min_overlap: f32 = 0.25, 0.0..=1.0;
    }
    advanced { "iterations", "epsilon", "min-overlap" }
}

/// A level of both pyramids.
struct Level {
    pictures: [Grid<f32>; 2],
    /// Derivatives of frame t, in gray levels per px of the level.
    gradients: OnceLock<[Grid<f32>; 2]>,
}

impl Level {
    fn gradients(&self) -> &[Grid<f32>; 2] {
        self.gradients.get_or_init(|| gradients(&self.pictures[0]))
    }

    fn bytes(&self) -> usize {
        4 * self.pictures[0].cells().len() * size_of::<f32>()
    }
}

/// The constant part of a run.
struct Fixed {
    pair: [Arc<Frame>; 2],
    levels: Vec<Level>,
    truth: Option<Arc<Flow>>,
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    fixed: Arc<Fixed>,
    level: usize,
    /// The next iteration on the level.
    iteration: usize,
    /// The Hessian of the level, row by row.
    hessian: Arc<Vec<f64>>,
    /// The warp in px of level 0, and the one before the last update.
    matrix: Matrix3,
    before: Matrix3,
    compared: Option<Arc<Compared>>,
    increment: Option<Arc<Increment>>,
    /// Level and error of all iterations so far.
    errors: Arc<Vec<(usize, f64)>>,
    /// Number of unsuitable levels: without texture, or diverged.
    failed: usize,
    /// Number of updates of the warp, on all levels.
    updates: usize,
    is_over: bool,
}

/// The outcome of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stage {
    /// The steepest-descent images.
    SteepestDescent,
    /// The Hessian.
    Hessian,
    /// A Hessian that is singular.
    Singular,
    /// The warped picture and its difference.
    Warp,
    /// A warp that leaves the picture.
    Diverged,
    /// A larger error than the one before the last update.
    Worse {
        /// That error, in gray levels.
        before: f64,
    },
    /// The right-hand side and the increment.
    Solve,
    /// Pixels inside frame t + 1 that determine no increment.
    Undetermined,
    /// The new warp.
    Update,
    /// The level has converged: the increment is below ε.
    Converged,
    /// The warp of the last iteration of a level.
    Exhausted,
}

/// A step with the state after it.
#[derive(Clone)]
pub struct Event {
    stage: Stage,
    state: Arc<State>,
}

/// The warp of level 0 in px of a level.
fn on_level(matrix: &Matrix3, level: usize) -> Matrix3 {
    let scale = f64::from(1u32 << level);
    let [a, b, c] = *matrix;
    [[a[0], a[1], a[2] / scale], [b[0], b[1], b[2] / scale], [c[0] * scale, c[1] * scale, c[2]]]
}

/// A warp of a level in px of level 0.
fn on_picture(matrix: &Matrix3, level: usize) -> Matrix3 {
    let scale = f64::from(1u32 << level);
    let [a, b, c] = *matrix;
    [[a[0], a[1], a[2] * scale], [b[0], b[1], b[2] * scale], [c[0] / scale, c[1] / scale, c[2]]]
}

impl State {
    fn level(&self) -> &Level {
        &self.fixed.levels[self.level]
    }

    /// The warp in px of the current level.
    fn warp(&self) -> Matrix3 {
        on_level(&self.matrix, self.level)
    }

    fn model(&self, model: Model) -> ModelField {
        ModelField {
            picture: self.fixed.pair[0].size(),
            model,
            // Without an update on any level, nothing is known.
            matrix: (!self.is_over || self.updates > 0).then_some(self.matrix),
            iterations: self.errors.len(),
            residual_px: None,
            support: None,
        }
    }

    /// The error of the iteration before, on the same level.
    fn previous_error(&self) -> Option<f64> {
        self.errors
            .len()
            .checked_sub(2)
            .and_then(|i| self.errors.get(i))
            .filter(|(level, _)| *level == self.level)
            .map(|(_, rms)| *rms)
    }
}

impl ImageAlignment {
    /// The alignment of the current level.
    fn aligner<'a>(&self, state: &'a State) -> Aligner<'a> {
        let level = state.level();
        Aligner { model: self.model, template: &level.pictures[0], gradients: level.gradients() }
    }

    /// Moves on to the next finer level, or ends the run.
    fn next_level(state: &mut State) {
        match state.level.checked_sub(1) {
            Some(finer) => (state.level, state.iteration) = (finer, 0),
            None => state.is_over = true,
        }
    }

    /// Computes the data shared by all iterations on a level; returns whether its texture determines the warp.
    fn begin_level(&self, state: &mut State, report: &mut impl FnMut(Stage, &State)) -> bool {
        (state.compared, state.increment, state.before) = (None, None, state.matrix);
        report(Stage::SteepestDescent, state);
        state.hessian = Arc::new(self.aligner(state).hessian());
        let is_regular = solve(&state.hessian, &vec![0.0; self.model.freedom()]).is_some();
        report(if is_regular { Stage::Hessian } else { Stage::Singular }, state);
        is_regular
    }

    /// Performs an iteration; `report` is called after each of its stages.
    fn iterate(&self, state: &mut State, mut report: impl FnMut(Stage, &State)) {
        let compared = self.aligner(state).compare(&state.hessian, &state.level().pictures[1], &state.warp());
        Arc::make_mut(&mut state.errors).push((state.level, compared.rms));
        let (is_diverged, rms) = (compared.overlap < f64::from(self.min_overlap), compared.rms);
        let compared = Arc::new(compared);
        state.compared = Some(Arc::clone(&compared));
        report(Stage::Warp, state);
        let worse = state.previous_error().filter(|before| rms > *before).map(|before| Stage::Worse { before });
        if let Some(stage) = is_diverged.then_some(Stage::Diverged).or(worse) {
            state.failed += usize::from(is_diverged);
            state.matrix = state.before;
            report(stage, state);
            return Self::next_level(state);
        }
        let increment = self.aligner(state).increment(&compared);
        let updated = increment.as_ref().and_then(|found| composed(&state.warp(), &found.matrix));
        let Some((increment, updated)) = increment.zip(updated) else {
            report(Stage::Undetermined, state);
            return Self::next_level(state);
        };
        state.increment = Some(Arc::new(increment.clone()));
        report(Stage::Solve, state);
        (state.before, state.matrix) = (state.matrix, on_picture(&updated, state.level));
        state.updates += 1;
        let stage = match state.iteration + 1 == self.iterations {
            _ if increment.moved_px <= f64::from(self.epsilon) => Stage::Converged,
            true => Stage::Exhausted,
            false => Stage::Update,
        };
        report(stage, state);
        if stage == Stage::Update { state.iteration += 1 } else { Self::next_level(state) }
    }
}

pseudocode! {
    START: "build the pyramids of frames t and t+1; W ← no motion",
    EACH_LEVEL: "for each pyramid level, from the coarsest to full resolution",
    STEEPEST_DESCENT: "  D ← steepest-descent images ∇T · ∂W/∂p of frame t",
    HESSIAN: "  H ← Σ D^T D; next level if it is singular",
    REPEAT: "  repeat",
    WARP: "    e(x) ← I(W(x)) − T(x), where W(x) is inside frame t+1",
    STEP_BACK: "    if overlap < min-overlap or RMS of e has risen: W ← W before; next level",
    SOLVE: "    Δp ← H⁻¹ Σ D^T e, both sums over the pixels inside; next level if H is singular there",
    UPDATE: "    W ← W ∘ W(Δp)⁻¹",
    UNTIL_CONVERGED: "  until W(Δp) moves no corner farther than epsilon, or iterations are done",
}

impl Estimator for ImageAlignment {
    const INFO: Info = Info {
        id: "image-alignment",
        name: "Image alignment",
        family: "Correspondence",
        summary: "One transformation of the whole picture by Gauss–Newton iterations on its gray levels, coarse to fine.",
        source: "S. Baker and I. Matthews, Lucas–Kanade 20 years on: a unifying framework, IJCV 56(3), 2004; B. D. Lucas and \
                 T. Kanade, An iterative image registration technique with an application to stereo vision, IJCAI 1981",
        pseudocode: line::ALL,
        granularities: &["pair", "level", "iteration", "step"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::choice(
            "converged",
            "How does the iteration end?",
            &[
                Reply::at(line::UPDATE, "Another iteration follows"),
                Reply::told(line::UNTIL_CONVERGED, case::CONVERGED, "Converged"),
                Reply::told(line::UNTIL_CONVERGED, case::EXHAUSTED, "The iterations are done"),
                Reply::at(line::STEP_BACK, "The step is undone"),
            ],
        ),
        Question::value("rms", "How large is the RMS difference after the warp?", line::WARP, value::RMS),
    ];
    const GUARANTEE: Guarantee = Guarantee::SubPixel { off_centi_px: 3 };
    const CHARTS: &'static [Chart] = &[Chart::Tiles, Chart::Matrices, Chart::Series];
    const PRODUCES: &'static [&'static ProductKind] = &[ModelField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        let pair = clip.pair(frame)?;
        let [first, second] = pair.each_ref().map(|frame| halvings(frame.luma(), self.levels));
        let real = |picture: Grid<u8>| picture.map(|&pixel| f32::from(pixel));
        let level = |(a, b)| Level { pictures: [real(a), real(b)], gradients: OnceLock::new() };
        let levels: Vec<Level> = first.into_iter().zip(second).map(level).collect();
        let level = levels.len() - 1;
        Ok(State {
            fixed: Arc::new(Fixed { pair, levels, truth: truth(clip, frame) }),
            level,
            iteration: 0,
            hessian: Arc::default(),
            matrix: IDENTITY,
            before: IDENTITY,
            compared: None,
            increment: None,
            errors: Arc::default(),
            failed: 0,
            updates: 0,
            is_over: false,
        })
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let mut report = |stage, state: &State| observer.see(|| Event { stage, state: Arc::new(state.clone()) });
        if state.iteration == 0 && !self.begin_level(state, &mut report) {
            state.failed += 1;
            Self::next_level(state);
        } else {
            self.iterate(state, report);
        }
        Ok(if state.is_over { Progress::Done } else { Progress::More })
    }

    fn units(&self, _: &State) -> Option<usize> {
        None
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        let levels = state.fixed.levels.len();
        vec![
            Granularity { index: 0, of: Some(1) },
            Granularity { index: levels - 1 - state.level, of: Some(levels) },
            Granularity { index: state.iteration, of: None },
        ]
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.draw_step(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        Output::of(state.model(self.model))
    }
}

impl Footprint<State> for ImageAlignment {
    fn need(&self, clip: &Clip) -> Need {
        // Pictures and derivatives of all levels; in a walk the error and its tiles.
        Need::per_pixel(clip, [26.0, 50.0])
    }

    fn state_bytes(&self, state: &State) -> usize {
        let sums = size_of_val(&state.hessian[..]) + size_of_val(&state.errors[..]);
        size_of::<State>() + sums + 2 * size_of::<Increment>() + 4 * self.model.freedom() * size_of::<f64>()
    }

    fn memory_bytes(&self, state: &State) -> usize {
        self.state_bytes(state) + state.fixed.levels.iter().map(Level::bytes).sum::<usize>()
    }
}
