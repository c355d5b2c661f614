//! Conversions of numbers that the target type may not hold.

/// The whole part of `value`, if `T` holds it.
#[expect(clippy::cast_possible_truncation, reason = "the fraction is meant to go, and larger numbers are refused")]
pub(crate) fn whole<T: TryFrom<i64>>(value: f64) -> Option<T> {
    let is_held = value.is_finite() && value.abs() < i64::MAX as f64;
    T::try_from(value as i64).ok().filter(|_| is_held)
}

/// `value` in single precision, the nearest number.
#[expect(clippy::cast_possible_truncation, reason = "it is rounded; what is out of range becomes infinite")]
pub(crate) fn single(value: f64) -> f32 {
    value as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_no_number() {
        assert_eq!([0.0, -0.9, 255.9].map(whole::<u8>), [Some(0), Some(0), Some(255)]);
        assert_eq!([-1.0, 256.0, f64::NAN, f64::INFINITY].map(whole::<u8>), [None; 4]);
        assert_eq!([1e300, -1e300].map(whole::<i64>), [None; 2]);
        assert_eq!((single(0.1), single(1e99)), (0.1, f32::INFINITY));
    }
}
