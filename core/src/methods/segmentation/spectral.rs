//! Spectral clustering: the eigenvectors of a normalised affinity matrix (A. Ng, M. Jordan and Y. Weiss, On spectral clustering, NIPS 2001).
//!
//! With degrees D = diag(Σ W) the matrix N = D^(−1/2) W D^(−1/2) has the eigenvalue 1 once for each group that is connected by no affinity to
//! the others; the Laplacian is I − N.

use crate::geometry::Grid;
use crate::synth::random::{hash, unit};

/// Iterations at most.
const ITERATIONS: usize = 300;
/// Change of all eigenvalues below which the iteration has converged.
const CONVERGED: f64 = 1e-7;

/// The largest eigenvalues of a normalised affinity matrix with their eigenvectors, by subspace iteration.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// The eigenvalues so far, from the largest down.
    pub values: Vec<f64>,
    /// The eigenvectors so far, of unit length; those beyond the rank of the matrix may vanish.
    pub vectors: Vec<Vec<f64>>,
    /// Largest change of an eigenvalue in the last iteration.
    pub change: f64,
    /// Number of iterations.
    pub iterations: usize,
}

impl Spectrum {
    /// Whether no further iteration changes it much.
    pub fn is_over(&self) -> bool {
        self.change < CONVERGED || self.iterations >= ITERATIONS
    }

    /// The start: `count` random vectors, at most as many as points.
    pub fn begin(points: usize, count: usize, seed: u64) -> Self {
        let random = |k: usize| (0..points).map(|i| unit(hash(seed, k as u64, i as u64)) - 0.5).collect();
        let mut vectors: Vec<Vec<f64>> = (0..count.min(points)).map(random).collect();
        orthonormalize(&mut vectors);
        Self { values: vec![0.0; vectors.len()], vectors, change: f64::INFINITY, iterations: 0 }
    }

    /// One iteration with the matrix `n`: multiplies each vector by (N + I) / 2, the eigenvalues of which are not negative, and makes them
    /// orthonormal again.
    pub fn iterate(&mut self, n: &Grid<f64>) {
        let multiplied = |vector: &Vec<f64>| -> Vec<f64> {
            (0..n.height())
                .map(|y| 0.5 * (vector[y] + n.row(y).iter().zip(vector).map(|(a, b)| a * b).sum::<f64>()))
                .collect()
        };
        let mut vectors: Vec<Vec<f64>> = self.vectors.iter().map(multiplied).collect();
        // Rayleigh quotients of the vectors before, which have unit length.
        let quotient = |(new, old): (&Vec<f64>, &Vec<f64>)| 2.0 * dot(new, old) - 1.0;
        let values: Vec<f64> = vectors.iter().zip(&self.vectors).map(quotient).collect();
        let changes = values.iter().zip(&self.values).map(|(a, b)| (a - b).abs());
        self.change = changes.fold(0.0, f64::max);
        orthonormalize(&mut vectors);
        self.iterations += 1;
        (self.values, self.vectors) = (values, vectors);
    }

    /// The number of groups before the largest gap between successive eigenvalues. The last eigenvalue converges most slowly, so the gap
    /// before it is left out.
    pub fn groups_by_gap(&self) -> usize {
        let known = &self.values[..self.values.len().saturating_sub(1).max(1).min(self.values.len())];
        let gaps = known.windows(2).map(|pair| pair[0] - pair[1]).enumerate();
        gaps.reduce(|best, next| if next.1 > best.1 { next } else { best }).map_or(1, |(index, _)| index + 1)
    }

