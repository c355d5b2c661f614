//! The k best assignments: K. G. Murty, An algorithm for ranking all the assignments in order of increasing cost, 1968. Each
//! subproblem takes over the solution and the prices of the one that it is part of, and needs a single augmenting path (M. L.
//! Miller, H. S. Stone and I. J. Cox, Optimizing Murty's ranked assignment method, 1997). Several problems are ranked together, as
//! the hypotheses of a scan are (I. J. Cox and S. L. Hingorani, 1996).

use std::cmp::Ordering;
use std::collections::BTreeSet;
use std::ops::Range;

use super::assignment::WorkBudget;

/// The ways in which a row can stay without a column.
pub(crate) const WAYS_ALONE: usize = 2;

/// The assignment of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Choice {
    /// A column, which no other row has.
    Column(usize),
    /// No column, in one of the ways of [`Row::alone`].
    Alone(usize),
}

/// The costs of a row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Its columns with their costs; others are not allowed.
    pub columns: Vec<(usize, f64)>,
    /// The costs of having no column; infinite where a way is not allowed.
    pub alone: [f64; WAYS_ALONE],
}

/// An assignment problem: each row has at most one column, each column at most one row.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The cost of every assignment beside those of its rows.
    pub base: f64,
    /// The number of columns.
    pub columns: usize,
    /// The rows.
    pub rows: Vec<Row>,
}

/// An assignment.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// The index of its problem.
    pub problem: usize,
    /// The assignment of each row.
    pub choices: Vec<Choice>,
    /// Its total cost.
    pub cost: f64,
}

/// Assignments in the order of their costs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ranking {
    /// The best ones.
    pub solutions: Vec<Solution>,
    /// Whether there are more within the allowed excess.
    pub has_more: bool,
    /// Whether the work budget was used up: then some may be missing, and the first of a problem may not be the best.
    pub is_exhausted: bool,
}

/// Returns the `count` assignments of least cost of all problems together, of those that cost at most `excess` more than the best.
/// Of equal costs, the one of the earlier problem and then the one found first comes first.
///
/// No more subproblems are kept than solutions are missing, because each yields one: memory is bounded by `count`. The budget counts the
/// pairs that paths visit and the entries that subproblems copy.
///
/// # Errors
/// If the work is cancelled.
pub fn k_best<E>(
    problems: &[Problem],
    (count, excess): (usize, f64),
    budget: &mut WorkBudget<E>,
) -> Result<Ranking, E> {
    let (mut open, mut ranking, mut scratch) = (BTreeSet::new(), Ranking::default(), Scratch::default());
    for (index, problem) in problems.iter().enumerate() {
        let node = Node::first(index, problem, (&mut scratch, budget))?;
        ranking.is_exhausted |= node.as_ref().is_some_and(|node| node.is_greedy);
        open.extend(node);
    }
    let mut most = open.first().map_or(0.0, |best: &Node| best.cost) + excess;
    let mut serial = 0;
    while let Some(node) = open.pop_first().filter(|node| node.cost <= most) {
        if ranking.solutions.len() == count {
            ranking.has_more = true;
            break;
        }
        // The last one needs none after it, but one more tells whether there are more.
        for row in node.fixed..node.choices.len() {
            if node.is_greedy || ranking.is_exhausted {
                break;
            }
            match node.without(&problems[node.problem], row, most, (&mut scratch, budget))? {
                Augmented::Found(mut child) => {
                    serial += 1;
                    child.serial = serial;
                    open.insert(*child);
                    // One more than the missing ones tells whether there are more.
                    while open.len() > count - ranking.solutions.len() {
                        open.pop_last();
                        most = open.last().map_or(most, |last| most.min(last.cost));
                    }
                }
                Augmented::TooFar => {}
                Augmented::Exhausted => ranking.is_exhausted = true,
            }
        }
        ranking.solutions.push(Solution { problem: node.problem, choices: node.choices, cost: node.cost });
    }
    Ok(ranking)
}

