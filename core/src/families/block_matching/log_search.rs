//! Two-dimensional logarithmic search: a cross of five candidates moves to its minimum, and shrinks where that is its
//! centre.
//!
//! ```text
//! . . . . 1 . . . .
//! . . . . . . . . .
//! . . . . . . 2 . .     ±5 px: steps of 2 px, then of 1 px.
//! . . . . . 4 4 4 .     1  the centre and 4 candidates at a distance of 2 px
//! 1 . 1 . 1 4 2 4 2     2  the minimum is (2, 0): the cross moves there with the same step
//! . . . . . 4 4 4 .     3  the minimum is the centre: the step is halved
//! . . . . . . 2 . .     4  at a step of 1 px: all 8 neighbours, and the search ends
//! . . . . . . . . .
//! . . . . 1 . . . .
//! ```

use super::diamond::SMALL as CROSS;
use super::three_step::SQUARE;
use crate::base::Observer;
use crate::cases;
use crate::methods::block_search::{BlockSearch, Event, Tester, around, block_search_params, search_pseudocode, value};
use crate::run::Info;
use crate::scene::Step;

block_search_params! {
    /// Two-dimensional logarithmic search: a cross descends the cost surface and halves its step at each minimum.
    pub struct LogSearch {}
}

cases! { over value;
    FIRST_STEP: "Search range {range}: the initial step is {step}, a power of two.",
    CROSS: "Cross of 5 candidates around {center} with arms of {step}.",
    HALVED_AT_CENTER: "The minimum {best:bare} is the centre: the step is halved to {step}.",
    HALVED_AT_LIMIT: "The minimum {best:bare} is at the limit of the search window: the step is halved to {step}.",
    NEIGHBOURS: "Step 1 px: the 8 neighbours of the best match are tested, and the search ends.",
}

search_pseudocode! {
    SET_STEP: "  step ← max(2, 2^(⌊log₂ search range⌋ − 1))",
    WHILE_STEP: "  while step > 1",
    TEST_CROSS: "    test the cross: best and the 4 candidates at distance step",
    HALVE_STEP: "    if best is unchanged, or at the limit of the search window, then step ← step / 2",
    TEST_NEIGHBORS: "  test the 8 neighbours of best",
}

impl BlockSearch for LogSearch {
    const INFO: Info = Info {
        id: "log-search",
        name: "2-D logarithmic search",
        family: "Block matching",
        summary: "Moves a cross of five candidates to its minimum, and halves the step where the centre is the minimum.",
        source: "J. R. Jain and A. K. Jain, Displacement measurement and its application in interframe image coding, \
                 IEEE Trans. Communications 29(12), 1981",
        pseudocode: line::ALL,
        granularities: &["frame", "block", "step"],
        frames: 2,
    };

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        // 2^(⌊log₂ range⌋ − 1) as in the paper.
        let mut step = (1 << self.matching.search_range.ilog2() >> 1).max(2);
        tester.report(|| {
            let range = self.matching.search_range;
            Step::at(line::SET_STEP).put(value::RANGE, range).put(value::STEP, step).say(case::FIRST_STEP)
        });
        while step > 1 {
            let centre = tester.best();
            tester.stage(around(centre, &CROSS, step), || {
                Step::at(line::TEST_CROSS).put(value::CENTER, centre).put(value::STEP, step).say(case::CROSS)
            });
            let best = tester.best();
            let is_reached = best == centre;
            if is_reached || tester.window.is_at_edge(best) {
                step /= 2;
                tester.report(|| {
                    let reason = if is_reached { case::HALVED_AT_CENTER } else { case::HALVED_AT_LIMIT };
                    Step::at(line::HALVE_STEP).put(value::BEST, best).put(value::STEP, step).say(reason)
                });
            }
        }
        let around = around(tester.best(), &SQUARE, 1);
        tester.stage(around, || Step::at(line::TEST_NEIGHBORS).say(case::NEIGHBOURS));
    }
}
