//! The determinant of the Hessian from box filters on an integral image.

use std::ops::Range;

use crate::base::{effort, wide::wide};
use crate::geometry::Grid;
use crate::methods::features::integral::{Integral, PixelBox};

/// Balance of D_xy against D_xx and D_yy, because boxes only approximate derivatives of a Gaussian.
pub const BALANCE: f32 = 0.9;

/// Layers of an octave.
pub const LAYERS: usize = 4;

/// Filter size of the first layer, and the standard deviation of the Gaussian derivative that it approximates, in px.
const BASE: (f32, f32) = (9.0, 1.2);

/// The box filters of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Filter {
    /// Side of the filter in px: 9, 15, 21, 27 in the first octave.
    pub size: usize,
}

/// A box of a filter with its weight.
pub type Weighted = (PixelBox, i32);

impl Filter {
    /// The filter of layer `index` of an octave.
    pub const fn of(octave: usize, index: usize) -> Self {
        Self { size: 3 * ((2 << octave) * (index + 1) + 1) }
    }

    /// The length of a lobe: a third of the side.
    pub const fn lobe(self) -> usize {
        self.size / 3
    }

    /// The scale in px.
    pub fn scale(self) -> f32 {
        scale_of(self.size as f32)
    }

    /// The boxes of D_xx, D_yy and D_xy around a pixel, with their weights.
    pub fn boxes(self, (x, y): (usize, usize)) -> [Vec<Weighted>; 3] {
        let (lobe, half) = (self.lobe() as i32, self.size as i32 / 2);
        let (narrow, broad) = (lobe / 2, lobe - 1);
        let at = |of: PixelBox| of.moved([x as i32, y as i32]);
        let [across, down] = [[2 * half + 1, 2 * broad + 1], [2 * broad + 1, 2 * half + 1]];
        let xx = vec![
            (at(PixelBox::new([-half, -broad], [lobe, across[1]])), 1),
            (at(PixelBox::new([-narrow, -broad], [lobe, across[1]])), -2),
            (at(PixelBox::new([narrow + 1, -broad], [lobe, across[1]])), 1),
        ];
        let yy = vec![
            (at(PixelBox::new([-broad, -half], [down[0], lobe])), 1),
            (at(PixelBox::new([-broad, -narrow], [down[0], lobe])), -2),
            (at(PixelBox::new([-broad, narrow + 1], [down[0], lobe])), 1),
        ];
        let xy = vec![
            (at(PixelBox::new([-lobe, -lobe], [lobe; 2])), 1),
            (at(PixelBox::new([1, -lobe], [lobe; 2])), -1),
            (at(PixelBox::new([-lobe, 1], [lobe; 2])), -1),
            (at(PixelBox::new([1, 1], [lobe; 2])), 1),
        ];
        [xx, yy, xy]
    }

    /// D_xx, D_yy and D_xy of a pixel, box after box.
    pub fn derivatives(self, integral: &Integral, place: (usize, usize)) -> [f32; 3] {
        self.boxes(place).map(|boxes| {
            let sum: i64 = boxes.iter().map(|(of, weight)| i64::from(*weight) * i64::from(integral.sum(*of))).sum();
            sum as f32 / (self.size * self.size) as f32
        })
    }
}

/// The scale of a filter of this size, in px.
pub fn scale_of(size: f32) -> f32 {
    size * BASE.1 / BASE.0
}

/// The determinant from D_xx, D_yy and D_xy.
#[inline(always)]
pub fn determinant([xx, yy, xy]: [f32; 3]) -> f32 {
    xx * yy - (BALANCE * xy) * (BALANCE * xy)
}

/// The responses of one filter, one for every `step` px each way.
#[derive(Debug)]
pub struct Layer {
    /// The filter.
    pub filter: Filter,
    /// The distance of the samples in px.
    pub step: usize,
    /// The responses; 0 where the filter does not fit into the picture.
    pub responses: Grid<f32>,
}

impl Layer {
    /// Computes the responses of a layer of an octave.
    pub fn of(integral: &Integral, octave: usize, index: usize) -> Self {
        wide! {
            fn rows(layer: &mut Layer, integral: &Integral) = Layer::fill
        }
        let (step, filter) = (1 << octave, Filter::of(octave, index));
        let (width, height) = integral.size();
        effort::add(width.div_ceil(step) * height.div_ceil(step));
        let responses = Grid::new(width.div_ceil(step), height.div_ceil(step), 0.0);
        let mut layer = Self { filter, step, responses };
        rows(&mut layer, integral);
        layer
    }

