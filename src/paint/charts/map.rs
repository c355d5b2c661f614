//! A part of the plane of displacements, with its axes.

use super::super::primitive::{Anchor, Point, Rect};
use super::super::{Face, Theme, number};
use super::axis::Axis;
use super::canvas::{Canvas, Level, Type};

/// Where a map of displacements lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Map {
    /// Where it lies.
    pub rect: Rect,
    /// Side of the cell of a displacement, in points.
    pub cell: f32,
    /// Size of the type around it.
    pub small: f32,
    origin: [i32; 2],
    size: [usize; 2],
    /// Cells per px.
    per_px: f32,
    /// Whether the names of the axes share the rows of what stands above and of the numbers below.
    is_tight: bool,
}

/// What the axes are called. The first goes to the right, the second down, as in the picture.
const NAMES: [&str; 2] = ["u, px →", "v, px ↓"];

impl Map {
    /// A map in `area` of `size` displacements from `origin` on, `right` letters free beside it.
    pub fn new((origin, size): ([i32; 2], (usize, usize)), area: Rect, right: f32, theme: Theme) -> Self {
        let small = theme.sizes().small;
        let size = [size.0, size.1];
        // Room for the header and the numbers at the axes.
        let is_tight = super::is_tight(area, small);
        let [above, below] = if is_tight { [1.7, 1.7] } else { [3.2, 3.2] };
        let min = [area.min[0] + 3.8 * small, area.min[1] + above * small];
        let max = [area.max[0] - right * small, area.max[1] - below * small];
        let room = [0, 1].map(|i| (max[i] - min[i]).max(8.0));
        let cell = [0, 1].map(|i| room[i] / size[i].max(1) as f32);
        let cell = cell[0].min(cell[1]);
        let extent = size.map(|n| n as f32 * cell);
        // What is not needed is left on both sides.
        let left = (min[0] + (room[0] - extent[0]).max(0.0) / 2.0).round();
        Self { rect: Rect::new([left, min[1].round()], extent), cell, small, origin, size, per_px: 1.0, is_tight }
    }

    /// The same map with so many cells per px.
    #[must_use]
    pub fn with_cells_per_px(self, count: i32) -> Self {
        Self { per_px: count.max(1) as f32, ..self }
    }

    /// The displacement at a place, in cells.
    pub fn displacement(&self, at: Point) -> Option<[i32; 2]> {
        let cells = [0, 1].map(|i| ((at[i] - self.rect.min[i]) / self.cell).floor());
        let inside = (0..2).all(|i| cells[i] >= 0.0 && cells[i] < self.size[i] as f32);
        inside.then(|| [0, 1].map(|i| self.origin[i] + cells[i] as i32))
    }

    /// The cell of a displacement in cells.
    pub fn cell_rect(&self, uv: [i32; 2]) -> Rect {
        let place = [0, 1].map(|i| self.rect.min[i] + (uv[i] - self.origin[i]) as f32 * self.cell);
        Rect::new(place, [self.cell; 2])
    }

    /// The axis of displacements along x or y; ticks stand at the middle of cells.
    pub fn axis(&self, which: usize) -> Axis {
        let first = self.origin[which] as f32;
        let last = first + self.size[which].saturating_sub(1) as f32;
        let half = self.cell / 2.0;
        Axis::new(
            [first, last].map(|cell| cell / self.per_px),
            [self.rect.min[which] + half, self.rect.max[which] - half],
        )
    }

    /// Draws the frame, and numbers along two sides.
    pub fn axes(&self, canvas: &mut Canvas, theme: Theme) {
        let (chrome, small) = (theme.chrome(), self.small);
        let (dim, text) = (Type::dim(theme), Type::text(theme).face(Face::Italic));
        let (bottom, left) = (self.rect.max[1], self.rect.min[0]);
        canvas.frame(self.rect.grown(0.5), 1.0, chrome.line);
        for tick in self.axis(0).displacement_ticks(2.8 * small) {
            let x = self.axis(0).place(tick);
            canvas.down(x, [bottom, bottom + 4.0], chrome.dim);
            canvas.text([x, bottom + 6.0], (Anchor::Middle, Level::Top), &number(tick), dim);
        }
        for tick in self.axis(1).displacement_ticks(1.8 * small) {
            let y = self.axis(1).place(tick);
            canvas.across([left - 4.0, left], y, chrome.dim);
            canvas.text([left - 7.0, y], (Anchor::End, Level::Middle), &number(tick), dim);
        }
        let [u, v] = NAMES;
        if self.is_tight {
            canvas.text([self.rect.max[0] + 0.8 * small, bottom + 6.0], (Anchor::Start, Level::Top), u, text);
        } else {
            canvas.text([self.rect.max[0], bottom + 6.0 + 1.25 * small], (Anchor::End, Level::Top), u, text);
        }
        let above = [left - 7.0, self.rect.min[1] - 0.3 * small];
        canvas.text(above, (Anchor::Middle, Level::Bottom), v, text);
    }

    /// Where what stands above the map begins.
    pub fn head_left(&self, area: Rect, theme: Theme) -> f32 {
        let half = Type::text(theme).face(Face::Italic).width(NAMES[1]) / 2.0;
        if self.is_tight { self.rect.min[0] - 7.0 + half + self.small } else { area.min[0] }
    }

    /// Where the name of the first axis begins, in the row below the numbers.
    pub fn name_left(&self, theme: Theme) -> f32 {
        self.rect.max[0] - Type::text(theme).face(Face::Italic).width(NAMES[0])
    }

    /// The top of the row below the numbers.
    pub fn below(&self) -> f32 {
        self.rect.max[1] + 6.0 + 1.25 * self.small
    }

    /// Whether words share rows.
    pub fn is_tight(&self) -> bool {
        self.is_tight
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_finds_the_displacement_whose_cell_it_is_in() {
        let area = Rect::new([20.0, 10.0], [500.0, 300.0]);
        let map = Map::new(([-16, -8], (33, 17)), area, 7.5, Theme::Dark);
        assert!((0..2).all(|i| area.min[i] <= map.rect.min[i] && map.rect.max[i] <= area.max[i]));
        for at in [[-16, -8], [0, 0], [16, 8], [5, -3]] {
            let cell = map.cell_rect(at);
            let middle = [0, 1].map(|i| (cell.min[i] + cell.max[i]) / 2.0);
            assert_eq!(map.displacement(middle), Some(at));
            for i in 0..2 {
                assert!((map.axis(i).place(at[i] as f32) - middle[i]).abs() < 0.01);
            }
        }
        assert_eq!(map.displacement(area.min), None);
    }
}
