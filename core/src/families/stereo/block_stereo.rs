//! Block matching along epipolar lines: for each pixel the window of the right view on the same row that fits best.
//!
//! ```text
//!   left view              right view                 C(d)
//!   ┌──────────────┐       ┌──────────────┐            │ ╲    ╱╲    ╱
//!   │        ┌─┐   │       │ ├──┌─┐───┤   │            │  ╲  ╱  ╲__╱
//!   │        └─┘   │       │    └─┘       │            │   ╲╱
//!   └──────────────┘       └──────────────┘            └────┴──────── d
//!          (x, y)             (x − d, y)                    d*
//! ```

mod explain;

use std::sync::Arc;

use crate::base::wide::wide;
use crate::base::{Error, Observer, Tally, Threads};
use crate::data::{Clip, Disparity};
use crate::geometry::Grid;
use crate::methods::stereo::{Kept, Settings, Verdict, Views, Winners, accept, census, vertex};
use crate::products::{DisparityField, Output, Product, ProductKind};
use crate::run::{
    Cursor, Estimator, Explained, Footprint, Granularity, Guarantee, Info, Need, Pointed, Progress, Seen,
};
use crate::scene::{Chart, Focus, Question, Reply, Role, Scene, Step};
use crate::{choices, params, pseudocode};

choices! {
    /// Matching cost of two windows.
    pub enum Cost {
        /// Sum of absolute differences of the gray levels. It assumes that both cameras see the same brightness.
        Sad = "sad" "SAD",
        /// Sum of the Hamming distances of the census strings, the order of the gray levels in 9×7 px around each pixel. Neither brightness nor
        /// contrast of a view matters.
        Census = "census" "Census",
    }
}

params! {
    /// Block matching along epipolar lines.
    pub struct BlockStereo {
        /// Half a side of the window: the side is 2·window + 1 px. Larger windows are less ambiguous, but blur depth edges.
        window: usize = 4, 0..=15, "px";
        /// Matching cost of two windows.
        cost: Cost = Cost::Sad;
        /// Range and tests of a match.
        settings: Settings = Settings::default();
    }
}

/// The state of a run.
#[derive(Clone)]
pub struct State {
    fixed: Arc<Fixed>,
    /// The results of the completed rows.
    kept: Arc<Vec<Kept>>,
}

/// The constant part of a run.
struct Fixed {
    views: Views,
    pixels: Pixels,
}

/// The compared pixels, extended by the columns that windows reach beyond the borders: the edge is repeated.
enum Pixels {
    /// Gray levels of both views.
    Gray([Grid<u8>; 2]),
    /// Census strings of both views.
    Census([Grid<u64>; 2]),
}

/// The result of a pixel with what decided it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    /// The result.
    kept: Kept,
    /// The disparity of lowest cost in px.
    best: u16,
    /// The disparity that the right view has at the match, in px.
    back: u16,
}

/// The costs of a row of pixels, and buffers.
#[derive(Default)]
struct Desk {
    /// For each disparity, the costs of all pixels; `u32::MAX` where the match lies beside the right view.
    costs: Vec<u32>,
    columns: Vec<u16>,
    lowest: Vec<u32>,
    rivals: Vec<u32>,
    winners: Winners,
}

impl BlockStereo {
    fn prepare(&self, clip: &Clip, frame: usize, threads: &Threads) -> Result<State, Error> {
        let views = Views::new(clip, frame)?;
        let pictures = [views.left.luma(), views.right.luma()];
        let pixels = match self.cost {
            Cost::Sad => Pixels::Gray([0, 1].map(|i| self.padded(pictures[i], i))),
            Cost::Census => Pixels::Census([0, 1].map(|i| self.padded(&census(pictures[i], threads), i))),
        };
        Ok(State { fixed: Arc::new(Fixed { views, pixels }), kept: Arc::new(Vec::new()) })
    }

