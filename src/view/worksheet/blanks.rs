//! What is left out of a step on a worksheet, and what is given.

use std::collections::BTreeSet;

use motionscope_core::scene::{Fact, Math, Matrix, Plane, Readout, Regions, Surface, Tile};
use motionscope_core::{Grid, Role, Step};

use super::equation::{defined, exercise};
use super::grids::{self, Grids};
use super::numbers::{self, Fill, filled, is_telling};
use crate::paint::charts::explanation::{equation_of, facts_of};
use crate::paint::charts::matrices::entries;
use crate::view::panes::find;

/// The most entries of a matrix that are left out: more are the same work again.
const MOST_ENTRIES: usize = 4;
/// A matrix of at most so many entries is left out as a whole.
const SMALL_MATRIX: usize = 4;

/// The parts of a step with numbers left out or filled in.
#[derive(Clone, Debug, Default)]
pub struct Exercise {
    /// Labels with their values.
    pub facts: Vec<Math>,
    /// The formulas.
    pub equation: Vec<Math>,
    /// The matrices.
    pub matrices: Vec<Matrix>,
    /// Matrices as they were before the step, where it changes them.
    pub before: Vec<Matrix>,
    /// Pixels and costs.
    pub grids: Grids,
    /// The plane of displacements without what is to be drawn into it, with the names of that.
    pub plane: Option<(Plane, Vec<String>)>,
    /// The regions of a decision, in the same way.
    pub regions: Option<(Regions, Vec<String>)>,
    /// What is left out.
    pub answers: Vec<Answer>,
}

/// The parts that have numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The labelled numbers.
    Facts,
    /// The formulas.
    Equation,
    /// The matrices.
    Matrices,
    /// The pixels.
    Tiles,
    /// The costs.
    Surface,
}

/// A number that is left out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// Where.
    pub part: Part,
    /// The number.
    pub number: String,
}

impl Exercise {
    /// The exercise of `step`, which follows `before`.
    pub fn of(step: &Step, before: Option<&Step>, fill: Fill) -> Self {
        let mut all = Self::default();
        let lines = equation_of(step);
        all.add_matrices(step, before, fill);
        let known = all.numbers();
        let equation = exercise(lines, &known, fill);
        all.equation = equation.lines;
        all.add(Part::Equation, equation.answers.into_iter().map(|(_, number)| number));
        let known = all.numbers();
        let tiles: &[Tile] = find(step, |readout| match readout {
            Readout::Tiles(tiles) => Some(tiles.as_slice()),
            _ => None,
        })
        .unwrap_or_default();
        let surface: Option<&Surface> = find(step, |readout| match readout {
            Readout::Surface(surface) => Some(surface),
            _ => None,
        });
        let (tiles, of_tiles) = grids::pixels(tiles, &known, fill);
        all.add(Part::Tiles, of_tiles);
        let (surface, of_surface) = surface.map(|surface| grids::costs(surface, &known, fill)).unwrap_or_default();
        all.add(Part::Surface, of_surface);
        let series = find(step, |readout| if let Readout::Series(series) = readout { Some(series) } else { None });
        all.grids = Grids { tiles, surface, histogram: series.and_then(grids::histogram) };
        all.add_drawings(step, fill);
        all.add_facts(facts_of(step), fill);
        all
    }

    /// Whether there is anything to be computed or drawn.
    pub fn is_empty(&self) -> bool {
        self.answers.is_empty() && self.plane.is_none() && self.regions.is_none()
    }

    /// The numbers that are left out so far.
    fn numbers(&self) -> Vec<String> {
        self.answers.iter().map(|answer| answer.number.clone()).collect()
    }

    fn add(&mut self, part: Part, numbers: impl IntoIterator<Item = String>) {
        self.answers.extend(numbers.into_iter().map(|number| Answer { part, number }));
    }

    fn add_matrices(&mut self, step: &Step, before: Option<&Step>, fill: Fill) {
        let all = matrices_of(step);
        let (results, chosen) = results_of(all, &defined(equation_of(step)));
        let hide =
            |matrix: &Matrix| {
                let words = entries(matrix);
                let is_chosen = |x: usize, y: usize| chosen.contains(&words[(x, y)]);
                let (width, height) = words.size();
                let mut matrix = matrix.clone();
                match fill {
                    Fill::Blank => {
                        matrix.entries = Grid::from_fn(width, height, |x, y| {
                            if is_chosen(x, y) { f64::NAN } else { matrix.entries[(x, y)] }
                        });
                        matrix.changed = None;
                    }
                    Fill::Answer => matrix.changed = Some(Grid::from_fn(width, height, is_chosen)),
                }
                matrix
            };
        self.matrices = all
            .iter()
            .enumerate()
            .map(
                |(index, matrix)| {
                    if results.contains(&index) { hide(matrix) } else { Matrix { changed: None, ..matrix.clone() } }
                },
            )
            .collect();
        let earlier = before.map(matrices_of).unwrap_or_default();
        let of_before = |index: &usize| {
            let now = &all[*index];
            let other = earlier.iter().find(|other| other.symbol == now.symbol && other.name == now.name)?;
            let is_other = other.entries.size() == now.entries.size() && other.entries != now.entries;
            is_other.then(|| Matrix { changed: None, ..other.clone() })
        };
        self.before = results.iter().filter_map(of_before).collect();
        self.add(Part::Matrices, chosen);
    }

