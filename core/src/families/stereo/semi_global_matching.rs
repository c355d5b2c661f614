//! Semi-global matching: costs of single pixels, made smooth along paths from all directions.
//!
//! ```text
//!   ↘ ↓ ↙       L_r(p, d)        a path reaches p from the pixel before it
//!   → p ←        ╱ ╲              with the same disparity: free
//!   ↗ ↑ ↖       d−1 d d+1         with one more or less: P1, as on a slope
//!                                 with any other: P2, as at a depth edge
//! ```

mod charts;
mod explain;
mod fill;
mod marks;
mod paths;
mod shown;
mod vocabulary;

use std::sync::Arc;

use crate::base::wide::wide;
use crate::base::{Error, Observer, Tally, Threads};
use crate::data::{Clip, Disparity, Mask};
use crate::geometry::Grid;
use crate::methods::stereo::{Kept, Settings, Verdict, Views, Winners, accept, census, vertex};
use crate::products::{DisparityField, Output, Product, ProductKind};
use crate::run::{Estimator, Explained, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen};
use crate::scene::{Chart, Focus, Question, Reply, Scene, Step};
use crate::{choices, params, pseudocode};
use fill::Gap;
use paths::{Job, LANES, Line, MOST_PENALTY, NONE};

choices! {
    /// Number of directions of paths.
    pub enum Paths {
        /// Along rows and columns.
        Four = "4" "4",
        /// Along diagonals too: fewer streaks, twice the time.
        Eight = "8" "8",
    }
}

params! {
    /// Semi-global matching.
    pub struct SemiGlobalMatching {
        /// Penalty P1 for a change of the disparity by 1 px between neighbours. Larger values make slanted surfaces into steps.
        p1: usize = 10, 0..=MOST_PENALTY;
        /// Penalty P2 for a larger change, at least P1. Larger values suppress noise, but pull thin objects into the background.
        p2: usize = 60, 0..=MOST_PENALTY;
        /// Number of directions of paths.
        paths: Paths = Paths::Eight;
        /// Fill pixels that fail a test from their surroundings.
        fill: bool = true;
        /// Range and tests of a match.
        settings: Settings = Settings { uniqueness: 5, ..Settings::default() };
    }
}

/// The steps from a pixel to the next one on a path: from the left, the right, above and below, and along the diagonals. Those that run
/// downwards or within a row come from rows above, so that one pass over the picture follows them all.
const DIRECTIONS: [[isize; 2]; 8] = [[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [-1, 1], [1, -1], [-1, -1]];

/// The state of a run.
#[derive(Clone)]
pub struct State {
    fixed: Arc<Fixed>,
    /// Number of completed stages.
    done: usize,
    /// The cost volume: for each pixel the costs of its disparities, with [`NONE`] up to a multiple of [`LANES`].
    costs: Arc<Vec<u8>>,
    /// The sums of the path costs so far, in the same order.
    sums: Arc<Vec<u16>>,
    /// The result of each pixel, from the choice of the minimum on.
    kept: Arc<Vec<Kept>>,
    /// The disparities from the right view, from the left–right check on.
    right: Arc<Vec<u16>>,
}

/// The constant part of a run.
struct Fixed {
    views: Views,
    /// Census strings of the left view, and of the right view with its rows from right to left.
    census: [Grid<u64>; 2],
    /// Costs of a pixel in the volume.
    depth: usize,
}

/// A stage of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// The cost volume.
    Cost,
    /// The paths along a direction.
    Path([isize; 2]),
    /// The minimum of the sums.
    Winner,
    /// The left–right check.
    Check,
    /// The interpolation of gaps.
    Fill,
}

/// A row of a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    stage: Stage,
    y: u32,
}

impl SemiGlobalMatching {
    fn prepare(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let views = Views::new(clip, frame)?;
        let [left, mut right] = [&views.left, &views.right].map(|view| census(view.luma(), threads));
        let width = right.width();
        right.cells_mut().chunks_exact_mut(width).for_each(<[u64]>::reverse);
        let depth = self.settings.disparities.next_multiple_of(LANES);
        Ok(State {
            fixed: Arc::new(Fixed { views, census: [left, right], depth }),
            done: 0,
            costs: Arc::default(),
            sums: Arc::default(),
            kept: Arc::default(),
            right: Arc::default(),
        })
    }

