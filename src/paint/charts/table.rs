//! A table of numbers for print: given, left out to be filled in, or filled in.

use motionscope_core::geometry::Grid;
use motionscope_core::scene::Role;

use super::super::primitive::{Anchor, Rect};
use super::super::{Face, Theme};
use super::canvas::{Canvas, Level, Type, middle, shortened};
use super::explanation::Block;

/// A cell of a [`Table`].
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A number.
    Given(String),
    /// A box to write in.
    Blank,
    /// A number that was left out elsewhere.
    Answer(String),
    /// Nothing is known of it.
    Unknown,
}

/// Rows and columns of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// What it has.
    pub title: String,
    /// The names of the columns and rows; none where they need none.
    pub columns: Vec<String>,
    /// The same of the rows.
    pub rows: Vec<String>,
    /// The cells.
    pub cells: Grid<Cell>,
    /// Cells framed in the colour of a role.
    pub framed: Vec<(Role, [usize; 2])>,
}

impl Table {
    /// Least width and height of a cell in letters of small type.
    const CELL: [f32; 2] = [2.15, 1.9];

    /// Lays the table out from the origin on.
    pub fn draw(&self, theme: Theme) -> Block {
        let (text, dim, chrome) = (Type::text(theme), Type::dim(theme), theme.chrome());
        let small = text.size;
        let widest = |words: &[String]| words.iter().map(|word| text.width(word)).fold(0.0, f32::max);
        let (width, height) = self.cells.size();
        let of_cell = |cell: &Cell| match cell {
            Cell::Given(number) | Cell::Answer(number) => text.face(Face::Bold).width(number) + 0.3 * small,
            Cell::Blank | Cell::Unknown => Self::CELL[0] * small,
        };
        let of_column = |x: usize| {
            let head = self.columns.get(x).map_or(0.0, |name| text.width(name) + 0.3 * small);
            (0..height).map(|y| of_cell(&self.cells[(x, y)])).fold(head.max(Self::CELL[0] * small), f32::max).ceil()
        };
        let widths: Vec<f32> = (0..width).map(of_column).collect();
        let row = (Self::CELL[1] * small).ceil();
        let left = if self.rows.is_empty() { 0.0 } else { widest(&self.rows) + 0.6 * small };
        let top = (if self.columns.is_empty() { 1.5 } else { 2.9 }) * small;
        let size = [left + widths.iter().sum::<f32>(), top + height as f32 * row];
        let place = |x: usize, y: usize| {
            Rect::new([left + widths[..x].iter().sum::<f32>(), top + y as f32 * row], [widths[x], row])
        };
        let mut canvas = Canvas::default();
        let room = size[0].max(14.0 * small);
        canvas.text([0.0, 0.0], (Anchor::Start, Level::Top), &shortened(&self.title, text, room), text);
        for (x, name) in self.columns.iter().enumerate() {
            let at = [middle(&place(x, 0))[0], top - 0.2 * small];
            canvas.text(at, (Anchor::Middle, Level::Bottom), name, dim);
        }
        for (y, name) in self.rows.iter().enumerate() {
            canvas.text([left - 0.4 * small, middle(&place(0, y))[1]], (Anchor::End, Level::Middle), name, dim);
        }
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let rect = place(x, y);
            let (words, style) = match &self.cells[(x, y)] {
                Cell::Given(number) => (number.as_str(), text),
                Cell::Answer(number) => (number.as_str(), text.face(Face::Bold).color(theme.word(Role::Result))),
                Cell::Blank | Cell::Unknown => ("", text),
            };
            if self.cells[(x, y)] == Cell::Unknown {
                canvas.fill(rect, chrome.raised);
            }
            canvas.frame(rect, 0.5, chrome.dim);
            canvas.text(middle(&rect), (Anchor::Middle, Level::Middle), words, style);
        }
        let boxes = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        boxes.filter(|at| matches!(self.cells[*at], Cell::Blank | Cell::Answer(_))).for_each(|(x, y)| {
            canvas.frame(place(x, y), 1.5, chrome.text);
        });
        for (role, [x, y]) in self.framed.iter().filter(|(_, [x, y])| *x < width && *y < height) {
            canvas.frame(place(*x, *y).grown(-1.5), 2.0, theme.stroke(*role));
        }
        let size = [room, size[1]];
        let lines = vec![(Rect::new([0.0; 2], size), self.title.clone())];
        Block { size, primitives: canvas.into_primitives(), lines, ..Block::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::super::texts;
    use super::*;

    #[test]
    fn given_numbers_and_answers_stand_there_and_blanks_are_empty() {
        let cell = |x: usize, y: usize| match (x, y) {
            (0, 0) => Cell::Given("812".into()),
            (1, 0) => Cell::Blank,
            (0, 1) => Cell::Answer("44".into()),
            _ => Cell::Unknown,
        };
        let (columns, rows) = (vec!["−1".into(), "0".into()], vec!["u".into(), "v".into()]);
        let table = Table { title: "SAD".into(), columns, rows, cells: Grid::from_fn(2, 2, cell), framed: Vec::new() };
        let block = table.draw(Theme::Light);
        assert_eq!(texts(&block.primitives), ["SAD", "−1", "0", "u", "v", "812", "44"]);
    }
}
