//! Two-dimensional logarithmic search: a cross of five points moves to its best point, and shrinks where that is its
//! centre.
//!
//! ```text
//! . . . . 1 . . . .
//! . . . . . . . . .
//! . . . . . . 2 . .     ±5 px: steps of 2 px, then of 1 px.
//! . . . . . 4 4 4 .     1  the centre and 4 points at a distance of 2 px
//! 1 . 1 . 1 4 2 4 2     2  the best is (2, 0): the cross moves there as it is
//! . . . . . 4 4 4 .     3  the best is the centre: the step is halved
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
    /// Two-dimensional logarithmic search: a cross walks downhill, halving its step wherever it stays.
    pub struct LogSearch {}
}

search_pseudocode! {
    SET_STEP: "  step ← the power of two from range / 4 to range / 2, at least 2",
    WHILE_STEP: "  while step > 1",
    TEST_CROSS: "    test the best so far and the 4 points at distance step around it",
    HALVE_STEP: "    if the best is still the centre, or at the window's edge, then step ← step / 2",
    TEST_NEIGHBORS: "  test the 8 neighbours of the best",
}

impl BlockSearch for LogSearch {
    const INFO: Info = Info {
        id: "log-search",
        name: "2-D logarithmic search",
        family: "Block matching",
        summary: "Moves a cross of five points towards the best, and halves its step where the centre is the best.",
        source: "J. R. Jain and A. K. Jain, Displacement measurement and its application in interframe image coding, \
                 IEEE Trans. Communications 29(12), 1981",
        pseudocode: line::ALL,
        granularities: &["frame", "block", "step"],
        frames: 2,
    };

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        // 2^(⌊log₂ range⌋ − 1) as in the paper.
        let mut step = (1 << self.matching.range.ilog2() >> 1).max(2);
        tester.tell(line::SET_STEP, || {
            format!(
                "With a range of {} px the search begins in steps of {step} px, a power of two.",
                self.matching.range
            )
        });
        while step > 1 {
            let centre = tester.best();
            tester.stage(line::TEST_CROSS, around(centre, &CROSS, step), || {
                format!("The cross stands at {} in steps of {step} px.", vector(centre))
            });
            let best = tester.best();
            let at_edge = tester.window.is_at_edge(best);
            if best == centre || at_edge {
                step /= 2;
                tester.tell(line::HALVE_STEP, || {
                    let why = if best == centre { "is still the best" } else { "lies at the edge of the window" };
                    format!("{} {why}, so the step is halved to {step} px.", vector(best))
                });
            }
        }
        tester.stage(line::TEST_NEIGHBORS, around(tester.best(), &SQUARE, 1), || {
            "The step is 1 px: all 8 neighbours of the best are tested, and the search ends.".into()
        });
    }
}
