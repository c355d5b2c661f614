//! The structure tensor: windowed means of the products of the derivatives.

use super::{Constraints, FLAT};
use crate::base::{effort, wide::wide};
use crate::choices;
use crate::geometry::filter::{gaussian_within, weigh};
use crate::scene::Spread;

choices! {
    /// Weights w of the pixels in a window.
    pub enum Weights {
        /// Equal weights.
        Box = "box" "Box",
        /// Gaussian with a standard deviation σ of a quarter of the window, cut off at 2 σ, the edge of the window.
        Gaussian = "gaussian" "Gaussian",
    }
}

impl Weights {
    /// Returns the window with a radius of `reach` px.
    pub fn window(self, reach: usize) -> Window {
        match self {
            Weights::Box => Window::even(reach),
            Weights::Gaussian => Window::gaussian(reach),
        }
    }
}

/// The texture of a window, by the eigenvalues of its structure tensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Texture {
    /// No pixel with a known constraint.
    Unknown,
    /// Both eigenvalues small, or one below the threshold and the other hardly larger.
    Flat,
    /// One eigenvalue large, the other small and at most a tenth of it.
    Edge,
    /// Both eigenvalues large.
    Corner,
}

/// The least ratio λ₁ / λ₂ of an edge (D. G. Lowe, Distinctive image features from scale-invariant keypoints, IJCV 60(2), 2004, section 4.1).
/// Below it the constraint lines have many directions.
pub const EDGE_RATIO: f32 = 10.0;

/// The weighted means over a window of the products of the derivatives; the weights sum to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tensor {
    /// Mean of I_x².
    pub xx: f32,
    /// Mean of I_x I_y.
    pub xy: f32,
    /// Mean of I_y².
    pub yy: f32,
    /// Mean of I_x I_t.
    pub xt: f32,
    /// Mean of I_y I_t.
    pub yt: f32,
    /// Mean of I_t².
    pub tt: f32,
    /// Effective number of pixels, (Σ w)² / Σ w².
    pub pixels: f32,
}

impl Tensor {
    /// Returns the eigenvalues λ₁ ≥ λ₂ of its spatial part.
    #[inline(always)]
    pub fn eigenvalues(&self) -> [f32; 2] {
        let (mean, half) = ((self.xx + self.yy) / 2.0, (self.xx - self.yy) / 2.0);
        let apart = (half * half + self.xy * self.xy).sqrt();
        [mean + apart, (mean - apart).max(0.0)]
    }

    /// Classifies the window; an eigenvalue is large from `threshold` on.
    #[inline(always)]
    pub fn texture(&self, threshold: f32) -> Texture {
        let [large, small] = self.eigenvalues();
        // Even without a threshold, rounding errors are no gradient and a singular tensor is no corner.
        let counts = |eigenvalue: f32| eigenvalue >= threshold && eigenvalue > FLAT;
        match () {
            () if self.pixels == 0.0 => Texture::Unknown,
            () if counts(small) && small > 1e-5 * large => Texture::Corner,
            () if counts(large) && large >= EDGE_RATIO * small => Texture::Edge,
            () => Texture::Flat,
        }
    }

    /// Returns the least-squares solution of the gradient constraints of the window. Not finite where the smaller eigenvalue
    /// is 0.
    #[inline(always)]
    pub fn solution(&self) -> [f32; 2] {
        let det = self.xx * self.yy - self.xy * self.xy;
        [(self.xy * self.yt - self.yy * self.xt) / det, (self.xy * self.xt - self.xx * self.yt) / det]
    }

    /// Returns the mean squared residual of the constraints at a displacement, in gray levels².
    pub fn residual(&self, [u, v]: [f32; 2]) -> f32 {
        let squares = self.xx * u * u + 2.0 * self.xy * u * v + self.yy * v * v;
        (squares + 2.0 * (self.xt * u + self.yt * v) + self.tt).max(0.0)
    }

    /// Returns the standard deviations of the least-squares solution `uv` along the eigenvectors, for independent residuals;
    /// `None` with no more than two constraints.
    pub fn spread(&self, uv: [f32; 2]) -> Option<Spread> {
        let [large, small] = self.eigenvalues();
        // The solution uses two degrees of freedom.
        let variance = self.residual(uv) / (self.pixels - 2.0);
        let radii = [variance / large, variance / small].map(f32::sqrt);
        let angle_rad = 0.5 * (2.0 * self.xy).atan2(self.xx - self.yy);
        (self.pixels > 2.0 && uv.iter().chain(&radii).all(|c| c.is_finite())).then_some(Spread {
            center: uv,
            radii,
            angle_rad,
        })
    }
}

