//! Reading pictures between their pixels, and bringing frame t + 1 back along a flow.

use super::Grid;
use crate::base::{
    LANES, Threads,
    wide::{lane, widest},
};

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
#[inline(always)]
fn keys(f: f32) -> [f32; 4] {
    let (f2, f3) = (f * f, f * f * f);
    [-0.5 * f3 + f2 - 0.5 * f, 1.5 * f3 - 2.5 * f2 + 1.0, -1.5 * f3 + 2.0 * f2 + 0.5 * f, 0.5 * f3 - 0.5 * f2]
}

/// The four pixels along an axis of `extent` px from which the place `c` is interpolated, and their weights; beyond the border the
/// edge is repeated.
#[inline]
pub(super) fn cubic_taps(c: f32, extent: usize) -> ([usize; 4], [f32; 4]) {
    let c = c.clamp(0.0, (extent - 1) as f32);
    let (first, last) = (c as usize, extent - 1);
    ([first.saturating_sub(1), first, (first + 1).min(last), (first + 2).min(last)], keys(c - first as f32))
}

/// The two pixels along an axis of `extent` px from which the place `c` is interpolated, and how far it lies from the first to the
/// second; beyond the border the edge is repeated.
pub(super) fn linear_taps(c: f32, extent: usize) -> ([usize; 2], f32) {
    let c = c.clamp(0.0, (extent - 1) as f32);
    let first = c as usize;
    ([first, (first + 1).min(extent - 1)], c - first as f32)
}

/// The weighted sum of four values.
#[inline(always)]
pub(super) fn weighted(weights: [f32; 4], [a, b, c, d]: [f32; 4]) -> f32 {
    weights[0] * a + weights[1] * b + weights[2] * c + weights[3] * d
}

#[inline]
fn bicubic(image: &Grid<f32>, x: f32, y: f32) -> f32 {
    let (width, height) = image.size();
    let ((columns, across), (rows, down)) = (cubic_taps(x, width), cubic_taps(y, height));
    let [a, b, c, d] = [image.row(rows[0]), image.row(rows[1]), image.row(rows[2]), image.row(rows[3])];
    let mut sums = [0.0; 4];
    for (sum, x) in sums.iter_mut().zip(columns) {
        *sum = weighted(down, [a[x], b[x], c[x], d[x]]);
    }
    weighted(across, sums)
}

/// Frame t + 1 warped toward frame t by the displacements `(u, v)`: the value of `next` at each displaced pixel, NaN where that
/// lies outside the picture or is not known.
pub fn backward(next: &Grid<f32>, [u, v]: [&Grid<f32>; 2], sampling: Sampling, threads: &Threads) -> Grid<f32> {
    let (width, height) = next.size();
    let mut warped = Grid::new(width, height, f32::NAN);
    threads.rows(&mut warped, |y, row| match sampling {
        Sampling::Bicubic => bicubic_row(next, y, [u.row(y), v.row(y)], row),
        Sampling::Bilinear => row_by_pixel((next, sampling), (0, y), [u.row(y), v.row(y)], row),
    });
    warped
}

/// Warps the pixels of a row from `(x, y)` on, one by one.
#[inline(always)]
fn row_by_pixel((next, sampling): (&Grid<f32>, Sampling), (x, y): (usize, usize), [u, v]: [&[f32]; 2], to: &mut [f32]) {
    for (i, (value, (u, v))) in to.iter_mut().zip(u.iter().zip(v)).enumerate() {
        *value = sampling.sample_inside(next, (x + i) as f32 + u, y as f32 + v);
    }
}

widest! {
    fn bicubic_row(next: &Grid<f32>, y: usize, flow: [&[f32]; 2], to: &mut [f32]) = bicubic_row_body
}

/// Warps row `y`: vectors of pixels whose sixteen neighbours all lie inside at once, the others one by one.
#[inline(always)]
fn bicubic_row_body(next: &Grid<f32>, y: usize, [u, v]: [&[f32]; 2], to: &mut [f32]) {
    for (i, to) in to.chunks_mut(LANES).enumerate() {
        let x = i * LANES;
        let vector = match (lane(u, x), lane(v, x)) {
            (Some(u), Some(v)) => bicubic_lanes(next, (x, y), [u, v]),
            _ => None,
        };
        match vector {
            Some(values) => to.copy_from_slice(&values),
            None => row_by_pixel((next, Sampling::Bicubic), (x, y), [&u[x..], &v[x..]], to),
        }
    }
}

/// Warps a vector of pixels from `(x, y)` on, if the neighbours of all of them lie inside; as [`bicubic`].
#[inline(always)]
fn bicubic_lanes(next: &Grid<f32>, (x, y): (usize, usize), [u, v]: [&[f32; LANES]; 2]) -> Option<[f32; LANES]> {
    let (width, height) = next.size();
    let [right, bottom] = [width, height].map(|extent| extent as f32 - 2.0);
    let (mut at_x, mut at_y, mut is_inside) = ([0.0; LANES], [0.0; LANES], true);
    for i in 0..LANES {
        (at_x[i], at_y[i]) = ((x + i) as f32 + u[i], y as f32 + v[i]);
        is_inside &= (at_x[i] >= 1.0) & (at_x[i] < right) & (at_y[i] >= 1.0) & (at_y[i] < bottom);
    }
    if !is_inside {
        return None;
    }
    let (mut first, mut across, mut down) = ([[0; LANES]; 2], [[0.0; LANES]; 4], [[0.0; LANES]; 4]);
    for i in 0..LANES {
        (first[0][i], first[1][i]) = (at_x[i] as i32, at_y[i] as i32);
        let (of_x, of_y) = (keys(at_x[i] - first[0][i] as f32), keys(at_y[i] - first[1][i] as f32));
        for k in 0..4 {
            (across[k][i], down[k][i]) = (of_x[k], of_y[k]);
        }
    }
    let mut values = [0.0; LANES];
    for i in 0..LANES {
        let corner = (first[1][i] as usize - 1) * width + first[0][i] as usize - 1;
        let row = |j: usize| next.cells()[corner + j * width..].first_chunk::<4>();
        let (a, b, c, d) = (row(0)?, row(1)?, row(2)?, row(3)?);
        let mut sums = [0.0; 4];
        for k in 0..4 {
            sums[k] = weighted([down[0][i], down[1][i], down[2][i], down[3][i]], [a[k], b[k], c[k], d[k]]);
        }
        values[i] = weighted([across[0][i], across[1][i], across[2][i], across[3][i]], sums);
    }
    Some(values)
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
    fn a_warped_picture_is_its_samples_one_by_one() {
        let next = Grid::from_fn(83, 21, |x, y| ((x * 37 + y * 101 + x * y * 13) % 256) as f32);
        let part = |k: usize| Grid::from_fn(83, 21, |x, y| ((x * 7 + y * 3 + k * x * y) % 61) as f32 / 10.0 - 3.0);
        let [u, v] = [part(1), part(2)];
        for sampling in [Sampling::Bicubic, Sampling::Bilinear] {
            let warped = backward(&next, [&u, &v], sampling, &Threads::single());
            for (x, y) in (0..21).flat_map(|y| (0..83).map(move |x| (x, y))) {
                let plain = sampling.sample_inside(&next, x as f32 + u[(x, y)], y as f32 + v[(x, y)]);
                assert_eq!(warped[(x, y)].to_bits(), plain.to_bits(), "{sampling:?} at ({x}, {y})");
            }
        }
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
