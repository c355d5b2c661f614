//! What is left out of a step on a worksheet, and what is given.

use std::collections::BTreeSet;

use motionscope_core::geometry::Grid;
use motionscope_core::scene::{Math, Matrix, Plane, Question, Readout, Regions, Role, Step};

use super::decision::Decision;
use super::equation::{self, Defined, defined, exercise, values};
use super::facts::Elsewhere;
use super::grids::{self, Grids, Missing};
use super::numbers::{self, Fill, is_telling, tells};
use super::reach::{Printed, is_small};
use super::windows::{self, Pixels, surface_of};
use crate::paint::charts::heat_map::cost;
use crate::paint::charts::matrices::entries;
use crate::paint::number;
use crate::view::panes::find;

/// The most entries of a matrix that are left out: more are the same work again.
const MOST_ENTRIES: usize = 4;
/// A matrix of at most so many entries is left out as a whole.
const SMALL_MATRIX: usize = 4;
/// Nearer to each other, as a share of the reach of a plane, two points are the same to the eye.
const BESIDE: f32 = 0.02;

/// The step that is asked for.
#[derive(Clone, Copy)]
pub struct Asked<'a> {
    /// The step.
    pub step: &'a Step,
    /// The unit of the run that it belongs to, from 0.
    pub unit: usize,
    /// The steps before it, latest first.
    pub earlier: &'a [Step],
    /// The questions of its estimator.
    pub questions: &'a [Question],
}

/// The parts of a step with numbers left out or filled in.
#[derive(Clone, Debug, Default)]
pub struct Exercise {
    /// Labels with their values.
    pub facts: Vec<Math>,
    /// The formulas.
    pub equation: equation::Exercise,
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
    /// What is decided.
    pub decision: Option<Decision>,
    /// Whether the line of the algorithm is asked for, since nothing else can be.
    pub asks_line: bool,
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
    /// The exercise of a step: what can be computed by hand, drawn or decided.
    pub fn of(asked: &Asked<'_>, fill: Fill) -> Self {
        let Asked { step, unit, earlier, questions } = *asked;
        let lines = step.formulas();
        let mut all = Self { decision: Decision::of(questions, (step, unit)), ..Self::default() };
        let pixels = windows::pixels(step, earlier, &values(lines), fill);
        let printed = printed(step, pixels.as_ref());
        all.add_matrices(step, earlier.first(), fill);
        let known = all.numbers();
        all.equation = exercise(lines, (&known, &printed), fill);
        let left_out = exercise(lines, (&known, &printed), Fill::Blank).lines;
        let given: Vec<String> = left_out.iter().flat_map(|line| numbers::of(&line.plain())).collect();
        all.add(Part::Equation, all.equation.answers.clone().into_iter().map(|(_, number)| number));
        all.hide_told(matrices_of(step), fill);
        all.grids = Grids { tiles: pixels, surface: None };
        let of_tiles = all.grids.tiles.as_ref().map(|pixels| pixels.answers.clone()).unwrap_or_default();
        all.add(Part::Tiles, of_tiles);
        all.add_costs(asked, fill);
        all.add_drawings(step, fill);
        all.add_facts(asked, &given, fill);
        all.asks_line = all.is_empty() && !(lines.is_empty() && matrices_of(step).is_empty());
        all
    }

    /// How many different numbers are asked for.
    pub fn count(&self) -> usize {
        let answers = self.answers.iter().map(|answer| answer.number.as_str());
        answers.filter(|answer| !numbers::of(answer).is_empty()).collect::<BTreeSet<_>>().len()
    }

    /// Whether a number with decimals is asked for.
    pub fn asks_decimals(&self) -> bool {
        let mut all = self.answers.iter().flat_map(|answer| numbers::of(&answer.number));
        all.any(|number| number.contains('.'))
    }

    /// Whether there is nothing to be computed, drawn or decided.
    pub fn is_empty(&self) -> bool {
        let has_drawings = self.plane.is_some() || self.regions.is_some();
        self.answers.is_empty() && !has_drawings && self.decision.is_none() && !self.asks_line
    }

