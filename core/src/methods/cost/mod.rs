//! Matching costs: sums of absolute or squared differences, for one candidate or a whole search window.
//!
//! The kernels of a whole search window give exactly the results of [`until`] for each candidate, as a test checks.
//!
//! Full search reads frame t + 1 through a copy of the pixels that the search window reaches ([`Cut`]): the border rule is
//! applied once, and the kernels read plain rows. Other searches read candidates from the picture and copy only those that
//! cross its border. With AVX-512 the kernels compute eight candidates in x and four in y at once, with AVX2 two in y. They
//! compute whole windows, so early termination saves no time here; its saving is reported in rows. Successive elimination
//! compares lower bounds from sums over parts of a block (`bounds.rs`) before it computes a cost.

pub mod bounds;
pub mod products;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
mod wasm;
pub mod whole;
pub mod windows;
#[cfg(target_arch = "x86_64")]
mod x86;

use crate::geometry::{Border, Gray};

/// The term summed over the pixels of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sum {
    /// Absolute differences.
    Absolute,
    /// Squared differences.
    Squared,
}

impl Sum {
    /// The term of one pixel.
    #[inline(always)]
    pub fn term(self, a: u8, b: u8) -> u32 {
        let difference = u32::from(a.abs_diff(b));
        match self {
            Sum::Absolute => difference,
            Sum::Squared => difference * difference,
        }
    }
}

/// A rectangle of pixels copied out of a picture, with the border rule applied, so that kernels read plain rows.
#[derive(Clone, Debug, Default)]
pub struct Cut {
    width: usize,
    height: usize,
    stride: usize,
    pixels: Vec<u8>,
}

/// Rows past the end of a cut that a kernel may read and ignore: 15 of its last tile, 2 of its second lane.
const SLACK_ROWS: usize = 17;
/// Bytes past those rows that it may read and ignore.
const SLACK_BYTES: usize = 16;

impl Cut {
    /// Copies `width × height` pixels of `picture` from `(x, y)` on.
    pub fn take(&mut self, picture: &Gray, (x, y): (isize, isize), (width, height): (usize, usize), border: Border) {
        self.width = width;
        self.height = height;
        self.stride = width.next_multiple_of(16);
        self.pixels.resize((height + SLACK_ROWS) * self.stride + SLACK_BYTES, 0);
        let targets = self.pixels.chunks_exact_mut(self.stride).take(height);
        let inside = |start: isize, length: usize, extent: usize| start >= 0 && start as usize + length <= extent;
        if inside(x, width, picture.width()) && inside(y, height, picture.height()) {
            let start = y as usize * picture.width() + x as usize;
            for (target, source) in targets.zip(picture.cells()[start..].chunks(picture.width())) {
                copy(&source[..width], target);
            }
            return;
        }
        for (row, target) in targets.enumerate() {
            let source = picture.row(border.index(y + row as isize, picture.height()));
            for (column, pixel) in target[..width].iter_mut().enumerate() {
                *pixel = source[border.index(x + column as isize, source.len())];
            }
        }
    }

    /// Row `y` from column `x` on.
    #[inline(always)]
    fn row(&self, x: usize, y: usize) -> &[u8] {
        &self.pixels[y * self.stride + x..]
    }

    /// All pixels from the first on, and the distance from one row to the next.
    pub fn rows(&self) -> (&[u8], usize) {
        (&self.pixels, self.stride)
    }

    /// The pixel at `(x, y)` of the cut.
    pub fn pixel(&self, x: usize, y: usize) -> u8 {
        self.pixels[y * self.stride + x]
    }
}

/// Copies a row. Rows are short: a call into the C library would cost more than the copy.
#[inline(always)]
fn copy(source: &[u8], target: &mut [u8]) {
    let (chunks, rest) = source.as_chunks::<16>();
    let (targets, target_rest) = target.as_chunks_mut::<16>();
    for (target, source) in targets.iter_mut().zip(chunks) {
        *target = *source;
    }
    if let Some(target) = targets.get_mut(chunks.len()) {
        target[..rest.len()].copy_from_slice(rest);
    } else {
        target_rest[..rest.len()].copy_from_slice(rest);
    }
}

