//! What semi-global matching tells and draws.

use std::sync::Arc;

use super::fill::{self, Gap};
use super::paths::{self, Job, Line, NONE};
use super::{Event, SemiGlobalMatching, Stage, State, find_winners, line};
use crate::data::Frame;
use crate::geometry::Grid;
use crate::methods::stereo::value as shared;
use crate::methods::stereo::{
    BITS, Curve, Pair, Verdict, WHOLE_PX, accept, concluded, draw_map, draw_match, measured, smallest, starting,
};
use crate::run::Seen;
use crate::scene::{Axes, Canvas, Picture, PictureRole, Readout, Role, Scene, Shape, Step, Surface, Unit};
use crate::{cases, variables};

variables! {
    /// The number of bits of a census string.
    BITS: "Census string", "", Unit::new("bits", 0);
    /// The lowest Hamming distance of the census strings.
    LEAST_DISTANCE: "Least Hamming distance", "", Unit::new("bits", 0), Role::Best;
    /// The side from which a path reaches the pixel.
    DIRECTION: "Direction", r"r", Unit::WHOLE;
    /// The penalty for a change of the disparity by 1 px.
    P1: "Penalty P1", "P_1", Unit::WHOLE;
    /// The penalty for a larger change of the disparity.
    P2: "Penalty P2", "P_2", Unit::WHOLE;
    /// The lowest matching cost of the pixel.
    MATCHING_COST: "Matching cost", "", Unit::WHOLE;
    /// The disparity of the lowest matching cost.
    MATCHING_BEST: "Its disparity", "", WHOLE_PX;
    /// The lowest path cost of the pixel.
    PATH_COST: "Path cost", "", Unit::WHOLE, Role::Best;
    /// The disparity of the lowest path cost.
    PATH_BEST: "Disparity of the path cost", "", WHOLE_PX, Role::Best;
    /// The disparity of the lowest path cost of the pixel before on the path.
    ARRIVAL: "Arrival", "", WHOLE_PX;
    /// The matching cost at the disparity of the lowest path cost.
    COST_HERE: "", "", Unit::WHOLE;
    /// The path cost of the pixel before at the same disparity.
    SAME: "", "", Unit::WHOLE;
    /// The lower of its path costs at the neighbouring disparities.
    BESIDE: "", "", Unit::WHOLE;
    /// The lowest of its path costs.
    LEAST_BEFORE: "", "m", Unit::WHOLE;
    /// The number of directions of paths.
    PATHS: "Paths", "", Unit::count("path cost");
}

cases! { pub(super) over value, shared;
    OPENING: "The cost of a single pixel is ambiguous; sums of costs along paths through the picture make neighbours agree.",
    COST: "{reference|Pixel} {pixel}: the census strings of the pixel and its match differ least, in {least_distance:bare} of \
           {bits} at d = {best:bare}. The window of 9×7 px is small, so the cost has many minima of nearly the same depth.",
    PATH_BEGINS: "{reference|Pixel} {pixel}, path {direction}: the path begins here, so the path cost is the matching cost.",
    PATH_ARRIVES: "{reference|Pixel} {pixel}, path {direction}: the path arrives with its minimum at d = {arrival:bare}, and \
                   changes of the disparity are penalised.",
    PATH_MINIMA: "The minimum of the matching cost is at d = {matching_best:bare}, that of the path cost at d = \
                  {path_best:bare}.",
    LOWEST_SUM: "{reference|Pixel} {pixel}: the sum of its {paths} is lowest, {minimum} at d = {best:bare}",
    AMBIGUOUS: ". Its rival, {rival_cost} at d = {rival:bare}, is less than {uniqueness} higher, so the match is ambiguous and \
                the pixel gets no disparity yet.",
    UNIQUE: ", and no rival comes near it: the disparity is unique.",
    BOTH_VIEWS: "{reference|Pixel} {pixel}: from the left view d = {best:bare}, from its match in the {second} d = {back:bare}.",
    CONFIRMED: "The left–right check confirms the disparity.",
    REJECTED: "The left–right check rejects the disparity.",
    OCCLUDED_OR_MISMATCHED: "The pixel is half-occluded, hidden from the other view, or mismatched.",
    KEPT: "{reference|Pixel} {pixel} passed all tests, so its disparity stays.",
    FILL_OCCLUDED: "{reference|Pixel} {pixel}: no pixel of the other view is matched with it, as where it is half-occluded. Then \
                    the background continues there, so it takes the second lowest of the nearest disparities in 8 directions,",
    FILL_AMBIGUOUS: "{reference|Pixel} {pixel}: its match is ambiguous. It takes the median of the nearest disparities in 8 \
                     directions,",
    FILL_WRONG: "{reference|Pixel} {pixel}: its match is wrong, as another pixel takes the same place. It takes the median of \
                 the nearest disparities in 8 directions,",
    FILLED: "{disparity}.",
    FILL_NONE: "of which there are none.",
}

