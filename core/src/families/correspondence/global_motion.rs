//! The global motion of a pair of frames: one transformation for all matches, by random sample consensus.

mod explain;
mod mosaic;

use std::sync::Arc;

use crate::base::{Error, Observer, Tally, Threads};
use crate::data::{Clip, Flow};
use crate::methods::differential::truth;
use crate::methods::geometric::{
    Correspondence,
    fit::{fit, squared_error},
    ransac::{Score, Scoring, chosen, sample, samples_needed},
    refine::least_squares,
};
use crate::methods::matching::{Pair, Settings};
use crate::products::model::{Matrix3, Model};
use crate::products::{Match, MatchField, MatchStatus, ModelField, Output, Product, ProductKind, Support};
use crate::run::{Estimator, Footprint, Granularity, Guarantee, Info, Need, Progress, Seen};
use crate::scene::{Chart, Role, Scene, Step};
use crate::synth::random::{hash, unit};
use crate::{params, pseudocode};

params! {
    /// One transformation that maps frame t to frame t + 1: RANSAC over matched keypoints.
    pub struct GlobalMotion {
        /// Model of the motion.
        model: Model = Model::Homography;
        /// Detector, descriptor and tests of the matches.
        matching: Settings = Settings::default();
        /// Score of a hypothesis.
        scoring: Scoring = Scoring::LoRansac;
        /// Largest distance of an inlier from its predicted position in frame t + 1.
        threshold: f32 = 3.0, 0.1..=50.0, "px";
        /// Probability of drawing at least one sample without outliers, which decides the number of iterations.
        confidence: f32 = 0.99, 0.5..=0.99999;
        /// Largest number of iterations.
        max_iterations: usize = 2000, 1..=100_000;
        /// Share of the matches that are replaced by random ones. The number of iterations grows steeply with it.
        outliers: f32 = 0.0, 0.0..=0.95;
        /// Random seed. The same seed draws the same samples.
        seed: usize = 1, 0..=1_000_000;
    }
    advanced { "confidence", "max-iterations", "seed" }
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    fixed: Arc<Fixed>,
    /// Number of iterations done.
    iterations: usize,
    /// Number of iterations that are needed with the best hypothesis so far.
    needed: usize,
    best: Option<Best>,
    /// Number of inliers of the best hypothesis after each iteration.
    history: Vec<u32>,
    /// The model after the final fit.
    fitted: Option<Best>,
}

/// A model with its score.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Best {
    matrix: Matrix3,
    score: Score,
}

/// The constant part of a run.
struct Fixed {
    pair: Pair,
    /// The accepted matches, some replaced by random ones.
    matches: Vec<Match>,
    points: Vec<Correspondence>,
    truth: Option<Arc<Flow>>,
}

/// An event of a unit.
#[derive(Clone, Debug)]
pub enum Event {
    /// There are fewer matches than the model needs.
    TooFew,
    /// A sample is drawn.
    Sample(Vec<usize>),
    /// The model through the sample, if it determines one.
    Hypothesis(Option<Matrix3>),
    /// The inliers of the hypothesis were counted.
    Scored(Score),
    /// The new best hypothesis was fitted to its inliers.
    Local(Matrix3, Score),
    /// The hypothesis is the best so far; so many iterations are needed with it.
    Best(usize),
    /// The model was fitted to all inliers.
    Refit(Matrix3, Score),
}

/// Rounds of local optimisation of a new best hypothesis.
const LOCAL_ROUNDS: usize = 3;
/// Rounds of the final fit, each to the inliers of the one before.
const FINAL_ROUNDS: usize = 8;

impl GlobalMotion {
    fn prepare(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let pair = self.matching.pair(clip, frame, threads)?;
        let mut matches = self.matching.matches(&pair, clip, threads)?;
        matches.retain(|found| found.status == MatchStatus::Match);
        self.replace_some(&mut matches, clip.size());
        let position = |at: [f32; 2]| at.map(f64::from);
        let points = matches.iter().map(|m| Correspondence { from: position(m.from), to: position(m.to) }).collect();
        let fixed = Fixed { pair, matches, points, truth: truth(clip, frame) };
        Ok(State {
            fixed: Arc::new(fixed),
            iterations: 0,
            needed: self.max_iterations,
            best: None,
            history: Vec::new(),
            fitted: None,
        })
    }

