//! A block search at a cursor: what the last event means, and what decided it.

use super::probe::Probe;
use super::subpixel::has_lowest;
use super::true_motion::CLOSE_PX;
use super::vocabulary::{case, line, value};
use super::whole_window::WholeWindow;
use super::{Cost, Event, Fit, Match, Skipped, Stage, Subpixel};
use crate::methods::cost::bounds::Parts;
use crate::products::{metrics, predict};
use crate::scene::{Case, Number, Step};

/// A match is called poor from this mean (or root-mean-square) difference, in gray levels per pixel.
const POOR_MATCH: f64 = 10.0;
/// Other minima are called nearly as low up to this mean difference above the match, in gray levels per pixel.
const COMPETING_LEVELS: f64 = 0.5;
/// The same as a share of the cost of the match; the smaller of both counts.
const COMPETING_SHARE: f64 = 0.05;
/// Displacements next to the match that a displacement between pixels explains.
const BESIDE: usize = 3;
/// The minimum of a parabola.
const FITTED: &str = concat!(
    r"{whole} + \frac{{cost_left} - {cost_right}}{2 \cdot ({cost_left} - 2 \cdot {cost_at} + {cost_right})}",
    " = {fitted:unit}"
);

/// A part in percent of the whole.
pub(crate) fn percent(part: usize, all: usize) -> f64 {
    100.0 * part as f64 / all.max(1) as f64
}

/// Tells the decision of a search, and which candidates of its pattern are skipped.
fn tell_stage(mut step: Step, stage: &Stage) -> Step {
    let (new, asked, reason) = (stage.points.len(), stage.asked, Step::clone(&stage.reason));
    step.values.extend(reason.values);
    let step = step.tell(reason.sentence).put(value::ASKED, asked).put(value::NEW, new);
    match (new, asked) {
        (new, asked) if new == asked => step,
        (0, 1) => step.say(case::COST_KNOWN),
        (0, 2) => step.say(case::BOTH_KNOWN),
        (0, _) => step.say(case::ALL_KNOWN),
        _ => step.say(if new == 1 { case::ONE_IS_NEW } else { case::SOME_ARE_NEW }).say(if asked - new == 1 {
            case::ONE_KNOWN
        } else {
            case::OTHERS_KNOWN
        }),
    }
}