/// The best solution of a subproblem: the first rows are fixed, and the next one may not have its forbidden choices.
#[derive(Clone)]
struct Node {
    problem: usize,
    serial: u64,
    cost: f64,
    fixed: usize,
    forbidden: Vec<Choice>,
    choices: Vec<Choice>,
    row_of: Vec<Option<usize>>,
    /// Dual prices. The reduced cost of each allowed pair is at least 0, that of each assigned one 0; a free column has price 0.
    row_price: Vec<f64>,
    column_price: Vec<f64>,
    is_greedy: bool,
}

impl PartialEq for Node {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Node {}

impl PartialOrd for Node {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Node {
    /// The cheapest comes first; of equal ones, that of the earlier problem, then the one found first.
    fn cmp(&self, other: &Self) -> Ordering {
        self.cost.total_cmp(&other.cost).then(self.problem.cmp(&other.problem)).then(self.serial.cmp(&other.serial))
    }
}

/// The outcome of an augmenting path.
enum Augmented {
    Found(Box<Node>),
    /// There is no solution within the limit.
    TooFar,
    /// The work budget is used up.
    Exhausted,
}

/// A step of an augmenting path.
#[derive(Clone, Copy)]
enum Step {
    /// A row takes what was reached.
    Taken(usize, Choice),
    /// The column is left free.
    Freed,
}

/// Distances of columns, and after them of *free*: a column that no row has, or a row's way of staying alone.
#[derive(Default)]
struct Scratch {
    far: Vec<f64>,
    step: Vec<Option<Step>>,
    is_done: Vec<bool>,
    /// The rows on shortest paths with their distances.
    rows: Vec<(usize, f64)>,
}

/// A row to be assigned among other rows.
struct Search<'a> {
    row: usize,
    /// The rows that may change their choices.
    active: Range<usize>,
    forbidden: &'a [Choice],
    /// The column that the row had: the path ends there, or where it is `None` at any free one.
    freed: Option<usize>,
    /// The largest allowed length of the path.
    most: f64,
}

impl Node {
    /// Solves a problem row by row; `None` if a row cannot be assigned. Once the budget is used up, rows take the cheapest choice.
    fn first<E>(
        index: usize,
        problem: &Problem,
        (scratch, budget): (&mut Scratch, &mut WorkBudget<E>),
    ) -> Result<Option<Self>, E> {
        let rows = problem.rows.len();
        let mut node = Self {
            problem: index,
            serial: 0,
            cost: 0.0,
            fixed: 0,
            forbidden: Vec::new(),
            choices: vec![Choice::Alone(0); rows],
            row_of: vec![None; problem.columns],
            row_price: vec![0.0; rows],
            column_price: vec![0.0; problem.columns],
            is_greedy: false,
        };
        for row in 0..rows {
            let reduced = problem.rows[row].columns.iter().map(|(column, cost)| cost - node.column_price[*column]);
            let least = reduced.chain(problem.rows[row].alone).fold(f64::INFINITY, f64::min);
            if !least.is_finite() {
                return Ok(None);
            }
            node.row_price[row] = least;
            let search = Search { row, active: 0..row + 1, forbidden: &[], freed: None, most: f64::INFINITY };
            node.is_greedy |= !budget.take(0)?;
            let is_found = !node.is_greedy && node.augment(problem, &search, (scratch, budget))?;
            if !is_found {
                // Either the budget is used up, or no path leads anywhere.
                if !node.is_greedy && budget.take(0)? {
                    return Ok(None);
                }
                node.is_greedy = true;
                let Some(choice) = node.cheapest(&problem.rows[row]) else { return Ok(None) };
                node.take(row, choice);
            }
        }
        node.cost = node.total(problem);
        Ok(Some(node))
    }

    fn cheapest(&self, row: &Row) -> Option<Choice> {
        let columns = row.columns.iter().filter(|(column, _)| self.row_of[*column].is_none());
        let columns = columns.map(|(column, cost)| (Choice::Column(*column), *cost));
        let all = columns.chain(row.alone.iter().enumerate().map(|(way, cost)| (Choice::Alone(way), *cost)));
        all.filter(|(_, cost)| cost.is_finite()).min_by(|a, b| a.1.total_cmp(&b.1)).map(|(choice, _)| choice)
    }

    fn take(&mut self, row: usize, choice: Choice) {
        self.choices[row] = choice;
        if let Choice::Column(column) = choice {
            self.row_of[column] = Some(row);
        }
    }