    /// Replaces a share of the matches by random ones.
    fn replace_some(&self, matches: &mut [Match], (width, height): (usize, usize)) {
        let seed = self.seed as u64;
        for (i, found) in matches.iter_mut().enumerate() {
            let random = |k: u64| unit(hash(seed ^ 0x6f75_746c, i as u64, k));
            if random(0) < f64::from(self.outliers) {
                found.to = [(random(1) * width as f64) as f32, (random(2) * height as f64) as f32];
            }
        }
    }

    fn score(&self, points: &[Correspondence], matrix: &Matrix3) -> Score {
        Score::of(points.iter().map(|m| squared_error(matrix, m)), self.threshold.into(), self.scoring)
    }

    fn inliers(&self, points: &[Correspondence], matrix: &Matrix3) -> Vec<Correspondence> {
        let limit = f64::from(self.threshold).powi(2);
        points.iter().copied().filter(|m| squared_error(matrix, m) <= limit).collect()
    }

    fn is_sampling(&self, state: &State) -> bool {
        state.iterations < state.needed
    }

    /// Draws a sample, and keeps its model if it is the best so far.
    fn iterate(&self, state: &mut State, observer: &mut impl Observer<Event>) {
        let fixed = Arc::clone(&state.fixed);
        let indices = sample(self.model.sample_size(), fixed.points.len(), self.seed as u64, state.iterations);
        state.iterations += 1;
        let hypothesis = fit(self.model, &chosen(&fixed.points, &indices));
        observer.see(|| Event::Sample(indices));
        observer.see(|| Event::Hypothesis(hypothesis));
        if let Some(matrix) = hypothesis {
            let score = self.score(&fixed.points, &matrix);
            observer.see(|| Event::Scored(score));
            if state.best.is_none_or(|best| score.is_better(&best.score)) {
                self.keep(state, Best { matrix, score }, observer);
            }
        }
        state.history.push(state.best.map_or(0, |best| best.score.inliers as u32));
    }

    fn keep(&self, state: &mut State, mut best: Best, observer: &mut impl Observer<Event>) {
        let fixed = Arc::clone(&state.fixed);
        let rounds = if self.scoring == Scoring::LoRansac { LOCAL_ROUNDS } else { 0 };
        for _ in 0..rounds {
            let Some(matrix) = fit(self.model, &self.inliers(&fixed.points, &best.matrix)) else { break };
            let score = self.score(&fixed.points, &matrix);
            if !score.is_better(&best.score) {
                break;
            }
            observer.see(|| Event::Local(matrix, score));
            best = Best { matrix, score };
        }
        let share = best.score.inliers as f64 / fixed.points.len() as f64;
        let size = self.model.sample_size();
        state.needed = samples_needed(share, size, self.confidence.into(), self.max_iterations);
        observer.see(|| Event::Best(state.needed));
        state.best = Some(best);
    }

    /// Fits the best hypothesis to all of its inliers, until these stay the same.
    fn refit(&self, state: &mut State, observer: &mut impl Observer<Event>) {
        let fixed = Arc::clone(&state.fixed);
        let Some(mut best) = state.best else { return observer.see(|| Event::TooFew) };
        for round in 0..FINAL_ROUNDS {
            let before = best.score;
            let refined = least_squares(self.model, &self.inliers(&fixed.points, &best.matrix));
            let matrix = refined.unwrap_or(best.matrix);
            let score = self.score(&fixed.points, &matrix);
            best = Best { matrix, score };
            observer.see(|| Event::Refit(matrix, score));
            if round > 0 && score.inliers == before.inliers && (score.squared - before.squared).abs() < 1e-9 {
                break;
            }
        }
        state.fitted = Some(best);
    }