    /// The directions of paths.
    fn directions(&self) -> &'static [[isize; 2]] {
        &DIRECTIONS[..if self.paths == Paths::Four { 4 } else { 8 }]
    }

    fn stages(&self) -> Vec<Stage> {
        let paths = self.directions().iter().map(|direction| Stage::Path(*direction));
        let rest = [Stage::Winner, Stage::Check].into_iter().chain(self.fill.then_some(Stage::Fill));
        [Stage::Cost].into_iter().chain(paths).chain(rest).collect()
    }

    /// P1 and P2.
    fn penalties(&self) -> [u8; 2] {
        [self.p1, self.p2.max(self.p1)].map(|penalty| penalty as u8)
    }

    /// The costs of row `y`.
    fn cost_row(&self, fixed: &Fixed, y: usize, costs: &mut [u8]) {
        let [left, right] = &fixed.census;
        paths::hamming(costs, left.row(y), right.row(y), self.settings.disparities);
    }

    fn choose_row(&self, sums: &[u16], desk: &Desk, row: &mut [Kept]) {
        let depth = self.settings.disparities.next_multiple_of(LANES);
        for (x, (kept, sums)) in row.iter_mut().zip(sums.chunks_exact(depth)).enumerate() {
            let at = usize::from(desk.winners.left[x]);
            let rival = Some(u32::from(desk.rivals[x])).filter(|rival| *rival < u32::from(u16::MAX));
            let verdict = accept(&self.settings, u32::from(sums[at]), rival, 0);
            let disparity = match verdict {
                Verdict::Accepted if self.settings.is_refined(at, x) => {
                    at as f32 + vertex([at - 1, at, at + 1].map(|d| u32::from(sums[d])))
                }
                Verdict::Accepted => at as f32,
                _ => Disparity::UNKNOWN,
            };
            *kept = Kept { disparity, verdict };
        }
    }

    /// Rejects the disparities of a row that the right view does not confirm, and stores those that it has.
    fn check_row(&self, desk: &Desk, row: &mut [Kept], right: &mut [u16]) {
        for (x, kept) in row.iter_mut().enumerate() {
            let is_confirmed = desk.winners.difference(x) <= self.settings.max_difference;
            if kept.verdict == Verdict::Accepted && !is_confirmed {
                *kept = Kept { disparity: Disparity::UNKNOWN, verdict: Verdict::Inconsistent };
            }
        }
        right.copy_from_slice(&desk.winners.right);
    }

    /// Why pixel `x` of a row has no disparity, given the disparities from the right view.
    fn gap(&self, right: &[u16], x: usize) -> Gap {
        let is_met = (0..=x.min(self.settings.disparities - 1)).any(|d| usize::from(right[x - d]) == d);
        if is_met { Gap::Mismatched } else { Gap::Occluded }
    }

    /// Fills all gaps.
    fn fill(&self, kept: &mut [Kept], right: &[u16], width: usize) {
        for (index, around) in fill::nearest(kept, width) {
            let gap = self.gap(&right[index / width * width..], index % width);
            kept[index].disparity = fill::value(gap, around);
        }
    }

    /// Adds the path costs along a direction to the sums.
    fn aggregate(&self, state: &mut State, direction: [isize; 2], mut each: impl FnMut(usize)) {
        let ((width, height), depth) = (state.fixed.views.size(), state.fixed.depth);
        let sums = Arc::make_mut(&mut state.sums);
        sums.resize(width * height * depth, 0);
        let mut follower = Follower::new(direction, (width, depth), self.penalties());
        for i in 0..height {
            let y = if direction[1] < 0 { height - 1 - i } else { i };
            let cells = y * width * depth..(y + 1) * width * depth;
            follower.follow(&state.costs[cells.clone()], &mut sums[cells]);
            each(y);
        }
    }
}

wide! {
    /// The minima of the sums of a row from both views, and their rivals.
    fn find_winners(disparities: usize, sums: &[u16], desk: &mut Desk) = find_each
}

