//! Structure tensors of one image, row by row.

use std::ops::Range;

use crate::base::wide::wide;
use crate::geometry::{
    Beyond, Gray,
    filter::{filtered_row, weigh},
};
use crate::methods::differential::{Scheme, Tensor, Window};

/// The structure tensors of an image.
pub struct Tensors<'a> {
    /// The image.
    pub picture: &'a Gray,
    /// The derivative kernel.
    pub scheme: Scheme,
    /// The averaging window; its part outside the image has weight 0.
    pub window: Window,
}

/// The products I_x², I_x I_y and I_y² of a row.
type Products = [Vec<f32>; 3];

impl Tensors<'_> {
    /// Calls `tell` with the number of each of `rows` and the windowed means of I_x², I_x I_y and I_y² of its pixels, with the widest
    /// registers available; all give the same result.
    pub fn rows(&self, rows: Range<usize>, tell: impl FnMut(usize, [&[f32]; 3])) {
        wide! {
            fn wide(of: &Tensors, rows: Range<usize>, tell: impl FnMut(usize, [&[f32]; 3])) = Tensors::rows_body
        }
        wide(self, rows, tell);
    }

    #[inline(always)]
    fn rows_body(&self, rows: Range<usize>, mut tell: impl FnMut(usize, [&[f32]; 3])) {
        let ((width, height), reach) = (self.picture.size(), self.window.reach());
        let side = 2 * reach + 1;
        // A ring buffer of the rows in the window.
        let mut ring: Vec<Products> = vec![[const { Vec::new() }; 3]; side];
        let (mut next, mut control) = (rows.start.saturating_sub(reach), [const { Vec::new() }; 3]);
        let share = |at: usize, extent: usize| 1.0 / self.window.inside(at, extent).1.iter().sum::<f32>();
        let shares: Vec<f32> = (0..width).map(|x| share(x, width)).collect();
        let mut down = vec![0.0; width + 2 * reach];
        let mut means = [const { Vec::new() }; 3];
        for y in rows {
            let (top, weights) = self.window.inside(y, height);
            while next < top + weights.len() {
                self.products(next, &mut ring[next % side], &mut control);
                next += 1;
            }
            let share = share(y, height);
            for (part, mean) in means.iter_mut().enumerate() {
                weigh(&mut down[reach..reach + width], weights, |k| &ring[(top + k) % side][part][..]);
                mean.resize(width, 0.0);
                weigh(mean, self.window.weights(), |k| &down[k..]);
                mean.iter_mut().zip(&shares).for_each(|(mean, of_column)| *mean *= of_column * share);
            }
            tell(y, means.each_ref().map(Vec::as_slice));
        }
    }

    /// Returns the working memory of the rows in the window, in bytes.
    pub fn bytes(&self) -> usize {
        // Three products per row; the means of one row, and their intermediate results.
        let rows = 3 * (2 * self.window.reach() + 1) + 3 + 3;
        rows * self.picture.width() * size_of::<f32>()
    }

    /// Computes the products of row `y`.
    #[inline(always)]
    fn products(&self, y: usize, products: &mut Products, [row, x, across]: &mut [Vec<f32>; 3]) {
        let (width, height) = self.picture.size();
        let (along, mean) = self.scheme.weights();
        for (filter, part) in [((along, mean), &mut *x), ((mean, along), &mut *across)] {
            part.resize(width, 0.0);
            filtered_row((|y| self.picture.row(y), height), filter, (Beyond::Slope, y), row, part);
        }
        let [xx, xy, yy] = products;
        for (product, (a, b)) in [(xx, (&*x, &*x)), (xy, (&*x, &*across)), (yy, (&*across, &*across))] {
            product.clear();
            product.extend(a.iter().zip(b).map(|(a, b)| a * b));
        }
    }

    /// Returns the eigenvalue below which noise alone may be the gradient, in (gray levels per px)².
    pub fn flat_below(&self) -> f32 {
        let (along, mean) = self.scheme.weights();
        let [along, mean] = [along, mean].map(|weights| weights.iter().map(|weight| weight * weight).sum::<f32>());
        let noise = noise_deviation(self.picture);
        (NOISE_FACTOR * along * mean * noise * noise).max(FLAT_AREA)
    }

    /// Returns the tensor of one pixel.
    pub fn at(&self, (x, y): (usize, usize)) -> Tensor {
        let mut tensor = Tensor::default();
        self.rows(y..y + 1, |_, [xx, xy, yy]| tensor = Tensor { xx: xx[x], xy: xy[x], yy: yy[x], ..Tensor::default() });
        tensor
    }
}

/// Both eigenvalues below this are a flat area even without noise, in (gray levels per px)².
const FLAT_AREA: f32 = 0.05;
/// The eigenvalue up to which a window of noise is flat, as a multiple of the variance of its derivatives.
const NOISE_FACTOR: f32 = 4.0;
/// The largest absolute response of the mask of [`noise_deviation`].
const MOST_RESPONSE: usize = 8 * 255;

/// Returns the standard deviation of the noise of an image in gray levels, from the difference of two Laplacians (J. Immerkær, Fast noise
/// variance estimation, Computer Vision and Image Understanding 64(2), 1996). The median instead of the mean leaves out texture.
fn noise_deviation(picture: &Gray) -> f32 {
    let (width, height) = picture.size();
    let mut counts = vec![0usize; MOST_RESPONSE + 1];
    for y in 1..height.max(1) - 1 {
        let [above, row, below] = [y - 1, y, y + 1].map(|y| picture.row(y));
        let second = |x: usize, row: &[u8]| i32::from(row[x - 1]) - 2 * i32::from(row[x]) + i32::from(row[x + 1]);
        for x in 1..width.max(1) - 1 {
            let response = second(x, above) - 2 * second(x, row) + second(x, below);
            counts[response.unsigned_abs() as usize] += 1;
        }
    }
    let all: usize = counts.iter().sum();
    let mut up_to = 0;
    let median = counts.iter().position(|count| {
        up_to += count;
        2 * up_to >= all
    });
    // The mask has a norm of 6; the median of |N(0, 1)| is 0.6745.
    median.unwrap_or_default() as f32 / (6.0 * 0.6745)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;
    use crate::synth::random::hash;

    #[test]
    fn the_noise_is_found_beside_texture() {
        for sigma in [0.0, 2.0, 5.0f32] {
            let noisy = Grid::from_fn(160, 120, |x, y| {
                // The sum of twelve uniform numbers has variance 1.
                let sum: f32 = (0..12).map(|k| (hash(k, x as u64, y as u64) % 1000) as f32 / 1000.0).sum();
                let texture = if x < 40 { 30 * (x as i32 / 3 % 2) } else { x as i32 };
                (80.0 + texture as f32 + sigma * (sum - 6.0)).round() as u8
            });
            let found = noise_deviation(&noisy);
            assert!((found - sigma).abs() < 0.25 * sigma + 0.1, "{sigma}: {found}");
        }
        assert_eq!(noise_deviation(&Grid::new(1, 1, 9)), 0.0);
    }
}
