//! A block search at a cursor: facts, formulas, tiles and charts.

use super::explain::percent;
use super::probe::Probe;
use super::vocabulary::{case, value};
use super::{Cost, Event, Match, Neighbours, Patch, Skipped, Subpixel, Tester, Window, Workspace};
use crate::data::{Between, Histogram};
use crate::geometry::Grid;
use crate::methods::cost::{Cut, Sum, bounds::Parts};
use crate::products::Block;
use crate::scene::{BetweenPixels, Footing, Picture, Readout, Role, Series, Step, Surface, Tile};

impl Probe<'_> {
    /// The tiles and charts of the step.
    pub(super) fn charts(&self) -> Vec<Readout> {
        let mut readouts = Vec::new();
        if let Some((candidate, rows)) = self.shown() {
            // Costs at sub-pixel positions are not on the cost surface, so they come first.
            let tiles = self.subpixel_costs().into_iter().chain(self.tiles(candidate, rows)).collect();
            readouts.push(Readout::Tiles(tiles));
        }
        let whole = self.whole();
        let is_on_surface = |candidate: &Match| candidate.fraction == [0.0; 2];
        let is_fitted = self.settings.refinement.subpixel == Subpixel::Parabola;
        readouts.push(Readout::Surface(Surface {
            unit: self.unit(),
            scale: self.scale(),
            probe: self.passed_over().or_else(|| {
                self.at_hand().map(|(candidate, _)| candidate).filter(is_on_surface).map(|at| at.displacement)
            }),
            // A sub-pixel position is not on the cost surface; a fitted one stays where it was tested.
            best: self.best().filter(|best| is_fitted || best.fraction == [0.0; 2]).map(|best| best.displacement),
            untested: self.untested(&whole),
            between: self.between(),
            truth: self.truth_in_window().filter(|_| self.is_over()),
            footing: Some(Footing { whole: Some(whole), ..Footing::new(Picture::NEXT, self.block().center()) }),
            ..Surface::new(self.settings.label(), self.window.min, self.costs(), self.tests())
        }));
        readouts.push(Readout::Series(self.series()));
        readouts.extend(self.histogram().map(Readout::Histogram));
        readouts
    }

    /// The costs of all candidates, tested or not.
    fn whole(&self) -> Grid<f32> {
        let (all, [left, top], (width, height)) = (self.full_search(), self.window.min, self.window.size);
        let cost = |x: usize, y: usize| all.cost([left + x as i32, top + y as i32]).unwrap_or(f64::NAN) as f32;
        Grid::from_fn(width, height, cost)
    }

    /// The costs of the candidates that the search left out, at its end; candidates of levels are no misses.
    fn untested(&self, whole: &Grid<f32>) -> Option<Grid<f32>> {
        let costs = self.costs();
        let is_whole = costs.cells().iter().all(|cost| cost.is_finite());
        let left_out = |x: usize, y: usize| if costs[(x, y)].is_finite() { f32::NAN } else { whole[(x, y)] };
        (self.is_over() && !is_whole).then(|| Grid::from_fn(costs.width(), costs.height(), left_out))
    }

    fn between(&self) -> Vec<BetweenPixels> {
        let between = self.candidates().map(|(tested, _)| tested).filter(|tested| tested.fraction != [0.0; 2]);
        between.map(|tested| BetweenPixels { at: tested.vector(), value: tested.cost as f32 }).collect()
    }

    /// The unit of the cost; none if it includes the rate of the displacement.
    fn unit(&self) -> &'static str {
        match self.settings.matching.cost {
            _ if self.settings.refinement.lambda != 0.0 => "",
            Cost::Sad | Cost::Zsad | Cost::Satd => "gray levels",
            Cost::Ssd | Cost::Mse => "gray levels²",
            Cost::Ncc => "",
        }
    }

    /// A scale of colors for all of the block: from 0, a perfect match, to the largest cost of displacements that are spread over
    /// the window, so that a color means the same at every step and for every search.
    pub(super) fn scale(&self) -> Option<[f32; 2]> {
        /// Displacements along each side.
        const SPREAD: usize = 13;
        let (width, height) = self.window.size;
        let along = |size: usize| (0..SPREAD.min(size)).map(move |i| i * (size - 1) / (SPREAD.min(size) - 1).max(1));
        let [left, top] = self.window.min;
        let spread = along(height).flat_map(|y| along(width).map(move |x| [left + x as i32, top + y as i32]));
        let (mut work, mut observer) = (Workspace::default(), ());
        let neighbours = Neighbours::default();
        let mut tester = Tester::new((self.pair, self.index), self.settings, neighbours, &mut work, &mut observer);
        let costs = spread
            .map(|at| (tester.distortion(at) + self.rate.price(at.map(|c| 4 * c))) as f32)
            .filter(|cost| cost.is_finite());
        let largest = costs.fold(0.0, f32::max);
        (largest > 0.0).then_some([0.0, largest])
    }

    /// The histogram of the motion vectors so far, with this block's own once it is found.
    fn histogram(&self) -> Option<Histogram> {
        let own = if let Some(Event::Found(found)) = self.events.last() { Some(found) } else { None };
        let vectors: Vec<_> = self.found.iter().chain(own).map(Match::vector).collect();
        Histogram::of(self.counted, &vectors, own.is_some())
    }

    /// The candidate whose numbers are shown: the one under test, at the end the best match.
    pub(super) fn shown(&self) -> Option<(Match, usize)> {
        match self.events.last() {
            // The minimum of a parabola was not tested itself.
            Some(Event::Found(found)) if self.settings.refinement.subpixel == Subpixel::Parabola => {
                Some((Match { fraction: [0.0; 2], ..*found }, self.block().height))
            }
            Some(Event::Found(found)) => Some((*found, self.block().height)),
            Some(Event::Refine(_) | Event::Fit(_)) => {
                self.at_hand().or_else(|| Some((self.best()?, self.block().height)))
            }
            _ => self.candidate(),
        }
    }

    /// The role of that candidate.
    pub(super) fn shown_role(&self) -> Role {
        if self.at_hand().is_some() { Role::Candidate } else { Role::Best }
    }

    /// Adds the facts: the block, the candidates tested, the current one, and the best.
    pub(super) fn facts(&self, step: Step) -> Step {
        let (block, settings, skipped) = (self.block(), &self.settings, self.skipped_here());
        let (whole, between) = (self.whole_tested(), self.tested() - self.whole_tested());
        let mut step = step
            .put(value::BLOCKS, self.pair.blocks.len())
            .put(value::CORNER, (block.x, block.y))
            .put(value::WIDTH, block.width)
            .put(value::HEIGHT, block.height)
            .put(value::RANGE, settings.matching.search_range)
            .put(value::LABEL, settings.label())
            .put(value::MEASURE, settings.measure())
            .put(value::CANDIDATES, self.window.count())
            .put(value::TESTED, self.tested())
            .put(value::BETWEEN, between)
            .fact_as(value::BLOCK.is(self.index + 1), case::BLOCK_OF)
            .fact_as(
                value::WHOLE_TESTED.is(whole),
                if between > 0 { case::TESTED_WITH_BETWEEN } else { case::TESTED_OF },
            );
        if let Some(Event::Skipped(skipped)) = self.events.last() {
            step = step.put_value(settings.cost(value::LOWER_BOUND, self.bound_of(skipped)));
            step = step.fact_as(value::CANDIDATE.is(skipped.displacement), case::CANDIDATE_BOUND);
        } else if let Some((candidate, rows)) = self.at_hand() {
            let (cost, with) = match rows < block.height {
                true => (value::LOWER_BOUND, case::CANDIDATE_BOUND),
                false => (value::COST, case::CANDIDATE_COST),
            };
            step = step.put_value(settings.cost(cost, candidate.cost));
            step = step.fact_as(value::CANDIDATE.is(candidate.vector()), with);
        }
        if skipped > 0 {
            let share = percent(skipped, self.window.count());
            step = step.put(value::SHARE_SKIPPED, share).fact_as(value::SKIPPED.is(skipped), case::SKIPPED_OF);
        }
        let Some(best) = self.best() else { return step };
        let is_fitted = settings.refinement.subpixel == Subpixel::Parabola && best.fraction != [0.0; 2];
        let (at, with) = match self.is_over() {
            true if is_fitted => (value::DISPLACEMENT, case::FITTED_COST),
            true => (value::DISPLACEMENT, case::DISPLACEMENT_COST),
            false => (value::BEST, case::BEST_COST),
        };
        let step = step.put(value::TESTED_AT, best.displacement).put_value(settings.cost(value::MINIMUM, best.cost));
        step.fact_as(at.is(best.vector()), with)
    }

    /// The pixels of the block and of the candidate: `(frame t, frame t + 1)`.
    pub(super) fn patches(&self, candidate: Match) -> (Cut, Cut) {
        let (mut patch, block, [u, v]) = (Patch::default(), self.block(), candidate.displacement);
        patch.take_block(self.pair, block);
        patch.take_area(self.pair, block, Window { min: [u, v], size: (1, 1) });
        if candidate.fraction != [0.0; 2] {
            let (mut between, size) = (Between::default(), (block.width, block.height));
            self.pair.take_between(block, [u, v], self.settings.refinement.interpolation, &mut between);
            let (pixels, _) = between.moved(candidate.fraction.map(|c| (4.0 * c) as i32));
            if let Ok(moved) = Grid::from_vec(size.0, size.1, pixels.to_vec()) {
                patch.area.take(&moved, (0, 0), size, self.pair.rule.border());
            }
        }
        (patch.block, patch.area)
    }

    /// The costs at sub-pixel positions around the best whole-pixel displacement.
    fn subpixel_costs(&self) -> Option<Tile> {
        let steps = self.settings.refinement.subpixel.steps_per_px();
        let (label, reach) = match self.settings.refinement.subpixel {
            Subpixel::Half => ("cost at ½ px", 1),
            Subpixel::Quarter => ("cost at ¼ px", 3),
            Subpixel::None | Subpixel::Parabola => return None,
        };
        let tested = || self.candidates().map(|(tested, _)| tested);
        let centre = tested().find(|tested| tested.fraction != [0.0; 2])?.displacement;
        let mut values = Grid::new(2 * reach + 1, 2 * reach + 1, f32::NAN);
        for tested in tested().filter(|tested| tested.displacement == centre) {
            let [i, j] = tested.fraction.map(|c| (c * steps as f32 + reach as f32) as usize);
            values[(i, j)] = tested.cost as f32;
        }
        let known = || values.cells().iter().copied().filter(|cost| cost.is_finite());
        let range = [known().fold(f32::INFINITY, f32::min), known().fold(0.0, f32::max)];
        Some(Tile::new(label, values, range))
    }

    /// Adds the formula of the cost of the candidate that is shown, with its numbers.
    pub(super) fn add_cost(&self, step: Step) -> Step {
        let Some((candidate, rows)) = self.shown() else { return step };
        let ((a, b), cost, [u, v]) = (self.patches(candidate), self.settings.matching.cost, candidate.vector());
        let distortion = self.rate.distortion(candidate);
        let step = step.put(value::LABEL, cost.label()).put(value::U, u).put(value::V, v);
        let step = step.put_value(self.settings.without_rate().cost(value::DISTORTION, distortion));
        let along = |axis: &str, name: &str, c: f32| match c {
            0.0 => axis.to_owned(),
            _ => format!("{axis}{{{name}:signed}}"),
        };
        let next = format!("I_{{t+1}}({}, {})", along("x", "u", u), along("y", "v", v));
        let step = match cost.sum() {
            Some(sum) => {
                let step = self.sum_of(step.put(value::ROWS_SUMMED, rows), sum, &next, (&a, &b));
                self.add_pixel_term(step, sum, rows, [&a, &b])
            }
            None => self.whole_equation(step, &next, &a, &b),
        };
        self.add_rate(step, candidate)
    }

    /// Adds a sum over the pixels, possibly of the first rows only.
    fn sum_of(&self, step: Step, sum: Sum, next: &str, (a, b): (&Cut, &Cut)) -> Step {
        let (block, rows) = (self.block(), step.real(value::ROWS_SUMMED) as usize);
        let (pixels, count) = (block.width * block.height, block.width * rows);
        let terms = first_and_last(sum, count);
        let is_mean = self.settings.matching.cost == Cost::Mse;
        let (over, terms) = if is_mean { (r"1/N \cdot ", format!(r"1/N \cdot ({terms})")) } else { ("", terms) };
        // A partial sum is a lower bound.
        let (relation, part) = match rows < block.height {
            true => (r"\ge", r"\text{   (first }{rows_summed}\text{ of }{height}\text{ rows)}"),
            false => ("=", ""),
        };
        let squares = (step.real(value::DISTORTION) * pixels as f64).round();
        let mean = if is_mean { r"\frac{{squares}}{{pixels}} = " } else { "" };
        let step = if is_mean { step.put(value::SQUARES, squares) } else { step };
        self.pairs(step, count, |i| self.pixels(a, b, i))
            .put(value::PIXELS, pixels)
            .formula(format!(
                r"{{label}}({{u}}, {{v}}) = {over}\sum_{{x, y}} {}",
                term(sum, &format!("I_t(x, y) - {next}"))
            ))
            .formula(format!(r"{relation}\, {terms}"))
            .formula(format!(r"= {mean}{{distortion}}{part}"))
    }

    /// The gray levels of pixel `i` of the block and of the candidate, row by row.
    pub(super) fn pixels(&self, a: &Cut, b: &Cut, i: usize) -> [u32; 2] {
        let width = self.block().width;
        [a, b].map(|cut| cut.pixel(i % width, i / width).into())
    }

    /// Puts the first two and the last of `count` pixels or parts of the block and of the candidate.
    pub(super) fn pairs(&self, step: Step, count: usize, pair: impl Fn(usize) -> [u32; 2]) -> Step {
        let places = [
            (0, value::BLOCK_FIRST, value::CANDIDATE_FIRST),
            (1, value::BLOCK_SECOND, value::CANDIDATE_SECOND),
            (count.saturating_sub(1), value::BLOCK_LAST, value::CANDIDATE_LAST),
        ];
        places.into_iter().filter(|(i, ..)| *i < count).fold(step, |step, (i, own, other)| {
            let [block, candidate] = pair(i);
            step.put(own, block).put_value(other.is(candidate).inked(self.shown_role()))
        })
    }

    /// Adds the term of the pixel pointed at, if it lies in one of the first `rows` of the block.
    fn add_pixel_term(&self, step: Step, sum: Sum, rows: usize, cuts: [&Cut; 2]) -> Step {
        let focus = self.focus.filter(|point| point.iter().all(|c| *c > -0.5));
        let Some([x, y]) = focus.map(|point| point.map(|c| c.round() as usize)) else { return step };
        let Block { x: left, y: top, width, .. } = self.block();
        if !(left..left + width).contains(&x) || !(top..top + rows).contains(&y) {
            return step;
        }
        let [own, other] = cuts.map(|cut| cut.pixel(x - left, y - top));
        let shown = term(sum, "{block_pointed} - {candidate_pointed}");
        step.put(value::POINTED, (x, y))
            .put(value::BLOCK_POINTED, own)
            .put_value(value::CANDIDATE_POINTED.is(other).inked(self.shown_role()))
            .put(value::TERM, sum.term(own, other))
            .formula(format!(r"\text{{at pixel }}{{pointed}}\text{{:  }}{shown} = {{term}}"))
    }

    /// Adds the rate term of the displacement and the cost with it; nothing for λ = 0.
    fn add_rate(&self, step: Step, candidate: Match) -> Step {
        if self.settings.refinement.lambda == 0.0 {
            return step;
        }
        step.put(value::LABEL, self.settings.matching.cost.label())
            .put(value::LAMBDA, self.rate.lambda)
            .put(value::BITS, self.rate.bits(candidate.quarters()))
            .put(value::PREDICTOR, self.rate.predicted_px())
            .put_value(self.settings.cost(value::COST, candidate.cost).inked(self.shown_role()))
            .formula(r"{label} + \lambda R = {distortion} + {lambda} \cdot {bits:unit} = {cost}")
            .formula(r"\text{R: bits of the difference from the median predictor }{predictor}")
    }

    /// The lower bound of the cost of a skipped candidate, with the rate term.
    pub(super) fn bound_of(&self, skipped: &Skipped) -> f64 {
        let price = self.rate.price(skipped.displacement.map(|c| 4 * c));
        self.settings.matching.cost.of(skipped.bound, self.block()) + price
    }

    /// Adds the formula of the bound by which a candidate was skipped, with the sums of the parts.
    pub(super) fn add_bound(&self, step: Step, skipped: &Skipped) -> Step {
        let (a, b) = self.patches(Match::whole(skipped.displacement, 0.0));
        let [own, others] = [a, b].map(|cut| Parts::of(&cut, skipped.side).sums);
        let (cost, [u, v]) = (self.settings.matching.cost, skipped.displacement);
        let sum = cost.sum().unwrap_or(Sum::Absolute);
        let mean = if sum == Sum::Squared { r"1/{part_pixels} \cdot " } else { "" };
        let times = if cost == Cost::Mse { r"N \cdot " } else { "" };
        let (terms, parts) = (first_and_last(sum, own.len()), term(sum, "S_k - S'_k"));
        self.pairs(step.put(value::U, u).put(value::V, v), own.len(), |k| [own[k], others[k]])
            .put(value::LABEL, cost.label())
            .put(value::PART_PIXELS, skipped.side * skipped.side)
            .put(value::BOUND_SUM, skipped.bound)
            .formula(format!(r"{times}{{label}}({{u}}, {{v}}) \ge {mean}\sum_k {parts}"))
            .formula(format!(r"= {mean}({terms})"))
            .formula(r"= {bound_sum}")
    }

    fn tiles(&self, candidate: Match, rows: usize) -> Vec<Tile> {
        let block = self.block();
        let (a, b) = self.patches(candidate);
        let grid = |f: &dyn Fn(usize, usize) -> f32| Grid::from_fn(block.width, block.height, f);
        let terms =
            |sum: Sum| grid(&|x, y| if y < rows { sum.term(a.pixel(x, y), b.pixel(x, y)) as f32 } else { f32::NAN });
        let (label, differences, top) = match self.settings.matching.cost.sum() {
            Some(sum @ Sum::Absolute) => ("|difference|", terms(sum), 255.0),
            Some(sum @ Sum::Squared) => ("difference²", terms(sum), 255.0 * 255.0),
            None => self.whole_tile(&a, &b),
        };
        let candidate = if self.is_over() { "best match" } else { "candidate" };
        vec![
            Tile::gray("block", grid(&|x, y| f32::from(a.pixel(x, y)))).with_role(Role::Reference),
            Tile::gray(candidate, grid(&|x, y| f32::from(b.pixel(x, y)))).with_role(self.shown_role()),
            Tile::new(label, differences, [0.0, top]).with_role(Role::Error),
        ]
    }

    fn series(&self) -> Series {
        let (mut tested, mut best, mut events, mut number) = (Vec::new(), Vec::new(), Vec::new(), 0.0);
        let mut bounds = Vec::new();
        for (i, event) in self.events.iter().enumerate() {
            let last = tested.last().copied();
            match (event, last) {
                (Event::Candidate { tested: candidate, rows }, _) => {
                    number += 1.0;
                    events.push(i + 1);
                    if *rows == self.block().height {
                        tested.push([number, candidate.cost as f32]);
                    }
                }
                (Event::Skipped(skipped), _) => {
                    number += 1.0;
                    events.push(i + 1);
                    bounds.push([number, self.bound_of(skipped) as f32]);
                }
                (Event::NewBest { .. }, Some(point)) => best.push(point),
                _ => {}
            }
        }
        // The minimum holds up to the last candidate.
        if let Some([_, y]) = best.last().copied() {
            best.push([number, y]);
        }
        Series {
            events,
            ..Series::new(
                "Cost by candidate",
                ["candidate", self.settings.label()],
                if self.is_over() { number as usize } else { ahead(number as usize) },
                [("candidate", Role::Candidate, tested), ("lower bound", Role::Rejected, bounds)]
                    .into_iter()
                    .chain([("minimum so far", Role::Best, best)])
                    .filter(|(name, _, points)| *name != "lower bound" || !points.is_empty())
                    .collect(),
            )
        }
    }
}

