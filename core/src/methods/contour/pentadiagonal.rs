//! The linear system of a closed elastic curve with stiffness: pentadiagonal, with corners, since the last point joins the first.

use super::Point;

/// The factors of A + γ I for a closed curve of n ≥ 5 points, where A has α (−1, 2, −1) + β (1, −4, 6, −4, 1) around its diagonal
/// (Kass, Witkin and Terzopoulos 1988, equations 12 to 15).
///
/// The first n − 2 unknowns have a banded matrix B = L D Lᵀ; the last two, which join the ends, follow by their Schur complement.
#[derive(Clone, Debug)]
pub(crate) struct Pentadiagonal {
    /// 1 / D of each row of B.
    inverse: Vec<f64>,
    /// The two entries of L left of the diagonal in each row: at −1 and at −2.
    lower: Vec<[f64; 2]>,
    /// B⁻¹ C, where C has the columns of the last two unknowns.
    joined: Vec<[f64; 2]>,
    /// C, in the rows of its entries that are not 0.
    columns: Vec<(usize, [f64; 2])>,
    /// The inverse of the Schur complement.
    schur: [[f64; 2]; 2],
}

impl Pentadiagonal {
    /// Factors the matrix for `count` points; γ is above 0, α and β are not negative.
    pub fn new(count: usize, [alpha, beta, gamma]: [f64; 3]) -> Self {
        let (diagonal, bands) = (2.0 * alpha + 6.0 * beta + gamma, [-alpha - 4.0 * beta, beta]);
        let entry = |i: usize, j: usize| {
            let apart = i.abs_diff(j);
            // The shorter way around the curve.
            match apart.min(count - apart) {
                0 => diagonal,
                around @ 1..=2 => bands[around - 1],
                _ => 0.0,
            }
        };
        let inner = count - 2;
        let (inverse, lower) = factors(inner, diagonal, bands);
        let columns: Vec<_> = (0..inner)
            .map(|i| (i, [entry(i, inner), entry(i, inner + 1)]))
            .filter(|(_, entries)| *entries != [0.0; 2])
            .collect();
        let mut joined = vec![[0.0; 2]; inner];
        columns.iter().for_each(|(i, entries)| joined[*i] = *entries);
        let system = Self { inverse, lower, joined: Vec::new(), columns, schur: [[0.0; 2]; 2] };
        system.solve_inner(&mut joined);
        let mut schur = [0, 1].map(|i| [0, 1].map(|j| entry(inner + i, inner + j)));
        for (row, entries) in &system.columns {
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                schur[i][j] -= entries[i] * joined[*row][j];
            }
        }
        let [[a, b], [c, d]] = schur;
        let scale = 1.0 / (a * d - b * c);
        Self { schur: [[d * scale, -b * scale], [-c * scale, a * scale]], joined, ..system }
    }

    /// Solves B x = `values` in place.
    fn solve_inner(&self, values: &mut [Point]) {
        let count = self.inverse.len();
        for i in 1..count {
            let [one, two] = self.lower[i];
            let (before, second) = (values[i - 1], if i > 1 { values[i - 2] } else { [0.0; 2] });
            values[i] = [0, 1].map(|k| values[i][k] - one * before[k] - two * second[k]);
        }
        for i in (0..count).rev() {
            let one = if i + 1 < count { self.lower[i + 1][0] } else { 0.0 };
            let two = if i + 2 < count { self.lower[i + 2][1] } else { 0.0 };
            let (after, second) = (values[(i + 1).min(count - 1)], values[(i + 2).min(count - 1)]);
            values[i] = [0, 1].map(|k| values[i][k] * self.inverse[i] - one * after[k] - two * second[k]);
        }
    }

    /// Solves the system for x and y of all points, in place.
    pub fn solve(&self, values: &mut [Point]) {
        let (inner, last) = values.split_at_mut(self.inverse.len());
        self.solve_inner(inner);
        let mut rest = [last[0], last[1]];
        for (row, entries) in &self.columns {
            for i in 0..2 {
                rest[i] = [0, 1].map(|k| rest[i][k] - entries[i] * inner[*row][k]);
            }
        }
        let solved = [0, 1].map(|i| [0, 1].map(|k| self.schur[i][0] * rest[0][k] + self.schur[i][1] * rest[1][k]));
        for (value, joined) in inner.iter_mut().zip(&self.joined) {
            *value = [0, 1].map(|k| value[k] - joined[0] * solved[0][k] - joined[1] * solved[1][k]);
        }
        last.copy_from_slice(&solved);
    }
}

/// The factors L and 1 / D of a symmetric banded matrix with constant bands.
fn factors(count: usize, diagonal: f64, bands: [f64; 2]) -> (Vec<f64>, Vec<[f64; 2]>) {
    let (mut inverse, mut lower, mut pivots) = (vec![0.0; count], vec![[0.0; 2]; count], vec![0.0; count]);
    for i in 0..count {
        let two = if i > 1 { bands[1] * inverse[i - 2] } else { 0.0 };
        let one = match i {
            0 => 0.0,
            1 => bands[0] * inverse[0],
            _ => (bands[0] - two * pivots[i - 2] * lower[i - 1][0]) * inverse[i - 1],
        };
        let of = |entry: f64, back: usize| if i >= back { entry * entry * pivots[i - back] } else { 0.0 };
        pivots[i] = diagonal - of(one, 1) - of(two, 2);
        inverse[i] = 1.0 / pivots[i];
        lower[i] = [one, two];
    }
    (inverse, lower)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solution_fulfils_the_equations_of_the_curve() {
        for count in [5, 6, 7, 8, 31, 100] {
            for [alpha, beta, gamma] in [[0.05, 0.1, 0.5], [3.0, 0.0, 0.1], [0.0, 5.0, 0.02], [0.0, 0.0, 2.0]] {
                let right: Vec<Point> = (0..count).map(|i| [(7 * i % 13) as f64, (5 * i % 11) as f64 - 4.0]).collect();
                let mut x = right.clone();
                Pentadiagonal::new(count, [alpha, beta, gamma]).solve(&mut x);
                for (i, right) in right.iter().enumerate() {
                    let at = |by: usize, k: usize| x[(i + count + by - 2) % count][k];
                    for (k, right) in right.iter().enumerate() {
                        let elastic = 2.0 * at(2, k) - at(1, k) - at(3, k);
                        let bending = at(0, k) - 4.0 * at(1, k) + 6.0 * at(2, k) - 4.0 * at(3, k) + at(4, k);
                        let left = alpha * elastic + beta * bending + gamma * at(2, k);
                        assert!((left - right).abs() < 1e-9, "row {i} of {count}: {left} for {right}");
                    }
                }
            }
        }
    }
}
