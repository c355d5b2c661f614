//! Pixels and costs of a worksheet as tables: small enough to be computed by hand.

use motionscope_core::scene::{Math, Series, Surface, Tile};
use motionscope_core::{Grid, Role, fixed};

use super::numbers::{Fill, filled, is_telling};
use crate::paint::charts::heat_map::{cost, optimum_words};
use crate::paint::charts::table::{Cell, Table};
use crate::paint::charts::tiles::brief;
use crate::paint::number;

/// Pixels of a side that are printed of a larger window.
const MOST_PIXELS: usize = 8;
/// The most windows whose pixels are printed where none of them is computed, and the longest side of these.
const MOST_GIVEN: usize = 4;
const LONGEST_GIVEN: usize = 9;
/// The most bins of a histogram that are printed.
const MOST_BINS: usize = 14;
/// Bins with less are nothing to three decimals.
const LEAST_SHARE: f32 = 0.001;
/// Displacements around the one at hand.
const AROUND: [i32; 2] = [3, 2];

/// The tables of a step.
#[derive(Clone, Debug, Default)]
pub struct Grids {
    /// Windows of pixels.
    pub tiles: Option<Pixels>,
    /// The costs around the displacement at hand.
    pub surface: Option<Costs>,
    /// The shares of histograms with few bins.
    pub histogram: Option<Table>,
}

/// Windows of pixels.
#[derive(Clone, Debug)]
pub struct Pixels {
    /// A table for each window.
    pub tables: Vec<Table>,
    /// What is known of the pixels that are not printed.
    pub rest: Option<Math>,
    /// Whether numbers are left out.
    pub has_blanks: bool,
}

/// Costs by displacement.
#[derive(Clone, Debug)]
pub struct Costs {
    /// The costs.
    pub table: Table,
    /// Which is the best, and where.
    pub best: Option<Math>,
}

/// The pixels of windows, of differences a row left out, and what is left out. Of windows larger than what can be computed by hand a
/// part is printed, with the sum of the others where the `known` results are such sums.
pub fn pixels(tiles: &[Tile], known: &[String], fill: Fill) -> (Option<Pixels>, Vec<String>) {
    let size = tiles.first().map_or((0, 0), |tile| tile.values.size());
    let computed = tiles.iter().position(|tile| tile.role == Some(Role::Error) && tile.values.size() == size);
    let is_small = |tile: &Tile| tile.values.width().max(tile.values.height()) <= LONGEST_GIVEN;
    let is_printed = computed.is_some() || tiles.len() <= MOST_GIVEN && tiles.iter().all(is_small);
    if tiles.is_empty() || !is_printed {
        return (None, Vec::new());
    }
    let most = if computed.is_some() { MOST_PIXELS } else { LONGEST_GIVEN };
    let mut answers = Vec::new();
    let mut rest = None;
    let tables = tiles.iter().enumerate().map(|(index, tile)| {
        if Some(index) != computed {
            return given(tile, most);
        }
        let sums = Sums::of(tile, most, known);
        rest = sums.as_ref().and_then(Sums::rest);
        let (table, left_out) = differences(tile, most, sums.as_ref(), fill);
        answers = left_out;
        table
    });
    let tables = tables.collect();
    (Some(Pixels { tables, rest, has_blanks: computed.is_some() }), answers)
}

/// The part of a window that is printed.
fn printed(tile: &Tile, most: usize) -> (usize, usize) {
    let (width, height) = tile.values.size();
    (width.min(most), height.min(most))
}

fn word(value: f32) -> Cell {
    if value.is_finite() { Cell::Given(brief(value)) } else { Cell::Unknown }
}

fn given(tile: &Tile, most: usize) -> Table {
    let (width, height) = printed(tile, most);
    let framed = tile.framed.iter().flat_map(|framed| framed.pixels.iter().map(|pixel| (framed.role, *pixel)));
    Table {
        title: tile.label.to_owned(),
        columns: Vec::new(),
        rows: Vec::new(),
        cells: Grid::from_fn(width, height, |x, y| word(tile.values[(x, y)])),
        framed: framed.collect(),
    }
}

/// Sums of the absolute values of a window, where the whole sum is a result of the step.
struct Sums {
    rows: Vec<f32>,
    /// The sum and the number of pixels that are not printed.
    others: (f32, usize),
}

impl Sums {
    fn of(tile: &Tile, most: usize, known: &[String]) -> Option<Self> {
        let values = &tile.values;
        let sum = |cells: &mut dyn Iterator<Item = f32>| cells.map(f32::abs).sum::<f32>();
        let total = sum(&mut values.cells().iter().copied());
        let is_known = total.is_finite() && known.iter().any(|other| *other == number(total));
        if !is_known {
            return None;
        }
        let (width, height) = printed(tile, most);
        let rows: Vec<f32> = (0..height).map(|y| sum(&mut (0..width).map(|x| values[(x, y)]))).collect();
        let others = (total - rows.iter().sum::<f32>(), values.cells().len() - width * height);
        Some(Self { rows, others })
    }

