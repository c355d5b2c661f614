//! Diamond search: a large diamond moves to its best point until that is its centre, then a small one ends the search.
//!
//! ```text
//! . . . . . . . .
//! . . . 1 . . . .
//! . . 1 . 1 2 . .     1  the large diamond: the centre and 8 points
//! . 1 . 1 . 1 . 2     2  the best is (1, 1), on a side: the diamond moves there, 3 new points; 5 at a corner
//! . . 1 . 1 . 2 .     3  the best is the centre: the small diamond, 4 points, and the search ends
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
    /// Diamond search: a large diamond walks downhill, a small one finds the end.
    pub struct Diamond {}
}

/// The large diamond.
const LARGE: [Displacement; 9] = [[0, 0], [0, -2], [-1, -1], [1, -1], [-2, 0], [2, 0], [-1, 1], [1, 1], [0, 2]];

/// A centre and the four points around it: the small diamond.
pub(super) const SMALL: [Displacement; 5] = [[0, 0], [0, -1], [-1, 0], [1, 0], [0, 1]];

search_pseudocode! {
    REPEAT: "  centre ← (0, 0); repeat",
    TEST_LARGE_DIAMOND: "    test the 9 points of the large diamond around centre",
    MOVE_CENTER: "    if the best is centre, then go on below; else centre ← the best",
    TEST_SMALL_DIAMOND: "  test the 4 points of the small diamond around centre",
}

impl BlockSearch for Diamond {
    const INFO: Info = Info {
        id: "diamond",
        name: "Diamond search",
        family: "Block matching",
        summary: "Walks downhill with a diamond of nine points, and ends with one of four.",
        source: "S. Zhu and K.-K. Ma, A new diamond search algorithm for fast block-matching motion estimation, \
                 IEEE Trans. Image Processing 9(2), 2000",
        pseudocode: line::ALL,
        granularities: &["frame", "block", "step"],
        frames: 2,
    };

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        let lines = Downhill { test: line::TEST_LARGE_DIAMOND, decide: line::MOVE_CENTER };
        let centre = walk_downhill(tester, &LARGE, lines, "large diamond");
        tester.stage(line::TEST_SMALL_DIAMOND, around(centre, &SMALL, 1), || {
            format!("The small diamond looks closer: its centre {} and the 4 points next to it.", vector(centre))
        });
    }
}

/// The lines of the pseudocode that a walk downhill is at.
#[derive(Clone, Copy)]
pub(super) struct Downhill {
    /// That which asks for the points of the pattern.
    pub test: Name,
    /// That which decides whether to go on.
    pub decide: Name,
}

/// Moves `pattern`, called `name`, to the best so far until that is its centre, and gives that centre.
pub(super) fn walk_downhill(
    tester: &mut Tester<impl Observer<Event>>,
    pattern: &'static [Displacement],
    lines: Downhill,
    name: &str,
) -> Displacement {
    let mut verb = "begins";
    loop {
        let centre = tester.best();
        tester.stage(lines.test, around(centre, pattern, 1), || {
            format!("The {name} {verb} at {}, with {} points.", vector(centre), pattern.len())
        });
        let best = tester.best();
        tester.tell(lines.decide, || match best == centre {
            true => format!("Nothing on the {name} beats its centre {}: it stays.", vector(centre)),
            false => format!(
                "{} is better than the centre {}: the {name} moves there and looks further that way.",
                vector(best),
                vector(centre)
            ),
        });
        if best == centre {
            return centre;
        }
        verb = "stands";
    }
}
