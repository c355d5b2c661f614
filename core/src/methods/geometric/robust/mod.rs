//! Robust estimation of a geometric model from matches: RANSAC as an estimator, for any model.
//!
//! [`Robust`] turns any [`RobustModel`] into an estimator: fits to a sample and to inliers, and a distance. It draws samples,
//! counts inliers, keeps the best model and explains each step; [`Robust::estimate`] is the same loop on given matches.
//! [`RobustModel::sequel`] explains steps that follow from the final model: registration, guided matching, rectification. The
//! products are a `ModelField`, one transformation of the plane with a flow at every pixel, and an `EpipolarField`, which has
//! none.

mod charts;
mod declare;
mod doubt;
mod explain;
mod place;
mod settings;
mod vocabulary;

use std::sync::Arc;

use super::Correspondence;
use super::ransac::{Samples, Score, Scoring, chosen, sample, samples_needed};
use super::system::System;
use crate::base::{Error, Observer, Tally, Threads};
use crate::data::{Clip, Flow};
use crate::methods::differential::truth;
use crate::methods::matching::{self, Pair};
use crate::params::{Params, inner_params};
use crate::products::model::Matrix3;
use crate::products::{Match, MatchField, MatchStatus, Output, Product, ProductKind};
use crate::run::{Estimator, Explained, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen};
use crate::scene::{Chart, Focus, Name, Picture, Question, Role, Scene, Step};
use crate::synth::random::{hash, unit};

use declare::QUESTIONS;
pub(crate) use declare::robust_pseudocode;
pub use doubt::Doubt;
use doubt::{distinct, sides_px};
pub use place::Place;
pub use settings::Settings;
pub(crate) use vocabulary::{case, value};

/// A geometric model that is estimated from matches.
pub trait RobustModel: Params + Default + Clone + Send + Sync + 'static {
    /// Its declaration.
    const INFO: Info;
    /// The kind of its product.
    const PRODUCT: &'static ProductKind;
    /// The symbol of its matrix.
    const SYMBOL: &'static str;
    /// The distance of a match from it, in words.
    const DISTANCE: &'static str;

    /// The parameters of the matching.
    fn matching(&self) -> &matching::Settings;

    /// The parameters of the robust estimation.
    fn settings(&self) -> &Settings;

    /// Its name in a sentence.
    fn name(&self) -> &'static str;

    /// Number of matches of a sample.
    fn sample_size(&self) -> usize;

    /// Tells the reason for the size of a sample.
    fn counting(&self, step: Step) -> Step;

    /// The models through a sample; none if it determines none.
    fn hypotheses(&self, sample: &[Correspondence]) -> Vec<Matrix3>;

    /// Tells the reason why a sample determines no model.
    fn no_model(&self, step: Step, _sample: &[Correspondence]) -> Step {
        step.say(case::COLLINEAR)
    }

    /// Number of inliers of each further sample by which the last hypothesis is optimised; 0 for none.
    fn resample_size(&self) -> usize {
        0
    }

    /// The linear system of a fit to matches in numbers; empty where the fit has a closed form.
    fn system(&self, _matches: &[Correspondence]) -> System {
        System::default()
    }

    /// The model fitted to inliers quickly.
    fn local(&self, inliers: &[Correspondence]) -> Option<Matrix3>;

    /// The model fitted to all inliers at the end.
    fn last(&self, inliers: &[Correspondence]) -> Option<Matrix3>;

    /// Writes the squared distance of each match from the model in px².
    fn squared_errors(matrix: &Matrix3, matches: &[Correspondence], errors: &mut [f64]);

    /// Share of a picture of this many px² in which a random match is an inlier.
    fn share_of_area(threshold_px: f64, sides_px: [f64; 2]) -> f64;

    /// Whether points on a line determine it.
    fn is_known_on_line(&self) -> bool;

    /// The product of a run so far.
    fn output(&self, estimate: &Estimate<'_>) -> Output;

    /// Tells the quality of the final model and what it means.
    fn conclusion(&self, step: Step, estimate: &Estimate<'_>) -> Step;

    /// Adds further formulas about the final model.
    fn formulas(&self, step: Step, _estimate: &Estimate<'_>) -> Step {
        step
    }

    /// The lines of the steps that follow from the final model.
    const SEQUELS: &'static [Name] = &[];

    /// Explains one of them.
    fn sequel(&self, step: Step, _index: usize, _estimate: &Estimate<'_>, _focus: Option<Focus>) -> Step {
        step
    }

    /// Draws one of them.
    fn draw_sequel(&self, _index: usize, _estimate: &Estimate<'_>, _focus: Option<Focus>, _scene: &mut Scene) {}

    /// Draws a model; `focus` is the point pointed at.
    fn draw(&self, estimate: &Estimate<'_>, matrix: Matrix3, focus: Option<Focus>, scene: &mut Scene);
}

/// The estimate at some time of a run.
pub struct Estimate<'a> {
    /// The frames with their keypoints.
    pub pair: &'a Pair,
    /// The matches, some replaced by random ones.
    pub points: &'a [Correspondence],
    /// The true flow, if it is known.
    pub truth: Option<&'a Flow>,
    /// The model, once there is a hypothesis.
    pub best: Option<Best>,
    /// Number of iterations done.
    pub iterations: usize,
    /// Where the inliers lie, at the end of a run.
    pub place: Option<Place>,
}

/// A model with its score.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Best {
    /// The matrix.
    pub matrix: Matrix3,
    /// Its score.
    pub score: Score,
}

impl Estimate<'_> {
    /// Width and height of a frame in px.
    pub fn size(&self) -> (usize, usize) {
        self.pair.frames[0].size()
    }
}