/// The cut through the cost volume along a row.
const SLICE: Picture = Picture { role: PictureRole::Slice, ..Picture::CURRENT };

/// The pixel that a step explains.
struct Shown<'a> {
    /// The state with the results of the stage, as far as it is over; else the one before it.
    state: &'a State,
    before: &'a State,
    stage: Stage,
    pixel: (usize, usize),
}

/// The path costs of a pixel along a direction, with what they are made of.
struct Path {
    /// The first pixel of the path.
    from: (usize, usize),
    /// Path costs of the pixel and, unless the path begins there, of the one before.
    costs: Vec<u32>,
    before: Option<Vec<u32>>,
}

impl Shown<'_> {
    /// The costs of the disparities of a pixel, without those of matches beside the right view.
    fn costs(&self, of: &SemiGlobalMatching, (x, y): (usize, usize)) -> Vec<u8> {
        let (fixed, width) = (&self.before.fixed, self.before.fixed.views.size().0);
        let mut row = vec![NONE; width * fixed.depth];
        of.cost_row(fixed, y, &mut row);
        row[x * fixed.depth..(x + 1) * fixed.depth].to_vec()
    }

    /// The sums of a pixel so far, without those of matches beside the right view.
    fn sums(&self, of: &SemiGlobalMatching) -> Vec<u32> {
        let ((x, y), width, depth) = (self.pixel, self.before.fixed.views.size().0, self.before.fixed.depth);
        let cells = &self.state.sums[(y * width + x) * depth..][..of.last(x) + 1];
        cells.iter().map(|sum| u32::from(*sum)).collect()
    }

    /// Follows a path from the border of the picture to the pixel.
    fn path(&self, of: &SemiGlobalMatching, [dx, dy]: [isize; 2]) -> Path {
        let ((width, height), depth) = (self.before.fixed.views.size(), self.before.fixed.depth);
        let inside = |(x, y): (isize, isize)| (0..width as isize).contains(&x) && (0..height as isize).contains(&y);
        let mut from = (self.pixel.0 as isize, self.pixel.1 as isize);
        while inside((from.0 - dx, from.1 - dy)) {
            from = (from.0 - dx, from.1 - dy);
        }
        let (mut at, mut before) = (from, Line::outside(1, depth));
        let (mut last, mut sums) = (None, vec![0; depth]);
        loop {
            let costs = self.costs_on_path(of, at);
            let mut line = Line::outside(1, depth);
            // A path may be longer than sums have room for.
            sums.fill(0);
            let job = Job {
                dx: 0,
                before: Some(&before),
                line: &mut line,
                costs,
                sums: &mut sums,
                penalties: of.penalties(),
            };
            paths::follow(job);
            if at == (self.pixel.0 as isize, self.pixel.1 as isize) {
                let told =
                    |line: &Line, x: usize| line.at(0)[..of.last(x) + 1].iter().map(|cost| u32::from(*cost)).collect();
                let came_from = (at.0 - dx) as usize;
                return Path {
                    from: (from.0 as usize, from.1 as usize),
                    costs: told(&line, self.pixel.0),
                    before: last.map(|()| told(&before, came_from)),
                };
            }
            (before, last) = (line, Some(()));
            at = (at.0 + dx, at.1 + dy);
        }
    }

    /// The costs of a pixel out of the volume.
    fn costs_on_path(&self, of: &SemiGlobalMatching, (x, y): (isize, isize)) -> &[u8] {
        debug_assert_eq!(self.before.fixed.depth, of.settings.disparities.next_multiple_of(paths::LANES));
        let (width, depth) = (self.before.fixed.views.size().0, self.before.fixed.depth);
        &self.before.costs[(y as usize * width + x as usize) * depth..][..depth]
    }
}

impl SemiGlobalMatching {
    /// The largest disparity of a pixel with a match inside the right view.
    fn last(&self, x: usize) -> usize {
        x.min(self.settings.disparities - 1)
    }

