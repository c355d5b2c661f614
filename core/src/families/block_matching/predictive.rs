//! Predictive search in the manner of EPZS: the motion vectors of neighbouring blocks are tested first.
//!
//! ```text
//!        3 . . . 3 . . . 3
//! ┌─┬─┬─┐. . . . . . . . .     l, a, r  motion vectors of the blocks to the left, above, and above right
//! │ │a│r│. . . . . . a . .     m        their median, tested first: often the search stops there
//! ├─┼─┴─┘. . . . . 2 . . .     0        the zero displacement; and c, this block's vector in the previous pair, and c + (c − b)
//! │l│?│  3 . . . 2 m 2 . 3     2        with b, the one before it: its acceleration (if temporal-predictor is on)
//! └─┴─┘  . . . . . 2 . . .              a small diamond descends from the best of them to a local minimum
//!        . . . . . . . r .     3        if that is still poor: fixed predictors, and a descent from the best
//!        . . . . l . . . .
//!        . . . . . . . . .     Where no predictor is near the true motion the search ends in a local minimum: for a block that
//!        3 . . . 3 . . . 3     begins to move, differs from its neighbours, or whose cost is low at a wrong displacement already.
//! ```

use super::diamond::{Descent, LARGE, SMALL, descend};
use super::three_step::SQUARE;
use crate::base::Observer;
use crate::cases;
use crate::methods::block_search::{
    BlockSearch, Event, Subpixel, Tester, around, block_search_params, search_pseudocode, value,
};
use crate::run::Info;
use crate::scene::{Case, Name, Number, Step};

block_search_params! {
    /// Predictive search (EPZS): starts at predictors, stops early if one matches, and descends to a minimum otherwise.
    pub struct Predictive {
        /// Largest mean difference of the best match at which the search stops (early termination). After all predictors the
        /// lowest cost of a neighbouring block is enough as well, so the threshold adapts to texture and noise.
        termination_threshold: f32 = 0.5, 0.0..=16.0, "gray levels";
        /// Mean difference above which the fixed predictors are tested too, if the best match also costs more than twice the lowest
        /// cost of a neighbour. It limits the adaptive threshold as well.
        fixed_threshold: f32 = 2.5, 0.0..=16.0, "gray levels";
        /// Distance between the squares of fixed predictors around (0, 0).
        fixed_step: usize = 4, 1..=16, "px";
        /// Number of squares of 8 fixed predictors, each a step larger than the one before.
        fixed_squares: usize = 3, 1..=64;
        /// Use the block's motion vector in the previous pair of frames, and its acceleration since the pair before that, as
        /// predictors. The two previous pairs are then searched first.
        temporal_predictor: bool = false;
    }
}

cases! { over value;
    NO_NEIGHBOUR: "No neighbour is searched yet: the median predictor is (0, 0).",
    MEDIAN: "Neighbours: {neighbours}. The median predictor is {predictor}.",
    ROUNDED_MEDIAN: "Neighbours: {neighbours}. The median predictor is {predictor} in whole px.",
    STOP_AT_MEDIAN: "{measure} {distortion} of the median predictor does not exceed the termination threshold {threshold}: early \
                     termination.",
    PREDICTORS: "The median predictor exceeds the termination threshold, so (0, 0) and the neighbours' motion vectors are tested",
    COLLOCATED: ", and the collocated block's {collocated}",
    ACCELERATED: ", with its acceleration {accelerated}",
    TESTED: ".",
    ADAPTED: "The lowest cost of a neighbour is {neighbour_cost}, and texture and noise are similar here: the termination \
              threshold is raised from {fixed_threshold} to {threshold}.",
    STOP_AT_PREDICTOR: "{measure} {distortion} of the best predictor does not exceed the termination threshold {threshold}: \
                        early termination.",
    STOP_BELOW_ADAPTED: "{measure} {distortion} of the best predictor does not exceed the adaptive threshold {threshold}: early \
                         termination.",
    FIXED_PREDICTORS: "{measure} {distortion} exceeds {threshold}, a poor match: no predictor is near the motion, which differs \
                       from that of the neighbours or is too large. Squares with a spacing of {step} around (0, 0) are tested.",
    NEIGHBOURS: "The 4 neighbours of {center} refine the match to 1 px.",
}

