//! Kernels for x86-64.
//!
//! All of them let candidates that stand below each other share the rows that are read: of the lanes of a register,
//! 16 bytes each, every one stands a row lower than the one before. A row of the area, broadcast to all lanes, meets
//! another row of the block in each. What sticks out at the top of the lower lanes and at the bottom of the upper
//! ones is put together: in *slot* `s`, lane `k` holds row `(s − k) mod height` of the block.

use std::arch::x86_64::*;

use super::{Cut, Sum};

/// One candidate, whose first pixel is the first of `pixels`, in rows of `stride` pixels: 16 columns at a time, then 8,
/// then 4, then one.
#[inline]
pub fn candidate<const SQUARED: bool>(block: &Cut, pixels: &[u8], stride: usize) -> u32 {
    assert!(block.height > 0 && (block.height - 1) * stride + block.width <= pixels.len());
    assert!((block.height - 1) * block.stride + block.width <= block.pixels.len());
    if (block.width, block.stride) == (16, 16) && block.height.is_multiple_of(2) && is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2; the asserts have seen that the candidate and the block lie inside their pixels.
        return unsafe { row_pairs::<SQUARED>(block, pixels, stride) };
    }
    let whole = block.width - block.width % 16;
    let mut total = 0;
    for x in (0..whole).step_by(16) {
        // SAFETY: the asserts have seen that the candidate and the block lie inside their pixels; so do these columns.
        total += unsafe { strip::<SQUARED>(block, x, pixels, stride, |p| _mm_loadu_si128(p.cast())) };
    }
    let mut x = whole;
    if block.width - x >= 8 {
        // SAFETY: as above, with 8 columns.
        total += unsafe { strip::<SQUARED>(block, x, pixels, stride, |p| _mm_loadl_epi64(p.cast())) };
        x += 8;
    }
    if block.width - x >= 4 {
        // SAFETY: as above, with 4 columns.
        total += unsafe {
            strip::<SQUARED>(block, x, pixels, stride, |p| _mm_cvtsi32_si128(p.cast::<i32>().read_unaligned()))
        };
        x += 4;
    }
    let sum = if SQUARED { Sum::Squared } else { Sum::Absolute };
    for (x, y) in (x..block.width).flat_map(|x| (0..block.height).map(move |y| (x, y))) {
        total += sum.term(block.pixel(x, y), pixels[y * stride + x]);
    }
    total
}

/// A candidate of a block 16 px wide, two rows in one register.
///
/// # Safety
/// The block must have an even number of rows of 16 px and lie in its pixels without gaps, the candidate inside its own.
#[target_feature(enable = "avx2")]
unsafe fn row_pairs<const SQUARED: bool>(block: &Cut, pixels: &[u8], stride: usize) -> u32 {
    // SAFETY: the caller vouches for the bytes and, by calling, for AVX2.
    unsafe {
        let mut totals = [_mm256_setzero_si256(); 2];
        let (a, mut b) = (block.pixels.as_ptr().cast::<__m256i>(), pixels.as_ptr());
        for pair in 0..block.height / 2 {
            let rows = _mm256_loadu2_m128i(b.wrapping_add(stride).cast(), b.cast());
            let differences = differences::<SQUARED>(rows, _mm256_loadu_si256(a.add(pair)));
            totals[pair % 2] = _mm256_add_epi32(totals[pair % 2], differences);
            b = b.wrapping_add(2 * stride);
        }
        let halves = lane_sums::<SQUARED>(_mm256_add_epi32(totals[0], totals[1]));
        (_mm256_extract_epi32::<0>(halves) + _mm256_extract_epi32::<4>(halves)) as u32
    }
}

/// The columns from `x` on that `load` reads, the rest of its register being zero.
///
/// # Safety
/// The bytes that `load` reads at column `x` of any row of the block and of the candidate must lie inside their pixels.
#[inline(always)]
unsafe fn strip<const SQUARED: bool>(
    block: &Cut,
    x: usize,
    pixels: &[u8],
    stride: usize,
    load: impl Fn(*const u8) -> __m128i,
) -> u32 {
    // SAFETY: every x86-64 processor has SSE2; the caller vouches for the bytes.
    unsafe {
        let mut total = _mm_setzero_si128();
        let (mut a, mut b) = (block.pixels.as_ptr().wrapping_add(x), pixels.as_ptr().wrapping_add(x));
        for _ in 0..block.height {
            total = _mm_add_epi32(total, row_differences::<SQUARED>(load(a), load(b)));
            (a, b) = (a.wrapping_add(block.stride), b.wrapping_add(stride));
        }
        if SQUARED {
            total = _mm_add_epi32(total, _mm_srli_epi64::<32>(total));
        }
        (_mm_cvtsi128_si32(total) + _mm_cvtsi128_si32(_mm_unpackhi_epi64(total, total))) as u32
    }
}

