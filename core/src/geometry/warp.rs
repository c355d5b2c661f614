//! Reading pictures between their pixels, and bringing frame t + 1 back along a flow.

use super::Grid;
use crate::base::Threads;

/// Interpolation of a picture at sub-pixel positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// From the four pixels around, along straight lines.
    Bilinear,
    /// From the sixteen pixels around, by cubic polynomials: sharper (R. G. Keys, Cubic convolution interpolation for
    /// digital image processing, IEEE Trans. Acoustics, Speech, and Signal Processing 29(6), 1981).
    Bicubic,
}

impl Sampling {
    /// The value of `image` at `(x, y)`; beyond the border the edge is repeated.
    ///
    /// # Panics
    /// If the image is empty.
    pub fn sample(self, image: &Grid<f32>, x: f32, y: f32) -> f32 {
        match self {
            Sampling::Bilinear => image.sample(x, y),
            Sampling::Bicubic => bicubic(image, x, y),
        }
    }

    /// The value of `image` at `(x, y)`; NaN outside the picture, or where unknown.
    #[inline(always)]
    pub fn sample_inside(self, image: &Grid<f32>, x: f32, y: f32) -> f32 {
        let [right, bottom] = [image.width(), image.height()].map(|extent| extent as f32 - 1.0);
        // False for NaN as well.
        let is_inside = (0.0..=right).contains(&x) && (0.0..=bottom).contains(&y);
        if is_inside { self.sample(image, x, y) } else { f32::NAN }
    }
}

/// The weights of the pixels at −1, 0, 1 and 2 for a place `f` px after 0.
fn keys(f: f32) -> [f32; 4] {
    let (f2, f3) = (f * f, f * f * f);
    [-0.5 * f3 + f2 - 0.5 * f, 1.5 * f3 - 2.5 * f2 + 1.0, -1.5 * f3 + 2.0 * f2 + 0.5 * f, 0.5 * f3 - 0.5 * f2]
}

fn bicubic(image: &Grid<f32>, x: f32, y: f32) -> f32 {
    let (width, height) = image.size();
    let x = x.clamp(0.0, (width - 1) as f32);
    let y = y.clamp(0.0, (height - 1) as f32);
    let (x0, y0) = (x as usize, y as usize);
    let (across, down) = (keys(x - x0 as f32), keys(y - y0 as f32));
    let columns = [x0.saturating_sub(1), x0, (x0 + 1).min(width - 1), (x0 + 2).min(width - 1)];
    let rows = [y0.saturating_sub(1), y0, (y0 + 1).min(height - 1), (y0 + 2).min(height - 1)];
    let along = |y: usize| {
        let row = image.row(y);
        let [a, b, c, d] = columns.map(|x| row[x]);
        across[0] * a + across[1] * b + across[2] * c + across[3] * d
    };
    let [a, b, c, d] = rows.map(along);
    down[0] * a + down[1] * b + down[2] * c + down[3] * d
}

/// Frame t + 1 warped toward frame t by the displacements `(u, v)`: the value of `next` at each displaced pixel, NaN where that
/// lies outside the picture or is not known.
pub fn backward(next: &Grid<f32>, [u, v]: [&Grid<f32>; 2], sampling: Sampling, threads: &Threads) -> Grid<f32> {
    let (width, height) = next.size();
    let mut warped = Grid::new(width, height, f32::NAN);
    threads.rows(&mut warped, |y, row| {
        for (x, (value, (u, v))) in row.iter_mut().zip(u.row(y).iter().zip(v.row(y))).enumerate() {
            *value = sampling.sample_inside(next, x as f32 + u, y as f32 + v);
        }
    });
    warped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bicubic_sampling_is_exact_on_parabolas() {
        let f = |x: f32, y: f32| 0.5 * x * x - x * y + 2.0 * y * y - 3.0 * x + 1.0;
        let image = Grid::from_fn(9, 8, |x, y| f(x as f32, y as f32));
        for (x, y) in [(3.0, 4.0), (2.25, 3.5), (5.9, 1.1), (4.5, 4.999)] {
            let found = Sampling::Bicubic.sample(&image, x, y);
            assert!((found - f(x, y)).abs() < 1e-4, "{found}, not {} at {x}, {y}", f(x, y));
        }
        assert_eq!(Sampling::Bicubic.sample(&image, -4.0, 99.0), f(0.0, 7.0), "the edge is repeated");
        assert_eq!(Sampling::Bicubic.sample(&Grid::new(1, 1, 5.0), 0.3, 0.2), 5.0);
    }

    #[test]
    fn what_leaves_the_picture_is_not_known() {
        let next = Grid::from_fn(5, 3, |x, y| (10 * y + x) as f32);
        let u = Grid::from_fn(5, 3, |x, y| if (x, y) == (0, 0) { f32::NAN } else { 1.5 });
        let warped = backward(&next, [&u, &Grid::new(5, 3, 0.0)], Sampling::Bilinear, &Threads::single());
        let known: Vec<_> = warped.row(0).iter().map(|v| v.is_finite()).collect();
        assert_eq!(known, [false, true, true, false, false]);
        assert_eq!(warped.row(1)[..3], [11.5, 12.5, 13.5]);
    }
}
