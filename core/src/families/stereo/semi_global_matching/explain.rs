//! The steps of semi-global matching in values, words and formulas.

use super::fill::{self, Gap};
use super::shown::{Path, Shown};
use super::vocabulary::{case, value};
use super::{SemiGlobalMatching, Stage, find_winners, line};
use crate::methods::stereo::value as shared;
use crate::methods::stereo::{BITS, Verdict, accept, conclude, put_depth, smallest, starting};
use crate::run::Seen;
use crate::scene::{Readout, Role, Step};

impl SemiGlobalMatching {
    pub(super) fn explanation(&self, seen: &Seen<Self>) -> Step {
        let Some(shown) = self.shown(seen) else {
            let views = &seen.before.fixed.views;
            return starting(Step::at(line::TAKE_VIEWS), views, &self.settings).say(case::OPENING);
        };
        let step = match shown.stage {
            Stage::Cost => self.tell_cost(&shown),
            Stage::Path(direction) => self.tell_path(&shown, direction),
            Stage::Winner => self.tell_choice(&shown),
            Stage::Check => self.tell_check(&shown),
            Stage::Fill => self.tell_fill(&shown),
        };
        let step = match (seen.after.filter(|after| after.done == self.stages().len()), seen.point()) {
            (Some(after), None) => conclude(step, &after.fixed.views, &self.settings, &after.kept),
            _ => step,
        };
        step.show(Readout::Landscape(self.canyon(&shown)))
    }

    fn tell_cost(&self, shown: &Shown) -> Step {
        let costs = self.single_costs(shown);
        let minimum = smallest(&costs);
        let step = self.pair(shown).step(line::COMPUTE_COSTS).fact(value::LEAST_DISTANCE, minimum.cost);
        let step = step.fact(value::BITS, BITS).fact(shared::BEST, minimum.at).say(case::COST);
        let lines = vec![("cost C(p, d)", Role::Candidate, &costs[..])];
        step.show(self.curve(shown, "Matching cost along the epipolar line", lines))
    }

    fn tell_path(&self, shown: &Shown, direction: [isize; 2]) -> Step {
        let (path, costs, [p1, p2]) = (shown.path(self, direction), self.single_costs(shown), self.penalties());
        let (alone, along) = (smallest(&costs), smallest(&path.costs));
        let step = self.pair(shown).step(line::AGGREGATE).fact(value::DIRECTION, direction_name(direction));
        let step = step.fact(value::P1, p1).fact(value::P2, p2).fact(value::MATCHING_COST, alone.cost);
        let step = step.fact(value::MATCHING_BEST, alone.at).fact(value::PATH_COST, along.cost);
        let step = step.fact(value::PATH_BEST, along.at);
        let step = match &path.before {
            None => step.say(case::PATH_BEGINS),
            Some(before) => step.put(value::ARRIVAL, smallest(before).at).say(case::PATH_ARRIVES),
        };
        let lines = vec![
            ("cost C(p, d)", Role::Candidate, &costs[..]),
            ("path cost L(p, d)", Role::Predicted, &path.costs[..]),
        ];
        let curve = self.curve(shown, "Path cost along the epipolar line", lines);
        recursion(step.say(case::PATH_MINIMA), &path, &costs, along.at).show(curve)
    }

    fn tell_choice(&self, shown: &Shown) -> Step {
        let sums = shown.sums(self);
        let minimum = smallest(&sums);
        let rival = minimum.rival.map(|(_, cost)| cost);
        let is_unique = accept(&self.settings, minimum.cost, rival, 0) == Verdict::Accepted;
        let (line, said) =
            if is_unique { (line::CHOOSE, case::UNIQUE) } else { (line::REJECT_AMBIGUOUS, case::AMBIGUOUS) };
        let step = self.pair(shown).step(line).fact(shared::MINIMUM, minimum.cost).fact(shared::BEST, minimum.at);
        let step = step.fact_if(shared::RIVAL_COST, rival).fact_if(shared::RIVAL, minimum.rival.map(|(at, _)| at));
        let step = step.put(value::PATHS, self.directions().len()).put(shared::UNIQUENESS, self.settings.uniqueness);
        step.say(case::LOWEST_SUM).say(said).show(self.sum_curve(shown, &sums))
    }