/// The cost of `block` at position `(i, j)` of `area`, row by row, up to the first row at which it
/// exceeds `limit` (partial distortion elimination). Returns the partial sum and its number of rows.
pub fn until(sum: Sum, block: &Cut, area: &Cut, (i, j): (usize, usize), limit: u32) -> (u32, usize) {
    let mut total = 0;
    for y in 0..block.height {
        total += match sum {
            Sum::Absolute => {
                row_sum(&block.row(0, y)[..block.width], area.row(i, j + y), |a, b| Sum::Absolute.term(a, b))
            }
            Sum::Squared => {
                row_sum(&block.row(0, y)[..block.width], area.row(i, j + y), |a, b| Sum::Squared.term(a, b))
            }
        };
        if total > limit {
            return (total, y + 1);
        }
    }
    (total, block.height)
}

/// The sum over a row, 16 pixels at a time, which compilers turn into vector instructions.
#[inline(always)]
fn row_sum(block: &[u8], area: &[u8], term: impl Fn(u8, u8) -> u32) -> u32 {
    let area = &area[..block.len()];
    let ((a, a_rest), (b, b_rest)) = (block.as_chunks::<16>(), area.as_chunks::<16>());
    let mut total = 0;
    for (a, b) in a.iter().zip(b) {
        for k in 0..16 {
            total += term(a[k], b[k]);
        }
    }
    total + a_rest.iter().zip(b_rest).map(|(&a, &b)| term(a, b)).sum::<u32>()
}

/// The cost of `block` against the candidate whose first pixel is the first of `pixels`, in rows of `stride` pixels.
#[inline]
pub fn candidate(sum: Sum, block: &Cut, pixels: &[u8], stride: usize) -> u32 {
    #[cfg(target_arch = "x86_64")]
    return match sum {
        Sum::Absolute => x86::candidate::<false>(block, pixels, stride),
        Sum::Squared => x86::candidate::<true>(block, pixels, stride),
    };
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
    if sum == Sum::Absolute {
        return wasm::candidate(block, pixels, stride);
    }
    #[cfg(not(target_arch = "x86_64"))]
    plain_candidate(sum, block, pixels, stride)
}

/// Pixel by pixel: the way on other processors.
#[cfg(any(test, not(target_arch = "x86_64")))]
fn plain_candidate(sum: Sum, block: &Cut, pixels: &[u8], stride: usize) -> u32 {
    let rows = (0..block.height).zip(pixels.chunks(stride));
    rows.map(|(y, row)| row_sum(&block.row(0, y)[..block.width], row, |a, b| sum.term(a, b))).sum()
}

/// The sums of absolute differences of `block` at all `columns × rows` places of `area`, row by row, into `costs`.
pub fn window(block: &Cut, area: &Cut, (columns, rows): (usize, usize), costs: &mut Vec<u32>) {
    assert!(area.width + 1 >= block.width + columns && area.height + 1 >= block.height + rows);
    costs.clear();
    costs.resize(columns * rows, 0);
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512bw") && is_x86_feature_detected!("avx512vl") {
            // SAFETY: the processor has the features that the function was compiled for.
            return unsafe { x86::avx512(block, area, columns, costs) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: as above.
            return unsafe { x86::avx2(block, area, columns, costs) };
        }
    }
    plain(Sum::Absolute, block, area, columns, costs);
}

