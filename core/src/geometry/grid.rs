//! A row-major 2-D array, the one border rule, and bilinear sampling.

use std::ops::{Index, IndexMut};

use crate::base::Error;

/// A row-major 2-D array of `width × height` cells; `(x, y)` is x right, y down.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid<T> {
    width: usize,
    height: usize,
    cells: Vec<T>,
}

/// A gray picture, 8 bits per pixel.
pub type Gray = Grid<u8>;

impl<T> Grid<T> {
    /// A grid whose cell at `(x, y)` is `f(x, y)`.
    pub fn from_fn(width: usize, height: usize, mut f: impl FnMut(usize, usize) -> T) -> Self {
        let mut cells = Vec::with_capacity(width * height);
        for y in 0..height {
            for x in 0..width {
                cells.push(f(x, y));
            }
        }
        Self { width, height, cells }
    }

    /// A grid over row-major `cells`.
    ///
    /// # Errors
    /// If there are not exactly `width × height` cells.
    pub fn from_vec(width: usize, height: usize, cells: Vec<T>) -> Result<Self, Error> {
        if width.checked_mul(height) == Some(cells.len()) {
            Ok(Self { width, height, cells })
        } else {
            Err(Error::new(format!("{} values do not fill a grid of {width}×{height} cells", cells.len())))
        }
    }

    /// Width in cells.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in cells.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Width and height in cells.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// The cell at `(x, y)`, or `None` outside the grid.
    pub fn get(&self, x: usize, y: usize) -> Option<&T> {
        (x < self.width && y < self.height).then(|| &self.cells[y * self.width + x])
    }

    /// The cell whose square contains `point`, if any.
    pub fn cell_at(&self, point: [f32; 2]) -> Option<(usize, usize)> {
        let inside = |c: f32, extent: usize| (c >= -0.5 && c < extent as f32 - 0.5).then(|| c.round() as usize);
        Some((inside(point[0], self.width)?, inside(point[1], self.height)?))
    }

    /// Row `y`, left to right.
    ///
    /// # Panics
    /// If `y` is not below the height.
    pub fn row(&self, y: usize) -> &[T] {
        &self.cells[y * self.width..(y + 1) * self.width]
    }

    /// Row `y`, to be written.
    ///
    /// # Panics
    /// If `y` is not below the height.
    pub fn row_mut(&mut self, y: usize) -> &mut [T] {
        &mut self.cells[y * self.width..(y + 1) * self.width]
    }

    /// All cells, row by row.
    pub fn cells(&self) -> &[T] {
        &self.cells
    }

    /// All cells, row by row, to be written.
    pub fn cells_mut(&mut self) -> &mut [T] {
        &mut self.cells
    }

    /// The cells, row by row.
    pub fn into_cells(self) -> Vec<T> {
        self.cells
    }

    /// A grid of the same size with `f` of every cell.
    pub fn map<U>(&self, f: impl FnMut(&T) -> U) -> Grid<U> {
        Grid { width: self.width, height: self.height, cells: self.cells.iter().map(f).collect() }
    }
}

impl<T: Clone> Grid<T> {
    /// A grid with `value` in every cell.
    pub fn new(width: usize, height: usize, value: T) -> Self {
        Self { width, height, cells: vec![value; width * height] }
    }
}

impl<T: Copy> Grid<T> {
    /// The cell at `(x, y)`, with coordinates outside mapped inside by `border`.
    ///
    /// # Panics
    /// If the grid is empty.
    pub fn at(&self, x: isize, y: isize, border: Border) -> T {
        self.cells[border.index(y, self.height) * self.width + border.index(x, self.width)]
    }
}

impl<T: Copy + Into<f32>> Grid<T> {
    /// The bilinearly interpolated value at `(x, y)`; beyond the border the edge is repeated.
    ///
    /// # Panics
    /// If the grid is empty.
    pub fn sample(&self, x: f32, y: f32) -> f32 {
        let x = x.clamp(0.0, (self.width - 1) as f32);
        let y = y.clamp(0.0, (self.height - 1) as f32);
        let (x0, y0) = (x as usize, y as usize);
        let (x1, y1) = ((x0 + 1).min(self.width - 1), (y0 + 1).min(self.height - 1));
        let (fx, fy) = (x - x0 as f32, y - y0 as f32);
        let mix = |a: T, b: T, f: f32| a.into() + (b.into() - a.into()) * f;
        let top = mix(self[(x0, y0)], self[(x1, y0)], fx);
        let bottom = mix(self[(x0, y1)], self[(x1, y1)], fx);
        top + (bottom - top) * fy
    }
}

impl<T> Index<(usize, usize)> for Grid<T> {
    type Output = T;
    fn index(&self, (x, y): (usize, usize)) -> &T {
        debug_assert!(x < self.width);
        &self.cells[y * self.width + x]
    }
}

impl<T> IndexMut<(usize, usize)> for Grid<T> {
    fn index_mut(&mut self, (x, y): (usize, usize)) -> &mut T {
        debug_assert!(x < self.width);
        &mut self.cells[y * self.width + x]
    }
}

/// Border rule: the mapping of a coordinate outside a picture to one inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Border {
    /// The edge pixel is repeated: `aaa|abcd|ddd`.
    Replicate,
    /// The picture is mirrored at its edge pixel: `dcb|abcd|cba`.
    Mirror,
}

impl Border {
    /// The index inside `0..len` that `i` stands for.
    ///
    /// # Panics
    /// If `len` is zero.
    pub fn index(self, i: isize, len: usize) -> usize {
        assert!(len > 0, "an empty picture has no border");
        let last = len as isize - 1;
        match self {
            Border::Replicate => i.clamp(0, last) as usize,
            Border::Mirror if last == 0 => 0,
            Border::Mirror => {
                let folded = i.rem_euclid(2 * last);
                folded.min(2 * last - folded) as usize
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn borders_fold_back_by_their_rule() {
        let read = |border: Border| (-3..7).map(|i| border.index(i, 4)).collect::<Vec<_>>();
        assert_eq!(read(Border::Replicate), [0, 0, 0, 0, 1, 2, 3, 3, 3, 3]);
        assert_eq!(read(Border::Mirror), [3, 2, 1, 0, 1, 2, 3, 2, 1, 0]);
        assert_eq!(Border::Mirror.index(-5, 1), 0);
    }

    #[test]
    fn a_cell_is_the_square_around_its_middle() {
        let grid = Grid::new(3, 2, 0);
        assert_eq!((grid.cell_at([-0.5, 1.4]), grid.cell_at([2.4, 0.6])), (Some((0, 1)), Some((2, 1))));
        assert!([[-0.6, 0.0], [2.5, 0.0], [0.0, 1.5], [f32::NAN, 0.0]].iter().all(|p| grid.cell_at(*p).is_none()));
    }

    #[test]
    fn bilinear_sampling_is_exact_on_a_plane() {
        let plane = Grid::from_fn(5, 4, |x, y| 2.0 * x as f32 + 3.0 * y as f32);
        assert_eq!(plane.sample(1.25, 2.5), 2.0 * 1.25 + 3.0 * 2.5);
        assert_eq!(plane.sample(-4.0, 99.0), 9.0);
    }

    #[test]
    fn a_grid_refuses_the_wrong_number_of_cells() {
        assert!(Grid::from_vec(2, 3, vec![0; 5]).is_err());
        assert!(Grid::from_vec(usize::MAX, 2, vec![0; 5]).is_err());
    }
}
