//! Tables as CSV.

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

/// A table whose columns carry their units in their names: `x_px`, `u_px`, `cost`.
#[derive(Clone, Debug, PartialEq)]
pub struct Table<const N: usize> {
    /// Names of the columns: letters, digits and underscores.
    pub columns: [&'static str; N],
    /// The rows, in the order in which they are written.
    pub rows: Vec<[Cell; N]>,
}

impl<const N: usize> Table<N> {
    /// The table as CSV: commas, points for decimals, one line of names, lines that end in a newline.
    pub fn csv(&self) -> String {
        let mut text = self.columns.join(",");
        text.push('\n');
        for row in &self.rows {
            for (i, cell) in row.iter().enumerate() {
                if i > 0 {
                    text.push(',');
                }
                text += &cell.to_string();
            }
            text.push('\n');
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_brief_and_exact() {
        let row = [Cell::Int(-3), Cell::Real(1.0 / 3.0), Cell::Single(0.1), Cell::Empty];
        let rows = vec![row, [Cell::Int(0), Cell::Real(f64::NAN), Cell::Single(-7.0), Cell::Single(f32::INFINITY)]];
        let csv = Table { columns: ["x_px", "cost", "u_px", "v_px"], rows }.csv();
        assert_eq!(csv, "x_px,cost,u_px,v_px\n-3,0.3333333333333333,0.1,\n0,,-7,\n");
        assert_eq!(Table::<1> { columns: ["cost"], rows: vec![] }.csv(), "cost\n");
    }
}