#[inline(always)]
fn find_each(disparities: usize, sums: &[u16], desk: &mut Desk) {
    let Desk { winners, rivals, lowest, reversed } = desk;
    let depth = disparities.next_multiple_of(LANES);
    let width = sums.len() / depth;
    winners.left.clear();
    rivals.clear();
    [(&mut *lowest, u16::MAX), (&mut *reversed, 0)].into_iter().for_each(|(buffer, value)| {
        buffer.clear();
        buffer.resize(width, value);
    });
    for (x, sums) in sums.chunks_exact(depth).enumerate() {
        let sums = &sums[..disparities.min(x + 1)];
        let least = |sums: &[u16]| sums.iter().copied().fold(u16::MAX, u16::min);
        // The cost in the upper half, its disparity in the lower one: the least of these is the first of the least costs.
        let keys = sums.iter().zip(0u32..).map(|(sum, d)| u32::from(*sum) << 16 | d);
        let at = usize::from(keys.fold(u32::MAX, u32::min) as u16);
        winners.left.push(at as u16);
        rivals.push(least(&sums[..at.saturating_sub(1)]).min(least(&sums[(at + 2).min(sums.len())..])));
        // Pixel x − d of the right view is at index width − 1 − x + d of its row from right to left.
        let from = width - 1 - x;
        keep_lower(&mut lowest[from..], &mut reversed[from..], sums);
    }
    winners.right.clear();
    winners.right.extend(reversed.iter().rev());
}

/// Keeps the lower of two costs of each pixel, with its disparity, the index into `sums`.
#[inline(always)]
fn keep_lower(lowest: &mut [u16], at: &mut [u16], sums: &[u16]) {
    for (((lowest, at), &sum), d) in lowest.iter_mut().zip(at).zip(sums).zip(0u16..) {
        *at = if sum < *lowest { d } else { *at };
        *lowest = sum.min(*lowest);
    }
}

/// Buffers for the decision on a row.
#[derive(Default)]
struct Desk {
    winners: Winners,
    /// The lowest sum of each pixel beside the minimum and its neighbours.
    rivals: Vec<u16>,
    lowest: Vec<u16>,
    reversed: Vec<u16>,
}

/// The paths along a direction, row by row.
struct Follower {
    direction: [isize; 2],
    penalties: [u8; 2],
    before: Line,
    line: Line,
}

impl Follower {
    fn new(direction: [isize; 2], (width, depth): (usize, usize), penalties: [u8; 2]) -> Self {
        let line = Line::outside(width, depth);
        Self { direction, penalties, before: line.clone(), line }
    }

    /// Goes on to the next row, with these costs.
    fn follow(&mut self, costs: &[u8], sums: &mut [u16]) {
        let [dx, dy] = self.direction;
        std::mem::swap(&mut self.before, &mut self.line);
        let before = (dy != 0).then_some(&self.before);
        paths::follow(Job { dx, before, line: &mut self.line, costs, sums, penalties: self.penalties });
    }
}

impl State {
    fn pixels(&self) -> usize {
        let (width, height) = self.fixed.views.size();
        width * height
    }

    /// The results before any choice.
    fn nothing(&self) -> Vec<Kept> {
        vec![Kept { disparity: Disparity::UNKNOWN, verdict: Verdict::Accepted }; self.pixels()]
    }

    /// The disparities so far: those chosen, else the minima of the sums, else those of the costs.
    fn map(&self) -> Grid<f32> {
        let (width, height) = self.fixed.views.size();
        let depth = self.fixed.depth;
        let lowest = |x: usize, y: usize| {
            let cells = (y * width + x) * depth..(y * width + x + 1) * depth;
            let at = match (&self.sums[..], &self.costs[..]) {
                ([], []) => None,
                ([], costs) => costs[cells].iter().enumerate().min_by_key(|(_, cost)| **cost).map(|(d, _)| d),
                (sums, _) => sums[cells].iter().enumerate().min_by_key(|(_, sum)| **sum).map(|(d, _)| d),
            };
            at.map_or(Disparity::UNKNOWN, |d| d as f32)
        };
        match &self.kept[..] {
            [] => Grid::from_fn(width, height, lowest),
            kept => Grid::from_fn(width, height, |x, y| kept[y * width + x].disparity),
        }
    }
}

