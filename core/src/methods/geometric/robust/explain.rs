//! The explanation of robust estimation.

use super::declare::line;
use super::doubt::{Doubt, LEAST_SPREAD_PX, distinct};
use super::vocabulary::{case, value};
use super::{Best, Estimate, Event, Place, Robust, RobustModel, Settings, State};
use crate::base::words::further_digits;
use crate::methods::geometric::ransac::{Samples, Score, Scoring, chosen};
use crate::products::model::Matrix3;
use crate::run::Seen;
use crate::scene::{Name, Number, Role, Step, Unit, Value};

impl<M: RobustModel> Robust<M> {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let Some(event) = seen.events.last() else {
            let step = Step::at(line::MATCH).put(value::MATCHES, seen.before.fixed.matches.len());
            return step.put(value::MODEL, self.0.name()).say(case::OPENING);
        };
        let at = |line: Name| self.put(Step::at(line), seen, event);
        let state = seen.before;
        let step = match event {
            Event::TooFew => self.tell_too_few(at(line::REPEAT), state),
            Event::Sample(_) => self.0.counting(at(line::DRAW).say(case::SAMPLE)),
            Event::Degenerate => {
                self.tell_degenerate(at(line::HYPOTHESISE).say(case::DEGENERATE), seen).say(case::SKIPPED)
            }
            Event::Hypothesis(_) => at(line::HYPOTHESISE).put(value::SYMBOL, M::SYMBOL).say(case::HYPOTHESIS),
            Event::Scored(score, is_best) => self.tell_score(at(line::COUNT), score, *is_best),
            Event::Local(_, score) => put_fit(at(line::OPTIMISE), score, Role::Candidate).say(case::LOCAL),
            Event::Best(Samples { is_limited, .. }) => {
                at(line::KEEP_BEST).say(case::BEST).say(if *is_limited { case::NEEDED_AT_MOST } else { case::NEEDED })
            }
            Event::Resampled(tried, _, score) => {
                let step = put_fit(at(line::OPTIMISE), score, Role::Best).put(value::MODEL_COST, score.cost);
                let step = step.put(value::RESAMPLED, *tried).put(value::RESAMPLE_SIZE, self.0.resample_size());
                step.say(case::RESAMPLED)
            }
            Event::Sequel(index, best) => {
                self.0.sequel(at(M::SEQUELS[*index]), *index, &ended(state, *best), seen.focus)
            }
            Event::Refit(_, score) => put_fit(at(line::REFIT), score, Role::Result).say(case::REFIT).say(case::FITTED),
            Event::Kept(_, score) => put_fit(at(line::REFIT), score, Role::Result).say(case::KEPT).say(case::FITTED),
            Event::Doubted(doubt) => tell_doubt(at(line::REFIT).say(case::DOUBTED), *doubt, state),
        };
        self.add_charts(self.formulas(self.conclude(step, seen), seen), seen, event)
    }

    /// Puts the matches, the iterations and the best model at the end of the events so far.
    fn put(&self, step: Step, seen: &Seen<Self>, event: &Event) -> Step {
        let (state, best, count) = (seen.before, self.best_now(seen), seen.before.fixed.points.len());
        let (iterations, size) = (state.consensus.iterations + usize::from(!is_last(event)), self.0.sample_size());
        let needed = if let Event::Best(samples) = event { samples.count } else { state.consensus.needed };
        let Settings { confidence, max_iterations, threshold, .. } = *self.0.settings();
        let confidence = f64::from(confidence);
        let step =
            step.put(value::MODEL, self.0.name()).put(value::SAMPLE_SIZE, size).put(value::DISTANCE, M::DISTANCE);
        let step =
            step.put(value::THRESHOLD, threshold).put(value::CONFIDENCE, confidence).put_value(percent(confidence));
        let step = step.put(value::MAX_ITERATIONS, max_iterations).put(value::DISTINCT, state.fixed.distinct);
        let mut step = step.fact(value::MATCHES, count).fact(value::ITERATIONS, iterations);
        if let Some((_, score)) = best {
            step = step.fact_as(value::BEST_INLIERS.is(score.inliers), case::BEST_OF);
            step = step.fact(value::BEST_RMS, rms(&score)).put(value::BEST_COST, score.cost);
        }
        // The final fit has other inliers than the hypothesis that the number of iterations follows from.
        if let Some((_, score)) = self.best_hypothesis(seen) {
            let share = score.inliers as f64 / count as f64;
            step = step.put(value::SHARE, share).put(value::PURITY, share.powi(size as i32));
        }
        step.fact(value::NEEDED, needed)
    }

    fn tell_degenerate(&self, step: Step, seen: &Seen<Self>) -> Step {
        let drawn = seen.events.iter().rev().find_map(|event| match event {
            Event::Sample(indices) => Some(chosen(&seen.before.fixed.points, indices)),
            _ => None,
        });
        let drawn = drawn.unwrap_or_default();
        match distinct(&drawn) < drawn.len() {
            true => step.say(case::SAME_POSITION),
            false => self.0.no_model(step, &drawn),
        }
    }

    fn tell_too_few(&self, step: Step, state: &State) -> Step {
        let size = self.0.sample_size();
        match (state.fixed.points.len() < size, state.fixed.distinct < size) {
            (true, _) => step.say(case::TOO_FEW).say(case::ADVISE_MATCHES),
            (false, true) => step.say(case::TOO_FEW_POSITIONS).say(case::ADVISE_MATCHES),
            (false, false) => step.put(value::SAMPLES, state.consensus.iterations).say(case::ALL_DEGENERATE),
        }
    }

    fn tell_score(&self, step: Step, score: &Score, is_best: bool) -> Step {
        let is_first = step.value(value::BEST_INLIERS).is_none();
        let step = step.put_value(value::INLIERS.is(score.inliers).inked(Role::Candidate)).say(case::SCORED);
        let is_ransac = self.0.settings().scoring == Scoring::Ransac;
        let step = if is_ransac { step } else { step.put(value::MODEL_COST, score.cost).say(case::COST) };
        let step = step.say(match (is_ransac, is_best) {
            _ if is_first => case::FIRST,
            (true, true) => case::MORE_INLIERS,
            (true, false) => case::NOT_MORE_INLIERS,
            (false, true) => case::LOWER_COST,
            (false, false) => case::NOT_LOWER_COST,
        });
        step.say_if(!is_best, case::DISCARDED)
    }

    /// The best model at the end of the events so far: the best hypothesis, or the fit to its inliers.
    pub(super) fn best_now(&self, seen: &Seen<Self>) -> Option<(Matrix3, Score)> {
        let mut best = self.best_hypothesis(seen);
        for event in seen.events {
            match event {
                Event::Resampled(_, matrix, score)
                | Event::Refit(matrix, score)
                | Event::Kept(matrix, score)
                | Event::Sequel(_, Best { matrix, score }) => best = Some((*matrix, *score)),
                Event::Doubted(_) => best = None,
                _ => {}
            }
        }
        best
    }

    /// The best hypothesis at the end of the events so far, from which the number of iterations follows.
    fn best_hypothesis(&self, seen: &Seen<Self>) -> Option<(Matrix3, Score)> {
        let mut matrix = None;
        let mut best = seen.before.consensus.best.map(|best| (best.matrix, best.score));
        let mut candidate: Option<(Matrix3, Score)> = None;
        for event in seen.events {
            match event {
                Event::Hypothesis(found) => matrix = Some(*found),
                Event::Scored(score, _) => candidate = matrix.map(|matrix| (matrix, *score)),
                Event::Local(matrix, score) => candidate = Some((*matrix, *score)),
                Event::Best(_) => best = candidate,
                _ => {}
            }
        }
        best
    }

    fn conclude(&self, step: Step, seen: &Seen<Self>) -> Step {
        let Some((after, Best { matrix, .. })) = seen.after.and_then(|after| Some((after, after.consensus.fitted?)))
        else {
            return step;
        };
        let inliers = self.inliers(&after.fixed.points, &matrix);
        // A truth that cannot be read is reported with the figures.
        let foreground = seen.clip.truth().and_then(|truth| truth.foreground(after.fixed.frame).ok().flatten());
        let place = Place::of(&inliers, foreground.as_deref(), seen.clip.size());
        self.0.conclusion(step.say(case::ENDED), &Estimate { place: Some(place), ..after.estimate() })
    }

    /// Adds the formulas about the final model, or N = log(1 − p) / log(1 − wⁿ) in symbols and in numbers.
    fn formulas(&self, step: Step, seen: &Seen<Self>) -> Step {
        let step = match seen.after.filter(|after| after.consensus.fitted.is_some()) {
            Some(after) => self.0.formulas(step, &after.estimate()),
            None => step,
        };
        if !step.formulas().is_empty() || step.value(value::SHARE).is_none() {
            return step;
        }
        step.formula(r"N = \frac{\log(1 - p)}{\log(1 - w^n)}").formula(concat!(
            r"= \frac{\log(1 - {confidence})}{\log(1 - {share}^{{sample_size}})}",
            r"\text{, so } {needed} \text{ (at most } {max_iterations} \text{)}"
        ))
    }
}

