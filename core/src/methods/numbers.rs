//! Numbers of background models, filters and tracks as text: each quantity with a fixed number of decimals.

pub(crate) use crate::base::words::fixed;

/// The decimals of a length in px or a velocity in px/frame.
pub(crate) const LENGTH_DECIMALS: usize = 2;
/// The decimals of a squared Mahalanobis distance.
pub(crate) const SQUARED_DECIMALS: usize = 2;
/// The decimals of a share, weight, overlap or cost without unit.
pub(crate) const RATIO_DECIMALS: usize = 3;

/// A length in px or a velocity in px/frame: two decimals.
pub(crate) fn px(value: f64) -> String {
    fixed(value, LENGTH_DECIMALS)
}

/// A squared Mahalanobis distance, NIS, NEES or gate: two decimals.
pub(crate) fn squared(value: f64) -> String {
    fixed(value, SQUARED_DECIMALS)
}

/// A share, weight, rate, overlap or cost without unit: three decimals.
pub(crate) fn ratio(value: f64) -> String {
    fixed(value, RATIO_DECIMALS)
}

/// A measured share of 0 to 1 in percent: one decimal.
pub(crate) fn percent(share: f64) -> String {
    format!("{} %", fixed(100.0 * share, 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_those_of_the_quantity() {
        assert_eq!([px(-3.456), squared(85.0)], ["−3.46", "85.00"]);
        assert_eq!([ratio(0.0367), percent(0.3), px(-0.001)], ["0.037", "30.0 %", "0.00"]);
        assert_eq!([fixed(-12_345.6, 1), fixed(f64::INFINITY, 2)], ["−12\u{202f}345.6", "∞"]);
    }
}
