//! Templates and their mismatch with windows of the next frame, with sub-pixel accuracy (J.-Y. Bouguet, 2000).

#[cfg(target_arch = "x86_64")]
mod x86;

use std::ops::Range;

use crate::base::wide::wide;
use crate::geometry::{Gray, Grid, pyramid::halvings};
use crate::methods::differential::Tensor;

/// Pixels per vector.
const LANES: usize = 8;
type Lanes = [f32; LANES];
/// A row of the largest window with 1 px of margin on either side, padded to whole vectors.
type Row = [Lanes; 5];

/// A pyramid level with a replicated border as wide as the window radius.
pub struct Level {
    size: (usize, usize),
    /// The last column and row of level 0, in px of this level.
    last: [f32; 2],
    margin: usize,
    pixels: Gray,
}

impl Level {
    /// Returns the pyramid of `picture`, level 0 first, for windows of radius `reach` px: `count` levels, or as many as leave at
    /// least 16 px per side.
    pub fn pyramid(picture: &Gray, count: usize, reach: usize) -> Vec<Self> {
        let (width, height) = picture.size();
        let level = |(n, level): (usize, &Gray)| {
            let last = [width, height].map(|side| (side - 1) as f32 / (1u32 << n) as f32);
            Self { last, ..Self::new(level, reach) }
        };
        halvings(picture, count).iter().enumerate().map(level).collect()
    }

    /// Returns `picture` as a level for windows of radius `reach` px.
    pub fn new(picture: &Gray, reach: usize) -> Self {
        let (width, height) = picture.size();
        // One px for differences, one for interpolation, and the overhang of the last vector.
        let (margin, beyond) = (reach + 2, reach + 2 + LANES);
        let mut pixels = Grid::new(width + margin + beyond, height + 2 * margin, 0);
        for y in 0..pixels.height() {
            let source = picture.row(y.saturating_sub(margin).min(height - 1));
            let row = pixels.row_mut(y);
            row[..margin].fill(source[0]);
            row[margin..margin + width].copy_from_slice(source);
            row[margin + width..].fill(source[width - 1]);
        }
        Self { size: (width, height), last: [width, height].map(|side| (side - 1) as f32), margin, pixels }
    }

    /// Returns width and height in px.
    pub fn size(&self) -> (usize, usize) {
        self.size
    }

    /// Returns the size in memory, in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.pixels.cells())
    }

    /// Whether a position lies in the frame.
    pub fn holds(&self, at: [f32; 2]) -> bool {
        at.iter().zip(self.last).all(|(c, last)| (0.0..=last).contains(c))
    }

    /// Returns the columns and rows of a window of radius `reach` around a position that lie in the frame.
    fn within(&self, at: [f32; 2], reach: usize) -> [Range<usize>; 2] {
        let side = 2 * reach + 1;
        let span = |c: f32, extent: usize| {
            let before = reach as f32 - c;
            let start = before.ceil().clamp(0.0, side as f32) as usize;
            start..((extent as f32 + before).floor().clamp(0.0, side as f32) as usize).max(start)
        };
        [span(at[0], self.size.0), span(at[1], self.size.1)]
    }

    /// Returns the interpolated gray value at a position, within the margin.
    pub fn sample(&self, [x, y]: [f32; 2]) -> f32 {
        self.pixels.sample(x + self.margin as f32, y + self.margin as f32)
    }

    /// Returns the gray value and its gradient by central differences at a position at least 1 px inside the frame.
    pub fn slope(&self, [x, y]: [f32; 2]) -> (f32, [f32; 2]) {
        let ([i, j], [fx, fy]) = self.corner([x, y], 1);
        let mix = |a: f32, b: f32, share: f32| a + (b - a) * share;
        // The four rows around the position, each interpolated horizontally.
        let rows: [&[u8]; 4] = [0, 1, 2, 3].map(|k| &self.pixels.row(j + k)[i..i + 4]);
        let between = |k: usize, c: usize| mix(f32::from(rows[k][c]), f32::from(rows[k][c + 1]), fx);
        let [above, top, bottom, below] = [0, 1, 2, 3].map(|k| between(k, 1));
        let beside = |c: usize| mix(between(1, c), between(2, c), fy);
        let down = mix(bottom, below, fy) - mix(above, top, fy);
        (mix(top, bottom, fy), [(beside(2) - beside(0)) / 2.0, down / 2.0])
    }

    /// Whether a position lies at least 1 px inside the frame.
    pub fn holds_around(&self, at: [f32; 2]) -> bool {
        at.iter().zip(self.last).all(|(c, last)| (1.0..=last - 1.0).contains(c))
    }

    /// Returns the first pixel of a window of radius `reach` around a position, and the fractional offset.
    #[inline(always)]
    fn corner(&self, at: [f32; 2], reach: usize) -> ([usize; 2], [f32; 2]) {
        let whole = at.map(|c| c as usize);
        ([0, 1].map(|i| whole[i] + self.margin - reach), [0, 1].map(|i| at[i] - whole[i] as f32))
    }

    /// Interpolates row `y` of the padded image from `x`, `fraction` px to the right.
    #[inline(always)]
    fn between(&self, [x, y]: [usize; 2], fraction: f32, values: &mut [Lanes]) {
        let row = &self.pixels.row(y)[x..x + LANES * values.len() + 1];
        let (left, right) = (row.as_chunks::<LANES>().0, row[1..].as_chunks::<LANES>().0);
        for (value, (left, right)) in values.iter_mut().zip(left.iter().zip(right)) {
            for i in 0..LANES {
                let [left, right] = [left[i], right[i]].map(f32::from);
                value[i] = left + (right - left) * fraction;
            }
        }
    }
}

