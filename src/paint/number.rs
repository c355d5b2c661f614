//! How numbers are written, in the window and in pictures alike.

use std::ops::Range;

use motionscope_core::base::words::spaced;
pub use motionscope_core::base::words::{grouped, with_power};

/// Numbers from here on are written without a power of ten.
const SMALL: f32 = 1e-4;
/// What is smaller is nothing but rounding.
const ROUNDING: f32 = 1e-6;

/// A number for a person: a true minus sign, thin spaces between thousands, four digits that count.
pub fn number(value: f32) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    let size = value.abs();
    if (ROUNDING..SMALL).contains(&size) {
        return with_power(value.into());
    }
    let decimals = match size {
        _ if value.fract() == 0.0 || size >= 1000.0 => 0,
        _ if size >= 100.0 => 1,
        _ if size >= 1.0 => 2,
        // Three that count, and nothing of what is but rounding.
        _ if (SMALL..0.01).contains(&size) => (2.0 - size.log10().floor()) as usize,
        _ => 3,
    };
    with_decimals(value, decimals)
}

/// Exponents of a power of ten.
const EXPONENT: &str = "⁻⁰¹²³⁴⁵⁶⁷⁸⁹";
/// A narrow space at which no line is broken, as within a number from 10 000 on.
pub const THIN: char = '\u{202f}';

/// The places of the numbers in a text, each with its sign and its power of ten.
pub fn places(text: &str) -> Vec<Range<usize>> {
    let letters: Vec<(usize, char)> = text.char_indices().collect();
    let end_of = |index: usize| letters.get(index).map_or(text.len(), |(at, _)| *at);
    let is_digit = |index: usize| letters.get(index).is_some_and(|(_, c)| c.is_ascii_digit());
    let is = |index: usize, wanted: &[char]| letters.get(index).is_some_and(|(_, c)| wanted.contains(c));
    let (mut found, mut index) = (Vec::new(), 0);
    while index < letters.len() {
        // A digit of a name, as in P1, is none.
        let follows_letter = index > 0 && (letters[index - 1].1.is_alphabetic() || letters[index - 1].1 == '_');
        let has_sign = is(index, &['−']) && is_digit(index + 1);
        if !(is_digit(index) && !follows_letter || has_sign) {
            index += 1;
            continue;
        }
        let from = index;
        index += 1;
        while is_digit(index) || (is(index, &['.', THIN]) && is_digit(index + 1)) {
            index += 1;
        }
        if is(index, &['·']) && is(index + 1, &['1']) && is(index + 2, &['0']) {
            let power = (index + 3..).take_while(|at| letters.get(*at).is_some_and(|(_, c)| EXPONENT.contains(*c)));
            let count = power.count();
            index += if count > 0 { 3 + count } else { 0 };
        }
        found.push(letters[from].0..end_of(index));
    }
    found
}

/// The labels at the ticks of an axis: at each as many decimals as the one that needs most, 0.8, 1.0, 1.2.
pub fn labels(ticks: &[f32]) -> Vec<String> {
    let is_exact = |decimals: i32| {
        let scaled = |tick: f32| f64::from(tick) * 10f64.powi(decimals);
        ticks.iter().all(|&tick| (scaled(tick) - scaled(tick).round()).abs() <= 1e-5 * scaled(tick).abs())
    };
    match (0..=6).find(|&decimals| is_exact(decimals)) {
        Some(decimals) => ticks.iter().map(|&tick| with_decimals(tick, decimals as usize)).collect(),
        None => ticks.iter().map(|&tick| number(tick)).collect(),
    }
}

/// A finite number with this many decimals.
fn with_decimals(value: f32, decimals: usize) -> String {
    let digits = format!("{:.decimals$}", value.abs());
    let (whole, fraction) = digits.split_at(digits.find('.').unwrap_or(digits.len()));
    let is_negative = value < 0.0 && digits.bytes().any(|b| (b'1'..=b'9').contains(&b));
    format!("{}{}{fraction}", if is_negative { "−" } else { "" }, spaced(whole))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::{Face, fonts};

    #[test]
    fn numbers_are_written_for_people() {
        let shown = [-3.0, 812.0, 4096.0, 65_025.0, 16_646_400.0, 3.17, -1e-7, f32::NAN].map(number);
        assert_eq!(shown, ["−3", "812", "4096", "65\u{202f}025", "16\u{202f}646\u{202f}400", "3.17", "0.000", "–"]);
        assert_eq!([0.5, 12.34, 110.73, 10_234.4].map(number), ["0.500", "12.34", "110.7", "10\u{202f}234"]);
        assert_eq!([0.05, 0.0012, -0.0004, 2e-6].map(number), ["0.050", "0.00120", "−0.000400", "2.0·10⁻⁶"]);
    }

    #[test]
    fn labels_of_an_axis_have_the_same_decimals() {
        assert_eq!(labels(&[0.6, 0.8, 1.0, 1.2]), ["0.6", "0.8", "1.0", "1.2"]);
        assert_eq!(labels(&[-0.05, 0.0, 0.05]), ["−0.05", "0.00", "0.05"]);
        assert_eq!(labels(&[0.0, 5000.0, 10_000.0]), ["0", "5000", "10\u{202f}000"]);
        assert_eq!(labels(&[1e-7, 2e-7]), [1e-7, 2e-7].map(number));
    }

    #[test]
    fn numbers_in_a_text_are_found_with_their_signs_and_powers() {
        let of = |text: &str| places(text).into_iter().map(|place| text[place].to_owned()).collect::<Vec<_>>();
        assert_eq!(of("(−3, 2.50) px, SAD 9741"), ["−3", "2.50", "9741"]);
        assert_eq!(of("0.4 − 1.9·10⁻⁴ = 16\u{202f}664.90"), ["0.4", "1.9·10⁻⁴", "16\u{202f}664.90"]);
        assert_eq!(of("P1, L(p, 22) + x_2"), ["22"]);
        assert_eq!(of("2·10 px"), ["2", "10"]);
    }

    #[test]
    fn thousands_are_set_apart() {
        assert_eq!([0, 1200, 1_234_567].map(grouped), ["0", "1200", "1\u{202f}234\u{202f}567"]);
    }

    #[test]
    fn the_type_has_the_thin_space() {
        let width = |text: &str| fonts::width(text, Face::Sans, 100.0);
        assert!(width("1\u{202f}2") > width("12") && width("1\u{202f}2") < width("1 2"));
    }
}
