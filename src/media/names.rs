//! File names with numbers in them.

use std::cmp::Ordering;
use std::iter;
use std::path::Path;

/// A name cut at its last number: `frame_0007` is `frame_`, 7 and nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Numbered<'a> {
    /// The part before the number.
    pub prefix: &'a str,
    /// The number as it is written.
    pub digits: &'a str,
    /// The part after the number.
    pub suffix: &'a str,
    /// The number.
    pub number: u64,
}

impl<'a> Numbered<'a> {
    /// `name` cut at its last number, if it has one that fits.
    pub fn parse(name: &'a str) -> Option<Self> {
        let end = name.rfind(|c: char| c.is_ascii_digit())? + 1;
        let start = name[..end].rfind(|c: char| !c.is_ascii_digit()).map_or(0, |i| i + width_at(name, i));
        let digits = &name[start..end];
        let number = digits.parse().ok()?;
        Some(Self { prefix: &name[..start], digits, suffix: &name[end..], number })
    }
}

fn width_at(name: &str, index: usize) -> usize {
    name[index..].chars().next().map_or(0, char::len_utf8)
}

/// The file name of `path` without its last extension.
pub fn stem(path: &Path) -> String {
    path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default()
}

/// The file name of `path`.
pub fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.to_string_lossy(), |s| s.to_string_lossy()).into_owned()
}

/// The extension of `path` in lower case, without its point.
pub fn extension(path: &Path) -> String {
    path.extension().map(|s| s.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// Natural order of names: `frame9` before `frame10`.
pub fn natural_order(a: &str, b: &str) -> Ordering {
    let parts = pieces(a).map(Some).chain(iter::repeat(None)).zip(pieces(b).map(Some).chain(iter::repeat(None)));
    for pair in parts {
        let order = match pair {
            (None, None) => return a.cmp(b),
            (Some(a), Some(b)) => compare_pieces(a, b),
            (a, b) => a.is_some().cmp(&b.is_some()),
        };
        if order != Ordering::Equal {
            return order;
        }
    }
    Ordering::Equal
}

/// Cuts a name into runs of digits and runs of anything else.
fn pieces(name: &str) -> impl Iterator<Item = &str> {
    let is_digit = |c: char| c.is_ascii_digit();
    let mut rest = name;
    iter::from_fn(move || {
        let first = rest.chars().next()?;
        let end = rest.find(|c| is_digit(c) != is_digit(first)).unwrap_or(rest.len());
        let (piece, tail) = rest.split_at(end);
        rest = tail;
        Some(piece)
    })
}

fn compare_pieces(a: &str, b: &str) -> Ordering {
    let are_numbers = [a, b].iter().all(|p| p.starts_with(|c: char| c.is_ascii_digit()));
    if are_numbers {
        let (a, b) = (a.trim_start_matches('0'), b.trim_start_matches('0'));
        a.len().cmp(&b.len()).then_with(|| a.cmp(b))
    } else {
        a.cmp(b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_number_counts() {
        let parse = |name| Numbered::parse(name).map(|n| (n.prefix, n.digits, n.suffix, n.number));
        assert_eq!(parse("frame_0007"), Some(("frame_", "0007", "", 7)));
        assert_eq!(parse("000003_10"), Some(("000003_", "10", "", 10)));
        assert_eq!(parse("12é"), Some(("", "12", "é", 12)));
        assert_eq!(parse("é12"), Some(("é", "12", "", 12)));
        assert_eq!(parse("cat"), None);
        assert_eq!(parse("99999999999999999999999"), None);
    }

    #[test]
    fn names_are_ordered_as_a_person_does() {
        let mut names = ["f10", "f9", "f", "f010", "é1", "f9b", "10", "9", "f9a2", "f9a10"];
        names.sort_by(|a, b| natural_order(a, b));
        assert_eq!(names, ["9", "10", "f", "f9", "f9a2", "f9a10", "f9b", "f010", "f10", "é1"]);
    }

    proptest::proptest! {
        #![proptest_config(proptest::test_runner::Config::with_cases(64))]
        #[test]
        fn the_order_is_total(a in "[ab0-9é]{0,6}", b in "[ab0-9é]{0,6}", c in "[ab0-9é]{0,6}") {
            proptest::prop_assert_eq!(natural_order(&a, &b), natural_order(&b, &a).reverse());
            if natural_order(&a, &b).is_le() && natural_order(&b, &c).is_le() {
                proptest::prop_assert!(natural_order(&a, &c).is_le());
            }
        }
    }
}
