//! The costs of a whole search window, for all costs but the sum of absolute differences.
//!
//! Sums over the candidate alone are computed for all places at once: its gray levels and their squares in boxes that slide, its
//! Hadamard transform for every place of the area. All sums are whole numbers, equal to those of [`whole`](super::whole) and
//! [`until`](super::until), as a test checks. None of them can overflow; they wrap, so that no build checks it number by number.

use super::products::Products;
use super::{Cut, whole};
use crate::base::wide::wide;

/// Side of a tile of the Hadamard transform, and its coefficients.
const TILE: usize = 4;
const COEFFICIENTS: usize = TILE * TILE;
/// Candidates side by side that are computed at once.
const LANES: usize = 16;

/// Buffers reused from block to block.
#[derive(Debug, Default)]
pub struct Windows {
    products: Products,
    /// By place: Σ b and Σ b² of the candidates.
    sums: Vec<u32>,
    squares: Vec<u32>,
    /// Sums of columns.
    columns: Vec<u32>,
    transform: Transform,
    /// The pixels of the area, widened.
    area: Vec<i16>,
}

/// The places of a search window: columns and rows.
type Size = (usize, usize);

impl Windows {
    /// The sums of squared differences: Σ a² + Σ b² − 2 Σ a·b.
    pub fn squared_differences(&mut self, block: &Cut, area: &Cut, size: Size, costs: &mut Vec<u32>) {
        self.products.compute(block, area, size);
        let boxes = Boxes { block: (block.width, block.height), size };
        box_sums::<true>(&mut self.squares, area, boxes, &mut self.columns);
        let [_, own] = own_sums(block);
        costs.clear();
        for (j, squares) in self.squares.chunks_exact(size.0).enumerate() {
            let row = squares.iter().zip(self.products.row(j));
            costs.extend(
                row.map(|(&squares, products)| own.wrapping_add(squares).wrapping_sub(products.wrapping_mul(2))),
            );
        }
    }

    /// One minus the zero-mean normalised cross-correlation.
    pub fn correlation(&mut self, block: &Cut, area: &Cut, size: Size, costs: &mut Vec<f64>) {
        self.products.compute(block, area, size);
        let boxes = Boxes { block: (block.width, block.height), size };
        box_sums::<true>(&mut self.squares, area, boxes, &mut self.columns);
        box_sums::<false>(&mut self.sums, area, boxes, &mut self.columns);
        let own = own_sums(block);
        costs.clear();
        costs.resize(size.0 * size.1, 0.0);
        let sums = self.sums.chunks_exact(size.0).zip(self.squares.chunks_exact(size.0));
        for ((j, (sums, squares)), costs) in sums.enumerate().zip(costs.chunks_exact_mut(size.0)) {
            let row = Sums { own, count: block.width * block.height, sums, squares, products: self.products.row(j) };
            correlations(&row, costs);
        }
    }

    /// Half the sums of the absolute coefficients of 4×4 Hadamard transforms.
    pub fn hadamard(&mut self, block: &Cut, area: &Cut, size: Size, costs: &mut Vec<f64>) {
        self.transform.sum(block, area, size, &mut self.sums);
        costs.clear();
        costs.extend(self.sums.iter().map(|sum| f64::from(sum / 2)));
    }

    /// The sums of absolute differences from the means.
    pub fn zero_mean(&mut self, block: &Cut, area: &Cut, size: Size, costs: &mut Vec<f64>) {
        let of_block = (block.width, block.height);
        box_sums::<false>(&mut self.sums, area, Boxes { block: of_block, size }, &mut self.columns);
        let stride = size.0.next_multiple_of(LANES) + block.width;
        widen(&mut self.area, area, stride);
        let [own, _] = own_sums(block);
        costs.clear();
        costs.resize(size.0 * size.1, 0.0);
        let window = Levels { block, area: &self.area, stride, own };
        for ((j, costs), sums) in costs.chunks_exact_mut(size.0).enumerate().zip(self.sums.chunks_exact(size.0)) {
            off_means(&window, j, sums, costs);
        }
    }
}

