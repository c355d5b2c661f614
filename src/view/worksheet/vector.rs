//! Vectors among labelled numbers: a length that is printed tells of a vector that is asked for.

use super::numbers::{self, is_telling, value_of};

/// The digits of both components are rounded: how far that changes the length, in units of their last digit.
const ROUNDED: f64 = 0.75;

/// The length of a vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector<'a> {
    length: f64,
    /// How far the length may be off, as the components are rounded.
    error: f64,
    unit: &'a str,
}

impl<'a> Vector<'a> {
    /// The vector of a value such as `(9.30, 4.46) px/frame`.
    pub fn of(value: &'a str) -> Option<Self> {
        let (components, unit) = value.strip_prefix('(')?.split_once(')')?;
        let found = numbers::of(components);
        let [x, y] = &found[..] else { return None };
        let ((x, of_x), (y, of_y)) = (value_of(x)?, value_of(y)?);
        let unit = unit.trim();
        let error = ROUNDED * 0.1f64.powi(of_x.min(of_y));
        (!unit.is_empty()).then(|| Self { length: x.hypot(y), error, unit })
    }

    /// Whether a value such as `10.31 px/frame` is its length.
    pub fn has_length(&self, value: &str) -> bool {
        let found = numbers::of(value);
        let [number] = &found[..] else { return false };
        let is_in_unit = value.strip_prefix(number.as_str()).is_some_and(|unit| unit.trim() == self.unit);
        let error = |decimals: i32| self.error + 0.5 * 0.1f64.powi(decimals);
        let is_same = |(length, decimals): (f64, i32)| (length - self.length).abs() <= error(decimals);
        is_in_unit && is_telling(number) && value_of(number).is_some_and(is_same)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_is_known_by_its_number_and_its_unit() {
        let vector = Vector::of("(9.30,\u{a0}−4.46) px/frame").expect("a vector");
        assert!(vector.has_length("10.31 px/frame") && vector.has_length("10.3 px/frame"));
        assert!(!vector.has_length("10.31 px") && !vector.has_length("10.45 px/frame"));
        assert!(!vector.has_length("10.31 px/frame, of 12.00"), "more than a length");
        let others = ["9.30, 4.46 px", "(9.30, 4.46)", "(9.30, 4.46, 1.00) px", "none"];
        assert!(others.iter().all(|value| Vector::of(value).is_none()));
    }
}
