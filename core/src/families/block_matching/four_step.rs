//! Four-step search: a square of nine candidates, 2 px apart, moves to its minimum until that is its centre.
//!
//! ```text
//! . . . . . . . . .
//! . . . . . . . . .
//! . . 1 . 1 . 1 . 2     ±7 px.
//! . . . . . . . 4 4 4   1  the centre and 8 candidates at a distance of 2 px
//! . . 1 . 1 . 1 4 2 4   2  the minimum is on the edge, here (2, 0): the square moves there, 3 new candidates
//! . . . . . . . 4 4 4   3  5 new candidates if the minimum is at a corner; at most 3 squares, counting 1
//! . . 1 . 1 . 1 . 2     4  the minimum is the centre, here (4, 0), or no square is left: its 8 neighbours
//! . . . . . . . . .
//! . . . . . . . . .
//! ```

use super::three_step::SQUARE;
use crate::base::Observer;
use crate::cases;
use crate::methods::block_search::{BlockSearch, Event, Tester, around, block_search_params, search_pseudocode, value};
use crate::run::Info;
use crate::scene::Step;

block_search_params! {
    /// Four-step search: a 5×5 square descends the cost surface; the last step tests the 3×3 neighbourhood.
    pub struct FourStep {}
}

cases! { over value;
    SQUARE_STARTS: "The square of 9 candidates, 2 px apart, starts at (0, 0).",
    SQUARE_MOVES: "The square of 9 candidates moves to {center}: step {square} of at most {most_squares}.",
    AT_MINIMUM: "The minimum of the square is its centre {center}: a local minimum is reached.",
    MOVE: "The minimum {best:bare} is not the centre of the square: the square moves there.",
    LAST: "Last step: the 3×3 neighbourhood of {best:bare}.",
}

search_pseudocode! {
    REPEAT: "  centre ← (0, 0); repeat search range / 2 times",
    TEST_SQUARE: "    test the square: centre and the 8 candidates at distance 2 px",
    MOVE_CENTER: "    if best = centre, then leave the loop; else centre ← best",
    TEST_NEIGHBORS: "  test the 8 neighbours of best",
}

impl BlockSearch for FourStep {
    const INFO: Info = Info {
        id: "four-step",
        name: "Four-step search",
        family: "Block matching",
        summary: "Moves a square of nine candidates, 2 px apart, to its minimum, then tests the eight neighbours.",
        source: "L.-M. Po and W.-C. Ma, A novel four-step search algorithm for fast block motion estimation, \
                 IEEE Trans. Circuits and Systems for Video Technology 6(3), 1996 \
                 (±7 px with 3 squares; here as many as reach the edge of the search window)",
        pseudocode: line::ALL,
        granularities: &["frame", "block", "step"],
        frames: 2,
    };

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        let (mut centre, squares) = ([0, 0], (self.matching.search_range / 2).max(1));
        for number in 1..=squares {
            tester.stage(around(centre, &SQUARE, 2), || {
                let step = Step::at(line::TEST_SQUARE).put(value::CENTER, centre).put(value::SQUARE, number);
                let reason = if number == 1 { case::SQUARE_STARTS } else { case::SQUARE_MOVES };
                step.put(value::MOST_SQUARES, squares).say(reason)
            });
            let best = tester.best();
            let is_reached = best == centre;
            tester.report(|| {
                let step = Step::at(line::MOVE_CENTER).put(value::CENTER, centre).put(value::BEST, best);
                step.say(if is_reached { case::AT_MINIMUM } else { case::MOVE })
            });
            if is_reached {
                break;
            }
            centre = best;
        }
        let best = tester.best();
        let reason = || Step::at(line::TEST_NEIGHBORS).put(value::BEST, best).say(case::LAST);
        tester.stage(around(best, &SQUARE, 1), reason);
    }
}