    fn add_drawings(&mut self, step: &Step, fill: Fill) {
        let plane = find(step, |readout| if let Readout::Plane(plane) = readout { Some(plane) } else { None });
        let is_result = |role: Role| matches!(role, Role::Result | Role::Estimate);
        self.plane = plane.and_then(|plane| {
            let results: Vec<_> = plane.points.iter().filter(|(_, role, _)| is_result(*role)).collect();
            let names: Vec<String> = results.iter().map(|(name, ..)| (*name).to_owned()).collect();
            let left = Plane {
                cost: None,
                ellipse: None,
                path: Vec::new(),
                points: plane
                    .points
                    .iter()
                    .filter(|(_, role, _)| !is_result(*role) && *role != Role::Truth)
                    .copied()
                    .collect(),
                ..plane.clone()
            };
            let shown = if fill == Fill::Blank { left } else { plane.clone() };
            (!names.is_empty()).then_some((shown, names))
        });
        let regions = find(step, |readout| if let Readout::Regions(regions) = readout { Some(regions) } else { None });
        self.regions = regions.filter(|regions| !regions.points.is_empty()).map(|regions| {
            let names = regions.points.iter().map(|(name, ..)| name.clone()).collect();
            let points = if fill == Fill::Blank { Vec::new() } else { regions.points.clone() };
            (Regions { points, ..regions.clone() }, names)
        });
    }

    /// Leaves out the results among labelled numbers, and what is left out elsewhere.
    fn add_facts(&mut self, facts: &[Fact], fill: Fill) {
        let known = self.numbers();
        let is_known = |number: &str| is_telling(number) && known.iter().any(|other| other == number);
        // Where nothing else is computed, what is best so far is the result.
        let results: &[Role] = match self.answers.is_empty() {
            false => &[Role::Result],
            true => &[Role::Result, Role::Best, Role::Estimate, Role::Candidate],
        };
        let mut answers = Vec::new();
        for fact in facts {
            // What is compared with the truth would tell the result.
            if fill == Fill::Blank && matches!(fact.role, Some(Role::Truth | Role::Error)) {
                continue;
            }
            // A value that is nothing but a result tells it, however few its digits.
            let is_told = known.contains(&fact.value);
            let is_result = is_told || fact.role.is_some_and(|role| results.contains(&role));
            let chosen = |number: &str| is_result || is_known(number);
            answers.extend(numbers::of(&fact.value).into_iter().filter(|number| chosen(number)));
            let label = Math::text(format!("{}: ", fact.label));
            self.facts.push(Math::Row(vec![label, filled(&fact.value, None, fill, &chosen)]));
        }
        self.add(Part::Facts, answers);
    }
}

/// The matrices that a step computes, by their indices, and the texts of the entries that are left out: those that no given
/// matrix has.
fn results_of(all: &[Matrix], defined: &[String]) -> (Vec<usize>, Vec<String>) {
    let plain = |symbol: &str| symbol.replace(' ', "");
    let is_defined = |matrix: &&Matrix| defined.iter().any(|symbol| plain(symbol) == plain(matrix.symbol));
    let has_changed = |matrix: &&Matrix| matrix.changed.as_ref().is_some_and(|grid| grid.cells().contains(&true));
    let is_result = |matrix: &&Matrix| matches!(matrix.role, Some(Role::Result | Role::Estimate));
    let of = |is: &dyn Fn(&&Matrix) -> bool| -> Vec<usize> { (0..all.len()).filter(|i| is(&&all[*i])).collect() };
    let ways = [of(&is_defined), of(&has_changed), of(&is_result)];
    let results = ways.into_iter().find(|way| !way.is_empty()).unwrap_or_default();
    let given: BTreeSet<String> = (0..all.len())
        .filter(|index| !results.contains(index))
        .flat_map(|index| entries(&all[index]).cells().to_vec())
        .collect();
    let mut chosen: Vec<String> = Vec::new();
    for index in &results {
        let words = entries(&all[*index]);
        let changed = all[*index].changed.as_ref().filter(|grid| grid.cells().contains(&true));
        let is_nothing = |word: &str| numbers::of(word).is_empty() || word == "0";
        let cells = words.cells().iter().zip(0..).filter(|(_, place)| changed.is_none_or(|grid| grid.cells()[*place]));
        let free = cells.map(|(word, _)| word).filter(|word| !is_nothing(word) && !given.contains(*word));
        let most = if words.cells().len() <= SMALL_MATRIX { SMALL_MATRIX } else { MOST_ENTRIES };
        let mut count = 0;
        for word in free {
            if count < most && !chosen.contains(word) {
                chosen.push(word.clone());
                count += 1;
            }
        }
    }
    (results, chosen)
}

fn matrices_of(step: &Step) -> &[Matrix] {
    find(step, |readout| if let Readout::Matrices(all) = readout { Some(all.as_slice()) } else { None })
        .unwrap_or_default()
}