/// A vector of neighbouring pixels of a window, masked beyond its last column.
struct Strip {
    values: Lanes,
    /// Their gradients along x and y; 0 where masked.
    across: Lanes,
    down: Lanes,
    /// The mask: 1 for pixels of the frame with neighbours on all sides, else 0.
    counts: Lanes,
}

impl Strip {
    /// Returns the pixels from column `first` of the middle of three rows, which begin 1 px before the window.
    #[inline(always)]
    fn new([top, middle, bottom]: [&Row; 3], first: usize, counts: Lanes) -> Self {
        let from = |row: &Row, x: usize| -> Lanes { std::array::from_fn(|i| row.as_flattened()[first + x + i]) };
        let differ = |after: Lanes, before: Lanes| -> Lanes {
            std::array::from_fn(|i| 0.5 * counts[i] * (after[i] - before[i]))
        };
        let across = differ(from(middle, 2), from(middle, 0));
        let down = differ(from(bottom, 1), from(top, 1));
        Self { values: from(middle, 1), across, down, counts }
    }

    /// Returns δI: the difference from the pixels `fraction` px below the row `above`.
    #[inline(always)]
    fn off(&self, [above, below]: [&Lanes; 2], fraction: f32) -> Lanes {
        std::array::from_fn(|i| self.values[i] - (above[i] + (below[i] - above[i]) * fraction))
    }
}

/// A window of frame t with its gradients.
pub struct Template {
    reach: usize,
    /// The strips, row by row, `strips_in_row` in each.
    strips: Vec<Strip>,
    strips_in_row: usize,
    /// The structure tensor; its temporal part is 0.
    pub tensor: Tensor,
}

/// The mismatch of a template at a position in frame t + 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mismatch {
    /// The structure tensor of the part of the window inside frame t + 1.
    pub tensor: Tensor,
    /// b: the means of δI I_x and δI I_y over that part, where δI = frame t − frame t + 1.
    pub vector: [f32; 2],
    /// The mean absolute difference |δI|, in gray levels.
    pub residual: f32,
}

impl Template {
    /// Returns the window of radius `reach` px around a position of `level`. Pixels outside the frame and on its border, without
    /// gradient, are masked.
    pub fn new(level: &Level, at: [f32; 2], reach: usize) -> Self {
        wide! {
            fn wide(level: &Level, at: [f32; 2], reach: usize) -> Template = Template::new_body
        }
        wide(level, at, reach)
    }

