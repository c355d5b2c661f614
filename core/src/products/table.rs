//! Tables: the data of a product row by row, for any file format.

use std::fmt;

/// One number or word of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell {
    /// A whole number.
    Int(i64),
    /// A real number; written as briefly as reads back exactly, left empty if it is not finite.
    Real(f64),
    /// A real number of single precision, written the same way.
    Single(f32),
    /// One of a few words of letters and hyphens.
    Word(&'static str),
    /// Not known: left empty.
    Empty,
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Cell::Int(v) => v.fmt(f),
            Cell::Real(v) if v.is_finite() => v.fmt(f),
            Cell::Single(v) if v.is_finite() => v.fmt(f),
            Cell::Word(v) => f.write_str(v),
            Cell::Real(_) | Cell::Single(_) | Cell::Empty => Ok(()),
        }
    }
}

impl From<usize> for Cell {
    fn from(v: usize) -> Self {
        Cell::Int(v as i64)
    }
}

impl From<u32> for Cell {
    fn from(v: u32) -> Self {
        Cell::Int(i64::from(v))
    }
}

impl From<f32> for Cell {
    fn from(v: f32) -> Self {
        Cell::Single(v)
    }
}

impl From<f64> for Cell {
    fn from(v: f64) -> Self {
        Cell::Real(v)
    }
}

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(v: Option<T>) -> Self {
        v.map_or(Cell::Empty, Into::into)
    }
}

/// A table whose columns carry their units in their names: `x_px`, `u_px`, `cost`.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    columns: Vec<&'static str>,
    cells: Vec<Cell>,
}

impl Table {
    /// A table of `rows`; the names of its columns are letters, digits, underscores and points.
    pub fn new<const N: usize>(columns: [&'static str; N], rows: impl IntoIterator<Item = [Cell; N]>) -> Self {
        Self { columns: columns.to_vec(), cells: rows.into_iter().flatten().collect() }
    }

    /// A table of `rows`, each with a cell for every column; which columns there are depends on what is known.
    pub fn of_rows(columns: Vec<&'static str>, rows: impl IntoIterator<Item = Vec<Cell>>) -> Self {
        Self { columns, cells: rows.into_iter().flatten().collect() }
    }

    /// The names of the columns.
    pub fn columns(&self) -> &[&'static str] {
        &self.columns
    }

    /// The rows, in the order in which they are written.
    pub fn rows(&self) -> impl Iterator<Item = &[Cell]> {
        self.cells.chunks(self.columns.len().max(1))
    }
}
