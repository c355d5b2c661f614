//! A mixture of Gaussians, fitted by expectation maximisation.

use nalgebra::{SMatrix, SymmetricEigen};

use super::points::{MOST_DIMENSIONS, Place, Points};
use crate::base::{Threads, effort};

/// Points that one thread takes at once: a fixed number, so that sums have one order on any number of threads.
const CHUNK: usize = 2048;
type Matrix = SMatrix<f64, MOST_DIMENSIONS, MOST_DIMENSIONS>;

/// The smallest standard deviation of a component along any axis, in units of the points. The likelihood of a component on equal
/// points has no bound.
pub const LEAST_DEVIATION: f64 = 0.05;

/// A square matrix, symmetric here.
type Square = [[f64; MOST_DIMENSIONS]; MOST_DIMENSIONS];

/// A component of the mixture.
#[derive(Clone, Debug, PartialEq)]
pub struct Component {
    /// Its weight, 0 to 1.
    pub weight: f64,
    /// Its mean.
    pub mean: Place,
    /// Its covariance; that of the unit matrix beyond the dimensions of the points.
    pub covariance: Square,
    /// The inverse of the covariance.
    precision: Square,
    /// The logarithm of weight and normalisation: ln w − ½ ln |2π Σ|.
    scale: f64,
}

/// Sums of an expectation step, from which the maximisation step follows.
#[derive(Clone, Debug, PartialEq)]
pub struct Expected {
    /// Log-likelihood of all points under the mixture.
    pub log_likelihood: f64,
    /// Number of points whose component of largest responsibility has changed.
    pub changed: usize,
    /// Of each component: the sums of responsibilities, of differences from its mean, and of their products.
    moments: Vec<Moments>,
}

#[derive(Clone, Debug, PartialEq)]
struct Moments {
    count: f64,
    first: [f64; MOST_DIMENSIONS],
    second: [[f64; MOST_DIMENSIONS]; MOST_DIMENSIONS],
}

impl Moments {
    fn new() -> Self {
        let first = [0.0; MOST_DIMENSIONS];
        Self { count: 0.0, first, second: [first; MOST_DIMENSIONS] }
    }

    fn take(&mut self, off: &[f64; MOST_DIMENSIONS], share: f64, dimensions: usize) {
        self.count += share;
        for (i, a) in off.iter().enumerate().take(dimensions) {
            self.first[i] += share * a;
            self.second[i].iter_mut().zip(&off[..=i]).for_each(|(sum, b)| *sum += share * a * b);
        }
    }

    fn add(&mut self, other: &Self) {
        self.count += other.count;
        self.first.iter_mut().zip(other.first).for_each(|(sum, value)| *sum += value);
        let own = self.second.iter_mut().flatten();
        own.zip(other.second.iter().flatten()).for_each(|(sum, value)| *sum += value);
    }
}

impl Component {
    /// A component from its weight, mean and covariance in the first `dimensions`, whose eigenvalues are raised to the smallest variance: the maximum of the
    /// likelihood among all covariances with no smaller eigenvalue.
    fn new(weight: f64, mean: Place, (covariance, dimensions): (Matrix, usize)) -> Self {
        let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(covariance);
        let values = eigenvalues.map(|value| value.max(LEAST_DEVIATION * LEAST_DEVIATION));
        let turned = |values| eigenvectors * Matrix::from_diagonal(&values) * eigenvectors.transpose();
        let (covariance, precision) = (turned(values), turned(values.map(|value| 1.0 / value)));
        // The unit matrix beyond the dimensions adds nothing.
        let log_determinant: f64 = values.iter().map(|value| value.ln()).sum();
        let normalization = dimensions as f64 * std::f64::consts::TAU.ln() + log_determinant;
        let [covariance, precision] = [covariance, precision].map(|matrix| matrix.into());
        Self { weight, mean, covariance, precision, scale: weight.ln() - 0.5 * normalization }
    }

    fn of(moments: &Moments, about: &Place, (total, dimensions): (f64, usize)) -> Self {
        let shift = moments.first.map(|sum| sum / moments.count);
        let covariance = Matrix::from_fn(|i, j| {
            let (i, j) = (i.max(j), i.min(j));
            match (i < dimensions, i == j) {
                (true, _) => moments.second[i][j] / moments.count - shift[i] * shift[j],
                (false, is_diagonal) => f64::from(u8::from(is_diagonal)),
            }
        });
        let mean = std::array::from_fn(|i| (f64::from(about[i]) + shift[i]) as f32);
        Self::new(moments.count / total, mean, (covariance, dimensions))
    }

