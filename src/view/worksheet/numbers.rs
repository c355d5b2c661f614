//! Numbers in texts and formulas: found, left out, filled in.

use std::ops::Range;

use motionscope_core::Role;
use motionscope_core::scene::Math;

use crate::paint::charts::formula::blank;

/// The box instead of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fill {
    /// A box to write in.
    Blank,
    /// The number, in the colour of results.
    Answer,
}

impl Fill {
    /// A number, left out or filled in.
    pub fn math(self, number: &str) -> Math {
        match self {
            Fill::Blank => Math::text(blank(number)),
            Fill::Answer => Math::ink(Role::Result, number),
        }
    }
}

/// Exponents of a power of ten.
const EXPONENT: &str = "⁻⁰¹²³⁴⁵⁶⁷⁸⁹";
/// A space within a number from 10 000 on.
const THIN: char = '\u{202f}';

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

/// The numbers of a text.
pub fn of(text: &str) -> Vec<String> {
    places(text).into_iter().map(|place| text[place].to_owned()).collect()
}

/// Whether a number is seldom met by chance: one of three digits or more that is neither 0 nor 1.
pub fn is_telling(number: &str) -> bool {
    let digits = number.chars().filter(char::is_ascii_digit).count();
    let value: Option<f64> = number.replace('−', "-").replace(THIN, "").parse().ok();
    digits >= 3 && value.is_none_or(|value| value != 0.0 && value.abs() != 1.0)
}

/// A text as a formula in which the numbers that are `chosen` are left out or filled in.
pub fn filled(text: &str, role: Option<Role>, fill: Fill, chosen: &dyn Fn(&str) -> bool) -> Math {
    let (mut parts, mut end) = (Vec::new(), 0);
    for place in places(text).into_iter().filter(|place| chosen(&text[place.clone()])) {
        if place.start > end {
            parts.push(Math::Text(text[end..place.start].to_owned(), role));
        }
        parts.push(fill.math(&text[place.clone()]));
        end = place.end;
    }
    if end < text.len() || parts.is_empty() {
        parts.push(Math::Text(text[end..].to_owned(), role));
    }
    if parts.len() == 1 { parts.remove(0) } else { Math::Row(parts) }
}

/// A formula in which the numbers that are `chosen` are left out or filled in; indices and exponents stay.
pub fn filled_in(math: &Math, fill: Fill, chosen: &dyn Fn(&str) -> bool) -> Math {
    let each = |inner: &Math| Box::new(filled_in(inner, fill, chosen));
    match math {
        Math::Text(text, role) => filled(text, *role, fill, chosen),
        Math::Row(parts) => Math::Row(parts.iter().map(|part| filled_in(part, fill, chosen)).collect()),
        Math::Frac(top, bottom) => Math::Frac(each(top), each(bottom)),
        Math::Sub(base, index) => Math::Sub(each(base), index.clone()),
        Math::Sup(base, exponent) => Math::Sup(each(base), exponent.clone()),
        Math::Abs(inner) => Math::Abs(each(inner)),
        Math::Sqrt(inner) => Math::Sqrt(each(inner)),
        Math::Matrix(rows) => {
            let row = |row: &Vec<Math>| row.iter().map(|entry| filled_in(entry, fill, chosen)).collect();
            Math::Matrix(rows.iter().map(row).collect())
        }
        Math::Var(_) | Math::Bold(_) | Math::Sum(_) | Math::Bar(_) | Math::Hat(_) => math.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_found_with_their_signs_and_powers() {
        assert_eq!(of("(−3, 2.50) px, SAD 9741"), ["−3", "2.50", "9741"]);
        assert_eq!(of("0.4 − 1.9·10⁻⁴ = 16\u{202f}664.90"), ["0.4", "1.9·10⁻⁴", "16\u{202f}664.90"]);
        assert_eq!(of("P1, L(p, 22) + x_2"), ["22"]);
        assert_eq!(of("2·10 px"), ["2", "10"]);
        assert!(is_telling("0.39") && is_telling("812") && !is_telling("16") && !is_telling("0.000"));
    }

    #[test]
    fn chosen_numbers_are_left_out_and_the_others_stay() {
        let text = "SAD 812 at (−3, 2)";
        let left = filled(text, None, Fill::Blank, &|number| number == "812").plain();
        assert!(left.starts_with("SAD □") && left.ends_with("at (−3, 2)") && !left.contains("812"), "{left}");
        assert_eq!(filled(text, None, Fill::Answer, &|_| true).plain(), text);
    }
}
