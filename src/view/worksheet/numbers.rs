//! Numbers in texts and formulas: found, left out, filled in.

use motionscope_core::scene::{Math, Role};

use crate::paint::charts::formula::blank;
use crate::paint::{THIN, places};

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

    /// A word or a sign between two values, left out or filled in.
    pub fn word(self, word: &str) -> Math {
        let letters = word.chars().count().max(LEAST_WORD);
        match self {
            Fill::Blank => Math::text(blank(word).chars().take(letters).collect::<String>()),
            Fill::Answer => Math::ink(Role::Result, word),
        }
    }
}

/// Least number of letters that the box for a word has room for.
const LEAST_WORD: usize = 2;

/// The numbers of a text.
pub fn of(text: &str) -> Vec<String> {
    places(text).into_iter().map(|place| text[place].to_owned()).collect()
}

/// The numbers of the values of a formula.
pub fn all_numbers(math: &Math) -> Vec<String> {
    math.values().into_iter().flat_map(|(value, style)| of(&style.text(value))).collect()
}

/// The numbers in the colour of a role.
pub fn inked(math: &Math) -> Vec<String> {
    let inked = math.values().into_iter().filter(|(value, _)| value.role.is_some());
    inked.flat_map(|(value, style)| of(&style.text(value))).collect()
}

/// Whether a formula has a value.
pub fn has_values(math: &Math) -> bool {
    !math.values().is_empty()
}

/// Whether a formula has a symbol.
pub fn has_unknown(math: &Math) -> bool {
    match math {
        Math::Var(_) | Math::Bold(_) | Math::Bar(_) | Math::Hat(_) => true,
        Math::Text(..) | Math::Value(..) | Math::Sum(_) => false,
        Math::Row(parts) => parts.iter().any(has_unknown),
        Math::Matrix(rows) => rows.iter().flatten().any(has_unknown),
        Math::Frac(top, bottom) => has_unknown(top) || has_unknown(bottom),
        Math::Sub(inner, _) | Math::Sup(inner, _) | Math::Abs(inner) | Math::Sqrt(inner) => has_unknown(inner),
    }
}

/// Whether a number is seldom met by chance: one of three digits or more that is neither 0 nor 1.
pub fn is_telling(number: &str) -> bool {
    let digits = number.chars().filter(char::is_ascii_digit).count();
    digits >= 3 && value_of(number).is_none_or(|(value, _)| value != 0.0 && value.abs() != 1.0)
}

/// A number with its count of decimals; `None` for one with a power of ten.
pub fn value_of(number: &str) -> Option<(f64, i32)> {
    let plain = number.replace('−', "-").replace(THIN, "");
    let decimals = plain.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    Some((plain.parse().ok()?, i32::try_from(decimals).ok()?))
}

/// Whether `shown` tells one of the numbers that are `asked` for: it is the same, or one of both is the other rounded.
pub fn tells<'a>(shown: &str, asked: impl IntoIterator<Item = &'a String>) -> bool {
    is_telling(shown) && asked.into_iter().any(|asked| asked == shown || is_rounded(shown, asked))
}

/// Whether one of two numbers is the other rounded to fewer decimals. A whole number is often met by chance.
fn is_rounded(a: &str, b: &str) -> bool {
    let (Some((of_a, decimals_a)), Some((of_b, decimals_b))) = (value_of(a), value_of(b)) else { return false };
    let (rounded, decimals) = if decimals_a < decimals_b { (a, decimals_a) } else { (b, decimals_b) };
    // Half a unit of the last digit, and no less by rounding here.
    let most = 0.5 * 0.1f64.powi(decimals) + 1e-9;
    decimals_a != decimals_b && decimals > 0 && is_telling(rounded) && (of_a - of_b).abs() <= most
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

/// A formula in which the numbers of values that are `chosen` are left out or filled in; indices and exponents stay.
pub fn filled_in(math: &Math, fill: Fill, chosen: &dyn Fn(&str) -> bool) -> Math {
    let each = |inner: &Math| Box::new(filled_in(inner, fill, chosen));
    match math {
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
        Math::Value(value, style) => filled(&style.text(value), value.role, fill, chosen),
        Math::Text(..) | Math::Var(_) | Math::Bold(_) | Math::Sum(_) | Math::Bar(_) | Math::Hat(_) => math.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_of_three_digits_is_telling_unless_it_is_zero_or_one() {
        assert_eq!(of("(−3, 2.50) px, SAD 9741"), ["−3", "2.50", "9741"]);
        assert!(["0.39", "812", "16\u{202f}664"].iter().all(|number| is_telling(number)));
        assert!(["16", "0.000", "−1.00"].iter().all(|number| !is_telling(number)));
    }

    #[test]
    fn a_number_tells_the_one_that_it_is_rounded_from_or_to() {
        let is_told = |shown: &str, asked: &str| tells(shown, [&asked.to_owned()]);
        assert!(is_told("6.22", "6.22") && is_told("6.22", "6.217") && is_told("6.217", "6.22"));
        assert!(is_told("6.22", "6.225") && is_told("6.23", "6.225"), "what lies between may be rounded to both");
        assert!(is_told("−16.5", "−16.52") && !is_told("16.5", "−16.52"));
        assert!(!is_told("6.22", "6.23") && !is_told("6.21", "6.217"), "another number");
        assert!(!is_told("158", "158.31") && !is_told("6.2", "6.22"), "seldom enough by chance");
    }

    #[test]
    fn chosen_numbers_are_left_out_and_the_others_stay() {
        let text = "SAD 812 at (−3, 2)";
        let left = filled(text, None, Fill::Blank, &|number| number == "812").plain();
        assert!(left.starts_with("SAD □") && left.ends_with("at (−3, 2)") && !left.contains("812"), "{left}");
        assert_eq!(filled(text, None, Fill::Answer, &|_| true).plain(), text);
    }

    #[test]
    fn a_sign_has_a_smaller_box_than_a_number() {
        let [sign, word] = ["≤", "accepted"].map(|word| Fill::Blank.word(word).plain());
        assert_eq!([&sign, &word].map(|blanks| blanks.chars().count()), [2, 8]);
        assert!(sign.chars().count() < Fill::Blank.math("9").plain().chars().count());
        assert_eq!(Fill::Answer.word("≤").plain(), "≤");
    }
}
