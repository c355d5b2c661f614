//! Three-step search: nine candidates, the minimum of which is the centre of nine closer ones, and so on.
//!
//! ```text
//! 1 . . . 1 . . . 1
//! . . . . . . . . .
//! . . . . . . . . .     ±7 px: steps of 4, 2 and 1 px.
//! . . . . . . . . .     1  the centre and 8 candidates at a distance of 4 px
//! 1 . . . 1 . 2 . 2     2  8 candidates at 2 px around their minimum, here (4, 4)
//! . . . . . . . 3 3 3   3  8 candidates at 1 px around the new minimum, here (4, 6)
//! . . . . . . 2 3 2 3
//! . . . . . . . 3 3 3
//! 1 . . . 1 . 2 . 2
//! ```

use crate::base::Observer;
use crate::cases;
use crate::methods::block_search::{
    BlockSearch, Displacement, Event, Tester, around, block_search_params, search_pseudocode, value,
};
use crate::run::Info;
use crate::scene::Step;

block_search_params! {
    /// Three-step search: a square of nine candidates with a step that is halved at each iteration.
    pub struct ThreeStep {}
}

/// A centre and its eight neighbours.
pub(super) const SQUARE: [Displacement; 9] =
    [[0, 0], [-1, -1], [0, -1], [1, -1], [-1, 0], [1, 0], [-1, 1], [0, 1], [1, 1]];

cases! { over value;
    HALVED: "The step is half of the {rest} that remain of the search range, rounded up: {step}.",
    SQUARE: "Square of 9 candidates with a step of {step} around {center}.",
}

search_pseudocode! {
    WHILE_LEFT: "  rest ← search range; while rest > 0",
    HALVE_STEP: "    step ← ⌈rest / 2⌉; rest ← rest − step",
    TEST_SQUARE: "    test best and the 8 candidates at distance step",
}

impl BlockSearch for ThreeStep {
    const INFO: Info = Info {
        id: "three-step",
        name: "Three-step search",
        family: "Block matching",
        summary: "Tests nine candidates far apart, then eight closer ones around the minimum, halving the step each time.",
        source: "T. Koga, K. Iinuma, A. Hirano, Y. Iijima and T. Ishiguro, Motion compensated interframe coding for \
                 video conferencing, Proc. National Telecommunications Conference, 1981 \
                 (±6 px in steps of 3, 2 and 1; here as many steps as reach the edge of the search window)",
        pseudocode: line::ALL,
        granularities: &["frame", "block", "step"],
        frames: 2,
    };

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        let mut left = self.matching.search_range as i32;
        while left > 0 {
            let (centre, step) = (tester.best(), (left + 1) / 2);
            tester
                .report(|| Step::at(line::HALVE_STEP).put(value::REST, left).put(value::STEP, step).say(case::HALVED));
            tester.stage(around(centre, &SQUARE, step), || {
                Step::at(line::TEST_SQUARE).put(value::STEP, step).put(value::CENTER, centre).say(case::SQUARE)
            });
            left -= step;
        }
    }
}
