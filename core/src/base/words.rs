//! How numbers, displacements and places are told. In plain text a letter below the line stands behind a low line, as in
//! `I_x, I_y, I_t`, for there is no small y to put there; digits are small ones, as in `u₀`. [`crate::scene::Math`] sets all of them.

/// A real number as a person reads it: a true minus sign, and about three digits that count.
pub fn number(v: f32) -> String {
    let size = v.abs();
    let decimals = match size {
        _ if size >= 100.0 => 0,
        _ if size >= 10.0 => 1,
        _ if size >= 1.0 || size == 0.0 => 2,
        _ if size >= 0.1 => 3,
        _ if size >= 0.01 => 4,
        _ => 5,
    };
    signed(v, decimals)
}

/// A number with a true minus sign, unless nothing is left of it.
fn signed(v: f32, decimals: usize) -> String {
    let digits = format!("{:.decimals$}", v.abs());
    let is_negative = v < 0.0 && digits.bytes().any(|b| (b'1'..=b'9').contains(&b));
    if is_negative { format!("−{digits}") } else { digits }
}

/// A number with two decimals, however large: one that large ones nearly cancel to.
pub fn fine(v: f32) -> String {
    signed(v, 2)
}

/// The same of a number that is known more exactly than it is told.
pub fn number_64(v: f64) -> String {
    number(v as f32)
}

/// So many of something: `1 frame`, `3 frames`.
pub fn counted(count: usize, one: &str) -> String {
    if count == 1 { format!("1 {one}") } else { format!("{count} {one}s") }
}

/// That there is no `kind` called `given`, with the one of `names` that was probably meant, or else with all of them.
pub fn there_is_no(kind: &str, given: &str, names: &[&str]) -> String {
    match nearest(given, names.iter().copied()) {
        Some(name) => format!("there is no {kind} {given}; the nearest is {name}"),
        None => format!("there is no {kind} {given}; there are {}", names.join(", ")),
    }
}

/// How many letters must be put in, left out, replaced or swapped with the next to make `a` of `b`: the distance of Damerau and
/// Levenshtein, each letter being touched once.
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

/// Between groups of three digits: thin, and no line is broken there.
const THIN_SPACE: char = '\u{202f}';

/// A whole number with thin spaces between thousands: 12 345.
pub fn grouped(count: usize) -> String {
    spaced(&count.to_string())
}

/// Digits with thin spaces between thousands: four stand together, more are grouped.
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

/// Where a velocity leads, in degrees from right, against the clock: more than −180 up to 180.
pub fn heading_deg([u, v]: [f64; 2]) -> f64 {
    // Not `-v`: left would be −180 where v is 0.
    (0.0 - v).atan2(u).to_degrees()
}

/// Where a velocity leads: `45°`, from right, against the clock, as a person reads a picture.
pub fn heading([u, v]: [f64; 2]) -> String {
    let degrees = heading_deg([u, v]).round();
    // No minus in front of nothing, and one name for left.
    let degrees = if degrees == -180.0 { 180.0 } else { degrees + 0.0 };
    format!("{degrees}°").replace('-', "−")
}

/// A displacement as a person reads it.
pub fn vector([u, v]: [f32; 2]) -> String {
    // A space at which no line is broken.
    format!("({},\u{a0}{})", number(u), number(v))
}

/// A place as a person reads it, to a hundredth of a px.
pub fn place(at: [f32; 2]) -> String {
    let [x, y] = at.map(|c| format!("{c:.2}").replace('-', "−"));
    // A space at which no line is broken.
    format!("({x},\u{a0}{y})")
}

/// `+ 3.1` or `− 3.1`.
pub fn plus(v: f32) -> String {
    let number = number(v);
    number.strip_prefix('−').map_or_else(|| format!("+ {number}"), |size| format!("− {size}"))
}

/// A number as it stands behind a sign.
pub fn factor(v: f32) -> String {
    let number = number(v);
    if number.starts_with('−') { format!("({number})") } else { number }
}

/// A pixel as a person reads it.
pub fn pixel((x, y): (usize, usize)) -> String {
    // A space at which no line is broken.
    format!("({x},\u{a0}{y})")
}

/// Words at the beginning of a sentence.
pub fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect()
}

/// A share of 0 to 1 in percent, as exactly as a person typed it.
pub fn percent(share: f32) -> String {
    let digits = format!("{:.4}", 100.0 * share);
    format!("{} %", digits.trim_end_matches('0').trim_end_matches('.'))
}

/// The one of `names` that `given` is probably a misspelling of: at most two edits, and no more than a third of the letters.
pub fn nearest<'a>(given: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let (edits, name) = names.map(|name| (edits(given, name), name)).min()?;
    (edits <= 2 && 3 * edits <= given.len()).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_that_was_probably_meant_is_told() {
        let names = ["diamond", "full-search", "hexagon"];
        let told = |given: &str| there_is_no("estimator", given, &names);
        for slip in ["diamnod", "diamon", "diamonds", "dismond"] {
            assert_eq!(told(slip), format!("there is no estimator {slip}; the nearest is diamond"));
        }
        assert_eq!(told("full-serach"), "there is no estimator full-serach; the nearest is full-search");
        for other in ["magic", "", "a", "hex", "größe"] {
            assert!(told(other).ends_with("; there are diamond, full-search, hexagon"), "{}", told(other));
        }
        assert_eq!(edits("kitten", "sitting"), 3);
    }

    #[test]
    fn numbers_are_short_and_have_a_true_sign() {
        let told = [0.0, -1e-7, -0.00123, 0.01234, 0.1234, -3.456, 12.34, -255.0].map(number);
        assert_eq!(told, ["0.00", "0.00000", "−0.00123", "0.0123", "0.123", "−3.46", "12.3", "−255"]);
        assert_eq!([fine(1403.247), fine(-0.001), fine(-12.0)], ["1403.25", "0.00", "−12.00"]);
        let headings = [[2.0, 0.0], [0.0, -3.0], [-1.0, 0.0], [0.0, 4.0], [-9.0, 0.01]].map(heading);
        assert_eq!(headings, ["0°", "90°", "180°", "−90°", "180°"]);
        assert_eq!((plus(-2.0), plus(0.5)), ("− 2.00".into(), "+ 0.500".into()));
        assert_eq!(place([126.737, -3.0]), "(126.74,\u{a0}−3.00)");
        assert_eq!([0.9999, 0.99, 0.5].map(percent), ["99.99 %", "99 %", "50 %"]);
    }
}