    /// A view with as many columns more as windows reach: view 1 is searched further left.
    fn padded<T: Copy>(&self, grid: &Grid<T>, view: usize) -> Grid<T> {
        let (width, height) = grid.size();
        let before = self.window + if view == 1 { self.settings.disparities - 1 } else { 0 };
        Grid::from_fn(width + before + self.window, height, |x, y| grid.row(y)[x.saturating_sub(before).min(width - 1)])
    }

    /// The costs of all matches of row `y`.
    fn costs(&self, fixed: &Fixed, y: usize, desk: &mut Desk) {
        let ((width, height), disparities) = (fixed.views.size(), self.settings.disparities);
        let side = 2 * self.window + 1;
        desk.costs.resize(width * disparities, 0);
        desk.columns.resize(width + 2 * self.window, 0);
        let rows = |j: usize| (y + j).saturating_sub(self.window).min(height - 1);
        for d in 0..disparities {
            desk.columns.fill(0);
            let from = disparities - 1 - d;
            for y in (0..side).map(rows) {
                match &fixed.pixels {
                    Pixels::Gray([left, right]) => add_absolute(&mut desk.columns, left.row(y), &right.row(y)[from..]),
                    Pixels::Census([left, right]) => add_hamming(&mut desk.columns, left.row(y), &right.row(y)[from..]),
                }
            }
            let costs = &mut desk.costs[d * width..(d + 1) * width];
            slide(costs, &desk.columns, side);
            costs[..d.min(width)].fill(u32::MAX);
        }
    }

    /// Decides on row `y`.
    fn row(&self, fixed: &Fixed, (y, row): (usize, &mut [Kept]), desk: &mut Desk, observer: &mut impl Observer<Event>) {
        self.costs(fixed, y, desk);
        let (width, settings) = (row.len(), &self.settings);
        let Desk { costs, lowest, rivals, winners, .. } = desk;
        [&mut *lowest, &mut *rivals].into_iter().for_each(|buffer| {
            buffer.clear();
            buffer.resize(width, u32::MAX);
        });
        [&mut winners.left, &mut winners.right].into_iter().for_each(|buffer| {
            buffer.clear();
            buffer.resize(width, 0);
        });
        let lines = || costs.chunks_exact(width).take(width);
        for (d, costs) in lines().enumerate() {
            keep_lower(lowest, &mut winners.left, costs, d as u16);
        }
        for (d, costs) in lines().enumerate() {
            keep_rival(rivals, &winners.left, costs, d as u16);
        }
        // The pixel x of the left view is matched with x − d of the right one.
        lowest.fill(u32::MAX);
        for (d, costs) in lines().enumerate() {
            keep_lower(lowest, &mut winners.right, &costs[d..], d as u16);
        }
        for (x, kept) in row.iter_mut().enumerate() {
            let best = usize::from(winners.left[x]);
            let cost = |d: usize| costs[d * width + x];
            let rival = Some(rivals[x]).filter(|rival| *rival < u32::MAX);
            let verdict = accept(settings, cost(best), rival, winners.difference(x));
            let disparity = match verdict {
                Verdict::Accepted if settings.is_refined(best, x) => {
                    best as f32 + vertex([cost(best - 1), cost(best), cost(best + 1)])
                }
                Verdict::Accepted => best as f32,
                _ => Disparity::UNKNOWN,
            };
            *kept = Kept { disparity, verdict };
            observer.see(|| Event { kept: *kept, best: best as u16, back: winners.right[x - best] });
        }
    }
}

wide! {
    /// Adds the absolute differences of two rows to the sums of columns.
    fn add_absolute(sums: &mut [u16], left: &[u8], right: &[u8]) = add_each_absolute
}

#[inline(always)]
fn add_each_absolute(sums: &mut [u16], left: &[u8], right: &[u8]) {
    for ((sum, left), right) in sums.iter_mut().zip(left).zip(right) {
        *sum += u16::from(left.abs_diff(*right));
    }
}

wide! {
    /// Adds the Hamming distances of two rows of census strings to the sums of columns.
    fn add_hamming(sums: &mut [u16], left: &[u64], right: &[u64]) = add_each_hamming
}

