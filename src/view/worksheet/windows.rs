//! Windows of pixels on a worksheet: parts that can be compared by hand, of the candidate at hand and of some before it.

use motionscope_core::geometry::Grid;
use motionscope_core::scene::{Math, Readout, Role, Step, Surface, Tile};

use super::numbers::{self, Fill};
use crate::paint::charts::heat_map::{cost, vector};
use crate::paint::charts::table::{Cell, Table};
use crate::paint::charts::tiles::brief;
use crate::paint::number;
use crate::view::panes::find;

/// Pixels of a side that are printed of a window whose differences are computed.
const MOST_PIXELS: usize = 4;
/// The most windows whose pixels are printed where none of them is computed, and the longest side of these.
const MOST_GIVEN: usize = 4;
const LONGEST_GIVEN: usize = 9;
/// The most candidates before the one at hand, and the steps back in which they are looked for.
const MOST_EARLIER: usize = 2;
const MOST_STEPS: usize = 6;
/// The task where nothing is left out.
const GIVEN: &str = "The values of this step by pixel";

/// Windows of pixels.
#[derive(Clone, Debug, Default)]
pub struct Pixels {
    /// The windows of the step, and those of candidates before it.
    pub windows: Vec<Windows>,
    /// Which part of them is printed, if it is not all.
    pub part: Option<String>,
    /// What is asked for.
    pub task: String,
    /// What is left out.
    pub answers: Vec<String>,
    /// The costs that can be computed, as texts.
    pub totals: Vec<String>,
    /// The displacements of the candidates before.
    pub earlier: Vec<[i32; 2]>,
}

/// Windows that are compared with each other.
#[derive(Clone, Debug)]
pub struct Windows {
    /// A table for each.
    pub tables: Vec<Table>,
    /// What is known of the pixels that are not printed, and the cost.
    pub rest: Vec<Math>,
}

/// How many steps before `step` are needed for its worksheet.
pub fn steps_before(step: &Step) -> usize {
    if tested(step).is_some() { MOST_STEPS } else { 1 }
}

/// The pixels of the windows of `step` with the differences left out, and those of candidates in `earlier` steps, latest first. Of large
/// windows a part is printed, with the sum of the others where that leads to one of the `values`.
pub fn pixels(step: &Step, earlier: &[Step], values: &[String], fill: Fill) -> Option<Pixels> {
    let tiles = tiles_of(step);
    let Some(computed) = Computed::of(tiles, values) else { return given(tiles) };
    let mut pixels = Pixels { task: GIVEN.to_owned(), ..Pixels::default() };
    let (width, height) = computed.difference().values.size();
    let part = computed.printed();
    pixels.part = (part != (width, height)).then(|| {
        let (columns, rows) = part;
        format!("The {columns}×{rows} pixels in the upper left corner of each {width}×{height} window are printed.")
    });
    let at = tested(step).map(|(at, _)| at);
    pixels.add(&computed, (at, Rows::All), fill);
    if !pixels.answers.is_empty() {
        pixels.task = computed.kind.task(computed.sums.is_some());
    }
    for (at, cost) in candidates(step, earlier, &computed) {
        let Some(other) = Computed::of(tiles_of(at.step), std::slice::from_ref(&cost)) else { continue };
        pixels.add(&other, (Some(at.displacement), Rows::Last), fill);
        let label = format!("{} at {} = ", at.title, vector(at.displacement));
        if let Some(windows) = pixels.windows.last_mut() {
            windows.rest.push(Math::Row(vec![Math::text(label), fill.math(&cost)]));
        }
        pixels.answers.push(cost);
        pixels.earlier.push(at.displacement);
    }
    Some(pixels)
}

impl Pixels {
    /// Adds windows with the differences of some rows left out.
    fn add(&mut self, computed: &Computed<'_>, (at, rows): (Option<[i32; 2]>, Rows), fill: Fill) {
        let tables = computed.tiles.iter().enumerate().map(|(index, tile)| {
            if index == computed.index {
                let (table, answers) = computed.table(rows, fill);
                self.answers.extend(answers);
                return table;
            }
            let mut table = printed(tile, computed.printed());
            // The block is the same for all candidates.
            if let Some(at) = at.filter(|_| tile.role != Some(Role::Reference)) {
                table.title = format!("{} {}", table.title, vector(at));
            }
            table
        });
        let tables = tables.collect();
        self.totals.extend(computed.sums.as_ref().map(|sums| number(sums.total)));
        self.windows.push(Windows { tables, rest: computed.rest().into_iter().collect() });
    }
}

