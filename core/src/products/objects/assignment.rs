//! Assignment: the pairs of rows and columns of a cost matrix of least total cost.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::pairs::Pairs;
use crate::base::Error;
use crate::geometry::Grid;

/// The work budget of an assignment and its check for cancellation, which `E` reports.
pub struct WorkBudget<'a, E = Error> {
    /// Pairs that may still be visited.
    left: u64,
    /// Pairs visited since the last check for cancellation.
    since: u64,
    wanted: &'a dyn Fn() -> Result<(), E>,
}

/// The number of pairs between checks for cancellation, some milliseconds.
const ASK_AFTER: u64 = 1 << 16;

impl<'a, E> WorkBudget<'a, E> {
    /// Creates an unlimited budget.
    pub fn endless(wanted: &'a dyn Fn() -> Result<(), E>) -> Self {
        Self::limited(u64::MAX, wanted)
    }

    /// Creates a budget of this many pairs.
    pub fn limited(pairs: u64, wanted: &'a dyn Fn() -> Result<(), E>) -> Self {
        Self { left: pairs, since: 0, wanted }
    }

    /// Does the work of all parts, the smallest first, each with an equal share of the remaining budget: no large part takes the share of a small
    /// one, and what the small ones leave is for the large ones. Returns the results in the order of the parts.
    ///
    /// # Errors
    /// The errors of the work.
    pub fn shared<P, T>(
        &mut self,
        parts: &[P],
        size: impl Fn(&P) -> usize,
        mut work: impl FnMut(&P, &mut Self) -> Result<T, E>,
    ) -> Result<Vec<T>, E> {
        let mut order: Vec<usize> = (0..parts.len()).collect();
        order.sort_by_key(|part| size(&parts[*part]));
        let mut done = Vec::with_capacity(parts.len());
        for (before, part) in order.into_iter().enumerate() {
            let rest = self.left - self.left / (parts.len() - before) as u64;
            self.left -= rest;
            done.push((part, work(&parts[part], self)?));
            self.left += rest;
        }
        done.sort_unstable_by_key(|(part, _)| *part);
        Ok(done.into_iter().map(|(_, result)| result).collect())
    }

    /// Takes pairs from the budget; returns whether any was left.
    pub(super) fn take(&mut self, pairs: usize) -> Result<bool, E> {
        let pairs = pairs as u64;
        self.since += pairs;
        if self.since >= ASK_AFTER {
            self.since = 0;
            (self.wanted)()?;
        }
        let has_any = self.left > 0;
        self.left = self.left.saturating_sub(pairs);
        Ok(has_any)
    }
}

/// The result of an assignment.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Assigned {
    /// The column of each row.
    pub columns: Vec<Option<usize>>,
    /// The number of rows assigned greedily because the budget was used up.
    pub greedy: usize,
}

/// The maximum number of cells of a table solved densely. Larger ones are solved by their entries only, with the same total cost,
/// but among equal optima perhaps another one.
const SMALL: usize = 1 << 14;

fn is_small(pairs: &Pairs) -> bool {
    pairs.rows() * pairs.columns() <= SMALL
}

/// Assigns each row at most one column: as many pairs as possible at the least total cost, by the
/// Hungarian method, by shortest augmenting paths (H. W. Kuhn 1955; R. Jonker and A. Volgenant 1987). Once `budget` is used up,
/// the remaining rows are assigned greedily.
///
/// # Errors
/// If the work is cancelled.
pub(crate) fn least_cost<E>(costs: &Pairs, budget: &mut WorkBudget<E>) -> Result<Assigned, E> {
    if is_small(costs) {
        return Ok(Assigned { columns: of_table(&costs.table(f64::INFINITY)), greedy: 0 });
    }
    let (low, high) = costs.iter().fold((0.0_f64, 0.0_f64), |(low, high), (.., cost)| (low.min(cost), high.max(cost)));
    // An unassigned row costs more than any sum of entries.
    let alone = (high - low + 1.0) * (costs.rows().min(costs.columns()) + 1) as f64;
    Paths::new(costs, low, alone).all(budget)
}

