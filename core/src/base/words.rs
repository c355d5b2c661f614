//! How numbers, displacements and places are written. In plain text an index stands behind an underscore, as in
//! `I_x, I_y, I_t`, since there is no subscript y; digits are true subscripts, as in `u₀`. [`crate::scene::Math`] typesets
//! all of them.
//!
//! A quantity has a fixed number of decimals, whatever its size: [`px`], [`gray`].
//! All have a true minus sign, and thin spaces between thousands from 10 000 on.

/// A number with this many decimals, a true minus sign, and thin spaces from 10 000 on.
pub fn fixed(v: f64, decimals: usize) -> String {
    let digits = format!("{:.decimals$}", v.abs());
    // Not −0.00, but −∞.
    let is_negative = v < 0.0 && (v.is_infinite() || digits.bytes().any(|b| (b'1'..=b'9').contains(&b)));
    let sign = if is_negative { "−" } else { "" };
    match digits.split_once('.') {
        Some((whole, rest)) => format!("{sign}{}.{rest}", spaced(whole)),
        None if v.is_finite() => format!("{sign}{}", spaced(&digits)),
        None if v.is_nan() => "undefined".into(),
        None => format!("{sign}∞"),
    }
}

/// The number that [`fixed`] writes.
pub fn rounded(v: f64, decimals: usize) -> f64 {
    format!("{v:.decimals$}").parse().unwrap_or(v)
}

/// The most further digits with which the numbers of a formula are written.
pub(crate) const MOST_FURTHER_DIGITS: usize = 4;

/// The fewest further digits with which a formula, computed from its numbers as they are written, gives its result as it is written:
/// `54.28 + 7.16 = 61.45` becomes `54.283 + 7.163 = 61.45`. `is_true` says whether it does with so many.
pub(crate) fn further_digits(is_true: impl FnMut(&usize) -> bool) -> usize {
    (0..MOST_FURTHER_DIGITS).find(is_true).unwrap_or(MOST_FURTHER_DIGITS)
}

/// The further digits with which the terms of a sum, written with this many decimals, give the sum as it is written.
pub(crate) fn further_digits_of_sum(terms: &[f64], decimals: usize) -> usize {
    let sum = fixed(terms.iter().sum(), decimals);
    let written = |further: &usize| terms.iter().map(|term| rounded(*term, decimals + further)).sum();
    further_digits(|further| fixed(written(further), decimals) == sum)
}

/// A position or displacement in px: two decimals, none where it is whole.
pub fn px(v: f32) -> String {
    fixed(v.into(), if v.fract() == 0.0 { 0 } else { 2 })
}

/// A difference or standard deviation in gray levels: two decimals.
pub fn gray(v: f32) -> String {
    fixed(v.into(), 2)
}

/// A small number with two digits and a power of ten: `−2.4·10⁻⁷`.
pub fn with_power(value: f64) -> String {
    with_power_to(value, 1)
}

/// A number with this many decimals before a power of ten.
pub(crate) fn with_power_to(value: f64, decimals: usize) -> String {
    let digits = format!("{:.decimals$e}", value.abs());
    let (mantissa, exponent) = digits.split_once('e').unwrap_or((&digits, "0"));
    let sign = if value < 0.0 { "−" } else { "" };
    format!("{sign}{mantissa}·10{}", exponent.chars().map(superscript).collect::<String>())
}

/// A digit of an exponent.
fn superscript(digit: char) -> char {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    digit.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize])
}

/// A count with its noun: `1 frame`, `3 frames`, `3 matches`, `3 trajectories`, `3 maxima`.
pub fn counted(count: usize, one: &str) -> String {
    if count == 1 { format!("1 {one}") } else { format!("{count} {}", plural(one)) }
}

/// The plural of a noun: `frames`, `matches`, `trajectories`, `hypotheses`, `maxima`.
pub fn plural(one: &str) -> String {
    match one.strip_suffix('y') {
        _ if one.is_empty() => String::new(),
        Some(stem) if !stem.ends_with(['a', 'e', 'o', 'u']) => format!("{stem}ies"),
        _ if one.ends_with("ch") || one.ends_with("ss") => format!("{one}es"),
        _ if one.ends_with("sis") => format!("{}es", &one[..one.len() - 2]),
        _ if one.ends_with("imum") => format!("{}a", &one[..one.len() - 2]),
        _ => format!("{one}s"),
    }
}

/// The message for an unknown name: the nearest of `names` if `given` looks like a misspelling of it, else all of them.
pub fn there_is_no(kind: &str, given: &str, names: &[&str]) -> String {
    match nearest(given, names.iter().copied()) {
        Some(name) => format!("there is no {kind} {given}; the nearest is {name}"),
        None => format!("there is no {kind} {given}; there are {}", names.join(", ")),
    }
}

/// The Damerau–Levenshtein distance: insertions, deletions, replacements and swaps of neighbouring letters between `a` and
/// `b`, each letter being edited once (optimal string alignment).
fn edits(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut rows = vec![(0..=b.len()).collect::<Vec<_>>()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replaced = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut fewest = replaced.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                fewest = fewest.min(rows[i - 2][j - 2] + 1);
            }
            row.push(fewest);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

/// The separator of thousands: a narrow no-break space.
const THIN_SPACE: char = '\u{202f}';

/// A count with thin spaces between thousands from 10 000 on: 12 345.
pub fn grouped(count: usize) -> String {
    spaced(&count.to_string())
}

/// Digits with thin spaces between thousands; four digits stay together.
pub fn spaced(digits: &str) -> String {
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && digits.len() > 4 && (digits.len() - i).is_multiple_of(3) {
            text.push(THIN_SPACE);
        }
        text.push(digit);
    }
    text
}