impl Best {
    /// Root mean square distance of the inliers in px.
    pub fn rms_px(&self) -> f64 {
        (self.score.squared / self.score.inliers.max(1) as f64).sqrt()
    }
}

/// The estimator of the model `M`.
#[derive(Clone, Debug, Default)]
pub struct Robust<M>(pub M);

inner_params!(Robust<M: RobustModel>);

/// The state of a run.
#[derive(Clone)]
pub struct State {
    fixed: Arc<Fixed>,
    consensus: Consensus,
}

/// The progress of random sample consensus.
#[derive(Clone, Debug)]
pub struct Consensus {
    /// Number of iterations done.
    pub iterations: usize,
    /// Number of iterations that are needed with the best hypothesis so far.
    pub needed: usize,
    /// The best hypothesis so far.
    pub best: Option<Best>,
    /// The inliers counted in each iteration.
    pub history: Vec<InlierCounts>,
    /// The model after the final fit.
    pub fitted: Option<Best>,
}

/// The inliers counted in an iteration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InlierCounts {
    /// The most inliers of its hypotheses; `None` if the sample determines no model.
    pub own: Option<usize>,
    /// The inliers of the best hypothesis so far; `None` before the first.
    pub best: Option<usize>,
}

/// The constant part of a run.
struct Fixed {
    /// Frame t.
    frame: usize,
    pair: Pair,
    /// The accepted matches, some replaced by random ones.
    matches: Vec<Match>,
    points: Vec<Correspondence>,
    /// Number of matches at distinct positions.
    distinct: usize,
    truth: Option<Arc<Flow>>,
}

/// An event of a unit.
#[derive(Clone, Debug)]
pub enum Event {
    /// There are fewer matches at distinct positions than the model needs, or no sample determines it.
    TooFew,
    /// A sample is drawn.
    Sample(Vec<usize>),
    /// The sample determines no model.
    Degenerate,
    /// A model through the sample.
    Hypothesis(Matrix3),
    /// The inliers of the hypothesis were counted; whether it is the best so far.
    Scored(Score, bool),
    /// The new best hypothesis was fitted to its inliers.
    Local(Matrix3, Score),
    /// The hypothesis is the best so far; the number of iterations needed with it.
    Best(Samples),
    /// The best hypothesis was compared with this many models through samples of its inliers; the best of all, and its score.
    Resampled(usize, Matrix3, Score),
    /// The model was fitted to all inliers, which lowers its cost.
    Refit(Matrix3, Score),
    /// A fit to all inliers does not lower the cost of the model, which stays.
    Kept(Matrix3, Score),
    /// The model is rejected, because its inliers do not support it.
    Doubted(Doubt),
    /// A step that follows from the final model, by its index.
    Sequel(usize, Best),
}