/// A square window with its weights.
#[derive(Clone, Debug)]
pub struct Window {
    /// The weights along each axis; the largest is 1.
    weights: Vec<f32>,
}

/// The factors of each product: indices into x, y, t.
const PRODUCTS: [[usize; 2]; 6] = [[0, 0], [0, 1], [1, 1], [0, 2], [1, 2], [2, 2]];

/// The structure tensors of an image, row by row, over the known pixels of each window.
pub struct Sums<'a> {
    window: &'a Window,
    of: &'a Constraints,
    /// A ring buffer of the latest rows of products with their row numbers.
    products: Vec<Option<(usize, [Vec<f32>; 6])>>,
    /// The column sums, padded with zeros.
    down: Vec<f32>,
    means: [Vec<f32>; 6],
    /// For each column the sum of the window's weights inside the image, and of their squares.
    columns: Vec<[f32; 2]>,
    /// For each pixel of the row the known weight in its window, and the effective number of pixels.
    weights: Vec<f32>,
    pixels: Vec<f32>,
    unknown: Unknown,
}

/// The weight of the unknown pixels in each window.
#[derive(Default)]
struct Unknown {
    /// Sums of the weights and of their squares, down each column.
    down: Vec<[f32; 2]>,
    /// The same over the whole window; empty where all pixels are known.
    across: Vec<[f32; 2]>,
}

impl Unknown {
    /// Sums the weights of the unknown pixels in the window of each pixel of a row.
    fn sum_up(&mut self, window: &Window, of: &Constraints, (top, weights): (usize, &[f32])) {
        let width = of.a.width();
        self.across.clear();
        self.down.clear();
        for (k, weight) in weights.iter().enumerate() {
            for x in of.unknown_in_row(top + k) {
                self.down.resize(width, [0.0; 2]);
                add(&mut self.down[x], [*weight, weight * weight]);
            }
        }
        for (x, down) in self.down.iter().enumerate().filter(|(_, down)| down[0] > 0.0) {
            self.across.resize(width, [0.0; 2]);
            let (first, weights) = window.inside(x, width);
            // The window is symmetric, so the roles of pixel and column can be swapped.
            for (target, weight) in self.across[first..].iter_mut().zip(weights) {
                add(target, [weight * down[0], weight * weight * down[1]]);
            }
        }
    }

    fn at(&self, x: usize) -> [f32; 2] {
        self.across.get(x).copied().unwrap_or_default()
    }
}

fn add(sums: &mut [f32; 2], more: [f32; 2]) {
    *sums = [sums[0] + more[0], sums[1] + more[1]];
}

/// A window with less known weight has no known pixel: the smallest single weight is larger.
const LEAST_WEIGHT: f32 = 1e-3;

impl Window {
    /// Returns a box window with a radius of `reach` px.
    pub fn even(reach: usize) -> Self {
        Self { weights: vec![1.0; 2 * reach + 1] }
    }

    /// Returns a Gaussian window with a radius of `reach` px = 2 σ.
    pub fn gaussian(reach: usize) -> Self {
        let weights = gaussian_within(reach as f32 / 2.0, reach);
        Self { weights: weights.iter().map(|weight| weight / weights[reach]).collect() }
    }

    /// Returns its radius in px.
    pub fn reach(&self) -> usize {
        self.weights.len() / 2
    }

    /// Returns the weight of a pixel `x` and `y` px from the centre, at most 1.
    pub fn weight(&self, [x, y]: [isize; 2]) -> f32 {
        let along = |c: isize| self.weights[(c + self.reach() as isize) as usize];
        along(x) * along(y)
    }

    /// Returns the weights along each axis.
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }

    /// Returns the weights around `at` inside an `extent`, with the position of the first.
    pub fn inside(&self, at: usize, extent: usize) -> (usize, &[f32]) {
        let first = at.saturating_sub(self.reach());
        let last = (at + self.reach()).min(extent - 1);
        let skip = first + self.reach() - at;
        (first, &self.weights[skip..skip + last + 1 - first])
    }

    /// Returns the structure tensors of an image with these constraints.
    pub fn sums<'a>(&'a self, of: &'a Constraints) -> Sums<'a> {
        let width = of.a.width();
        let whole = counts(&self.weights);
        let column = |x: usize| {
            let is_whole = x >= self.reach() && x + self.reach() < width;
            if is_whole { whole } else { counts(self.inside(x, width).1) }
        };
        Sums {
            window: self,
            of,
            products: self.weights.iter().map(|_| None).collect(),
            down: vec![0.0; width + 2 * self.reach()],
            means: [(); 6].map(|()| vec![0.0; width]),
            columns: (0..width).map(column).collect(),
            weights: vec![0.0; width],
            pixels: vec![0.0; width],
            unknown: Unknown::default(),
        }
    }
}

