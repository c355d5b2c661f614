//! A block search at a cursor: what the last event means, in words.

use super::probe::Probe;
use super::subpixel::has_lowest;
use super::true_motion::CLOSE_PX;
use super::whole_window::WholeWindow;
use super::{Cost, Event, Fit, Match, Skipped, Stage, Subpixel, shorter};
use crate::base::words::{cost, counted, fixed, gray, grouped};
use crate::methods::cost::bounds::Parts;
use crate::products::{metrics, predict};
use crate::scene::{Role, Sentence};

/// A match is called poor from this mean (or root-mean-square) difference on, in gray levels per pixel.
const POOR_MATCH: f64 = 10.0;
/// Other minima are called nearly as low up to this mean difference above the match, in gray levels per pixel.
const COMPETING_LEVELS: f64 = 0.5;
/// The same as a share of the cost of the match; the smaller of both decides.
const COMPETING_SHARE: f64 = 0.05;
/// How many ties are listed.
const LISTED: usize = 6;

/// A component of a displacement in px: two decimals, none where it is whole.
pub(super) fn signed(v: impl Into<f64>) -> String {
    let v = v.into();
    fixed(v, decimals(&[v]))
}

/// The decimals of a displacement with these components.
fn decimals(components: &[f64]) -> usize {
    if components.iter().all(|c| c.fract() == 0.0) { 0 } else { 2 }
}

/// A parameter's value with at most two decimals.
pub(super) fn short(v: f64) -> String {
    let shown = format!("{v:.2}");
    shown.trim_end_matches('0').trim_end_matches('.').into()
}

/// Why `a` is preferred to `b`, which costs the same.
fn preference(a: Match, b: Match) -> &'static str {
    let length = |found: Match| found.quarters().map(|c| c * c).iter().sum::<i32>();
    if length(a) < length(b) { "is shorter" } else { "is equally short and comes first in raster order" }
}

/// A displacement as text: two decimals, none where both components are whole.
pub(crate) fn vector([u, v]: [impl Into<f64>; 2]) -> String {
    let components = [u.into(), v.into()];
    let [u, v] = components.map(|c| fixed(c, decimals(&components)));
    // A no-break space.
    format!("({u},\u{a0}{v})")
}

/// The candidates of a stage that are skipped.
fn skipped(stage: &Stage) -> String {
    match (stage.points.len(), stage.asked) {
        (new, asked) if new == asked => String::new(),
        (0, 1) => " Its cost is known already, or it lies outside the search window.".into(),
        (0, 2) => " Both costs are known already, or outside the search window.".into(),
        (0, asked) => format!(" All {asked} costs are known already, or outside the search window."),
        (new, asked) => {
            let are = if new == 1 { "is" } else { "are" };
            let rest = match asked - new {
                1 => "the cost of the other is known already, or it lies",
                _ => "the costs of the others are known already, or they lie",
            };
            format!(" {new} of these {asked} {are} tested now; {rest} outside the search window.")
        }
    }
}