/// Rounds of local optimisation of a new best hypothesis.
const LOCAL_ROUNDS: usize = 3;
/// Most samples of the inliers of the best hypothesis.
const RESAMPLES: usize = 50;
/// Number of successive samples with the same cost after which no further one is drawn.
const RESAMPLES_ALIKE: usize = 5;
/// Largest relative difference of costs that count as equal.
const ALIKE: f64 = 0.01;
/// Rounds of the final fit, each to the inliers of the previous one.
const FINAL_ROUNDS: usize = 8;

impl State {
    fn estimate(&self) -> Estimate<'_> {
        Estimate {
            pair: &self.fixed.pair,
            points: &self.fixed.points,
            truth: self.fixed.truth.as_deref(),
            best: self.consensus.fitted.or(self.consensus.best),
            iterations: self.consensus.iterations,
            place: None,
        }
    }
}

impl<M: RobustModel> Robust<M> {
    fn prepare(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let matching = self.0.matching();
        let pair = matching.pair(clip, frame, threads)?;
        let mut matches = matching.matches(&pair, clip, threads)?;
        matches.retain(|found| found.status == MatchStatus::Match);
        self.replace_some(&mut matches, clip.size());
        let position = |at: [f32; 2]| at.map(f64::from);
        let points: Vec<_> =
            matches.iter().map(|m| Correspondence { from: position(m.from), to: position(m.to) }).collect();
        let fixed = Fixed { frame, pair, matches, distinct: distinct(&points), points, truth: truth(clip, frame) };
        Ok(State { fixed: Arc::new(fixed), consensus: self.begin() })
    }

    fn begin(&self) -> Consensus {
        let needed = self.0.settings().max_iterations;
        Consensus { iterations: 0, needed, best: None, history: Vec::new(), fitted: None }
    }

    /// Estimates the model from given matches. The consensus has no final model if there are too few of them.
    pub fn estimate(&self, points: &[Correspondence]) -> Consensus {
        let mut consensus = self.begin();
        let is_enough = distinct(points) >= self.0.sample_size();
        while is_enough && consensus.iterations < consensus.needed {
            self.iterate(points, &mut consensus, &mut ());
        }
        self.refit(points, &mut consensus, &mut ());
        consensus
    }

    /// Replaces a share of the matches by random ones.
    fn replace_some(&self, matches: &mut [Match], (width, height): (usize, usize)) {
        /// A stream of its own, apart from the samples'.
        const STREAM: u64 = 0x6f75_746c;
        let Settings { seed, outliers, .. } = *self.0.settings();
        for (i, found) in matches.iter_mut().enumerate() {
            let random = |k: u64| unit(hash(seed as u64 ^ STREAM, i as u64, k));
            if random(0) < f64::from(outliers) {
                found.to = [(random(1) * width as f64) as f32, (random(2) * height as f64) as f32];
            }
        }
    }

    fn score(&self, points: &[Correspondence], matrix: &Matrix3) -> Score {
        let Settings { threshold, scoring, .. } = *self.0.settings();
        Score::of(&Self::errors(points, matrix), threshold.into(), scoring)
    }

    fn inliers(&self, points: &[Correspondence], matrix: &Matrix3) -> Vec<Correspondence> {
        let all = points.iter().zip(self.are_inliers(points, matrix));
        all.filter(|(_, is_inlier)| *is_inlier).map(|(m, _)| *m).collect()
    }

    fn are_inliers(&self, points: &[Correspondence], matrix: &Matrix3) -> impl Iterator<Item = bool> + use<M> {
        let limit = f64::from(self.0.settings().threshold).powi(2);
        Self::errors(points, matrix).into_iter().map(move |error| error <= limit)
    }

    fn errors(points: &[Correspondence], matrix: &Matrix3) -> Vec<f64> {
        let mut errors = vec![0.0; points.len()];
        M::squared_errors(matrix, points, &mut errors);
        errors
    }

    /// Why the inliers of a model do not support it, if they do not.
    fn doubt(&self, points: &[Correspondence], best: &Best) -> Option<Doubt> {
        let inliers = self.inliers(points, &best.matrix);
        let on_line = (!self.0.is_known_on_line()).then(|| Doubt::on_line(&inliers)).flatten();
        on_line.or_else(|| {
            let share = M::share_of_area(self.0.settings().threshold.into(), sides_px(points));
            Doubt::by_chance(self.0.sample_size(), [distinct(&inliers), distinct(points)], share)
        })
    }

