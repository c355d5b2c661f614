//! Work spread over the rows of grids.

use super::Grid;
use crate::base::Threads;

impl Threads {
    /// Has `f` write every row of `grid`, given its number; the rows are written in any order.
    pub fn rows<T: Send>(&self, grid: &mut Grid<T>, f: impl Fn(usize, &mut [T]) + Sync) {
        let width = grid.width();
        self.chunks(grid.cells_mut(), width, f);
    }

    /// Has `f` write every row of all `grids`, which are of one size, given its number, in any order. What it gives of each
    /// row, in theirs.
    pub(crate) fn rows_of<T: Send, R: Send, const N: usize>(
        &self,
        grids: [&mut Grid<T>; N],
        f: impl Fn(usize, [&mut [T]; N]) -> R + Send + Sync,
    ) -> Vec<R> {
        let height = grids.first().map_or(0, |grid| grid.height());
        let mut rows = grids.map(|grid| {
            let width = grid.width().max(1);
            grid.cells_mut().chunks_exact_mut(width)
        });
        let rows = (0..height).map(|y| (y, rows.each_mut().map(|rows| rows.next().unwrap_or_default())));
        self.gather(rows, |(y, rows)| f(y, rows))
    }
}