search_pseudocode! {
    TEST_MEDIAN: "  test the median predictor: median of the left, above and above-right motion vectors",
    STOP_AT_MEDIAN: "  if its cost per pixel ≤ termination threshold, then stop",
    TEST_PREDICTORS: "  test (0, 0), the three neighbours, and the temporal predictors",
    ADAPT_THRESHOLD: "  threshold ← lowest cost per pixel of the neighbours, from termination to fixed threshold",
    STOP_AT_PREDICTOR: "  if the minimum per pixel ≤ threshold, then stop",
    REPEAT: "  repeat",
    TEST_SMALL_DIAMOND: "    test the small diamond: the 4 neighbours of best",
    UNTIL_BEST_STAYS: "  until best is unchanged",
    IS_POOR: "  if the minimum per pixel > fixed threshold, and > 2 · lowest cost of the neighbours, then",
    TEST_FIXED: "    test the fixed predictors: squares around (0, 0)",
    REPEAT_FROM_FIXED: "    repeat",
    TEST_LARGE_DIAMOND: "      test the large diamond: 8 candidates around best",
    UNTIL_CENTER_STAYS: "    until best is unchanged; test the 4 neighbours of best",
}

impl BlockSearch for Predictive {
    const INFO: Info = Info {
        id: "predictive",
        name: "Predictive search",
        family: "Block matching",
        summary: "Tests the motion vectors of neighbouring blocks, stops if one matches, and descends from the best otherwise.",
        source: "A. M. Tourapis, Enhanced predictive zonal search for single and multiple frame motion estimation, \
                 Proc. SPIE 4671, Visual Communications and Image Processing, 2002; fixed predictors: A. M. Tourapis, \
                 H.-Y. Cheong and P. Topiwala, Fast ME in the JM reference software, JVT-P026, 2005",
        pseudocode: line::ALL,
        granularities: &["frame", "block", "step"],
        frames: 2,
    };

    fn predicts(&self) -> bool {
        true
    }

    fn predicts_in_time(&self) -> bool {
        self.temporal_predictor
    }

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        self.test_median(tester);
        let fixed = tester.cost_of_levels(self.termination_threshold);
        if stops(tester, fixed, line::STOP_AT_MEDIAN, case::STOP_AT_MEDIAN) {
            return;
        }
        test_predictors(tester);
        let (most, reason) = match self.adapted(tester, fixed) {
            Some(adapted) => (adapted, case::STOP_BELOW_ADAPTED),
            None => (fixed, case::STOP_AT_PREDICTOR),
        };
        if stops(tester, most, line::STOP_AT_PREDICTOR, reason) {
            return;
        }
        let lines = Descent { test: line::TEST_SMALL_DIAMOND, decide: line::UNTIL_BEST_STAYS };
        descend(tester, &SMALL, lines, "small diamond");
        let least = tester.least_of_neighbours().unwrap_or(0.0);
        let poor = tester.cost_of_levels(self.fixed_threshold).max(FAR_ABOVE * least);
        if tester.best_distortion() > poor {
            self.test_fixed(tester, poor);
        }
    }
}

/// The cost of a poor match, as a multiple of the lowest cost of a neighbour: where all blocks match alike, none is poor.
const FAR_ABOVE: f64 = 2.0;