/// The direction of a velocity in degrees as of all angles on a picture, from x (right) towards y (down): more than −180 up to 180.
pub fn heading_deg([u, v]: [f64; 2]) -> f64 {
    // A negative zero in v would turn left into −180.
    (v + 0.0).atan2(u).to_degrees()
}

/// The same in whole degrees; to the left it is 180.
pub(crate) fn whole_heading_deg(velocity: [f64; 2]) -> f64 {
    let degrees = heading_deg(velocity).round();
    if degrees == -180.0 { 180.0 } else { degrees + 0.0 }
}

/// A position in px as text, to a hundredth of a px.
pub fn place(at: [f32; 2]) -> String {
    let [x, y] = at.map(|c| fixed(c.into(), 2));
    // A no-break space.
    format!("({x},\u{a0}{y})")
}

/// A pixel's coordinates as text.
pub fn pixel((x, y): (usize, usize)) -> String {
    // A no-break space.
    format!("({x},\u{a0}{y})")
}

/// The words with a capital letter at the beginning.
pub fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect()
}

/// A share of 0 to 1 in percent, with up to four significant decimals: `99.99 %`.
pub fn percent(share: f32) -> String {
    let digits = format!("{:.4}", 100.0 * share);
    format!("{} %", digits.trim_end_matches('0').trim_end_matches('.'))
}

/// The most letters that a misspelling changes, adds or leaves out.
const MOST_EDITS: usize = 2;

/// The one of `names` that `given` is probably a misspelling of: at most two edits, and no more than a third of the letters.
pub fn nearest<'a>(given: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let length = given.chars().count();
    // An edit changes the length by one at most.
    let alike = names.filter(|name| name.chars().count().abs_diff(length) <= MOST_EDITS);
    let (edits, name) = alike.map(|name| (edits(given, name), name)).min()?;
    (edits <= MOST_EDITS && 3 * edits <= given.len()).then_some(name)
}

/// Whether `typed` is `name`, whatever its capitals and whatever stands between its words: `chan-vese` is `Chan–Vese`.
pub fn is_name(typed: &str, name: &str) -> bool {
    let words = |text: &str| {
        let words = text.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
        words.map(str::to_lowercase).collect::<Vec<_>>()
    };
    !words(typed).is_empty() && words(typed) == words(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_the_same_however_they_are_written() {
        assert!(is_name("hierarchical-search", "Hierarchical search") && is_name("chan vese", "Chan–Vese"));
        assert!(!is_name("hierarchical", "Hierarchical search") && !is_name("", "") && !is_name("--", ""));
    }

    #[test]
    fn the_name_that_was_probably_meant_is_reported() {
        let names = ["diamond", "full-search", "hexagon"];
        let message = |given: &str| there_is_no("estimator", given, &names);
        for slip in ["diamnod", "diamon", "diamonds", "dismond"] {
            assert_eq!(message(slip), format!("there is no estimator {slip}; the nearest is diamond"));
        }
        assert_eq!(message("full-serach"), "there is no estimator full-serach; the nearest is full-search");
        for other in ["magic", "", "a", "hex", "größe"] {
            assert!(message(other).ends_with("; there are diamond, full-search, hexagon"), "{}", message(other));
        }
        assert_eq!(edits("kitten", "sitting"), 3);
        // Names that are much shorter are not compared: letter by letter that would take minutes.
        let long = "d".repeat(3_000_000);
        assert_eq!(nearest(&long, names.iter().copied().cycle().take(300)), None);
    }

    #[test]
    fn decimals_are_those_of_the_quantity() {
        assert_eq!([px(3.0), px(-0.25), px(-0.001), gray(-0.0625)], ["3", "−0.25", "0.00", "−0.06"]);
        assert_eq!([fixed(12_345.0, 0), fixed(-0.00056, 3), fixed(0.0098, 3)], ["12\u{202f}345", "−0.001", "0.010"]);
        assert_eq!([fixed(f64::NEG_INFINITY, 2), fixed(f64::NAN, 2)], ["−∞", "undefined"]);
        let headings = [[2.0, 0.0], [0.0, -3.0], [-1.0, -0.0], [0.0, 4.0], [-9.0, -0.01]].map(whole_heading_deg);
        assert_eq!(headings, [0.0, -90.0, 180.0, 90.0, 180.0]);
        assert_eq!(place([126.737, -3.0]), "(126.74,\u{a0}−3.00)");
        assert_eq!([0.9999, 0.99, 0.5].map(percent), ["99.99 %", "99 %", "50 %"]);
    }

    #[test]
    fn a_formula_has_the_digits_that_make_it_true() {
        assert_eq!(further_digits_of_sum(&[54.28, -7.16], 2), 0);
        assert_eq!(further_digits_of_sum(&[54.2834, 7.1634], 2), 1, "54.28 + 7.16 = 61.44, but the sum is 61.4468");
        assert_eq!(further_digits_of_sum(&[-0.2, f64::NAN], 1), 0);
        assert_eq!(further_digits(|_| false), 4);
        assert_eq!([rounded(-0.126, 2), rounded(12_345.678, 1)], [-0.13, 12_345.7]);
        assert_eq!([with_power_to(2.44e-7, 2), with_power(2.44e-7)], ["2.44·10⁻⁷", "2.4·10⁻⁷"]);
    }
}
