//! New three-step search: as three-step search, but it also tests the neighbours of the centre, where most motion is, and
//! stops early if the minimum is there.
//!
//! ```text
//! 1 . . . 1 . . . 1
//! . . . . . . . . .
//! . . . . . . . . .     ±7 px.
//! . . . 1 1 1 2 . .     1  the centre, its 8 neighbours, and 8 candidates at a distance of 4 px
//! 1 . . 1 1 1 2 . 1     2  if the minimum is a neighbour, here (1, 0): its 3 or 5 new neighbours, and stop
//! . . . 1 1 1 2 . .        if it is one of the outer candidates: continue as three-step search
//! . . . . . . . . .        if it is the centre: stop at once
//! . . . . . . . . .
//! 1 . . . 1 . . . 1
//! ```

use super::three_step::SQUARE;
use crate::base::Observer;
use crate::cases;
use crate::methods::block_search::{BlockSearch, Event, Tester, around, block_search_params, search_pseudocode, value};
use crate::run::Info;
use crate::scene::Step;

block_search_params! {
    /// New three-step search: a centre-biased three-step search with an early stop for small motion.
    pub struct NewThreeStep {}
}

cases! { over value;
    FIRST_STEP: "The first step is half the search range of {range}, rounded up: {step}.",
    BOTH_SQUARES: "Most motion is small (centre bias), so (0, 0) and its 8 neighbours are tested besides the 8 candidates at \
                   {step}.",
    FIRST_STOP: "First-step stop: the minimum is (0, 0), so the block is taken as static.",
    SECOND_STOP: "Second-step stop: the minimum {best:bare} is next to (0, 0), and the search ends with its neighbours.",
    OUTER: "The minimum {best:bare} is an outer candidate: continue there with a step of {step}.",
}

search_pseudocode! {
    SET_STEP: "  rest ← search range; step ← ⌈rest / 2⌉; rest ← rest − step",
    TEST_BOTH_SQUARES: "  test (0, 0), its 8 neighbours, and the 8 candidates at distance step",
    STOP_AT_ZERO: "  if best = (0, 0), then stop",
    IS_NEIGHBOR: "  if best is one of the 8 neighbours, then",
    TEST_NEXT_TO_IT: "    test the neighbours of best and stop",
    WHILE_LEFT: "  while rest > 0",
    TEST_SQUARE: "    step ← ⌈rest / 2⌉; rest ← rest − step; test the 8 candidates at distance step from best",
}

impl BlockSearch for NewThreeStep {
    const INFO: Info = Info {
        id: "new-three-step",
        name: "New three-step search",
        family: "Block matching",
        summary: "Three-step search that also tests the neighbours of (0, 0), and stops early where motion is small.",
        source: "R. Li, B. Zeng and M. L. Liou, A new three-step search algorithm for block motion estimation, \
                 IEEE Trans. Circuits and Systems for Video Technology 4(4), 1994",
        pseudocode: line::ALL,
        granularities: &["frame", "block", "step"],
        frames: 2,
    };

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        let mut left = self.matching.search_range as i32;
        let step = (left + 1) / 2;
        tester.report(|| Step::at(line::SET_STEP).put(value::RANGE, left).put(value::STEP, step).say(case::FIRST_STEP));
        tester.stage(around([0, 0], &SQUARE, 1).chain(around([0, 0], &SQUARE[1..], step)), || {
            Step::at(line::TEST_BOTH_SQUARES).put(value::STEP, step).say(case::BOTH_SQUARES)
        });
        let best = tester.best();
        if best == [0, 0] {
            return tester.report(|| Step::at(line::STOP_AT_ZERO).say(case::FIRST_STOP));
        }
        if best.iter().all(|c| c.abs() <= 1) {
            return tester.stage(around(best, &SQUARE, 1), || {
                Step::at(line::TEST_NEXT_TO_IT).put(value::BEST, best).say(case::SECOND_STOP)
            });
        }
        left -= step;
        while left > 0 {
            let (centre, step) = (tester.best(), (left + 1) / 2);
            tester.stage(around(centre, &SQUARE, step), || {
                Step::at(line::TEST_SQUARE).put(value::BEST, centre).put(value::STEP, step).say(case::OUTER)
            });
            left -= step;
        }
    }
}
