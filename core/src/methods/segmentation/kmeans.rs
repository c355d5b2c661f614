//! k-means to its end, and the choice of the number of clusters.

use super::points::{Place, Points, squared_distance};
use super::seeds::Seeds;
use crate::base::Threads;

/// Points on which numbers of clusters are compared.
const COMPARED: usize = 800;
/// Points between which the silhouette takes all distances.
const SILHOUETTES: usize = 300;
/// Iterations of such a clustering at most.
const ITERATIONS: usize = 30;

/// The result of k-means.
#[derive(Clone, Debug, PartialEq)]
pub struct Clustering {
    /// The means; fewer than asked for if there are fewer distinct points.
    pub means: Vec<Place>,
    /// The index of the nearest mean of each point.
    pub nearest: Vec<u8>,
    /// Sum of the squared distances of the points from their means.
    pub inertia: f64,
}

impl Clustering {
    /// Clusters `points` into at most `count` by k-means (S. Lloyd 1982), seeded by k-means++.
    pub fn of(points: &Points, count: usize, seed: usize) -> Self {
        let mut seeds = Seeds::new(points, count, seed);
        let seeds = std::iter::from_fn(|| seeds.next(points)).take(count);
        let mut found =
            Self { means: seeds.map(|seed| seed.place).collect(), nearest: vec![0; points.len()], inertia: 0.0 };
        if found.means.is_empty() {
            return found;
        }
        for _ in 0..ITERATIONS {
            let tally = points.assign(&found.means, &mut found.nearest, &Threads::single());
            let means: Vec<Place> = (0..found.means.len()).map(|j| tally.mean(j).unwrap_or(found.means[j])).collect();
            found.inertia = tally.inertia;
            if means == found.means {
                break;
            }
            found.means = means;
        }
        found
    }
}

/// A number of clusters that was tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    /// Number of clusters.
    pub clusters: usize,
    /// Mean squared distance of a point from its mean, in squared units of the points: plotted over k, the elbow.
    pub within: f64,
    /// Mean silhouette; `None` for a single cluster, which has none.
    pub silhouette: Option<f64>,
}

/// Clusters a sample of `points` into 1, 2, … at most `most` clusters, as long as there are enough distinct points.
pub fn trials(points: &Points, most: usize, seed: usize) -> Vec<Trial> {
    let (sample, _) = points.sampled(COMPARED);
    let mut all = Vec::new();
    for clusters in 1..=most {
        let found = Clustering::of(&sample, clusters, seed);
        if found.means.len() < clusters {
            break;
        }
        let within = found.inertia / sample.len() as f64;
        all.push(Trial { clusters, within, silhouette: silhouette(&sample, &found) });
    }
    all
}

/// The trial with the largest mean silhouette, the first of several.
pub fn best(trials: &[Trial]) -> Option<&Trial> {
    let value = |trial: &Trial| trial.silhouette.unwrap_or(f64::NEG_INFINITY);
    trials.iter().reduce(|best, next| if value(next) > value(best) { next } else { best })
}

/// The mean silhouette of a sample (P. Rousseeuw 1987): (b − a) / max(a, b) of a point with mean distance a from the others of its cluster and
/// b from those of the nearest other cluster; 0 if it is alone in its cluster.
fn silhouette(points: &Points, found: &Clustering) -> Option<f64> {
    if found.means.len() < 2 {
        return None;
    }
    let (sample, indices) = points.sampled(SILHOUETTES);
    let places: Vec<Place> = (0..sample.len()).map(|i| sample.at(i)).collect();
    let cluster = |i: usize| usize::from(found.nearest[indices[i]]);
    let of_point = |i: usize| {
        let mut sums = vec![(0.0f64, 0u32); found.means.len()];
        for j in (0..places.len()).filter(|j| *j != i) {
            let (sum, count) = &mut sums[cluster(j)];
            *sum += f64::from(squared_distance(&places[i], &places[j])).sqrt();
            *count += 1;
        }
        let mean = |(sum, count): (f64, u32)| sum / f64::from(count);
        let own = sums[cluster(i)];
        let others = sums.iter().enumerate().filter(|(j, (_, count))| *j != cluster(i) && *count > 0);
        let nearest = others.map(|(_, sum)| mean(*sum)).fold(f64::INFINITY, f64::min);
        if own.1 == 0 || !nearest.is_finite() {
            return 0.0;
        }
        let (a, b) = (mean(own), nearest);
        if a.max(b) > 0.0 { (b - a) / a.max(b) } else { 0.0 }
    };
    Some((0..places.len()).map(of_point).sum::<f64>() / places.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three groups of points about (0, 0), (6, 0) and (0, 6).
    fn groups() -> Points {
        let near = |i: usize, k: usize| ((i * k) % 17) as f32 / 17.0 - 0.5;
        let center = |i: usize| [[0.0, 0.0], [6.0, 0.0], [0.0, 6.0]][i % 3];
        Points::new(vec![
            (0..600).map(|i| center(i)[0] + near(i, 7)).collect(),
            (0..600).map(|i| center(i)[1] + near(i, 11)).collect(),
        ])
    }

    #[test]
    fn the_silhouette_chooses_the_number_of_groups() {
        let points = groups();
        let all = trials(&points, 6, 1);
        assert_eq!(all.len(), 6);
        assert!(all.windows(2).all(|pair| pair[1].within <= pair[0].within), "{all:?}");
        assert_eq!(best(&all).map(|trial| trial.clusters), Some(3));
        assert_eq!(all[0].silhouette, None);
        let found = Clustering::of(&points, 3, 1);
        assert!((0..600).all(|i| found.nearest[i] == found.nearest[i % 3]), "each group is a cluster");
    }

    #[test]
    fn there_are_no_more_clusters_than_distinct_points() {
        let points = Points::new(vec![(0..50).map(|i| (i % 2) as f32).collect()]);
        assert_eq!(Clustering::of(&points, 5, 0).means.len(), 2);
        let all = trials(&points, 5, 0);
        assert_eq!((all.len(), best(&all).and_then(|trial| trial.silhouette)), (2, Some(1.0)));
        assert_eq!(trials(&Points::new(vec![Vec::new(); 2]), 5, 0), []);
    }
}