    fn total(&self, problem: &Problem) -> f64 {
        let cost = |(row, choice): (&Row, &Choice)| match choice {
            Choice::Alone(way) => row.alone[*way],
            Choice::Column(column) => {
                let known = row.columns.iter().find(|(other, _)| other == column);
                known.map_or(f64::INFINITY, |(_, cost)| *cost)
            }
        };
        problem.base + problem.rows.iter().zip(&self.choices).map(cost).sum::<f64>()
    }

    /// Solves the part of this subproblem in which the rows before `row` keep their choices and `row` loses its own.
    fn without<E>(
        &self,
        problem: &Problem,
        row: usize,
        most: f64,
        (scratch, budget): (&mut Scratch, &mut WorkBudget<E>),
    ) -> Result<Augmented, E> {
        let is_same = row == self.fixed;
        let mut forbidden = if is_same { self.forbidden.clone() } else { Vec::new() };
        forbidden.push(self.choices[row]);
        let ways = problem.rows[row].columns.len() + WAYS_ALONE;
        if !budget.take(ways * forbidden.len())? {
            return Ok(Augmented::Exhausted);
        }
        // The cheapest other choice is a lower bound that costs little.
        let prices = |column: usize| self.row_price[row] + self.column_price[column];
        let columns = problem.rows[row].columns.iter().map(|(x, cost)| (Choice::Column(*x), cost - prices(*x)));
        let alone = problem.rows[row].alone.iter().enumerate();
        let alone = alone.map(|(way, cost)| (Choice::Alone(way), cost - self.row_price[row]));
        let others = columns.chain(alone).filter(|(choice, _)| !forbidden.contains(choice));
        let least = others.map(|(_, reduced)| reduced).fold(f64::INFINITY, f64::min);
        if self.cost + least > most {
            return Ok(Augmented::TooFar);
        }
        // The copy, and the sum of its costs.
        let entries: usize = problem.rows.iter().map(|row| row.columns.len()).sum();
        if !budget.take(2 * (problem.rows.len() + problem.columns) + entries)? {
            return Ok(Augmented::Exhausted);
        }
        let mut node = self.clone();
        let freed = match node.choices[row] {
            Choice::Column(column) => {
                node.row_of[column] = None;
                Some(column)
            }
            Choice::Alone(_) => None,
        };
        let active = row..problem.rows.len();
        let search = Search { row, active, forbidden: &forbidden, freed, most: most - self.cost };
        if !node.augment(problem, &search, (scratch, budget))? {
            return Ok(if budget.take(0)? { Augmented::TooFar } else { Augmented::Exhausted });
        }
        (node.fixed, node.forbidden) = (row, forbidden);
        node.cost = node.total(problem);
        Ok(if node.cost <= most { Augmented::Found(Box::new(node)) } else { Augmented::TooFar })
    }

    /// Assigns a row by a shortest augmenting path; `false` if none is short enough, or the budget is used up.
    fn augment<E>(
        &mut self,
        problem: &Problem,
        search: &Search,
        (scratch, budget): (&mut Scratch, &mut WorkBudget<E>),
    ) -> Result<bool, E> {
        let free = problem.columns;
        let target = search.freed.unwrap_or(free);
        scratch.begin(free + 1);
        let mut visited = self.relax_row(problem, search, (search.row, 0.0), scratch);
        let length = loop {
            if !budget.take(visited + free + 1)? {
                return Ok(false);
            }
            let Some((at, far)) = scratch.nearest().filter(|(_, far)| *far <= search.most) else { return Ok(false) };
            if at == target {
                break far;
            }
            scratch.is_done[at] = true;
            visited = if at == free {
                self.relax_free(problem, search, far, scratch)
            } else {
                self.row_of[at].map_or(0, |row| self.relax_row(problem, search, (row, far), scratch))
            };
        };
        self.reprice(search, (free, length), scratch);
        self.follow(search.row, (free, target), scratch);
        Ok(true)
    }

