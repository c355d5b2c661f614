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

use super::diamond::{SMALL, walk_downhill};
use crate::block_search::{BlockSearch, Event, Tester, around, block_search_params, pseudocode, vector};
use crate::{Info, Observer};

block_search_params! {
    /// Adaptive rood pattern search: as far out as the neighbour moved, then downhill.
    pub struct AdaptiveRood {
        /// A block that differs by at most this much per pixel at (0, 0) counts as still and is searched no further; 0
        /// searches every block. The paper has a SAD of 512 for 16×16 px, which is 2.
        still: f32 = 2.0, 0.0..=16.0, "gray levels";
    }
}

impl BlockSearch for AdaptiveRood {
    const INFO: Info = Info {
        id: "adaptive-rood",
        name: "Adaptive rood pattern search",
        family: "Block matching",
        summary: "Looks as far out as the block to the left moved, and where it moved, then walks downhill.",
        source: "Y. Nie and K.-K. Ma, Adaptive rood pattern search for fast block-matching motion estimation, \
                 IEEE Trans. Image Processing 11(12), 2002",
        pseudocode: pseudocode![
            "  test (0, 0)",
            "  if its cost is at most still per pixel, then stop",
            "  p ← displacement of the block to the left",
            "  arm ← the longer of |u| and |v| of p; 2 if there is no such block",
            "  test p and the 4 points at distance arm around (0, 0)",
            "  repeat",
            "    test the 4 points next to the best",
            "  until the best stays",
        ],
        rungs: &["frame", "block", "step"],
        frames: 2,
    };

    fn predicts(&self) -> bool {
        true
    }

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        tester.stage(2, [[0, 0]].into_iter(), || "Does the block stay where it is? (0, 0) is tested first.".into());
        let (cost, most) = (tester.best_distortion(), tester.cost_of_levels(self.still));
        if cost <= most {
            let settings = tester.settings.free();
            return tester.tell(3, || {
                format!("{} is at most {}: the block counts as still.", settings.show(cost), settings.show(most))
            });
        }
        let predicted = tester.neighbours.left.map(|left| left.displacement);
        let arm = predicted.map_or(2, |[u, v]| u.abs().max(v.abs()));
        tester.stage(6, around([0, 0], &SMALL, arm).chain(predicted), || match predicted {
            Some(p) => format!("The block to the left moved by {}, so the arms are {arm} px long.", vector(p)),
            None => format!("There is no block to the left to learn from, so the arms are {arm} px long."),
        });
        walk_downhill(tester, &SMALL, 8, "small diamond");
    }
}