    /// The pixel pointed at, else the middle of the row at work; `None` before the first.
    fn shown<'a>(&self, seen: &'a Seen<Self>) -> Option<Shown<'a>> {
        let Event { stage, y } = *seen.events.last()?;
        let views = &seen.before.fixed.views;
        let pointed_at = seen.point().and_then(|point| views.left.luma().cell_at(point));
        let pixel = pointed_at.unwrap_or((views.size().0 / 2, y as usize));
        Some(Shown { state: seen.after.unwrap_or(seen.before), before: seen.before, stage, pixel })
    }

    fn pair<'a>(&self, shown: &Shown<'a>) -> Pair<'a> {
        Pair { views: &shown.before.fixed.views, pixel: shown.pixel, reach: 4, disparities: self.settings.disparities }
    }

    pub(super) fn told(&self, seen: &Seen<Self>) -> Step {
        let Some(shown) = self.shown(seen) else {
            let views = &seen.before.fixed.views;
            return starting(Step::at(line::TAKE_VIEWS), views, &self.settings).say(case::OPENING);
        };
        let step = match shown.stage {
            Stage::Cost => self.told_cost(&shown),
            Stage::Path(direction) => self.told_path(&shown, direction),
            Stage::Winner => self.told_choice(&shown),
            Stage::Check => self.told_check(&shown),
            Stage::Fill => self.told_fill(&shown),
        };
        let step = match (seen.after.filter(|after| after.done == self.stages().len()), seen.point()) {
            (Some(after), None) => concluded(step, &after.fixed.views, &self.settings, &after.kept),
            _ => step,
        };
        step.show(Readout::Landscape(self.canyon(&shown)))
    }

    fn told_cost(&self, shown: &Shown) -> Step {
        let costs = self.single_costs(shown);
        let minimum = smallest(&costs);
        let step = self.pair(shown).step(line::COMPUTE_COSTS).fact(value::LEAST_DISTANCE, minimum.cost);
        let step = step.fact(value::BITS, BITS).fact(shared::BEST, minimum.at).say(case::COST);
        let lines = vec![("cost C(p, d)", Role::Candidate, &costs[..])];
        step.show(self.curve(shown, "Matching cost along the epipolar line", lines))
    }

    /// The matching costs of the pixel.
    fn single_costs(&self, shown: &Shown) -> Vec<u32> {
        let costs = shown.costs(self, shown.pixel);
        costs[..self.last(shown.pixel.0) + 1].iter().map(|cost| u32::from(*cost)).collect()
    }

    fn curve(&self, shown: &Shown, title: &'static str, lines: Vec<(&'static str, Role, &[u32])>) -> Readout {
        let best = lines.last().map_or(0, |(.., costs)| smallest(costs).at);
        let real = |costs: &[u32]| costs.iter().map(|cost| *cost as f32).collect();
        let lines = lines.into_iter().map(|(name, role, costs)| (name, role, real(costs))).collect();
        Curve { title, y_label: "cost (bits)", lines, best, thresholds: Vec::new(), pair: self.pair(shown) }.readout()
    }

    fn told_path(&self, shown: &Shown, direction: [isize; 2]) -> Step {
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

    fn told_choice(&self, shown: &Shown) -> Step {
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

    fn sum_curve(&self, shown: &Shown, sums: &[u32]) -> Readout {
        self.curve(shown, "Sum of path costs along the epipolar line", vec![("sum S(p, d)", Role::Estimate, sums)])
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

    fn told_check(&self, shown: &Shown) -> Step {
        let (sums, pair) = (shown.sums(self), self.pair(shown));
        let [best, back] = self.both(shown, &sums);
        let step = pair.step(line::CHECK).fact(shared::BEST, best).fact(shared::BACK, back).say(case::BOTH_VIEWS);
        let step = match accept(&self.settings, 0, None, best.abs_diff(back)) {
            Verdict::Accepted => step.say(case::CONFIRMED),
            _ => pair.cause(step.say(case::REJECTED), case::OCCLUDED_OR_MISMATCHED),
        };
        step.show(self.sum_curve(shown, &sums))
    }

    fn told_fill(&self, shown: &Shown) -> Step {
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
            true => measured(step, shown.before.fixed.views.calibration.as_ref(), disparity),
            false => step.say(case::FILL_NONE),
        };
        let is_filled = disparity.is_finite() && was.disparity.is_nan();
        step.say_if(is_filled, case::FILLED).show(self.sum_curve(shown, &shown.sums(self)))
    }

    pub(super) fn drawn(&self, seen: &Seen<Self>, scene: &mut Scene) {
        let state = seen.after.unwrap_or(seen.before);
        scene.pictures = seen.before.fixed.views.canvases();
        let meaning = if state.kept.is_empty() { "disparity of least cost so far, in px" } else { "disparity in px" };
        draw_map(scene, state.map(), self.settings.disparities, meaning);
        let Some(shown) = self.shown(seen) else { return };
        let (x, y) = shown.pixel;
        let slice = self.slice(&shown);
        scene.pictures.push(Canvas::made(SLICE, move || Frame::gray(Grid::clone(&slice))).along(y));
        let index = y * seen.before.fixed.views.size().0 + x;
        let kept = state.kept.get(index);
        let best = match &state.sums[..] {
            [] => smallest(&self.single_costs(&shown)).at as f32,
            _ => smallest(&shown.sums(self)).at as f32,
        };
        let is_kept = kept.is_none_or(|kept| kept.disparity.is_finite());
        let at = kept.map(|kept| kept.disparity).filter(|d| d.is_finite()).unwrap_or(best);
        draw_match(scene, &self.pair(&shown), at, is_kept);
        let column = vec![[x as f32, -0.5], [x as f32, self.last(x) as f32 + 0.5]];
        scene.mark(SLICE, Role::Window, Shape::Path { points: column, closed: false });
        scene.mark(SLICE, Role::Best, Shape::Points(vec![[x as f32, best]]));
        scene.legend(Role::Best, "match");
        if let Stage::Path(direction) = shown.stage {
            let from = shown.path(self, direction).from;
            let points = vec![[from.0 as f32, from.1 as f32], [x as f32, y as f32]];
            scene.mark(Picture::CURRENT, Role::Predicted, Shape::Path { points, closed: false });
            scene.legend(Role::Predicted, "path to the pixel");
        }
    }

    /// The cut through the volume along the row of the pixel: x to the right, d down, low costs bright.
    fn slice(&self, shown: &Shown) -> Arc<Grid<u8>> {
        let (values, paths) = self.row(shown);
        let most = BITS.max(paths * (BITS + u32::from(self.penalties()[1])) / 2);
        Arc::new(values.map(|value| 255 - (255 * (*value).min(most) / most) as u8))
    }

    /// The costs along the row of the pixel, x to the right and d down: the sums so far and of how many paths they are, else the matching
    /// costs.
    fn row(&self, shown: &Shown) -> (Grid<u32>, u32) {
        let (fixed, y) = (&shown.before.fixed, shown.pixel.1);
        let (width, depth) = (fixed.views.size().0, fixed.depth);
        let paths = (shown.state.done.min(self.directions().len() + 1) as u32).saturating_sub(1);
        let values: Vec<u32> = if paths > 0 {
            shown.state.sums[y * width * depth..(y + 1) * width * depth].iter().map(|sum| u32::from(*sum)).collect()
        } else {
            let mut row = vec![NONE; width * depth];
            self.cost_row(fixed, y, &mut row);
            row.into_iter().map(u32::from).collect()
        };
        (Grid::from_fn(width, self.settings.disparities, |x, d| values[x * depth + d]), paths)
    }

    /// The costs around the pixel on that cut as a canyon, with the disparities of least cost along its bed.
    fn canyon(&self, shown: &Shown) -> Surface {
        /// How far it reaches to each side, in px.
        const REACH: usize = 24;
        let (row, paths) = self.row(shown);
        let (x, (width, depth)) = (shown.pixel.0, row.size());
        let (left, right) = (x.saturating_sub(REACH), (x + REACH).min(width - 1));
        // Beyond the border of the other view there is no match.
        let cost = |x: usize, d: usize| if d <= self.last(x) { row[(x, d)] as f32 } else { f32::NAN };
        let values = Grid::from_fn(right - left + 1, depth, |i, d| cost(left + i, d));
        let center = [(left + values.width() / 2) as f32, (depth / 2) as f32];
        let title = match shown.stage {
            _ if paths == 0 => "cost C(p, d)",
            Stage::Path(_) => "sum of the finished paths",
            _ => "sum S(p, d)",
        };
        let surface = Surface::over_picture((title, "bits"), (SLICE, center, 1.0), values);
        let least = |x: usize| smallest(&(0..=self.last(x)).map(|d| row[(x, d)]).collect::<Vec<_>>()).at;
        let bed = (left..=right).map(|x| surface.axes.displacement([x as f32, least(x) as f32]));
        let best = surface.axes.displacement([x as f32, least(x) as f32]).map(|c| c as i32);
        Surface {
            axes: Axes { names: ["x, px", "d, px"], ..surface.axes },
            trail: bed.collect(),
            probe: Some(best),
            ..surface
        }
    }
}

/// The name of a direction of paths.
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
