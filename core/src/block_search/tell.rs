//! A block search at a cursor: why the last event happened, in words.

use super::probe::Probe;
use super::{Displacement, Event, Match, shorter};
use crate::Role;
use crate::scene::Sentence;

/// A number with a true minus sign.
pub(super) fn signed(v: i32) -> String {
    if v < 0 { format!("−{}", v.unsigned_abs()) } else { v.to_string() }
}

/// Why `a` is preferred to `b`, which costs the same.
fn preference(a: Displacement, b: Displacement) -> &'static str {
    let length = |[u, v]: Displacement| u * u + v * v;
    if length(a) < length(b) { "is shorter" } else { "is as short and comes first, row by row" }
}

pub(super) fn vector([u, v]: Displacement) -> String {
    format!("({}, {})", signed(u), signed(v))
}

impl Probe<'_> {
    /// Why the last event happened.
    pub fn sentence(&self) -> Sentence {
        let block = self.block();
        let place = format!("{}×{} px at ({}, {})", block.width, block.height, block.x, block.y);
        let show = |found: Match| self.cost.show(found.sum, block);
        let said = Sentence::default();
        match (self.events.last(), self.candidate()) {
            (Some(Event::Window), _) | (Some(Event::Candidate { .. } | Event::NewBest { .. }), None) => {
                let (columns, rows) = self.window.size;
                let of = format!("{columns}×{rows} = {} candidates", self.window.count());
                let is_cut = self.window.count() < (2 * self.range + 1).pow(2);
                let cut = if is_cut { "; the picture's border cuts it." } else { "." };
                said.ink(Role::Reference, format!("Block {}", self.index + 1))
                    .text(format!(" is the {place} of frame t. Its "))
                    .ink(Role::Window, "search window")
                    .text(format!(" in frame t+1 holds {of}{cut}"))
            }
            (Some(Event::Candidate { .. }), Some((candidate, rows))) => self.why_candidate(candidate, rows),
            (Some(Event::NewBest { before }), Some((best, _))) => {
                let said = said.ink(Role::Best, format!("{} at {}", show(best), vector(best.displacement)));
                match *before {
                    None => said.text(" is the first cost, so it is the best so far."),
                    Some(old) if old.sum == best.sum => said.text(format!(
                        " equals the best so far at {}, and the displacement {}: it is preferred.",
                        vector(old.displacement),
                        preference(best.displacement, old.displacement)
                    )),
                    Some(old) => {
                        said.text(format!(" is less than {} at {}: the new best.", show(old), vector(old.displacement)))
                    }
                }
            }
            (Some(Event::Found(found)), _) => said
                .ink(Role::Reference, format!("Block {}", self.index + 1))
                .text(" moves by ")
                .ink(Role::Result, format!("{} px", vector(found.displacement)))
                .text(format!(": {} {} is the smallest of {} tested.", self.cost.label(), show(*found), self.tested()))
                .text(self.saved_rows()),
            (None, _) => said.text(format!(
                "Nothing has been searched yet: {} blocks of {} px wait. Step into the first.",
                self.pair.blocks.len(),
                self.pair.blocks.size
            )),
        }
    }

    /// What giving up early has saved, if it has.
    fn saved_rows(&self) -> String {
        let looked_at: usize =
            self.events.iter().map(|event| if let Event::Candidate { rows, .. } = event { *rows } else { 0 }).sum();
        let all = self.tested() * self.block().height;
        if looked_at == all {
            return String::new();
        }
        format!(
            " Giving up early, {looked_at} of {all} rows were added up: {:.0} %.",
            100.0 * looked_at as f64 / all as f64
        )
    }

    fn why_candidate(&self, candidate: Match, rows: usize) -> Sentence {
        let block = self.block();
        let show = |found: Match| self.cost.show(found.sum, block);
        let said = Sentence::default()
            .text("Candidate ")
            .ink(Role::Candidate, vector(candidate.displacement))
            .text(format!(" costs {}", show(candidate)));
        let Some(best) = self.best() else {
            return said.text(", the first cost of this block.");
        };
        let best_shown = format!("{} at {}", show(best), vector(best.displacement));
        if rows < block.height {
            let given_up = format!(" after {rows} of {} rows, already more than the best, ", block.height);
            return said.text(given_up).ink(Role::Best, best_shown).text(": given up early.");
        }
        let verdict = match candidate.sum.cmp(&best.sum) {
            std::cmp::Ordering::Less => ", less than the best so far, ",
            std::cmp::Ordering::Equal => ", the same as the best so far, ",
            std::cmp::Ordering::Greater => ", more than the best so far, ",
        };
        let said = said.text(verdict).ink(Role::Best, best_shown);
        if candidate.sum == best.sum && shorter(best.displacement, candidate.displacement) {
            return said.text(format!(", which {} and stays.", preference(best.displacement, candidate.displacement)));
        }
        said.text(".")
    }
}
