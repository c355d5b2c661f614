//! Hexagon search: a hexagon moves to its minimum until that is its centre, then four neighbours end the search.
//!
//! ```text
//! . . . . . . . .
//! . . 1 . 1 2 . 2     1  the hexagon: the centre and 6 candidates
//! . . . . . . . .     2  the minimum is (2, 0): the hexagon moves there, always 3 new candidates
//! . 1 . 1 . 1 . 2     3  the minimum is the centre: its 4 neighbours, and the search ends
//! . . . . . . . .
//! . . 1 . 1 2 . 2
//! . . . . . . . .
//! ```

use super::diamond::{Descent, SMALL, case, descend};
use crate::base::Observer;
use crate::methods::block_search::{
    BlockSearch, Displacement, Event, Tester, around, block_search_params, search_pseudocode, value,
};
use crate::run::{Guarantee, Info};
use crate::scene::Step;

block_search_params! {
    /// Hexagon search: as diamond search, with a nearly circular pattern of fewer candidates.
    pub struct Hexagon {}
}

/// The hexagon: all its candidates are about equally far from the centre.
const HEXAGON: [Displacement; 7] = [[0, 0], [-1, -2], [1, -2], [-2, 0], [2, 0], [-1, 2], [1, 2]];

search_pseudocode! {
    REPEAT: "  centre ← (0, 0); repeat",
    TEST_HEXAGON: "    test the hexagon: centre and 6 candidates around it",
    MOVE_CENTER: "    if best = centre, then leave the loop; else centre ← best",
    TEST_SMALL_DIAMOND: "  test the small diamond: the 4 neighbours of centre",
}

impl BlockSearch for Hexagon {
    const INFO: Info = Info {
        id: "hexagon",
        name: "Hexagon search",
        family: "Block matching",
        summary: "Descends the cost surface with a hexagon, three new candidates per move, and ends with the four neighbours.",
        source: "C. Zhu, X. Lin and L.-P. Chau, Hexagon-based search pattern for fast block motion estimation, \
                 IEEE Trans. Circuits and Systems for Video Technology 12(5), 2002",
        pseudocode: line::ALL,
        granularities: &["frame", "block", "step"],
        frames: 2,
    };
    /// The hexagon leaves gaps, and only four of the eight neighbours are tested in the end.
    const GUARANTEE: Guarantee = Guarantee::SmoothTranslation { off_px: 1 };

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        let lines = Descent { test: line::TEST_HEXAGON, decide: line::MOVE_CENTER };
        let centre = descend(tester, &HEXAGON, lines, "hexagon");
        let reason = || Step::at(line::TEST_SMALL_DIAMOND).put(value::CENTER, centre).say(case::SMALL_DIAMOND);
        tester.stage(around(centre, &SMALL, 1), reason);
    }
}