/// Assigns each row at most one column so that the total worth is largest; unassigned rows and negative worths count 0.
///
/// # Errors
/// If the work is cancelled.
pub(crate) fn most_worth<E>(worths: &Pairs, budget: &mut WorkBudget<E>) -> Result<Assigned, E> {
    let costs = worths.filter_map(|_, _, worth| (worth > 0.0).then_some(-worth));
    if is_small(&costs) {
        let columns = of_table(&costs.table(0.0)).into_iter().enumerate();
        let columns = columns.map(|(row, column)| column.filter(|column| costs.get(row, *column).is_some()));
        return Ok(Assigned { columns: columns.collect(), greedy: 0 });
    }
    let low = costs.iter().fold(0.0_f64, |low, (.., cost)| low.min(cost));
    Paths::new(&costs, low, -low).all(budget)
}

/// Returns the assignment of a dense table. Costs that are not finite are never assigned.
fn of_table(costs: &Grid<f64>) -> Vec<Option<usize>> {
    let (columns, rows) = costs.size();
    // A forbidden pair costs more than any sum of allowed ones.
    let known = costs.cells().iter().copied().filter(|cost| cost.is_finite());
    let (low, high) = known.fold((0.0_f64, 0.0_f64), |(low, high), cost| (low.min(cost), high.max(cost)));
    let forbidden = (high - low + 1.0) * (rows.min(columns) + 1) as f64;
    let cost = |row: usize, column: usize| {
        let cost = costs[(column, row)];
        if cost.is_finite() { cost - low } else { forbidden }
    };
    let pairs = if rows <= columns {
        shortest_paths((rows, columns), cost)
    } else {
        let mut of_row = vec![None; rows];
        let of_column = shortest_paths((columns, rows), |column, row| cost(row, column));
        for (column, row) in of_column.into_iter().enumerate() {
            if let Some(row) = row {
                of_row[row] = Some(column);
            }
        }
        of_row
    };
    let is_allowed = |row: usize, column: usize| costs[(column, row)].is_finite();
    pairs.into_iter().enumerate().map(|(row, column)| column.filter(|&column| is_allowed(row, column))).collect()
}

/// Solves a dense table with at least as many columns as rows by shortest augmenting paths.
fn shortest_paths((rows, columns): (usize, usize), cost: impl Fn(usize, usize) -> f64) -> Vec<Option<usize>> {
    // Column `columns` stands for no column: each path begins there.
    let mut row_price = vec![0.0; rows];
    let mut column_price = vec![0.0; columns];
    let mut row_of = vec![None; columns + 1];
    let (mut far, mut from, mut is_done) = (vec![0.0; columns], vec![columns; columns], vec![false; columns + 1]);
    for row in 0..rows {
        far.fill(f64::INFINITY);
        is_done.fill(false);
        row_of[columns] = Some(row);
        let mut at = columns;
        while let Some(row) = row_of[at] {
            is_done[at] = true;
            let (mut least, mut next) = (f64::INFINITY, columns);
            for column in (0..columns).filter(|&column| !is_done[column]) {
                let reduced = cost(row, column) - row_price[row] - column_price[column];
                if reduced < far[column] {
                    (far[column], from[column]) = (reduced, at);
                }
                if far[column] < least {
                    (least, next) = (far[column], column);
                }
            }
            for column in 0..=columns {
                match (is_done[column], row_of[column]) {
                    (true, Some(row)) => {
                        row_price[row] += least;
                        if let Some(price) = column_price.get_mut(column) {
                            *price -= least;
                        }
                    }
                    _ => {
                        if let Some(far) = far.get_mut(column) {
                            *far -= least;
                        }
                    }
                }
            }
            at = next;
        }
        // Back along the path, each column takes the row of the previous one.
        while at < columns {
            row_of[at] = row_of[from[at]];
            at = from[at];
        }
    }
    let mut of_row = vec![None; rows];
    for (column, row) in row_of[..columns].iter().enumerate() {
        if let Some(row) = row {
            of_row[*row] = Some(column);
        }
    }
    of_row
}

/// Shortest augmenting paths through the entries of a sparse table. Each row has a column of its own that stands for no
/// assignment.
struct Paths<'a> {
    costs: &'a Pairs,
    /// The offset subtracted from each cost, so that none is negative.
    low: f64,
    /// The cost of staying alone.
    alone: f64,
    row_price: Vec<f64>,
    column_price: Vec<f64>,
    row_of: Vec<Option<usize>>,
    column_of: Vec<Option<usize>>,
    /// The distance of each column, and the row before it on the shortest path.
    far: Vec<f64>,
    from: Vec<usize>,
    is_done: Vec<bool>,
}