    /// The samples along an axis at which the filter fits.
    fn samples(&self, extent: usize) -> Range<usize> {
        let half = self.filter.size / 2;
        let first = half.div_ceil(self.step);
        first..extent.saturating_sub(half).div_ceil(self.step).max(first)
    }

    #[inline(always)]
    fn fill(&mut self, integral: &Integral) {
        let (width, height) = integral.size();
        let (lobe, half) = (self.filter.lobe(), self.filter.size / 2);
        let (narrow, broad) = (lobe / 2, lobe - 1);
        let (columns, rows) = (self.samples(width), self.samples(height));
        if columns.is_empty() || rows.is_empty() {
            return;
        }
        let share = 1.0 / (self.filter.size * self.filter.size) as f32;
        // Sums down the bands of the filters, for each column so far.
        let [mut across, mut down, mut mixed] = [const { Vec::new() }; 3].map(|mut of: Vec<u32>| {
            of.resize(width + 1, 0);
            of
        });
        for row in rows {
            let y = row * self.step;
            let band = |rows: Range<usize>| (integral.row(rows.start), integral.row(rows.end));
            subtract(&mut across, band(y - broad..y + broad + 1));
            let (full, middle) = (band(y - half..y + half + 1), band(y - narrow..y + narrow + 1));
            let (upper, lower) = (band(y - lobe..y), band(y + 1..y + lobe + 1));
            for (x, (down, mixed)) in down.iter_mut().zip(&mut mixed).enumerate() {
                let of = |(top, bottom): (&[u32], &[u32])| bottom[x].wrapping_sub(top[x]);
                *down = of(full).wrapping_sub(of(middle).wrapping_mul(3));
                *mixed = of(upper).wrapping_sub(of(lower));
            }
            let responses = &mut self.responses.row_mut(row)[columns.clone()];
            let first = columns.start * self.step;
            let at = |offset: isize| (first as isize + offset) as usize;
            let [lobe, half, narrow, broad] = [lobe, half, narrow, broad].map(|reach| reach as isize);
            let wide = [at(half + 1), at(-half), at(narrow + 1), at(-narrow)];
            let tall = [at(broad + 1), at(-broad)];
            let four = [at(0), at(-lobe), at(lobe + 1), at(1)];
            let sums = Bands { across: &across, down: &down, mixed: &mixed, wide, tall, four, share };
            // With neighbouring samples the compiler makes vector instructions of it.
            match self.step {
                1 => sums.respond::<1>(responses),
                2 => sums.respond::<2>(responses),
                step => sums.respond_at(step, responses),
            }
        }
    }

    /// The pixel of a sample.
    pub fn pixel(&self, (i, j): (usize, usize)) -> (usize, usize) {
        (i * self.step, j * self.step)
    }

    /// The sample nearest to a place of the frame.
    pub fn nearest(&self, at: [f32; 2]) -> Option<(usize, usize)> {
        self.responses.cell_at(at.map(|c| c / self.step as f32))
    }

    /// Whether the filter fits around a sample.
    pub fn fits(&self, (i, j): (usize, usize), (width, height): (usize, usize)) -> bool {
        self.samples(width).contains(&i) && self.samples(height).contains(&j)
    }

    /// The sample of the largest response, if any is positive.
    pub fn strongest(&self) -> Option<(usize, usize)> {
        let mut best = (0, 0.0);
        for (i, response) in self.responses.cells().iter().enumerate() {
            if *response > best.1 {
                best = (i, *response);
            }
        }
        (best.1 > 0.0).then(|| (best.0 % self.responses.width(), best.0 / self.responses.width()))
    }
}

/// The sums down the bands of the filters in a row of samples, and the columns between which those of the first sample lie.
struct Bands<'a> {
    across: &'a [u32],
    down: &'a [u32],
    mixed: &'a [u32],
    wide: [usize; 4],
    tall: [usize; 2],
    four: [usize; 4],
    share: f32,
}

impl Bands<'_> {
    /// Computes the responses of samples `STEP` px apart.
    #[inline(always)]
    fn respond<const STEP: usize>(&self, responses: &mut [f32]) {
        self.respond_at(STEP, responses);
    }

    /// Computes the responses of samples `step` px apart.
    #[inline(always)]
    fn respond_at(&self, step: usize, responses: &mut [f32]) {
        let length = (responses.len() - 1) * step + 1;
        let wide = self.wide.map(|first| &self.across[first..][..length]);
        let tall = self.tall.map(|first| &self.down[first..][..length]);
        let four = self.four.map(|first| &self.mixed[first..][..length]);
        for (i, response) in responses.iter_mut().enumerate() {
            let x = i * step;
            let xx = wide[0][x].wrapping_sub(wide[1][x]);
            let xx = xx.wrapping_sub(wide[2][x].wrapping_sub(wide[3][x]).wrapping_mul(3));
            let yy = tall[0][x].wrapping_sub(tall[1][x]);
            let xy = four[0][x].wrapping_sub(four[1][x]).wrapping_sub(four[2][x].wrapping_sub(four[3][x]));
            *response = determinant([xx, yy, xy].map(|sum| sum as i32 as f32 * self.share));
        }
    }
}

