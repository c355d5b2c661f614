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

    /// Returns the tensor of one pixel.
    pub fn at(&self, (x, y): (usize, usize)) -> Tensor {
        let mut tensor = Tensor::default();
        self.rows(y..y + 1, |_, [xx, xy, yy]| tensor = Tensor { xx: xx[x], xy: xy[x], yy: yy[x], ..Tensor::default() });
        tensor
    }
}
