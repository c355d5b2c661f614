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
use crate::methods::block_search::{
    BlockSearch, Displacement, Event, Tester, around, block_search_params, search_pseudocode, vector,
};
use crate::run::Info;
use crate::scene::Name;

block_search_params! {
    /// Diamond search: a large diamond descends to a minimum of the cost, a small one refines it.
    pub struct Diamond {}
}

/// The large diamond.
pub(super) const LARGE: [Displacement; 9] =
    [[0, 0], [0, -2], [-1, -1], [1, -1], [-2, 0], [2, 0], [-1, 1], [1, 1], [0, 2]];

/// The small diamond: a centre and its four neighbours.
pub(super) const SMALL: [Displacement; 5] = [[0, 0], [0, -1], [-1, 0], [1, 0], [0, 1]];

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
        tester.stage(line::TEST_SMALL_DIAMOND, around(centre, &SMALL, 1), || {
            format!("Small diamond: the centre {} and its 4 neighbours refine the match to 1 px.", vector(centre))
        });
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
    name: &str,
) -> Displacement {
    let mut verb = "starts at";
    loop {
        let centre = tester.best();
        tester.stage(lines.test, around(centre, pattern, 1), || {
            format!("The {name} of {} candidates {verb} {}.", pattern.len(), vector(centre))
        });
        let best = tester.best();
        tester.report(lines.decide, || match best == centre {
            true => format!("The minimum of the {name} is its centre {}: a local minimum is reached.", vector(centre)),
            false => format!(
                "The minimum of the {name} is {}, not its centre {}: the pattern moves there.",
                vector(best),
                vector(centre)
            ),
        });
        if best == centre {
            return centre;
        }
        verb = "moves to";
    }
}
