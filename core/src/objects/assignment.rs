//! Who belongs to whom: pairs of rows and columns of a table of costs.

use crate::Grid;

/// Pairs each row with at most one column, so that as many are paired as can be and the sum of their costs is least: the
/// Hungarian method, by shortest augmenting paths (H. W. Kuhn 1955; R. Jonker and A. Volgenant 1987). Costs that are not finite
/// are never paired. Gives the column of each row.
pub fn least_cost(costs: &Grid<f64>) -> Vec<Option<usize>> {
    let (columns, rows) = costs.size();
    // What is not allowed costs more than all that is, however much of it is paired.
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

/// The same where no row lacks a column: there are at least as many columns as rows.
fn shortest_paths((rows, columns): (usize, usize), cost: impl Fn(usize, usize) -> f64) -> Vec<Option<usize>> {
    // Column `columns` stands for none: there each path begins.
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
        // Back along the path, each column takes the row of the one before.
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

/// Pairs the row and column of the least cost first, then the next, each at most once; those of one cost in the order of the
/// table. Costs that are not finite are never paired. Gives the column of each row.
pub fn nearest_first(costs: &Grid<f64>) -> Vec<Option<usize>> {
    let (columns, rows) = costs.size();
    let mut order: Vec<(usize, usize)> =
        (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row))).collect();
    order.retain(|&place| costs[place].is_finite());
    order.sort_by(|&a, &b| costs[a].total_cmp(&costs[b]));
    let (mut of_row, mut is_taken) = (vec![None; rows], vec![false; columns]);
    for (column, row) in order {
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

    /// How many are paired and what that costs.
    fn worth(costs: &Grid<f64>, pairs: &[Option<usize>]) -> (usize, f64) {
        let paired = pairs.iter().enumerate().filter_map(|(row, column)| column.map(|column| costs[(column, row)]));
        paired.fold((0, 0.0), |(count, sum), cost| (count + 1, sum + cost))
    }

    /// The best of all ways to pair the rows from `row` on.
    fn best(costs: &Grid<f64>, row: usize, taken: &mut Vec<usize>) -> (usize, f64) {
        if row == costs.height() {
            return (0, 0.0);
        }
        let mut best_so_far = best(costs, row + 1, taken);
        for column in 0..costs.width() {
            if costs[(column, row)].is_finite() && !taken.contains(&column) {
                taken.push(column);
                let (count, sum) = best(costs, row + 1, taken);
                taken.pop();
                let worth = (count + 1, sum + costs[(column, row)]);
                if worth.0 > best_so_far.0 || worth.0 == best_so_far.0 && worth.1 < best_so_far.1 {
                    best_so_far = worth;
                }
            }
        }
        best_so_far
    }

    proptest! {
        #[test]
        fn no_other_pairs_cost_less(
            rows in 1..6_usize,
            columns in 1..6_usize,
            cells in prop::collection::vec(prop_oneof![4 => (-9..30_i32).prop_map(f64::from), 1 => Just(f64::INFINITY)], 36),
        ) {
            let costs = Grid::from_fn(columns, rows, |x, y| cells[y * 6 + x]);
            let pairs = least_cost(&costs);
            let mut columns_taken: Vec<_> = pairs.iter().flatten().collect();
            columns_taken.sort();
            columns_taken.dedup();
            prop_assert_eq!(columns_taken.len(), pairs.iter().flatten().count());
            let (count, sum) = best(&costs, 0, &mut Vec::new());
            let found = worth(&costs, &pairs);
            prop_assert_eq!(found.0, count);
            prop_assert!((found.1 - sum).abs() < 1e-9, "{} instead of {}", found.1, sum);
            let greedy = worth(&costs, &nearest_first(&costs));
            prop_assert!(greedy.0 <= count && (greedy.0 < count || greedy.1 >= sum - 1e-9));
        }
    }

    #[test]
    fn the_nearest_is_not_always_best() {
        let costs = Grid::from_vec(2, 2, vec![1.0, 2.0, 1.5, 9.0]).expect("four cells");
        assert_eq!(nearest_first(&costs), [Some(0), Some(1)]);
        assert_eq!(least_cost(&costs), [Some(1), Some(0)]);
        let nothing: Grid<f64> = Grid::new(0, 3, 0.0);
        assert_eq!((least_cost(&nothing), nearest_first(&nothing)), (vec![None; 3], vec![None; 3]));
    }
}
