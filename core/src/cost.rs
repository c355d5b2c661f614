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

/// The cost of `block` against the place `(i, j)` of `area`, row by row, given up after the first row at which it
/// exceeds `limit`. Gives the sum so far and the number of rows in it.
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

/// The costs of `block` at all `columns × rows` places of `area`, row by row, into `costs`.
pub fn window(sum: Sum, block: &Cut, area: &Cut, (columns, rows): (usize, usize), costs: &mut Vec<u32>) {
    assert!(area.width + 1 >= block.width + columns && area.height + 1 >= block.height + rows);
    costs.clear();
    costs.resize(columns * rows, 0);
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512bw") && is_x86_feature_detected!("avx512vl") {
            // SAFETY: the processor has the features that the functions were compiled for.
            return unsafe {
                match sum {
                    Sum::Absolute => x86::avx512::<false>(block, area, columns, costs),
                    Sum::Squared => x86::avx512::<true>(block, area, columns, costs),
                }
            };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: as above.
            return unsafe {
                match sum {
                    Sum::Absolute => x86::avx2::<false>(block, area, columns, costs),
                    Sum::Squared => x86::avx2::<true>(block, area, columns, costs),
                }
            };
        }
    }
    plain(sum, block, area, columns, costs);
}

/// Candidate by candidate: the way on other processors.
fn plain(sum: Sum, block: &Cut, area: &Cut, columns: usize, costs: &mut [u32]) {
    for (j, costs) in costs.chunks_exact_mut(columns).enumerate() {
        for (i, cost) in costs.iter_mut().enumerate() {
            *cost = until(sum, block, area, (i, j), u32::MAX).0;
        }
    }
}

