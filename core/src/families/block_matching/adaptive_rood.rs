//! Adaptive rood pattern search: a cross whose arms are as long as the neighbour's motion, then small steps downhill.
//!
//! ```text
//! . . . . 1 . . . .
//! . . . . . . . . .     the block to the left moved by (4, 1): arms of 4 px, the longer of the two
//! . . . . . . . . .     1  the centre, the ends of the arms, and the neighbour's motion p
//! . . . . . . . . .     2  a small diamond around the best, here p, moves downhill until its centre is the best
//! 1 . . . 1 . . 2 1
//! . . . . . . 2 2 p 2
//! . . . . . . . 2 2
//! . . . . . . . . .
//! . . . . 1 . . . .
//! ```

use super::diamond::{Downhill, SMALL, walk_downhill};
use crate::base::Observer;
use crate::methods::block_search::{
    BlockSearch, Event, Tester, around, block_search_params, search_pseudocode, vector,
};
use crate::run::Info;

block_search_params! {
    /// Adaptive rood pattern search: as far out as the neighbour moved, then downhill.
    pub struct AdaptiveRood {
        /// A block that differs by at most this much per pixel at (0, 0) counts as still and is searched no further; 0
        /// searches every block. The paper has a SAD of 512 for 16×16 px, which is 2.
        still: f32 = 2.0, 0.0..=16.0, "gray levels";
    }
}

search_pseudocode! {
    TEST_ZERO: "  test (0, 0)",
    STOP_IF_STILL: "  if its cost is at most still per pixel, then stop",
    SET_ARM: "  p ← displacement of the block to the left; arm ← the longer of its |u| and |v|, 2 without one",
    TEST_ROOD: "  test p and the 4 points at distance arm around (0, 0)",
    REPEAT: "  repeat",
    TEST_SMALL_DIAMOND: "    test the 4 points next to the best",
    UNTIL_BEST_STAYS: "  until the best stays",
}

impl BlockSearch for AdaptiveRood {
    const INFO: Info = Info {
        id: "adaptive-rood",
        name: "Adaptive rood pattern search",
        family: "Block matching",
        summary: "Looks as far out as the block to the left moved, and where it moved, then walks downhill.",
        source: "Y. Nie and K.-K. Ma, Adaptive rood pattern search for fast block-matching motion estimation, \
                 IEEE Trans. Image Processing 11(12), 2002",
        pseudocode: line::ALL,
        granularities: &["frame", "block", "step"],
        frames: 2,
    };

    fn predicts(&self) -> bool {
        true
    }

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        tester.stage(line::TEST_ZERO, [[0, 0]].into_iter(), || {
            "Does the block stay where it is? (0, 0) is tested first.".into()
        });
        let (cost, most) = (tester.best_distortion(), tester.cost_of_levels(self.still));
        if cost <= most {
            let settings = tester.settings.free();
            return tester.tell(line::STOP_IF_STILL, || {
                format!("{} is at most {}: the block counts as still.", settings.show(cost), settings.show(most))
            });
        }
        let predicted = tester.neighbours.left.map(|left| left.displacement);
        let arm = predicted.map_or(2, |[u, v]| u.abs().max(v.abs()));
        tester.tell(line::SET_ARM, || match predicted {
            Some(p) => format!("The block to the left moved by {}, so the arms are {arm} px long.", vector(p)),
            None => format!("There is no block to the left to learn from, so the arms are {arm} px long."),
        });
        tester.stage(line::TEST_ROOD, around([0, 0], &SMALL, arm).chain(predicted), || match predicted {
            Some(p) if p != [0, 0] => format!("(0, 0), the 4 ends of the arms around it and {} are tested.", vector(p)),
            _ => "(0, 0) and the 4 ends of the arms around it are tested.".into(),
        });
        let lines = Downhill { test: line::TEST_SMALL_DIAMOND, decide: line::UNTIL_BEST_STAYS };
        walk_downhill(tester, &SMALL, lines, "small diamond");
    }
}