/// Which differences are left out.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Rows {
    All,
    Last,
}

/// Small windows without differences, as they are.
fn given(tiles: &[Tile]) -> Option<Pixels> {
    let is_small = |tile: &Tile| tile.values.width().max(tile.values.height()) <= LONGEST_GIVEN;
    let is_printed = !tiles.is_empty() && tiles.len() <= MOST_GIVEN && tiles.iter().all(is_small);
    let tables = || tiles.iter().map(|tile| printed(tile, tile.values.size())).collect();
    is_printed.then(|| Pixels {
        windows: vec![Windows { tables: tables(), rest: Vec::new() }],
        task: GIVEN.to_owned(),
        ..Pixels::default()
    })
}

/// The upper left part of a window.
fn printed(tile: &Tile, (width, height): (usize, usize)) -> Table {
    let framed = tile.framed.iter().flat_map(|framed| framed.pixels.iter().map(|pixel| (framed.role, *pixel)));
    Table {
        title: tile.label.to_owned(),
        columns: Vec::new(),
        rows: Vec::new(),
        cells: Grid::from_fn(width, height, |x, y| word(tile.values[(x, y)])),
        framed: framed.collect(),
    }
}

fn word(value: f32) -> Cell {
    if value.is_finite() { Cell::Given(brief(value)) } else { Cell::Unknown }
}

/// What the differences of pixels are printed as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Their magnitudes.
    Absolute,
    /// Their squares.
    Squared,
    /// With their signs: the first of these windows minus the second.
    Signed(&'static str, &'static str),
}

impl Kind {
    /// What is asked for, with the sums of rows or without.
    fn task(self, has_sums: bool) -> String {
        let differences = match self {
            Self::Absolute => "absolute differences".to_owned(),
            Self::Squared => "squared differences".to_owned(),
            Self::Signed(one, other) => format!("differences ({one} − {other})"),
        };
        let sums = if self.has_signs() { "the sums Σ of their magnitudes" } else { "their sums Σ" };
        let and_sums = format!(", {sums} by row, and with the other pixels the costs");
        format!("Compute the empty {differences}{}.", if has_sums { and_sums.as_str() } else { "" })
    }

    /// What is known of `count` pixels that are not printed.
    fn rest(self, sum: f32, count: usize) -> String {
        let of_what = if self.has_signs() { "of the magnitudes at" } else { "over" };
        format!("Sum {of_what} the other {count} pixels: {}", number(sum))
    }

    fn has_signs(self) -> bool {
        matches!(self, Self::Signed(..))
    }
}

/// Windows of which one has the differences of two others.
struct Computed<'a> {
    tiles: &'a [Tile],
    /// The index of that one.
    index: usize,
    /// What that one has.
    kind: Kind,
    sums: Option<Sums>,
}

/// Sums of the differences without their signs, where the sum of all is a result of the step.
struct Sums {
    total: f32,
    rows: Vec<f32>,
    /// The sum and the number of pixels that are not printed.
    others: (f32, usize),
}

impl<'a> Computed<'a> {
    fn of(tiles: &'a [Tile], values: &[String]) -> Option<Self> {
        let (index, kind) = differences(tiles)?;
        let mut computed = Self { tiles, index, kind, sums: None };
        let cells = &computed.difference().values;
        let sum = |cells: &mut dyn Iterator<Item = f32>| cells.map(f32::abs).sum::<f32>();
        let total = sum(&mut cells.cells().iter().copied());
        if !total.is_finite() || !values.contains(&number(total)) {
            return Some(computed);
        }
        let (width, height) = computed.printed();
        let rows: Vec<f32> = (0..height).map(|y| sum(&mut (0..width).map(|x| cells[(x, y)]))).collect();
        let others = (total - rows.iter().sum::<f32>(), cells.cells().len() - width * height);
        computed.sums = Some(Sums { total, rows, others });
        Some(computed)
    }