    #[inline(always)]
    fn new_body(level: &Level, at: [f32; 2], reach: usize) -> Self {
        let side = 2 * reach + 1;
        let strips_in_row = side.div_ceil(LANES);
        let ([x, y], [fx, fy]) = level.corner(at, reach + 1);
        // Three interpolated rows of the window with 1 px of margin.
        let wide = (side + 2).div_ceil(LANES);
        let mut rows: [Row; 3] = Default::default();
        let [mut above, mut below, mut columns]: [Row; 3] = Default::default();
        for (i, column) in columns.as_flattened_mut()[..side].iter_mut().enumerate() {
            *column = inside(at[0] + i as f32 - reach as f32, level.size.0);
        }
        let mut strips = Vec::with_capacity(side * strips_in_row);
        level.between([x, y], fx, &mut above[..wide]);
        for j in 0..side + 2 {
            level.between([x, y + j + 1], fx, &mut below[..wide]);
            for (value, (a, b)) in rows[j % 3][..wide].iter_mut().zip(above.iter().zip(&below)) {
                *value = std::array::from_fn(|i| a[i] + (b[i] - a[i]) * fy);
            }
            std::mem::swap(&mut above, &mut below);
            let Some(row) = j.checked_sub(2) else { continue };
            let of_row = inside(at[1] + row as f32 - reach as f32, level.size.1);
            let around = [j - 2, j - 1, j].map(|j| &rows[j % 3]);
            let columns = columns[..strips_in_row].iter().enumerate();
            strips.extend(columns.map(|(k, columns)| Strip::new(around, k * LANES, columns.map(|c| of_row * c))));
        }
        let mut sums = Sums::default();
        strips.iter().for_each(|strip| sums.add(strip, strip.counts));
        Self { reach, tensor: sums.tensor(), strips, strips_in_row }
    }

    /// Returns the mismatch at a position inside `next`.
    pub fn mismatch(&self, next: &Level, at: [f32; 2]) -> Mismatch {
        #[cfg(target_arch = "x86_64")]
        if let Some(mismatch) = x86::mismatch(self, next, at) {
            return mismatch;
        }
        self.plain_mismatch(next, at)
    }

    /// The portable version.
    fn plain_mismatch(&self, next: &Level, at: [f32; 2]) -> Mismatch {
        wide! {
            fn wide(of: &Template, next: &Level, at: [f32; 2]) -> Mismatch = Template::mismatch_body
        }
        wide(self, next, at)
    }

    #[inline(always)]
    fn mismatch_body(&self, next: &Level, at: [f32; 2]) -> Mismatch {
        let side = 2 * self.reach + 1;
        let [columns, rows] = next.within(at, self.reach);
        if columns.len() < side || rows.len() < side {
            return self.partial_mismatch(next, at, [columns, rows]);
        }
        let mut differences = Differences::default();
        self.lay(next, at, rows, |strip, off, _| differences.add(strip, off, strip.counts));
        differences.mismatch(self.tensor)
    }

    /// The mismatch where only some `columns` and `rows` of the window lie in `next`.
    #[inline(always)]
    fn partial_mismatch(&self, next: &Level, at: [f32; 2], [columns, rows]: [Range<usize>; 2]) -> Mismatch {
        let mut is_in = Row::default();
        is_in.as_flattened_mut()[columns].fill(1.0);
        let (mut sums, mut differences) = (Sums::default(), Differences::default());
        self.lay(next, at, rows, |strip, off, k| {
            let counts = std::array::from_fn(|i| is_in[k][i] * strip.counts[i]);
            sums.add(strip, counts);
            differences.add(strip, off, counts);
        });
        differences.mismatch(sums.tensor())
    }

    /// Calls `tell` with each strip of `rows` of the window, its δI at a position in `next`, and its index in the row.
    #[inline(always)]
    fn lay(&self, next: &Level, at: [f32; 2], rows: Range<usize>, mut tell: impl FnMut(&Strip, Lanes, usize)) {
        let ([x, y], [fx, fy]) = next.corner(at, self.reach);
        let [mut above, mut below]: [Row; 2] = Default::default();
        next.between([x, y + rows.start], fx, &mut above[..self.strips_in_row]);
        for j in rows {
            next.between([x, y + j + 1], fx, &mut below[..self.strips_in_row]);
            let strips = self.strips[j * self.strips_in_row..][..self.strips_in_row].iter();
            for (k, (strip, (a, b))) in strips.zip(above.iter().zip(&below)).enumerate() {
                tell(strip, strip.off([a, b], fy), k);
            }
            std::mem::swap(&mut above, &mut below);
        }
    }
}