    /// Leaves out costs of the surface that the formulas and the windows lead to.
    fn add_costs(&mut self, asked: &Asked<'_>, fill: Fill) {
        let Some(surface) = surface_of(asked.step) else { return };
        let known = self.numbers();
        let center = surface.probe.or(surface.best);
        let is_computed = |at: &[i32; 2]| {
            let text = cost(surface, *at).map(number);
            let is_result = text.is_some_and(|text| is_telling(&text) && known.contains(&text));
            is_result || surface.probe.is_some() && !self.equation.answers.is_empty()
        };
        let earlier = self.grids.tiles.iter().flat_map(|pixels| pixels.earlier.iter().copied());
        let at: Vec<[i32; 2]> = center.filter(is_computed).into_iter().chain(earlier).collect();
        let is_decided = self.decision.is_some() && surface.probe.is_some();
        // Costs of another block do not tell what is best of this one.
        let of_block = asked.earlier.first().filter(|before| windows::is_same_block(before, asked.step));
        let before = of_block.and_then(surface_of);
        let (costs, answers) = grids::costs(surface, Missing { at: &at, before, is_decided }, fill);
        self.grids.surface = costs;
        self.add(Part::Surface, answers);
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
        let (results, chosen) = results_of(all, &defined(step.formulas()));
        // Where nothing is computed nothing has to be known before.
        let changed = if results.is_empty() { 0 } else { all.len() };
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
        let of_before = |now: &Matrix| {
            let is_same = |other: &&Matrix| other.symbol == now.symbol && other.name == now.name;
            // A prediction has a minus sign, as P⁻ beside P.
            let bare = |matrix: &Matrix| matrix.symbol.trim_end_matches('⁻');
            let is_shown = |other: &Matrix| all.iter().any(|shown| shown.symbol == other.symbol);
            let is_predicted = |other: &&Matrix| bare(other) == bare(now) && !is_shown(other);
            let other = earlier.iter().find(is_same).or_else(|| earlier.iter().find(is_predicted))?;
            let is_other = other.entries.size() == now.entries.size() && other.entries != now.entries;
            is_other.then(|| Matrix { changed: None, ..other.clone() })
        };
        self.before = all[..changed].iter().filter_map(of_before).collect();
        self.add(Part::Matrices, chosen);
    }

    /// Leaves out or fills in the results of the formulas among the entries of `whole` matrices that are given.
    fn hide_told(&mut self, whole: &[Matrix], fill: Fill) {
        let told: Vec<String> = self.equation.answers.iter().map(|(_, number)| number.clone()).collect();
        let mut answers = Vec::new();
        for (matrix, whole) in self.matrices.iter_mut().zip(whole) {
            let words = entries(whole);
            let (width, height) = words.size();
            let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            for place in places.filter(|place| tells(&words[*place], &told)) {
                answers.push(words[place].clone());
                match fill {
                    Fill::Blank => matrix.entries[place] = f64::NAN,
                    Fill::Answer => {
                        matrix.changed.get_or_insert_with(|| Grid::new(width, height, false))[place] = true;
                    }
                }
            }
        }
        self.add(Part::Matrices, answers);
    }