/// The next of 16, 24, 32, 48, 64 and so on: an axis that ends there has room ahead and seldom changes.
fn ahead(tested: usize) -> usize {
    let ends = (4..usize::BITS - 1).flat_map(|i| [1usize << i, 3 << (i - 1)]);
    ends.into_iter().find(|end| *end >= tested).unwrap_or(tested)
}

/// The first two terms of a sum over pixels or parts, and the last.
fn first_and_last(sum: Sum, count: usize) -> String {
    let [first, second, last] =
        ["first", "second", "last"].map(|place| term(sum, &format!("{{block_{place}}} - {{candidate_{place}}}")));
    match count {
        0 | 1 => first,
        2 => format!("{first} + {second}"),
        _ => format!(r"{first} + {second} + \ldots + {last}"),
    }
}

fn term(sum: Sum, difference: &str) -> String {
    match sum {
        Sum::Absolute => format!("|{difference}|"),
        Sum::Squared => format!("({difference})^2"),
    }
}

#[cfg(test)]
mod tests {
    use super::ahead;

    #[test]
    fn the_axis_ends_a_little_after_what_was_tested() {
        assert_eq!([0, 13, 16, 17, 25, 33, 49, 1089].map(ahead), [16, 16, 16, 24, 32, 48, 64, 1536]);
        assert!((1..5000).all(|tested| ahead(tested) >= tested && 2 * ahead(tested) <= 3 * tested.max(11)));
    }
}