/// The sums of I_x², I_x I_y, I_y² and the number of pixels.
#[derive(Default)]
struct Sums([Lanes; 4]);

impl Sums {
    /// Adds the pixels of a strip under the mask `counts`.
    #[inline(always)]
    fn add(&mut self, Strip { across, down, .. }: &Strip, counts: Lanes) {
        let Self([xx, xy, yy, pixels]) = self;
        for i in 0..LANES {
            let [gx, gy] = [across[i], down[i]].map(|gradient| gradient * counts[i]);
            xx[i] += gx * gx;
            xy[i] += gx * gy;
            yy[i] += gy * gy;
            pixels[i] += counts[i];
        }
    }

    /// Returns the means.
    fn tensor(&self) -> Tensor {
        let [xx, xy, yy, pixels] = self.0.map(|sums| sums.iter().sum::<f32>());
        let mean = |sum: f32| sum / pixels.max(1.0);
        Tensor { xx: mean(xx), xy: mean(xy), yy: mean(yy), pixels, ..Tensor::default() }
    }
}

/// The sums of δI I_x, δI I_y and |δI|.
#[derive(Default)]
struct Differences([Lanes; 3]);

impl Differences {
    /// Adds the pixels of a strip under the mask `counts`.
    #[inline(always)]
    fn add(&mut self, strip: &Strip, off: Lanes, counts: Lanes) {
        let Self([across, down, size]) = self;
        for i in 0..LANES {
            let off = off[i] * counts[i];
            across[i] += off * strip.across[i];
            down[i] += off * strip.down[i];
            size[i] += off.abs();
        }
    }

    /// Returns the means over the pixels of a tensor.
    fn mismatch(&self, tensor: Tensor) -> Mismatch {
        let [x, y, residual] = self.0.map(|sums| sums.iter().sum::<f32>() / tensor.pixels.max(1.0));
        Mismatch { tensor, vector: [x, y], residual }
    }
}

impl Mismatch {
    /// Returns the increment η = T⁻¹ b.
    pub fn update(&self) -> [f32; 2] {
        let [x, y] = self.vector;
        Tensor { xt: -x, yt: -y, ..self.tensor }.solution()
    }
}

