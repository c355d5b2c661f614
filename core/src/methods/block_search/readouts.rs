//! A block search at a cursor: facts, formulas, tiles and charts.

use super::explain::{counted_share, short, signed, vector};
use super::probe::Probe;
use super::subpixel::has_lowest;
use super::{Cost, Event, Fit, Match, Neighbours, Patch, Skipped, Subpixel, Tester, Window, Workspace};
use crate::base::words::{cost as cost_text, fixed, grouped};
use crate::data::{Between, Histogram};
use crate::geometry::Grid;
use crate::methods::cost::{Cut, Sum, bounds::Parts};
use crate::scene::{BetweenPixels, Fact, Footing, Math, Picture, Readout, Role, Series, Surface, Tile};

impl Probe<'_> {
    /// The facts, formulas and charts of the step.
    pub fn readouts(&self) -> Vec<Readout> {
        if self.events.is_empty() {
            return Vec::new();
        }
        let mut readouts = vec![Readout::Facts(self.facts())];
        if let Some(Event::Skipped { skipped, .. }) = self.events.last() {
            readouts.push(Readout::Equation(self.bound_equation(skipped)));
        } else if let Some(Event::Fit(fit)) = self.events.last() {
            readouts.push(Readout::Equation(self.parabolas(fit)));
        } else if let Some((candidate, rows)) = self.shown() {
            let mut lines = self.equation(candidate, rows);
            lines.extend(self.rate_lines(candidate));
            readouts.push(Readout::Equation(lines));
        }
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

    /// The costs of the candidates that the search has left out, at its end; those of levels are no misses.
    fn untested(&self, whole: &Grid<f32>) -> Option<Grid<f32>> {
        let costs = self.costs();
        let is_whole = costs.cells().iter().all(|cost| cost.is_finite());
        let left_out = |x: usize, y: usize| if costs[(x, y)].is_finite() { f32::NAN } else { whole[(x, y)] };
        (self.is_over() && !is_whole).then(|| Grid::from_fn(costs.width(), costs.height(), left_out))
    }

    /// The candidates between pixels.
    fn between(&self) -> Vec<BetweenPixels> {
        let tested = self.events.iter().filter_map(|event| match event {
            Event::Candidate { tested, .. } if tested.fraction != [0.0; 2] => {
                Some(BetweenPixels { at: tested.vector(), value: tested.cost as f32 })
            }
            _ => None,
        });
        tested.collect()
    }

    /// The unit of the cost; none where the price of the displacement is part of it.
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
        let own = self.events.last().and_then(|event| match event {
            Event::Found(found) => Some(found),
            _ => None,
        });
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

    fn facts(&self) -> Vec<Fact> {
        let block = self.block();
        let mut facts = vec![
            Fact::new(
                "Block",
                format!(
                    "{} of {}, at ({}, {})",
                    grouped(self.index + 1),
                    grouped(self.pair.blocks.len()),
                    block.x,
                    block.y
                ),
                Some(Role::Reference),
            ),
            Fact::new("Tested", self.counted(), None),
        ];
        let of = |found: Match| format!("{} px, {}", vector(found.vector()), self.cost_of(found));
        let at_least = |found: Match| format!("{} px, {}", vector(found.vector()), self.settings.bound(found.cost));
        if let Some(Event::Skipped { skipped, .. }) = self.events.last() {
            let bound = Match::whole(skipped.displacement, self.bound_of(skipped));
            facts.push(Fact::new("Candidate", at_least(bound), Some(Role::Candidate)));
        } else if let Some((candidate, rows)) = self.at_hand() {
            let value = if rows < block.height { at_least(candidate) } else { of(candidate) };
            facts.push(Fact::new("Candidate", value, Some(Role::Candidate)));
        }
        if self.skipped_here() > 0 {
            let value = counted_share(self.skipped_here(), self.window.count());
            facts.push(Fact::new("Skipped", value, None));
        }
        if let Some(best) = self.best() {
            let label = if self.is_over() { "Displacement" } else { "Best so far" };
            let role = if self.is_over() { Role::Result } else { Role::Best };
            facts.push(Fact::new(label, of(best), Some(role)));
        }
        facts
    }

    /// The number of candidates tested in the window, and at sub-pixel positions.
    fn counted(&self) -> String {
        let whole = self.tests().cells().iter().flatten().count();
        let of_window = format!("{} of {}", grouped(whole), grouped(self.window.count()));
        match self.tested() - whole {
            0 => of_window,
            between => format!("{of_window}, {} between pixels", grouped(between)),
        }
    }

    /// The cost of a match, and where it was tested if a parabola has moved the match since.
    pub(super) fn cost_of(&self, found: Match) -> String {
        let cost = self.settings.show(found.cost);
        let is_fitted = self.settings.refinement.subpixel == Subpixel::Parabola && found.fraction != [0.0; 2];
        if is_fitted { format!("{cost} at {}", vector(found.displacement)) } else { cost }
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

    /// The distortion of a candidate as text: its cost without the rate term.
    pub(super) fn distortion(&self, candidate: Match) -> String {
        self.settings.without_rate().number(self.rate.distortion(candidate))
    }

    /// The rate term of the displacement and the cost with it; nothing for λ = 0.
    fn rate_lines(&self, candidate: Match) -> Vec<Math> {
        if self.settings.refinement.lambda == 0.0 {
            return Vec::new();
        }
        let bits = self.rate.bits(candidate.quarters());
        let sum = Math::Row(vec![
            Math::text(format!("{} + λR = {} + ", self.settings.matching.cost.label(), self.distortion(candidate))),
            Math::text(format!("{} · {bits} bits = ", short(self.rate.lambda))),
            Math::ink(self.shown_role(), self.settings.number(candidate.cost)),
        ]);
        let predicted = Math::ink(Role::Predicted, vector(self.rate.predicted_px()));
        vec![sum, Math::Row(vec![Math::text("R: bits of the difference from the median predictor "), predicted])]
    }

    /// The minimum of each parabola, with its numbers.
    fn parabolas(&self, fit: &Fit) -> Vec<Math> {
        let best = self.best().map_or([0, 0], |best| best.displacement);
        let along = |i: usize, name: &'static str| {
            let [before, at, after] = fit.costs[i].filter(has_lowest)?.map(|cost| self.settings.number(cost));
            Some(Math::Row(vec![
                Math::Var(name),
                Math::text(format!(" = {} + ", signed(best[i]))),
                Math::Frac(
                    Box::new(Math::text(format!("{before} − {after}"))),
                    Box::new(Math::text(format!("2 · ({before} − 2 · {at} + {after})"))),
                ),
                Math::text(" = "),
                Math::ink(Role::Best, format!("{} px", fixed((best[i] as f32 + fit.fraction[i]).into(), 2))),
            ]))
        };
        [along(0, "u"), along(1, "v")].into_iter().flatten().collect()
    }

    /// The costs at sub-pixel positions around the best whole-pixel displacement.
    fn subpixel_costs(&self) -> Option<Tile> {
        let steps = self.settings.refinement.subpixel.steps_per_px();
        let (label, reach) = match self.settings.refinement.subpixel {
            Subpixel::Half => ("cost at ½ px", 1),
            Subpixel::Quarter => ("cost at ¼ px", 3),
            Subpixel::None | Subpixel::Parabola => return None,
        };
        let tested = || {
            self.events.iter().filter_map(|event| match event {
                Event::Candidate { tested, .. } => Some(*tested),
                _ => None,
            })
        };
        let centre = tested().find(|tested| tested.fraction != [0.0; 2])?.displacement;
        let mut values = Grid::new(2 * reach + 1, 2 * reach + 1, f32::NAN);
        for tested in tested().filter(|tested| tested.displacement == centre) {
            let [i, j] = tested.fraction.map(|c| (c * steps as f32 + reach as f32) as usize);
            values[(i, j)] = tested.cost as f32;
        }
        let known = || values.cells().iter().copied().filter(|cost| cost.is_finite());
        let range = [known().fold(f32::INFINITY, f32::min), known().fold(0.0, f32::max)];
        Some(Tile { label, role: None, values, range, framed: Vec::new() })
    }

    fn equation(&self, candidate: Match, rows: usize) -> Vec<Math> {
        let block = self.block();
        let (a, b) = self.patches(candidate);
        let cost = self.settings.matching.cost;
        let [u, v] = candidate.vector().map(signed);
        let name = || Math::text(format!("{}({u}, {v}) ", cost.label()));
        let Some(sum) = cost.sum() else {
            return self.whole_equation(candidate, &a, &b);
        };
        let (open, close) = if cost == Cost::Mse { ("1/N · ", "") } else { ("", "") };
        let difference = Math::Row(vec![
            Math::indexed(Math::Var("I"), Math::Var("t")),
            Math::text("(x, y) − "),
            Math::indexed(Math::Var("I"), Math::text("t+1")),
            Math::text(format!("(x{}, y{})", offset(candidate.vector()[0]), offset(candidate.vector()[1]))),
        ]);
        let general = vec![
            name(),
            Math::text(format!("= {open}")),
            Math::Sum(Box::new(Math::text("x, y"))),
            term(sum, difference),
            Math::text(close),
        ];
        let numbers = |x: usize, y: usize| {
            let pair = vec![
                Math::ink(Role::Reference, a.pixel(x, y).to_string()),
                Math::text(" − "),
                Math::ink(self.shown_role(), b.pixel(x, y).to_string()),
            ];
            term(sum, Math::Row(pair))
        };
        let last = (block.width - 1, rows - 1);
        // A partial sum is a lower bound.
        let relation = if rows < block.height { "≥ " } else { "= " };
        let mut terms = vec![Math::text(relation), numbers(0, 0)];
        if block.width > 1 {
            terms.extend([Math::text(" + "), numbers(1, 0)]);
        }
        if last.0 > 1 || last.1 > 0 {
            terms.extend([Math::text(" + … + "), numbers(last.0, last.1)]);
        }
        let mut result = vec![Math::text(format!("= {}", self.distortion(candidate)))];
        if cost == Cost::Mse {
            let n = block.width * block.height;
            let distortion = self.rate.distortion(candidate);
            let squares = (distortion * n as f64).round();
            terms.insert(1, Math::text("1/N · ("));
            terms.push(Math::text(")"));
            result = vec![
                Math::text("= "),
                Math::Frac(Box::new(Math::text(cost_text(squares))), Box::new(Math::text(n.to_string()))),
                Math::text(format!(" = {}", self.distortion(candidate))),
            ];
        }
        if rows < block.height {
            result.push(Math::text(format!("   (first {rows} of {} rows)", block.height)));
        }
        let mut lines = vec![Math::Row(general), Math::Row(terms), Math::Row(result)];
        lines.extend(self.focused_term(&a, &b, rows));
        lines
    }

    /// The term of the pixel pointed at, if it lies in a row of the block that was summed.
    fn focused_term(&self, a: &Cut, b: &Cut, rows: usize) -> Option<Math> {
        let block = self.block();
        let [x, y] = self.focus?.map(|c| c.round() as isize);
        let (i, j) = (x - block.x as isize, y - block.y as isize);
        let inside = (0..block.width as isize).contains(&i) && (0..rows as isize).contains(&j);
        let (i, j) = inside.then_some((i as usize, j as usize))?;
        let (p, q, sum) = (a.pixel(i, j), b.pixel(i, j), self.settings.matching.cost.sum()?);
        let numbers = vec![
            Math::ink(Role::Reference, p.to_string()),
            Math::text(" − "),
            Math::ink(self.shown_role(), q.to_string()),
        ];
        Some(Math::Row(vec![
            Math::text(format!("at pixel ({x}, {y}):  ")),
            term(sum, Math::Row(numbers)),
            Math::text(format!(" = {}", cost_text(sum.term(p, q).into()))),
        ]))
    }

    /// The lower bound of the cost of a skipped candidate, with the rate term.
    pub(super) fn bound_of(&self, skipped: &Skipped) -> f64 {
        let price = self.rate.price(skipped.displacement.map(|c| 4 * c));
        self.settings.matching.cost.of(skipped.bound, self.block()) + price
    }

    /// The bound by which a candidate was skipped: its formula, and with the sums of the parts.
    fn bound_equation(&self, skipped: &Skipped) -> Vec<Math> {
        let (a, b) = self.patches(Match::whole(skipped.displacement, 0.0));
        let [own, others] = [a, b].map(|cut| Parts::of(&cut, skipped.side).sums);
        let (sum, pixels) = (self.settings.matching.cost.sum().unwrap_or(Sum::Absolute), skipped.side * skipped.side);
        let [u, v] = skipped.displacement.map(signed);
        let of_part = |of: Math| Math::indexed(of, Math::Var("k"));
        let difference = Math::Row(vec![of_part(Math::Var("S")), Math::text(" − "), of_part(Math::text("S′"))]);
        let mean = if sum == Sum::Squared { format!("1/{pixels} · ") } else { String::new() };
        let label =
            if self.settings.matching.cost == Cost::Mse { "N · MSE" } else { self.settings.matching.cost.label() };
        let general = vec![
            Math::text(format!("{label}({u}, {v}) ≥ {mean}")),
            Math::Sum(Box::new(Math::Var("k"))),
            term(sum, difference),
        ];
        let numbers = |k: usize| {
            let pair = vec![
                Math::ink(Role::Reference, cost_text(own[k].into())),
                Math::text(" − "),
                Math::ink(Role::Candidate, cost_text(others[k].into())),
            ];
            term(sum, Math::Row(pair))
        };
        let mut terms = vec![Math::text(format!("= {mean}("))];
        terms.extend(own.first().map(|_| numbers(0)));
        match own.len() {
            0 | 1 => {}
            2 => terms.extend([Math::text(" + "), numbers(1)]),
            count => terms.extend([Math::text(" + … + "), numbers(count - 1)]),
        }
        terms.push(Math::text(")"));
        let result = Math::text(format!("= {}", cost_text(skipped.bound.into())));
        vec![Math::Row(general), Math::Row(terms), result]
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
        let tile = |label, role, values, top| Tile { label, role, values, range: [0.0, top], framed: Vec::new() };
        vec![
            tile("block", Some(Role::Reference), grid(&|x, y| f32::from(a.pixel(x, y))), 255.0),
            tile(
                if self.is_over() { "best match" } else { "candidate" },
                Some(self.shown_role()),
                grid(&|x, y| f32::from(b.pixel(x, y))),
                255.0,
            ),
            tile(label, Some(Role::Error), differences, top),
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
                (Event::Skipped { skipped, .. }, _) => {
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
            title: "Cost by candidate",
            x_label: "candidate",
            y_label: self.settings.label(),
            x_max: if self.is_over() { number as usize } else { ahead(number as usize) },
            events,
            lines: [("candidate", Role::Candidate, tested), ("lower bound", Role::Rejected, bounds)]
                .into_iter()
                .chain([("minimum so far", Role::Best, best)])
                .filter(|(name, _, points)| *name != "lower bound" || !points.is_empty())
                .collect(),
            ..Series::default()
        }
    }
}

/// The next of 16, 24, 32, 48, 64 and so on: an axis that ends there has room ahead and seldom changes.
fn ahead(tested: usize) -> usize {
    let ends = (4..usize::BITS - 1).flat_map(|i| [1usize << i, 3 << (i - 1)]);
    ends.into_iter().find(|end| *end >= tested).unwrap_or(tested)
}

/// A displacement added to a coordinate: ` + 3`, ` − 0.50`.
pub(super) fn offset(v: f32) -> String {
    match v {
        0.0 => String::new(),
        v if v < 0.0 => format!(" − {}", signed(-v)),
        v => format!(" + {}", signed(v)),
    }
}

fn term(sum: Sum, difference: Math) -> Math {
    match sum {
        Sum::Absolute => Math::Abs(Box::new(difference)),
        Sum::Squared => {
            let bracketed = Math::Row(vec![Math::text("("), difference, Math::text(")")]);
            Math::power(bracketed, Math::text("2"))
        }
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
