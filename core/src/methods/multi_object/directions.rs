//! Where objects usually go: the mean direction of those that passed each part of the picture.
//!
//! After C. Stauffer and W. E. L. Grimson, Learning patterns of activity using real-time tracking, PAMI 2000, in its plainest
//! form; means of directions as in K. V. Mardia and P. E. Jupp, Directional statistics, 2000.

use crate::geometry::Grid;

/// Directions in the parts of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Directions {
    /// Side of a part in px.
    pub side_px: usize,
    parts: Grid<Vec<TrackDirection>>,
}

/// What one object has left in a part.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TrackDirection {
    id: u32,
    /// The sum of its directions, unit vectors.
    sum: [f64; 2],
    /// The direction of that sum, a unit vector; none where it is nothing.
    direction: Option<[f64; 2]>,
}

impl TrackDirection {
    fn new(id: u32, sum: [f64; 2]) -> Self {
        let length = sum[0].hypot(sum[1]);
        Self { id, sum, direction: (length > 0.0).then(|| sum.map(|c| c / length)) }
    }
}

/// Where others go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanDirection {
    /// The mean of their directions, a unit vector.
    pub direction: [f64; 2],
    /// How well they agree, 0 to 1: the length of the mean of unit vectors.
    pub agreement: f64,
    /// How many there were.
    pub others: usize,
}

impl Directions {
    /// Nothing is known yet of a picture of that size.
    pub fn new((width, height): (usize, usize), side_px: usize) -> Self {
        let side_px = side_px.max(1);
        Self { side_px, parts: Grid::new(width.div_ceil(side_px), height.div_ceil(side_px), Vec::new()) }
    }

    /// The part in which a place lies; the nearest one outside the picture.
    fn part(&self, at: [f64; 2]) -> (usize, usize) {
        let (width, height) = self.parts.size();
        let index = |c: f64, count: usize| ((c + 0.5) / self.side_px as f64).clamp(0.0, count as f64 - 1.0) as usize;
        (index(at[0], width), index(at[1], height))
    }

    /// Takes in that an object goes in a direction at a place.
    pub fn learn(&mut self, id: u32, at: [f64; 2], direction: [f64; 2]) {
        let part = self.part(at);
        let passed = &mut self.parts[part];
        // Whoever passes is mostly among the last that came.
        match passed.iter_mut().rev().find(|passed| passed.id == id) {
            Some(passed) => *passed = TrackDirection::new(id, [0, 1].map(|i| passed.sum[i] + direction[i])),
            None => passed.push(TrackDirection::new(id, direction)),
        }
    }

    /// Where objects but `id` go at a place. Each counts once, however long it was there.
    pub fn mean_of_others(&self, id: u32, at: [f64; 2]) -> Option<MeanDirection> {
        mean(self.parts[self.part(at)].iter().filter(|passed| passed.id != id))
    }

    /// The middle of each part that at least so many objects have passed, and where they usually go there.
    pub fn all(&self, least: usize) -> Vec<([f32; 2], MeanDirection)> {
        let (width, height) = self.parts.size();
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let middle = |c: usize| (c as f32 + 0.5) * self.side_px as f32 - 0.5;
        let known = places.filter_map(|(x, y)| Some(([middle(x), middle(y)], mean(self.parts[(x, y)].iter())?)));
        known.filter(|(_, usual)| usual.others >= least).collect()
    }

    /// Memory that it takes, in bytes.
    pub fn bytes(&self) -> usize {
        let passed: usize = self.parts.cells().iter().map(|part| size_of_val(&part[..])).sum();
        size_of_val(self.parts.cells()) + passed
    }
}

fn mean<'a>(passed: impl Iterator<Item = &'a TrackDirection>) -> Option<MeanDirection> {
    let (mut sum, mut others) = ([0.0, 0.0], 0);
    for [u, v] in passed.filter_map(|passed| passed.direction) {
        sum = [sum[0] + u, sum[1] + v];
        others += 1;
    }
    let length = f64::hypot(sum[0], sum[1]);
    (length > 0.0).then(|| MeanDirection { direction: sum.map(|c| c / length), agreement: length / others as f64, others })
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
        assert_eq!(directions.mean_of_others(2, [25.0, 25.0]).map(|usual| usual.direction), Some([1.0, 0.0]), "without itself");
        assert_eq!(directions.mean_of_others(3, [5.0, 25.0]), None, "nobody was there");
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
