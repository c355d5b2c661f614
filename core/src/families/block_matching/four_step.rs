//! Four-step search: a square of nine points, 2 px apart, that moves to its best point until that is its centre.
//!
//! ```text
//! . . . . . . . . .
//! . . . . . . . . .
//! . . 1 . 1 . 1 . 2     ±7 px.
//! . . . . . . . 4 4 4   1  the centre and 8 points at a distance of 2 px
//! . . 1 . 1 . 1 4 2 4   2  the best is on the edge, here (2, 0): the square moves there, 3 new points
//! . . . . . . . 4 4 4   3  5 new points if the best is at a corner; the square moves 3 times at most, counting 1
//! . . 1 . 1 . 1 . 2     4  the best is the centre, here (4, 0), or there is no move left: its 8 neighbours
//! . . . . . . . . .
//! . . . . . . . . .
//! ```

use super::three_step::SQUARE;
use crate::base::Observer;
use crate::methods::block_search::{
    BlockSearch, Event, Tester, around, block_search_params, search_pseudocode, vector,
};
use crate::run::Info;

block_search_params! {
    /// Four-step search: a small square moves towards the best match; the last step looks at the neighbours.
    pub struct FourStep {}
}

search_pseudocode! {
    REPEAT: "  centre ← (0, 0); repeat range / 2 times",
    TEST_SQUARE: "    test centre and the 8 points at distance 2 around it",
    MOVE_CENTER: "    if the best is centre, then go on below; else centre ← the best",
    TEST_NEIGHBORS: "  test the 8 neighbours of the best",
}

impl BlockSearch for FourStep {
    const INFO: Info = Info {
        id: "four-step",
        name: "Four-step search",
        family: "Block matching",
        summary: "Moves a square of nine points, 2 px apart, to its best point, then looks at the neighbours.",
        source: "L.-M. Po and W.-C. Ma, A novel four-step search algorithm for fast block motion estimation, \
                 IEEE Trans. Circuits and Systems for Video Technology 6(3), 1996 \
                 (±7 px with 3 squares; here as many as reach the edge of the window)",
        pseudocode: line::ALL,
        granularities: &["frame", "block", "step"],
        frames: 2,
    };

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        let (mut centre, squares) = ([0, 0], (self.matching.range / 2).max(1));
        for number in 1..=squares {
            tester.stage(line::TEST_SQUARE, around(centre, &SQUARE, 2), || match number {
                1 => "The square begins at (0, 0), its 9 points 2 px apart.".into(),
                _ => format!(
                    "The square of 9 points stands at {}: number {number} of {squares} at most.",
                    vector(centre)
                ),
            });
            let best = tester.best();
            tester.tell(line::MOVE_CENTER, || match best == centre {
                true => format!("Nothing on the square beats its centre {}: the square stays.", vector(centre)),
                false => format!("{} lies on the edge of the square, so the square moves there.", vector(best)),
            });
            if best == centre {
                break;
            }
            centre = best;
        }
        let best = tester.best();
        tester.stage(line::TEST_NEIGHBORS, around(best, &SQUARE, 1), || {
            format!("The last step looks at {} and its 8 neighbours.", vector(best))
        });
    }
}
