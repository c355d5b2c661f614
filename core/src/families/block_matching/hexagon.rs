//! Hexagon search: a hexagon moves to its best point until that is its centre, then four points end the search.
//!
//! ```text
//! . . . . . . . .
//! . . 1 . 1 2 . 2     1  the hexagon: the centre and 6 points
//! . . . . . . . .     2  the best is (2, 0): the hexagon moves there, always 3 new points
//! . 1 . 1 . 1 . 2     3  the best is the centre: its 4 nearest points, and the search ends
//! . . . . . . . .
//! . . 1 . 1 2 . 2
//! . . . . . . . .
//! ```

use super::diamond::{Downhill, SMALL, walk_downhill};
use crate::base::Observer;
use crate::methods::block_search::{
    BlockSearch, Displacement, Event, Tester, around, block_search_params, search_pseudocode, vector,
};
use crate::run::{Guarantee, Info};

block_search_params! {
    /// Hexagon search: as diamond search, with a rounder pattern of fewer points.
    pub struct Hexagon {}
}

/// The hexagon: all its points are about as far from the centre.
const HEXAGON: [Displacement; 7] = [[0, 0], [-1, -2], [1, -2], [-2, 0], [2, 0], [-1, 2], [1, 2]];

search_pseudocode! {
    REPEAT: "  centre ← (0, 0); repeat",
    TEST_HEXAGON: "    test centre and the 6 points of the hexagon around it",
    MOVE_CENTER: "    if the best is centre, then go on below; else centre ← the best",
    TEST_SMALL_DIAMOND: "  test the 4 points next to centre",
}

impl BlockSearch for Hexagon {
    const INFO: Info = Info {
        id: "hexagon",
        name: "Hexagon search",
        family: "Block matching",
        summary: "Walks downhill with a hexagon, three new points a move, and ends with the four nearest points.",
        source: "C. Zhu, X. Lin and L.-P. Chau, Hexagon-based search pattern for fast block motion estimation, \
                 IEEE Trans. Circuits and Systems for Video Technology 12(5), 2002",
        pseudocode: line::ALL,
        granularities: &["frame", "block", "step"],
        frames: 2,
    };
    /// The points of the hexagon leave gaps, and only four of the eight neighbours are looked at in the end.
    const GUARANTEE: Guarantee = Guarantee::SmoothTranslation { off_px: 1 };

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        let lines = Downhill { test: line::TEST_HEXAGON, decide: line::MOVE_CENTER };
        let centre = walk_downhill(tester, &HEXAGON, lines, "hexagon");
        tester.stage(line::TEST_SMALL_DIAMOND, around(centre, &SMALL, 1), || {
            format!("The centre {} and the 4 points next to it end the search.", vector(centre))
        });
    }
}