/// Width and height of a candidate in px, and the places of a search window.
#[derive(Clone, Copy)]
pub struct Boxes {
    pub block: (usize, usize),
    pub size: Size,
}

/// Sums gray levels, or their squares, over all candidates, row by row.
pub fn box_sums<const SQUARED: bool>(sums: &mut Vec<u32>, area: &Cut, boxes: Boxes, columns: &mut Vec<u32>) {
    sums.clear();
    sums.resize(boxes.size.0 * boxes.size.1, 0);
    let mut sliding = Sliding::<SQUARED>::new(area, boxes, std::mem::take(columns));
    sums.chunks_exact_mut(boxes.size.0).for_each(|sums| sliding.add_row(sums));
    *columns = sliding.columns;
}

/// The gray levels, or their squares, of candidates summed row by row: the sums of columns move down a row at a time, and runs of
/// them are doubled.
pub struct Sliding<'a, const SQUARED: bool> {
    area: &'a Cut,
    boxes: Boxes,
    /// The next row of candidates.
    row: usize,
    /// Sums of columns, and room for runs of them twice.
    columns: Vec<u32>,
}

impl<'a, const SQUARED: bool> Sliding<'a, SQUARED> {
    /// Begins with the first row of candidates; `columns` is room to work in.
    pub fn new(area: &'a Cut, boxes: Boxes, mut columns: Vec<u32>) -> Self {
        let reach = boxes.size.0 + boxes.block.0 - 1;
        columns.clear();
        columns.resize(3 * reach, 0);
        let mut sliding = Self { area, boxes, row: 0, columns };
        (0..boxes.block.1 - 1).for_each(|y| sliding.add_pixels(y, 1));
        sliding
    }

    /// Adds those of the next row of candidates to `sums`.
    pub fn add_row(&mut self, sums: &mut [u32]) {
        let (width, height) = self.boxes.block;
        self.add_pixels(self.row + height - 1, 1);
        let reach = self.columns.len() / 3;
        let (columns, runs) = self.columns.split_at_mut(reach);
        runs[..reach].copy_from_slice(columns);
        add_runs(runs, width, sums);
        // Minus one: the row leaves the candidates.
        self.add_pixels(self.row, u32::MAX);
        self.row += 1;
    }

    /// Adds a row of pixels to the sums of columns, this many times.
    fn add_pixels(&mut self, y: usize, times: u32) {
        let reach = self.columns.len() / 3;
        let add = if SQUARED { add_squares } else { add_levels };
        add(&mut self.columns[..reach], self.area.row(0, y), times);
    }
}

wide!(fn add_levels(columns: &mut [u32], row: &[u8], times: u32) = add_row_of_pixels::<false>);
wide!(fn add_squares(columns: &mut [u32], row: &[u8], times: u32) = add_row_of_pixels::<true>);

#[inline(always)]
fn add_row_of_pixels<const SQUARED: bool>(columns: &mut [u32], row: &[u8], times: u32) {
    for (sum, &pixel) in columns.iter_mut().zip(row) {
        let pixel = u32::from(pixel);
        let term = if SQUARED { pixel.wrapping_mul(pixel) } else { pixel };
        *sum = sum.wrapping_add(term.wrapping_mul(times));
    }
}

wide!(fn add_runs(runs: &mut [u32], width: usize, sums: &mut [u32]) = add_runs_of);

/// Adds the sums of `width` numbers from each of the first half of `runs` on; overwrites `runs`.
#[inline(always)]
fn add_runs_of(runs: &mut [u32], width: usize, sums: &mut [u32]) {
    let (mut now, mut next) = runs.split_at_mut(runs.len() / 2);
    let (mut length, mut start) = (1, 0);
    loop {
        if width & length != 0 {
            sums.iter_mut().zip(&now[start..]).for_each(|(sum, run)| *sum = sum.wrapping_add(*run));
            start += length;
        }
        if start == width {
            return;
        }
        for ((double, &run), &after) in next.iter_mut().zip(&*now).zip(&now[length..]) {
            *double = run.wrapping_add(after);
        }
        std::mem::swap(&mut now, &mut next);
        length *= 2;
    }
}

