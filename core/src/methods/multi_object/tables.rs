//! Tables of tracks and detections, of which a step shows a part.

use std::ops::Range;

use super::vocabulary::{case, value};
use crate::geometry::Grid;
use crate::scene::{Matrix, Step};

/// The maximum number of rows and columns of a shown table.
const SHOWN: usize = 12;

/// The names of rows and columns of a table of tracks (rows) and detections (columns).
pub(crate) struct Names {
    pub rows: Vec<String>,
    pub columns: Vec<String>,
}

impl Names {
    /// Names tracks as given, and detections by their numbers from 1.
    pub fn new(rows: impl IntoIterator<Item = String>, columns: impl IntoIterator<Item = usize>) -> Self {
        let columns = columns.into_iter().map(|column| (column + 1).to_string()).collect();
        Self { rows: rows.into_iter().collect(), columns }
    }

    /// Adds the shown part of a table that is too large.
    pub fn add_shown_part(&self, step: Step) -> Step {
        let [rows, columns] = [self.rows.len(), self.columns.len()];
        if rows.max(columns) <= SHOWN {
            return step;
        }
        let step =
            step.put(value::ROWS, rows).put(value::COLUMNS, columns).put(value::SHOWN_COLUMNS, columns.min(SHOWN));
        step.fact_as(value::SHOWN_ROWS.is(rows.min(SHOWN)), case::SHOWN_PART)
    }

    /// Returns the table of `entry` by row and column, of a large one the part around the lit cells; `None` if it is empty.
    pub fn table(
        &self,
        (symbol, name): (&'static str, &'static str),
        entry: impl Fn(usize, usize) -> f64,
        lit: &[(usize, usize)],
    ) -> Option<Matrix> {
        let rows = window(self.rows.len(), lit.iter().map(|(row, _)| *row));
        let columns = window(self.columns.len(), lit.iter().map(|(_, column)| *column));
        if columns.is_empty() || rows.is_empty() {
            return None;
        }
        let mut changed = Grid::new(columns.len(), rows.len(), false);
        for (row, column) in lit.iter().filter(|(row, column)| rows.contains(row) && columns.contains(column)) {
            changed[(column - columns.start, row - rows.start)] = true;
        }
        let entries = Grid::from_fn(columns.len(), rows.len(), |x, y| entry(rows.start + y, columns.start + x));
        let table = Matrix::new(symbol, name, entries);
        Some(Matrix {
            rows: self.rows[rows].to_vec(),
            columns: self.columns[columns].to_vec(),
            changed: Some(changed),
            ..table
        })
    }
}

/// Returns the shown range of `all` rows or columns, with the lit ones in its middle if they fit.
fn window(all: usize, lit: impl Iterator<Item = usize>) -> Range<usize> {
    let [low, high] = lit.fold([usize::MAX, 0], |[low, high], i| [low.min(i), high.max(i)]);
    let spare = SHOWN.saturating_sub((high + 1).saturating_sub(low));
    let first = if low > high { 0 } else { low.saturating_sub(spare / 2) };
    let first = first.min(all.saturating_sub(SHOWN));
    first..all.min(first + SHOWN)
}

#[cfg(test)]
mod tests {
    use super::*;

    crate::line_names!(TABLE);

    #[test]
    fn a_large_table_shows_what_it_is_about_with_its_names() {
        let entry = |row: usize, column: usize| (100 * row + column) as f64;
        let names = Names::new((0..15).map(|i| (i + 200).to_string()), 0..40);
        let table = names.table(("C", "costs"), entry, &[(13, 30)]).expect("there is one");
        assert_eq!(table.entries.size(), (12, 12));
        let lit = table.changed.expect("lit");
        let (x, y) = (0..144).map(|i| (i % 12, i / 12)).find(|&place| lit[place]).expect("the pair");
        assert_eq!((table.entries[(x, y)], &*table.rows[y], &*table.columns[x]), (1330.0, "213", "31"));
        assert_eq!(names.add_shown_part(Step::at(TABLE)).facts()[0].value, "12 of 15 rows, 12 of 40 columns");
        assert_eq!([window(5, [4].into_iter()), window(40, [].into_iter()), window(40, 0..40)], [0..5, 0..12, 0..12]);
    }
}
