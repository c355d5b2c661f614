//! Costs of a worksheet as a table: small enough to be computed by hand.

use motionscope_core::geometry::Grid;
use motionscope_core::scene::{Math, Surface};

use super::numbers::{self, Fill, filled};
use super::windows::Pixels;
use crate::paint::charts::heat_map::{cost, optimum_words};
use crate::paint::charts::table::{Cell, Table};
use crate::paint::number;

/// Displacements around the current one.
const AROUND: [i32; 2] = [3, 2];

/// The tables of a step.
#[derive(Clone, Debug, Default)]
pub struct Grids {
    /// Windows of pixels.
    pub tiles: Option<Pixels>,
    /// The costs around the current displacement.
    pub surface: Option<Costs>,
}

/// A table, and what it has: words that may need more room than it does.
#[derive(Clone, Debug, PartialEq)]
pub struct Captioned {
    /// What it has.
    pub caption: String,
    /// The table, without a title.
    pub table: Table,
}

/// Costs by displacement.
#[derive(Clone, Debug)]
pub struct Costs {
    /// The costs.
    pub costs: Captioned,
    /// Which is the best, and where.
    pub best: Option<Math>,
    /// What is asked for.
    pub task: &'static str,
}

/// Which costs of a surface are left out, and what is known before.
#[derive(Clone, Copy)]
pub struct Missing<'a> {
    /// The displacements whose costs can be computed.
    pub at: &'a [[i32; 2]],
    /// The surface before the candidate at hand, where it is decided about that.
    pub before: Option<&'a Surface>,
    /// Whether it is decided about the candidate at hand: what is best now is not told.
    pub is_decided: bool,
}

/// The costs around the displacement under test, or the best one, with those `missing` left out; and what that is.
pub fn costs(surface: &Surface, missing: Missing<'_>, fill: Fill) -> (Option<Costs>, Vec<String>) {
    let Some(center) = surface.probe.or(surface.best) else { return (None, Vec::new()) };
    let last = [surface.values.width(), surface.values.height()];
    let ends = [0, 1].map(|i| {
        let (from, to) = (surface.origin[i], surface.origin[i] + last[i] as i32 - 1);
        [(center[i] - AROUND[i]).max(from), (center[i] + AROUND[i]).min(to)]
    });
    let [us, vs]: [Vec<i32>; 2] = ends.map(|[from, to]| (from..=to).collect());
    let mut answers = Vec::new();
    let cells = Grid::from_fn(us.len(), vs.len(), |x, y| {
        let at = [us[x], vs[y]];
        let Some(text) = cost(surface, at).map(number) else { return Cell::Unknown };
        if !missing.at.contains(&at) {
            return Cell::Given(text);
        }
        answers.push(text.clone());
        if fill == Fill::Blank { Cell::Blank } else { Cell::Answer(text) }
    });
    if cells.cells().iter().all(|cell| *cell == Cell::Unknown) {
        return (None, Vec::new());
    }
    let words = |all: &[i32]| all.iter().map(|c| number(*c as f32)).collect();
    let (columns, rows) = (words(&us), words(&vs));
    let table = Table { title: String::new(), columns, rows, cells, framed: Vec::new() };
    let caption = format!("{} by displacement: u to the right, v down.", surface.title);
    let has_blanks = !answers.is_empty();
    // The best one before the candidate under test is given.
    let is_asked = has_blanks && surface.probe.is_none_or(|probe| surface.best.is_none_or(|best| best == probe));
    let best = match missing.is_decided {
        true => {
            let before = missing.before.and_then(optimum_words);
            before.map(|words| Math::text(format!("Before this candidate: {words}")))
        }
        false => optimum_words(surface).map(|words| {
            answers.extend(numbers::of(&words).into_iter().filter(|_| is_asked));
            filled(&format!("So far: {words}"), None, fill, &|_| is_asked)
        }),
    };
    let task = match (has_blanks, is_asked && !missing.is_decided, surface.is_similarity) {
        (true, true, false) => "Enter the missing costs and find the displacement of minimum cost.",
        (true, true, true) => "Enter the missing values and find the displacement of maximum similarity.",
        (true, false, false) => "Enter the missing costs.",
        (true, false, true) => "Enter the missing values.",
        (false, _, false) => "Costs around the current displacement",
        (false, _, true) => "Similarities around the current displacement",
    };
    (Some(Costs { costs: Captioned { caption, table }, best, task }), answers)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A surface whose costs are the numbers of their cells, with a probe that is the best.
    fn surface(probe: [i32; 2]) -> Surface {
        let values = Grid::from_fn(9, 7, |x, y| if [x, y] == [4, 3] { 99.0 } else { 197.0 });
        let events = Grid::new(9, 7, Some(1));
        Surface { probe: Some(probe), best: Some([0, 0]), ..Surface::new("SAD", [-4, -3], values, events) }
    }

    fn blanks(costs: &Costs) -> usize {
        costs.costs.table.cells.cells().iter().filter(|cell| **cell == Cell::Blank).count()
    }

    #[test]
    fn costs_are_missing_where_they_can_be_computed_and_not_where_they_are_equal_by_chance() {
        let at = [[1, 1], [0, 1]];
        let missing = Missing { at: &at, before: None, is_decided: false };
        let (costs, answers) = costs(&surface([1, 1]), missing, Fill::Blank);
        let costs = costs.expect("costs");
        assert_eq!((blanks(&costs), answers), (2, vec!["197".to_owned(); 2]));
        assert_eq!(costs.task, "Enter the missing costs.");
        assert!(costs.costs.caption.ends_with("v down.") && costs.costs.table.title.is_empty(), "a title would be cut");
        assert_eq!(costs.best.map(|best| best.plain()), Some("So far: minimum 99 at (0, 0)".to_owned()));
    }

    #[test]
    fn given_costs_and_similarities_are_called_so() {
        let task = |is_similarity| {
            let surface = Surface { is_similarity, ..surface([1, 1]) };
            let missing = Missing { at: &[], before: None, is_decided: false };
            costs(&surface, missing, Fill::Blank).0.expect("a table").task
        };
        assert_eq!(task(false), "Costs around the current displacement");
        assert_eq!(task(true), "Similarities around the current displacement");
    }

    #[test]
    fn what_is_best_is_not_told_where_it_is_decided() {
        let at = [[0, 0]];
        let before = Surface { values: Grid::new(9, 7, 197.0), ..surface([-1, 0]) };
        let told = |before| {
            let missing = Missing { at: &at, before, is_decided: true };
            let (costs, answers) = costs(&surface([0, 0]), missing, Fill::Blank);
            assert_eq!(answers, ["99"]);
            costs.expect("costs").best.map(|best| best.plain())
        };
        assert_eq!(told(None), None);
        let words = told(Some(&before)).expect("the best before");
        assert!(words.starts_with("Before this candidate: minimum 197") && !words.contains("99"), "{words}");
    }
}
