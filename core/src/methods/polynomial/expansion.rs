//! Polynomial expansion: a quadratic polynomial for the neighbourhood of each pixel (G. Farnebäck, Polynomial
//! expansion for orientation and motion estimation, Linköping 2002, chapter 4).

use crate::base::{Threads, effort, wide::wide};
use crate::geometry::{
    Grid,
    filter::{gaussian_within, weigh},
};

/// The polynomial c + b_x x + b_y y + a_xx x² + 2 a_xy x y + a_yy y² about a pixel, in gray levels, x and y in px from it: in
/// memory in the order of [`Polynomial`]'s accessors, eight numbers so that they fit a register.
pub type Packed = [f32; 8];

/// A quadratic polynomial with named coefficients.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Polynomial {
    /// The constant term: the value at the pixel.
    pub c: f32,
    /// The linear term: the gradient at the pixel.
    pub b: [f32; 2],
    /// a_xx, a_xy and a_yy: half the second derivatives.
    pub a: [f32; 3],
}

impl Polynomial {
    /// Returns the value `x`, `y` px from its pixel.
    pub fn at(&self, [x, y]: [f32; 2]) -> f32 {
        let Self { c, b, a } = self;
        c + b[0] * x + b[1] * y + a[0] * x * x + 2.0 * a[1] * x * y + a[2] * y * y
    }
}

impl From<Packed> for Polynomial {
    fn from([bx, by, xx, xy, yy, c, ..]: Packed) -> Self {
        Self { c, b: [bx, by], a: [xx, xy, yy] }
    }
}

/// The applicability: the Gaussian weights of a neighbourhood, cut off at its edge. Pixels outside the image have weight 0
/// (normalised convolution).
#[derive(Clone, Debug)]
pub struct Applicability {
    /// The weights along each axis; they sum to 1.
    weights: Vec<f32>,
}

/// The powers of x and y in the basis functions 1, x, y, x², y² and xy.
const BASIS: [[i32; 2]; 6] = [[0, 0], [1, 0], [0, 1], [2, 0], [0, 2], [1, 1]];

type Matrix = [[f64; 6]; 6];

impl Applicability {
    /// Returns a Gaussian of standard deviation `sigma_px` with a radius of `reach` px.
    pub fn new(sigma_px: f32, reach: usize) -> Self {
        Self { weights: gaussian_within(sigma_px, reach) }
    }

    /// Returns its radius in px.
    pub fn reach(&self) -> usize {
        self.weights.len() / 2
    }

    /// Returns the sums of w, w x, … w x⁴ over the pixels from −`before` to `after`.
    fn moments(&self, [before, after]: [usize; 2]) -> [f64; 5] {
        let reach = self.reach();
        let inside = &self.weights[reach - before..=reach + after];
        let mut moments = [0.0; 5];
        for (i, weight) in inside.iter().enumerate() {
            let x = i as f64 - before as f64;
            (0..5).for_each(|power| moments[power] += f64::from(*weight) * x.powi(power as i32));
        }
        moments
    }

    /// Returns the Gram matrix of the basis over the part of the neighbourhood inside the image.
    fn metric(&self, across: [usize; 2], down: [usize; 2]) -> Matrix {
        let (across, down) = (self.moments(across), self.moments(down));
        let product = |i: usize, j: usize| {
            let power = |axis: usize| (BASIS[i][axis] + BASIS[j][axis]) as usize;
            across[power(0)] * down[power(1)]
        };
        std::array::from_fn(|i| std::array::from_fn(|j| product(i, j)))
    }
}

/// The solution of `metric` · s = `right` for several right-hand sides. Undetermined coefficients, as in an image one pixel
/// wide, are 0.
fn solve(mut metric: Matrix, mut right: Matrix) -> Matrix {
    let mut is_determined = [true; 6];
    for i in 0..6 {
        // The squared norm of the basis function, orthogonalised against the simpler ones.
        is_determined[i] = metric[i][i] > 1e-9;
        if !is_determined[i] {
            continue;
        }
        for row in (0..6).filter(|row| *row != i) {
            let factor = metric[row][i] / metric[i][i];
            for column in 0..6 {
                metric[row][column] -= factor * metric[i][column];
                right[row][column] -= factor * right[i][column];
            }
        }
    }
    for i in 0..6 {
        let row = right[i];
        right[i] = if is_determined[i] { row.map(|v| v / metric[i][i]) } else { [0.0; 6] };
    }
    right
}