    /// Relaxes the choices of a row; returns their number.
    fn relax_row(&self, problem: &Problem, search: &Search, (row, far): (usize, f64), scratch: &mut Scratch) -> usize {
        let free = problem.columns;
        scratch.rows.push((row, far));
        let is_allowed = |choice: Choice| row != search.row || !search.forbidden.contains(&choice);
        for &(column, cost) in &problem.rows[row].columns {
            let choice = Choice::Column(column);
            let is_fixed = self.row_of[column].is_some_and(|holder| !search.active.contains(&holder));
            if is_fixed || !is_allowed(choice) {
                continue;
            }
            let there = far + (cost - self.row_price[row] - self.column_price[column]).max(0.0);
            let is_free = self.row_of[column].is_none() && search.freed != Some(column);
            scratch.relax(if is_free { free } else { column }, there, Step::Taken(row, choice));
        }
        for (way, cost) in problem.rows[row].alone.into_iter().enumerate() {
            let choice = Choice::Alone(way);
            if cost.is_finite() && is_allowed(choice) {
                scratch.relax(free, far + (cost - self.row_price[row]).max(0.0), Step::Taken(row, choice));
            }
        }
        problem.rows[row].columns.len() + WAYS_ALONE
    }

    /// Relaxes what is possible once something free is taken: another column may stay free, and a row that was alone may leave. Returns
    /// the number of pairs and rows visited.
    fn relax_free(&self, problem: &Problem, search: &Search, far: f64, scratch: &mut Scratch) -> usize {
        let mut visited = problem.columns + search.active.len();
        for column in 0..problem.columns {
            let is_held = self.row_of[column].is_some_and(|row| search.active.contains(&row));
            if is_held || search.freed == Some(column) {
                scratch.relax(column, far - self.column_price[column].min(0.0), Step::Freed);
            }
        }
        for row in search.active.clone() {
            if row != search.row && matches!(self.choices[row], Choice::Alone(_)) {
                visited += self.relax_row(problem, search, (row, far), scratch);
            }
        }
        visited
    }

    /// Updates the prices after a path of this length.
    fn reprice(&mut self, search: &Search, (free, length): (usize, f64), scratch: &Scratch) {
        for &(row, far) in &scratch.rows {
            self.row_price[row] += length - far;
        }
        let done = (0..free).filter(|column| scratch.is_done[*column]);
        done.for_each(|column| self.column_price[column] -= length - scratch.far[column]);
        if scratch.is_done[free] {
            // All prices are shifted so that those of free columns are 0 again.
            let shift = length - scratch.far[free];
            search.active.clone().for_each(|row| self.row_price[row] -= shift);
            for column in 0..free {
                let is_held = self.row_of[column].is_some_and(|row| search.active.contains(&row));
                if is_held || search.freed == Some(column) {
                    self.column_price[column] += shift;
                }
            }
        }
    }

    /// Back along the path, each row takes what it has reached.
    fn follow(&mut self, first: usize, (free, target): (usize, usize), scratch: &Scratch) {
        let mut at = target;
        while let Some(step) = scratch.step[at] {
            match step {
                Step::Freed => {
                    self.row_of[at] = None;
                    self.column_price[at] = 0.0;
                    at = free;
                }
                Step::Taken(row, choice) => {
                    let before = std::mem::replace(&mut self.choices[row], choice);
                    if let Choice::Column(column) = choice {
                        self.row_of[column] = Some(row);
                    }
                    if row == first {
                        return;
                    }
                    at = match before {
                        Choice::Column(column) => column,
                        Choice::Alone(_) => free,
                    };
                }
            }
        }
    }
}

impl Scratch {
    fn begin(&mut self, places: usize) {
        self.far.clear();
        self.far.resize(places, f64::INFINITY);
        self.step.clear();
        self.step.resize(places, None);
        self.is_done.clear();
        self.is_done.resize(places, false);
        self.rows.clear();
    }

    fn relax(&mut self, at: usize, far: f64, step: Step) {
        if !self.is_done[at] && far < self.far[at] {
            (self.far[at], self.step[at]) = (far, Some(step));
        }
    }

    /// Returns the nearest place that is not done.
    fn nearest(&self) -> Option<(usize, f64)> {
        let open = self.far.iter().enumerate().filter(|(at, far)| far.is_finite() && !self.is_done[*at]);
        open.min_by(|a, b| a.1.total_cmp(b.1)).map(|(at, far)| (at, *far))
    }
}
