//! Seeds of a clustering by k-means++.

use super::points::{Place, Points};
use crate::synth::random::{hash, unit};

/// A stream of random numbers for the seeds.
const SEEDS: u64 = 0x5EED;

/// A seed: a point that becomes a mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seed {
    /// The index of the point.
    pub point: usize,
    /// Its coordinates.
    pub place: Place,
    /// Its squared distance from the nearest earlier seed; infinite for the first.
    pub squared_distance: f32,
    /// The sum of these over all points: its chance is the ratio of both.
    pub sum: f64,
}

/// The draw of seeds, one after the other (D. Arthur and S. Vassilvitskii 2007): each point with a probability in proportion to its squared
/// distance from the nearest seed so far. Of several points drawn, the one that leaves the smallest sum becomes the seed (the greedy variant of
/// the same paper).
#[derive(Clone, Debug)]
pub struct Seeds {
    /// The squared distance of each point from the nearest seed so far.
    distances: Vec<f32>,
    seed: u64,
    drawn: u64,
    /// Points drawn for each seed.
    trials: usize,
}

impl Seeds {
    /// Begins a draw of `count` seeds for `points`.
    pub fn new(points: &Points, count: usize, seed: usize) -> Self {
        let trials = 2 + (count as f64).ln() as usize;
        Self { distances: vec![f32::INFINITY; points.len()], seed: seed as u64, drawn: 0, trials }
    }

    /// Draws the next seed; `None` if all points lie on earlier seeds, or there are none.
    pub fn next(&mut self, points: &Points) -> Option<Seed> {
        if self.distances.is_empty() {
            return None;
        }
        if self.drawn == 0 {
            let point = ((self.number() * points.len() as f64) as usize).min(points.len() - 1);
            let seed = Seed { point, place: points.at(point), squared_distance: f32::INFINITY, sum: f64::INFINITY };
            points.lower(&mut self.distances, &seed.place);
            return Some(seed);
        }
        let sum: f64 = self.distances.iter().map(|d| f64::from(*d)).sum();
        if sum <= 0.0 {
            return None;
        }
        let mut best: Option<(f64, Seed, Vec<f32>)> = None;
        for _ in 0..self.trials {
            let point = self.drawn_from(sum);
            let place = points.at(point);
            let mut distances = self.distances.clone();
            points.lower(&mut distances, &place);
            let left: f64 = distances.iter().map(|d| f64::from(*d)).sum();
            if best.as_ref().is_none_or(|(least, ..)| left < *least) {
                let seed = Seed { point, place, squared_distance: self.distances[point], sum };
                best = Some((left, seed, distances));
            }
        }
        let (_, seed, distances) = best?;
        self.distances = distances;
        Some(seed)
    }

    /// A random number from 0 to below 1.
    fn number(&mut self) -> f64 {
        self.drawn += 1;
        unit(hash(self.seed, SEEDS, self.drawn))
    }

    /// The point at a random share of the sum of squared distances.
    fn drawn_from(&mut self, sum: f64) -> usize {
        let mut left = self.number() * sum;
        let mut last = 0;
        for (i, distance) in self.distances.iter().enumerate().filter(|(_, distance)| **distance > 0.0) {
            last = i;
            left -= f64::from(*distance);
            if left < 0.0 {
                break;
            }
        }
        last
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_lie_in_different_groups_and_end_with_them() {
        let points = Points::new(vec![(0..300).map(|i| [0.0, 5.0, 9.0][i % 3]).collect()]);
        for seed in 0..20 {
            let mut seeds = Seeds::new(&points, 5, seed);
            let mut found: Vec<f32> = std::iter::from_fn(|| seeds.next(&points)).map(|seed| seed.place[0]).collect();
            found.sort_by(f32::total_cmp);
            assert_eq!(found, [0.0, 5.0, 9.0]);
        }
        assert_eq!(Seeds::new(&Points::new(vec![Vec::new(); 2]), 3, 0).next(&Points::new(vec![Vec::new(); 2])), None);
    }

    #[test]
    fn the_chance_of_a_point_goes_with_its_squared_distance() {
        // One point at 1 and one at 2 from the place where half of all first seeds are drawn.
        let values: Vec<f32> = (0..1000)
            .map(|i| {
                if i == 0 {
                    1.0
                } else if i == 1 {
                    2.0
                } else {
                    0.0
                }
            })
            .collect();
        let points = Points::new(vec![values]);
        let drawn = |seed: usize| {
            let mut seeds = Seeds { trials: 1, ..Seeds::new(&points, 2, seed) };
            (seeds.next(&points).expect("a point").place[0] == 0.0)
                .then(|| seeds.next(&points).expect("a point").place[0])
        };
        let all: Vec<f32> = (0..2000).filter_map(drawn).collect();
        let share = all.iter().filter(|place| **place == 2.0).count() as f64 / all.len() as f64;
        assert!(all.len() > 1900 && (share - 0.8).abs() < 0.03, "{share}");
    }
}
