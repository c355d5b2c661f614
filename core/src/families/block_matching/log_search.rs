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
use crate::methods::block_search::{
    BlockSearch, Event, Tester, around, block_search_params, search_pseudocode, vector,
};
use crate::run::Info;

block_search_params! {
    /// Two-dimensional logarithmic search: a cross descends the cost surface and halves its step at each minimum.
    pub struct LogSearch {}
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
        tester.report(line::SET_STEP, || {
            format!("Search range {} px: the initial step is {step} px, a power of two.", self.matching.search_range)
        });
        while step > 1 {
            let centre = tester.best();
            tester.stage(line::TEST_CROSS, around(centre, &CROSS, step), || {
                format!("Cross of 5 candidates around {} with arms of {step} px.", vector(centre))
            });
            let best = tester.best();
            let at_edge = tester.window.is_at_edge(best);
            if best == centre || at_edge {
                step /= 2;
                tester.report(line::HALVE_STEP, || {
                    let why = if best == centre { "the centre" } else { "at the limit of the search window" };
                    format!("The minimum {} is {why}: the step is halved to {step} px.", vector(best))
                });
            }
        }
        tester.stage(line::TEST_NEIGHBORS, around(tester.best(), &SQUARE, 1), || {
            "Step 1 px: the 8 neighbours of the best match are tested, and the search ends.".into()
        });
    }
}