    fn add_drawings(&mut self, step: &Step, fill: Fill) {
        let plane = find(step, |readout| if let Readout::Plane(plane) = readout { Some(plane) } else { None });
        let is_result = |role: Role| matches!(role, Role::Result | Role::Estimate);
        self.plane = plane.and_then(|plane| {
            let results: Vec<_> = plane.points.iter().filter(|(_, role, _)| is_result(*role)).collect();
            let names: Vec<String> = results.iter().map(|(name, ..)| (*name).to_owned()).collect();
            let distance = |a: [f32; 2], b: [f32; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
            // A point beside a result tells it.
            let tells = |at: [f32; 2]| results.iter().any(|(.., to)| distance(at, *to) < BESIDE * plane.reach);
            let left = Plane {
                cost: None,
                ellipse: None,
                path: Vec::new(),
                points: plane
                    .points
                    .iter()
                    .filter(|(_, role, at)| !is_result(*role) && *role != Role::Truth && !tells(*at))
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

    /// Leaves out what is left out elsewhere among labelled numbers, and what would tell it.
    /// A result that is equal to a number `given` in a formula is no secret.
    fn add_facts(&mut self, asked: &Asked<'_>, given: &[String], fill: Fill) {
        let hidden: Vec<String> = self.numbers().into_iter().filter(|number| !given.contains(number)).collect();
        let elsewhere = Elsewhere {
            numbers: &hidden,
            before: asked.earlier.first().map(Step::facts).unwrap_or_default(),
            is_decided: self.decision.is_some(),
            is_test: surface_of(asked.step).is_some_and(|surface| surface.probe.is_some()),
        };
        let (facts, answers) = elsewhere.facts(asked.step.facts(), fill);
        self.facts = facts;
        self.add(Part::Facts, answers);
    }
}

/// What is printed of a step, from which its results can be computed.
fn printed(step: &Step, pixels: Option<&Pixels>) -> Printed {
    let symbols = defined(step.formulas()).into_iter().map(|defined| defined.name);
    Printed {
        names: Printed::names(step.facts(), matrices_of(step), symbols),
        totals: pixels.map(|pixels| pixels.totals.clone()).unwrap_or_default(),
    }
}

/// The matrices that the formulas of a step define, by their indices, and the texts of the entries that are left out: those that no
/// given matrix has. Sums and products of large matrices are no work by hand.
fn results_of(all: &[Matrix], defined: &[Defined]) -> (Vec<usize>, Vec<String>) {
    let plain = |symbol: &str| symbol.replace(' ', "");
    let leads_to = |matrix: &Matrix, one: &Defined| one.is_by_hand && plain(&one.name) == plain(matrix.symbol);
    let is_result =
        |matrix: &Matrix| is_small(matrix.entries.size()) && defined.iter().any(|one| leads_to(matrix, one));
    let results: Vec<usize> = (0..all.len()).filter(|index| is_result(&all[*index])).collect();
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

#[cfg(test)]
mod tests {
    use motionscope_core::scene::{Fact, Reply};

    use super::super::tests::formula;
    use super::*;

    motionscope_core::pseudocode! {
        GATE: "gate the measurement",
    }

    motionscope_core::cases! {
        ACCEPTED: "It is accepted.",
    }

    const REPLIES: &[Reply] = &[Reply::told(line::GATE, case::ACCEPTED, "Yes"), Reply::at(line::GATE, "No")];
    const QUESTION: Question = Question::choice("gate", "Is it inside?", REPLIES);

    fn matrix(symbol: &'static str, side: usize) -> Matrix {
        let entries = Grid::from_fn(side, side, |x, y| (10 * y + x) as f64 + 0.25);
        let (rows, columns) = (Vec::new(), Vec::new());
        Matrix { symbol, name: "", role: None, entries, rows, columns, changed: None, decimals: Some(2) }
    }

    fn step(readouts: Vec<Readout>) -> Step {
        Step::at(line::GATE).say(case::ACCEPTED).show_all(readouts)
    }

    fn exercise(step: &Step, questions: &[Question], fill: Fill) -> Exercise {
        Exercise::of(&Asked { step, unit: 0, earlier: &[], questions }, fill)
    }

    fn plain(lines: &[Math]) -> String {
        lines.iter().map(|line| line.plain() + "\n").collect()
    }

    #[test]
    fn what_tells_the_decision_is_left_out_with_it() {
        let facts = vec![
            Fact::new("NIS", "5.25, gate 9.21", None),
            Fact::new("Status", "accepted", None),
            Fact::new("Eigenvalues", "261.98 and 1.22: edge", None),
            Fact::new("Matches so far", "12", Some(Role::Result)),
        ];
        let lines = vec![formula(r"s = {a} + {a} = {s} \le {b}")];
        let step = step(vec![Readout::Facts(facts), Readout::Equation(lines)]);
        let left_out = exercise(&step, &[QUESTION], Fill::Blank);
        assert!(left_out.decision.as_ref().is_some_and(|decision| decision.choices[decision.right] == "Yes"));
        let shown = plain(&left_out.facts) + &plain(&left_out.equation.lines);
        for told in ["5.25", "accepted", "edge", "Matches", "≤"] {
            assert!(!shown.contains(told), "{told} is told: {shown}");
        }
        assert!(shown.contains("gate 9.21") && shown.contains("261.98 and 1.22"), "{shown}");
        let solved = exercise(&step, &[QUESTION], Fill::Answer);
        let shown = plain(&solved.facts);
        let told = "NIS: 5.25, gate 9.21\nStatus: accepted\nEigenvalues: 261.98 and 1.22: edge\n";
        assert!(shown.contains(told), "{shown}");
        let without = plain(&exercise(&step, &[], Fill::Blank).facts);
        assert!(without.contains("accepted") && without.contains("edge"), "nothing is decided: {without}");
    }

    #[test]
    fn a_value_that_a_formula_gives_stays_though_the_result_is_equal_to_it() {
        let facts = vec![Fact::new("I_t", "5.25", None), Fact::new("Flow", "5.25", Some(Role::Result))];
        let readouts = |formula| vec![Readout::Facts(facts.clone()), Readout::Equation(vec![formula])];
        let shown = |template: &str| {
            let exercise = exercise(&step(readouts(formula(template))), &[], Fill::Blank);
            plain(&exercise.facts) + &plain(&exercise.equation.lines)
        };
        let given = shown("c = {s} - {a} = {s}");
        assert!(given.contains("I_t: 5.25") && !given.contains("Flow: 5.25"), "{given}");
        let asked = shown("c = {a} - {b} = {s}");
        assert!(!asked.contains("5.25"), "{asked}");
    }

    #[test]
    fn a_point_beside_the_result_is_left_out_of_the_plane_with_it() {
        let points = vec![
            ("mean", Role::Predicted, [0.5, 0.0]),
            ("nearest", Role::Candidate, [0.1, 0.201]),
            ("result", Role::Result, [0.1, 0.2]),
        ];
        let plane = Plane {
            title: "",
            unit: "px".into(),
            center: [0.0; 2],
            reach: 1.0,
            cost: None,
            groups: Vec::new(),
            lines: Vec::new(),
            path: Vec::new(),
            points,
            ellipse: None,
        };
        let names = |fill| {
            let (plane, _) = exercise(&step(vec![Readout::Plane(plane.clone())]), &[], fill).plane.expect("a plane");
            plane.points.iter().map(|(name, ..)| *name).collect::<Vec<_>>()
        };
        assert_eq!(names(Fill::Blank), ["mean"]);
        assert_eq!(names(Fill::Answer), ["mean", "nearest", "result"]);
    }

    #[test]
    fn large_matrices_and_sums_are_given() {
        let define = |by: &str| formula(&format!(r"\mathbf{{S}} = {by} \mathbf{{H}}"));
        let asked = |side: usize, by: &str| {
            let readouts = vec![Readout::Equation(vec![define(by)]), Readout::Matrices(vec![matrix("S", side)])];
            let exercise = exercise(&step(readouts), &[], Fill::Blank);
            (exercise.answers.len(), exercise.asks_line)
        };
        assert_eq!(asked(2, "2"), (4, false));
        assert_eq!(asked(6, "2"), (0, true), "only the line can be asked for");
        assert_eq!(asked(2, r"\sum"), (0, true), "a sum over pixels");
        let lines = vec![formula("s = {a} + {b} = {s}")];
        let told = step(vec![Readout::Equation(lines), Readout::Matrices(vec![matrix("P", 6)])]);
        let left_out = exercise(&told, &[], Fill::Blank);
        assert!(left_out.matrices[0].entries[(5, 0)].is_nan(), "a given matrix does not tell a result");
        assert_eq!((left_out.count(), left_out.asks_decimals()), (1, true), "it is asked for once");
        assert_eq!(left_out.matrices[0].entries.cells().iter().filter(|entry| entry.is_nan()).count(), 1);
        let solved = exercise(&told, &[], Fill::Answer);
        assert!(solved.matrices[0].changed.as_ref().is_some_and(|changed| changed[(5, 0)]));
        assert!(exercise(&step(Vec::new()), &[], Fill::Blank).is_empty());
    }
}
