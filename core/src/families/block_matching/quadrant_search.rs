//! Logarithmic search by quadrants: the search window is quartered, the quadrant with the minimum is kept, and so on.
//!
//! ```text
//! 1 . . . . . . . 1 . . . . . . . 1
//! . . . . . . . . . . . . . . . . .
//! . . . . . . . . 2 . 2 . 2 . 2 . 2     ±8 px.
//! . . . . . . . . . . . . . . . . .     1  the corners and the centre of each quadrant: 13 candidates
//! . . . . 1 . . . 2 . 2 . 1 . 2 . 2     2  the minimum is (4, −4), so the upper right quadrant is kept; of its own
//! . . . . . . . . . . . . . . . . .        13 candidates 5 are known and 8 are new, those on the inner lines
//! . . . . . . . . 2 . 2 . 2 . 2 . 2
//! . . . . . . . . . . . . . . . . .
//! 1 . . . . . . . 1 . . . . . . . 1
//! ```

use crate::base::Observer;
use crate::cases;
use crate::methods::block_search::{
    BlockSearch, Displacement, Event, Tester, Window, block_search_params, search_pseudocode, value,
};
use crate::run::{Guarantee, Info};
use crate::scene::Step;

block_search_params! {
    /// Logarithmic search by quadrants: the search window is quartered again and again, keeping the quadrant with the
    /// minimum.
    pub struct QuadrantSearch {
        /// Window size (width and height) down to which the search continues.
        min_window: usize = 1, 1..=64, "px";
        /// Smallest relative decrease of the minimum per iteration; below it, the search stops. 0 disables the criterion.
        min_decrease: f32 = 0.0, 0.0..=100.0, "%";
    }
}

cases! { over value;
    DIVIDED: "The window from {from} to {to} is divided into quadrants: their vertices and centres are the candidates.",
    KEPT: "The minimum {best:bare} lies in the quadrant around {center}: this quadrant is kept.",
    SMALLEST: "The quadrant is {quadrant} wide, at most the min window of {min_window}: the search stops.",
    ALL_TESTED: "The quadrant is {quadrant} wide and fully tested: the search stops.",
    LEAST_DECREASE: "The minimum decreased by {decrease}, less than {min_decrease}: the search stops.",
}

search_pseudocode! {
    REPEAT: "  W ← search window; repeat",
    TEST_QUADRANTS: "    test the corners and the centre of each quadrant of W",
    KEEP_QUADRANT: "    W ← the quadrant that holds best; of several, the one with the lowest cost at its centre",
    STOP_AT_SMALLEST: "    if W is at most min window wide and high, or fully tested, then stop",
    STOP_AT_LEAST_GAIN: "    if the minimum decreased by less than min decrease, then stop",
}

impl BlockSearch for QuadrantSearch {
    const INFO: Info = Info {
        id: "quadrant-search",
        name: "Logarithmic search by quadrants",
        family: "Block matching",
        summary: "Divides the search window into quadrants, keeps the one with the minimum, and repeats.",
        source: "the course's logarithmic search; the idea is that of J. R. Jain and A. K. Jain, Displacement measurement \
                 and its application in interframe image coding, IEEE Trans. Communications 29(12), 1981",
        pseudocode: line::ALL,
        granularities: &["frame", "block", "step"],
        frames: 2,
    };
    /// A quadrant that was dropped is never tested again, although the global minimum may lie just inside it.
    const GUARANTEE: Guarantee = Guarantee::Better;

    fn search(&self, tester: &mut Tester<impl Observer<Event>>) {
        let range = self.matching.search_range as i32;
        let mut part = Part { min: [-range; 2], max: [range; 2] };
        loop {
            let (whole, before) = (part, tester.best_cost());
            tester.narrowed = Some(whole.window());
            tester.stage(whole.points().into_iter(), || {
                Step::at(line::TEST_QUADRANTS).put(value::FROM, whole.min).put(value::TO, whole.max).say(case::DIVIDED)
            });
            let best = tester.best();
            let cost = |quadrant: &Part| tester.known(quadrant.centre()).unwrap_or(f64::INFINITY);
            let holding = whole.quadrants().into_iter().filter(|quadrant| quadrant.holds(best));
            // The minimum so far was always kept, so a quadrant contains it.
            part = holding.min_by(|a, b| cost(a).total_cmp(&cost(b))).unwrap_or(whole);
            tester.narrowed = Some(part.window());
            tester.report(|| {
                Step::at(line::KEEP_QUADRANT).put(value::BEST, best).put(value::CENTER, part.centre()).say(case::KEPT)
            });
            let gain = if before > 0.0 { 100.0 * (before - tester.best_cost()) / before } else { 0.0 };
            // All corners of a part are tested, so one of 2 px has no new candidate.
            if part.side() <= self.min_window.max(2) {
                let (side, smallest) = (part.side(), self.min_window);
                return tester.report(|| {
                    let step = Step::at(line::STOP_AT_SMALLEST).put(value::QUADRANT, side);
                    let reason = if side <= smallest { case::SMALLEST } else { case::ALL_TESTED };
                    step.put(value::MIN_WINDOW, smallest).say(reason)
                });
            }
            if before.is_finite() && gain < f64::from(self.min_decrease) {
                let least = self.min_decrease;
                return tester.report(|| {
                    let step = Step::at(line::STOP_AT_LEAST_GAIN).put(value::DECREASE, gain);
                    step.put(value::MIN_DECREASE, least).say(case::LEAST_DECREASE)
                });
            }
        }
    }
}

/// A part of the search window: a rectangle of displacements, corners included.
#[derive(Clone, Copy)]
struct Part {
    min: Displacement,
    max: Displacement,
}

impl Part {
    fn centre(&self) -> Displacement {
        [0, 1].map(|i| (self.min[i] + self.max[i]).div_euclid(2))
    }

    fn side(&self) -> usize {
        (self.max[0] - self.min[0]).max(self.max[1] - self.min[1]) as usize + 1
    }

    fn holds(&self, point: Displacement) -> bool {
        (0..2).all(|i| (self.min[i]..=self.max[i]).contains(&point[i]))
    }

    /// The upper left, upper right, lower left and lower right quadrant; neighbours share a line.
    fn quadrants(&self) -> [Part; 4] {
        let (Part { min: [left, top], max: [right, bottom] }, [x, y]) = (*self, self.centre());
        [
            Part { min: [left, top], max: [x, y] },
            Part { min: [x, top], max: [right, y] },
            Part { min: [left, y], max: [x, bottom] },
            Part { min: [x, y], max: [right, bottom] },
        ]
    }

    /// The centre, the corners of the quadrants, and their centres.
    fn points(&self) -> [Displacement; 13] {
        let (Part { min: [left, top], max: [right, bottom] }, [x, y]) = (*self, self.centre());
        let [a, b, c, d] = self.quadrants().map(|quadrant| quadrant.centre());
        let corners =
            [[left, top], [x, top], [right, top], [left, y], [right, y], [left, bottom], [x, bottom], [right, bottom]];
        let [e, f, g, h, i, j, k, l] = corners;
        [[x, y], e, f, g, h, i, j, k, l, a, b, c, d]
    }

    fn window(&self) -> Window {
        let size = [0, 1].map(|i| (self.max[i] - self.min[i]) as usize + 1);
        Window { min: self.min, size: (size[0], size[1]) }
    }
}