    /// The logarithm of its weighted density at a difference from its mean, and the squared Mahalanobis distance.
    fn log_density(&self, off: &[f64; MOST_DIMENSIONS], dimensions: usize) -> (f64, f64) {
        let row = |row: &[f64]| row.iter().zip(off).take(dimensions).map(|(p, off)| p * off).sum::<f64>();
        let squared: f64 = self.precision.iter().zip(off).take(dimensions).map(|(p, off)| off * row(p)).sum();
        (self.scale - 0.5 * squared, squared)
    }

    fn off(&self, place: &Place) -> [f64; MOST_DIMENSIONS] {
        std::array::from_fn(|i| f64::from(place[i]) - f64::from(self.mean[i]))
    }
}

/// The mixture whose components are the clusters of a hard assignment to `means`; clusters without points are left out.
pub fn initial(points: &Points, means: &[Place], nearest: &[u8]) -> Vec<Component> {
    let dimensions = points.dimensions();
    let mut moments = vec![Moments::new(); means.len()];
    for (i, j) in nearest.iter().enumerate().map(|(i, j)| (i, usize::from(*j))) {
        let place = points.at(i);
        let off = std::array::from_fn(|d| f64::from(place[d]) - f64::from(means[j][d]));
        moments[j].take(&off, 1.0, dimensions);
    }
    let filled = moments.iter().zip(means).filter(|(moments, _)| moments.count > 0.0);
    filled.map(|(moments, mean)| Component::of(moments, mean, (points.len() as f64, dimensions))).collect()
}

/// The responsibilities of the components for a point, and its squared Mahalanobis distances from their means.
pub fn responsibilities(components: &[Component], place: &Place, dimensions: usize) -> Vec<(f64, f64)> {
    let all: Vec<(f64, f64)> = components.iter().map(|c| c.log_density(&c.off(place), dimensions)).collect();
    let most = all.iter().map(|(log, _)| *log).fold(f64::NEG_INFINITY, f64::max);
    let sum: f64 = all.iter().map(|(log, _)| (log - most).exp()).sum();
    all.into_iter().map(|(log, squared)| ((log - most).exp() / sum, squared)).collect()
}

/// The expectation step: responsibilities r = w N(x; μ, Σ) / Σ w N(x; μ, Σ) of all components for all points. Writes the component of the largest
/// one to `nearest`.
///
/// # Panics
/// If there are no components, or `nearest` has another number of points.
pub fn expect(points: &Points, components: &[Component], nearest: &mut [u8], threads: &Threads) -> Expected {
    assert!(!components.is_empty() && nearest.len() == points.len());
    effort::add(points.len());
    let chunks = nearest.chunks_mut(CHUNK).enumerate();
    let parts = threads.gather(chunks, |(chunk, nearest)| expect_chunk(points, components, (chunk * CHUNK, nearest)));
    let moments = vec![Moments::new(); components.len()];
    let mut whole = Expected { log_likelihood: 0.0, changed: 0, moments };
    for part in parts {
        whole.log_likelihood += part.log_likelihood;
        whole.changed += part.changed;
        whole.moments.iter_mut().zip(&part.moments).for_each(|(sum, part)| sum.add(part));
    }
    whole
}

fn expect_chunk(points: &Points, components: &[Component], (first, nearest): (usize, &mut [u8])) -> Expected {
    let dimensions = points.dimensions();
    let mut found = Expected { log_likelihood: 0.0, changed: 0, moments: vec![Moments::new(); components.len()] };
    let mut all = vec![(0.0, [0.0; MOST_DIMENSIONS]); components.len()];
    for (i, nearest) in nearest.iter_mut().enumerate() {
        let place = points.at(first + i);
        let (mut most, mut best) = (f64::NEG_INFINITY, 0);
        for (j, component) in components.iter().enumerate() {
            let off = component.off(&place);
            let (log, _) = component.log_density(&off, dimensions);
            all[j] = (log, off);
            if log > most {
                (most, best) = (log, j);
            }
        }
        all.iter_mut().for_each(|(log, _)| *log = (*log - most).exp());
        let sum: f64 = all.iter().map(|(density, _)| density).sum();
        found.log_likelihood += most + sum.ln();
        for ((density, off), moments) in all.iter().zip(&mut found.moments) {
            let share = density / sum;
            if share > 1e-12 {
                moments.take(off, share, dimensions);
            }
        }
        found.changed += usize::from(usize::from(*nearest) != best);
        *nearest = best as u8;
    }
    found
}

