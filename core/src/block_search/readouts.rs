//! A block search at a cursor: its numbers.

use super::probe::Probe;
use super::tell::{signed, vector};
use super::{Cost, Displacement, Event, Match, Patch, Window};
use crate::cost::{Cut, Sum};
use crate::scene::{Fact, Math, Readout, Series, Surface, Tile};
use crate::{Grid, Role};

impl Probe<'_> {
    /// The numbers of the step.
    pub fn readouts(&self) -> Vec<Readout> {
        if self.events.is_empty() {
            return Vec::new();
        }
        let mut readouts = vec![Readout::Facts(self.facts())];
        if let Some((candidate, rows)) = self.shown() {
            readouts.push(Readout::Equation(self.equation(candidate, rows)));
            readouts.push(Readout::Tiles(self.tiles(candidate, rows)));
        }
        readouts.push(Readout::Surface(Surface {
            title: self.cost.label(),
            origin: self.window.min,
            values: self.costs(),
            events: self.tests(),
            probe: self.candidate().filter(|_| !self.is_over()).map(|(candidate, _)| candidate.displacement),
            best: self.best().map(|best| best.displacement),
        }));
        readouts.push(Readout::Series(self.series()));
        readouts
    }

    /// The candidate whose numbers are shown: the one under test, at the end the one that won.
    pub(super) fn shown(&self) -> Option<(Match, usize)> {
        match self.events.last() {
            Some(Event::Found(found)) => Some((*found, self.block().height)),
            _ => self.candidate(),
        }
    }

    /// The role of that candidate.
    pub(super) fn shown_role(&self) -> Role {
        if self.is_over() { Role::Best } else { Role::Candidate }
    }

    fn facts(&self) -> Vec<Fact> {
        let block = self.block();
        let mut facts = vec![
            Fact {
                label: "Block",
                value: format!("{} of {}, at ({}, {})", self.index + 1, self.pair.blocks.len(), block.x, block.y),
                role: Some(Role::Reference),
            },
            Fact { label: "Tested", value: format!("{} of {}", self.tested(), self.window.count()), role: None },
        ];
        let of = |found: Match| {
            let (cost, sum) = (self.cost.label(), self.cost.show(found.cost));
            format!("{} px, {cost} {sum}", vector(found.displacement))
        };
        if let Some((candidate, _)) = self.candidate().filter(|_| !self.is_over()) {
            facts.push(Fact { label: "Candidate", value: of(candidate), role: Some(Role::Candidate) });
        }
        if let Some(best) = self.best() {
            let label = if self.is_over() { "Displacement" } else { "Best so far" };
            let role = if self.is_over() { Role::Result } else { Role::Best };
            facts.push(Fact { label, value: of(best), role: Some(role) });
        }
        facts
    }

    /// The pixels of the block and of the candidate: `(frame t, frame t + 1)`.
    fn patches(&self, displacement: Displacement) -> (Cut, Cut) {
        let mut patch = Patch::default();
        patch.take_block(self.pair, self.block());
        patch.take_area(self.pair, self.block(), Window { min: displacement, size: (1, 1) });
        (patch.block, patch.area)
    }

    fn equation(&self, candidate: Match, rows: usize) -> Vec<Math> {
        let block = self.block();
        let (a, b) = self.patches(candidate.displacement);
        let [u, v] = candidate.displacement.map(signed);
        let name = || Math::text(format!("{}({u}, {v}) ", self.cost.label()));
        let Some(sum) = self.cost.sum() else {
            return self.whole_equation(candidate, &a, &b);
        };
        let (open, close) = if self.cost == Cost::Mse { ("1/N · ", "") } else { ("", "") };
        let difference = Math::Row(vec![
            Math::indexed(Math::Var("I"), Math::Var("t")),
            Math::text("(x, y) − "),
            Math::indexed(Math::Var("I"), Math::text("t+1")),
            Math::text(format!("(x{}, y{})", offset(candidate.displacement[0]), offset(candidate.displacement[1]))),
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
        // Some rows add up to no more than all of them.
        let relation = if rows < block.height { "≥ " } else { "= " };
        let mut terms = vec![Math::text(relation), numbers(0, 0)];
        if block.width > 1 {
            terms.extend([Math::text(" + "), numbers(1, 0)]);
        }
        if last.0 > 1 || last.1 > 0 {
            terms.extend([Math::text(" + … + "), numbers(last.0, last.1)]);
        }
        let mut result = vec![Math::text(format!("= {}", self.cost.show(candidate.cost)))];
        if self.cost == Cost::Mse {
            let n = block.width * block.height;
            let squares = (candidate.cost * n as f64).round();
            terms.insert(1, Math::text("1/N · ("));
            terms.push(Math::text(")"));
            result = vec![
                Math::text("= "),
                Math::Frac(Box::new(Math::text(squares.to_string())), Box::new(Math::text(n.to_string()))),
                Math::text(format!(" = {}", self.cost.show(candidate.cost))),
            ];
        }
        if rows < block.height {
            result.push(Math::text(format!("   (first {rows} of {} rows)", block.height)));
        }
        let mut lines = vec![Math::Row(general), Math::Row(terms), Math::Row(result)];
        lines.extend(self.focused_term(&a, &b, rows));
        lines
    }

    /// The term of the pixel pointed at, if it lies in the rows of the block that were summed.
    fn focused_term(&self, a: &Cut, b: &Cut, rows: usize) -> Option<Math> {
        let block = self.block();
        let [x, y] = self.focus?.map(|c| c.round() as isize);
        let (i, j) = (x - block.x as isize, y - block.y as isize);
        let inside = (0..block.width as isize).contains(&i) && (0..rows as isize).contains(&j);
        let (i, j) = inside.then_some((i as usize, j as usize))?;
        let (p, q, sum) = (a.pixel(i, j), b.pixel(i, j), self.cost.sum()?);
        let numbers = vec![
            Math::ink(Role::Reference, p.to_string()),
            Math::text(" − "),
            Math::ink(self.shown_role(), q.to_string()),
        ];
        Some(Math::Row(vec![
            Math::text(format!("at pixel ({x}, {y}):  ")),
            term(sum, Math::Row(numbers)),
            Math::text(format!(" = {}", sum.term(p, q))),
        ]))
    }

    fn tiles(&self, candidate: Match, rows: usize) -> Vec<Tile> {
        let block = self.block();
        let (a, b) = self.patches(candidate.displacement);
        let grid = |f: &dyn Fn(usize, usize) -> f32| Grid::from_fn(block.width, block.height, f);
        let terms =
            |sum: Sum| grid(&|x, y| if y < rows { sum.term(a.pixel(x, y), b.pixel(x, y)) as f32 } else { f32::NAN });
        let (label, differences, top) = match self.cost.sum() {
            Some(sum @ Sum::Absolute) => ("|difference|", terms(sum), 255.0),
            Some(sum @ Sum::Squared) => ("difference²", terms(sum), 255.0 * 255.0),
            None => self.whole_tile(&a, &b),
        };
        let tile = |label, role, values, top| Tile { label, role, values, range: [0.0, top] };
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
        for (i, event) in self.events.iter().enumerate() {
            let last = tested.last().copied();
            match (event, last) {
                (&Event::Candidate { cost, rows, .. }, _) => {
                    number += 1.0;
                    events.push(i + 1);
                    if rows == self.block().height {
                        tested.push([number, cost as f32]);
                    }
                }
                (Event::NewBest { .. }, Some(point)) => best.push(point),
                _ => {}
            }
        }
        // The best stays what it is up to the last candidate.
        if let Some([_, y]) = best.last().copied() {
            best.push([number, y]);
        }
        Series {
            title: "Cost by candidate",
            x_label: "candidate",
            y_label: self.cost.label(),
            x_max: self.window.count(),
            events,
            lines: vec![("candidate", Role::Candidate, tested), ("best so far", Role::Best, best)],
        }
    }
}

/// What is added to a coordinate: ` + 3`.
pub(super) fn offset(v: i32) -> String {
    match v {
        0 => String::new(),
        _ if v < 0 => format!(" − {}", v.unsigned_abs()),
        _ => format!(" + {v}"),
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