    /// The disparities from the left and, at the match, from the right view.
    fn both(&self, shown: &Shown, sums: &[u32]) -> [usize; 2] {
        let ((x, y), width, depth) = (shown.pixel, shown.before.fixed.views.size().0, shown.before.fixed.depth);
        let best = smallest(sums).at;
        let row = &shown.state.sums[y * width * depth..(y + 1) * width * depth];
        let mut desk = super::Desk::default();
        find_winners(self.settings.disparities, row, &mut desk);
        [best, usize::from(desk.winners.right[x - best])]
    }

    fn tell_check(&self, shown: &Shown) -> Step {
        let (sums, pair) = (shown.sums(self), self.pair(shown));
        let [best, back] = self.both(shown, &sums);
        let step = pair.step(line::CHECK).fact(shared::BEST, best).fact(shared::BACK, back).say(case::BOTH_VIEWS);
        let step = match accept(&self.settings, 0, None, best.abs_diff(back)) {
            Verdict::Accepted => step.say(case::CONFIRMED),
            _ => pair.cause(step.say(case::REJECTED), case::OCCLUDED_OR_MISMATCHED),
        };
        step.show(self.sum_curve(shown, &sums))
    }

    fn tell_fill(&self, shown: &Shown) -> Step {
        let ((x, y), width) = (shown.pixel, shown.before.fixed.views.size().0);
        let index = y * width + x;
        let was = shown.before.kept[index];
        let step = self.pair(shown).step(line::FILL);
        let (step, disparity) = if was.disparity.is_finite() {
            (step.say(case::KEPT), was.disparity)
        } else {
            let gap = self.gap(&shown.before.right[y * width..], x);
            let around = fill::nearest(&shown.before.kept, width).into_iter().find(|(hole, _)| *hole == index);
            let step = step.say(match (gap, was.verdict) {
                (Gap::Occluded, _) => case::FILL_OCCLUDED,
                (Gap::Mismatched, Verdict::Ambiguous) => case::FILL_AMBIGUOUS,
                (Gap::Mismatched, _) => case::FILL_WRONG,
            });
            (step, around.map_or(f32::NAN, |(_, around)| fill::value(gap, around)))
        };
        let step = match disparity.is_finite() {
            true => put_depth(step, shown.before.fixed.views.calibration.as_ref(), disparity),
            false => step.say(case::FILL_NONE),
        };
        let is_filled = disparity.is_finite() && was.disparity.is_nan();
        step.say_if(is_filled, case::FILLED).show(self.sum_curve(shown, &shown.sums(self)))
    }
}

fn direction_name(direction: [isize; 2]) -> &'static str {
    match direction {
        [1, 0] => "from the left",
        [-1, 0] => "from the right",
        [0, 1] => "from above",
        [0, -1] => "from below",
        [1, 1] => "from the upper left",
        [-1, 1] => "from the upper right",
        [1, -1] => "from the lower left",
        _ => "from the lower right",
    }
}

/// Adds the recursion, and with its numbers at disparity `d`, that of the lowest path cost.
fn recursion(step: Step, path: &Path, costs: &[u32], d: usize) -> Step {
    let step = step.formula(r"L(p, d) = C(p, d) + \text{min}(L(p - r, d), L(p - r, d \pm 1) + P_1, m + P_2) - m");
    let Some(before) = &path.before else { return step };
    let at = |d: Option<usize>| d.and_then(|d| before.get(d)).copied();
    let beside = [at(d.checked_sub(1)), at(Some(d + 1))].into_iter().flatten().min();
    let mut step = step.put(value::COST_HERE, costs[d]).put(value::LEAST_BEFORE, smallest(before).cost);
    let mut terms = String::new();
    for (of, cost, term) in [(value::SAME, at(Some(d)), "{same}, "), (value::BESIDE, beside, "{beside} + {p1}, ")] {
        let Some(cost) = cost else { continue };
        (step, terms) = (step.put(of, cost), terms + term);
    }
    let min = format!(r"\text{{min}}({terms}{{least_before}} + {{p2}})");
    step.formula(format!("L(p, {{path_best}}) = {{cost_here}} + {min} - {{least_before}} = {{path_cost}}"))
}
