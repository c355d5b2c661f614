//! Sparse matrices of pairs: most rows and columns have no entry in common.

use std::ops::Range;

use crate::geometry::Grid;

/// A sparse matrix by rows; pairs without an entry are absent.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pairs {
    width: usize,
    /// The end of each row in both lists.
    ends: Vec<usize>,
    /// The column of each pair, in ascending order within a row, and its number.
    columns: Vec<u32>,
    numbers: Vec<f64>,
}

impl Pairs {
    /// Creates a matrix with this many columns and no rows.
    pub fn new(columns: usize) -> Self {
        Self { width: columns, ..Self::default() }
    }

    /// Returns the finite entries of a table.
    pub fn of(table: &Grid<f64>) -> Self {
        let mut pairs = Self::new(table.width());
        for y in 0..table.height() {
            let row = table.row(y).iter().copied().enumerate();
            pairs.push(row.filter(|(_, number)| number.is_finite()));
        }
        pairs
    }

    /// Returns a dense table, with `absent` for absent pairs.
    pub fn table(&self, absent: f64) -> Grid<f64> {
        let mut table = Grid::new(self.columns(), self.rows(), absent);
        self.iter().for_each(|(row, column, number)| table[(column, row)] = number);
        table
    }

    /// Adds a row, by its columns in ascending order.
    pub fn push(&mut self, row: impl IntoIterator<Item = (usize, f64)>) {
        for (column, number) in row {
            self.columns.push(column as u32);
            self.numbers.push(number);
        }
        self.ends.push(self.columns.len());
    }

    /// The number of columns.
    pub fn columns(&self) -> usize {
        self.width
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.ends.len()
    }

    /// The number of entries.
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Whether there are no entries.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    fn range(&self, row: usize) -> Range<usize> {
        let start = row.checked_sub(1).map_or(0, |before| self.ends[before]);
        start..self.ends[row]
    }

    /// Returns columns and entries of a row, by column.
    pub fn row(&self, row: usize) -> impl Iterator<Item = (usize, f64)> + Clone {
        let range = self.range(row);
        let numbers = self.numbers[range.clone()].iter().copied();
        self.columns[range].iter().map(|column| *column as usize).zip(numbers)
    }

    /// Returns the entry of a pair.
    pub fn get(&self, row: usize, column: usize) -> Option<f64> {
        let range = self.range(row);
        let place = self.columns[range.clone()].binary_search(&(column as u32)).ok()?;
        Some(self.numbers[range.start + place])
    }

    /// Returns all entries as row, column and number, row by row.
    pub fn iter(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        (0..self.rows()).flat_map(|row| self.row(row).map(move |(column, number)| (row, column, number)))
    }

    /// Maps entries by row, column and number, and drops those mapped to `None`.
    #[must_use]
    pub fn filter_map(&self, f: impl Fn(usize, usize, f64) -> Option<f64>) -> Self {
        let mut kept = Self::new(self.width);
        for row in 0..self.rows() {
            kept.push(self.row(row).filter_map(|(column, number)| Some((column, f(row, column, number)?))));
        }
        kept
    }

    /// Keeps the entries for which `counts` holds.
    #[must_use]
    pub fn filtered(&self, counts: impl Fn(usize, usize, f64) -> bool) -> Self {
        self.filter_map(|row, column, number| counts(row, column, number).then_some(number))
    }

    /// Maps all entries by row, column and number.
    #[must_use]
    pub fn map(&self, f: impl Fn(usize, usize, f64) -> f64) -> Self {
        self.filter_map(|row, column, number| Some(f(row, column, number)))
    }

    /// Returns the transpose.
    #[must_use]
    pub fn turned(&self) -> Self {
        let mut ends = vec![0; self.width];
        self.columns.iter().for_each(|column| ends[*column as usize] += 1);
        let mut sum = 0;
        for end in &mut ends {
            sum += *end;
            *end = sum - *end;
        }
        let (mut columns, mut numbers) = (vec![0; self.len()], vec![0.0; self.len()]);
        for (row, column, number) in self.iter() {
            (columns[ends[column]], numbers[ends[column]]) = (row as u32, number);
            ends[column] += 1;
        }
        Self { width: self.rows(), ends, columns, numbers }
    }
}

/// Numbers of pairs that are added up one by one, in any order of rows and columns.
#[derive(Clone, Debug)]
pub struct Sums(Vec<Vec<(u32, f64)>>);

impl Sums {
    /// Creates empty sums of this many rows.
    pub fn new(rows: usize) -> Self {
        Self(vec![Vec::new(); rows])
    }

    /// Adds to the sum of a pair.
    pub fn add(&mut self, (row, column): (usize, usize), number: f64) {
        let (cells, column) = (&mut self.0[row], column as u32);
        // Columns mostly come in ascending order.
        let place = match cells.last() {
            Some((last, _)) if *last < column => Err(cells.len()),
            _ => cells.binary_search_by_key(&column, |(column, _)| *column),
        };
        match place {
            Ok(place) => cells[place].1 += number,
            Err(place) => cells.insert(place, (column, number)),
        }
    }

    /// Returns the sums as a matrix with this many columns.
    pub fn pairs(self, columns: usize) -> Pairs {
        let mut pairs = Pairs::new(columns);
        self.0.into_iter().for_each(|row| pairs.push(row.into_iter().map(|(column, sum)| (column as usize, sum))));
        pairs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_those_of_the_table() {
        let cell =
            |x: usize, y: usize| if (x * 7 + y * 5).is_multiple_of(3) { (10 * x + y) as f64 } else { f64::INFINITY };
        let table = Grid::from_fn(6, 4, cell);
        let pairs = Pairs::of(&table);
        assert_eq!((pairs.columns(), pairs.rows()), (6, 4));
        assert_eq!(pairs.len(), table.cells().iter().filter(|cell| cell.is_finite()).count());
        for (x, y) in (0..4).flat_map(|y| (0..6).map(move |x| (x, y))) {
            assert_eq!(pairs.get(y, x), Some(cell(x, y)).filter(|cell| cell.is_finite()));
        }
        assert_eq!(pairs.turned(), Pairs::of(&Grid::from_fn(4, 6, |y, x| cell(x, y))));
        assert_eq!(pairs.turned().turned(), pairs);
        assert_eq!(pairs.table(f64::INFINITY), table);
        let large = pairs.filtered(|_, x, number| x > 2 && number > 31.0);
        assert!(large.iter().all(|(y, x, number)| x > 2 && number > 31.0 && pairs.get(y, x) == Some(number)));
        assert_eq!(pairs.map(|y, x, number| number - (10 * x + y) as f64).iter().map(|(.., n)| n).sum::<f64>(), 0.0);
        assert!(Pairs::of(&Grid::new(0, 3, 0.0)).is_empty() && Pairs::default().rows() == 0);
    }

    #[test]
    fn sums_are_kept_by_column() {
        let mut sums = Sums::new(2);
        for (place, number) in [((0, 4), 1.0), ((0, 9), 2.0), ((0, 1), 3.0), ((0, 4), 0.5), ((1, 0), 7.0)] {
            sums.add(place, number);
        }
        let pairs = sums.pairs(10);
        assert_eq!(pairs.iter().collect::<Vec<_>>(), [(0, 1, 3.0), (0, 4, 1.5), (0, 9, 2.0), (1, 0, 7.0)]);
    }
}