/// The differences of two rows.
#[inline(always)]
fn subtract(target: &mut [u32], (top, bottom): (&[u32], &[u32])) {
    for (difference, (top, bottom)) in target.iter_mut().zip(top.iter().zip(bottom)) {
        *difference = bottom.wrapping_sub(*top);
    }
}

/// The three layers in which an extremum is looked for: the one below, its own and the one above.
pub type Three<'a> = [&'a Layer; 3];

/// A neighbour in the 3×3×3 samples: its layer of [`Three`], and its sample.
pub type Neighbor = (usize, (usize, usize));

/// Whether a sample is suppressed: none of its 26 neighbours may be as large.
#[inline]
pub fn is_suppressed(layers: Three<'_>, (i, j): (usize, usize)) -> bool {
    let here = layers[1].responses.row(j)[i];
    let three = |layer: usize, j: usize| layers[layer].responses.row(j)[i - 1..].first_chunk::<3>().copied();
    let exceeds = |layer: usize, j: usize| three(layer, j).is_some_and(|[a, b, c]| a >= here || b >= here || c >= here);
    let [left, right] = [layers[1].responses.row(j)[i - 1], layers[1].responses.row(j)[i + 1]];
    left >= here
        || right >= here
        || [j - 1, j + 1].into_iter().any(|j| exceeds(1, j))
        || [0, 2].into_iter().any(|layer| exceeds(layer, j - 1) || exceeds(layer, j) || exceeds(layer, j + 1))
}

/// The largest of the 26 neighbours of a sample, if it is not smaller than the sample: it suppresses it.
pub fn suppressed_by(layers: Three<'_>, (i, j): (usize, usize)) -> Option<Neighbor> {
    let all = (0..3).flat_map(|k| (j - 1..=j + 1).flat_map(move |j| (i - 1..=i + 1).map(move |i| (k, (i, j)))));
    let response = |(k, place): Neighbor| layers[k].responses[place];
    let largest = all
        .filter(|neighbor| *neighbor != (1, (i, j)))
        .reduce(|best, other| if response(other) > response(best) { other } else { best })?;
    (response(largest) >= response((1, (i, j)))).then_some(largest)
}

/// A maximum refined to a fraction of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refined {
    /// Offset in samples along x and y, and in layers.
    pub offset: [f32; 3],
    /// The response at the refined place.
    pub response: f32,
}

impl Refined {
    /// The vertex of the quadratic function through a maximum and its neighbours; `None` where it has none.
    pub fn of(layers: Three<'_>, (i, j): (usize, usize)) -> Option<Self> {
        let at = |dx: isize, dy: isize, ds: isize| {
            let place = ((i as isize + dx) as usize, (j as isize + dy) as usize);
            layers[(1 + ds) as usize].responses[place]
        };
        let here = at(0, 0, 0);
        let gradient = [
            (at(1, 0, 0) - at(-1, 0, 0)) / 2.0,
            (at(0, 1, 0) - at(0, -1, 0)) / 2.0,
            (at(0, 0, 1) - at(0, 0, -1)) / 2.0,
        ];
        let second = [
            at(1, 0, 0) + at(-1, 0, 0) - 2.0 * here,
            at(0, 1, 0) + at(0, -1, 0) - 2.0 * here,
            at(0, 0, 1) + at(0, 0, -1) - 2.0 * here,
        ];
        let xy = (at(1, 1, 0) + at(-1, -1, 0) - at(1, -1, 0) - at(-1, 1, 0)) / 4.0;
        let xs = (at(1, 0, 1) + at(-1, 0, -1) - at(1, 0, -1) - at(-1, 0, 1)) / 4.0;
        let ys = (at(0, 1, 1) + at(0, -1, -1) - at(0, 1, -1) - at(0, -1, 1)) / 4.0;
        let hessian = nalgebra::Matrix3::new(second[0], xy, xs, xy, second[1], ys, xs, ys, second[2]);
        let offset = hessian.lu().solve(&-nalgebra::Vector3::from(gradient))?;
        let rise: f32 = (0..3).map(|k| gradient[k] * offset[k]).sum();
        let offset: [f32; 3] = offset.into();
        offset.iter().all(|c| c.is_finite()).then_some(Self { offset, response: here + rise / 2.0 })
    }