impl Probe<'_> {
    /// What the last event means, and what decided it.
    pub fn sentence(&self) -> Sentence {
        let show = |found: Match| self.settings.show(found.cost);
        let said = Sentence::default();
        match (self.events.last(), self.candidate()) {
            (Some(Event::Window), _) | (Some(Event::Candidate { .. } | Event::NewBest { .. }), None) => {
                self.describe_window()
            }
            (Some(Event::Stage { stage, .. } | Event::Refine(stage)), _) => {
                said.text(stage.why.clone()).text(skipped(stage))
            }
            (Some(Event::Fit(fit)), _) => self.describe_fit(fit),
            (Some(Event::Skipped { skipped, .. }), _) => self.describe_skipped(skipped),
            (Some(Event::Candidate { .. }), Some((candidate, rows))) => self.describe_candidate(candidate, rows),
            (Some(Event::NewBest { before }), Some((best, _))) => {
                let said = said.ink(Role::Best, format!("{} at {}", show(best), vector(best.vector())));
                match *before {
                    None => said.text(" is the minimum so far, as the first candidate of this block."),
                    Some(old) if old.cost == best.cost => said.text(format!(
                        " equals the minimum so far at {}, and the displacement {}: new minimum.",
                        vector(old.vector()),
                        preference(best, old)
                    )),
                    Some(old) => said.text(format!(
                        " is below {} at {}: new minimum.",
                        self.settings.number(old.cost),
                        vector(old.vector())
                    )),
                }
            }
            (Some(Event::Found(found)), _) => self.describe_result(*found),
            (None, _) => {
                let level = match self.counted.level {
                    Some(level) => format!("Level {level} of frame t has"),
                    None => "Frame t has".to_owned(),
                };
                let (blocks, size) = (counted(self.pair.blocks.len(), "block"), self.pair.blocks.size);
                said.text(format!("{level} {blocks} of {size}×{size} px. Each is matched in frame t+1."))
            }
        }
    }

    fn describe_window(&self) -> Sentence {
        let (block, (columns, rows)) = (self.block(), self.window.size);
        let range = self.settings.matching.search_range;
        let is_cut = self.window.count() < (2 * range + 1).pow(2);
        let cut = if is_cut { ", cut at the picture border," } else { "" };
        Sentence::default()
            .ink(Role::Reference, format!("Block {}", self.index + 1))
            .text(format!(": {}×{} px at ({}, {}) in frame t. Its ", block.width, block.height, block.x, block.y))
            .ink(Role::Window, "search window")
            .text(format!(
                " of ±{range} px in frame t+1{cut} holds {columns}×{rows} = {} candidates.",
                grouped(self.window.count())
            ))
    }

    /// The result of a block, how good it is, and after the last block how good the whole field is.
    fn describe_result(&self, found: Match) -> Sentence {
        Sentence::default()
            .ink(Role::Reference, format!("Block {}", self.index + 1))
            .text(": motion vector ")
            .ink(Role::Result, format!("{} px", vector(found.vector())))
            .text(format!(". {} is the minimum of {}.", self.cost_of(found), self.candidates_tested()))
            .text(self.rows_summed())
            .text(self.share_skipped())
            .text(format!(" {}", self.verdict(self.as_tested(found))))
            .text(self.true_motion(found))
            .text(self.conclusion(found))
    }

    /// The match where it was tested: a parabola moves it afterwards.
    pub(super) fn as_tested(&self, found: Match) -> Match {
        let is_fitted = self.settings.refinement.subpixel == Subpixel::Parabola;
        Match { fraction: if is_fitted { [0.0; 2] } else { found.fraction }, ..found }
    }

    /// The number of candidates tested, and the number that full search would test.
    fn candidates_tested(&self) -> String {
        let (all, whole) = (self.window.count(), self.whole_tested());
        let tested = counted_candidates(self.tested());
        let between = match self.tested() - whole {
            0 => String::new(),
            between => format!(", {} between pixels", grouped(between)),
        };
        match whole + self.skipped_here() < all && self.counted.level.is_none() {
            true => format!("{tested}{between} (full search: {})", grouped(all)),
            false => format!("{tested}{between}"),
        }
    }

    /// The number of candidates tested at whole pixels.
    fn whole_tested(&self) -> usize {
        self.tests().cells().iter().flatten().count()
    }

    /// The share of the rows that were summed where candidates were rejected early.
    fn rows_summed(&self) -> String {
        let rows = |event: &Event| if let Event::Candidate { rows, .. } = event { *rows } else { 0 };
        let (summed, all): (usize, _) = (self.events.iter().map(rows).sum(), self.tested() * self.block().height);
        if summed == all {
            return String::new();
        }
        let share = 100.0 * summed as f64 / all as f64;
        format!(" Early exit: {} of {} rows summed, {share:.0} %.", grouped(summed), grouped(all))
    }

    /// The share of the candidates that were skipped by a bound.
    fn share_skipped(&self) -> String {
        match self.skipped_here() {
            0 => String::new(),
            skipped => format!(" Skipped by lower bounds: {}.", counted_share(skipped, self.window.count())),
        }
    }

    /// How reliable the match `found` is: ambiguous, at the limit of the search range, poor, exact, or missed.
    fn verdict(&self, found: Match) -> String {
        let surface = self.full_search();
        // What was found at a sub-pixel position lies beside the minimum of its whole pixels.
        let whole = surface.cost(found.displacement).unwrap_or(found.cost);
        if surface.least.cost < whole.min(found.cost) {
            return self.miss(found, &surface);
        }
        let ties = surface.ties(found.displacement);
        if !ties.is_empty() && ties.len() + 1 == self.window.count() {
            return "All candidates cost the same: without texture the match is arbitrary, and the shortest \
                    displacement is taken."
                .into();
        }
        // Between two pixels both whole displacements cost alike, and more than nothing; that is no ambiguity of the texture.
        let is_beside = |other: &Match| (0..2).all(|i| (other.displacement[i] - found.displacement[i]).abs() <= 1);
        let may_lie_between = found.cost > 0.0
            && self.settings.refinement.subpixel == Subpixel::None
            && ties.len() <= BESIDE
            && ties.iter().all(is_beside);
        if !ties.is_empty() {
            let at: Vec<String> = ties.iter().map(|tie| vector(tie.vector())).collect();
            // Refinement moves the vector by less than a pixel.
            let is_far = self.true_error(found).is_some_and(|(_, off)| off >= CLOSE_PX);
            return match may_lie_between {
                true if is_far => format!("The cost is the same at the neighbouring {}.", at.join(", ")),
                true => format!(
                    "The cost is the same at the neighbouring {}: the displacement may lie in between. Sub-pixel refinement resolves \
                     it.",
                    at.join(", ")
                ),
                false => self.ambiguity(found, "The cost is the same at", at),
            };
        }
        if self.rate.distortion(found) == 0.0 {
            return match self.settings.matching.cost {
                Cost::Zsad => "The match is exact up to an offset.",
                Cost::Ncc => "The match is exact up to a gain and an offset.",
                _ => "The match is exact.",
            }
            .into();
        }
        let levels = self.settings.matching.cost.of_levels(COMPETING_LEVELS, self.block());
        let margin = levels.min(COMPETING_SHARE * whole.abs());
        let competing_minima = surface.competing_minima(found.displacement, whole + margin);
        if !competing_minima.is_empty() {
            let other = |other: &Match| format!("{} at {}", self.settings.number(other.cost), vector(other.vector()));
            let same = match surface.least.cost >= whole {
                true if self.tested() > self.whole_tested() => {
                    "Its whole displacement is the global minimum, but nearly the same cost is reached at other minima:"
                }
                true => "It is the global minimum, but nearly the same cost is reached at other minima:",
                // Only between pixels.
                false => "The search window has other minima, which cost less or nearly the same:",
            };
            return self.ambiguity(found, same, competing_minima.iter().map(other).collect());
        }
        if let Some(limit) = self.at_limit(found) {
            return limit;
        }
        let (mean, levels) = self.difference_per_pixel(found);
        if levels.is_some_and(|levels| levels >= POOR_MATCH) {
            let causes = match self.is_explained(found) {
                true => "",
                false => " Possible causes: occlusion, a change of brightness, or motion other than translation.",
            };
            return format!("{mean}, a poor match.{causes}");
        }
        match surface.least.cost < whole {
            true => format!("It may be a local minimum, since candidates were left out.{}", sentence_of(&mean)),
            // Between pixels only the neighbours of that minimum were tested.
            false if self.tested() > self.whole_tested() => format!(
                "It lies at or beside the global minimum over all whole displacements of the search window. Between pixels only positions \
                 around that minimum were tested.{}",
                sentence_of(&mean)
            ),
            false => format!("It is the global minimum of the search window.{}", sentence_of(&mean)),
        }
    }

    /// A lower cost was left out: where it is, and why it was not tested.
    fn miss(&self, found: Match, surface: &WholeWindow) -> String {
        let least = surface.least;
        let mean = sentence_of(&self.difference_per_pixel(found).0);
        let (cost, at) = (self.settings.show(least.cost), vector(least.vector()));
        if !self.is_refinement {
            return format!("Full search finds {cost} at {at}: the global minimum is missed.{mean}");
        }
        // The coarser level is to blame where a test would have helped: the true displacement costs less than the match.
        let cause = match self.true_error(found) {
            Some((truth, off)) if off >= CLOSE_PX && self.costs_less(truth, found, surface) => {
                " The coarser level led elsewhere, and an error of a coarser level stays. Smaller blocks or fewer levels avoid it."
            }
            Some(_) => "",
            None => " The coarser level may have led elsewhere; smaller blocks or fewer levels would tell.",
        };
        format!(
            "The global minimum, {cost} at {at}, was not tested: refinement stays near the motion vectors of the coarser \
             level.{cause}{mean}"
        )
    }

    /// The match lies at the limit of the search range. Where the truth is known, it says whether the range is the cause.
    fn at_limit(&self, found: Match) -> Option<String> {
        let range = self.settings.matching.search_range as u32;
        let is_at_limit = found.displacement.iter().any(|c| c.unsigned_abs() == range);
        let may_be_lower = self.rate.distortion(found) > 0.0 && self.truth_of_block().is_none();
        (is_at_limit && may_be_lower).then(|| {
            format!("It lies at the limit of the search range of ±{range} px: a larger range may lower the cost.")
        })
    }

    /// Displacements that cost as much, or nearly, as the match; what precedes them is `same`.
    ///
    /// Where the truth names another cause of the error, or the match may be cut off by the range, texture is not the only one.
    fn ambiguity(&self, found: Match, same: &str, at: Vec<String>) -> String {
        let more = match at.len().saturating_sub(LISTED) {
            0 => String::new(),
            more => format!(" and {} more", grouped(more)),
        };
        let listed = at[..at.len().min(LISTED)].join(", ");
        if self.is_explained(found) {
            return format!("{same} {listed}{more}.");
        }
        let limit = self.at_limit(found).map(|limit| format!(" {limit}")).unwrap_or_default();
        format!(
            "{same} {listed}{more}: repeating texture, an edge or a flat area makes the match ambiguous. A larger block may \
             resolve it.{limit}"
        )
    }

    /// The mean difference per pixel in words and in gray levels, for the costs that have one.
    fn difference_per_pixel(&self, found: Match) -> (String, Option<f64>) {
        let cost = self.settings.matching.cost;
        let levels = cost.levels_of(self.rate.distortion(found), self.block());
        let name = if cost.is_squared() { "Root-mean-square difference:" } else { "Mean absolute difference:" };
        (levels.map_or_else(String::new, |levels| format!("{name} {} gray levels", gray(levels as f32))), levels)
    }

    /// After the last block of a picture: the quality of the motion-compensated prediction, and its worst block.
    fn conclusion(&self, found: Match) -> String {
        let is_last = self.index + 1 == self.pair.blocks.len() && self.counted.level.unwrap_or(0) == 0;
        if !is_last {
            return String::new();
        }
        let blocks = &self.pair.blocks;
        let all: Vec<Match> = self.found.iter().copied().chain([found]).collect();
        let field = self.settings.field(self.pair.blocks, all.iter().map(|found| Some(found.result(0))).collect());
        let (frame, next) = (self.pair.current.luma(), self.pair.next.luma());
        let prediction = predict(&field.flow(), next, (field.border, field.filter));
        let psnr = |picture| match metrics::psnr_db(picture, frame) {
            Ok(db) if db.is_finite() => format!("{db:.2} dB"),
            _ => "infinite (no error)".into(),
        };
        let quality = format!(
            " All {} are matched: PSNR of the motion-compensated prediction {}, with zero motion vectors {}.",
            counted(all.len(), "block"),
            psnr(&prediction),
            psnr(next)
        );
        let worst = all.iter().enumerate().max_by(|(_, a), (_, b)| a.cost.total_cmp(&b.cost));
        let skipped = self.skipped.iter().map(|&skipped| skipped as usize).sum::<usize>() + self.skipped_here();
        let quality = match skipped {
            0 => quality,
            skipped => {
                let window = |i| self.pair.window(blocks.block(i), self.settings.matching.search_range).count();
                let all = (0..blocks.len()).map(window).sum();
                format!("{quality} Skipped by lower bounds in all blocks: {}.", counted_share(skipped, all))
            }
        };
        match worst.filter(|(_, worst)| self.rate.lambda == 0.0 && worst.cost > 0.0) {
            Some((i, worst)) => format!("{quality} Worst match: block {}, {}.", i + 1, self.settings.show(worst.cost)),
            None => quality,
        }
    }

    /// The parabolas along u and along v.
    fn describe_fit(&self, fit: &Fit) -> Sentence {
        let along = |i: usize, name: &str| match fit.costs[i] {
            Some(costs) if !has_lowest(&costs) => {
                format!("Along {name} the three costs are equal, so the parabola has no minimum.")
            }
            Some(costs) => {
                let [before, at, after] = costs.map(|cost| self.settings.number(cost));
                let lowest = fixed(fit.fraction[i].into(), 2);
                format!(
                    "Along {name} the parabola through {before}, {at} and {after} has its minimum at {lowest} px from the best match."
                )
            }
            None => format!("Along {name} a neighbour lies outside the search window, so no parabola is fitted."),
        };
        Sentence::default().text(format!("{} {}", along(0, "u"), along(1, "v")))
    }

    fn describe_skipped(&self, skipped: &Skipped) -> Sentence {
        let parts = Parts::of(&self.patches(Match::whole([0, 0], 0.0)).0, skipped.side).counts;
        let sums = match parts.0 * parts.1 {
            1 => "the sums of both blocks".to_owned(),
            count => format!("the sums of {count} parts of {0}×{0} px", skipped.side),
        };
        let at = Match::whole(skipped.displacement, self.bound_of(skipped));
        let said = Sentence::default().text("Candidate ").ink(Role::Candidate, vector(at.vector()));
        let said = said.text(format!(
            ": {} cannot be below {}, by {sums}",
            self.settings.label(),
            self.settings.number(at.cost)
        ));
        match self.best() {
            Some(best) => said
                .text(". The minimum so far is ")
                .ink(Role::Best, format!("{} at {}", self.settings.number(best.cost), vector(best.vector())))
                .text(": skipped."),
            None => said.text(": skipped."),
        }
    }

    fn describe_candidate(&self, candidate: Match, rows: usize) -> Sentence {
        let height = self.block().height;
        let said = Sentence::default().text("Candidate ").ink(Role::Candidate, vector(candidate.vector())).text(": ");
        let cost = self.settings.show(candidate.cost);
        let Some(best) = self.best() else {
            return said.text(format!("{cost}, the first cost of this block."));
        };
        let minimum = format!("{} at {}", self.settings.number(best.cost), vector(best.vector()));
        if rows < height {
            let cost = self.settings.bound(candidate.cost);
            return said
                .text(format!("{cost} after {rows} of {height} rows exceeds the minimum so far, "))
                .ink(Role::Best, minimum)
                .text(". Early exit: rejected.");
        }
        let (relation, verdict) = match candidate.cost.total_cmp(&best.cost) {
            std::cmp::Ordering::Less => ("is below", "."),
            std::cmp::Ordering::Equal => ("equals", "."),
            std::cmp::Ordering::Greater => ("exceeds", ": rejected."),
        };
        let said = said.text(format!("{cost} {relation} the minimum so far, ")).ink(Role::Best, minimum);
        if candidate.cost == best.cost && shorter(best.quarters(), candidate.quarters()) {
            return said.text(format!(". The earlier displacement {}, so it is kept.", preference(best, candidate)));
        }
        said.text(verdict)
    }
}

/// The most displacements beside the match that a displacement between pixels explains.
const BESIDE: usize = 3;

/// `940 of 1089 candidates, 86.3 %`.
pub(crate) fn counted_share(part: usize, all: usize) -> String {
    let share = 100.0 * part as f64 / all.max(1) as f64;
    format!("{} of {} candidates, {} %", grouped(part), grouped(all), fixed(share, 1))
}

/// `1 tested candidate`, `25 tested candidates`.
fn counted_candidates(count: usize) -> String {
    format!("{} tested candidate{}", cost(count as f64), if count == 1 { "" } else { "s" })
}

/// A clause as a further sentence; nothing if there is none.
fn sentence_of(clause: &str) -> String {
    if clause.is_empty() { String::new() } else { format!(" {clause}.") }
}
