//! Adaptive rood pattern search: a cross with arms as long as the predictor, then a small diamond descends to a minimum.
//!
//! ```text
//! . . . . 1 . . . .
//! . . . . . . . . .     motion vector of the left block (4, 1): arm length max(|u|, |v|) = 4 px
//! . . . . . . . . .     1  the centre, the ends of the arms, and the predictor p
//! . . . . . . . . .     2  a small diamond around the best, here p, moves until its centre is the minimum
//! 1 . . . 1 . . 2 1
//! . . . . . . 2 2 p 2
//! . . . . . . . 2 2
//! . . . . . . . . .
//! . . . . 1 . . . .
//! ```

use super::diamond::{Descent, SMALL, descend};
use crate::base::Observer;
use crate::cases;
use crate::methods::block_search::{BlockSearch, Event, Tester, around, block_search_params, search_pseudocode, value};
use crate::run::Info;
use crate::scene::Step;

block_search_params! {
    /// Adaptive rood pattern search (ARPS): arms as long as the predicted motion, then descent with a small diamond.
    pub struct AdaptiveRood {
        /// Largest mean difference at (0, 0) at which a block is taken as static and the search stops; 0
        /// searches every block. The paper uses SAD 512 for 16×16 px, which is 2 gray levels per pixel.
        zero_motion_threshold: f32 = 2.0, 0.0..=16.0, "gray levels";
    }
}

cases! { over value;
    ZERO_FIRST: "Zero-motion prejudgement: (0, 0) is tested first, since most blocks are static.",
    STATIC: "{measure} {distortion} at (0, 0) does not exceed the zero-motion threshold {threshold}: static block, the search \
             stops.",
    PREDICTED_ARM: "The left block predicts {predictor}: arm length max(|u|, |v|) = {step}.",
    DEFAULT_ARM: "There is no left block to predict from: arm length {step} by default.",
    ROOD_AND_PREDICTOR: "Rood pattern: the centre (0, 0), the 4 arm ends and the predictor {predictor}.",
    ROOD: "Rood pattern: the centre (0, 0) and the 4 arm ends.",
}

search_pseudocode! {
    TEST_ZERO: "  test (0, 0)",
    STOP_IF_STILL: "  if its cost per pixel ≤ zero-motion threshold, then stop",
    SET_ARM: "  p ← motion vector of the left block; arm ← max(|u|, |v|) of p, or 2 if there is none",
    TEST_ROOD: "  test p and the 4 candidates at distance arm from (0, 0)",
    REPEAT: "  repeat",
    TEST_SMALL_DIAMOND: "    test the small diamond: the 4 neighbours of best",
    UNTIL_BEST_STAYS: "  until best is unchanged",
}

impl BlockSearch for AdaptiveRood {
    const INFO: Info = Info {
        id: "adaptive-rood",
        name: "Adaptive rood pattern search",
        family: "Block matching",
        summary: "Tests a cross with an arm length predicted from the left block, then descends with a small diamond.",
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
        tester.stage([[0, 0]].into_iter(), || Step::at(line::TEST_ZERO).say(case::ZERO_FIRST));
        let (cost, most) = (tester.best_distortion(), tester.cost_of_levels(self.zero_motion_threshold));
        if cost <= most {
            let settings = tester.settings;
            return tester
                .report(|| settings.tell_comparison(Step::at(line::STOP_IF_STILL), cost, most).say(case::STATIC));
        }
        let predicted = tester.neighbours.left.map(|left| left.displacement);
        let arm = predicted.map_or(2, |[u, v]| u.abs().max(v.abs()));
        tester.report(|| {
            let step = Step::at(line::SET_ARM).put(value::STEP, arm);
            match predicted {
                Some(p) => step.put(value::PREDICTOR, p).say(case::PREDICTED_ARM),
                None => step.say(case::DEFAULT_ARM),
            }
        });
        tester.stage(around([0, 0], &SMALL, arm).chain(predicted), || match predicted {
            Some(p) if p != [0, 0] => Step::at(line::TEST_ROOD).put(value::PREDICTOR, p).say(case::ROOD_AND_PREDICTOR),
            _ => Step::at(line::TEST_ROOD).say(case::ROOD),
        });
        let lines = Descent { test: line::TEST_SMALL_DIAMOND, decide: line::UNTIL_BEST_STAYS };
        descend(tester, &SMALL, lines, "small diamond");
    }
}
