//! Full search with successive elimination: a candidate is skipped where a lower bound of its cost exceeds the minimum so far.
//!
//! ```text
//! ┌───────┐  ┌───┬───┐  ┌─┬─┬─┬─┐     level 0: |Σ a − Σ b| over the whole block ≤ SAD
//! │       │  │   │   │  ├─┼─┼─┼─┤     level 1: the same of its quarters, added up
//! │   Σ   │  ├───┼───┤  ├─┼─┼─┼─┤     level 2: of its sixteenths, and so on
//! │       │  │   │   │  ├─┼─┼─┼─┤
//! └───────┘  └───┴───┘  └─┴─┴─┴─┘     Parts that divide the block raise the bound; the first above the minimum skips.
//! ```
//!
//! The sums of frame t + 1 are computed once for all blocks, so a bound takes 1, 4 or 16 differences where SAD takes 256. The result
//! is that of full search, bit for bit. It is effective where blocks differ in brightness and the minimum is low (scene `translation`:
//! nearly all is skipped), and fails where all sums are equal: little texture under noise (`flat-wall`: hardly any is skipped).

use std::sync::Arc;

use crate::base::Observer;
use crate::methods::{
    block_search::{BlockSearch, Displacement, Event, Patch, Skipped, Tester, block_search_params, percent, value},
    cost::{
        Sum,
        bounds::{LANES, PartSums, Parts},
    },
};
use crate::run::{Guarantee, Info};
use crate::scene::Step;
use crate::{cases, pseudocode};

block_search_params! {
    /// Full search with successive elimination: skips candidates by lower bounds of their cost. It finds what full search finds.
    pub struct SuccessiveElimination {
        /// Levels of the bound: 1 compares the sums of whole blocks (Li and Salari), each further one halves the side of the parts.
        /// Bounds are used for SAD, SSD and MSE; with the other costs nothing is skipped.
        bound_levels: usize = 3, 1..=5;
    }
}

cases! { over value;
    FIRST: "(0, 0) and the median predictor {predictor} are tested first: the lower the minimum, the more candidates are \
            skipped.",
    SKIPPED: "Skipped without computing their cost: {skipped:bare} of {candidates}, {share_skipped}.",
    NO_BOUND: "Successive elimination has no lower bound for {label} here, so every candidate is tested.",
}

pseudocode! {
    EACH_BLOCK: "for each block B of frame t",
    LAY_WINDOW: "  place the search window of ±search range around B in frame t+1",
    TEST_FIRST: "  test (0, 0) and the median predictor: the lower the minimum, the more is skipped",
    EACH_CANDIDATE: "  for each other candidate (u, v) in the search window",
    EACH_LEVEL: "    for each level, from whole B to its smallest parts",
    COMPARE_BOUND: "      if b = Σ |sum of a part of B − sum of that part displaced by (u, v)| (SSD: Σ (…)² / n) > minimum [− λR(u, v)]",
    SKIP_CANDIDATE: "        skip (u, v): its cost cannot be below b",
    NO_BOUND: "    (a cost without such a bound: no candidate is skipped)",
    COMPUTE_COST: "    c ← cost of B and the block of frame t+1 displaced by (u, v) [+ λR(u, v)]",
    COMPARE_COST: "    if c < minimum, or c = minimum and (u, v) is shorter than best",
    KEEP_BEST: "      minimum ← c; best ← (u, v)",
    REPORT_SHARE: "  share skipped ← skipped candidates / candidates in the search window",
    REFINE_BEST: "  refine best to sub-pixel accuracy (if subpixel is set)",
    SET_DISPLACEMENT: "  motion vector of B ← best",
}

impl BlockSearch for SuccessiveElimination {
    const INFO: Info = Info {
        id: "successive-elimination",
        name: "Successive elimination",
        family: "Block matching",
        summary: "Full search that skips a candidate where the sums of its parts show that its cost exceeds the minimum.",
        source: "W. Li and E. Salari, Successive elimination algorithm for motion estimation, IEEE Trans. Image Processing \
                 4(1), 1995; levels: X. Q. Gao, C. J. Duanmu and C. R. Zou, A multilevel successive elimination algorithm for \
                 block matching motion estimation, IEEE Trans. Image Processing 9(3), 2000",
        pseudocode: line::ALL,
        granularities: &["frame", "block", "step"],
        frames: 2,
    };
    const GUARANTEE: Guarantee = Guarantee::Translation;

    fn predicts(&self) -> bool {
        true
    }

    fn part_sides(&self) -> Vec<usize> {
        let sides = (0..self.bound_levels).map(|level| self.matching.block_size >> level);
        // A part of one pixel is the cost itself.
        sides.filter(|&side| side > 1).collect()
    }

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        let first = [[0, 0], tester.neighbours.median()];
        tester.stage(first.into_iter(), || Step::at(line::TEST_FIRST).put(value::PREDICTOR, first[1]).say(case::FIRST));
        match tester.settings.matching.cost.sum() {
            Some(sum) => self.eliminate(tester, sum),
            None => test_all(tester),
        }
    }
}