    /// The coordinates of each point by the first `count` eigenvectors, scaled to unit length.
    pub fn embedding(&self, count: usize) -> Vec<Vec<f32>> {
        let count = count.clamp(1, self.vectors.len().max(1));
        let points = self.vectors.first().map_or(0, Vec::len);
        let length = |i: usize| self.vectors[..count].iter().map(|v| v[i] * v[i]).sum::<f64>().sqrt().max(1e-12);
        self.vectors[..count.min(self.vectors.len())]
            .iter()
            .map(|vector| (0..points).map(|i| (vector[i] / length(i)) as f32).collect())
            .collect()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Modified Gram–Schmidt.
fn orthonormalize(vectors: &mut [Vec<f64>]) {
    for k in 0..vectors.len() {
        let (before, rest) = vectors.split_at_mut(k);
        let vector = &mut rest[0];
        for other in before.iter() {
            let along = dot(vector, other);
            vector.iter_mut().zip(other).for_each(|(c, other)| *c -= along * other);
        }
        let length = dot(vector, vector).sqrt();
        if length > 1e-12 {
            vector.iter_mut().for_each(|c| *c /= length);
        }
    }
}

/// D^(−1/2) W D^(−1/2) of a symmetric matrix of affinities; rows without any stay zero.
pub fn normalized(affinities: &Grid<f32>) -> Grid<f64> {
    let size = affinities.height();
    let degree = |y: usize| affinities.row(y).iter().map(|w| f64::from(*w)).sum::<f64>();
    let scale: Vec<f64> = (0..size).map(|y| if degree(y) > 0.0 { degree(y).sqrt().recip() } else { 0.0 }).collect();
    Grid::from_fn(size, size, |x, y| f64::from(affinities[(x, y)]) * scale[x] * scale[y])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Affinities of groups of points: strong within, weak between.
    fn affinities(groups: &[usize], between: f32) -> Grid<f32> {
        let of: Vec<usize> = groups.iter().enumerate().flat_map(|(group, count)| vec![group; *count]).collect();
        Grid::from_fn(of.len(), of.len(), |x, y| match (x == y, of[x] == of[y]) {
            (true, _) => 1.0,
            (_, true) => 0.6 + 0.3 * ((x * y) % 3) as f32 / 3.0,
            _ => between,
        })
    }

    #[test]
    fn eigenvalues_and_vectors_are_those_of_the_matrix() {
        let matrix = normalized(&affinities(&[9, 7, 4], 0.02));
        let mut spectrum = Spectrum::begin(20, 5, 3);
        while !spectrum.is_over() {
            spectrum.iterate(&matrix);
        }
        let plain = nalgebra::SMatrix::<f64, 20, 20>::from_fn(|y, x| matrix[(x, y)]).symmetric_eigen();
        let mut expected: Vec<f64> = plain.eigenvalues.iter().copied().collect();
        expected.sort_by(|a, b| b.total_cmp(a));
        for (found, expected) in spectrum.values.iter().zip(&expected).take(3) {
            assert!((found - expected).abs() < 1e-4, "{:?} {expected}", spectrum.values);
        }
        assert!((spectrum.values[0] - 1.0).abs() < 1e-6, "the largest eigenvalue is 1");
        assert_eq!(spectrum.groups_by_gap(), 3);
        let rows = spectrum.embedding(3);
        let distance = |i: usize, j: usize| rows.iter().map(|row| (row[i] - row[j]).powi(2)).sum::<f32>();
        assert!(distance(0, 8) < 0.1 && distance(0, 9) > 1.0 && distance(9, 16) > 1.0);
    }

    #[test]
    fn a_point_without_affinity_leaves_the_others_finite() {
        let mut weights = affinities(&[3, 3], 0.0);
        (0..6).for_each(|i| (weights[(i, 2)], weights[(2, i)]) = (0.0, 0.0));
        let matrix = normalized(&weights);
        let mut spectrum = Spectrum::begin(6, 9, 1);
        (0..50).for_each(|_| spectrum.iterate(&matrix));
        assert!(spectrum.values.len() == 6 && spectrum.vectors.as_slice().concat().iter().all(|c| c.is_finite()));
        assert!(spectrum.embedding(2).concat().iter().all(|c| c.is_finite()));
    }
}