    /// The matches, with outliers marked once the model is known.
    fn judged(&self, state: &State) -> Vec<Match> {
        let limit = f64::from(self.threshold).powi(2);
        let all = state.fixed.matches.iter().zip(&state.fixed.points);
        let judge = |(found, point): (&Match, &Correspondence)| match state.fitted {
            Some(Best { matrix, .. }) if squared_error(&matrix, point) > limit => {
                Match { status: MatchStatus::Outlier, ..*found }
            }
            _ => *found,
        };
        all.map(judge).collect()
    }

    fn model_of(&self, state: &State) -> ModelField {
        let best = state.fitted.or(state.best);
        let residual = |Best { score, .. }: Best| (score.squared / score.inliers.max(1) as f64).sqrt();
        ModelField {
            picture: state.fixed.pair.frames[0].size(),
            model: self.model,
            matrix: best.map(|best| best.matrix),
            iterations: state.iterations,
            residual_px: best.map(residual),
            support: Some(Support {
                inliers: best.map_or(0, |best| best.score.inliers),
                matches: state.fixed.matches.len(),
            }),
        }
    }
}

pseudocode! {
    MATCH: "match the keypoints of frames t and t+1; N ← max-iterations",
    REPEAT: "for each iteration k = 1, 2, … N",
    DRAW: "  draw a sample of n matches, as many as determine the model",
    HYPOTHESISE: "  H ← the model through the sample",
    COUNT: "  count the inliers: matches with |x′ − H x| at most the threshold",
    OPTIMISE: "    LO-RANSAC: fit H to its inliers while that adds inliers",
    KEEP_BEST: "  if H is the best so far: keep it; w ← share of inliers, N ← log(1 − p) / log(1 − wⁿ)",
    REFIT: "fit H to all inliers by least squares, until these stay the same",
}

impl Estimator for GlobalMotion {
    const INFO: Info = Info {
        id: "global-motion",
        name: "Global motion (RANSAC)",
        family: "Correspondence",
        summary: "One transformation for the whole picture, estimated from matches of which some are wrong.",
        source: "M. A. Fischler and R. C. Bolles, Random sample consensus, Communications of the ACM 24(6), 1981; R. Hartley and A. Zisserman, \
                 Multiple view geometry, 2004, chapter 4",
        pseudocode: line::ALL,
        granularities: &["frame", "iteration", "step"],
        frames: 2,
    };
    const GUARANTEE: Guarantee = Guarantee::Better;
    const CHARTS: &'static [Chart] = &[Chart::Matrices, Chart::Series];
    const PRODUCES: &'static [&'static ProductKind] = &[ModelField::KIND, MatchField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        self.prepare(clip, frame, &Threads::single())
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        if state.fixed.points.len() < self.model.sample_size() {
            observer.see(|| Event::TooFew);
            return Ok(Progress::Done);
        }
        if self.is_sampling(state) {
            self.iterate(state, observer);
            return Ok(Progress::More);
        }
        self.refit(state, observer);
        Ok(Progress::Done)
    }

    fn units(&self, _: &State) -> Option<usize> {
        None
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        let iterations = Granularity { index: state.iterations, of: Some(state.needed.max(state.iterations) + 1) };
        vec![Granularity { index: 0, of: Some(1) }, iterations]
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        matches!(event, Event::Best(_)).then_some(Role::Best)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.draw_step(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        let matches = MatchField { picture: state.fixed.pair.frames[0].size(), matches: self.judged(state) };
        Output::of(self.model_of(state)).and(matches)
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads, tally: &impl Tally<Event>) -> Result<State, Error> {
        let mut state = self.prepare(clip, frame, threads)?;
        let (mut counter, mut units) = (tally.counter(), 1);
        while self.advance(clip, &mut state, &mut counter)? == Progress::More {
            clip.wanted()?;
            units += 1;
        }
        tally.add_units(units);
        Ok(state)
    }
}

impl Footprint<State> for GlobalMotion {
    fn need(&self, clip: &Clip) -> Need {
        self.matching.need(clip)
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of::<State>() + size_of_val(&state.history[..])
    }

    fn memory_bytes(&self, state: &State) -> usize {
        self.state_bytes(state) + state.fixed.pair.bytes() + 80 * state.fixed.matches.len()
    }
}