/// Σ a and Σ a² of a block.
fn own_sums(block: &Cut) -> [u32; 2] {
    let pixels = (0..block.height).flat_map(|y| &block.row(0, y)[..block.width]).map(|&a| u32::from(a));
    pixels.fold([0, 0], |[sum, squares], a| [sum + a, squares + a * a])
}

/// The sums of which the correlations of a row of candidates consist.
struct Sums<'a> {
    /// Σ a and Σ a² of the block, and its pixels.
    own: [u32; 2],
    count: usize,
    /// By place: Σ b, Σ b² and Σ a·b.
    sums: &'a [u32],
    squares: &'a [u32],
    products: &'a [u32],
}

wide!(fn correlations(row: &Sums<'_>, costs: &mut [f64]) = correlations_of);

/// The correlations of a row of candidates, of moments that are whole numbers below 2⁵³: as exact here as in 64 bits.
#[inline(always)]
fn correlations_of(row: &Sums<'_>, costs: &mut [f64]) {
    let (count, [a, aa]) = (row.count as f64, row.own.map(f64::from));
    let of_block = count * aa - a * a;
    for (((cost, &sum), &squares), &products) in costs.iter_mut().zip(row.sums).zip(row.squares).zip(row.products) {
        // At most 64² · 255², which fits into 31 bits; from them a register of numbers is converted at once.
        let [b, bb, ab] = [sum, squares, products].map(|sum| f64::from(sum as i32));
        *cost = whole::correlation_of([of_block, count * bb - b * b, count * ab - a * b]);
    }
}

/// Copies the pixels of `area` into rows of `stride`; pixels beyond it affect no requested place.
fn widen(pixels: &mut Vec<i16>, area: &Cut, stride: usize) {
    pixels.clear();
    pixels.resize(stride * area.height, 0);
    for (y, pixels) in pixels.chunks_exact_mut(stride).enumerate() {
        pixels.iter_mut().zip(&area.row(0, y)[..area.width]).for_each(|(wide, &pixel)| *wide = pixel.into());
    }
}

/// A block and the widened area under its search window.
struct Levels<'a> {
    block: &'a Cut,
    area: &'a [i16],
    stride: usize,
    /// Σ a of the block.
    own: u32,
}

wide!(fn off_means(window: &Levels<'_>, j: usize, sums: &[u32], costs: &mut [f64]) = off_means_of);

/// The zero-mean SAD of the candidates of row `j`, whose gray levels have these `sums`.
///
/// With the difference of the means q + r / N, a difference d contributes |d − q| − r / N above q, and |d − q| + r / N elsewhere.
#[inline(always)]
fn off_means_of(window: &Levels<'_>, j: usize, sums: &[u32], costs: &mut [f64]) {
    let count = (window.block.width * window.block.height) as i32;
    for (first, (costs, sums)) in costs.chunks_mut(LANES).zip(sums.chunks(LANES)).enumerate() {
        let (mut quotients, mut rests) = ([0i16; LANES], [0i32; LANES]);
        for ((&sum, quotient), rest) in sums.iter().zip(&mut quotients).zip(&mut rests) {
            let difference = window.own as i32 - sum as i32;
            (*quotient, *rest) = (difference.div_euclid(count) as i16, difference.rem_euclid(count));
        }
        let (absolute, above) = around(window, (first * LANES, j), &quotients);
        for (lane, cost) in costs.iter_mut().enumerate() {
            let [absolute, above, rest, count] =
                [i64::from(absolute[lane]), i64::from(above[lane]), i64::from(rests[lane]), i64::from(count)];
            *cost = (count * absolute + rest * (count - 2 * above)) as f64 / count as f64;
        }
    }
}

/// Σ |d − q| and the number of differences above q, for candidates beside each other from `(i, j)` on, each with its own q.
#[inline(always)]
fn around(window: &Levels<'_>, (i, j): (usize, usize), quotients: &[i16; LANES]) -> ([u32; LANES], [u32; LANES]) {
    let (mut absolute, mut above) = ([0u32; LANES], [0u32; LANES]);
    for y in 0..window.block.height {
        let area = &window.area[(j + y) * window.stride + i..];
        // A row is at most 64 px, and a term at most 510.
        let (mut row, mut row_above) = ([0u16; LANES], [0u16; LANES]);
        for (x, &a) in window.block.row(0, y)[..window.block.width].iter().enumerate() {
            let Some(pixels) = area[x..].first_chunk::<LANES>() else { break };
            for lane in 0..LANES {
                let off = i16::from(a).wrapping_sub(pixels[lane]).wrapping_sub(quotients[lane]);
                row[lane] = row[lane].wrapping_add(off.unsigned_abs());
                row_above[lane] = row_above[lane].wrapping_add(u16::from(off > 0));
            }
        }
        for lane in 0..LANES {
            absolute[lane] = absolute[lane].wrapping_add(row[lane].into());
            above[lane] = above[lane].wrapping_add(row_above[lane].into());
        }
    }
    (absolute, above)
}

/// The Hadamard transforms of all tiles of an area, one at each place.
#[derive(Debug, Default)]
struct Transform {
    /// By row of the area, then coefficient, then column.
    coefficients: Vec<i16>,
    stride: usize,
}

impl Transform {
    /// Sums the absolute coefficients of the differences over the tiles of `block`, for all places of `area`.
    fn sum(&mut self, block: &Cut, area: &Cut, size: Size, sums: &mut Vec<u32>) {
        sums.clear();
        sums.resize(size.0 * size.1, 0);
        // A block that is cut at the border may have tiles of up to four sizes.
        let sides = |length: usize| {
            [(length / TILE, TILE, 0), (usize::from(!length.is_multiple_of(TILE)), length % TILE, length / TILE * TILE)]
        };
        for (down, height, y) in sides(block.height).into_iter().filter(|side| side.0 > 0) {
            for (across, width, x) in sides(block.width).into_iter().filter(|side| side.0 > 0) {
                let tiles = Tiles { first: (x, y), counts: (across, down), side: (width, height) };
                let rows = size.1 + y + (down - 1) * TILE;
                self.take(area, (width, height), rows);
                self.add(block, &tiles, size.0, sums);
            }
        }
    }

    /// Transforms the `width × height` px at each place of `rows` rows of `area`, the rest of a tile being zero.
    fn take(&mut self, area: &Cut, (width, height): (usize, usize), rows: usize) {
        // A row is read in whole registers.
        self.stride = area.width.next_multiple_of(LANES) + LANES;
        self.coefficients.resize(rows * COEFFICIENTS * self.stride, 0);
        let mut pixels = vec![0i16; (rows + TILE) * (self.stride + TILE)];
        for (row, pixels) in pixels.chunks_exact_mut(self.stride + TILE).enumerate().take(area.height) {
            pixels.iter_mut().zip(&area.row(0, row)[..area.width]).for_each(|(wide, &pixel)| *wide = pixel.into());
        }
        for (y, coefficients) in self.coefficients.chunks_exact_mut(COEFFICIENTS * self.stride).enumerate() {
            transform_row(&pixels[y * (self.stride + TILE)..], self.stride, (width, height), coefficients);
        }
    }

    /// Adds the absolute differences of the coefficients of `tiles` and of each candidate.
    fn add(&self, block: &Cut, tiles: &Tiles, columns: usize, sums: &mut [u32]) {
        let own: Vec<[i16; COEFFICIENTS]> = tiles.places().map(|place| of_tile(block, place, tiles.side)).collect();
        for (j, sums) in sums.chunks_exact_mut(columns).enumerate() {
            add_row(self, tiles, &own, j, sums);
        }
    }
}

/// Tiles of one size that cover a part of a block.
struct Tiles {
    /// The first pixel.
    first: (usize, usize),
    /// Tiles across and down.
    counts: (usize, usize),
    /// Width and height in px.
    side: (usize, usize),
}

impl Tiles {
    /// The first pixel of each tile, row by row.
    fn places(&self) -> impl Iterator<Item = (usize, usize)> {
        let (first, across, down) = (self.first, self.counts.0, self.counts.1);
        (0..down).flat_map(move |y| (0..across).map(move |x| (first.0 + TILE * x, first.1 + TILE * y)))
    }
}

fn of_tile(block: &Cut, (x, y): (usize, usize), (width, height): (usize, usize)) -> [i16; COEFFICIENTS] {
    let mut rows = [[0i16; TILE]; TILE];
    for (j, row) in rows.iter_mut().enumerate().take(height) {
        for (i, pixel) in row.iter_mut().enumerate().take(width) {
            *pixel = block.pixel(x + i, y + j).into();
        }
    }
    let along = rows.map(butterfly);
    let columns: [[i16; TILE]; TILE] = std::array::from_fn(|i| butterfly(along.map(|row| row[i])));
    std::array::from_fn(|k| columns[k / TILE][k % TILE])
}

/// Four numbers times the Hadamard matrix.
#[inline(always)]
fn butterfly([a, b, c, d]: [i16; TILE]) -> [i16; TILE] {
    let (add, subtract) = (i16::wrapping_add, i16::wrapping_sub);
    let (plus, minus) = ([add(a, c), add(b, d)], [subtract(a, c), subtract(b, d)]);
    [add(plus[0], plus[1]), add(minus[0], minus[1]), subtract(minus[0], minus[1]), subtract(plus[0], plus[1])]
}

wide!(fn transform_row(pixels: &[i16], stride: usize, side: (usize, usize), coefficients: &mut [i16]) = transform_row_of);

/// The transforms of the tiles that begin in the first of these rows of pixels, `stride` of them.
#[inline(always)]
fn transform_row_of(pixels: &[i16], stride: usize, side: (usize, usize), coefficients: &mut [i16]) {
    let reach = stride + TILE;
    for x in (0..stride).step_by(LANES) {
        let mut along = [[[0i16; LANES]; TILE]; TILE];
        for (y, along) in along.iter_mut().enumerate().take(side.1) {
            let at = |i: usize| {
                let lanes = pixels[y * reach + x + i..].first_chunk::<LANES>();
                lanes.filter(|_| i < side.0).copied().unwrap_or([0; LANES])
            };
            *along = butterfly_lanes([at(0), at(1), at(2), at(3)]);
        }
        for i in 0..TILE {
            let column = butterfly_lanes([along[0][i], along[1][i], along[2][i], along[3][i]]);
            for (k, lanes) in column.iter().enumerate() {
                coefficients[(TILE * i + k) * stride + x..][..LANES].copy_from_slice(lanes);
            }
        }
    }
}

/// [`butterfly`] of many places.
#[inline(always)]
fn butterfly_lanes([a, b, c, d]: [[i16; LANES]; TILE]) -> [[i16; LANES]; TILE] {
    let mut out = [[0; LANES]; TILE];
    for lane in 0..LANES {
        let numbers = butterfly([a[lane], b[lane], c[lane], d[lane]]);
        for (out, number) in out.iter_mut().zip(numbers) {
            out[lane] = number;
        }
    }
    out
}

wide!(fn add_row(transform: &Transform, tiles: &Tiles, own: &[[i16; COEFFICIENTS]], j: usize, sums: &mut [u32]) = add_row_of);

/// Adds the differences of the candidates of row `j`.
#[inline(always)]
fn add_row_of(transform: &Transform, tiles: &Tiles, own: &[[i16; COEFFICIENTS]], j: usize, sums: &mut [u32]) {
    let stride = transform.stride;
    for (first, sums) in sums.chunks_mut(LANES).enumerate() {
        let mut totals = [0u32; LANES];
        for (own, (x, y)) in own.iter().zip(tiles.places()) {
            let row = &transform.coefficients[(j + y) * COEFFICIENTS * stride + x + first * LANES..];
            // The coefficients of a tile sum to at most 16 · 4 · 255.
            let mut total = [0u16; LANES];
            for (k, &own) in own.iter().enumerate() {
                let Some(lanes) = row[k * stride..].first_chunk::<LANES>() else { continue };
                for (total, coefficient) in total.iter_mut().zip(lanes) {
                    *total = total.wrapping_add(own.wrapping_sub(*coefficient).unsigned_abs());
                }
            }
            totals.iter_mut().zip(total).for_each(|(totals, total)| *totals = totals.wrapping_add(total.into()));
        }
        sums.iter_mut().zip(totals).for_each(|(sum, total)| *sum = sum.wrapping_add(total));
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::{Border, Grid};

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]

        #[test]
        fn windows_agree_with_the_costs_of_each_candidate(
            (width, height) in (1usize..=64, 1usize..=64), (columns, rows) in (1usize..40, 1usize..40), seed in any::<u32>(),
            // Extreme pixels bring every sum to its bound.
            levels in prop::sample::select(vec![2u32, 256]),
        ) {
            let noise = |x: usize, y: usize| {
                let h = (x as u32).wrapping_mul(0x9E37_79B9) ^ (y as u32).wrapping_mul(0x85EB_CA6B) ^ seed;
                ((h.wrapping_mul(0xC2B2_AE35) >> 16) % levels * (255 / (levels - 1))) as u8
            };
            let picture = Grid::from_fn(120, 120, noise);
            let (mut block, mut area) = (Cut::default(), Cut::default());
            // A larger cut first: its leftovers in the buffer must not count.
            area.take(&picture, (0, 0), (120, 120), Border::Mirror);
            block.take(&picture, (3, 5), (width, height), Border::Replicate);
            area.take(&picture, (-7, 20), (width + columns - 1, height + rows - 1), Border::Replicate);
            let (mut windows, size, (pixels, stride)) = (Windows::default(), (columns, rows), area.rows());
            // A larger window first, for the same reason.
            let mut costs = Vec::new();
            windows.hadamard(&block, &area, (columns, 1), &mut costs);
            let places = || (0..rows).flat_map(|j| (0..columns).map(move |i| j * stride + i));
            let each = |cost: fn(&Cut, &[u8], usize) -> f64| -> Vec<f64> {
                places().map(|first| cost(&block, &pixels[first..], stride)).collect()
            };
            windows.hadamard(&block, &area, size, &mut costs);
            prop_assert_eq!(&costs, &each(whole::hadamard));
            windows.zero_mean(&block, &area, size, &mut costs);
            prop_assert_eq!(&costs, &each(whole::zero_mean));
            windows.correlation(&block, &area, size, &mut costs);
            prop_assert_eq!(&costs, &each(whole::correlation));
        }
    }

    #[test]
    fn the_largest_block_overflows_no_sum() {
        let (mut block, mut area) = (Cut::default(), Cut::default());
        block.take(&Grid::new(64, 64, 255), (0, 0), (64, 64), Border::Replicate);
        let checkers = Grid::from_fn(70, 70, |x, y| if (x / 4 + y / 4) % 2 == 0 { 0 } else { 255 });
        for picture in [Grid::new(70, 70, 0), Grid::new(70, 70, 255), checkers] {
            area.take(&picture, (0, 0), (66, 66), Border::Replicate);
            let (mut windows, mut sums, mut costs) = (Windows::default(), Vec::new(), Vec::new());
            windows.squared_differences(&block, &area, (3, 3), &mut sums);
            let squared = (0..9)
                .map(|k| super::super::until(super::super::Sum::Squared, &block, &area, (k % 3, k / 3), u32::MAX).0);
            assert!(squared.eq(sums));
            let (pixels, stride) = area.rows();
            windows.hadamard(&block, &area, (3, 3), &mut costs);
            assert!(
                (0..9)
                    .map(|k| whole::hadamard(&block, &pixels[k / 3 * stride + k % 3..], stride))
                    .eq(costs.iter().copied())
            );
            windows.zero_mean(&block, &area, (3, 3), &mut costs);
            assert!(
                (0..9)
                    .map(|k| whole::zero_mean(&block, &pixels[k / 3 * stride + k % 3..], stride))
                    .eq(costs.iter().copied())
            );
            windows.correlation(&block, &area, (3, 3), &mut costs);
            assert!(
                (0..9)
                    .map(|k| whole::correlation(&block, &pixels[k / 3 * stride + k % 3..], stride))
                    .eq(costs.iter().copied())
            );
        }
    }
}