    /// Whether the vertex lies within one sample of the maximum.
    pub fn is_near(&self) -> bool {
        self.offset.iter().all(|c| c.abs() <= 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filters_have_the_sizes_of_the_paper() {
        let sizes = |octave| (0..LAYERS).map(|index| Filter::of(octave, index).size).collect::<Vec<_>>();
        assert_eq!(sizes(0), [9, 15, 21, 27]);
        assert_eq!(sizes(1), [15, 27, 39, 51]);
        assert_eq!(sizes(2), [27, 51, 75, 99]);
        assert!((Filter::of(0, 0).scale() - 1.2).abs() < 1e-6);
    }

    #[test]
    fn the_boxes_of_a_filter_cancel_on_a_slope_and_have_its_size() {
        let filter = Filter::of(0, 1);
        for boxes in filter.boxes((20, 20)) {
            let sum: i32 = boxes.iter().map(|(of, weight)| of.area() * weight).sum();
            assert_eq!(sum, 0);
        }
        let [xx, yy, _] = filter.boxes((20, 20));
        assert_eq!((xx[0].0.min[0], xx[2].0.max[0]), (13, 28));
        assert_eq!((yy[0].0.min[1], yy[2].0.max[1]), (13, 28));
    }

    #[test]
    fn rows_give_what_single_pixels_give() {
        let picture = Grid::from_fn(70, 61, |x, y| ((x * x * 3 + y * 37 + x * y * 5) % 251) as u8);
        let integral = Integral::of(&picture);
        for (octave, index) in [(0, 0), (0, 3), (1, 1), (2, 0), (2, 3)] {
            let layer = Layer::of(&integral, octave, index);
            let (mut inside, (width, height)) = (0, layer.responses.size());
            for place in (0..height).flat_map(|j| (0..width).map(move |i| (i, j))) {
                let (x, y) = layer.pixel(place);
                let half = layer.filter.size / 2;
                let fits = x >= half && y >= half && x + half < 70 && y + half < 61;
                assert_eq!(layer.fits(place, (70, 61)), fits, "{place:?} of {octave}, {index}");
                let plain = if fits { determinant(layer.filter.derivatives(&integral, (x, y))) } else { 0.0 };
                let found = layer.responses[place];
                assert!((found - plain).abs() <= 1e-3 * plain.abs().max(1.0), "{found} at {place:?}, plainly {plain}");
                inside += usize::from(fits);
            }
            assert!(inside > 0 || layer.filter.size > 61);
        }
    }

    #[test]
    fn the_vertex_of_a_quadratic_function_is_found() {
        let of = |k: usize| {
            let value = |i: usize, j: usize| {
                let [x, y, s] = [i as f32 - 2.2, j as f32 - 1.9, k as f32 - 1.3];
                50.0 - 2.0 * x * x - 3.0 * y * y - s * s + 0.5 * x * y
            };
            Layer { filter: Filter::of(0, k), step: 1, responses: Grid::from_fn(5, 5, value) }
        };
        let layers = [of(0), of(1), of(2)];
        let refined = Refined::of(layers.each_ref(), (2, 2)).expect("a maximum");
        let off = refined.offset.iter().zip([0.2, -0.1, 0.3]).all(|(found, truth)| (found - truth).abs() < 1e-3);
        assert!(off && refined.is_near() && (refined.response - 50.0).abs() < 1e-2, "{refined:?}");
        assert_eq!(suppressed_by(layers.each_ref(), (2, 2)), None);
        assert_eq!(suppressed_by(layers.each_ref(), (3, 2)), Some((1, (2, 2))));
    }

    #[test]
    fn a_sample_is_suppressed_where_a_neighbour_suppresses_it() {
        // Few values, so that many are equal.
        let of = |k: usize| Layer {
            filter: Filter::of(0, k),
            step: 1,
            responses: Grid::from_fn(40, 30, |x, y| ((x * 7 + y * 11 + x * y * (k + 3) + k * k * 5) % 23) as f32),
        };
        let layers = [of(0), of(1), of(2)];
        let mut kept = 0;
        for place in (1..29).flat_map(|j| (1..39).map(move |i| (i, j))) {
            let by = suppressed_by(layers.each_ref(), place);
            assert_eq!(is_suppressed(layers.each_ref(), place), by.is_some(), "{place:?}");
            kept += usize::from(by.is_none());
        }
        assert!(kept > 0);
    }
}
