//! The cross-correlation of a block with all places of a search window: Σ a·b, two pixels of eight or sixteen candidates at once.
//!
//! A register holds candidates that stand beside each other, and for each of them two pixels of a row: `pmaddwd` multiplies them
//! with the two pixels of the block and adds the products. Two candidates that stand below each other share each row.

use super::Cut;
use crate::base::wide::wide;

/// Candidates below each other that share the rows that are read.
const BELOW: usize = 2;
/// Candidates of the widest register.
const WIDEST: usize = 16;

/// Pixels in pairs, widened to 16 bits: the products of all places of a search window follow from a block and an area.
#[derive(Debug, Default)]
pub struct Products {
    /// Rows of the block between two rows of zeros, two pixels in each number.
    block: Vec<u32>,
    /// Rows of the area: at each column its pixel and the next one.
    area: Vec<u32>,
    /// Σ a·b by place, in rows of [`stride`](Self::stride).
    sums: Vec<u32>,
    /// Distance between rows of places.
    stride: usize,
}

/// The pixels `[a, b]` in one number.
#[inline(always)]
fn pair(a: u8, b: u8) -> u32 {
    u32::from(a) | u32::from(b) << 16
}

impl Products {
    /// Computes the sums for `columns × rows` places of `area`.
    pub fn compute(&mut self, block: &Cut, area: &Cut, (columns, rows): (usize, usize)) {
        assert!(area.width + 1 >= block.width + columns && area.height + 1 >= block.height + rows);
        self.stride = columns.next_multiple_of(WIDEST);
        self.sums.clear();
        self.sums.resize(self.stride * rows.next_multiple_of(BELOW), 0);
        let size = (block.width.div_ceil(2), block.height);
        self.take_block(block, size.0);
        let reach = (self.stride + 2 * size.0, rows.next_multiple_of(BELOW) + block.height);
        self.area.clear();
        self.area.resize(reach.0 * reach.1, 0);
        // Pixels beyond the area affect no requested place.
        for (y, pairs) in self.area.chunks_exact_mut(reach.0).enumerate().take(area.height) {
            take_row(&area.row(0, y)[..area.width + 1], pairs);
        }
        let places = Places { size, reach: reach.0, columns, stride: self.stride };
        correlate(&places, &self.block, &self.area, &mut self.sums);
    }

    /// Σ a·b at the places of row `j`.
    pub fn row(&self, j: usize) -> &[u32] {
        &self.sums[j * self.stride..][..self.stride]
    }

    fn take_block(&mut self, block: &Cut, pairs: usize) {
        self.block.clear();
        self.block.resize(pairs, 0);
        for y in 0..block.height {
            let row = block.row(0, y)[..block.width].chunks(2);
            self.block.extend(row.map(|row| pair(row[0], row.get(1).copied().unwrap_or(0))));
        }
        self.block.resize(self.block.len() + pairs, 0);
    }
}

wide!(fn take_row(row: &[u8], pairs: &mut [u32]) = take_row_of);

/// Pairs each pixel of a row with the next one.
#[inline(always)]
fn take_row_of(row: &[u8], pairs: &mut [u32]) {
    for ((two, &a), &b) in pairs.iter_mut().zip(row).zip(&row[1..]) {
        *two = pair(a, b);
    }
}

/// The sizes of all that a kernel reads.
struct Places {
    /// Pairs of a row of the block, and its rows.
    size: (usize, usize),
    /// Pairs of a row of the area.
    reach: usize,
    /// Places of a row, and those with room for whole registers.
    columns: usize,
    stride: usize,
}

fn correlate(places: &Places, block: &[u32], area: &[u32], sums: &mut [u32]) {
    #[cfg(target_arch = "x86_64")]
    {
        if is_x86_feature_detected!("avx512bw") {
            // SAFETY: the processor has the feature.
            return unsafe { x86::with_avx512(places, block, area, sums) };
        }
        if is_x86_feature_detected!("avx2") {
            // SAFETY: as above.
            return unsafe { x86::with_avx2(places, block, area, sums) };
        }
    }
    plain(places, block, area, sums);
}

