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

use crate::block_search::{BlockSearch, Displacement, Event, Tester, around, block_search_params, pseudocode, vector};
use crate::{Info, Observer};

block_search_params! {
    /// Diamond search: a large diamond walks downhill, a small one finds the end.
    pub struct Diamond {}
}

/// The large diamond.
const LARGE: [Displacement; 9] = [[0, 0], [0, -2], [-1, -1], [1, -1], [-2, 0], [2, 0], [-1, 1], [1, 1], [0, 2]];

/// A centre and the four points around it: the small diamond.
pub(super) const SMALL: [Displacement; 5] = [[0, 0], [0, -1], [-1, 0], [1, 0], [0, 1]];

impl BlockSearch for Diamond {
    const INFO: Info = Info {
        id: "diamond",
        name: "Diamond search",
        family: "Block matching",
        summary: "Walks downhill with a diamond of nine points, and ends with one of four.",
        source: "S. Zhu and K.-K. Ma, A new diamond search algorithm for fast block-matching motion estimation, \
                 IEEE Trans. Image Processing 9(2), 2000",
        pseudocode: pseudocode![
            "  centre ← (0, 0)",
            "  repeat",
            "    test the 9 points of the large diamond around centre",
            "    if the best is centre, then go on below; else centre ← the best",
            "  test the 4 points of the small diamond around centre",
        ],
        rungs: &["frame", "block", "step"],
        frames: 2,
    };

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        let centre = walk_downhill(tester, &LARGE, 4, "large diamond");
        tester.stage(6, around(centre, &SMALL, 1), || {
            format!("Nothing on the large diamond beats its centre {}: the small one looks closer.", vector(centre))
        });
    }
}

/// Moves `pattern`, called `name`, to the best so far until that is its centre, and gives that centre. `line` of the
/// pseudocode asks for its points.
pub(super) fn walk_downhill(
    tester: &mut Tester<impl Observer<Event>>,
    pattern: &'static [Displacement],
    line: usize,
    name: &str,
) -> Displacement {
    let mut before = None;
    loop {
        let centre = tester.best();
        if before == Some(centre) {
            return centre;
        }
        tester.stage(line, around(centre, pattern, 1), || match before {
            None => format!("The {name} begins at {}.", vector(centre)),
            Some(old) => format!(
                "{} is better than the centre {}: the {name} moves there and looks further that way.",
                vector(centre),
                vector(old)
            ),
        });
        before = Some(centre);
    }
}