/// Sums of the differences of 16 pixels, spread over the register.
#[inline]
#[target_feature(enable = "sse2")]
fn row_differences<const SQUARED: bool>(a: __m128i, b: __m128i) -> __m128i {
    if !SQUARED {
        return _mm_sad_epu8(a, b);
    }
    let zero = _mm_setzero_si128();
    let difference = _mm_or_si128(_mm_subs_epu8(a, b), _mm_subs_epu8(b, a));
    let (low, high) = (_mm_unpacklo_epi8(difference, zero), _mm_unpackhi_epi8(difference, zero));
    _mm_add_epi32(_mm_madd_epi16(low, low), _mm_madd_epi16(high, high))
}

/// Side of the tiles into which a block is cut.
const TILE: usize = 16;

/// Part of a block, at most 16×16 px.
#[derive(Clone, Copy)]
struct Tile {
    x: usize,
    y: usize,
    width: usize,
    height: usize,
}

/// The tiles of a block, row by row.
fn tiles(block: &Cut) -> impl Iterator<Item = Tile> {
    let (width, height) = (block.width, block.height);
    let corners = (0..height).step_by(TILE).flat_map(move |y| (0..width).step_by(TILE).map(move |x| (x, y)));
    corners.map(move |(x, y)| Tile { x, y, width: TILE.min(width - x), height: TILE.min(height - y) })
}

impl Tile {
    /// Panics unless the rows that `lanes` candidates below each other meet may be read for all places, and in each
    /// of them 16 bytes from `past` bytes after the last place on.
    fn check(&self, area: &Cut, (columns, rows): (usize, usize), lanes: usize, past: usize) {
        let lowest = self.y + rows.next_multiple_of(lanes) - 1 + TILE - 1;
        assert!(lowest * area.stride + self.x + columns - 1 + past + 16 <= area.pixels.len());
    }
}

/// With AVX-512, absolute differences are summed by `vdbpsadbw`: four pixels against eight places in a row, at once,
/// in each of four lanes.
#[target_feature(enable = "avx512f,avx512bw,avx512vl,avx2")]
pub fn avx512(block: &Cut, area: &Cut, columns: usize, sums: &mut [u32]) {
    for tile in tiles(block) {
        if tile.width.is_multiple_of(4) && tile.height >= LANES - 1 {
            let quads = Quads::new(block, &tile);
            match tile.width / 4 {
                1 => add_quads::<1>(&tile, &quads, area, columns, sums),
                2 => add_quads::<2>(&tile, &quads, area, columns, sums),
                3 => add_quads::<3>(&tile, &quads, area, columns, sums),
                _ => add_quads::<4>(&tile, &quads, area, columns, sums),
            }
        } else {
            add_tile(&tile, block, area, columns, sums);
        }
    }
}

/// Without it, two candidates share a register.
#[target_feature(enable = "avx2")]
pub fn avx2(block: &Cut, area: &Cut, columns: usize, sums: &mut [u32]) {
    for tile in tiles(block) {
        add_tile(&tile, block, area, columns, sums);
    }
}

/// Lanes of a register of AVX-512.
const LANES: usize = 4;
/// Places next to each other that one lane stands for.
const PLACES: usize = 8;

/// For each four columns of a tile: four pixels, four times, in each lane.
type Slot = [[[u8; 4]; 4 * LANES]; TILE / 4];

/// A tile for [`add_quads`], slot by slot; aligned, so that no register is loaded from two cache lines.
#[repr(align(64))]
struct Quads([Slot; TILE]);

impl Quads {
    fn new(block: &Cut, tile: &Tile) -> Self {
        let mut quads = [[[[0; 4]; 4 * LANES]; TILE / 4]; TILE];
        for slot in 0..tile.height {
            for lane in 0..LANES {
                let row = block.row(tile.x, tile.y + (slot + tile.height - lane) % tile.height);
                let (pixels, _) = row[..tile.width].as_chunks::<4>();
                for (quads, pixels) in quads[slot].iter_mut().zip(pixels) {
                    quads[lane * 4..][..4].fill(*pixels);
                }
            }
        }
        Self(quads)
    }
}