/// Kernels for x86-64.
///
/// Two candidates, one below the other, share the rows that are read: of the two lanes of 16 pixels the second
/// stands one row lower. Row `r` of the area, broadcast to both lanes, meets row `r` of the block in the first
/// and row `r − 1` in the second; what sticks out at the top and the bottom is put together in one.
#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use super::{Cut, SLACK_BYTES};

    /// Side of the tiles into which a block is cut.
    const TILE: usize = 16;

    /// The rows of one tile for both lanes, and masks of the pixels that count.
    struct Tile {
        x: usize,
        y: usize,
        pixels: [__m256i; TILE],
        masks: [__m256i; TILE],
        is_full: bool,
    }

    impl Tile {
        #[target_feature(enable = "avx2")]
        fn new(block: &Cut, x: usize, y: usize) -> Self {
            let (width, height) = (TILE.min(block.width - x), TILE.min(block.height - y));
            let (mut pixels, mut masks) = ([_mm256_setzero_si256(); TILE], [_mm256_setzero_si256(); TILE]);
            for r in 0..TILE {
                let (mut row, mut mask) = ([0u8; 2 * TILE], [0u8; 2 * TILE]);
                for (lane, of_block) in [r, (r + TILE - 1) % TILE].into_iter().enumerate() {
                    if of_block < height {
                        let lane = lane * TILE..lane * TILE + width;
                        row[lane.clone()].copy_from_slice(&block.row(x, y + of_block)[..width]);
                        mask[lane].fill(u8::MAX);
                    }
                }
                // SAFETY: 32 bytes are there to be read.
                unsafe {
                    pixels[r] = _mm256_loadu_si256(row.as_ptr().cast());
                    masks[r] = _mm256_loadu_si256(mask.as_ptr().cast());
                }
            }
            Self { x, y, pixels, masks, is_full: (width, height) == (TILE, TILE) }
        }
    }

    /// Sums of the differences of two times 16 pixels, spread over each lane.
    #[inline(always)]
    unsafe fn differences<const SQUARED: bool>(a: __m256i, b: __m256i) -> __m256i {
        // SAFETY: the caller vouches for AVX2.
        unsafe {
            if !SQUARED {
                return _mm256_sad_epu8(a, b);
            }
            let zero = _mm256_setzero_si256();
            let difference = _mm256_or_si256(_mm256_subs_epu8(a, b), _mm256_subs_epu8(b, a));
            let (low, high) = (_mm256_unpacklo_epi8(difference, zero), _mm256_unpackhi_epi8(difference, zero));
            _mm256_add_epi32(_mm256_madd_epi16(low, low), _mm256_madd_epi16(high, high))
        }
    }

    /// The sum of each lane, in the first and the fifth of eight numbers.
    #[inline(always)]
    unsafe fn lane_sums<const SQUARED: bool>(total: __m256i) -> __m256i {
        // SAFETY: the caller vouches for AVX2.
        unsafe {
            let halves = _mm256_add_epi32(total, _mm256_unpackhi_epi64(total, total));
            if SQUARED { _mm256_add_epi32(halves, _mm256_srli_epi64::<32>(halves)) } else { halves }
        }
    }

    /// Adds the part of `tile` to the sums of all candidates.
    #[inline(always)]
    unsafe fn add_tile<const SQUARED: bool, const FULL: bool>(
        tile: &Tile,
        area: &Cut,
        columns: usize,
        sums: &mut [u32],
    ) {
        let rows = sums.len() / columns;
        let lowest = (rows - 1) / 2 * 2 + tile.y + TILE;
        assert!(tile.x + columns <= area.stride && (lowest + 1) * area.stride + SLACK_BYTES <= area.pixels.len());
        for j in (0..rows).step_by(2) {
            for i in 0..columns {
                // SAFETY: the assertion above keeps 16 bytes from every place in every row inside the area; the
                // caller vouches for AVX2.
                unsafe {
                    let start = area.pixels.as_ptr().add((j + tile.y) * area.stride + tile.x + i);
                    let row = |r: usize| _mm_loadu_si128(start.add(r * area.stride).cast());
                    let mut total = _mm256_setzero_si256();
                    for r in 0..TILE {
                        let both = if r == 0 {
                            _mm256_set_m128i(row(TILE), row(0))
                        } else {
                            _mm256_broadcastsi128_si256(row(r))
                        };
                        let both = if FULL { both } else { _mm256_and_si256(tile.masks[r], both) };
                        total = _mm256_add_epi32(total, differences::<SQUARED>(both, tile.pixels[r]));
                    }
                    let halves = lane_sums::<SQUARED>(total);
                    sums[j * columns + i] += _mm256_extract_epi32::<0>(halves) as u32;
                    if let Some(below) = sums.get_mut((j + 1) * columns + i) {
                        *below += _mm256_extract_epi32::<4>(halves) as u32;
                    }
                }
            }
        }
    }

    #[inline(always)]
    unsafe fn all_tiles<const SQUARED: bool>(block: &Cut, area: &Cut, columns: usize, sums: &mut [u32]) {
        for y in (0..block.height).step_by(TILE) {
            for x in (0..block.width).step_by(TILE) {
                // SAFETY: the caller vouches for AVX2.
                unsafe {
                    let tile = Tile::new(block, x, y);
                    if tile.is_full {
                        add_tile::<SQUARED, true>(&tile, area, columns, sums);
                    } else {
                        add_tile::<SQUARED, false>(&tile, area, columns, sums);
                    }
                }
            }
        }
    }

    /// With the 32 registers of AVX-512 the whole tile stays in registers.
    #[target_feature(enable = "avx512f,avx512bw,avx512vl,avx2")]
    pub fn avx512<const SQUARED: bool>(block: &Cut, area: &Cut, columns: usize, sums: &mut [u32]) {
        // SAFETY: this function is only compiled for processors with AVX2.
        unsafe { all_tiles::<SQUARED>(block, area, columns, sums) }
    }

    #[target_feature(enable = "avx2")]
    pub fn avx2<const SQUARED: bool>(block: &Cut, area: &Cut, columns: usize, sums: &mut [u32]) {
        // SAFETY: as above.
        unsafe { all_tiles::<SQUARED>(block, area, columns, sums) }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::Grid;

    /// As simple as possible.
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
            // A larger cut first: what is left of it in the buffer must not count.
            area.take(&picture, (0, 0), (120, 120), Border::Mirror);
            block.take(&picture, (3, 5), (width, height), Border::Replicate);
            area.take(&picture, (-7, 20), (width + columns - 1, height + rows - 1), Border::Replicate);
            for sum in [Sum::Absolute, Sum::Squared] {
                let mut costs = Vec::new();
                window(sum, &block, &area, (columns, rows), &mut costs);
                let expected = textbook(sum, &block, &area, (columns, rows));
                prop_assert_eq!(&costs, &expected);
                plain(sum, &block, &area, columns, &mut costs);
                prop_assert_eq!(&costs, &expected);
                #[cfg(target_arch = "x86_64")]
                if is_x86_feature_detected!("avx2") {
                    costs.fill(0);
                    // SAFETY: the processor has AVX2.
                    unsafe {
                        match sum {
                            Sum::Absolute => x86::avx2::<false>(&block, &area, columns, &mut costs),
                            Sum::Squared => x86::avx2::<true>(&block, &area, columns, &mut costs),
                        }
                    }
                    prop_assert_eq!(&costs, &expected);
                }
                for (k, &cost) in expected.iter().enumerate() {
                    let place = (k % columns, k / columns);
                    prop_assert_eq!(until(sum, &block, &area, place, u32::MAX), (cost, height));
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
