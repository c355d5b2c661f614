//! The structure tensor: what the gradients in a window say together.

use super::Derivatives;
use super::filter::gaussian_within;
use crate::choices;
use crate::scene::Spread;

choices! {
    /// How much the pixels of a window count.
    pub enum Weights {
        /// All alike.
        Box = "box" "Box",
        /// The less the farther from the middle, by a Gaussian that falls to two standard deviations at the edge.
        Gaussian = "gaussian" "Gaussian",
    }
}

impl Weights {
    /// A window that reaches `reach` px each way.
    pub fn window(self, reach: usize) -> Window {
        match self {
            Weights::Box => Window::even(reach),
            Weights::Gaussian => Window::gaussian(reach),
        }
    }
}

/// The weighted means over a window of the products of the derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tensor {
    /// Of Iₓ².
    pub xx: f32,
    /// Of Iₓ I_y.
    pub xy: f32,
    /// Of I_y².
    pub yy: f32,
    /// Of Iₓ Iₜ.
    pub xt: f32,
    /// Of I_y Iₜ.
    pub yt: f32,
    /// Of Iₜ².
    pub tt: f32,
    /// How many pixels count, those of less weight less.
    pub pixels: f32,
}

impl Tensor {
    /// The eigenvalues of its spatial part, the larger first.
    #[inline(always)]
    pub fn eigenvalues(&self) -> [f32; 2] {
        let (mean, half) = ((self.xx + self.yy) / 2.0, (self.xx - self.yy) / 2.0);
        let apart = (half * half + self.xy * self.xy).sqrt();
        [mean + apart, (mean - apart).max(0.0)]
    }

    /// The displacement that fits all constraints of the window best, in the mean square. Not finite where the smaller
    /// eigenvalue is 0.
    #[inline(always)]
    pub fn solution(&self) -> [f32; 2] {
        let det = self.xx * self.yy - self.xy * self.xy;
        [(self.xy * self.yt - self.yy * self.xt) / det, (self.xy * self.xt - self.xx * self.yt) / det]
    }

    /// The mean square by which the constraints are off at a displacement, in gray levels².
    pub fn residual(&self, [u, v]: [f32; 2]) -> f32 {
        let squares = self.xx * u * u + 2.0 * self.xy * u * v + self.yy * v * v;
        (squares + 2.0 * (self.xt * u + self.yt * v) + self.tt).max(0.0)
    }

