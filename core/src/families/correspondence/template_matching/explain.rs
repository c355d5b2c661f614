//! The explanation of template matching.

use super::charts::{Shown, template_tile};
use super::vocabulary::{case, value};
use super::{DRIFT_PX, Event, Found, LEAST_DEVIATION, Pair, Stage, State, Template, TemplateMatching, Update, line};
use crate::methods::correlation::{Evaluation, Score};
use crate::run::Seen;
use crate::scene::{Name, Readout, Step, Unit, Value, Variable};

/// Peaks whose ratio is smaller are ambiguous.
const DISTINCT: f64 = 1.1;
/// A block with a smaller eigenvalue below this, in (gray levels per px)², has no texture in some direction.
const LEAST_EIGENVALUE: f32 = 0.01;
/// The vertex of a parabola.
const VERTEX: &str = concat!(
    r" = \frac{{cost_before} - {cost_behind}}{2 \cdot ({cost_before} - 2 \cdot {cost_at} + {cost_behind})}",
    r" = {fraction:unit} \quad ({cost_name} \text{ at −1, 0 and 1})"
);

impl TemplateMatching {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let (state, shown) = (seen.before, Shown::of(seen));
        let at = |line: Name| match &shown {
            Some(shown) => self.put(Step::at(line), shown),
            None => Step::at(line),
        };
        let step = match seen.events.last() {
            None => {
                let step = at(line::EACH_PAIR).put(value::MEASURE, self.score.label()).put(value::FRAMES, self.frames);
                let (width, height) = state.first.pixels.size();
                let step = step.put(value::WIDTH, width).put(value::HEIGHT, height).say(case::OPENING);
                self.tell_clipping(step, &state.first)
            }
            Some(Event::Chosen(template)) => self.tell_choice(at(line::CHOOSE), template),
            Some(Event::Flat(template)) => self
                .tell_choice(at(line::CHOOSE), template)
                .put(value::LEAST_DEVIATION, LEAST_DEVIATION)
                .say(case::FLAT),
            Some(Event::Area(pair)) => self.tell_area(at(line::SET_AREA), state, pair),
            Some(Event::Candidate(..)) => self.compare_with_best(at(line::SCORE), shown.as_ref()),
            Some(Event::Decided(stage, found)) => self.conclude(seen, self.tell_decision(at, *stage, (state, found))),
        };
        match &shown {
            Some(shown) => self.add_charts(step, seen, shown),
            None => step,
        }
    }

    /// A cost as the value of a score: a sum is whole, a correlation has three decimals.
    fn score_of(&self, of: &'static Variable, cost: f64) -> Value {
        let unit = if self.score.is_similarity() { Unit::RATIO } else { Unit::WHOLE };
        of.is(self.score.of_cost(cost)).in_unit(unit)
    }

    /// Puts the template, the places and their scores.
    fn put(&self, step: Step, shown: &Shown) -> Step {
        let Shown { pair, done, here, place, best, found, .. } = shown;
        let (cost, at) = (|place: &(usize, usize)| pair.costs[*place], |place| pair.displacement(place));
        let ((width, height), places) = (pair.template.pixels.size(), pair.costs.cells().len());
        let step = step.put(value::MEASURE, self.score.label()).put(value::WIDTH, width).put(value::HEIGHT, height);
        let step = step.put(value::PLACES, places).fact_as(value::TEMPLATE.is(pair.from), case::SIZE_AT);
        let mut step = step.fact_as(value::SCORED.is(done + here), case::SCORED_OF);
        if let Some(place) = place {
            step = step.put_value(self.score_of(value::SCORE, cost(place)).inked(shown.role()));
            step = match found {
                Some(_) => step.fact_as(value::PEAK.is(at(*place)), case::PEAK_SCORE),
                None => step.fact_as(value::CANDIDATE.is(at(*place)), case::CANDIDATE_SCORE),
            };
        }
        let Some(found) = found else {
            let Some(best) = best else { return step };
            let step = step.put_value(self.score_of(value::BEST_SCORE, cost(best)));
            return step.fact_as(value::BEST.is(at(*best)), case::BEST_SCORE);
        };
        if let Some(second) = &found.second {
            step = step.put_value(self.score_of(value::SECOND_SCORE, cost(second)));
            step = step.fact_as(value::SECOND.is(at(*second)), case::SECOND_SCORE);
        }
        let whole = at(found.best);
        let step = step.fact_if(value::RATIO, found.ratio(self.score)).fact(value::ZNCC, found.zncc);
        step.fact(value::DISPLACEMENT, [0, 1].map(|i| whole[i] as f32 + found.fraction[i]))
    }

    fn tell_choice(&self, step: Step, template: &Template) -> Step {
        let (width, height) = template.pixels.size();
        let step = step.put(value::WIDTH, width).put(value::HEIGHT, height).put(value::FRAME, template.frame);
        let step = step.fact_as(value::TEMPLATE.is(template.at), case::SIZE_AT);
        let step = step.fact(value::DEVIATION, template.deviation()).fact_if(value::EIGENVALUE, template.eigenvalue);
        let step = step.say(case::TEMPLATE_OF).show(Readout::Tiles(vec![template_tile(template)]));
        match template.eigenvalue {
            None => self.tell_clipping(step.say(case::PLACED), template),
            Some(eigenvalue) if eigenvalue >= LEAST_EIGENVALUE => step.say(case::TEXTURED),
            Some(_) if template.deviation() < LEAST_DEVIATION => step.say(case::WITHOUT_TEXTURE).say(case::BEST_BLOCK),
            Some(_) => step.say(case::WITHOUT_CORNERS).say(case::BEST_BLOCK),
        }
    }

    /// Says so if the picture border clips the placed rectangle.
    fn tell_clipping(&self, step: Step, template: &Template) -> Step {
        let Some(zone) = self.template else { return step };
        let [wide, high] = [0, 1].map(|i| f64::from(zone.max[i].ceil()) - f64::from(zone.min[i].ceil()));
        let (width, height) = template.pixels.size();
        if wide <= width as f64 && high <= height as f64 {
            return step;
        }
        step.put(value::PLACED_WIDTH, wide).put(value::PLACED_HEIGHT, high).say(case::CLIPPED)
    }

    fn tell_area(&self, step: Step, state: &State, pair: &Pair) -> Step {
        let ((columns, rows), (width, height)) = (pair.costs.size(), pair.template.pixels.size());
        let step = step.put(value::NEXT_FRAME, state.frame + 1).put(value::COLUMNS, columns).put(value::ROWS, rows);
        let step = step.put(value::RANGE, self.search_range).put(value::PRODUCTS, columns * rows * width * height);
        step.say(case::AREA).say(match pair.way {
            Evaluation::Direct => case::DIRECT,
            Evaluation::Fourier => case::FOURIER,
        })
    }

    /// Compares a candidate with the best place before it.
    fn compare_with_best(&self, step: Step, shown: Option<&Shown>) -> Step {
        let Some(Shown { pair, before, here, done, .. }) = shown else { return step };
        let is_new = shown.is_some_and(|shown| shown.best == shown.place);
        let (step, is_similarity) = (step.say(case::CANDIDATE), self.score.is_similarity());
        let step = match (before, is_new) {
            (None, _) => step.say(case::FIRST),
            (Some(before), true) => step
                .put_value(self.score_of(value::SCORE_BEFORE, pair.costs[*before]))
                .say(if is_similarity { case::ABOVE } else { case::BELOW })
                .say(case::NEW_BEST),
            (Some(_), false) => {
                step.say(if is_similarity { case::NOT_ABOVE } else { case::NOT_BELOW }).say(case::NOT_BEST)
            }
        };
        let (columns, rows) = pair.costs.size();
        let step = step.put(value::ROW, done / columns + 1).put(value::ROWS, rows);
        self.score_formula(step.say_if(*here == columns, case::ROW_ENDS), pair, (here - 1, done / columns))
    }

    fn tell_decision(&self, at: impl Fn(Name) -> Step, stage: Stage, (state, found): (&State, &Found)) -> Step {
        let formula = |step| self.score_formula(step, found.pair.as_ref(), found.best);
        let is_similarity = self.score.is_similarity();
        match stage {
            Stage::Peak => {
                let step = formula(at(line::TAKE_PEAK)).say(if is_similarity { case::HIGHEST } else { case::LOWEST });
                step.say(case::PEAK).say_if(found.is_at_limit(self.search_range), case::AT_LIMIT)
            }
            Stage::Subpixel if found.around.iter().all(Option::is_none) => {
                formula(at(line::FIT_PARABOLA)).say(case::NO_PARABOLA)
            }
            Stage::Subpixel => {
                self.parabolas(at(line::FIT_PARABOLA).put(value::VERTEX, found.fraction).say(case::REFINED), found)
            }
            Stage::Second => self.compare_peaks(formula(at(line::COMPARE_SECOND)), found),
            Stage::Check => {
                let step =
                    formula(at(line::CHECK)).put(value::MIN_ZNCC, self.min_zncc).put(value::POSITION, found.point);
                match found.feature.displacement {
                    Some(displacement) => step.put(value::TRACK_DISPLACEMENT, displacement).say(case::ACCEPTED),
                    None => step.say(case::LOST),
                }
            }
            Stage::Drift => {
                let step = formula(at(line::MEASURE_DRIFT)).put(value::FIRST_FRAME, state.first.frame);
                let step = step.put(value::UPDATES, state.past.len() + 1).put(value::DRIFT_LIMIT, DRIFT_PX);
                let Some(drift) = found.drift else { return step };
                let step = step.put(value::OFFSET, drift.offset.map(|c| -c)).put(value::DRIFT, drift.length());
                step.say(if drift.is_at_least { case::DRIFTED_FAR } else { case::DRIFTED })
            }
            Stage::Update => formula(at(line::UPDATE)).put(value::NEXT_FRAME, state.frame + 1).say(case::UPDATED),
        }
    }

    fn compare_peaks(&self, step: Step, found: &Found) -> Step {
        let Some(second) = found.second else { return step.say(case::NO_SECOND) };
        step.put(value::DISTINCT, DISTINCT).say(case::SECOND).say(match found.ratio(self.score) {
            Some(ratio) if ratio < DISTINCT => case::AMBIGUOUS,
            Some(_) => case::IS_DISTINCT,
            None if self.score.is_similarity() => case::ALONE_POSITIVE,
            None if found.pair.costs[second] == 0.0 => case::BOTH_EXACT,
            None => case::ALONE_EXACT,
        })
    }

    fn conclude(&self, seen: &Seen<Self>, step: Step) -> Step {
        let Some(after) = seen.after.filter(|after| after.is_over) else { return step };
        let (past, tracked) = (&after.past, after.track.points.len().saturating_sub(1));
        let lowest = past.iter().enumerate().min_by(|(_, a), (_, b)| a.zncc.total_cmp(&b.zncc));
        let Some((lowest, at_lowest)) = lowest else { return step };
        let limited = past.iter().filter(|past| past.is_at_limit).count();
        let step = step.put(value::TRACKED, tracked).put(value::PAIRS, past.len());
        let step = step.put(value::LOWEST_ZNCC, at_lowest.zncc).put(value::LOWEST_FRAME, after.span.first + lowest + 1);
        let step = step.put(value::PAIRS_AT_LIMIT, limited).put(value::RANGE, self.search_range).say(case::CONCLUSION);
        let mut step = self.tell_clipping(step.say_if(limited > 0, case::LIMITED), &after.first);
        if let Some(error) = past.iter().rev().find_map(|past| past.error) {
            step = step.put(value::POSITION_ERROR, error).say(case::FINAL_ERROR);
        }
        if let Some(drift) = past.iter().rev().find_map(|past| past.drift) {
            step = step.put(value::DRIFT, drift.length()).put(value::DRIFT_LIMIT, DRIFT_PX);
            step = step.say(if drift.is_at_least { case::FINAL_DRIFT_FAR } else { case::FINAL_DRIFT });
        }
        step.say(match (tracked < past.len(), self.update) {
            (true, Update::Fixed) => case::ADVISE_LOST,
            (true, Update::EveryFrame) => case::ADVISE_LOST_UPDATED,
            (false, Update::Fixed) => case::ADVISE_FIXED,
            (false, Update::EveryFrame) => case::ADVISE_UPDATED,
        })
    }

    fn score_formula(&self, step: Step, pair: &Pair, place: (usize, usize)) -> Step {
        let moments = pair.moments(place);
        let [template_mean, window_mean] = moments.means();
        let [deviation, window_sigma] = moments.deviations();
        let step = step.put(value::PIXELS, moments.count);
        match self.score {
            Score::Sad => step
                .put(value::MEAN_DIFFERENCE, pair.costs[place] / moments.count)
                .formula(r"\text{SAD} = \sum_{x, y} |T - I|")
                .formula(r"= {pixels} \cdot {mean_difference:unit} = {score}"),
            Score::Zncc => step
                .put(value::TEMPLATE_MEAN, template_mean)
                .put(value::WINDOW_MEAN, window_mean)
                .put(value::DEVIATION, deviation)
                .put(value::WINDOW_SIGMA, window_sigma)
                .put(value::COVARIANCE, moments.covariance())
                .formula(
                    r"\text{ZNCC} = \frac{\frac{1}{N} \sum_{x, y} (T - \bar{T}) \, (I - \bar{I})}{\sigma_T \sigma_I}",
                )
                .formula(
                    r"N = {pixels}, \bar{T} = {template_mean}, \bar{I} = {window_mean}, \sigma_T = {deviation}, \sigma_I = {window_sigma}",
                )
                .formula(r"= \frac{{covariance}}{{deviation} \cdot {window_sigma}} = {score}"),
            Score::Ssd | Score::Ncc => {
                let [of_template, of_window] = moments.squares;
                let step = step.put(value::TEMPLATE_SQUARES, of_template).put(value::WINDOW_SQUARES, of_window);
                let step = step.put(value::PRODUCT, moments.product);
                if self.score == Score::Ncc {
                    return step
                        .formula(r"\text{NCC} = \frac{\sum_{x, y} T I}{\sqrt{\sum_{x, y} T^2 \cdot \sum_{x, y} I^2}}")
                        .formula(r"= \frac{{product}}{\sqrt{{template_squares} \cdot {window_squares}}} = {score}");
                }
                step.formula(r"\text{SSD} = \sum_{x, y} (T - I)^2")
                    .formula(r"= \sum_{x, y} T^2 + \sum_{x, y} I^2 - 2 \sum_{x, y} T I")
                    .formula(r"= {template_squares} + {window_squares} - 2 \cdot {product} = {score}")
            }
        }
    }

    /// The vertices of the parabolas along x and y, with the costs behind them.
    fn parabolas(&self, step: Step, found: &Found) -> Step {
        let unit = if self.score.is_similarity() { Unit::RATIO.finer(1) } else { Unit::WHOLE };
        let step = step.put(value::COST_NAME, self.score.cost_name());
        ["x", "y"].into_iter().enumerate().fold(step, |step, (i, axis)| {
            let Some(costs) = found.around[i] else { return step };
            let named = [value::COST_BEFORE, value::COST_AT, value::COST_BEHIND].into_iter().zip(costs);
            let step = named.fold(step, |step, (of, cost)| step.put_value(of.is(cost).in_unit(unit)));
            step.put(value::FRACTION, found.fraction[i]).formula(format!(r"\Delta {axis}{VERTEX}"))
        })
    }
}
