//! The points of a clustering: a few coordinates for each pixel, block or sample.

use crate::base::{Threads, effort, wide::wide};

/// The largest number of coordinates.
pub const MOST_DIMENSIONS: usize = 6;
/// Points that are gone through at once: a fixed number, so that sums have one order on any number of threads.
const CHUNK: usize = 1024;

/// A place among the points: their coordinates, 0 beyond their number.
pub type Place = [f32; MOST_DIMENSIONS];

/// Points with their coordinates apart from each other, so that loops over them vectorise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// The values of each coordinate.
    coordinates: Vec<Vec<f32>>,
}

/// The result of assigning points to their nearest means.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// Number of points whose mean has changed.
    pub changed: usize,
    /// Sum of the squared distances of the points from their means.
    pub inertia: f64,
    /// Number of points of each mean.
    pub counts: Vec<usize>,
    /// Sums of the coordinates of the points of each mean.
    sums: Vec<[f64; MOST_DIMENSIONS]>,
}

/// Returns the squared Euclidean distance of two places.
pub fn squared_distance(a: &Place, b: &Place) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

impl Points {
    /// Creates points from the values of each coordinate.
    ///
    /// # Panics
    /// If these are more than [`MOST_DIMENSIONS`] or differ in number.
    pub fn new(coordinates: Vec<Vec<f32>>) -> Self {
        assert!(
            coordinates.len() <= MOST_DIMENSIONS && coordinates.windows(2).all(|pair| pair[0].len() == pair[1].len())
        );
        Self { coordinates }
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the number of points.
    pub fn len(&self) -> usize {
        self.coordinates.first().map_or(0, Vec::len)
    }

    /// Returns the number of coordinates of each.
    pub fn dimensions(&self) -> usize {
        self.coordinates.len()
    }

    /// Returns point `index`.
    pub fn at(&self, index: usize) -> Place {
        let mut place = [0.0; MOST_DIMENSIONS];
        place.iter_mut().zip(&self.coordinates).for_each(|(c, values)| *c = values[index]);
        place
    }

    /// Returns at most `most` of the points, one from each of as many equal parts of their order. Where in its part one lies changes by
    /// the golden section: at equal distances in the order of an image only few of its columns would be sampled.
    pub fn sampled(&self, most: usize) -> (Self, Vec<usize>) {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let count = self.len().min(most);
        let part = self.len() as f64 / count.max(1) as f64;
        let inside = |i: usize| if count < self.len() { (GOLDEN * (i as f64 + 0.5)).fract() } else { 0.0 };
        let indices: Vec<usize> = (0..count).map(|i| ((i as f64 + inside(i)) * part) as usize).collect();
        let values = |values: &Vec<f32>| indices.iter().map(|i| values[*i]).collect();
        (Self { coordinates: self.coordinates.iter().map(values).collect() }, indices)
    }

    /// Returns the size in memory in bytes.
    pub fn bytes(&self) -> usize {
        self.coordinates.iter().map(|values| size_of_val(&values[..])).sum()
    }

    /// Lowers each of `distances` to the squared distance of its point from `mean`, if that is less.
    pub fn lower(&self, distances: &mut [f32], mean: &Place) {
        effort::add(self.len());
        for (chunk, distances) in distances.chunks_mut(CHUNK).enumerate() {
            let mut own = [0.0; CHUNK];
            self.distances(chunk, mean, &mut own);
            distances.iter_mut().zip(own).for_each(|(least, own)| *least = least.min(own));
        }
    }

    /// Writes the squared distances of the points of a chunk from `mean`.
    #[inline(always)]
    fn distances(&self, chunk: usize, mean: &Place, to: &mut [f32; CHUNK]) {
        *to = [0.0; CHUNK];
        for (values, mean) in self.coordinates.iter().zip(mean) {
            let values = &values[chunk * CHUNK..values.len().min((chunk + 1) * CHUNK)];
            to.iter_mut().zip(values).for_each(|(sum, value)| *sum += (value - mean) * (value - mean));
        }
    }

    /// Assigns each point to the nearest of `means`, the first of several, and writes their indices to `nearest`.
    ///
    /// # Panics
    /// If there are no means or more than 255, or `nearest` has another number of points.
    pub fn assign(&self, means: &[Place], nearest: &mut [u8], threads: &Threads) -> Tally {
        assert!((1..=255).contains(&means.len()) && nearest.len() == self.len());
        effort::add(self.len());
        let chunks = nearest.chunks_mut(CHUNK).enumerate();
        let parts = threads.gather(chunks, |(chunk, nearest)| assign_chunk(self, chunk, means, nearest));
        let mut whole =
            Tally { counts: vec![0; means.len()], sums: vec![[0.0; MOST_DIMENSIONS]; means.len()], ..Tally::default() };
        parts.iter().for_each(|part| whole.add(part));
        whole
    }
}

wide! {
    fn assign_chunk(points: &Points, chunk: usize, means: &[Place], nearest: &mut [u8]) -> Tally = assign_chunk_by
}

#[inline(always)]
fn assign_chunk_by(points: &Points, chunk: usize, means: &[Place], nearest: &mut [u8]) -> Tally {
    let (mut least, mut index, mut own) = ([f32::INFINITY; CHUNK], [0u32; CHUNK], [0.0f32; CHUNK]);
    for (j, mean) in means.iter().enumerate() {
        points.distances(chunk, mean, &mut own);
        for ((least, index), own) in least.iter_mut().zip(&mut index).zip(&own) {
            let is_nearer = *own < *least;
            *index = if is_nearer { j as u32 } else { *index };
            *least = if is_nearer { *own } else { *least };
        }
    }
    let mut tally =
        Tally { counts: vec![0; means.len()], sums: vec![[0.0; MOST_DIMENSIONS]; means.len()], ..Tally::default() };
    for ((known, index), least) in nearest.iter_mut().zip(&index).zip(&least) {
        tally.changed += usize::from(u32::from(*known) != *index);
        tally.inertia += f64::from(*least);
        tally.counts[*index as usize] += 1;
        *known = *index as u8;
    }
    for (d, values) in points.coordinates.iter().enumerate() {
        let values = &values[chunk * CHUNK..];
        for (value, index) in values.iter().zip(&index[..nearest.len()]) {
            tally.sums[*index as usize][d] += f64::from(*value);
        }
    }
    tally
}

impl Tally {
    fn add(&mut self, other: &Self) {
        self.changed += other.changed;
        self.inertia += other.inertia;
        self.counts.iter_mut().zip(&other.counts).for_each(|(sum, count)| *sum += count);
        let own = self.sums.iter_mut().flatten();
        own.zip(other.sums.iter().flatten()).for_each(|(sum, other)| *sum += other);
    }