    /// Draws a sample, and keeps its model if it is the best so far.
    fn iterate(&self, points: &[Correspondence], consensus: &mut Consensus, observer: &mut impl Observer<Event>) {
        let seed = self.0.settings().seed as u64;
        let indices = sample(self.0.sample_size(), points.len(), seed, consensus.iterations);
        consensus.iterations += 1;
        let hypotheses = self.0.hypotheses(&chosen(points, &indices));
        observer.see(|| Event::Sample(indices));
        if hypotheses.is_empty() {
            observer.see(|| Event::Degenerate);
        }
        let mut own = None;
        for matrix in hypotheses {
            observer.see(|| Event::Hypothesis(matrix));
            let score = self.score(points, &matrix);
            let is_best = consensus.best.is_none_or(|best| score.is_better(&best.score));
            observer.see(|| Event::Scored(score, is_best));
            own = own.max(Some(score.inliers));
            if is_best {
                self.keep(points, consensus, Best { matrix, score }, observer);
            }
        }
        consensus.history.push(InlierCounts { own, best: consensus.best.map(|best| best.score.inliers) });
    }

    fn keep(
        &self,
        points: &[Correspondence],
        consensus: &mut Consensus,
        mut best: Best,
        observer: &mut impl Observer<Event>,
    ) {
        let Settings { scoring, confidence, max_iterations, .. } = *self.0.settings();
        let rounds = if scoring == Scoring::LoRansac { LOCAL_ROUNDS } else { 0 };
        for _ in 0..rounds {
            let Some(matrix) = self.0.local(&self.inliers(points, &best.matrix)) else { break };
            let score = self.score(points, &matrix);
            if !score.is_better(&best.score) {
                break;
            }
            observer.see(|| Event::Local(matrix, score));
            best = Best { matrix, score };
        }
        let share = best.score.inliers as f64 / points.len() as f64;
        let samples = samples_needed(share, self.0.sample_size(), confidence.into(), max_iterations);
        consensus.needed = samples.count;
        observer.see(|| Event::Best(samples));
        consensus.best = Some(best);
    }

    /// Compares the best hypothesis with models through samples of its inliers, each fitted to its own inliers again.
    fn resample(&self, points: &[Correspondence], mut best: Best, observer: &mut impl Observer<Event>) -> Best {
        /// A stream of its own, apart from the other samples'.
        const STREAM: u64 = 0x696e_6e65;
        let Settings { scoring, seed, .. } = *self.0.settings();
        if scoring != Scoring::LoRansac || self.0.resample_size() == 0 {
            return best;
        }
        let (mut inliers, mut alike, mut tried) = (self.inliers(points, &best.matrix), 0, 0);
        while tried < RESAMPLES && alike < RESAMPLES_ALIKE {
            let size = self.0.resample_size().min(inliers.len() / 2);
            if size < self.0.sample_size() {
                break;
            }
            let indices = sample(size, inliers.len(), seed as u64 ^ STREAM, tried);
            tried += 1;
            let through = self.0.local(&chosen(&inliers, &indices));
            let fitted = through.and_then(|matrix| self.0.local(&self.inliers(points, &matrix)).or(Some(matrix)));
            let Some(matrix) = fitted else { continue };
            let score = self.score(points, &matrix);
            let is_alike = (score.cost - best.score.cost).abs() <= ALIKE * best.score.cost;
            alike = if is_alike { alike + 1 } else { 0 };
            if score.is_better(&best.score) {
                best = Best { matrix, score };
                inliers = self.inliers(points, &matrix);
            }
        }
        if tried > 0 {
            observer.see(|| Event::Resampled(tried, best.matrix, best.score));
        }
        best
    }

