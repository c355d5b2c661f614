//! Numbers of optical flow in text: each quantity with its own fixed decimals.

use crate::base::words;
pub use crate::base::words::gray;

/// A number with `decimals` decimals, a true minus sign, and thin spaces from 10 000 on.
pub fn fixed(value: f32, decimals: usize) -> String {
    words::fixed(value.into(), decimals)
}

/// A length in px, to a thousandth.
pub fn px(length: f32) -> String {
    fixed(length, 3)
}

/// A displacement or a position of a method with sub-pixel accuracy, in px.
pub fn vector([x, y]: [f32; 2]) -> String {
    // No line break between the two.
    format!("({},\u{a0}{})", px(x), px(y))
}

/// An eigenvalue or a response of a corner measure: two decimals, but two digits and a power of ten where those would be zeros.
pub fn response(value: f32) -> String {
    let text = gray(value);
    if value != 0.0 && value.abs() < 0.005 { words::with_power(value.into()) } else { text }
}

/// A number of [`response`] as the base of a power or behind a sign: in parentheses where it has a sign or a power of ten.
pub fn base(value: f32) -> String {
    let text = response(value);
    if text.contains('·') || text.starts_with('−') { format!("({text})") } else { text }
}

/// A number of [`fixed`] as a further summand: `+ 3.10` or `− 3.10`.
pub fn summand(number: String) -> String {
    match number.strip_prefix('−') {
        Some(size) => format!("− {size}"),
        None => format!("+ {number}"),
    }
}

/// A number of [`fixed`] as a factor: a negative one in parentheses.
pub fn factor(number: String) -> String {
    if number.starts_with('−') { format!("({number})") } else { number }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_fixed_and_thousands_grouped() {
        assert_eq!([fixed(-0.00056, 3), fixed(0.0098, 3), fixed(-12.5, 2)], ["−0.001", "0.010", "−12.50"]);
        assert_eq!([gray(9999.0), gray(219_023.4)], ["9999.00", "219\u{202f}023.41"]);
        assert_eq!([response(-0.00026), response(0.0), response(0.08)], ["−2.6·10⁻⁴", "0.00", "0.08"]);
        assert_eq!([base(0.00026), base(-2.0), base(2.0)], ["(2.6·10⁻⁴)", "(−2.00)", "2.00"]);
        assert_eq!(vector([0.0654, -1.0]), "(0.065,\u{a0}−1.000)");
        assert_eq!([summand(gray(-2.0)), summand(gray(0.5))], ["− 2.00", "+ 0.50"]);
        assert_eq!([factor(px(-2.0)), factor(px(0.5))], ["(−2.000)", "0.500"]);
    }
}