    /// Returns the mean of the points of mean `index`; `None` if it has none.
    pub fn mean(&self, index: usize) -> Option<Place> {
        let count = self.counts[index];
        (count > 0).then(|| self.sums[index].map(|sum| (sum / count as f64) as f32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_assigned_to_the_nearest_mean_on_any_number_of_threads() {
        let value = |i: usize, k: usize| ((i * k) % 101) as f32 / 10.0;
        let points =
            Points::new(vec![(0..5000).map(|i| value(i, 37)).collect(), (0..5000).map(|i| value(i, 53)).collect()]);
        let means = [[1.0, 2.0], [8.0, 3.0], [4.0, 9.0]].map(|[u, v]| [u, v, 0.0, 0.0, 0.0, 0.0]);
        let mut nearest = vec![0; 5000];
        let tally = points.assign(&means, &mut nearest, &Threads::single());
        let (mut inertia, mut changed) = (0.0, 0);
        for (i, j) in nearest.iter().enumerate() {
            let all = means.map(|mean| squared_distance(&mean, &points.at(i)));
            assert!(all.iter().all(|other| all[usize::from(*j)] <= *other), "point {i}");
            inertia += f64::from(all[usize::from(*j)]);
            changed += usize::from(*j > 0);
        }
        assert!((tally.inertia / inertia - 1.0).abs() < 1e-9 && tally.changed == changed);
        let own: Vec<usize> = (0..5000).filter(|i| nearest[*i] == 1).collect();
        let mean = own.iter().map(|i| f64::from(points.at(*i)[1])).sum::<f64>() / own.len() as f64;
        assert!((f64::from(tally.mean(1).expect("it has points")[1]) - mean).abs() < 1e-5);
        let mut other = vec![0; 5000];
        assert_eq!(points.assign(&means, &mut other, &Threads::new(3).expect("threads")), tally);
        assert_eq!(nearest, other);
    }

    #[test]
    fn samples_are_spread_evenly() {
        let points = Points::new(vec![(0..100).map(|i| i as f32).collect()]);
        assert_eq!(points.sampled(4).1, [7, 48, 63, 79]);
        assert_eq!(points.sampled(1000).0, points);
        assert!(Points::new(vec![Vec::new()]).sampled(5).1.is_empty());
    }
}