    /// The standard deviations of the displacement `uv` along the axes of the tensor, if each constraint is off by chance
    /// and by itself; `None` where that is not known, or there are too few to tell.
    pub fn spread(&self, uv: [f32; 2]) -> Option<Spread> {
        let [large, small] = self.eigenvalues();
        // Two of the pixels were needed for the displacement itself.
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

/// The products of the derivatives: which two of x, y and t.
const PRODUCTS: [[usize; 2]; 6] = [[0, 0], [0, 1], [1, 1], [0, 2], [1, 2], [2, 2]];

/// Room for the sums along a row.
#[derive(Default)]
pub struct Sums {
    down: [Vec<f32>; 6],
    across: [Vec<f32>; 6],
}

impl Window {
    /// A window that reaches `reach` px each way, all pixels alike.
    pub fn even(reach: usize) -> Self {
        Self { weights: vec![1.0; 2 * reach + 1] }
    }

    /// A window that reaches `reach` px each way, by when a Gaussian has fallen to two standard deviations.
    pub fn gaussian(reach: usize) -> Self {
        let weights = gaussian_within(reach as f32 / 2.0, reach);
        Self { weights: weights.iter().map(|weight| weight / weights[reach]).collect() }
    }

    /// How far it reaches, in px.
    pub fn reach(&self) -> usize {
        self.weights.len() / 2
    }

    /// The weight of a pixel `x` and `y` px from the middle, up to 1.
    pub fn weight(&self, [x, y]: [isize; 2]) -> f32 {
        let along = |c: isize| self.weights[(c + self.reach() as isize) as usize];
        along(x) * along(y)
    }

    /// The weights along each axis.
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }

    /// The weights around `at` that lie inside an `extent`, with the first place that they are for.
    pub fn inside(&self, at: usize, extent: usize) -> (usize, &[f32]) {
        let first = at.saturating_sub(self.reach());
        let last = (at + self.reach()).min(extent - 1);
        let skip = first + self.reach() - at;
        (first, &self.weights[skip..skip + last + 1 - first])
    }

    /// The tensors along row `y`, over as much of the window as lies in the picture.
    pub fn row(&self, of: &Derivatives, y: usize, sums: &mut Sums, mut tell: impl FnMut(usize, Tensor)) {
        let (width, height) = of.x.size();
        let reach = self.reach();
        let (top, down) = self.inside(y, height);
        sum_up(self, of, (top, down), sums);
        let count = |weights: &[f32]| [weights.iter().sum::<f32>(), weights.iter().map(|w| w * w).sum()];
        let [weight_down, squares_down] = count(down);
        let whole = count(&self.weights);
        for x in 0..width {
            let is_whole = x >= reach && x + reach < width;
            let [weight, squares] = if is_whole { whole } else { count(self.inside(x, width).1) };
            let (weight, squares) = (weight * weight_down, squares * squares_down);
            let [xx, xy, yy, xt, yt, tt] = [0, 1, 2, 3, 4, 5].map(|i| sums.across[i][x] / weight);
            tell(x, Tensor { xx, xy, yy, xt, yt, tt, pixels: weight * weight / squares });
        }
    }
}

/// Adds up the products under the window of each pixel of a row, with the widest registers there are; all give the same.
fn sum_up(window: &Window, of: &Derivatives, rows: (usize, &[f32]), sums: &mut Sums) {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2.
        return unsafe { sum_up_avx2(window, of, rows, sums) };
    }
    sum_up_anyhow(window, of, rows, sums);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn sum_up_avx2(window: &Window, of: &Derivatives, rows: (usize, &[f32]), sums: &mut Sums) {
    sum_up_anyhow(window, of, rows, sums);
}

#[inline(always)]
fn sum_up_anyhow(window: &Window, of: &Derivatives, (top, weights): (usize, &[f32]), sums: &mut Sums) {
    let (width, reach) = (of.x.width(), window.reach());
    let parts = [&of.x, &of.y, &of.t];
    for (product, [i, j]) in PRODUCTS.into_iter().enumerate() {
        let (down, across) = (&mut sums.down[product], &mut sums.across[product]);
        down.clear();
        // Beyond the edge there is nothing.
        down.resize(width + 2 * reach, 0.0);
        for (k, weight) in weights.iter().enumerate() {
            let (a, b) = (parts[i].row(top + k), parts[j].row(top + k));
            for (sum, (a, b)) in down[reach..reach + width].iter_mut().zip(a.iter().zip(b)) {
                *sum += weight * (a * b);
            }
        }
        across.clear();
        across.resize(width, 0.0);
        for (k, weight) in window.weights.iter().enumerate() {
            for (sum, value) in across.iter_mut().zip(&down[k..]) {
                *sum += weight * value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Grid;

    #[test]
    fn a_tensor_is_the_weighted_mean_over_the_part_of_the_window_in_the_picture() {
        let part = |k: usize| Grid::from_fn(11, 9, move |x, y| ((x * 7 + y * 13 + x * y * k) % 17) as f32 - 8.0);
        let of = Derivatives { x: part(3), y: part(5), t: part(7) };
        for window in [Window::even(2), Window::gaussian(3)] {
            let reach = window.reach() as isize;
            for y in 0..9 {
                window.row(&of, y, &mut Sums::default(), |x, found| {
                    let (mut total, mut sums) = (0.0, [0.0; 6]);
                    for (i, j) in (-reach..=reach).flat_map(|j| (-reach..=reach).map(move |i| (i, j))) {
                        let place = (x.checked_add_signed(i), y.checked_add_signed(j));
                        let (Some(px), Some(py)) = place else { continue };
                        if px < 11 && py < 9 {
                            let [a, b, c] = of.at((px, py));
                            let weight = window.weight([i, j]);
                            let products = [a * a, a * b, b * b, a * c, b * c, c * c];
                            sums.iter_mut().zip(products).for_each(|(sum, product)| *sum += weight * product);
                            total += weight;
                        }
                    }
                    let found = [found.xx, found.xy, found.yy, found.xt, found.yt, found.tt];
                    for (found, sum) in found.into_iter().zip(sums) {
                        assert!((found - sum / total).abs() < 1e-3, "({x}, {y}): {found}, not {}", sum / total);
                    }
                });
            }
        }
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