impl Expected {
    /// The maximisation step for component `index`: weight, mean and covariance of the points, weighted by responsibility. A component that
    /// explains less than one point keeps them.
    pub fn maximized(&self, index: usize, component: &Component, points: &Points) -> Component {
        let moments = &self.moments[index];
        if moments.count < 1.0 {
            return component.clone();
        }
        Component::of(moments, &component.mean, (points.len() as f64, points.dimensions()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::segmentation::kmeans::Clustering;
    use crate::synth::random::{gaussian, hash};

    /// Two Gaussians: 70 % about (1, −2) with deviations 0.6 and 0.3, and 30 % about (3, 1) with 0.4 and 0.8.
    fn sample(count: u64) -> Points {
        let value = |d: usize| {
            (0..count)
                .map(|i| {
                    let (mean, deviation) =
                        if i % 10 < 7 { ([1.0, -2.0], [0.6, 0.3]) } else { ([3.0, 1.0], [0.4, 0.8]) };
                    (mean[d] + deviation[d] * gaussian(hash(3, d as u64, i))) as f32
                })
                .collect()
        };
        Points::new(vec![value(0), value(1)])
    }

    #[test]
    fn the_log_likelihood_rises_to_the_true_parameters() {
        let points = sample(20_000);
        let Clustering { means, mut nearest, .. } = Clustering::of(&points, 2, 1);
        let mut components = initial(&points, &means, &nearest);
        let mut before = f64::NEG_INFINITY;
        for _ in 0..40 {
            let expected = expect(&points, &components, &mut nearest, &Threads::single());
            assert!(expected.log_likelihood >= before - 1e-6, "{} after {before}", expected.log_likelihood);
            before = expected.log_likelihood;
            components = (0..2).map(|j| expected.maximized(j, &components[j], &points)).collect();
        }
        components.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        let [large, small] = &components[..] else { panic!("two components") };
        assert!((large.weight - 0.7).abs() < 0.01, "{}", large.weight);
        assert!((large.mean[0] - 1.0).abs() < 0.02 && (small.mean[1] - 1.0).abs() < 0.05);
        let deviations = [large, small].map(|c| [c.covariance[0][0].sqrt(), c.covariance[1][1].sqrt()]);
        for (found, truth) in deviations.iter().flatten().zip([0.6, 0.3, 0.4, 0.8]) {
            assert!((found - truth).abs() < 0.02, "{deviations:?}");
        }
    }

    #[test]
    fn equal_points_have_the_smallest_deviation_and_no_more() {
        let points = Points::new(vec![vec![2.0; 100], vec![1.0; 100]]);
        let mut nearest = vec![0; 100];
        let [component] = &initial(&points, &[points.at(0)], &nearest)[..] else { panic!("one") };
        assert!((component.covariance[0][0].sqrt() - LEAST_DEVIATION).abs() < 1e-12);
        let expected = expect(&points, std::slice::from_ref(component), &mut nearest, &Threads::single());
        let each = expected.log_likelihood / 100.0;
        let density = -(std::f64::consts::TAU * LEAST_DEVIATION * LEAST_DEVIATION).ln();
        assert!((each - density).abs() < 1e-9);
    }

    #[test]
    fn sums_do_not_depend_on_the_number_of_threads() {
        let points = sample(10_000);
        let found = Clustering::of(&points, 2, 1);
        let components = initial(&points, &found.means, &found.nearest);
        let [mut a, mut b] = [found.nearest.clone(), found.nearest];
        let one = expect(&points, &components, &mut a, &Threads::single());
        assert_eq!(one, expect(&points, &components, &mut b, &Threads::new(3).expect("threads")));
        assert_eq!(a, b);
        let shares = responsibilities(&components, &points.at(5), 2);
        assert!((shares.iter().map(|(share, _)| share).sum::<f64>() - 1.0).abs() < 1e-12);
    }
}