/// A column that a path leads to. The nearest is the largest; of two as near, one that is free, then the first.
#[derive(PartialEq)]
struct Reached {
    far: f64,
    is_taken: bool,
    column: usize,
}

impl Eq for Reached {}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> Ordering {
        let nearer = other.far.total_cmp(&self.far);
        nearer.then(other.is_taken.cmp(&self.is_taken)).then(other.column.cmp(&self.column))
    }
}

/// Where a shortest path ends.
enum End {
    /// At a column that was free.
    At(usize),
    /// At a row that remains unassigned.
    Alone(usize),
}

impl<'a> Paths<'a> {
    fn new(costs: &'a Pairs, low: f64, alone: f64) -> Self {
        let (rows, columns) = (costs.rows(), costs.columns());
        Self {
            costs,
            low,
            alone,
            row_price: vec![0.0; rows],
            column_price: vec![0.0; columns],
            row_of: vec![None; columns],
            column_of: vec![None; rows],
            far: vec![f64::INFINITY; columns],
            from: vec![0; columns],
            is_done: vec![false; columns],
        }
    }

    fn all<E>(mut self, budget: &mut WorkBudget<E>) -> Result<Assigned, E> {
        for row in 0..self.costs.rows() {
            if !self.pair(row, budget)? {
                return Ok(self.greedy(row));
            }
        }
        Ok(Assigned { columns: self.column_of, greedy: 0 })
    }

    /// Assigns the rows from `first` on greedily to the free columns.
    fn greedy(mut self, first: usize) -> Assigned {
        let left = self.costs.filtered(|row, column, _| row >= first && self.row_of[column].is_none());
        for (row, column) in nearest_first(&left).into_iter().enumerate().skip(first) {
            self.column_of[row] = column;
        }
        let greedy = self.column_of.len() - first;
        Assigned { columns: self.column_of, greedy }
    }

    /// Assigns one more row by a shortest augmenting path; `false` if the budget is used up first.
    fn pair<E>(&mut self, row: usize, budget: &mut WorkBudget<E>) -> Result<bool, E> {
        let (mut heap, mut touched, mut rows, mut done) = (BinaryHeap::new(), Vec::new(), Vec::new(), Vec::new());
        let (mut next, mut alone) = (Some((row, 0.0)), (f64::INFINITY, row));
        let end = loop {
            if let Some((row, far)) = next.take() {
                let to_stay = far + (self.alone - self.row_price[row]).max(0.0);
                if to_stay < alone.0 {
                    alone = (to_stay, row);
                }
                rows.push((row, far));
                if !budget.take(self.relax(row, far, (&mut heap, &mut touched)))? {
                    self.forget(&touched);
                    return Ok(false);
                }
            }
            let nearest = heap.pop().filter(|reached: &Reached| reached.far < alone.0);
            let Some(Reached { far, column, .. }) = nearest else { break (End::Alone(alone.1), alone.0) };
            if std::mem::replace(&mut self.is_done[column], true) {
                continue;
            }
            match self.row_of[column] {
                None => break (End::At(column), far),
                Some(row) => next = Some((row, far)),
            }
            done.push((column, far));
        };
        rows.into_iter().for_each(|(row, far)| self.row_price[row] += end.1 - far);
        done.into_iter().for_each(|(column, far)| self.column_price[column] -= end.1 - far);
        self.augment(row, end.0);
        self.forget(&touched);
        Ok(true)
    }

    /// Relaxes the columns of a row at this distance; returns their number.
    fn relax(&mut self, row: usize, far: f64, (heap, touched): (&mut BinaryHeap<Reached>, &mut Vec<usize>)) -> usize {
        let mut count = 0;
        for (column, cost) in self.costs.row(row) {
            count += 1;
            let reduced = cost - self.low - self.row_price[row] - self.column_price[column];
            let there = far + reduced.max(0.0);
            if self.is_done[column] || there >= self.far[column] {
                continue;
            }
            if self.far[column].is_infinite() {
                touched.push(column);
            }
            (self.far[column], self.from[column]) = (there, row);
            heap.push(Reached { far: there, is_taken: self.row_of[column].is_some(), column });
        }
        count.max(1)
    }

