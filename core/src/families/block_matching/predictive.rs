//! Predictive search in the manner of EPZS: the motion vectors of neighbouring blocks are tested first.
//!
//! ```text
//!        3 . . 3 . a 3 . . 3
//! ┌─┬─┬─┐. . . . . . . . . .     l, a, r  motion vectors of the blocks to the left, above, and above right
//! │ │a│r│. . . . . . . . . .     m        their median, tested first: often the search stops there
//! ├─┼─┴─┘3 . . 3 . 2 2 l . 3     0        the zero displacement; and this block's vector in the previous pair, if enabled
//! │l│?│  . . . . . 2 m 2 . .     2        a square descends from the best of them to a local minimum
//! └─┴─┘  . . . . . 2 2 2 . r     3        if that is still poor: a grid over the search window, and descent from its best
//!        3 . . 0 . . 3 . . 3
//! ```

use super::diamond::{Descent, descend};
use super::three_step::SQUARE;
use crate::base::Observer;
use crate::methods::block_search::{
    BlockSearch, Displacement, Event, Match, Subpixel, Tester, around, block_search_params, search_pseudocode, vector,
};
use crate::run::Info;
use crate::scene::Name;

block_search_params! {
    /// Predictive search (EPZS): starts at predictors, stops early if one matches, and descends to a minimum otherwise.
    pub struct Predictive {
        /// Largest mean difference of the best match at which the search stops (early termination).
        termination_threshold: f32 = 0.25, 0.0..=16.0, "gray levels";
        /// Mean difference above which a block is searched again, from a grid over the search window.
        grid_threshold: f32 = 2.0, 0.0..=16.0, "gray levels";
        /// Spacing of the grid's candidates; 1 makes it a full search.
        grid_step: usize = 3, 1..=16, "px";
        /// Number of the grid's best candidates from which the search descends.
        grid_starts: usize = 10, 1..=64;
        /// Use the block's motion vector from the previous pair of frames as a predictor. The previous pair is then searched first.
        temporal_predictor: bool = false;
    }
    renamed {
        "enough" => "termination-threshold",
        "poor" => "grid-threshold",
        "grid" => "grid-step",
        "starts" => "grid-starts",
        "temporal" => "temporal-predictor",
    }
}

search_pseudocode! {
    TEST_MEDIAN: "  test the median predictor: median of the left, above and above-right motion vectors",
    STOP_AT_MEDIAN: "  if its cost per pixel ≤ termination threshold, then stop",
    TEST_PREDICTORS: "  test (0, 0), the three neighbours, and the temporal predictor",
    STOP_AT_PREDICTOR: "  if the minimum per pixel ≤ termination threshold, then stop",
    REPEAT: "  repeat",
    TEST_SQUARE: "    test the square: the 8 neighbours of best",
    UNTIL_BEST_STAYS: "  until best is unchanged",
    IS_POOR: "  if the minimum per pixel > grid threshold, then",
    TEST_GRID: "    test a grid of candidates over the search window",
    WALK_FROM_GRID: "    descend as above from each of its best grid starts",
}

impl BlockSearch for Predictive {
    const INFO: Info = Info {
        id: "predictive",
        name: "Predictive search",
        family: "Block matching",
        summary: "Tests the motion vectors of neighbouring blocks, stops if one matches, and descends from the best otherwise.",
        source: "A. M. Tourapis, Enhanced predictive zonal search for single and multiple frame motion estimation, \
                 Proc. SPIE 4671, Visual Communications and Image Processing, 2002",
        pseudocode: line::ALL,
        granularities: &["frame", "block", "step"],
        frames: 2,
    };

    fn predicts(&self) -> bool {
        true
    }

