//! How unlike two blocks are: sums of absolute or squared differences, for one candidate or a whole window.
//!
//! The kernels of a whole window give exactly what [`until`] gives candidate by candidate; a test holds them to it.

use crate::{Border, Gray};

/// What is summed over the pixels of a block.
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

/// Rows past the end of a cut that a kernel may read and ignore: 15 of its last tile, 3 of its last lanes.
const SLACK_ROWS: usize = 18;
/// Bytes past those rows that it may read and ignore.
const SLACK_BYTES: usize = 16;

impl Cut {
    /// Copies `width × height` pixels of `picture` from `(x, y)` on.
    pub fn take(&mut self, picture: &Gray, (x, y): (isize, isize), (width, height): (usize, usize), border: Border) {
        self.width = width;
        self.height = height;
        self.stride = width.next_multiple_of(16);
        self.pixels.resize((height + SLACK_ROWS) * self.stride + SLACK_BYTES, 0);
        let columns_inside = x >= 0 && x as usize + width <= picture.width();
        for (row, target) in self.pixels.chunks_exact_mut(self.stride).take(height).enumerate() {
            let source = picture.row(border.index(y + row as isize, picture.height()));
            if columns_inside {
                target[..width].copy_from_slice(&source[x as usize..x as usize + width]);
            } else {
                for (column, pixel) in target[..width].iter_mut().enumerate() {
                    *pixel = source[border.index(x + column as isize, source.len())];
                }
            }
        }
    }

    /// Row `y` from column `x` on.
    #[inline(always)]
    fn row(&self, x: usize, y: usize) -> &[u8] {
        &self.pixels[y * self.stride + x..]
    }

    /// The pixel at `(x, y)` of the cut.
    pub fn pixel(&self, x: usize, y: usize) -> u8 {
        self.pixels[y * self.stride + x]
    }
}

/// The cost of `block` against the place `(i, j)` of `area`, row by row, given up after the first row at which it
/// exceeds `limit`. Gives the sum so far and the number of rows in it.
pub fn until(sum: Sum, block: &Cut, area: &Cut, (i, j): (usize, usize), limit: u32) -> (u32, usize) {
    let mut total = 0;
    for y in 0..block.height {
        let rows = block.row(0, y)[..block.width].iter().zip(area.row(i, j + y));
        total += rows.map(|(&a, &b)| sum.term(a, b)).sum::<u32>();
        if total > limit {
            return (total, y + 1);
        }
    }
    (total, block.height)
}