#[inline(always)]
fn add_each_hamming(sums: &mut [u16], left: &[u64], right: &[u64]) {
    for ((sum, left), right) in sums.iter_mut().zip(left).zip(right) {
        *sum += (left ^ right).count_ones() as u16;
    }
}

/// The sum of `side` columns from each one on.
fn slide(sums: &mut [u32], columns: &[u16], side: usize) {
    let mut sum: u32 = columns[..side - 1].iter().map(|column| u32::from(*column)).sum();
    for ((slot, entering), leaving) in sums.iter_mut().zip(&columns[side - 1..]).zip(columns) {
        sum += u32::from(*entering);
        *slot = sum;
        sum -= u32::from(*leaving);
    }
}

wide! {
    /// Takes over the costs of a disparity where they are lower.
    fn keep_lower(lowest: &mut [u32], at: &mut [u16], costs: &[u32], disparity: u16) = keep_each_lower
}

#[inline(always)]
fn keep_each_lower(lowest: &mut [u32], at: &mut [u16], costs: &[u32], disparity: u16) {
    for ((lowest, at), &cost) in lowest.iter_mut().zip(at).zip(costs) {
        *at = if cost < *lowest { disparity } else { *at };
        *lowest = cost.min(*lowest);
    }
}

wide! {
    /// Takes over the costs of a disparity where they are lower, and it is no neighbour of the best one.
    fn keep_rival(rivals: &mut [u32], best: &[u16], costs: &[u32], disparity: u16) = keep_each_rival
}

#[inline(always)]
fn keep_each_rival(rivals: &mut [u32], best: &[u16], costs: &[u32], disparity: u16) {
    for ((rival, best), &cost) in rivals.iter_mut().zip(best).zip(costs) {
        let is_rival = best.abs_diff(disparity) > 1;
        *rival = if is_rival { cost.min(*rival) } else { *rival };
    }
}

impl State {
    fn width(&self) -> usize {
        self.fixed.views.size().0
    }

    /// The next row.
    fn y(&self) -> usize {
        self.kept.len() / self.width()
    }

    /// The disparities so far, with `more` of the next row.
    fn map(&self, more: &[Event]) -> Grid<f32> {
        let (width, height) = self.fixed.views.size();
        let mut map = Grid::new(width, height, Disparity::UNKNOWN);
        let all = self.kept.iter().chain(more.iter().map(|event| &event.kept));
        map.cells_mut().iter_mut().zip(all).for_each(|(cell, kept)| *cell = kept.disparity);
        map
    }
}

pseudocode! {
    TAKE_VIEWS: "take the left and the right view, rectified so that corresponding points lie on one row",
    EACH_PIXEL: "for each pixel (x, y): C(d) ← cost of its window and that at (x − d, y) of the right view, d = 0 … D − 1; d* ← arg min C(d)",
    REJECT_AMBIGUOUS: "  if another minimum is higher than C(d*) by less than the uniqueness: no disparity",
    REJECT_INCONSISTENT: "  else if |d* − arg min over d of the costs of pixel (x − d*, y) of the right view| > max-difference: no disparity",
    REFINE: "  else d ← d* + the vertex of the parabola through C(d* − 1), C(d*), C(d* + 1)",
}