    fn predicts_in_time(&self) -> bool {
        self.temporal_predictor
    }

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        let neighbours = tester.neighbours;
        let median = neighbours.median();
        // Predictors are rounded: the search is in whole px, whatever the refinement.
        let whole = if tester.settings.refinement.subpixel == Subpixel::None { "" } else { " in whole px" };
        tester.stage(line::TEST_MEDIAN, std::iter::once(median), || {
            let names =
                [("left", neighbours.left), ("above", neighbours.above), ("above right", neighbours.above_right)];
            match named(&names) {
                known if known.is_empty() => "No neighbour is searched yet: the median predictor is (0, 0).".into(),
                known => format!("Neighbours: {known}. The median predictor is {}{whole}.", vector(median)),
            }
        });
        if self.is_enough(tester, (line::STOP_AT_MEDIAN, "the median predictor")) {
            return;
        }
        let moved = |found: Option<Match>| found.map(|found| found.displacement);
        let around = [neighbours.left, neighbours.above, neighbours.above_right, neighbours.before];
        let predicted = [Some([0, 0])].into_iter().chain(around.map(moved)).flatten();
        tester.stage(line::TEST_PREDICTORS, predicted, || {
            let before = neighbours
                .before
                .map(|before| format!(", and the temporal predictor {}", vector(before.vector())))
                .unwrap_or_default();
            format!(
                "The median predictor exceeds the termination threshold, so (0, 0) and the neighbours' motion vectors are tested{before}."
            )
        });
        if self.is_enough(tester, (line::STOP_AT_PREDICTOR, "the best predictor")) {
            return;
        }
        let lines = Descent { test: line::TEST_SQUARE, decide: line::UNTIL_BEST_STAYS };
        descend(tester, &SQUARE, lines, "square");
        let (settings, cost) = (tester.settings.without_rate(), tester.best_distortion());
        let most = tester.cost_of_levels(self.grid_threshold);
        if cost > most {
            let (step, reach) = (self.grid_step as i32, (self.matching.search_range / self.grid_step) as i32);
            let row = move |v| (-reach..=reach).map(move |u| [u * step, v * step]);
            tester.stage(line::TEST_GRID, (-reach..=reach).flat_map(row), || {
                let (cost, most) = (settings.show(cost), settings.number(most));
                format!("{cost} exceeds the grid threshold {most}: a grid with a step of {step} px is tested.")
            });
            let mut starts: Vec<_> = (-reach..=reach).flat_map(row).filter(|&at| tester.known(at).is_some()).collect();
            starts.sort_by(|&a, &b| tester.compare(a, b));
            for (place, &start) in starts.iter().take(self.grid_starts).enumerate() {
                descend_from(tester, (start, place + 1));
            }
        }
    }
}

impl Predictive {
    /// Whether the best match so far, called `name`, is below the termination threshold, a test at `line` of the pseudocode.
    fn is_enough(&self, tester: &mut Tester<impl Observer<Event>>, (line, name): (Name, &str)) -> bool {
        let (settings, cost) = (tester.settings.without_rate(), tester.best_distortion());
        let most = tester.cost_of_levels(self.termination_threshold);
        let is_enough = cost <= most;
        if is_enough {
            tester.report(line, || {
                let (cost, most) = (settings.show(cost), settings.number(most));
                format!("{cost} of {name} does not exceed the termination threshold {most}: early termination.")
            });
        }
        is_enough
    }
}

/// Descends with the square from `start`, the candidate of this `rank` on the grid, to a local minimum.
fn descend_from(tester: &mut Tester<impl Observer<Event>>, (start, rank): (Displacement, usize)) {
    let mut centre = start;
    loop {
        // On the path of an earlier descent all is tested, but the path may lead further.
        if around(centre, &SQUARE, 1).any(|at| tester.is_new(at)) {
            tester.stage(line::WALK_FROM_GRID, around(centre, &SQUARE, 1), || {
                format!("Descent from {}, rank {rank} of the grid: the square is at {}.", vector(start), vector(centre))
            });
        }
        let known = around(centre, &SQUARE, 1).filter(|&at| tester.known(at).is_some());
        match known.min_by(|&a, &b| tester.compare(a, b)) {
            Some(next) if next != centre => centre = next,
            _ => return,
        }
    }
}

/// The neighbours that exist: `left (1, 0), above (2, 0)`.
fn named(all: &[(&str, Option<Match>)]) -> String {
    let known = all.iter().filter_map(|(name, found)| found.map(|found: Match| (name, found.vector())));
    known.map(|(name, at)| format!("{name} {}", vector(at))).collect::<Vec<_>>().join(", ")
}
