//! The mismatch of windows for processors with AVX2: a strip in a register. The compiled plain loops give the same bits
//! and take three times as long.

use std::arch::x86_64::*;

use super::{Differences, LANES, Lanes, Level, Mismatch, Row, Strip, Sums, Template};
use crate::geometry::Gray;

/// The mismatch of a window at a place inside `next`; `None` without AVX2.
pub fn mismatch(template: &Template, next: &Level, at: [f32; 2]) -> Option<Mismatch> {
    if !is_x86_feature_detected!("avx2") {
        return None;
    }
    let Template { reach, strips, strips_in_row, tensor } = template;
    let [columns, rows] = next.within(at, *reach);
    let is_whole = columns.len().min(rows.len()) > 2 * reach;
    let mut is_in = Row::default();
    is_in.as_flattened_mut()[columns].fill(1.0);
    let ([x, y], fraction) = next.corner(at, *reach);
    let place = [x, y + rows.start];
    let strips = &strips[rows.start * strips_in_row..rows.end * strips_in_row];
    let is_in = (!is_whole).then_some(&is_in);
    // The compiler knows how many strips there are in a row, and keeps it in registers.
    // SAFETY: the processor has AVX2.
    let (differences, sums) = unsafe {
        match strips_in_row {
            1 => lay::<1>(strips, &next.pixels, place, fraction, is_in),
            2 => lay::<2>(strips, &next.pixels, place, fraction, is_in),
            3 => lay::<3>(strips, &next.pixels, place, fraction, is_in),
            _ => lay::<4>(strips, &next.pixels, place, fraction, is_in),
        }
    };
    let tensor = if is_whole { *tensor } else { Sums(sums).tensor() };
    Some(Differences(differences).mismatch(tensor))
}

/// Lays rows of strips at a place of a padded picture, a pixel and a fraction of a px beyond. The sums of δI I_x, δI I_y and
/// |δI|; and those of I_x², I_x I_y, I_y² and of the pixels that count, where not all columns are in.
#[target_feature(enable = "avx2")]
fn lay<const STRIPS: usize>(
    strips: &[Strip],
    pixels: &Gray,
    [x, y]: [usize; 2],
    fraction: [f32; 2],
    is_in: Option<&Row>,
) -> ([Lanes; 3], [Lanes; 4]) {
    let [fx, fy] = fraction.map(|f| _mm256_set1_ps(f));
    let sign = _mm256_set1_ps(-0.0);
    let (mut sums, [mut across, mut down, mut size]) = ([_mm256_setzero_ps(); 4], [_mm256_setzero_ps(); 3]);
    let mut above = between::<STRIPS>(&pixels.row(y)[x..], fx);
    for (j, strips) in strips.as_chunks::<STRIPS>().0.iter().enumerate() {
        let below = between::<STRIPS>(&pixels.row(y + j + 1)[x..], fx);
        for (k, strip) in strips.iter().enumerate() {
            let gradient = [load(&strip.across), load(&strip.down)];
            let mut counts = load(&strip.counts);
            if let Some(is_in) = is_in {
                counts = _mm256_mul_ps(load(&is_in[k]), counts);
                sums = added(sums, gradient, counts);
            }
            let off = _mm256_mul_ps(_mm256_sub_ps(load(&strip.values), mix(above[k], below[k], fy)), counts);
            across = _mm256_add_ps(across, _mm256_mul_ps(off, gradient[0]));
            down = _mm256_add_ps(down, _mm256_mul_ps(off, gradient[1]));
            size = _mm256_add_ps(size, _mm256_andnot_ps(sign, off));
        }
        above = below;
    }
    ([across, down, size].map(|sum| store(sum)), sums.map(|sum| store(sum)))
}

/// The sums with a strip's products of gradients added, for the pixels that count.
#[target_feature(enable = "avx2")]
fn added([xx, xy, yy, pixels]: [__m256; 4], [across, down]: [__m256; 2], counts: __m256) -> [__m256; 4] {
    let (gx, gy) = (_mm256_mul_ps(across, counts), _mm256_mul_ps(down, counts));
    [
        _mm256_add_ps(xx, _mm256_mul_ps(gx, gx)),
        _mm256_add_ps(xy, _mm256_mul_ps(gx, gy)),
        _mm256_add_ps(yy, _mm256_mul_ps(gy, gy)),
        _mm256_add_ps(pixels, counts),
    ]
}

/// The gray values of the first strips of a row, `fraction` px further to the right each.
#[target_feature(enable = "avx2")]
fn between<const STRIPS: usize>(row: &[u8], fraction: __m256) -> [__m256; STRIPS] {
    let row = &row[..STRIPS * LANES + 1];
    let (left, right) = (row.as_chunks::<LANES>().0, row[1..].as_chunks::<LANES>().0);
    let mut values = [_mm256_setzero_ps(); STRIPS];
    for (k, value) in values.iter_mut().enumerate() {
        *value = mix(grays(left[k]), grays(right[k]), fraction);
    }
    values
}

#[target_feature(enable = "avx2")]
fn grays(pixels: [u8; LANES]) -> __m256 {
    _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_cvtsi64_si128(i64::from_le_bytes(pixels))))
}

/// Interpolates linearly between `a` and `b`.
#[target_feature(enable = "avx2")]
fn mix(a: __m256, b: __m256, share: __m256) -> __m256 {
    _mm256_add_ps(a, _mm256_mul_ps(_mm256_sub_ps(b, a), share))
}

#[target_feature(enable = "avx2")]
fn load(lanes: &Lanes) -> __m256 {
    // SAFETY: the lanes are as many as a register has.
    unsafe { _mm256_loadu_ps(lanes.as_ptr()) }
}

#[target_feature(enable = "avx2")]
fn store(register: __m256) -> Lanes {
    let mut lanes = [0.0; LANES];
    // SAFETY: the lanes are as many as a register has.
    unsafe { _mm256_storeu_ps(lanes.as_mut_ptr(), register) };
    lanes
}
