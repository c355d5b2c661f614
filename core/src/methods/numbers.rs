//! Numbers of background models, filters and tracks as text: each quantity with a fixed number of decimals.

use crate::base::words::spaced;

/// A number with this many decimals, a true minus sign, and thin spaces from 10 000 on.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    let digits = format!("{:.decimals$}", value.abs());
    let is_negative = value < 0.0 && digits.bytes().any(|digit| (b'1'..=b'9').contains(&digit));
    let sign = if is_negative { "−" } else { "" };
    match digits.split_once('.') {
        Some((whole, rest)) => format!("{sign}{}.{rest}", spaced(whole)),
        None if value.is_finite() => format!("{sign}{}", spaced(&digits)),
        None if value.is_nan() => "undefined".into(),
        None => format!("{sign}∞"),
    }
}

/// A length in px or a velocity in px/frame: two decimals.
pub(crate) fn px(value: f64) -> String {
    fixed(value, 2)
}

/// A gray level of a model, a difference from it or its standard deviation: two decimals.
pub(crate) fn gray(value: f32) -> String {
    fixed(value.into(), 2)
}

/// The gray level of a pixel: a whole number.
pub(crate) fn level(value: f32) -> String {
    fixed(value.into(), 0)
}

/// A squared Mahalanobis distance, NIS, NEES or gate: two decimals.
pub(crate) fn squared(value: f64) -> String {
    fixed(value, 2)
}

/// A share, weight, rate, overlap or cost without unit: three decimals.
pub(crate) fn ratio(value: f64) -> String {
    fixed(value, 3)
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
        assert_eq!([px(-3.456), gray(127.0), level(176.0), squared(85.0)], ["−3.46", "127.00", "176", "85.00"]);
        assert_eq!([ratio(0.0367), percent(0.3), px(-0.001)], ["0.037", "30.0 %", "0.00"]);
        assert_eq!([fixed(-12_345.6, 1), fixed(f64::INFINITY, 2)], ["−12\u{202f}345.6", "∞"]);
    }
}