    /// Fits the best hypothesis to all of its inliers, as long as that lowers the limited sum of squared errors.
    fn refit(&self, points: &[Correspondence], consensus: &mut Consensus, observer: &mut impl Observer<Event>) {
        let Some(best) = consensus.best else { return observer.see(|| Event::TooFew) };
        let mut best = self.resample(points, best, observer);
        let limit = f64::from(self.0.settings().threshold).powi(2);
        let limited = |score: &Score| score.limited(limit, points.len());
        for round in 0..FINAL_ROUNDS {
            let refined = self.0.last(&self.inliers(points, &best.matrix));
            let next = refined.map(|matrix| Best { matrix, score: self.score(points, &matrix) });
            // Smaller changes are rounding.
            let Some(next) = next.filter(|next| limited(&next.score) < limited(&best.score) - 1e-9) else {
                if round == 0 {
                    observer.see(|| Event::Kept(best.matrix, best.score));
                }
                break;
            };
            best = next;
            observer.see(|| Event::Refit(best.matrix, best.score));
        }
        let doubt = self.doubt(points, &best);
        if let Some(doubt) = doubt {
            observer.see(|| Event::Doubted(doubt));
        }
        let kept = Some(best).filter(|_| doubt.is_none());
        (consensus.fitted, consensus.best) = (kept, kept);
        if let Some(best) = kept {
            (0..M::SEQUELS.len()).for_each(|index| observer.see(|| Event::Sequel(index, best)));
        }
    }

    /// The matches, with outliers marked once the model is known.
    fn judged(&self, state: &State) -> Vec<Match> {
        let Fixed { matches, points, .. } = &*state.fixed;
        let Some(Best { matrix, .. }) = state.consensus.fitted else { return matches.clone() };
        let judge = |(found, is_inlier): (&Match, bool)| match is_inlier {
            true => *found,
            false => Match { status: MatchStatus::Outlier, ..*found },
        };
        matches.iter().zip(self.are_inliers(points, &matrix)).map(judge).collect()
    }
}

