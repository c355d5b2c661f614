//! The decimals of quantities of background models, filters and tracks.

use crate::base::words::fixed;

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
