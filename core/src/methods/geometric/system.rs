//! The linear systems of the normalised DLT, of the eight-point algorithm and of the affine fit in numbers, to be shown.

use nalgebra::Matrix3 as Square;

use super::Correspondence;
use super::fit::normal_equations;
use super::moments::{Moments, Normal};
use super::normalisation::Normalisation;
use crate::geometry::Grid;
use crate::products::model::Matrix3;
use crate::scene::Matrix;

/// The size and the matrices of a linear system.
#[derive(Clone, Debug, Default)]
pub struct System {
    /// Number of its homogeneous equations; `None` of normal equations.
    pub equations: Option<usize>,
    /// Its matrices in the order of the computation.
    pub matrices: Vec<Matrix>,
}

/// The eigenvalues that are shown, from the largest on: the last ones tell how well a solution is determined.
const SHOWN: [(usize, &str); 4] = [(0, "λ₁"), (6, "λ₇"), (7, "λ₈"), (8, "λ₉")];

/// The name of a solution.
const SOLUTION: &str = "of the normalised points";

impl System {
    /// The system A h = 0 of a homography between normalised points (Hartley and Zisserman 2004, algorithm 4.2): two equations for each
    /// match, solved by the eigenvector of AᵀA with the smallest eigenvalue. Empty if the points of a frame are at one place.
    pub fn of_homography(matches: &[Correspondence]) -> Self {
        let Some((by, moments)) = normalised(matches) else { return Self::default() };
        let solved = Solved::of(moments.transfer());
        let mut system = Self::solved_by(matches.len(), 2 * matches.len(), by, &solved);
        system.matrices.push(matrix("H", SOLUTION, &solved.vectors[0]));
        system
    }

    /// The system A f = 0 of a fundamental matrix between normalised points (Hartley 1997): an equation for each match. Seven leave two
    /// solutions to be mixed; from eight on the singular values of the one solution are shown, of which the smallest becomes 0.
    pub fn of_fundamental(matches: &[Correspondence]) -> Self {
        let Some((by, moments)) = normalised(matches) else { return Self::default() };
        let solved = Solved::of(moments.bilinear());
        let mut system = Self::solved_by(matches.len(), matches.len(), by, &solved);
        let [least, next] = &solved.vectors;
        if matches.len() < 8 {
            system.matrices.push(matrix("F₁", "solution, to be mixed", least));
            system.matrices.push(matrix("F₂", "solution, to be mixed", next));
            return system;
        }
        let values = Square::from_fn(|i, j| least[i][j]).singular_values();
        system.matrices.push(matrix("F", SOLUTION, least));
        let mut values = [values[0], values[1], values[2]];
        values.sort_by(|a, b| b.total_cmp(a));
        system.matrices.push(Matrix::column("s", "singular values; the last becomes 0", &values).with_decimals(4));
        system
    }

    /// The normal equations N X = R of an affine map, with the points of frame t relative to their mean.
    pub fn of_affine(matches: &[Correspondence]) -> Self {
        let (_, normal, right) = normal_equations(matches);
        const ROWS: [&str; 3] = ["x", "y", "1"];
        let normal = Grid::from_fn(3, 3, |x, y| normal[(y, x)]);
        let right = Grid::from_fn(2, 3, |x, y| right[(y, x)]);
        let matrices = vec![
            Matrix::new("N", "sums of products of x, y and 1", normal).with_columns(ROWS),
            Matrix::new("R", "sums of products with x′ and y′", right).with_columns(["x′", "y′"]),
        ];
        let matrices = matrices.into_iter().map(|matrix| matrix.with_rows(ROWS).with_decimals(1)).collect();
        Self { equations: None, matrices }
    }

    /// The same with its solution named as what a refinement begins with.
    #[must_use]
    pub fn before_refinement(mut self) -> Self {
        for matrix in self.matrices.iter_mut().filter(|matrix| matrix.name == SOLUTION) {
            matrix.name = "of the normalised inliers, before refinement";
        }
        self
    }

    /// The normalisations and the eigenvalues.
    fn solved_by(count: usize, equations: usize, by: [Normalisation; 2], solved: &Solved) -> Self {
        let values = SHOWN.map(|(i, _)| solved.eigenvalues[i] / count as f64);
        let eigenvalues = Matrix::column("λ", "eigenvalues of A^T A per match", &values);
        let [from, to] = by;
        let matrices = vec![
            matrix("T", "normalisation of frame t", &from.matrix()),
            matrix("T′", "normalisation of frame t+1", &to.matrix()),
            eigenvalues.with_rows(SHOWN.map(|(_, name)| name)).with_decimals(6),
        ];
        Self { equations: Some(equations), matrices }
    }
}

/// Eigenvalues of a normal matrix, largest first, and the eigenvectors of the smallest and the next, by rows.
struct Solved {
    eigenvalues: [f64; 9],
    vectors: [Matrix3; 2],
}

impl Solved {
    fn of(normal: Normal) -> Self {
        let eigen = normal.symmetric_eigen();
        let mut order: [usize; 9] = std::array::from_fn(|i| i);
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        let vector = |i: usize| {
            let column = eigen.eigenvectors.column(order[i]);
            std::array::from_fn(|row| std::array::from_fn(|x| column[3 * row + x]))
        };
        // Rounding leaves tiny negative ones.
        Self { eigenvalues: order.map(|i| eigen.eigenvalues[i].max(0.0)), vectors: [vector(8), vector(7)] }
    }
}

fn normalised(matches: &[Correspondence]) -> Option<([Normalisation; 2], Moments)> {
    let from = Normalisation::of(matches.iter().map(|m| m.from))?;
    let to = Normalisation::of(matches.iter().map(|m| m.to))?;
    let moments = Moments::of(matches, [&from, &to], &vec![1.0; matches.len()]);
    Some(([from, to], moments))
}

fn matrix(symbol: &'static str, name: &'static str, entries: &Matrix3) -> Matrix {
    Matrix::of_rows(symbol, name, entries).with_decimals(4)
}