/// Place by place: the way on other processors.
fn plain(places: &Places, block: &[u32], area: &[u32], sums: &mut [u32]) {
    let Places { size: (pairs, height), reach, columns, stride } = *places;
    let rows = sums.len() / stride;
    for (j, i) in (0..rows).flat_map(|j| (0..columns).map(move |i| (j, i))) {
        let row = |y: usize| &area[(j + y) * reach + i..][..2 * pairs];
        let of_block = |y: usize| &block[(y + 1) * pairs..][..pairs];
        let product = |a: u32, b: u32| (a & 0xffff) * (b & 0xffff) + (a >> 16) * (b >> 16);
        let of_row = |y| of_block(y).iter().zip(row(y).iter().step_by(2)).map(|(&a, &b)| product(a, b)).sum::<u32>();
        sums[j * stride + i] = (0..height).map(of_row).sum();
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use super::{BELOW, Places};

    /// Registers beside each other at most.
    const BESIDE: usize = 5;

    /// A register of numbers of 32 bits, each for one candidate.
    trait Lanes: Copy {
        /// Candidates of a register.
        const COUNT: usize;
        /// # Safety
        /// The processor must have the instructions of the register.
        unsafe fn zero() -> Self;
        /// # Safety
        /// As for [`Lanes::zero`].
        unsafe fn splat(pair: u32) -> Self;
        /// # Safety
        /// As for [`Lanes::zero`], and `COUNT` numbers must be readable from `pairs` on.
        unsafe fn load(pairs: *const u32) -> Self;
        /// # Safety
        /// As for [`Lanes::zero`], and `COUNT` numbers must be writable from `sums` on.
        unsafe fn store(self, sums: *mut u32);
        /// Adds the products of the pairs `a` and `b`.
        ///
        /// # Safety
        /// As for [`Lanes::zero`].
        unsafe fn plus(self, a: Self, b: Self) -> Self;
    }

    impl Lanes for __m256i {
        const COUNT: usize = 8;
        #[inline(always)]
        unsafe fn zero() -> Self {
            // SAFETY: the caller vouches for AVX2, here and below, and for the bytes.
            unsafe { _mm256_setzero_si256() }
        }
        #[inline(always)]
        unsafe fn splat(pair: u32) -> Self {
            // SAFETY: as above.
            unsafe { _mm256_set1_epi32(pair as i32) }
        }
        #[inline(always)]
        unsafe fn load(pairs: *const u32) -> Self {
            // SAFETY: as above.
            unsafe { _mm256_loadu_si256(pairs.cast()) }
        }
        #[inline(always)]
        unsafe fn store(self, sums: *mut u32) {
            // SAFETY: as above.
            unsafe { _mm256_storeu_si256(sums.cast(), self) }
        }
        #[inline(always)]
        unsafe fn plus(self, a: Self, b: Self) -> Self {
            // SAFETY: as above.
            unsafe { _mm256_add_epi32(self, _mm256_madd_epi16(a, b)) }
        }
    }

    impl Lanes for __m512i {
        const COUNT: usize = 16;
        #[inline(always)]
        unsafe fn zero() -> Self {
            // SAFETY: the caller vouches for AVX-512, here and below, and for the bytes.
            unsafe { _mm512_setzero_si512() }
        }
        #[inline(always)]
        unsafe fn splat(pair: u32) -> Self {
            // SAFETY: as above.
            unsafe { _mm512_set1_epi32(pair as i32) }
        }
        #[inline(always)]
        unsafe fn load(pairs: *const u32) -> Self {
            // SAFETY: as above.
            unsafe { _mm512_loadu_si512(pairs.cast()) }
        }
        #[inline(always)]
        unsafe fn store(self, sums: *mut u32) {
            // SAFETY: as above.
            unsafe { _mm512_storeu_si512(sums.cast(), self) }
        }
        #[inline(always)]
        unsafe fn plus(self, a: Self, b: Self) -> Self {
            // SAFETY: as above.
            unsafe { _mm512_add_epi32(self, _mm512_madd_epi16(a, b)) }
        }
    }

    #[target_feature(enable = "avx2")]
    pub fn with_avx2(places: &Places, block: &[u32], area: &[u32], sums: &mut [u32]) {
        // SAFETY: this function is only compiled for processors with AVX2.
        unsafe { correlate::<__m256i>(places, block, area, sums) }
    }

    #[target_feature(enable = "avx512f,avx512bw")]
    pub fn with_avx512(places: &Places, block: &[u32], area: &[u32], sums: &mut [u32]) {
        // SAFETY: this function is only compiled for processors with AVX-512.
        unsafe { correlate::<__m512i>(places, block, area, sums) }
    }

    /// # Safety
    /// The processor must have what `V` needs.
    #[inline(always)]
    unsafe fn correlate<V: Lanes>(places: &Places, block: &[u32], area: &[u32], sums: &mut [u32]) {
        let Places { size: (pairs, height), reach, columns, stride } = *places;
        let rows = sums.len() / stride;
        assert!(columns.next_multiple_of(V::COUNT) <= stride && reach >= stride + 2 * pairs);
        assert!(rows.is_multiple_of(BELOW) && block.len() >= (height + 2) * pairs);
        assert!(area.len() >= (rows + height) * reach && sums.len() >= rows * stride);
        for j in (0..rows).step_by(BELOW) {
            let (mut i, mut left) = (0, columns.div_ceil(V::COUNT));
            while left > 0 {
                let beside = left.min(BESIDE);
                // SAFETY: the asserts have seen that all rows and columns lie inside.
                unsafe {
                    let (area, sums) = (area.as_ptr().add(j * reach + i), sums.as_mut_ptr().add(j * stride + i));
                    match beside {
                        1 => strip::<V, 1>(places, block.as_ptr(), area, sums),
                        2 => strip::<V, 2>(places, block.as_ptr(), area, sums),
                        3 => strip::<V, 3>(places, block.as_ptr(), area, sums),
                        4 => strip::<V, 4>(places, block.as_ptr(), area, sums),
                        _ => strip::<V, BESIDE>(places, block.as_ptr(), area, sums),
                    }
                }
                (i, left) = (i + beside * V::COUNT, left - beside);
            }
        }
    }

    /// The sums of `N` registers of candidates beside each other, in two rows of places.
    ///
    /// # Safety
    /// The processor must have the instructions of `V`. `(height + 2) · pairs` numbers must be readable from `block` on, and in each of
    /// `height + 1` rows of `area`, `reach` numbers apart, `2 · pairs + N · COUNT`; in two rows of `sums`, `stride` apart, `N · COUNT`
    /// must be writable.
    #[inline(always)]
    unsafe fn strip<V: Lanes, const N: usize>(places: &Places, block: *const u32, area: *const u32, sums: *mut u32) {
        let Places { size: (pairs, height), reach, stride, .. } = *places;
        // SAFETY: the caller vouches for the bytes and for the processor.
        unsafe {
            let mut totals = [[V::zero(); N]; BELOW];
            for y in 0..=height {
                let (row, below) = (block.add((y + 1) * pairs), block.add(y * pairs));
                for k in 0..pairs {
                    // The row of zeros before the block meets the first row, the one after it the last.
                    let of_block = [V::splat(*row.add(k)), V::splat(*below.add(k))];
                    for n in 0..N {
                        let of_area = V::load(area.add(y * reach + 2 * k + n * V::COUNT));
                        for (totals, of_block) in totals.iter_mut().zip(of_block) {
                            totals[n] = totals[n].plus(of_block, of_area);
                        }
                    }
                }
            }
            for (below, totals) in totals.into_iter().enumerate() {
                for (n, total) in totals.into_iter().enumerate() {
                    total.store(sums.add(below * stride + n * V::COUNT));
                }
            }
        }
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
        fn kernels_agree_with_the_sum_of_products(
            (width, height) in (1usize..=64, 1usize..=64), (columns, rows) in (1usize..100, 1usize..20), seed in any::<u32>(),
        ) {
            let noise = |x: usize, y: usize| {
                let h = (x as u32).wrapping_mul(0x9E37_79B9) ^ (y as u32).wrapping_mul(0x85EB_CA6B) ^ seed;
                (h.wrapping_mul(0xC2B2_AE35) >> 24) as u8
            };
            let picture = Grid::from_fn(170, 120, noise);
            let (mut block, mut area) = (Cut::default(), Cut::default());
            block.take(&picture, (3, 5), (width, height), Border::Replicate);
            area.take(&picture, (-7, 20), (width + columns - 1, height + rows - 1), Border::Replicate);
            let mut products = Products::default();
            products.compute(&block, &area, (columns, rows));
            let expected = |i: usize, j: usize| -> u32 {
                let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
                places.map(|(x, y)| u32::from(block.pixel(x, y)) * u32::from(area.pixel(i + x, j + y))).sum()
            };
            for j in 0..rows {
                let row: Vec<u32> = (0..columns).map(|i| expected(i, j)).collect();
                prop_assert_eq!(&products.row(j)[..columns], &row);
            }
            let size = (width.div_ceil(2), height);
            let reach = products.stride + 2 * size.0;
            let places = Places { size, reach, columns, stride: products.stride };
            let mut sums = products.sums.clone();
            plain(&places, &products.block, &products.area, &mut sums);
            for j in 0..rows {
                prop_assert_eq!(&products.row(j)[..columns], &sums[j * products.stride..][..columns]);
            }
        }
    }
}
