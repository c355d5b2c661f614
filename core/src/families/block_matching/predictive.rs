//! Predictive search in the manner of EPZS: where the neighbours moved, this block may have moved too.
//!
//! ```text
//!        3 . . 3 . a 3 . . 3
//! ┌─┬─┬─┐. . . . . . . . . .     l, a, r  what the blocks to the left, above, and above right moved
//! │ │a│r│. . . . . . . . . .     m        their median, tested first: often that is good enough
//! ├─┼─┴─┘3 . . 3 . 2 2 l . 3     0        the zero displacement; and what this block moved one frame before, if asked for
//! │l│?│  . . . . . 2 m 2 . .     2        a square around the best of them walks downhill
//! └─┴─┘  . . . . . 2 2 2 . r     3        if that is still poor: a grid all over the window, and downhill from its best
//!        3 . . 0 . . 3 . . 3
//! ```

use super::diamond::{Downhill, walk_downhill};
use super::three_step::SQUARE;
use crate::base::Observer;
use crate::methods::block_search::{
    BlockSearch, Displacement, Event, Match, Subpixel, Tester, around, block_search_params, search_pseudocode, vector,
};
use crate::run::Info;
use crate::scene::Name;

block_search_params! {
    /// Predictive search: begins where the neighbouring blocks moved, stops where that fits, and walks downhill otherwise.
    pub struct Predictive {
        /// The search ends as soon as the best differs by at most this much per pixel.
        enough: f32 = 0.25, 0.0..=16.0, "gray levels";
        /// A block whose best still differs by more than this per pixel is searched once more, beginning from a grid.
        poor: f32 = 2.0, 0.0..=16.0, "gray levels";
        /// From one point of that grid to the next; at 1 it is a full search.
        grid: usize = 3, 1..=16, "px";
        /// From how many points of that grid, the best ones, the search walks downhill.
        starts: usize = 10, 1..=64;
        /// Predict from the motion one frame before as well. That pair of frames is then searched first.
        temporal: bool = false;
    }
}

search_pseudocode! {
    TEST_MEDIAN: "  test the median of the displacements to the left, above and above right",
    STOP_AT_MEDIAN: "  if its cost is at most enough per pixel, then stop",
    TEST_PREDICTORS: "  test (0, 0), those three, and that of this block one frame before",
    STOP_AT_PREDICTOR: "  if the best cost is at most enough per pixel, then stop",
    REPEAT: "  repeat",
    TEST_SQUARE: "    test the 8 points next to the best",
    UNTIL_BEST_STAYS: "  until the best stays",
    IS_POOR: "  if the best cost is more than poor per pixel, then",
    TEST_GRID: "    test a grid of points all over the window",
    WALK_FROM_GRID: "    from each of the starts best of them, walk downhill as above",
}

impl BlockSearch for Predictive {
    const INFO: Info = Info {
        id: "predictive",
        name: "Predictive search",
        family: "Block matching",
        summary: "Tests what the neighbouring blocks moved, stops if that fits, and walks downhill from the best otherwise.",
        source: "A. M. Tourapis, Enhanced predictive zonal search for single and multiple frame motion estimation, \
                 Proc. SPIE 4671, Visual Communications and Image Processing, 2002",
        pseudocode: line::ALL,
        granularities: &["frame", "block", "step"],
        frames: 2,
    };

    fn predicts(&self) -> bool {
        true
    }