/// Polynomial expansion of an image, row by row.
pub struct Expander {
    applicability: Applicability,
    size: (usize, usize),
    /// The separable kernels inside an image: mean, slope and curvature.
    kernels: [Vec<f32>; 3],
    /// The mean of w x², which corrects the constant term for the curvature.
    second_moment: f32,
    /// The extents of the neighbourhood to either side, near the image border.
    cuts: [Vec<[usize; 2]>; 2],
    /// The matrices that correct the coefficients near the border from zero padding to normalised convolution.
    corrections: Vec<[[f32; 6]; 6]>,
}

impl Expander {
    /// Prepares the expansion of images of this size.
    pub fn new(applicability: Applicability, size: (usize, usize)) -> Self {
        let reach = applicability.reach();
        let [_, _, second, _, fourth] = applicability.moments([reach; 2]);
        let kernel = |f: &dyn Fn(f64) -> f64| -> Vec<f32> {
            let along = applicability.weights.iter().enumerate();
            along.map(|(i, weight)| (f64::from(*weight) * f(i as f64 - reach as f64)) as f32).collect()
        };
        let kernels =
            [kernel(&|_| 1.0), kernel(&|x| x / second), kernel(&|x| (x * x - second) / (fourth - second * second))];
        let cuts = [size.0, size.1].map(|extent| {
            let cut = |at: usize| [at.min(reach), (extent - 1 - at).min(reach)];
            let mut cuts: Vec<_> = (0..extent).map(cut).collect();
            cuts.dedup();
            cuts
        });
        let whole = applicability.metric([reach; 2], [reach; 2]);
        let correction =
            |across, down| solve(applicability.metric(across, down), whole).map(|row: [f64; 6]| row.map(|v| v as f32));
        let corrections = cuts[1].iter().flat_map(|down| cuts[0].iter().map(|across| correction(*across, *down)));
        let corrections = corrections.collect();
        Self { size, kernels, second_moment: second as f32, cuts, corrections, applicability }
    }

    /// Returns the index of the cut of position `at` along an axis; all inner positions share one.
    fn cut(&self, axis: usize, at: usize) -> usize {
        let extent = [self.size.0, self.size.1][axis];
        let from_last = (self.cuts[axis].len() - 1).saturating_sub(extent - 1 - at);
        at.min(self.applicability.reach()).max(from_last)
    }

    /// Returns the polynomials of all pixels of `picture`.
    pub fn expand(&self, picture: &Grid<f32>, threads: &Threads) -> Grid<Packed> {
        effort::add(8 * picture.cells().len());
        let (width, height) = self.size;
        let mut polynomials = Grid::new(width, height, [0.0; 8]);
        threads.rows(&mut polynomials, |y, row| self.row(picture, y, row));
        polynomials
    }

    /// Computes the polynomials of row `y`, with the widest registers available; all give the same result.
    fn row(&self, picture: &Grid<f32>, y: usize, row: &mut [Packed]) {
        wide! {
            fn wide(by: &Expander, picture: &Grid<f32>, y: usize, row: &mut [Packed]) = Expander::row_body
        }
        wide(self, picture, y, row);
    }

    #[inline(always)]
    fn row_body(&self, picture: &Grid<f32>, y: usize, row: &mut [Packed]) {
        let ((width, height), reach) = (self.size, self.applicability.reach());
        let (top, bottom) = (y.saturating_sub(reach), (y + reach).min(height - 1));
        let mut padded = vec![0.0; width + 2 * reach];
        let mut parts: [Vec<f32>; 6] = std::array::from_fn(|_| vec![0.0; width]);
        // The horizontal kernels for each vertical one.
        for (down, across) in [(0, &[(1, 0), (2, 2), (0, 5)][..]), (1, &[(0, 1), (1, 3)]), (2, &[(0, 4)])] {
            let inside = &self.kernels[down][top + reach - y..=bottom + reach - y];
            weigh(&mut padded[reach..reach + width], inside, |k| picture.row(top + k));
            for &(kernel, part) in across {
                weigh(&mut parts[part], &self.kernels[kernel], |k| &padded[k..]);
            }
        }
        let [bx, by, xx, xy, yy, c] = parts.each_ref().map(|part| &part[..width]);
        for (x, polynomial) in row[..width].iter_mut().enumerate() {
            let value = c[x] - self.second_moment * (xx[x] + yy[x]);
            *polynomial = [bx[x], by[x], xx[x], 0.5 * xy[x], yy[x], value, 0.0, 0.0];
        }
        self.correct(y, row);
    }