/// A confidence in percent, with as many decimals as it takes not to be written as certainty.
fn percent(confidence: f64) -> Value {
    let percent = value::CONFIDENCE_PERCENT.is(100.0 * confidence);
    let finer = |further: &usize| percent.clone().in_unit(Unit::PERCENT.finer(*further as u8));
    let further = further_digits(|further| finer(further).rounded() < Some(100.0));
    finer(&further)
}

/// The RMS distance of the inliers, if there are any.
fn rms(score: &Score) -> Number {
    match score.inliers {
        0 => "undefined".into(),
        count => (score.squared / count as f64).sqrt().into(),
    }
}

/// Puts the inliers of the model of the step, and their distance.
fn put_fit(step: Step, score: &Score, role: Role) -> Step {
    step.put_value(value::INLIERS.is(score.inliers).inked(role)).put(value::RMS, rms(score))
}

/// Tells why the model is rejected.
fn tell_doubt(step: Step, doubt: Doubt, state: &State) -> Step {
    match doubt {
        Doubt::OnLine { inliers, spread_px } => {
            let step = step.put(value::SUPPORT, inliers).put(value::SPREAD, spread_px);
            step.put(value::LEAST_SPREAD, LEAST_SPREAD_PX).say(case::ON_LINE)
        }
        Doubt::ByChance { inliers, needed } => {
            let step = step.put(value::SUPPORT, inliers).put(value::NEEDED_SUPPORT, needed).say(case::BY_CHANCE);
            let has_same = state.fixed.distinct < state.fixed.points.len();
            step.say_if(has_same, case::AT_DISTINCT_POSITIONS).say(case::AS_RANDOM)
        }
    }
}

/// Whether an event belongs to no iteration: to the final fit to all inliers, or to the end without a model.
pub(super) fn is_last(event: &Event) -> bool {
    !matches!(
        event,
        Event::Sample(_)
            | Event::Degenerate
            | Event::Hypothesis(_)
            | Event::Scored(..)
            | Event::Local(..)
            | Event::Best(_)
    )
}

/// The estimate at the end of a run that `state` has not quite reached.
pub(super) fn ended(state: &State, best: Best) -> Estimate<'_> {
    Estimate { best: Some(best), ..state.estimate() }
}
