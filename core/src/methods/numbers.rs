//! The decimals of quantities of background models, filters and tracks.

use crate::base::words::{fixed, further_digits, rounded};
use crate::scene::{Number, Value, Variable};

/// The decimals of a length in px or a velocity in px/frame.
pub(crate) const LENGTH_DECIMALS: usize = 2;
/// The decimals of a squared Mahalanobis distance.
pub(crate) const SQUARED_DECIMALS: usize = 2;
/// The decimals of a share, weight, overlap or cost without unit.
pub(crate) const RATIO_DECIMALS: usize = 3;

/// A share, weight, rate, overlap or cost without unit.
pub(crate) fn ratio(value: f64) -> String {
    fixed(value, RATIO_DECIMALS)
}

/// A value with further digits.
pub(crate) fn finer(of: &'static Variable, number: impl Into<Number>, further: usize) -> Value {
    of.is(number).in_unit(of.unit.finer(further as u8))
}

/// The further digits with which `computed`, by the number of decimals of its terms, gives the length or squared distance `result`.
pub(crate) fn digits(result: f64, computed: impl Fn(usize) -> f64) -> usize {
    let shown = |number| rounded(number, LENGTH_DECIMALS);
    further_digits(|further| shown(computed(LENGTH_DECIMALS + further)) == shown(result))
}