    /// Corrects the polynomials of a row whose neighbourhoods extend beyond the border.
    fn correct(&self, y: usize, row: &mut [Packed]) {
        let ((width, height), reach) = (self.size, self.applicability.reach());
        let is_inner = |at: usize, extent: usize| at >= reach && at + reach < extent;
        let of_row = self.cut(1, y) * self.cuts[0].len();
        for (x, polynomial) in row.iter_mut().enumerate() {
            if is_inner(y, height) && is_inner(x, width) {
                continue;
            }
            let matrix = &self.corrections[of_row + self.cut(0, x)];
            let [bx, by, xx, xy, yy, c, ..] = *polynomial;
            let found = [c, bx, by, xx, yy, 2.0 * xy];
            let [c, bx, by, xx, yy, xy] =
                matrix.map(|factors| factors.iter().zip(found).map(|(factor, value)| factor * value).sum::<f32>());
            *polynomial = [bx, by, xx, 0.5 * xy, yy, c, 0.0, 0.0];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pixels without structure.
    fn texture(width: usize, height: usize) -> Grid<f32> {
        Grid::from_fn(width, height, |x, y| ((x * 37 + y * 101 + x * x * y * 13) % 251) as f32)
    }

    /// The weights of 1, x, y, x², y² and xy at a pixel.
    fn basis([x, y]: [f64; 2]) -> [f64; 6] {
        BASIS.map(|[i, j]| x.powi(i) * y.powi(j))
    }

    #[test]
    fn no_polynomial_fits_better_wherever_the_neighbourhood_is_cut() {
        for (size, sigma_px, reach) in [
            ((17, 13), 1.2, 3),
            ((17, 13), 1.5, 7),
            ((4, 5), 0.8, 2),
            ((2, 9), 1.1, 3),
            ((9, 1), 1.1, 2),
            ((1, 1), 1.1, 2),
        ] {
            let picture = texture(size.0, size.1);
            let expander = Expander::new(Applicability::new(sigma_px, reach), size);
            let found = expander.expand(&picture, &Threads::single());
            let weight = |c: f64| (-0.5 * (c / f64::from(sigma_px)).powi(2)).exp();
            let near = |a: usize, b: usize| a.abs_diff(b) <= reach;
            let pixels = || (0..size.1).flat_map(|y| (0..size.0).map(move |x| (x, y)));
            for (x, y) in pixels() {
                let polynomial = Polynomial::from(found[(x, y)]);
                // The residual is orthogonal to the basis.
                let (mut left, mut total) = ([0.0; 6], 0.0);
                for (px, py) in pixels().filter(|(px, py)| near(*px, x) && near(*py, y)) {
                    let place = [px as f64 - x as f64, py as f64 - y as f64];
                    let off = f64::from(picture[(px, py)] - polynomial.at(place.map(|c| c as f32)));
                    let weight = weight(place[0]) * weight(place[1]);
                    left.iter_mut().zip(basis(place)).for_each(|(left, function)| *left += weight * function * off);
                    total += weight;
                }
                assert!(left.iter().all(|left| left.abs() < 0.02 * total), "({x}, {y}) of {size:?}: {left:?}");
            }
        }
    }

    #[test]
    fn a_parabola_is_found_again_up_to_the_corners() {
        let parabola = Polynomial { c: 90.0, b: [3.0, -2.0], a: [0.5, -0.25, 0.125] };
        let picture = Grid::from_fn(12, 10, |x, y| parabola.at([x as f32 - 4.0, y as f32 - 4.0]));
        let expander = Expander::new(Applicability::new(1.2, 4), (12, 10));
        let found = expander.expand(&picture, &Threads::single());
        for (x, y) in (0..10).flat_map(|y| (0..12).map(move |x| (x, y))) {
            let Polynomial { c, b, a } = found[(x, y)].into();
            let [dx, dy] = [x as f32 - 4.0, y as f32 - 4.0];
            let gradient = [3.0 + dx - 0.5 * dy, -2.0 - 0.5 * dx + 0.25 * dy];
            assert!((c - picture[(x, y)]).abs() < 0.01, "{c} at ({x}, {y})");
            assert!((0..2).all(|i| (b[i] - gradient[i]).abs() < 0.01), "{b:?} at ({x}, {y}), not {gradient:?}");
            assert!((0..3).all(|i| (a[i] - parabola.a[i]).abs() < 0.01), "{a:?} at ({x}, {y})");
        }
    }

    #[test]
    fn a_line_of_pixels_does_not_bend_across() {
        let expander = Expander::new(Applicability::new(1.2, 3), (1, 9));
        let found = expander.expand(&texture(1, 9), &Threads::single());
        for polynomial in found.cells() {
            let Polynomial { b, a, .. } = (*polynomial).into();
            assert_eq!((b[0], a[0], a[1]), (0.0, 0.0, 0.0));
        }
    }
}