    fn difference(&self) -> &'a Tile {
        &self.tiles[self.index]
    }

    /// The size of the part that is printed.
    fn printed(&self) -> (usize, usize) {
        let (width, height) = self.difference().values.size();
        (width.min(MOST_PIXELS), height.min(MOST_PIXELS))
    }

    fn rest(&self) -> Option<Math> {
        let (sum, count) = self.sums.as_ref()?.others;
        (count > 0).then(|| Math::text(self.kind.rest(sum, count)))
    }

    /// The differences and their sums with some `rows` left out, and what is left out.
    fn table(&self, rows: Rows, fill: Fill) -> (Table, Vec<String>) {
        let tile = self.difference();
        let (width, height) = self.printed();
        let first = if rows == Rows::All { 0 } else { height.saturating_sub(1) };
        let value = |x: usize, y: usize| match &self.sums {
            Some(sums) if x == width => sums.rows[y],
            _ => tile.values[(x, y)],
        };
        let columns = width + usize::from(self.sums.is_some());
        let cell = |x: usize, y: usize| match (word(value(x, y)), fill) {
            (Cell::Given(_), Fill::Blank) if y >= first => Cell::Blank,
            (Cell::Given(text), Fill::Answer) if y >= first => Cell::Answer(text),
            (given, _) => given,
        };
        let asked = (first..height).flat_map(|y| (0..columns).map(move |x| (x, y)));
        let answers = asked.map(|(x, y)| value(x, y)).filter(|value| value.is_finite()).map(brief).collect();
        let heads = || (0..width).map(|_| String::new()).chain(["Σ".to_owned()]).collect();
        let table = Table {
            title: tile.label.to_owned(),
            columns: if self.sums.is_some() { heads() } else { Vec::new() },
            rows: Vec::new(),
            cells: Grid::from_fn(columns, height, cell),
            framed: Vec::new(),
        };
        (table, answers)
    }
}

/// The index of the window that has the differences of the first two others, and which kind of them.
fn differences(tiles: &[Tile]) -> Option<(usize, Kind)> {
    /// A kind of differences, and how one follows from that of two pixels.
    type Way = (Kind, fn(f32) -> f32);
    /// What a difference is shown rounded to.
    const SAME: f32 = 0.05;
    let size = tiles.first()?.values.size();
    let is_same_size = |tile: &&Tile| tile.values.size() == size;
    let index = tiles.iter().position(|tile| tile.role == Some(Role::Error) && is_same_size(&tile))?;
    let result = &tiles[index];
    let others: Vec<&Tile> = tiles.iter().filter(|tile| is_same_size(tile) && !std::ptr::eq(*tile, result)).collect();
    let [a, b, ..] = &others[..] else { return None };
    let signed: [Way; 2] = [(Kind::Signed(a.label, b.label), |d| d), (Kind::Signed(b.label, a.label), |d| -d)];
    let unsigned: [Way; 2] = [(Kind::Absolute, f32::abs), (Kind::Squared, |d| d * d)];
    // Where all differences are positive only the range tells whether others could be negative.
    let ways = if result.range[0] < 0.0 { signed } else { unsigned };
    let pairs = || a.values.cells().iter().zip(b.values.cells()).zip(result.values.cells());
    let is_way = |(_, way): &Way| {
        pairs().filter(|(_, result)| result.is_finite()).all(|((a, b), result)| (way(a - b) - result).abs() < SAME)
    };
    ways.into_iter().find(is_way).map(|(kind, _)| (index, kind))
}

/// A candidate before the one at hand.
#[derive(Clone, Copy)]
struct Candidate<'a> {
    step: &'a Step,
    displacement: [i32; 2],
    /// The name of its cost.
    title: &'static str,
}

/// The displacement that a step tests, with the cost surface.
fn tested(step: &Step) -> Option<([i32; 2], &Surface)> {
    let surface = surface_of(step)?;
    Some((surface.probe?, surface))
}