/// 1 if a coordinate lies at least 1 px inside an image of this extent, else 0.
#[inline(always)]
fn inside(c: f32, extent: usize) -> f32 {
    if (1.0..=extent as f32 - 2.0).contains(&c) { 1.0 } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture() -> Gray {
        Grid::from_fn(40, 30, |x, y| ((x * 37 + y * 101 + x * y * 13) % 251) as u8)
    }

    /// The value between pixels, the edge repeated.
    fn sample(picture: &Gray, x: f64, y: f64) -> f64 {
        let pixel = |x: f64, y: f64| f64::from(picture.at(x as isize, y as isize, crate::geometry::Border::Replicate));
        let (x0, y0) = (x.floor(), y.floor());
        let line = |y| pixel(x0, y) * (1.0 - (x - x0)) + pixel(x0 + 1.0, y) * (x - x0);
        line(y0) * (1.0 - (y - y0)) + line(y0 + 1.0) * (y - y0)
    }

    #[test]
    fn tensor_and_mismatch_are_the_plain_sums() {
        let picture = picture();
        for (reach, at, to) in [
            (1, [12.0, 9.0], [13.4, 8.2]),
            (10, [20.25, 14.5], [18.0, 15.9]),
            (15, [2.5, 27.0], [0.0, 29.0]),
            (3, [39.0, 0.0], [38.1, 0.7]),
        ] {
            let level = Level::new(&picture, reach);
            let template = Template::new(&level, at, reach);
            let (mut sums, mut count) = ([0.0; 6], 0.0);
            let span = -(reach as i32)..=reach as i32;
            for (i, j) in span.clone().flat_map(|j| span.clone().map(move |i| (f64::from(i), f64::from(j)))) {
                let [x, y] = [f64::from(at[0]) + i, f64::from(at[1]) + j];
                let there = [f64::from(to[0]) + i, f64::from(to[1]) + j];
                let is_in = (0.0..=39.0).contains(&there[0]) && (0.0..=29.0).contains(&there[1]);
                if !(1.0..=38.0).contains(&x) || !(1.0..=28.0).contains(&y) || !is_in {
                    continue;
                }
                let value = |x, y| sample(&picture, x, y);
                let a = (value(x + 1.0, y) - value(x - 1.0, y)) / 2.0;
                let b = (value(x, y + 1.0) - value(x, y - 1.0)) / 2.0;
                let off = value(x, y) - value(there[0], there[1]);
                let products = [a * a, a * b, b * b, off * a, off * b, off.abs()];
                sums.iter_mut().zip(products).for_each(|(sum, product)| *sum += product);
                count += 1.0;
            }
            let Mismatch { vector: [x, y], residual, tensor } = template.mismatch(&level, to);
            let Tensor { xx, xy, yy, pixels, .. } = tensor;
            assert_eq!(f64::from(pixels), count);
            for (found, sum) in [xx, xy, yy, x, y, residual].into_iter().zip(sums) {
                let plain = sum / count;
                assert!((f64::from(found) - plain).abs() < 2e-3 * (1.0 + plain.abs()), "{found}, plainly {plain}");
            }
        }
    }

    #[test]
    fn wide_registers_give_the_same_bits() {
        let picture = picture();
        for reach in [1, 3, 7, 10, 15] {
            let level = Level::new(&picture, reach);
            for k in 0..400u16 {
                let place = |step: f32| {
                    let [x, y] = [f32::from(k) * step, f32::from(k) * (step + 0.37)];
                    [x % 39.0, y % 29.0]
                };
                let (template, to) = (Template::new(&level, place(1.25), reach), place(2.13));
                let bits =
                    |Mismatch { tensor: Tensor { xx, xy, yy, pixels, .. }, vector: [x, y], residual }: Mismatch| {
                        [xx, xy, yy, pixels, x, y, residual].map(f32::to_bits)
                    };
                let [found, plain] = [template.mismatch(&level, to), template.plain_mismatch(&level, to)].map(bits);
                assert_eq!(found, plain, "{k}, reach {reach}");
            }
        }
    }

    #[test]
    fn a_slope_is_that_of_the_values_between_pixels() {
        let level = Level::new(&picture(), 3);
        for at in [[12.0, 9.0], [20.25, 14.5], [1.0, 1.0], [37.9, 27.75]] {
            assert!(level.holds_around(at));
            let (value, [across, down]) = level.slope(at);
            let sample = |i: f32, j: f32| level.sample([at[0] + i, at[1] + j]);
            let plain = [
                sample(0.0, 0.0),
                (sample(1.0, 0.0) - sample(-1.0, 0.0)) / 2.0,
                (sample(0.0, 1.0) - sample(0.0, -1.0)) / 2.0,
            ];
            for (found, plain) in [value, across, down].into_iter().zip(plain) {
                assert!((found - plain).abs() < 1e-3, "{found}, plainly {plain} at {at:?}");
            }
        }
        assert!(
            !level.holds_around([0.9, 5.0]) && !level.holds_around([5.0, 28.1]) && !level.holds_around([f32::NAN, 5.0])
        );
    }

    #[test]
    fn the_margin_repeats_the_edge_and_a_px_is_a_picture() {
        let level = Level::new(&Grid::new(1, 1, 7), 15);
        let template = Template::new(&level, [0.0, 0.0], 15);
        assert_eq!((template.tensor.pixels, template.tensor.eigenvalues()), (0.0, [0.0, 0.0]));
        assert_eq!(template.mismatch(&level, [0.0, 0.0]).residual, 0.0);
        assert!(level.holds([0.0, 0.0]) && !level.holds([0.1, 0.0]) && !level.holds([f32::NAN, 0.0]));
    }
}