/// The sums of `weights` and of their squares.
fn counts(weights: &[f32]) -> [f32; 2] {
    [weights.iter().sum(), weights.iter().map(|w| w * w).sum()]
}

impl Sums<'_> {
    /// Calls `tell` with column and tensor of each pixel of row `y`.
    pub fn row(&mut self, y: usize, mut tell: impl FnMut(usize, Tensor)) {
        wide! {
            fn compute(sums: &mut Sums, y: usize) = Sums::compute
        }
        compute(self, y);
        effort::add(self.columns.len());
        let width = self.columns.len();
        let [xx, xy, yy, xt, yt, tt] = self.means.each_ref().map(|means| &means[..width]);
        for (x, (&weight, &pixels)) in self.weights.iter().zip(&self.pixels).enumerate() {
            let tensor = Tensor { xx: xx[x], xy: xy[x], yy: yy[x], xt: xt[x], yt: yt[x], tt: tt[x], pixels };
            tell(x, if weight > LEAST_WEIGHT { tensor } else { Tensor::default() });
        }
    }

    /// Computes the means and the known weights of row `y`.
    #[inline(always)]
    fn compute(&mut self, y: usize) {
        let (width, height) = self.of.a.size();
        let (top, down) = self.window.inside(y, height);
        self.unknown.sum_up(self.window, self.of, (top, down));
        self.count(counts(down));
        (top..top + down.len()).for_each(|row| self.multiply(row));
        let (side, reach) = (self.products.len(), self.window.reach());
        for (i, means) in self.means.iter_mut().enumerate() {
            let product = |k: usize| self.products[(top + k) % side].as_ref().map_or(&[][..], |(_, of_row)| &of_row[i]);
            weigh(&mut self.down[reach..reach + width], down, product);
            weigh(means, &self.window.weights, |k| &self.down[k..]);
            means.iter_mut().zip(&self.weights).for_each(|(mean, weight)| *mean /= weight);
        }
    }

    /// Computes the known weight and the effective number of pixels of each window of a row.
    #[inline(always)]
    fn count(&mut self, [weight, squares]: [f32; 2]) {
        let counted = self.weights.iter_mut().zip(&mut self.pixels);
        for (x, ((known, pixels), column)) in counted.zip(&self.columns).enumerate() {
            let unknown = self.unknown.at(x);
            *known = column[0] * weight - unknown[0];
            *pixels = *known * *known / (column[1] * squares - unknown[1]);
        }
    }

    /// Computes the products of a row, unless they are in the ring buffer.
    #[inline(always)]
    fn multiply(&mut self, row: usize) {
        let side = self.products.len();
        let held = &mut self.products[row % side];
        if held.as_ref().is_some_and(|(held, _)| *held == row) {
            return;
        }
        let mut products = held.take().map(|(_, products)| products).unwrap_or_default();
        let parts = [&self.of.a, &self.of.b, &self.of.c].map(|part| part.row(row));
        for (product, [i, j]) in products.iter_mut().zip(PRODUCTS) {
            product.clear();
            product.extend(parts[i].iter().zip(parts[j]).map(|(a, b)| a * b));
        }
        *held = Some((row, products));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Threads;
    use crate::geometry::Grid;

    /// Checks the tensors of all pixels against plain sums over what is known.
    fn assert_plain(of: &Constraints, window: &Window) {
        let (reach, (width, height)) = (window.reach() as isize, of.a.size());
        let mut sums = window.sums(of);
        // Out of order, so that rows are revisited and skipped.
        for y in (0..height).map(|y| y * 4 % height) {
            sums.row(y, |x, found| {
                let (mut total, mut squares, mut sums) = (0.0, 0.0, [0.0; 6]);
                for (i, j) in (-reach..=reach).flat_map(|j| (-reach..=reach).map(move |i| (i, j))) {
                    let place = (x.checked_add_signed(i), y.checked_add_signed(j));
                    let (Some(px), Some(py)) = place else { continue };
                    if px < width && py < height && of.is_known((px, py)) {
                        let [a, b, c] = of.at((px, py));
                        let weight = window.weight([i, j]);
                        let products = [a * a, a * b, b * b, a * c, b * c, c * c];
                        sums.iter_mut().zip(products).for_each(|(sum, product)| *sum += weight * product);
                        (total, squares) = (total + weight, squares + weight * weight);
                    }
                }
                let Tensor { xx, xy, yy, xt, yt, tt, pixels } = found;
                let plain = sums.map(|sum| if total > 0.0 { sum / total } else { 0.0 });
                for (found, plain) in [xx, xy, yy, xt, yt, tt].into_iter().zip(plain) {
                    assert!((found - plain).abs() < 1e-3 * (1.0 + plain.abs()), "({x}, {y}): {found}, not {plain}");
                }
                let plain = if total > 0.0 { total * total / squares } else { 0.0 };
                assert!((pixels - plain).abs() < 1e-3 * (1.0 + plain), "({x}, {y}): {pixels} pixels, not {plain}");
            });
        }
    }

    #[test]
    fn a_tensor_is_the_weighted_mean_over_what_is_known_under_the_window() {
        let part = |k: usize| Grid::from_fn(11, 9, move |x, y| ((x * 7 + y * 13 + x * y * k) % 17) as f32 - 8.0);
        let hidden = Grid::from_fn(11, 9, |x, y| {
            let is_gone = x > 5 || (x, y) == (2, 3) || y == 0;
            if is_gone { f32::NAN } else { part(7)[(x, y)] }
        });
        for c in [part(7), hidden] {
            let parts = [part(3), part(5), c];
            let write = |y: usize, row: [&mut [f32]; 3]| {
                row.into_iter().zip(&parts).for_each(|(row, part)| row.copy_from_slice(part.row(y)));
            };
            let of = Constraints::new((11, 9), write, &Threads::single());
            [Window::even(2), Window::gaussian(3)].iter().for_each(|window| assert_plain(&of, window));
        }
    }

    #[test]
    fn texture_follows_from_the_eigenvalues() {
        let texture = |xx, yy, threshold| Tensor { xx, yy, pixels: 9.0, ..Tensor::default() }.texture(threshold);
        assert_eq!(texture(4.0, 3.0, 0.5), Texture::Corner);
        assert_eq!((texture(4.2, 0.4, 0.5), texture(0.4, 0.4, 0.5)), (Texture::Edge, Texture::Flat));
        // The weak gradients of a flat window have all directions.
        assert_eq!((texture(0.99, 0.4, 0.5), texture(4.6, 0.48, 0.5)), (Texture::Flat, Texture::Flat));
        // Without a threshold, rounding is neither an edge nor a corner.
        assert_eq!((texture(4.0, 2e-5, 0.0), texture(1e-3, 1e-7, 0.0)), (Texture::Edge, Texture::Edge));
        assert_eq!((texture(1e-9, 0.0, 0.0), texture(1e-9, 1e-9, 0.0)), (Texture::Flat, Texture::Flat));
        assert_eq!(texture(0.4, 0.3, 0.0), Texture::Corner);
        assert_eq!(Tensor::default().texture(0.0), Texture::Unknown);
    }

    #[test]
    fn eigenvalues_solution_and_residual_are_those_of_the_textbook() {
        // Gradients (3, 0) and (0, 1), by which (2, −1) is seen exactly.
        let constraints = [[3.0, 0.0, -6.0], [0.0, 1.0, 1.0f32]];
        let mean = |i: usize, j: usize| constraints.iter().map(|c| c[i] * c[j]).sum::<f32>() / 2.0;
        let tensor = Tensor {
            xx: mean(0, 0),
            xy: mean(0, 1),
            yy: mean(1, 1),
            xt: mean(0, 2),
            yt: mean(1, 2),
            tt: mean(2, 2),
            pixels: 2.0,
        };
        assert_eq!((tensor.eigenvalues(), tensor.solution()), ([4.5, 0.5], [2.0, -1.0]));
        assert_eq!((tensor.residual([2.0, -1.0]), tensor.residual([2.0, 0.0])), (0.0, 0.5));
        assert_eq!(tensor.spread([2.0, -1.0]), None, "two lines always cross");
        assert_eq!(Tensor { pixels: 9.0, ..tensor }.spread([f32::NAN; 2]), None);
        let more = Tensor { pixels: 18.0, tt: tensor.tt + 2.0, ..tensor };
        let spread = more.spread([2.0, -1.0]).expect("enough lines");
        // Variance 2 over 16 pixels, divided by 4.5 along u and by 0.5 along v.
        assert!((spread.radii[0] - (0.125f32 / 4.5).sqrt()).abs() < 1e-5 && (spread.radii[1] - 0.5).abs() < 1e-5);
        assert_eq!(spread.angle_rad, 0.0);
    }
}
