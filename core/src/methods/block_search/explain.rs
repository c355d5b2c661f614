//! A block search at a cursor: why the last event happened, in words.

use super::probe::Probe;
use super::subpixel::has_lowest;
use super::{Event, Fit, Match, Stage, shorter};
use crate::scene::{Role, Sentence};

/// A number with a true minus sign.
pub(super) fn signed(v: impl Into<f64>) -> String {
    let v = v.into();
    let shown = short(v.abs());
    if v < 0.0 && shown != "0" { format!("−{shown}") } else { shown }
}

/// A number with at most two digits after the point.
pub(super) fn short(v: f64) -> String {
    let shown = format!("{v:.2}");
    shown.trim_end_matches('0').trim_end_matches('.').into()
}

/// Why `a` is preferred to `b`, which costs the same.
fn preference(a: Match, b: Match) -> &'static str {
    let length = |found: Match| found.quarters().map(|c| c * c).iter().sum::<i32>();
    if length(a) < length(b) { "is shorter" } else { "is as short and comes first, row by row" }
}

/// A displacement as a person reads it.
pub(crate) fn vector([u, v]: [impl Into<f64>; 2]) -> String {
    // A space at which no line is broken.
    format!("({},\u{a0}{})", signed(u), signed(v))
}

/// What a stage passes over of the points that it asks for.
fn left_out(stage: &Stage) -> String {
    match (stage.points.len(), stage.asked) {
        (new, asked) if new == asked => String::new(),
        (0, 1) => " It was tested before or lies outside the window.".into(),
        (0, asked) => format!(" All {asked} were tested before or lie outside the window."),
        (new, asked) => format!(" Of these {asked}, {new} lie in the window and were not tested before."),
    }
}

impl Probe<'_> {
    /// Why the last event happened.
    pub fn sentence(&self) -> Sentence {
        let block = self.block();
        let place = format!("{}×{} px at ({}, {})", block.width, block.height, block.x, block.y);
        let show = |found: Match| self.settings.number(found.cost);
        let said = Sentence::default();
        match (self.events.last(), self.candidate()) {
            (Some(Event::Window), _) | (Some(Event::Candidate { .. } | Event::NewBest { .. }), None) => {
                let (columns, rows) = self.window.size;
                let of = format!("{columns}×{rows} = {} candidates", self.window.count());
                let is_cut = self.window.count() < (2 * self.settings.matching.range + 1).pow(2);
                let cut = if is_cut { "; the picture's border cuts it." } else { "." };
                said.ink(Role::Reference, format!("Block {}", self.index + 1))
                    .text(format!(" is the {place} of frame t. Its "))
                    .ink(Role::Window, "search window")
                    .text(format!(" in frame t+1 holds {of}{cut}"))
            }
            (Some(Event::Stage { stage, .. } | Event::Refine(stage)), _) => {
                said.text(stage.why.clone()).text(left_out(stage))
            }
            (Some(Event::Fit(fit)), _) => self.why_fit(fit),
            (Some(Event::Candidate { .. }), Some((candidate, rows))) => self.why_candidate(candidate, rows),
            (Some(Event::NewBest { before }), Some((best, _))) => {
                let said = said.ink(Role::Best, format!("{} at {}", show(best), vector(best.vector())));
                match *before {
                    None => said.text(" is the first cost, so it is the best so far."),
                    Some(old) if old.cost == best.cost => said.text(format!(
                        " equals the best so far at {}, and the displacement {}: it is preferred.",
                        vector(old.vector()),
                        preference(best, old)
                    )),
                    Some(old) => {
                        said.text(format!(" is less than {} at {}: the new best.", show(old), vector(old.vector())))
                    }
                }
            }
            (Some(Event::Found(found)), _) => said
                .ink(Role::Reference, format!("Block {}", self.index + 1))
                .text(" moves by ")
                .ink(Role::Result, format!("{} px", vector(found.vector())))
                .text(format!(": {} is the smallest of {} tested", self.cost_of(*found), self.tested()))
                .text(self.saved_candidates())
                .text(self.saved_rows()),
            (None, _) => said.text(format!(
                "Nothing has been searched yet: {} blocks of {} px wait. Step into the first.",
                self.pair.blocks.len(),
                self.pair.blocks.size
            )),
        }
    }

    /// What not testing every candidate has saved, if it has.
    fn saved_candidates(&self) -> String {
        let all = self.window.count();
        let whole = self.tests().cells().iter().flatten().count();
        let between = match self.tested() - whole {
            0 => String::new(),
            between => format!(", {between} of them between pixels"),
        };
        match whole < all && self.counted.level.is_none() {
            true if between.is_empty() => format!("; full search would test {all}."),
            true => format!("{between}; full search would test {all} of whole px."),
            false => format!("{between}."),
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

    /// What was fitted, along u and along v.
    fn why_fit(&self, fit: &Fit) -> Sentence {
        let along = |i: usize, name: &str| match fit.costs[i] {
            Some(costs) if !has_lowest(&costs) => {
                format!("Along {name} the costs at the best and beside it are equal: no parabola has a lowest point.")
            }
            Some(costs) => {
                let [before, at, after] = costs.map(|cost| self.settings.number(cost));
                let lowest = signed(fit.fraction[i]);
                format!(
                    "Along {name} a parabola through {before}, {at} and {after} is lowest {lowest} px from the best."
                )
            }
            None => format!("Along {name} a neighbour of the best lies outside the window: nothing is fitted."),
        };
        Sentence::default().text(format!("{} {}", along(0, "u"), along(1, "v")))
    }

    fn why_candidate(&self, candidate: Match, rows: usize) -> Sentence {
        let block = self.block();
        let show = |found: Match| self.settings.number(found.cost);
        let said = Sentence::default()
            .text("Candidate ")
            .ink(Role::Candidate, vector(candidate.vector()))
            .text(format!(" costs {}", show(candidate)));
        let Some(best) = self.best() else {
            return said.text(", the first cost of this block.");
        };
        let best_shown = format!("{} at {}", show(best), vector(best.vector()));
        if rows < block.height {
            let given_up = format!(" after {rows} of {} rows, already more than the best, ", block.height);
            return said.text(given_up).ink(Role::Best, best_shown).text(": given up early.");
        }
        let verdict = match candidate.cost.total_cmp(&best.cost) {
            std::cmp::Ordering::Less => ", less than the best so far, ",
            std::cmp::Ordering::Equal => ", the same as the best so far, ",
            std::cmp::Ordering::Greater => ", more than the best so far, ",
        };
        let said = said.text(verdict).ink(Role::Best, best_shown);
        if candidate.cost == best.cost && shorter(best.quarters(), candidate.quarters()) {
            return said.text(format!(", which {} and stays.", preference(best, candidate)));
        }
        said.text(".")
    }
}