pseudocode! {
    TAKE_VIEWS: "take the left and the right view, rectified so that corresponding points lie on one row",
    COMPUTE_COSTS: "for each pixel p and d = 0 … D − 1: C(p, d) ← Hamming distance of the census strings of p and p − (d, 0)",
    EACH_DIRECTION: "for each of 4 or 8 directions r, pixel by pixel along its paths",
    AGGREGATE: "  L(p, d) ← C(p, d) + min(L(p − r, d), L(p − r, d ± 1) + P1, m + P2) − m, m = min L(p − r, ·); S(p, d) ← S(p, d) + L(p, d)",
    CHOOSE: "d(p) ← arg min S(p, d), refined by a parabola",
    REJECT_AMBIGUOUS: "if another minimum is higher by less than the uniqueness: no disparity",
    CHECK: "if the right view has another disparity at p − (d, 0), by more than max-difference: no disparity",
    FILL: "gaps: the second lowest of the nearest disparities in 8 directions where half-occluded, else their median",
}

impl Estimator for SemiGlobalMatching {
    const INFO: Info = Info {
        id: "semi-global-matching",
        name: "Semi-global matching",
        family: "Stereo",
        summary: "Sums matching costs along paths from all directions, with penalties for changes of the disparity, and takes the minimum.",
        source: "H. Hirschmüller, Stereo processing by semiglobal matching and mutual information, IEEE Transactions on Pattern Analysis and \
                 Machine Intelligence 30(2), 2008; census cost: H. Hirschmüller and D. Scharstein, same journal 31(9), 2009",
        pseudocode: line::ALL,
        granularities: &["frame", "stage", "row"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::choice(
            "unique",
            "Is the lowest sum of path costs unique?",
            &[Reply::at(line::REJECT_AMBIGUOUS, "No: a rival is nearly as low"), Reply::at(line::CHOOSE, "Yes")],
        ),
        Question::choice(
            "confirmed",
            "Does the left–right check confirm the disparity?",
            &[Reply::told(line::CHECK, vocabulary::case::CONFIRMED, "Yes"), Reply::at(line::CHECK, "No")],
        ),
    ];
    const GUARANTEE: Guarantee = Guarantee::Disparity;
    const CHARTS: &'static [Chart] = &[Chart::Series];
    const CONTRASTS: Option<&'static str> = Some("paths");
    const PRODUCES: &'static [&'static ProductKind] = &[DisparityField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        self.prepare(clip, frame, &Threads::single())
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let stages = self.stages();
        let stage = stages[state.done];
        let ((width, height), depth) = (state.fixed.views.size(), state.fixed.depth);
        let mut see = |y: usize| observer.see(|| Event { stage, y: y as u32 });
        match stage {
            Stage::Cost => {
                let mut costs = vec![NONE; width * height * depth];
                for (y, row) in costs.chunks_exact_mut(width * depth).enumerate() {
                    self.cost_row(&state.fixed, y, row);
                    see(y);
                }
                state.costs = Arc::new(costs);
            }
            Stage::Path(direction) => self.aggregate(state, direction, see),
            Stage::Winner | Stage::Check => {
                let mut kept = if stage == Stage::Winner { state.nothing() } else { Vec::clone(&state.kept) };
                let mut right = vec![0; if stage == Stage::Check { width * height } else { 0 }];
                let mut desk = Desk::default();
                let rows = kept.chunks_exact_mut(width).zip(state.sums.chunks_exact(width * depth));
                for (y, (row, sums)) in rows.enumerate() {
                    find_winners(self.settings.disparities, sums, &mut desk);
                    match stage {
                        Stage::Winner => self.choose_row(sums, &desk, row),
                        _ => self.check_row(&desk, row, &mut right[y * width..(y + 1) * width]),
                    }
                    see(y);
                }
                (state.kept, state.right) = (Arc::new(kept), Arc::new(right));
            }
            Stage::Fill => {
                self.fill(&mut Arc::make_mut(&mut state.kept)[..], &state.right, width);
                (0..height).for_each(see);
            }
        }
        state.done += 1;
        Ok(if state.done == stages.len() { Progress::Done } else { Progress::More })
    }

    fn units(&self, _: &State) -> Option<usize> {
        Some(self.stages().len())
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        vec![Granularity { index: 0, of: Some(1) }, Granularity { index: state.done, of: self.units(state) }]
    }

    fn pointed(&self) -> Option<&dyn Pointed<Self::State>> {
        Some(self)
    }

    fn step(&self, seen: &Seen<Self>) -> Step {
        self.explanation(seen)
    }

    fn draw(&self, seen: &Seen<Self>, scene: &mut Scene) {
        self.draw_step(seen, scene);
    }

