//! Typical directions of motion: the mean direction of the tracks through each cell of a grid.
//!
//! After C. Stauffer and W. E. L. Grimson, Learning patterns of activity using real-time tracking, PAMI 2000, in its simplest
//! form; circular means as in K. V. Mardia and P. E. Jupp, Directional statistics, 2000.

use crate::geometry::Grid;

/// The directions of tracks in the cells of a grid over the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Directions {
    /// Side of a cell in px.
    pub side_px: usize,
    cells: Grid<Vec<TrackDirection>>,
}

/// The mean direction of one track in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TrackDirection {
    id: u32,
    /// The sum of its unit direction vectors.
    sum: [f64; 2],
    /// The direction of that sum, a unit vector; none where the sum is zero.
    direction: Option<[f64; 2]>,
}

impl TrackDirection {
    fn new(id: u32, sum: [f64; 2]) -> Self {
        let length = sum[0].hypot(sum[1]);
        Self { id, sum, direction: (length > 0.0).then(|| sum.map(|c| c / length)) }
    }
}

/// The mean direction of tracks in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanDirection {
    /// The circular mean, a unit vector.
    pub direction: [f64; 2],
    /// The mean resultant length, 0 (uniform) to 1 (all equal).
    pub agreement: f64,
    /// The number of tracks.
    pub others: usize,
}

impl Directions {
    /// Creates an empty grid over a picture of this size.
    pub fn new((width, height): (usize, usize), side_px: usize) -> Self {
        let side_px = side_px.max(1);
        Self { side_px, cells: Grid::new(width.div_ceil(side_px), height.div_ceil(side_px), Vec::new()) }
    }

    /// Returns the cell of a position; the nearest one outside the picture.
    fn cell(&self, at: [f64; 2]) -> (usize, usize) {
        let (width, height) = self.cells.size();
        let index = |c: f64, count: usize| ((c + 0.5) / self.side_px as f64).clamp(0.0, count as f64 - 1.0) as usize;
        (index(at[0], width), index(at[1], height))
    }

    /// Adds the direction of a track at a position.
    pub fn learn(&mut self, id: u32, at: [f64; 2], direction: [f64; 2]) {
        let cell = self.cell(at);
        let passed = &mut self.cells[cell];
        // A track that passes is usually among the last entries.
        match passed.iter_mut().rev().find(|passed| passed.id == id) {
            Some(passed) => *passed = TrackDirection::new(id, [0, 1].map(|i| passed.sum[i] + direction[i])),
            None => passed.push(TrackDirection::new(id, direction)),
        }
    }

    /// Returns the mean direction of the tracks other than `id` at a position. Each track counts once.
    pub fn mean_of_others(&self, id: u32, at: [f64; 2]) -> Option<MeanDirection> {
        mean(self.cells[self.cell(at)].iter().filter(|passed| passed.id != id))
    }

    /// Returns the centre and the mean direction of each cell with at least `least` tracks.
    pub fn all(&self, least: usize) -> Vec<([f32; 2], MeanDirection)> {
        let (width, height) = self.cells.size();
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let middle = |c: usize| (c as f32 + 0.5) * self.side_px as f32 - 0.5;
        let known = places.filter_map(|(x, y)| Some(([middle(x), middle(y)], mean(self.cells[(x, y)].iter())?)));
        known.filter(|(_, mean)| mean.others >= least).collect()
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        let passed: usize = self.cells.cells().iter().map(|cell| size_of_val(&cell[..])).sum();
        size_of_val(self.cells.cells()) + passed
    }
}

fn mean<'a>(passed: impl Iterator<Item = &'a TrackDirection>) -> Option<MeanDirection> {
    let (mut sum, mut others) = ([0.0, 0.0], 0);
    for [u, v] in passed.filter_map(|passed| passed.direction) {
        sum = [sum[0] + u, sum[1] + v];
        others += 1;
    }
    let length = f64::hypot(sum[0], sum[1]);
    (length > 0.0).then(|| MeanDirection {
        direction: sum.map(|c| c / length),
        agreement: length / others as f64,
        others,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_object_counts_once() {
        let mut directions = Directions::new((100, 50), 20);
        for _ in 0..50 {
            directions.learn(1, [30.0, 30.0], [1.0, 0.0]);
        }
        directions.learn(2, [31.0, 39.4], [0.0, 1.0]);
        let usual = directions.mean_of_others(3, [25.0, 25.0]).expect("two have passed");
        let diagonal = 0.5f64.sqrt();
        assert!(usual.direction.iter().all(|c| (c - diagonal).abs() < 1e-12), "{usual:?}");
        assert!((usual.agreement - diagonal).abs() < 1e-12 && usual.others == 2);
        assert_eq!(
            directions.mean_of_others(2, [25.0, 25.0]).map(|mean| mean.direction),
            Some([1.0, 0.0]),
            "without itself"
        );
        assert_eq!(directions.mean_of_others(3, [5.0, 25.0]), None, "an empty cell");
    }

    #[test]
    fn opposite_ways_have_no_mean_and_places_outside_are_the_nearest_inside() {
        let mut directions = Directions::new((40, 40), 20);
        directions.learn(1, [-80.0, 5.0], [1.0, 0.0]);
        directions.learn(2, [3.0, -9.0], [-1.0, 0.0]);
        assert_eq!(directions.mean_of_others(9, [0.0, 0.0]), None);
        directions.learn(3, [1e9, f64::from(u16::MAX)], [0.0, 1.0]);
        assert_eq!(directions.all(1).iter().map(|(at, _)| *at).collect::<Vec<_>>(), [[29.5, 29.5]]);
    }
}
