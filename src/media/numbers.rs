//! Conversions of numbers that the target type may not hold.

/// The whole part of `value`, if `T` holds it.
#[expect(
    clippy::cast_possible_truncation,
    reason = "`as` saturates, and a saturated number is larger than any that is asked for"
)]
pub(crate) fn whole<T: TryFrom<i64>>(value: f64) -> Option<T> {
    let number = value as i64;
    T::try_from(number).ok().filter(|_| value.is_finite())
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
        assert_eq!((single(0.1), single(1e99)), (0.1, f32::INFINITY));
    }
}