    fn output(&self, state: &State) -> Output {
        let map = match &state.kept[..] {
            [] => Grid::new(state.fixed.views.size().0, state.fixed.views.size().1, Disparity::UNKNOWN),
            _ => state.map(),
        };
        let calibration = state.fixed.views.calibration;
        let is_filled = |kept: &Kept| kept.verdict != Verdict::Accepted && kept.disparity.is_finite();
        let width = state.fixed.views.size().0;
        let filled = state.kept.iter().any(is_filled).then(|| {
            Mask::from_fn(width, state.kept.len() / width.max(1), |x, y| is_filled(&state.kept[y * width + x]))
        });
        let candidates = self.settings.disparities;
        Output::of(DisparityField { map: Disparity(map), calibration, candidates, filled })
    }

    /// The same rows in another order: in a single pass down the picture the costs of a row and all its paths that come from above or from
    /// the sides, and in one up those from below and the decisions. Sums of whole numbers do not depend on it.
    fn run(&self, clip: &Clip, frame: usize, threads: &Threads, tally: &impl Tally<Event>) -> Result<State, Error> {
        let mut state = self.prepare(clip, frame, threads)?;
        clip.wanted()?;
        let ((width, height), depth) = (state.fixed.views.size(), state.fixed.depth);
        let stages = self.stages();
        tally.add_units(stages.len());
        tally.add_events((stages.len() * height) as u64);
        let row = width * depth;
        let (mut costs, mut sums) = (vec![NONE; height * row], vec![0u16; height * row]);
        let fixed = &state.fixed;
        threads.chunks(&mut costs, row, |y, costs| self.cost_row(fixed, y, costs));
        clip.wanted()?;
        let new = |direction: &[isize; 2]| Follower::new(*direction, (width, depth), self.penalties());
        let (mut down, mut up): (Vec<_>, Vec<_>) =
            self.directions().iter().map(new).partition(|follower| follower.direction[1] >= 0);
        for (costs, sums) in costs.chunks_exact(row).zip(sums.chunks_exact_mut(row)) {
            down.iter_mut().for_each(|follower| follower.follow(costs, sums));
        }
        clip.wanted()?;
        for (costs, sums) in costs.chunks_exact(row).zip(sums.chunks_exact_mut(row)).rev() {
            up.iter_mut().for_each(|follower| follower.follow(costs, sums));
        }
        clip.wanted()?;
        let (mut kept, mut right) = (state.nothing(), vec![0; width * height]);
        let rows = kept.chunks_exact_mut(width).zip(right.chunks_exact_mut(width)).zip(sums.chunks_exact(row));
        threads.each(rows, |((kept, right), sums)| {
            let mut desk = Desk::default();
            find_winners(self.settings.disparities, sums, &mut desk);
            self.choose_row(sums, &desk, kept);
            self.check_row(&desk, kept, right);
        });
        clip.wanted()?;
        if self.fill {
            self.fill(&mut kept, &right, width);
        }
        state.done = stages.len();
        (state.costs, state.sums, state.kept, state.right) =
            (Arc::new(costs), Arc::new(sums), Arc::new(kept), Arc::new(right));
        Ok(state)
    }
}

impl Footprint<State> for SemiGlobalMatching {
    fn need(&self, clip: &Clip) -> Need {
        let depth = self.settings.disparities.next_multiple_of(LANES) as f64;
        let lines = 16.0 * (clip.size().0 + 2) as f64 * (depth + 32.0);
        Need::per_pixel(clip, [3.0 * depth + 110.0, 10.0 * depth + 260.0]).and([lines, lines])
    }

    fn state_bytes(&self, state: &State) -> usize {
        let State { sums, kept, right, .. } = state;
        size_of::<State>() + size_of_val(&sums[..]) + size_of_val(&kept[..]) + size_of_val(&right[..])
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let Fixed { views, census, .. } = &*state.fixed;
        let strings: usize = census.iter().map(|grid| size_of_val(grid.cells())).sum();
        self.state_bytes(state) + state.costs.len() + views.bytes() + strings
    }
}

impl Pointed<State> for SemiGlobalMatching {
    fn explained(&self, state: &State, Focus { at, .. }: Focus) -> Option<Explained> {
        state.fixed.views.left.luma().cell_at(at).map(|_| Explained::Always)
    }
}
