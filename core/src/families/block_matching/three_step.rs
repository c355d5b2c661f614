//! Three-step search: nine points, the best of which becomes the centre of nine closer ones, and so on.
//!
//! ```text
//! 1 . . . 1 . . . 1
//! . . . . . . . . .
//! . . . . . . . . .     ±7 px: steps of 4, 2 and 1 px.
//! . . . . . . . . .     1  the centre and 8 points at a distance of 4 px
//! 1 . . . 1 . 2 . 2     2  8 points at 2 px around the best of them, here (4, 4)
//! . . . . . . . 3 3 3   3  8 points at 1 px around the best of these, here (4, 6)
//! . . . . . . 2 3 2 3
//! . . . . . . . 3 3 3
//! 1 . . . 1 . 2 . 2
//! ```

use crate::base::Observer;
use crate::methods::block_search::{
    BlockSearch, Displacement, Event, Tester, around, block_search_params, search_pseudocode, vector,
};
use crate::run::Info;

block_search_params! {
    /// Three-step search: coarse steps first, then ever smaller ones around the best so far.
    pub struct ThreeStep {}
}

/// A centre and the eight points around it.
pub(super) const SQUARE: [Displacement; 9] =
    [[0, 0], [-1, -1], [0, -1], [1, -1], [-1, 0], [1, 0], [-1, 1], [0, 1], [1, 1]];

search_pseudocode! {
    WHILE_LEFT: "  left ← range; while left > 0",
    HALVE_STEP: "    step ← half of left, rounded up; left ← left − step",
    TEST_SQUARE: "    test the best so far and the 8 points at distance step around it",
}

impl BlockSearch for ThreeStep {
    const INFO: Info = Info {
        id: "three-step",
        name: "Three-step search",
        family: "Block matching",
        summary: "Tests nine points far apart, then nine closer ones around the best, halving the distance each time.",
        source: "T. Koga, K. Iinuma, A. Hirano, Y. Iijima and T. Ishiguro, Motion compensated interframe coding for \
                 video conferencing, Proc. National Telecommunications Conference, 1981 \
                 (±6 px in steps of 3, 2 and 1; here as many steps as reach the edge of the window)",
        pseudocode: line::ALL,
        granularities: &["frame", "block", "step"],
        frames: 2,
    };

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        let mut left = self.matching.range as i32;
        while left > 0 {
            let (centre, step) = (tester.best(), (left + 1) / 2);
            tester.tell(line::HALVE_STEP, || {
                format!("The search can still go {left} px: the step is half of that, rounded up, {step} px.")
            });
            tester.stage(line::TEST_SQUARE, around(centre, &SQUARE, step), || {
                format!("9 points in steps of {step} px around {} are tested.", vector(centre))
            });
            left -= step;
        }
    }
}
