//! Sums of products over correspondences, of which the normal matrices of homography and fundamental matrix are made.

use nalgebra::SMatrix;

use super::Correspondence;
use super::normalisation::Normalisation;
use crate::base::wide::wide;

/// A symmetric 9×9 matrix.
pub type Normal = SMatrix<f64, 9, 9>;

/// The sums Σ w (q qᵀ) ⊗ (p pᵀ) over pairs of homogeneous points p and q with weights w: for each of the six distinct
/// entries of q qᵀ, those of p pᵀ.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moments([[f64; 6]; 6]);

/// The index of entry `(i, j)` among the six different ones of a symmetric 3×3 matrix.
fn entry(i: usize, j: usize) -> usize {
    [[0, 1, 2], [1, 3, 4], [2, 4, 5]][i][j]
}

/// The six different products of three numbers.
#[inline(always)]
fn products([x, y, z]: [f64; 3]) -> [f64; 6] {
    [x * x, x * y, x * z, y * y, y * z, z * z]
}

impl Moments {
    /// The sums over normalised correspondences; a weight for each.
    pub fn of(matches: &[Correspondence], by: [&Normalisation; 2], weights: &[f64]) -> Self {
        let mut sums = Self::default();
        add_all(&mut sums, matches, by, weights);
        sums
    }

    /// Adds the products of a pair.
    #[inline(always)]
    pub fn add(&mut self, p: [f64; 3], q: [f64; 3], weight: f64) {
        let of_p = products(p);
        for (sums, of_q) in self.0.iter_mut().zip(products(q)) {
            let factor = weight * of_q;
            sums.iter_mut().zip(of_p).for_each(|(sum, of_p)| *sum += factor * of_p);
        }
    }

    /// The normal matrix of the equations q′ᵀ F p = 0 in the entries of F by rows.
    pub fn bilinear(&self) -> Normal {
        Normal::from_fn(|row, column| self.0[entry(row / 3, column / 3)][entry(row % 3, column % 3)])
    }

    /// The normal matrix of the equations q × H p = 0, two for each pair, in the entries of H by rows; q = (u, v, 1).
    pub fn transfer(&self) -> Normal {
        Normal::from_fn(|row, column| {
            let of_p = entry(row % 3, column % 3);
            match (row / 3, column / 3) {
                (0, 0) | (1, 1) => self.0[entry(2, 2)][of_p],
                (0, 1) | (1, 0) => 0.0,
                (2, 2) => self.0[entry(0, 0)][of_p] + self.0[entry(1, 1)][of_p],
                (i, 2) | (2, i) => -self.0[entry(i, 2)][of_p],
                _ => 0.0,
            }
        })
    }
}

wide! {
    fn add_all(sums: &mut Moments, matches: &[Correspondence], by: [&Normalisation; 2], weights: &[f64]) = add_all_body
}

#[inline(always)]
fn add_all_body(sums: &mut Moments, matches: &[Correspondence], [from, to]: [&Normalisation; 2], weights: &[f64]) {
    let mut own = Moments::default();
    for (m, weight) in matches.iter().zip(weights) {
        let ([x, y], [u, v]) = (from.apply(m.from), to.apply(m.to));
        own.add([x, y, 1.0], [u, v, 1.0], *weight);
    }
    *sums = own;
}

#[cfg(test)]
mod tests {
    use nalgebra::SVector;

    use super::*;

    #[test]
    fn normal_matrices_are_the_products_of_their_equations() {
        let one = |i: usize| {
            let [x, y, u, v] = [3, 7, 11, 13].map(|k| ((i * k + 5) % 17) as f64);
            Correspondence { from: [x, y], to: [u, v] }
        };
        let matches: Vec<_> = (0..12).map(one).collect();
        let weights: Vec<f64> = (0..12).map(|i| 1.0 + 0.25 * f64::from(i)).collect();
        let by = Normalisation { mean: [2.0, -1.0], scale: 0.5 };
        let moments = Moments::of(&matches, [&by, &by], &weights);
        let (mut bilinear, mut transfer) = (Normal::zeros(), Normal::zeros());
        for (m, weight) in matches.iter().zip(&weights) {
            let ([x, y], [u, v]) = (by.apply(m.from), by.apply(m.to));
            let row = SVector::<f64, 9>::from([u * x, u * y, u, v * x, v * y, v, x, y, 1.0]);
            bilinear += row * row.transpose() * *weight;
            for row in [[x, y, 1.0, 0.0, 0.0, 0.0, -x * u, -y * u, -u], [0.0, 0.0, 0.0, x, y, 1.0, -x * v, -y * v, -v]]
            {
                let row = SVector::<f64, 9>::from(row);
                transfer += row * row.transpose() * *weight;
            }
        }
        assert!((moments.bilinear() - bilinear).amax() < 1e-9 * bilinear.amax());
        assert!((moments.transfer() - transfer).amax() < 1e-9 * transfer.amax());
    }
}
