//! Sums of absolute differences with the 16-byte registers of WebAssembly.

use std::arch::wasm32::{
    i16x8_splat, u8x16_sub_sat, u16x8_add, u16x8_extadd_pairwise_u8x16, u32x4_add, u32x4_extadd_pairwise_u16x8,
    u32x4_extract_lane, u32x4_splat, v128, v128_load, v128_or,
};

use super::{Cut, Sum};

/// Registers of differences that sums in 16 bits have room for: each adds up to 2 · 255.
const MOST: usize = 128;

/// The sum of absolute differences of `block` against the candidate whose first pixel is the first of `pixels`, in rows of `stride`
/// pixels.
pub fn candidate(block: &Cut, pixels: &[u8], stride: usize) -> u32 {
    let rows = || (0..block.height).map(|y| (&block.row(0, y)[..block.width], &pixels[y * stride..][..block.width]));
    let whole = block.width / 16 * 16;
    let rows_at_once = (MOST / (whole / 16).max(1)).max(1);
    let mut sums = u32x4_splat(0);
    for first in (0..block.height).step_by(rows_at_once) {
        let mut part = i16x8_splat(0);
        for (a, b) in rows().skip(first).take(rows_at_once) {
            for (a, b) in a.as_chunks::<16>().0.iter().zip(b.as_chunks::<16>().0) {
                part = u16x8_add(part, u16x8_extadd_pairwise_u8x16(differences(load(a), load(b))));
            }
        }
        sums = u32x4_add(sums, u32x4_extadd_pairwise_u16x8(part));
    }
    let rest = |(a, b): (&[u8], &[u8])| -> u32 {
        a[whole..].iter().zip(&b[whole..]).map(|(&a, &b)| Sum::Absolute.term(a, b)).sum()
    };
    let lanes = u32x4_extract_lane::<0>(sums)
        + u32x4_extract_lane::<1>(sums)
        + u32x4_extract_lane::<2>(sums)
        + u32x4_extract_lane::<3>(sums);
    if whole == block.width { lanes } else { lanes + rows().map(rest).sum::<u32>() }
}

#[inline(always)]
fn load(pixels: &[u8; 16]) -> v128 {
    // SAFETY: the 16 bytes are there, and the instruction takes any alignment.
    unsafe { v128_load(pixels.as_ptr().cast()) }
}

#[inline(always)]
fn differences(a: v128, b: v128) -> v128 {
    // One of the two is 0.
    v128_or(u8x16_sub_sat(a, b), u8x16_sub_sat(b, a))
}