impl SuccessiveElimination {
    /// Tests the candidates that no bound excludes.
    fn eliminate<O: Observer<Event>>(&self, tester: &mut Tester<O>, sum: Sum) {
        let sums = tester.sums.clone().unwrap_or_else(|| Arc::new(self.sums_of_window(tester)));
        let parts = sums.parts(&tester.work.patch.block);
        let (window, elimination) = (tester.window, Elimination { sum, sums: &sums, parts: &parts });
        for row in 0..window.size.1 {
            // The limit only falls along the row, so excluded candidates stay excluded. An observer gets each bound by itself.
            let excluded = if O::WATCHES { 0 } else { elimination.excluded(tester, row) };
            let runs = (0..window.size.0).step_by(LANES).enumerate();
            for (_, first) in runs.filter(|(run, _)| *run >= 64 || excluded >> run & 1 == 0) {
                let displacement = [window.min[0] + first as i32, window.min[1] + row as i32];
                elimination.run(tester, Run { displacement, count: LANES.min(window.size.0 - first) });
            }
        }
        let skipped = window.count() - tester.tested;
        tester.skipped = skipped;
        tester.report(|| {
            let step = Step::at(line::REPORT_SHARE).put(value::SKIPPED, skipped).put(value::CANDIDATES, window.count());
            step.put(value::SHARE_SKIPPED, percent(skipped, window.count())).say(case::SKIPPED)
        });
    }

    /// The sums of the area under the search window alone, for a block of a frame without precomputed sums.
    fn sums_of_window(&self, tester: &Tester<impl Observer<Event>>) -> PartSums {
        let (mut patch, block, min) = (Patch::default(), tester.block, tester.window.min);
        patch.take_area(tester.pair, block, tester.window);
        let first = (block.x as isize + min[0] as isize, block.y as isize + min[1] as isize);
        PartSums::of_area(&patch.area, first, &self.part_sides())
    }
}

fn test_all(tester: &mut Tester<impl Observer<Event>>) {
    let (window, label) = (tester.window, tester.settings.matching.cost.label());
    let all = (0..window.count()).map(|index| window.displacement(index));
    tester.stage(all, || Step::at(line::NO_BOUND).put(value::LABEL, label).say(case::NO_BOUND));
}

/// Candidates beside each other: the first, and their number.
#[derive(Clone, Copy)]
struct Run {
    displacement: Displacement,
    count: usize,
}

/// The bounds of the candidates of a block.
struct Elimination<'a> {
    sum: Sum,
    sums: &'a PartSums,
    parts: &'a [Parts],
}

impl Elimination<'_> {
    /// The runs of a row of the search window that the sum of the whole block excludes: one bit for each of the first 64.
    fn excluded(&self, tester: &Tester<impl Observer<Event>>, row: usize) -> u64 {
        let (block, window) = (tester.block, tester.window);
        let [x, y] = [block.x as isize + window.min[0] as isize, block.y as isize + window.min[1] as isize];
        let candidates = ((x, y + row as isize), window.size.0);
        self.parts.first().map_or(0, |parts| self.sums.excluded(self.sum, parts, candidates, tester.sum_limit(None)))
    }

    /// Skips or tests the candidates of a run, level by level until all of them are excluded.
    fn run<O: Observer<Event>>(&self, tester: &mut Tester<O>, run: Run) {
        let (block, first) = (tester.block, run.displacement);
        let place = (block.x as isize + first[0] as isize, block.y as isize + first[1] as isize);
        let limit = tester.sum_limit(None);
        let all = u8::MAX >> (LANES - run.count);
        let (mut bounds, mut known, mut open) = ([[0; LANES]; MOST_LEVELS], 0, all);
        while known < self.parts.len() && open != 0 {
            bounds[known] = self.sums.bounds(self.sum, known, &self.parts[known], place);
            open &= within(&bounds[known], limit);
            known += 1;
        }
        // An observed run reports each excluded candidate.
        let mut left = if O::WATCHES { all } else { open };
        while left != 0 {
            let lane = left.trailing_zeros() as usize;
            left &= left - 1;
            let at = [first[0] + lane as i32, first[1]];
            // The minimum may have fallen since, and the price of a displacement lowers the limit.
            let limit = tester.sum_limit(Some(at));
            match bounds[..known].iter().position(|bounds| bounds[lane] > limit) {
                Some(level) => {
                    let (bound, side) = (bounds[level][lane], self.parts[level].side);
                    tester.skip(Skipped { displacement: at, bound, side });
                }
                None => tester.test(at),
            }
        }
    }
}

/// Maximum number of levels of a bound, and one spare: sides from 64 to 4 px.
const MOST_LEVELS: usize = 6;

/// The candidates of a run whose bounds do not exceed `limit`, a bit for each.
#[inline(always)]
fn within(bounds: &[u32; LANES], limit: u32) -> u8 {
    bounds.iter().zip(0..).fold(0, |open, (bound, lane)| open | u8::from(*bound <= limit) << lane)
}