impl Probe<'_> {
    /// The step of the last event, with its facts, formulas and charts, after the content of `lead`.
    pub fn step(&self, lead: Step) -> Step {
        let Some(last) = self.events.last() else { return self.opening(lead) };
        let at = |line| Step { line, ..self.facts(lead) };
        let step = match last {
            Event::Window => self.window_placed(at(line::LAY_WINDOW)),
            Event::Stage(stage) | Event::Refine(stage) => self.add_cost(tell_stage(at(stage.reason.line), stage)),
            Event::Fit(fit) => self.tell_fit(at(line::REFINE_BEST), fit),
            Event::Skipped(skipped) => self.tell_skipped(at(line::SKIP_CANDIDATE), skipped),
            Event::Candidate { rows, .. } if *rows < self.block().height => {
                self.add_cost(at(line::EXIT_EARLY).put(value::ROWS_SUMMED, *rows).say(case::EARLY_EXIT))
            }
            Event::Candidate { tested, .. } => self.add_cost(self.tell_comparison(at(line::COMPUTE_COST), *tested)),
            Event::NewBest { before } => self.add_cost(self.tell_improvement(at(line::KEEP_BEST), *before)),
            Event::Found(found) => self.add_cost(self.result(at(line::SET_DISPLACEMENT), *found)),
        };
        step.show_all(self.charts())
    }

    fn opening(&self, lead: Step) -> Step {
        let blocks = &self.pair.blocks;
        let step = lead.put(value::BLOCKS, blocks.len());
        step.put(value::WIDTH, blocks.size).put(value::HEIGHT, blocks.size).say(if self.counted.level.is_some() {
            case::LEVEL_OPENING
        } else {
            case::OPENING
        })
    }

    fn window_placed(&self, step: Step) -> Step {
        let is_cut = self.window.count() < (2 * self.settings.matching.search_range + 1).pow(2);
        let (columns, rows) = self.window.size;
        let step = step.put(value::COLUMNS, columns).put(value::ROWS, rows).say(case::WINDOW);
        step.say_if(is_cut, case::CUT).say(case::WINDOW_HOLDS)
    }

    /// Compares a candidate with the best before it, as the search does.
    fn tell_comparison(&self, step: Step, candidate: Match) -> Step {
        let Some(best) = self.best() else { return step.say(case::FIRST) };
        match (candidate.cost == best.cost, candidate.wins(&best)) {
            (false, true) => step.say(case::BELOW),
            (false, false) => step.say(case::ABOVE),
            (true, true) => step.say(case::EQUAL),
            (true, false) if best.length() < candidate.length() => step.say(case::EQUAL).say(case::KEPT_AS_SHORTER),
            (true, false) => step.say(case::EQUAL).say(case::KEPT_AS_FIRST),
        }
    }

    /// Tells why the last candidate is the new best.
    fn tell_improvement(&self, step: Step, before: Option<Match>) -> Step {
        let (Some(before), Some(best)) = (before, self.best()) else { return step.say(case::NEW_AS_FIRST) };
        let cost = self.settings.cost(value::COST_BEFORE, before.cost);
        step.put(value::BEFORE, before.vector()).put_value(cost).say(match before.cost == best.cost {
            false => case::NEW_AS_LOWER,
            true if best.length() < before.length() => case::NEW_AS_SHORTER,
            true => case::NEW_AS_EARLIER,
        })
    }

    fn tell_skipped(&self, step: Step, skipped: &Skipped) -> Step {
        let (across, down) = Parts::of(&self.patches(Match::whole([0, 0], 0.0)).0, skipped.side).counts;
        let step = step.put(value::PARTS, across * down).put(value::SIDE, skipped.side);
        let step = step.say(if across * down == 1 { case::SKIPPED_BY_WHOLE } else { case::SKIPPED_BY_PARTS });
        self.add_bound(step, skipped)
    }

    /// The parabolas along u and along v.
    fn tell_fit(&self, step: Step, fit: &Fit) -> Step {
        let whole = self.best().map_or([0, 0], |best| best.displacement);
        ["u", "v"].into_iter().enumerate().fold(step, |step, (i, axis)| {
            let step = step.put(value::AXIS, axis);
            let Some(costs) = fit.costs[i] else { return step.say(case::NO_PARABOLA) };
            let named = [value::COST_LEFT, value::COST_AT, value::COST_RIGHT].into_iter().zip(costs);
            let step = named.fold(step, |step, (of, cost)| step.put_value(self.settings.cost(of, cost)));
            if !has_lowest(&costs) {
                return step.say(case::NO_MINIMUM);
            }
            let step = step.put(value::WHOLE, whole[i]).put(value::OFFSET, fit.fraction[i]);
            let step = step.put(value::FITTED, whole[i] as f32 + fit.fraction[i]).say(case::PARABOLA);
            step.formula(format!("{axis} = {FITTED}"))
        })
    }

    /// The result of a block and its quality, and after the last block the quality of the whole field.
    fn result(&self, step: Step, found: Match) -> Step {
        let (tested, skipped, candidates) = (self.tested(), self.skipped_here(), self.window.count());
        let mut step = step.say(case::FOUND);
        // A parabola moves the match after it was tested.
        if self.as_tested(found) != found {
            step = step.put(value::TESTED_AT, found.displacement).say(case::FITTED);
        }
        let is_full = self.whole_tested() + skipped == candidates || self.counted.level.is_some();
        let step = step.say(case::MINIMUM_OF).say_if(tested > self.whole_tested(), case::SOME_BETWEEN);
        let step = step.say_if(!is_full, case::FULL_SEARCH).say(case::END);
        // If candidates were rejected early, some rows were not summed.
        let (summed, all): (usize, _) = (self.candidates().map(|(_, rows)| rows).sum(), tested * self.block().height);
        let step = step.put(value::SUMMED, summed).put(value::ALL_ROWS, all);
        let step = step.put(value::SHARE_SUMMED, percent(summed, all)).say_if(summed < all, case::SUMMED);
        let step = self.verdict(step.say_if(skipped > 0, case::SKIPPED), self.as_tested(found));
        self.conclusion(self.true_motion(step, found), found)
    }

    /// The match at its tested position: a parabola moves it afterwards.
    pub(super) fn as_tested(&self, found: Match) -> Match {
        let is_fitted = self.settings.refinement.subpixel == Subpixel::Parabola;
        Match { fraction: if is_fitted { [0.0; 2] } else { found.fraction }, ..found }
    }

    /// The number of candidates tested at whole pixels.
    pub(super) fn whole_tested(&self) -> usize {
        self.tests().cells().iter().flatten().count()
    }

    /// The reliability of the match `found`: ambiguous, at the limit of the search range, poor, exact, or missed.
    fn verdict(&self, step: Step, found: Match) -> Step {
        let surface = self.full_search();
        // A sub-pixel match lies beside the minimum of its whole pixels.
        let whole = surface.cost(found.displacement).unwrap_or(found.cost);
        if surface.least.cost < whole.min(found.cost) {
            return self.tell_miss(step, found, &surface);
        }
        let ties = surface.ties(found.displacement);
        if !ties.is_empty() {
            return self.tell_ties(step, found, &ties);
        }
        if self.rate.distortion(found) == 0.0 {
            return step.say(match self.settings.matching.cost {
                Cost::Zsad => case::EXACT_BUT_OFFSET,
                Cost::Ncc => case::EXACT_BUT_GAIN,
                _ => case::EXACT,
            });
        }
        let levels = self.settings.matching.cost.of_levels(COMPETING_LEVELS, self.block());
        let margin = levels.min(COMPETING_SHARE * whole.abs());
        let others = surface.competing_minima(found.displacement, whole + margin);
        let is_least = surface.least.cost >= whole;
        if others.is_empty() {
            return self.alone(step, found, is_least);
        }
        let cost = |other: &Match| self.settings.cost(value::LEAST_COST, other.cost).bare();
        let named = |other: &Match| format!("{} at {}", cost(other), value::LEAST.is(other.vector()).bare());
        let step = step.put(value::OTHER_MINIMA, others.iter().map(named).collect::<Number>());
        let reason = match is_least {
            true if self.tested() > self.whole_tested() => case::MINIMA_BESIDE_WHOLE,
            true => case::MINIMA,
            // Only between pixels.
            false => case::LOWER_MINIMA,
        };
        self.ambiguous(step, found, reason)
    }

    /// The quality of a match without a competing one; `is_least` says whether its whole displacement has the global minimum.
    fn alone(&self, step: Step, found: Match, is_least: bool) -> Step {
        if self.is_at_limit(found) {
            return step.say(case::AT_LIMIT);
        }
        if self.levels_per_pixel(found).is_some_and(|levels| levels >= POOR_MATCH) {
            return self.mean(step, found, case::POOR).say_if(!self.is_explained(found), case::POSSIBLE_CAUSES);
        }
        let step = step.say(match is_least {
            false => case::LOCAL_MINIMUM,
            // Between pixels only the neighbours of that minimum were tested.
            true if self.tested() > self.whole_tested() => case::BESIDE_GLOBAL,
            true => case::GLOBAL_MINIMUM,
        });
        self.mean(step, found, case::END)
    }

    /// A lower cost was missed: its place, and why it was not tested.
    fn tell_miss(&self, step: Step, found: Match, surface: &WholeWindow) -> Step {
        let least = surface.least;
        let cost = self.settings.cost(value::LEAST_COST, least.cost);
        let step = step.put(value::LEAST, least.vector()).put_value(cost);
        let step = match (self.is_refinement, self.true_error(found)) {
            (false, _) => step.say(case::MISSED),
            // The coarser level is the cause if a test would have helped: the true displacement costs less than the match.
            (true, Some((truth, off))) => step
                .say(case::MISSED_BY_REFINEMENT)
                .say_if(off >= CLOSE_PX && self.costs_less(truth, found, surface), case::LED_ELSEWHERE),
            (true, None) => step.say(case::MISSED_BY_REFINEMENT).say(case::MAY_HAVE_LED_ELSEWHERE),
        };
        self.mean(step, found, case::END)
    }

    /// Other displacements have the same cost as the match.
    fn tell_ties(&self, step: Step, found: Match, ties: &[Match]) -> Step {
        if ties.len() + 1 == self.window.count() {
            return step.say(case::ALL_ALIKE);
        }
        // Between two pixels both whole displacements cost the same, and more than nothing; that is no ambiguity of the texture.
        let is_beside = |other: &Match| (0..2).all(|i| (other.displacement[i] - found.displacement[i]).abs() <= 1);
        let may_lie_between = found.cost > 0.0
            && self.settings.refinement.subpixel == Subpixel::None
            && ties.len() <= BESIDE
            && ties.iter().all(is_beside);
        // Refinement moves the vector by less than a pixel.
        let is_far = self.true_error(found).is_some_and(|(_, off)| off >= CLOSE_PX);
        let step = step.put(value::TIES, ties.iter().map(Match::vector).collect::<Number>());
        match may_lie_between {
            true => step.say(if is_far { case::TIE_BESIDE } else { case::TIE_BETWEEN }),
            false => self.ambiguous(step, found, case::TIE),
        }
    }

    /// Whether the match lies at the limit of the search range, which may be the cause if the truth is not known.
    fn is_at_limit(&self, found: Match) -> bool {
        let range = self.settings.matching.search_range as u32;
        let is_at_limit = found.displacement.iter().any(|c| c.unsigned_abs() == range);
        is_at_limit && self.rate.distortion(found) > 0.0 && self.truth_of_block().is_none()
    }

    /// Displacements that cost as much, or nearly, as the match: `same` lists them.
    ///
    /// Where the truth names another cause of the error, or the match may be cut off by the range, texture is not the only one.
    fn ambiguous(&self, step: Step, found: Match, same: &'static Case) -> Step {
        match self.is_explained(found) {
            true => step.say(same).say(case::END),
            false => step.say(same).say(case::AMBIGUOUS).say_if(self.is_at_limit(found), case::AT_LIMIT),
        }
    }

    /// The mean difference per pixel in gray levels, for the costs that have one.
    fn levels_per_pixel(&self, found: Match) -> Option<f64> {
        self.settings.matching.cost.levels_of(self.rate.distortion(found), self.block())
    }

    /// Adds that difference, and how the sentence ends.
    fn mean(&self, step: Step, found: Match, end: &'static Case) -> Step {
        let Some(levels) = self.levels_per_pixel(found) else { return step };
        let is_squared = self.settings.matching.cost.is_squared();
        let step = step.put(value::MEAN_DIFFERENCE, levels as f32);
        step.say(if is_squared { case::ROOT_MEAN_SQUARE } else { case::MEAN_DIFFERENCE }).say(end)
    }

    /// After the last block of a picture: the quality of the motion-compensated prediction, and the worst block.
    fn conclusion(&self, step: Step, found: Match) -> Step {
        let blocks = &self.pair.blocks;
        if self.index + 1 < blocks.len() || self.counted.level.unwrap_or(0) > 0 {
            return step;
        }
        let all: Vec<Match> = self.found.iter().copied().chain([found]).collect();
        let field = self.settings.field(*blocks, all.iter().map(|found| Some(found.result(0))).collect());
        let (frame, next) = (self.pair.current.luma(), self.pair.next.luma());
        let prediction = predict(&field.flow(), next, (field.border, field.filter));
        let psnr = |picture| match metrics::psnr_db(picture, frame) {
            Ok(db) if db.is_finite() => Number::from(db),
            _ => "infinite (no error)".into(),
        };
        let step = step.put(value::BLOCKS, all.len()).put(value::PSNR, psnr(&prediction));
        let step = step.put(value::PSNR_AT_ZERO, psnr(next)).say(case::CONCLUSION);
        let skipped = self.skipped.iter().map(|&skipped| skipped as usize).sum::<usize>() + self.skipped_here();
        let window = |i| self.pair.window(blocks.block(i), self.settings.matching.search_range).count();
        let candidates = (0..blocks.len()).map(window).sum();
        let step = step.put(value::ALL_SKIPPED, skipped).put(value::ALL_CANDIDATES, candidates);
        let step = step.put(value::ALL_SHARE_SKIPPED, percent(skipped, candidates));
        let step = step.say_if(skipped > 0, case::SKIPPED_IN_ALL);
        let worst = all.iter().enumerate().max_by(|(_, a), (_, b)| a.cost.total_cmp(&b.cost));
        match worst.filter(|(_, worst)| self.rate.lambda == 0.0 && worst.cost > 0.0) {
            Some((i, worst)) => {
                let cost = self.settings.cost(value::WORST_COST, worst.cost);
                step.put(value::WORST_BLOCK, i + 1).put_value(cost).say(case::WORST)
            }
            None => step,
        }
    }
}
