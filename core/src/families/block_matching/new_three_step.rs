//! New three-step search: as three-step search, but it looks right around the centre too, where most motion is, and
//! stops early if it finds it there.
//!
//! ```text
//! 1 . . . 1 . . . 1
//! . . . . . . . . .
//! . . . . . . . . .     ±7 px.
//! . . . 1 1 1 2 . .     1  the centre, its 8 neighbours, and 8 points at a distance of 4 px
//! 1 . . 1 1 1 2 . 1     2  if the best is a neighbour, here (1, 0): the 3 or 5 points next to it, and that is all
//! . . . 1 1 1 2 . .        if it is one of the outer points: go on as three-step search does
//! . . . . . . . . .        if it is the centre: stop at once
//! . . . . . . . . .
//! 1 . . . 1 . . . 1
//! ```

use super::three_step::SQUARE;
use crate::base::Observer;
use crate::methods::block_search::{
    BlockSearch, Event, Tester, around, block_search_params, search_pseudocode, vector,
};
use crate::run::Info;

block_search_params! {
    /// New three-step search: three-step search that looks around the centre first and may stop there.
    pub struct NewThreeStep {}
}

search_pseudocode! {
    SET_STEP: "  step ← half of range, rounded up",
    TEST_BOTH_SQUARES: "  test (0, 0), its 8 neighbours, and the 8 points at distance step",
    STOP_AT_ZERO: "  if (0, 0) is the best, then stop",
    IS_NEIGHBOR: "  if the best is one of the neighbours, then",
    TEST_NEXT_TO_IT: "    test the points next to it and stop",
    WHILE_LEFT: "  while step < range is left to go",
    TEST_SQUARE: "    test the 8 points around the best at half of what is left",
}

impl BlockSearch for NewThreeStep {
    const INFO: Info = Info {
        id: "new-three-step",
        name: "New three-step search",
        family: "Block matching",
        summary: "Three-step search that also tests the centre's neighbours, and stops early where little moves.",
        source: "R. Li, B. Zeng and M. L. Liou, A new three-step search algorithm for block motion estimation, \
                 IEEE Trans. Circuits and Systems for Video Technology 4(4), 1994",
        pseudocode: line::ALL,
        granularities: &["frame", "block", "step"],
        frames: 2,
    };

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        let mut left = self.matching.range as i32;
        let step = (left + 1) / 2;
        tester.tell(line::SET_STEP, || {
            format!("The search can go {left} px: the first step is half of that, {step} px.")
        });
        tester.stage(line::TEST_BOTH_SQUARES, around([0, 0], &SQUARE, 1).chain(around([0, 0], &SQUARE[1..], step)), || {
            format!(
                "Most motion is small, so the neighbours of (0, 0) are tested as well as the 8 points {step} px away."
            )
        });
        let best = tester.best();
        if best == [0, 0] {
            return tester.tell(line::STOP_AT_ZERO, || {
                "(0, 0) is better than all points around it: the search stops at once.".into()
            });
        }
        if best.iter().all(|c| c.abs() <= 1) {
            return tester.stage(line::TEST_NEXT_TO_IT, around(best, &SQUARE, 1), || {
                format!("{} is a neighbour of (0, 0): only the points next to it are left to test.", vector(best))
            });
        }
        left -= step;
        while left > 0 {
            let (centre, step) = (tester.best(), (left + 1) / 2);
            tester.stage(line::TEST_SQUARE, around(centre, &SQUARE, step), || {
                format!("{} lies far out, so the search goes on there in steps of {step} px.", vector(centre))
            });
            left -= step;
        }
    }
}
