//! The segment test for processors with AVX2, 32 pixels in a register. The compiled plain loops keep their data in
//! memory and take five times as long.

use std::arch::x86_64::*;

use super::{CIRCLE, COMPASS, LANES, Lanes, RADIUS, Rows, Tested};

/// Tests the pixels from column `x` on.
#[target_feature(enable = "avx2")]
pub fn test<const ARC: usize, const COMPASS_POINTS: usize>(rows: &Rows, x: usize, threshold: u8) -> Option<Tested> {
    // The length is known to the compiler, so that no further check is needed.
    let mut around = [&[0; SPAN]; 2 * RADIUS + 1];
    for (around, row) in around.iter_mut().zip(rows) {
        *around = row[x - RADIUS..].first_chunk()?;
    }
    let center = at(&around, [0, 0]);
    let limit = _mm256_set1_epi8(threshold as i8);
    let (mut brighter, mut darker) = ([_mm256_setzero_si256(); 4], [_mm256_setzero_si256(); 4]);
    for k in 0..4 {
        let pixels = at(&around, CIRCLE[COMPASS[k]]);
        // A difference above the threshold leaves something.
        brighter[k] = _mm256_subs_epu8(_mm256_subs_epu8(pixels, center), limit);
        darker[k] = _mm256_subs_epu8(_mm256_subs_epu8(center, pixels), limit);
    }
    let [brighter, darker] = [is_run::<COMPASS_POINTS>(brighter), is_run::<COMPASS_POINTS>(darker)];
    let passes = brighter | darker;
    if passes == 0 {
        return None;
    }
    let mut most = _mm256_setzero_si256();
    let mut differences = [most; 16];
    if brighter != 0 {
        for k in 0..16 {
            differences[k] = _mm256_subs_epu8(at(&around, CIRCLE[k]), center);
        }
        most = of_best_arc::<ARC>(&differences);
    }
    if darker != 0 {
        for k in 0..16 {
            differences[k] = _mm256_subs_epu8(center, at(&around, CIRCLE[k]));
        }
        most = _mm256_max_epu8(most, of_best_arc::<ARC>(&differences));
    }
    let is_none = _mm256_cmpeq_epi8(_mm256_subs_epu8(most, limit), _mm256_setzero_si256());
    let scores = _mm256_andnot_si256(is_none, _mm256_sub_epi8(most, _mm256_set1_epi8(1)));
    Some(Tested { passes, scores: store(scores) })
}

/// Pixels of a row that the circles of all reach.
const SPAN: usize = LANES + 2 * RADIUS;

/// The pixels at an offset from those tested.
#[inline]
#[target_feature(enable = "avx2")]
fn at(around: &[&[u8; SPAN]; 2 * RADIUS + 1], [i, j]: [isize; 2]) -> __m256i {
    load(around[(j + RADIUS as isize) as usize], (i + RADIUS as isize) as usize)
}

/// A bit for each pixel at which this many adjacent ones of the four values are not 0.
#[inline]
#[target_feature(enable = "avx2")]
fn is_run<const COMPASS_POINTS: usize>([a, b, c, d]: [__m256i; 4]) -> u32 {
    let both = |a, b| _mm256_min_epu8(a, b);
    let either = |a, b| _mm256_or_si256(a, b);
    let run = match COMPASS_POINTS {
        3 => {
            let zero = |a| _mm256_cmpeq_epi8(a, _mm256_setzero_si256());
            let [a, b, c, d] = [zero(a), zero(b), zero(c), zero(d)];
            // At most one of four is 0.
            let two = either(
                either(_mm256_and_si256(a, b), _mm256_and_si256(c, d)),
                _mm256_and_si256(either(a, b), either(c, d)),
            );
            return !(_mm256_movemask_epi8(two) as u32);
        }
        _ => both(either(a, c), either(b, d)),
    };
    !(_mm256_movemask_epi8(_mm256_cmpeq_epi8(run, _mm256_setzero_si256())) as u32)
}

/// As the plain [`super::of_best_arc`].
#[inline]
#[target_feature(enable = "avx2")]
fn of_best_arc<const ARC: usize>(differences: &[__m256i; 16]) -> __m256i {
    let both = |a, b| _mm256_min_epu8(a, b);
    let at = |k: usize| differences[k % 16];
    let (mut two, mut four, mut best) =
        ([_mm256_setzero_si256(); 8], [_mm256_setzero_si256(); 8], _mm256_setzero_si256());
    for (k, two) in two.iter_mut().enumerate() {
        *two = both(at(2 * k + 1), at(2 * k + 2));
    }
    for k in 0..8 {
        four[k] = both(two[k], two[(k + 1) % 8]);
    }
    for k in 0..8 {
        let eight = both(four[k], four[(k + 2) % 8]);
        let shared = match ARC {
            9 => eight,
            10 => both(eight, at(2 * k + 9)),
            11 => both(eight, two[(k + 4) % 8]),
            _ => both(eight, both(two[(k + 4) % 8], at(2 * k + 11))),
        };
        let ends = _mm256_max_epu8(at(2 * k), at(2 * k + ARC));
        best = _mm256_max_epu8(best, both(shared, ends));
    }
    best
}

/// A bit for each pixel from column `x` on whose score exceeds those of its eight neighbours.
#[target_feature(enable = "avx2")]
pub fn maxima(rows: [&[u8]; 3], x: usize) -> u32 {
    let here = load(rows[1], x);
    if _mm256_testz_si256(here, here) == 1 {
        return 0;
    }
    let three = |row| {
        let (left, right) = (load(row, x - 1), load(row, x + 1));
        _mm256_max_epu8(_mm256_max_epu8(left, right), load(row, x))
    };
    let beside = _mm256_max_epu8(load(rows[1], x - 1), load(rows[1], x + 1));
    let around = _mm256_max_epu8(_mm256_max_epu8(three(rows[0]), three(rows[2])), beside);
    let over = _mm256_subs_epu8(here, around);
    !(_mm256_movemask_epi8(_mm256_cmpeq_epi8(over, _mm256_setzero_si256())) as u32)
}

#[inline]
#[target_feature(enable = "avx2")]
fn load(row: &[u8], start: usize) -> __m256i {
    let lanes = &row[start..start + LANES];
    // SAFETY: the slice has as many bytes as a register.
    unsafe { _mm256_loadu_si256(lanes.as_ptr().cast()) }
}

#[inline]
#[target_feature(enable = "avx2")]
fn store(register: __m256i) -> Lanes {
    let mut lanes = [0; LANES];
    // SAFETY: the lanes are as many as a register has.
    unsafe { _mm256_storeu_si256(lanes.as_mut_ptr().cast(), register) };
    lanes
}