impl<M: RobustModel> Estimator for Robust<M> {
    const INFO: Info = M::INFO;
    const QUESTIONS: &'static [Question] = QUESTIONS;
    const GUARANTEE: Guarantee = Guarantee::Better;
    const CHARTS: &'static [Chart] = &[Chart::Matrices, Chart::Series];
    const PRODUCES: &'static [&'static ProductKind] = &[M::PRODUCT, MatchField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        self.prepare(clip, frame, &Threads::single())
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let (fixed, consensus) = (Arc::clone(&state.fixed), &mut state.consensus);
        if fixed.distinct < self.0.sample_size() {
            observer.see(|| Event::TooFew);
            return Ok(Progress::Done);
        }
        if consensus.iterations < consensus.needed {
            self.iterate(&fixed.points, consensus, observer);
            return Ok(Progress::More);
        }
        self.refit(&fixed.points, consensus, observer);
        Ok(Progress::Done)
    }

    fn units(&self, _: &State) -> Option<usize> {
        None
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        let Consensus { iterations, needed, .. } = state.consensus;
        let iterations = Granularity { index: iterations, of: Some(needed.max(iterations) + 1) };
        vec![Granularity { index: 0, of: Some(1) }, iterations]
    }

    fn landmark(&self, event: &Event) -> Option<Role> {
        matches!(event, Event::Best(_)).then_some(Role::Best)
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
        let matches = MatchField { picture: state.fixed.pair.frames[0].size(), matches: self.judged(state) };
        self.0.output(&state.estimate()).and(matches)
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

impl<M: RobustModel> Footprint<State> for Robust<M> {
    fn need(&self, clip: &Clip) -> Need {
        self.0.matching().need(clip)
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of::<State>() + size_of_val(&state.consensus.history[..])
    }

    fn memory_bytes(&self, state: &State) -> usize {
        /// Of a match and its positions.
        const MATCH: usize = size_of::<Match>() + size_of::<Correspondence>();
        self.state_bytes(state) + state.fixed.pair.bytes() + MATCH * state.fixed.matches.len()
    }
}

impl<M: RobustModel> Pointed<State> for Robust<M> {
    fn takes(&self, picture: Picture) -> bool {
        [Picture::CURRENT, Picture::NEXT].contains(&picture)
    }

    fn explained(&self, _: &State, _: Focus) -> Option<Explained> {
        Some(Explained::Always)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::families::correspondence::{EpipolarGeometry, GlobalMotion};
    use crate::products::model::mapped;
    use crate::synth::random::gaussian;

    /// Noisy matches of a plane, or with a parallax of up to 20 px; every third one is wrong.
    fn matches(parallax_px: f64, seed: u64) -> Vec<Correspondence> {
        let truth = [[1.02, 0.05, 6.0], [-0.04, 0.99, -3.0], [5e-5, -2e-5, 1.0]];
        let one = |i: usize| {
            let random = |k: u64| unit(hash(seed, i as u64, k));
            let off = |k: u64| 0.6 * gaussian(hash(seed + 1, i as u64, k));
            let from = [320.0 * random(0), 240.0 * random(1)];
            let [u, v] = mapped(&truth, from).expect("before the horizon");
            let to = match i % 3 {
                0 => [320.0 * random(2), 240.0 * random(3)],
                _ => [u + parallax_px * random(4) + off(0), v + off(1)],
            };
            Correspondence { from, to }
        };
        (0..150).map(one).collect()
    }

    /// Checks that the best score and the final fits only fall; returns the number of final fits.
    fn falls<M: RobustModel>(robust: &Robust<M>, points: &[Correspondence]) -> usize {
        let mut consensus = robust.begin();
        let mut cost = f64::INFINITY;
        while consensus.iterations < consensus.needed {
            robust.iterate(points, &mut consensus, &mut ());
            let next = consensus.best.map_or(f64::INFINITY, |best| best.score.cost);
            assert!(next <= cost, "iteration {}: {next} after {cost}", consensus.iterations);
            cost = next;
        }
        let limit = f64::from(robust.0.settings().threshold).powi(2);
        let before = consensus.best.map_or(f64::INFINITY, |best| best.score.limited(limit, points.len()));
        let mut events = Vec::new();
        robust.refit(points, &mut consensus, &mut events);
        let mut limited = before;
        let mut fits = 0;
        for event in &events {
            let (Event::Resampled(_, _, score) | Event::Refit(_, score) | Event::Kept(_, score)) = event else {
                continue;
            };
            let next = score.limited(limit, points.len());
            assert!(next <= limited, "fit {fits}: {next} after {limited}");
            limited = next;
            fits += usize::from(matches!(event, Event::Refit(..)));
        }
        let kept = consensus.fitted.expect("half of the matches agree").score.limited(limit, points.len());
        assert!(kept <= limited, "{kept} is kept of {limited}");
        fits
    }

    #[test]
    fn several_matches_of_a_point_support_no_model() {
        let places = [[20.0, 30.0], [250.0, 40.0], [230.0, 200.0], [35.0, 180.0], [140.0, 90.0], [90.0, 150.0]];
        // Wildly displaced, so that no two points move alike; two matches of each.
        let one = |i: usize| {
            let [x, y] = places[i / 2];
            let by = |k: u64| 30.0 * unit(hash(5, (i / 2) as u64, k));
            Correspondence { from: [x, y], to: [x + by(0), y + by(1)] }
        };
        let all: Vec<Correspondence> = (0..12).map(one).collect();
        let mut motion = Robust::<GlobalMotion>::default();
        motion.set("model", "homography").expect("it is one");
        // A homography passes through any four points.
        assert_eq!(motion.estimate(&all[..8]).fitted, None);
        assert_eq!(motion.estimate(&all[..6]).iterations, 0, "3 of 4 distinct positions");
        let epipolar = Robust::<EpipolarGeometry>::default();
        assert_eq!(epipolar.estimate(&all).iterations, 0, "6 of 7 distinct positions");
    }

    #[test]
    fn the_cost_of_fits_to_the_inliers_never_rises() {
        let mut fits = 0;
        for (scoring, seed) in
            ["ransac", "msac", "lo-ransac"].into_iter().flat_map(|id| (0..4).map(move |i| (id, 10 * i)))
        {
            for model in ["similarity", "affine", "homography"] {
                let mut motion = Robust::<GlobalMotion>::default();
                [("scoring", scoring), ("model", model)]
                    .into_iter()
                    .for_each(|(name, value)| motion.set(name, value).expect("it is one"));
                fits += falls(&motion, &matches(0.0, seed));
            }
            let mut epipolar = Robust::<EpipolarGeometry>::default();
            epipolar.set("scoring", scoring).expect("it is one");
            fits += falls(&epipolar, &matches(20.0, seed));
        }
        assert!(fits > 24, "{fits} fits of 48 runs");
    }
}
