//! Sine, cosine, logarithm and exponential that give the same bits on every platform.
//!
//! The platform's own differ in the last digit; these use only the operations that IEEE 754 fixes exactly.

use std::f64::consts::{LN_2, SQRT_2, TAU};

/// The largest whole number not above `x`, saturating at the limits of `i32`.
pub fn floor(x: f64) -> i32 {
    let whole = x as i32;
    whole.saturating_sub(i32::from(x < f64::from(whole)))
}

/// Sine and cosine of an angle in turns (1 is a full circle), exact at quarter turns.
pub fn sin_cos(turns: f64) -> (f64, f64) {
    (sin(turns), cos(turns))
}

/// Sine of an angle in turns.
pub fn sin(turns: f64) -> f64 {
    let half = floor(turns * 2.0 + 0.5);
    let rest = turns - f64::from(half) * 0.5;
    if half & 1 == 0 { sin_near_zero(rest) } else { -sin_near_zero(rest) }
}

/// Cosine of an angle in turns.
pub fn cos(turns: f64) -> f64 {
    sin(turns + 0.25)
}

/// Taylor's series, good to 10⁻¹³ within a quarter of a turn, and exact at its ends.
fn sin_near_zero(turns: f64) -> f64 {
    if turns.abs() == 0.25 {
        return 4.0 * turns;
    }
    let x = turns * TAU;
    let z = x * x;
    let z2 = z * z;
    let z4 = z2 * z2;
    // In pairs, so that a processor can work on several at once.
    let pair = |n: usize| SINE[n] + SINE[n + 1] * z;
    x * ((pair(0) + pair(2) * z2) + (pair(4) + pair(6) * z2) * z4 + SINE[8] * z4 * z4)
}

/// (−1)ⁿ/(2n+1)! for n from 0 to 8.
const SINE: [f64; 9] = {
    let mut series = [1.0; 9];
    let mut n = 1;
    while n < 9 {
        series[n] = -series[n - 1] / ((2 * n) * (2 * n + 1)) as f64;
        n += 1;
    }
    series
};

/// Natural logarithm of a positive, normal `x`.
pub fn ln(x: f64) -> f64 {
    let bits = x.to_bits();
    let mut exponent = ((bits >> 52) & 0x7ff) as i64 - 1023;
    let mut mantissa = f64::from_bits((bits & ((1 << 52) - 1)) | (1023 << 52));
    if mantissa > SQRT_2 {
        mantissa *= 0.5;
        exponent += 1;
    }
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let mut sum = 0.0;
    for odd in (1..=21).rev().step_by(2) {
        sum = sum * s * s + 1.0 / f64::from(odd);
    }
    exponent as f64 * LN_2 + 2.0 * s * sum
}

/// e to the power `x`, for |x| up to 700.
pub fn exp(x: f64) -> f64 {
    let twos = floor(x / LN_2 + 0.5).clamp(-1022, 1023);
    let rest = x - f64::from(twos) * LN_2;
    let series = (1..=14).rev().fold(1.0, |sum, n| 1.0 + rest / f64::from(n) * sum);
    series * f64::from_bits(((1023 + i64::from(twos)) as u64) << 52)
}

/// Goes up from 0 to `turn` at speed 1 and back down again, for ever: 0 1 2 1 0 1 2 …
pub fn there_and_back(t: f64, turn: f64) -> f64 {
    let phase = t - f64::from(floor(t / (2.0 * turn))) * 2.0 * turn;
    phase.min(2.0 * turn - phase)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_agree_with_the_platforms() {
        for i in -2000..2000 {
            let x = f64::from(i) * 0.013_7;
            let (s, c) = sin_cos(x);
            assert!((s - (x * TAU).sin()).abs() < 1e-13 && (c - (x * TAU).cos()).abs() < 1e-13, "{x}");
            assert!((exp(x) / x.exp() - 1.0).abs() < 1e-14, "{x}");
            let positive = f64::from(i + 2001) * 0.001;
            assert!((ln(positive) - positive.ln()).abs() < 1e-14, "{positive}");
        }
    }

    #[test]
    fn nothing_turns_or_grows_at_zero() {
        assert_eq!((sin_cos(0.0), exp(0.0), ln(1.0)), ((0.0, 1.0), 1.0, 0.0));
        assert_eq!((sin_cos(0.25), sin_cos(-0.25)), ((1.0, 0.0), (-1.0, 0.0)));
    }

    #[test]
    fn floor_rounds_down_and_saturates() {
        assert_eq!([-1.5, -1.0, -0.1, 0.0, 0.9, 1.0].map(floor), [-2, -1, -1, 0, 0, 1]);
        assert_eq!((floor(1e30), floor(-1e30)), (i32::MAX, i32::MIN));
    }

    #[test]
    fn there_and_back_is_a_triangle() {
        assert_eq!(
            [0.0, 1.0, 2.5, 3.0, 4.0, 6.0, 7.0].map(|t| there_and_back(t, 3.0)),
            [0.0, 1.0, 2.5, 3.0, 2.0, 0.0, 1.0]
        );
    }
}