/// The costs of `block` at all `columns × rows` places of `area`, row by row, into `costs`.
pub fn window(sum: Sum, block: &Cut, area: &Cut, (columns, rows): (usize, usize), costs: &mut Vec<u32>) {
    debug_assert!(area.width + 1 >= block.width + columns && area.height + 1 >= block.height + rows);
    costs.clear();
    costs.resize(columns * rows, 0);
    #[cfg(target_arch = "x86_64")]
    {
        if sum == Sum::Absolute && is_x86_feature_detected!("avx512bw") {
            // SAFETY: the processor has the features that the function was compiled for.
            return unsafe { x86::sad_avx512(block, area, columns, costs) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: as above.
            return unsafe {
                match sum {
                    Sum::Absolute => x86::sad_avx2(block, area, columns, costs),
                    Sum::Squared => x86::ssd_avx2(block, area, columns, costs),
                }
            };
        }
    }
    plain(sum, block, area, columns, costs);
}

/// The textbook loops; the oracle of the tests and the way on other processors.
#[inline(always)]
fn plain(sum: Sum, block: &Cut, area: &Cut, columns: usize, costs: &mut [u32]) {
    for (j, costs) in costs.chunks_exact_mut(columns).enumerate() {
        for (i, cost) in costs.iter_mut().enumerate() {
            *cost = (0..block.height)
                .map(|y| {
                    let pixels = block.row(0, y)[..block.width].iter().zip(&area.row(i, j + y)[..block.width]);
                    pixels.map(|(&a, &b)| sum.term(a, b)).sum::<u32>()
                })
                .sum();
        }
    }
}

/// Kernels for x86-64.
///
/// Several candidates below one another share each row that is read: with lanes `l` of 16 pixels, lane `l` holds
/// the block's row `r − l`, so row `r` of the area, broadcast to all lanes, meets the right row in each.
#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use super::{Cut, SLACK_BYTES, Sum, plain};

    /// Side of the tiles into which a block is cut.
    const TILE: usize = 16;

    /// A 16-pixel row of the block, or zeros outside it, and a mask of the pixels that count.
    fn tile_row(block: &Cut, x: usize, y0: usize, r: isize) -> ([u8; TILE], u16) {
        let mut row = [0; TILE];
        let height = TILE.min(block.height - y0) as isize;
        if !(0..height).contains(&r) {
            return (row, 0);
        }
        let width = TILE.min(block.width - x);
        row[..width].copy_from_slice(&block.row(x, y0 + r as usize)[..width]);
        (row, ((1u32 << width) - 1) as u16)
    }

    /// Every tile of the block, by its first column and row.
    fn tiles(block: &Cut) -> impl Iterator<Item = (usize, usize)> {
        let (width, height) = (block.width, block.height);
        (0..height).step_by(TILE).flat_map(move |y| (0..width).step_by(TILE).map(move |x| (x, y)))
    }

    #[target_feature(enable = "avx512f,avx512bw")]
    pub fn sad_avx512(block: &Cut, area: &Cut, columns: usize, costs: &mut [u32]) {
        const LANES: usize = 4;
        const ROWS: usize = TILE + LANES - 1;
        let rows = costs.len() / columns;
        for (x, y) in tiles(block) {
            let mut lanes = [_mm512_setzero_si512(); ROWS];
            let mut masks = [0u64; ROWS];
            for r in 0..ROWS {
                let mut bytes = [0u8; 64];
                for l in 0..LANES {
                    let (row, mask) = tile_row(block, x, y, r as isize - l as isize);
                    bytes[l * TILE..][..TILE].copy_from_slice(&row);
                    masks[r] |= u64::from(mask) << (l * TILE);
                }
                // SAFETY: 64 bytes are there to be read.
                lanes[r] = unsafe { _mm512_loadu_si512(bytes.as_ptr().cast()) };
            }
            let full = (LANES - 1..TILE).all(|r| masks[r] == u64::MAX);
            let last = (rows - 1) / LANES * LANES + y + ROWS - 1;
            assert!(x + columns <= area.stride && (last + 1) * area.stride + SLACK_BYTES <= area.pixels.len());
            for j in (0..rows).step_by(LANES) {
                let lanes_used = LANES.min(rows - j);
                for i in 0..columns {
                    let mut total = _mm512_setzero_si512();
                    for r in 0..ROWS {
                        // SAFETY: the assertion above keeps 16 bytes from every place in every row inside the area.
                        let pixels = unsafe {
                            let start = area.pixels.as_ptr().add((j + y + r) * area.stride + x + i);
                            _mm512_broadcast_i32x4(_mm_loadu_si128(start.cast()))
                        };
                        let pixels = if full && (LANES - 1..TILE).contains(&r) {
                            pixels
                        } else {
                            _mm512_maskz_mov_epi8(masks[r], pixels)
                        };
                        total = _mm512_add_epi64(total, _mm512_sad_epu8(pixels, lanes[r]));
                    }
                    let pairs = _mm512_add_epi64(total, _mm512_unpackhi_epi64(total, total));
                    let mut sums = [0u64; 8];
                    // SAFETY: 64 bytes are there to be written.
                    unsafe { _mm512_storeu_si512(sums.as_mut_ptr().cast(), pairs) };
                    for l in 0..lanes_used {
                        costs[(j + l) * columns + i] += sums[2 * l] as u32;
                    }
                }
            }
        }
    }

    #[target_feature(enable = "avx2")]
    pub fn sad_avx2(block: &Cut, area: &Cut, columns: usize, costs: &mut [u32]) {
        const LANES: usize = 2;
        const ROWS: usize = TILE + LANES - 1;
        let rows = costs.len() / columns;
        for (x, y) in tiles(block) {
            let mut lanes = [_mm256_setzero_si256(); ROWS];
            let mut masks = [_mm256_setzero_si256(); ROWS];
            let mut full = true;
            for r in 0..ROWS {
                let (mut bytes, mut mask) = ([0u8; 32], [0u8; 32]);
                for l in 0..LANES {
                    let (row, bits) = tile_row(block, x, y, r as isize - l as isize);
                    bytes[l * TILE..][..TILE].copy_from_slice(&row);
                    for (k, m) in mask[l * TILE..][..TILE].iter_mut().enumerate() {
                        *m = if bits >> k & 1 == 1 { u8::MAX } else { 0 };
                    }
                }
                full &= !(LANES - 1..TILE).contains(&r) || mask == [u8::MAX; 32];
                // SAFETY: 32 bytes are there to be read.
                unsafe {
                    lanes[r] = _mm256_loadu_si256(bytes.as_ptr().cast());
                    masks[r] = _mm256_loadu_si256(mask.as_ptr().cast());
                }
            }
            let last = (rows - 1) / LANES * LANES + y + ROWS - 1;
            assert!(x + columns <= area.stride && (last + 1) * area.stride + SLACK_BYTES <= area.pixels.len());
            for j in (0..rows).step_by(LANES) {
                let lanes_used = LANES.min(rows - j);
                for i in 0..columns {
                    let mut total = _mm256_setzero_si256();
                    for r in 0..ROWS {
                        // SAFETY: the assertion above keeps 16 bytes from every place in every row inside the area.
                        let pixels = unsafe {
                            let start = area.pixels.as_ptr().add((j + y + r) * area.stride + x + i);
                            _mm256_broadcastsi128_si256(_mm_loadu_si128(start.cast()))
                        };
                        let pixels = if full && (LANES - 1..TILE).contains(&r) {
                            pixels
                        } else {
                            _mm256_and_si256(masks[r], pixels)
                        };
                        total = _mm256_add_epi64(total, _mm256_sad_epu8(pixels, lanes[r]));
                    }
                    let pairs = _mm256_add_epi64(total, _mm256_unpackhi_epi64(total, total));
                    let mut sums = [0u64; 4];
                    // SAFETY: 32 bytes are there to be written.
                    unsafe { _mm256_storeu_si256(sums.as_mut_ptr().cast(), pairs) };
                    for l in 0..lanes_used {
                        costs[(j + l) * columns + i] += sums[2 * l] as u32;
                    }
                }
            }
        }
    }

    #[target_feature(enable = "avx2")]
    pub fn ssd_avx2(block: &Cut, area: &Cut, columns: usize, costs: &mut [u32]) {
        plain(Sum::Squared, block, area, columns, costs);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::Grid;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]
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
            // A larger cut first: what is left of it in the buffer must not count.
            area.take(&picture, (0, 0), (120, 120), Border::Mirror);
            block.take(&picture, (3, 5), (width, height), Border::Replicate);
            area.take(&picture, (-7, 20), (width + columns - 1, height + rows - 1), Border::Replicate);
            for sum in [Sum::Absolute, Sum::Squared] {
                let mut costs = Vec::new();
                window(sum, &block, &area, (columns, rows), &mut costs);
                let mut expected = vec![0; columns * rows];
                plain(sum, &block, &area, columns, &mut expected);
                prop_assert_eq!(&costs, &expected);
                #[cfg(target_arch = "x86_64")]
                if sum == Sum::Absolute && is_x86_feature_detected!("avx2") {
                    let mut costs = vec![0; columns * rows];
                    // SAFETY: the processor has AVX2.
                    unsafe { x86::sad_avx2(&block, &area, columns, &mut costs) };
                    prop_assert_eq!(&costs, &expected);
                }
                for (k, &cost) in expected.iter().enumerate() {
                    let place = (k % columns, k / columns);
                    prop_assert_eq!(until(sum, &block, &area, place, u32::MAX), (cost, height));
                    let (partial, rows) = until(sum, &block, &area, place, cost / 2);
                    prop_assert!(rows <= height && partial > cost / 2 || cost == 0);
                }
            }
        }
    }
}