/// Adds the absolute differences of `tile` to the sums of all candidates.
#[target_feature(enable = "avx512f,avx512bw,avx512vl,avx2")]
fn add_quads<const COUNT: usize>(tile: &Tile, quads: &Quads, area: &Cut, columns: usize, sums: &mut [u32]) {
    let rows = sums.len() / columns;
    assert!(sums.len() == rows * columns && tile.width == 4 * COUNT && tile.height >= LANES - 1);
    tile.check(area, (columns, rows), LANES, 8);
    for j in (0..rows).step_by(LANES) {
        for i in (0..columns).step_by(PLACES) {
            // SAFETY: `check` has seen that all rows and bytes that are read lie inside the area.
            let total = unsafe {
                let start = area.pixels.as_ptr().add((j + tile.y) * area.stride + tile.x + i);
                quad_sums::<COUNT>(&quads.0[..tile.height], start, area.stride)
            };
            let lanes: [__m128i; LANES] = [
                _mm512_extracti32x4_epi32::<0>(total),
                _mm512_extracti32x4_epi32::<1>(total),
                _mm512_extracti32x4_epi32::<2>(total),
                _mm512_extracti32x4_epi32::<3>(total),
            ];
            let inside = if i + PLACES <= columns { u8::MAX } else { (1 << (columns - i)) - 1 };
            for (lane, row) in lanes.into_iter().zip(sums[j * columns..].chunks_mut(columns)) {
                // SAFETY: the assert has seen that every row has `columns` sums; `inside` leaves out the lanes past the last.
                unsafe {
                    let sums = row.as_mut_ptr().add(i).cast::<i32>();
                    let before = _mm256_maskz_loadu_epi32(inside, sums);
                    let after = _mm256_add_epi32(before, _mm256_cvtepu16_epi32(lane));
                    _mm256_mask_storeu_epi32(sums, inside, after);
                }
            }
        }
    }
}

/// The sums of eight places in each of four rows of places, the first of them at `start`.
///
/// # Safety
/// From `start` on, 24 bytes of each of the `slots.len() + 3` rows, `stride` bytes apart, must be readable; there must be at least 3
/// slots.
#[inline]
#[target_feature(enable = "avx512f,avx512bw,avx512vl,avx2")]
unsafe fn quad_sums<const COUNT: usize>(slots: &[Slot], start: *const u8, stride: usize) -> __m512i {
    /// Of the four times four bytes of a lane, those that a quad meets at eight places in a row.
    const FIRST: i32 = 0b10_01_01_00;
    /// The same for the quad beside it.
    const SECOND: i32 = 0b11_10_10_01;
    let mut totals = [_mm512_setzero_si512(); 4];
    let mut add = |slot: &Slot, [left, right]: [__m512i; 2]| {
        // SAFETY: a quad of the tile is 64 bytes.
        let quad = |q: usize| unsafe { _mm512_loadu_si512(slot[q].as_ptr().cast()) };
        totals[0] = _mm512_add_epi16(totals[0], _mm512_dbsad_epu8::<FIRST>(quad(0), left));
        if COUNT > 1 {
            totals[1] = _mm512_add_epi16(totals[1], _mm512_dbsad_epu8::<SECOND>(quad(1), left));
        }
        if COUNT > 2 {
            totals[2] = _mm512_add_epi16(totals[2], _mm512_dbsad_epu8::<FIRST>(quad(2), right));
            if COUNT > 3 {
                totals[3] = _mm512_add_epi16(totals[3], _mm512_dbsad_epu8::<SECOND>(quad(3), right));
            }
        }
    };
    // SAFETY: the caller vouches for the bytes.
    let at = |row: usize, right: usize| unsafe { _mm_loadu_si128(start.add(row * stride + right).cast()) };
    // At the top the lower lanes have not begun: they take the row that they lack at the bottom.
    for (s, slot) in slots.iter().enumerate().take(LANES - 1) {
        let lower = u16::MAX << (4 * (s + 1));
        let upper = |right| _mm512_broadcast_i32x4(at(s, right));
        let both = |right| _mm512_mask_broadcast_i32x4(upper(right), lower, at(s + slots.len(), right));
        add(slot, [both(0), both(8)]);
    }
    for (s, slot) in slots.iter().enumerate().skip(LANES - 1) {
        add(slot, [_mm512_broadcast_i32x4(at(s, 0)), _mm512_broadcast_i32x4(at(s, 8))]);
    }
    let [a, b, c, d] = totals;
    _mm512_add_epi16(_mm512_add_epi16(a, b), _mm512_add_epi16(c, d))
}