/// Candidate by candidate: the way on other processors.
fn plain(sum: Sum, block: &Cut, area: &Cut, columns: usize, costs: &mut [u32]) {
    for (j, costs) in costs.chunks_exact_mut(columns).enumerate() {
        for (i, cost) in costs.iter_mut().enumerate() {
            *cost = candidate(sum, block, area.row(i, j), area.stride);
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::windows::Windows;
    use super::*;
    use crate::geometry::Grid;

    /// Reference implementation.
    fn textbook_at(sum: Sum, block: &Cut, area: &Cut, (i, j): (usize, usize)) -> u32 {
        let mut cost = 0;
        for (x, y) in (0..block.height).flat_map(|y| (0..block.width).map(move |x| (x, y))) {
            let difference = i64::from(block.pixel(x, y)) - i64::from(area.pixel(i + x, j + y));
            cost += if sum == Sum::Absolute { difference.abs() } else { difference * difference };
        }
        cost as u32
    }

    fn textbook(sum: Sum, block: &Cut, area: &Cut, (columns, rows): (usize, usize)) -> Vec<u32> {
        let places = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
        places.map(|place| textbook_at(sum, block, area, place)).collect()
    }

    #[test]
    fn a_candidate_in_the_last_corner_is_read_to_its_last_pixel_and_no_further() {
        let picture = Grid::from_fn(40, 40, |x, y| (x * 7 + y * 31) as u8);
        for side in [1, 3, 4, 7, 8, 12, 16, 31, 40] {
            let mut block = Cut::default();
            block.take(&picture, (0, 0), (side, side), Border::Replicate);
            let (first, mut area) = ((40 - side) * 41, Cut::default());
            area.take(&picture, (40 - side as isize, 40 - side as isize), (side, side), Border::Replicate);
            for sum in [Sum::Absolute, Sum::Squared] {
                let cost = candidate(sum, &block, &picture.cells()[first..], 40);
                assert_eq!(cost, textbook_at(sum, &block, &area, (0, 0)));
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]
        #[test]
        fn kernels_agree_with_the_textbook_loops(
            width in 1usize..70, height in 1usize..70, columns in 1usize..40, rows in 1usize..40, seed in any::<u32>(),
        ) {
            let noise = |x: usize, y: usize| {
                let h = (x as u32).wrapping_mul(0x9E37_79B9) ^ (y as u32).wrapping_mul(0x85EB_CA6B) ^ seed;
                (h.wrapping_mul(0xC2B2_AE35) >> 24) as u8
            };
            let picture = Grid::from_fn(120, 120, noise);
            let (mut block, mut area) = (Cut::default(), Cut::default());
            // A larger cut first: its leftovers in the buffer must not count.
            area.take(&picture, (0, 0), (120, 120), Border::Mirror);
            block.take(&picture, (3, 5), (width, height), Border::Replicate);
            area.take(&picture, (-7, 20), (width + columns - 1, height + rows - 1), Border::Replicate);
            for sum in [Sum::Absolute, Sum::Squared] {
                let mut costs = Vec::new();
                match sum {
                    Sum::Absolute => window(&block, &area, (columns, rows), &mut costs),
                    Sum::Squared => Windows::default().squared_differences(&block, &area, (columns, rows), &mut costs),
                }
                let expected = textbook(sum, &block, &area, (columns, rows));
                prop_assert_eq!(&costs, &expected);
                plain(sum, &block, &area, columns, &mut costs);
                prop_assert_eq!(&costs, &expected);
                #[cfg(target_arch = "x86_64")]
                if sum == Sum::Absolute && is_x86_feature_detected!("avx2") {
                    costs.fill(0);
                    // SAFETY: the processor has AVX2.
                    unsafe { x86::avx2(&block, &area, columns, &mut costs) }
                    prop_assert_eq!(&costs, &expected);
                }
                for (k, &cost) in expected.iter().enumerate() {
                    let place = (k % columns, k / columns);
                    prop_assert_eq!(until(sum, &block, &area, place, u32::MAX), (cost, height));
                    prop_assert_eq!(candidate(sum, &block, area.row(place.0, place.1), area.stride), cost);
                    prop_assert_eq!(plain_candidate(sum, &block, area.row(place.0, place.1), area.stride), cost);
                    let by_row = |rows: usize| {
                        let mut part = Cut::default();
                        part.take(&picture, (3, 5), (width, rows), Border::Replicate);
                        textbook_at(sum, &part, &area, place)
                    };
                    let (partial, rows) = until(sum, &block, &area, place, cost / 2);
                    prop_assert_eq!(partial, by_row(rows));
                    // It stops at the first row that exceeds the limit, and only there.
                    prop_assert!(rows == height || partial > cost / 2);
                    prop_assert!(rows == 1 || by_row(rows - 1) <= cost / 2);
                }
            }
        }
    }
}
