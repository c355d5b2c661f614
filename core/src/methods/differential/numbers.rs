//! Numbers of optical flow in text: each quantity with its own fixed decimals.

use crate::base::words;
pub use crate::base::words::gray;

/// A number with `decimals` decimals, a true minus sign, and thin spaces from 10 000 on.
pub fn fixed(value: f32, decimals: usize) -> String {
    words::fixed(value.into(), decimals)
}

/// The decimals of a length in px.
pub const PX_DECIMALS: usize = 3;

/// The decimals of a difference in gray levels.
pub const GRAY_DECIMALS: usize = 2;

/// A length in px, to a thousandth.
pub fn px(length: f32) -> String {
    fixed(length, PX_DECIMALS)
}

/// A displacement or a position of a method with sub-pixel accuracy, in px.
pub fn vector([x, y]: [f32; 2]) -> String {
    // No line break between the two.
    format!("({},\u{a0}{})", px(x), px(y))
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
        assert_eq!(vector([0.0654, -1.0]), "(0.065,\u{a0}−1.000)");
        assert_eq!([factor(px(-2.0)), factor(px(0.5))], ["(−2.000)", "0.500"]);
    }
}