/// A tile for [`add_tile`]: its rows in both lanes, and masks of the pixels that count.
struct Rows {
    pixels: [__m256i; TILE],
    masks: [__m256i; TILE],
}

impl Rows {
    #[target_feature(enable = "avx2")]
    fn new(block: &Cut, tile: &Tile) -> Self {
        let (mut pixels, mut masks) = ([_mm256_setzero_si256(); TILE], [_mm256_setzero_si256(); TILE]);
        for slot in 0..TILE {
            let (mut row, mut mask) = ([0u8; 2 * TILE], [0u8; 2 * TILE]);
            for lane in 0..2 {
                let of_block = (slot + TILE - lane) % TILE;
                if of_block < tile.height {
                    let lane = lane * TILE..lane * TILE + tile.width;
                    row[lane.clone()].copy_from_slice(&block.row(tile.x, tile.y + of_block)[..tile.width]);
                    mask[lane].fill(u8::MAX);
                }
            }
            // SAFETY: 32 bytes are there to be read.
            unsafe {
                pixels[slot] = _mm256_loadu_si256(row.as_ptr().cast());
                masks[slot] = _mm256_loadu_si256(mask.as_ptr().cast());
            }
        }
        Self { pixels, masks }
    }
}

/// Sums of the differences of two times 16 pixels, spread over each lane.
#[inline]
#[target_feature(enable = "avx2")]
fn differences<const SQUARED: bool>(a: __m256i, b: __m256i) -> __m256i {
    if !SQUARED {
        return _mm256_sad_epu8(a, b);
    }
    let zero = _mm256_setzero_si256();
    let difference = _mm256_or_si256(_mm256_subs_epu8(a, b), _mm256_subs_epu8(b, a));
    let (low, high) = (_mm256_unpacklo_epi8(difference, zero), _mm256_unpackhi_epi8(difference, zero));
    _mm256_add_epi32(_mm256_madd_epi16(low, low), _mm256_madd_epi16(high, high))
}

/// The sum of each lane, in the first and the fifth of eight numbers.
#[inline]
#[target_feature(enable = "avx2")]
fn lane_sums<const SQUARED: bool>(total: __m256i) -> __m256i {
    let halves = _mm256_add_epi32(total, _mm256_unpackhi_epi64(total, total));
    if SQUARED { _mm256_add_epi32(halves, _mm256_srli_epi64::<32>(halves)) } else { halves }
}

/// Adds the part of `tile` to the sums of all candidates.
#[inline]
#[target_feature(enable = "avx2")]
fn add_tile(tile: &Tile, block: &Cut, area: &Cut, columns: usize, sums: &mut [u32]) {
    let rows = Rows::new(block, tile);
    if (tile.width, tile.height) == (TILE, TILE) {
        add_rows::<true>(tile, &rows, area, columns, sums);
    } else {
        add_rows::<false>(tile, &rows, area, columns, sums);
    }
}

#[inline]
#[target_feature(enable = "avx2")]
fn add_rows<const FULL: bool>(
    tile: &Tile,
    Rows { pixels, masks }: &Rows,
    area: &Cut,
    columns: usize,
    sums: &mut [u32],
) {
    let rows = sums.len() / columns;
    tile.check(area, (columns, rows), 2, 0);
    for j in (0..rows).step_by(2) {
        for i in 0..columns {
            let start = (j + tile.y) * area.stride + tile.x + i;
            // SAFETY: `check` has seen that all rows and bytes that are read lie inside the area.
            let row = |r: usize| unsafe { _mm_loadu_si128(area.pixels.as_ptr().add(start + r * area.stride).cast()) };
            let mut total = _mm256_setzero_si256();
            for r in 0..TILE {
                let both =
                    if r == 0 { _mm256_set_m128i(row(TILE), row(0)) } else { _mm256_broadcastsi128_si256(row(r)) };
                let both = if FULL { both } else { _mm256_and_si256(masks[r], both) };
                total = _mm256_add_epi32(total, _mm256_sad_epu8(both, pixels[r]));
            }
            let halves = lane_sums::<false>(total);
            sums[j * columns + i] += _mm256_extract_epi32::<0>(halves) as u32;
            if let Some(below) = sums.get_mut((j + 1) * columns + i) {
                *below += _mm256_extract_epi32::<4>(halves) as u32;
            }
        }
    }
}