    fn rest(&self) -> Option<Math> {
        let (sum, count) = self.others;
        (count > 0).then(|| Math::text(format!("Sum of the other {count} pixels: {}", number(sum))))
    }
}

/// A window of differences, its last row and the sum of that left out.
fn differences(tile: &Tile, most: usize, sums: Option<&Sums>, fill: Fill) -> (Table, Vec<String>) {
    let (width, height) = printed(tile, most);
    let last = height.saturating_sub(1);
    let value = |x: usize, y: usize| match sums {
        Some(sums) if x == width => sums.rows[y],
        _ => tile.values[(x, y)],
    };
    let columns = width + usize::from(sums.is_some());
    let cell = |x: usize, y: usize| match (word(value(x, y)), fill) {
        (Cell::Given(_), Fill::Blank) if y == last => Cell::Blank,
        (Cell::Given(text), Fill::Answer) if y == last => Cell::Answer(text),
        (given, _) => given,
    };
    let answers = (0..columns).map(|x| value(x, last)).filter(|value| value.is_finite()).map(brief).collect();
    let heads = (0..width).map(|_| String::new()).chain(sums.map(|_| "Σ".to_owned()));
    let table = Table {
        title: tile.label.to_owned(),
        columns: if sums.is_some() { heads.collect() } else { Vec::new() },
        rows: Vec::new(),
        cells: Grid::from_fn(columns, height, cell),
        framed: Vec::new(),
    };
    (table, answers)
}

/// The bins of histograms over each other, unless they are more than can be added by hand.
pub fn histogram(series: &Series) -> Option<Table> {
    // A bar is two points of the same height, a bin apart.
    let bars = |points: &[[f32; 2]]| -> Option<Vec<f32>> {
        let bar = |pair: &[[f32; 2]]| match pair {
            [left, right] => (left[1] == right[1] && right[0] - left[0] == 1.0).then_some(left[1]),
            _ => None,
        };
        points.chunks(2).map(bar).collect()
    };
    let lines: Vec<(&str, Vec<f32>)> =
        series.lines.iter().map(|(name, _, points)| Some((*name, bars(points)?))).collect::<Option<_>>()?;
    let count = lines.iter().map(|(_, values)| values.len()).max()?;
    let value = |bin: usize, y: usize| lines[y].1.get(bin).copied().unwrap_or_default();
    let bins: Vec<usize> = (0..count).filter(|bin| (0..lines.len()).any(|y| value(*bin, y) >= LEAST_SHARE)).collect();
    let is_printed = series.is_sweep && (1..=MOST_BINS).contains(&bins.len());
    is_printed.then(|| Table {
        title: format!("{}: {}, bins of at least {LEAST_SHARE}", series.title, series.y_label),
        columns: bins.iter().map(|bin| (bin + 1).to_string()).collect(),
        rows: lines.iter().map(|(name, _)| (*name).to_owned()).collect(),
        cells: Grid::from_fn(bins.len(), lines.len(), |x, y| Cell::Given(fixed(value(bins[x], y).into(), 3))),
        framed: Vec::new(),
    })
}

/// The costs around the displacement under test, or the best one; left out are the one under test and the `known` results.
pub fn costs(surface: &Surface, known: &[String], fill: Fill) -> (Option<Costs>, Vec<String>) {
    let Some(center) = surface.probe.or(surface.best) else { return (None, Vec::new()) };
    let last = [surface.values.width(), surface.values.height()];
    let ends = [0, 1].map(|i| {
        let (from, to) = (surface.origin[i], surface.origin[i] + last[i] as i32 - 1);
        [(center[i] - AROUND[i]).max(from), (center[i] + AROUND[i]).min(to)]
    });
    let [us, vs]: [Vec<i32>; 2] = ends.map(|[from, to]| (from..=to).collect());
    let is_known = |text: &str| is_telling(text) && known.iter().any(|other| other == text);
    let mut answers = Vec::new();
    let cells = Grid::from_fn(us.len(), vs.len(), |x, y| {
        let at = [us[x], vs[y]];
        let Some(text) = cost(surface, at).map(number) else { return Cell::Unknown };
        if surface.probe != Some(at) && !is_known(&text) {
            return Cell::Given(text);
        }
        answers.push(text.clone());
        if fill == Fill::Blank { Cell::Blank } else { Cell::Answer(text) }
    });
    if cells.cells().iter().all(|cell| *cell == Cell::Unknown) {
        return (None, Vec::new());
    }
    let words = |all: &[i32]| all.iter().map(|c| number(*c as f32)).collect();
    let table = Table {
        title: format!("{} by displacement: u across, v down", surface.title),
        columns: words(&us),
        rows: words(&vs),
        cells,
        framed: Vec::new(),
    };
    // The best one before the candidate under test is given.
    let is_asked = surface.probe.is_none_or(|probe| surface.best.is_none_or(|best| best == probe));
    let best = optimum_words(surface).map(|words| {
        answers.extend(super::numbers::of(&words).into_iter().filter(|_| is_asked));
        filled(&format!("So far: {words}"), None, fill, &|_| is_asked)
    });
    (Some(Costs { table, best }), answers)
}
