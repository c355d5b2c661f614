//! Diamond search: a large diamond moves to its minimum until that is its centre, then a small one ends the search.
//!
//! ```text
//! . . . . . . . .
//! . . . 1 . . . .
//! . . 1 . 1 2 . .     1  the large diamond: the centre and 8 candidates
//! . 1 . 1 . 1 . 2     2  the minimum is (1, 1), on a side: the diamond moves there, 3 new candidates; 5 at a corner
//! . . 1 . 1 . 2 .     3  the minimum is the centre: the small diamond, 4 candidates, and the search ends
//! . . . 1 . 2 . .
//! . . . . 2 . . .        a large diamond      a small diamond
//! . . . . . . . .
//! ```

use crate::base::Observer;
use crate::cases;
use crate::methods::block_search::{
    BlockSearch, Displacement, Event, Tester, around, block_search_params, search_pseudocode, value,
};
use crate::run::Info;
use crate::scene::{Name, Step};

block_search_params! {
    /// Diamond search: a large diamond descends to a minimum of the cost, a small one refines it.
    pub struct Diamond {}
}

/// The large diamond.
pub(super) const LARGE: [Displacement; 9] =
    [[0, 0], [0, -2], [-1, -1], [1, -1], [-2, 0], [2, 0], [-1, 1], [1, 1], [0, 2]];

/// The small diamond: a centre and its four neighbours.
pub(super) const SMALL: [Displacement; 5] = [[0, 0], [0, -1], [-1, 0], [1, 0], [0, 1]];

cases! { pub(super) over value;
    STARTS: "The {pattern} of {pattern_size} starts at {center}.",
    MOVES: "The {pattern} of {pattern_size} moves to {center}.",
    AT_MINIMUM: "The minimum of the {pattern} is its centre {center}: a local minimum is reached.",
    MOVE: "The minimum of the {pattern} is {best:bare}, not its centre {center}: the pattern moves there.",
    SMALL_DIAMOND: "Small diamond: the centre {center} and its 4 neighbours refine the match to 1 px.",
}

search_pseudocode! {
    REPEAT: "  centre ← (0, 0); repeat",
    TEST_LARGE_DIAMOND: "    test the large diamond: 9 candidates around centre",
    MOVE_CENTER: "    if best = centre, then leave the loop; else centre ← best",
    TEST_SMALL_DIAMOND: "  test the small diamond: the 4 neighbours of centre",
}

impl BlockSearch for Diamond {
    const INFO: Info = Info {
        id: "diamond",
        name: "Diamond search",
        family: "Block matching",
        summary: "Descends the cost surface with a large diamond of nine candidates, and refines with a small one of four.",
        source: "S. Zhu and K.-K. Ma, A new diamond search algorithm for fast block-matching motion estimation, \
                 IEEE Trans. Image Processing 9(2), 2000",
        pseudocode: line::ALL,
        granularities: &["frame", "block", "step"],
        frames: 2,
    };

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        let lines = Descent { test: line::TEST_LARGE_DIAMOND, decide: line::MOVE_CENTER };
        let centre = descend(tester, &LARGE, lines, "large diamond");
        let reason = || Step::at(line::TEST_SMALL_DIAMOND).put(value::CENTER, centre).say(case::SMALL_DIAMOND);
        tester.stage(around(centre, &SMALL, 1), reason);
    }
}

/// The pseudocode lines of a descent.
#[derive(Clone, Copy)]
pub(super) struct Descent {
    /// The line that tests the pattern.
    pub test: Name,
    /// The line that decides whether to move on.
    pub decide: Name,
}

/// Moves `pattern`, called `name`, to its minimum until that is its centre; returns that centre, a local minimum.
pub(super) fn descend(
    tester: &mut Tester<impl Observer<Event>>,
    pattern: &'static [Displacement],
    lines: Descent,
    name: &'static str,
) -> Displacement {
    let mut begun = case::STARTS;
    loop {
        let centre = tester.best();
        let at = |line| Step::at(line).put(value::PATTERN, name).put(value::CENTER, centre);
        tester.stage(around(centre, pattern, 1), || at(lines.test).put(value::PATTERN_SIZE, pattern.len()).say(begun));
        let best = tester.best();
        let is_reached = best == centre;
        tester.report(|| {
            at(lines.decide).put(value::BEST, best).say(if is_reached { case::AT_MINIMUM } else { case::MOVE })
        });
        if is_reached {
            return centre;
        }
        begun = case::MOVES;
    }
}