    /// Back along the path from its end to the row that it begins with, each row takes the column that follows it.
    fn augment(&mut self, row: usize, end: End) {
        let mut next = match end {
            End::At(column) => Some(column),
            End::Alone(row) => self.column_of[row].take(),
        };
        while let Some(column) = next {
            let before = self.from[column];
            self.row_of[column] = Some(before);
            next = self.column_of[before].replace(column).filter(|_| before != row);
        }
    }

    /// Makes room for the next path.
    fn forget(&mut self, touched: &[usize]) {
        for &column in touched {
            (self.far[column], self.is_done[column]) = (f64::INFINITY, false);
        }
    }
}

/// Pairs the row and column of the least cost first, then the next, each at most once; those of one cost in the order of the
/// table. Gives the column of each row.
pub(crate) fn nearest_first(costs: &Pairs) -> Vec<Option<usize>> {
    let mut order: Vec<(usize, usize, f64)> = costs.iter().collect();
    order.sort_by(|a, b| a.2.total_cmp(&b.2));
    let (mut of_row, mut is_taken) = (vec![None; costs.rows()], vec![false; costs.columns()]);
    for (row, column, _) in order {
        if of_row[row].is_none() && !is_taken[column] {
            (of_row[row], is_taken[column]) = (Some(column), true);
        }
    }
    of_row
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn wanted() -> Result<(), Error> {
        Ok(())
    }

    fn least(costs: &Pairs) -> Vec<Option<usize>> {
        least_cost(costs, &mut WorkBudget::endless(&wanted)).expect("it is wanted").columns
    }

    #[test]
    fn small_parts_have_their_share_of_the_budget_and_leave_the_rest_to_large_ones() {
        let mut budget = WorkBudget::limited(100, &wanted);
        // Each part takes as many pairs as it has, if it has the budget.
        let parts = [500, 3, 40, 7];
        let had = budget.shared(
            &parts,
            |part| *part,
            |part, budget| {
                let left = budget.left;
                budget.take(*part).map(|_| left)
            },
        );
        // 100 / 4, 97 / 3, 90 / 2, and the remainder.
        assert_eq!(had.expect("it is wanted"), [50, 25, 45, 32]);
        assert_eq!(budget.left, 0);
    }

    /// The same by paths, as it is done for large tables.
    fn by_paths(costs: &Pairs) -> Vec<Option<usize>> {
        let (low, high) = costs.iter().fold((0.0_f64, 0.0_f64), |(a, b), (.., cost)| (a.min(cost), b.max(cost)));
        let alone = (high - low + 1.0) * (costs.rows() + 1) as f64;
        Paths::new(costs, low, alone).all(&mut WorkBudget::endless(&wanted)).expect("it is wanted").columns
    }

    /// Returns the number of pairs and their total cost; asserts that no column is used twice.
    fn worth(costs: &Pairs, pairs: &[Option<usize>]) -> (usize, f64) {
        let mut columns: Vec<_> = pairs.iter().flatten().collect();
        columns.sort();
        columns.dedup();
        assert_eq!(columns.len(), pairs.iter().flatten().count());
        let paired = pairs.iter().enumerate().filter_map(|(row, column)| column.map(|column| (row, column)));
        let cost = |(row, column)| costs.get(row, column).expect("only pairs that are allowed");
        paired.map(cost).fold((0, 0.0), |(count, sum), cost| (count + 1, sum + cost))
    }

    /// The best of all ways to pair the rows from `row` on.
    fn best(costs: &Pairs, row: usize, taken: &mut Vec<usize>) -> (usize, f64) {
        if row == costs.rows() {
            return (0, 0.0);
        }
        let mut best_so_far = best(costs, row + 1, taken);
        for (column, cost) in costs.row(row) {
            if !taken.contains(&column) {
                taken.push(column);
                let (count, sum) = best(costs, row + 1, taken);
                taken.pop();
                let worth = (count + 1, sum + cost);
                if worth.0 > best_so_far.0 || worth.0 == best_so_far.0 && worth.1 < best_so_far.1 {
                    best_so_far = worth;
                }
            }
        }
        best_so_far
    }

    /// The most that pairs of the rows from `row` on can be worth.
    fn most(worths: &Pairs, row: usize, taken: &mut Vec<usize>) -> f64 {
        if row == worths.rows() {
            return 0.0;
        }
        let mut most_so_far = most(worths, row + 1, taken);
        for (column, worth) in worths.row(row) {
            if !taken.contains(&column) {
                taken.push(column);
                most_so_far = most_so_far.max(worth + most(worths, row + 1, taken));
                taken.pop();
            }
        }
        most_so_far
    }

    proptest! {
        #[test]
        fn no_other_pairs_cost_less(
            rows in 1..6_usize,
            columns in 1..6_usize,
            cells in prop::collection::vec(prop_oneof![4 => (-9..30_i32).prop_map(f64::from), 1 => Just(f64::INFINITY)], 36),
        ) {
            let costs = Pairs::of(&Grid::from_fn(columns, rows, |x, y| cells[y * 6 + x]));
            let (count, sum) = best(&costs, 0, &mut Vec::new());
            let found = worth(&costs, &least(&costs));
            prop_assert_eq!(found.0, count);
            prop_assert!((found.1 - sum).abs() < 1e-9, "{} instead of {}", found.1, sum);
            let of_paths = worth(&costs, &by_paths(&costs));
            prop_assert!(of_paths.0 == count && (of_paths.1 - sum).abs() < 1e-9, "{of_paths:?} instead of {sum}");
            let greedy = worth(&costs, &nearest_first(&costs));
            prop_assert!(greedy.0 <= count && (greedy.0 < count || greedy.1 >= sum - 1e-9));
            let all = most_worth(&costs, &mut WorkBudget::endless(&wanted)).expect("it is wanted");
            let most = most(&costs, 0, &mut Vec::new());
            prop_assert!((worth(&costs, &all.columns).1 - most).abs() < 1e-9);
            let negative = costs.filter_map(|_, _, worth| (worth > 0.0).then_some(-worth));
            let low = negative.iter().fold(0.0_f64, |low, (.., cost)| low.min(cost));
            let paths = Paths::new(&negative, low, -low).all(&mut WorkBudget::endless(&wanted)).expect("it is wanted");
            prop_assert!((worth(&costs, &paths.columns).1 - most).abs() < 1e-9);
        }

        #[test]
        fn paths_come_to_what_the_whole_table_does(
            (rows, columns) in (1..40_usize, 1..40_usize),
            share in 1..100_u64,
            seed in any::<u64>(),
        ) {
            let mut state = seed;
            let mut dice = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                state >> 33
            };
            let costs = Pairs::of(&Grid::from_fn(columns, rows, |_, _| match dice() % 100 < share {
                true => (dice() % 50) as f64 / 4.0,
                false => f64::INFINITY,
            }));
            let (found, expected) = (worth(&costs, &by_paths(&costs)), worth(&costs, &least(&costs)));
            prop_assert_eq!(found.0, expected.0);
            prop_assert!((found.1 - expected.1).abs() < 1e-6, "{} instead of {}", found.1, expected.1);
        }
    }

    #[test]
    fn the_nearest_is_not_always_best() {
        let costs = Pairs::of(&Grid::from_vec(2, 2, vec![1.0, 2.0, 1.5, 9.0]).expect("four cells"));
        assert_eq!(nearest_first(&costs), [Some(0), Some(1)]);
        assert_eq!(least(&costs), [Some(1), Some(0)]);
        let nothing = Pairs::of(&Grid::new(0, 3, 0.0));
        assert_eq!((least(&nothing), nearest_first(&nothing)), (vec![None; 3], vec![None; 3]));
    }

    #[test]
    fn effort_has_an_end_and_work_that_is_not_wanted_stops() {
        // Each pair is as good as any other, and there are twice as many rows as columns.
        let costs = Pairs::of(&Grid::new(300, 600, 1.0));
        let cut = least_cost(&costs, &mut WorkBudget::limited(40_000, &wanted)).expect("it is wanted");
        assert!((1..600).contains(&cut.greedy), "{}", cut.greedy);
        assert_eq!(worth(&costs, &cut.columns), (300, 300.0), "those that were left are paired all the same");
        let whole = least_cost(&costs, &mut WorkBudget::endless(&wanted)).expect("it is wanted");
        assert_eq!((worth(&costs, &whole.columns), whole.greedy), ((300, 300.0), 0));
        let refused = || Err(Error::new("enough"));
        assert!(least_cost(&costs, &mut WorkBudget::endless(&refused)).is_err());
    }
}