/// Candidates of the same block in `earlier` steps whose costs do not stand on the sheet of the one at hand, with these.
fn candidates<'a>(own_step: &Step, earlier: &'a [Step], at_hand: &Computed<'_>) -> Vec<(Candidate<'a>, String)> {
    let Some((own, _)) = tested(own_step).filter(|_| at_hand.sums.is_some()) else { return Vec::new() };
    let told = own_step.facts().iter().flat_map(|fact| numbers::of(&fact.value));
    let of_lines = own_step.formulas().iter().flat_map(|line| numbers::of(&line.plain()));
    let told: Vec<String> = told.chain(of_lines).collect();
    let mut found: Vec<(Candidate<'a>, String)> = Vec::new();
    for step in earlier {
        let Some((displacement, surface)) = tested(step) else { continue };
        let is_other = displacement != own && found.iter().all(|(other, _)| other.displacement != displacement);
        let is_of_block = is_same_block(step, own_step);
        let Some(cost) = cost(surface, displacement).map(number) else { continue };
        if !is_other || !is_of_block || told.contains(&cost) || found.len() == MOST_EARLIER {
            continue;
        }
        let is_computed = Computed::of(tiles_of(step), std::slice::from_ref(&cost)).is_some_and(|of| of.sums.is_some());
        if is_computed {
            found.push((Candidate { step, displacement, title: surface.title }, cost));
        }
    }
    found
}

/// Whether steps are about the same block: what comes first of their numbers and windows is the same.
pub fn is_same_block(a: &Step, b: &Step) -> bool {
    let is_same_window = tiles_of(a).first().map(|tile| &tile.values) == tiles_of(b).first().map(|tile| &tile.values);
    a.facts().first() == b.facts().first() && is_same_window
}

fn tiles_of(step: &Step) -> &[Tile] {
    find(step, |readout| if let Readout::Tiles(tiles) = readout { Some(tiles.as_slice()) } else { None })
        .unwrap_or_default()
}

/// The cost surface of a step.
pub fn surface_of(step: &Step) -> Option<&Surface> {
    find(step, |readout| if let Readout::Surface(surface) = readout { Some(surface) } else { None })
}

#[cfg(test)]
mod tests {
    use motionscope_core::scene::{Fact, Sentence};

    use super::*;

    motionscope_core::pseudocode! {
        TEST: "test a candidate",
    }

    /// A step that tests `probe`, whose block has this gray level and whose candidate has larger ones by `off`.
    fn step(probe: [i32; 2], (gray, off): (f32, f32), told: &str) -> Step {
        let tile = |label, role, f: &dyn Fn(usize) -> f32| Tile {
            label,
            role: Some(role),
            values: Grid::from_fn(6, 5, |x, _| f(x)),
            range: [0.0, 255.0],
            framed: Vec::new(),
        };
        let difference = |x: usize| off + x as f32;
        let tiles = vec![
            tile("block", Role::Reference, &|_| gray),
            tile("candidate", Role::Candidate, &|x| gray + difference(x)),
            tile("|difference|", Role::Error, &difference),
        ];
        let total = 30.0 * off + 75.0;
        let values = Grid::from_fn(5, 5, |x, y| if [x as i32 - 2, y as i32 - 2] == probe { total } else { f32::NAN });
        let events = Grid::new(5, 5, None);
        let surface = Surface { probe: Some(probe), ..Surface::new("SAD", [-2; 2], values, events) };
        let facts = vec![Fact::new("Block", "1 of 4", None), Fact::new("Best so far", told, None)];
        let readouts = vec![Readout::Facts(facts), Readout::Tiles(tiles), Readout::Surface(surface)];
        Step { values: Vec::new(), line: line::TEST, sentence: Sentence::default(), readouts }
    }

    fn sheet(earlier: &[Step], told: &str, fill: Fill) -> Pixels {
        let step = step([1, 0], (50.0, 4.0), told);
        pixels(&step, earlier, &["195".to_owned()], fill).expect("windows")
    }

    #[test]
    fn the_corner_of_each_candidate_and_the_sum_of_the_rest_give_its_cost() {
        let earlier = [step([0, 0], (50.0, 2.0), ""), step([-1, 0], (50.0, 3.0), ""), step([-2, 0], (50.0, 5.0), "")];
        let pixels = sheet(&earlier, "", Fill::Blank);
        assert_eq!((pixels.earlier.clone(), pixels.windows.len()), (vec![[0, 0], [-1, 0]], 3));
        assert_eq!(pixels.totals, ["195", "135", "165"]);
        assert!(pixels.part.as_ref().is_some_and(|part| part.contains("4×4") && part.contains("6×5 window")));
        let rest = rest_of(&pixels);
        assert_eq!(rest[0], "Sum over the other 14 pixels: 107", "the rows have 22 each");
        let task = "Compute the empty absolute differences, their sums Σ by row, and with the other pixels the costs.";
        assert_eq!(pixels.task, task);
        assert!(rest.iter().all(|line| !line.contains("135") && !line.contains("165")), "{rest:?}");
        let blanks = |index: usize| {
            let table = pixels.windows[index].tables.last().expect("differences");
            table.cells.cells().iter().filter(|cell| **cell == Cell::Blank).count()
        };
        assert_eq!([0, 1, 2].map(blanks), [20, 5, 5]);
        let solved = sheet(&earlier, "", Fill::Answer);
        let lines = rest_of(&solved);
        assert!(lines.contains(&"SAD at (0, 0) = 135".to_owned()), "{lines:?}");
        let names: Vec<&str> = solved.windows[1].tables.iter().map(|table| table.title.as_str()).collect();
        assert_eq!(names, ["block", "candidate (0, 0)", "|difference|"]);
    }

    #[test]
    fn candidates_of_another_block_and_those_whose_costs_are_printed_are_not_asked_for() {
        let others = [step([0, 0], (60.0, 2.0), ""), step([-1, 0], (50.0, 3.0), "")];
        assert_eq!(sheet(&others, "165 at (−1, 0)", Fill::Blank).earlier, Vec::<[i32; 2]>::new());
        assert_eq!(sheet(&others, "", Fill::Blank).earlier, [[-1, 0]]);
        let unknown = pixels(&others[0], &[], &["7".to_owned()], Fill::Blank).expect("windows");
        assert_eq!(unknown.task, "Compute the empty absolute differences.", "the cost is no sum of these");
        assert!(unknown.totals.is_empty());
    }

    /// A step whose differences are shown in this `range` as something else, and lead to a `cost`.
    fn shown_as(change: fn(f32) -> f32, range: [f32; 2], cost: &str) -> Pixels {
        let mut step = step([1, 0], (50.0, 4.0), "");
        for readout in &mut step.readouts {
            if let Readout::Tiles(tiles) = readout {
                tiles[2].values = tiles[2].values.map(|value| change(*value));
                tiles[2].range = range;
            }
        }
        pixels(&step, &[], &[cost.to_owned()], Fill::Answer).expect("windows")
    }

    fn rest_of(pixels: &Pixels) -> Vec<String> {
        pixels.windows.iter().flat_map(|windows| &windows.rest).map(Math::plain).collect()
    }

    #[test]
    fn differences_with_signs_have_an_order_and_are_added_without_their_signs() {
        for (sign, order) in [(1.0, "candidate − block"), (-1.0, "block − candidate")] {
            let change: fn(f32) -> f32 = if sign > 0.0 { |d| d } else { |d| -d };
            let pixels = shown_as(change, [-64.0, 64.0], "195");
            let sums = "the sums Σ of their magnitudes by row, and with the other pixels the costs";
            assert_eq!(pixels.task, format!("Compute the empty differences ({order}), {sums}."));
            assert_eq!(rest_of(&pixels), ["Sum of the magnitudes at the other 14 pixels: 107"]);
            assert!(pixels.answers.contains(&number(change(4.0))) && pixels.answers.contains(&"22".to_owned()));
            let without = shown_as(change, [-64.0, 64.0], "7");
            assert_eq!(without.task, format!("Compute the empty differences ({order})."));
        }
    }

    #[test]
    fn squares_are_asked_for_as_such() {
        let pixels = shown_as(|d| d * d, [0.0, 65_025.0], "1355");
        let task = "Compute the empty squared differences, their sums Σ by row, and with the other pixels the costs.";
        assert_eq!(pixels.task, task);
        assert_eq!(rest_of(&pixels), ["Sum over the other 14 pixels: 851"]);
    }

    #[test]
    fn what_is_no_difference_of_pixels_is_not_asked_for() {
        let mut step = step([0, 0], (50.0, 2.0), "");
        for readout in &mut step.readouts {
            if let Readout::Tiles(tiles) = readout {
                tiles[2].values = tiles[2].values.map(|value| 3.0 * value);
            }
        }
        let pixels = pixels(&step, &[], &[], Fill::Blank).expect("small windows are printed");
        assert!(pixels.task == GIVEN && pixels.answers.is_empty());
    }
}