impl Estimator for BlockStereo {
    const INFO: Info = Info {
        id: "block-stereo",
        name: "Block stereo",
        family: "Stereo",
        summary: "Matches a window around each pixel along its epipolar line, and keeps unique matches on which both views agree.",
        source: "D. Scharstein and R. Szeliski, A taxonomy and evaluation of dense two-frame stereo correspondence algorithms, \
                 International Journal of Computer Vision 47, 2002; left–right check: P. Fua, Machine Vision and Applications 6, 1993; census: \
                 R. Zabih and J. Woodfill, ECCV 1994",
        pseudocode: line::ALL,
        granularities: &["frame", "row", "pixel"],
        frames: 2,
    };
    const QUESTIONS: &'static [Question] = &[
        Question::choice(
            "valid",
            "Does the next pixel get a disparity?",
            &[
                Reply::at(line::REFINE, "Yes"),
                Reply::at(line::REJECT_AMBIGUOUS, "No: another minimum is nearly as low"),
                Reply::at(line::REJECT_INCONSISTENT, "No: it fails the left–right check"),
            ],
        ),
        Question::place("match", "Where is the match of the pixel in the right view?", line::REFINE, Role::Best),
    ];
    const GUARANTEE: Guarantee = Guarantee::Disparity;
    const CHARTS: &'static [Chart] = &[Chart::Series, Chart::Tiles];
    const CONTRASTS: Option<&'static str> = Some("cost");
    const PRODUCES: &'static [&'static ProductKind] = &[DisparityField::KIND];
    type State = State;
    type Event = Event;

    fn start(&self, clip: &Clip, frame: usize) -> Result<State, Error> {
        self.prepare(clip, frame, &Threads::single())
    }

    fn advance(&self, _: &Clip, state: &mut State, observer: &mut impl Observer<Event>) -> Result<Progress, Error> {
        let mut row = vec![Kept { disparity: Disparity::UNKNOWN, verdict: Verdict::Accepted }; state.width()];
        self.row(&state.fixed, (state.y(), &mut row), &mut Desk::default(), observer);
        Arc::make_mut(&mut state.kept).extend(row);
        Ok(if state.y() == state.fixed.views.size().1 { Progress::Done } else { Progress::More })
    }

    fn units(&self, state: &State) -> Option<usize> {
        Some(state.fixed.views.size().1)
    }

    fn place(&self, state: &State) -> Vec<Granularity> {
        vec![Granularity { index: 0, of: Some(1) }, Granularity { index: state.y(), of: self.units(state) }]
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
        let calibration = state.fixed.views.calibration;
        Output::of(DisparityField {
            map: Disparity(state.map(&[])),
            calibration,
            candidates: self.settings.disparities,
            filled: None,
        })
    }

    fn run(&self, clip: &Clip, frame: usize, threads: &Threads, tally: &impl Tally<Event>) -> Result<State, Error> {
        let mut state = self.prepare(clip, frame, threads)?;
        clip.wanted()?;
        let (width, height) = state.fixed.views.size();
        tally.add_units(height);
        let nothing = Kept { disparity: Disparity::UNKNOWN, verdict: Verdict::Accepted };
        let mut kept = vec![nothing; width * height];
        let band = threads.rows_at_once(height);
        threads.each(kept.chunks_mut(width * band).enumerate(), |(part, rows)| {
            let (mut desk, mut observer) = (Desk::default(), tally.counter());
            for (i, row) in rows.chunks_exact_mut(width).enumerate() {
                self.row(&state.fixed, (part * band + i, row), &mut desk, &mut observer);
            }
        });
        clip.wanted()?;
        state.kept = Arc::new(kept);
        Ok(state)
    }
}

impl Footprint<State> for BlockStereo {
    fn need(&self, clip: &Clip) -> Need {
        let row = 4.0 * clip.size().0 as f64 * self.settings.disparities as f64 * 64.0;
        Need::per_pixel(clip, [60.0, 150.0]).and([row, row])
    }

    fn state_bytes(&self, state: &State) -> usize {
        size_of::<State>() + size_of_val(&state.kept[..])
    }

    fn memory_bytes(&self, state: &State) -> usize {
        let Fixed { views, pixels } = &*state.fixed;
        let pixels = match pixels {
            Pixels::Gray(grids) => grids.iter().map(|grid| size_of_val(grid.cells())).sum::<usize>(),
            Pixels::Census(grids) => grids.iter().map(|grid| size_of_val(grid.cells())).sum(),
        };
        self.state_bytes(state) + views.bytes() + pixels
    }
}

impl Pointed<State> for BlockStereo {
    fn unit_at(&self, state: &State, Focus { at, .. }: Focus) -> Option<usize> {
        state.fixed.views.left.luma().cell_at(at).map(|(_, y)| y)
    }

    fn explained(&self, state: &State, Focus { at, .. }: Focus) -> Option<Explained> {
        let (x, y) = state.fixed.views.left.luma().cell_at(at)?;
        Some(Explained::From(Cursor { unit: y, event: x + 1 }))
    }
}