impl Predictive {
    fn test_median(&self, tester: &mut Tester<impl Observer<Event>>) {
        let neighbours = tester.neighbours;
        let median = neighbours.median();
        // Predictors are rounded: the search is in whole px, whatever the refinement.
        let is_whole = tester.settings.refinement.subpixel == Subpixel::None;
        tester.stage(std::iter::once(median), || {
            let all = [("left", neighbours.left), ("above", neighbours.above), ("above right", neighbours.above_right)];
            let known =
                all.iter().filter_map(|(name, found)| Some((name, value::NEIGHBOURS.is(found.as_ref()?.vector()))));
            let named = known.map(|(name, at)| format!("{name} {}", at.bare())).collect::<Number>();
            let step = Step::at(line::TEST_MEDIAN).put(value::NEIGHBOURS, named).put(value::PREDICTOR, median);
            step.say(match neighbours.spatial().next() {
                None => case::NO_NEIGHBOUR,
                Some(_) if is_whole => case::MEDIAN,
                Some(_) => case::ROUNDED_MEDIAN,
            })
        });
    }

    /// Tests the fixed predictors and descends from the best candidate.
    fn test_fixed(&self, tester: &mut Tester<impl Observer<Event>>, poor: f64) {
        let (settings, cost) = (tester.settings, tester.best_distortion());
        let (step, range) = (self.fixed_step as i32, self.matching.search_range as i32);
        let squares = (1..=self.fixed_squares as i32).map(move |n| n * step).take_while(move |&side| side <= range);
        let fixed = squares.flat_map(|side| SQUARE[1..].iter().map(move |[u, v]| [side * u, side * v]));
        tester.stage(fixed, || {
            let reason = settings.tell_comparison(Step::at(line::TEST_FIXED), cost, poor);
            reason.put(value::STEP, step).say(case::FIXED_PREDICTORS)
        });
        let lines = Descent { test: line::TEST_LARGE_DIAMOND, decide: line::UNTIL_CENTER_STAYS };
        let centre = descend(tester, &LARGE, lines, "large diamond");
        tester.stage(around(centre, &SMALL, 1), || {
            Step::at(line::UNTIL_CENTER_STAYS).put(value::CENTER, centre).say(case::NEIGHBOURS)
        });
    }

    /// The adaptive threshold, if it exceeds the `fixed` one: a block need not match better than its best neighbour.
    fn adapted(&self, tester: &mut Tester<impl Observer<Event>>, fixed: f64) -> Option<f64> {
        let (settings, most) = (tester.settings, tester.cost_of_levels(self.fixed_threshold));
        let least = tester.least_of_neighbours().filter(|&least| least.min(most) > fixed)?;
        let adapted = least.min(most);
        tester.report(|| {
            Step::at(line::ADAPT_THRESHOLD)
                .put_value(settings.cost(value::NEIGHBOUR_COST, least))
                .put_value(settings.cost(value::FIXED_THRESHOLD, fixed))
                .put_value(settings.cost(value::THRESHOLD, adapted))
                .say(case::ADAPTED)
        });
        Some(adapted)
    }
}

/// Tests the predictors other than the median.
fn test_predictors(tester: &mut Tester<impl Observer<Event>>) {
    let neighbours = tester.neighbours;
    let (before, accelerated) = (neighbours.before.map(|before| before.displacement), neighbours.accelerated());
    let spatial = neighbours.spatial().map(|found| found.displacement);
    let predicted = std::iter::once([0, 0]).chain(spatial).chain(before).chain(accelerated);
    tester.stage(predicted, || {
        let temporal =
            [(value::COLLOCATED, before, case::COLLOCATED), (value::ACCELERATED, accelerated, case::ACCELERATED)];
        let known = temporal.into_iter().filter_map(|(of, at, reason)| Some((of, at?, reason)));
        let step = Step::at(line::TEST_PREDICTORS).say(case::PREDICTORS);
        known.fold(step, |step, (of, at, reason)| step.put(of, at).say(reason)).say(case::TESTED)
    });
}

/// Whether the best match so far does not exceed a threshold, so that the search stops; `reason` tells why, at `line`.
fn stops(tester: &mut Tester<impl Observer<Event>>, threshold: f64, line: Name, reason: &'static Case) -> bool {
    let (settings, cost) = (tester.settings, tester.best_distortion());
    let stops = cost <= threshold;
    if stops {
        tester.report(|| settings.tell_comparison(Step::at(line), cost, threshold).say(reason));
    }
    stops
}