    fn looks_back(&self) -> bool {
        self.temporal
    }

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        let neighbours = tester.neighbours;
        let median = neighbours.median();
        // A search walks in whole px, whatever its result is refined to.
        let whole = if tester.settings.refinement.subpixel == Subpixel::None { "" } else { " in whole px" };
        tester.stage(line::TEST_MEDIAN, std::iter::once(median), || {
            let names =
                [("left", neighbours.left), ("above", neighbours.above), ("above right", neighbours.above_right)];
            match named(&names) {
                known if known.is_empty() => {
                    "There are no neighbours to learn from yet: the search begins at (0, 0).".into()
                }
                known => format!("The neighbours moved by {known}; their median is {}{whole}.", vector(median)),
            }
        });
        if self.is_enough(tester, (line::STOP_AT_MEDIAN, "The median")) {
            return;
        }
        let moved = |found: Option<Match>| found.map(|found| found.displacement);
        let around = [neighbours.left, neighbours.above, neighbours.above_right, neighbours.before];
        let predicted = [Some([0, 0])].into_iter().chain(around.map(moved)).flatten();
        tester.stage(line::TEST_PREDICTORS, predicted, || {
            let before = neighbours
                .before
                .map(|before| format!(", and {}, where this block moved one frame before", vector(before.vector())));
            format!(
                "The median is not good enough: (0, 0) and each neighbour's own motion are tested{}.",
                before.unwrap_or_default()
            )
        });
        if self.is_enough(tester, (line::STOP_AT_PREDICTOR, "The best of them")) {
            return;
        }
        let lines = Downhill { test: line::TEST_SQUARE, decide: line::UNTIL_BEST_STAYS };
        walk_downhill(tester, &SQUARE, lines, "square");
        let (settings, cost) = (tester.settings.free(), tester.best_distortion());
        let most = tester.cost_of_levels(self.poor);
        if cost > most {
            let (step, reach) = (self.grid as i32, (self.matching.range / self.grid) as i32);
            let row = move |v| (-reach..=reach).map(move |u| [u * step, v * step]);
            tester.stage(line::TEST_GRID, (-reach..=reach).flat_map(row), || {
                let (cost, most) = (settings.show(cost), settings.show(most));
                format!("{cost} is more than {most}: nothing nearby fits, so a grid in steps of {step} px is tested.")
            });
            let mut starts: Vec<_> = (-reach..=reach).flat_map(row).filter(|&at| tester.known(at).is_some()).collect();
            starts.sort_by(|&a, &b| tester.compare(a, b));
            for (place, &start) in starts.iter().take(self.starts).enumerate() {
                descend(tester, start, || format!("number {} of the grid's best", place + 1));
            }
        }
    }
}

impl Predictive {
    /// Whether the best so far, called `name`, is good enough, which `line` of the pseudocode asks.
    fn is_enough(&self, tester: &mut Tester<impl Observer<Event>>, (line, name): (Name, &str)) -> bool {
        let (settings, cost) = (tester.settings.free(), tester.best_distortion());
        let most = tester.cost_of_levels(self.enough);
        let is_enough = cost <= most;
        if is_enough {
            tester.tell(line, || {
                let (cost, most) = (settings.show(cost), settings.show(most));
                format!("{name} has {cost}, at most {most}, which is good enough: the search ends.")
            });
        }
        is_enough
    }
}

/// Walks with the square to the best point around until that is its centre, from `start`, which is called `name`.
fn descend(tester: &mut Tester<impl Observer<Event>>, start: Displacement, name: impl Fn() -> String) {
    let mut centre = start;
    loop {
        // Where another walk has been, there is nothing to test any more, but perhaps somewhere to go.
        if around(centre, &SQUARE, 1).any(|at| tester.is_new(at)) {
            tester.stage(line::WALK_FROM_GRID, around(centre, &SQUARE, 1), || {
                format!(
                    "From {}, {}, the square walks downhill; it stands at {}.",
                    vector(start),
                    name(),
                    vector(centre)
                )
            });
        }
        let known = around(centre, &SQUARE, 1).filter(|&at| tester.known(at).is_some());
        match known.min_by(|&a, &b| tester.compare(a, b)) {
            Some(next) if next != centre => centre = next,
            _ => return,
        }
    }
}

/// Those that are there: `(1, 0) left, (2, 0) above`.
fn named(all: &[(&str, Option<Match>)]) -> String {
    let known = all.iter().filter_map(|(name, found)| found.map(|found: Match| (name, found.vector())));
    known.map(|(name, at)| format!("{} {name}", vector(at))).collect::<Vec<_>>().join(", ")
}
